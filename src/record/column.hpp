// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace slipfront::record {

/// A column of the results, for all that writes, reads, adds or describes them.
template <class Record, class Value>
struct Column {
  const char* name;  ///< in files; it ends with the unit
  const char* unit;
  const char* description;
  Value Record::*member;
};

}  // namespace slipfront::record
