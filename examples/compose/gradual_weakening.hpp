// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "base/message.hpp"
#include "interface/friction.hpp"
#include "interface/friction/parameter.hpp"
#include "interface/friction/slip_weakening.hpp"

/// A friction law of one's own, mu = mu_k + (mu_s - mu_k)/(1 + slip/D)^2, as laws in src/interface/friction.
struct GradualWeakening {
  static constexpr const char* name = "gradual_weakening";
  static constexpr const char* help = "falls gradually from mu_s to mu_k over the slip, for good";
  static constexpr auto memory = slipfront::interface::SlipMemory::lasting;

  double mu_s = 0.7, mu_k = 0.4, slip_scale_m = 2e-6;

  static constexpr auto parameters() {
    using L = GradualWeakening;
    return std::array<slipfront::interface::Parameter<L>, 3> {
      {
        {"mu_s", &L::mu_s, 0, 100, "friction coefficient before slip"},
            {"mu_k", &L::mu_k, 0, 100, "friction coefficient after long slip"}, {
          "slip_scale_m", &L::slip_scale_m, 1e-12, 1e3, "slip over which the drop falls to a fourth"
        }
      }
    };
  }
  slipfront::Message inconsistency() const { return {}; }
  double static_coefficient() const { return mu_s; }
  double kinetic_coefficient() const { return mu_k; }

  template <class V>
  struct Evaluator {
    V kinetic, drop, per_slip_per_m;
    V operator()(V /*speed_m_per_s*/, V slip_m) const {
      const V grown = 1 + slip_m * per_slip_per_m;
      return kinetic + drop / (grown * grown);
    }
    V slope_s_per_m(V /*speed_m_per_s*/, V /*slip_m*/) const { return V{}; }
  };
  Evaluator<double> evaluator() const { return {mu_k, mu_s - mu_k, 1 / slip_scale_m}; }
};

/// The law without a line in the registry: over arrays, several times slower. A law of the registry stands
/// for its coefficients at rest and in motion.
inline slipfront::interface::FrictionLaw without_registry(const GradualWeakening& law) {
  slipfront::interface::FrictionLaw friction = slipfront::interface::SlipWeakening { law.mu_s, law.mu_k };
  friction.set_function([mu_of = law.evaluator()](auto speed_m_per_s, auto slip_m, auto mu) {
    for (std::size_t k = 0; k < mu.size(); ++k) mu[k] = mu_of(speed_m_per_s[k], slip_m[k]);
  });
  return friction;
}
