// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

/// The Python module slipfront._core, a function for each part. It gives the functions of the other modules
/// to Python as they are; what makes them convenient there is in python/slipfront.
namespace slipfront::python {

namespace nb = nanobind;

void bind_errors(nb::module_& module);
void bind_cases(nb::module_& module);
void bind_batch(nb::module_& module);
void bind_observers(nb::module_& module);
void bind_compose(nb::module_& module);
void bind_fronts(nb::module_& module);
void bind_fracture(nb::module_& module);
void bind_passages(nb::module_& module);
void bind_fits(nb::module_& module);

}  // namespace slipfront::python
