// SPDX-License-Identifier: BSD-3-Clause
#include "reflection.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "motion/stepper.hpp"
#include "motion/support.hpp"

namespace slipfront::motion::test {

using Complex = std::complex<double>;
using std::numbers::pi;

Reflection theory(PlaneWave incident, double sine, double ratio) {
  const bool shear = incident == PlaneWave::shear;
  // Angles of both waves, Snell's law; beyond the critical angle the longitudinal one clings to the edge.
  const Complex sin_p = shear ? sine * ratio : sine, sin_s = shear ? sine : sine / ratio;
  const Complex cos_s = std::sqrt(1.0 - sin_s * sin_s);
  Complex cos_p = std::sqrt(1.0 - sin_p * sin_p);
  if (sin_p.real() > 1) cos_p = Complex(0, -std::abs(cos_p));
  // Tangential and normal traction of edge and dashpot over rho c_S and rho c_L times the rate.
  const Complex p_x = sin_p * (1.0 + 2.0 * cos_p / ratio);
  const Complex p_y = -cos_p - 1.0 + 2.0 * sin_p * sin_p / (ratio * ratio);
  const Complex s_x = cos_s + cos_s * cos_s - sin_s * sin_s;
  const Complex s_y = sin_s * (1.0 + 2.0 * cos_s / ratio);
  const Complex in_x = shear ? cos_s - cos_s * cos_s + sin_s * sin_s : sin_p * (1.0 - 2.0 * cos_p / ratio);
  const Complex in_y =
      shear ? -sin_s * (1.0 - 2.0 * cos_s / ratio) : cos_p - 1.0 + 2.0 * sin_p * sin_p / (ratio * ratio);
  const Complex determinant = p_x * s_y - s_x * p_y;
  return {-(in_x * s_y - s_x * in_y) / determinant, -(p_x * in_y - in_x * p_y) / determinant};
}

Measurement measure(PlaneWave incident, int columns, double wavelength, const solid::Material& material) {
  const bool shear = incident == PlaneWave::shear;
  constexpr double h = 1e-3, amplitude = 1e-6, lift = 1e-4;
  const double c_L = solid::longitudinal_speed_m_per_s(material), c_S = solid::shear_speed_m_per_s(material);
  const double c = shear ? c_S : c_L;
  const double k = 2 * pi / (wavelength * h), k_x = columns > 0 ? 2 * pi / (columns * h) : 0;
  const double sine = k_x / k, q_0 = std::sqrt(k * k - k_x * k_x);

  // A Gaussian packet: 5 standard deviations before the edge, five wide to each side. A longitudinal wave
  // that a shear wave leaves behind is faster by less than c_L/c_S.
  const double sigma = 1.5 * 2 * pi / q_0, distance = 5 * sigma;
  const double height = h * std::ceil((shear ? c_L / c_S : 1.0) * 10.5 * sigma / h);
  auto plate = support::plate_of(std::max(columns, 4) * h, height, h);
  plate.sides = mesh::Sides::periodic;
  plate.top = mesh::Top::absorbing;
  const auto mesh = mesh::make_plate(plate);
  Stepper stepper(mesh, material, support::paper_law, {.interface_substeps = 1});

  const auto spectrum = [&](double q) { return std::exp(-0.5 * std::pow((q - q_0) * sigma, 2)); };
  // Displacement and velocity by row, over exp(-i k_x x).
  const int rows = mesh.grid.rows + 1, n_columns = mesh.grid.columns;
  std::vector<Complex> u_x(rows), u_y(rows), v_x(rows), v_y(rows);
  const double dq = 2 * pi / (4 * height);
  for (double q = dq; q < q_0 + 6 / sigma; q += dq) {
    if (q < q_0 - 6 / sigma) continue;
    const double size = std::hypot(k_x, q), omega = c * size;
    const double pol_x = shear ? q / size : k_x / size, pol_y = shear ? -k_x / size : q / size;
    for (int j = 0; j < rows; ++j) {
      const Complex u =
          amplitude * dq * sigma * spectrum(q) * std::polar(1.0, -q * (h * j - height + distance));
      const Complex v = Complex(0, omega) * u * std::polar(1.0, -0.5 * omega * stepper.step_s());
      u_x[j] += u * pol_x;
      u_y[j] += u * pol_y;
      v_x[j] += v * pol_x;
      v_y[j] += v * pol_y;
    }
  }
  solid::Field u(mesh.n_nodes()), v(mesh.n_nodes());
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < n_columns; ++i) {
      const auto n = mesh.grid.node(i, j);
      const Complex phase = std::polar(1.0, -k_x * h * i);
      u.x[n] = (u_x[j] * phase).real();
      u.y[n] = lift + (u_y[j] * phase).real();  // in the air
      v.x[n] = (v_x[j] * phase).real();
      v.y[n] = (v_y[j] * phase).real();
    }
  support::UnderWay way(std::move(stepper), support::in_flight(mesh, u, v), 1);
  way.advance_to(2 * distance * k / (c * q_0));

  for (int j = 0; j < rows; ++j) {
    u_x[j] = u_y[j] = 0;
    for (int i = 0; i < n_columns; ++i) {
      const auto n = mesh.grid.node(i, j);
      const Complex phase = std::polar(2.0 / n_columns, k_x * h * i);
      u_x[j] += way.stepper.u_m().x[n] * phase;
      u_y[j] += (way.stepper.u_m().y[n] - lift) * phase;
    }
  }
  // What goes down is exp(i q y), along it or across.
  const auto down = [&](double q, bool as_shear) {
    const double size = std::hypot(k_x, q);
    Complex sum = 0;
    for (int j = 0; j < rows; ++j)
      sum += std::polar(h, -q * h * j) * (as_shear ? u_x[j] * q + u_y[j] * k_x : u_x[j] * k_x - u_y[j] * q) /
             size;
    return std::abs(sum) / (2 * pi * amplitude * sigma);
  };
  // The same wave keeps its q. That of the other one is shifted a little by the elements' dispersion: the
  // largest amplitude near it is taken.
  const auto largest_down = [&](double q, bool as_shear) {
    double largest = 0;
    for (int step = -20; step <= 20; ++step)
      largest = std::max(largest, down(q * (1 + 0.0025 * step), as_shear));
    return largest;
  };
  // A frequency keeps k_x; the other wave has another q, and so another spacing in it.
  Measurement m;
  m.sine = sine;
  const double other = shear ? c_S / c_L : c_L / c_S;
  const double q_square = other * other * k * k - k_x * k_x;
  const double same = down(q_0, shear);
  const double q_other = std::sqrt(std::max(0.0, q_square));
  const double converted = q_square > 0 ? largest_down(q_other, !shear) * other * other * q_0 / q_other : 0;
  m.longitudinal = shear ? converted : same;
  m.shear = shear ? same : converted;
  return m;
}

}  // namespace slipfront::motion::test
