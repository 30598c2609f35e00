// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace slipfront {

/// A quantity at nodes: one value for all of them, or one for each.
class PerNode {
 public:
  PerNode(double of_all = 0) : of_all_(of_all) {}                         // NOLINT: a value is one for all
  PerNode(std::vector<double> of_each) : of_each_(std::move(of_each)) {}  // NOLINT
  double operator[](std::size_t node) const { return of_each_.empty() ? of_all_ : of_each_[node]; }
  /// The values of so many nodes.
  std::vector<double> at_all(std::size_t n_nodes) const {
    return of_each_.empty() ? std::vector<double>(n_nodes, of_all_) : of_each_;
  }

 private:
  double of_all_ = 0;
  std::vector<double> of_each_;
};

}  // namespace slipfront
