// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/stl/tuple.h>

#include <tuple>
#include <utility>
#include <vector>

#include "fracture/field.hpp"
#include "input/schema.hpp"
#include "problem/problem.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"

namespace slipfront::python {
namespace {

using namespace nb::literals;
using fracture::PlaneTensor;

/// The field of the tip of a front between a case's bodies.
struct Field {
  stability::Bodies bodies;
  double speed_m_per_s;
  fracture::TipField field;

  Field(const input::CaseFile& given, double speed, int along_x)
      : bodies(materials_of(problem::bodies_of(given.config()))),
        speed_m_per_s(speed),
        field(bodies, speed, along_x) {
    require(along_x == 1 || along_x == -1, "along_x must be 1 or -1");
  }
};

using Components = std::tuple<Array, Array, Array>;

template <PlaneTensor (fracture::TipField::*of)(double, double) const>
Components at(const Field& self, const Values& x, const Values& y) {
  require_length(y, x.size(), "y_m");
  std::vector<double> xx(x.size()), yy(x.size()), xy(x.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    const auto found = (self.field.*of)(x.data()[k], y.data()[k]);
    xx[k] = found.xx, yy[k] = found.yy, xy[k] = found.xy;
  }
  return {to_array(std::move(xx)), to_array(std::move(yy)), to_array(std::move(xy))};
}

}  // namespace

void bind_gauges(nb::module_& module) {
  using T = fracture::TipField;
  nb::class_<Field>(module, "TipField",
                    "Stress and strain near the tip of a front along +x or -x between a case's bodies, over "
                    "the stress intensity factor K in Pa m^(1/2), which is positive where the body above "
                    "slips to +x: docs/gauges.md. NaN from the limiting speed on.")
      .def(nb::init<const input::CaseFile&, double, int>(), "case"_a, "speed_m_per_s"_a, "along_x"_a)
      .def("stress_per_K", &at<&T::stress_per_K>, "x_m"_a, "y_m"_a,
           "xx, yy and xy at places from the tip [places]")
      .def("strain_per_K", &at<&T::strain_per_K>, "x_m"_a, "y_m"_a,
           "xx, yy and xy, half the engineering shear strain, at places from the tip [places]")
      .def_prop_ro(
          "energy_per_K2",
          [](const Field& f) { return fracture::energy_release_rate_J_per_m2(f.bodies, f.speed_m_per_s, 1); },
          "energy release rate over K^2, J/m2")
      .def_prop_ro(
          "limiting_speed_m_per_s", [](const Field& f) { return fracture::limiting_speed_m_per_s(f.bodies); },
          "up to which there is a field");
}

}  // namespace slipfront::python
