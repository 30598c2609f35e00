// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "interface/friction/slip_weakening.hpp"
#include "verification/loaded_plane.hpp"
#include "verification/orders.hpp"
#include "verification/problems.hpp"

namespace slipfront::verification::slip_patch {

namespace {

constexpr double a_m = 0.02;
constexpr double p_Pa = 50e6;  // far above its changes by slip, so that the body stays on the plane
constexpr double drop_Pa = 1e6;

struct Patch {
  std::vector<double> x_m, slip_m;
  double middle_m = 0;
  double rest = 0;  ///< fastest slip at the end, times the patch's length over c_S, over the slip
};

/// The patch has no strength, the interface around it more than enough. The traction rises as slowly as
/// 40 a/c_S and waits as long again.
Patch slip(double a_over_h, double width_over_a) {
  const double c_S = solid::shear_speed_m_per_s(undamped);
  LoadedBody body({.width_m = width_over_a * a_m,
                   .height_m = 0.5 * width_over_a * a_m,
                   .h_m = a_m / a_over_h,
                   .pressure_Pa = p_Pa,
                   .law = interface::SlipWeakening{.mu_s = 100, .mu_k = 0, .d_c_m = 1e3},
                   // The nodes at +-a are the first that stick.
                   .strength_fraction = [](double x) { return std::abs(x) < a_m * (1 - 1e-6) ? 0.0 : 1.0; }});
  const double rise_s = 40 * a_m / c_S;
  while (body.time_s() < 2 * rise_s) {
    const double s = std::min(1.0, body.time_s() / rise_s);
    const double t = drop_Pa * s * s * s * (10 - 15 * s + 6 * s * s);
    body.load([=](double) { return t; });
    body.advance();
  }
  Patch patch;
  double fastest = 0;
  for (std::size_t i = 0; i < body.x_m().size(); ++i) {
    if (std::abs(body.x_m()[i]) > 1.2 * a_m) continue;
    patch.x_m.push_back(body.x_m()[i]);
    patch.slip_m.push_back(body.slip_m(i));
    patch.middle_m = std::max(patch.middle_m, body.slip_m(i));
    fastest = std::max(fastest, std::abs(body.interface_state().slip_rate_m_per_s[i]));
  }
  patch.rest = fastest * a_m / c_S / patch.middle_m;
  return patch;
}

double middle_in_theory_m() {
  return drop_Pa / sliding_stiffness_Pa() * a_m;
}

double ellipse(double x_over_a) {
  return std::sqrt(std::max(0.0, 1 - std::pow(x_over_a, 2)));
}

Chart profile_in_theory() {
  Chart profile{.x_label = "x / a", .y_label = "slip Y0 / (a stress drop)"};
  Curve theory{"theory", Curve::Kind::theory};
  for (int j = -100; j <= 100; ++j) {
    theory.add(0.012 * j, ellipse(0.012 * j));
  }
  profile.curves.push_back(std::move(theory));
  return profile;
}

/// What the edges of a domain of 16 a add to the slip in the middle over theory: from domains that grow, on
/// one mesh.
struct EdgesPart {
  static constexpr int a_over_h = 10;
  double part = 0, uncertainty = 0;
  Chart chart{.x_label = "(a / width)^2", .y_label = "slip in the middle over theory"};

  explicit EdgesPart(Outcome& outcome) {
    std::vector<double> at;
    Curve edges{fmt::format("middle, h = a/{}", a_over_h)};
    for (const double width : {8.0, 16.0, 32.0}) {
      at.push_back(slip(a_over_h, width).middle_m / middle_in_theory_m());
      edges.add(1 / (width * width), at.back());
    }
    const auto edgeless = limit(at[0], at[1], at[2], 2, 4);
    part = at[1] - edgeless.value;
    uncertainty = edgeless.uncertainty;
    Curve line{"a line through the two widest", Curve::Kind::theory};
    for (const double inverse_square : {0.0, edges.x.front()}) {
      const double slope = (at[1] - at[2]) / (edges.x[1] - edges.x[2]);
      line.add(inverse_square, at[2] + slope * (inverse_square - edges.x[2]));
    }
    chart.curves = {std::move(line), std::move(edges)};
    outcome.check("edges' part of the slip: (8 a less 16 a) over (16 a less 32 a)",
                  (at[0] - at[1]) / (at[1] - at[2]), 4, 1,
                  "the next order, (a/width)^4, and what the dashpots leave of waves");
  }
};

/// The mesh's part: one domain, its edges' part taken off.
struct MeshesPart {
  Curve against_h{"middle"}, rms{"rms over the patch"};
  std::vector<double> middle;  ///< over theory
  double rest = 0;             ///< the largest, of Patch

  void add(int a_over_h, double edges_part, Chart& profile) {
    const auto patch = slip(a_over_h, 16);
    rest = std::max(rest, patch.rest);
    const double scale = (1 - edges_part / (patch.middle_m / middle_in_theory_m())) / middle_in_theory_m();
    Curve points{fmt::format("h = a/{}", a_over_h)};
    double square = 0;
    int inside = 0;
    for (std::size_t i = 0; i < patch.x_m.size(); ++i) {
      const double x = patch.x_m[i] / a_m, u = patch.slip_m[i] * scale;
      points.add(x, u);
      if (std::abs(x) > 1) continue;
      square += std::pow(u - ellipse(x), 2);
      ++inside;
    }
    if (a_over_h <= 20) profile.curves.push_back(std::move(points));
    middle.push_back(patch.middle_m * scale);
    against_h.add(1.0 / a_over_h, std::abs(middle.back() - 1));
    rms.add(1.0 / a_over_h, std::sqrt(square / inside));
  }
};

void check_limit(const MeshesPart& meshes, const EdgesPart& edges, Outcome& outcome) {
  const auto converged = limit(meshes.middle[0], meshes.middle[1], meshes.middle[2], 1, 2);
  outcome.check(
      "slip in the middle over theory, h -> 0, edges' part taken off", converged.value, 1,
      converged.uncertainty + edges.uncertainty + std::abs(edges.part) / EdgesPart::a_over_h,
      fmt::format("changes when the finest mesh and the widest body join the extrapolations, and h/a of the "
                  "edges' part ({:.2g}), which is known on one mesh",
                  edges.part));
  outcome.check("order in h of the error in the middle",
                std::log2(meshes.against_h.y[1] / meshes.against_h.y[2]), 1, 0.3,
                "terms of higher order on meshes this coarse");
  outcome.check("fastest slip at the end over c_S slip/a", meshes.rest, 0, 1e-3,
                "how far the slow rise is from rest: far below the errors above");
}

}  // namespace

Outcome verify(Effort effort) {
  Outcome outcome;
  Chart profile = profile_in_theory();
  EdgesPart edges(outcome);
  MeshesPart meshes;
  for (const int n : effort == Effort::full ? std::vector{10, 20, 40} : std::vector{5, 10, 20}) {
    meshes.add(n, edges.part, profile);
    outcome.check(fmt::format("slip in the middle over theory, h = a/{}, edges' part taken off", n),
                  meshes.middle.back(), 1, 1.0 / n,
                  "the patch ends between the last node that slips and the next: h/a");
  }
  check_limit(meshes, edges, outcome);
  Chart error{.x_label = "h / a", .y_label = "relative error", .log_x = true, .log_y = true};
  error.curves = {std::move(meshes.against_h), std::move(meshes.rms)};
  outcome.charts = {std::move(profile), std::move(error), std::move(edges.chart)};
  return outcome;
}

}  // namespace slipfront::verification::slip_patch
