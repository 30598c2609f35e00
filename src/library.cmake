# SPDX-License-Identifier: BSD-3-Clause
# All modules as one library, slipfront::slipfront. Packages have it shared, once for each kind of processor: the loader
# takes the one in glibc-hwcaps/KIND beside the library where the processor can run it (glibc 2.33 or later).
if(NOT SLIPFRONT_SHARED)
  add_library(libslipfront INTERFACE)
  target_link_libraries(libslipfront INTERFACE slipfront_cli)
  add_library(slipfront::slipfront ALIAS libslipfront)
  return()
endif()

set(symbols ${CMAKE_CURRENT_SOURCE_DIR}/library.map)
foreach(kind IN LISTS kinds)
  list(TRANSFORM modules PREPEND ${kind}_ OUTPUT_VARIABLE all)
  list(TRANSFORM all REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>" OUTPUT_VARIABLE objects)
  add_library(lib${kind} SHARED ${objects})
  target_link_libraries(lib${kind} PRIVATE ${all} PUBLIC fmt::fmt)
  target_compile_features(lib${kind} PUBLIC cxx_std_20)
  target_include_directories(lib${kind} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}>
                             $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/slipfront>)
  # Copies of templates and inline functions stay within: a program's own may be compiled for another processor.
  target_link_options(lib${kind} PRIVATE LINKER:--version-script,${symbols} LINKER:-Bsymbolic-functions
                      LINKER:-z,defs)
  string(REPLACE "slipfront-" "glibc-hwcaps/" folder ${kind})
  string(REPLACE "slipfront" "" folder ${folder})
  set_target_properties(lib${kind} PROPERTIES
    OUTPUT_NAME slipfront EXPORT_NAME slipfront LINK_DEPENDS ${symbols}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/${folder})
endforeach()
add_library(slipfront::slipfront ALIAS libslipfront)
