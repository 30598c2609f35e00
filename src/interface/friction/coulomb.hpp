// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "interface/friction/parameter.hpp"

namespace slipfront::interface {

/// Coulomb's friction: one coefficient, at rest and in motion.
struct Coulomb {
  static constexpr const char* name = "coulomb";
  static constexpr const char* help = "one coefficient, at rest and in motion";
  static constexpr SlipMemory memory = SlipMemory::none;

  double mu = 1.3;

  static constexpr std::array<Parameter<Coulomb>, 1> parameters() {
    return {{{"mu", &Coulomb::mu, 0, 100, "friction coefficient"}}};
  }
  /// Empty, or what is wrong with the parameters together.
  const char* inconsistency() const { return ""; }

  double static_coefficient() const { return mu; }
  double kinetic_coefficient() const { return mu; }

  struct Evaluator {
    double mu;
    double operator()(double /*speed_m_per_s*/, double /*slip_m*/) const { return mu; }
    /// d mu / d|v|
    double slope_s_per_m(double /*speed_m_per_s*/, double /*slip_m*/) const { return 0; }
  };
  Evaluator evaluator() const { return {mu}; }
};

}  // namespace slipfront::interface
