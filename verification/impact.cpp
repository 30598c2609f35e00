// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "interface/friction/coulomb.hpp"
#include "verification/body.hpp"
#include "verification/problems.hpp"

namespace slipfront::verification::impact {

namespace {

using interface::ContactAlgorithm;

constexpr double height_m = 0.1;
constexpr double speed_m_per_s = 1;
const double rho = undamped.density_kg_per_m3, c_L = solid::longitudinal_speed_m_per_s(undamped);
const double there_and_back_s = 2 * height_m / c_L;
const double impact_Pa = rho * c_L * speed_m_per_s;  ///< pressure of an impact
/// Share of a step's way that is left above the plane before the step in which the body lands.
constexpr double share_left = 0.5;

const char* name(ContactAlgorithm algorithm) {
  return algorithm == ContactAlgorithm::direct ? "direct" : "predictor_corrector";
}

/// A layer, periodic along x, free on top, that falls at speed_m_per_s onto a plane without friction.
class Fall {
 public:
  Fall(ContactAlgorithm algorithm, int n_elements, double step_factor)
      : h_m_(height_m / n_elements),
        mesh_(layer(4 * h_m_, height_m, h_m_, mesh::Top::free)),
        stepper_(mesh_, undamped, {interface::Coulomb{.mu = 0}, {}, algorithm}, plain_stepping(step_factor)) {
    verification::start(stepper_, mesh_, {.u_y_m = [this](mesh::Node, double time) {
                          const double gap_m = (3 + share_left) * speed_m_per_s * step_s();
                          return gap_m - speed_m_per_s * time;
                        }});
    start_ = stepper_.energies();
  }

  /// External pressure that pulls the lower face down.
  void pull(double p_Pa) {
    const auto n = mesh_.interface_nodes.size();
    stepper_.set_prestress(std::vector<double>(n, 0.0), std::vector<double>(n, p_Pa));
  }

  void advance() {
    verification::advance(stepper_);
    const auto& s = stepper_.interface_state();
    const bool touches = s.p_Pa[0] > 0 || s.locked[0] != 0;
    if (touches != touched_) ++n_changes_;
    touched_ = touches;
  }

  double h_m() const { return h_m_; }
  double step_s() const { return stepper_.step_s(); }
  double time_s() const { return stepper_.time_s(); }
  double p_Pa() const { return stepper_.interface_state().p_Pa[0]; }
  bool touches() const { return touched_; }
  int n_changes() const { return n_changes_; }  ///< of contact
  double mean_v_y_m_per_s() const {
    double momentum = 0, mass = 0;
    const auto& m = stepper_.plate().mass_kg;
    for (std::size_t n = 0; n < m.size(); ++n) momentum += m[n] * stepper_.v_m_per_s().y[n], mass += m[n];
    return momentum / mass;
  }
  record::Energies start() const { return start_; }
  record::Energies energies() { return stepper_.energies(); }

 private:
  double h_m_;
  mesh::Mesh mesh_;
  motion::Stepper stepper_;
  record::Energies start_;
  bool touched_ = false;
  int n_changes_ = 0;
};

struct Impact {
  double h_m = 0, step_s = 0;
  double bounce_m_per_s = 0;
  double contact_s = 0;         ///< from the first step under pressure to the last
  double mean_p_Pa = 0;         ///< over the middle half of the contact in theory
  double reported_impulse = 0;  ///< of p over the change of momentum
  double lost = 0;              ///< of the energy, as a share
  int n_changes = 0;
  Curve pressure = {};
};

Impact fall(ContactAlgorithm algorithm, int n_elements, double step_factor) {
  Fall body(algorithm, n_elements, step_factor);
  Impact impact{.h_m = body.h_m(), .step_s = body.step_s()};
  double from_s = -1, to_s = 0, impulse = 0, sum = 0;
  int n = 0;
  while (body.time_s() < 1.5 * there_and_back_s) {
    body.advance();
    const double p = body.p_Pa();
    impulse += p * body.step_s();
    if (body.touches() && from_s < 0) from_s = body.time_s() - body.step_s();
    const double since_s = (body.time_s() - from_s) / there_and_back_s;
    if (body.touches()) to_s = body.time_s();
    if (from_s >= 0) {
      impact.pressure.add(since_s, p / impact_Pa);
    }
    if (from_s >= 0 && since_s > 0.25 && since_s < 0.75) sum += p, ++n;
  }
  impact.bounce_m_per_s = body.mean_v_y_m_per_s();
  impact.contact_s = to_s - from_s;
  impact.mean_p_Pa = sum / n;
  impact.reported_impulse = impulse / (rho * height_m * (speed_m_per_s + impact.bounce_m_per_s));
  impact.lost = 1 - body.energies().stored() / body.start().stored();
  impact.n_changes = body.n_changes();
  return impact;
}

/// Loss of the kinetic energy of the lowest nodes, a quarter of an element's mass on each side, with what the
/// step adds where it ends above the plane; verification/impact.md.
double lost_in_theory(const Impact& impact) {
  const double r = c_L * impact.step_s / impact.h_m;
  return impact.h_m / (2 * height_m) * (1 + 2 * r * r * share_left * (1 - share_left));
}

/// Length by which the first maximum of a wave's front lags behind after the way there and back, over that
/// way.
double lag(const Impact& impact) {
  const double n = 2 * height_m / impact.h_m;
  const double r = c_L * impact.step_s / impact.h_m;
  constexpr double first_zero_of_Ai = 2.338;
  return first_zero_of_Ai * std::cbrt(n * (1 - r * r) / 8) / n;
}

void check_impact(ContactAlgorithm algorithm, int n_elements, double step_factor, Outcome& outcome) {
  const auto impact = fall(algorithm, n_elements, step_factor);
  const auto check = [&](std::string_view what, const char* unit, double measured, double expected,
                         double tolerance, const char* reason) {
    outcome.check(fmt::format("{} elements, {:g} of the stable step, {}: {}", n_elements, step_factor,
                              name(algorithm), what),
                  measured, expected, tolerance, reason, unit);
  };
  const char* dispersion = "lag of the wave's first maximum by dispersion";
  check("speed of the bounce", "m/s", impact.bounce_m_per_s, speed_m_per_s, lag(impact) * speed_m_per_s,
        dispersion);
  check("duration of contact", "us", 1e6 * impact.contact_s, 1e6 * there_and_back_s,
        1e6 * lag(impact) * there_and_back_s, dispersion);
  check("pressure in the middle half of the contact", "MPa", 1e-6 * impact.mean_p_Pa, 1e-6 * impact_Pa,
        1e-6 * impact_Pa * std::numbers::pi * std::pow(impact.h_m / height_m, 1.5),
        "the mean cuts a period of the lattice's ringing");
  const double expected_loss = lost_in_theory(impact);
  check("share of the energy lost", "", impact.lost, expected_loss, 1e-9, "rounding of the falling body");
  check("changes of contact", "", impact.n_changes, 2, 0, "one landing, one release");
  // A landing by projection has no pressure.
  const double unreported =
      algorithm == ContactAlgorithm::direct
          ? 0
          : 0.5 * impact.h_m / height_m * speed_m_per_s / (speed_m_per_s + impact.bounce_m_per_s);
  check("impulse of the reported pressure over the change of momentum", "", impact.reported_impulse,
        1 - unreported, 1e-9, "rounding of the falling body");
}

/// Many impacts of a body whose lower face is pulled down.
Curve pulled(ContactAlgorithm algorithm, int n_elements, double& worst_imbalance, int& n_landings) {
  Fall body(algorithm, n_elements, 0.9);
  const double p_Pa = 0.1 * rho * c_L * speed_m_per_s;
  body.pull(p_Pa);
  const double flight_s = 2 * rho * height_m * speed_m_per_s / p_Pa;
  Curve curve{name(algorithm)};
  worst_imbalance = 0;
  double next_s = 0;
  while (body.time_s() < 20 * flight_s) {
    body.advance();
    if (body.time_s() < next_s) continue;
    next_s += 0.05 * flight_s;
    const auto now = body.energies();
    worst_imbalance = std::max(worst_imbalance, std::abs(imbalance_J_per_m(now, body.start())));
    curve.add(body.time_s() / flight_s, -now.contact_work / body.start().stored());
  }
  worst_imbalance /= body.start().stored();
  n_landings = (body.n_changes() + 1) / 2;
  return curve;
}

}  // namespace

Outcome verify(Effort effort) {
  Outcome outcome;
  constexpr std::array algorithms = {ContactAlgorithm::direct, ContactAlgorithm::predictor_corrector};
  for (const auto algorithm : algorithms)
    for (const double step_factor : {0.9, 0.05}) check_impact(algorithm, 50, step_factor, outcome);
  if (effort == Effort::quick) return outcome;

  Chart pressure{.x_label = "time since landing / (2 H / c_L)", .y_label = "p / (rho c_L V)"};
  pressure.curves.push_back({"theory", Curve::Kind::theory, {0, 0, 1, 1, 1.4}, {0, 1, 1, 0, 0}});
  Chart lost{.x_label = "h / H", .y_label = "energy lost / kinetic energy", .log_x = true, .log_y = true};
  Curve theory{"h / (2 H)", Curve::Kind::theory};
  for (const auto algorithm : algorithms) {
    auto p = fall(algorithm, 100, 0.9).pressure;
    p.label = name(algorithm);
    pressure.curves.push_back(std::move(p));
    Curve program{fmt::format("{}, 0.05 of the stable step", name(algorithm))};
    theory.x.clear(), theory.y.clear();
    for (const int n : {25, 50, 100, 200, 400}) {
      program.add(1.0 / n, fall(algorithm, n, 0.05).lost);
      theory.add(1.0 / n, 0.5 / n);
    }
    lost.curves.push_back(std::move(program));
  }
  lost.curves.insert(lost.curves.begin(), theory);
  Chart many{.x_label = "time / time of flight", .y_label = "energy lost in landings / kinetic energy"};
  for (const auto algorithm : algorithms)
    for (const int n : {25, 50, 100}) {
      double imbalance = 0;
      int n_landings = 0;
      auto curve = pulled(algorithm, n, imbalance, n_landings);
      curve.label = fmt::format("{}, h = H/{}, {} landings", curve.label, n, n_landings);
      outcome.check(fmt::format("{} elements, {}: imbalance over {} landings of a pulled body "
                                "over its kinetic energy",
                                n, name(algorithm), n_landings),
                    imbalance, 0, 1e-10, "rounding");
      many.curves.push_back(std::move(curve));
    }
  outcome.charts = {std::move(pressure), std::move(lost), std::move(many)};
  return outcome;
}

}  // namespace slipfront::verification::impact
