// SPDX-License-Identifier: BSD-3-Clause
#include "stability/modes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "base/error.hpp"

namespace slipfront::stability {
namespace {

/// What friction does to a perturbation, in units of G k.
struct Response {
  Complex of_pressure;  ///< of strength to pressure, over mu
  Complex of_slip;      ///< of strength to slip at constant pressure
};

Response response(const Sliding& sliding, double unit_Pa_per_m, Complex s) {
  const Complex delay = sliding.relaxed == interface::Relaxed::none
                            ? Complex{1}
                            : sliding.relaxation_rate_per_s / (sliding.relaxation_rate_per_s + s);
  Complex slope = sliding.slope_s_per_m;
  if (sliding.state_rate_per_s > 0)
    slope += sliding.state_slope_s_per_m * sliding.state_rate_per_s / (sliding.state_rate_per_s + s);
  Complex of_slip = sliding.pressure_Pa * (slope * s + sliding.slip_slope_per_m) / unit_Pa_per_m;
  if (sliding.relaxed == interface::Relaxed::strength) of_slip *= delay;
  return {delay, of_slip};
}

Complex determinant(std::array<std::array<Complex, 4>, 4> m) {
  Complex product = 1;
  for (std::size_t c = 0; c < 4; ++c) {
    std::size_t pivot = c;
    for (std::size_t r = c + 1; r < 4; ++r)
      if (std::abs(m[r][c]) > std::abs(m[pivot][c])) pivot = r;
    if (m[pivot][c] == Complex{0}) return 0;
    if (pivot != c) {
      std::swap(m[pivot], m[c]);
      product = -product;
    }
    product *= m[c][c];
    for (std::size_t r = c + 1; r < 4; ++r) {
      const Complex share = m[r][c] / m[c][c];
      for (std::size_t j = c; j < 4; ++j) m[r][j] -= share * m[c][j];
    }
  }
  return product;
}

/// F(s) of a layer, zero at its modes, in p = s/(k c_S).
Complex layer_relation(const solid::Material& material, const Sliding& sliding, double wavenumber_per_m,
                       double height_m, Complex p) {
  const Complex s = p * wavenumber_per_m * solid::shear_speed_m_per_s(material);
  const auto r = response(sliding, solid::shear_modulus_Pa(material) * wavenumber_per_m, s);
  const Waves w(material, wavenumber_per_m, s);
  const double height = wavenumber_per_m * height_m;
  const Complex fall_d = std::exp(-w.a_d * height);
  const Complex fall_s = std::exp(-w.a_s * height);
  // Columns: the two potentials, falling from the interface and from the top. Rows: u_x and u_y at the top,
  // u_y at the interface, friction.
  std::array<std::array<Complex, 4>, 4> m;
  for (std::size_t c = 0; c < 4; ++c) {
    const bool dilatation = c < 2;
    const double sign = c % 2 == 0 ? -1 : 1;
    const Complex a = sign * (dilatation ? w.a_d : w.a_s);
    const Complex fall = dilatation ? fall_d : fall_s;
    const Complex below = sign < 0 ? 1.0 : fall;
    const Complex above = sign < 0 ? fall : 1.0;
    const Complex u_x = dilatation ? i_unit : a;
    const Complex u_y = dilatation ? a : -i_unit;
    const Complex t = dilatation ? 2.0 * i_unit * a : w.P2 + 2.0;
    const Complex pressure = dilatation ? -(w.P2 + 2.0) : 2.0 * i_unit * a;
    const Complex friction = w.damped * (t - sliding.mu * r.of_pressure * pressure) - r.of_slip * u_x;
    m[0][c] = u_x * above;
    m[1][c] = u_y * above;
    m[2][c] = u_y * below;
    m[3][c] = friction * below;
  }
  // The determinant is odd in a_d and in a_s: the quotient has no branch points.
  return determinant(m) / (w.a_d * w.a_s);
}

std::vector<Mode> modes_of(const std::vector<Complex>& zeros, double rate_per_s) {
  std::vector<Mode> modes;
  for (const Complex p : zeros) modes.push_back({p * rate_per_s});
  return modes;
}

}  // namespace

Sliding uniform_sliding(const interface::FrictionLaw& law, double speed_m_per_s, double pressure_Pa,
                        const interface::Regularisation& regularisation) {
  Sliding s;
  // Weakening by slip is steepest at its beginning; far below any d_c.
  constexpr double small_slip_m = 1e-12;
  s.mu = interface::friction_coefficient(law, speed_m_per_s, 0);
  s.slope_s_per_m = interface::friction_slope_s_per_m(law, speed_m_per_s, 0);
  s.slip_slope_per_m =
      (interface::friction_coefficient(law, speed_m_per_s, small_slip_m) - s.mu) / small_slip_m;
  if (const auto state = interface::state_response(law, speed_m_per_s)) {
    s.slope_s_per_m = state->a / state->V_m_per_s;
    s.state_slope_s_per_m = -state->b / state->V_m_per_s;
    s.state_rate_per_s = state->V_m_per_s / state->d_c_m;
  }
  s.pressure_Pa = pressure_Pa;
  // The strength does not follow the pressure: it does so at no rate.
  s.relaxed = regularisation.relaxed == interface::Relaxed::initial_pressure ? interface::Relaxed::pressure
                                                                             : regularisation.relaxed;
  s.relaxation_rate_per_s = interface::relaxation_rate_per_s(regularisation, speed_m_per_s);
  return s;
}

Complex half_space_relation(const Bodies& bodies, const Sliding& sliding, double wavenumber_per_m,
                            Complex p) {
  const double k = wavenumber_per_m;
  const Complex s = p * k * solid::shear_speed_m_per_s(bodies.above);
  const auto r = response(sliding, solid::shear_modulus_Pa(bodies.above) * k, s);
  const auto c = compliance(bodies, k, s);
  return c.yy + sliding.mu * r.of_pressure * c.xy - r.of_slip * c.determinant;
}

std::vector<Mode> growing_modes(const Bodies& bodies, const Sliding& sliding, double wavenumber_per_m,
                                std::span<const Mode> expected) {
  SLIPFRONT_ASSERT(wavenumber_per_m > 0, "modes are described by k > 0");
  const double rate_per_s = wavenumber_per_m * solid::shear_speed_m_per_s(bodies.above);
  const auto f = [&](Complex p) { return half_space_relation(bodies, sliding, wavenumber_per_m, p); };
  std::vector<Complex> starts;
  for (const Mode& mode : expected) starts.push_back(mode.s_per_s / rate_per_s);
  return modes_of(zeros_by_argument_principle(f, {}, starts), rate_per_s);
}

std::optional<Mode> fastest_growing_mode(const Bodies& bodies, const Sliding& sliding,
                                         double wavenumber_per_m) {
  const auto modes = growing_modes(bodies, sliding, wavenumber_per_m);
  if (modes.empty()) return std::nullopt;
  return modes.front();
}

std::vector<Mode> growing_layer_modes(const solid::Material& material, const Sliding& sliding,
                                      double wavenumber_per_m, double height_m, double largest_rate_per_s) {
  SLIPFRONT_ASSERT(wavenumber_per_m > 0 && height_m > 0, "modes are described by k > 0");
  const double height = wavenumber_per_m * height_m;
  const double rate_per_s = wavenumber_per_m * solid::shear_speed_m_per_s(material);
  Sector sector;
  // Below this the two potentials are too nearly the same for the determinant.
  sector.min_modulus = 1e-3 * std::max(1.0, 1 / height);
  sector.max_modulus = largest_rate_per_s / rate_per_s;
  sector.phase_rate = 2 * height;
  SLIPFRONT_ASSERT(sector.max_modulus > sector.min_modulus, "the largest rate is below the smallest one");
  const auto f = [&](Complex p) { return layer_relation(material, sliding, wavenumber_per_m, height_m, p); };
  return modes_of(zeros_by_argument_principle(f, sector), rate_per_s);
}

}  // namespace slipfront::stability
