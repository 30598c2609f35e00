// SPDX-License-Identifier: BSD-3-Clause
#include "stability/rupture.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/numbers.hpp"

namespace slipfront::stability {

namespace {

double drop_ratio_of(const NodeBefore& node) {
  return std::max(0., (node.t_Pa - node.residual_Pa) / (node.strength_Pa - node.residual_Pa));
}

bool weakens(const NodeBefore& node) {
  return node.residual_Pa < node.strength_Pa;
}
bool is_driven(const NodeBefore& node) {
  return node.residual_Pa < node.t_Pa;
}

/// Medians of a length over the nodes that weaken and have what it takes.
template <class Has, class Length>
std::optional<double> median_length_m(const std::vector<NodeBefore>& nodes, Has has, Length length_m) {
  std::vector<double> lengths_m;
  for (const auto& node : nodes)
    if (weakens(node) && (node.*has)) lengths_m.push_back(length_m(node));
  if (lengths_m.empty()) return {};
  const double median = spread_of(lengths_m).median;
  return std::isfinite(median) ? std::optional(median) : std::nullopt;
}

/// On both sides of the interface.
enum class Pair { equal, unlike, rigid };

Pair pair_of(const Bodies& bodies) {
  if (!bodies.below) return Pair::rigid;
  return are_alike(bodies) ? Pair::equal : Pair::unlike;
}

/// Andrews's transition is that of equal bodies without damping.
std::string supershear_regime(double half_length_m, Pair pair) {
  auto text = fmt::format(
      "S < 1.77: fronts above c_S can form, {}about {:.2g} m from a nucleation of the critical length on, "
      "sooner from a longer one",
      pair == Pair::equal ? "without damping " : "between equal bodies ", half_length_m);
  if (pair == Pair::rigid) return text + "; on a rigid plane much earlier";
  if (pair == Pair::unlike) return text + "; between these no formula says where, often much earlier";
  return text;
}

std::string regime_of(const Outlook& o, Pair pair) {
  if (o.n_weakening == 0) return "none: friction does not weaken at any node";
  if (o.n_driven == 0)
    return "none: the residual strength is nowhere below t, a front would release no energy";
  if (o.n_barriers == o.n_nodes) return "none: S is beyond 10 at all nodes, no front breaks such strength";
  if (o.S.median < 0) return "none: t is beyond the strength at most nodes, they slip at once";
  if (!o.nucleation_length_m)
    return o.S.median < supershear_S
               ? "S < 1.77, as for fronts above c_S; without a length in the law no transition can be "
                 "predicted"
               : "S > 1.77, as for fronts below the Rayleigh speed; the law has no length";
  if (o.S.median < supershear_S)
    return supershear_regime(o.supershear_half_length_m.value_or(infinity), pair);
  if (pair == Pair::equal) return "sub-Rayleigh: S > 1.77";
  return fmt::format(
      "S > 1.77: between equal bodies fronts stay below the Rayleigh speed; {} they can pass "
      "c_S all the same",
      pair == Pair::rigid ? "on a rigid plane" : "between unlike ones");
}

}  // namespace

double modulus_Pa(const Bodies& bodies) {
  const auto c = compliance(bodies, 1, 0);
  return -2 * solid::shear_modulus_Pa(bodies.above) * (c.yy / c.determinant).real();
}

double nucleation_length_m(double modulus_Pa, double strength_drop_Pa, double d_c_m) {
  return 1.158 * modulus_Pa * d_c_m / strength_drop_Pa;
}

double unstable_wavelength_m(double modulus_Pa, const interface::StateResponse& state, double pressure_Pa) {
  if (state.b <= state.a) return infinity;
  return std::numbers::pi * modulus_Pa * state.d_c_m / ((state.b - state.a) * pressure_Pa);
}

double nucleation_length_m(double modulus_Pa, const interface::StateResponse& state, double pressure_Pa) {
  if (state.b <= state.a) return infinity;
  const double L_b_m = modulus_Pa * state.d_c_m / (state.b * pressure_Pa), ratio = state.a / state.b;
  return ratio < 0.3781 ? 2 * 1.3774 * L_b_m : 2 * L_b_m / (std::numbers::pi * (1 - ratio) * (1 - ratio));
}

double griffith_half_length_m(double modulus_Pa, double strength_drop_Pa, double d_c_m,
                              double stress_drop_Pa) {
  if (stress_drop_Pa <= 0) return infinity;
  return modulus_Pa * strength_drop_Pa * d_c_m / (std::numbers::pi * stress_drop_Pa * stress_drop_Pa);
}

double process_zone_m(double modulus_Pa, double strength_drop_Pa, double d_c_m) {
  return 9 * std::numbers::pi / 32 * modulus_Pa * d_c_m / strength_drop_Pa;
}

double supershear_half_length_m(double griffith_half_length_m, double S) {
  if (S >= supershear_S) return infinity;
  return 9.8 * std::pow(supershear_S - S, -3) * griffith_half_length_m;
}

double strength_excess(const NodeBefore& node) {
  if (!is_driven(node)) return infinity;
  return (node.strength_Pa - node.t_Pa) / (node.t_Pa - node.residual_Pa);
}

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {nan, nan, nan};
  std::ranges::sort(values);
  const std::size_t n = values.size();
  const double low = values[(n - 1) / 2], high = values[n / 2];
  return {values.front(), low == high ? low : 0.5 * (low + high), values.back()};
}

namespace {

/// S is not defined: the strength at a tip depends on its slip rate.
void set_lengths_of_state(const std::vector<NodeBefore>& nodes, Outlook& o) {
  const auto median = [&](auto length_m) {
    return median_length_m(nodes, &NodeBefore::state,
                           [&](const NodeBefore& n) { return length_m(o.modulus_Pa, *n.state, n.p_Pa); });
  };
  using State = interface::StateResponse;
  o.nucleation_length_m =
      median([](double mu, const State& s, double p) { return nucleation_length_m(mu, s, p); });
  o.process_zone_m = median([](double mu, const State& s, double p) {
    return s.breakdown_per_m > 0 ? process_zone_m(mu, s.breakdown_per_m * p, 1) : infinity;
  });
  o.unstable_wavelength_m = median(unstable_wavelength_m);
  o.regime = o.n_weakening > 0 ? "unknown: the strength at a tip depends on its slip rate"
                               : "none: friction does not weaken at any node";
}

}  // namespace

Outlook outlook(const Bodies& bodies, const std::vector<NodeBefore>& all) {
  Outlook o;
  o.n_nodes = all.size();
  o.n_weakening = static_cast<std::size_t>(std::ranges::count_if(all, weakens));
  o.n_driven = static_cast<std::size_t>(std::ranges::count_if(all, is_driven));
  o.modulus_Pa = modulus_Pa(bodies);
  if (!all.empty() && all.front().state) {
    set_lengths_of_state(all, o);
    return o;
  }
  auto nodes = all;
  std::erase_if(nodes, [](const NodeBefore& node) { return strength_excess(node) > barrier_S; });
  o.n_barriers = all.size() - nodes.size();
  if (nodes.empty()) nodes = all;
  std::vector<double> S, ratio;
  for (const auto& node : nodes) {
    S.push_back(strength_excess(node));
    if (weakens(node)) ratio.push_back(drop_ratio_of(node));
  }
  o.S = spread_of(S);
  o.drop_ratio = spread_of(ratio);
  const auto drop_Pa = [](const NodeBefore& node) { return node.strength_Pa - node.residual_Pa; };
  o.nucleation_length_m = median_length_m(nodes, &NodeBefore::d_c_m, [&](const NodeBefore& node) {
    return nucleation_length_m(o.modulus_Pa, drop_Pa(node), *node.d_c_m);
  });
  o.process_zone_m = median_length_m(nodes, &NodeBefore::d_c_m, [&](const NodeBefore& node) {
    return process_zone_m(o.modulus_Pa, drop_Pa(node), *node.d_c_m);
  });
  o.griffith_half_length_m = median_length_m(nodes, &NodeBefore::d_c_m, [&](const NodeBefore& node) {
    return griffith_half_length_m(o.modulus_Pa, drop_Pa(node), *node.d_c_m, node.t_Pa - node.residual_Pa);
  });
  if (o.griffith_half_length_m && o.S.median < supershear_S)
    o.supershear_half_length_m = supershear_half_length_m(*o.griffith_half_length_m, o.S.median);
  o.regime = regime_of(o, pair_of(bodies));
  return o;
}

}  // namespace slipfront::stability
