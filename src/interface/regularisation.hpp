// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>

namespace slipfront::interface {

/// Which quantity follows its instantaneous value with a delay.
enum class Relaxed {
  none,      ///< strength S = mu p at once
  strength,  ///< dS/dt = rate (mu p - S)
  pressure,  ///< dq/dt = rate (p - q), S = mu q
};

/// Delayed response of friction to changes of pressure (Prakash and Clifton 1993, simplified): the quantity
/// relaxes at the rate (|v| + v*) / L + 1 / t*. An infinite L leaves a constant rate, an infinite t* one that
/// depends on the slip rate alone.
struct Regularisation {
  Relaxed relaxed = Relaxed::none;
  double length_m = std::numeric_limits<double>::infinity();  ///< L
  double slip_rate_m_per_s = 0;                               ///< v*
  double time_s = std::numeric_limits<double>::infinity();    ///< t*
};

/// Relaxation rate at a slip rate, 1/s.
inline double relaxation_rate_per_s(const Regularisation& r, double speed_m_per_s) {
  return (speed_m_per_s + r.slip_rate_m_per_s) / r.length_m + 1 / r.time_s;
}

// What is left of a deviation after one (sub-)step: exp(-rate dt), exact while the target is constant.

struct ConstantDecay {
  double factor;
  ConstantDecay(const Regularisation& r, double dt_s)
      : factor(std::exp(-dt_s * relaxation_rate_per_s(r, 0))) {}
  double operator()(double /*speed_m_per_s*/) const { return factor; }
};

struct SlipRateDecay {
  double at_rest, dt_per_length_s_per_m;
  SlipRateDecay(const Regularisation& r, double dt_s)
      : at_rest(dt_s * relaxation_rate_per_s(r, 0)), dt_per_length_s_per_m(dt_s / r.length_m) {}
  double operator()(double speed_m_per_s) const {
    return std::exp(-(at_rest + speed_m_per_s * dt_per_length_s_per_m));
  }
};

// Strength of a node in its step. The relaxed quantity follows one equation whether the node sticks, slips or
// is open; an open node (p = 0) forgets at the same rate, and has no strength whatever is left of its memory.
// `at_rest` is the strength of a node that has just stuck, mu at rest given.

/// The strength follows at once.
struct Immediate {
  double operator()(double mu, double p_Pa, double /*speed_m_per_s*/, double& /*relaxed_Pa*/) const {
    return mu * p_Pa;
  }
  double at_rest(double mu, double p_Pa, double /*relaxed_Pa*/) const { return mu * p_Pa; }
  double initial(double /*mu*/, double /*p_Pa*/) const { return 0; }
};

/// A stuck node keeps the strength with which it stuck and regains the static one at the rate for |v| = 0.
template <class Decay>
struct RelaxedStrength {
  Decay decay;
  double operator()(double mu, double p_Pa, double speed_m_per_s, double& relaxed_Pa) const {
    const double target = mu * p_Pa;
    relaxed_Pa = target + decay(speed_m_per_s) * (relaxed_Pa - target);
    return p_Pa > 0 ? relaxed_Pa : 0;
  }
  double at_rest(double /*mu*/, double p_Pa, double relaxed_Pa) const { return p_Pa > 0 ? relaxed_Pa : 0; }
  double initial(double mu, double p_Pa) const { return mu * p_Pa; }
};

/// The coefficient acts at once, so that a stuck node has the static coefficient times the relaxed pressure.
template <class Decay>
struct RelaxedPressure {
  Decay decay;
  double operator()(double mu, double p_Pa, double speed_m_per_s, double& relaxed_Pa) const {
    relaxed_Pa = p_Pa + decay(speed_m_per_s) * (relaxed_Pa - p_Pa);
    return at_rest(mu, p_Pa, relaxed_Pa);
  }
  double at_rest(double mu, double p_Pa, double relaxed_Pa) const { return p_Pa > 0 ? mu * relaxed_Pa : 0; }
  double initial(double /*mu*/, double p_Pa) const { return p_Pa; }
};

/// Calls f with the form that the settings name. The choice is made once per contact update.
template <class F>
auto with_form(const Regularisation& r, double dt_s, F&& f) {
  const bool constant = std::isinf(r.length_m);
  if (r.relaxed == Relaxed::strength)
    return constant ? f(RelaxedStrength<ConstantDecay>{{r, dt_s}})
                    : f(RelaxedStrength<SlipRateDecay>{{r, dt_s}});
  if (r.relaxed == Relaxed::pressure)
    return constant ? f(RelaxedPressure<ConstantDecay>{{r, dt_s}})
                    : f(RelaxedPressure<SlipRateDecay>{{r, dt_s}});
  return f(Immediate{});
}

}  // namespace slipfront::interface
