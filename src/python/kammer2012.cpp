// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "base/numbers.hpp"
#include "fronts/front.hpp"
#include "input/schema.hpp"
#include "papers/kammer2012/outcome.hpp"
#include "papers/kammer2012/scorecard.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/histories.hpp"
#include "run/run.hpp"

namespace slipfront::python {
namespace {

using namespace nb::literals;
using kammer2012::Outcome;

/// Where the interface is in contact, inside and at its largest t/p, as the statics would tell.
void find_contact(const record::StaticState& state, double edge_margin_m, run::InitialState& initial) {
  auto& subcritical = initial.subcritical;
  const auto in_contact = [&](double p_Pa) { return p_Pa > 0; };
  const auto first = std::ranges::find_if(state.p_s_Pa, in_contact);
  require(first != state.p_s_Pa.end(), "p_s_Pa is nowhere above 0: nothing is in contact");
  const auto last = std::find_if(state.p_s_Pa.rbegin(), state.p_s_Pa.rend(), in_contact);
  subcritical.inside_from_m = state.x_m[first - state.p_s_Pa.begin()] + edge_margin_m;
  subcritical.inside_to_m = state.x_m[state.p_s_Pa.rend() - last - 1] - edge_margin_m;
  subcritical.peak_ratio = -infinity;
  for (std::size_t k = 0; k < state.x_m.size(); ++k) {
    const double ratio = state.t_s_Pa[k] / state.p_s_Pa[k];
    const bool inside = state.x_m[k] >= subcritical.inside_from_m && state.x_m[k] <= subcritical.inside_to_m;
    if (!inside || !(state.p_s_Pa[k] > 0) || !(ratio > subcritical.peak_ratio)) continue;
    subcritical.peak_ratio = ratio;
    subcritical.peak_x_m = state.x_m[k];
  }
  require(std::isfinite(subcritical.peak_ratio), "t_s_Pa/p_s_Pa is defined nowhere inside the interface");
}

/// An event from a user's arrays instead of a run.
Outcome make_outcome(const std::string& name, const input::CaseFile& given, const Values& time_s,
                     const Values& x_m, const Rows& slip_rate_m_per_s, const Rows& t_Pa, const Rows& p_Pa,
                     const Values& t_s_Pa, const Values& p_s_Pa, double threshold_m_per_s,
                     double critical_shear_m) {
  const auto& config = given.config();
  const auto history = to_history(time_s, x_m, slip_rate_m_per_s, t_Pa, p_Pa);
  run::InitialState initial;
  initial.subcritical.tractions = to_state(x_m, t_s_Pa, p_s_Pa);
  initial.critical_shear_m = critical_shear_m;
  find_contact(initial.subcritical.tractions, config.loading.edge_margin_m, initial);
  run::Result result;
  result.config = config;
  result.speeds = run::wave_speeds(config.material);
  const auto options = run::front_options(config, initial);
  result.event.record = to_record(history, threshold_m_per_s, options.l_star_m);
  result.fronts = fronts::find_fronts(result.event.record, initial.subcritical.tractions, options);
  return kammer2012::make_outcome(name, result, initial);
}

std::vector<const Outcome*> pointers_to(const std::vector<Outcome>& outcomes) {
  std::vector<const Outcome*> all;
  for (const auto& outcome : outcomes) all.push_back(&outcome);
  return all;
}

kammer2012::Collapse collapse(const std::vector<Outcome>& outcomes, bool without_tails) {
  return kammer2012::collapse(pointers_to(outcomes), without_tails);
}

std::vector<kammer2012::Claim> scorecard(
    const Outcome& spontaneous, const Outcome& left, const Outcome& right, const Outcome& spontaneous_mu_k_1,
    const std::optional<std::pair<std::vector<double>, std::vector<double>>>& experiment) {
  kammer2012::Reproduction runs{spontaneous, left, right, spontaneous_mu_k_1, {}, {}};
  if (experiment) {
    require(experiment->first.size() == experiment->second.size(),
            "the experiment's arrays differ in length");
    runs.experiment = input::Experiment{experiment->first, experiment->second};
  }
  return kammer2012::scorecard(runs);
}

/// A criterion at points of which these are the columns.
Array criterion(kammer2012::Criterion which, const Values& t_s_Pa, const Values& p_s_Pa, const Values& t_d_Pa,
                const Values& p_d_Pa, const Values& U_s_J_per_m3, const Values& U_r_J_per_m3) {
  for (const auto* values : {&p_s_Pa, &t_d_Pa, &p_d_Pa, &U_s_J_per_m3, &U_r_J_per_m3})
    require_length(*values, t_s_Pa.size(), "a column");
  std::vector<double> values;
  values.reserve(t_s_Pa.size());
  for (std::size_t k = 0; k < t_s_Pa.size(); ++k) {
    fronts::FrontPoint point;
    point.t_s_Pa = t_s_Pa(k);
    point.p_s_Pa = p_s_Pa(k);
    point.t_d_Pa = t_d_Pa(k);
    point.p_d_Pa = p_d_Pa(k);
    point.U_s_J_per_m3 = U_s_J_per_m3(k);
    point.U_r_J_per_m3 = U_r_J_per_m3(k);
    values.push_back(kammer2012::criterion_value(point, which));
  }
  return to_array(std::move(values));
}

void bind_collapse(nb::module_& module) {
  using kammer2012::Collapse;
  nb::class_<Collapse::Spreads>(module, "Spreads", "Of V_tip/c_L at equal criterion.")
      .def_ro("cases", &Collapse::Spreads::cases, "between the events")
      .def_ro("fronts", &Collapse::Spreads::fronts, "between all their fronts");
  nb::class_<Collapse>(module, "Collapse", "How well each criterion orders the speeds of a set of events.")
      .def_ro("static_ratio", &Collapse::static_ratio, "against t_s/p_s")
      .def_ro("dynamic_ratio", &Collapse::dynamic_ratio, "against t_d/p_d")
      .def_ro("energy_rise", &Collapse::energy_rise, "against (U_r - U_s)/U_s")
      .def_prop_ro(
          "fit", [](const Collapse& c) { return c.fitted ? std::optional(c.fit) : std::nullopt; },
          "of V_tip/c_L against the energy rise; None below 10 points")
      .def_ro("share_in_paper_band", &Collapse::share_in_paper_band)
      .def_ro("n_points", &Collapse::n_points);
}

void bind_claims(nb::module_& module) {
  using kammer2012::Claim, kammer2012::Figure;
  nb::class_<Figure>(module, "Figure", "A number that a claim states.")
      .def_ro("name", &Figure::name)
      .def_ro("value", &Figure::value, "in the unit given; NaN where undefined")
      .def_ro("unit", &Figure::unit);
  nb::class_<Claim>(module, "Claim", "A claim of Kammer et al. 2012, tested.")
      .def_ro("id", &Claim::id)
      .def_ro("claim", &Claim::claim)
      .def_ro("paper", &Claim::paper, "where it stands")
      .def_ro("measured", &Claim::measured)
      .def_ro("holds", &Claim::holds, "None where it is not tested")
      .def_ro("how", &Claim::how, "the test")
      .def_ro("figures", &Claim::figures, "the numbers of `measured`")
      .def_ro("counts", &Claim::counts, "whether the verdict is the claim's")
      .def_ro("second_test_of", &Claim::second_test_of, "id of the row whose test this one corrects")
      .def_ro("why", &Claim::why, "that row's test misjudges the claim");
}

}  // namespace

void bind_kammer2012(nb::module_& module) {
  nb::enum_<kammer2012::Criterion>(module, "Criterion")
      .value("static_ratio", kammer2012::Criterion::static_ratio)
      .value("dynamic_ratio", kammer2012::Criterion::dynamic_ratio)
      .value("energy_rise", kammer2012::Criterion::energy_rise);
  module.def("criterion", &criterion, "which"_a, "t_s_Pa"_a, "p_s_Pa"_a, "t_d_Pa"_a, "p_d_Pa"_a,
             "U_s_J_per_m3"_a, "U_r_J_per_m3"_a, "A criterion at points of fronts [points].");
  nb::class_<Outcome>(module, "Outcome", "An event, as the claims look at it.")
      .def_ro("name", &Outcome::name)
      .def_ro("fronts", &Outcome::fronts, "those of at least 10 mm")
      .def_ro("peak_x_m", &Outcome::peak_x_m, "of t_s/p_s inside")
      .def_ro("first_onset_x_m", &Outcome::first_onset_x_m, "inside; NaN: none");
  module.def("outcome", &make_outcome, "name"_a, "case"_a, "time_s"_a, "x_m"_a, "slip_rate_m_per_s"_a,
             "t_Pa"_a, "p_Pa"_a, "t_s_Pa"_a, "p_s_Pa"_a, "threshold_m_per_s"_a, "critical_shear_m"_a,
             "An event from a history of its interface and the tractions before it.");
  bind_collapse(module);
  bind_claims(module);
  module.def("collapse", &collapse, "outcomes"_a, "without_tails"_a);
  module.def("scorecard", &scorecard, "spontaneous"_a, "left"_a, "right"_a, "spontaneous_mu_k_1"_a,
             "experiment"_a.none(), "Every claim against four events; what needs studies is not tested.");
}

}  // namespace slipfront::python
