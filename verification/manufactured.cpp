// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "interface/friction/coulomb.hpp"
#include "verification/body.hpp"
#include "verification/orders.hpp"
#include "verification/problems.hpp"

namespace slipfront::verification::manufactured {

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

/// u_x = U(y) sin(k x) sin(omega t), u_y = V(y) cos(k x) sin(omega t) from the potentials f and g, a linear
/// function of their four coefficients.
struct LayerWave {
  double omega_rad_per_s = 0;
  Eigen::Vector4d coefficient = Eigen::Vector4d::Zero();

  Depth longitudinal() const {
    const double c = solid::longitudinal_speed_m_per_s(undamped);
    return {std::pow(omega_rad_per_s / c, 2) - k_rad_per_m * k_rad_per_m};
  }
  Depth shear() const {
    const double c = solid::shear_speed_m_per_s(undamped);
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
  /// Rows of sigma_xy and sigma_yy at a height, without the functions of x and t.
  Eigen::Matrix<double, 2, 4> stress(double y) const {
    const auto m = motion(y);
    const double G = solid::shear_modulus_Pa(undamped), P = solid::longitudinal_modulus_Pa(undamped);
    Eigen::Matrix<double, 2, 4> s;
    s.row(0) = G * (m.row(2) - k_rad_per_m * m.row(1));
    s.row(1) = P * m.row(3) + (P - 2 * G) * k_rad_per_m * m.row(0);
    return s;
  }
  /// Of the lower edge and the held upper one, each row of order 1.
  Eigen::Matrix4d conditions(Edge edge) const {
    const auto below = motion(0), above = motion(side_m);
    const auto edge_stress = stress(0);
    Eigen::Matrix4d m;
    m.row(0) = edge_stress.row(0);
    m.row(1) = edge_stress.row(1);
    if (edge == Edge::stuck) m.row(0) = below.row(0);
    if (edge != Edge::free) m.row(1) = below.row(1);
    m.row(2) = above.row(0);
    m.row(3) = above.row(1);
    for (int r = 0; r < 4; ++r) m.row(r).normalize();
    return m;
  }
  double u_x(double x, double y, double time) const {
    return motion(y).row(0).dot(coefficient) * std::sin(k_rad_per_m * x) * std::sin(omega_rad_per_s * time);
  }
  double u_y(double x, double y, double time) const {
    return motion(y).row(1).dot(coefficient) * std::cos(k_rad_per_m * x) * std::sin(omega_rad_per_s * time);
  }
};

/// The n-th frequency at which the layer has a free wave of wavenumber k, to rounding.
LayerWave layer_wave(Edge edge, int n) {
  LayerWave wave;
  const auto determinant = [&](double omega) {
    wave.omega_rad_per_s = omega;
    return wave.conditions(edge).determinant();
  };
  const double step = 0.01 * k_rad_per_m * solid::shear_speed_m_per_s(undamped);
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

/// Relative errors in the L2 norm: of u and v at the end, of t and p over the time of the run.
struct Errors {
  double u = 0, v = 0, t = 0, p = 0;
  solid::Field u_end_m, rest_m;
};

/// Relative change of the frequency by the join above `rows` rows of cells: verification/subcycling.md.
double shift_by_join(const LayerWave& wave, double h_m, double step_s, const motion::TimeStepping& stepping) {
  const double c_L = solid::longitudinal_speed_m_per_s(undamped), c_S = solid::shear_speed_m_per_s(undamped);
  const double G = solid::shear_modulus_Pa(undamped), P = solid::longitudinal_modulus_Pa(undamped);
  const Eigen::Vector2d stress = wave.stress((stepping.interface_rows + 0.5) * h_m) * wave.coefficient;
  const int n = stepping.interface_substeps;
  const double join = subcycling::thinning_of_join(c_S * step_s / h_m, n) * stress(0) * stress(0) / G +
                      subcycling::thinning_of_join(c_L * step_s / h_m, n) * stress(1) * stress(1) / P;
  double inertia = 0;
  constexpr int n_points = 1000;
  for (int i = 0; i < n_points; ++i) {
    const Eigen::Vector4d m = wave.motion((i + 0.5) / n_points * side_m) * wave.coefficient;
    inertia += side_m / n_points * (m(0) * m(0) + m(1) * m(1));
  }
  const double omega = wave.omega_rad_per_s;
  return 0.5 * h_m * join / (undamped.density_kg_per_m3 * omega * omega * inertia);
}

/// Of v - u over u.
double relative_distance(const solid::Field& u, const solid::Field& v, const solid::Field& rest) {
  double difference = 0, norm = 0;
  for (std::size_t n = 0; n < u.size(); ++n) {
    difference += std::pow(u.x[n] - v.x[n], 2) + std::pow(u.y[n] - v.y[n], 2);
    norm += std::pow(u.x[n] - rest.x[n], 2) + std::pow(u.y[n] - rest.y[n], 2);
  }
  return std::sqrt(difference / norm);
}

/// In the L2 norm, of numbers one by one.
struct RelativeError {
  double difference = 0, exact = 0;
  void add(double measured, double expected) {
    difference += (measured - expected) * (measured - expected);
    exact += expected * expected;
  }
  double value() const { return exact > 0 ? std::sqrt(difference / exact) : std::sqrt(difference); }
};

Errors run(const LayerWave& wave, Edge edge, double time_s, double h_m, double coarsest_h_m, bool subcycled) {
  const auto mesh = layer(side_m, side_m, h_m);
  const auto steps = steps_to(time_s, h_m, coarsest_h_m);
  const double factor = factor_of_step(mesh, steps.step_s);
  motion::TimeStepping stepping;  // 4 rows of cells, 18 sub-steps
  stepping.step_factor = factor;
  motion::Stepper stepper(mesh, undamped, {interface::Coulomb{edge == Edge::stuck ? 10.0 : 0.0}},
                          subcycled ? stepping : plain_stepping(factor));
  // At rest: lifted, or pressed down uniformly.
  const double strain = edge == Edge::free ? 0 : pressure_Pa / solid::longitudinal_modulus_Pa(undamped);
  const auto u_x = [&](mesh::Node n, double time) {
    return mesh.y_m[n] > side_m - 0.5 * h_m ? 0 : wave.u_x(mesh.x_m[n], mesh.y_m[n], time);
  };
  const auto u_y = [&](mesh::Node n, double time) {
    const double rest = edge == Edge::free ? lift_m : -strain * mesh.y_m[n];
    if (mesh.y_m[n] > side_m - 0.5 * h_m) return rest;
    return rest + wave.u_y(mesh.x_m[n], mesh.y_m[n], time);
  };
  start(stepper, mesh,
        {.u_x_m = u_x,
         .u_y_m = u_y,
         .contact = edge == Edge::free           ? statics::Contact::open
                    : edge == Edge::frictionless ? statics::Contact::slip
                                                 : statics::Contact::stick,
         .p_Pa = edge == Edge::free ? 0 : pressure_Pa});
  RelativeError u, v, t, p;
  const Eigen::Vector2d stress = wave.stress(0) * wave.coefficient;
  for (int step = 0; step < steps.n; ++step) {
    advance(stepper);
    const double then = stepper.time_s() - stepper.substep_s();  // of the last contact update
    for (std::size_t i = 0; i < mesh.interface_nodes.size() && edge != Edge::free; ++i) {
      const double phase = k_rad_per_m * mesh.x_m[mesh.interface_nodes[i]];
      const double course = std::sin(wave.omega_rad_per_s * then);
      if (edge == Edge::stuck) t.add(stepper.interface_state().t_Pa[i], stress(0) * std::sin(phase) * course);
      p.add(stepper.interface_state().p_Pa[i] - pressure_Pa, -stress(1) * std::cos(phase) * course);
    }
  }
  const double now = stepper.time_s();
  auto at_rest = stepper.u_m();  // of the held edge
  const auto velocity = stepper.mean_velocity_m_per_s();
  for (int j = 0; j < mesh.grid.rows; ++j)
    for (int i = 0; i < mesh.grid.columns; ++i) {
      const auto n = mesh.grid.node(i, j);
      at_rest.x[n] = 0;
      const double rest = at_rest.y[n] = u_y(n, now) - wave.u_y(mesh.x_m[n], mesh.y_m[n], now);
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
  return {u.value(), v.value(), t.value(), p.value(), stepper.u_m(), at_rest};
}

}  // namespace

Outcome verify(Effort effort) {
  Outcome outcome;
  const std::vector<int> columns =
      effort == Effort::quick ? std::vector{32, 64, 128} : std::vector{32, 64, 128, 256};
  const auto chart_of = [](const char* y_label) {
    return Chart{.x_label = "h (mm)", .y_label = y_label, .log_x = true, .log_y = true};
  };
  Chart errors = chart_of("relative error, one step"), joined = chart_of("change of u by sub-cycling over u");
  for (const auto& [edge, name] :
       {std::pair{Edge::free, "free"}, std::pair{Edge::frictionless, "frictionless"},
        std::pair{Edge::stuck, "stuck"}}) {
    const auto wave = layer_wave(edge, 2);
    constexpr double n_periods = 3.125;  // where u and v are as far from their zeros
    const double time = n_periods * 2 * std::numbers::pi / wave.omega_rad_per_s;
    std::vector<double> h, u, v, t, p, distance, expected;
    for (const int n : columns) {
      const double h_m = side_m / n, coarsest = side_m / columns.front();
      const auto e = run(wave, edge, time, h_m, coarsest, false);
      h.push_back(1e3 * h_m);
      u.push_back(e.u), v.push_back(e.v), t.push_back(e.t), p.push_back(e.p);
      const auto layered = run(wave, edge, time, h_m, coarsest, true);
      distance.push_back(relative_distance(e.u_end_m, layered.u_end_m, e.rest_m));
      expected.push_back(wave.omega_rad_per_s * time *
                         shift_by_join(wave, h_m, steps_to(time, h_m, coarsest).step_s, {}));
    }
    const auto add = [&, name = name](const char* of, const std::vector<double>& error) {
      outcome.check(fmt::format("order of the error of {}, {} edge", of, name), observed_order(h, error), 2,
                    0.1, "the error's next term");
      if (*of != 'v')  // which would lie on u
        errors.curves.push_back({fmt::format("{}, {}", of, name), Curve::Kind::program, h, error});
    };
    add("u", u);
    add("v", v);
    if (edge == Edge::stuck) add("t", t);
    if (edge != Edge::free) add("p", p);
    if (edge == Edge::stuck) errors.curves.push_back(order_line(2, h, u.back()));
    if (edge == Edge::free) continue;  // no stress at the join either
    outcome.check(fmt::format("change of u by sub-cycling over u, h = {:.4f} mm, {} edge", h.back(), name),
                  distance.back(), expected.back(), expected.back() * 4 / (wave.omega_rad_per_s * time),
                  "other waves that the join scatters, which do not grow with time");
    joined.curves.push_back({fmt::format("{}, theory of the join", name), Curve::Kind::theory, h, expected});
    joined.curves.push_back({fmt::format("{}, program", name), Curve::Kind::program, h, distance});
  }
  outcome.charts = {errors, joined};
  return outcome;
}

}  // namespace slipfront::verification::manufactured
