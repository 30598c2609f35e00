// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <optional>

#include "solid/material.hpp"

namespace slipfront::stability {

using Complex = std::complex<double>;
inline constexpr Complex i_unit{0, 1};

/// A body y > 0 that slides on the rigid plane y = 0, or on a half-space y < 0.
struct Bodies {
  solid::Material above;
  std::optional<solid::Material> below = {};  ///< none: the rigid plane

  Bodies(const solid::Material& above_, const std::optional<solid::Material>& below_ = {})
      : above(above_), below(below_) {}
};

/// Whether both bodies have the same stiffness and density, to 1e-6: slip between them does not change the
/// pressure. Damping may differ.
bool are_alike(const Bodies& bodies);

/// The waves exp(i k x + s t) of a body, in units of k and c_S.
struct Waves {
  Waves(const solid::Material& material, double wavenumber_per_m, Complex s_per_s);

  double eta2;       ///< (c_L/c_S)^2
  Complex damped;    ///< complex over elastic moduli, 1 + beta_R s
  Complex P2;        ///< (s/(k c_S))^2 over damped: the waves see complex moduli
  Complex a_d, a_s;  ///< decay rates in y, over k
};

/// How edges yield to the tractions t and p of the other side (docs/stability.md): u_x = xx t + xy p, u_y =
/// xy t + yy p, all over one denominator, so that nothing has a pole. Of two bodies, u is the displacement of
/// the one above relative to the one below.
struct Compliance {
  Complex xx, xy, yy;   ///< times G k of the body above, over the denominator
  Complex determinant;  ///< xx yy - xy^2 of the quotients, times (G k)^2, over the denominator too
  Complex denominator;  ///< has no zeros with Re s > 0
};

Compliance compliance(const Bodies& bodies, double wavenumber_per_m, Complex s_per_s);

/// Speed of the wave along a frictionless interface that does not open; damping left out. Empty where there
/// is none: the two differ too much. Of equal bodies it is the Rayleigh speed.
std::optional<double> generalised_rayleigh_speed_m_per_s(const solid::Material& above,
                                                         const solid::Material& below);

}  // namespace slipfront::stability
