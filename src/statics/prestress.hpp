// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mesh/mesh.hpp"
#include "record/record.hpp"
#include "statics/statics.hpp"

namespace slipfront::statics {

/// The undeformed plate at rest under given tractions of its interface, every node in sticking contact. Only
/// the loaded edge, where there is one, moves with the shear. The tractions have to be given to the stepper
/// too, see motion::Loads.
/// @param below  mesh of a deformable body below, equally undeformed; null on the rigid plane
Equilibrium prestressed(const mesh::Mesh& mesh, record::StaticState tractions,
                        const mesh::Mesh* below = nullptr);

}  // namespace slipfront::statics
