// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "mesh/part.hpp"

namespace slipfront::statics {

/// Where bodies are cut across the interface into pieces, one for each process; enough to find the nodes to
/// which a piece's unknowns belong.
struct Cut {
  std::vector<int> first_column;                 ///< [pieces + 1] columns as NodeColumns counts them
  std::vector<std::vector<mesh::Node>> orphans;  ///< [bodies] nodes without cells and unknowns, ascending
  /// At the interface of two bodies: whose unknowns are relative displacements, see Piece.
  bool base_is_relative = false;

  int n_pieces() const { return static_cast<int>(first_column.size()) - 1; }
  /// [bodies] The nodes of a piece, in the order of its unknowns: those of one body after those of the other.
  std::vector<std::vector<mesh::Node>> nodes_of_piece(std::span<const mesh::NodeColumns> bodies,
                                                      int piece) const;
};

/// Displacements that processes keep together, each the unknowns of its piece.
struct KeptDisplacement {
  int number = 0;  ///< in each process's KeptDisplacements
  std::shared_ptr<const Cut> cut;
};

/// What one process keeps of such displacements, by number. All processes add theirs at the same time, so
/// that the numbers are the same.
class KeptDisplacements {
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
