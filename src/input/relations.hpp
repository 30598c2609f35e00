// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "input/case.hpp"
#include "input/document.hpp"

namespace slipfront::input {

/// Refuses keys that do not fit together, where that needs no mesh; mesh::make_plate checks the rest of the
/// geometry.
/// @param document  tells which keys were set
/// @throws UserError with the keys that it is about, those first that are to change
void check_relations(const Case& config, const Document& document);

/// The part of it that does not compare tables.
void check_each_table(const Case& config);

}  // namespace slipfront::input
