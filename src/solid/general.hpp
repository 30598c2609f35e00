// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "mesh/mesh.hpp"
#include "solid/material.hpp"

namespace slipfront::solid {

struct Field;

/// Products with M^-1 K at listed nodes of any mesh, summed cell by cell.
///
/// A cell's forces do not change with a translation: with the displacements of three of its nodes relative to
/// the fourth, d, they are the 6 x 6 stiffness of these three times d, and the fourth node's force balances
/// the others. As many cells as a vector has lanes are computed at once. Regular cells that are similar
/// (equal but for place and size; a plane cell's stiffness does not depend on its size) share one stiffness,
/// the others have their own. The forces on a node are added up in the order of its cells in the mesh;
/// neither they nor a cell's stiffness depend on what other cells there are: in a part of a mesh they are
/// those of the whole. Neighbouring nodes should have near numbers, see mesh::near_numbers.
class GeneralRows {
 public:
  GeneralRows() = default;
  /// @param nodes    where the product is wanted, ascending
  /// @param mass_kg  [nodes of the mesh]
  /// @param in_part  cells that count
  GeneralRows(const mesh::Mesh& mesh, const Material& material, std::vector<mesh::Node> nodes,
              std::span<const double> mass_kg, const std::vector<bool>& in_part);

  const std::vector<mesh::Node>& node() const { return node_; }  ///< [rows]
  std::size_t size() const { return node_.size(); }
  std::size_t n_shared_stiffnesses() const;  ///< classes of similar regular cells

  /// Memory of one product.
  struct Workspace {
    std::vector<double> w;      ///< [nodes at the cells] x, y of each in turn
    std::vector<double> force;  ///< on the corners of each cell
  };
  Workspace workspace() const;

  /// a = M^-1 K (u + factor v) at the listed nodes. @param a_x, a_y  [rows]
  void multiply(const Field& u, double factor, const Field& v, Workspace& space, double* a_x,
                double* a_y) const;

 private:
  struct Cells;
  class Builder;
  std::vector<mesh::Node> node_;
  std::shared_ptr<const Cells> cells_;  ///< null without rows
};

}  // namespace slipfront::solid
