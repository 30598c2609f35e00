// SPDX-License-Identifier: BSD-3-Clause
#include "verify/sliding.hpp"

#include <cmath>
#include <numbers>
#include <numeric>

#include "stability/modes.hpp"
#include "verify/body.hpp"

namespace slipfront::verify {

namespace {

constexpr Complex i_unit{0, 1};

Complex determinant(const std::array<std::array<Complex, 3>, 3>& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

}  // namespace

WaveShape::WaveShape(const solid::Material& material, double wavenumber_per_m, Complex s_per_s,
                     double height_m)
    : height_m_(height_m) {
  const double k = wavenumber_per_m;
  const double c_L = solid::longitudinal_speed_m_per_s(material), c_S = solid::shear_speed_m_per_s(material);
  const Complex P2 = std::pow(s_per_s / (k * c_S), 2);
  const Complex a_d = std::sqrt(1.0 + P2 * (c_S * c_S / (c_L * c_L))), a_s = std::sqrt(1.0 + P2);
  // Dilatation falling from below and from above, then shear; each over its potential's k.
  const std::array<Complex, 4> a = {-a_d, a_d, -a_s, a_s};
  const std::array<Complex, 4> x = {i_unit, i_unit, a[2], a[3]};
  const std::array<Complex, 4> y = {a[0], a[1], -i_unit, -i_unit};
  std::array<Complex, 4> amplitude{};
  if (height_m == 0) {
    amplitude = {y[2], 0, -y[0], 0};
  } else {
    // At rest at the top, on the plane below: three conditions, solved by their minors.
    std::array<std::array<Complex, 4>, 3> rows;
    for (std::size_t c = 0; c < 4; ++c) {
      const Complex fall = std::exp((c % 2 == 0 ? a[c] : -a[c]) * k * height_m);
      const Complex above = c % 2 == 0 ? fall : 1.0, below = c % 2 == 0 ? 1.0 : fall;
      rows[0][c] = x[c] * above;
      rows[1][c] = y[c] * above;
      rows[2][c] = y[c] * below;
    }
    for (std::size_t left_out = 0; left_out < 4; ++left_out) {
      std::array<std::array<Complex, 3>, 3> minor;
      for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0, to = 0; c < 4; ++c)
          if (c != left_out) minor[r][to++] = rows[r][c];
      amplitude[left_out] = (left_out % 2 == 0 ? 1.0 : -1.0) * determinant(minor);
    }
  }
  for (std::size_t c = 0; c < 4; ++c) {
    rate_per_m_[c] = a[c] * k;
    u_x_[c] = amplitude[c] * x[c];
    u_y_[c] = amplitude[c] * y[c];
  }
  const Complex scale = 1.0 / u_x(0);
  for (std::size_t c = 0; c < 4; ++c) {
    u_x_[c] *= scale;
    u_y_[c] *= scale;
  }
  // p = -sigma_yy = -(rho c_L^2 du_y/dy + lambda du_x/dx), lambda = rho (c_L^2 - 2 c_S^2).
  const double M = solid::longitudinal_modulus_Pa(material), G = solid::shear_modulus_Pa(material);
  Complex strain_yy = 0;
  for (std::size_t c = 0; c < 4; ++c)
    strain_yy += rate_per_m_[c] * u_y_[c] * (c % 2 == 0 ? 1.0 : std::exp(-rate_per_m_[c] * height_m));
  pressure_ = -(M * strain_yy + (M - 2 * G) * i_unit * k);
}

Complex WaveShape::sum(const std::array<Complex, 4>& amplitude, double y_m) const {
  Complex total = 0;
  for (std::size_t c = 0; c < 4; ++c)
    if (amplitude[c] != Complex{0})
      total += amplitude[c] * std::exp(rate_per_m_[c] * (c % 2 == 0 ? y_m : y_m - height_m_));
  return total;
}

Complex Growth::rate_per_s() const {
  const auto n = static_cast<double>(time_s.size());
  const double t_mean = std::accumulate(time_s.begin(), time_s.end(), 0.0) / n;
  Complex numerator = 0;
  double denominator = 0;
  for (std::size_t j = 0; j < time_s.size(); ++j) {
    numerator += (time_s[j] - t_mean) * log_u[j];
    denominator += (time_s[j] - t_mean) * (time_s[j] - t_mean);
  }
  return numerator / denominator;
}

Growth carry(const SlidingWave& w) {
  constexpr double amplitude_m = 1e-8;
  const double k = w.wavenumber_per_m, length = 2 * std::numbers::pi / k, h = length / w.elements_per_wave;
  const double c_L = solid::longitudinal_speed_m_per_s(w.material);
  const int rows =
      static_cast<int>(w.height_m > 0 ? std::round(w.height_m / h) : std::ceil(c_L * w.end_s / h) + 4);
  const WaveShape shape(w.material, k, w.s_per_s, w.height_m > 0 ? rows * h : 0);
  const auto mesh = mesh::make_plate({.width_m = length,
                                      .height_m = rows * h,
                                      .element_size_m = h,
                                      .corner = mesh::Corner::none,
                                      .sides = mesh::Sides::periodic});
  // The same c_L dt/h on every mesh, and a whole number of steps: errors then follow powers of h.
  const int n_steps = w.elements_per_wave * static_cast<int>(std::ceil(c_L * w.end_s / (0.9 * length)));
  const double stable_s = motion::Stepper(mesh, w.material, w.contact, plain_stepping()).stable_step_s();
  motion::Stepper stepper(mesh, w.material, w.contact, plain_stepping(w.end_s / (n_steps * stable_s)));
  const auto phase = [&](mesh::Node n, double time) {
    return amplitude_m * std::exp(i_unit * k * mesh.x_m[n] + w.s_per_s * time);
  };
  const double mu = stability::uniform_sliding(w.contact.law, w.speed_m_per_s, w.pressure_Pa).mu;
  auto state = start(stepper, mesh,
                     {.u_x_m =
                          [&](mesh::Node n, double time) {
                            return w.speed_m_per_s * time + (phase(n, time) * shape.u_x(mesh.y_m[n])).real();
                          },
                      .u_y_m =
                          [&](mesh::Node n, double time) {
                            // On the plane to the last digit, so that no gap opens.
                            return mesh.y_m[n] == 0 ? 0.0 : (phase(n, time) * shape.u_y(mesh.y_m[n])).real();
                          },
                      .contact = statics::Contact::slip,
                      .t_Pa = mu * w.pressure_Pa,
                      .p_Pa = w.pressure_Pa});
  // A delayed response has a part of the wave in its memory.
  if (w.contact.regularisation.relaxed != interface::Relaxed::none) {
    const double rate = interface::relaxation_rate_per_s(w.contact.regularisation, w.speed_m_per_s);
    const Complex delayed = shape.pressure_Pa_per_m() * rate / (rate + w.s_per_s);
    for (std::size_t i = 0; i < mesh.lower.size(); ++i)
      state.tractions.p_s_Pa[i] += (phase(mesh.lower[i], 0) * delayed).real();
    stepper.start(state, 1);
  }
  stepper.set_prestress(std::vector<double>(mesh.lower.size(), mu * w.pressure_Pa),
                        std::vector<double>(mesh.lower.size(), w.pressure_Pa));

  const auto transform = [&] {
    Complex sum = 0;
    for (const auto n : mesh.lower)
      sum += (stepper.u_m().x[n] - w.speed_m_per_s * stepper.time_s()) * std::exp(-i_unit * k * mesh.x_m[n]);
    return sum;
  };
  motion::Recorder recorder(state, mu, 0);
  Growth growth{{0}, {0}};
  Complex last = transform();
  while (stepper.step() < n_steps) {
    stepper.advance(recorder);
    const Complex now = transform();
    growth.time_s.push_back(stepper.time_s());
    growth.log_u.push_back(growth.log_u.back() + std::log(now / last));
    last = now;
  }
  return growth;
}

}  // namespace slipfront::verify
