// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "base/exponential.hpp"
#include "base/message.hpp"
#include "interface/friction/parameter.hpp"

namespace slipfront::interface {

/// mu = mu_k + (mu_s - mu_k) exp(-slip/d_c), over the slip path, for good.
struct ExponentialSlipWeakening {
  static constexpr const char* name = "slip_weakening_exponential";
  static constexpr const char* help = "from mu_s to mu_k exponentially, over the slip d_c, for good";
  static constexpr SlipMemory memory = SlipMemory::lasting;

  double mu_s = 0.6;
  double mu_k = 0.3;
  double d_c_m = 2e-6;

  static constexpr std::array<Parameter<ExponentialSlipWeakening>, 3> parameters() {
    using L = ExponentialSlipWeakening;
    return {{{"mu_s", &L::mu_s, 0, 100, "friction coefficient before slip"},
             {"mu_k", &L::mu_k, 0, 100, "friction coefficient after much slip"},
             {"d_c_m", &L::d_c_m, 1e-12, 1e3, "slip over which mu - mu_k falls to 1/e"}}};
  }
  Message inconsistency() const { return {}; }

  double static_coefficient() const { return mu_s; }
  double kinetic_coefficient() const { return mu_k; }
  /// d_c of linear slip weakening with this fracture energy, (mu_s - mu_k) p d_c.
  double weakening_slip_m() const { return 2 * d_c_m; }

  template <class V>
  struct Evaluator {
    V kinetic, drop, per_slip_per_m;
    V operator()(V /*speed_m_per_s*/, V slip_m) const {
      return kinetic + drop * exp_minus(slip_m * per_slip_per_m);
    }
    V slope_s_per_m(V /*speed_m_per_s*/, V /*slip_m*/) const { return V{}; }
  };
  Evaluator<double> evaluator() const { return {mu_k, mu_s - mu_k, 1 / d_c_m}; }
};

}  // namespace slipfront::interface
