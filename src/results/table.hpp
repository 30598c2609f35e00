// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "record/column.hpp"
#include "results/contents.hpp"
#include "results/rows.hpp"

namespace slipfront::results {

template <class Record, class Value>
Description description_of(const record::Column<Record, Value>& column) {
  return {column.name, column.unit, column.description};
}
template <class Columns>
std::vector<Description> descriptions_of(const Columns& columns) {
  std::vector<Description> all;
  for (const auto& column : columns) all.push_back(description_of(column));
  return all;
}

/// A record over time at places: a file of rows (rows.hpp), per row the time and each field at all places.
/// Without axes it has fields of time alone.
struct Table {
  struct Axis {
    Description about;
    std::vector<double> values;  ///< [places]
  };
  Origin origin;
  std::vector<Axis> axes = {};          ///< where the places are
  std::vector<std::string> names = {};  ///< of the places; none for those without
  Description time;
  std::vector<Description> fields;

  std::size_t n_places() const { return axes.empty() ? 1 : axes.front().values.size(); }
  std::size_t row_values() const { return 1 + fields.size() * n_places(); }
  std::uint64_t head_bytes() const;
};

/// The rows of a record, as they are in a file. @param members  record::members_of, the time first
std::vector<double> rows_of(std::span<const std::vector<double>* const> members);

RowFormat row_format(const char* file, Table table);
/// Finishes a file whose rows are there. @throws WriteError
void finish(const std::filesystem::path& path, const Table& table);

}  // namespace slipfront::results
