// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/stl/string.h>

#include "base/version.hpp"
#include "python/bindings.hpp"

NB_MODULE(_core, module) {
  // A stepper whose law is a function of the script that holds the stepper lasts until the interpreter ends.
  nanobind::set_leak_warnings(false);
  module.doc() = "The compiled part of slipfront; use the package slipfront, which explains it.";
  module.def("version", &slipfront::version_line, "Version and commit that the module was built from.");
  slipfront::python::bind_errors(module);
  slipfront::python::bind_observers(module);
  slipfront::python::bind_cases(module);
  slipfront::python::bind_compose(module);
  slipfront::python::bind_fronts(module);
  slipfront::python::bind_fracture(module);
  slipfront::python::bind_passages(module);
  slipfront::python::bind_fits(module);
  slipfront::python::bind_batch(module);
}
