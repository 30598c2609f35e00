// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>

#include "interface/friction/coulomb.hpp"
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

/// All laws under both algorithms, without and with a delayed response.
template <class F>
void for_each_model(F&& f) {
  for (const FrictionLaw& law :
       {FrictionLaw(VelocityWeakening{}), FrictionLaw(Coulomb{}), FrictionLaw(SlipWeakening{}),
        FrictionLaw(SlipWeakeningHealing{}), FrictionLaw(SlipTable{}), FrictionLaw(SlipRateTable{})})
    for (const auto algorithm : {ContactAlgorithm::direct, ContactAlgorithm::predictor_corrector}) {
      f(ContactModel{law, {}, algorithm});
      for (const Relaxed relaxed : {Relaxed::strength, Relaxed::pressure})
        for (const double length_m : {2e-6, std::numeric_limits<double>::infinity()})
          f(ContactModel{law, {relaxed, length_m, 0.1, 2e-6}, algorithm});
    }
}

/// Trial motion that presses the node with p and drags it with t_stop.
inline void pull(Interface& s, double t_stop_Pa, double p_Pa) {
  s.v_x_m_per_s[0] = t_stop_Pa / impedance;
  s.v_y_m_per_s[0] = -p_Pa / impedance;
}

/// One node at rest on the plane under p.
inline Interface resting_node(const ContactModel& model, double p_Pa) {
  Interface s(1);
  s.mass_per_length_kg_m2[0] = mass;
  s.p_Pa[0] = p_Pa;
  start_contact(model, s);
  return s;
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

}  // namespace slipfront::interface::test
