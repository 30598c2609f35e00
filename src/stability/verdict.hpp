// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string>

#include "stability/modes.hpp"

namespace slipfront::stability {

/// Whether slow uniform sliding of a half-space on the rigid plane or on another one, as a mesh sees it, has
/// a growth that a finer mesh would not change.
struct WellPosedness {
  Sliding sliding;                  ///< in the limit of slow sliding
  double grid_wavelength_m = 0;     ///< 2 h, the shortest that the mesh carries
  double growth_at_grid_per_s = 0;  ///< of the fastest mode there, 0 where none grows; see has_verdict
  bool unbounded = false;           ///< growth has no bound as the wavelength goes to zero: ill-posed
  /// -mu'(0) p over the radiation damping; above 1 strength drops at once on slip.
  double weakening_over_radiation = 0;
  /// Fastest growth among all waves up to the longest; infinite where unbounded, 0 where none grows.
  double fastest_growth_per_s = 0;
  /// Its wavelength; 0 where growth rises to the end of the search, at ever shorter waves.
  double fastest_wavelength_m = 0;
  double longest_wavelength_m = 0;  ///< of the search
  /// Fastest growth times h/c_L, of two bodies the faster one's: above 1 no step follows it.
  double growth_in_crossing = 0;
  double damping_length_m = 0;  ///< beta_R c_L: much shorter waves are overdamped
  double damping_length_over_h = 0;
  std::string statement;  ///< one plain line
  /// False where rounding hides which waves grow: growth is not a number then.
  bool has_verdict() const { return !std::isnan(fastest_growth_per_s); }
};

/// @param longest_wavelength_m such as the length of the interface.
WellPosedness well_posedness(const Bodies& bodies, const interface::FrictionLaw& law, double pressure_Pa,
                             double element_size_m, double longest_wavelength_m,
                             const interface::Regularisation& regularisation = {});

double slower_c_L_m_per_s(const Bodies& bodies);

/// beta_R c_L, of two bodies the larger beta_R times the slower c_L: a front, which the slower body bounds,
/// makes waves of one frequency in both.
double damping_length_m(const Bodies& bodies);

/// Shear traction per slip rate of waves that leave the interface at right angles: G/c_S on the rigid plane,
/// of two bodies half the harmonic mean.
double radiation_damping_Pa_s_per_m(const Bodies& bodies);

/// Whether growth is unbounded as k grows, from the relation's limits (docs/stability.md).
bool growth_is_unbounded(const Bodies& bodies, const Sliding& sliding);

/// beta_R from which on waves of a few elements do not grow on the mesh alone: 0.1 h/c_S where friction
/// follows the pressure at once and slip changes it, 0.35 h/c_S where friction weakens with the slip rate
/// besides; of two bodies the slower one's c_S, and both need it. 0 between equal bodies, where slip does not
/// change the pressure, and where the response is delayed. verification/growing_modes.md
double damping_of_grid_waves_s(const Bodies& bodies, const interface::FrictionLaw& law,
                               const interface::Regularisation& regularisation, double element_size_m);

}  // namespace slipfront::stability
