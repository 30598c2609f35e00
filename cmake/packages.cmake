# SPDX-License-Identifier: BSD-3-Clause
# The Debian package that `cpack` makes in the build folder of the preset "package".
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "slip fronts at frictional interfaces, by 2D explicit finite elements")
set(CPACK_PACKAGE_DESCRIPTION "\
How sliding begins when an elastic body is pressed and sheared on a
rigid plane or on another body: statics, contact, friction, explicit
motion, front tracking, and the studies of Kammer et al. (2012).
The library for the processor at hand is chosen when the program starts.")
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_COMPONENTS_ALL runtime debian)
set(SLIPFRONT_MAINTAINER "the slipfront authors <slipfront@example.org>" CACHE STRING "Of the Debian package")
set(CPACK_PACKAGE_CONTACT "${SLIPFRONT_MAINTAINER}")
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${SLIPFRONT_MAINTAINER}")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# The variants of the library are found through the program's search path, as the loader finds them.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR}/lib)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
install(FILES packaging/lintian-overrides DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides RENAME slipfront
        COMPONENT debian EXCLUDE_FROM_ALL)
# Compressed as Debian wants it, without the time of writing.
add_custom_command(OUTPUT ${CMAKE_BINARY_DIR}/pages/NEWS.gz
  COMMAND ${GZIP} -9nc ${PROJECT_SOURCE_DIR}/CHANGELOG.md > ${CMAKE_BINARY_DIR}/pages/NEWS.gz
  DEPENDS ${PROJECT_SOURCE_DIR}/CHANGELOG.md VERBATIM)
add_custom_target(news ALL DEPENDS ${CMAKE_BINARY_DIR}/pages/NEWS.gz)
install(FILES ${CMAKE_BINARY_DIR}/pages/NEWS.gz DESTINATION ${doc_folder} COMPONENT debian EXCLUDE_FROM_ALL)
include(CPack)
