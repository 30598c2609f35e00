// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "verification/verification.hpp"

/// The problems, each in its file and namespace, so that all of them can be compiled together.
namespace slipfront::verification {

// clang-format off
namespace plane_waves { Outcome verify(Effort effort); }
namespace manufactured { Outcome verify(Effort effort); }
namespace rayleigh_wave { Outcome verify(Effort effort); }
namespace lamb { Outcome verify(Effort effort); }
namespace column { Outcome verify(Effort effort); }
namespace time_reversal { Outcome verify(Effort effort); }
namespace subcycling {
Outcome verify(Effort effort);
/// The join between a sub-cycled layer and the other cells acts as if the cell above it were thinner by this
/// share, for changes of stress since the start: verification/subcycling.md.
/// @param courant_number  c dt/h of the longer step
double thinning_of_join(double courant_number, int substeps);
}
namespace symmetry { Outcome verify(Effort effort); }
namespace growing_modes { Outcome verify(Effort effort); }
namespace growing_modes_of_two { Outcome verify(Effort effort); }
namespace growing_modes_with_state { Outcome verify(Effort effort); }
namespace slip_patch { Outcome verify(Effort effort); }
namespace crack { Outcome verify(Effort effort); }
namespace static_crack { Outcome verify(Effort effort); }
namespace self_similar_crack { Outcome verify(Effort effort); }
namespace steady_strip { Outcome verify(Effort effort); }
namespace layer_spectrum { Outcome verify(Effort effort); }
namespace impact { Outcome verify(Effort effort); }
namespace block { Outcome verify(Effort effort); }
namespace block_on_spring { Outcome verify(Effort effort); }
namespace spring_slider { Outcome verify(Effort effort); }
namespace velocity_steps { Outcome verify(Effort effort); }
namespace recontact { Outcome verify(Effort effort); }
namespace stiff_base { Outcome verify(Effort effort); }
namespace nucleation { Outcome verify(Effort effort); }
namespace bonded_waves { Outcome verify(Effort effort); }
// clang-format on

}  // namespace slipfront::verification
