// SPDX-License-Identifier: BSD-3-Clause
#include "results/history.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.hpp"
#include "files/checksum.hpp"

namespace slipfront::results {
namespace {

using record::History, record::HistoryColumn, record::history_fields, record::history_place,
    record::history_time;

/// Bytes of a chunk of a matrix: few calls, and little left empty at the end of a short history.
constexpr std::size_t chunk_bytes = 64 * 1024;
constexpr hsize_t time_chunk_rows = 1024;

void describe(const hdf5::File& file, const HistoryColumn& column) {
  hdf5::set_attribute(file, column.name, "unit", std::string(column.unit));
  hdf5::set_attribute(file, column.name, "description", std::string(column.description));
}

void require_described(const hdf5::File& file, const HistoryColumn& column) {
  hdf5::require_text(file, column.name, "unit", column.unit);
  hdf5::require_text(file, column.name, "description", column.description);
}

std::vector<double> read_axis(const hdf5::File& file, const HistoryColumn& column) {
  hdf5::Array array = hdf5::read(file, column.name);
  const std::string path = file.path.string();
  if (array.shape.size() != 1)
    throw UserError("{}: {} has {} dimensions; it must have one", path, column.name, array.shape.size());
  for (std::size_t i = 0; i < array.values.size(); ++i)
    if (!std::isfinite(array.values[i]) || (i > 0 && array.values[i] <= array.values[i - 1]))
      throw UserError("{}: {} is {} at index {}; its values must be finite and ascending", path, column.name,
                      array.values[i], i);
  return std::move(array.values);
}

std::vector<double> read_matrix(const hdf5::File& file, const HistoryColumn& column,
                                const hdf5::Shape& shape) {
  hdf5::Array array = hdf5::read(file, column.name);
  if (array.shape != shape) {
    std::string lengths;
    for (const hsize_t length : array.shape)
      lengths += fmt::format("{}{}", lengths.empty() ? "" : ", ", length);
    throw UserError("{}: {} has the shape [{}]; with time_s and x_m it must be [{}, {}]", file.path.string(),
                    column.name, lengths, shape[0], shape[1]);
  }
  return std::move(array.values);
}

}  // namespace

std::size_t history_block_rows(std::size_t n_nodes) {
  return std::max<std::size_t>(chunk_bytes / (sizeof(double) * std::max<std::size_t>(n_nodes, 1)), 1);
}

HistoryFile::HistoryFile(const std::filesystem::path& path, std::span<const double> x_m, const Origin& origin)
    : file_(hdf5::create_file(path)), n_nodes_(x_m.size()) {
  hdf5::describe_root(file_, origin);
  hdf5::create_growing(file_, history_time.name, {}, time_chunk_rows, hdf5::Chunks::checked);
  describe(file_, history_time);
  hdf5::create_growing(file_, history_place.name, {}, std::max<std::size_t>(n_nodes_, 1),
                       hdf5::Chunks::checked);
  hdf5::add_rows(file_, history_place.name, n_nodes_);
  hdf5::write_rows(file_, history_place.name, 0, x_m);
  describe(file_, history_place);
  for (const HistoryColumn& field : history_fields) {
    if (n_nodes_ > 0)
      hdf5::create_growing(file_, field.name, {n_nodes_}, history_block_rows(n_nodes_),
                           hdf5::Chunks::checked);
    else
      hdf5::create(file_, field.name, hdf5::Type::float64, {0, 0});
    describe(file_, field);
  }
}

void HistoryFile::append(const History& rows) {
  const std::size_t n = rows.time_s.size();
  const auto append_column = [&](const HistoryColumn& column, std::size_t length) {
    const auto& values = rows.*column.member;
    SLIPFRONT_ASSERT(values.size() == n * length, "columns of a history differ in length");
    if (values.empty()) return;
    hdf5::add_rows(file_, column.name, n);
    hdf5::write_rows(file_, column.name, n_rows_, values);
  };
  append_column(history_time, 1);
  for (const HistoryColumn& field : history_fields) append_column(field, n_nodes_);
  n_rows_ += n;
}

void HistoryFile::close() {
  hdf5::close(std::move(file_));
}

void write_history(const std::filesystem::path& path, const History& history, const Origin& origin) {
  HistoryFile file(path, history.x_m, origin);
  file.append(history);
  file.close();
  const WrittenHistory written(path, origin);
  written.require(0, history);
  written.require_lengths(history.time_s.size(), history.x_m.size());
}

WrittenHistory::WrittenHistory(const std::filesystem::path& path, const Origin& origin)
    : file_(hdf5::open_written_file(path)) {
  hdf5::require_root_described(file_, origin);
  for (const HistoryColumn& axis : {history_time, history_place}) require_described(file_, axis);
  for (const HistoryColumn& field : history_fields) require_described(file_, field);
}

void WrittenHistory::require(std::size_t row, const History& rows) const {
  hdf5::require_rows(file_, history_time.name, row, rows.time_s);
  hdf5::require_rows(file_, history_place.name, 0, rows.x_m);
  if (rows.x_m.empty()) return;
  for (const HistoryColumn& field : history_fields)
    hdf5::require_rows(file_, field.name, row, rows.*field.member);
}

void WrittenHistory::require_lengths(std::size_t n_rows, std::size_t n_nodes) const {
  hdf5::require_length(file_, history_time.name, n_rows);
  hdf5::require_length(file_, history_place.name, n_nodes);
  if (n_nodes == 0) return;
  for (const HistoryColumn& field : history_fields) hdf5::require_length(file_, field.name, n_rows);
}

History read_history(const std::filesystem::path& path) {
  files::require_listed(path);
  const hdf5::File file = hdf5::open_file(path);
  History history;
  for (const HistoryColumn& axis : {history_time, history_place})
    history.*axis.member = read_axis(file, axis);
  const hdf5::Shape shape = {history.time_s.size(), history.x_m.size()};
  for (const HistoryColumn& field : history_fields) history.*field.member = read_matrix(file, field, shape);
  return history;
}

}  // namespace slipfront::results
