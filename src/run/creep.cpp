// SPDX-License-Identifier: BSD-3-Clause
#include "run/creep.hpp"

#include <algorithm>
#include <cmath>

#include "record/sequence.hpp"
#include "statics/statics.hpp"

namespace slipfront::run {
namespace {

/// Of a node's states.
double change(const interface::QuasiDynamicFriction& friction, std::size_t node,
              const interface::LawStates& states, const interface::LawStates& before) {
  return friction.change(node, [&](std::size_t k) { return states[k][node] - before[k][node]; });
}

double friction(const motion::QuasiDynamicState& state, const std::vector<double>& tributary_m) {
  const auto force = statics::contact_force(state.p_Pa, state.t_Pa, tributary_m);
  return force.shear_N_per_m / force.normal_N_per_m;
}

}  // namespace

bool TurnFinder::see(double value) {
  const double back = direction_ * (extreme_ - value);
  if (back > 0 && back < amount_) return false;
  extreme_ = value;
  if (back <= 0) return false;
  direction_ = -direction_;
  return true;
}

Creep::Creep(const motion::QuasiDynamicSlip& slow, const std::vector<double>& tributary_m)
    : turns_(friction(slow.state(), tributary_m), 0.01 * std::ranges::min(slow.friction().a())) {}

bool Creep::is_row_due(const motion::QuasiDynamicSlip& slow) const {
  if (slow.n_steps() % record::steps_per_slow_row != 0) return false;
  if (n_rows_ < record::all_slow_rows) return true;
  // States have changed by this share of an e-fold slip rate; rates have doubled or halved, of nodes that are
  // not far slower than the fastest: those of nodes that bear little go up and down by some per cent from
  // step to step.
  constexpr double of_state = 0.1, of_rate = 0.5, far_slower = 0.1;
  const auto& state = slow.state();
  const double least_m_per_s = far_slower * state.fastest_m_per_s();
  for (std::size_t k = 0; k < row_V_m_per_s_.size(); ++k) {
    const double V = std::abs(state.slip_rate_m_per_s[k]), row_V = std::abs(row_V_m_per_s_[k]);
    if (state.contact[k] == statics::Contact::stick &&
        (change(slow.friction(), k, state.law_states, row_states_) > of_state ||
         std::abs(V - row_V) > of_rate * std::max({V, row_V, least_m_per_s})))
      return true;
  }
  return false;
}

bool Creep::takes_row(const motion::QuasiDynamicState& state) {
  if (n_rows_ > 0 && last_row_s_ == state.time_s) return false;  // the end is such a step, too
  last_row_s_ = state.time_s;
  row_V_m_per_s_ = state.slip_rate_m_per_s;
  row_states_ = state.law_states;
  ++n_rows_;
  return true;
}

bool Creep::is_loading_row_due(const motion::QuasiDynamicState& state,
                               const std::vector<double>& tributary_m) {
  constexpr double factor = 2;
  const double rate = state.fastest_m_per_s();
  const bool has_turned = turns_.see(friction(state, tributary_m));
  if (!has_turned && rate <= factor * loading_rate_m_per_s_ && rate >= loading_rate_m_per_s_ / factor)
    return false;
  loading_rate_m_per_s_ = rate;
  return true;
}

bool Creep::is_steady(const motion::QuasiDynamicSlip& slow) {
  constexpr double many = 10, least_change = 1e-3;  // of d_c, and of that by which the rate changes e-fold
  const auto& state = slow.state();
  bool has_slipped = !steady_u_x_m_.empty();
  for (std::size_t k = 0; k < steady_u_x_m_.size(); ++k) {
    if (state.contact[k] != statics::Contact::stick) continue;
    if (change(slow.friction(), k, state.law_states, steady_states_) > least_change) {
      steady_u_x_m_.clear();
      break;
    }
    has_slipped =
        has_slipped && std::abs(state.u_x_m[k] - steady_u_x_m_[k]) > many * slow.friction().d_c_m()[k];
  }
  if (!steady_u_x_m_.empty()) return has_slipped;
  steady_u_x_m_ = state.u_x_m;
  steady_states_ = state.law_states;
  return false;
}

}  // namespace slipfront::run
