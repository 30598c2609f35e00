// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "mesh/slabs.hpp"
#include "motion/time_stepper.hpp"
#include "results/contents.hpp"
#include "results/rows.hpp"

namespace slipfront::results {

/// Rows of a fields.vtkhdf: the time, u_x, u_y, v_x and v_y [nodes].
/// @param n_snapshots  for which the head has room
RowFormat snapshot_format(const Origin& origin, std::size_t n_snapshots, std::size_t n_nodes);
/// That of a mesh whose nodes are numbered from `first` on.
Seam seam(const mesh::Mesh& mesh, std::size_t first = 0);
/// Gives the right edge the motion of the left one. @param place  of the values among those of a snapshot
void close_seam(std::span<double> values, std::size_t place, std::size_t n_nodes, const Seam& seam);

/// One of the ranks that fill a file together: `count` of them each some slabs of its mesh. What one has
/// filled another one compares.
struct Writer {
  int number = 0, count = 1;
  /// Does a part of the work of all, further ranks included: where it fails for one of them, it ends for all.
  std::function<void(const std::function<void()>& work)> together = [](const auto& work) { work(); };

  bool leads() const { return number == 0; }
};

/// Finishes a fields.vtkhdf whose rows are there, and compares what is put over and behind them: VTKHDF
/// (version 2.0) unstructured grid, mesh written once, a step per snapshot, point data `displacement_m` and
/// `velocity_m_per_s`, and where they are asked for the cell data `strain_xx` ... and `stress_xx_Pa` ...,
/// values at the cell's centre; strain_zz in plane stress, stress_zz_Pa in plane strain, where the other one
/// is 0. Data sets have the attributes `unit` and `description`. ParaView 5.12 and h5py read it. A slab of
/// the mesh is held at a time, and a field over it. The bytes do not depend on the number of writers.
/// @throws WriteError, and what `together` throws
void finish_snapshots(const std::filesystem::path& file, const mesh::Slabs& mesh,
                      const SnapshotContents& contents = {}, const Writer& writer = {});

/// Numbers of strain and stress to a cell and snapshot.
inline constexpr int tensor_values_per_cell = 7;

}  // namespace slipfront::results
