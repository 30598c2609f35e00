// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "stability/compliance.hpp"

// A front as the tip of a shear crack along the interface of half-spaces that touch. Damping is left out.
// Formulas and sources: docs/fracture.md. Speeds V > 0 in m/s.
namespace slipfront::fracture {

using stability::Bodies;
using stability::Complex;

/// Which way a front runs against the slip of the body above.
enum class Direction { with_slip = 1, against_slip = -1 };

/// What a pattern of slip delta exp(i k (x - V t)), k > 0, that moves in a direction costs: -(t - mu p)/(k
/// delta), where slip changes p. Real below the lowest shear speed where mu is 0 or the bodies are alike.
Complex moving_stiffness_Pa(const Bodies& bodies, double speed_m_per_s, double mu = 0,
                            Direction direction = Direction::with_slip);

/// The real one at mu = 0; not a number from the lowest shear speed on. At rest G = K^2/(4 stiffness), moving
/// as well.
double stiffness_Pa(const Bodies& bodies, double speed_m_per_s);

/// Energy release rate over that of a tip at rest with the same K: A_II(V) of Freund (1990).
double energy_factor(const Bodies& bodies, double speed_m_per_s);

/// J/m2, of a stress intensity factor in Pa m^(1/2), and back.
double energy_release_rate_J_per_m2(const Bodies& bodies, double speed_m_per_s, double K_Pa_sqrt_m);
double stress_intensity_Pa_sqrt_m(const Bodies& bodies, double speed_m_per_s, double G_J_per_m2);

/// Slip at a distance behind a tip with energy release rate G: slip^2 = this times G times the distance. m2/J
double slip_squared_per_G_and_distance(const Bodies& bodies, double speed_m_per_s);

/// Exponent a of slip behind the tip, slip ~ r^a, stress ~ r^(a - 1), where the residual traction is mu p.
/// 1/2 between alike bodies below the shear speed; from 1/2 up above it, where no energy flows into the tip
/// itself but at sqrt(2) c_S. Comninou (1977), Freund (1979).
double slip_exponent(const Bodies& bodies, double speed_m_per_s, double mu, Direction direction);

/// Speed at which a front that releases energy ends to be possible below the shear speeds: the (generalised)
/// Rayleigh speed, or the lowest shear speed where there is none.
double limiting_speed_m_per_s(const Bodies& bodies);

/// g(V) of the equation of motion G = g(V) G_static: energy release rate of a long crack that grows at V,
/// over that at rest under the same stress drop, exactly as Freund (1990) for all bodies that are half-spaces
/// with a residual traction that slip does not change. Falls from 1 to 0 at limiting_speed; 0 beyond.
double speed_factor(const Bodies& bodies, double speed_m_per_s);

}  // namespace slipfront::fracture
