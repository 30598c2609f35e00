// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/exponential.hpp"
#include "base/numbers.hpp"

namespace slipfront::interface {

/// Which quantity follows its instantaneous value with a delay.
enum class Relaxed {
  none,              ///< strength S = mu p at once
  strength,          ///< dS/dt = rate (mu p - S)
  pressure,          ///< dq/dt = rate (p - q), S = mu q
  initial_pressure,  ///< S = mu p_s in contact, p_s the pressure before the event: no rate
};

/// Delayed response of friction to changes of pressure (Prakash and Clifton 1993, simplified): the quantity
/// relaxes at the rate (|v| + v*) / L + 1 / t*. An infinite L leaves a constant rate, an infinite t* one that
/// depends on the slip rate alone.
struct Regularisation {
  Relaxed relaxed = Relaxed::none;
  double length_m = infinity;    ///< L
  double slip_rate_m_per_s = 0;  ///< v*
  double time_s = infinity;      ///< t*
};

/// Whether a quantity relaxes.
inline bool has_rate(const Regularisation& r) {
  return r.relaxed == Relaxed::strength || r.relaxed == Relaxed::pressure;
}

/// Whether the strength follows the pressure, at once or with a delay.
inline bool follows_pressure(const Regularisation& r) {
  return r.relaxed != Relaxed::initial_pressure;
}

/// Relaxation rate at a slip rate, 1/s.
inline double relaxation_rate_per_s(const Regularisation& r, double speed_m_per_s) {
  return (speed_m_per_s + r.slip_rate_m_per_s) / r.length_m + 1 / r.time_s;
}

/// How a relaxed quantity q follows its target over a time dt in which the target goes linearly from T0 to
/// T1: q1 = T1 - lag (T1 - T0) + left (q0 - T0), exact; left = exp(-x), lag = (1 - exp(-x))/x, x = rate dt.
template <class V>
struct Following {
  V left, lag;
  explicit Following(V x) {
    const auto parts = decay(x);
    const auto takes_time = x > 0;
    left = parts.left;
    lag = select(takes_time, parts.lost, V{} + 1) / select(takes_time, x, V{} + 1);
  }
  V operator()(V from_Pa, V target_before_Pa, V target_Pa) const {
    return target_Pa - lag * (target_Pa - target_before_Pa) + left * (from_Pa - target_before_Pa);
  }
};

/// Relaxation at the slip rate of a node, through a time dt.
struct Relaxation {
  double at_rest, dt_per_length_s_per_m;
  Relaxation(const Regularisation& r, double dt_s)
      : at_rest(dt_s * relaxation_rate_per_s(r, 0)), dt_per_length_s_per_m(dt_s / r.length_m) {}
  template <class V>
  Following<V> at(V speed_m_per_s) const {
    return Following<V>(at_rest + speed_m_per_s * dt_per_length_s_per_m);
  }
};

/// The relaxed quantity of a node at a contact update, and its target there.
template <class V>
struct Memory {
  V relaxed_Pa{}, target_Pa{};
};

// How the strength of a node follows. `step` gives what the time since the last update decides, at the slip
// rate of that time; `now` is the memory with the coefficient of this update. The relaxed quantity follows
// one equation whether the node sticks, slips or is open; an open node (p = 0) forgets at the same rate, and
// has no strength whatever is left of its memory.

/// The strength follows at once.
struct Immediate {
  static constexpr bool remembers = false;
  struct Step {};
  template <class V>
  Step step(V /*speed_m_per_s*/) const {
    return {};
  }
  template <class V>
  static Memory<V> now(Step, const Memory<V>& /*before*/, V /*mu*/, V /*p_Pa*/) {
    return {};
  }
  template <class V>
  static V strength(V mu, V p_Pa, const Memory<V>& /*now*/) {
    return mu * p_Pa;
  }
  static Memory<double> initial(double /*mu*/, double /*p_Pa*/) { return {}; }
};

/// A stuck node keeps the strength with which it stuck and regains the static one at the rate for |v| = 0.
struct RelaxedStrength {
  static constexpr bool remembers = true;
  Relaxation relaxation;
  template <class V>
  auto step(V speed_m_per_s) const {
    return relaxation.at(speed_m_per_s);
  }
  template <class V>
  static Memory<V> now(const Following<V>& following, const Memory<V>& before, V mu, V p_Pa) {
    return {following(before.relaxed_Pa, before.target_Pa, mu * p_Pa), mu * p_Pa};
  }
  template <class V>
  static V strength(V /*mu*/, V p_Pa, const Memory<V>& now) {
    return select(p_Pa > 0, now.relaxed_Pa, V{});
  }
  static Memory<double> initial(double mu, double p_Pa) { return {mu * p_Pa, mu * p_Pa}; }
};

/// The coefficient acts on a pressure that is remembered.
struct RememberedPressure {
  static constexpr bool remembers = true;
  template <class V>
  static V strength(V mu, V p_Pa, const Memory<V>& now) {
    return select(p_Pa > 0, mu * now.relaxed_Pa, V{});
  }
  static Memory<double> initial(double /*mu*/, double p_Pa) { return {p_Pa, p_Pa}; }
};

/// The coefficient acts at once, so that a stuck node has the static coefficient times the relaxed pressure.
struct RelaxedPressure : RememberedPressure {
  Relaxation relaxation;
  explicit RelaxedPressure(const Relaxation& r) : relaxation(r) {}
  template <class V>
  auto step(V speed_m_per_s) const {
    return relaxation.at(speed_m_per_s);
  }
  template <class V>
  static Memory<V> now(const Following<V>& following, const Memory<V>& before, V /*mu*/, V p_Pa) {
    return {following(before.relaxed_Pa, before.target_Pa, p_Pa), p_Pa};
  }
};

/// The strength does not depend on pressure in contact: the coefficient acts on the one before the event.
struct InitialPressure : RememberedPressure {
  struct Step {};
  template <class V>
  Step step(V /*speed_m_per_s*/) const {
    return {};
  }
  template <class V>
  static Memory<V> now(Step, const Memory<V>& before, V /*mu*/, V /*p_Pa*/) {
    return before;
  }
};

/// Calls f with the form that the settings name. The choice is made once per contact update.
template <class F>
auto with_regularisation(const Regularisation& r, double dt_s, F&& f) {
  if (r.relaxed == Relaxed::strength) return f(RelaxedStrength{{r, dt_s}});
  if (r.relaxed == Relaxed::pressure) return f(RelaxedPressure({r, dt_s}));
  if (r.relaxed == Relaxed::initial_pressure) return f(InitialPressure{});
  return f(Immediate{});
}

}  // namespace slipfront::interface
