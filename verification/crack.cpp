// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "fracture/prediction.hpp"
#include "interface/friction/slip_weakening.hpp"
#include "verification/loaded_plane.hpp"
#include "verification/orders.hpp"
#include "verification/problems.hpp"

namespace slipfront::verification::crack {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double p_Pa = 50e6;  // far above its changes by slip, so that the body stays on the plane
constexpr double strength_drop_Pa = 5e6;
constexpr double residual_Pa = 5e6;

const double c_S = solid::shear_speed_m_per_s(undamped), c_L = solid::longitudinal_speed_m_per_s(undamped);

/// Slip-weakening zone of a crack at rest, its traction taken as linear in x (Palmer and Rice 1973).
double zone_m(double fracture_energy_J_per_m2) {
  const double K2 = 4 * sliding_stiffness_Pa() * fracture_energy_J_per_m2;
  return 9 * pi / 32 * K2 / (strength_drop_Pa * strength_drop_Pa);
}

/// The law whose zone is as long as this.
interface::SlipWeakening law_of_zone(double length_m) {
  const double fracture_energy = length_m / zone_m(1);
  return {.mu_s = (residual_Pa + strength_drop_Pa) / p_Pa,
          .mu_k = residual_Pa / p_Pa,
          .d_c_m = 2 * fracture_energy / strength_drop_Pa};
}

double fracture_energy_J_per_m2(const interface::SlipWeakening& law) {
  return 0.5 * law.d_c_m * (law.mu_s - law.mu_k) * p_Pa;
}

/// v at which the energy release rate of a long crack under a load that is there from the beginning is this
/// share of that at rest; c_S where even c_S leaves more.
double speed_at(double share) {
  static const fracture::SpeedLaw law{fracture::Bodies(undamped)};
  return law.speed_m_per_s(share);
}

/// First place to the right of `from_m` at which the slip is below `slip_m`, between nodes.
double slip_contour_m(const LoadedBody& body, double slip_m, double from_m) {
  const auto& x = body.x_m();
  auto i = static_cast<std::size_t>(std::ranges::lower_bound(x, from_m) - x.begin());
  while (i + 1 < x.size() && body.slip_m(i) > slip_m) ++i;
  if (i == 0 || body.slip_m(i - 1) <= slip_m) return x[i];
  const double u = body.slip_m(i - 1), w = body.slip_m(i);
  return x[i - 1] + (x[i] - x[i - 1]) * (u - slip_m) / (u - w);
}

/// The path of a tip: times in t_c, places and speeds in c_S t_c and c_S.
struct Run {
  double zone = 0;  ///< of the crack at rest over c_S t_c
  Curve place = {};

  double speed_at(double t, double half) const {
    return (place.value_at(t + half) - place.value_at(t - half)) / (2 * half);
  }
};

constexpr double run_end = 2.7;  ///< in t_c

/// The left half loses its strength at t = 0 under the stress drop strength_drop/ratio, and the crack runs to
/// the right when it can.
Run run(double ratio, int elements_per_zone) {
  const double drop_Pa = strength_drop_Pa / ratio;
  constexpr double h_m = 1e-3;
  const auto law = law_of_zone(elements_per_zone * h_m);
  const double t_c =
      pi * solid::shear_modulus_Pa(undamped) * fracture_energy_J_per_m2(law) / (2 * drop_Pa * drop_Pa * c_S);
  const double unit_m = c_S * t_c;
  // Waves from the edges reach neither the tip nor what it sees: half the way there and back.
  const double half_width_m = std::ceil(c_L / c_S * run_end * unit_m / h_m) * h_m;
  LoadedBody body({.width_m = 2 * half_width_m,
                   .height_m = std::ceil(0.5 * c_L / c_S * run_end * unit_m / h_m) * h_m,
                   .h_m = h_m,
                   .pressure_Pa = p_Pa,
                   .law = law,
                   .strength_fraction = [&](double x) { return x < -0.25 * h_m ? 0.0 : 1.0; }});
  body.load([&](double) { return residual_Pa + drop_Pa; });
  Run run{.zone = elements_per_zone * h_m / unit_m};
  while (body.time_s() < run_end * t_c) {
    body.advance();
    run.place.add(body.time_s() / t_c, slip_contour_m(body, 0.5 * law.d_c_m, -0.25 * h_m) / unit_m);
  }
  return run;
}

/// Half-length over r of a crack at rest under a stress drop within |x| < r alone, above the drop at which
/// K = drop sqrt(pi r) is the crack's own; `load` is their ratio.
double half_length_at_rest(double load) {
  double low = 1, high = 100;
  for (int j = 0; j < 60; ++j) {
    const double a = 0.5 * (low + high);
    (load * 2 / pi * std::sqrt(a) * std::asin(1 / a) > 1 ? low : high) = a;
  }
  return low;
}

constexpr double final_load = 2;

struct Arrest {
  std::vector<double> load, half_length;  ///< half-lengths over r
  double half_length_at_end = 0, last_growth = 0;
};

/// The interface within |x| < r has lost its strength and is loaded slowly, as in `final_load`, then left
/// alone. Outside, t0 is the residual strength.
Arrest grow_and_stop(double r_over_zone, double width_over_r) {
  constexpr int elements_per_zone = 4;
  constexpr double h_m = 1e-3;
  const double r_m = r_over_zone * elements_per_zone * h_m;
  const auto law = law_of_zone(elements_per_zone * h_m);
  const double K = std::sqrt(4 * sliding_stiffness_Pa() * fracture_energy_J_per_m2(law));
  const double first_drop_Pa = K / std::sqrt(pi * r_m);
  LoadedBody body({.width_m = width_over_r * r_m,
                   .height_m = 0.5 * width_over_r * r_m,
                   .h_m = h_m,
                   .pressure_Pa = p_Pa,
                   .law = law,
                   .strength_fraction = [&](double x) { return std::abs(x) < r_m - 0.5 * h_m ? 0.0 : 1.0; }});
  const double rise_s = 120 * r_m / c_S, hold_s = 60 * r_m / c_S;
  Arrest arrest;
  const auto half_length = [&] { return slip_contour_m(body, 0.5 * law.d_c_m, r_m - 1.5 * h_m) / r_m; };
  double before_last = 0;
  while (body.time_s() < rise_s + hold_s) {
    const double s = std::min(1.0, body.time_s() / rise_s);
    const double load = final_load * s * s * (3 - 2 * s);
    body.load([&](double x) {
      // The node at r carries half of its length.
      const double inside = std::clamp((r_m - std::abs(x)) / h_m + 0.5, 0.0, 1.0);
      return residual_Pa + inside * load * first_drop_Pa;
    });
    body.advance();
    if (s < 1) {
      arrest.load.push_back(load);
      arrest.half_length.push_back(half_length());
    }
    if (body.time_s() < rise_s + 0.5 * hold_s) before_last = half_length();
  }
  arrest.half_length_at_end = half_length();
  arrest.last_growth = arrest.half_length_at_end - before_last;
  return arrest;
}

constexpr double path_step = 0.01;   ///< of the theory, in t_c
constexpr double half_window = 0.1;  ///< in t_c, for speeds

/// Speeds in the middles of the steps, places at their ends.
struct PathInTheory {
  Curve place{"theory", Curve::Kind::theory}, speed{"theory", Curve::Kind::theory};

  PathInTheory() {
    double x = 0;
    for (int j = 0; j < static_cast<int>(run_end / path_step); ++j) {
      const double v = speed_at(1 / ((j + 0.5) * path_step)) / c_S;
      speed.add((j + 0.5) * path_step, v);
      x += v * path_step;
      place.add((j + 1) * path_step, x);
    }
  }
  double place_at(double t) const {
    return place.y[static_cast<std::size_t>(std::lround(t / path_step)) - 1];
  }
};

/// Runs with three lengths of the zone, falling, on two meshes each.
struct Runs {
  std::vector<Run> coarse, fine;

  explicit Runs(bool full) {
    for (const double ratio : full ? std::vector{4.0, 4 * std::numbers::sqrt2, 8.0}
                                   : std::vector{2 * std::numbers::sqrt2, 4.0, 4 * std::numbers::sqrt2}) {
      coarse.push_back(run(ratio, 8));
      fine.push_back(run(ratio, 16));
    }
  }
};

/// Of a number get(run), extrapolated to no zone.
template <class Get>
Check check_of_short_zone(const Runs& runs, const std::string& quantity, const Get& get, double expected) {
  std::array<double, 3> at;
  double mesh_part = 0;
  for (std::size_t z = 0; z < 3; ++z) {
    mesh_part = (get(runs.fine[z]) - get(runs.coarse[z])) / 3;
    at[z] = get(runs.fine[z]) + mesh_part;
  }
  const auto small_zone = limit(at[0], at[1], at[2], 1, 2);
  return {quantity + ", zone -> 0",
          "",
          small_zone.value,
          expected,
          small_zone.uncertainty + std::abs(mesh_part),
          fmt::format("changes when the shortest zone joins the extrapolation, from "
                      "zones of {:.2f}, {:.2f} and {:.2f} c_S t_c, "
                      "and of the extrapolation from 8 and 16 elements in each",
                      runs.fine[0].zone, runs.fine[1].zone, runs.fine[2].zone)};
}

void check_path(const Runs& runs, const PathInTheory& theory, Outcome& outcome) {
  for (const double t : {1.5, 2.0, 2.5}) {
    outcome.checks.push_back(check_of_short_zone(
        runs, fmt::format("tip speed over c_S at {} t_c", t),
        [&](const Run& r) { return r.speed_at(t, half_window); }, speed_at(1 / t) / c_S));
    // The path before is left out: while the tip is slow the zone is not short.
    constexpr double from = 1.5;
    if (t > from)
      outcome.checks.push_back(check_of_short_zone(
          runs, fmt::format("way of the tip over c_S t_c from {} to {} t_c", from, t),
          [&](const Run& r) { return r.place.value_at(t) - r.place.value_at(from); },
          theory.place_at(t) - theory.place_at(from)));
  }
}

void draw_path(const Runs& runs, const PathInTheory& theory, Outcome& outcome) {
  Chart path{.x_label = "time / t_c", .y_label = "tip / (c_S t_c)", .curves = {theory.place}};
  Chart speed{.x_label = "time / t_c", .y_label = "tip speed / c_S", .curves = {theory.speed}};
  for (const auto& r : runs.fine) {
    Curve places{fmt::format("zone {:.2f} c_S t_c", r.zone)};
    Curve speeds = places;
    for (double t = 0.3; t < run_end - half_window; t += 0.1) {
      places.add(t, r.place.value_at(t));
      speeds.add(t, r.speed_at(t, half_window));
    }
    path.curves.push_back(std::move(places));
    speed.curves.push_back(std::move(speeds));
  }
  outcome.charts.push_back(std::move(path));
  outcome.charts.push_back(std::move(speed));
}

void growth_of_a_long_crack(bool full, Outcome& outcome) {
  const PathInTheory theory;
  const Runs runs(full);
  check_path(runs, theory, outcome);
  draw_path(runs, theory, outcome);
}

Curve half_lengths_at_rest() {
  Curve rest{"theory", Curve::Kind::theory};
  for (double load = 1; load <= final_load + 1e-9; load += 0.02) {
    rest.add(load, half_length_at_rest(load));
  }
  return rest;
}

Curve half_lengths(const Arrest& arrest, double size) {
  Curve points{fmt::format("zone r/{}", size)};
  const std::size_t every = arrest.load.size() / 40;
  for (std::size_t k = every; k < arrest.load.size(); k += every) {
    if (arrest.load[k] < 0.8) continue;
    points.add(arrest.load[k], arrest.half_length[k]);
  }
  return points;
}

void slow_growth_and_arrest(bool full, Outcome& outcome) {
  Chart slow{.x_label = "stress drop / that of first growth", .y_label = "half-length / r"};
  slow.curves.push_back(half_lengths_at_rest());
  constexpr double width = 32;  // over r
  const std::vector<double> sizes = full ? std::vector{2.0, 4.0, 6.0} : std::vector{2.0, 3.0};
  const double narrower = grow_and_stop(sizes[0], 0.5 * width).half_length_at_end;
  double last_growth = 0, edges = 0;
  for (const double size : sizes) {
    const auto arrest = grow_and_stop(size, width);
    // The edges' part goes with (r/width)^2.
    if (size == sizes[0]) edges = (arrest.half_length_at_end - narrower) / -3;
    outcome.check(
        fmt::format("half-length over r at rest, {} times the first load, zone r/{}", final_load, size),
        arrest.half_length_at_end, half_length_at_rest(final_load), 1 / size + std::abs(edges),
        fmt::format("the tip is somewhere in its zone; the edges' part, {:.2g}", edges));
    last_growth = arrest.last_growth;
    slow.curves.push_back(half_lengths(arrest, size));
  }
  outcome.check("growth over r in the second half of the hold", last_growth, 0, 0.25 / sizes.back(),
                "one element");
  outcome.charts.push_back(std::move(slow));
}

}  // namespace

Outcome verify(Effort effort) {
  const bool full = effort == Effort::full;
  Outcome outcome;
  growth_of_a_long_crack(full, outcome);
  slow_growth_and_arrest(full, outcome);
  return outcome;
}

}  // namespace slipfront::verification::crack
