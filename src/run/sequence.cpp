// SPDX-License-Identifier: BSD-3-Clause
#include "run/sequence.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "run/begin.hpp"
#include "run/choices.hpp"

namespace slipfront::run {

namespace {

statics::Statics statics_of(const input::Case& config, const InitialState& initial,
                            const motion::Monitor& monitor) {
  std::optional<statics::ElasticBody> base;
  if (initial.base) base.emplace(statics::ElasticBody{*initial.base, input::base_material(config)});
  const auto of = ratios_at_rest(config, initial.mu_s);
  std::vector<double> mu_s;
  for (std::size_t k = 0; k < initial.tributary_m.size(); ++k) mu_s.push_back(of[k]);
  return {{initial.mesh, config.material}, base, config.loading, std::move(mu_s),
          interface::static_coefficient_key(config.friction), [monitor] { return monitor(0, 0); }};
}

}  // namespace

Rest rest_of(const motion::Snapshot& snapshot, const InitialState& initial, double shear_m) {
  Rest rest{.shear_m = shear_m, .contact = {}, .u_x_m = {}};
  const auto& u = snapshot.u_m;
  double u_max = 0;
  for (const double u_y : u.y) u_max = std::max(u_max, std::abs(u_y));
  for (std::size_t k = 0; k < initial.mesh.interface_nodes.size(); ++k) {
    const auto n = initial.mesh.interface_nodes[k];
    double u_x = u.x[n], gap = initial.mesh.y_m[n] + u.y[n];
    if (initial.base) {
      const auto m = initial.base->interface_nodes[k];
      const auto below = static_cast<std::size_t>(initial.mesh.n_nodes() + m);
      u_x -= u.x[below];
      gap += initial.base->y_m[m] - u.y[below];
    }
    constexpr double rounding = 1e-9;
    rest.contact.push_back(gap > rounding * u_max ? statics::Contact::open : statics::Contact::stick);
    rest.u_x_m.push_back(u_x);
  }
  return rest;
}

Sequence::Sequence(const input::Case& config, const motion::Monitor& monitor)
    : config_(config),
      initial_(make_initial_state(config, monitor)),
      statics_(statics_of(config_, initial_, monitor)) {}

statics::Equilibrium Sequence::hold(const Rest& rest) {
  statics_.hold(rest.contact, rest.u_x_m);
  shear_m_ = rest.shear_m;
  return statics_.shear_by(shear_m_);
}

const InitialState& Sequence::next() {
  const double margin = config_.loading.critical_margin;
  const auto at_least = [&](double share) {
    auto state = statics_.shear_to(share);
    return state.shear_m > shear_m_ ? std::move(state) : statics_.shear_by(shear_m_);
  };
  initial_.common = at_least(1 - margin);
  initial_.spontaneous = at_least(1 + margin);
  initial_.critical_shear_m = statics_.shear_to(1).shear_m;
  return initial_;
}

}  // namespace slipfront::run
