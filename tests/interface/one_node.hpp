// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "interface/friction/coulomb.hpp"
#include "interface/friction/exponential_slip_weakening.hpp"
#include "interface/friction/rate_and_state.hpp"
#include "interface/friction/rate_and_state_two.hpp"
#include "interface/friction/slip_weakening.hpp"
#include "interface/friction/table.hpp"
#include "interface/friction/velocity_weakening.hpp"
#include "interface/interface.hpp"

namespace slipfront::interface::test {

inline constexpr double dt = 1e-6;
inline constexpr double mass = 0.4;             // kg/m2
inline constexpr double impedance = mass / dt;  // Pa s/m

inline constexpr double rounding_Pa = 1e-8;  // tractions of 1e6 Pa through a velocity and back
inline const VelocityWeakening weakening{.mu_s = 1.3, .mu_k = 0.6, .alpha_m2_per_s2 = 0.1};
/// Its coefficient, by hand.
inline double weakening_mu(double v_m_per_s) {
  return 0.6 + 0.7 * std::exp(-v_m_per_s * std::sqrt(7.0));
}

inline FrictionLaw strengthening() {
  return VelocityWeakening{.mu_s = 0.6, .mu_k = 0.9, .alpha_m2_per_s2 = 1e-6};
}
inline FrictionLaw cohesive() {
  FrictionLaw law = SlipWeakening{};
  law.parameter(FrictionLaw::cohesion_key) = 2e4;
  return law;
}

/// All laws under both algorithms, with an immediate and a delayed response, or none, to the pressure.
template <class F>
void for_each_model(F&& f) {
  for (const FrictionLaw& law :
       {FrictionLaw(VelocityWeakening{}), FrictionLaw(Coulomb{}), FrictionLaw(SlipWeakening{}),
        FrictionLaw(SlipWeakeningHealing{}), FrictionLaw(ExponentialSlipWeakening{}),
        FrictionLaw(SlipTable{}), FrictionLaw(SlipRateTable{}), strengthening(), cohesive()})
    for (const auto algorithm : {ContactAlgorithm::direct, ContactAlgorithm::predictor_corrector}) {
      for (const Relaxed relaxed : {Relaxed::none, Relaxed::initial_pressure})
        f(ContactModel{law, {relaxed}, algorithm});
      for (const Relaxed relaxed : {Relaxed::strength, Relaxed::pressure})
        for (const double length_m : {2e-6, std::numeric_limits<double>::infinity()})
          f(ContactModel{law, {relaxed, length_m, 0.1, 2e-6}, algorithm});
    }
  for (const FrictionLaw& law : {FrictionLaw(RateAndStateAging{}), FrictionLaw(RateAndStateSlip{}),
                                 FrictionLaw(RateAndStateStrong{}), FrictionLaw(RateAndStateAgingTwo{})})
    for (const Relaxed relaxed : {Relaxed::none, Relaxed::pressure})
      f(ContactModel{law, {relaxed, 2e-6, 0.1, 2e-6}});
}

inline Interface one_node() {
  Interface s(1);
  s.mass_per_length_kg_m2[0] = mass;
  return s;
}

/// One node at rest on the plane under p.
inline Interface resting_node(const ContactModel& model, double p_Pa) {
  auto s = one_node();
  s.p_Pa[0] = p_Pa;
  start_contact(model, s);
  return s;
}

/// A step with this trial velocity; whether a node began or ceased to slip.
inline bool move(const ContactModel& model, Interface& s, double v_x_m_per_s, double v_y_m_per_s) {
  s.v_x_m_per_s[0] = v_x_m_per_s;
  s.v_y_m_per_s[0] = v_y_m_per_s;
  return update_contact(model, dt, s);
}

/// A step whose trial motion presses the node with p and drags it with t_stop.
inline bool pull(const ContactModel& model, Interface& s, double t_stop_Pa, double p_Pa) {
  return move(model, s, t_stop_Pa / impedance, -p_Pa / impedance);
}

/// Strength of a slipping node in a step: the coefficient at the mean of the last and the new slip rate, the
/// new one with three tries from the last. All quantities along the motion.
template <class Coefficient>
double strength_under_way(Coefficient mu, double last_rate, double t_stop_Pa, double p_Pa) {
  double rate = last_rate, strength = 0;
  for (int k = 0; k < 3; ++k) {
    strength = mu(std::abs(rate)) * p_Pa;
    rate = 0.5 * (last_rate + (t_stop_Pa - strength) / impedance);
  }
  return strength;
}

/// All that an update writes of a node.
inline std::vector<double> results_at(const Interface& s, std::size_t i) {
  std::vector<double> all;
  for_each_field(s, [&](FieldKind kind, const auto& values) {
    if (kind != FieldKind::body && kind != FieldKind::load) all.push_back(values[i]);
  });
  return all;
}

/// Nodes of different masses, some weakened, some open.
inline Interface many_nodes(std::size_t n, const ContactModel& model) {
  Interface s(n, model.law.states());
  for (std::size_t i = 0; i < n; ++i) {
    s.mass_per_length_kg_m2[i] = mass * (1 + 0.01 * static_cast<double>(i));
    s.strength_fraction[i] = i % 7 == 0 ? 0.5 : 1;
    s.p_Pa[i] = i % 9 == 0 ? 0 : 0.5e6;
  }
  return s;
}

/// Trial motions that make nodes stick, slip, open, land and turn round, the same for all that take them.
struct Motion {
  double v_x, v_y, u_y;
  static std::vector<Motion> of(std::size_t n, std::mt19937_64& random) {
    std::uniform_real_distribution<double> within(-1, 1);
    std::vector<Motion> motions;
    for (std::size_t i = 0; i < n; ++i)
      motions.push_back({within(random), within(random) - 0.6, dt * (within(random) + 0.3)});
    return motions;
  }
  void push(Interface& s, std::size_t i) const {
    s.v_x_m_per_s[i] = 0.8 * s.slip_rate_m_per_s[i] + v_x;
    s.v_y_m_per_s[i] = v_y;
    s.u_y_m[i] += u_y;
  }
};

}  // namespace slipfront::interface::test
