// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "verify/extrapolation.hpp"
#include "verify/loaded_plane.hpp"
#include "verify/problems.hpp"

namespace slipfront::verify {

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
  const solid::Material material{.stiffness_damping_s = 0};
  const double c_S = solid::shear_speed_m_per_s(material);
  LoadedBody body({.material = material,
                   .width_m = width_over_a * a_m,
                   .height_m = 0.5 * width_over_a * a_m,
                   .h_m = a_m / a_over_h,
                   .pressure_Pa = p_Pa,
                   .law = {.mu_s = 100, .mu_k = 0, .d_c_m = 1e3},
                   // The nodes at +-a are the first that stick.
                   .intact = [](double x) { return std::abs(x) < a_m * (1 - 1e-6) ? 0.0 : 1.0; }});
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

}  // namespace

Outcome slip_patch(Effort effort) {
  const bool full = effort == Effort::full;
  const solid::Material material;
  const double middle_m = drop_Pa / sliding_stiffness_Pa(material) * a_m;
  Outcome outcome;
  Chart profile{.x_label = "x / a", .y_label = "slip Y0 / (a stress drop)"};
  Curve ellipse{"theory", Curve::Kind::theory, {}, {}};
  for (int j = -100; j <= 100; ++j) {
    ellipse.x.push_back(0.012 * j);
    ellipse.y.push_back(std::sqrt(std::max(0.0, 1 - std::pow(0.012 * j, 2))));
  }
  profile.curves.push_back(std::move(ellipse));
  const auto middle = [&](const Patch& patch) { return patch.middle_m / middle_m; };

  // The edges' part: domains that grow, one mesh.
  constexpr int coarse = 10;
  std::vector<double> widths = {8, 16, 32}, at_width;
  Curve edges{fmt::format("middle, h = a/{}", coarse), Curve::Kind::program, {}, {}};
  for (const double width : widths) {
    at_width.push_back(middle(slip(coarse, width)));
    edges.x.push_back(1 / (width * width));
    edges.y.push_back(at_width.back());
  }
  const auto edgeless = limit(at_width[0], at_width[1], at_width[2], 2, 4);
  Curve edge_law{"a line through the two widest", Curve::Kind::theory, {}, {}};
  for (const double inverse_square : {0.0, edges.x.front()}) {
    const double slope = (at_width[1] - at_width[2]) / (edges.x[1] - edges.x[2]);
    edge_law.x.push_back(inverse_square);
    edge_law.y.push_back(at_width[2] + slope * (inverse_square - edges.x[2]));
  }
  const double edge_part = at_width[1] - edgeless.value;
  outcome.checks.push_back({"edges' part of the slip: (8 a less 16 a) over (16 a less 32 a)", "",
                            (at_width[0] - at_width[1]) / (at_width[1] - at_width[2]), 4, 1,
                            "the next order, (a/width)^4, and what the dashpots leave of waves"});

  // The mesh's part: one domain, its edges' part taken off.
  Curve against_h{"middle", Curve::Kind::program, {}, {}},
      rms{"rms over the patch", Curve::Kind::program, {}, {}};
  std::vector<double> at_h;
  double rest = 0;
  const std::vector<int> meshes = full ? std::vector{10, 20, 40} : std::vector{5, 10, 20};
  for (const int n : meshes) {
    const auto patch = slip(n, 16);
    rest = std::max(rest, patch.rest);
    const double scale = (1 - edge_part / middle(patch)) / middle_m;
    Curve points{fmt::format("h = a/{}", n), Curve::Kind::program, {}, {}};
    double square = 0;
    int inside = 0;
    for (std::size_t i = 0; i < patch.x_m.size(); ++i) {
      const double x = patch.x_m[i] / a_m, u = patch.slip_m[i] * scale;
      points.x.push_back(x);
      points.y.push_back(u);
      if (std::abs(x) > 1) continue;
      square += std::pow(u - std::sqrt(std::max(0.0, 1 - x * x)), 2);
      ++inside;
    }
    if (n <= 20) profile.curves.push_back(std::move(points));
    at_h.push_back(patch.middle_m * scale);
    against_h.x.push_back(1.0 / n);
    against_h.y.push_back(std::abs(at_h.back() - 1));
    rms.x.push_back(1.0 / n);
    rms.y.push_back(std::sqrt(square / inside));
    outcome.checks.push_back(
        {fmt::format("slip in the middle over theory, h = a/{}, edges' part taken off", n), "", at_h.back(),
         1, 1.0 / n, "the patch ends between the last node that slips and the next: h/a"});
  }
  const auto converged = limit(at_h[0], at_h[1], at_h[2], 1, 2);
  outcome.checks.push_back(
      {"slip in the middle over theory, h -> 0, edges' part taken off", "", converged.value, 1,
       converged.uncertainty + edgeless.uncertainty + std::abs(edge_part) / coarse,
       fmt::format("changes when the finest mesh and the widest body join the extrapolations, and h/a of the "
                   "edges' part ({:.2g}), which is known on one mesh",
                   edge_part)});
  outcome.checks.push_back({"order in h of the error in the middle", "",
                            std::log2(against_h.y[1] / against_h.y[2]), 1, 0.3,
                            "terms of higher order on meshes this coarse"});
  outcome.checks.push_back({"fastest slip at the end over c_S slip/a", "", rest, 0, 1e-3,
                            "how far the slow rise is from rest: far below the errors above"});
  Chart error{.x_label = "h / a", .y_label = "relative error", .log_x = true, .log_y = true};
  error.curves = {std::move(against_h), std::move(rms)};
  Chart width{.x_label = "(a / width)^2", .y_label = "slip in the middle over theory"};
  width.curves = {std::move(edge_law), std::move(edges)};
  outcome.charts = {std::move(profile), std::move(error), std::move(width)};
  return outcome;
}

}  // namespace slipfront::verify
