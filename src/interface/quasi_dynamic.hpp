// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "interface/interface.hpp"

namespace slipfront::interface {

/// Friction of laws with states, where inertia counts for no more than the waves that slip radiates. All
/// spans and lists [nodes].
class QuasiDynamicFriction {
 public:
  /// @param radiation_damping_Pa_s_per_m  traction over slip rate of these waves
  /// @pre the laws of the model have states
  QuasiDynamicFriction(const ContactModel& model, std::size_t n_nodes, double radiation_damping_Pa_s_per_m);

  /// Slip rates V at which p mu(V, states) + (radiation damping) V = t, with its sign, and d states/dt. A
  /// node with p <= 0 does not slip.
  /// @param short_s  in which states change evenly: rates that the law does not give are those of this time
  void balance(std::span<const double> t_Pa, std::span<const double> p_Pa, const LawStates& states,
               double short_s, std::span<double> slip_rate_m_per_s, LawStates& states_per_s) const;
  /// With which loading begins: what the law gives, else those of steady sliding at V_i.
  const LawStates& initial_states() const { return initial_states_; }
  /// Whether d states/dt are those of short_s.
  bool takes_differences() const;
  double radiation_damping_Pa_s_per_m() const { return radiation_damping_; }
  /// d mu/d ln V at once, and slip over which states change.
  const std::vector<double>& a() const { return a_; }
  const std::vector<double>& d_c_m() const { return d_c_m_; }
  /// A change of each state, over that by which the slip rate changes e-fold: the largest of a node.
  template <class Change>
  double change(std::size_t node, const Change& of_state) const {
    double largest = 0;
    for (std::size_t k = 0; k < state_scales_.size(); ++k)
      largest = std::max(largest, std::abs(of_state(k)) / state_scales_[k][node]);
    return largest;
  }

 private:
  struct Nodes;
  template <class Law>
  struct NodesOf;
  struct NodesOfFunction;

  double radiation_damping_;
  std::shared_ptr<const Nodes> nodes_;
  LawStates initial_states_, state_scales_;
  std::vector<double> a_, d_c_m_;
};

}  // namespace slipfront::interface
