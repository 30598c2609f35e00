// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "record/column.hpp"
#include "record/probes.hpp"
#include "record/record.hpp"
#include "results/contents.hpp"

namespace slipfront::results {

/// A data set and its attributes.
struct Description {
  const char* name;
  const char* unit;
  const char* description;
};

/// A record over time at places: a file of rows (rows.hpp), per row the time and each field at all places.
struct Table {
  struct Axis {
    Description about;
    std::vector<double> values;  ///< [places]
  };
  Origin origin;
  std::vector<Axis> axes;          ///< where the places are
  std::vector<std::string> names;  ///< of the places; none for those without
  Description time;
  std::vector<Description> fields;

  std::size_t n_places() const { return axes.front().values.size(); }
  std::size_t row_values() const { return 1 + fields.size() * n_places(); }
  std::uint64_t head_bytes() const;
};

/// interface.h5: time_s [times], x_m [nodes] and record::history_fields [times, nodes].
Table history_table(std::span<const double> x_m, const Origin& origin = {});
/// probes.h5: name, x_m and y_m of the probes, time_s and record::probe_fields [times, probes].
Table probe_table(std::span<const record::ProbePlace> places, const Origin& origin = {});

/// The rows of a record, as they are in a file.
template <class Record, std::size_t n_fields>
std::vector<double> rows_of(const Record& record,
                            const std::array<record::Column<Record, std::vector<double>>, n_fields>& fields) {
  std::vector<double> rows;
  for (std::size_t k = 0; k < record.time_s.size(); ++k) {
    rows.push_back(record.time_s[k]);
    for (const auto& field : fields) {
      const auto& values = record.*field.member;
      const auto n = static_cast<std::ptrdiff_t>(values.size() / record.time_s.size());
      const auto first = values.begin() + static_cast<std::ptrdiff_t>(k) * n;
      rows.insert(rows.end(), first, first + n);
    }
  }
  return rows;
}

/// Finishes a file whose rows are there. @throws WriteError
void finish(const std::filesystem::path& path, const Table& table);

}  // namespace slipfront::results
