// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/mesh.hpp"

namespace slipfront::mesh {

/// Some of the numbers of a whole, such as its columns of nodes, ascending, with the places that they have
/// among themselves.
class Subset {
 public:
  /// All numbers, each in its place.
  Subset() = default;
  /// @param ranges  ascending, not empty
  explicit Subset(std::vector<Span> ranges);

  const std::vector<Span>& ranges() const { return ranges_; }
  int count() const;
  bool has(int number) const;
  /// @pre the whole has it, or the subset its place
  int place_of(int number) const;
  int number_at(int place) const;
  /// Without the numbers from `end` on.
  Subset below(int end) const;
  /// Values of its numbers among those of the whole; none of none.
  template <class T>
  std::vector<T> of(const std::vector<T>& values) const {
    if (ranges_.empty() || values.empty()) return values;
    std::vector<T> some;
    for (const auto& range : ranges_)
      some.insert(some.end(), values.begin() + range.begin, values.begin() + range.end);
    return some;
  }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(ranges_);
  }

 private:
  std::vector<Span> ranges_;
};

/// The columns of a plate's nodes, counted in the smallest squares: node i of a grid row of the k-th block
/// upwards stands in column 2^k i, as does the inner node i of the transition above that block, where i is no
/// multiple of 4. Of a mesh that holds some columns of a plate they are those of the plate, the whole. Nodes
/// are those of the mesh, or of a whole plate that need not be held and may have more than a Node can number.
///
/// A mesh without a grid has one row, and each node stands in a separate column.
class NodeColumns {
 public:
  /// No nodes.
  NodeColumns() = default;
  /// Columns of a whole plate or mesh; of a plate the interface is enough, see make_interface.
  explicit NodeColumns(const Mesh& whole);
  /// Columns of a whole plate with these blocks, upwards.
  explicit NodeColumns(std::span<const Grid> blocks);
  /// The columns `held` of a plate with n_columns columns of nodes.
  NodeColumns(const Mesh& part, const Subset& held, int n_columns);
  /// Columns of a subdomain that holds some columns of this whole.
  NodeColumns of_subdomain(const Subset& held) const;

  int n_columns() const { return n_columns_; }  ///< of the whole
  std::int64_t n_nodes() const { return rows_.empty() ? 0 : row(n_rows() - 1).end(); }
  /// Rows of nodes, upwards: grid rows and, between blocks, the inner nodes of a transition.
  int n_rows() const { return static_cast<int>(rows_.size()); }
  /// Nodes with consecutive numbers, as many as the mesh has of a row.
  struct Nodes {
    std::int64_t first = 0;
    int count = 0;
    std::int64_t end() const { return first + count; }
  };
  Nodes row(int row) const { return {rows_[row].first, rows_[row].held.count()}; }
  /// A row's nodes in some neighbouring columns of the whole. @pre the mesh holds these
  Nodes nodes(int row, Span columns) const;
  int row_of(std::int64_t n) const;
  int column_of(std::int64_t n) const;
  /// The number that a node of the mesh has in the whole, and back. @pre the mesh holds it
  std::int64_t global_number(std::int64_t n) const;
  Node local_node(std::int64_t number) const;
  /// The column of a node of the whole, by its number there.
  int global_column_of(std::int64_t number) const;

 private:
  struct Row {
    int block = 0;
    bool is_inner = false;  ///< of a transition
    std::int64_t first = 0, first_global = 0;
    Subset held;  ///< places in the row of the whole
  };
  void add_rows(std::span<const Grid> blocks, const Subset& held);
  void add_row(int block, bool is_inner, const Subset& held);
  const Row& global_row_of(std::int64_t number) const;

  int n_columns_ = 0;
  bool is_whole_ = false;  ///< holds all columns
  std::vector<Row> rows_;
};

/// Columns over which the widest cells of a block, or of the transition above it, reach.
int columns_of_cells(const Mesh& mesh, int block);

/// Columns at either end in which cells are wrapped around a rounded corner; 0 where there is none.
int columns_of_wrapped_cells(const Mesh& mesh);

}  // namespace slipfront::mesh
