// SPDX-License-Identifier: BSD-3-Clause
#include "papers/kammer2012/open_choices.hpp"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "files/checksum.hpp"
#include "input/schema.hpp"
#include "support/files.hpp"

namespace slipfront::kammer2012 {
namespace {

using test::TemporaryFolder;
using testing::Contains;
using testing::Each;

std::vector<double> standard_values(const std::vector<OpenChoice>& choices) {
  std::vector<double> values;
  for (const auto& choice : choices) values.push_back(choice.standard);
  return values;
}

std::size_t place_of(const std::vector<OpenChoice>& choices, std::string_view name) {
  return static_cast<std::size_t>(std::ranges::find(choices, name, &OpenChoice::name) - choices.begin());
}

TEST(OpenChoices, RangesHoldTheStandardAndGoBackAndForth) {
  for (const auto& choice : open_choices()) {
    SCOPED_TRACE(choice.name);
    EXPECT_TRUE(std::ranges::is_sorted(choice.levels));
    EXPECT_TRUE(choice.words.empty() || choice.words.size() == choice.levels.size());
    EXPECT_GE(choice.share_of(choice.standard), 0);
    EXPECT_LE(choice.share_of(choice.standard), 1);
    EXPECT_EQ(choice.at(0), choice.levels.front());
    EXPECT_NEAR(choice.share_of(choice.at(1)), 1, 1e-12);
    if (choice.is_continuous) {
      EXPECT_NEAR(choice.share_of(choice.at(0.3)), 0.3, 1e-12);
    } else {
      EXPECT_THAT(choice.levels, Contains(choice.standard));
    }
  }
}

TEST(OpenChoices, SetTheKeysThatTheyName) {
  const auto choices = open_choices();
  std::set<std::string> names;
  for (const auto& choice : choices) {
    SCOPED_TRACE(choice.name);
    EXPECT_TRUE(names.insert(choice.name).second);
    for (const double level : choice.levels) {
      input::Case changed, standard;
      changed.event = standard.event = choice.event.value_or(standard.event);
      if (choice.name.ends_with("_raised"))
        changed.trigger.form = standard.trigger.form = interface::TriggerForm::raised;
      choice.set(standard, choice.standard);
      choice.set(changed, level);
      const auto differing = input::to_toml(changed) != input::to_toml(standard);
      EXPECT_EQ(differing, level != choice.standard) << level;
      const auto key = choice.key.substr(choice.key.find('.') + 1);
      EXPECT_THAT(input::to_toml(changed), testing::HasSubstr(key));
    }
  }
}

TEST(OpenChoices, TriggersVaryAtOneEdgeAndRampsEndWithinTheirDuration) {
  const auto choices = open_choices();
  for (const auto edge : {interface::EventKind::left, interface::EventKind::right}) {
    const auto list = trigger_samples(choices, edge, {0, 512}, standard_values(choices));
    std::set<std::vector<double>> different;
    std::array<int, 2> n_ends{};
    for (const auto& sample : list) {
      different.insert(sample.values);
      for (std::size_t k = 0; k < choices.size(); ++k) {
        if (choices[k].event != edge) {
          EXPECT_EQ(sample.values[k], choices[k].standard) << choices[k].name;
          continue;
        }
        EXPECT_GE(sample.values[k], choices[k].levels.front()) << choices[k].name;
        EXPECT_LE(sample.values[k], choices[k].levels.back()) << choices[k].name;
        EXPECT_EQ(fmt::format("{:.2g}", sample.values[k]), fmt::format("{:.6g}", sample.values[k]));
      }
      const std::string name = edge == interface::EventKind::left ? "left" : "right";
      const auto value = [&](const char* choice) { return sample.values[place_of(choices, name + choice)]; };
      const bool is_held = value("_end") == 1;
      ++n_ends[is_held];
      if (!is_held && value("_form") != 2) {  // a weakened zone has neither
        EXPECT_LE(value("_ramp_s"), value("_duration_s"));
      }
    }
    EXPECT_EQ(different.size(), list.size());
    EXPECT_EQ(n_ends[0], n_ends[1]);
    const auto behind = trigger_samples(choices, edge, {500, 12}, standard_values(choices));
    for (std::size_t k = 0; k < behind.size(); ++k) EXPECT_EQ(behind[k].values, list[500 + k].values);
  }
}

TEST(OpenChoices, SpaceFillingReachesEveryTenthOfEveryRange) {
  const auto choices = open_choices();
  const auto list = samples_of_all(choices, 256);
  ASSERT_EQ(list.size(), 256U);
  for (std::size_t k = 0; k < choices.size(); ++k) {
    if (!choices[k].is_continuous || !choices[k].at_most.empty()) continue;
    std::array<int, 10> n{};
    for (const auto& sample : list)
      ++n[std::min(9, static_cast<int>(10 * choices[k].share_of(sample.values[k])))];
    EXPECT_THAT(n, Each(testing::AllOf(testing::Ge(23), testing::Le(28)))) << choices[k].name;
  }
}

TEST(OpenChoices, AChoiceCountsWhereAllThatDecideItDo) {
  const auto choices = open_choices();
  auto values = standard_values(choices);
  const auto set = [&](const char* name, double value) { values[place_of(choices, name)] = value; };
  const auto used = [&](const char* name) { return is_in_use(choices, place_of(choices, name), values); };
  EXPECT_TRUE(used("left_added") && used("left_ramp_s") && used("left_end"));
  EXPECT_FALSE(used("left_raised") || used("left_duration_s"));  // it is held
  set("left_end", 0);
  EXPECT_TRUE(used("left_duration_s"));
  set("left_form", 2);  // weakened
  EXPECT_FALSE(used("left_added") || used("left_ramp_s") || used("left_end") || used("left_duration_s"));
  EXPECT_TRUE(used("left_zone_m"));
}

/// Outcomes of left triggers, for which the constraining claims hold.
class Region : public testing::Test {
 protected:
  SampleOutcome& add(double form, double end, double zone_m, double duration_s = 5e-6) {
    auto& o = outcomes.emplace_back();
    o.sample = {Sample::Set::left_trigger, standard_values(choices)};
    o.sample.values[place_of(choices, "left_form")] = form;
    o.sample.values[place_of(choices, "left_end")] = end;
    o.sample.values[place_of(choices, "left_zone_m")] = zone_m;
    o.sample.values[place_of(choices, "left_duration_s")] = duration_s;
    o.others_hold = true;
    o.circle = Circle{.n_snapshots = 10, .n_apart = 8};
    return o;
  }
  TriggerRegion region() const { return region_of(choices, outcomes, interface::EventKind::left); }

  std::vector<OpenChoice> choices = open_choices();
  std::vector<SampleOutcome> outcomes;
};

TEST_F(Region, HasTheTriggersForWhichAllConstrainingClaimsHold) {
  EXPECT_FALSE(region().nearest_to_middle);
  add(0, 0, 5e-3).circle->n_apart = 7;
  add(0, 0, 5e-3).circle.reset();
  add(0, 0, 5e-3).others_hold = false;
  add(0, 0, 5e-3).sample.set = Sample::Set::right_trigger;
  EXPECT_THAT(region().all, testing::IsEmpty());
  add(0, 0, 5e-3);
  EXPECT_THAT(region().all, testing::ElementsAre(4));
  EXPECT_EQ(region().nearest_to_middle, 4U);
}

TEST_F(Region, IsChosenInTheMiddleOfItsMostFrequentFormAndEnd) {
  add(1, 0, 2e-3);  // raised
  for (const double zone_m : {4e-3, 2e-3, 16e-3, 2e-3, 20e-3}) add(0, 0, zone_m);
  add(0, 1, 4e-3), add(0, 1, 4e-3, 15e-6);  // held, whatever their duration
  EXPECT_THAT(region().all, testing::SizeIs(8));
  EXPECT_THAT(region().alike, testing::ElementsAre(1, 2, 3, 4, 5));
  EXPECT_EQ(region().nearest_to_middle, 1U);  // 4 mm is the median
  // Durations count by their logarithms: 0.5, 1, 1, 4 and 15 us, median 1.
  const auto duration = place_of(choices, "left_duration_s");
  const std::array durations_s = {15e-6, 1e-6, 4e-6, 0.5e-6, 1e-6};
  for (std::size_t k = 0; k < 5; ++k) outcomes[k + 1].sample.values[duration] = durations_s[k];
  EXPECT_EQ(region().nearest_to_middle,
            2U);  // 2 mm and 1 us: log 2 / log 10 off; 4 mm and 15 us: log 15 / log 30
}

TEST_F(Region, IsChosenAtTheRightAmongTriggersLikeTheLeftOne) {
  const auto add_right = [&](double right_form, double right_end) {
    auto& o = add(1, 0, 5e-3);  // raised at the left, and taken away
    o.sample.set = Sample::Set::right_trigger;
    o.sample.values[place_of(choices, "right_form")] = right_form;
    o.sample.values[place_of(choices, "right_end")] = right_end;
  };
  add_right(0, 0), add_right(0, 0), add_right(1, 1), add_right(2, 0), add_right(1, 0);
  const auto right = region_of(choices, outcomes, interface::EventKind::right);
  EXPECT_THAT(right.all, testing::SizeIs(5));
  EXPECT_THAT(right.alike, testing::ElementsAre(4));
  EXPECT_EQ(right.nearest_to_middle, 4U);
}

TEST_F(Region, EvidenceIsOfItAndOfHeldTriggersWithoutTheCircle) {
  OpenChoicesResult result;
  result.choices = choices;
  result.claims = {"C14", "C21"};
  const auto give = [](SampleOutcome& o, double spread) {
    o.spread_at_energy_rise = spread;
    o.distance = spread < 0.05 ? 1 : 1.5;
    o.difference_of_kinds = nan;
    o.holds = {spread < 0.1, std::nullopt};
  };
  give(add(0, 0, 5e-3), 0.04);
  give(add(0, 0, 6e-3), 0.06);
  give(add(1, 0, 5e-3), 0.12);
  for (const double form : {0.0, 2.0}) {  // a weakened zone has no end
    auto& held = add(form, 1, 5e-3);
    held.circle->n_apart = 0;
    give(held, 0.2);
  }
  auto& brief = add(0, 0, 5e-3);
  brief.circle->n_apart = 0;
  give(brief, 0.9);
  result.outcomes = outcomes;
  const auto groups = evidence(result);
  ASSERT_EQ(groups.size(), 2U);
  EXPECT_EQ(groups[0].n, 3U);
  EXPECT_EQ(groups[1].n, 1U);
  EXPECT_EQ(groups[1].spread_at_energy_rise.median, 0.2);
  const auto& region = groups[0];
  EXPECT_EQ(region.n_paper_fit_in_intervals, 1U);
  EXPECT_EQ(region.spread_at_energy_rise.least, 0.04);
  EXPECT_EQ(region.spread_at_energy_rise.median, 0.06);
  EXPECT_EQ(region.spread_at_energy_rise.largest, 0.12);
  EXPECT_TRUE(std::isnan(region.difference_of_kinds.median));
  ASSERT_EQ(region.shares.size(), 1U);  // C21 was not tested
  EXPECT_EQ(region.shares[0].claim, "C14");
  EXPECT_EQ(region.shares[0].n_tested, 3U);
  EXPECT_EQ(region.shares[0].n_holding, 2U);
}

TEST(OpenChoices, AStudyIsTheSameForAnyNumberOfThreadsAndBeginsWithTheStandard) {
  const auto go_on = [](std::size_t, std::size_t) { return true; };
  const auto once = study_open_choices({.quick = true, .threads = 1, .kept = {}}, go_on);
  const auto again = study_open_choices({.quick = true, .threads = 2, .kept = {}}, go_on);
  // The default, four triggers at each edge, four of all choices; more where triggers were chosen.
  ASSERT_GE(once.outcomes.size() + once.n_impossible, 13U);
  EXPECT_EQ(once.counts.n_runs, again.counts.n_runs);
  EXPECT_EQ(once.triggers.n_triggers, 4);
  EXPECT_EQ(once.triggers.n_holding, again.triggers.n_holding);
  const TemporaryFolder a, b;
  write_open_choices(a.path(), once);
  write_open_choices(b.path(), again);
  for (const char* name : {"open_choices.csv", "open_choices.json"})
    EXPECT_EQ(test::read_file(a / name), test::read_file(b / name)) << name;

  const auto& standard = once.outcomes.front();
  EXPECT_EQ(standard.sample.set, Sample::Set::standard);
  EXPECT_EQ(once.chosen().has_value(), !once.left.all.empty());
  for (const auto place : once.left.all) EXPECT_TRUE(once.outcomes[place].is_constrained());
  const auto json = nlohmann::json::parse(test::read_file(a / "open_choices.json"));
  EXPECT_EQ(json["n_runs"], once.counts.n_runs);
  EXPECT_EQ(json["choices"].size(), once.choices.size());
  EXPECT_EQ(std::ranges::count(test::read_file(a / "open_choices.csv"), '\n'), 1 + std::ssize(once.outcomes));
}

TEST(OpenChoices, TriggersAreReadFromTheFolderOfAStudy) {
  const TemporaryFolder folder;
  const auto error = [&](bool quick = false) {
    return test::error_of([&] { read_trigger_sample(folder.path(), quick); });
  };
  const auto seal = [&] {
    files::write_checksums(folder.path(),
                           {{"open_choices.json", files::sha256_of_file(folder / "open_choices.json")}});
  };
  EXPECT_THAT(error(), testing::HasSubstr("slipfront study open-choices"));
  OpenChoicesResult result;
  result.choices = open_choices();
  result.triggers = {.n_triggers = 7, .n_holding = 3};
  result.outcomes.emplace_back().sample.values = standard_values(result.choices);
  write_open_choices(folder.path(), result);
  EXPECT_THAT(error(), testing::HasSubstr("holds no checksums.sha256"));
  seal();
  EXPECT_THAT(error(true), testing::HasSubstr("is a full study"));
  std::filesystem::create_directory(folder / "publishing");  // a newer set whose publication was cut off
  std::filesystem::copy(folder / "checksums.sha256", folder / "publishing/checksums.sha256");
  EXPECT_THAT(error(), testing::HasSubstr("still on their way"));
  std::filesystem::remove_all(folder / "publishing");
  const auto triggers = read_trigger_sample(folder.path(), false);
  EXPECT_EQ(triggers.n_triggers, 7);
  EXPECT_EQ(triggers.n_holding, 3);
  for (const char* text : {"", "[]", "{}", "{\"n_triggers\": -1}", "{\"n_triggers\": 1e300}"}) {
    test::write_file(folder / "open_choices.json", text);
    EXPECT_THAT(error(), testing::HasSubstr("was changed or damaged")) << text;
    seal();
    EXPECT_THAT(error(), testing::HasSubstr("n_triggers")) << text;
  }
  for (const char* counts : {"0, \"n_triggers_slow_left\": 0", "4, \"n_triggers_slow_left\": 5"}) {
    test::write_file(folder / "open_choices.json", fmt::format("{{\"n_triggers\": {}}}", counts));
    seal();
    EXPECT_THAT(error(), testing::HasSubstr("cannot be")) << counts;
  }
}

TEST(OpenChoices, SamplesAboutAnotherChangeOneChoiceOrOneWithTheWordThatLetsItCount) {
  const auto choices = open_choices();
  const auto values = standard_values(choices);  // held: durations come with an end
  const auto list = samples_about(choices, values);
  std::set<std::size_t> changed_choices;
  for (const auto& sample : list) {
    std::vector<std::size_t> changed;
    for (std::size_t k = 0; k < choices.size(); ++k)
      if (sample.values[k] != values[k]) changed.push_back(k);
    ASSERT_FALSE(changed.empty());
    ASSERT_LE(changed.size(), 2U);
    if (changed.size() == 2) {
      EXPECT_THAT(choices[changed.front()].name,
                  testing::AnyOf(testing::EndsWith("_form"), testing::EndsWith("_end")));
    }
    changed_choices.insert(changed.back());
  }
  EXPECT_EQ(changed_choices.size(), choices.size());
}

TEST(OpenChoices, SamplesAboutABriefTriggerHaveNoRampBeyondItsEnd) {
  const auto choices = open_choices();
  auto values = standard_values(choices);
  values[place_of(choices, "left_end")] = 0;
  values[place_of(choices, "left_duration_s")] = 2e-6;
  values[place_of(choices, "left_ramp_s")] = 1e-6;
  for (const auto& sample : samples_about(choices, values))
    if (sample.values[place_of(choices, "left_end")] == 0 &&
        sample.values[place_of(choices, "left_form")] != 2) {
      EXPECT_LE(sample.values[place_of(choices, "left_ramp_s")],
                sample.values[place_of(choices, "left_duration_s")]);
    }
}

TEST(OpenChoices, CanBeInterrupted) {
  const TemporaryFolder folder;
  const OpenChoicesOptions options{.quick = true, .threads = 1, .kept = folder / "runs"};
  EXPECT_THROW(study_open_choices(options, [](std::size_t done, std::size_t) { return done < 3; }),
               Interrupted);
  std::size_t least = 1000;
  study_open_choices(options, [&](std::size_t done, std::size_t) {
    least = std::min(least, done);
    return true;
  });
  EXPECT_EQ(least, 3U);  // it goes on behind those that were done
}

}  // namespace
}  // namespace slipfront::kammer2012
