// SPDX-License-Identifier: BSD-3-Clause
#include "papers/kammer2012/cases.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "input/schema.hpp"
#include "interface/friction/velocity_weakening.hpp"

namespace slipfront::kammer2012 {
namespace {

using testing::ElementsAre;

const std::filesystem::path case_folder = std::filesystem::path(SLIPFRONT_SOURCE_DIR) / "papers/kammer2012";

const Study& find(const std::vector<Study>& list, const std::string& name) {
  return *std::ranges::find(list, name, &Study::name);
}

std::string leaf_of(const std::string& key) {
  return key.substr(key.rfind('.') + 1);
}

TEST(PaperCases, AreTheCaseFiles) {
  std::set<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(case_folder))
    if (entry.path().extension() == ".toml") files.insert(entry.path().stem().string());
  std::set<std::string> known;
  for (const auto& c : paper_cases(false)) {
    known.insert(c.name);
    const auto file = case_folder / (c.name + ".toml");
    EXPECT_EQ(input::to_toml(input::read_case(file)), input::to_toml(c.config)) << file;
  }
  EXPECT_EQ(known, files);
}

TEST(PaperCases, HaveTable1) {
  // Kammer et al. (2012), Table 1 and "Model set-up".
  for (const auto& [name, c] : paper_cases(false)) {
    EXPECT_EQ(c.plate.width_m, 0.2);
    EXPECT_EQ(c.plate.height_m, 0.1);
    EXPECT_NEAR(c.plate.element_size_m, 0.67e-3, 0.005e-3);
    EXPECT_EQ(c.material.youngs_modulus_Pa, 2.6e9);
    EXPECT_EQ(c.material.poissons_ratio, 0.37);
    EXPECT_EQ(c.material.density_kg_per_m3, 1200);
    EXPECT_EQ(c.material.plane, solid::Plane::stress);
    EXPECT_EQ(c.material.stiffness_damping_s, 0.1e-6);
    EXPECT_EQ(c.loading.tilt_left_m, 0.37e-3);
    EXPECT_EQ(c.loading.tilt_right_m, 0.037e-3);
    EXPECT_EQ(c.loading.shear_speed_over_c_L, 1e-6);
    EXPECT_EQ(c.fronts.l_star_m, 0.67e-3);
    const auto law = c.friction.as<interface::VelocityWeakening>();
    EXPECT_EQ(law.mu_s, 1.3);
    EXPECT_EQ(law.mu_k, name == "spontaneous_mu_k_1.0" ? 1.0 : 0.6);
    EXPECT_EQ(law.alpha_m2_per_s2, 0.1);
  }
}

TEST(PaperCases, QuickOnesDifferInTheMeshAlone) {
  const auto full = paper_cases(false);
  auto quick = paper_cases(true);
  ASSERT_EQ(full.size(), quick.size());
  for (std::size_t k = 0; k < full.size(); ++k) {
    EXPECT_DOUBLE_EQ(quick[k].config.plate.element_size_m, 2e-3);
    quick[k].config.plate.element_size_m = full[k].config.plate.element_size_m;
    EXPECT_EQ(input::to_toml(quick[k].config), input::to_toml(full[k].config));
    EXPECT_EQ(quick[k].name, full[k].name);
  }
}

TEST(Studies, HaveTheScorecardsValues) {
  const std::map<std::string, std::vector<double>> expected = {{"mu_k", {0.4, 0.6, 0.8, 1.0, 1.1, 1.2}},
                                                               {"alpha", {0.01, 0.03, 0.1, 0.3, 1}}};
  std::size_t n_found = 0;
  for (const auto& study : studies(false)) {
    if (!expected.contains(study.name)) continue;
    ++n_found;
    std::vector<double> numbers;
    for (const auto& point : study.points) {
      numbers.push_back(point.number);
      std::set<std::string> names;
      for (const auto& c : point.cases) names.insert(c.name);
      EXPECT_THAT(names, ElementsAre("left", "right", "spontaneous")) << study.name;
    }
    EXPECT_EQ(numbers, expected.at(study.name));
  }
  EXPECT_EQ(n_found, expected.size());
}

/// Line of a key in the resolved case.
std::string line_of(const std::string& toml, const std::string& leaf) {
  const auto begin = toml.find("\n" + leaf + " = ");
  EXPECT_NE(begin, std::string::npos) << leaf;
  return toml.substr(begin, toml.find('\n', begin + 1) - begin);
}

std::string without(std::string toml, const std::string& leaf) {
  const auto line = line_of(toml, leaf);
  return toml.erase(toml.find(line), line.size());
}

TEST(Studies, ChangeOneParameterOfThePapersRuns) {
  const auto paper = paper_cases(false);
  for (const bool quick : {false, true})
    for (const auto& study : studies(quick)) {
      SCOPED_TRACE(study.name);
      const bool is_of_papers =
          !quick && !study.own_reference && study.key != "loading.method" && study.key != "plate.corner";
      std::set<std::string> values;
      for (const auto& point : study.points) {
        SCOPED_TRACE(point.value);
        ASSERT_FALSE(point.cases.empty());
        EXPECT_TRUE(values.insert(point.value).second);
        if (study.name == "corner") continue;  // its values name two keys
        for (const auto& c : point.cases) {
          const auto line = line_of(input::to_toml(c.config), leaf_of(study.key));
          const auto text = line.substr(line.find('=') + 2, line.find("  #") - line.find('=') - 2);
          if (std::isnan(point.number))
            EXPECT_EQ(text, '"' + point.value + '"');
          else
            EXPECT_DOUBLE_EQ(std::stod(text), point.number);
          if (!is_of_papers) continue;
          // All but the one key, and what is written besides the fronts.
          const auto reference = std::ranges::find(paper, c.name, &NamedCase::name);
          ASSERT_NE(reference, paper.end()) << c.name;
          auto ours = c.config, theirs = reference->config;
          ours.title = theirs.title;
          ours.output = theirs.output;
          EXPECT_EQ(without(input::to_toml(ours), leaf_of(study.key)),
                    without(input::to_toml(theirs), leaf_of(study.key)));
        }
      }
    }
}

/// Every case of a variation in the order of the paper's runs, and those.
std::vector<std::pair<input::Case, input::Case>> pairs_of(const Variation& variation, bool quick) {
  std::vector<std::pair<input::Case, input::Case>> list;
  const auto events = paper_cases(quick);
  for (std::size_t k = 0; k < events.size(); ++k) {
    list.emplace_back(variation.events[k].config, events[k].config);
    auto& own = list.back().second;
    if (own.event != interface::EventKind::left) own.output.snapshot_times_s.clear();
  }
  const auto all = studies(quick);
  for (const auto& study : variation.studies) {
    const auto& own = find(all, study.name);
    for (std::size_t k = 0; k < own.points.size(); ++k)
      for (std::size_t j = 0; j < own.points[k].cases.size(); ++j)
        list.emplace_back(study.points[k].cases[j].config, own.points[k].cases[j].config);
  }
  return list;
}

TEST(Variations, DifferFromTheRunsOfTheScorecardInOneParameter) {
  for (const bool quick : {false, true}) {
    const auto list = variations(quick);
    ASSERT_EQ(list.size(), 2U);
    for (const auto& variation : list) {
      ASSERT_EQ(variation.events.size(), paper_cases(quick).size());
      std::vector<std::string> names;
      for (const auto& study : variation.studies) names.push_back(study.name);
      EXPECT_THAT(names, ElementsAre("mu_k", "alpha"));
      for (auto& [varied, own] : pairs_of(variation, quick)) {
        input::Case expected = own;
        expected.title = varied.title;
        if (variation.name == "mesh")
          expected.plate.element_size_m = variation.value;
        else
          expected.time.interface_substeps = static_cast<int>(variation.value);
        EXPECT_EQ(input::to_toml(varied), input::to_toml(expected));
        EXPECT_NE(input::to_toml(varied), input::to_toml(own));
      }
    }
    EXPECT_EQ(list[0].key, "plate.element_size_m");
    EXPECT_EQ(list[0].value, quick ? 4e-3 : 1e-3);
    EXPECT_EQ(list[1].key, "time.interface_substeps");
    EXPECT_EQ(list[1].value, 9);
  }
}

}  // namespace
}  // namespace slipfront::kammer2012
