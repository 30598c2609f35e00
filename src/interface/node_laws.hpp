// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <vector>

#include "base/lanes.hpp"
#include "interface/friction.hpp"

namespace slipfront::interface {

/// A friction law per node, all of one type, and their constants as the loop over nodes takes them: those of
/// `lanes` nodes side by side, in blocks.
class NodeLaws {
 public:
  /// None.
  NodeLaws() = default;
  explicit NodeLaws(std::vector<FrictionLaw> laws);

  bool empty() const { return laws_.empty(); }
  std::size_t size() const { return laws_.size(); }
  const FrictionLaw& operator[](std::size_t node) const { return laws_[node]; }

  /// The constants of the nodes from lanes * block on, those of the last node in lanes left over.
  /// @tparam Constants  the law's evaluator for Lanes with constants of Lanes, then its coefficient at rest
  ///                    and its kinetic one
  template <class Constants>
  Constants constants(std::size_t block) const {
    static_assert(sizeof(Constants) % sizeof(Lanes) == 0);
    std::array<Lanes, sizeof(Constants) / sizeof(Lanes)> values;
    const double* from = constants_.data() + block * values.size() * lanes;
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = load(from + k * lanes);
    return std::bit_cast<Constants>(values);
  }

 private:
  std::vector<FrictionLaw> laws_;  ///< [nodes]
  std::vector<double> constants_;  ///< [blocks x constants x lanes]
};

}  // namespace slipfront::interface
