// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "base/error.hpp"

namespace slipfront {

/// Writes to or reads from an archive (cereal's, whose vectors the archive's owner includes) a vector of
/// known length. @throws UserError where one of another length is read.
template <class Archive, class T>
void archive_vector(Archive& archive, std::vector<T>& values, std::size_t length) {
  archive(values);
  if (values.size() != length)
    throw UserError("the saved state has {} values, this case has {}: it belongs to another case",
                    values.size(), length);
}

/// The same with its present length.
template <class Archive, class T>
void archive_vector(Archive& archive, std::vector<T>& values) {
  archive_vector(archive, values, values.size());
}

/// A pair of such vectors, x and y.
template <class Archive, class Field>
void archive_field(Archive& archive, Field& field, std::size_t length) {
  archive_vector(archive, field.x, length);
  archive_vector(archive, field.y, length);
}

}  // namespace slipfront
