// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "mesh/slabs.hpp"
#include "motion/event.hpp"
#include "results/contents.hpp"

namespace slipfront::results {

/// Snapshots of which not all need be held at a time.
struct SnapshotSeries {
  std::vector<double> time_s;
  /// Of snapshot k the values at n nodes from `first` on.
  std::function<solid::Field(std::size_t k, std::size_t first, std::size_t n)> u_m, v_m_per_s;
};
/// @param snapshots  must last as long
SnapshotSeries series_of(std::span<const motion::Snapshot> snapshots);

/// One of the ranks that fill a file together: `count` of them each some slabs of its mesh. What one has
/// filled another one compares.
struct Writer {
  int number = 0, count = 1;
  /// Does a part of the work of all, further ranks included: where it fails for one of them, it ends for all.
  std::function<void(const std::function<void()>& work)> together = [](const auto& work) { work(); };

  bool leads() const { return number == 0; }
};

/// Writes a fields.vtkhdf and compares it with what it should hold: VTKHDF (version 2.0) unstructured grid,
/// mesh written once, a step per snapshot, point data `displacement_m` and `velocity_m_per_s`, and where they
/// are asked for the cell data `strain_xx` ... and `stress_xx_Pa` ..., values at the cell's centre; strain_zz
/// in plane stress, stress_zz_Pa in plane strain, where the other one is 0. Data sets have the attributes
/// `unit` and `description`. ParaView 5.12 and h5py read it. Without snapshots: the mesh alone. A slab of the
/// mesh is held at a time, and a field over it.
///
/// The first writer makes the file with the places of all numbers, so that its bytes do not depend on the
/// number of writers; each of them puts its own ones there, without HDF5.
/// @throws WriteError, and what the series and `together` throw
void write_snapshots(const std::filesystem::path& file, const mesh::Slabs& mesh, const SnapshotSeries& series,
                     const SnapshotContents& contents = {}, const Writer& writer = {});

/// Numbers of strain and stress to a cell and snapshot.
inline constexpr int tensor_values_per_cell = 7;

}  // namespace slipfront::results
