// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "statics/top_pressure.hpp"

namespace slipfront::statics {

/// What the solvers take their dense and sparse algebra from: "Eigen 3.4.0".
std::string algebra_library();

inline constexpr const char* interrupted_in_statics = "interrupted in the statics";

/// How the state before the event comes about: by tilt and shear of the top edge, or prescribed.
enum class LoadingMethod {
  direct,  ///< tilt, then shear by static equilibria from a sparse factorisation
  ramp,    ///< tilt, then shear by explicit dynamics with the top edge moving
  /// Tractions of the interface are given; the plate is at rest with u = 0, its motion is what they change.
  prestress,
};

/// Whether the top edge's nodes may move along x while it is tilted.
enum class TopEdge { held, free };

/// How static equilibria are solved.
enum class StaticSolver {
  automatic,  ///< by a factorisation up to a number of unknowns, iteratively beyond
  direct,     ///< sparse factorisation, the interface condensed
  iterative,  ///< conjugate gradients with a multigrid preconditioner
};

/// Displacements of the top edge: pushed down along a line, then moved to +x; or the forces of the interface
/// that they are to give. Forces are per unit thickness.
struct Loading {
  double tilt_left_m = 0.25e-3;  ///< downward displacement at the left end
  double tilt_right_m = 0.2e-3;  ///< ... at the right end, linear between
  TopEdge top_during_tilt = TopEdge::held;
  LoadingMethod method = LoadingMethod::direct;
  StaticSolver solver = StaticSolver::automatic;
  double shear_speed_m_per_s = 1.5844024039000516e-3;  ///< v_x of the top edge: 1e-6 c_L of PMMA
  double edge_margin_m = 5e-3;  ///< "inside" the interface leaves out this much at each end of the contact
  double critical_margin =
      1e-3;  ///< common state at t/p = (1 - margin) mu_s inside, spontaneous event at (1 + margin)
  /// At most one of the three, of the state before any shear; then tilt_left_m and tilt_right_m do not count.
  std::optional<double> normal_force_N_per_m = {}, mean_pressure_Pa = {};
  TopPressure top_pressure = {};
  /// With the first two: how much further down the left end goes than the right one.
  double tilt_difference_m = 0;
  /// Force of the subcritical state, at most one of the two; then critical_margin does not count.
  std::optional<double> shear_force_N_per_m = {}, shear_over_critical = {};
};

/// The normal force that is asked for, of an interface of a given width; none where displacements are.
inline std::optional<double> normal_force_N_per_m(const Loading& loading, double width_m) {
  if (loading.mean_pressure_Pa) return *loading.mean_pressure_Pa * width_m;
  if (loading.top_pressure.is_there()) return loading.top_pressure.force_N_per_m(width_m);
  return loading.normal_force_N_per_m;
}

/// Whether the shear of the common state is asked for by its force.
inline bool is_sheared_by_force(const Loading& loading) {
  return loading.shear_force_N_per_m || loading.shear_over_critical;
}

}  // namespace slipfront::statics
