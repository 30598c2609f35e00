// SPDX-License-Identifier: BSD-3-Clause
#include "papers/kammer2012/cases.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

#include "base/numbers.hpp"

namespace slipfront::kammer2012 {

namespace {

constexpr double width_m = 0.2;
/// All fronts have crossed the plate; the top goes on driving what slips.
constexpr double end_s = 250e-6;

/// The paper gives no triggers. These lie in the middle of those that satisfy what it says of fronts and of
/// the wave ahead of the left one: papers/kammer2012/open-choices.md.
constexpr interface::Trigger left_trigger = {
    .zone_m = 16e-3, .amount = 42, .ramp_s = 0.43e-6, .duration_s = 3.2e-6};
constexpr interface::Trigger right_trigger = {
    .zone_m = 8.4e-3, .amount = 8, .ramp_s = 0.61e-6, .duration_s = 1.8e-6};

input::Case base_case(interface::EventKind event, bool quick) {
  input::Case c;  // the other defaults are the paper's
  c.event = event;
  c.time.end_s = end_s;
  if (event == interface::EventKind::left) c.trigger = left_trigger;
  if (event == interface::EventKind::right) c.trigger = right_trigger;
  c.plate.element_size_m = quick ? 2e-3 : 6.6666666666666667e-4;
  return c;
}

using Change = std::function<void(input::Case&)>;

/// The events of one study point: the paper's with one change, at a history spacing that keeps their files
/// small.
StudyPoint make_point(std::string value, double number, bool quick,
                      const std::vector<interface::EventKind>& events, const Change& change) {
  StudyPoint point{std::move(value), number, {}};
  for (const auto event : events) {
    input::Case c = base_case(event, quick);
    c.output.history_interval_s = 2e-6;
    change(c);
    const char* name = event == interface::EventKind::left    ? "left"
                       : event == interface::EventKind::right ? "right"
                                                              : "spontaneous";
    c.title = fmt::format("{}, {}", name, point.value);
    point.cases.push_back({name, c});
  }
  return point;
}

}  // namespace

std::vector<NamedCase> paper_cases(bool quick) {
  using enum interface::EventKind;
  std::vector<NamedCase> cases = {{"spontaneous", base_case(spontaneous, quick)},
                                  {"left", base_case(left, quick)},
                                  {"right", base_case(right, quick)},
                                  {"spontaneous_mu_k_1.0", base_case(spontaneous, quick)}};
  cases[3].config.friction.parameter("mu_k") = 1.0;
  const std::vector<std::string> titles = {"spontaneous, mu_k = 0.6", "triggered on the left, mu_k = 0.6",
                                           "triggered on the right, mu_k = 0.6", "spontaneous, mu_k = 1.0"};
  for (std::size_t k = 0; k < cases.size(); ++k) {
    cases[k].config.title = titles[k];
    // The wave ahead of the left front (C25) is looked for every 5 us.
    const bool is_left = cases[k].config.event == left;
    for (int t = 1; t <= (is_left ? 40 : 20); ++t)
      cases[k].config.output.snapshot_times_s.push_back(is_left ? t / 2e5 : t / 1e5);
  }
  return cases;
}

std::vector<NamedCase> sequences(bool quick) {
  std::vector<NamedCase> cases;
  for (const double mu_k : {0.6, 1.0}) {
    auto c = base_case(interface::EventKind::spontaneous, quick);
    c.title = fmt::format("loaded on to global sliding, mu_k = {:.1f}", mu_k);
    c.friction.parameter("mu_k") = mu_k;
    c.loading.shear_speed_over_c_L = 1e-9;
    c.sequence.max_events = 1000;
    c.sequence.to_global_sliding = true;
    c.time.quiet_s = 0.45e-3;  // a period of shear waves between interface and top edge
    c.time.end_s = 10e-3;
    c.output.history_interval_s = 2e-6;
    cases.push_back({fmt::format("mu_k_{:.1f}", mu_k), c});
  }
  return cases;
}

namespace {

using interface::EventKind;

const std::vector<EventKind> all_events = {EventKind::spontaneous, EventKind::left, EventKind::right};
const std::vector<EventKind> triggered_events = {EventKind::left, EventKind::right};
/// A study over the values of a key.
struct Sweep {
  const char *name, *key, *why;
  std::vector<double> values;
  std::function<void(input::Case&, double)> set;
};

Study make_study(const Sweep& sweep, const std::vector<EventKind>& events, bool quick) {
  Study study{sweep.name, sweep.key, sweep.why, {}};
  for (const double value : sweep.values)
    study.points.push_back(make_point(fmt::format("{:g}", value), value, quick, events,
                                      [&](input::Case& c) { sweep.set(c, value); }));
  return study;
}

std::vector<Study> make_studies(const std::vector<Sweep>& sweeps, const std::vector<EventKind>& events,
                                bool quick) {
  std::vector<Study> list;
  for (const auto& sweep : sweeps) list.push_back(make_study(sweep, events, quick));
  return list;
}

/// Over element sizes, each named by three digits of it.
Study make_mesh_study(const char* name, const char* why, const std::vector<int>& columns, bool quick,
                      const Change& change) {
  Study study{name, "plate.element_size_m", why, {}};
  for (const int n : columns)
    study.points.push_back(
        make_point(fmt::format("{:.3g}", width_m / n), width_m / n, quick, all_events, [&](input::Case& c) {
          c.plate.element_size_m = width_m / n;
          change(c);
        }));
  return study;
}

std::vector<Study> friction_studies(bool quick) {
  const std::vector<Sweep> sweeps = {
      {"mu_k",
       "friction.mu_k",
       "kind of slip (C20, C21)",
       {0.4, 0.6, 0.8, 1.0, 1.1, 1.2},
       [](input::Case& c, double v) { c.friction.parameter("mu_k") = v; }},
      {"alpha",
       "friction.alpha_m2_per_s2",
       "speed of fronts (C22)",
       {0.01, 0.03, 0.1, 0.3, 1},
       [](input::Case& c, double v) { c.friction.parameter("alpha_m2_per_s2") = v; }}};
  return make_studies(sweeps, all_events, quick);
}

Study mesh_study(bool quick) {
  return make_mesh_study("element_size", "dependence on the mesh",
                         quick ? std::vector<int>{50, 100} : std::vector<int>{300, 200, 150, 100}, quick,
                         [](input::Case&) {});
}

std::vector<Study> step_and_damping_studies() {
  const std::vector<Sweep> sweeps = {
      {"substeps",
       "time.interface_substeps",
       "dependence on the time step at the interface",
       {1, 3, 9, 18, 36, 72},
       [](input::Case& c, double v) { c.time.interface_substeps = static_cast<int>(v); }},
      {"damping",
       "material.stiffness_damping_s",
       "dependence on the damping",
       {0.05e-6, 0.1e-6, 0.2e-6, 0.4e-6},
       [](input::Case& c, double v) { c.material.stiffness_damping_s = v; }}};
  return make_studies(sweeps, all_events, false);
}

Study corner_study() {
  Study corner{"corner", "plate.corner", "rounding of the corners, not given in the paper", {}};
  const auto add = [&](std::string value, double number, const Change& change) {
    corner.points.push_back(make_point(std::move(value), number, false, all_events, change));
  };
  add("relief", nan, [](input::Case&) {});
  add("none", nan, [](input::Case& c) { c.plate.corner = mesh::Corner::none; });
  for (const double radius : {2e-3, 5e-3, 10e-3})
    add(fmt::format("fillet_{:g}mm", radius * 1e3), radius, [&](input::Case& c) {
      c.plate.corner = mesh::Corner::fillet;
      c.plate.fillet_radius_m = radius;
    });
  return corner;
}

Study top_study() {
  Study top{"top", "loading.top_during_tilt", "top edge held or free along x while it is tilted", {}};
  top.points.push_back(make_point("held", nan, false, all_events, [](input::Case&) {}));
  top.points.push_back(make_point("free", nan, false, all_events, [](input::Case& c) {
    c.loading.top_during_tilt = statics::TopEdge::free;
  }));
  return top;
}

std::vector<Study> trigger_studies() {
  const auto amount = [](const char* name, std::vector<double> values) {
    return Sweep{name, "event.trigger_amount", "strength of the trigger", std::move(values),
                 [](input::Case& c, double v) { c.trigger.amount = v; }};
  };
  // The pressure has its peak at the right edge: more than 20 tears it off the plane.
  std::vector<Study> list = {make_study(amount("left_amount", {5, 10, 20, 40, 80}), {EventKind::left}, false),
                             make_study(amount("right_amount", {2, 5, 10, 20}), {EventKind::right}, false)};
  const std::vector<Sweep> sweeps = {{"trigger_zone",
                                      "event.trigger_zone_m",
                                      "length of the trigger zone",
                                      {5e-3, 10e-3, 15e-3, 20e-3},
                                      [](input::Case& c, double v) { c.trigger.zone_m = v; }},
                                     {"trigger_ramp",
                                      "event.trigger_ramp_s",
                                      "rise time of the trigger",
                                      {0.1e-6, 0.5e-6, 1.5e-6},
                                      [](input::Case& c, double v) { c.trigger.ramp_s = v; }},
                                     {"trigger_duration",
                                      "event.trigger_duration_s",
                                      "how long the trigger lasts",
                                      {2e-6, 5e-6, 15e-6, infinity},
                                      [](input::Case& c, double v) { c.trigger.duration_s = v; }}};
  std::ranges::move(make_studies(sweeps, triggered_events, false), std::back_inserter(list));
  return list;
}

Study speed_length_study() {
  return make_study({"l_star",
                     "fronts.l_star_m",
                     "length over which speed and tractions are taken",
                     {0.67e-3, 1.33e-3, 2.67e-3, 5.33e-3},
                     [](input::Case& c, double v) { c.fronts.l_star_m = v; }},
                    all_events, false);
}

/// The ramp takes a third of a second of physical time: elements of 2 mm.
Study loading_method_study() {
  Study method{"loading_method",
               "loading.method",
               "critical state by equilibria or by the explicit ramp, elements of 2 mm",
               {}};
  method.own_reference = true;
  for (const auto& [word, value] :
       {std::pair{"direct", statics::LoadingMethod::direct}, {"ramp", statics::LoadingMethod::ramp}})
    method.points.push_back(
        make_point(word, nan, false, {EventKind::spontaneous}, [m = value](input::Case& c) {
          c.plate.element_size_m = width_m / 100;
          c.loading.method = m;
        }));
  return method;
}

void add_all(std::vector<Study>& list, std::vector<Study> more) {
  std::ranges::move(more, std::back_inserter(list));
}

}  // namespace

std::vector<Study> studies(bool quick) {
  std::vector<Study> list = friction_studies(quick);
  list.push_back(mesh_study(quick));
  if (quick) return list;
  add_all(list, step_and_damping_studies());
  list.push_back(corner_study());
  list.push_back(top_study());
  add_all(list, trigger_studies());
  list.push_back(speed_length_study());
  list.push_back(loading_method_study());
  return list;
}

std::vector<Variation> variations(bool quick) {
  const auto make = [&](const char* name, const char* key, double value, const Change& change) {
    Variation variation{name, key, value, paper_cases(quick), {}};
    const auto vary = [&](input::Case& c) {
      change(c);
      c.title += fmt::format(", {} = {:g}", key, value);
    };
    for (auto& c : variation.events) {
      if (c.config.event != interface::EventKind::left) c.config.output.snapshot_times_s.clear();
      vary(c.config);
    }
    for (auto& study : studies(quick)) {
      if (std::ranges::find(scorecard_studies, study.name) == scorecard_studies.end()) continue;
      for (auto& point : study.points)
        for (auto& c : point.cases) vary(c.config);
      variation.studies.push_back(std::move(study));
    }
    return variation;
  };
  const double element_size_m = quick ? 4e-3 : 1e-3;
  const int substeps = input::Case{}.time.interface_substeps / 2;
  return {make("mesh", "plate.element_size_m", element_size_m,
               [=](input::Case& c) { c.plate.element_size_m = element_size_m; }),
          make("step", "time.interface_substeps", substeps,
               [=](input::Case& c) { c.time.interface_substeps = substeps; })};
}

namespace {

using interface::Relaxed;

Change delayed(Relaxed what, double time_s) {
  return [=](input::Case& c) {
    c.regularisation.relaxed = what;
    c.regularisation.time_s = time_s;
  };
}

std::vector<Study> regularised_mesh_studies() {
  std::vector<Study> list;
  const auto add = [&](const char* name, const char* why, const Change& change) {
    list.push_back(make_mesh_study(name, why, {600, 300, 150, 100}, false, change));
    list.back().own_reference = true;
  };
  add("element_size", "the paper's law, without a length scale", [](input::Case&) {});
  add("element_size_strength", "strength relaxed over 0.5 us", delayed(Relaxed::strength, 0.5e-6));
  add("element_size_pressure", "pressure relaxed over 0.5 us", delayed(Relaxed::pressure, 0.5e-6));
  add("element_size_undamped", "strength relaxed over 0.5 us, no bulk damping", [](input::Case& c) {
    delayed(Relaxed::strength, 0.5e-6)(c);
    c.material.stiffness_damping_s = 0;
  });
  return list;
}

Study relaxation_time_study(const char* name, const char* why, Relaxed what) {
  Study study = make_study({name,
                            "friction.relaxation_time_s",
                            why,
                            {0.02e-6, 0.05e-6, 0.1e-6, 0.2e-6, 0.5e-6, 1e-6, 2e-6},
                            [what](input::Case& c, double v) { delayed(what, v)(c); }},
                           all_events, false);
  study.own_reference = true;
  return study;
}

Study relaxation_length_study() {
  Study study = make_study({"relaxation_length_strength",
                            "friction.relaxation_length_m",
                            "strength relaxed at the rate (|v| + 0.1 m/s)/L",
                            {0.01e-6, 0.03e-6, 0.1e-6, 0.3e-6, 1e-6, 3e-6},
                            [](input::Case& c, double v) {
                              c.regularisation = {Relaxed::strength, v, 0.1, infinity};
                            }},
                           all_events, false);
  study.own_reference = true;
  return study;
}

}  // namespace

std::vector<Study> regularised_studies() {
  std::vector<Study> list = regularised_mesh_studies();
  list.push_back(relaxation_time_study("relaxation_time_strength", "strength relaxed at a constant rate",
                                       Relaxed::strength));
  list.push_back(relaxation_time_study("relaxation_time_pressure", "pressure relaxed at a constant rate",
                                       Relaxed::pressure));
  list.push_back(relaxation_length_study());
  return list;
}

}  // namespace slipfront::kammer2012
