# SPDX-License-Identifier: BSD-3-Clause
# SuiteSparse's CHOLMOD: Debian's package carries no CMake configuration. Defines CHOLMOD::CHOLMOD.
#
# OpenBLAS without threads comes first: with them it starts a thread per processor when the program is loaded, and
# waits for ever where there is not the memory for their stacks.
find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse)
find_library(CHOLMOD_LIBRARY cholmod)
find_library(OPENBLAS_LIBRARY openblas PATH_SUFFIXES openblas-serial)
# CHOLMOD asks for libblas and liblapack, by default those of another OpenBLAS. It takes what is already loaded: theirs.
cmake_path(GET OPENBLAS_LIBRARY PARENT_PATH openblas_folder)
find_library(OPENBLAS_BLAS_LIBRARY blas PATHS ${openblas_folder} NO_DEFAULT_PATH)
find_library(OPENBLAS_LAPACK_LIBRARY lapack PATHS ${openblas_folder} NO_DEFAULT_PATH)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(CHOLMOD REQUIRED_VARS
  CHOLMOD_LIBRARY CHOLMOD_INCLUDE_DIR OPENBLAS_LIBRARY OPENBLAS_BLAS_LIBRARY OPENBLAS_LAPACK_LIBRARY)
if(CHOLMOD_FOUND AND NOT TARGET CHOLMOD::CHOLMOD)
  add_library(CHOLMOD::CHOLMOD UNKNOWN IMPORTED)
  set_target_properties(CHOLMOD::CHOLMOD PROPERTIES
    IMPORTED_LOCATION "${CHOLMOD_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${CHOLMOD_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "${OPENBLAS_LIBRARY};${OPENBLAS_BLAS_LIBRARY};${OPENBLAS_LAPACK_LIBRARY}"
    INTERFACE_LINK_OPTIONS "LINKER:--no-as-needed")
endif()
