// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "mesh/slabs.hpp"
#include "motion/event.hpp"
#include "results/contents.hpp"
#include "results/hdf5.hpp"

namespace slipfront::results {

/// A field of which not all need be held at a time: of n nodes from `first` on.
using NodeValues = std::function<solid::Field(std::size_t first, std::size_t n)>;

/// Such a snapshot.
struct SnapshotValues {
  double time_s = 0;
  NodeValues u_m, v_m_per_s;
};
/// @param snapshot  must last as long
SnapshotValues values_of(const motion::Snapshot& snapshot);

/// A fields.vtkhdf that grows: VTKHDF (version 2.0) unstructured grid, mesh written once, a step per
/// snapshot, point data `displacement_m` and `velocity_m_per_s`, and where they are asked for the cell data
/// `strain_xx` ... and `stress_xx_Pa` ..., values at the cell's centre; strain_zz in plane stress,
/// stress_zz_Pa in plane strain, where the other one is 0. Data sets have the attributes `unit` and
/// `description`. ParaView 5.12 and h5py read it once it is closed. Without snapshots: the mesh alone. A slab
/// of the mesh is held at a time, and a field over it. Every function throws WriteError where the file cannot
/// be written.
class SnapshotFile {
 public:
  /// Writes the mesh.
  SnapshotFile(const std::filesystem::path& path, mesh::Slabs mesh, SnapshotContents contents = {});
  void append(const SnapshotValues& snapshot);
  /// Writes the table of steps, and what HDF5 holds back. The last call.
  void close();

  std::size_t n_snapshots() const { return time_s_.size(); }

 private:
  void append_field(const std::string& name, const NodeValues& field);
  void append_tensors(const NodeValues& u_m);

  hdf5::File file_;
  mesh::Slabs mesh_;
  SnapshotContents contents_;
  std::vector<double> time_s_;
};

/// A fields.vtkhdf that was written just now, to be compared with what it should hold; see WrittenHistory.
class WrittenSnapshots {
 public:
  WrittenSnapshots(const std::filesystem::path& path, mesh::Slabs mesh, SnapshotContents contents = {});
  void require(std::size_t step, const SnapshotValues& snapshot) const;
  void require_steps(std::size_t n) const;

 private:
  hdf5::File file_;
  mesh::Slabs mesh_;
  SnapshotContents contents_;
};

/// Writes a whole file and compares it. @throws WriteError
void write_snapshots(const std::filesystem::path& file, const mesh::Slabs& mesh,
                     std::span<const motion::Snapshot> snapshots, const SnapshotContents& contents = {});

/// Numbers of strain and stress to a cell and snapshot.
inline constexpr int tensor_values_per_cell = 7;

}  // namespace slipfront::results
