// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "interface/friction/slip_weakening.hpp"
#include "verification/body.hpp"
#include "verification/problems.hpp"

namespace slipfront::verification::block {

namespace {

constexpr double H_m = 0.1;
constexpr double p_Pa = 1e6, mu_s = 0.6, mu_k = 0.4;

/// A column that moves uniformly across, its top drawn at a constant speed. Times in T = 2 H/c_S, tractions
/// in the strength drop D, speeds in D/(rho c_S), slip in D T/(rho c_S).
struct Drive {
  double top_speed = 0;
  double first_traction = 0;  ///< uniform at time 0, the interface at rest
  double end = 0;
};

/// Over time.
struct History {
  Curve traction, slip;
};

constexpr double drop_Pa = (mu_s - mu_k) * p_Pa;
constexpr double strength = mu_s / (mu_s - mu_k), residual = mu_k / (mu_s - mu_k);

/// By characteristics: v = f + g, t = g - f on the interface, f(t) the wave that leaves and
/// g(t) = top_speed - f(t - 1) what comes back.
History characteristics(const Drive& drive) {
  constexpr int n = 2000;    // per T
  std::vector<double> f(n);  // before time 0: at rest under the first traction, the top already moving
  for (int j = 0; j < n; ++j) f[j] = -0.5 * drive.first_traction - drive.top_speed * ((j + 0.5) / n - 1);
  History h;
  bool slides = false;
  double slip = 0;
  for (int j = 0; j < static_cast<int>(drive.end * n); ++j) {
    const double g = drive.top_speed - f[j % n];
    if (!slides && 2 * g > strength) slides = true;
    const double v = 2 * g - residual;
    if (slides && v < 0) slides = false;
    f[j % n] = slides ? g - residual : -g;
    if (slides) slip += v / n;
    h.traction.add((j + 0.5) / n, g - f[j % n]);
    h.slip.add((j + 0.5) / n, slip);
  }
  return h;
}

/// The same by the program. @param rows  of cells in the column
History program(const Drive& drive, const solid::Material& material, int rows, double step_factor) {
  const double h_m = H_m / rows, c_S = solid::shear_speed_m_per_s(material);
  const double T_s = 2 * H_m / c_S, v_m_per_s = drop_Pa / (material.density_kg_per_m3 * c_S);
  const auto mesh = layer(3 * h_m, H_m, h_m);
  // Full weakening within one step of any slip.
  const interface::SlipWeakeningHealing law { .mu_s = mu_s, .mu_k = mu_k, .d_c_m = 1e-15 };
  // Constant pressure: otherwise waves of a few elements along x grow from rounding.
  motion::Stepper stepper(mesh, material, {law, {.relaxed = interface::Relaxed::pressure}},
                          plain_stepping(step_factor));
  const double strain = drive.first_traction * drop_Pa / solid::shear_modulus_Pa(material);
  const auto u_x = [&](mesh::Node n, double time) {
    return mesh.y_m[n] * (strain + drive.top_speed * v_m_per_s * time / H_m);
  };
  start(stepper, mesh,
        {.u_x_m = u_x,
         .contact = statics::Contact::stick,
         .t_Pa = drive.first_traction * drop_Pa,
         .p_Pa = p_Pa,
         .loads = {std::vector<double>(mesh.interface_nodes.size(), 0.0),
                   std::vector<double>(mesh.interface_nodes.size(), p_Pa)}});
  History h;
  while (stepper.time_s() < drive.end * T_s) {
    // The tractions of a step belong to the places at its beginning.
    const double time = stepper.time_s() / T_s, slip_m = stepper.u_m().x[mesh.interface_nodes[0]];
    advance(stepper);
    h.traction.add(time, stepper.interface_state().t_Pa[0] / drop_Pa);
    h.slip.add(time, slip_m / (v_m_per_s * T_s));
  }
  return h;
}

Curve theory(const Curve& curve) {
  return {"theory", Curve::Kind::theory, curve.x, curve.y};
}

/// Few enough to be told apart.
Curve points(const char* label, const Curve& all) {
  Curve curve{label};
  const std::size_t every = all.x.size() / 58;
  for (std::size_t i = every / 2; i < all.x.size(); i += every) curve.add(all.x[i], all.y[i]);
  return curve;
}

double mean(const Curve& curve, double from, double to) {
  double sum = 0;
  int n = 0;
  for (std::size_t i = 0; i < curve.x.size(); ++i)
    if (curve.x[i] > from && curve.x[i] < to) sum += curve.y[i], ++n;
  return sum / n;
}

/// One event, the top all but at rest.
void single_event(Effort effort, Outcome& outcome) {
  const double c_L = solid::longitudinal_speed_m_per_s(undamped), c_S = solid::shear_speed_m_per_s(undamped);
  const Drive slow{.top_speed = 1e-4, .first_traction = strength * (1 - 1e-6), .end = 3};
  Chart chart{.x_label = "time c_S / 2 H", .y_label = "traction / strength drop"};
  const auto exact = characteristics(slow);
  chart.curves.push_back(theory(exact.traction));
  for (const int rows :
       effort == Effort::full ? std::vector{50, 100, 200, 400, 800, 1600} : std::vector{50, 200}) {
    const auto h = program(slow, undamped, rows, 0.9);
    // The step dt of c_L dt = 0.9 h spreads a front that has gone 2 H over the length l of an Airy function.
    const double courant = 0.9 * c_S / c_L;
    const double spread = std::cbrt((1 - courant * courant) / 8 * 2 * rows) / (2 * rows);
    const double slip = h.slip.y.back();
    outcome.check(fmt::format("slip of an event over 2 H (t_s - t_k)/G, h = H/{}", rows), slip, 1,
                  spread + courant / rows,
                  "spread of the front by dispersion, over 2 H, and a step at either end");
    if (rows != 200) continue;
    outcome.check(fmt::format("drop of the traction over t_s - t_k, mean of 2 H/c_S after the event, "
                              "h = H/{}",
                              rows),
                  strength - mean(h.traction, 1.5, 2.5), 2, 2 * (spread + courant / rows),
                  "as for the slip, which sets the drop at rest");
    chart.curves.push_back(points("h = H/200", h.traction));
  }
  outcome.charts.push_back(std::move(chart));
}

/// Stick-slip by characteristics and by the program, whose damping goes with h and takes the ripples off the
/// fronts, which would end a stick too early.
struct StickSlip {
  int rows;
  Drive drive{.top_speed = 1 / 5.5, .first_traction = 0.9 * strength, .end = 24};
  History theory, cycle;

  explicit StickSlip(int rows_of_cells) : rows(rows_of_cells) {
    solid::Material damped;
    damped.stiffness_damping_s = 0.3 * H_m / rows / solid::shear_speed_m_per_s(damped);
    theory = characteristics(drive);
    cycle = program(drive, damped, rows, 0.9);
  }
  /// Damping spreads a front into a Gauss error function of standard deviation sqrt(beta t). [T]
  double spread(double time) const { return std::sqrt(0.15 / rows * time); }
  bool rests_from(double time) const {
    const double slip_before = theory.slip.value_at(time - 0.01), slip = theory.slip.value_at(time);
    return slip == theory.slip.value_at(time + 0.5) && slip_before < slip;
  }
  bool is_away_from_fronts(double time) const {
    const double around = 3 * spread(time);
    const double jump = theory.traction.value_at(time + around) - theory.traction.value_at(time - around);
    return std::abs(jump) <= 4 * drive.top_speed * around + 0.01;
  }
  /// Times of the comparison.
  std::vector<double> times() const {
    std::vector<double> all;
    for (double time = 1; time < drive.end - 1; time += 0.01) all.push_back(time);
    return all;
  }
};

void check_slips(const StickSlip& s, Outcome& outcome) {
  int n_events = 0;
  for (const double time : s.times()) {
    if (!s.rests_from(time)) continue;
    ++n_events;
    const double later = time + 0.5;
    outcome.check(fmt::format("slip after event {} over 2 H (t_s - t_k)/G, h = H/{}", n_events, s.rows),
                  s.cycle.slip.value_at(later), s.theory.slip.value_at(time), 2 * s.spread(later),
                  "spread of the fronts that begin and end each event");
  }
}

void check_traction(const StickSlip& s, Outcome& outcome) {
  double square = 0, allowed = 0;
  int n_compared = 0;
  for (const double time : s.times()) {
    if (!s.is_away_from_fronts(time)) continue;
    const double difference = s.cycle.traction.value_at(time) - s.theory.traction.value_at(time);
    square += difference * difference;
    // The slope along a stick times the delay, and 2 per slip, the stiffness of the column.
    const double tolerance = (2 * s.drive.top_speed + 2 * 2) * s.spread(time);
    allowed += tolerance * tolerance;
    ++n_compared;
  }
  outcome.check(fmt::format("traction over t_s - t_k away from fronts: rms deviation, h = H/{}", s.rows),
                std::sqrt(square / n_compared), 0, std::sqrt(allowed / n_compared),
                "delay of the fronts, and the stiffness of the column times the slips' tolerance");
}

void draw(const StickSlip& s, Outcome& outcome) {
  const auto add_chart = [&](const char* y_label, const Curve& exact, const Curve& program) {
    outcome.charts.push_back({.x_label = "time c_S / 2 H",
                              .y_label = y_label,
                              .curves = {theory(exact), points("program", program)}});
  };
  add_chart("traction / strength drop", s.theory.traction, s.cycle.traction);
  add_chart("slip G / (2 H strength drop)", s.theory.slip, s.cycle.slip);
}

}  // namespace

Outcome verify(Effort effort) {
  Outcome outcome;
  single_event(effort, outcome);
  const StickSlip stick_slip(effort == Effort::full ? 1000 : 250);
  check_slips(stick_slip, outcome);
  check_traction(stick_slip, outcome);
  draw(stick_slip, outcome);
  return outcome;
}

}  // namespace slipfront::verification::block
