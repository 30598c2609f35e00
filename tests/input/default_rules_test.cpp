// SPDX-License-Identifier: BSD-3-Clause
#include "input/default_rules.hpp"

#include <gtest/gtest.h>

#include "input/entries.hpp"
#include "messages.hpp"

namespace slipfront::input {
namespace {

/// To the last bit.
std::string value_of(const Case& config, const std::string& key) {
  for (const Entry& entry : common_entries())
    if (entry.key == key) return toml_text(entry.get(config));
  ADD_FAILURE() << key;
  return {};
}

TEST(DefaultRules, GiveTheDefaultCaseItsNumbersToTheLastBit) {
  const Case by_default;
  for (const auto& rule : default_rules())
    EXPECT_EQ(toml_text(rule.value(by_default)), value_of(by_default, rule.key)) << rule.key;
}

TEST(DefaultRules, ABaseIsLikeThePlate) {
  const std::string text =
      "[plate]\nheight_m = 0.2\nsides = 'absorbing'\ntop = 'absorbing'\n[material]\nyoungs_modulus_Pa = "
      "2e11\n"
      "poissons_ratio = 0.3\ndensity_kg_per_m3 = 7800\nstiffness_damping_s = 3e-7\n"
      "[loading]\nmethod = 'prestress'\n[prestress]\nt_Pa = 1\np_Pa = 1\n[event]\nkind = 'none'\n[base]\n";
  const Case c = parsed(text);
  EXPECT_EQ(c.base.plate.height_m, 0.2);
  EXPECT_EQ(c.base.material.youngs_modulus_Pa, 2e11);
  EXPECT_EQ(c.base.material.poissons_ratio, 0.3);
  EXPECT_EQ(c.base.material.density_kg_per_m3, 7800);
  EXPECT_EQ(c.base.plate.sides, mesh::Sides::absorbing);
  EXPECT_EQ(c.base.plate.top, mesh::Top::absorbing);
  EXPECT_EQ(c.base.material.stiffness_damping_s, 3e-7);
  const Case other = parsed(text + "sides = 'free'\nbottom = 'held'\nstiffness_damping_s = 0\n");
  EXPECT_EQ(other.base.plate.sides, mesh::Sides::free);
  EXPECT_EQ(other.base.plate.top, mesh::Top::loaded);
  EXPECT_EQ(other.base.material.stiffness_damping_s, 0);
}

TEST(DefaultRules, ScaleWithThePlate) {
  const Case c = parsed("event.kind = 'left'\n[plate]\nwidth_m = 0.2\nheight_m = 0.15\ncorner = 'relief'\n");
  const Case by_default;
  EXPECT_EQ(c.plate.element_size_m, 2 * by_default.plate.element_size_m);
  EXPECT_EQ(c.trigger.zone_m, 2 * by_default.trigger.zone_m);
  EXPECT_EQ(c.loading.edge_margin_m, 2 * by_default.loading.edge_margin_m);
  EXPECT_EQ(c.fronts.min_length_m, 2 * by_default.fronts.min_length_m);
  EXPECT_DOUBLE_EQ(c.time.end_s, 2 * by_default.time.end_s);
  EXPECT_NEAR(c.plate.relief_depth_m / by_default.plate.relief_depth_m, 3, 1e-12);
}

TEST(DefaultRules, TimesScaleWithTheWavesOfTheSlowerBody) {
  const Case by_default;
  const Case stiff = parsed("[material]\nyoungs_modulus_Pa = 10.4e9\n");
  EXPECT_NEAR(stiff.time.end_s / by_default.time.end_s, 0.5, 1e-12);
  EXPECT_NEAR(stiff.material.stiffness_damping_s / by_default.material.stiffness_damping_s, 0.5, 1e-12);
  const std::string on_pmma = "[material]\nyoungs_modulus_Pa = 10.4e9\n[base]\nyoungs_modulus_Pa = 2.6e9\n";
  EXPECT_EQ(parsed(on_pmma).time.end_s, by_default.time.end_s);
}

TEST(DefaultRules, DampingFollowsTheMeshAndIsMoreWhereBodiesDiffer) {
  // 2 % of a process zone of three elements.
  const auto over_h = [](const Case& c) {
    return c.material.stiffness_damping_s * solid::longitudinal_speed_m_per_s(c.material) /
           c.plate.element_size_m;
  };
  for (const char* text :
       {"", "plate.width_m = 0.4", "plate.element_size_m = 1e-3", "material.youngs_modulus_Pa = 50e9"})
    EXPECT_NEAR(over_h(parsed(text)), 0.06, 1e-5) << text;
  const Case rigid = parsed("base.kind = 'rigid'"), unlike = parsed("base.youngs_modulus_Pa = 1e9");
  EXPECT_DOUBLE_EQ(rigid.material.stiffness_damping_s,
                   0.1 * rigid.plate.element_size_m / solid::shear_speed_m_per_s(rigid.material));
  EXPECT_DOUBLE_EQ(unlike.material.stiffness_damping_s,
                   0.1 * unlike.plate.element_size_m / solid::shear_speed_m_per_s(base_material(unlike)));
  EXPECT_EQ(unlike.base.material.stiffness_damping_s, unlike.material.stiffness_damping_s);
}

TEST(DefaultRules, AKeyThatIsSetKeepsItsValue) {
  const Case c = parsed("[plate]\nwidth_m = 0.4\n[time]\nend_s = 1e-4\n", {{"fronts.arrest_time_s", "3e-5"}});
  EXPECT_EQ(c.time.end_s, 1e-4);
  EXPECT_EQ(c.fronts.arrest_time_s, 3e-5);
}

TEST(DefaultRules, SpeedsAreTakenOverNoLessThanAnElement) {
  EXPECT_EQ(parsed("[plate]\nelement_size_m = 5e-3\n").fronts.l_star_m, 5e-3);
  EXPECT_EQ(parsed("[plate]\nelement_size_m = 2.5e-4\n").fronts.l_star_m, 0.335e-3);
}

TEST(DefaultRules, PrescribedTractionsAreAllTheLoad) {
  const std::string text =
      "[plate]\ncorner = 'none'\n[loading]\nmethod = 'prestress'\n[prestress]\nt_Pa = 1\np_Pa = 1\n"
      "[event]\nkind = 'nucleation'\n";
  EXPECT_EQ(parsed(text).loading.shear_speed_m_per_s, 0);
  EXPECT_EQ(parsed(text, {{"loading.shear_speed_m_per_s", "1e-6"}}).loading.shear_speed_m_per_s, 1e-6);
}

}  // namespace
}  // namespace slipfront::input
