// SPDX-License-Identifier: BSD-3-Clause
#include "verification/scattering.hpp"

#include <Eigen/Dense>

namespace slipfront::verification {

namespace {

/// Displacement and stress of a wave of amplitude 1 at the bond.
struct AtBond {
  Complex u_x, u_y, sigma_xy, sigma_yy;
};

AtBond at_bond(const solid::Material& material, Kind kind, double k_x, Complex k_y, double omega) {
  const double scale = speed_m_per_s(material, kind) / omega;
  const Complex u_x = scale * (kind == Kind::longitudinal ? k_x : -k_y);
  const Complex u_y = scale * (kind == Kind::longitudinal ? k_y : k_x);
  const double P = solid::longitudinal_modulus_Pa(material), G = solid::shear_modulus_Pa(material);
  const Complex i(0, 1);
  return {u_x, u_y, i * G * (k_y * u_x + k_x * u_y), i * (P * k_y * u_y + (P - 2 * G) * k_x * u_x)};
}

}  // namespace

double speed_m_per_s(const solid::Material& material, Kind kind) {
  return kind == Kind::longitudinal ? solid::longitudinal_speed_m_per_s(material)
                                    : solid::shear_speed_m_per_s(material);
}

Complex leaving_k_y(const solid::Material& material, Kind kind, double k_x, double omega) {
  const double k = omega / speed_m_per_s(material, kind);
  return std::sqrt(Complex(k * k - k_x * k_x, 0));
}

Scattered scattered(const std::array<solid::Material, 2>& bodies, Kind incident, double k_x, double omega) {
  // Rows: what above less below is zero. Upside down, u_y and sigma_xy of the body below have the other sign.
  const auto conditions = [&](const AtBond& w, int body) {
    if (body == 0) return Eigen::Vector4cd(w.u_x, w.u_y, w.sigma_xy, w.sigma_yy);
    return Eigen::Vector4cd(-w.u_x, w.u_y, w.sigma_xy, -w.sigma_yy);
  };
  // Stresses over displacements, so that the rows are of one size.
  const double impedance = omega * bodies[0].density_kg_per_m3 * speed_m_per_s(bodies[0], incident);
  const Eigen::Vector4d scale(1, 1, 1 / impedance, 1 / impedance);
  Eigen::Matrix4cd matrix;
  for (int body = 0; body < 2; ++body)
    for (const Kind kind : kinds) {
      const Complex k_y = leaving_k_y(bodies[body], kind, k_x, omega);
      matrix.col(2 * body + static_cast<int>(kind)) =
          scale.asDiagonal() * conditions(at_bond(bodies[body], kind, k_x, k_y, omega), body);
    }
  const Complex k_y = -leaving_k_y(bodies[0], incident, k_x, omega);
  const Eigen::Vector4cd given =
      scale.asDiagonal() * conditions(at_bond(bodies[0], incident, k_x, k_y, omega), 0);
  const Eigen::Vector4cd a = matrix.partialPivLu().solve(-given);
  return {{{a(0), a(1)}, {a(2), a(3)}}};
}

namespace {

struct Stress {
  Complex xy, yy;
};

/// Of the incident wave in the body above and all scattered ones.
Stress stress_at(double y, int body, const std::array<solid::Material, 2>& bodies, Kind incident,
                 const Scattered& amplitude, double k_x, double omega) {
  Stress sum{};
  const auto add = [&](Complex a, Kind kind, Complex k_y) {
    const auto w = at_bond(bodies[body], kind, k_x, k_y, omega);
    a *= std::exp(Complex(0, 1) * k_y * y);
    sum.xy += a * w.sigma_xy, sum.yy += a * w.sigma_yy;
  };
  for (const Kind kind : kinds)
    add(of(amplitude, body, kind), kind, leaving_k_y(bodies[body], kind, k_x, omega));
  if (body == 0) add(1, incident, -leaving_k_y(bodies[0], incident, k_x, omega));
  return sum;
}

}  // namespace

Scattered change_by(const std::array<Compliance, 2>& lines, const std::array<solid::Material, 2>& bodies,
                    Kind incident, double k_x, double omega) {
  const auto given = scattered(bodies, incident, k_x, omega);
  Scattered change{};
  for (int to = 0; to < 2; ++to)
    for (const Kind kind : kinds) {
      const double k_y = leaving_k_y(bodies[to], kind, k_x, omega).real();
      if (k_y == 0) continue;
      // Reciprocity with the wave that comes back, mirrored in x; above is the body in which it comes.
      const std::array<solid::Material, 2> turned = {bodies[to], bodies[1 - to]};
      const auto back = scattered(turned, kind, k_x, omega);
      Complex sum = 0;
      for (int body = 0; body < 2; ++body) {
        const auto& line = lines[body];
        const auto a = stress_at(line.y_m, body, bodies, incident, given, k_x, omega);
        const auto b = stress_at(line.y_m, body == to ? 0 : 1, turned, kind, back, k_x, omega);
        sum += line.across_m_per_Pa * a.yy * b.yy - line.along_m_per_Pa * a.xy * b.xy;
      }
      const double c = speed_m_per_s(bodies[to], kind), sign = kind == Kind::longitudinal ? 1 : -1;
      of(change, to, kind) = sign * sum / Complex(0, 2 * bodies[to].density_kg_per_m3 * c * c * k_y);
    }
  return change;
}

}  // namespace slipfront::verification
