// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <string>
#include <vector>

#include "interface/interface.hpp"
#include "solid/material.hpp"
#include "stability/compliance.hpp"
#include "verification/verification.hpp"

namespace slipfront::verification {

using Complex = std::complex<double>;

struct Displacement {
  Complex x, y;
};

/// Displacements of a wave exp(i k x + s t) in an undamped body y > 0: two potentials that fall from the
/// interface and, in a layer whose upper edge is held, two that fall from there.
class WaveShape {
 public:
  /// In a half-space whose edge moves by this much.
  WaveShape(const solid::Material& material, double wavenumber_per_m, Complex s_per_s,
            const Displacement& edge);
  /// In a layer that stays on the plane (u_y = 0 at y = 0), scaled to u_x = 1 at y = 0.
  WaveShape(const solid::Material& material, double wavenumber_per_m, Complex s_per_s, double height_m);

  Complex u_x(double y_m) const { return y_m == 0 ? edge_.x : sum(u_x_, y_m); }
  Complex u_y(double y_m) const { return y_m == 0 ? edge_.y : sum(u_y_, y_m); }
  Complex pressure_Pa_per_m() const { return pressure_; }  ///< on the interface

 private:
  void set_potentials(const solid::Material& material, Complex s_per_s);
  void set_amplitudes(const solid::Material& material, const std::array<Complex, 4>& amplitude);
  Complex sum(const std::array<Complex, 4>& amplitude, double y_m) const;

  double k_per_m_, height_m_;
  Displacement edge_;
  std::array<Complex, 4> rate_per_m_, u_x_, u_y_;  ///< of exp(rate (y - origin))
  Complex pressure_;
};

/// A body that slides at speed V under uniform pressure, on the plane or on another body at rest, and a small
/// wave on it.
struct SlidingWave {
  stability::Bodies bodies;  ///< without damping; only a half-space lies on another one
  interface::ContactModel contact;
  double pressure_Pa = 0;
  double speed_m_per_s = 0;
  double wavenumber_per_m = 0;
  Complex s_per_s;      ///< the start is the wave of this rate
  double height_m = 0;  ///< of a layer; 0 for a half-space
  int elements_per_wave = 0;
  double end_s = 0;
};

/// Slip at the wavenumber over its value at time 0, its logarithm with the phase counted
/// through.
struct Growth {
  std::vector<double> time_s;
  std::vector<Complex> log_slip;
  Complex rate_per_s() const;  ///< slope of the line of least squares
};

/// Growth rates and phase speeds over what they depend on.
struct RateCurves {
  Curve growth, speed;
  RateCurves(const std::string& label, Curve::Kind kind);
  void add(double at, double growth_rate, double phase_speed);
};
struct RateCharts {
  Chart growth, speed;
  RateCharts(const char* x_label, const char* growth_label, const char* speed_label);
  /// Of the next curves of theory: one legend stands for all.
  const char* theory_label() const { return growth.curves.empty() ? "theory" : ""; }
  void add(const RateCurves& curves);
};

/// Simulates the wave. A half-space is as high as a longitudinal wave from its far edge needs to
/// arrive at the end; a layer's height is rounded to whole elements beforehand.
Growth simulate(const SlidingWave& wave);

}  // namespace slipfront::verification
