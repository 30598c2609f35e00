// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "interface/friction/coulomb.hpp"
#include "interface/friction/slip_weakening.hpp"
#include "interface/friction/velocity_weakening.hpp"

namespace slipfront::interface {

/// All friction laws the case file can name; a new law is one more type in this list.
using FrictionLaw = std::variant<VelocityWeakening, Coulomb, SlipWeakening, SlipWeakeningHealing>;

inline double static_coefficient(const FrictionLaw& law) {
  return std::visit([](const auto& l) { return l.static_coefficient(); }, law);
}

/// The coefficient that a weakening law falls to.
inline double kinetic_coefficient(const FrictionLaw& law) {
  return std::visit([](const auto& l) { return l.kinetic_coefficient(); }, law);
}

/// mu after a slip path and at a slip rate |v|.
inline double friction_coefficient(const FrictionLaw& law, double speed_m_per_s, double slip_m) {
  return std::visit([&](const auto& l) { return l.evaluator()(speed_m_per_s, slip_m); }, law);
}

/// d mu / d|v| there; negative where friction weakens with the slip rate.
inline double friction_slope_s_per_m(const FrictionLaw& law, double speed_m_per_s, double slip_m) {
  return std::visit([&](const auto& l) { return l.evaluator().slope_s_per_m(speed_m_per_s, slip_m); }, law);
}

/// A parameter of a law, whichever that is.
struct ParameterValue {
  const char* key;  ///< in the table [friction], with its unit
  double* value;    ///< in the law
  double min, max;  ///< allowed
};
inline std::vector<ParameterValue> parameters_of(FrictionLaw& law) {
  return std::visit(
      [](auto& l) {
        std::vector<ParameterValue> all;
        for (const auto& p : l.parameters()) all.push_back({p.key, &(l.*p.member), p.min, p.max});
        return all;
      },
      law);
}

/// Empty, or what is wrong with the parameters together.
inline Message inconsistency(const FrictionLaw& law) {
  return std::visit([](const auto& l) { return l.inconsistency(); }, law);
}

/// The static coefficient's key in the case file: every law names its coefficient at rest first.
inline std::string static_coefficient_key(const FrictionLaw& law) {
  return std::visit([](const auto& l) { return std::string("friction.") + l.parameters()[0].key; }, law);
}

}  // namespace slipfront::interface
