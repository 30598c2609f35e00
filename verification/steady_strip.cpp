// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fracture/passage.hpp"
#include "interface/friction/slip_weakening.hpp"
#include "statics/prestress.hpp"
#include "verification/body.hpp"
#include "verification/problems.hpp"
#include "verification/rupture.hpp"

namespace slipfront::verification::steady_strip {

namespace {

using fracture::Direction;
using std::numbers::pi;

constexpr double p_Pa = 5e6, mu_k = 0.6, drop_Pa = 0.1e6;
constexpr double height_m = 0.1, fine_height_m = 0.15 * height_m;
/// Over which the front speeds up, smoothly: an abrupt start makes the strip ring.
constexpr double start_m = 5 * height_m;
/// The way on to the run's end, and from there to the strip's.
constexpr double beyond_m = 1.5 * height_m;
constexpr int elements_per_zone = 5;
constexpr double from_zones = 2, to_heights = 0.3;  ///< range of distances behind the tip, for fits

struct Strip {
  fracture::Bodies bodies;
  double h_m, v_m_per_s;
  double read_from_m, read_to_m;  ///< along the way
  bool feels_pressure = false;    ///< friction behind the front follows changes of the pressure
  Direction direction = Direction::with_slip;

  double width_m() const { return read_to_m + 2 * beyond_m; }
  const solid::Material& material() const { return bodies.above; }
  double mu_felt() const { return feels_pressure ? mu_k : 0; }
  double G_J_per_m2() const {
    const double of_one_body = 0.5 * height_m * drop_Pa * drop_Pa / solid::shear_modulus_Pa(material());
    return bodies.below ? 2 * of_one_body : of_one_body;
  }
  double slip_exponent() const { return fracture::slip_exponent(bodies, v_m_per_s, mu_felt(), direction); }
  /// Way of the front to a place.
  double way_m(double x_m) const { return direction == Direction::with_slip ? x_m : width_m() - x_m; }
  bool is_read(double way) const { return way >= read_from_m && way <= read_to_m; }
  /// When the front is there: its speed grows as (1 - cos)/2 of time.
  double arrival_s(double way) const {
    const double start_s = 2 * start_m / v_m_per_s;
    if (way > start_m) return start_s + (way - start_m) / v_m_per_s;
    double low = 0, high = 1;
    for (int k = 0; k < 50; ++k) {
      const double share = 0.5 * (low + high);
      (share - std::sin(pi * share) / pi < way / start_m ? low : high) = share;
    }
    return low * start_s;
  }
};

/// Damped enough that a tip leaves no waves of the mesh behind.
solid::Material pmma(double h_m) {
  solid::Material pmma;
  pmma.stiffness_damping_s = 0.1 * h_m / solid::shear_speed_m_per_s(pmma);
  return pmma;
}

/// Read along a period of the strip's ringing.
Strip two_bodies(double h_m, double share_of_c_R) {
  const auto material = pmma(h_m);
  return {.bodies = {material, material},
          .h_m = h_m,
          .v_m_per_s = share_of_c_R * solid::rayleigh_speed_m_per_s(material),
          .read_from_m = 7 * height_m,
          .read_to_m = 11 * height_m};
}

Strip on_plane(double h_m, double share_of_c_S, bool feels_pressure, Direction direction) {
  const auto material = pmma(h_m);
  return {.bodies = fracture::Bodies(material),
          .h_m = h_m,
          .v_m_per_s = share_of_c_S * solid::shear_speed_m_per_s(material),
          .read_from_m = 5.5 * height_m,
          .read_to_m = 6.6 * height_m,
          .feels_pressure = feels_pressure,
          .direction = direction};
}

/// y = amplitude r^exponent exp(b r), r over the height: the amplitude's logarithm, b, and the exponent
/// unless it is known.
Eigen::VectorXd fitted(const Curve& profile, std::optional<double> exponent = {}) {
  Eigen::MatrixX3d columns(std::ssize(profile.x), 3);
  Eigen::VectorXd values(std::ssize(profile.x));
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    const double r = profile.x[at], log_r = std::log(r);
    columns.row(k) << 1, r, log_r;
    values[k] = std::log(profile.y[at]) - exponent.value_or(0) * log_r;
  }
  return columns.leftCols(exponent ? 2 : 3).colPivHouseholderQr().solve(values);
}

struct Found {
  double zone = 0;                                     ///< cohesive zone over the height
  Curve work, G_slip;                                  ///< over G, along the way over the height
  double mean_work = 0, mean_G_slip = 0, damping = 0;  ///< over G
  double change = 0;  ///< of the breakdown work along the way that is read, over G
  /// Over those of a tip with G at the distance of the height, against the distance over the height: of all
  /// times in the range of the fits, of the last one also beyond it.
  Curve slip, slip_rate, last_slip_rate;
};

Found run(const Strip& strip) {
  const auto& material = strip.material();
  const double v = strip.v_m_per_s, G = strip.G_J_per_m2();
  const bool is_two = strip.bodies.below.has_value();
  const auto mesh = mesh::make_plate({.width_m = strip.width_m(),
                                      .height_m = height_m,
                                      .element_size_m = strip.h_m,
                                      .coarsenings = 2,
                                      .fine_height_m = fine_height_m,
                                      .corner = mesh::Corner::none,
                                      .sides = mesh::Sides::absorbing});
  // A linear cohesive zone of this length takes up K; the strength falls along twice its length.
  const double zone_m = elements_per_zone * strip.h_m;
  const double K = fracture::stress_intensity_Pa_sqrt_m(strip.bodies, v, G);
  const double peak_Pa = 0.75 * std::sqrt(0.5 * pi) * K / std::sqrt(zone_m);
  const double mu_s = mu_k + 2 * peak_Pa / p_Pa, t_Pa = mu_k * p_Pa + drop_Pa;
  std::vector<double> x_m;
  motion::Loads loads;
  for (const auto n : mesh.interface_nodes) {
    x_m.push_back(mesh.x_m[n]);
    loads.weakens_at_s.push_back(strip.arrival_s(strip.way_m(mesh.x_m[n])));
  }
  loads.weakening_time_s = 2 * zone_m / v;
  loads.strength_fraction.assign(x_m.size(), 0);
  const std::vector t(x_m.size(), t_Pa), p(x_m.size(), p_Pa);
  loads.prestress_t_Pa = t, loads.prestress_p_Pa = p;
  constexpr double never_m = 1;  // slip over which friction weakens by itself
  interface::ContactModel contact {
    .law = interface::SlipWeakening { mu_s, mu_k, never_m }
  };
  if (!strip.feels_pressure) contact.regularisation.relaxed = interface::Relaxed::initial_pressure;
  motion::TimeStepping time;
  time.interface_substeps = strip.feels_pressure ? 6 : 1;  // 0.1 h/c_S, else waves of the mesh grow
  time.end_s = strip.arrival_s(strip.read_to_m + beyond_m);
  time.quiet_s = infinity;
  const motion::BodySource body{mesh, material};
  auto stepper =
      is_two ? motion::Stepper(body, body, contact, time) : motion::Stepper(mesh, material, contact, time);
  const auto state = statics::prestressed(mesh, {x_m, t, p}, is_two ? &mesh : nullptr);
  stepper.start(state, 0, loads);
  const auto [event, fronts, history] =
      run_rupture(stepper, state, time, material, mu_s, 0.05 * height_m / v, 0.25 * height_m / v);

  Found found;
  std::vector<double> zone, work, G_slip, offset_m;
  for (const auto& front : fronts) {
    if (front.direction != static_cast<int>(strip.direction)) continue;
    const auto passages = fracture::passages(front, {x_m, event.breakdown, event.tip_slip}, strip.bodies);
    for (std::size_t k = 0; k < passages.size(); ++k) {
      const auto& point = front.points[k];
      const auto node = static_cast<std::size_t>(point.node);
      const double way = strip.way_m(point.x_m), by_slip = passages[k].G_slip_J_per_m2 / G;
      if (event.breakdown.complete[node] == 0) continue;
      const double work_here = event.breakdown.work_J_per_m2[node] / G;
      found.work.add(way / height_m, work_here);
      if (std::isfinite(by_slip)) found.G_slip.add(way / height_m, by_slip);
      if (!strip.is_read(way)) continue;
      zone.push_back(passages[k].cohesive_zone_m);
      work.push_back(work_here);
      offset_m.push_back(way - v * point.onset_s);
      if (std::isfinite(by_slip)) G_slip.push_back(by_slip);
    }
  }
  found.zone = mean(zone) / height_m;
  found.mean_work = mean(work);
  found.mean_G_slip = mean(G_slip);
  const auto [least, most] = std::ranges::minmax(work);
  found.change = most - least;

  const double tip_offset_m = mean(offset_m);
  std::vector<record::Energies> energies;
  for (const auto& row : event.energies)
    if (strip.is_read(tip_offset_m + v * row.time_s)) energies.push_back(row);
  const auto &first = energies.front(), &last = energies.back();
  found.damping = (first.damping_work - last.damping_work) / (v * (last.time_s - first.time_s)) / G;

  // A linear cohesive zone has, far from it, the field of a tip that is this far behind its head.
  const double shift = found.zone / (3 - strip.slip_exponent());
  const double unit_m = std::sqrt(fracture::slip_squared_per_G_and_distance(strip.bodies, v) * G * height_m);
  for (std::size_t row = 0; row < history.time_s.size(); ++row) {
    const double tip_m = tip_offset_m + v * history.time_s[row];
    if (!strip.is_read(tip_m)) continue;
    found.last_slip_rate = {};
    for (std::size_t i = 0; i < x_m.size(); ++i) {
      const double r = (tip_m - strip.way_m(x_m[i])) / height_m - shift;
      const double slip = history.slip_m[row * x_m.size() + i] / unit_m;
      const double slip_rate =
          history.slip_rate_m_per_s[row * x_m.size() + i] / (0.5 * v * unit_m / height_m);
      if (r > 0.5 * found.zone && r < 1) found.last_slip_rate.add(r, slip_rate);
      if (r < from_zones * found.zone || r > to_heights) continue;
      found.slip.add(r, slip);
      found.slip_rate.add(r, slip_rate);
    }
  }
  return found;
}

/// Points of a curve that are apart by a tenth of their abscissa or more.
Curve thinned(const Curve& all, const std::string& label) {
  Curve few{label};
  for (std::size_t k = 0; k < all.x.size(); ++k) {
    const auto at =
        std::ranges::find_if(few.x, [&](double x) { return std::abs(std::log(all.x[k] / x)) < 0.1; });
    if (at == few.x.end()) few.add(all.x[k], all.y[k]);
  }
  return few;
}

const char* const zone_reason = "cohesive zone over the height";
const char* const change_reason = "range of the breakdown work along the way: it rings and settles";
const char* const both_reasons = "cohesive zone over the height, and that range";

void of_two_bodies(double h_m, Outcome& outcome) {
  Chart energies{.x_label = "way / H", .y_label = "found / G"};
  Chart rates{.x_label = "distance behind the tip / H",
              .y_label = "slip rate / that of theory at H",
              .log_x = true,
              .log_y = true};
  energies.curves.push_back({"G", Curve::Kind::theory, {0, 12}, {1, 1}});
  Curve theory{"r^(-1/2)", Curve::Kind::theory};
  for (const double r : {0.02, 1.0}) theory.add(r, 1 / std::sqrt(r));
  rates.curves.push_back(std::move(theory));
  for (const double share : {0.5, 0.8}) {
    auto found = run(two_bodies(h_m, share));
    const auto at = fmt::format(", {} c_R", share);
    outcome.check("breakdown work and damping over G" + at, found.mean_work + found.damping, 1, found.change,
                  change_reason);
    outcome.check("G by slip over G" + at, found.mean_G_slip, 1, found.zone + found.change, both_reasons);
    outcome.check("amplitude of the slip rate over theory" + at, std::exp(fitted(found.slip_rate, -0.5)[0]),
                  1, found.zone + found.change, both_reasons);
    outcome.check("exponent of the slip rate" + at, fitted(found.slip_rate)[2], -0.5, found.zone,
                  zone_reason);
    found.work.label = "breakdown work" + at;
    found.G_slip.label = "slip" + at;
    energies.curves.push_back(std::move(found.work));
    energies.curves.push_back(std::move(found.G_slip));
    rates.curves.push_back(thinned(found.last_slip_rate, fmt::format("{} c_R", share)));
  }
  outcome.charts.push_back(std::move(energies));
  outcome.charts.push_back(std::move(rates));
}

void of_plane(double h_m, const std::vector<double>& shares, Outcome& outcome) {
  Chart exponents{.x_label = "speed / c_S", .y_label = "exponent of slip"};
  struct Case {
    const char* name;
    bool feels_pressure;
    Direction direction;
  };
  for (const auto& [name, feels_pressure, direction] :
       {Case{"against the slip", true, Direction::against_slip},
        Case{"initial pressure", false, Direction::with_slip},
        Case{"with the slip", true, Direction::with_slip}}) {
    Curve theory{"", Curve::Kind::theory}, program{name};
    for (double share = 0.01; share < 0.96; share += 0.01)
      theory.add(share, on_plane(h_m, share, feels_pressure, direction).slip_exponent());
    for (const double share : shares) {
      const auto strip = on_plane(h_m, share, feels_pressure, direction);
      const auto found = run(strip);
      const auto at = fmt::format(" on the plane, {}, {} c_S", name, share);
      program.add(share, fitted(found.slip)[2]);
      outcome.check("exponent of slip" + at, program.y.back(), strip.slip_exponent(), found.zone,
                    zone_reason);
      if (!feels_pressure)
        outcome.check("breakdown work and damping over G" + at, found.mean_work + found.damping, 1,
                      found.change, change_reason);
    }
    exponents.curves.push_back(std::move(theory));
    exponents.curves.push_back(std::move(program));
  }
  outcome.charts.push_back(std::move(exponents));
}

}  // namespace

Outcome verify(Effort effort) {
  const bool full = effort == Effort::full;
  const double h_m = full ? 0.625e-3 : 1e-3;
  Outcome outcome;
  of_two_bodies(h_m, outcome);
  of_plane(h_m, full ? std::vector{0.5, 0.8} : std::vector{0.5}, outcome);
  return outcome;
}

}  // namespace slipfront::verification::steady_strip
