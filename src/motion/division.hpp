// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "mesh/mesh.hpp"
#include "mesh/part.hpp"
#include "motion/probes.hpp"
#include "motion/settings.hpp"
#include "solid/operator.hpp"

namespace slipfront::motion {

/// How the columns of nodes of a plate are divided into parts, one for each process.
///
/// A part accounts for its own columns and computes a halo beside them as well. What it computes there is
/// wrong first in the outermost column, where cells are missing, and one column further in with each push;
/// before that reaches a column which counts, the owners send the halo's motion (docs/processes.md).
struct Division {
  std::vector<int> first;      ///< [parts + 1] where the own columns of each begin
  int halo = 0;                ///< columns beside them, as far as there are any
  int columns_per_step = 1;    ///< see the function of this name
  int steps_per_exchange = 1;  ///< after so many steps the halo is renewed
  /// Whether the plate repeats: the first part and the last one are neighbours, and the whole has a column of
  /// nodes more, without cells.
  bool is_ring = false;

  int n_parts() const { return static_cast<int>(first.size()) - 1; }
  int n_columns() const { return first.back() + (is_ring ? 1 : 0); }  ///< of nodes of the whole
  solid::Span own(int part) const { return {first[part], first[part + 1]}; }
  /// Own columns and halo.
  mesh::Subset all(int part) const;
  /// Columns of its halo on either side, 0 where it has no neighbour.
  int halo_below(int part) const { return n_parts() > 1 && (part > 0 || is_ring) ? halo : 0; }
  int halo_above(int part) const { return n_parts() > 1 && (part + 1 < n_parts() || is_ring) ? halo : 0; }
};

/// Columns into which what is wrong at a part's edge may get within a step. A push carries it over the cells
/// that push, those of a block 2^k columns, of the transition above it twice as many; as far as all the
/// pushes of a step's levels together do, one after the other. Two bodies push at the same time.
int columns_per_step(std::span<const BodySource> bodies, std::span<const BodySteps> steps,
                     const TimeStepping& time);

/// Parts of nearly equal width.
/// @param mesh              of the whole plate
/// @param columns_per_step  see there
/// @param reach             columns beyond its own that a part looks at
Division divide_columns(const mesh::Mesh& mesh, int n_parts, int columns_per_step, int reach);
/// The same for bodies with grids.
/// @param steps  of each body
/// @throws UserError where the parts would be too narrow for their halo, would end at a rounded corner, or
///         would have more nodes than can be numbered; it tells how many are possible
Division divide_bodies(std::span<const BodySource> bodies, std::span<const BodySteps> steps,
                       const TimeStepping& time, int n_parts);

}  // namespace slipfront::motion
