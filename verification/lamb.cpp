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

namespace slipfront::verification::lamb {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double force_N_per_m = 1000;  ///< largest line load
constexpr double pulse_s = 20e-6;
constexpr double lift_m = 1e-4;
constexpr std::array distances_m = {10e-3, 20e-3, 30e-3};
// What the boundaries send back does not reach the receivers before the end.
constexpr double width_m = 0.12, height_m = 0.044;

/// The load's course in time: three continuous derivatives.
double course(double t) {
  return t > 0 && t < pulse_s ? std::pow(std::sin(pi * t / pulse_s), 4) : 0;
}

enum Load { tangential, normal };  // to +x, to +y

/// Motion of the edge of a half-plane under a line load at its origin (Lamb 1904), by Cagniard's method: at
/// x > 0 and slowness p = t/x, Im F(p + i0)/(pi G x) is the response to a unit impulse.
class HalfPlane {
 public:
  explicit HalfPlane(const solid::Material& m)
      : G_(solid::shear_modulus_Pa(m)),
        p_L_(1 / solid::longitudinal_speed_m_per_s(m)),
        p_S_(1 / solid::shear_speed_m_per_s(m)),
        p_R_(1 / solid::rayleigh_speed_m_per_s(m)) {}

  /// Displacement along the load, m.
  double along(Load load, double x, double t) const {
    const auto f = [&](double p) { return course(t - p * x) * in_line(load, p); };
    double sum = integral(p_L_, p_S_, f);
    // Principal value at the Rayleigh pole: pairs of points on either side.
    sum += integral(0, p_R_ - p_S_, [&](double s) { return f(p_R_ - s) + f(p_R_ + s); });
    const double from = 2 * p_R_ - p_S_;
    if (t / x > from) sum += integral(from, t / x, f);
    return force_N_per_m / (pi * G_) * sum;
  }
  /// Displacement across: u_y under the tangential load, -u_x under the normal one.
  double across(double x, double t) const {
    const double sum = integral(p_L_, p_S_, [&](double p) { return course(t - p * x) * coupling(p).imag(); });
    // Faster than S waves or at the Rayleigh pole only.
    const double step = 1e-5 * p_R_;
    const double slope =
        ((1.0 / coupling(p_R_ + step)).real() - (1.0 / coupling(p_R_ - step)).real()) / (2 * step);
    return force_N_per_m / (pi * G_) * (sum - pi * course(t - p_R_ * x) / slope);
  }

 private:
  using Complex = std::complex<double>;
  /// sqrt(q^2 - (p + i0)^2)
  static Complex root(double q, double p) {
    return p < q ? Complex(std::sqrt(q * q - p * p), 0) : Complex(0, -std::sqrt(p * p - q * q));
  }
  Complex rayleigh(double p) const {
    const double d = p_S_ * p_S_ - 2 * p * p;
    return d * d + 4 * p * p * root(p_L_, p) * root(p_S_, p);
  }
  double in_line(Load load, double p) const {
    return (p_S_ * p_S_ * root(load == tangential ? p_S_ : p_L_, p) / rayleigh(p)).imag();
  }
  Complex coupling(double p) const {
    return p * (2.0 * root(p_L_, p) * root(p_S_, p) - (p_S_ * p_S_ - 2 * p * p)) / rayleigh(p);
  }
  /// Points crowd at the ends, where the integrands have roots.
  template <class F>
  static double integral(double from, double to, F&& f) {
    constexpr int n = 400;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      const double angle = pi * (i + 0.5) / n;
      sum += f(from + (to - from) * 0.5 * (1 - std::cos(angle))) * std::sin(angle);
    }
    return sum * (to - from) * 0.5 * pi / n;
  }

  double G_, p_L_, p_S_, p_R_;
};

struct Seismogram {
  std::vector<double> t_s;
  std::array<std::vector<double>, 3> u_x_m, u_y_m;  ///< by distance
};

Seismogram run(Load load, double h_m, double end_s, double coarsest_h_m) {
  const auto mesh = mesh::make_plate(
      {.width_m = width_m, .height_m = height_m, .element_size_m = h_m, .corner = mesh::Corner::none});
  const auto steps = steps_to(end_s, h_m, coarsest_h_m);
  motion::Stepper stepper(mesh, undamped, {interface::Coulomb{}},
                          plain_stepping(factor_of_step(mesh, steps.step_s)));
  start(stepper, mesh, {.u_y_m = [](mesh::Node, double) { return lift_m; }});
  const auto at = [&](double x) { return static_cast<int>(std::lround((0.5 * width_m + x) / h_m)); };
  Seismogram s;
  std::vector<double> none(mesh.interface_nodes.size(), 0.0), traction = none;
  for (int step = 0; step < steps.n; ++step) {
    traction[at(0)] = force_N_per_m * course(stepper.time_s()) / h_m;
    if (load == normal) traction[at(0)] *= -1;  // p0 presses down
    stepper.set_prestress(load == tangential ? traction : none, load == normal ? traction : none);
    advance(stepper);
    s.t_s.push_back(stepper.time_s());
    for (std::size_t k = 0; k < distances_m.size(); ++k) {
      const auto n = mesh.grid.node(at(distances_m[k]), 0);
      s.u_x_m[k].push_back(stepper.u_m().x[n]);
      s.u_y_m[k].push_back(stepper.u_m().y[n] - lift_m);
    }
  }
  return s;
}

}  // namespace

Outcome verify(Effort effort) {
  Outcome outcome;
  const HalfPlane half_plane(undamped);
  const std::vector<double> sizes_m = effort == Effort::quick ? std::vector{1e-3, 0.5e-3, 0.25e-3}
                                                              : std::vector{1e-3, 0.5e-3, 0.25e-3, 0.125e-3};
  const double end_s = distances_m.back() / solid::rayleigh_speed_m_per_s(undamped) + pulse_s;
  Chart errors{.x_label = "h (mm)", .y_label = "relative error", .log_x = true, .log_y = true};
  for (const Load load : {tangential, normal}) {
    const char* name = load == tangential ? "tangential" : "normal";
    std::vector<double> h_mm;
    std::array<std::vector<double>, 2> error;  // of u_x, u_y
    Chart chart{.x_label = "t (us)", .y_label = fmt::format("displacement (um), {} load", name)};
    for (const double h_m : sizes_m) {
      const auto s = run(load, h_m, end_s, sizes_m.front());
      const std::size_t every = s.t_s.size() / 50;
      std::array<double, 2> off{}, all{};
      for (std::size_t k = 0; k < distances_m.size(); ++k) {
        std::array<Curve, 2> theory, program;
        for (const int c : {0, 1}) {
          const auto label = fmt::format("{} at {:.0f} mm", c == 0 ? "u_x" : "u_y", 1e3 * distances_m[k]);
          theory[c] = {k + c == 0 ? "theory" : "", Curve::Kind::theory};
          program[c] = {label};
        }
        for (std::size_t i = every - 1; i < s.t_s.size(); i += every) {
          const double x = distances_m[k], t = s.t_s[i];
          const double in_line = half_plane.along(load, x, t), across = half_plane.across(x, t);
          const std::array exact = {load == tangential ? in_line : -across,
                                    load == tangential ? across : in_line};
          const std::array found = {s.u_x_m[k][i], s.u_y_m[k][i]};
          for (const int c : {0, 1}) {
            off[c] += (found[c] - exact[c]) * (found[c] - exact[c]);
            all[c] += exact[c] * exact[c];
            theory[c].x.push_back(1e6 * t), program[c].x.push_back(1e6 * t);
            theory[c].y.push_back(1e6 * exact[c]), program[c].y.push_back(1e6 * found[c]);
          }
        }
        if (h_m == sizes_m.back() && k != 1)
          for (const int c : {0, 1})
            chart.curves.push_back(std::move(theory[c])), chart.curves.push_back(std::move(program[c]));
      }
      h_mm.push_back(1e3 * h_m);
      for (const int c : {0, 1}) error[c].push_back(std::sqrt(off[c] / all[c]));
    }
    for (const int c : {0, 1}) {
      const auto of = fmt::format("{}, {} load", c == 0 ? "u_x" : "u_y", name);
      outcome.check(fmt::format("order of the error of {}", of), observed_order(h_mm, error[c]), 2, 0.1,
                    "the error's next term");
      const auto last = error[c].size() - 1;
      errors.curves.push_back({of, Curve::Kind::program, h_mm, error[c]});
      if (load == normal && c == 1) errors.curves.push_back(order_line(2, h_mm, error[c][last]));
    }
    outcome.charts.push_back(std::move(chart));
  }
  outcome.charts.push_back(std::move(errors));
  return outcome;
}

}  // namespace slipfront::verification::lamb
