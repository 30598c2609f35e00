# SPDX-License-Identifier: BSD-3-Clause
# Writes OUTPUT from TEMPLATE with VERSION and the commit of the repository at SOURCE_DIR; run at every build,
# the file is touched only when one of them changes.
set(COMMIT unknown)
if(EXISTS ${SOURCE_DIR}/.git)
  execute_process(COMMAND git -C ${SOURCE_DIR} describe --always --dirty --abbrev=12 --exclude=*
    OUTPUT_VARIABLE described RESULT_VARIABLE failed OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT failed AND described)
    set(COMMIT ${described})
  endif()
endif()
configure_file(${TEMPLATE} ${OUTPUT} @ONLY)
