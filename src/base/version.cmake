# SPDX-License-Identifier: BSD-3-Clause
# Writes OUTPUT from TEMPLATE with VERSION and the commit of the repository at SOURCE_DIR; run at every build,
# the file is touched only when one of them changes.
set(COMMIT unknown)
# An archive that git made names the commit there.
file(READ ${SOURCE_DIR}/src/base/commit.txt archived)
if(archived MATCHES "^([0-9a-f]+)")
  set(COMMIT ${CMAKE_MATCH_1})
endif()
if(EXISTS ${SOURCE_DIR}/.git)
  execute_process(COMMAND git -C ${SOURCE_DIR} describe --always --dirty --abbrev=12 --exclude=*
    OUTPUT_VARIABLE described RESULT_VARIABLE failed OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT failed AND described)
    set(COMMIT ${described})
  endif()
endif()
configure_file(${TEMPLATE} ${OUTPUT} @ONLY)
