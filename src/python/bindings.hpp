// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

/// The Python module slipfront._core, a function for each part. It gives the functions of the other modules
/// to Python as they are; what makes them convenient there is in python/slipfront.
namespace slipfront::python {

void bind_errors(nanobind::module_& module);
void bind_cases(nanobind::module_& module);
void bind_observers(nanobind::module_& module);
void bind_compose(nanobind::module_& module);
void bind_fronts(nanobind::module_& module);
void bind_fits(nanobind::module_& module);
void bind_kammer2012(nanobind::module_& module);

}  // namespace slipfront::python
