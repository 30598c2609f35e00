// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace slipfront::statics {

/// What the solvers take their dense and sparse algebra from: "Eigen 3.4.0".
std::string algebra_library();

}  // namespace slipfront::statics
