// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>
#include <vector>

namespace slipfront::record {

/// A column of the results, for all that writes, reads, adds or describes them.
template <class Record, class Value>
struct Column {
  const char* name;  ///< in files; it ends with the unit
  const char* unit;
  const char* description;
  Value Record::*member;
};

/// What the rows of a record hold, in the order of the files: its time and the members that columns name.
template <class Record, class Values, std::size_t n_fields>
auto members_of(Record& record,
                const std::array<Column<std::remove_const_t<Record>, Values>, n_fields>& fields) {
  std::vector members = {&record.time_s};
  for (const auto& field : fields) members.push_back(&(record.*field.member));
  return members;
}

/// Appends the rows of one record to those of another one.
inline void append_rows(const std::vector<std::vector<double>*>& to,
                        const std::vector<const std::vector<double>*>& from) {
  for (std::size_t k = 0; k < to.size(); ++k) to[k]->insert(to[k]->end(), from[k]->begin(), from[k]->end());
}

}  // namespace slipfront::record
