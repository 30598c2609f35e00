// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <tuple>
#include <vector>

#include "advice/prediction.hpp"
#include "fracture/prediction.hpp"
#include "input/schema.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"

namespace slipfront::python {
namespace {

using namespace nb::literals;

nb::dict predict_fronts(const input::CaseFile& given, const Values& x_m, const Values& fracture_energy,
                        const Values& residual_coefficient, const std::optional<double>& at_x_m,
                        const std::optional<std::tuple<Values, Values, Values>>& before) {
  const advice::TipFriction friction{to_vector(x_m), to_vector(fracture_energy),
                                     to_vector(residual_coefficient)};
  const auto problem = problem::make_problem(given.config());
  std::optional<record::StaticState> state;
  if (before) {
    const auto& [places, t_Pa, p_Pa] = *before;
    state = {to_vector(places), to_vector(t_Pa), to_vector(p_Pa)};
  }
  const auto p = [&] {
    const nb::gil_scoped_release unlocked;
    return given.placing_errors(
        [&] { return advice::FrontPredictor(problem).predict(friction, at_x_m, state ? &*state : nullptr); });
  }();
  const auto& of = p.of_fronts;
  nb::dict points;
  std::vector<double> direction;
  for (const auto& front : of.fronts) direction.insert(direction.end(), front.points.size(), front.direction);
  points["direction"] = to_array(std::move(direction));
  for (const auto& column : fracture::predicted_fields) {
    std::vector<double> values;
    for (const auto& front : of.fronts)
      for (const auto& point : front.points) values.push_back(point.*column.member);
    points[column.name] = to_array(std::move(values));
  }
  std::vector<int> arrests;
  for (const auto& front : of.fronts)
    if (front.arrests()) arrests.push_back(front.direction);
  nb::dict found;
  found["points"] = points;
  found["arrests"] = arrests;
  found["starts"] = of.starts;
  found["first_length_m"] = of.first_length_m;
  found["critical_length_m"] = of.critical_length_m;
  found["nucleation_length_m"] = p.nucleation_length_m;
  found["bodies"] = p.bodies;
  nb::list notes;
  for (const auto& note : p.notes) notes.append(note.text);
  found["notes"] = notes;
  found["law_has_length"] = advice::has_fracture_energy(problem);
  found["doubts_of_arrest"] = p.doubts_of_arrest;
  return found;
}

}  // namespace

void bind_fracture(nb::module_& module) {
  module.def("predict_fronts", &predict_fronts, "case"_a, "x_m"_a, "fracture_energy_J_per_m2"_a,
             "residual_coefficient"_a, "at_x_m"_a.none(), "before"_a.none(),
             "Fronts of a case by the equation of motion of cracks; empty arrays leave friction to the law. "
             "before: places, t and p before the event, instead of those of the case.");
}

}  // namespace slipfront::python
