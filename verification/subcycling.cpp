// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "interface/friction/coulomb.hpp"
#include "verification/body.hpp"
#include "verification/problems.hpp"

namespace slipfront::verification::subcycling {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double h_m = 1e-3;
constexpr double pressure_Pa = 1e6;
constexpr double amplitude_m = 1e-6;

/// Frequency of the lowest standing wave of a column on the plane with its top held: along y without
/// friction, or along x where it sticks.
double frequency(bool shear, int rows, double step_factor, bool subcycled, int n_half_periods) {
  const double height = rows * h_m, q = pi / height;
  const double c = shear ? solid::shear_speed_m_per_s(undamped) : solid::longitudinal_speed_m_per_s(undamped);
  const auto mesh = layer(4 * h_m, height, h_m);
  motion::TimeStepping stepping;  // 4 rows of cells, 18 sub-steps
  stepping.step_factor = step_factor;
  motion::Stepper stepper(mesh, undamped, {interface::Coulomb{shear ? 10.0 : 0.0}},
                          subcycled ? stepping : plain_stepping(step_factor));
  const double strain = pressure_Pa / solid::longitudinal_modulus_Pa(undamped);
  const auto wave = [&](mesh::Node n, double time) {
    return amplitude_m * std::sin(q * mesh.y_m[n]) * std::sin(q * c * time);
  };
  const auto rest = [&](mesh::Node n) { return -strain * mesh.y_m[n]; };
  Start from{.u_y_m = [&](mesh::Node n, double time) { return rest(n) + (shear ? 0 : wave(n, time)); },
             .contact = shear ? statics::Contact::stick : statics::Contact::slip,
             .p_Pa = pressure_Pa};
  if (shear) from.u_x_m = wave;
  start(stepper, mesh, from);
  const auto projection = [&] {
    double sum = 0;
    for (int j = 0; j < rows; ++j) {
      const auto n = mesh.grid.node(1, j);
      sum += std::sin(q * mesh.y_m[n]) * (shear ? stepper.u_m().x[n] : stepper.u_m().y[n] - rest(n));
    }
    return sum;
  };
  // Slope of the times at which the projection passes zero.
  double before = projection(), k_t = 0, k_k = 0;
  const double middle = 0.5 * (n_half_periods + 1);
  for (int k = 1; k <= n_half_periods;) {
    advance(stepper);
    const double now = projection();
    if (before * now < 0) {
      const double time = stepper.time_s() - stepper.step_s() * now / (now - before);
      k_t += (k - middle) * time;
      k_k += (k - middle) * (k - middle);
      ++k;
    }
    before = now;
  }
  return pi * k_k / k_t;
}

}  // namespace

double thinning_of_join(double courant_number, int substeps) {
  // Compliance of the end of the layer's chain of masses to the pushes' harmonics within a step.
  double sum = 0;
  for (int j = 1; j < substeps; ++j) {
    const double s = 2 * substeps / courant_number * std::sin(pi * j / substeps);
    const double half = 1 - 0.5 * s * s;
    const double decay = half + std::sqrt(half * half - 1);
    sum += 1 / (s * s - (1 - decay));
  }
  return sum;
}

Outcome verify(Effort effort) {
  Outcome outcome;
  const int n_half_periods = effort == Effort::quick ? 20 : 60;
  constexpr int rows = 100, layer_rows = 4, substeps = 18;
  Chart chart{.x_label = "c dt / h", .y_label = "relative thinning of the cell above the join"};
  for (const bool shear : {false, true}) {
    const char* name = shear ? "shear" : "longitudinal";
    const double c =
        shear ? solid::shear_speed_m_per_s(undamped) : solid::longitudinal_speed_m_per_s(undamped);
    Curve theory{fmt::format("{}, theory", name), Curve::Kind::theory};
    Curve program{fmt::format("{}, program", name)};
    const double strain = std::cos(pi * (layer_rows + 0.5) / rows);
    for (const double factor : {0.5, 0.7, 0.9}) {
      // c_L dt/h is the factor, but for 0.5 %.
      const double courant = factor * c / solid::longitudinal_speed_m_per_s(undamped);
      const double plain = frequency(shear, rows, factor, false, n_half_periods);
      const double with = frequency(shear, rows, factor, true, n_half_periods);
      theory.x.push_back(courant), program.x.push_back(courant);
      theory.y.push_back(thinning_of_join(courant, substeps));
      program.y.push_back((with / plain - 1) * rows / (strain * strain));
    }
    outcome.check(fmt::format("thinning by the join, {} waves, 0.9 of the stable step", name),
                  program.y.back(), theory.y.back(), 0.05 * theory.y.back(),
                  "second order in k h of the layer's own step, 0.5 % of the stable step");
    chart.curves.push_back(std::move(theory));
    chart.curves.push_back(std::move(program));
  }
  outcome.charts.push_back(std::move(chart));
  return outcome;
}

}  // namespace slipfront::verification::subcycling
