// SPDX-License-Identifier: BSD-3-Clause
#include "input/relations.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "input/entries.hpp"
#include "input/schema.hpp"

namespace slipfront::input {
namespace {

/// A case whose keys do not fit together. The line to be named ends with "# here"; where none does, it is the
/// last override.
struct Contradiction {
  const char* name;
  std::string text;
  std::vector<Override> overrides = {};
};
const std::string uniform_tractions =
    "[prestress]\nt_Pa = 1e6\np_Pa = 5e6\n[loading]\nmethod = \"prestress\"\n";
const std::string at_rest = uniform_tractions + "[event]\nkind = \"none\"\n";
const std::string patch = uniform_tractions + "[event]\nkind = \"nucleation\"\n[nucleation]\nx_m = 0.1\n";
const std::string dead_load = "[loading]\nnormal_stiffness_Pa_per_m = 0\n";
const std::string on_steel =
    "[base]\nkind = \"body\"\nheight_m = 0.1\nyoungs_modulus_Pa = 2e11\npoissons_ratio = 0.3\n"
    "density_kg_per_m3 = 7800\nstiffness_damping_s = 1e-7\n";
const std::string square = "[plate]\ncorner = \"none\"\n";

const Contradiction wrong_cases[] = {
    // Friction
    {"FrictionTable", "[friction]\nlaw = \"slip_table\"\ntable_mu = [0.6, 0.3] # here\n"},
    {"FrictionTableOverridden",
     "[friction]\nlaw = \"slip_table\"\n",
     {{"friction.table_slip_m", "[0, 1e-6]"}}},
    {"CohesionUnderATilt", "[friction]\ncohesion_Pa = 1e4 # here\n"},
    {"StateGivenUnderATilt", "[friction]\nlaw = \"rate_and_state_aging\"\ntheta_i_s = 1 # here\n"},
    {"StateSlipRateAndTraction",
     at_rest + square + "[friction]\nlaw = \"rate_and_state_aging\"\nV_i_m_per_s = 1e-9\n",
     {{"friction.theta_i_s", "1"}}},
    {"ForcedPatchWithoutASpeed", patch + square, {{"nucleation.form", "forced"}}},
    {"StateAndTractionWithoutASlipRate",
     at_rest + square + "[friction]\nlaw = \"rate_and_state_aging\"\ntheta_i_s = 1e12 # here\n"},
    {"RandomKey", "[friction]\nlaw = \"coulomb\"\nrandom_key = \"mu_k\" # here\n"},
    {"RandomKeyOfAnotherLaw", "[friction]\nrandom_key = \"mu_k\"\n", {{"friction.law", "coulomb"}}},
    {"RegularisationWithoutScale", "[friction]\nregularisation = \"strength\" # here\n"},
    {"RegularisationWithoutItsScale",
     "[friction]\nregularisation = \"strength\"\nrelaxation_time_s = 1e-6\n",
     {{"friction.relaxation_time_s", "inf"}}},
    {"SlipRateWithoutLength",
     "[friction]\nregularisation = \"strength\"\nrelaxation_time_s = 1e-6\n"
     "relaxation_slip_rate_m_per_s = 0.1 # here\n"},
    // Plate
    {"Nodes", "[plate]\nwidth_m = 0.2\nelement_size_m = 1e-7 # here\n"},
    {"NodesOfAWidePlate", "[plate]\nelement_size_m = 1e-3\n", {{"plate.width_m", "1e6"}}},
    {"NodesOfAHighPlate", "[plate]\nheight_m = 1e6 # here\n"},
    {"NodesOfARow", at_rest + square + "width_m = 3e6\nelement_size_m = 1e-3 # here\n"},
    {"NodesOfAColumn", at_rest + square + "element_size_m = 1e-3 # here\nheight_m = 3e6\n"},
    {"NodesUnderATilt", square + "width_m = 100\nheight_m = 100\nelement_size_m = 1e-3 # here\n"},
    {"NodesOfAGradedPlate",
     at_rest + square + "coarsenings = 1\nwidth_m = 100\nheight_m = 100\nelement_size_m = 1e-3 # here\n"},
    {"Element", "[plate]\nwidth_m = 3\n\nelement_size_m = 0.2 # here\n"},
    {"ElementOfALowerPlate", "[plate]\nelement_size_m = 1e-2\n", {{"plate.height_m", "1e-3"}}},
    // Loading
    {"TopHeld", "[loading]\nmethod = \"ramp\"\nshear_speed_m_per_s = 0 # here\n"},
    {"TopHeldByTheMethod", uniform_tractions + "shear_speed_m_per_s = 0\n", {{"loading.method", "direct"}}},
    {"NoTractions", "[loading]\nmethod = \"prestress\" # here\n[prestress]\nt_Pa = 1e6\n"},
    {"Relief", at_rest + "[plate]\ncorner = \"relief\" # here\n"},
    {"SpontaneousEvent", uniform_tractions + "[event]\nkind = \"spontaneous\" # here\n" + square},
    {"PeriodicEdge",
     uniform_tractions + "[event]\nkind = \"left\" # here\n" + square + "sides = \"periodic\"\n"},
    {"EdgeMadePeriodic",
     uniform_tractions + "[event]\nkind = \"left\"\n" + square,
     {{"plate.sides", "periodic"}}},
    {"Tilt", "[loading]\ntilt_left_m = 0.1 # here\n"},
    {"TiltOfALowerPlate", "[plate]\nelement_size_m = 1e-4\nheight_m = 1e-4 # here\n"},
    {"TiltWithAForce", "[loading]\nmean_pressure_Pa = 1e6\ntilt_difference_m = -0.1 # here\n"},
    {"FewerPressures", dead_load + "pressures_x_m = [0, 0.1] # here\npressures_Pa = [1e6]\n"},
    {"PressuresBackwards", dead_load + "pressures_x_m = [0.1, 0.1] # here\npressures_Pa = [1e6, 2e6]\n"},
    {"PressureBeyondTheEdge", dead_load + "pressures_x_m = [0, 0.5] # here\npressures_Pa = [1e6, 2e6]\n"},
    {"PressuresOfZero", dead_load + "pressures_x_m = [0, 0.1]\npressures_Pa = [0, 0] # here\n"},
    {"TiltBesidePressures",
     dead_load + "pressures_x_m = [0, 0.1]\npressures_Pa = [1e6, 2e6]\ntilt_left_m = 1e-4 # here\n"},
    {"PressuresWithoutADeadLoad",
     dead_load + "pressures_x_m = [0, 0.1]\npressures_Pa = [1e6, 2e6] # here\n",
     {{"loading.normal_stiffness_Pa_per_m", "1e9"}}},
    {"PressuresOfARamp",
     dead_load + "pressures_x_m = [0, 0.1]\npressures_Pa = [1e6, 2e6] # here\n",
     {{"loading.method", "ramp"}}},
    {"EdgeMargin", "[plate]\nwidth_m = 0.2\n[loading]\nedge_margin_m = 0.1 # here\n"},
    {"EdgeMarginOfANarrowPlate", "[loading]\nedge_margin_m = 0.05\n", {{"plate.width_m", "0.1"}}},
    {"TriggerZone", "[event]\nkind = \"left\"\ntrigger_zone_m = 0.3 # here\n"},
    {"GradedIteratively", "[plate]\ncoarsenings = 1\n[loading]\nsolver = \"iterative\" # here\n"},
    {"IterativelyGraded", "[loading]\nsolver = \"iterative\"\n", {{"plate.coarsenings", "1"}}},
    {"SlenderIteratively",
     "[plate]\nheight_m = 2\nwidth_m = 0.02\n[loading]\nsolver = \"iterative\" # here\nedge_margin_m = "
     "1e-3\n"},
    // Base
    {"PeriodicBase", on_steel + "sides = \"periodic\" # here\n"},
    {"FilletOnABase", on_steel + "[plate]\ncorner = \"fillet\" # here\n"},
    {"GradedBaseIteratively",
     on_steel + "coarsenings = 1\nfine_height_m = 0.02\n[loading]\nsolver = \"iterative\" # here\n"},
    {"HighBaseIteratively",
     on_steel + "[plate]\nwidth_m = 0.006\nelement_size_m = 1e-3\n[loading]\nsolver = \"iterative\" # "
                "here\nedge_margin_m = 1e-3\n"},
    // Start of the event
    {"TriggerOfCoulomb",
     "[friction]\nlaw = \"coulomb\"\n[event]\nkind = \"left\"\ntrigger_form = \"weakened\" # here\n"},
    {"TriggerWithoutWeakening",
     "[event]\nkind = \"left\"\ntrigger_form = \"weakened\"\n",
     {{"friction.law", "coulomb"}}},
    {"PatchOfCoulomb", "[friction]\nlaw = \"coulomb\"\n[event]\nkind = \"nucleation\" # here\n"},
    {"PatchBeyondThePlate", "[event]\nkind = \"nucleation\"\n[nucleation]\nx_m = 0.3 # here\n"},
    {"PlateBesideThePatch", patch + square, {{"plate.width_m", "0.09"}}},
    {"PatchWithoutLength", patch + "taper_m = 0\nhalf_length_m = 0 # here\n" + square},
    {"PatchOnARing", patch + "taper_m = 0.15 # here\n" + square + "sides = \"periodic\"\n"},
    // Time, fronts, output
    {"Step", "[time]\nstep_factor = 1.5 # here\n"},
    {"StepNoLongerAllowed",
     "[time]\nstep_factor = 1.5\nallow_unstable = true\n",
     {{"time.allow_unstable", "false"}}},
    {"Duration", "[time]\nend_s = 1e6 # here\n"},
    {"FrontSpeed", "[plate]\nwidth_m = 0.2\n[fronts]\nl_star_m = 1 # here\n"},
    {"PulseShare", "[fronts]\ncrack_share = 0.4\npulse_share = 0.9 # here\n"},
    {"PulseShareAboveACrackShare", "[fronts]\npulse_share = 0.1\n", {{"fronts.crack_share", "0.05"}}},
    {"SnapshotTimes", "[output]\nsnapshot_times_s = [2e-5, 1e-5] # here\n"},
    {"Magnitude", "[material]\nyoungs_modulus_Pa = 1e150 # here\n"},
    {"MagnitudeInAList", "[output]\nsnapshot_times_s = [1e-300] # here\n"},
};

std::string place_in(const Contradiction& wrong) {
  const auto mark = wrong.text.find("# here");
  if (mark != std::string::npos)
    return fmt::format("c.toml:{}", 1 + std::count(wrong.text.begin(), wrong.text.begin() + mark, '\n'));
  const auto& [key, value] = wrong.overrides.back();
  return fmt::format("--set {}={}", key, value);
}

bool is_in_schema(const std::string& key) {
  const auto among = [&](const std::vector<Entry>& entries) {
    return std::ranges::count(entries, key, &Entry::key) > 0;
  };
  return among(common_entries()) ||
         std::ranges::any_of(friction_laws(), [&](const LawEntries& law) { return among(law.entries); });
}

/// A plate as thin as the default tilt is none that a case could press down.
TEST(Relations, AreNotAskedOfTablesAlone) {
  const std::vector<Override> small = {{"plate.width_m", "4e-4"},
                                       {"plate.height_m", "2e-4"},
                                       {"plate.element_size_m", "1e-5"},
                                       {"plate.corner", "relief"}};
  EXPECT_THROW(parse_case("", "c.toml", small), UserError);
  const auto tables = parse_tables(small);
  EXPECT_EQ(tables.plate.height_m, 2e-4);
  EXPECT_EQ(tables.plate.relief_length_m, 1e-5);  // by the width's rule
  EXPECT_THROW(parse_tables({{"plate.width_m", "4e-4"}, {"plate.element_size_m", "1e-3"}}), UserError);
  EXPECT_THROW(parse_tables({{"friction.law", "slip_table"}, {"friction.table_mu", "[1, 0]"}}), UserError);
}

TEST(Relations, AreRefusedWithThePlaceAndTheKeysAtFault) {
  for (const auto& wrong : wrong_cases) {
    SCOPED_TRACE(wrong.name);
    try {
      parse_case(wrong.text, "c.toml", wrong.overrides);
      ADD_FAILURE() << "the case was accepted";
    } catch (const UserError& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with(place_in(wrong) + ": ")) << error.what();
      EXPECT_FALSE(error.keys().empty()) << error.what();
      for (const auto& key : error.keys()) EXPECT_TRUE(is_in_schema(key)) << key;
    }
  }
}

}  // namespace
}  // namespace slipfront::input
