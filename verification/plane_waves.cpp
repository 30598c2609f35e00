// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "interface/friction/coulomb.hpp"
#include "verification/body.hpp"
#include "verification/problems.hpp"

namespace slipfront::verification::plane_waves {

namespace {

constexpr double lift_m = 1e-5;  ///< keeps the body off the plane
constexpr double h_m = 1e-3;

struct Wave {
  bool shear = false;
  double c_m_per_s = 0;
  const char* name() const { return shear ? "shear" : "longitudinal"; }
};

/// A body in the air.
class Column {
 public:
  Column(const mesh::Mesh& mesh, Wave wave)
      : mesh_(mesh), wave_(wave), stepper_(mesh, undamped, {interface::Coulomb{}}, plain_stepping()) {}

  motion::Stepper& stepper() { return stepper_; }

  /// Uniform motion across, a Gaussian pulse that moves down from `from_m`.
  void start_pulse(double from_m, double width_m) {
    const auto pulse = [=, this](mesh::Node n, double time) {
      const double s = (mesh_.y_m[n] - from_m + wave_.c_m_per_s * time) / width_m;
      return amplitude_m * std::exp(-0.5 * s * s);
    };
    const auto lift = [](mesh::Node, double) { return lift_m; };
    const auto lifted_pulse = [=](mesh::Node n, double time) { return lift_m + pulse(n, time); };
    if (wave_.shear)
      start(stepper_, mesh_, {.u_x_m = pulse, .u_y_m = lift});
    else
      start(stepper_, mesh_, {.u_y_m = lifted_pulse});
  }

  double u_m(int row) const {
    const auto n = mesh_.grid.node(1, row);
    return wave_.shear ? stepper_.u_m().x[n] : stepper_.u_m().y[n] - lift_m;
  }
  double centroid_m() const {
    double sum = 0, moment = 0;
    for (int j = 0; j <= mesh_.grid.rows; ++j) sum += u_m(j), moment += h_m * j * u_m(j);
    return moment / sum;
  }
  std::complex<double> transform(double kh) const {
    std::complex<double> sum = 0;
    for (int j = 0; j <= mesh_.grid.rows; ++j) sum += u_m(j) * std::polar(1.0, -kh * j);
    return sum;
  }

 private:
  static constexpr double amplitude_m = 1e-6;
  const mesh::Mesh& mesh_;
  Wave wave_;
  motion::Stepper stepper_;
};

}  // namespace

Outcome verify(Effort) {
  Outcome outcome;
  Chart chart{.x_label = "k h", .y_label = "phase velocity / wave speed"};
  for (const Wave wave : {Wave{false, solid::longitudinal_speed_m_per_s(undamped)},
                          Wave{true, solid::shear_speed_m_per_s(undamped)}}) {
    const auto mesh = layer(4 * h_m, 0.2, h_m);
    Column column(mesh, wave);
    auto& stepper = column.stepper();
    const double dt = stepper.step_s(), c = wave.c_m_per_s;

    // The centroid moves with the group velocity of infinite wavelength, which the scheme does not disperse.
    // Neither the pulse nor the faint wave that the discrete start sends back reaches an edge.
    column.start_pulse(0.11, 6e-3);
    const double before = column.centroid_m();
    while (c * stepper.time_s() < 0.04) advance(stepper);
    outcome.check(fmt::format("speed of a {} pulse", wave.name()),
                  (before - column.centroid_m()) / stepper.time_s(), c, 1e-6 * c,
                  "tails of the Gaussian pulse", "m/s");

    // u(t) = A e^(i omega t) + B e^(-i omega t) for each k: cos(omega T) = (u(t - T) + u(t + T))/(2 u(t)).
    Curve theory{fmt::format("{}, discrete theory", wave.name()), Curve::Kind::theory};
    Curve program{fmt::format("{}, program", wave.name())};
    double worst = 0;
    for (int i = 1; i <= 31; ++i) {
      const double kh = 0.1 * i;
      column.start_pulse(0.1, 0.6 * h_m);  // short: it holds all wavenumbers
      std::array<std::complex<double>, 3> u;
      // At most half a period between the looks, so that the angle is unique.
      const double omega_expected = 2 / dt * std::asin(c * dt / h_m * std::sin(kh / 2));
      const int n_steps = std::max(1, static_cast<int>(0.5 * std::numbers::pi / (omega_expected * dt)));
      for (auto& value : u) {
        for (int step = 0; step < n_steps; ++step) advance(stepper);
        value = column.transform(kh);
      }
      const double omega = std::acos(((u[0] + u[2]) / (2.0 * u[1])).real()) / (n_steps * dt);
      theory.add(kh, omega_expected * h_m / (kh * c));
      program.add(kh, omega * h_m / (kh * c));
      worst = std::max(worst, std::abs(omega / omega_expected - 1));
    }
    outcome.check(fmt::format("phase velocity of {} waves, 0.1 <= k h <= 3.1: largest relative "
                              "deviation from the discrete theory",
                              wave.name()),
                  worst, 0, 1e-10, "rounding of u, amplified where a component is faint");
    chart.curves.push_back(std::move(theory));
    chart.curves.push_back(std::move(program));
  }
  outcome.charts.push_back(std::move(chart));
  return outcome;
}

}  // namespace slipfront::verification::plane_waves
