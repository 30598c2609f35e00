// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/exponential.hpp"
#include "base/lanes.hpp"
#include "base/logarithm.hpp"

// The implicit equation of a node under friction that rises with the slip rate, for a value type V.
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

/// Root of a function of one sign at a and the other at b, by Chandrupatla's choice of bisection and inverse
/// quadratic interpolation; the end where it is nearer to 0 where the signs are alike.
/// @param nothing  how far off the root may be, or 1e-14 of itself
template <class F, class V>
inline V root_between(const F& f, V a, V f_a, V b, V f_b, V nothing) {
  constexpr double rounding = 1e-14;
  constexpr int most = 200;
  const auto nearest = [&] { return select(absolute(f_a) < absolute(f_b), a, b); };
  Mask<V> goes_on = (f_a > 0) != (f_b > 0);
  if (!any(goes_on)) return nearest();
  V share = f_a / (f_a - f_b);
  for (int i = 0; i < most; ++i) {
    const V small = rounding * absolute(nearest()) + nothing, width = absolute(b - a);
    goes_on = goes_on && small < 0.5 * width && f_a != 0 && f_b != 0;
    if (!any(goes_on)) break;
    const V least = small / width;
    share = select(share > least, select(share < 1 - least, share, 1 - least), least);
    const V x = select(goes_on, a + share * (b - a), a), f_x = f(x);
    const Mask<V> passed = (f_x > 0) != (f_a > 0);
    const V c = select(passed, b, a), f_c = select(passed, f_b, f_a);
    const V other = select(passed, a, b), f_other = select(passed, f_a, f_b);
    a = select(goes_on, x, a), f_a = select(goes_on, f_x, f_a);
    b = select(goes_on, other, b), f_b = select(goes_on, f_other, f_b);
    const auto over = [](V of, V by) {
      return of / select(by == 0, V{} + 1, by);
    };  // counts where by is not 0
    const V xi = over(a - b, c - b), phi = over(f_a - f_b, f_c - f_b);
    const Mask<V> is_smooth = c != b && f_c != f_b && phi * phi < xi && (1 - phi) * (1 - phi) < 1 - xi;
    share = select(is_smooth,
                   over(over(f_a, f_b - f_a) * f_c, f_b - f_c) +
                       over(over(over(c - a, b - a) * f_a, f_c - f_a) * f_b, f_c - f_b),
                   V{} + 0.5);
  }
  return nearest();
}

/// ln(most/V) of the slip rate V that friction leaves of `most`, the rate without it: k mu(V) = 1 - V/most,
/// where mu is 0 at rest and rises with V. Over this logarithm mu is nearly straight.
/// @param mu    of slip rates
/// @param guess  of the result
template <class Mu, class V>
inline V log_slowing(const Mu& mu, V most, V k, V guess) {
  constexpr double longest = 708;  // exp(-708) is 0
  const auto excess = [&](V d) {
    const auto [left, lost] = decay(d);
    return k * mu(most * left) - lost;
  };
  constexpr double small = 0.01, wider = 4, nothing = 1e-18;
  constexpr int most_widenings = 9;  // to `longest`
  V a = positive_part(select(guess < longest, guess, V{} + longest));
  V f_a = excess(a), b = a, f_b = f_a, reach = V{} + small;
  Mask<V> is_open = f_a == f_a;
  for (int i = 0; i < most_widenings && any(is_open); ++i) {
    V next = positive_part(select(f_b > 0, b + reach, b - reach));
    next = select(next < longest, next, V{} + longest);
    const V f_next = excess(next);
    a = select(is_open, b, a), f_a = select(is_open, f_b, f_a);
    b = select(is_open, next, b), f_b = select(is_open, f_next, f_b);
    is_open = is_open && (f_a > 0) == (f_b > 0);
    reach = wider * reach;
  }
  return root_between(excess, a, f_a, b, f_b, V{} + nothing);
}

}  // namespace slipfront::interface
