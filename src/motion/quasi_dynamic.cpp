// SPDX-License-Identifier: BSD-3-Clause
#include "motion/quasi_dynamic.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "base/state.hpp"

namespace slipfront::motion {

namespace {

/// Error of ln V by the states', and of slip over d_c, in a step.
constexpr double accuracy = 1e-5;
/// Slip over d_c by which a change of contact, which a step makes at its end, may come too late.
constexpr double late = 1e-3;

}  // namespace

double light_pressure_Pa(const std::vector<double>& p_Pa, const std::vector<double>& tributary_m) {
  constexpr double share = 0.01;
  double force_N_per_m = 0, length_m = 0;
  for (std::size_t i = 0; i < tributary_m.size(); ++i) {
    force_N_per_m += p_Pa[i] * tributary_m[i];
    length_m += tributary_m[i];
  }
  return share * force_N_per_m / length_m;
}

double QuasiDynamicState::fastest_m_per_s() const {
  double fastest = 0;
  for (const double V : slip_rate_m_per_s) fastest = std::max(fastest, std::abs(V));
  return fastest;
}

QuasiDynamicSlip::QuasiDynamicSlip(const statics::Statics& statics, interface::QuasiDynamicFriction friction,
                                   std::vector<double> tributary_m, double edge_speed_m_per_s)
    : statics_(statics),
      friction_(std::move(friction)),
      tributary_m_(std::move(tributary_m)),
      edge_speed_m_per_s_(edge_speed_m_per_s) {
  const auto resize = [&](Rates& rates) {
    rates.u_x.resize(tributary_m_.size());
    rates.law_states = friction_.initial_states();
  };
  resize(rates_);
  for (auto& rates : stages_) resize(rates);
}

void QuasiDynamicSlip::balance(QuasiDynamicState& state, Rates& rates) const {
  bodies_->equilibrate(state.shear_m, state.u_x_m, state.t_Pa, state.p_Pa, state.gap_m);
  slide(state, rates);
}

void QuasiDynamicSlip::slide(QuasiDynamicState& state, Rates& rates) const {
  constexpr double part = 1e-5;  // of a step: rates hardly change, and rounding counts for little
  friction_.balance(state.t_Pa, state.p_Pa, state.law_states, part * next_dt_s_, state.slip_rate_m_per_s,
                    rates.law_states);
  rates.u_x = state.slip_rate_m_per_s;
}

double QuasiDynamicSlip::first_dt_s() const {
  // Where nothing slips yet, as if slip followed the load.
  constexpr double slowest_m_per_s = 1e-30;
  const double speed_m_per_s =
      std::max({now_.fastest_m_per_s(), std::abs(edge_speed_m_per_s_), slowest_m_per_s});
  return accuracy * std::ranges::min(friction_.d_c_m()) / speed_m_per_s;
}

void QuasiDynamicSlip::start(double time_s, double shear_m, std::vector<statics::Contact> contact,
                             std::vector<double> u_x_m, interface::LawStates law_states) {
  const std::vector<double> none(tributary_m_.size());
  now_ = {time_s, shear_m, std::move(u_x_m),  std::move(law_states), none, none,
          none,   none,    std::move(contact)};
  for (auto& state : now_.contact)
    if (state == statics::Contact::slip) state = statics::Contact::stick;
  bodies_ = statics_.sliding(now_.contact);
  works_ = {};
  n_steps_ = 0;
  next_dt_s_ = first_dt_s();
  balance(now_, rates_);
  light_Pa_ = light_pressure_Pa(now_.p_Pa, tributary_m_);
  settle_contact(now_, rates_);
  next_dt_s_ = first_dt_s();  // now that slip rates are known
  slide(now_, rates_);
  // Rates by differences hold over times in which states change little.
  const auto largest_change = [&] {
    double largest = 0;
    for (std::size_t i = 0; i < tributary_m_.size(); ++i)
      largest = std::max(
          largest, friction_.change(i, [&](std::size_t k) { return rates_.law_states[k][i] * next_dt_s_; }));
    return largest;
  };
  while (friction_.takes_differences() && largest_change() > 1) {
    next_dt_s_ *= 0.1;
    slide(now_, rates_);
  }
}

void QuasiDynamicSlip::restored() {
  const std::size_t n = tributary_m_.size();
  const auto is_of = [&](const auto&... values) { return ((values.size() == n) && ...); };
  const auto are_of = [&](const interface::LawStates& states) {
    return states.size() == friction_.initial_states().size() &&
           std::ranges::all_of(states, [&](const auto& values) { return is_of(values); });
  };
  require_possible(
      is_of(now_.u_x_m, now_.slip_rate_m_per_s, now_.t_Pa, now_.p_Pa, now_.gap_m, now_.contact, rates_.u_x) &&
          are_of(now_.law_states) && are_of(rates_.law_states) && next_dt_s_ > 0 &&
          std::ranges::all_of(now_.contact, [](auto contact) { return contact <= statics::Contact::open; }),
      "slow slip");
  bodies_ = statics_.sliding(now_.contact);
}

bool QuasiDynamicSlip::slip_until(double end_s, double slip_rate_m_per_s,
                                  const std::function<bool()>& after_step) {
  constexpr double beyond = 1.1;
  while (now_.time_s < end_s) {
    if (now_.fastest_m_per_s() >= slip_rate_m_per_s) return true;
    if (now_.time_s + next_dt_s_ == now_.time_s)
      throw UserError(
          "the time step of slow slip fell below rounding {:.6g} s after normal loading; choose a faster "
          "load ({}), "
          "or a smaller {}",
          now_.time_s, Key("loading.shear_speed_m_per_s"), Key("sequence.inertia_slip_rate_m_per_s"));
    const double remaining_s = end_s - now_.time_s;
    const bool is_last = next_dt_s_ >= remaining_s;
    const double taken_s = try_step(std::min(next_dt_s_, remaining_s));
    if (taken_s == 0) {
      slide(now_, rates_);  // over a shorter time
      continue;
    }
    if (next_.fastest_m_per_s() > beyond * slip_rate_m_per_s) {
      next_dt_s_ = 0.5 * taken_s;
      continue;
    }
    if (is_last) next_.time_s = end_s;
    const auto works = works_;
    add_works(now_, next_);
    if (taken_s * settle_contact(next_, stages_.back()) > late) {
      works_ = works;
      bodies_ = statics_.sliding(now_.contact);
      next_dt_s_ = 0.5 * taken_s;
      slide(now_, rates_);
      continue;
    }
    std::swap(now_, next_);
    std::swap(rates_, stages_.back());
    ++n_steps_;
    if (!after_step()) return false;
  }
  return false;
}

double QuasiDynamicSlip::settle_contact(QuasiDynamicState& state, Rates& rates) {
  constexpr int most = 100;
  const auto contact = state.contact;
  const auto rate_m_per_s = state.slip_rate_m_per_s;
  for (int i = 0; i < most; ++i) {
    if (!correct_contact(state)) {
      double change_per_s = 0;
      for (std::size_t k = 0; k < contact.size(); ++k)
        if (contact[k] == statics::Contact::stick && state.contact[k] == contact[k])
          change_per_s = std::max(
              change_per_s, std::abs(state.slip_rate_m_per_s[k] - rate_m_per_s[k]) / friction_.d_c_m()[k]);
      return change_per_s;
    }
    const auto before = state;
    bodies_ = statics_.sliding(state.contact);
    balance(state, rates);
    add_works(before, state);
  }
  throw UserError(
      "{:.6g} s after normal loading contact at the interface does not settle; press the bodies harder",
      state.time_s);
}

bool QuasiDynamicSlip::correct_contact(QuasiDynamicState& state) const {
  using statics::Contact;
  // Tension over the largest pressure, and overlap over the slip in which psi changes, that count.
  constexpr double tension = 1e-9, overlap = 1e-6;
  const double least_p_Pa = -tension * std::ranges::max(state.p_Pa);
  bool changed = false;
  for (std::size_t i = 0; i < state.contact.size(); ++i) {
    const double p_Pa = state.p_Pa[i];
    auto& contact = state.contact[i];
    const auto before = contact;
    if (contact == Contact::open)
      contact = state.gap_m[i] < -overlap * friction_.d_c_m()[i] ? Contact::slip : Contact::open;
    else if (p_Pa < least_p_Pa)
      contact = Contact::open;
    else if (p_Pa < (contact == Contact::slip ? 2 : 1) * light_Pa_)
      contact = Contact::slip;
    else
      contact = Contact::stick;
    changed = changed || contact != before;
  }
  return changed;
}

double QuasiDynamicSlip::try_step(double dt_s) {
  const std::size_t n = tributary_m_.size();
  // The stages' rates: now, at a half, at three quarters, and at the end, where the next step begins.
  Rates &k2 = stages_[0], &k3 = stages_[1], &k4 = stages_[2];
  const auto& k1 = rates_;
  const auto slip = [](const Rates& r) -> const std::vector<double>& { return r.u_x; };
  const auto of_state = [](std::size_t k) {
    return [k](const Rates& r) -> const std::vector<double>& { return r.law_states[k]; };
  };
  next_ = now_;
  const auto go = [&](double share, const auto& sum, Rates& rates) {
    const auto moved = [&](const std::vector<double>& from, const auto& of, std::vector<double>& to) {
      for (std::size_t i = 0; i < n; ++i) to[i] = from[i] + dt_s * sum(of, i);
    };
    next_.time_s = now_.time_s + share * dt_s;
    next_.shear_m = now_.shear_m + edge_speed_m_per_s_ * share * dt_s;
    moved(now_.u_x_m, slip, next_.u_x_m);
    for (std::size_t k = 0; k < now_.law_states.size(); ++k)
      moved(now_.law_states[k], of_state(k), next_.law_states[k]);
    balance(next_, rates);
  };
  go(
      0.5, [&](const auto& p, std::size_t i) { return 0.5 * p(k1)[i]; }, k2);
  go(
      0.75, [&](const auto& p, std::size_t i) { return 0.75 * p(k2)[i]; }, k3);
  go(
      1, [&](const auto& p, std::size_t i) { return (2 * p(k1)[i] + 3 * p(k2)[i] + 4 * p(k3)[i]) / 9; }, k4);
  double error = 0;
  const auto of_pair = [&](const auto& p, std::size_t i) {
    return dt_s * std::abs(-5 * p(k1)[i] / 72 + p(k2)[i] / 12 + p(k3)[i] / 9 - p(k4)[i] / 8);
  };
  for (std::size_t i = 0; i < n; ++i) {
    if (now_.contact[i] != statics::Contact::stick) continue;
    const double of_states = friction_.change(i, [&](std::size_t k) { return of_pair(of_state(k), i); });
    error = std::max({error, of_states, of_pair(slip, i) / friction_.d_c_m()[i]});
  }
  if (!std::isfinite(error)) {
    next_dt_s_ = 0.1 * dt_s;
    return 0;
  }
  error /= accuracy;
  constexpr double safety = 0.9, least = 0.2, most = 5;
  const double factor = error > 0 ? std::clamp(safety * std::pow(error, -1.0 / 3), least, most) : most;
  next_dt_s_ = factor * dt_s;
  return error > 1 ? 0 : dt_s;
}

void QuasiDynamicSlip::add_works(const QuasiDynamicState& from, const QuasiDynamicState& to) {
  double force_N_per_m = 0;
  for (std::size_t i = 0; i < tributary_m_.size(); ++i) {
    const double half_m = 0.5 * tributary_m_[i], eta = friction_.radiation_damping_Pa_s_per_m();
    const double t = half_m * (from.t_Pa[i] + to.t_Pa[i]);
    const double slip_m = to.u_x_m[i] - from.u_x_m[i];
    const double radiated = half_m * eta * (from.slip_rate_m_per_s[i] + to.slip_rate_m_per_s[i]) * slip_m;
    force_N_per_m += t;
    works_.of_friction_J_per_m -= t * slip_m - radiated;
    works_.radiated_J_per_m += radiated;
    works_.of_contact_J_per_m += half_m * (from.p_Pa[i] + to.p_Pa[i]) * (to.gap_m[i] - from.gap_m[i]);
  }
  works_.of_load_J_per_m += force_N_per_m * (to.shear_m - from.shear_m);
}

}  // namespace slipfront::motion
