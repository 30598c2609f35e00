// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <cmath>

#include "verify/body.hpp"
#include "verify/problems.hpp"

namespace slipfront::verify {

namespace {

constexpr double pressure_Pa = 1e6;
constexpr double h_m = 1e-3;

/// Slip rate v > 0 at which rho c_S v = tau0 - p mu(v); unique where the law weakens slower with v than
/// radiation damps.
double slip_rate(double tau0_Pa, double impedance, const interface::VelocityWeakening& law) {
  const auto mu = law.evaluator();
  double low = 0, high = tau0_Pa / impedance;
  for (int i = 0; i < 200; ++i) {
    const double v = 0.5 * (low + high);
    (tau0_Pa - pressure_Pa * mu(v, 0) - impedance * v > 0 ? low : high) = v;
  }
  return 0.5 * (low + high);
}

struct Case {
  double mu_s, mu_k, tau0_Pa;
};

}  // namespace

Outcome column(Effort effort) {
  Outcome outcome;
  const solid::Material material{.stiffness_damping_s = 1e-6};
  const double c_S = solid::shear_speed_m_per_s(material);
  const double impedance = material.density_kg_per_m3 * c_S;
  const double G = solid::shear_modulus_Pa(material);
  const double height_m = effort == Effort::quick ? 0.4 : 0.8;
  const auto mesh = mesh::make_plate({.width_m = 4 * h_m,
                                      .height_m = height_m,
                                      .element_size_m = h_m,
                                      .corner = mesh::Corner::none,
                                      .sides = mesh::Sides::periodic});
  const double return_s = 2 * height_m / c_S;
  Chart rate{.x_label = "t c_S / (2 H)", .y_label = "slip rate (m/s)"};
  for (const Case c : {Case{0.9, 0.5, 0.91e6}, Case{0.9, 0.5, 0.95e6}, Case{0.9, 0.5, 1.00e6},
                       Case{1.3, 1.0, 1.35e6}, Case{1.3, 1.0, 1.40e6}}) {
    const interface::VelocityWeakening law { c.mu_s, c.mu_k, 0.1 };
    const double v = slip_rate(c.tau0_Pa, impedance, law);
    motion::Stepper stepper(mesh, material, {law}, plain_stepping());
    const double shear = c.tau0_Pa / G, strain = pressure_Pa / solid::longitudinal_modulus_Pa(material);
    const auto state = start(stepper, mesh,
                             {.u_x_m = [&](mesh::Node n, double) { return shear * mesh.y_m[n]; },
                              .u_y_m = [&](mesh::Node n, double) { return -strain * mesh.y_m[n]; },
                              .contact = statics::Contact::stick,
                              .t_Pa = c.tau0_Pa,
                              .p_Pa = pressure_Pa});
    motion::Recorder recorder(state, c.mu_s, 0);
    const auto node = mesh.lower[1];
    Curve program{"", Curve::Kind::program, {}, {}};
    double next = 0;
    const auto to = [&](double time_s) {
      while (stepper.time_s() < time_s) {
        stepper.advance(recorder);
        if (stepper.time_s() < next) continue;
        program.x.push_back(stepper.time_s() / return_s);
        program.y.push_back(stepper.v_m_per_s().x[node]);
        next += 0.04 * return_s;
      }
      return std::pair{stepper.time_s(), stepper.u_m().x[node]};
    };
    const std::string name = fmt::format("tau0 {2:.2f} MPa, mu {0} to {1}", c.mu_s, c.mu_k, 1e-6 * c.tau0_Pa);
    rate.curves.push_back(
        {rate.curves.empty() ? "theory" : "", Curve::Kind::theory, {0, 1, 1, 1.4}, {v, v, 0, 0}});
    program.label = fmt::format("{:.2f} MPa, mu_k {}", 1e-6 * c.tau0_Pa, c.mu_k);
    const auto [t_1, u_1] = to(0.4 * return_s);
    const auto [t_2, u_2] = to(0.7 * return_s);
    outcome.checks.push_back({fmt::format("slip rate, {}", name), "m/s", (u_2 - u_1) / (t_2 - t_1), v,
                              1e-6 * v, "tail of the returning front, six of its widths away"});
    to(1.4 * return_s);
    double least = 1, most = -1;
    for (const auto n : mesh.lower) {
      least = std::min(least, stepper.u_m().x[n]);
      most = std::max(most, stepper.u_m().x[n]);
    }
    outcome.checks.push_back({fmt::format("slip, {}", name), "um", 1e6 * most, 1e6 * v * return_s,
                              3e6 * v * std::sqrt(material.stiffness_damping_s * return_s),
                              "three widths of the front, which damping spreads"});
    // Sliding of a wider plane would not stay uniform without the damping.
    outcome.checks.push_back({fmt::format("slip of the interface nodes, largest difference, {}", name), "um",
                              1e6 * (most - least), 0, 1e6 * most * 1e-12,
                              "rounding that disturbances along the interface do not amplify"});
    double sum = 0;
    int n = 0;
    while (stepper.time_s() < 1.6 * return_s) {
      stepper.advance(recorder);
      sum += stepper.interface_state().t_Pa[1];
      ++n;
    }
    outcome.checks.push_back({fmt::format("traction after the return, {}", name), "MPa", 1e-6 * sum / n,
                              1e-6 * (c.tau0_Pa - 2 * impedance * v), 1e-6 * impedance * v * 1e-6,
                              "tails of the fronts"});
    rate.curves.push_back(std::move(program));
  }
  outcome.charts.push_back(std::move(rate));
  return outcome;
}

}  // namespace slipfront::verify
