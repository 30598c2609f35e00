// SPDX-License-Identifier: BSD-3-Clause
#include "run/outlook.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "base/numbers.hpp"
#include "input/friction_along_x.hpp"
#include "input/pressure.hpp"
#include "motion/trigger_zone.hpp"
#include "run/choices.hpp"
#include "stability/verdict.hpp"
#include "statics/prestress.hpp"

namespace slipfront::run {
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

/// Nodes in contact inside, t in the direction of the load.
std::vector<Placed> nodes_inside(const input::Case& config, const statics::Equilibrium& state) {
  const auto& s = state.tractions;
  const auto laws = input::friction_at(config, s.x_m);
  double load_Pa = 0;
  for (const double t : s.t_s_Pa) load_Pa += t;
  const double direction = load_Pa < 0 ? -1 : 1;
  std::vector<Placed> nodes;
  for (std::size_t k = 0; k < s.x_m.size(); ++k)
    if (state.is_inside(s.x_m[k]) && s.p_s_Pa[k] > 0)
      nodes.push_back({s.x_m[k], node_before(laws.empty() ? config.friction : laws[k],
                                             direction * s.t_s_Pa[k], s.p_s_Pa[k])});
  return nodes;
}

std::optional<double> trigger_length_m(const input::Case& config) {
  const auto& n = config.nucleation;
  if (interface::is_at_edge(config.event)) return config.trigger.zone_m;
  if (config.event == EventKind::nucleation) return n.length_m();
  return {};
}

/// The largest share of the strength that the patch's overstress brings t to.
double overstressed_share(const input::Case& config, const std::vector<Placed>& nodes) {
  const double period_m = config.plate.sides == mesh::Sides::periodic ? config.plate.width_m : 0;
  double most = 0;
  for (const auto& [x_m, node] : nodes) {
    const double added_Pa =
        config.nucleation.overstress_Pa * interface::nucleation_profile(config.nucleation, x_m, period_m);
    most = std::max(most, std::abs(node.t_Pa + added_Pa) / node.strength_Pa);
  }
  return most;
}

/// None under a law that never sticks.
std::int64_t n_beyond_strength(const std::vector<Placed>& nodes) {
  return std::ranges::count_if(nodes, [](const Placed& placed) {
    return !placed.node.state && placed.node.t_Pa > placed.node.strength_Pa;
  });
}

/// Empty, or that growing tractions come to the strength of no node before the end.
std::string doubt_of_growing_loads(const input::Case& config, const std::vector<Placed>& nodes) {
  const double t_rate = config.prestress.t_rate_Pa_per_s, p_rate = config.prestress.p_rate_Pa_per_s;
  const bool follows_p = interface::follows_pressure(config.regularisation);
  double first_s = infinity;
  for (const auto& [x_m, node] : nodes) {
    const double strength_rate = follows_p ? node.strength_Pa / node.p_Pa * p_rate : 0;
    for (const double direction : {1.0, -1.0}) {
      const double nearer_per_s = direction * t_rate - strength_rate;
      if (nearer_per_s > 0)
        first_s = std::min(first_s, (node.strength_Pa - direction * node.t_Pa) / nearer_per_s);
    }
  }
  if (first_s <= config.time.end_s) return {};
  return std::isfinite(first_s) ? fmt::format(
                                      "growing tractions come to the strength at {:.3g} s, after "
                                      "time.end_s = {:g} s",
                                      first_s, config.time.end_s)
                                : "tractions grow away from the strength at all nodes inside";
}

/// Empty, or why the event does not begin.
std::string doubt_of_beginning(const input::Case& config, const std::vector<Placed>& nodes) {
  const auto n_beyond = n_beyond_strength(nodes);
  if (2 * n_beyond > std::ssize(nodes))
    return fmt::format("t is beyond mu_s p at {} of {} nodes inside: they slip at once, without a front",
                       n_beyond, nodes.size());
  if (nodes.empty() || n_beyond > 0 || nodes.front().node.state) return {};
  if (has_growing_tractions(config)) return doubt_of_growing_loads(config, nodes);
  if (config.event == EventKind::none) return "event.kind = none, and t is below mu_s p at all nodes inside";
  if (input::is_pushed_at_edge(config) && config.trigger.amount < 1)
    return fmt::format("event.trigger_amount = {:g} leaves the traction of the trigger zone below mu_s p",
                       config.trigger.amount);
  if (!input::is_overstressed(config)) return {};
  const double share = overstressed_share(config, nodes);
  if (share >= 1) return {};
  return fmt::format("nucleation.overstress_Pa = {:g} brings t to no more than {:.3g} of mu_s p",
                     config.nucleation.overstress_Pa, share);
}

/// Empty, or that slip stops for want of length.
std::string doubt_of_length(const input::Case& config, const RuptureOutlook& o) {
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
  const double min_m = interface::is_at_edge(config.event) ? 0.5 * critical_m : critical_m;
  if (o.trigger_length_m && *o.trigger_length_m < min_m)
    return fmt::format(
        "the trigger's {:.3g} m are less than the {:.3g} m from which a crack runs (Griffith{}): slip may "
        "stop near them",
        *o.trigger_length_m, min_m, min_m < critical_m ? "; at an edge half the critical length" : "");
  if (critical_m > config.plate.width_m)
    return fmt::format("a crack runs from {:.3g} m on (Griffith), longer than the interface", critical_m);
  return {};
}

/// Why slip that has begun stops.
std::vector<std::string> doubts_of_growth(const input::Case& config, const RuptureOutlook& o) {
  const auto& of = o.of_nodes;
  if (of.n_weakening == 0) return {"friction does not weaken at any node: no rupture feeds itself"};
  if (of.n_driven == 0)
    return {"the residual strength mu_k p is nowhere below t: a rupture finds no energy beyond its trigger"};
  std::vector<std::string> doubts;
  if (of.n_barriers == of.n_nodes)
    doubts.emplace_back("S is beyond 10 at all nodes: no front breaks such strength");
  if (auto doubt = doubt_of_length(config, o); !doubt.empty()) doubts.push_back(std::move(doubt));
  return doubts;
}

std::string caution_of_mesh(double zone_elements, bool may_pass_c_S, bool has_state) {
  const auto is =
      fmt::format("the process zone has {:.3g} elements at rest and fewer in motion", zone_elements);
  if (has_state && may_pass_c_S && zone_elements < elements_for_transition)
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
std::string caution_of_trigger(const input::Case& config, const statics::Equilibrium& before,
                               std::span<const double> tributary_m) {
  if (!input::is_pushed_at_edge(config)) return {};
  const auto zone = motion::trigger_zone(before, config.event, config.trigger.zone_m);
  const double direction = motion::load_direction(before, tributary_m, zone);
  if (direction * statics::contact_force(before, tributary_m).shear_N_per_m >= 0) return {};
  return fmt::format("the trigger acts to {}x, against the shear, as its zone is loaded before the event",
                     direction < 0 ? '-' : '+');
}

void add_cautions(const input::Case& config, RuptureOutlook& o) {
  if (!o.process_zone_elements) return;
  const auto bodies = bodies_of(config);
  if (auto caution = caution_of_mesh(*o.process_zone_elements, may_pass_c_S(bodies, o.of_nodes.S.median),
                                     config.friction.has_state());
      !caution.empty())
    o.cautions.push_back(std::move(caution));
  const double length_m = stability::damping_length_m(bodies);
  const double harmless_m = harmless_damping * *o.of_nodes.process_zone_m;
  const double advised_m = advised_damping_s(config) * stability::slower_c_L_m_per_s(bodies);
  if (length_m > harmless_m)
    o.cautions.push_back(fmt::format(
        "damping: beta_R c_L = {:.3g} m is {:.3g} % of the process zone; beyond 2 % it changes speeds and "
        "whether and where fronts pass c_S; choose {}, or compare with one",
        length_m, 100 * length_m / *o.of_nodes.process_zone_m,
        advised_m > harmless_m ? "a smaller plate.element_size_m, which needs less damping"
                               : "a smaller stiffness_damping_s"));
}

/// Where friction weakens with the rate of steady sliding, in words. @param x_m  of the interface nodes
std::string weakening_along_x(const input::Case& config, const std::vector<double>& x_m,
                              double speed_m_per_s) {
  const auto laws = input::friction_at(config, x_m);
  std::size_t n_weakening = 0;
  std::vector<std::pair<double, double>> stretches_m;
  bool goes_on = false;
  for (std::size_t k = 0; k < x_m.size(); ++k) {
    const auto state = *interface::state_response(laws.empty() ? config.friction : laws[k], speed_m_per_s);
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

/// The same at the slip rate before the event and at 1 m/s, which differ under strong weakening.
std::string steady_sliding(const input::Case& config, const std::vector<double>& x_m) {
  if (!config.friction.has_state()) return {};
  const auto slow = weakening_along_x(config, x_m, 0), fast = weakening_along_x(config, x_m, 1);
  return slow == fast ? slow : fmt::format("{}; at 1 m/s {}", slow, fast);
}

RuptureOutlook outlook_of(const input::Case& config, const std::vector<Placed>& placed,
                          const std::vector<double>& x_m) {
  std::vector<stability::NodeBefore> nodes;
  for (const auto& p : placed) nodes.push_back(p.node);
  RuptureOutlook o;
  o.of_nodes = stability::outlook(bodies_of(config), nodes);
  o.trigger_length_m = trigger_length_m(config);
  if (config.friction.has_state()) o.tip_slip_rate_m_per_s = input::tip_slip_rate_m_per_s(config);
  o.steady_sliding = steady_sliding(config, x_m);
  o.cracks = quick_prediction(config);
  if (o.of_nodes.process_zone_m)
    o.process_zone_elements = *o.of_nodes.process_zone_m / config.plate.element_size_m;
  if (const auto half_m = o.of_nodes.supershear_half_length_m;
      half_m && *half_m > config.plate.width_m && stability::are_alike(bodies_of(config)))
    o.of_nodes.regime += "; that is beyond the interface";
  add_cautions(config, o);
  if (const auto n_beyond = n_beyond_strength(placed); n_beyond > 0 && 2 * n_beyond <= std::ssize(placed))
    o.cautions.push_back(fmt::format("t is beyond mu_s p at {} of {} nodes inside: they slip at once",
                                     n_beyond, placed.size()));
  return o;
}

void add_doubts(const input::Case& config, const std::vector<Placed>& placed, RuptureOutlook& o) {
  if (auto doubt = doubt_of_beginning(config, placed); !doubt.empty()) o.doubts.push_back(std::move(doubt));
  for (auto& doubt : doubts_of_growth(config, o)) o.doubts.push_back(std::move(doubt));
}

}  // namespace

std::string doubt_of_beginning(const input::Case& config, const statics::Equilibrium& before) {
  return doubt_of_beginning(config, nodes_inside(config, before));
}

RuptureOutlook rupture_outlook(const input::Case& config, const statics::Equilibrium& before,
                               std::span<const double> tributary_m) {
  const auto placed = nodes_inside(config, before);
  auto o = outlook_of(config, placed, before.tractions.x_m);
  add_doubts(config, placed, o);
  if (auto caution = caution_of_trigger(config, before, tributary_m); !caution.empty())
    o.cautions.push_back(std::move(caution));
  return o;
}

RuptureOutlook rupture_outlook(const input::Case& config, const Meshes& meshes) {
  if (is_prestressed(config))
    return rupture_outlook(config,
                           statics::prestressed(meshes.plate, prescribed_tractions(config, meshes.plate)),
                           mesh::tributary_lengths_m(meshes.plate));
  const double p_Pa = input::nominal_pressure_Pa(config);
  const double strength_Pa = interface::static_strength_Pa(config.friction, p_Pa);
  auto o =
      outlook_of(config, {{0, node_before(config.friction, strength_Pa, p_Pa)}}, interface_x_m(meshes.plate));
  o.nominal = true;
  // S, and what follows from it, take the tractions along the interface.
  o.of_nodes.S = o.of_nodes.drop_ratio = {nan, nan, nan};
  o.of_nodes.supershear_half_length_m.reset();
  o.of_nodes.regime = "unknown before the statics give the tractions along the interface";
  o.doubts = doubts_of_growth(config, o);
  return o;
}

}  // namespace slipfront::run
