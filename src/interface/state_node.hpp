// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/exponential.hpp"
#include "base/lanes.hpp"
#include "base/logarithm.hpp"

// The implicit equation of a node under a rate-and-state law, for a value type V.
namespace slipfront::interface {

/// Below it psi/a leaves no friction to speak of, and above it exponentials stay in range.
inline constexpr double least_state = -150;

/// The y >= 0 of y + k (exp(y - s) - exp(-y - s)) = Y, Y >= 0, k > 0: y is tau/(a p), s is psi/a, and the
/// left side the traction and what the mass takes of the trial one, Y. It rises with y, ever more steeply, so
/// that there is one root, between 0 and Y, and Halley's steps from above come down to it without passing it.
/// Their error after each is of third order: when one is below `small` the next is below rounding.
/// @param log_trial  ln of the trial slip rate over V0, Y/k: y is at most asinh(Y/(2 k) exp(s)) too
template <class V>
inline V root_of_traction(V Y, V k, V s, V log_trial) {
  // Above ln(1 + exp(u)), which is above asinh(exp(u)/2). Beyond 20 this is u, in which ln(1 - y/Y) < -y/Y
  // takes the traction off the trial one.
  const V u = s + log_trial;
  const V near_0 = 0.69315 + u * (0.5 + u * 0.125);
  V bound = select(u > 2, u + 0.16, select(u < -2, V{} + 0.2, near_0));
  bound = select(u > 20, u * Y / (Y + 1), bound);
  V y = select(Y < bound, Y, bound);
  constexpr double small = 1e-4;
  constexpr int most = 50;  // of numbers that are none
  Mask<V> goes_on = y == y;
  for (int i = 0; i < most; ++i) {
    const V forward = k * exp_minus(s - y);
    V back{};  // from y = 20 on it is below rounding beside forward
    if (any(y < 20)) back = forward * exp_minus(2 * y);
    const V f = y + (forward - back) - Y, slope = 1 + forward + back, bend = forward - back;
    const V step = f * slope / (slope * slope - 0.5 * f * bend);
    y = select(goes_on, y - step, y);
    goes_on = goes_on && absolute(step) > small;
    if (!any(goes_on)) break;
  }
  return select(y < 0, V{}, y);  // by rounding alone
}

}  // namespace slipfront::interface
