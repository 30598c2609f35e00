# SPDX-License-Identifier: BSD-3-Clause
# What `cmake --install` puts where. The shared library lies in a folder of its own: its interface goes with the version.
set(library_folder ${CMAKE_INSTALL_LIBDIR}/slipfront)
set(config_folder ${CMAKE_INSTALL_LIBDIR}/cmake/slipfront)
set(doc_folder ${CMAKE_INSTALL_DATADIR}/doc/slipfront)

install(TARGETS slipfront COMPONENT runtime)
install(FILES CITATION.cff README.md DESTINATION ${doc_folder} COMPONENT runtime)
install(FILES packaging/copyright DESTINATION ${doc_folder} COMPONENT runtime)
install(DIRECTORY docs papers verification DESTINATION ${doc_folder} COMPONENT runtime
        PATTERN *.cpp EXCLUDE PATTERN *.hpp EXCLUDE PATTERN *.toml EXCLUDE PATTERN CMakeLists.txt EXCLUDE)
install(DIRECTORY cases DESTINATION ${CMAKE_INSTALL_DATADIR}/slipfront COMPONENT runtime)
install(DIRECTORY papers DESTINATION ${CMAKE_INSTALL_DATADIR}/slipfront COMPONENT runtime
        FILES_MATCHING PATTERN *.toml PATTERN figures EXCLUDE)

# Written by the program, so that they have what it has. The loader may take any of the libraries.
set(libraries "")
if(SLIPFRONT_SHARED)
  list(TRANSFORM SLIPFRONT_PROCESSORS PREPEND libslipfront- OUTPUT_VARIABLE libraries)
endif()
find_program(GZIP gzip REQUIRED)
foreach(page man bash)
  set(file ${CMAKE_BINARY_DIR}/pages/${page})
  add_custom_command(OUTPUT ${file} COMMAND slipfront page ${page} > ${file} DEPENDS slipfront ${libraries} VERBATIM)
  list(APPEND pages ${file})
endforeach()
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/pages)
add_custom_command(OUTPUT ${CMAKE_BINARY_DIR}/pages/man.gz DEPENDS ${CMAKE_BINARY_DIR}/pages/man
  COMMAND ${GZIP} -9nc ${CMAKE_BINARY_DIR}/pages/man > ${CMAKE_BINARY_DIR}/pages/man.gz VERBATIM)
list(APPEND pages ${CMAKE_BINARY_DIR}/pages/man.gz)
add_custom_target(pages ALL DEPENDS ${pages})
install(FILES ${CMAKE_BINARY_DIR}/pages/man.gz RENAME slipfront.1.gz
        DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT runtime)
install(FILES ${CMAKE_BINARY_DIR}/pages/bash RENAME slipfront
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT runtime)

# A wheel holds, beside the files in Python, the module and an installation without what describes it.
if(SLIPFRONT_PYTHON)
  install(TARGETS slipfront_core LIBRARY DESTINATION slipfront COMPONENT python EXCLUDE_FROM_ALL)
  install(TARGETS slipfront RUNTIME DESTINATION slipfront/bin COMPONENT python EXCLUDE_FROM_ALL)
  if(SLIPFRONT_LICENCES)
    install(DIRECTORY ${SLIPFRONT_LICENCES}/ DESTINATION slipfront/licences COMPONENT python EXCLUDE_FROM_ALL)
  endif()
endif()

if(NOT SLIPFRONT_SHARED)
  return()
endif()
cmake_path(RELATIVE_PATH CMAKE_INSTALL_FULL_LIBDIR BASE_DIRECTORY ${CMAKE_INSTALL_FULL_BINDIR} OUTPUT_VARIABLE to_lib)
set_target_properties(slipfront PROPERTIES INSTALL_RPATH "$ORIGIN/${to_lib}/slipfront")
install(TARGETS libslipfront EXPORT slipfront LIBRARY DESTINATION ${library_folder}
        COMPONENT runtime NAMELINK_COMPONENT development)
foreach(processor IN LISTS SLIPFRONT_PROCESSORS)
  install(TARGETS libslipfront-${processor} LIBRARY DESTINATION ${library_folder}/glibc-hwcaps/${processor}
          COMPONENT runtime NAMELINK_SKIP)
endforeach()
if(SLIPFRONT_PYTHON)
  set_target_properties(slipfront_core PROPERTIES INSTALL_RPATH "$ORIGIN/${library_folder}")
  set(wheel_folder slipfront/${library_folder})
  install(TARGETS libslipfront LIBRARY DESTINATION ${wheel_folder}
          COMPONENT python NAMELINK_SKIP EXCLUDE_FROM_ALL)
  foreach(processor IN LISTS SLIPFRONT_PROCESSORS)
    install(TARGETS libslipfront-${processor} LIBRARY DESTINATION ${wheel_folder}/glibc-hwcaps/${processor}
            COMPONENT python NAMELINK_SKIP EXCLUDE_FROM_ALL)
  endforeach()
endif()

foreach(module base threads processes files record mesh solid boundary interface stability fronts fracture statics motion
        input problem results setup advice run)
  install(DIRECTORY src/${module} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/slipfront COMPONENT development
          FILES_MATCHING PATTERN *.hpp)
endforeach()
include(CMakePackageConfigHelpers)
file(WRITE ${CMAKE_BINARY_DIR}/slipfrontConfig.cmake [[
include(CMakeFindDependencyMacro)
find_dependency(fmt 9)
include(${CMAKE_CURRENT_LIST_DIR}/slipfrontTargets.cmake)
]])
write_basic_package_version_file(${CMAKE_BINARY_DIR}/slipfrontConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/slipfrontConfig.cmake ${CMAKE_BINARY_DIR}/slipfrontConfigVersion.cmake
        DESTINATION ${config_folder} COMPONENT development)
install(EXPORT slipfront NAMESPACE slipfront:: FILE slipfrontTargets.cmake
        DESTINATION ${config_folder} COMPONENT development)
