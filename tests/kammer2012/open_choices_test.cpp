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

std::size_t n_changed(const std::vector<OpenChoice>& choices, const Sample& sample) {
  std::size_t n = 0;
  for (std::size_t k = 0; k < choices.size(); ++k) n += sample.values[k] != choices[k].standard ? 1 : 0;
  return n;
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
    if (choice.between != OpenChoice::Between::nothing) {
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

TEST(OpenChoices, SamplesAreWhatTheirSetSays) {
  const auto choices = open_choices();
  std::map<Sample::Set, std::size_t> n;
  std::set<std::vector<double>> different;
  for (const auto& sample : samples(choices, false)) {
    ++n[sample.set];
    different.insert(sample.values);
    ASSERT_EQ(sample.values.size(), choices.size());
    const auto changed = n_changed(choices, sample);
    if (sample.set == Sample::Set::one_at_a_time) {
      EXPECT_THAT(changed, testing::AnyOf(1U, 2U));
    }
    if (sample.set == Sample::Set::standard || sample.set == Sample::Set::pairs) {
      EXPECT_EQ(changed, sample.set == Sample::Set::pairs ? 2U : 0U);
    }
    if (sample.set == Sample::Set::left_trigger) {
      const auto value = [&](const char* name) { return sample.values[place_of(choices, name)]; };
      EXPECT_NE(choices.front().text(value("left_form")), "weakened");
      EXPECT_GE(value("left_zone_m"), 10e-3);
      EXPECT_GE(value("left_added"), 5);
      EXPECT_GE(value("left_raised"), 2);
    }
    for (std::size_t k = 0; k < choices.size(); ++k) {
      const auto& choice = choices[k];
      const double value = sample.values[k];
      if ((sample.set == Sample::Set::left_trigger && choice.event != interface::EventKind::left) ||
          (sample.set == Sample::Set::triggers && !choice.event)) {
        EXPECT_EQ(value, choice.standard) << choice.name;
      }
      EXPECT_GE(value, choice.levels.front()) << choice.name;
      EXPECT_LE(value, choice.levels.back()) << choice.name;
    }
  }
  EXPECT_EQ(n[Sample::Set::standard], 1U);
  EXPECT_EQ(n[Sample::Set::triggers], 512U);
  EXPECT_EQ(n[Sample::Set::all], 256U);
  EXPECT_EQ(n[Sample::Set::left_trigger], 256U);
  EXPECT_EQ(different.size(), samples(choices, false).size());
}

TEST(OpenChoices, SpaceFillingReachesEveryTenthOfEveryRange) {
  const auto choices = open_choices();
  for (std::size_t k = 0; k < choices.size(); ++k) {
    if (choices[k].between == OpenChoice::Between::nothing) continue;
    std::array<int, 10> n{};
    for (const auto& sample : samples(choices, false))
      if (sample.set == Sample::Set::all)
        ++n[std::min(9, static_cast<int>(10 * choices[k].share_of(sample.values[k])))];
    EXPECT_THAT(n, Each(testing::AllOf(testing::Ge(23), testing::Le(28)))) << choices[k].name;  // of 256
  }
}

TEST(OpenChoices, TheRegionAgreesWithFig6WhereThereIsSuchASample) {
  std::vector<SampleOutcome> outcomes(5);
  EXPECT_THAT(region_of(outcomes), testing::IsEmpty());
  EXPECT_EQ(min_extreme(outcomes), -1);
  outcomes[0].agrees_with_fig6 = true;  // though another claim fails
  for (const std::size_t k : {1, 2, 3, 4}) outcomes[k].is_constrained = true;
  for (const std::size_t k : {1, 2, 3, 4}) outcomes[k].extremity = k == 2 ? 0.2 : 0.3;
  EXPECT_THAT(region_of(outcomes), testing::ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(min_extreme(outcomes), 2);
  outcomes[3].agrees_with_fig6 = outcomes[4].agrees_with_fig6 = true;
  EXPECT_THAT(region_of(outcomes), testing::ElementsAre(3, 4));
  EXPECT_EQ(min_extreme(outcomes), 3);  // the first of two
}

TEST(OpenChoices, EvidenceIsOfTheSamplesWhoseConstrainingClaimsHold) {
  OpenChoicesResult result;
  result.choices = open_choices();
  result.claims = {"C14", "C21"};
  const auto duration = place_of(result.choices, "left_duration_s");
  const auto add = [&](bool is_constrained, bool agrees, bool is_held, double spread) {
    auto& o = result.outcomes.emplace_back();
    o.sample.values = standard_values(result.choices);
    if (!is_held) o.sample.values[duration] = 15e-6;
    o.is_constrained = is_constrained;
    o.agrees_with_fig6 = agrees;
    o.spread_at_energy_rise = spread;
    o.distance = spread < 0.05 ? 1 : 1.5;
    o.difference_of_kinds = std::numeric_limits<double>::quiet_NaN();
    o.holds = {spread < 0.1, std::nullopt};
  };
  add(false, true, true, 0.9);
  add(true, true, true, 0.04);
  add(true, true, false, 0.06);
  add(true, true, false, 0.12);
  add(true, false, true, 0.2);
  const auto groups = evidence(result);
  ASSERT_EQ(groups.size(), 4U);
  for (const auto& [k, n] : {std::pair{0, 3}, {1, 4}, {2, 1}, {3, 2}}) EXPECT_EQ(groups[k].n, n) << k;
  const auto& agreeing = groups[0];
  EXPECT_EQ(agreeing.n_paper_fit_in_intervals, 1);
  EXPECT_EQ(agreeing.spread_at_energy_rise.least, 0.04);
  EXPECT_EQ(agreeing.spread_at_energy_rise.median, 0.06);
  EXPECT_EQ(agreeing.spread_at_energy_rise.largest, 0.12);
  EXPECT_TRUE(std::isnan(agreeing.difference_of_kinds.median));
  ASSERT_EQ(agreeing.shares.size(), 1U);  // C21 was not tested
  EXPECT_EQ(agreeing.shares[0].claim, "C14");
  EXPECT_EQ(agreeing.shares[0].n_tested, 3);
  EXPECT_EQ(agreeing.shares[0].n_holding, 2);
}

TEST(OpenChoices, AStudyIsTheSameForAnyNumberOfThreadsAndBeginsWithTheStandard) {
  const auto go_on = [](std::size_t, std::size_t) { return true; };
  const auto once = study_open_choices({.quick = true, .threads = 1, .kept = {}}, go_on);
  const auto again = study_open_choices({.quick = true, .threads = 2, .kept = {}}, go_on);
  ASSERT_EQ(once.outcomes.size() + once.n_impossible, 13U);
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
  EXPECT_EQ(standard.extremity, 0);
  EXPECT_EQ(once.chosen >= 0, !once.region.empty());
  for (const auto place : once.region) {
    EXPECT_TRUE(once.outcomes[place].is_constrained);
    if (once.outcomes[place].sample.set == Sample::Set::about_chosen) continue;
    EXPECT_GE(once.outcomes[place].extremity, once.outcomes[static_cast<std::size_t>(once.chosen)].extremity);
  }
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

TEST(OpenChoices, SamplesAboutAnotherChangeOneChoiceOrAnAmountWithItsForm) {
  const auto choices = open_choices();
  auto values = standard_values(choices);
  values[0] = 2;  // weakened at the left
  const auto list = samples_about(choices, Sample::Set::about_chosen, values);
  std::set<std::size_t> changed_choices;
  for (const auto& sample : list) {
    std::vector<std::size_t> changed;
    for (std::size_t k = 0; k < choices.size(); ++k)
      if (sample.values[k] != values[k]) changed.push_back(k);
    ASSERT_FALSE(changed.empty());
    ASSERT_LE(changed.size(), 2U);
    if (changed.size() == 2) {
      EXPECT_THAT(choices[changed.front()].name, testing::EndsWith("_form"));
    }
    changed_choices.insert(changed.back());
  }
  EXPECT_EQ(changed_choices.size(), choices.size());
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
