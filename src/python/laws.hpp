// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include "interface/friction.hpp"

namespace slipfront::python {

/// A function of Python as a law over arrays. It is called without Python's lock, and must outlive the law.
interface::ArrayLaw law_of(const nanobind::callable& mu_of);

}  // namespace slipfront::python
