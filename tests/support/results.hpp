// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "record/record.hpp"
#include "results/outputs.hpp"
#include "results/snapshots.hpp"
#include "results/stream.hpp"
#include "results/table.hpp"

/// Reads and writes files of results as a whole.
namespace slipfront::test {

using results::hdf5::Handle, results::hdf5::Shape;

struct DataSet {
  Shape shape;
  std::vector<double> values;  ///< row-major
};

inline Handle open_hdf5(const std::filesystem::path& file) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  Handle opened(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!opened.valid()) throw std::runtime_error("no HDF5 file " + file.string());
  return opened;
}

/// A data set of any numeric type.
inline DataSet read(const std::filesystem::path& file, const std::string& name) {
  const auto opened = open_hdf5(file);
  const Handle found(H5Dopen2(opened.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!found.valid()) throw std::runtime_error("no data set " + name);
  const Handle space(H5Dget_space(found.get()), H5Sclose);
  DataSet data{Shape(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space.get()))), {}};
  H5Sget_simple_extent_dims(space.get(), data.shape.data(), nullptr);
  data.values.resize(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.get())));
  if (!data.values.empty() &&
      H5Dread(found.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, data.values.data()) < 0)
    throw std::runtime_error("unreadable data set " + name);
  return data;
}

/// A text attribute of variable length.
inline std::string text_of(const std::filesystem::path& file, const std::string& object,
                           const std::string& attribute) {
  const auto opened = open_hdf5(file);
  const Handle found(
      H5Aopen_by_name(opened.get(), object.c_str(), attribute.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  const Handle type(H5Aget_type(found.get()), H5Tclose);
  char* text = nullptr;
  if (!found.valid() || H5Aread(found.get(), type.get(), &text) < 0) return {};
  const std::string copy = text;
  H5free_memory(text);
  return copy;
}

inline record::History read_history(const std::filesystem::path& file) {
  record::History history;
  for (const auto& column : {record::history_time, record::history_place})
    history.*column.member = read(file, column.name).values;
  for (const auto& field : record::history_fields) history.*field.member = read(file, field.name).values;
  return history;
}

inline void write_history(const std::filesystem::path& file, const record::History& history) {
  const auto table = results::history_table(history.x_m);
  results::RowFile rows(file, table.head_bytes());
  rows.write(results::rows_of(members_of(history)));
  rows.sync();
  results::finish(file, table);
}

/// A row of fields.vtkhdf.
inline std::vector<double> row_of(const motion::Snapshot& snapshot) {
  std::vector<double> row = {snapshot.time_s};
  for (const auto* field : {&snapshot.u_m, &snapshot.v_m_per_s})
    for (const auto* component : {&field->x, &field->y})
      row.insert(row.end(), component->begin(), component->end());
  return row;
}

/// DIR/fields.vtkhdf.
inline void write_snapshots(const std::filesystem::path& dir, const mesh::Slabs& mesh,
                            std::span<const motion::Snapshot> snapshots,
                            const results::SnapshotContents& contents = {}, const results::Seam& seam = {}) {
  results::ResultStream stream(dir,
                               {results::snapshot_format(contents.origin, snapshots.size(), mesh.n_nodes)});
  for (const auto& snapshot : snapshots) {
    auto row = row_of(snapshot);
    results::close_seam(std::span(row).subspan(1), 0, mesh.n_nodes, seam);
    stream.sink(results::snapshot_output.file).put(std::move(row));
  }
  stream.finish();
  results::finish_snapshots(dir / results::snapshot_output.file, mesh, contents);
}

}  // namespace slipfront::test
