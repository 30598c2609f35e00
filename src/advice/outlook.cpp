// SPDX-License-Identifier: BSD-3-Clause
#include "advice/outlook.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>

#include "base/numbers.hpp"
#include "motion/trigger_zone.hpp"
#include "problem/contact.hpp"
#include "stability/verdict.hpp"
#include "statics/prestress.hpp"

namespace slipfront::advice {
namespace {

using interface::EventKind;

stability::NodeBefore node_before(const interface::FrictionLaw& law, double t_Pa, double p_Pa) {
  return {t_Pa,
          interface::static_strength_Pa(law, p_Pa),
          interface::kinetic_coefficient(law) * p_Pa + law.cohesion_Pa(),
          interface::weakening_slip_m(law),
          p_Pa,
          interface::state_response(law, 0)};
}

/// A node with its place.
struct Placed {
  double x_m;
  stability::NodeBefore node;
};

/// Nodes in contact inside, and words on them.
struct Inside {
  std::vector<Placed> placed;
  double direction = 1;  ///< of the load along x, in which t of the nodes is
  bool has_cohesion = false;

  const char* t() const { return direction < 0 ? "-t" : "t"; }
  std::string over_pressure(const char* coefficient) const {
    return fmt::format("{}{} p", has_cohesion ? "cohesion_Pa + " : "", coefficient);
  }
  std::string strength() const { return over_pressure("mu_s"); }
  std::int64_t size() const { return std::ssize(placed); }
};

Inside nodes_inside(const Problem& problem, const statics::Equilibrium& state,
                    const std::vector<double>& healed) {
  const auto& s = state.tractions;
  const auto laws = friction_at(problem, s.x_m, healed);
  double load_Pa = 0;
  for (const double t : s.t_s_Pa) load_Pa += t;
  Inside inside;
  inside.direction = load_Pa < 0 ? -1 : 1;
  for (std::size_t k = 0; k < s.x_m.size(); ++k) {
    const auto& law = laws.empty() ? problem.friction.law : laws[k];
    if (!state.is_inside(s.x_m[k]) || !(s.p_s_Pa[k] > 0)) continue;
    inside.placed.push_back({s.x_m[k], node_before(law, inside.direction * s.t_s_Pa[k], s.p_s_Pa[k])});
    inside.has_cohesion = inside.has_cohesion || law.cohesion_Pa() > 0;
  }
  return inside;
}

std::optional<double> trigger_length_m(const Problem& problem) {
  const auto& n = problem.start.nucleation;
  if (interface::is_at_edge(problem.start.kind)) return problem.start.trigger.zone_m;
  if (problem.start.kind == EventKind::nucleation) return n.length_m();
  return {};
}

/// The largest share of the strength that the patch's overstress brings t to.
double overstressed_share(const Problem& problem, const Inside& inside) {
  const double period_m = problem.above().plate.sides == mesh::Sides::periodic ? problem.width_m() : 0;
  double most = 0;
  for (const auto& [x_m, node] : inside.placed) {
    const double added_Pa = inside.direction * problem.start.nucleation.overstress_Pa *
                            interface::nucleation_profile(problem.start.nucleation, x_m, period_m);
    most = std::max(most, std::abs(node.t_Pa + added_Pa) / node.strength_Pa);
  }
  return most;
}

/// None under a law that never sticks.
std::int64_t n_beyond_strength(const Inside& inside) {
  return std::ranges::count_if(inside.placed, [](const Placed& placed) {
    return !placed.node.state && placed.node.t_Pa > placed.node.strength_Pa;
  });
}

/// Empty, or that growing tractions come to the strength of no node before the end.
std::string doubt_of_growing_loads(const Problem& problem, const Inside& inside) {
  const double t_rate = inside.direction * problem.prestress->t_rate_Pa_per_s;
  const double p_rate = problem.prestress->p_rate_Pa_per_s;
  const bool follows_p = interface::follows_pressure(problem.friction.regularisation);
  double first_s = infinity;
  for (const auto& [x_m, node] : inside.placed) {
    const double strength_rate = follows_p ? node.strength_Pa / node.p_Pa * p_rate : 0;
    for (const double direction : {1.0, -1.0}) {
      const double nearer_per_s = direction * t_rate - strength_rate;
      if (nearer_per_s > 0)
        first_s = std::min(first_s, (node.strength_Pa - direction * node.t_Pa) / nearer_per_s);
    }
  }
  if (first_s <= problem.time.end_s) return {};
  return std::isfinite(first_s) ? fmt::format(
                                      "growing tractions come to the strength at {:.3g} s, after "
                                      "time.end_s = {:g} s",
                                      first_s, problem.time.end_s)
                                : "tractions grow away from the strength at all nodes inside";
}

/// Empty, or why an overstress begins nothing, or nothing that the load drives on.
std::string doubt_of_overstress(const Problem& problem, const Inside& inside) {
  const double overstress_Pa = problem.start.nucleation.overstress_Pa,
               share = overstressed_share(problem, inside);
  const bool is_against = inside.direction * overstress_Pa < 0 &&
                          std::ranges::any_of(inside.placed, [](const Placed& p) { return p.node.t_Pa > 0; });
  if (share < 1)
    return fmt::format("nucleation.overstress_Pa = {:g}{} brings {} to no more than {:.3g} of {}",
                       overstress_Pa, is_against ? ", which acts against t," : "", inside.t(), share,
                       inside.strength());
  if (!is_against) return {};
  return fmt::format(
      "nucleation.overstress_Pa = {:g} acts against t: slip begins against the load, which does not drive it "
      "on",
      overstress_Pa);
}

/// Empty, or why the event does not begin.
std::string doubt_of_beginning(const Problem& problem, const Inside& inside) {
  const auto n_beyond = n_beyond_strength(inside);
  if (2 * n_beyond > inside.size())
    return fmt::format("{} is beyond {} at {} of {} nodes inside: they slip at once, without a front",
                       inside.t(), inside.strength(), n_beyond, inside.size());
  if (inside.placed.empty() || n_beyond > 0 || inside.placed.front().node.state) return {};
  if (problem.has_growing_tractions()) return doubt_of_growing_loads(problem, inside);
  if (problem.start.kind == EventKind::none)
    return fmt::format("event.kind = none, and {} is below {} at all nodes inside", inside.t(),
                       inside.strength());
  if (problem.start.pushes_edge() && problem.start.trigger.amount < 1)
    return fmt::format("{} = {:g} leaves the traction of the trigger zone below {}; 1 just reaches it",
                       problem.start.trigger_key(), problem.start.trigger.amount, inside.strength());
  return problem.start.overstresses() ? doubt_of_overstress(problem, inside) : std::string();
}

/// Empty, or that slip stops for want of length.
std::string doubt_of_length(const Problem& problem, const RuptureOutlook& o) {
  if (o.cracks) {
    const auto& cracks = o.cracks->of_fronts;
    if (cracks.starts || o.cracks->covers_all) return {};
    if (std::isnan(cracks.critical_length_m))
      return fmt::format("no crack from the first one, {:.3g} m, runs, however long: slip may stop near it",
                         cracks.first_length_m);
    return fmt::format(
        "the first crack, {:.3g} m, is shorter than the {:.3g} m from which it runs: slip may stop near it",
        cracks.first_length_m, cracks.critical_length_m);
  }
  const auto& of = o.of_nodes;
  if (!of.griffith_half_length_m) return {};
  const double critical_m = 2 * *of.griffith_half_length_m;
  // At a free edge half a crack does.
  const double min_m = interface::is_at_edge(problem.start.kind) ? 0.5 * critical_m : critical_m;
  if (o.trigger_length_m && *o.trigger_length_m < min_m)
    return fmt::format(
        "the trigger's {:.3g} m are less than the {:.3g} m from which a crack runs (Griffith{}): slip may "
        "stop near them",
        *o.trigger_length_m, min_m, min_m < critical_m ? "; at an edge half the critical length" : "");
  if (critical_m > problem.width_m())
    return fmt::format("a crack runs from {:.3g} m on (Griffith), longer than the interface", critical_m);
  return {};
}

/// Why slip that has begun stops.
std::vector<std::string> doubts_of_growth(const Problem& problem, const Inside& inside,
                                          const RuptureOutlook& o) {
  const auto& of = o.of_nodes;
  if (of.n_weakening == 0) return {"friction does not weaken at any node: no rupture feeds itself"};
  if (of.n_driven == 0)
    return {fmt::format(
        "the residual strength {} is nowhere below {}: a rupture finds no energy beyond its trigger",
        inside.over_pressure("mu_k"), inside.t())};
  std::vector<std::string> doubts;
  if (of.n_barriers == of.n_nodes)
    doubts.emplace_back("S is beyond 10 at all nodes: no front breaks such strength");
  if (auto doubt = doubt_of_length(problem, o); !doubt.empty()) doubts.push_back(std::move(doubt));
  return doubts;
}

std::string note_on_mesh(double zone_elements, bool may_pass_c_S, bool never_sticks, bool nominal) {
  const auto is = fmt::format("the process zone has {:.3g} elements at rest and fewer in motion{}",
                              zone_elements, nominal ? ", under the nominal pressure" : "");
  if (never_sticks && may_pass_c_S && zone_elements < elements_for_transition)
    return is +
           "; below 16 the mesh may decide whether fronts pass c_S, the outcome and not its digits alone: "
           "compare with half the plate.element_size_m";
  if (zone_elements < fewest_elements) return is + "; below 3 the mesh decides on fronts and their speeds";
  if (zone_elements < elements_for_peaks) return is + "; peaks of slip rate and traction need 6";
  if (zone_elements < elements_for_transition && may_pass_c_S)
    return is + "; the place where fronts pass c_S, where S < 1.77, needs 16";
  return {};
}

/// Empty, or that the trigger's force acts against the shear.
std::string note_on_trigger(const Problem& problem, const statics::Equilibrium& before,
                            std::span<const double> tributary_m) {
  if (!problem.start.pushes_edge()) return {};
  const auto zone = motion::trigger_zone(before, problem.start.kind, problem.start.trigger.zone_m);
  const double direction = motion::load_direction(before, tributary_m, zone);
  if (direction * statics::contact_force(before, tributary_m).shear_N_per_m >= 0) return {};
  return fmt::format("the trigger acts to {}x, against the shear, as its zone is loaded before the event",
                     direction < 0 ? '-' : '+');
}

void add_notes(const Problem& problem, RuptureOutlook& o) {
  if (!o.process_zone_elements) return;
  const auto bodies = materials_of(problem);
  if (auto note = note_on_mesh(*o.process_zone_elements, may_pass_c_S(bodies, o.of_nodes.S.median),
                               problem.friction.law.never_sticks(), o.nominal);
      !note.empty())
    o.notes.add(Diagnostic::resolution, "{}", note);
  const double length_m = stability::damping_length_m(bodies);
  const double harmless_m = harmless_damping * *o.of_nodes.process_zone_m;
  const double advised_m = advised_damping_s(problem) * stability::slower_c_L_m_per_s(bodies);
  if (length_m > harmless_m)
    o.notes.add(
        Diagnostic::resolution,
        "damping: beta_R c_L = {:.3g} m is {:.3g} % of the process zone; beyond 2 % it changes speeds and "
        "whether and where fronts pass c_S; choose {}, or compare with one",
        length_m, 100 * length_m / *o.of_nodes.process_zone_m,
        advised_m > harmless_m ? "a smaller plate.element_size_m, which needs less damping"
                               : "a smaller stiffness_damping_s");
}

/// How far the place holds where fronts pass c_S, which is that of a nucleation of the critical length.
void add_to_regime(const Problem& problem, RuptureOutlook& o) {
  auto& of = o.of_nodes;
  if (!of.supershear_half_length_m || !std::isfinite(*of.supershear_half_length_m)) return;
  constexpr double longer = 1.1;
  const double triggers = o.trigger_length_m.value_or(0) / (2 * *of.griffith_half_length_m) *
                          (interface::is_at_edge(problem.start.kind) ? 2 : 1);
  if (triggers > longer)
    of.regime += fmt::format(
        "; the trigger has {:.2g} times the critical length: no formula tells by how much sooner", triggers);
  else if (*of.supershear_half_length_m > problem.width_m() && stability::are_alike(materials_of(problem)))
    of.regime += "; that is beyond the interface";
}

/// Where friction weakens with the rate of steady sliding, in words. @param x_m  of the interface nodes
std::string weakening_along_x(const Problem& problem, const std::vector<double>& x_m, double speed_m_per_s) {
  const auto laws = friction_at(problem, x_m);
  std::size_t n_weakening = 0;
  std::vector<std::pair<double, double>> stretches_m;
  bool goes_on = false;
  for (std::size_t k = 0; k < x_m.size(); ++k) {
    const auto state =
        *interface::state_response(laws.empty() ? problem.friction.law : laws[k], speed_m_per_s);
    constexpr double rounding = 1e-9;
    const bool weakens = state.b > (1 + rounding) * state.a;
    if (weakens && !goes_on) stretches_m.emplace_back(x_m[k], x_m[k]);
    if (weakens) stretches_m.back().second = x_m[k];
    n_weakening += weakens ? 1 : 0;
    goes_on = weakens;
  }
  if (n_weakening == 0) return "velocity strengthening (a >= b) everywhere";
  if (n_weakening == x_m.size()) return "velocity weakening (b > a) everywhere";
  constexpr std::size_t few = 4;
  std::string where;
  for (const auto& [from_m, to_m] : stretches_m)
    where += fmt::format("{}{:.4g} .. {:.4g}", where.empty() ? "over " : ", ", from_m, to_m);
  where += " m";
  if (stretches_m.size() > few) where = fmt::format("at {} of {} nodes", n_weakening, x_m.size());
  return fmt::format("velocity weakening (b > a) {}, strengthening elsewhere", where);
}

/// Weakening along x at the slip rate before the event and at 1 m/s, which differ under strong weakening.
std::string steady_sliding(const Problem& problem, const std::vector<double>& x_m) {
  if (!problem.friction.law.has_states()) return {};
  const auto slow = weakening_along_x(problem, x_m, 0), fast = weakening_along_x(problem, x_m, 1);
  return slow == fast ? slow : fmt::format("{}; at 1 m/s {}", slow, fast);
}

RuptureOutlook outlook_of(const Problem& problem, const Inside& inside, const std::vector<double>& x_m,
                          bool nominal) {
  std::vector<stability::NodeBefore> nodes;
  for (const auto& p : inside.placed) nodes.push_back(p.node);
  RuptureOutlook o;
  o.nominal = nominal;
  o.of_nodes = stability::outlook(materials_of(problem), nodes);
  if (o.of_nodes.nucleation_length_m && problem.friction.law.never_sticks() &&
      problem.friction.law.name() != std::string_view("rate_and_state_aging"))
    o.of_nodes.nucleation_length_m = nan;  // Rubin and Ampuero's is that of the aging law with one state
  o.trigger_length_m = trigger_length_m(problem);
  if (problem.friction.law.never_sticks()) o.tip_slip_rate_m_per_s = tip_slip_rate_m_per_s(problem);
  o.steady_sliding = steady_sliding(problem, x_m);
  o.cracks = quick_prediction(problem);
  if (o.of_nodes.process_zone_m)
    o.process_zone_elements = *o.of_nodes.process_zone_m / problem.element_size_m();
  add_to_regime(problem, o);
  add_notes(problem, o);
  if (const auto n_beyond = n_beyond_strength(inside); n_beyond > 0 && 2 * n_beyond <= inside.size())
    o.notes.add(Diagnostic::physics, "{} is beyond {} at {} of {} nodes inside: they slip at once",
                inside.t(), inside.strength(), n_beyond, inside.size());
  return o;
}

/// Adds doubts by tractions that are known.
void add_doubts(const Problem& problem, const Inside& inside, RuptureOutlook& o) {
  for (auto doubt : {doubt_of_beginning(problem, inside), doubt_of_forced_patch(problem)})
    if (!doubt.empty()) o.doubts.push_back(std::move(doubt));
  for (auto& doubt : doubts_of_growth(problem, inside, o)) o.doubts.push_back(std::move(doubt));
}

}  // namespace

double advised_damping_s(const Problem& problem) {
  const double least_s = stability::damping_of_grid_waves_s(
      materials_of(problem), problem.friction.law, problem.friction.regularisation, problem.element_size_m());
  if (least_s == 0) return 0;
  const double digit_s = std::pow(10, std::floor(std::log10(least_s)) - 2);
  return digit_s * std::ceil((1 - 1e-9) * least_s / digit_s);
}

std::string doubt_of_beginning(const Problem& problem, const statics::Equilibrium& before) {
  return doubt_of_beginning(problem, nodes_inside(problem, before, {}));
}

std::string doubt_of_forced_patch(const Problem& problem) {
  const auto& n = problem.start.nucleation;
  if (!problem.start.is_forced()) return {};
  const double whole_s = n.half_length_m / n.front_speed_m_per_s + n.weakening_time_s;
  if (whole_s <= problem.time.end_s) return {};
  return fmt::format(
      "nucleation.front_speed_m_per_s = {:g}: the forced patch is not of nucleation.half_length_m = {:g} m "
      "before {:.3g} s, time.end_s is {:.3g} s; is the speed in m/s?",
      n.front_speed_m_per_s, n.half_length_m, whole_s, problem.time.end_s);
}

RuptureOutlook rupture_outlook(const Problem& problem, const statics::Equilibrium& before,
                               std::span<const double> tributary_m, const std::vector<double>& healed) {
  const auto inside = nodes_inside(problem, before, healed);
  auto o = outlook_of(problem, inside, before.tractions.x_m, false);
  add_doubts(problem, inside, o);
  if (const auto note = note_on_trigger(problem, before, tributary_m); !note.empty())
    o.notes.add(Diagnostic::physics, "{}", note);
  return o;
}

RuptureOutlook rupture_outlook(const Problem& problem, const setup::Meshes& meshes) {
  const auto x_m = mesh::interface_x_m(meshes.plate);
  if (problem.is_prestressed())
    return rupture_outlook(problem, statics::prestressed(meshes.plate, prescribed_tractions(problem, x_m)),
                           mesh::tributary_lengths_m(meshes.plate));
  const double p_Pa = nominal_pressure_Pa(problem);
  const double strength_Pa = interface::static_strength_Pa(problem.friction.law, p_Pa);
  Inside inside;
  inside.placed = {{0, node_before(problem.friction.law, strength_Pa, p_Pa)}};
  inside.has_cohesion = problem.friction.law.cohesion_Pa() > 0;
  auto o = outlook_of(problem, inside, x_m, true);
  // S, and what follows from it, take the tractions along the interface.
  o.of_nodes.S = o.of_nodes.drop_ratio = {nan, nan, nan};
  o.of_nodes.supershear_half_length_m.reset();
  o.of_nodes.regime = "unknown before the statics give the tractions along the interface";
  if (auto doubt = doubt_of_forced_patch(problem); !doubt.empty()) o.doubts.push_back(std::move(doubt));
  for (auto& doubt : doubts_of_growth(problem, inside, o)) o.doubts.push_back(std::move(doubt));
  return o;
}

}  // namespace slipfront::advice
