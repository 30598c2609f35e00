// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace slipfront {

/// Version of the program, "0.1.0".
const char* version();

/// Commit it was built from, with "-dirty" where files were changed since; "unknown" outside a repository.
const char* commit();

/// "slipfront 0.1.0 (commit)".
std::string version_line();

/// What it was compiled for: "x86-64-v3", "the machine that compiled it".
const char* processor();

/// Size of the vectors that the processor's loops take.
int vector_bytes_of_processor();

/// Compiler that made the program, "g++ 12.2.0".
const char* compiler();

}  // namespace slipfront
