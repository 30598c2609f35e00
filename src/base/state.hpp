// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "base/error.hpp"

namespace slipfront {

/// Whether a saved value is one: numbers are finite, bytes are flags.
template <class T>
bool is_possible(const T& value) {
  if constexpr (std::is_floating_point_v<T>) return std::isfinite(value);
  if constexpr (std::is_same_v<T, std::uint8_t>) return value <= 1;
  return true;
}

/// A saved state does not fit the case that reads it.
struct StateError : UserError {
  using UserError::UserError;
};

/// Refuses a saved state that its case does not come to. @throws StateError
inline void require_possible(bool is_possible, const char* what) {
  if (!is_possible) throw StateError("the saved state has {} of another case, or was changed", what);
}

/// Writes to or reads from an archive (cereal's, whose vectors the archive's owner includes) a vector of
/// its present length. @throws StateError where one of another length is read, or of impossible values.
template <class Archive, class T>
void archive_vector(Archive& archive, std::vector<T>& values) {
  const auto length = values.size();
  archive(values);
  if (values.size() != length)
    throw StateError("the saved state has {} values, this case has {}: it belongs to another case",
                     values.size(), length);
  if constexpr (Archive::is_loading::value)
    require_possible(std::ranges::all_of(values, is_possible<T>), "numbers");
}

}  // namespace slipfront
