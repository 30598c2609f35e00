// SPDX-License-Identifier: BSD-3-Clause
#include "advice/prediction.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "advice/needs.hpp"
#include "advice/outlook.hpp"
#include "base/caller.hpp"
#include "base/error.hpp"
#include "base/numbers.hpp"
#include "boundary/boundary.hpp"
#include "fracture/static_crack.hpp"
#include "interface/nucleation.hpp"
#include "motion/trigger_zone.hpp"
#include "problem/contact.hpp"
#include "setup/event_loads.hpp"
#include "statics/condensed_interface.hpp"
#include "statics/elastic_body.hpp"

namespace slipfront::advice {

namespace {

/// Limits of a sample, with a dense stiffness of its interface; and of half-spaces, with kernels.
constexpr double most_columns_of_sample = 1500, most_unknowns_of_sample = 1e6,
                 most_columns_of_half_spaces = 2000;
/// Elements over the height of half-spaces, whose bodies do not matter.
constexpr double rows_of_half_spaces = 32;

/// Whether the sample's edges enter: where its far edges are held.
bool is_held(const Problem& problem) {
  return std::ranges::all_of(problem.bodies,
                             [](const auto& body) { return body.plate.top == mesh::Top::loaded; });
}

double columns_of(const mesh::Plate& plate) {
  return std::round(plate.width_m / plate.element_size_m);
}

/// The height in whole elements.
double height_in_elements_m(double height_m, double element_size_m) {
  return std::max(1.0, std::round(height_m / element_size_m)) * element_size_m;
}

/// What elements of this size change the heights of the sample by, over them.
double change_of_heights(const Problem& problem, double element_size_m) {
  double most = 0;
  for (const auto& body : problem.bodies) {
    const double height_m = body.plate.height_m;
    most = std::max(most, std::abs(height_in_elements_m(height_m, element_size_m) / height_m - 1));
  }
  return most;
}

/// The largest number of columns that a prediction takes, and of those near it that which changes heights
/// least.
double fewer_columns(const Problem& problem) {
  const double columns = columns_of(problem.above().plate);
  if (!is_held(problem)) return std::min(columns, most_columns_of_half_spaces);
  const double too_many = 2 * mesh_size(problem).n_nodes / most_unknowns_of_sample;
  if (columns <= most_columns_of_sample && too_many <= 1) return columns;
  const double most = std::max(
      2.0, std::floor(std::min(most_columns_of_sample, columns / std::sqrt(std::max(1.0, too_many)))));
  double best = most;
  for (double n = most; n >= std::max(2.0, 0.5 * most); --n) {
    const double width_m = problem.width_m();
    if (change_of_heights(problem, width_m / n) < (1 - 1e-6) * change_of_heights(problem, width_m / best))
      best = n;
  }
  return best;
}

/// The case in larger elements where it has more of them than a prediction takes.
Problem in_fewer_elements(Problem problem) {
  problem.probes.clear();  // which may lie outside of lower bodies
  const auto& plate = problem.above().plate;
  const double columns = columns_of(plate), fewer = fewer_columns(problem);
  const bool held = is_held(problem);
  if (fewer == columns && held) return problem;
  if (plate.corner != mesh::Corner::none && fewer < columns)
    problem.above().plate.corner = mesh::Corner::none;
  const double h = plate.width_m / fewer;
  for (auto& body : problem.bodies) {
    body.plate.element_size_m = h;
    body.plate.height_m = held ? height_in_elements_m(body.plate.height_m, h) : rows_of_half_spaces * h;
    body.plate.coarsenings = 0;
  }
  problem.time.interface_rows = 1;
  return problem;
}

/// Response of the sample with its far edges held.
fracture::SlipResponse response_of_sample(const Problem& problem, const InitialState& initial) {
  using statics::Factorisation;
  const auto plate = std::make_shared<const Factorisation>(
      statics::ElasticBody{initial.mesh, problem.above().material, problem.above().machine},
      statics::constraint_under_shear(boundary::make_boundary(initial.mesh, problem.above().machine)));
  std::shared_ptr<const Factorisation> base;
  if (initial.base)
    base = std::make_shared<const Factorisation>(
        statics::ElasticBody{*initial.base, problem.below().material}, statics::TopConstraint::both);
  const statics::CondensedInterface interface(plate, base);
  return fracture::response_of_sample(interface.stiffness(), mesh::interface_x_m(initial.mesh),
                                      initial.tributary_m);
}

double at(const std::vector<double>& x_m, const std::vector<double>& values, double x) {
  const auto above = std::ranges::upper_bound(x_m, x);
  if (above == x_m.begin()) return values.front();
  if (above == x_m.end()) return values.back();
  const auto k = static_cast<std::size_t>(above - x_m.begin());
  return record::between(values[k - 1], values[k], (x - x_m[k - 1]) / (x_m[k] - x_m[k - 1]));
}

/// At which laws with a state weaken behind a tip.
constexpr double slip_rate_at_tip_m_per_s = 1;

/// Infinite of friction that does not weaken.
double fracture_energy_J_per_m2(const interface::FrictionLaw& law,
                                const std::optional<interface::StateBreakdown>& of_state, double p_Pa) {
  double over_pressure_m = 0;
  if (of_state) {
    over_pressure_m = of_state->energy_over_pressure_m;
  } else {
    const auto slip_m = interface::weakening_slip_m(law);
    if (!slip_m)
      throw UserError("{} = \"{}\" has no fracture energy of its own; give it by {}", Key("friction.law"),
                      law.name(), for_caller("--fracture-energy", "fracture_energy_J_per_m2"));
    over_pressure_m =
        0.5 * *slip_m * (interface::static_coefficient(law) - interface::kinetic_coefficient(law));
  }
  return over_pressure_m > 0 ? over_pressure_m * p_Pa : infinity;
}

/// The friction law of each node.
struct Laws {
  std::vector<interface::FrictionLaw> of_nodes;  ///< empty where all have that of the case
  const interface::FrictionLaw& of_case;

  Laws(const Problem& problem, const std::vector<double>& x_m, const std::vector<double>& healed)
      : of_nodes(friction_at(problem, x_m, healed)), of_case(problem.friction.law) {}
  const interface::FrictionLaw& operator[](std::size_t k) const {
    return of_nodes.empty() ? of_case : of_nodes[k];
  }
};

/// Fills in what friction does behind a tip.
/// @return the fracture energy, J/m2 [nodes]
std::vector<double> add_friction(const Problem& problem, const Laws& laws, const TipFriction& given,
                                 const record::StaticState& before, fracture::CrackLoads& loads) {
  for (const double c : given.residual_coefficient)
    if (!(c >= 0 && c <= 100))
      throw UserError("{} is {:g}; it must be from 0 to 100",
                      for_caller("--residual-coefficient", "residual_coefficient"), c);
  const bool follows_pressure = interface::follows_pressure(problem.friction.regularisation);
  std::vector<double> energies;
  for (std::size_t k = 0; k < before.x_m.size(); ++k) {
    const auto& law = laws[k];
    const double x_m = before.x_m[k], p_Pa = before.p_s_Pa[k];
    const auto of_state = interface::state_breakdown(law, before.t_s_Pa[k], p_Pa, slip_rate_at_tip_m_per_s);
    energies.push_back(given.fracture_energy_J_per_m2.empty()
                           ? fracture_energy_J_per_m2(law, of_state, p_Pa)
                           : at(given.x_m, given.fracture_energy_J_per_m2, x_m));
    const double residual = !given.residual_coefficient.empty()
                                ? at(given.x_m, given.residual_coefficient, x_m)
                            : of_state ? of_state->residual_coefficient
                                       : interface::kinetic_coefficient(law);
    loads.residual_coefficient.push_back(follows_pressure ? residual : 0);
    loads.cohesion_Pa.push_back(law.cohesion_Pa() + (follows_pressure ? 0 : residual * p_Pa));
  }
  return energies;
}

/// Adds the trigger's tractions, where they stay.
void add_trigger(const Problem& problem, const InitialState& initial, std::vector<double>& t_Pa) {
  if (std::isfinite(problem.start.trigger.duration_s)) return;
  const auto loads = setup::event_loads(problem, initial);
  for (std::size_t k = 0; k < loads.trigger_force_N_per_m.size(); ++k)
    t_Pa[k] += loads.trigger_force_N_per_m[k] / initial.tributary_m[k];
}

struct Patch {
  std::size_t first = 0, last = 0;
};

/// That of the sample, by the linear fall of friction that has its fracture energy.
double nucleation_length_m(const Laws& laws, const fracture::SlipResponse& response,
                           const record::StaticState& before, bool follows_pressure, std::size_t node) {
  std::vector<double> coefficient, weakening_Pa_per_m;
  for (std::size_t k = 0; k < before.x_m.size(); ++k) {
    const auto slip_m = interface::weakening_slip_m(laws[k]);
    if (!slip_m) return nan;
    const double mu_s = interface::static_coefficient(laws[k]);
    coefficient.push_back(follows_pressure ? mu_s : 0);
    weakening_Pa_per_m.push_back((mu_s - interface::kinetic_coefficient(laws[k])) * before.p_s_Pa[k] /
                                 *slip_m);
  }
  return fracture::nucleation_length_m(response, coefficient, weakening_Pa_per_m, node);
}

/// Nodes of the first crack: at a place, the trigger's, or the node that is nearest to its strength.
Patch first_crack(const Problem& problem, const InitialState& initial, const std::optional<double>& x_m) {
  const auto& nodes_x_m = initial.subcritical.tractions.x_m;
  const auto nearest = [&](double x) {
    const auto away = [&](double node_x) { return std::abs(node_x - x); };
    return static_cast<std::size_t>(std::ranges::min_element(nodes_x_m, {}, away) - nodes_x_m.begin());
  };
  if (x_m && !(*x_m >= nodes_x_m.front() && *x_m <= nodes_x_m.back()))
    throw UserError("{} is {:g} m; the interface goes from {:g} to {:g} m", for_caller("--x", "at_x_m"), *x_m,
                    nodes_x_m.front(), nodes_x_m.back());
  if (x_m) return {nearest(*x_m), nearest(*x_m)};
  if (interface::is_at_edge(problem.start.kind)) {
    const auto zone =
        motion::trigger_zone(initial.subcritical, problem.start.kind, problem.start.trigger.zone_m);
    if (!zone.empty()) return {zone.front(), zone.back()};
  }
  if (problem.start.kind == interface::EventKind::nucleation) {
    const auto& n = problem.start.nucleation;
    if (problem.above().plate.sides == mesh::Sides::periodic &&
        std::abs(n.x_m - 0.5 * problem.width_m()) + 0.5 * n.length_m() > 0.5 * problem.width_m())
      throw UserError(
          "{} = {:g} m puts the patch across the seam of a periodic plate, which counts as its ends; "
          "move it to the middle",
          Key("nucleation.x_m"), n.x_m);
    return {nearest(n.x_m - 0.5 * n.length_m()), nearest(n.x_m + 0.5 * n.length_m())};
  }
  const double peak_x_m = initial.subcritical.peak_x_m;
  return {nearest(peak_x_m), nearest(peak_x_m)};
}

/// By which the exponents of slip behind a tip at rest and of stress before it differ from a half, where slip
/// changes the pressure (docs/fracture.md).
double exponent_by_pressure(const fracture::Bodies& bodies, double residual_coefficient) {
  if (stability::are_alike(bodies)) return 0;
  const double N = fracture::moving_stiffness_Pa(bodies, 0, 1).imag();
  return std::atan(std::abs(residual_coefficient * N) / fracture::stiffness_Pa(bodies, 0)) / std::numbers::pi;
}

/// Median strength excess of the nodes that fronts run over; not a number under a law that never sticks.
double median_strength_excess(const Laws& laws, const fracture::CrackLoads& loads,
                              const std::vector<fracture::PredictedFront>& fronts) {
  if (laws[0].never_sticks()) return nan;
  std::vector<double> S;
  for (const auto& front : fronts)
    for (const auto& point : front.points) {
      const auto k = point.node;
      const double p_Pa = loads.p_Pa[k];
      const double residual_Pa = interface::kinetic_coefficient(laws[k]) * p_Pa + laws[k].cohesion_Pa();
      S.push_back(stability::strength_excess(
          {loads.t_Pa[k], interface::static_strength_Pa(laws[k], p_Pa), residual_Pa}));
    }
  return stability::spread_of(std::move(S)).median;
}

/// Empty, or that fronts may pass c_S: those of equal bodies do from a length on, unless the first crack is
/// longer than the critical one (Andrews 1985); of others no formula tells.
std::string doubt_of_speeds(const fracture::Bodies& bodies, const fracture::Prediction& of, double S) {
  if (!(S < stability::supershear_S)) return {};
  const bool starts_critical = !of.starts;
  double longest_m = 0;
  for (const auto& front : of.fronts) longest_m = std::max(longest_m, front.points.back().length_m);
  const double passes_at_m = 2 * stability::supershear_half_length_m(0.5 * of.critical_length_m, S);
  if (stability::are_alike(bodies) && starts_critical && longest_m < passes_at_m) return {};
  return fmt::format(
      "S = {:.3g}, below 1.77, where fronts run: they may pass c_S, where G at rest tells neither speeds nor "
      "arrest",
      S);
}

/// Why fronts may run on where G at rest falls below the fracture energy; empty where nothing speaks against
/// an arrest there.
std::vector<std::string> doubts_of_arrest(const Problem& problem, bool by_law, const std::string& of_speeds) {
  std::vector<std::string> doubts;
  if (problem.start.is_by_force())
    doubts.emplace_back(
        "the trigger's force drives fronts further than the energy release rate at rest tells");
  if (!of_speeds.empty()) doubts.push_back(of_speeds);
  if (problem.friction.law.never_sticks() && by_law)
    doubts.emplace_back("the residual friction depends on the slip rate");
  return doubts;
}

/// What the prediction leaves out.
/// @param residual  coefficient, the largest one
void add_notes(const Problem& given, const Problem& problem, const fracture::Bodies& bodies, double residual,
               bool by_law, bool has_state_before, FracturePrediction& p) {
  const auto absorbs = [](const problem::Body& body) {
    return body.plate.sides != mesh::Sides::free && body.plate.top == mesh::Top::absorbing;
  };
  if (!is_held(problem) && !std::ranges::all_of(problem.bodies, absorbs))
    p.notes.add(
        Diagnostic::physics,
        "edges are left out, the crack is one between half-spaces: of samples with both far edges held alone "
        "they are taken in");
  if (is_held(problem) && problem.above().plate.sides == mesh::Sides::absorbing)
    p.notes.add(Diagnostic::physics, "absorbing sides count as free ones");
  if (const double eps = exponent_by_pressure(bodies, residual); eps != 0)
    p.notes.add(
        Diagnostic::physics,
        "slip changes the pressure: speeds leave it out, and G at rest depends on the element size, by "
        "{:.2g} % for one half as large",
        100 * (std::exp2(2 * eps) - 1));
  if (const double factor = problem.element_size_m() / given.element_size_m(); factor > 1.01) {
    auto note =
        fmt::format("elements are {:.3g} times those of the case, {:.3g} m: what is shorter is smeared",
                    factor, problem.element_size_m());
    if (is_held(problem))
      note += fmt::format("; heights change by {:.2g} %, and G of a strip as much",
                          100 * change_of_heights(given, problem.element_size_m()));
    p.notes.add(Diagnostic::resolution, "{}", note);
  }
  if (problem.above().plate.sides == mesh::Sides::periodic)
    p.notes.add(Diagnostic::physics, "periodic sides count as ends of the contact");
  if (problem.friction.law.never_sticks() && by_law)
    p.notes.add(Diagnostic::physics,
                "fracture energy and residual friction are those of slip at {:g} m/s from the state before "
                "the event on",
                slip_rate_at_tip_m_per_s);
  if (given.is_sequence() && !has_state_before)
    p.notes.add(Diagnostic::physics, "of the first event of the sequence{}",
                given.heals() ? ", before its strength heals" : "");
  if (given.is_by_ramp())
    p.notes.add(Diagnostic::physics, "the state before the event is that of loading.method = direct");
  if (problem.has_growing_tractions())
    p.notes.add(Diagnostic::physics, "tractions that grow count as at the start");
}

}  // namespace

bool has_fracture_energy(const Problem& problem) {
  return problem.friction.law.has_states() || interface::weakening_slip_m(problem.friction.law);
}

FrontPredictor::FrontPredictor(const Problem& given) : given_(given), problem_(in_fewer_elements(given)) {
  if (problem_.is_by_ramp()) problem_.loading.method = statics::LoadingMethod::direct;
  initial_ = setup::make_initial_state(problem_, [](auto, auto) { return true; });
  response_ = std::make_shared<const fracture::SlipResponse>(
      is_held(problem_)
          ? response_of_sample(problem_, initial_)
          : fracture::response_of_half_spaces(materials_of(problem_), initial_.subcritical.tractions.x_m));
}

void FrontPredictor::set_healed(const std::vector<double>& x_m, const std::vector<double>& healed) {
  initial_.healed.clear();
  if (healed.empty()) return;
  for (const double x : initial_.subcritical.tractions.x_m) initial_.healed.push_back(at(x_m, healed, x));
}

FracturePrediction FrontPredictor::predict(const TipFriction& friction, const std::optional<double>& x_m,
                                           const record::StaticState* given_before) const {
  const auto bodies = materials_of(problem_);
  auto before = initial_.subcritical.tractions;
  for (std::size_t k = 0; given_before != nullptr && k < before.x_m.size(); ++k) {
    before.t_s_Pa[k] = at(given_before->x_m, given_before->t_s_Pa, before.x_m[k]);
    before.p_s_Pa[k] = at(given_before->x_m, given_before->p_s_Pa, before.x_m[k]);
  }
  const Laws laws(problem_, before.x_m, initial_.healed);
  FracturePrediction p;
  p.n_nodes = before.x_m.size();
  fracture::CrackLoads loads;
  loads.t_Pa = before.t_s_Pa;
  loads.p_Pa = before.p_s_Pa;
  const auto energies = add_friction(problem_, laws, friction, before, loads);
  add_trigger(problem_, initial_, loads.t_Pa);
  p.bodies = is_held(problem_) ? "the sample, its far edges held" : "half-spaces";
  // To the side to which the load drives the plate.
  double force = 0;
  for (const double t_Pa : loads.t_Pa) force += t_Pa;
  std::optional<fracture::SlipResponse> turned;
  if (force < 0) {
    for (double& t_Pa : loads.t_Pa) t_Pa = -t_Pa;
    turned = *response_;
    turned->p_per_slip *= -1;
  }
  const auto& response = turned ? *turned : *response_;
  if (auto doubt = doubt_of_forced_patch(given_); !x_m && !doubt.empty())
    throw UserError("no fronts to predict: {}; or give {}", doubt, for_caller("--x", "at_x_m"))
        .about("nucleation.front_speed_m_per_s");
  const auto patch = first_crack(problem_, initial_, x_m);
  p.covers_all = patch.first == 0 && patch.last + 1 == p.n_nodes;
  p.nucleation_length_m = nucleation_length_m(laws, response, before,
                                              interface::follows_pressure(problem_.friction.regularisation),
                                              p.covers_all || patch.first == 0 ? patch.first
                                              : patch.last + 1 == p.n_nodes    ? patch.last
                                                                            : (patch.first + patch.last) / 2);
  p.of_fronts =
      fracture::predict(response, loads, energies, patch.first, patch.last, fracture::SpeedLaw(bodies));
  const bool by_law = friction.fracture_energy_J_per_m2.empty();
  add_notes(given_, problem_, bodies, std::ranges::max(loads.residual_coefficient), by_law,
            given_before != nullptr, p);
  const auto& fronts = p.of_fronts.fronts;
  auto of_speeds = doubt_of_speeds(bodies, p.of_fronts, median_strength_excess(laws, loads, fronts));
  if (std::ranges::any_of(fronts, &fracture::PredictedFront::arrests))
    p.doubts_of_arrest = doubts_of_arrest(problem_, by_law, of_speeds);
  if (!p.doubts_of_arrest.empty())
    p.notes.add(Diagnostic::physics, "no arrest is predicted: {}", fmt::join(p.doubts_of_arrest, "; "));
  else if (!of_speeds.empty())
    p.notes.add(Diagnostic::physics, "{}", of_speeds);
  if (auto doubt = doubt_of_beginning(problem_, initial_.subcritical);
      given_before == nullptr && !doubt.empty())
    p.notes.add(Diagnostic::physics, "{}", doubt);
  return p;
}

FracturePrediction predict_fronts(const Problem& problem, const TipFriction& friction,
                                  const std::optional<double>& x_m) {
  return FrontPredictor(problem).predict(friction, x_m);
}

std::optional<FracturePrediction> quick_prediction(const Problem& problem) {
  if (!problem.is_prestressed() || is_held(problem) || problem.start.kind == interface::EventKind::none ||
      problem.above().plate.sides == mesh::Sides::periodic || !has_fracture_energy(problem) ||
      !doubt_of_forced_patch(problem).empty())
    return {};
  return predict_fronts(problem);
}

}  // namespace slipfront::advice
