// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>

#include "base/exponential.hpp"
#include "base/message.hpp"
#include "interface/friction/parameter.hpp"

namespace slipfront::interface {

/// mu(v) = mu_k + (mu_s - mu_k) exp(-|v| sqrt(|mu_s - mu_k| / alpha)): Kammer et al. 2012, Eq. 1. Strengthens
/// with mu_k > mu_s.
struct VelocityWeakening {
  static constexpr const char* name = "velocity_weakening";
  static constexpr const char* help =
      "from mu_s at rest to mu_k at speed, over about sqrt(alpha / |mu_s - mu_k|)";
  static constexpr SlipMemory memory = SlipMemory::none;

  double mu_s = 1.3;
  double mu_k = 0.6;
  double alpha_m2_per_s2 = 0.1;

  static constexpr std::array<Parameter<VelocityWeakening>, 3> parameters() {
    return {{{"mu_s", &VelocityWeakening::mu_s, 0, 100, "friction coefficient at rest"},
             {"mu_k", &VelocityWeakening::mu_k, 0, 100, "friction coefficient at high slip rate"},
             {"alpha_m2_per_s2", &VelocityWeakening::alpha_m2_per_s2, 1e-12, 1e12,
              "transition parameter alpha"}}};
  }
  /// Empty, or what is wrong with the parameters together.
  Message inconsistency() const { return {}; }

  double static_coefficient() const { return mu_s; }
  double kinetic_coefficient() const { return mu_k; }
  bool strengthens() const { return mu_k > mu_s; }

  /// The law with its constants folded, for the loop over nodes.
  template <class V>
  struct Evaluator {
    V kinetic, drop, rate_s_per_m;
    V operator()(V speed_m_per_s, V /*slip_m*/) const {
      return kinetic + drop * exp_minus(speed_m_per_s * rate_s_per_m);
    }
    /// d mu / d|v|
    V slope_s_per_m(V speed_m_per_s, V /*slip_m*/) const {
      return -drop * rate_s_per_m * exp_minus(speed_m_per_s * rate_s_per_m);
    }
  };
  Evaluator<double> evaluator() const {
    return {mu_k, mu_s - mu_k, std::sqrt(std::abs(mu_s - mu_k) / alpha_m2_per_s2)};
  }
};

}  // namespace slipfront::interface
