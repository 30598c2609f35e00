// SPDX-License-Identifier: BSD-3-Clause
#include "papers/kammer2012/reproduce.hpp"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "files/checksum.hpp"
#include "papers/kammer2012/cases.hpp"
#include "support/files.hpp"

namespace slipfront::kammer2012 {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::TemporaryFolder;

bool go_on(std::size_t, std::size_t, const std::string&) {
  return true;
}

ReproduceOptions quick(const fs::path& dir, int threads, bool overwrite = false) {
  ReproduceOptions options;
  options.dir = dir;
  options.quick = true;
  options.overwrite = overwrite;
  options.threads = threads;
  return options;
}

/// Folders of all runs of the quick reproduction.
std::vector<std::string> run_folders() {
  std::vector<std::string> list;
  for (const auto& c : paper_cases(true)) list.push_back(c.name);
  for (const auto& study : studies(true))
    for (const auto& point : study.points)
      for (const auto& c : point.cases)
        list.push_back("studies/" + study.name + "/" + point.value + "/" + c.name);
  return list;
}

/// The text of a run.json without its measured times, the only values that may differ between equal runs.
std::string without_times(const std::string& text) {
  auto run = nlohmann::ordered_json::parse(text);
  EXPECT_EQ(run.erase("wall_s"), 1U);
  EXPECT_EQ(run.erase("node_updates_per_s"), 1U);
  EXPECT_EQ(run["statics"].erase("wall_s"), 1U);
  return run.dump();
}

/// A list of checksums without those of files with measured times, and of lists that name such files.
std::string without_sums_of_times(const std::string& text) {
  std::istringstream lines(text);
  std::string rest;
  for (std::string line; std::getline(lines, line);)
    if (!line.ends_with("run.json") && !line.ends_with("timings.json") && !line.ends_with("checksums.sha256"))
      rest += line + "\n";
  return rest;
}

/// Every file of a reproduction by its path, as it is to be in any other one with the same options.
std::map<std::string, std::string> reproducible_files(const fs::path& dir) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(dir)) {
    if (!entry.is_regular_file() || entry.path().filename() == "timings.json") continue;
    auto text = test::read_file(entry.path());
    if (entry.path().filename() == "run.json") text = without_times(text);
    if (entry.path().filename() == "checksums.sha256") text = without_sums_of_times(text);
    files[fs::relative(entry.path(), dir).string()] = std::move(text);
  }
  return files;
}

void expect_same(const std::map<std::string, std::string>& files,
                 const std::map<std::string, std::string>& expected) {
  EXPECT_EQ(files.size(), expected.size());
  for (const auto& [name, text] : expected)
    EXPECT_TRUE(files.contains(name) && files.at(name) == text) << name;
}

/// A quick reproduction shared by the tests.
class QuickReproduction : public testing::Test {
 protected:
  struct Shared {
    TemporaryFolder folder;
    ReproduceReport report;
    std::multiset<std::string> done;
    std::size_t total = 0, last_done = 0;
    Shared() {
      report =
          reproduce(quick(folder.path(), 2), [&](std::size_t n, std::size_t of, const std::string& name) {
            if (!name.empty()) done.insert(name);
            total = of;
            last_done = n;
            return true;
          });
    }
  };
  static void SetUpTestSuite() { shared = std::make_unique<Shared>(); }
  static void TearDownTestSuite() { shared.reset(); }
  static inline std::unique_ptr<Shared> shared;
  const Shared& s = *shared;
  json read_json(const char* name) const { return json::parse(test::read_file(s.folder / name)); }
};

// One test: the shared reproduction is made once for each process of the test program.
TEST_F(QuickReproduction, WritesAllOfItAndTheSameForAnyNumberOfThreads) {
  // Every run, told of once.
  for (const auto& name : run_folders()) {
    for (const char* file : {"case.resolved.toml", "run.json", "interface.h5", "fronts.csv", "static.csv"})
      EXPECT_TRUE(fs::is_regular_file(s.folder.path() / name / file)) << name << '/' << file;
    EXPECT_NE(json::parse(test::read_file(s.folder.path() / name / "run.json"))["end"], "interrupted");
  }
  for (const auto& c : paper_cases(true))
    EXPECT_TRUE(fs::is_regular_file(s.folder.path() / c.name / "fields.vtkhdf")) << c.name;
  auto folders = run_folders();
  for (const auto& c : sequences(true)) {
    folders.push_back("sequences/" + c.name);
    EXPECT_TRUE(fs::is_regular_file(s.folder.path() / folders.back() / "events.csv")) << c.name;
  }
  EXPECT_THAT(s.done, testing::UnorderedElementsAreArray(folders));
  EXPECT_EQ(s.total, folders.size());
  EXPECT_EQ(s.last_done, s.total);

  // Every claim.
  const json list = read_json("scorecard.json");
  ASSERT_EQ(list.size(), s.report.claims.size());
  std::set<std::string> ids;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const auto& row = list[k];
    const auto& claim = s.report.claims[k];
    for (const char* key : {"id", "claim", "paper", "measured", "how"})
      EXPECT_TRUE(row[key].is_string() && !row[key].get<std::string>().empty()) << row.dump();
    EXPECT_TRUE(ids.insert(row["id"]).second) << row["id"];
    EXPECT_EQ(row["id"], claim.id);
    EXPECT_EQ(row["measured"], claim.measured);
    EXPECT_EQ(row["counts"], claim.counts);
    EXPECT_EQ(row.value("second_test_of", ""), claim.second_test_of);
    EXPECT_EQ(row.value("why", ""), claim.why);
    EXPECT_EQ(row["holds"], claim.holds ? json(*claim.holds) : json(nullptr));
  }
  for (int k = 1; k <= 25; ++k) EXPECT_TRUE(ids.contains(fmt::format("C{}", k))) << k;
  EXPECT_TRUE(ids.contains("E1"));

  // Analysis and timings.
  const json analysis = read_json("analysis.json"), timings = read_json("timings.json");
  for (const char* key : {"fit", "fit_curve", "share_in_paper_band", "n_points", "spread"})
    EXPECT_TRUE(analysis.contains(key)) << key;
  for (const auto& [key, value] : {std::pair{"a", 0.76}, {"b", 1.80}, {"c", 3.05}})
    EXPECT_EQ(analysis["paper_fit"][key], value);
  ASSERT_EQ(analysis["studies"].size(), studies(true).size());
  for (std::size_t k = 0; k < studies(true).size(); ++k) {
    EXPECT_EQ(analysis["studies"][k]["name"], studies(true)[k].name);
    EXPECT_EQ(analysis["studies"][k]["points"].size(), studies(true)[k].points.size());
  }
  EXPECT_EQ(timings.size(), s.report.timings.size());

  // The same bytes by another number of threads, over earlier results; what is no result stays.
  const auto expected = reproducible_files(s.folder.path());
  EXPECT_GT(expected.size(), 5 * run_folders().size());  // five files a run, and those of the whole
  const TemporaryFolder folder;
  fs::create_directories(folder / "spontaneous");
  std::string earlier;
  for (const char* file : {"scorecard.json", "spontaneous/fronts.csv"}) {
    test::write_file(folder / file, "old");
    earlier += files::sha256("old") + "  " + file + "\n";
  }
  test::write_file(folder / files::checksum_list, earlier);
  for (const char* file : {"notes.txt", "spontaneous/notes.txt"}) test::write_file(folder / file, "mine");
  reproduce(quick(folder.path(), 1, true), go_on);
  auto files = reproducible_files(folder.path());
  for (const char* file : {"notes.txt", "spontaneous/notes.txt"}) {
    EXPECT_EQ(files[file], "mine") << file;
    files.erase(file);
  }
  expect_same(files, expected);
}

TEST_F(QuickReproduction, SensitivityAddsVariationsAndChangesNothingElse) {
  const TemporaryFolder folder;
  auto options = quick(folder.path(), 2);
  options.sensitivity = true;
  const auto report = reproduce(options, go_on);
  ASSERT_EQ(report.claims.size(), s.report.claims.size());
  json with = json::parse(test::read_file(folder / "scorecard.json"));
  for (std::size_t k = 0; k < with.size(); ++k) {
    ASSERT_EQ(report.claims[k].variations.size(), 2U) << report.claims[k].id;
    for (const auto& variation : report.claims[k].variations) {
      auto& entry = with[k][variation.name + "_variation"];
      EXPECT_EQ(entry["parameter"], variation.key);
      EXPECT_EQ(entry["value"], variation.value);
      EXPECT_EQ(entry["measured"], variation.measured);
      EXPECT_EQ(entry["differences"].size(), with[k]["figures"].size());
      EXPECT_EQ(entry["moves"], describe(report.claims[k], variation));
      with[k].erase(variation.name + "_variation");
    }
  }
  EXPECT_EQ(with, json::parse(test::read_file(s.folder / "scorecard.json")));
  for (const auto& variation : variations(true)) {
    const auto dir = folder.path() / "variations" / variation.name;
    for (const char* run : {"left", "studies/mu_k/0.6/left", "studies/alpha/0.1/spontaneous"})
      EXPECT_TRUE(fs::is_regular_file(dir / run / "fronts.csv")) << dir / run;
  }
  // The coarse study of the mesh has the runs of the mesh variation.
  for (const char* event : {"left", "spontaneous", "right"})
    EXPECT_EQ(test::read_file(folder.path() / "variations/mesh" / event / "fronts.csv"),
              test::read_file(s.folder.path() / "studies/element_size/0.004" / event / "fronts.csv"));
}

TEST(Reproduce, RefusesAFolderThatHoldsAnything) {
  const TemporaryFolder folder;
  test::write_file(folder / "notes.txt", "mine");
  const auto error = test::error_of([&] { reproduce(quick(folder.path(), 1), go_on); });
  EXPECT_THAT(error, testing::HasSubstr("is not empty"));
  EXPECT_THAT(error, testing::HasSubstr("--overwrite"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

TEST(Reproduce, InterruptionKeepsTheRunsThatWereDoneAndEarlierResults) {
  const TemporaryFolder folder;
  const auto earlier = {"scorecard.json", "analysis.json", "timings.json"};
  for (const char* name : earlier) test::write_file(folder / name, "of an earlier reproduction");
  std::vector<std::string> done;
  EXPECT_THROW(reproduce(quick(folder.path(), 2, true),
                         [&](std::size_t n, std::size_t, const std::string& name) {
                           if (!name.empty() && n <= 3) done.push_back(name);
                           return n < 3;
                         }),
               Interrupted);
  ASSERT_EQ(done.size(), 3U);
  const auto unfinished = folder / "unfinished";
  for (const auto& name : done) {
    EXPECT_EQ(json::parse(test::read_file(unfinished / name / "run.json"))["status"], "complete") << name;
    EXPECT_TRUE(fs::is_regular_file(unfinished / name / "fronts.csv"));
  }
  EXPECT_FALSE(fs::exists(unfinished / "scorecard.json"));
  EXPECT_FALSE(fs::exists(unfinished / "studies"));
  for (const char* name : earlier)
    EXPECT_EQ(test::read_file(folder / name), "of an earlier reproduction") << name;
}

TEST_F(QuickReproduction, GoesOnBehindTheRunsThatWereDone) {
  const TemporaryFolder folder;
  for (const std::size_t stop_at : {3U, 9U})
    EXPECT_THROW(reproduce(quick(folder.path(), 1),
                           [&](std::size_t n, std::size_t, const std::string&) { return n < stop_at; }),
                 Interrupted);
  // One of them damaged meanwhile: it is computed again.
  test::write_file(folder / "unfinished/left/fronts.csv", "damaged");
  reproduce(quick(folder.path(), 2), go_on);
  expect_same(reproducible_files(folder.path()), reproducible_files(s.folder.path()));
  files::require_intact(folder.path());
}

}  // namespace
}  // namespace slipfront::kammer2012
