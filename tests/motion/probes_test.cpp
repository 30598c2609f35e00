// SPDX-License-Identifier: BSD-3-Clause
#include "motion/probes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "motion/support.hpp"

namespace slipfront::motion {
namespace {

using mesh::Corner;
using record::ProbePlace;
using ::testing::HasSubstr;

const solid::Material above_material{.stiffness_damping_s = 0};
const solid::Material below_material{
    .youngs_modulus_Pa = 9e9, .density_kg_per_m3 = 2000, .stiffness_damping_s = 0};

mesh::Mesh small_plate(Corner corner, int coarsenings = 0, mesh::Sides sides = mesh::Sides::free) {
  auto plate = support::plate_of(0.048, 0.036, 1e-3, corner);
  plate.fillet_radius_m = 5e-3;
  plate.coarsenings = coarsenings;
  plate.fine_height_m = 0.01;
  plate.sides = sides;
  plate.top = mesh::Top::free;
  return mesh::make_plate(plate);
}

/// Places all over a plate, off its nodes; with a body below also in that.
std::vector<ProbePlace> scattered(bool below = false) {
  Random random(5);
  std::vector<ProbePlace> places;
  for (int k = 0; k < 40; ++k) {
    const double height_m = below && k % 2 == 0 ? -0.036 : 0.036;
    const double x_m = 0.024 + 0.017 * random();
    places.push_back({std::to_string(k), x_m, height_m * (0.5 + 0.49 * random())});
  }
  return places;
}

/// u = a + G x in the axes of the plate.
struct LinearField {
  double a_x = 1e-5, a_y = -2e-5, xx = 3e-4, xy = -5e-4, yx = 2e-4, yy = 7e-4;
  double x(double x_m, double y_m) const { return a_x + xx * x_m + xy * y_m; }
  double y(double x_m, double y_m) const { return a_y + yx * x_m + yy * y_m; }
};

/// The displacements of the probes' nodes, those of the second body upside down.
std::vector<double> displacements(const LinearField& field, const std::vector<Probe>& probes,
                                  const std::vector<BodySource>& bodies) {
  std::vector<double> values;
  for (const auto& probe : probes)
    for (const auto n : probe.node) {
      const auto& mesh = bodies[probe.body].mesh;
      const double up = probe.body > 0 ? -1 : 1, x_m = mesh.x_m[n], y_m = up * mesh.y_m[n];
      values.insert(values.end(), {field.x(x_m, y_m), up * field.y(x_m, y_m)});
    }
  return values;
}

void expect_linear(const std::vector<BodySource>& bodies, bool below) {
  const LinearField field;
  const auto places = scattered(below);
  const auto probes = locate_probes(places, bodies);
  const auto u_m = displacements(field, probes, bodies);
  ProbeRecorder recorder(probes, 1e-7, 1e-7, u_m, u_m);
  recorder.expect(0, 1);
  std::ranges::copy(u_m, recorder.room_for(1));
  record::ProbeRecord rows;
  recorder.take_rows(1, rows);
  ASSERT_EQ(rows.time_s, std::vector<double>{0});
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto& m = probes[k].material;
    const double nu = m.poissons_ratio, E = m.youngs_modulus_Pa, size = 1e-3;
    EXPECT_EQ(probes[k].body, places[k].y_m < 0 ? 1U : 0U);
    EXPECT_NEAR(rows.u_x_m[k], field.x(places[k].x_m, places[k].y_m), 1e-16) << k;
    EXPECT_NEAR(rows.u_y_m[k], field.y(places[k].x_m, places[k].y_m), 1e-16) << k;
    EXPECT_EQ(rows.v_x_m_per_s[k], 0);
    EXPECT_NEAR(rows.strain_xx[k], field.xx, 1e-12 * size) << k;
    EXPECT_NEAR(rows.strain_yy[k], field.yy, 1e-12 * size) << k;
    EXPECT_NEAR(rows.strain_xy[k], 0.5 * (field.xy + field.yx), 1e-12 * size) << k;
    // Plane stress, by Hooke's law in its three-dimensional form.
    const double s_xx = rows.stress_xx_Pa[k], s_yy = rows.stress_yy_Pa[k];
    EXPECT_NEAR((s_xx - nu * s_yy) / E, field.xx, 1e-11 * size);
    EXPECT_NEAR((s_yy - nu * s_xx) / E, field.yy, 1e-11 * size);
    EXPECT_NEAR(-nu * (s_xx + s_yy) / E, rows.strain_zz[k], 1e-11 * size);
    EXPECT_NEAR(rows.stress_xy_Pa[k] * (1 + nu) / E, rows.strain_xy[k], 1e-11 * size);
    EXPECT_EQ(rows.stress_zz_Pa[k], 0);
  }
}

TEST(Probes, AreExactInUniformStrain) {
  const auto relief = small_plate(Corner::relief), fillet = small_plate(Corner::fillet),
             graded = small_plate(Corner::none, 1), below = small_plate(Corner::none);
  for (const auto* mesh : {&relief, &fillet, &graded}) expect_linear({{*mesh, above_material}}, false);
  expect_linear({{graded, above_material}, {below, below_material}}, true);
}

TEST(Probes, HoldAStressThatDisplacementsLeaveOut) {
  const auto above = small_plate(Corner::none), below = small_plate(Corner::none);
  const std::vector<BodySource> bodies = {{above, above_material}, {below, below_material}};
  const auto places = scattered(true);
  const auto probes = locate_probes(places, bodies);
  const auto u_m = displacements({}, probes, bodies);
  const solid::UniformStress further{-4e6, 2e6, -1e10, 3e10};
  const auto rows_of = [&](const std::optional<solid::UniformStress>& stress) {
    ProbeRecorder recorder(probes, 1e-6, 1e-6, u_m, u_m, stress);
    recorder.expect(0, 11);
    for (int step = 1; step <= 11; ++step) std::ranges::copy(u_m, recorder.room_for(step));
    record::ProbeRecord rows;
    recorder.take_rows(11, rows);
    return rows;
  };
  const auto with = rows_of(further), without = rows_of({});
  for (std::size_t row = 0; row < with.time_s.size(); ++row)
    for (std::size_t k = 0; k < places.size(); ++k) {
      const std::size_t at = row * places.size() + k;
      const double nu = probes[k].material.poissons_ratio, E = probes[k].material.youngs_modulus_Pa;
      const double yy = -4e6 - 1e10 * with.time_s[row], xy = 2e6 + 3e10 * with.time_s[row], size = 1e-2;
      EXPECT_NEAR(with.stress_yy_Pa[at] - without.stress_yy_Pa[at], yy, 1e-6);
      EXPECT_NEAR(with.stress_xy_Pa[at] - without.stress_xy_Pa[at], xy, 1e-6);
      EXPECT_EQ(with.stress_xx_Pa[at], without.stress_xx_Pa[at]);
      EXPECT_NEAR(with.strain_xx[at] - without.strain_xx[at], -nu * yy / E, 1e-12 * size);
      EXPECT_NEAR(with.strain_yy[at] - without.strain_yy[at], yy / E, 1e-12 * size);
      EXPECT_NEAR(with.strain_zz[at] - without.strain_zz[at], -nu * yy / E, 1e-12 * size);
      EXPECT_NEAR(with.strain_xy[at] - without.strain_xy[at], (1 + nu) * xy / E, 1e-12 * size);
      EXPECT_EQ(with.u_y_m[at], without.u_y_m[at]);
    }
}

TEST(Probes, LieOnSidesAndCornersOfTheirBody) {
  const auto mesh = small_plate(Corner::none, 0, mesh::Sides::periodic);
  const std::vector<ProbePlace> places = {{"a", 0, 0}, {"b", 0.048, 0.036}, {"c", 0.0475, 0.001}};
  const std::vector<BodySource> bodies = {{mesh, above_material}};
  EXPECT_EQ(locate_probes(places, bodies).size(), 3U);
}

TEST(Probes, OutsideAreRefused) {
  const auto mesh = small_plate(Corner::fillet);
  const std::vector<BodySource> bodies = {{mesh, above_material}};
  for (const ProbePlace& place :
       {ProbePlace{"gauge", 1e-4, 1e-4}, ProbePlace{"gauge", 0.05, 0.01}, ProbePlace{"gauge", 0.01, -1e-4}})
    EXPECT_THAT([&] { locate_probes(std::vector{place}, bodies); },
                ::testing::ThrowsMessage<UserError>(::testing::AllOf(HasSubstr("the probe gauge at ("),
                                                                     HasSubstr("lies outside the plate"))));
}

/// Takes n steps, at most `at_once` in one call.
record::ProbeRecord take_steps(Stepper& stepper, support::RowRecorder& recorder, std::int64_t n,
                               std::int64_t at_once, double interval_s) {
  auto before_m = stepper.probed_u_m();
  const auto v = stepper.probed_v_m_per_s();
  for (std::size_t k = 0; k < v.size(); ++k) before_m[k] -= stepper.step_s() * v[k];
  ProbeRecorder probes(stepper.probes(), stepper.step_s(), interval_s, before_m, stepper.probed_u_m());
  record::ProbeRecord rows;
  recorder.probes = &probes;
  while (stepper.step() < n) {
    const auto most = std::min(at_once, n - stepper.step());
    probes.expect(stepper.step(), most);
    stepper.advance(recorder, most);
    if (const double* shown = at_once == 1 ? probes.room_for(stepper.step()) : nullptr) {
      EXPECT_TRUE(std::ranges::equal(stepper.probed_u_m(), std::span(shown, v.size()))) << stepper.step();
    }
    probes.take_rows(stepper.step(), rows);
  }
  return rows;
}

/// A Gaussian pulse of longitudinal motion that moves down a wide plate in the air and is reflected from its
/// lower edge.
class PassingPulse {
 public:
  explicit PassingPulse(double h, int substeps, Precision precision = Precision::double_precision,
                        const Execution& execution = {})
      : mesh_(support::make_plate(0.16, 0.08, h, Corner::none)) {
    const TimeStepping time{.precision = precision, .interface_substeps = substeps};
    stepper_.emplace(mesh_, above_material, support::paper_law, time, execution);
  }

  record::ProbeRecord run(const std::vector<ProbePlace>& places, std::int64_t at_once, double interval_s) {
    const std::vector<BodySource> bodies = {{mesh_, above_material}};
    stepper_->set_probes(locate_probes(places, bodies));
    solid::Field u(mesh_.n_nodes()), v(mesh_.n_nodes());
    for (mesh::Node n = 0; n < mesh_.n_nodes(); ++n) {
      const double dt = stepper_->step_s(n);
      u.y[n] = 1e-5 + u_m(mesh_.y_m[n], 0);
      v.y[n] = dt > 0 ? (u_m(mesh_.y_m[n], 0) - u_m(mesh_.y_m[n], -dt)) / dt : 0;
    }
    const auto state = support::in_flight(mesh_, u, v);
    stepper_->start(state, 1);
    support::RowRecorder recorder(state, 1.3, 0);
    return take_steps(*stepper_, recorder, std::llround(30e-6 / stepper_->step_s()), at_once, interval_s);
  }

  static double pulse(double s_m) { return 1e-6 * std::exp(-0.5 * s_m * s_m / (4e-3 * 4e-3)); }
  static double slope(double s_m) { return -s_m / (4e-3 * 4e-3) * pulse(s_m); }
  /// The pulse, and its image below the free edge.
  double u_m(double y_m, double time_s) const {
    return pulse(y_m - 0.03 + c_ * time_s) + pulse(-y_m - 0.03 + c_ * time_s);
  }
  double v_m_per_s(double y_m, double time_s) const {
    return c_ * (slope(y_m - 0.03 + c_ * time_s) + slope(-y_m - 0.03 + c_ * time_s));
  }
  double strain_yy(double y_m, double time_s) const {
    return slope(y_m - 0.03 + c_ * time_s) - slope(-y_m - 0.03 + c_ * time_s);
  }

 private:
  mesh::Mesh mesh_;
  double c_ = solid::longitudinal_speed_m_per_s(above_material);
  std::optional<Stepper> stepper_;
};

/// Largest differences from the analytic solution at a place over the largest values anywhere.
struct Errors {
  double u = 0, v = 0, strain = 0;
};

/// In the plate, in the sub-cycled layer and at its edge; halfway up in cells, which have one strain each.
std::vector<Errors> errors_of(double h, int substeps) {
  PassingPulse wave(h, substeps);
  const std::vector<ProbePlace> places = {
      {"plate", 0.0801, 0.02 + 0.5 * h}, {"layer", 0.0803, 1.5 * h}, {"join", 0.0799, 3.5 * h}};
  const auto rows = wave.run(places, 16, 0.4e-6);
  const double P = solid::longitudinal_modulus_Pa(above_material);
  std::vector<Errors> worst(places.size());
  Errors largest;
  for (std::size_t t = 0; t < rows.time_s.size(); ++t)
    for (std::size_t k = 0; k < places.size(); ++k) {
      const std::size_t at = t * places.size() + k;
      const double y_m = places[k].y_m, time_s = rows.time_s[t];
      const auto take = [](double& difference, double& scale, double value, double expected) {
        difference = std::max(difference, std::abs(value - expected));
        scale = std::max(scale, std::abs(expected));
      };
      take(worst[k].u, largest.u, rows.u_y_m[at] - 1e-5, wave.u_m(y_m, time_s));
      take(worst[k].v, largest.v, rows.v_y_m_per_s[at], wave.v_m_per_s(y_m, time_s));
      take(worst[k].strain, largest.strain, rows.strain_yy[at], wave.strain_yy(y_m, time_s));
      EXPECT_NEAR(rows.stress_yy_Pa[at], P * rows.strain_yy[at], 1e-9 * P * 1e-4);
    }
  for (auto& errors : worst)
    errors = {errors.u / largest.u, errors.v / largest.v, errors.strain / largest.strain};
  return worst;
}

// Second order: measured differences fall by 1.8 to 7 with half the element, where 4 is the limit.
TEST(Probes, RecordAPassingPlaneWave) {
  for (const int substeps : {1, 6}) {
    const auto coarse = errors_of(1e-3, substeps), fine = errors_of(0.5e-3, substeps);
    for (std::size_t k = 0; k < fine.size(); ++k) {
      EXPECT_LT(fine[k].u, 0.6 * coarse[k].u) << substeps << " " << k;
      EXPECT_LT(fine[k].v, 0.5 * coarse[k].v) << substeps << " " << k;
      EXPECT_LT(fine[k].u, 0.005) << substeps << " " << k;
      EXPECT_LT(fine[k].v, 0.016) << substeps << " " << k;
      // The nodes at the layer's edge swing with the pushes of the cells above; undamped, by 7 to 9 % of the
      // strain in the cells next to them.
      const bool swings = k == 2 && substeps > 1;
      EXPECT_LT(fine[k].strain, swings ? 0.1 : 0.006) << substeps << " " << k;
      if (!swings) {
        EXPECT_LT(fine[k].strain, 0.5 * coarse[k].strain) << substeps << " " << k;
      }
    }
  }
}

TEST(Probes, RecordTheSameForAnyThreadsAndSweeps) {
  const std::vector<ProbePlace> places = {{"a", 0.0801, 0.0203}, {"b", 0.01, 0.0031}, {"c", 0.0, 0.08},
                                          {"d", 0.1503, 0.0},    {"e", 0.05, 0.0555}, {"f", 0.16, 0.04}};
  for (const auto precision : {Precision::double_precision, Precision::single_precision}) {
    for (const double interval_s : {0.0, 0.7e-6}) {
      // One step at a time: nothing is under way when the displacements are looked at.
      const auto expected = PassingPulse(1e-3, 6, precision).run(places, 1, interval_s);
      ASSERT_GT(expected.time_s.size(), 5U);
      for (const auto& execution : {Execution{1, 7}, Execution{3, 5}}) {
        const auto rows = PassingPulse(1e-3, 6, precision, execution).run(places, 50, interval_s);
        EXPECT_EQ(rows.time_s, expected.time_s);
        for (const auto& field : record::probe_fields)
          EXPECT_EQ(rows.*field.member, expected.*field.member) << field.name;
      }
    }
  }
}

}  // namespace
}  // namespace slipfront::motion
