// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "interface/interface.hpp"

namespace slipfront::interface {

/// Friction of laws with a state, psi, where inertia counts for no more than the waves that slip radiates.
/// All spans [nodes].
class QuasiDynamicFriction {
 public:
  /// @param radiation_damping_Pa_s_per_m  traction over slip rate of these waves
  /// @pre the laws of the model have a state
  QuasiDynamicFriction(const ContactModel& model, std::size_t n_nodes, double radiation_damping_Pa_s_per_m);

  /// Slip rates V at which p mu(V, psi) + (radiation damping) V = t, with its sign, and d psi/dt. A node with
  /// p <= 0 does not slip.
  void balance(std::span<const double> t_Pa, std::span<const double> p_Pa, std::span<const double> psi,
               std::span<double> slip_rate_m_per_s, std::span<double> psi_per_s) const;
  /// psi with which loading begins: by theta_i where that is given, else that of steady sliding at V_i.
  std::vector<double> initial_states() const;
  double radiation_damping_Pa_s_per_m() const { return radiation_damping_; }
  /// Change of psi by which the slip rate changes e-fold, and slip over which psi changes. [nodes]
  const std::vector<double>& a() const { return a_; }
  const std::vector<double>& d_c_m() const { return d_c_m_; }

 private:
  struct Evaluators;
  template <class Law>
  struct EvaluatorsOf;

  double radiation_damping_;
  std::shared_ptr<const Evaluators> laws_;  ///< [nodes]
  std::vector<double> initial_states_, a_, d_c_m_;
};

}  // namespace slipfront::interface
