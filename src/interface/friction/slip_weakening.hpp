// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "base/lanes.hpp"
#include "base/message.hpp"
#include "interface/friction/parameter.hpp"

namespace slipfront::interface {

/// mu = mu_k + (mu_s - mu_k) max(0, 1 - slip/d_c): linear slip weakening (Ida 1972, Andrews 1976). The slip
/// path counts for good, or, with healing, anew from each sticking.
template <SlipMemory slip_memory>
struct LinearSlipWeakening {
  static constexpr bool heals = slip_memory == SlipMemory::until_stick;
  static constexpr const char* name = heals ? "slip_weakening_healing" : "slip_weakening";
  static constexpr const char* help = heals ? "from mu_s to mu_k linearly, over the slip d_c since the node "
                                              "last stuck"
                                            : "from mu_s to mu_k linearly, over the slip d_c, for good";
  static constexpr SlipMemory memory = slip_memory;

  double mu_s = 0.6;
  double mu_k = 0.45;
  double d_c_m = 5e-6;

  static constexpr std::array<Parameter<LinearSlipWeakening>, 3> parameters() {
    using L = LinearSlipWeakening;
    return {{{"mu_s", &L::mu_s, 0, 100, "friction coefficient before slip"},
             {"mu_k", &L::mu_k, 0, 100, "friction coefficient after the slip d_c"},
             {"d_c_m", &L::d_c_m, 1e-12, 1e3, "slip over which friction changes"}}};
  }
  /// Empty, or what is wrong with the parameters together.
  Message inconsistency() const { return {}; }

  double static_coefficient() const { return mu_s; }
  double kinetic_coefficient() const { return mu_k; }
  double weakening_slip_m() const { return d_c_m; }

  template <class V>
  struct Evaluator {
    V kinetic, drop, per_slip_per_m;
    V operator()(V /*speed_m_per_s*/, V slip_m) const {
      return kinetic + drop * positive_part(1 - slip_m * per_slip_per_m);
    }
    V slope_s_per_m(V /*speed_m_per_s*/, V /*slip_m*/) const { return V{}; }
  };
  Evaluator<double> evaluator() const { return {mu_k, mu_s - mu_k, 1 / d_c_m}; }
};

using SlipWeakening = LinearSlipWeakening<SlipMemory::lasting>;
using SlipWeakeningHealing = LinearSlipWeakening<SlipMemory::until_stick>;

}  // namespace slipfront::interface
