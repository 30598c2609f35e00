// SPDX-License-Identifier: BSD-3-Clause
#include "results/probes.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "base/error.hpp"

namespace slipfront::results {
namespace {

using record::probe_fields, record::probe_time, record::ProbeColumn, record::ProbePlace, record::ProbeRecord;

constexpr std::size_t probe_chunk_bytes = 64 * 1024;
constexpr hsize_t probe_time_chunk_rows = 1024;

constexpr const char* name_description = "name of the probe";

struct Coordinate {
  const char* name;
  const char* description;
  double ProbePlace::*member;
};
constexpr std::array<Coordinate, 2> coordinates = {
    {{"x_m", "position along the interface from the left edge", &ProbePlace::x_m},
     {"y_m", "position above the interface; below 0 in the base", &ProbePlace::y_m}}};

std::vector<std::string> names_of(std::span<const ProbePlace> places) {
  std::vector<std::string> names;
  for (const auto& place : places) names.push_back(place.name);
  return names;
}

std::vector<double> values_of(std::span<const ProbePlace> places, const Coordinate& coordinate) {
  std::vector<double> values;
  for (const auto& place : places) values.push_back(place.*coordinate.member);
  return values;
}

/// Calls f(object, attribute, text) for all that describes the data sets.
template <class F>
void for_descriptions(F&& f) {
  f("name", "description", name_description);
  for (const auto& coordinate : coordinates) {
    f(coordinate.name, "unit", "m");
    f(coordinate.name, "description", coordinate.description);
  }
  const auto describe = [&](const ProbeColumn& column) {
    f(column.name, "unit", column.unit);
    f(column.name, "description", column.description);
  };
  describe(probe_time);
  for (const auto& field : probe_fields) describe(field);
}

}  // namespace

std::size_t probe_block_rows(std::size_t n_probes) {
  return std::max<std::size_t>(probe_chunk_bytes / (sizeof(double) * n_probes), 1);
}

ProbeFile::ProbeFile(const std::filesystem::path& path, std::span<const ProbePlace> places,
                     const Origin& origin)
    : file_(hdf5::create_file(path)), n_probes_(places.size()) {
  SLIPFRONT_ASSERT(n_probes_ > 0, "a file of no probes");
  hdf5::describe_root(file_, origin);
  hdf5::write_texts(file_, "name", names_of(places));
  for (const auto& coordinate : coordinates)
    hdf5::write(file_, coordinate.name, values_of(places, coordinate), {n_probes_});
  hdf5::create_growing(file_, probe_time.name, {}, probe_time_chunk_rows, hdf5::Chunks::checked);
  for (const auto& field : probe_fields)
    hdf5::create_growing(file_, field.name, {n_probes_}, probe_block_rows(n_probes_), hdf5::Chunks::checked);
  for_descriptions([&](const char* object, const char* name, const char* text) {
    hdf5::set_attribute(file_, object, name, std::string(text));
  });
}

void ProbeFile::append(const ProbeRecord& rows) {
  const std::size_t n = rows.time_s.size();
  const auto append_column = [&](const ProbeColumn& column, std::size_t length) {
    const auto& values = rows.*column.member;
    SLIPFRONT_ASSERT(values.size() == n * length, "columns of probes differ in length");
    if (values.empty()) return;
    hdf5::add_rows(file_, column.name, n);
    hdf5::write_rows(file_, column.name, n_rows_, values);
  };
  append_column(probe_time, 1);
  for (const auto& field : probe_fields) append_column(field, n_probes_);
  n_rows_ += n;
}

void ProbeFile::close() {
  hdf5::close(std::move(file_));
}

WrittenProbes::WrittenProbes(const std::filesystem::path& path, std::span<const ProbePlace> places,
                             const Origin& origin)
    : file_(hdf5::open_written_file(path)) {
  hdf5::require_root_described(file_, origin);
  hdf5::require_texts(file_, "name", names_of(places));
  for (const auto& coordinate : coordinates) {
    hdf5::require_length(file_, coordinate.name, places.size());
    hdf5::require_rows(file_, coordinate.name, 0, values_of(places, coordinate));
  }
  for_descriptions([&](const char* object, const char* name, const char* text) {
    hdf5::require_text(file_, object, name, text);
  });
}

void WrittenProbes::require(std::size_t row, const ProbeRecord& rows) const {
  hdf5::require_rows(file_, probe_time.name, row, rows.time_s);
  for (const auto& field : probe_fields) hdf5::require_rows(file_, field.name, row, rows.*field.member);
}

void WrittenProbes::require_length(std::size_t n_rows) const {
  hdf5::require_length(file_, probe_time.name, n_rows);
  for (const auto& field : probe_fields) hdf5::require_length(file_, field.name, n_rows);
}

void write_probes(const std::filesystem::path& path, std::span<const ProbePlace> places,
                  const ProbeRecord& record, const Origin& origin) {
  ProbeFile file(path, places, origin);
  file.append(record);
  file.close();
  const WrittenProbes written(path, places, origin);
  written.require(0, record);
  written.require_length(record.time_s.size());
}

}  // namespace slipfront::results
