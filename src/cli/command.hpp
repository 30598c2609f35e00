// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

// Options of subcommands: values that are refused. The messages of CLI11's own checks name the largest
// double, and nan passes them.
namespace slipfront::cli {

CLI::Validator positive();
CLI::Validator finite();
CLI::Validator non_negative();
/// An empty text, as of a variable that is not set, is no path.
CLI::Validator not_empty();

}  // namespace slipfront::cli
