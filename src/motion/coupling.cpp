// SPDX-License-Identifier: BSD-3-Clause
#include "motion/coupling.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "boundary/dashpot.hpp"
#include "motion/orientation.hpp"

namespace slipfront::motion {

Coupling::Coupling(const interface::ContactModel& contact, std::vector<ContactBody> bodies)
    : contact_(contact),
      interface_(bodies.front().side->nodes.size(), contact.law.states()),
      breakdown_(interface_.size()),
      tributary_m_(bodies.front().side->tributary_m),
      v_x_before_(interface_.size()),
      v_y_before_(interface_.size()),
      v_x_trial_(interface_.size()),
      v_y_trial_(interface_.size()),
      start_u_x_m_(interface_.size()),
      own_begin_(static_cast<std::size_t>(bodies.front().side->own.begin)),
      own_end_(static_cast<std::size_t>(bodies.front().side->own.end)) {
  // Effective masses along x and y of each body.
  std::vector<std::vector<double>> mass_x, mass_y;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto& side = *bodies[b].side;
    SLIPFRONT_ASSERT(side.nodes.size() == interface_.size(), "interfaces of different nodes");
    auto x = side.mass_kg;
    auto y = x;
    for (const auto& dashpot : side.dashpots) {
      x[dashpot.at] *= 1 + dashpot.d_x;
      y[dashpot.at] *= 1 + dashpot.d_y;
    }
    mass_x.push_back(std::move(x));
    mass_y.push_back(std::move(y));
    for (std::size_t i = 0; i < interface_.size(); ++i) interface_.initial_gap_m[i] += side.y_m[i];
    const std::vector<double> ones(interface_.size(), 1), zeros(interface_.size(), 0);
    sides_.push_back({bodies[b], sign_of_body(b), ones, ones, zeros});
  }
  contact_mass_kg_ = mass_y.front();
  if (!is_pair()) {
    const auto& side = *above().side;
    for (std::size_t i = 0; i < interface_.size(); ++i)
      interface_.mass_per_length_kg_m2[i] = side.mass_kg[i] / tributary_m_[i];
    for (const auto& dashpot : side.dashpots) {
      interface_.mass_per_length_kg_m2[dashpot.at] *= 1 + dashpot.d_y;
      interface_.tangential_mass_ratio[dashpot.at] = (1 + dashpot.d_x) / (1 + dashpot.d_y);
    }
    return;
  }
  const auto of_pair = [](double a, double b) { return a * b / (a + b); };
  for (std::size_t s = 0; s < 2; ++s) {
    auto& side = sides_[s];
    side.v_x = side.v_y = side.v_x_before = side.v_y_before = side.shift_m;
    for (std::size_t i = 0; i < interface_.size(); ++i) {
      side.share_x[i] = mass_x[1 - s][i] / (mass_x[0][i] + mass_x[1][i]);
      side.share_y[i] = mass_y[1 - s][i] / (mass_y[0][i] + mass_y[1][i]);
    }
  }
  for (std::size_t i = 0; i < interface_.size(); ++i) {
    contact_mass_kg_[i] = of_pair(mass_y[0][i], mass_y[1][i]);
    interface_.mass_per_length_kg_m2[i] = contact_mass_kg_[i] / tributary_m_[i];
    interface_.tangential_mass_ratio[i] = of_pair(mass_x[0][i], mass_x[1][i]) / contact_mass_kg_[i];
  }
}

double Coupling::relative_u_x_m(std::size_t i) const {
  const double above_m = sides_[0].body.u_m(i).x;
  return is_pair() ? above_m - sides_[1].body.u_m(i).x : above_m;
}

double Coupling::relative_u_y_m(std::size_t i) const {
  const double above_m = sides_[0].body.u_m(i).y;
  return is_pair() ? above_m + sides_[1].body.u_m(i).y : above_m;
}

void Coupling::take_velocities(Side& side) {
  const auto to = velocities(side);
  for (const auto& run : side.body.side->runs) {
    std::copy_n(&side.body.v->x[run.first], run.count, &to.x[run.at]);
    std::copy_n(&side.body.v->y[run.first], run.count, &to.y[run.at]);
  }
}

void Coupling::set_relative_motion() {
  if (is_pair()) {
    for (std::size_t i = 0; i < interface_.size(); ++i) {
      interface_.v_x_m_per_s[i] = v_x_trial_[i] = sides_[0].v_x[i] - sides_[1].v_x[i];
      interface_.v_y_m_per_s[i] = sides_[0].v_y[i] + sides_[1].v_y[i];
      interface_.u_y_m[i] = relative_u_y_m(i);
    }
  } else {
    for (const auto& run : above().side->runs)
      std::copy_n(&above().u->y[run.first], run.count, &interface_.u_y_m[run.at]);
  }
  std::ranges::copy(interface_.v_y_m_per_s, v_y_trial_.begin());
}

void Coupling::start(const statics::Equilibrium& equilibrium, Loads loads) {
  for (auto& side : sides_) take_velocities(side);
  set_relative_motion();
  for (std::size_t i = 0; i < interface_.size(); ++i) {
    start_u_x_m_[i] = relative_u_x_m(i);
    interface_.slip_rate_m_per_s[i] = interface_.v_x_m_per_s[i];
    interface_.t_Pa[i] = equilibrium.tractions.t_s_Pa[i];
    interface_.p_Pa[i] = equilibrium.tractions.p_s_Pa[i];
    interface_.slipping[i] = equilibrium.contact[i] == statics::Contact::slip;
    if (interface_.slipping[i] != 0) breakdown_.leave_out(i);
  }
  std::ranges::fill(interface_.strength_fraction, 1.0);
  start_contact(contact_, interface_);
  if (!loads.law_states.empty()) interface_.law_states = loads.law_states;
  // A patch that is weakened now loses its strength at the rate of the regularisation.
  set_loads(std::move(loads));
}

void Coupling::set_loads(Loads loads) {
  loads_ = std::move(loads);
  loads_.trigger_force_N_per_m.resize(interface_.size(), 0.0);
  SLIPFRONT_ASSERT(loads_.strength_fraction.empty() || loads_.strength_fraction.size() == interface_.size(),
                   "strength_fraction of other nodes");
  loads_.strength_fraction.resize(interface_.size(), 1.0);
  interface_.strength_fraction = loads_.strength_fraction;
  interface_.is_time_weakening = !loads_.weakens_at_s.empty();
  trigger_nodes_.clear();
  weakening_nodes_.clear();
  for (std::size_t i = 0; i < interface_.size(); ++i) {
    if (loads_.trigger_force_N_per_m[i] != 0 || unloading_N_per_m(i) != 0) trigger_nodes_.push_back(i);
    if (!loads_.weakens_at_s.empty() && loads_.strength_fraction[i] < 1) weakening_nodes_.push_back(i);
  }
  weaken(0);
}

void Coupling::weaken(double time_s) {
  for (const auto i : weakening_nodes_) {
    const double since_s = time_s - loads_.weakens_at_s[i], all_s = loads_.weakening_time_s;
    const double share = since_s >= all_s ? 1 : std::max(0.0, since_s / all_s);
    interface_.strength_fraction[i] = 1 - share * (1 - loads_.strength_fraction[i]);
  }
}

void Coupling::add_to(StateView& state) {
  std::vector<StateArray> arrays;
  interface::for_each_field(interface_, [&](interface::FieldKind kind, auto& values) {
    if (kind == interface::FieldKind::result || kind == interface::FieldKind::memory)
      arrays.push_back(values);
  });
  breakdown_.for_each_array([&](auto& values) { arrays.push_back(values); });
  for (const auto* load : Loads::arrays(std::as_const(loads_)))
    if (!load->empty()) arrays.push_back(*load);
  arrays.push_back(start_u_x_m_);
  if (is_pair())
    for (auto& side : sides_) arrays.insert(arrays.end(), {side.v_x, side.v_y});
  state.lists.push_back(
      {StateKey::place, 0, interface_.size(), above().side->nodes.data(), std::move(arrays)});
  state.flags.push_back(&interface_.begun);
}

void Coupling::set_prestress(std::vector<double> t_Pa, std::vector<double> p_Pa) {
  SLIPFRONT_ASSERT(t_Pa.size() == interface_.size() && p_Pa.size() == interface_.size(),
                   "prestress of other nodes");
  loads_.prestress_t_Pa = std::move(t_Pa);
  loads_.prestress_p_Pa = std::move(p_Pa);
}

void Coupling::update(double time_s, double dt_s, StepObserver& observer, record::History* sample,
                      record::Energies& works) {
  const double impulse_s = dt_s * trigger_factor(loads_.trigger, time_s);
  prestress_growth_t_Pa_ = time_s * loads_.prestress_rate.t_Pa_per_s;
  prestress_growth_p_Pa_ = time_s * loads_.prestress_rate.p_Pa_per_s;
  weaken(time_s);
  std::swap(interface_.v_x_m_per_s, v_x_before_);
  std::swap(interface_.v_y_m_per_s, v_y_before_);
  for (auto& side : sides_) {
    std::swap(side.v_x, side.v_x_before);
    std::swap(side.v_y, side.v_y_before);
    take_velocities(side);
    add_loads(side, dt_s, impulse_s);
  }
  set_relative_motion();
  if (sample != nullptr) append_law_states(*sample);
  const bool changed = interface::update_contact(contact_, dt_s, interface_);
  observer.observe(time_s, interface_, changed);
  follow_breakdown(dt_s, changed);
  if (sample != nullptr) append_sample(time_s, *sample);
  if (contact_.algorithm == interface::ContactAlgorithm::predictor_corrector) take_shifts();
  for (auto& side : sides_) is_pair() ? move_nodes<true>(side, dt_s) : move_nodes<false>(side, dt_s);
  add_works_of_contact(dt_s, works);
  add_works_of_loads(dt_s, impulse_s, works);
}

SlipRates Coupling::slip_rates() const {
  SlipRates rates;
  for (std::size_t i = own_begin_; i < own_end_; ++i) {
    const double v = std::abs(interface_.slip_rate_m_per_s[i]);
    rates.finite &= std::isfinite(v);
    rates.fastest_m_per_s = std::max(rates.fastest_m_per_s, v);
    if (interface_.p_Pa[i] > loads_.light_Pa)
      rates.fastest_in_contact_m_per_s = std::max(rates.fastest_in_contact_m_per_s, v);
    if (interface_.slipping[i] != 0)
      rates.fastest_slipping_m_per_s = std::max(rates.fastest_slipping_m_per_s, v);
  }
  return rates;
}

void Coupling::follow_breakdown(double dt_s, bool changed) {
  const auto& s = interface_;
  breakdown_.follow(
      dt_s, changed, [&](std::size_t i) { return s.slipping[i]; },
      [&](std::size_t i) {
        interface::NodeFriction now;
        now.t_Pa = s.t_Pa[i];
        now.p_Pa = interface::pressure_of_friction_Pa(contact_, s, i);
        now.strength_Pa = s.strength_Pa[i];
        now.cohesion_Pa = contact_.law_at(i).cohesion_Pa();
        // As in the work of friction: slip at the mean velocity over the kick.
        now.slip_m = 0.5 * dt_s * (s.v_x_m_per_s[i] + v_x_before_[i]);
        now.slips = s.slipping[i] != 0;
        return now;
      });
}

record::Breakdown Coupling::breakdown() const {
  return breakdown_.found(own_begin_, own_end_,
                          [&](std::size_t i) { return contact_.law_at(i).cohesion_Pa(); });
}

double Coupling::largest_acceleration_m_per_s2() const {
  double a = 0;
  for (std::size_t i = own_begin_; i < own_end_; ++i)
    a = std::max(a, std::max(std::abs(interface_.t_Pa[i]), std::abs(interface_.p_Pa[i])) /
                        interface_.mass_per_length_kg_m2[i]);
  return a;
}

void Coupling::add_loads(Side& side, double dt_s, double impulse_s) {
  const auto [v_x, v_y, v_x_before, v_y_before] = velocities(side);
  const auto& mass = side.body.side->mass_kg;
  const double sign = side.sign;
  for (const auto i : trigger_nodes_) {
    v_x[i] += sign * impulse_s * loads_.trigger_force_N_per_m[i] / mass[i];
    v_y[i] += impulse_s * unloading_N_per_m(i) / mass[i];
  }
  const double growth_t_Pa = prestress_growth_t_Pa_, growth_p_Pa = prestress_growth_p_Pa_;
  for (std::size_t i = 0; i < loads_.prestress_t_Pa.size(); ++i) {
    const double per_pressure = dt_s * tributary_m_[i] / mass[i];
    v_x[i] += sign * per_pressure * (loads_.prestress_t_Pa[i] + growth_t_Pa);
    v_y[i] -= per_pressure * (loads_.prestress_p_Pa[i] + growth_p_Pa);
  }
  for (const auto& [i, n, d_x, d_y, spring] : side.body.side->dashpots) {
    // The contact's tractions act on the effective mass m (1 + d).
    v_x[i] = (v_x[i] - d_x * v_x_before[i]) / (1 + d_x);
    v_y[i] = (v_y[i] - d_y * v_y_before[i]) / (1 + d_y);
  }
}

void Coupling::add_works_of_contact(double dt_s, record::Energies& works) const {
  const auto& s = interface_;
  // The impulse from the velocities: a landing by projection has no pressure.
  const auto contact_work = [&](std::size_t i) {
    return 0.5 * contact_mass_kg_[i] * (s.v_y_m_per_s[i] - v_y_trial_[i]) *
           (s.v_y_m_per_s[i] + v_y_before_[i]);
  };
  const auto friction_work = [&](std::size_t i) {
    return 0.5 * dt_s * tributary_m_[i] * s.t_Pa[i] * (s.v_x_m_per_s[i] + v_x_before_[i]);
  };
  const auto landing_work = [&](const Side& side) {
    return side.body.side->landing.work(*side.body.u, *side.body.v, dt_s);
  };
  if (is_pair()) {
    for (std::size_t i = own_begin_; i < own_end_; ++i) {
      works.contact_work += contact_work(i);
      works.friction_work -= friction_work(i);
    }
    for (const auto& side : sides_) works.contact_work += landing_work(side);
    return;
  }
  double all_contact_work = 0, all_friction_work = 0;
  for (const auto& run : above().side->runs) {
    if (!run.is_owned) continue;
#pragma omp simd reduction(+ : all_contact_work, all_friction_work)
    for (std::size_t i = run.at; i < run.at + run.count; ++i) {
      all_contact_work += contact_work(i);
      all_friction_work -= friction_work(i);
    }
  }
  works.contact_work += all_contact_work + landing_work(sides_.front());
  works.friction_work += all_friction_work;
}

void Coupling::take_shifts() {
  for (std::size_t i = 0; i < interface_.size(); ++i) {
    const double shift_m = interface_.u_y_m[i] - relative_u_y_m(i);
    for (auto& side : sides_) {
      side.shift_m[i] = side.share_y[i] * shift_m;
      if (shift_m != 0) side.body.side->landing.add(i, side.shift_m[i]);
    }
  }
}

template <bool is_pair>
void Coupling::move_nodes(Side& side, double dt_s) {
  const auto& s = interface_;
  const auto own = velocities(side);
  if constexpr (is_pair)
    for (std::size_t i = 0; i < s.size(); ++i) {
      own.x[i] += side.sign * side.share_x[i] * (s.v_x_m_per_s[i] - v_x_trial_[i]);
      own.y[i] += side.share_y[i] * (s.v_y_m_per_s[i] - v_y_trial_[i]);
    }
  for (const auto& run : side.body.side->runs) {
    const auto count = run.count;
    const double* v_x_now = &own.x[run.at];
    const double* v_y_now = &own.y[run.at];
    const double* u_y_now = &s.u_y_m[run.at];
    const double* shift = &side.shift_m[run.at];
    double* __restrict v_x = &side.body.v->x[run.first];
    double* __restrict v_y = &side.body.v->y[run.first];
    double* __restrict u_x = &side.body.u->x[run.first];
    double* __restrict u_y = &side.body.u->y[run.first];
#pragma omp simd
    for (std::size_t k = 0; k < count; ++k) {
      v_x[k] = v_x_now[k];
      v_y[k] = v_y_now[k];
      u_x[k] += dt_s * v_x_now[k];
      if constexpr (is_pair)
        u_y[k] += shift[k] + dt_s * v_y_now[k];
      else
        u_y[k] = u_y_now[k] + dt_s * v_y_now[k];
    }
  }
}

void Coupling::add_works_of_loads(double dt_s, double impulse_s, record::Energies& works) {
  for (auto& side : sides_) {
    const auto [v_x, v_y, v_x_before, v_y_before] = velocities(side);
    for (const auto& dashpot : side.body.side->dashpots) {
      const auto i = dashpot.at;
      if (!is_own(i)) continue;
      works.boundary_work +=
          boundary::dashpot_work(dashpot.d_x, dashpot.d_y, side.body.side->mass_kg[i],
                                 0.5 * (v_x[i] + v_x_before[i]), 0.5 * (v_y[i] + v_y_before[i]));
    }
  }
  for (std::size_t i = own_begin_; i < std::min(own_end_, loads_.prestress_t_Pa.size()); ++i)
    works.prestress_work +=
        0.5 * dt_s * tributary_m_[i] *
        ((loads_.prestress_t_Pa[i] + prestress_growth_t_Pa_) * (interface_.v_x_m_per_s[i] + v_x_before_[i]) -
         (loads_.prestress_p_Pa[i] + prestress_growth_p_Pa_) * (interface_.v_y_m_per_s[i] + v_y_before_[i]));
  for (const auto i : trigger_nodes_)
    if (is_own(i))
      works.trigger_work += 0.5 * impulse_s *
                            (loads_.trigger_force_N_per_m[i] * (interface_.v_x_m_per_s[i] + v_x_before_[i]) +
                             unloading_N_per_m(i) * (interface_.v_y_m_per_s[i] + v_y_before_[i]));
}

record::History Coupling::interface_row(double time_s) const {
  record::History row;
  append_law_states(row);
  append_sample(time_s, row);
  return row;
}

void Coupling::append_law_states(record::History& history) const {
  history.law_states.resize(interface_.law_states.size());
  for (std::size_t k = 0; k < history.law_states.size(); ++k)
    history.law_states[k].insert(history.law_states[k].end(), interface_.law_states[k].begin() + own_begin_,
                                 interface_.law_states[k].begin() + own_end_);
}

void Coupling::append_sample(double time_s, record::History& history) const {
  history.time_s.push_back(time_s);
  for (std::size_t i = own_begin_; i < own_end_; ++i) {
    history.slip_m.push_back(slip_m(i));
    history.slip_rate_m_per_s.push_back(interface_.slip_rate_m_per_s[i]);
    history.t_Pa.push_back(interface_.t_Pa[i]);
    history.p_Pa.push_back(interface_.p_Pa[i]);
  }
}

void Coupling::reverse() {
  const auto negate = [](std::vector<double>& values) {
    for (double& value : values) value = -value;
  };
  for (auto* v : {&interface_.v_x_m_per_s, &interface_.v_y_m_per_s, &interface_.slip_rate_m_per_s,
                  &interface_.acceleration_m_per_s2})
    negate(*v);
  for (auto& side : sides_)
    for (auto* v : {&side.v_x, &side.v_y}) negate(*v);
}

}  // namespace slipfront::motion
