// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"

namespace slipfront::statics {

/// A stiffness is not positive definite, but by rounding.
struct Indefinite : UserError {
  Indefinite()
      : UserError(
            "the statics have no solution in double precision: stiffnesses of bodies and machine are too far "
            "apart; change {}, {}, {} or {}",
            Key("material.youngs_modulus_Pa"), Key("base.youngs_modulus_Pa"), Key("material.poissons_ratio"),
            Key("loading.shear_stiffness_Pa_per_m")) {}
};

}  // namespace slipfront::statics
