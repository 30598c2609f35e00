// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "interface/friction/velocity_weakening.hpp"
#include "verification/body.hpp"
#include "verification/problems.hpp"

namespace slipfront::verification::column {

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
  interface::VelocityWeakening law() const {
    return {mu_s, mu_k, 0.1};
  }
  std::string name() const {
    return fmt::format("tau0 {2:.2f} MPa, mu {0} to {1}", mu_s, mu_k, 1e-6 * tau0_Pa);
  }
};
constexpr std::array<Case, 5> cases = {
    {{0.9, 0.5, 0.91e6}, {0.9, 0.5, 0.95e6}, {0.9, 0.5, 1.00e6}, {1.3, 1.0, 1.35e6}, {1.3, 1.0, 1.40e6}}};

struct Column {
  solid::Material material{.stiffness_damping_s = 1e-6};
  mesh::Mesh mesh;
  double return_s;

  explicit Column(double height_m)
      : mesh(layer(4 * h_m, height_m, h_m)), return_s(2 * height_m / solid::shear_speed_m_per_s(material)) {}
  double impedance() const { return material.density_kg_per_m3 * solid::shear_speed_m_per_s(material); }
};

/// The motion of a column under a shear traction that its interface does not bear.
class Fall {
 public:
  Fall(const Column& column, const Case& c)
      : column_(column), stepper_(column.mesh, column.material, {c.law()}, plain_stepping()) {
    const auto& mesh = column.mesh;
    const double shear = c.tau0_Pa / solid::shear_modulus_Pa(column.material);
    const double strain = pressure_Pa / solid::longitudinal_modulus_Pa(column.material);
    start(stepper_, mesh,
          {.u_x_m = [&](mesh::Node n, double) { return shear * mesh.y_m[n]; },
           .u_y_m = [&](mesh::Node n, double) { return -strain * mesh.y_m[n]; },
           .contact = statics::Contact::stick,
           .t_Pa = c.tau0_Pa,
           .p_Pa = pressure_Pa});
  }

  struct Place {
    double time_s, slip_m;
  };
  /// Moves on, taking down the slip rate of a node.
  Place to(double time_s) {
    const auto node = column_.mesh.interface_nodes[1];
    while (stepper_.time_s() < time_s) {
      advance(stepper_);
      if (stepper_.time_s() < next_s_) continue;
      slip_rate_.add(stepper_.time_s() / column_.return_s, stepper_.v_m_per_s().x[node]);
      next_s_ += 0.04 * column_.return_s;
    }
    return {stepper_.time_s(), stepper_.u_m().x[node]};
  }
  double mean_traction_MPa_until(double time_s) {
    double sum = 0;
    int n = 0;
    while (stepper_.time_s() < time_s) {
      advance(stepper_);
      sum += stepper_.interface_state().t_Pa[1];
      ++n;
    }
    return 1e-6 * sum / n;
  }
  struct Range {
    double least = 1, most = -1;
  };
  Range slips_m() const {
    Range range;
    for (const auto n : column_.mesh.interface_nodes) {
      range.least = std::min(range.least, stepper_.u_m().x[n]);
      range.most = std::max(range.most, stepper_.u_m().x[n]);
    }
    return range;
  }
  const Curve& slip_rate() const { return slip_rate_; }

 private:
  const Column& column_;
  motion::Stepper stepper_;
  double next_s_ = 0;
  Curve slip_rate_;
};

void compare(const Column& column, const Case& c, Outcome& outcome, Chart& rate) {
  const double return_s = column.return_s, impedance = column.impedance();
  const double v = slip_rate(c.tau0_Pa, impedance, c.law());
  const std::string name = c.name();
  rate.curves.push_back(
      {rate.curves.empty() ? "theory" : "", Curve::Kind::theory, {0, 1, 1, 1.4}, {v, v, 0, 0}});
  Fall fall(column, c);
  const auto first = fall.to(0.4 * return_s), second = fall.to(0.7 * return_s);
  outcome.check(fmt::format("slip rate, {}", name),
                (second.slip_m - first.slip_m) / (second.time_s - first.time_s), v, 1e-6 * v,
                "tail of the returning front, six of its widths away", "m/s");
  fall.to(1.4 * return_s);
  const auto [least, most] = fall.slips_m();
  outcome.check(fmt::format("slip, {}", name), 1e6 * most, 1e6 * v * return_s,
                3e6 * v * std::sqrt(column.material.stiffness_damping_s * return_s),
                "three widths of the front, which damping spreads", "um");
  // Sliding of a wider plane would not stay uniform without the damping.
  outcome.check(fmt::format("slip of the interface nodes, largest difference, {}", name),
                1e6 * (most - least), 0, 1e6 * most * 1e-12,
                "rounding that disturbances along the interface do not amplify", "um");
  rate.curves.push_back(fall.slip_rate());
  rate.curves.back().label = fmt::format("{:.2f} MPa, mu_k {}", 1e-6 * c.tau0_Pa, c.mu_k);
  outcome.check(fmt::format("traction after the return, {}", name),
                fall.mean_traction_MPa_until(1.6 * return_s), 1e-6 * (c.tau0_Pa - 2 * impedance * v),
                1e-6 * impedance * v * 1e-6, "tails of the fronts", "MPa");
}

}  // namespace

Outcome verify(Effort effort) {
  Outcome outcome;
  const Column column(effort == Effort::quick ? 0.4 : 0.8);
  Chart rate{.x_label = "t c_S / (2 H)", .y_label = "slip rate (m/s)"};
  for (const auto& c : cases) compare(column, c, outcome, rate);
  outcome.charts.push_back(std::move(rate));
  return outcome;
}

}  // namespace slipfront::verification::column
