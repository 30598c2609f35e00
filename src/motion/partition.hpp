// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "mesh/mesh.hpp"
#include "mesh/node_columns.hpp"
#include "motion/probes.hpp"
#include "motion/settings.hpp"
#include "motion/step_plan.hpp"
#include "solid/operator.hpp"

namespace slipfront::motion {

/// Partition of the columns of nodes into subdomains, one per rank.
///
/// A subdomain owns some columns and computes ghost columns (the halo) beside them. An error enters at the
/// outermost ghost column, where cells are missing, and moves one column inwards per impulse; before it
/// reaches an owned column the owners send the ghost columns' motion (docs/processes.md).
struct Partition {
  std::vector<int> first;      ///< [subdomains + 1] where the own columns of each begin
  int halo = 0;                ///< columns beside them, as far as there are any
  int columns_per_step = 1;    ///< see the function of this name
  int steps_per_exchange = 1;  ///< after so many steps the halo is renewed
  /// Whether the plate repeats: the first subdomain and the last one are neighbours, and the whole has a
  /// column of nodes more, without cells.
  bool is_ring = false;

  int n_subdomains() const { return static_cast<int>(first.size()) - 1; }
  int n_columns() const { return first.back() + (is_ring ? 1 : 0); }  ///< of nodes of the whole
  solid::Span own(int subdomain) const { return {first[subdomain], first[subdomain + 1]}; }
  /// Own columns and halo.
  mesh::Subset all(int subdomain) const;
  /// Columns of its halo on either side, 0 where it has no neighbour.
  int halo_below(int subdomain) const { return n_subdomains() > 1 && (subdomain > 0 || is_ring) ? halo : 0; }
  int halo_above(int subdomain) const {
    return n_subdomains() > 1 && (subdomain + 1 < n_subdomains() || is_ring) ? halo : 0;
  }
  template <class Archive>
  void serialize(Archive& archive) {
    archive(first, halo, columns_per_step, steps_per_exchange, is_ring);
  }
};

/// Columns that the error at a subdomain's edge crosses within a step. An impulse carries it over the cells
/// that kick, those of a block 2^k columns, of the transition above it twice as many; as far as all the
/// impulses of a step's levels together do, one after the other. Two bodies kick at the same time.
int columns_per_step(std::span<const BodySource> bodies, const StepPlan& plan);

/// Subdomains of nearly equal width.
/// @param mesh              of the whole plate
/// @param columns_per_step  see there
/// @param reach             columns beyond its own that a subdomain looks at
Partition partition_columns(const mesh::Mesh& mesh, int n_subdomains, int columns_per_step, int reach);
/// Partition of bodies with grids.
/// @param steps  of each body
/// @throws UserError where the subdomains would be too narrow for their halo, would end at a rounded corner,
/// or
///         would have more nodes than can be numbered; it tells how many are possible
Partition partition_bodies(std::span<const BodySource> bodies, std::span<const BodySteps> steps,
                           const TimeStepping& time, int n_subdomains);

}  // namespace slipfront::motion
