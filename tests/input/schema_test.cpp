// SPDX-License-Identifier: BSD-3-Clause
#include "input/schema.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "input/entries.hpp"
#include "interface/friction/registry.hpp"
#include "interface/friction/velocity_weakening.hpp"
#include "messages.hpp"

namespace slipfront::input {
namespace {

using test::error_of;
using ::testing::HasSubstr;

constexpr double infinity = std::numeric_limits<double>::infinity();

// Structured bindings name every member: with one more member of a struct its number below does not compile,
// which reminds of its entry in the schema.
template <int n, class Struct>
auto members(const Struct& s) {
  if constexpr (n == 3) {
    const auto& [a, b, c] = s;
    return std::tuple(a, b, c);
  } else if constexpr (n == 4) {
    const auto& [a, b, c, d] = s;
    return std::tuple(a, b, c, d);
  } else if constexpr (n == 5) {
    const auto& [a, b, c, d, e] = s;
    return std::tuple(a, b, c, d, e);
  } else if constexpr (n == 6) {
    const auto& [a, b, c, d, e, f] = s;
    return std::tuple(a, b, c, d, e, f);
  } else if constexpr (n == 7) {
    const auto& [a, b, c, d, e, f, g] = s;
    return std::tuple(a, b, c, d, e, f, g);
  } else if constexpr (n == 8) {
    const auto& [a, b, c, d, e, f, g, h] = s;
    return std::tuple(a, b, c, d, e, f, g, h);
  } else {
    static_assert(n == 9);
    const auto& [a, b, c, d, e, f, g, h, i] = s;
    return std::tuple(a, b, c, d, e, f, g, h, i);
  }
}
auto members(const mesh::Plate& plate) {
  const auto& [a, b, c, d, e, f, g, h, i, j, k, l] = plate;
  return std::tuple(a, b, c, d, e, f, g, h, i, j, k, l);
}
auto members(const boundary::Machine& machine) {
  const auto& [shear_Pa, normal_Pa, pusher, mass_kg_per_m2] = machine;
  return std::tuple(shear_Pa, normal_Pa, pusher.from_m, pusher.to_m, mass_kg_per_m2);
}
auto members(const statics::Loading& loading) {
  const auto& [a, b, c, d, e, f, g, h, i, j, pressure, l, m, n] = loading;
  return std::tuple(a, b, c, d, e, f, g, h, i, j, pressure.x_m, pressure.p_Pa, l, m, n);
}
auto members(const Base& base) {
  const auto& [kind, plate, material] = base;
  return std::tuple(kind, members(plate), members<5>(material));
}
auto members(const Prestress& p) {
  const auto& [a, b, c, table, e, f] = p;
  return std::tuple(a, b, c, table.text, e, f);
}
auto members(const FrictionAlongX& f) {
  const auto& [a, table, c, d, e, g, h] = f;
  return std::tuple(a, table.text, c, d, e, g, h);
}

/// A friction law's name and members, by its own list of parameters.
auto members(const interface::FrictionLaw& friction) {
  return interface::visit(friction, [&](const auto& law) {
    std::vector<double> values;
    for (const auto& parameter : law.parameters()) values.push_back(law.*parameter.member);
    if constexpr (requires { law.lists(); })
      for (const auto& list : law.lists())
        values.insert(values.end(), (law.*list.member).begin(), (law.*list.member).end());
    values.push_back(friction.cohesion_Pa());
    return std::pair(std::string(friction.name()), values);
  });
}
auto members(const Case& c) {
  const auto& [title, plate, material, machine, base, loading, prestress, friction, friction_along_x, tip,
               regularisation, contact, event, trigger, nucleation, sequence, time, fronts, output, probes] =
      c;
  return std::tuple(title, members(plate), members<5>(material), members(machine), members(base),
                    members(loading), members(prestress), members(friction), members(friction_along_x), tip,
                    members<4>(regularisation), contact, event, members<6>(trigger), members<9>(nucleation),
                    members<7>(sequence), members<9>(time), members<7>(fronts), members<6>(output),
                    members<4>(probes));
}

void expect_equal(const Case& a, const Case& b) {
  EXPECT_TRUE(members(a) == members(b)) << to_toml(a) << "\nis not\n\n" << to_toml(b);
}

/// A case in which no member has its default, as a file has it.
const std::string changed_text =
    "title = \"a \\\"title\\\" with \\\\ and\\ttab, \\u00b5\"\n"
    "plate = {width_m = 0.30000000000000004, height_m = 0.3333333333333333, element_size_m = 1.5e-4,"
    " coarsenings = 2, fine_height_m = 1.25e-3, corner = 'none', sides = 'absorbing',"
    " top = 'absorbing'}\n"
    "material = {youngs_modulus_Pa = 3.3e8, poissons_ratio = -0.25, density_kg_per_m3 = 1.1e3,"
    " plane = 'strain', stiffness_damping_s = 0}\n"
    "base = {kind = 'body', height_m = 0.285, coarsenings = 1, fine_height_m = 2.5e-3, sides = 'absorbing',"
    " bottom = 'free', youngs_modulus_Pa = 6.7e10, poissons_ratio = 0.125, density_kg_per_m3 = 7.8e3,"
    " stiffness_damping_s = 3e-9}\n"
    "loading = {tilt_left_m = 1e-4, tilt_right_m = 3e-4, top_during_tilt = 'free', method = 'ramp',"
    " solver = 'direct', shear_speed_m_per_s = 1e-5, edge_margin_m = 0.02, critical_margin = 3e-4}\n"
    "friction = {law = 'velocity_weakening', mu_s = 1.25, mu_k = 0.75, alpha_m2_per_s2 = 0.3,"
    " regularisation = 'strength', relaxation_length_m = 4e-6, relaxation_slip_rate_m_per_s = 0.5,"
    " relaxation_time_s = 2e-6, file = 'table.csv', between_rows = 'stepwise', random_key = 'mu_k',"
    " random_share = 0.05, random_correlation_length_m = 6e-3, random_seed = 7}\n"
    "contact.algorithm = 'predictor_corrector'\n"
    "event = {kind = 'right', trigger_form = 'raised', trigger_zone_m = 7e-3, trigger_over_strength = 2.5,"
    " trigger_ramp = 'smooth', trigger_ramp_s = 0, trigger_duration_s = 3e-5}\n"
    "time = {step_factor = 1.5, allow_unstable = true, stepper = 'plain', precision = 'single', "
    "interface_rows = 7,"
    " interface_substeps = 11, local_steps = false, end_s = 1e-4, quiet_s = inf}\n"
    "fronts = {l_star_m = 1e-3, speed_interval = 'approach', arrest_time_s = 2e-5, min_length_m = 3e-3,"
    " crack_share = 0.625, pulse_share = 0.25, trigger_margin_m = 6e-3}\n"
    "output = {history_interval_s = 1e-7, snapshot_times_s = [0, 1e-5, 3.3e-5], snapshot_interval_s = 4e-5,"
    " snapshot_stress = false, energy_interval_s = 3e-5, moment_rate = true}\n"
    "probes = {x_m = [0.01, 0.02], y_m = [0.03, 0.05], names = ['left', 'b \\'], interval_s = 2e-6}\n";

Case changed_case() {
  Case c;
  c.title = "a \"title\" with \\ and\ttab, \xc2\xb5";
  c.plate = {.width_m = 0.1 + 0.2,
             .height_m = 1.0 / 3,
             .element_size_m = 1.5e-4,
             .coarsenings = 2,
             .fine_height_m = 1.25e-3,
             .corner = mesh::Corner::none,
             .sides = mesh::Sides::absorbing,
             .top = mesh::Top::absorbing};
  c.material = {3.3e8, -0.25, 1.1e3, solid::Plane::strain, 0};
  c.base.kind = BaseKind::body;
  c.base.plate.height_m = 0.285;
  c.base.plate.coarsenings = 1;
  c.base.plate.fine_height_m = 2.5e-3;
  c.base.plate.sides = mesh::Sides::absorbing;
  c.base.plate.top = mesh::Top::free;
  c.base.material = {6.7e10, 0.125, 7.8e3, solid::Plane::stress, 3e-9};
  c.loading = {
      1e-4, 3e-4, statics::TopEdge::free, statics::LoadingMethod::ramp, statics::StaticSolver::direct, 1e-5,
      0.02, 3e-4};
  c.friction = interface::VelocityWeakening { 1.25, 0.75, 0.3 };
  c.friction_along_x = {"table.csv", {}, BetweenRows::stepwise, "mu_k", 0.05, 6e-3, 7};
  c.regularisation = {interface::Relaxed::strength, 4e-6, 0.5, 2e-6};
  c.contact = interface::ContactAlgorithm::predictor_corrector;
  c.event = interface::EventKind::right;
  c.trigger = {interface::TriggerForm::raised, 7e-3, 2.5, interface::Ramp::smooth, 0, 3e-5};
  c.time = {1.5,  true,    motion::StepperKind::plain, motion::Precision::single_precision, 7, 11, false,
            1e-4, infinity};
  c.fronts = {1e-3, fronts::SpeedInterval::approach, 2e-5, 3e-3, 0.625, 0.25, 6e-3};
  c.output = {1e-7, {0, 1e-5, 3.3e-5}, 4e-5, false, 3e-5, true};
  c.probes = {{0.01, 0.02}, {0.03, 0.05}, {"left", "b \\"}, 2e-6};
  return c;
}

/// A case of prescribed tractions in which no member that it can set has its default.
Case changed_prestress() {
  Case c = changed_case();
  c.friction_along_x = {};
  c.plate.corner = mesh::Corner::none;
  c.loading = {};
  c.loading.method = statics::LoadingMethod::prestress;
  c.loading.shear_speed_m_per_s = 0;
  c.prestress = {1e6 / 3, 2e6 / 7, "", {}, 3e8, -2e8};
  c.event = interface::EventKind::nucleation;
  c.trigger = {.ramp_s = 0, .duration_s = 3e-5};
  c.friction.parameter("cohesion_Pa") = 3e4;
  c.nucleation = {.form = interface::NucleationForm::overstress,
                  .profile = interface::NucleationProfile::smooth,
                  .x_m = 0.1 / 3,
                  .half_length_m = 7e-3,
                  .overstress_Pa = -2e5};
  return c;
}

TEST(Schema, DefaultsReadBackFromToml) {
  expect_equal(parsed(""), Case{});
  expect_equal(parsed(to_toml(Case{})), Case{});
}

TEST(Schema, TheKeysStandForTheirMembers) {
  const Case changed = changed_case();
  Case standard;
  standard.friction = interface::VelocityWeakening {};
  const std::set<std::string> unchanged = {"friction.law", "friction.cohesion_Pa", "plate.corner",
                                           "base.kind"};
  for (const Entry& entry : entries_of(changed))
    if (!unchanged.contains(entry.key) && has_value(entry, changed)) {
      EXPECT_NE(toml_text(entry.get(changed)), toml_text(entry.get(standard)))
          << entry.key << " is not changed";
    }
  expect_equal(parsed(changed_text), changed);
  expect_equal(parsed(to_toml(changed)), changed);
}

TEST(Schema, PrestressAndNucleationReadBackFromToml) {
  const Case uniform = changed_prestress();
  const Case standard;
  std::set<std::string> keys;
  for (const Entry& entry : entries_of(uniform)) {
    keys.insert(entry.key);
    if (entry.key.starts_with("prestress.") || entry.key.starts_with("nucleation.")) {
      EXPECT_EQ(toml_text(entry.get(uniform)) != toml_text(entry.get(standard)),
                entry.key != "prestress.file")
          << entry.key;
    }
  }
  EXPECT_TRUE(keys.contains("nucleation.overstress_Pa"));
  EXPECT_FALSE(keys.contains("loading.tilt_left_m"));
  expect_equal(parsed(to_toml(uniform)), uniform);

  Case table = uniform;
  table.prestress = {};
  table.prestress.file = "table.csv";
  expect_equal(parsed(to_toml(table)), table);

  Case forced = uniform;
  forced.trigger = {};
  forced.nucleation = {.form = interface::NucleationForm::forced,
                       .x_m = 0.1 / 3,
                       .half_length_m = 7e-3,
                       .taper_m = 1e-3,
                       .front_speed_m_per_s = 300,
                       .weakening_time_s = 1e-6};
  expect_equal(parsed(to_toml(forced)), forced);
}

TEST(Schema, WhatIsNotSetTogetherReadsBackFromToml) {
  Case relief, fillet, pushed, on_machine, sequence;
  relief.plate.corner = mesh::Corner::relief;
  relief.plate.relief_length_m = 4e-3;
  relief.plate.relief_height_m = 3e-4;
  relief.plate.relief_depth_m = 8e-3;
  fillet.base.kind = BaseKind::rigid;
  fillet.plate.corner = mesh::Corner::fillet;
  fillet.plate.fillet_radius_m = 3e-3;
  pushed.machine.pusher = {0.01, 0.02};
  on_machine.machine = {2e9, 0};
  sequence.loading.shear_speed_m_per_s = 1e-8;
  sequence.time.end_s = 1e-2;
  sequence.time.quiet_s = 1e-3;
  sequence.sequence = {7, 400, true, {{2, 3}, {1e-6, 1e-6}}, 0.02, 3, {}};
  auto slow = sequence;
  slow.friction = interface::RateAndStateAging {};
  slow.sequence = {7, 400, true, {}, 0, 1, 2e-3};
  for (const Case& c : {relief, fillet, pushed, on_machine, sequence, slow})
    expect_equal(parsed(to_toml(c)), c);
  EXPECT_TRUE(parsed("loading.normal_stiffness_Pa_per_m = inf").machine.is_rigid());
}

TEST(Schema, LoadingPathsRiseInTime) {
  const auto error = [](const char* times, const char* shears) {
    return parse_error(
        fmt::format("sequence.max_events = 2\nsequence.times_s = {}\nsequence.shears_m = {}", times, shears));
  };
  EXPECT_THAT(error("[1.0, 2.0]", "[1e-6]"), HasSubstr("one displacement per time"));
  EXPECT_THAT(error("[2.0, 2.0]", "[1e-6, 2e-6]"), HasSubstr("sequence.times_s must rise"));
  EXPECT_THAT(error("[1.0, 2.0]", "[2e-6, 1e-6]"), HasSubstr("sequence.shears_m must not fall"));
}

TEST(Schema, SlowSlipBetweenEventsNeedsAFactorisationAndAPressure) {
  const std::string slow = "friction.law = \"rate_and_state_aging\"\nsequence.max_events = 2\n";
  EXPECT_TRUE(is_slow(parsed(slow + "friction.theta_i_s = 10")));
  EXPECT_THAT(parse_error(slow + "loading.solver = \"iterative\""), HasSubstr("condense the interface"));
  EXPECT_THAT(parse_error(slow + "friction.regularisation = \"initial_pressure\""),
              HasSubstr("no pressure to slow slip"));
  EXPECT_THAT(parse_error(slow + "sequence.healing_per_e_fold = 0.1"), HasSubstr("with mu_s"));
  EXPECT_THAT(parse_error("sequence.max_events = 2\nsequence.inertia_slip_rate_m_per_s = 0.1"),
              HasSubstr("with a state"));
}

TEST(Schema, PushersNeedASideThatIsFreeAndNodesUnderThem) {
  const std::string pusher = "loading.pusher_from_m = 0.01\nloading.pusher_to_m = 0.02\n";
  EXPECT_THAT(parse_error("loading.pusher_to_m = 0.02"), HasSubstr("an element above the interface"));
  EXPECT_THAT(parse_error("loading.pusher_from_m = 0.02"), HasSubstr("an element or more apart"));
  EXPECT_THAT(parse_error("loading.pusher_from_m = 0.05\nloading.pusher_to_m = 0.2"),
              HasSubstr("plate.height_m"));
  EXPECT_THAT(parse_error(pusher + "base.kind = 'rigid'\nplate.corner = 'fillet'"),
              HasSubstr("other than fillet"));
  EXPECT_THAT(parse_error(pusher + "plate.corner = 'none'\nplate.sides = 'absorbing'"),
              HasSubstr("plate.sides = free"));
  EXPECT_THAT(parse_error(pusher + "loading.solver = 'iterative'"), HasSubstr("loading.solver = direct"));
  EXPECT_THAT(parse_error(pusher + "time.precision = 'single'"), HasSubstr("time.precision = double"));
  EXPECT_THAT(parse_error(pusher + "loading.method = 'ramp'"), HasSubstr("loading.method = direct"));
}

TEST(Schema, MachinesNeedASolverThatKnowsThemAndElementsThatAreStiffer) {
  const std::string soft = "loading.shear_stiffness_Pa_per_m = 1e9\n",
                    dead = "loading.normal_stiffness_Pa_per_m = 0\n";
  EXPECT_THAT(parse_error("loading.shear_stiffness_Pa_per_m = 0"), HasSubstr("greater than 0"));
  EXPECT_THAT(parse_error("loading.normal_stiffness_Pa_per_m = -1"), HasSubstr("at least 0"));
  EXPECT_THAT(parse_error("loading.shear_stiffness_Pa_per_m = 1e14"), HasSubstr("for a rigid machine"));
  EXPECT_THAT(parse_error("loading.normal_stiffness_Pa_per_m = 1e14"), HasSubstr("for a rigid machine"));
  for (const auto& machine : {soft, dead}) {
    EXPECT_THAT(parse_error(machine + "loading.solver = 'iterative'"), HasSubstr("loading.solver = direct"));
    EXPECT_THAT(parse_error(machine + "time.precision = 'single'"), HasSubstr("time.precision = double"));
    EXPECT_THAT(parse_error(machine + "loading.method = 'ramp'"), HasSubstr("loading.method = direct"));
    EXPECT_THAT(parse_error(machine + "loading.method = 'prestress'"), HasSubstr("loading.method = direct"));
  }
}

TEST(Schema, DefaultsOfASequenceLetEventsComeToRestBeforeTheEdgeMovesOn) {
  const Case single = parsed(""), sequence = parsed("sequence.max_events = 2");
  EXPECT_DOUBLE_EQ(sequence.loading.shear_speed_m_per_s, 1e-3 * single.loading.shear_speed_m_per_s);
  EXPECT_DOUBLE_EQ(sequence.time.end_s, 10 * single.time.end_s);
  EXPECT_DOUBLE_EQ(sequence.time.quiet_s,
                   4 * single.plate.height_m / solid::shear_speed_m_per_s(single.material));
  EXPECT_EQ(parsed("time.quiet_s = 2e-4\nsequence.max_events = 2").time.quiet_s, 2e-4);
}

TEST(Schema, SequencesNeedEventsThatBeginAndEndByThemselves) {
  const std::string begin = "sequence.max_events = 2\n";
  EXPECT_THAT(parse_error(begin + "event.kind = 'left'"), HasSubstr("event.kind = spontaneous"));
  EXPECT_THAT(parse_error(begin + "loading.method = 'ramp'"), HasSubstr("loading.method = direct"));
  EXPECT_THAT(parse_error(begin + "time.quiet_s = inf"), HasSubstr("each event comes to rest"));
  EXPECT_THAT(parse_error(begin + "output.history_interval_s = 1e-3"), HasSubstr("at most half"));
  EXPECT_THAT(parse_error("sequence.end_s = 2"), HasSubstr("sequence.max_events > 1"));
}

TEST(Schema, ForcesReadBackFromToml) {
  Case pressure = changed_case();
  pressure.loading = {};
  pressure.loading.mean_pressure_Pa = 1e6 / 3;
  pressure.loading.tilt_difference_m = -2e-5;
  pressure.loading.shear_over_critical = 1;
  Case force = pressure;
  force.loading.mean_pressure_Pa = force.loading.shear_over_critical = {};
  force.loading.normal_force_N_per_m = 2e5 / 7;
  force.loading.shear_force_N_per_m = 1e4;
  Case uneven = pressure;
  uneven.machine.normal_stiffness_Pa_per_m = 0;
  uneven.time.precision = motion::Precision::double_precision;
  uneven.loading.mean_pressure_Pa = {};
  uneven.loading.tilt_difference_m = 0;
  uneven.loading.top_pressure = {{0.01, 0.1 / 3}, {0, 1e6 / 3}};
  for (const Case& c : {pressure, force, uneven}) {
    for (const char* key : {"tilt_left_m", "tilt_right_m", "critical_margin"})
      EXPECT_EQ(to_toml(c).find(std::string("\n") + key), std::string::npos) << key;
    expect_equal(parsed(to_toml(c)), c);
  }
  // Each force excludes the other way to give it, and an override wins.
  const Case overridden =
      parsed(to_toml(force), {{"loading.mean_pressure_Pa", toml_text(*pressure.loading.mean_pressure_Pa)},
                              {"loading.shear_over_critical", "1"}});
  expect_equal(overridden, pressure);
  const Case spontaneous = parsed(to_toml(force), {{"event.kind", "spontaneous"}});
  EXPECT_FALSE(spontaneous.loading.shear_force_N_per_m);
  EXPECT_TRUE(spontaneous.loading.normal_force_N_per_m);
  EXPECT_FALSE(parsed("", {{"loading.mean_pressure_Pa", "1e6"}}).loading.normal_force_N_per_m);
}

TEST(Schema, KeysThatAnOverrideExcludesAreDropped) {
  const std::string nucleated = to_toml(changed_prestress());
  const Case left = parsed(nucleated, {{"event.kind", "left"}});
  EXPECT_TRUE(members<9>(left.nucleation) == members<9>(Case{}.nucleation));
  EXPECT_EQ(left.event, interface::EventKind::left);
  const Case table = parsed(nucleated, {{"prestress.file", "t.csv"}});
  EXPECT_EQ(table.prestress.p_Pa, Case{}.prestress.p_Pa);
  const Case weakened = parsed(nucleated, {{"nucleation.form", "weakened"}});
  EXPECT_EQ(weakened.nucleation.overstress_Pa, Case{}.nucleation.overstress_Pa);
  // What depends on a key that is dropped is dropped with it.
  const std::string sequence =
      "[event]\nkind = \"spontaneous\"\n[sequence]\nmax_events = 9\nend_s = 2\nto_global_sliding = true\n";
  const Case single = parsed(sequence, {{"event.kind", "left"}});
  EXPECT_FALSE(is_sequence(single) || single.sequence.to_global_sliding);
  EXPECT_EQ(single.sequence.end_s, Case{}.sequence.end_s);
  // Without what it depends on a key is wrong all the same.
  expect_message(parse_error("[sequence]\nend_s = 2\n", {{"event.kind", "left"}}),
                 "c.toml:2: sequence.end_s applies only with sequence.max_events > 1");
  // An override of a key that does not apply is wrong all the same.
  expect_message(parse_error(nucleated, {{"event.kind", "left"}, {"nucleation.x_m", "0.1"}}),
                 "--set nucleation.x_m=0.1: nucleation.x_m applies only with");
}

TEST(Schema, ABodyBelowHasItsKeys) {
  const std::string graded = "base = {coarsenings = 1, fine_height_m = 0.01}\ntime.local_steps = false\n";
  EXPECT_FALSE(parsed(graded).time.local_steps);
  EXPECT_EQ(parsed("base.density_kg_per_m3 = 7850").base.material.density_kg_per_m3, 7850);
  expect_message(parse_error("base = {kind = 'rigid', density_kg_per_m3 = 7850}"),
                 "c.toml:1: ", "base.kind = body");
  const Case rigid = parsed(to_toml(changed_prestress()), {{"base.kind", "rigid"}});
  Base expected;
  expected.kind = BaseKind::rigid;
  EXPECT_TRUE(members(rigid.base) == members(expected));
}

TEST(Schema, TheFormOfATriggerDecidesWhatItsAmountIsOver) {
  const std::string at_left = "[event]\nkind = \"left\"\n", raised = at_left + "trigger_form = \"raised\"\n";
  EXPECT_EQ(parsed(at_left + "trigger_over_missing = 7\n").trigger.amount, 7);
  EXPECT_EQ(parsed(raised + "trigger_over_strength = 7\n").trigger.amount, 7);
  expect_message(parse_error(raised + "trigger_over_missing = 7\n"),
                 "c.toml:4: event.trigger_over_missing applies only with", "event.trigger_form = added");
  expect_message(parse_error(at_left + "trigger_amount = 7\n"),
                 "c.toml:3: event.trigger_amount is event.trigger_over_missing now", "trigger_over_strength");
}

TEST(Schema, AWeakenedTriggerHasNoAmount) {
  const std::string pushed = "[event]\nkind = \"left\"\ntrigger_over_missing = 7\n";
  EXPECT_EQ(parsed(pushed).trigger.amount, 7);
  std::vector<Override> overrides = {{"event.trigger_form", "weakened"}};
  EXPECT_EQ(parsed(pushed, overrides).trigger.form, interface::TriggerForm::weakened);
  EXPECT_EQ(parsed(pushed, overrides).trigger.amount, interface::Trigger{}.amount);
  overrides.push_back({"event.trigger_over_missing", "3"});
  expect_message(parse_error(pushed, overrides),
                 "--set event.trigger_over_missing=3: event.trigger_over_missing applies only with");
}

TEST(Schema, EveryLawOfTheRegistryIsReadByItsName) {
  ASSERT_EQ(friction_laws().size(), interface::law_descriptions().size());
  std::set<std::string> names;
  for (const LawEntries& law : friction_laws()) {
    SCOPED_TRACE(law.name);
    EXPECT_TRUE(names.insert(law.name).second) << "two laws of one name";
    const Case plain = parsed("friction.law = \"" + law.name + "\"");
    EXPECT_EQ(members(plain.friction), members(law.defaults));

    // A common factor keeps relations between parameters, e.g. mu_k <= mu_s.
    Case scaled;
    scaled.friction = law.defaults;
    for (const auto& parameter : interface::description_of(scaled.friction).parameters)
      scaled.friction.parameter(parameter.key) *= 0.75;
    EXPECT_NE(members(scaled.friction), members(law.defaults));
    expect_equal(parsed(to_toml(scaled)), scaled);

    for (const Entry& entry : law.entries) {
      const std::string too_small = toml_text(Value(entry.range.min - 1));
      const std::string written = entry.kind == Kind::numbers ? "[" + too_small + "]" : too_small;
      expect_message(parse_error("friction.law = \"" + law.name + "\"\n" + entry.key + " = " + written),
                     "c.toml:2: " + entry.key + " is " + too_small, "it must be at least");
    }
  }
}

/// A case that is refused, with the beginning of the message and what else it says.
struct Refused {
  const char *text, *begins, *contains = "";
};

constexpr Refused refused[] = {
    // Names
    {"[loading]\nshear_speed_over_c_L = 1e-6",
     "c.toml:2: loading.shear_speed_over_c_L is loading.shear_speed_m_per_s now, in m/s: "},
    {"[loading]\nshear_speed_over_c_L = 1e-6",
     "c.toml:2: loading.shear_speed_over_c_L is loading.shear_speed_m_per_s now, in m/s: "},
    {"[plate]\n\nwidht_m = 0.2", "c.toml:3: unknown key plate.widht_m; did you mean plate.width_m?"},
    {"[plate]\nwidth = 0.2", "c.toml:2: unknown key plate.width; did you mean plate.width_m?"},
    {"[friction]\nlaw = \"velocity_weakening\"\nalpha = 0.1",
     "c.toml:3: unknown key friction.alpha; did you mean friction.alpha_m2_per_s2?"},
    {"[friction]\ndc = 1e-6", "c.toml:2: unknown key friction.dc; did you mean friction.d_c_m?"},
    {"[friction]\nalpha = 0.1",
     "c.toml:2: unknown key friction.alpha; did you mean friction.alpha_m2_per_s2 of the friction law "
     "velocity_weakening?"},
    {"[material]\ndensitykg = 1200",
     "c.toml:2: unknown key material.densitykg; did you mean material.density_kg_per_m3?"},
    {"[time]\nunheard_of_quantity = 1", "c.toml:2: unknown key time.unheard_of_quantity"},
    {"[material]\nwidth_m = 1", "c.toml:2: unknown key material.width_m; did you mean plate.width_m?"},
    {"[loading]\nshear_force = 1e6",
     "c.toml:2: unknown key loading.shear_force; did you mean loading.shear_force_N_per_m?"},
    {"[loading]\nnormal_force_N = 1e6",
     "c.toml:2: unknown key loading.normal_force_N; did you mean loading.normal_force_N_per_m?"},
    {"width_m = 1", "c.toml:1: unknown key width_m"},
    {"title = \"\"\n[boundaries]", "c.toml:2: unknown table [boundaries]"},
    {"[plate.inner]\nwidth_m = 1", "c.toml:1: unknown table [plate.inner]"},
    {"plate = 3", "c.toml:1: plate is a table, not a key"},
    {"[[plate]]\nwidth_m = 1", "c.toml:1: plate is a table, not a key"},
    {"[event]\nkind = \"lft\"", "c.toml:2: event.kind is \"lft\"; it must be one of none",
     "did you mean left?"},
    {"[friction]\nlaw = \"coulom\"", "c.toml:2: friction.law is \"coulom\"; it must be one of "},
    {"[friction]\nlaw = \"coulomb\"\nmu_k = 0.5", "c.toml:3: friction.mu_k belongs to the friction law",
     "friction.law is coulomb"},
    // Types
    {"[plate]\nwidth_m = \"0.2\"", "c.toml:2: plate.width_m must be a number, is a string"},
    {"[plate]\nwidth_m = true", "c.toml:2: plate.width_m must be a number, is a boolean"},
    {"[plate]\nwidth_m = 1979-05-27", "c.toml:2: plate.width_m must be a number, is a date"},
    {"[plate.width_m]\nvalue = 1", "c.toml:1: plate.width_m must be a number, is a table"},
    {"[time]\ninterface_rows = 4.5", "c.toml:2: time.interface_rows must be an integer, is a number"},
    {"[time]\nallow_unstable = 1", "c.toml:2: time.allow_unstable must be true or false, is an integer"},
    {"title = 5", "c.toml:1: title must be a string, is an integer"},
    {"[event]\nkind = 1", "c.toml:2: event.kind must be a word in quotes, is an integer"},
    {"[output]\nsnapshot_times_s = 1e-5", "c.toml:2: output.snapshot_times_s must be a list of numbers"},
    {"[output]\nsnapshot_times_s = [0, \"a\"]",
     "c.toml:2: output.snapshot_times_s must be a list of numbers"},
    // Ranges
    {"[plate]\nheight_m = 0.0", "c.toml:2: plate.height_m is 0 m; it must be greater than 0 m"},
    {"[material]\npoissons_ratio = 0.5", "c.toml:2: material.poissons_ratio is 0.5",
     "greater than -1 and less than 0.5"},
    {"[material]\ndensity_kg_per_m3 = -1", "c.toml:2: material.density_kg_per_m3 is -1 kg/m3"},
    {"[time]\ninterface_substeps = 0", "c.toml:2: time.interface_substeps is 0",
     "at least 1 and at most 1000000"},
    {"[event]\nkind = \"left\"\ntrigger_duration_s = -1", "c.toml:3: event.trigger_duration_s is -1 s",
     "may be inf"},
    {"[output]\nsnapshot_times_s = [0, -1]", "c.toml:2: output.snapshot_times_s is -1 s"},
    // The first error of the file is reported.
    {"[time]\nend_s = -1\n[material]\ndensity_kg_per_m3 = -1", "c.toml:2: time.end_s"},
    // Keys that do not apply
    {"[prestress]\nt_Pa = 1\n", "c.toml:2: prestress.t_Pa applies only with loading.method = prestress"},
    {"[nucleation]\nx_m = 0.1\n", "c.toml:2: nucleation.x_m applies only with event.kind = nucleation"},
    {"[event]\nkind = \"nucleation\"\n[nucleation]\noverstress_Pa = 1\n",
     "c.toml:4: nucleation.overstress_Pa", "and nucleation.form = overstress"},
    {"[loading]\ntilt_left_m = 0\nmethod = \"prestress\"\n", "c.toml:2: loading.tilt_left_m",
     "loading.method = direct or ramp"},
    {"[loading]\nmethod = \"prestress\"\n[prestress]\nt_Pa = 1\np_Pa = 1\nfile = \"a.csv\"\n",
     "c.toml:4: prestress.t_Pa applies only with"},
    {"[event]\nkind = \"left\"\ntrigger_form = \"weakened\"\ntrigger_over_missing = 5\n",
     "c.toml:4: event.trigger_over_missing", "event.trigger_form = added"},
    {"[event]\ntrigger_zone_m = 1e-2\n",
     "c.toml:2: event.trigger_zone_m applies only with event.kind = left"},
    {"[event]\nkind = \"nucleation\"\ntrigger_ramp_s = 0\n", "c.toml:3: event.trigger_ramp_s",
     ", or event.kind = nucleation and nucleation.form = overstress"},
    {"[friction]\nrelaxation_time_s = 1e-6\n", "c.toml:2: friction.relaxation_time_s",
     "friction.regularisation = strength or pressure"},
    {"[plate]\nfillet_radius_m = 1e-3\n", "c.toml:2: plate.fillet_radius_m", "plate.corner = fillet"},
    {"[plate]\ncorner = \"none\"\nrelief_depth_m = 1e-3\n", "c.toml:3: plate.relief_depth_m",
     "plate.corner = relief"},
    {"[base]\nkind = \"rigid\"\nheight_m = 1", "c.toml:3: base.height_m applies only with base.kind"},
    // Two ways to give one load, and loads that do not go together
    {"[loading]\nmean_pressure_Pa = 1e6\ntilt_left_m = 1e-4\n", "c.toml:3: loading.tilt_left_m applies only",
     "none of loading.normal_force_N_per_m, mean_pressure_Pa and pressures_Pa"},
    {"[loading]\nmean_pressure_Pa = 1e6\nnormal_force_N_per_m = 1e5\n",
     "c.toml:2: loading.mean_pressure_Pa applies only",
     "neither loading.normal_force_N_per_m nor loading.pressures_Pa"},
    {"[loading]\npressures_x_m = [0]\npressures_Pa = [1e6]\n", "c.toml:2: loading.pressures_x_m applies only",
     "loading.normal_stiffness_Pa_per_m = 0"},
    {"[loading]\nnormal_stiffness_Pa_per_m = 0\nmean_pressure_Pa = 1e6\npressures_x_m = [0]\npressures_Pa = "
     "[1e6]\n",
     "c.toml:4: loading.pressures_x_m applies only", "nor mean_pressure_Pa"},
    {"[loading]\ntilt_difference_m = 1e-5\n", "c.toml:2: loading.tilt_difference_m applies only",
     "loading.normal_force_N_per_m or mean_pressure_Pa"},
    {"[loading]\nmethod = \"prestress\"\nmean_pressure_Pa = 1e6\n",
     "c.toml:3: loading.mean_pressure_Pa applies only", "loading.method = direct or ramp"},
    {"[event]\nkind = \"left\"\n[loading]\nshear_force_N_per_m = 1e5\ncritical_margin = 0.1\n",
     "c.toml:5: loading.critical_margin applies only",
     "neither loading.shear_force_N_per_m nor shear_over_critical"},
    {"[event]\nkind = \"left\"\n[loading]\nshear_force_N_per_m = 1e5\nshear_over_critical = 0.5\n",
     "c.toml:5: loading.shear_over_critical applies only", "no loading.shear_force_N_per_m"},
    {"[loading]\nshear_over_critical = 0.5\n", "c.toml:2: loading.shear_over_critical applies only",
     "event.kind other than spontaneous"},
    {"event.kind = \"left\"\nloading = {method = \"ramp\", shear_over_critical = 0.5}\n",
     "c.toml:2: loading.shear_over_critical applies only", "loading.method = direct"},
    {"[loading]\nmean_pressure_Pa = 0\n", "c.toml:2: loading.mean_pressure_Pa is 0 Pa; it must be greater"},
    {"[loading]\nnormal_force_N_per_m = -1\n", "c.toml:2: loading.normal_force_N_per_m is -1 N/m; it must"},
    {"[event]\nkind = \"left\"\n[loading]\nshear_over_critical = 1.01\n",
     "c.toml:4: loading.shear_over_critical is 1.01", "greater than 0 and at most 1"},
    {"[event]\nkind = \"left\"\n[loading]\nshear_force_N_per_m = 0\n",
     "c.toml:4: loading.shear_force_N_per_m is 0 N/m"},
    {"[loading]\nmean_pressure = 1e6\n", "c.toml:2: unknown key loading.mean_pressure",
     "did you mean loading.mean_pressure_Pa?"},
    // Syntax
    {"title = \"x\"\n\n[plate\n", "c.toml:3: ", "; correct the TOML there"},
    {"title = \"x\"\n[*plate]\n", "c.toml:2: ", "; correct the TOML there"},
    {"[plate]\nwidth_m = 0.2.1", "c.toml:2: "},
    {"[plate]\nwidth_m =\n", "c.toml:2: "},
    {"[plate]\nwidth_m = 0.2\nwidth_m = 0.3", "c.toml:3: ", "width_m"},
    {"[plate]\n[plate]", "c.toml:2: ", "; keep only one of the two"},
};

TEST(Schema, WhatIsWrongIsRefusedWithItsLine) {
  for (const auto& [text, begins, contains] : refused) expect_message(parse_error(text), begins, contains);
}

TEST(Schema, AnIntegerDoesForANumber) {
  EXPECT_EQ(parsed("[plate]\nwidth_m = 2").plate.width_m, 2.0);
  EXPECT_EQ(parsed("[output]\nsnapshot_times_s = [0, 1.5, 2]").output.snapshot_times_s,
            (std::vector<double>{0, 1.5, 2}));
}

TEST(Schema, NoNumberMayBeNanAndOnlyOpenEndedTimesAndRigidMachinesInfinite) {
  std::vector<std::string> may_be_infinite;
  for (const Entry& entry : entries_of(Case{})) {
    if (entry.kind != Kind::number) continue;
    expect_message(parse_error(entry.key + " = nan"), "", "is nan");
    if (parse_error(entry.key + " = inf") == "(nothing thrown)") may_be_infinite.push_back(entry.key);
  }
  EXPECT_EQ(may_be_infinite,
            (std::vector<std::string>{"loading.shear_stiffness_Pa_per_m", "loading.normal_stiffness_Pa_per_m",
                                      "time.quiet_s", "output.snapshot_interval_s"}));
}

// What is refused is in relations_test.
TEST(Schema, RelationsThatAreAllowed) {
  EXPECT_EQ(parsed("[time]\nstep_factor = 1.5\nallow_unstable = true").time.step_factor, 1.5);
  for (const std::string scale : {"relaxation_length_m = 1e-5", "relaxation_time_s = 1e-6"})
    EXPECT_EQ(parsed("[friction]\nregularisation = \"strength\"\n" + scale).regularisation.relaxed,
              interface::Relaxed::strength);
}

TEST(Overrides, AreSplitAtTheFirstEqualsSign) {
  EXPECT_EQ(parse_override("title=a=b"), Override("title", "a=b"));
  EXPECT_EQ(parse_override(" plate.width_m = 0.4 "), Override("plate.width_m", "0.4"));
  EXPECT_EQ(parse_override("title="), Override("title", ""));
  expect_message(error_of([] { parse_override("plate.width_m"); }),
                 "--set plate.width_m: is not of the form key=value");
  expect_message(error_of([] { parse_override("=1"); }), "--set =1: is not of the form key=value");
}

TEST(Overrides, WinOverTheFileAndTheLastOverEarlierOnes) {
  const Case c = parsed("[plate]\nwidth_m = 0.3\nheight_m = 0.2",
                        {{"plate.width_m", "0.4"}, {"plate.width_m", "0.5"}, {"time.interface_rows", "6"}});
  EXPECT_EQ(c.plate.width_m, 0.5);
  EXPECT_EQ(c.plate.height_m, 0.2);
  EXPECT_EQ(c.time.interface_rows, 6);
  // They mend an error of the file.
  EXPECT_EQ(parsed("[plate]\nwidth_m = -1", {{"plate.width_m", "0.4"}}).plate.width_m, 0.4);
}

TEST(Overrides, WordsAndTextNeedNoQuotes) {
  for (const char* left : {"left", "\"left\""})
    EXPECT_EQ(parsed("", {{"event.kind", left}}).event, interface::EventKind::left);
  for (const auto& [value, title] : {std::pair{"my run", "my run"}, {"12", "12"}, {"'12'", "12"}})
    EXPECT_EQ(parsed("", {{"title", value}}).title, title);
  const Case c = parsed("", {{"output.snapshot_times_s", "[1e-5, 2e-5]"},
                             {"time.allow_unstable", "true"},
                             {"event.kind", "left"},
                             {"event.trigger_duration_s", "inf"}});
  EXPECT_EQ(c.output.snapshot_times_s, (std::vector<double>{1e-5, 2e-5}));
  EXPECT_TRUE(c.time.allow_unstable);
  EXPECT_TRUE(std::isinf(c.trigger.duration_s));
}

TEST(Overrides, ErrorsNameTheOverride) {
  const std::tuple<const char*, const char*, const char*> overrides[] = {
      {"plate.widht_m", "1", "=1: unknown key plate.widht_m; did you mean plate.width_m?"},
      {"plate.width_m", "0,2", "=0,2: plate.width_m must be a number, is a string"},
      {"plate.width_m", "1e400", "=1e400: plate.width_m must be a number, is a number out of range"},
      {"plate.coarsenings", "99999999999999999999",
       "=99999999999999999999: plate.coarsenings must be an integer, is a number out of range"},
      {"plate.width_m", "-1", "=-1: plate.width_m is -1 m"},
      {"event.kind", "lft", "=lft: event.kind is \"lft\""},
      {"plate.width_m", "0.2\nheight_m = 3", "=0.2"},
      {"plate", "3", "=3: plate is a table"}};
  for (const auto& [key, value, error] : overrides)
    expect_message(parse_error("", {{key, value}}), std::string("--set ") + key + error);
}

TEST(Overrides, ChangeTheFrictionLaw) {
  const std::string file = "[friction]\nlaw = \"velocity_weakening\"\nmu_s = 1.3\nmu_k = 0.6";
  const Case c = parsed(file, {{"friction.mu", "0.75"}, {"friction.law", "coulomb"}});
  ASSERT_TRUE(c.friction.name() == "coulomb");
  EXPECT_EQ(c.friction.as<interface::Coulomb>().mu, 0.75);

  expect_message(parse_error(file, {{"friction.law", "coulomb"}, {"friction.mu_k", "1"}}),
                 "--set friction.mu_k=1: friction.mu_k belongs to the friction law slip_weakening");
  expect_message(parse_error(file + "\nmuk = 1", {{"friction.law", "coulomb"}}),
                 "c.toml:5: unknown key friction.muk; did you mean friction.mu_k of the friction law "
                 "slip_weakening?");
}

TEST(Entries, KeysAreUniqueAndDefaultsInRange) {
  std::set<std::string> keys;
  for (const Entry& entry : common_entries()) EXPECT_TRUE(keys.insert(entry.key).second) << entry.key;
  for (const Entry& entry : entries_of(Case{})) {
    const Value value = entry.get(Case{});
    if (const auto* number = std::get_if<double>(&value)) {
      EXPECT_TRUE(contains(entry.range, *number)) << entry.key;
    }
    if (const auto* integer = std::get_if<std::int64_t>(&value)) {
      EXPECT_TRUE(contains(entry.range, static_cast<double>(*integer))) << entry.key;
    }
  }
}

TEST(CaseFile, MessagesNameTheFile) {
  const test::TemporaryFolder folder;
  const auto file = folder / "my case.toml";
  const std::string missing = file.string() + ": cannot be read (No such file or directory)";
  expect_message(error_of([&] { read_case(file); }), missing);
  expect_message(error_of([&] { read_case(folder.path()); }), "", ": is a folder");
  test::write_file(file, "\xef\xbb\xbf# with a byte order mark\r\n[plate]\r\nwidth_m = -1\r\n");
  const std::string place = file.string() + ":3: plate.width_m is -1 m";
  expect_message(error_of([&] { read_case(file); }), place);
}

TEST(CaseFile, PlacesOfLaterErrors) {
  const test::TemporaryFolder folder;
  const auto file = folder / "c.toml";
  test::write_file(file, "title = \"x\"\n[plate]\n\nelement_size_m = 1e-3\n");
  const CaseFile plain(file);
  const Key element_size("plate.element_size_m"), width("plate.width_m");
  EXPECT_EQ(plain.with_place(UserError("{} is odd", width)).what(), file.string() + ": plate.width_m is odd");
  EXPECT_EQ(plain.with_place(UserError("no key in here")).what(), file.string() + ": no key in here");
  const CaseFile overridden(file, {{"plate.width_m", "3"}});
  std::filesystem::remove(file);  // what has been read is not read again
  // The text is not searched for keys.
  EXPECT_EQ(overridden.with_place(UserError("{} does not divide plate.width_m", element_size)).what(),
            file.string() + ":4: plate.element_size_m does not divide plate.width_m");
  EXPECT_STREQ(overridden.with_place(UserError("{} is odd", width)).what(),
               "--set plate.width_m=3: plate.width_m is odd");
  EXPECT_STREQ(overridden.with_place(UserError("{} does not divide {}", element_size, width)).what(),
               "--set plate.width_m=3: plate.element_size_m does not divide plate.width_m");
}

}  // namespace
}  // namespace slipfront::input
