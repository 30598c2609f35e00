// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

}  // namespace slipfront::interface
