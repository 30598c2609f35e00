// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "boundary/machine.hpp"
#include "mesh/plate.hpp"
#include "motion/support.hpp"
#include "record/probes.hpp"
#include "statics/prestress.hpp"

namespace slipfront::motion::support {

inline const solid::Material pmma{.youngs_modulus_Pa = 5.6e9,
                                  .poissons_ratio = 0.37,
                                  .density_kg_per_m3 = 1190,
                                  .plane = solid::Plane::strain,
                                  .stiffness_damping_s = 7e-9};
inline const solid::Material gel{.youngs_modulus_Pa = 1.4e9,
                                 .poissons_ratio = 0.30,
                                 .density_kg_per_m3 = 1100,
                                 .plane = solid::Plane::strain,
                                 .stiffness_damping_s = 7e-9};

/// A rupture from a weakened patch under uniform tractions.
struct Problem {
  mesh::Plate plate{.width_m = 0.2, .height_m = 0.03, .element_size_m = 1e-3, .corner = mesh::Corner::none};
  boundary::Machine machine = {};
  bool is_strained = false;  ///< before the event
  const solid::Material* below = nullptr;
  double height_below_m = plate.height_m;
  double stiffness_damping_s = pmma.stiffness_damping_s;
  int coarsenings_below = 0;
  TimeStepping time{.interface_rows = 2, .interface_substeps = 4};
  Execution execution{.halo_stage_bytes = 1};  ///< of the parts; as many stages as there are
  interface::ContactModel contact = paper_law;
  double t_over_p = 1.2;
  double patch = 1.0 / 3;  ///< its middle, in lengths of the plate
  int halo = 3;            ///< nodes around an onset whose tractions are recorded
  std::vector<record::ProbePlace> probes = {{"a", 0.0501, 0.0049}, {"b", 0.1004, 0.0102}};
};

struct Bodies {
  explicit Bodies(const Problem& problem)
      : above(mesh::make_plate(problem.plate)), material(pmma), machine(problem.machine) {
    material.stiffness_damping_s = problem.stiffness_damping_s;
    plates.push_back(problem.plate);
    if (problem.below != nullptr) add_below(problem);
  }
  void add_below(const Problem& problem) {
    auto plate = problem.plate;
    plate.corner = mesh::Corner::none;
    plate.coarsenings = problem.coarsenings_below;
    plate.height_m = problem.height_below_m;
    plates.push_back(plate);
    below = mesh::make_plate(plate);
    material_below = *problem.below;
    material_below.stiffness_damping_s = problem.stiffness_damping_s;
  }
  std::vector<BodySource> sources() const {
    std::vector<BodySource> sources = {{above, material, nullptr, nullptr, machine}};
    if (below) sources.push_back({*below, material_below});
    return sources;
  }
  std::vector<mesh::Plate> plates;
  mesh::Mesh above;
  solid::Material material, material_below;
  boundary::Machine machine;
  std::optional<mesh::Mesh> below;
};

struct Begin {
  int halo = 0;
  statics::Equilibrium state;
  Loads loads;
};

inline constexpr double p_Pa = 5e6;

inline Begin begin_of(const Problem& problem, const Bodies& bodies) {
  const auto n = bodies.above.interface_nodes.size();
  record::StaticState tractions;
  for (const auto node : bodies.above.interface_nodes) tractions.x_m.push_back(bodies.above.x_m[node]);
  for (std::size_t i = 0; i < n; ++i)
    tractions.t_s_Pa.push_back(problem.t_over_p * p_Pa * (1 + 1e-2 * std::sin(0.1 * static_cast<double>(i))));
  tractions.p_s_Pa.assign(n, p_Pa);
  Begin begin{
      problem.halo, statics::prestressed(bodies.above, tractions), {tractions.t_s_Pa, tractions.p_s_Pa}};
  if (bodies.below)
    begin.state.below_u_m = begin.state.below_u_per_shear = solid::Field(bodies.below->n_nodes());
  begin.loads.strength_fraction.assign(n, 1.0);
  if (problem.is_strained) {
    begin.state.u_m = begin.state.u_per_shear = solid::Field(bodies.above.n_nodes());
    for (mesh::Node k = 0; k < bodies.above.n_nodes(); ++k) {
      begin.state.u_m.x[k] = 1e-8 * std::sin(300 * bodies.above.x_m[k] + 100 * bodies.above.y_m[k]);
      begin.state.u_per_shear.x[k] = bodies.above.y_m[k] / problem.plate.height_m;
    }
  }
  const auto middle = static_cast<std::size_t>(problem.patch * static_cast<double>(n));
  for (std::size_t i = middle - 6; i < middle + 6; ++i) begin.loads.strength_fraction[i % n] = 0;
  return begin;
}

/// Three sizes of elements; local steps need the damping.
inline Problem graded() {
  Problem problem;
  problem.plate.coarsenings = problem.coarsenings_below = 2;
  problem.plate.fine_height_m = 4e-3;
  problem.stiffness_damping_s = 1e-7;
  problem.probes = {{"a", 0.0501, 0.0049}, {"b", 0.1004, 0.0102}, {"c", 0.0672, 0.0201}};
  return problem;
}

struct Variant {
  const char* name;
  void (*change)(Problem&);
  std::vector<int> numbers = {2, 3};
};

inline void without_substeps(Problem& p) {
  p.time.interface_substeps = p.time.interface_rows = 1;
}

inline void with_threads(Problem& p) {
  p.plate.height_m = 0.2;
  p.execution.threads = 2;
  without_substeps(p);
}

inline void between_absorbing_edges(Problem& p) {
  p.plate.sides = mesh::Sides::absorbing;
  p.plate.top = mesh::Top::absorbing;
}

/// The rupture passes the sides.
inline void repeating(Problem& p) {
  p.below = &gel;
  p.plate.sides = mesh::Sides::periodic;
  p.plate.top = mesh::Top::absorbing;
  p.patch = 0.97;
}

inline void of_heights(Problem& p, double height_m, double height_below_m) {
  p.below = &pmma;
  p.plate.height_m = height_m;
  p.height_below_m = height_below_m;
  p.probes.clear();
  without_substeps(p);
}

inline void graded_bodies(Problem& p, const solid::Material& below, int coarsenings, int coarsenings_below) {
  p = graded();
  p.below = &below;
  p.plate.width_m = 0.4;
  p.plate.coarsenings = coarsenings;
  p.coarsenings_below = coarsenings_below;
}

inline void repeating_alone(Problem& p) {
  p.plate.sides = mesh::Sides::periodic;
}
inline void pushed(Problem& p) {
  p.machine.pusher = {1e-3, 20e-3};
}
/// By springs in all that a machine may hold.
inline void gripped(Problem& p) {
  p.machine.shear_stiffness_Pa_per_m = 5e12;
  p.machine.normal_stiffness_Pa_per_m = 1e12;
  p.is_strained = true;
}
inline void under_dead_load(Problem& p) {
  p.machine.normal_stiffness_Pa_per_m = 0;
  p.is_strained = true;
}
/// Nodes around an onset: five parts have 40 columns each.
inline constexpr int beyond_a_part = 60;

inline constexpr auto single = Precision::single_precision;
inline constexpr auto predictor_corrector = interface::ContactAlgorithm::predictor_corrector;

inline const Variant variants[] = {
    {"Plain", [](Problem&) {}, {2, 3, 4, 5}},
    {"Strained", [](Problem& p) { p.is_strained = true; }},
    {"Threads", with_threads},
    {"ThreadsSingle", [](Problem& p) { with_threads(p), p.time.precision = single; }},
    {"Relief", [](Problem& p) { p.plate.corner = mesh::Corner::relief; }},
    {"ReliefSingle", [](Problem& p) { p.plate.corner = mesh::Corner::relief, p.time.precision = single; }},
    {"Fillet", [](Problem& p) { p.plate.corner = mesh::Corner::fillet; }},
    {"AbsorbingEdges", between_absorbing_edges},
    {"Pushed", pushed},  // in sub-cycled rows and above
    {"Gripped", gripped},
    {"UnderDeadLoad", under_dead_load},
    {"PushedBySpring", [](Problem& p) { pushed(p), gripped(p); }},
    {"Repeating", repeating, {2, 3, 4}},
    {"TwoBodies", [](Problem& p) { p.below = &gel, p.contact.algorithm = predictor_corrector; }},
    {"LowOnLow", [](Problem& p) { of_heights(p, 7e-3, 6e-3); }, {2}},
    {"LowOnHigh", [](Problem& p) { of_heights(p, 9e-3, 60e-3); }, {2}},
    {"TractionsOfOnsetsAlone", [](Problem& p) { p.halo = 0; }, {2, 5}},
    {"TractionsFarAround", [](Problem& p) { p.halo = beyond_a_part; }, {2, 5}},
    {"RepeatingTractionsOfOnsetsAlone", [](Problem& p) { repeating_alone(p), p.halo = 0; }, {2, 5}},
    {"RepeatingTractionsFarAround", [](Problem& p) { repeating_alone(p), p.halo = beyond_a_part; }, {2, 5}},
    {"Regularised",
     [](Problem& p) {
       p.contact.regularisation = {.relaxed = interface::Relaxed::strength, .time_s = 0.5e-6};
     }},
    {"Graded", [](Problem& p) { p = graded(); }, {2, 3, 4, 5}},
    {"GradedOneStep", [](Problem& p) { p = graded(), p.time.local_steps = false, without_substeps(p); }},
    {"GradedFillet",
     [](Problem& p) {
       p = graded();
       p.plate.corner = mesh::Corner::fillet;
       p.plate.fine_height_m = 9e-3;
       p.plate.coarsenings = 1;
     }},
    {"GradedHalfUnits",
     [](Problem& p) { p = graded(), p.plate.width_m = 0.204, between_absorbing_edges(p); }},
    {"GradedPushed", [](Problem& p) { p = graded(), pushed(p); }},
    {"GradedGripped", [](Problem& p) { p = graded(), gripped(p); }},
    {"GradedPushedBySpring", [](Problem& p) { p = graded(), pushed(p), gripped(p), under_dead_load(p); }},
    {"GradedRepeating", [](Problem& p) { graded_bodies(p, gel, 2, 2), repeating(p); }},
    {"GradedSingle", [](Problem& p) { p = graded(), p.plate.height_m = 0.1, p.time.precision = single; }},
    {"EvenOnGradedOneStep",
     [](Problem& p) { graded_bodies(p, pmma, 0, 2), p.time.local_steps = false; },
     {2}},
    {"GradedOnEven",
     [](Problem& p) { graded_bodies(p, gel, 2, 0), p.contact.algorithm = predictor_corrector; }},
    {"GradedOnMoreGraded",
     [](Problem& p) { graded_bodies(p, gel, 1, 2), p.contact.algorithm = predictor_corrector; }},
};

}  // namespace slipfront::motion::support
