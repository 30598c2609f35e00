// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "interface/friction/slip_weakening.hpp"
#include "motion/observers/onsets.hpp"
#include "motion/trigger_zone.hpp"
#include "solid/element.hpp"
#include "verification/body.hpp"
#include "verification/problems.hpp"

namespace slipfront::verification::symmetry {

namespace {

/// Largest entry of R^T K' R - K over that of K: K' of the cell turned by `angle` about the origin.
double turned_cell(const solid::CellCoordinates& cell, double angle, const solid::Material& material) {
  const double c = std::cos(angle), s = std::sin(angle);
  solid::CellCoordinates turned;
  for (int a = 0; a < 4; ++a) {
    turned[2 * a] = c * cell[2 * a] - s * cell[2 * a + 1];
    turned[2 * a + 1] = s * cell[2 * a] + c * cell[2 * a + 1];
  }
  const auto K = solid::cell_stiffness(cell, material), T = solid::cell_stiffness(turned, material);
  const double R[2][2] = {{c, -s}, {s, c}};
  double worst = 0, largest = 0;
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b)
      for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) {
          double back = 0;
          for (int k = 0; k < 2; ++k)
            for (int l = 0; l < 2; ++l) back += R[k][i] * T[8 * (2 * a + k) + 2 * b + l] * R[l][j];
          const double entry = K[8 * (2 * a + i) + 2 * b + j];
          worst = std::max(worst, std::abs(back - entry));
          largest = std::max(largest, std::abs(entry));
        }
  return worst / largest;
}

struct Run {
  statics::Equilibrium state;
  std::vector<record::Onset> onsets;  ///< by node, then time
  solid::Field u_m;
  double time_s = 0, substep_s = 0;
};

/// An event triggered at the end from which the shear drags the plate, or its mirror image.
Run run(const mesh::Mesh& mesh, const solid::Material& material, bool mirrored, double end_s) {
  const interface::ContactModel model {
    interface::LinearSlipWeakening<interface::SlipMemory::lasting> {
      .mu_s = 1.3, .mu_k = 0.9, .d_c_m = 4e-6
    }
  };
  statics::Loading loading;
  if (mirrored) std::swap(loading.tilt_left_m, loading.tilt_right_m);
  constexpr double mu_s = 1.3;
  const double sign = mirrored ? -1 : 1;
  // The shear is that of the original.
  const statics::Statics original(mesh, material, {}, mu_s), statics(mesh, material, loading, mu_s);
  Run run;
  run.state = statics.shear_by(sign * original.shear_to(0.95).shear_m);
  motion::Stepper stepper(mesh, material, model, {});
  motion::Loads loads;
  loads.trigger_force_N_per_m = motion::trigger_forces(
      run.state, mesh::tributary_lengths_m(mesh),
      mirrored ? interface::EventKind::right : interface::EventKind::left, loads.trigger, mu_s);
  stepper.start(run.state, sign * 1e-6 * solid::longitudinal_speed_m_per_s(material), loads);
  motion::Recorder recorder(run.state, mu_s, 0);
  while (stepper.time_s() < end_s) stepper.advance(recorder);
  run.onsets = recorder.record_until(end_s).onsets;
  const auto last = static_cast<std::int32_t>(mesh.interface_nodes.size()) - 1;
  for (auto& onset : run.onsets) onset.node = mirrored ? last - onset.node : onset.node;
  std::ranges::sort(run.onsets, {}, [](const auto& o) { return std::pair(o.node, o.time_s); });
  run.u_m = stepper.u_m();
  run.time_s = stepper.time_s();
  run.substep_s = stepper.substep_s();
  return run;
}

}  // namespace

Outcome verify(Effort effort) {
  Outcome outcome;
  const solid::Material material;
  const solid::CellCoordinates square = {0, 0, 1, 0, 1, 1, 0, 1},
                               skew = {0, 0, 1.1, 0.1, 1.3, 0.9, -0.2, 0.8};
  for (const auto& [cell, name] : {std::pair{square, "square"}, std::pair{skew, "skew"}}) {
    double worst = 0;
    for (int k = 1; k < 36; ++k)
      worst = std::max(worst, turned_cell(cell, k * std::numbers::pi / 18, material));
    outcome.check(fmt::format("stiffness of a {} cell, turned by 10 to 350 degrees: largest "
                              "deviation over the largest entry",
                              name),
                  worst, 0, 1e-14, "some tens of roundings");
  }

  const double h = effort == Effort::quick ? 2e-3 : 1e-3;
  const auto mesh = mesh::make_plate({.element_size_m = h});
  const auto a = run(mesh, material, false, 150e-6), b = run(mesh, material, true, 150e-6);
  const int stride = mesh.grid.stride();
  double statics = 0, motion = 0, u_largest = 0;
  for (mesh::Node n = 0; n < mesh.n_nodes(); ++n) {
    const auto image = n / stride * stride + stride - 1 - n % stride;
    u_largest = std::max({u_largest, std::abs(a.u_m.x[n]), std::abs(a.u_m.y[n])});
    statics = std::max({statics, std::abs(a.state.u_m.x[n] + b.state.u_m.x[image]),
                        std::abs(a.state.u_m.y[n] - b.state.u_m.y[image])});
    motion = std::max({motion, std::abs(a.u_m.x[n] + b.u_m.x[image]), std::abs(a.u_m.y[n] - b.u_m.y[image])});
  }
  outcome.check("statics: largest difference of u over the largest u", statics / u_largest, 0, 1e-11,
                "rounding times the condition of the stiffness, some 1e5");
  outcome.check("number of onsets", static_cast<double>(b.onsets.size()),
                static_cast<double>(a.onsets.size()), 0, "the same");
  outcome.check("end of the event: largest difference of u over the largest u", motion / u_largest, 0, 1e-11,
                "the same, carried on");
  double late = 0;
  Chart chart{.x_label = "x, of the mirrored plate from its right edge (mm)", .y_label = "first slip (us)"};
  Curve original{"plate", Curve::Kind::theory}, image{"mirrored plate"};
  for (std::size_t k = 0; k < std::min(a.onsets.size(), b.onsets.size()); ++k) {
    late = std::max(late, std::abs(a.onsets[k].time_s - b.onsets[k].time_s) +
                              (a.onsets[k].node == b.onsets[k].node ? 0 : 1));
    // The picture shows the first slip of every other node.
    if (a.onsets[k].node % 2 != 0 || (k > 0 && a.onsets[k].node == a.onsets[k - 1].node)) continue;
    original.add(1e3 * mesh.x_m[mesh.interface_nodes[a.onsets[k].node]], 1e6 * a.onsets[k].time_s);
    image.add(1e3 * mesh.x_m[mesh.interface_nodes[b.onsets[k].node]], 1e6 * b.onsets[k].time_s);
  }
  outcome.check("largest difference of onset times over the sub-step", late / a.substep_s, 0, 1e-6,
                "1e-11 of u is 1e-9 of t/p, which rises by some 1e-3 in a sub-step");
  chart.curves = {original, image};
  outcome.charts.push_back(std::move(chart));
  return outcome;
}

}  // namespace slipfront::verification::symmetry
