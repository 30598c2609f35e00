// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "solid/element.hpp"
#include "solid/material.hpp"

namespace slipfront::results {

/// Which numbers are written: of complete results finite ones, of others those that there are.
enum class Numbers { finite, any };

/// What the root of every file of results says of where it comes from.
struct Origin {
  std::string title;
  std::string case_text;  ///< case.resolved.toml
};

/// Cells of one body in a mesh that may join two.
struct CellsOfBody {
  std::size_t end = 0;  ///< one past the last; they begin where those of the body before end
  solid::Material material;
};

/// What a fields.vtkhdf holds besides displacement and velocity.
struct SnapshotContents {
  std::vector<CellsOfBody> bodies;  ///< whose strain and stress are written; none for neither
  Origin origin = {};
  std::optional<solid::UniformStress> further_stress = {};  ///< that the displacements leave out
};

/// A data set and its attributes.
struct Description {
  const char* name;
  const char* unit;
  const char* description;
};

/// Nodes of the left edge of a periodic plate, and of the right one, which move as these.
using Seam = std::vector<std::pair<std::size_t, std::size_t>>;

/// A file of rows, of which each is a time and fields of as many numbers.
struct RowFormat {
  std::string file;
  std::uint64_t head_bytes = 0;
  std::vector<const char*> names = {};  ///< of the time and the fields
  std::size_t n_places = 1;             ///< numbers of a field
  /// Finishes it. A file without that is finished by others, and is there with its first row.
  std::function<void(const std::filesystem::path& file)> finish = {};

  std::size_t row_values() const { return 1 + (names.size() - 1) * n_places; }
};

/// Where the rows of a file go.
class RowSink {
 public:
  virtual ~RowSink() = default;
  /// Takes rows, or the next piece of one.
  virtual void put(std::vector<double> values) = 0;
  /// Waits until the queue has room for so many more bytes; called before a large piece is computed.
  virtual void wait_for_room(std::size_t /*bytes*/) {}
};

}  // namespace slipfront::results
