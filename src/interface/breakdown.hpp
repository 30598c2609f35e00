// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "interface/interface.hpp"
#include "record/breakdown.hpp"
#include "record/record.hpp"

namespace slipfront::interface {

/// What friction is at a node at the end of some time.
struct NodeFriction {
  double t_Pa = 0, p_Pa = 0;  ///< p is the pressure that the coefficient acts on
  double strength_Pa = 0, cohesion_Pa = 0;
  double slip_m = 0;  ///< over this time, with its sign
  bool slips = false;
};

/// Follows the breakdown of friction at nodes that have begun to slip, see record::Breakdown.
class BreakdownMonitor {
 public:
  explicit BreakdownMonitor(std::size_t n_nodes);

  /// Leaves out a node that slips from the start on.
  void leave_out(std::size_t node) { broken_[node] = 1; }

  /// After a time of length dt_s.
  /// @param some_begin  whether nodes may have begun to slip in it
  /// @param slips       of a node, 1 or 0
  /// @param friction    NodeFriction of a node; asked of few at a time
  template <class Slips, class Friction>
  void follow(double dt_s, bool some_begin, Slips&& slips, Friction&& friction) {
    const std::size_t n = breaking_.size();
    for (std::size_t i = 0; some_begin && i < n; ++i)
      if (slips(i) > (breaking_[i] | broken_[i])) begin(friction(i), i);
    // Eight flags are looked at in one word.
    for (std::size_t first = 0; first < n; first += sizeof(std::uint64_t)) {
      std::uint64_t flags = 0;
      std::memcpy(&flags, &breaking_[first], std::min(sizeof(flags), n - first));
      for (; flags != 0; flags &= flags - 1) {
        const auto i = first + static_cast<std::size_t>(std::countr_zero(flags)) / 8;
        follow(dt_s, friction(i), i);
      }
    }
  }
  bool has_begun(std::size_t node) const { return (breaking_[node] | broken_[node]) != 0; }

  /// What has been found so far at the nodes [first, end).
  /// @param cohesion_Pa  of a node
  template <class Cohesion>
  record::Breakdown found(std::size_t first, std::size_t end, Cohesion&& cohesion_Pa) const {
    record::Breakdown all;
    for (std::size_t i = first; i < end; ++i) add_found(i, cohesion_Pa(i), all);
    return all;
  }

  /// Calls f for each array of what it remembers. [nodes]
  template <class F>
  void for_each_array(F&& f) {
    f(breaking_);
    f(broken_);
    for (auto* values :
         {&peak_t_Pa_, &peak_coefficient_, &least_coefficient_, &residual_t_Pa_, &counted_coefficient_,
          &counted_slip_m_, &slip_m_, &work_of_t_J_per_m2_, &work_of_p_J_per_m2_, &impulse_of_t_Pa_s_,
          &impulse_of_p_Pa_s_, &work_J_per_m2_, &impulse_Pa_s_})
      f(*values);
  }

 private:
  void begin(const NodeFriction& now, std::size_t i);
  void follow(double dt_s, const NodeFriction& now, std::size_t i);
  void end(std::size_t i);
  void add_found(std::size_t i, double cohesion_Pa, record::Breakdown& all) const;

  // All [nodes].
  std::vector<std::uint8_t> breaking_, broken_;  ///< 1 while, and after, friction breaks down
  // At the peak, the least, and the last fall that counts; coefficients are (|t| - cohesion)/p.
  std::vector<double> peak_t_Pa_, peak_coefficient_, least_coefficient_, residual_t_Pa_;
  std::vector<double> counted_coefficient_, counted_slip_m_;
  // Sums since slip began, impulses since the peak.
  std::vector<double> slip_m_, work_of_t_J_per_m2_, work_of_p_J_per_m2_, impulse_of_t_Pa_s_,
      impulse_of_p_Pa_s_;
  // Integrals of the traction above the residual one, up to the least coefficient.
  std::vector<double> work_J_per_m2_, impulse_Pa_s_;
};

/// Pressure that the coefficient of friction acts on at a node.
double pressure_of_friction_Pa(const ContactModel& model, const Interface& state, std::size_t node);

/// Breakdown by the samples of a history, its integrals by trapezoids. A node slips while |slip rate| is
/// above threshold_m_per_s; slip begins with the sample before.
/// @pre numbers are finite, matrices of matching sizes
record::Breakdown breakdown_from_history(const record::History& history, double threshold_m_per_s,
                                         double cohesion_Pa);

}  // namespace slipfront::interface
