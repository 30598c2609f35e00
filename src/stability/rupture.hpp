// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/numbers.hpp"
#include "stability/modes.hpp"

// Lengths and ratios that tell whether a rupture can begin and run, and how fast. Pure functions; formulas
// and sources: docs/stability.md, Rupture. Modulus: mu* of modulus_Pa; slip-weakening rate: strength drop
// over d_c.
namespace slipfront::stability {

/// mu*: a pattern of slip delta exp(i k x) at rest changes t by -mu* |k| delta/2 between bodies that stay in
/// contact. G/(1 - nu) of two equal bodies in plane strain, G (1 + nu) in plane stress. What slip changes the
/// pressure by is left out.
double modulus_Pa(const Bodies& bodies);

/// Length of the slip zone at which slow slip becomes unstable under linear slip weakening, whatever the
/// load: 1.158 mu* d_c/(strength drop). Uenishi and Rice (2003), Eq. 13.
double nucleation_length_m(double modulus_Pa, double strength_drop_Pa, double d_c_m);

/// Half the length from which a crack with uniform stress drop runs: mu* strength_drop d_c/(pi
/// stress_drop^2), with the fracture energy strength_drop d_c/2. Griffith's condition in Andrews (1976).
double griffith_half_length_m(double modulus_Pa, double strength_drop_Pa, double d_c_m,
                              double stress_drop_Pa);

/// Length over which strength falls behind a slow tip: 9 pi/32 mu* d_c/(strength drop). Palmer and Rice
/// (1973); Day et al. (2005).
double process_zone_m(double modulus_Pa, double strength_drop_Pa, double d_c_m);

/// Wavelength beyond which uniform sliding under a law with a state is unstable: pi mu* d_c/((b - a) p), Rice
/// and Ruina (1983), without inertia; infinite where friction does not weaken with the slip rate.
double unstable_wavelength_m(double modulus_Pa, const interface::StateResponse& state, double pressure_Pa);

/// Length of the slip zone at which slip under the aging law runs away, L_b = mu* d_c/(b p): 2.755 L_b for
/// a/b < 0.378, else 2 L_b/(pi (1 - a/b)^2). Rubin and Ampuero (2005), twice their half-length.
double nucleation_length_m(double modulus_Pa, const interface::StateResponse& state, double pressure_Pa);

/// Below it fronts in plane can pass to speeds above c_S: Andrews (1976, 1985).
inline constexpr double supershear_S = 1.77;

/// Half length of a crack at which its front passes to speeds above c_S: 9.8 (1.77 - S)^-3 times
/// griffith_half_length_m. Andrews (1985). Infinite from S = 1.77 on.
double supershear_half_length_m(double griffith_half_length_m, double S);

/// Tractions and friction at a node before an event, in the direction of the load.
struct NodeBefore {
  double t_Pa = 0;
  double strength_Pa = 0;            ///< mu_s p
  double residual_Pa = 0;            ///< mu_k p
  std::optional<double> d_c_m = {};  ///< none where the law has no length
  double p_Pa = 0;
  std::optional<interface::StateResponse> state = {};  ///< at V_i, of a law with a state
};

/// Strength excess S = (strength - t)/(t - residual); infinite where t is not above the residual strength.
double strength_excess(const NodeBefore& node);

/// Nodes of larger S are barriers at which ruptures end, such as the ends of a fault whose mu_s is put beyond
/// reach.
inline constexpr double barrier_S = 10;

/// Least, median and largest of some numbers; not numbers where there are none.
struct Spread {
  double least = 0, median = 0, largest = 0;
};
Spread spread_of(std::vector<double> values);

/// What can be said of a rupture along some nodes.
struct Outlook {
  std::size_t n_nodes = 0;
  std::size_t n_weakening = 0;  ///< with residual below strength
  std::size_t n_driven = 0;     ///< with residual below t: there a front releases energy
  std::size_t n_barriers = 0;   ///< what follows is without them, unless all nodes are
  Spread S{nan, nan, nan};      ///< not numbers under a law with a state
  Spread drop_ratio =
      S;  ///< (t - residual)/(strength - residual) = 1/(1 + S), the seismic ratio; 0 where t is below
  double modulus_Pa = 0;
  /// Lengths of the median node; none where the law has no length, and Griffith's where none is driven.
  std::optional<double> nucleation_length_m, process_zone_m, griffith_half_length_m, supershear_half_length_m;
  std::optional<double> unstable_wavelength_m;  ///< of a law with a state
  std::string regime;                           ///< one plain line
};
Outlook outlook(const Bodies& bodies, const std::vector<NodeBefore>& nodes);

}  // namespace slipfront::stability
