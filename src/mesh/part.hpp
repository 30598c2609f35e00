// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mesh/mesh.hpp"

namespace slipfront::mesh {

/// Some of the numbers of a whole, such as its columns of nodes, ascending, with the places that they have
/// among themselves.
class Subset {
 public:
  struct Range {
    int begin = 0, end = 0;
  };

  /// All numbers, each in its place.
  Subset() = default;
  /// @param ranges  ascending, not empty
  explicit Subset(std::vector<Range> ranges);

  const std::vector<Range>& ranges() const { return ranges_; }
  int count() const;
  bool has(int number) const;
  /// @pre the whole has it, or the subset its place
  int place_of(int number) const;
  int number_at(int place) const;
  /// Without the numbers from `end` on.
  Subset below(int end) const;

 private:
  std::vector<Range> ranges_;
};

/// The columns of nodes of a mesh that are among `columns`, with the cells between them: a mesh of its own,
/// whose nodes have the order of the whole one.
///
/// Right-angled, relieved and rounded corners keep their shape where the part holds them. The part's own
/// edges, where they are not the plate's, lack the cells beyond. A part of a plate that repeats has either a
/// single range of columns, or two: then it holds the cells that join the plate's sides, and the last column,
/// which has no cells, with them.
/// @pre the mesh has a grid of a single block
/// @throws UserError where a cut goes through the cells that are wrapped around a corner
Mesh columns_of(const Mesh& whole, const Subset& columns);

}  // namespace slipfront::mesh
