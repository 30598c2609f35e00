// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

namespace slipfront::record {

/// A column of the results, for all that writes, reads, adds or describes them.
template <class Record, class Value>
struct Column {
  const char* name;  ///< in files; it ends with the unit
  const char* unit;
  const char* description;
  Value Record::*member;
};

/// Appends the rows of one record to those of another one.
template <class Record, class Values, std::size_t n_fields>
void append_rows(Record& to, const Record& from, const std::array<Column<Record, Values>, n_fields>& fields) {
  to.time_s.insert(to.time_s.end(), from.time_s.begin(), from.time_s.end());
  for (const auto& field : fields) {
    const auto& values = from.*field.member;
    (to.*field.member).insert((to.*field.member).end(), values.begin(), values.end());
  }
}

}  // namespace slipfront::record
