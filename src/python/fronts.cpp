// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "fronts/front.hpp"
#include "fronts/measures.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/histories.hpp"

namespace slipfront::python {
namespace {

using namespace nb::literals;
using fronts::Front;
using fronts::FrontOptions;
using fronts::FrontPoint;

/// A number of all points of a front, as NumPy sees it inside the points themselves.
template <auto member>
auto column(nb::handle_t<Front> self) {
  using Value = std::remove_reference_t<decltype(std::declval<FrontPoint>().*member)>;
  static_assert(sizeof(FrontPoint) % sizeof(Value) == 0);
  const auto& points = nb::cast<const Front&>(self).points;
  const Value* data = points.empty() ? nullptr : &(points.front().*member);
  constexpr auto stride = static_cast<std::int64_t>(sizeof(FrontPoint) / sizeof(Value));
  return nb::ndarray<nb::numpy, const Value, nb::ndim<1>>(data, {points.size()}, self, {stride});
}

void bind_front(nb::module_& module) {
  nb::class_<Front>(module, "Front", "A path of onsets, continuous in x, in one direction. Arrays: [points]")
      .def_ro("id", &Front::id)
      .def_ro("direction", &Front::direction, "+1 or -1 along x")
      .def_prop_ro(
          "end", [](const Front& f) { return fronts::name(f.end); }, "why it ends")
      .def_prop_ro(
          "mode", [](const Front& f) { return fronts::name(f.mode); }, "crack, pulse or mixed")
      .def_prop_ro("length_m", [](const Front& f) { return fronts::length_m(f); })
      .def_prop_ro("node", &column<&FrontPoint::node>, "indices along the interface")
      .def_prop_ro("x_m", &column<&FrontPoint::x_m>)
      .def_prop_ro("onset_s", &column<&FrontPoint::onset_s>)
      .def_prop_ro("v_tip_m_per_s", &column<&FrontPoint::v_tip_m_per_s>)
      .def_prop_ro("t_s_Pa", &column<&FrontPoint::t_s_Pa>)
      .def_prop_ro("p_s_Pa", &column<&FrontPoint::p_s_Pa>)
      .def_prop_ro("t_d_Pa", &column<&FrontPoint::t_d_Pa>)
      .def_prop_ro("p_d_Pa", &column<&FrontPoint::p_d_Pa>)
      .def_prop_ro("t_r_Pa", &column<&FrontPoint::t_r_Pa>)
      .def_prop_ro("p_r_Pa", &column<&FrontPoint::p_r_Pa>)
      .def_prop_ro("U_s_J_per_m3", &column<&FrontPoint::U_s_J_per_m3>)
      .def_prop_ro("U_r_J_per_m3", &column<&FrontPoint::U_r_J_per_m3>)
      .def_prop_ro("slipping_share", &column<&FrontPoint::slipping_share>)
      .def_prop_ro("accelerating", &column<&FrontPoint::accelerating>);
}

void bind_options(nb::module_& module) {
  nb::enum_<fronts::SpeedInterval>(module, "SpeedInterval", "Where l* lies against the node at x.")
      .value("centred", fronts::SpeedInterval::centred)
      .value("approach", fronts::SpeedInterval::approach);
  nb::class_<FrontOptions>(module, "FrontOptions",
                           "How fronts are found and measured; lengths in m, times in s.")
      .def(nb::init<>())
      .def_rw("l_star_m", &FrontOptions::l_star_m)
      .def_rw("speed_interval", &FrontOptions::speed_interval)
      .def_rw("arrest_time_s", &FrontOptions::arrest_time_s)
      .def_rw("arrest_time_by_event", &FrontOptions::arrest_time_by_event)
      .def_rw("whole_interface", &FrontOptions::whole_interface)
      .def_rw("min_length_m", &FrontOptions::min_length_m)
      .def_rw("crack_share", &FrontOptions::crack_share)
      .def_rw("pulse_share", &FrontOptions::pulse_share)
      .def_rw("mode_fraction", &FrontOptions::mode_fraction)
      .def_prop_rw(
          "mu_s", [](const FrontOptions& o) { return o.mu_s[0]; },
          [](FrontOptions& o, double mu_s) { o.mu_s = mu_s; })
      .def_prop_rw(
          "youngs_modulus_Pa", [](const FrontOptions& o) { return o.elasticity.youngs_modulus_Pa; },
          [](FrontOptions& o, double E_Pa) { o.elasticity.youngs_modulus_Pa = E_Pa; })
      .def_prop_rw(
          "poissons_ratio", [](const FrontOptions& o) { return o.elasticity.poissons_ratio; },
          [](FrontOptions& o, double nu) { o.elasticity.poissons_ratio = nu; })
      .def_prop_rw(
          "plane_strain", [](const FrontOptions& o) { return o.elasticity.plane_strain; },
          [](FrontOptions& o, bool is) { o.elasticity.plane_strain = is; });
}

/// The onsets of nodes that slip, in the order of time; tractions around them are unknown.
record::SlipRecord record_of(const Values& x_m, const Values& onset_s, double end_time_s,
                             double resolution_s) {
  require_length(onset_s, x_m.size(), "onset_s");
  record::SlipRecord record;
  record.x_m = to_vector(x_m);
  record.end_time_s = end_time_s;
  record.resolution_s = resolution_s;
  for (std::size_t node = 0; node < onset_s.size(); ++node)
    if (std::isfinite(onset_s(node)))
      record.onsets.push_back({static_cast<std::int32_t>(node), onset_s(node)});
  std::ranges::stable_sort(record.onsets, {}, &record::Onset::time_s);
  record.around.assign(record.onsets.size(), {nan, nan});
  return record;
}

/// Lets a signal's handler, such as that of Ctrl-C, end the work by its exception.
void interruptible() {
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

std::vector<Front> find_fronts(const Values& x_m, const Values& onset_s, const Values& t_s_Pa,
                               const Values& p_s_Pa, double end_time_s, double resolution_s,
                               FrontOptions options) {
  options.pause = interruptible;
  const auto state = to_state(x_m, t_s_Pa, p_s_Pa);
  return fronts::find_fronts(record_of(x_m, onset_s, end_time_s, resolution_s), state, options);
}

std::vector<Front> find_fronts_in_history(const Values& time_s, const Values& x_m,
                                          const Rows& slip_rate_m_per_s, const Rows& t_Pa, const Rows& p_Pa,
                                          const Values& t_s_Pa, const Values& p_s_Pa,
                                          double threshold_m_per_s, bool tip_at_peak, FrontOptions options) {
  options.pause = interruptible;
  const auto state = to_state(x_m, t_s_Pa, p_s_Pa);
  const auto history = to_history(time_s, x_m, slip_rate_m_per_s, t_Pa, p_Pa);
  const auto record = to_record(history, threshold_m_per_s, options.l_star_m,
                                tip_at_peak ? fronts::TipAt::peak : fronts::TipAt::slip_rate);
  return fronts::find_fronts(record, state, options);
}

Array energy_density(const Values& t_Pa, const Values& p_Pa, double E_Pa, double nu, bool plane_strain) {
  require_length(p_Pa, t_Pa.size(), "p_Pa");
  std::vector<double> density;
  density.reserve(t_Pa.size());
  for (std::size_t k = 0; k < t_Pa.size(); ++k)
    density.push_back(fronts::energy_density_J_per_m3({t_Pa(k), p_Pa(k)}, {E_Pa, nu, plane_strain}));
  return to_array(std::move(density));
}

/// Neighbouring places over which one quantity falls while another rises, by the lengths of the stretches.
Array falls_while_rises(const Values& s_m, const Values& falling, const Values& rising, double min_length_m) {
  require_ascending(view(s_m), "s_m");
  require_length(falling, s_m.size(), "falling");
  require_length(rising, s_m.size(), "rising");
  fronts::StretchOptions options;
  options.min_length_m = min_length_m;
  std::vector<double> lengths_m;
  for (const auto& stretch : fronts::find_stretches(view(s_m), view(falling), view(rising), options))
    lengths_m.push_back(stretch.length_m);
  return to_array(std::move(lengths_m));
}

}  // namespace

void bind_fronts(nb::module_& module) {
  bind_front(module);
  bind_options(module);
  module.def("find_fronts", &find_fronts, "x_m"_a, "onset_s"_a, "t_s_Pa"_a, "p_s_Pa"_a, "end_time_s"_a,
             "resolution_s"_a, "options"_a, "Fronts in first onsets at x_m [nodes], infinite where none is.");
  module.def("find_fronts_in_history", &find_fronts_in_history, "time_s"_a, "x_m"_a, "slip_rate_m_per_s"_a,
             "t_Pa"_a, "p_Pa"_a, "t_s_Pa"_a, "p_s_Pa"_a, "threshold_m_per_s"_a, "tip_at_peak"_a, "options"_a,
             "Fronts in a history of the interface, matrices [times, nodes].");
  module.def("falls_while_rises", &falls_while_rises, "s_m"_a, "falling"_a, "rising"_a, "min_length_m"_a,
             "Lengths of stretches of a path over which one quantity falls while another rises.");
  module.def("energy_density_J_per_m3", &energy_density, "t_Pa"_a, "p_Pa"_a, "youngs_modulus_Pa"_a,
             "poissons_ratio"_a, "plane_strain"_a, "Kammer et al. 2012, Eq. 2.");
}

}  // namespace slipfront::python
