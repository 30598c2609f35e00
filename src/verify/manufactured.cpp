// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "verify/body.hpp"
#include "verify/orders.hpp"
#include "verify/problems.hpp"

namespace slipfront::verify {

namespace {

constexpr double side_m = 0.04;       ///< period and height of the layer
constexpr double amplitude_m = 1e-7;  ///< largest displacement of the wave
constexpr double lift_m = 1e-5;       ///< keeps a free edge off the plane
constexpr double pressure_Pa = 1e6;   ///< keeps an edge in contact on it
constexpr double k_rad_per_m = 2 * std::numbers::pi / side_m;

enum class Edge { free, frictionless, stuck };

/// Depth functions of a potential, f'' = -square f: of both signs of `square`, real. f(0) = 1, f'(0) = 0
/// and f(0) = 0, f'(0) = 1.
struct Depth {
  double square = 0;
  double even(double y) const {
    const double q = std::sqrt(std::abs(square));
    return square >= 0 ? std::cos(q * y) : std::cosh(q * y);
  }
  double odd(double y) const {
    const double q = std::sqrt(std::abs(square));
    return square >= 0 ? std::sin(q * y) / q : std::sinh(q * y) / q;
  }
};

/// u_x = U(y) sin(k x - omega t), u_y = V(y) cos(k x - omega t) from the potentials f and g, a linear
/// function of their four coefficients.
struct LayerWave {
  double omega_rad_per_s = 0;
  solid::Material material;
  Eigen::Vector4d coefficient = Eigen::Vector4d::Zero();

  Depth longitudinal() const {
    const double c = solid::longitudinal_speed_m_per_s(material);
    return {std::pow(omega_rad_per_s / c, 2) - k_rad_per_m * k_rad_per_m};
  }
  Depth shear() const {
    const double c = solid::shear_speed_m_per_s(material);
    return {std::pow(omega_rad_per_s / c, 2) - k_rad_per_m * k_rad_per_m};
  }
  /// Rows U, V, U', V' at a height.
  Eigen::Matrix4d motion(double y) const {
    const auto p = longitudinal(), s = shear();
    const double k = k_rad_per_m, a = p.square, b = s.square;
    Eigen::Matrix4d m;
    m << -k * p.even(y), -k * p.odd(y), -b * s.odd(y), s.even(y),         //
        -a * p.odd(y), p.even(y), -k * s.even(y), -k * s.odd(y),          //
        k * a * p.odd(y), -k * p.even(y), -b * s.even(y), -b * s.odd(y),  //
        -a * p.even(y), -a * p.odd(y), k * b * s.odd(y), -k * s.even(y);
    return m;
  }
  /// Rows of sigma_xy / sin and sigma_yy / cos at the lower edge.
  Eigen::Matrix<double, 2, 4> stress_at_edge() const {
    const auto m = motion(0);
    const double G = solid::shear_modulus_Pa(material), P = solid::longitudinal_modulus_Pa(material);
    Eigen::Matrix<double, 2, 4> s;
    s.row(0) = G * (m.row(2) - k_rad_per_m * m.row(1));
    s.row(1) = P * m.row(3) + (P - 2 * G) * k_rad_per_m * m.row(0);
    return s;
  }
  /// Of the lower edge and the held upper one, each row of order 1.
  Eigen::Matrix4d conditions(Edge edge) const {
    const auto below = motion(0), above = motion(side_m);
    const auto stress = stress_at_edge();
    Eigen::Matrix4d m;
    m.row(0) = stress.row(0);
    m.row(1) = stress.row(1);
    if (edge == Edge::stuck) m.row(0) = below.row(0);
    if (edge != Edge::free) m.row(1) = below.row(1);
    m.row(2) = above.row(0);
    m.row(3) = above.row(1);
    for (int r = 0; r < 4; ++r) m.row(r).normalize();
    return m;
  }
  double u_x(double x, double y, double time) const {
    return motion(y).row(0).dot(coefficient) * std::sin(k_rad_per_m * x - omega_rad_per_s * time);
  }
  double u_y(double x, double y, double time) const {
    return motion(y).row(1).dot(coefficient) * std::cos(k_rad_per_m * x - omega_rad_per_s * time);
  }
};

/// The n-th frequency at which the layer has a free wave of wavenumber k, to rounding.
LayerWave layer_wave(Edge edge, int n, const solid::Material& material) {
  LayerWave wave{0, material};
  const auto determinant = [&](double omega) {
    wave.omega_rad_per_s = omega;
    return wave.conditions(edge).determinant();
  };
  const double step = 0.01 * k_rad_per_m * solid::shear_speed_m_per_s(material);
  double low = 10 * step;
  for (int found = 0;; low += step) {
    if (determinant(low) * determinant(low + step) < 0 && ++found == n) break;
    SLIPFRONT_ASSERT(low < 1000 * step, "a layer without waves");
  }
  double high = low + step;
  const bool rises = determinant(low) < 0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    ((determinant(middle) < 0) == rises ? low : high) = middle;
  }
  wave.omega_rad_per_s = 0.5 * (low + high);
  const Eigen::JacobiSVD<Eigen::Matrix4d> svd(wave.conditions(edge), Eigen::ComputeFullV);
  wave.coefficient = svd.matrixV().col(3);
  double largest = 0;
  for (int i = 0; i <= 100; ++i)
    for (const int r : {0, 1})
      largest = std::max(largest, std::abs(wave.motion(0.01 * i * side_m).row(r).dot(wave.coefficient)));
  wave.coefficient *= amplitude_m / largest;
  return wave;
}

/// Relative errors in the L2 norm at the end.
struct Errors {
  double u = 0, v = 0, t = 0, p = 0;
};

Errors run(const LayerWave& wave, Edge edge, double time_s, double h_m, double coarsest_h_m, bool subcycled) {
  const auto mesh = mesh::make_plate({.width_m = side_m,
                                      .height_m = side_m,
                                      .element_size_m = h_m,
                                      .corner = mesh::Corner::none,
                                      .sides = mesh::Sides::periodic});
  const auto steps = steps_to(time_s, h_m, coarsest_h_m, wave.material);
  const double factor = factor_of_step(mesh, wave.material, steps.step_s);
  solve::TimeStepping stepping;  // 18 sub-steps
  stepping.interface_rows = 4;
  stepping.step_factor = factor;
  solve::Stepper stepper(mesh, wave.material, {interface::Coulomb{edge == Edge::stuck ? 10.0 : 0.0}},
                         subcycled ? stepping : plain_stepping(factor));
  // At rest: lifted, or pressed down uniformly.
  const double strain = edge == Edge::free ? 0 : pressure_Pa / solid::longitudinal_modulus_Pa(wave.material);
  const auto u_x = [&](mesh::Node n, double time) {
    return mesh.y_m[n] > side_m - 0.5 * h_m ? 0 : wave.u_x(mesh.x_m[n], mesh.y_m[n], time);
  };
  const auto u_y = [&](mesh::Node n, double time) {
    const double rest = edge == Edge::free ? lift_m : -strain * mesh.y_m[n];
    if (mesh.y_m[n] > side_m - 0.5 * h_m) return rest;
    return rest + wave.u_y(mesh.x_m[n], mesh.y_m[n], time);
  };
  const auto state = start(stepper, mesh,
                           {.u_x_m = u_x,
                            .u_y_m = u_y,
                            .contact = edge == Edge::free           ? solve::Contact::open
                                       : edge == Edge::frictionless ? solve::Contact::slip
                                                                    : solve::Contact::stick,
                            .p_Pa = edge == Edge::free ? 0 : pressure_Pa});
  solve::Recorder recorder(state, 10, 0);
  struct Norm {
    double error = 0, exact = 0;
    void add(double measured, double expected) {
      error += (measured - expected) * (measured - expected);
      exact += expected * expected;
    }
    double relative() const { return exact > 0 ? std::sqrt(error / exact) : std::sqrt(error); }
  } u, v, t, p;
  const Eigen::Vector2d stress = wave.stress_at_edge() * wave.coefficient;
  for (int step = 0; step < steps.n; ++step) {
    stepper.advance(recorder);
    const double then = stepper.time_s() - stepper.substep_s();  // of the last contact update
    for (std::size_t i = 0; i < mesh.lower.size() && edge != Edge::free; ++i) {
      const double phase = k_rad_per_m * mesh.x_m[mesh.lower[i]] - wave.omega_rad_per_s * then;
      if (edge == Edge::stuck) t.add(stepper.interface_state().t_Pa[i], stress(0) * std::sin(phase));
      p.add(stepper.interface_state().p_Pa[i] - pressure_Pa, -stress(1) * std::cos(phase));
    }
  }
  const double now = stepper.time_s();
  const auto velocity = stepper.mean_velocity_m_per_s();
  for (int j = 0; j < mesh.grid.rows; ++j)
    for (int i = 0; i < mesh.grid.columns; ++i) {
      const auto n = mesh.grid.node(i, j);
      const double rest = u_y(n, now) - wave.u_y(mesh.x_m[n], mesh.y_m[n], now);
      u.add(stepper.u_m().x[n], u_x(n, now));
      u.add(stepper.u_m().y[n] - rest, u_y(n, now) - rest);
      // The mean velocity over the last (sub-)step; over the last step between the two kinds of cells.
      const bool between = subcycled && j == stepping.interface_rows;
      const double dt = between ? stepper.step_s() : stepper.step_s(n);
      constexpr double tiny = 1e-4;  // of the (sub-)step, for the derivative
      const double before = now - 0.5 * dt - tiny * dt, after = now - 0.5 * dt + tiny * dt;
      v.add(velocity.x[n], (u_x(n, after) - u_x(n, before)) / (after - before));
      v.add(velocity.y[n], (u_y(n, after) - u_y(n, before)) / (after - before));
    }
  return {u.relative(), v.relative(), t.relative(), p.relative()};
}

}  // namespace

Outcome manufactured(Effort effort) {
  Outcome outcome;
  const solid::Material material{.stiffness_damping_s = 0};
  const std::vector<int> columns =
      effort == Effort::quick ? std::vector{16, 32, 64} : std::vector{32, 64, 128, 256};
  for (const bool subcycled : {false, true}) {
    Chart chart{.x_label = "h (mm)",
                .y_label = fmt::format("relative error, {}", subcycled ? "4 rows x 18 sub-steps" : "plain"),
                .log_x = true,
                .log_y = true};
    for (const auto& [edge, name] :
         {std::pair{Edge::free, "free"}, std::pair{Edge::frictionless, "frictionless"},
          std::pair{Edge::stuck, "stuck"}}) {
      const auto wave = layer_wave(edge, 3, material);
      const double time = 1.2 * 2 * std::numbers::pi / wave.omega_rad_per_s;
      std::vector<double> h, u, v, t, p;
      for (const int n : columns) {
        const auto e = run(wave, edge, time, side_m / n, side_m / columns.front(), subcycled);
        h.push_back(1e3 * side_m / n);
        u.push_back(e.u), v.push_back(e.v), t.push_back(e.t), p.push_back(e.p);
      }
      const auto add = [&](const char* of, const std::vector<double>& error) {
        outcome.checks.push_back({fmt::format("order of the error of {}, {} edge, {}", of, name,
                                              subcycled ? "4 rows x 18 sub-steps" : "plain"),
                                  "", observed_order(h, error), 2, 0.1, "the error's next term"});
        chart.curves.push_back({fmt::format("{}, {}", of, name), Curve::Kind::program, h, error});
      };
      add("u", u);
      add("v", v);
      if (edge == Edge::stuck) add("t", t);
      if (edge != Edge::free) add("p", p);
      if (edge == Edge::stuck) chart.curves.push_back(order_line(2, h, u.back()));
    }
    outcome.charts.push_back(std::move(chart));
  }
  return outcome;
}

}  // namespace slipfront::verify
