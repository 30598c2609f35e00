// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "fracture/passage.hpp"
#include "fracture/prediction.hpp"
#include "interface/friction/slip_weakening.hpp"
#include "statics/prestress.hpp"
#include "verification/body.hpp"
#include "verification/orders.hpp"
#include "verification/problems.hpp"
#include "verification/rupture.hpp"

namespace slipfront::verification::self_similar_crack {

namespace {

using std::numbers::pi;

constexpr double p_Pa = 5e6, t_Pa = 2.35e6, mu_s = 0.8, mu_k = 0.4;
constexpr double drop_Pa = t_Pa - mu_k * p_Pa, strength_drop_Pa = (mu_s - mu_k) * p_Pa;
constexpr double width_m = 0.4, middle_m = 0.2, height_m = 0.2, patch_m = 15e-3, read_at_m = 0.14;
constexpr solid::Material pmma{.youngs_modulus_Pa = 5.6e9,
                               .poissons_ratio = 0.33,
                               .density_kg_per_m3 = 1180,
                               .stiffness_damping_s = 0.02e-6};
const fracture::Bodies bodies(pmma, pmma);
const fracture::Bodies undamped_bodies = [] {
  auto undamped = pmma;
  undamped.stiffness_damping_s = 0;
  return fracture::Bodies(undamped, undamped);
}();

/// Slip C sqrt(v^2 t^2 - x^2) of a crack that has grown at +-v from a point: in the transforms of Laplace and
/// Fourier its traction at x = 0 is drop = C v^2 int_0^inf Y(i s) ds/(s^2 + v^2)^(3/2).
double slip_factor(double v) {
  double sum = 0;
  constexpr int n = 4000;  // s = v tan(angle)
  for (int i = 0; i < n; ++i) {
    const double angle = 0.5 * pi * (i + 0.5) / n;
    const auto c = stability::compliance(undamped_bodies, 1, {v * std::tan(angle), 0});
    const double Y = -solid::shear_modulus_Pa(pmma) * (c.yy / c.determinant).real();
    sum += Y * std::cos(angle) * 0.5 * pi / n;
  }
  return drop_Pa / sum;
}

/// Energy release rate over the half-length.
double G_per_length(double v) {
  const double C = slip_factor(v);
  return C * C * 2 / fracture::slip_squared_per_G_and_distance(bodies, v);
}

/// The speed at which a fracture energy that grows by `slope` J/m3 along the crack lets it grow.
double speed_in_theory(double slope) {
  double low = 0, high = solid::rayleigh_speed_m_per_s(pmma);
  for (int k = 0; k < 50; ++k) {
    const double v = 0.5 * (low + high);
    (G_per_length(v) > slope ? low : high) = v;
  }
  return low;
}

/// What is found where the tip is read_at_m from the middle.
struct Found {
  double v_m_per_s = 0, zone_m = 0;
  double work = 0, G_slip = 0;  ///< over the fracture energy there
};

/// @param slope  of the fracture energy, J/m3
Found run(double slope, double h_m, double v_m_per_s) {
  const mesh::Plate plate{.width_m = width_m,
                          .height_m = height_m,
                          .element_size_m = h_m,
                          .corner = mesh::Corner::none,
                          .sides = mesh::Sides::absorbing,
                          .top = mesh::Top::absorbing};
  const auto mesh = mesh::make_plate(plate);
  std::vector<double> x_m;
  std::vector<interface::FrictionLaw> laws;
  motion::Loads loads;
  for (const auto n : mesh.interface_nodes) {
    const double x = mesh.x_m[n], r = std::abs(x - middle_m);
    x_m.push_back(x);
    laws.emplace_back(interface::SlipWeakening{mu_s, mu_k, 2 * slope * std::max(r, 3e-3) / strength_drop_Pa});
    loads.strength_fraction.push_back(r < patch_m ? 0 : 1);
  }
  const std::vector t(x_m.size(), t_Pa), p(x_m.size(), p_Pa);
  loads.prestress_t_Pa = t, loads.prestress_p_Pa = p;
  const interface::ContactModel contact {
    .law = laws.front(), .law_per_node = interface::NodeLaws(laws, false)
  };
  motion::TimeStepping time;
  time.end_s = 1.25 * read_at_m / v_m_per_s;
  time.quiet_s = infinity;
  motion::Stepper stepper(motion::BodySource{mesh, pmma}, motion::BodySource{mesh, pmma}, contact, time);
  const auto state = statics::prestressed(mesh, {x_m, t, p}, &mesh);
  stepper.start(state, 0, loads);
  const auto [event, fronts, history] =
      run_rupture(stepper, state, time, pmma, mu_s, 0.5 * h_m / v_m_per_s, 1);
  std::vector<double> v, zone, work, G_slip;
  for (const auto& front : fronts) {
    if (front.direction < 0) continue;
    const auto passages = fracture::passages(front, {x_m, event.breakdown, event.tip_slip}, bodies);
    for (std::size_t k = 0; k < passages.size(); ++k) {
      const double r = front.points[k].x_m - middle_m;
      if (std::abs(r - read_at_m) > 5e-3) continue;
      v.push_back(front.points[k].v_tip_m_per_s);
      zone.push_back(passages[k].cohesive_zone_m);
      work.push_back(event.breakdown.work_J_per_m2[static_cast<std::size_t>(front.points[k].node)] /
                     (slope * r));
      if (std::isfinite(passages[k].G_slip_J_per_m2))
        G_slip.push_back(passages[k].G_slip_J_per_m2 / (slope * r));
    }
  }
  return {mean(v), mean(zone), mean(work), mean(G_slip)};
}

}  // namespace

Outcome verify(Effort effort) {
  const bool full = effort == Effort::full;
  Outcome outcome;
  Chart speeds{.x_label = "dGamma/da, J/m3", .y_label = "speed / c_R"};
  Chart energies{.x_label = "h / cohesive zone", .y_label = "found / Gamma"};
  const double c_R = solid::rayleigh_speed_m_per_s(pmma);
  Curve theory{"theory", Curve::Kind::theory}, program{"program"};
  for (double share = 0.3; share < 0.95; share += 0.05) theory.add(G_per_length(share * c_R), share);
  std::ranges::reverse(theory.x);
  std::ranges::reverse(theory.y);
  for (const double slope : full ? std::vector{35.0, 45.0} : std::vector{45.0}) {
    const double v = speed_in_theory(slope);
    Curve work{fmt::format("breakdown work, {:.2f} c_R", v / c_R)},
        slip{fmt::format("slip, {:.2f} c_R", v / c_R)};
    std::vector<Found> found;
    for (const double h_m : full ? std::vector{1e-3, 0.5e-3, 0.25e-3} : std::vector{1e-3, 0.5e-3}) {
      found.push_back(run(slope, h_m, v));
      work.add(h_m / found.back().zone_m, found.back().work);
      slip.add(h_m / found.back().zone_m, found.back().G_slip);
    }
    const auto& last = found.back();
    const auto& before = found[found.size() - 2];
    const double zone = last.zone_m / read_at_m;
    const auto at = fmt::format("dGamma/da = {:g} J/m3, {:.2g} elements in the zone", slope,
                                last.zone_m / (full ? 0.25e-3 : 0.5e-3));
    outcome.check("breakdown work over Gamma, " + at, last.work, 1, 1e-3, "steps of slip within the zone");
    outcome.check("G by slip over Gamma, " + at, last.G_slip, 1, zone + std::abs(last.G_slip - before.G_slip),
                  "cohesive zone over half-length, and the change with the mesh");
    const double in_theory = G_per_length(last.v_m_per_s) / slope;
    outcome.check("G of theory at the speed found over Gamma, " + at, in_theory, 1,
                  zone + std::abs(G_per_length(before.v_m_per_s) / slope - in_theory), "the same");
    program.add(slope, last.v_m_per_s / c_R);
    energies.curves.push_back(std::move(work));
    energies.curves.push_back(std::move(slip));
  }
  speeds.curves = {std::move(theory), std::move(program)};
  outcome.charts = {std::move(speeds), std::move(energies)};
  return outcome;
}

}  // namespace slipfront::verification::self_similar_crack
