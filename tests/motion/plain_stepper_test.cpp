// SPDX-License-Identifier: BSD-3-Clause
#include "motion/plain_stepper.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "motion/problems.hpp"

namespace slipfront::motion {
namespace {

using namespace support;
using mesh::Corner;

void expect_near(std::span<const double> a, std::span<const double> b, double rounding, const char* what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  double largest = 0, worst = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    largest = std::max(largest, std::abs(a[k]));
    worst = std::max(worst, std::abs(a[k] - b[k]));
  }
  EXPECT_LE(worst, rounding * largest) << what;
}

/// What steps leave: everything that a run writes.
struct Trace {
  Snapshot snapshot;
  record::History history;
  record::ProbeRecord probes;
  record::SlipRecord record;
  record::Energies start, end;
};

/// Steps until the coarsest level has taken some.
template <class S>
Trace run(S& stepper, const Problem& problem, const Bodies& bodies, const Begin& begin, int n_steps) {
  stepper.set_probes(locate_probes(problem.probes, bodies.sources()));
  stepper.start(begin.state, 0.3, begin.loads);
  support::RowRecorder recorder(begin.state, mu_s, begin.halo);
  Trace trace;
  trace.start = stepper.energies();
  ProbeRecorder probes(stepper.probes(), stepper.step_s(), stepper.step_s(), stepper.probed_u_m(),
                       stepper.probed_u_m());
  probes.expect(0, n_steps);
  recorder.to_row = [&] { return &trace.history; };
  recorder.probes = &probes;
  EXPECT_EQ(stepper.advance(recorder, n_steps), n_steps);
  probes.take_rows(n_steps, trace.probes);
  trace.snapshot = stepper.snapshot();
  trace.record = recorder.record_until(stepper.time_s());
  trace.end = stepper.energies();
  return trace;
}

class StepperOf : public ::testing::TestWithParam<Variant> {};
INSTANTIATE_TEST_SUITE_P(Variants, StepperOf, ::testing::ValuesIn(variants),
                         [](const auto& variant) { return variant.param.name; });

TEST_P(StepperOf, ComputesThePlainScheme) {
  Problem problem;
  GetParam().change(problem);
  problem.contact.law = gentle_law.law;
  problem.is_strained = true;
  problem.t_over_p = 1.27;
  const bool is_single = problem.time.precision == Precision::single_precision;
  // Of numbers whose largest component may be another one.
  const double rounding = is_single ? 1e-4 : 1e-12;
  const Bodies bodies(problem);
  const auto begin = begin_of(problem, bodies);
  Stepper stepper(bodies.sources(), problem.contact, problem.time, problem.execution);
  PlainStepper plain(bodies.sources(), problem.contact, problem.time);
  EXPECT_EQ(stepper.node_updates_per_step(), plain.node_updates_per_step());
  EXPECT_DOUBLE_EQ(stepper.step_s(), plain.step_s());
  EXPECT_DOUBLE_EQ(stepper.substep_s(), plain.substep_s());
  constexpr int n_steps = 12;
  const auto a = run(stepper, problem, bodies, begin, n_steps),
             b = run(plain, problem, bodies, begin, n_steps);
  EXPECT_GT(a.record.onsets.size(), 12);
  for (const auto component : components) {
    expect_near(a.snapshot.u_m.*component, b.snapshot.u_m.*component, rounding, "u");
    expect_near(a.snapshot.v_m_per_s.*component, b.snapshot.v_m_per_s.*component, rounding, "v");
  }
  for (const auto& field : record::history_fields)
    expect_near(a.history.*field.member, b.history.*field.member, rounding, field.name);
  for (const auto& field : record::probe_fields)
    expect_near(a.probes.*field.member, b.probes.*field.member, rounding, field.name);
  ASSERT_EQ(a.record.onsets.size(), b.record.onsets.size());
  double largest = 0;
  for (const auto& term : record::energy_terms) largest = std::max(largest, std::abs(a.end.*term.member));
  for (const auto& term : record::energy_terms)
    EXPECT_NEAR(a.end.*term.member, b.end.*term.member, rounding * largest) << term.name;
  EXPECT_LE(std::abs(record::imbalance_J_per_m(b.end, b.start)), 1e-12 * largest);
}

/// Contact of the direct algorithm on the rigid plane, and friction that weakens with the slip rate, node by
/// node.
struct PlainContact {
  interface::VelocityWeakening law;
  interface::Trigger trigger;
  std::vector<double> force_N_per_m, slip_rate_m_per_s;  ///< [interface nodes]

  void operator()(PlainBody& body, double dt, double now_s) {
    const auto mu = law.evaluator();
    auto &u = body.u_m, &v = body.v_m_per_s;
    for (std::size_t i = 0; i < body.side.nodes.size(); ++i) {
      const auto n = body.side.nodes[i];
      const double m = body.mass_kg[n], B = body.side.tributary_m[i];
      const double x = v.x[n] + dt * trigger_factor(trigger, now_s) * force_N_per_m[i] / m, y = v.y[n];
      const double gap = body.side.y_m[i] + u.y[n];
      const double p = std::max(0.0, -(y + gap / dt) * m / (dt * B));
      const double stop = x * m / (dt * B);
      double mean = slip_rate_m_per_s[i];
      for (int evaluation = 0; evaluation < 3; ++evaluation) {
        const double strength = mu(std::abs(mean), 0) * p;
        v.x[n] = std::abs(stop) <= strength ? 0 : x - dt * B * std::copysign(strength, stop) / m;
        mean = 0.5 * (slip_rate_m_per_s[i] + v.x[n]);
      }
      v.y[n] = y + dt * B * p / m;
      slip_rate_m_per_s[i] = v.x[n];
      u.x[n] += dt * v.x[n];
      u.y[n] += dt * v.y[n];
    }
  }
};

class Scheme : public ::testing::TestWithParam<std::tuple<Corner, int, int>> {};
INSTANTIATE_TEST_SUITE_P(Layers, Scheme,
                         ::testing::Combine(::testing::Values(Corner::relief, Corner::fillet),
                                            ::testing::Values(1, 8), ::testing::Values(1, 5)),
                         [](const auto& p) {
                           return name_of(std::get<0>(p.param)) + "_" + std::to_string(std::get<1>(p.param)) +
                                  "rows_" + std::to_string(std::get<2>(p.param)) + "substeps";
                         });

TEST_P(Scheme, IsComputedWithContactAndFriction) {
  // A triggered event with stick, slip and opening.
  const auto [corner, rows, substeps] = GetParam();
  const auto mesh = tiny_plate(corner);
  const solid::Material material;
  const auto e = statics::Statics(mesh, material, tilted, mu_s).shear_to(0.9);
  const TimeStepping time{.interface_rows = rows, .interface_substeps = substeps};
  const auto loads = left_trigger(e, mesh, mu_s);
  Stepper stepper(mesh, material, gentle_law, time);
  stepper.start(e, 0.2, loads);
  PlainStepper plain(std::vector<BodySource>{{mesh, material}}, gentle_law, time);
  plain.start(e, 0.2, loads);
  std::vector<PlainBody> bodies(plain.bodies().begin(), plain.bodies().end());
  auto& body = bodies.front();
  PlainContact contact{
      gentle_law.law.as<interface::VelocityWeakening>(), loads.trigger, loads.trigger_force_N_per_m, {}};
  for (const auto n : mesh.interface_nodes) contact.slip_rate_m_per_s.push_back(body.v_m_per_s.x[n]);
  Recorder recorder(e, mu_s, 0);
  for (int step = 0; step < 40; ++step) {
    const double now_s = stepper.time_s(), dt = stepper.substep_s();
    stepper.advance(recorder);
    take_step(std::span(bodies), substeps, [&](int k) { contact(body, dt, now_s + k * dt); });
  }
  EXPECT_GT(recorder.record_until(stepper.time_s()).onsets.size(), 5);
  EXPECT_GT(max_abs(body.v_m_per_s), 0.1);
  // Rounding of displacements of 0.05 mm and velocities of some 10 m/s; schemes that differ do so by more
  // than 1e-6 of that.
  EXPECT_LE(max_difference(stepper.u_m(), body.u_m), 1e-16);
  EXPECT_LE(max_difference(stepper.v_m_per_s(), body.v_m_per_s), 1e-10);
}

}  // namespace
}  // namespace slipfront::motion
