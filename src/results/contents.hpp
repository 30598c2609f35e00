// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
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

}  // namespace slipfront::results
