// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <optional>
#include <span>
#include <vector>

#include "interface/friction.hpp"
#include "interface/regularisation.hpp"
#include "solid/material.hpp"
#include "stability/compliance.hpp"
#include "stability/roots.hpp"

namespace slipfront::stability {

/// Uniform sliding to +x of a body y > 0 relative to what is below, and what friction does near it. The
/// contact is never lost. Derivations: docs/stability.md.
struct Sliding {
  double mu = 0;                     ///< coefficient at the sliding speed
  double slope_s_per_m = 0;          ///< d mu / d|v| there, at once; negative: weakening
  double slip_slope_per_m = 0;       ///< d mu / d slip, of a law that depends on slip
  double pressure_Pa = 0;            ///< uniform, positive in compression
  double relaxation_rate_per_s = 0;  ///< of a delayed response, at the sliding speed
  interface::Relaxed relaxed = interface::Relaxed::none;
  double state_slope_s_per_m = 0;  ///< what the state adds to the slope with a delay, of a law that has one
  double state_rate_per_s = 0;     ///< of that delay
};

/// Uniform sliding at a speed under a law; speed 0 is the limit of slow sliding.
Sliding uniform_sliding(const interface::FrictionLaw& law, double speed_m_per_s, double pressure_Pa,
                        const interface::Regularisation& regularisation = {});

/// A perturbation that goes with exp(i k x + s t), k > 0.
struct Mode {
  std::complex<double> s_per_s;

  double growth_per_s() const { return s_per_s.real(); }
  /// Phase velocity, positive with the sliding.
  double velocity_m_per_s(double wavenumber_per_m) const { return -s_per_s.imag() / wavenumber_per_m; }
};

/// Growing modes of a half-space on the rigid plane or on another half-space, fastest first. Growth below
/// 1e-6 |s| counts as neutral; |s| is sought between 1e-8 and 1e9 times k c_S, c_S of the body above.
/// @param expected  modes of a nearby problem, such as another wavenumber: make the search shorter
std::vector<Mode> growing_modes(const Bodies& bodies, const Sliding& sliding, double wavenumber_per_m,
                                std::span<const Mode> expected = {});

/// The first of them; empty where uniform sliding is stable at this wavenumber.
std::optional<Mode> fastest_growing_mode(const Bodies& bodies, const Sliding& sliding,
                                         double wavenumber_per_m);

/// Growing modes of a layer on the rigid plane whose upper edge y = height is held, fastest first. Without an
/// upper bound there are infinitely many in general: |s| is sought up to largest_rate_per_s, from 1e-3 c_S
/// max(k, 1/height).
std::vector<Mode> growing_layer_modes(const solid::Material& material, const Sliding& sliding,
                                      double wavenumber_per_m, double height_m, double largest_rate_per_s);

/// The relation of half-spaces, whose zeros are their modes, in p = s/(k c_S), c_S of the body above: for
/// other ways of finding them.
Complex half_space_relation(const Bodies& bodies, const Sliding& sliding, double wavenumber_per_m, Complex p);

}  // namespace slipfront::stability
