// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "base/error.hpp"
#include "base/lanes.hpp"
#include "base/numbers.hpp"
#include "interface/friction.hpp"

namespace slipfront::interface {

/// Coefficients of a law over arrays for what is computed node by node: what has been answered, evaluation by
/// evaluation, and what is asked for beyond it.
class Answers {
 public:
  explicit Answers(std::size_t n_nodes) : n_nodes_(n_nodes) {}

  /// Calls attempt(), which begins from the same state each time, until it has asked for nothing.
  /// @param law  fills in mu for slip rates and slip paths [nodes]
  template <class Attempt, class Law>
  void complete(const Attempt& attempt, const Law& law) {
    const std::size_t padded = (n_nodes_ + lanes - 1) / lanes * lanes;
    while (true) {
      asks_ = false;
      speed_m_per_s_.assign(padded, 1);
      slip_m_.assign(padded, 0);
      attempt();
      if (!asks_) return;
      auto& mu = mu_.emplace_back(padded);
      law(std::span<const double>(speed_m_per_s_.data(), n_nodes_),
          std::span<const double>(slip_m_.data(), n_nodes_), std::span<double>(mu.data(), n_nodes_));
      std::fill(mu.begin() + static_cast<std::ptrdiff_t>(n_nodes_), mu.end(), mu[n_nodes_ - 1]);
    }
  }

  /// The evaluator of the nodes from one on: its k-th call takes the k-th answer, or asks.
  template <class V>
  struct Evaluator {
    Answers* answers;
    std::size_t node = 0;
    mutable std::size_t calls = 0;

    V operator()(V speed_m_per_s, V slip_m) const {
      const std::size_t k = calls++;
      if (k < answers->mu_.size()) return load_as<V>(answers->mu_[k].data() + node);
      if (k == answers->mu_.size()) {
        store(answers->speed_m_per_s_.data() + node, speed_m_per_s);
        store(answers->slip_m_.data() + node, slip_m);
        answers->asks_ = true;
      }
      return V{} + nan;  // no iteration goes on from there
    }
    // As that of a law with states, which do not change meanwhile.
    using States = std::array<V, 0>;
    V coefficient(V speed_m_per_s, const States& /*states*/) const {
      constexpr double slowest = 1e-300;  // laws over arrays are asked for rates above 0
      return (*this)(select(speed_m_per_s > slowest, speed_m_per_s, V{} + slowest), V{});
    }
    static States evolved(const States& states, V /*speed_m_per_s*/, double /*dt_s*/) { return states; }
  };

 private:
  std::size_t n_nodes_;
  std::vector<std::vector<double>> mu_;  ///< [evaluations][nodes, all lanes full]
  std::vector<double> speed_m_per_s_, slip_m_;
  bool asks_ = false;
};

/// mu of a law with states, of given ones.
inline void coefficients(const StateArrayLaw& law, std::span<const double> speed_m_per_s,
                         const LawStates& states, std::span<double> mu) {
  law.coefficient(speed_m_per_s, states, mu);
  constexpr double at_rest_m_per_s = 1e-200, little = 1e-3;
  for (std::size_t i = 0; i < mu.size(); ++i)
    if (speed_m_per_s[i] < at_rest_m_per_s && mu[i] > little)
      throw UserError("mu is {:.3g} without slip; under a law with a state it is 0 there", mu[i]);
}

}  // namespace slipfront::interface
