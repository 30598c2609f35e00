// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "mesh/mesh.hpp"
#include "motion/event.hpp"
#include "results/contents.hpp"
#include "results/hdf5.hpp"

namespace slipfront::results {

/// A fields.vtkhdf that grows: VTKHDF (version 2.0) unstructured grid, mesh written once, a step per
/// snapshot, point data `displacement_m` and `velocity_m_per_s`, and where they are asked for the cell data
/// `strain_xx` ... and `stress_xx_Pa` ..., values at the cell's centre; strain_zz in plane stress,
/// stress_zz_Pa in plane strain, where the other one is 0. Data sets have the attributes `unit` and
/// `description`. ParaView 5.12 and h5py read it once it is closed. Without snapshots: the mesh alone. Every
/// function throws WriteError where the file cannot be written.
class SnapshotFile {
 public:
  /// Writes the mesh, which must last as long as snapshots are appended with strain and stress.
  SnapshotFile(const std::filesystem::path& path, const mesh::Mesh& mesh, SnapshotContents contents = {});
  void append(const motion::Snapshot& snapshot);
  /// Writes the table of steps, and what HDF5 holds back. The last call.
  void close();

  std::size_t n_snapshots() const { return time_s_.size(); }

 private:
  void append_field(const std::string& name, const solid::Field& field);
  void append_tensors(const solid::Field& u_m);

  hdf5::File file_;
  const mesh::Mesh& mesh_;
  SnapshotContents contents_;
  std::size_t n_points_;
  /// Of a periodic plate: for each point the one whose values it has; those of the right edge have those of
  /// the left one. Empty otherwise.
  std::vector<std::size_t> source_;
  std::vector<double> time_s_;
};

/// A fields.vtkhdf that was written just now, to be compared with what it should hold; see WrittenHistory.
class WrittenSnapshots {
 public:
  WrittenSnapshots(const std::filesystem::path& path, const mesh::Mesh& mesh, SnapshotContents contents = {});
  void require(std::size_t step, const motion::Snapshot& snapshot) const;
  void require_steps(std::size_t n) const;

 private:
  hdf5::File file_;
  const mesh::Mesh& mesh_;
  SnapshotContents contents_;
  std::size_t n_points_;
  std::vector<std::size_t> source_;  ///< as in SnapshotFile
};

/// Writes a whole file and compares it. @throws WriteError
void write_snapshots(const std::filesystem::path& file, const mesh::Mesh& mesh,
                     std::span<const motion::Snapshot> snapshots, const SnapshotContents& contents = {});

/// Numbers of strain and stress to a cell and snapshot.
inline constexpr int tensor_values_per_cell = 7;

}  // namespace slipfront::results
