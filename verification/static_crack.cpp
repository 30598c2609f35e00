// SPDX-License-Identifier: BSD-3-Clause
#include "fracture/static_crack.hpp"

#include <fmt/core.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "mesh/node_columns.hpp"
#include "statics/condensed_interface.hpp"
#include "statics/elastic_body.hpp"
#include "verification/body.hpp"
#include "verification/problems.hpp"

namespace slipfront::verification::static_crack {

namespace {

using std::numbers::pi;

constexpr double h_m = 1e-3, drop_Pa = 1e5;

/// Two alike bodies, or one on the rigid plane, far edges held.
fracture::SlipResponse response(int columns, int rows, mesh::Sides sides, bool rigid) {
  const auto mesh = mesh::make_plate({.width_m = columns * h_m,
                                      .height_m = rows * h_m,
                                      .element_size_m = h_m,
                                      .corner = mesh::Corner::none,
                                      .sides = sides});
  const auto body = std::make_shared<const statics::Factorisation>(statics::ElasticBody{mesh, undamped},
                                                                   statics::TopConstraint::both);
  const statics::CondensedInterface interface(body, rigid ? nullptr : body);
  std::vector<double> x_m;
  for (const auto n : mesh.interface_nodes) x_m.push_back(mesh.x_m[n]);
  return fracture::response_of_sample(interface.stiffness(), x_m, mesh::tributary_lengths_m(mesh));
}

fracture::CrackLoads loads(const fracture::SlipResponse& response,
                           const std::function<double(double x_m)>& drop) {
  fracture::CrackLoads loads;
  for (const double x : response.x_m) loads.t_Pa.push_back(drop(x));
  const std::vector<double> none(response.x_m.size());
  loads.p_Pa = loads.residual_coefficient = loads.cohesion_Pa = none;
  return loads;
}

const double E = solid::uniaxial_modulus_Pa(undamped);

/// A crack in the middle of each period of an endless row, far edges held at 1.5 times the period.
void row_of_cracks(int columns, Outcome& outcome, Chart& chart) {
  const int rows = 3 * columns / 2;
  const auto sample = response(columns, rows, mesh::Sides::periodic, false);
  const auto uniform = loads(sample, [](double) { return drop_Pa; });
  fracture::StaticCrack crack(sample, uniform);
  const double w = columns * h_m;
  // K^2 = drop^2 w tan(pi a/w); far away the bodies approach by (4 drop w/(pi E)) ln sec(pi a/w), which held
  // edges take off the drop.
  const auto expected = [&](double a) {
    const double compliance = 4 * w / (pi * E) * std::log(1 / std::cos(pi * a / w));
    const double left = drop_Pa / (1 + solid::shear_modulus_Pa(undamped) / (2 * rows * h_m) * compliance);
    return left * left * w * std::tan(pi * a / w) / E;
  };
  Curve theory{"row of cracks", Curve::Kind::theory}, found{fmt::format("row, w/h = {}", columns)};
  crack.begin(static_cast<std::size_t>(columns / 2));
  for (int k = 1; k < columns / 2 - 1; ++k) {
    const double a = k * h_m, G = crack.energy_release_rate_J_per_m2(1);
    const double unit = drop_Pa * drop_Pa * w / E;
    if (k > 3 && a < 0.4 * w) {
      theory.add(a / w, expected(a) / unit);
      if (k % (columns / 20) == 0) found.add(a / w, G / unit);
    }
    if (k == columns / 20 || k == columns / 8 || k == columns / 4)
      outcome.check(fmt::format("G of a row over theory, a = {} h = {:.3g} w", k, a / w), G / expected(a), 1,
                    0.5 / k,
                    "half an element over a: the tip lies between the last node of the crack and the next");
    crack.release(1);
    crack.release(-1);
  }
  chart.curves.push_back(std::move(theory));
  chart.curves.push_back(std::move(found));
}

/// From a free side, far shorter than the sample. Under drop(x), l the length: K = (2/sqrt(pi l)) int_0^l
/// drop(s) F(s/l)/sqrt(1 - (s/l)^2) ds, F(u) = 1 + 0.297 (1 - u^(5/4)) (Tada, Paris, Irwin 2000).
void edge_crack(int columns, const std::string& name, const std::function<double(double)>& drop,
                Outcome& outcome, Chart& chart) {
  const auto sample = response(columns, columns / 2, mesh::Sides::free, false);
  const auto of_drop = loads(sample, drop);
  fracture::StaticCrack crack(sample, of_drop);
  const auto expected = [&](double l) {
    double sum = 0;
    constexpr int n = 2000;  // s = l sin(angle)
    for (int i = 0; i < n; ++i) {
      const double u = std::sin(0.5 * pi * (i + 0.5) / n);
      sum += drop(u * l) * (1 + 0.297 * (1 - std::pow(u, 1.25))) * 0.5 * pi / n;
    }
    const double K = 2 * std::sqrt(l / pi) * sum;
    return K * K / E;
  };
  Curve theory{name, Curve::Kind::theory}, found{fmt::format("{}, W/h = {}", name, columns)};
  crack.begin(0);
  for (int k = 1; k < columns / 8; ++k) {
    // The node at the side has half of the length of the others.
    const double l = k * h_m, G = crack.energy_release_rate_J_per_m2(1);
    const double unit = drop_Pa * drop_Pa * columns * h_m / E;
    if (k > 2) {
      theory.add(l / (columns * h_m), expected(l) / unit);
      if (k % (columns / 80) == 0) found.add(l / (columns * h_m), G / unit);
    }
    if (k == columns / 40)
      outcome.check(fmt::format("G of an edge crack over theory, {}, l = {} h = W/40", name, k),
                    G / expected(l), 1, 0.01 + 0.5 / k,
                    "half an element over l, and 1 % of the formula and of the sample's size");
    crack.release(1);
  }
  chart.curves.push_back(std::move(theory));
  chart.curves.push_back(std::move(found));
}

/// Tractions by a wave of slip on the rigid plane: -Y k and N k, with their signs.
void pressure_by_slip(int columns, Outcome& outcome) {
  const auto sample = response(columns, columns, mesh::Sides::periodic, true);
  const fracture::Bodies bodies(undamped);
  const double k = 2 * pi * 2 / (columns * h_m);  // two waves, far shorter than the height
  Eigen::VectorXd slip(columns), along(columns);
  for (int i = 0; i < columns; ++i) {
    slip[i] = std::cos(k * sample.x_m[static_cast<std::size_t>(i)]);
    along[i] = -std::sin(k * sample.x_m[static_cast<std::size_t>(i)]);
  }
  const Eigen::VectorXd t = sample.t_per_slip * slip, p = sample.p_per_slip * slip;
  const double n = 0.5 * columns;
  const double mesh_part = std::pow(k * h_m, 2);
  outcome.check("t by slip on the rigid plane over -Y k slip",
                t.dot(slip) / n / (-fracture::stiffness_Pa(bodies, 0) * k), 1, mesh_part, "(k h)^2");
  outcome.check("p by slip over N d slip/dx",
                p.dot(along) / n / (fracture::moving_stiffness_Pa(bodies, 0, 1).imag() * k), 1, mesh_part,
                "(k h)^2");
}

}  // namespace

Outcome verify(Effort effort) {
  Outcome outcome;
  const bool full = effort == Effort::full;
  Chart row{.x_label = "half-length / period w", .y_label = "G E / (drop^2 w)"};
  row_of_cracks(full ? 160 : 80, outcome, row);
  Chart edge{.x_label = "length / width W", .y_label = "G E / (drop^2 W)"};
  const int columns = full ? 400 : 160;
  edge_crack(
      columns, "uniform drop", [](double) { return drop_Pa; }, outcome, edge);
  const double end = 0.1 * columns * h_m;
  edge_crack(
      columns, "falling drop", [=](double x) { return drop_Pa * (1 - x / end); }, outcome, edge);
  pressure_by_slip(full ? 160 : 80, outcome);
  outcome.charts = {std::move(row), std::move(edge)};
  return outcome;
}

}  // namespace slipfront::verification::static_crack
