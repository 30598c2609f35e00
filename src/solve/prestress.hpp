// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fronts/record.hpp"
#include "mesh/mesh.hpp"
#include "solve/statics.hpp"

namespace slipfront::solve {

/// The undeformed plate at rest under given tractions of its interface, every node in sticking contact. Only
/// the loaded edge, where there is one, moves with the shear. The tractions have to be given to the stepper
/// too, see Stepper::set_prestress.
Equilibrium prestressed(const mesh::Mesh& mesh, fronts::StaticState tractions);

}  // namespace slipfront::solve
