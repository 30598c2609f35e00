// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

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

/// interface.h5: time_s [times], x_m [nodes], record::history_fields and the law's states [times, nodes].
Table history_table(std::span<const double> x_m, const Origin& origin = {},
                    std::span<const Description> law_states = {});
/// probes.h5: name, x_m and y_m of the probes, time_s and record::probe_fields [times, probes].
Table probe_table(std::span<const record::ProbePlace> places, const Origin& origin = {});

/// The rows of a record, as they are in a file. @param members  record::members_of, the time first
std::vector<double> rows_of(std::span<const std::vector<double>* const> members);

/// Finishes a file whose rows are there. @throws WriteError
void finish(const std::filesystem::path& path, const Table& table);

}  // namespace slipfront::results
