// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "base/numbers.hpp"
#include "base/per_node.hpp"
#include "record/record.hpp"

namespace slipfront::fronts {

/// What of the solid the energy density needs.
struct Elasticity {
  double youngs_modulus_Pa = 0;
  double poissons_ratio = 0;
  bool plane_strain = false;
};

/// Heuristic energy density of the tractions (t, p) with the in-plane stress left out, J/m3 (Kammer et al.
/// 2012, Eq. 2): (2 (1 + nu) t^2 + p^2) / (2E) in plane stress; p^2 becomes (1 - nu^2) p^2 in plane strain.
double energy_density_J_per_m3(const record::Traction& traction, const Elasticity& elasticity);

/// A part of the interface.
struct Zone {
  double from_m = 0, to_m = 0;
};

/// Where the length l* lies over which the tip's speed is taken, against the node at x.
enum class SpeedInterval {
  centred,   ///< x - l*/2 to x + l*/2
  approach,  ///< x - l* to x: from where t_d and p_d are taken to where t_r and p_r are
};

/// How fronts are found and measured. Lengths in m, times in s.
struct FrontOptions {
  double l_star_m = 0.67e-3;  ///< length over which the speed is taken; one element where that is longer
  SpeedInterval speed_interval = SpeedInterval::centred;
  double arrest_time_s = 20e-6;  ///< a tip that waits longer than this for its next onset has arrested
  /// Whether a tip waits longer where the event is slow: see arrest_time_s().
  bool arrest_time_by_event = false;
  double min_length_m =
      2e-3;                  ///< a shorter path, or a jump ahead no longer than this, is no front of its own
  double crack_share = 0.5;  ///< crack-like above this share of slipping length to distance run
  double pulse_share = 0.2;  ///< pulse-like below it
  /// Static friction coefficient and cohesion, for U_r = U(p_r, mu_s p_r + cohesion).
  PerNode mu_s = 0, cohesion_Pa = 0;
  Elasticity elasticity;
  double exclude_left_m = -infinity;  ///< no t_d, p_d at x below it (trigger zone)
  double exclude_right_m = infinity;  ///< ... nor above it
  double exclude_from_m = infinity;   ///< ... nor from here (nucleation patch)
  double exclude_to_m = -infinity;    ///< ... to here
  /// The trigger zone, or the nucleation patch itself: no v_tip there, both ends included.
  std::vector<Zone> driven;
  double mode_fraction = 0.8;  ///< of a front's points with a slipping share that must agree on its mode
  /// Whether contact ends at the first and the last node; beyond those of an experiment nothing is known.
  bool whole_interface = true;
  std::function<void()> pause;  ///< called now and then; what it throws ends the search
};

/// The longest wait of a tip that has not arrested: options.arrest_time_s or, with arrest_time_by_event and
/// where it is longer, 3 times what a front takes for min_length_m (the median spacing where that is longer)
/// at the median speed between neighbours. Those that slip at the same time or lie in `driven` do not count.
double arrest_time_s(const record::SlipRecord& record, const FrontOptions& options);

/// Whether x lies in a zone that is left out.
inline bool is_excluded(const FrontOptions& o, double x_m) {
  return x_m < o.exclude_left_m || x_m > o.exclude_right_m ||
         (x_m >= o.exclude_from_m && x_m <= o.exclude_to_m);
}

/// Whether x lies in a zone where the nodes slip when the trigger makes them.
bool is_driven(const FrontOptions& options, double x_m);

/// Why a front ends.
enum class End {
  arrest,       ///< no onset ahead for arrest_time_s
  meets_front,  ///< the interface ahead has slipped already, or slips under another front
  contact_end,  ///< no node ahead, or the next one is out of contact before the event (p_s <= 0)
  record_edge,  ///< the last place of a record that knows nothing of what is beyond
  record_end,   ///< the record ends while the front may still run
};
std::string_view name(End end);

/// Kind of slip by the share of the distance run that still slips behind the tip.
enum class SlipMode { crack, pulse, mixed };
std::string_view name(SlipMode mode);

/// What the time says that a tip takes for the length l* at a node.
enum class SpeedKind {
  front,         ///< v_tip: slip may have been passed on from node to node
  triggered,     ///< no v_tip: one of the nodes that the length lies between is in a zone of `driven`
  simultaneous,  ///< no v_tip: these nodes begin to slip faster than the computation passes anything on
  path_end,      ///< no v_tip: the length leaves the path
};
std::string_view name(SpeedKind kind);

/// A front's passage over one node. What is undefined there is NaN.
struct FrontPoint {
  std::int32_t node = 0;
  double x_m = 0;
  double onset_s = 0;
  double v_tip_m_per_s = nan;                  ///< speed over l*, positive in the front's own direction
  double t_s_Pa = nan, p_s_Pa = nan;           ///< before the event
  double t_d_Pa = nan, p_d_Pa = nan;           ///< when the front is l* short of x
  double t_r_Pa = nan, p_r_Pa = nan;           ///< at the onset
  double U_s_J_per_m3 = nan;                   ///< U(p_d, t_d)
  double U_r_J_per_m3 = nan;                   ///< U(p_r, mu_s p_r), with the cohesion
  double slipping_share = nan;                 ///< slipping length behind the tip over the distance run
  bool accelerating = false;                   ///< v_tip rises along the path, see find_fronts
  SpeedKind speed_kind = SpeedKind::path_end;  ///< v_tip is defined where it is `front`, nowhere else
};

/// A path of onsets, continuous in x, in one direction.
struct Front {
  int id = 0;
  int direction = 0;               ///< +1 or -1 along x
  std::vector<FrontPoint> points;  ///< in the order of travel
  End end = End::record_end;
  SlipMode mode = SlipMode::mixed;  ///< of the whole path
};

/// Finds all fronts in the first onsets of a record and measures them. Sorted by the time of their start.
///
/// Paths. Onsets are taken in the order of time. An onset ahead of a tip belongs to that front if it is the
/// next node, or no farther than min_length_m, and comes within arrest_time_s (see arrest_time_s()) of the
/// tip's last one; of several tips the nearest takes it (of two at the same distance the one that has waited
/// longer). Any other onset is a nucleation, the start of one front to each side. So a node that slips a
/// little early, late, long before or never does not split a front. A node that a front jumps over is a point
/// of it if it slips within arrest_time_s of that; otherwise it is missing in it. Paths shorter than
/// min_length_m are left out of the result.
///
/// Measures. The tip passes x when the first node at or beyond x on the path slips; between nodes the time
/// is linear in x. l* at a node is the longest of l_star_m and the elements beside the node.
/// - v_tip: l* over the time that the tip needs for it, see SpeedInterval. Undefined, for the reason that
///   speed_kind has, where that leaves the path; where it lies between nodes of which one is in the trigger
///   zone or the nucleation patch, where nodes slip when the trigger makes them; and where nothing can have
///   travelled: a computation passes information by one node per resolution_s, and an onset lies anywhere
///   within that time, so that slip passed on over n elements takes more than (n - 1) resolution_s. Nodes n
///   elements apart that begin to slip within max(n - 1, 1) resolution_s are simultaneous.
/// - t_d, p_d: linear in tip position between the two nodes that bracket the tip (a tip within 2 % of their
///   distance from a node is at that node). Undefined, with U_s and U_r, within l* of the start, in the
///   zones of exclude_*, where the tip jumps over x - l* and x at once, and where the halo is too small:
///   l*/element length + 1 nodes are enough where the path has no gap.
/// - slipping_share: at the tip's passage, the length of the contiguous slipping zone behind the tip over
///   the distance from the start. Sticking nodes between slipping ones no farther than min_length_m apart do
///   not end the zone. Undefined within 5 l* of the start.
/// - mode: crack (pulse) if at least mode_fraction of the defined shares are above crack_share (below
///   pulse_share).
/// - accelerating: the least-squares slope of v_tip over the points within 3 mm (at least 4 on each side,
///   where there are as many) is positive.
///
/// @pre state.x_m equals record.x_m; onset nodes are valid; `around` is complete.
std::vector<Front> find_fronts(const record::SlipRecord& record, const record::StaticState& state,
                               const FrontOptions& options);

}  // namespace slipfront::fronts
