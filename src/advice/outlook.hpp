// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "advice/prediction.hpp"
#include "base/diagnostic.hpp"
#include "problem/problem.hpp"
#include "setup/initial_state.hpp"
#include "setup/meshes.hpp"
#include "stability/rupture.hpp"

namespace slipfront::advice {

/// What is to be expected of a case's rupture, from the tractions before it.
struct RuptureOutlook {
  /// Outlook of the nodes inside; before statics are solved, of one node at the critical state under the
  /// nominal pressure.
  stability::Outlook of_nodes;
  bool nominal = false;                    ///< tractions are not known yet
  std::optional<double> trigger_length_m;  ///< of the zone at an edge, or of the patch
  std::optional<double> process_zone_elements;
  /// Beyond it a node counts as slipping, under a law that never sticks.
  std::optional<double> tip_slip_rate_m_per_s;
  /// Where friction of such a law weakens with the slip rate, in words. Else empty.
  std::string steady_sliding;
  /// Its fronts as cracks, where that is known quickly.
  std::optional<FracturePrediction> cracks;
  std::vector<std::string> doubts;  ///< why nothing may rupture, a line each
  Diagnostics notes;                ///< what mesh, damping and trigger decide of it
};

/// Elements in a process zone at rest below which nobody calls it resolved (Day et al. 2005), which peaks
/// need, and which the place needs where fronts pass c_S.
inline constexpr double fewest_elements = 3, elements_for_peaks = 6, elements_for_transition = 16;
/// Whether fronts may pass c_S, as far as S tells: between equal bodies. It is not a number where it is
/// unknown.
inline bool may_pass_c_S(const stability::Bodies& bodies, double S) {
  return stability::are_alike(bodies) && !(S >= stability::supershear_S);
}
/// Damping length over the process zone; more moves the place where fronts pass c_S by more than some per
/// cent.
inline constexpr double harmless_damping = 0.02;

/// The least stiffness damping that leaves no waves of the mesh to grow, up to three digits; 0 where none do.
double advised_damping_s(const Problem& problem);

/// Why the event does not begin in this state, or begins everywhere at once; empty where it begins.
std::string doubt_of_beginning(const Problem& problem, const statics::Equilibrium& before);
/// That a forced patch has not its length before the end; empty where it has, or there is none.
std::string doubt_of_forced_patch(const Problem& problem);

/// Outlook of a case whose state before the event is known.
/// @param tributary_m  [interface nodes]
/// @param healed       see friction_at
RuptureOutlook rupture_outlook(const Problem& problem, const statics::Equilibrium& before,
                               std::span<const double> tributary_m, const std::vector<double>& healed = {});
/// Outlook of a case alone, whose tractions are known where they are prescribed.
RuptureOutlook rupture_outlook(const Problem& problem, const setup::Meshes& meshes);

}  // namespace slipfront::advice
