// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "interface/friction/coulomb.hpp"
#include "verification/body.hpp"
#include "verification/orders.hpp"
#include "verification/problems.hpp"

namespace slipfront::verification::rayleigh_wave {

namespace {

constexpr double wavelength_m = 0.04;
constexpr double height_m = 4 * wavelength_m;  ///< the wave's tail there: exp(-9.7)
constexpr double k_rad_per_m = 2 * std::numbers::pi / wavelength_m;
constexpr double amplitude_m = 1e-6, lift_m = 1e-5;

/// u_x = U(y) cos(k x - omega t), u_y = V(y) sin(k x - omega t) below a free edge, U(0) = amplitude.
struct RayleighWave {
  double c_R = solid::rayleigh_speed_m_per_s(undamped);
  double decay_L = decay(solid::longitudinal_speed_m_per_s(undamped));
  double decay_S = decay(solid::shear_speed_m_per_s(undamped));
  /// Over depth, 1/m.
  double decay(double c) const { return k_rad_per_m * std::sqrt(1 - std::pow(c_R / c, 2)); }
  double shear_part() const {
    return 2 * decay_L * decay_S / (k_rad_per_m * k_rad_per_m + decay_S * decay_S);
  }
  double scale() const { return amplitude_m / (1 - shear_part()); }
  double U(double y) const {
    return scale() * (std::exp(-decay_L * y) - shear_part() * std::exp(-decay_S * y));
  }
  double V(double y) const {
    return -scale() * decay_L / k_rad_per_m *
           (std::exp(-decay_L * y) - 2 * k_rad_per_m * k_rad_per_m /
                                         (k_rad_per_m * k_rad_per_m + decay_S * decay_S) *
                                         std::exp(-decay_S * y));
  }
};

/// The wave on a mesh, carried by the program.
class Carried {
 public:
  Carried(const RayleighWave& wave, int per_wavelength, bool subcycled)
      : wave_(wave),
        n_(per_wavelength),
        mesh_(layer(wavelength_m, height_m, wavelength_m / per_wavelength)),
        stepper_(mesh_, undamped, {interface::Coulomb{}}, stepping(subcycled)) {
    begin();
  }

  double h_m() const { return wavelength_m / n_; }

  /// Over three wavelengths: other waves of the layer, which the start holds faintly, only make it swing.
  double speed_m_per_s() {
    double travelled = 0, last = angle();
    std::vector<double> times, angles;
    while (wave_.c_R * stepper_.time_s() < 3 * wavelength_m) {
      advance(stepper_);
      const double now = angle();
      travelled -= std::remainder(now - last, 2 * std::numbers::pi);
      last = now;
      times.push_back(stepper_.time_s());
      angles.push_back(travelled);
    }
    travelled_ = travelled;
    return slope(times, angles) / k_rad_per_m;
  }

  /// Amplitudes over depth now.
  Chart depth() const {
    Chart chart{.x_label = "y / wavelength", .y_label = "amplitude / that of u_x at the edge"};
    Curve U{"u_x, theory", Curve::Kind::theory}, V{"u_y, theory", Curve::Kind::theory};
    Curve u{"u_x, program"}, v{"u_y, program"};
    for (int j = 0; j < mesh_.grid.rows / 2; j += n_ / 16) {
      double a = 0, b = 0;
      for (int i = 0; i < n_; ++i) {
        const auto node = mesh_.grid.node(i, j);
        const double at = k_rad_per_m * mesh_.x_m[node] - travelled_;
        a += 2.0 / n_ * stepper_.u_m().x[node] * std::cos(at);
        b += 2.0 / n_ * (stepper_.u_m().y[node] - lift_m) * std::sin(at);
      }
      const double y = j * h_m();
      for (auto* curve : {&U, &V, &u, &v}) curve->x.push_back(y / wavelength_m);
      U.y.push_back(wave_.U(y) / amplitude_m), V.y.push_back(wave_.V(y) / amplitude_m);
      u.y.push_back(a / amplitude_m), v.y.push_back(b / amplitude_m);
    }
    chart.curves = {U, V, u, v};
    return chart;
  }

 private:
  motion::TimeStepping stepping(bool subcycled) const {
    motion::TimeStepping stepping;
    stepping.step_factor = factor_of_step(mesh_, 0.85 * h_m() / solid::longitudinal_speed_m_per_s(undamped));
    if (!subcycled) stepping.interface_substeps = 1;
    return stepping;
  }
  void begin() {
    const auto phase = [&](mesh::Node node, double time) {
      return k_rad_per_m * (mesh_.x_m[node] - wave_.c_R * time);
    };
    const auto held = [&](mesh::Node node) { return mesh_.y_m[node] > height_m - 0.5 * h_m(); };
    const auto u_x = [&](mesh::Node node, double time) {
      return held(node) ? 0 : wave_.U(mesh_.y_m[node]) * std::cos(phase(node, time));
    };
    const auto u_y = [&](mesh::Node node, double time) {
      return lift_m + (held(node) ? 0 : wave_.V(mesh_.y_m[node]) * std::sin(phase(node, time)));
    };
    start(stepper_, mesh_, {.u_x_m = u_x, .u_y_m = u_y});
  }
  /// Phase of the edge's motion along y.
  double angle() const {
    std::complex<double> sum = 0;
    for (const auto node : mesh_.interface_nodes)
      sum += (stepper_.u_m().y[node] - lift_m) * std::polar(1.0, -k_rad_per_m * mesh_.x_m[node]);
    return std::arg(sum);
  }
  /// Of the line of least squares.
  static double slope(const std::vector<double>& times, const std::vector<double>& angles) {
    double mean_t = 0, mean_phi = 0, t_t = 0, t_phi = 0;
    for (std::size_t i = 0; i < times.size(); ++i) mean_t += times[i], mean_phi += angles[i];
    mean_t /= static_cast<double>(times.size()), mean_phi /= static_cast<double>(times.size());
    for (std::size_t i = 0; i < times.size(); ++i) {
      t_t += (times[i] - mean_t) * (times[i] - mean_t);
      t_phi += (times[i] - mean_t) * (angles[i] - mean_phi);
    }
    return t_phi / t_t;
  }

  const RayleighWave& wave_;
  int n_;  ///< elements per wavelength
  mesh::Mesh mesh_;
  motion::Stepper stepper_;
  double travelled_ = 0;  ///< phase
};

void check_speeds(const std::vector<double>& kh, const std::vector<double>& speed,
                  const std::vector<double>& error, const RayleighWave& wave, Outcome& outcome) {
  outcome.check("order of the speed's error", observed_order(kh, error), 2, 0.1, "the error's next term");
  const auto last = speed.size() - 1;
  const double ratio = std::pow(kh[last - 1] / kh[last], 2);
  const double correction = (speed[last] - speed[last - 1]) / (ratio - 1);
  outcome.check("speed, extrapolated to h = 0", speed[last] + correction, wave.c_R,
                std::abs(correction) * kh[last] * kh[last],
                "the extrapolation times (k h)^2: the error's next term", "m/s");
}

}  // namespace

Outcome verify(Effort effort) {
  Outcome outcome;
  const RayleighWave wave;
  const std::vector<int> per_wavelength =
      effort == Effort::quick ? std::vector{12, 16, 24, 32} : std::vector{12, 16, 24, 32, 48, 64};
  Chart errors{.x_label = "k h", .y_label = "relative error of the speed", .log_x = true, .log_y = true};
  for (const bool subcycled : {false, true}) {
    std::vector<double> kh, speed, error;
    for (const int n : per_wavelength) {
      Carried carried(wave, n, subcycled);
      kh.push_back(k_rad_per_m * carried.h_m());
      speed.push_back(carried.speed_m_per_s());
      error.push_back(std::abs(speed.back() / wave.c_R - 1));
      if (n == per_wavelength.back() && !subcycled) outcome.charts.push_back(carried.depth());
    }
    errors.curves.push_back({subcycled ? "4 rows x 18 sub-steps" : "plain", Curve::Kind::program, kh, error});
    if (subcycled) continue;
    errors.curves.push_back(order_line(2, kh, error.back()));
    check_speeds(kh, speed, error, wave, outcome);
  }
  outcome.charts.push_back(std::move(errors));
  return outcome;
}

}  // namespace slipfront::verification::rayleigh_wave
