// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "mesh/node_columns.hpp"

namespace slipfront::statics {

/// Partition of the bodies across the interface into subdomains, one per rank; enough to find the nodes of a
/// subdomain's unknowns.
struct Partition {
  std::vector<int> first_column;                 ///< [subdomains + 1] columns as NodeColumns counts them
  std::vector<std::vector<mesh::Node>> orphans;  ///< [bodies] nodes without cells and unknowns, ascending
  /// At the interface of two bodies: whose unknowns are relative displacements, see Subdomain.
  bool base_is_relative = false;

  int n_subdomains() const { return static_cast<int>(first_column.size()) - 1; }
  /// [bodies] The nodes of a subdomain, in the order of its unknowns: those of one body after those of the
  /// other.
  std::vector<std::vector<mesh::Node>> nodes_of_subdomain(std::span<const mesh::NodeColumns> bodies,
                                                          int subdomain) const;
};

/// A displacement field distributed over the ranks, each with the unknowns of its subdomain.
struct DistributedField {
  int number = 0;  ///< in each process's DistributedFields
  std::shared_ptr<const Partition> partition;
};

/// One rank's share of such fields, by number. All ranks add theirs at the same time, so that numbers agree.
class DistributedFields {
 public:
  int add(std::vector<double> own) {
    own_.push_back(std::move(own));
    return static_cast<int>(own_.size()) - 1;
  }
  /// x and y of each own pair of unknowns.
  const std::vector<double>& own(int number) const { return own_.at(static_cast<std::size_t>(number)); }
  void forget(int number) { own_.at(static_cast<std::size_t>(number)) = {}; }
  void clear() { own_ = {}; }

 private:
  std::vector<std::vector<double>> own_;
};

}  // namespace slipfront::statics
