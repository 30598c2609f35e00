// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "base/message.hpp"
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
  Message inconsistency() const { return {}; }

  double static_coefficient() const { return mu; }
  double kinetic_coefficient() const { return mu; }

  template <class V>
  struct Evaluator {
    V mu;
    V operator()(V /*speed_m_per_s*/, V /*slip_m*/) const { return mu; }
    /// d mu / d|v|
    V slope_s_per_m(V /*speed_m_per_s*/, V /*slip_m*/) const { return V{}; }
  };
  Evaluator<double> evaluator() const { return {mu}; }
};

}  // namespace slipfront::interface
