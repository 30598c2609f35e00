// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <functional>
#include <string>

#include "interface/interface.hpp"
#include "solid/material.hpp"
#include "stability/compliance.hpp"
#include "verification/verification.hpp"

namespace slipfront::verification {

using Complex = std::complex<double>;

/// A body that slides at speed V under uniform pressure, on the plane or on another body at rest, and a small
/// wave on it.
struct SlidingWave {
  stability::Bodies bodies;         ///< without damping; only a half-space lies on another one
  interface::ContactModel contact;  ///< V_i of a law with a state is the speed
  double pressure_Pa = 0;
  double speed_m_per_s = 0;
  double wavenumber_per_m = 0;
  Complex s_per_s;      ///< the start is the wave of this rate
  double height_m = 0;  ///< of a layer; 0 for a half-space
  int elements_per_wave = 0;
  double end_s = 0;
};

/// Growth rates and phase speeds over what they depend on.
struct RateCurves {
  Curve growth, speed;
  RateCurves(const std::string& label, Curve::Kind kind) : growth{label, kind}, speed(growth) {}
  void add(double at, double growth_rate, double phase_speed) {
    growth.add(at, growth_rate);
    speed.add(at, phase_speed);
  }
};
struct RateCharts {
  Chart growth, speed;
  RateCharts(const char* x_label, const char* growth_label, const char* speed_label)
      : growth{.x_label = x_label, .y_label = growth_label},
        speed{.x_label = x_label, .y_label = speed_label} {}
  /// Of the next curves of theory: one legend stands for all.
  const char* theory_label() const { return growth.curves.empty() ? "theory" : ""; }
  void add(const RateCurves& curves) {
    growth.curves.push_back(curves.growth);
    speed.curves.push_back(curves.speed);
  }
};

/// mu at this speed that falls with it.
interface::ContactModel weakening(double mu, double speed_m_per_s, double slope_s_per_m);

/// The program's rate of a mode on a mesh, in k c_S.
using CarriedRate = std::function<Complex(int elements_per_wave)>;
/// Checks the rate of a half-space's mode, in k c_S, extrapolated from 16, 32 and 64 elements per wave, and
/// returns it. Finer meshes carry shorter waves, whose growth would lift rounding up to the wave within the
/// run: e-fold pi elements (end k c_S) (growth/k c_S)/2 pi times, 22 at mu = 2 and 24 at mu = 1.3.
/// @param order, next_order  in h of the program's error
Complex check_mode(const std::string& what, const CarriedRate& carried, Complex expected, int order,
                   int next_order, Outcome& outcome);
/// Errors in k c_S over k h on meshes of 16 to 128 elements per wave, their order checked.
Curve check_order(const std::string& label, const std::string& what,
                  const std::function<double(int elements_per_wave)>& error, int order, Outcome& outcome);

/// The rate with which the program carries the wave: slope, by least squares, of the logarithm of the slip at
/// the wavenumber, with the phase counted through. A half-space is as high as a longitudinal wave from its
/// far edge needs to arrive at the end; a layer's height is rounded to whole elements beforehand.
Complex carried_rate_per_s(const SlidingWave& wave);

}  // namespace slipfront::verification
