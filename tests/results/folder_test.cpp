// SPDX-License-Identifier: BSD-3-Clause
#include "results/folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>

#include "files/checksum.hpp"
#include "support/files.hpp"

namespace slipfront::results {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::names_below;
using ::testing::Each;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

/// Publishes files, each with its name as its content.
void publish(const fs::path& dir, const std::vector<std::string>& names, bool adds = false) {
  ResultFolder folder(dir, "test");
  folder.begin();
  for (const auto& name : names) {
    fs::create_directories((folder.unfinished() / name).parent_path());
    files::write_text(folder.unfinished() / name, name);
  }
  folder.publish(adds);
}

/// Begins work of a kind, and leaves it.
void leave_unfinished(const fs::path& dir, const char* kind) {
  ResultFolder left(dir, kind);
  left.begin();
  files::write_text(left.unfinished() / "run.json", "so far");
}

using ResultFolders = test::InFolder;
using Checksums = test::InFolder;

TEST_F(ResultFolders, IsMadeWithItsParentsAndGoesAgainUnused) {
  {
    const ResultFolder made(folder_ / "a" / "b", "test");
    EXPECT_TRUE(fs::is_directory(folder_ / "a" / "b"));
  }
  EXPECT_FALSE(fs::exists(folder_ / "a"));
  publish(folder_ / "a" / "b", {"run.json"});
  EXPECT_THAT(names_below(folder_ / "a" / "b"), UnorderedElementsAre("run.json", "checksums.sha256"));
}

TEST_F(ResultFolders, IsRefusedWhereItHoldsAnything) {
  test::write_file(folder_ / "notes.txt", "mine");
  {
    const ResultFolder taken(folder_.path(), "test");
    EXPECT_EQ(error_of([&] { taken.require_empty(false); }),
              "output folder " + folder_.path().string() +
                  ": is not empty; choose another or pass --overwrite to replace a run's results");
    EXPECT_EQ(error_of([&] { taken.require_empty(true); }), "(nothing thrown)");
  }
  EXPECT_THAT(names_below(folder_.path()), UnorderedElementsAre("notes.txt"));
}

TEST_F(ResultFolders, UnfinishedWorkIsNotLostByAccident) {
  leave_unfinished(folder_.path(), "one");
  ResultFolder again(folder_.path(), "one");
  EXPECT_FALSE(again.has_results());
  EXPECT_TRUE(again.has_unfinished());
  EXPECT_THAT(error_of([&] { again.require_empty(false); }), HasSubstr("holds unfinished work"));
  EXPECT_EQ(error_of([&] { again.require_empty(false, true); }), "(nothing thrown)");
  again.begin_or_resume();
  EXPECT_EQ(test::read_file(again.unfinished() / "run.json"), "so far");
}

TEST_F(ResultFolders, LinksAndPipesInUnfinishedWorkAreRefusedAtAnyDepth) {
  fs::create_directories(folder_ / "elsewhere");
  test::write_file(folder_ / "elsewhere/run.json", "mine");
  for (const char* name :
       {"state", "state/kind", "events", "events/0001", "events/0001/unfinished", "run.json"})
    for (const char* work : {"unfinished", "publishing"})
      for (const bool is_pipe : {false, true}) {
        const auto dir = folder_ / "out", path = dir / work / name;
        fs::remove_all(dir);
        leave_unfinished(dir, "one");
        if (work != std::string("unfinished")) fs::rename(dir / "unfinished", dir / work);
        fs::remove_all(path);
        fs::create_directories(path.parent_path());
        if (is_pipe)
          ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
        else
          fs::create_directory_symlink(folder_ / "elsewhere", path);
        EXPECT_EQ(error_of([&] { const ResultFolder again(dir, "one"); }),
                  path.string() + ": is not a file of slipfront, which needs the name; move it away");
        EXPECT_TRUE(fs::exists(dir / work));
      }
  EXPECT_THAT(names_below(folder_ / "elsewhere"), UnorderedElementsAre("run.json"));
}

TEST_F(ResultFolders, FilesWithAnotherNameAreNotWrittenOn) {
  const auto dir = folder_ / "out";
  leave_unfinished(dir, "one");
  test::write_file(dir / "unfinished/run.json", "mine");
  fs::create_hard_link(dir / "unfinished/run.json", folder_ / "copy");
  EXPECT_THAT(error_of([&] { const ResultFolder again(dir, "one"); }),
              HasSubstr("run.json: has another name"));
  EXPECT_TRUE(fs::exists(dir / "unfinished/run.json"));
}

TEST_F(ResultFolders, APartIsNotMadeThroughALink) {
  const ResultFolder whole(folder_ / "out", "one");
  fs::create_directories(whole.unfinished());
  fs::create_directories(folder_ / "elsewhere");
  fs::create_directory_symlink(folder_ / "elsewhere", whole.unfinished() / "part");
  EXPECT_THAT(error_of([&] { const ResultFolder part(whole.unfinished() / "part", "one", &whole); }),
              HasSubstr("is not a folder of slipfront"));
  EXPECT_TRUE(fs::is_empty(folder_ / "elsewhere"));
}

TEST_F(ResultFolders, WorkOfAnotherKindIsNotResumed) {
  leave_unfinished(folder_.path(), "one");
  ResultFolder other(folder_.path(), "another");
  EXPECT_FALSE(other.has_unfinished());
  EXPECT_THAT(error_of([&] { other.require_empty(false, true); }), HasSubstr("holds unfinished work"));
  other.begin_or_resume();
  EXPECT_FALSE(fs::exists(other.unfinished() / "run.json"));
}

TEST_F(ResultFolders, AFileThatIsNotOfTheEarlierSetIsNotReplaced) {
  publish(folder_.path(), {"run.json"});
  ResultFolder next(folder_.path(), "test");
  next.begin();
  files::write_text(next.unfinished() / "static.csv", "new");
  test::write_file(folder_ / "static.csv", "mine");
  EXPECT_EQ(
      error_of([&] { next.require_empty(true); }),
      (folder_ / "static.csv").string() + ": is not of earlier results, and would be replaced; move it away");
  EXPECT_THAT(error_of([&] { next.publish(); }), HasSubstr("move it away; the results are in"));
  EXPECT_EQ(test::read_file(folder_ / "static.csv"), "mine");
  EXPECT_TRUE(fs::exists(folder_ / "run.json"));
  ASSERT_TRUE(fs::remove(folder_ / "static.csv"));
  next.publish();
  EXPECT_EQ(test::read_file(folder_ / "static.csv"), "new");
}

TEST_F(ResultFolders, TheReportOfEarlierResultsGoesWithThem) {
  const std::string page = "<!DOCTYPE html><!-- slipfront report -->\n";
  for (const auto& [text, stays] : {std::pair{page, false}, {std::string("mine"), true}}) {
    publish(folder_.path(), {"run.json"});
    test::write_file(folder_ / "report.html", text);
    publish(folder_.path(), {"run.json"});
    EXPECT_EQ(fs::exists(folder_ / "report.html"), stays);
  }
}

TEST(ResultFolder, NeedsAName) {
  for (const char* name : {"/", ""})
    EXPECT_THAT(error_of([&] { ResultFolder folder(name, "test"); }),
                HasSubstr("name a folder for these results"));
}

TEST_F(ResultFolders, EarlierResultsStayUntilTheNewOnesAreComplete) {
  publish(folder_.path(), {"run.json", "fields.vtkhdf"});
  test::write_file(folder_ / "notes.txt", "mine");
  ResultFolder next(folder_.path(), "test");
  next.begin();
  files::write_text(next.unfinished() / "run.json", "new");
  EXPECT_EQ(test::read_file(folder_ / "run.json"), "run.json");
  next.publish();
  EXPECT_EQ(test::read_file(folder_ / "run.json"), "new");
  // The earlier set's fields are not the new one's; what is nobody's stays.
  EXPECT_FALSE(fs::exists(folder_ / "fields.vtkhdf"));
  EXPECT_TRUE(fs::exists(folder_ / "notes.txt"));
  files::require_intact(folder_.path());
}

TEST_F(ResultFolders, ReplacesTheResultsOfFoldersWithoutAListAndNothingElse) {
  for (const char* name : {"case.resolved.toml", "run.json", "interface.h5", "fronts.csv", "static.csv",
                           "energy.csv", "fields.vtkhdf", "notes.txt", "old.interface.h5"})
    test::write_file(folder_ / name, "x");
  fs::create_directory(folder_ / "figures");
  test::write_file(folder_ / "figures" / "fronts.csv", "x");
  publish(folder_.path(), {"run.json"});
  EXPECT_THAT(names_below(folder_.path()),
              UnorderedElementsAre("run.json", "checksums.sha256", "notes.txt", "old.interface.h5", "figures",
                                   "figures/fronts.csv"));
}

TEST_F(ResultFolders, ASetMayHaveFoldersWithSetsOfTheirOwn) {
  const auto with_runs = [&](const std::vector<std::string>& runs) {
    ResultFolder held(folder_.path(), "test");
    held.begin();
    for (const auto& run : runs) {
      fs::create_directories(held.unfinished() / run);
      files::write_text(held.unfinished() / run / "run.json", run);
      seal(held.unfinished() / run);
    }
    files::write_text(held.unfinished() / "scorecard.json", "all");
    held.publish();
  };
  with_runs({"left", "studies/a/right"});
  EXPECT_THAT(names_below(folder_.path()),
              UnorderedElementsAre("checksums.sha256", "scorecard.json", "left", "left/run.json",
                                   "left/checksums.sha256", "studies", "studies/a", "studies/a/right",
                                   "studies/a/right/run.json", "studies/a/right/checksums.sha256"));
  for (const char* run : {"", "left", "studies/a/right"}) files::require_intact(folder_ / run);
  with_runs({"left"});
  EXPECT_THAT(names_below(folder_.path()), UnorderedElementsAre("checksums.sha256", "scorecard.json", "left",
                                                                "left/run.json", "left/checksums.sha256"));
}

/// Publishes a sequence of so many events, each of the given content.
void publish_sequence(const fs::path& dir, int n_events, const std::string& content) {
  ResultFolder held(dir, "run");
  held.begin();
  for (int k = 1; k <= n_events; ++k) {
    const auto event = event_folder(held.unfinished(), k);
    fs::create_directories(event);
    for (const char* name : {"case.resolved.toml", "energy.csv", "run.json"})
      files::write_text(event / name, content);
    seal(event);
  }
  for (const char* name : {"case.resolved.toml", "events.csv", "sequence.json"})
    files::write_text(held.unfinished() / name, content);
  held.publish();
}

void require_sequence(const fs::path& dir, int n_events, const std::string& content) {
  files::require_intact(dir);
  EXPECT_EQ(test::read_file(dir / "events.csv"), content);
  EXPECT_THAT(names_below(dir), ::testing::SizeIs(4 + 1 + 5 * n_events));
  for (int k = 1; k <= n_events; ++k) {
    files::require_intact(event_folder(dir, k));
    EXPECT_EQ(test::read_file(event_folder(dir, k) / "energy.csv"), content);
  }
}

/// Wherever its publication is cut off, over an earlier one.
TEST_F(ResultFolders, ASequenceWhosePublicationWasCutOffIsEnded) {
  const test::TemporaryFolder fresh;
  publish_sequence(fresh.path(), 2, "new");
  const auto names = names_below(fresh.path());
  for (std::size_t n_moved = 0; n_moved < names.size(); ++n_moved) {
    const test::TemporaryFolder folder;
    publish_sequence(folder.path(), 3, "old");
    fs::remove_all(event_folder(folder.path(), 3));  // what is stale goes first
    fs::copy(fresh.path(), folder / "publishing", fs::copy_options::recursive);
    fs::create_directories(folder / "publishing/state");
    test::write_file(folder / "publishing/state/kind", "run\n");
    std::size_t k = 0;
    for (const auto& name : names)
      if (k++ < n_moved && name != files::checksum_list && !fs::is_directory(fresh / name)) {
        fs::rename(folder / "publishing" / name, folder / name);
        std::error_code is_not_empty;
        fs::remove((folder / "publishing" / name).parent_path(), is_not_empty);
      }
    { const ResultFolder claimed(folder.path(), "run"); }
    require_sequence(folder.path(), 2, "new");
  }
}

TEST_F(ResultFolders, ADamagedListOfAnEventIsInNobodysWay) {
  for (const char* damaged : {"events/0001/checksums.sha256", "checksums.sha256"}) {
    const test::TemporaryFolder folder;
    publish_sequence(folder.path(), 3, "old");
    test::write_file(folder / damaged, "no list\n");
    publish_sequence(folder.path(), 2, "new");  // over it
    require_sequence(folder.path(), 2, "new");
  }
  // On its way: it arrives as it is, and can be replaced.
  publish_sequence(folder_ / "a", 2, "old");
  fs::rename(folder_ / "a", folder_ / "publishing");
  test::write_file(folder_ / "publishing/events/0001/checksums.sha256", "no list\n");
  fs::create_directories(folder_ / "publishing/state");
  test::write_file(folder_ / "publishing/state/kind", "run\n");
  { const ResultFolder claimed(folder_.path(), "run"); }
  EXPECT_FALSE(fs::exists(folder_ / "publishing"));
  EXPECT_THAT(error_of([&] { files::require_intact(folder_.path()); }), HasSubstr("does not match"));
  publish_sequence(folder_.path(), 2, "new");
  require_sequence(folder_.path(), 2, "new");
  // Nor is it published.
  ResultFolder held(folder_ / "b", "run");
  held.begin();
  fs::create_directories(event_folder(held.unfinished(), 1));
  test::write_file(event_folder(held.unfinished(), 1) / files::checksum_list, "no list\n");
  EXPECT_THAT(error_of([&] { held.publish(); }), HasSubstr("is not a list of checksums"));
  EXPECT_TRUE(held.has_unfinished());
}

TEST_F(ResultFolders, WhatIsInTheWayOfEventsIsFoundBeforeTheStart) {
  const test::TemporaryFolder elsewhere;
  for (const std::string name : {"events", "events/0001", "events/0002", "events/0001/run.json",
                                 "events/0002/interface.h5", "events/0001/checksums.sha256"})
    for (const char* what : {"file", "folder", "link"}) {
      const bool is_for_folder = fs::path(name).extension().empty();
      if (what == std::string("folder") && is_for_folder) continue;
      const test::TemporaryFolder folder;
      fs::create_directories((folder / name).parent_path());
      if (what == std::string("file")) test::write_file(folder / name, "mine");
      if (what == std::string("folder")) fs::create_directory(folder / name);
      if (what == std::string("link")) fs::create_symlink(elsewhere.path(), folder / name);
      const ResultFolder held(folder.path(), "run");
      EXPECT_THAT(error_of([&] { held.require_room(2); }),
                  ::testing::AllOf(HasSubstr((folder / name).string() + ": is "), EndsWith("; move it away")))
          << name << " " << what;
      EXPECT_EQ(error_of([&] { held.require_room(0); }), "(nothing thrown)");  // of a single run
    }
  // An earlier sequence is not, nor what is not of this one.
  publish_sequence(folder_.path(), 2, "old");
  fs::create_directory(folder_ / "events/0003");
  test::write_file(folder_ / "events/0003/run.json", "mine");
  test::write_file(folder_ / "events/notes.txt", "mine");
  const ResultFolder held(folder_.path(), "run");
  EXPECT_EQ(error_of([&] { held.require_room(2); }), "(nothing thrown)");
  EXPECT_THAT(error_of([&] { held.require_room(3); }), HasSubstr("0003/run.json: is not of earlier results"));
}

TEST_F(ResultFolders, IsNoPartOfASequence) {
  publish_sequence(folder_.path(), 1, "old");
  for (const char* name : {"events", "events/0001", "events/0002", "events/mine"})
    EXPECT_EQ(error_of([&] { ResultFolder(folder_ / name, "run"); }),
              "output folder " + (folder_ / name).string() + ": is part of the sequence in " +
                  folder_.path().string() + "; choose another place");
  EXPECT_NO_THROW(ResultFolder(folder_ / "other", "run"));
}

TEST_F(ResultFolders, ASetMayBeAddedTo) {
  publish(folder_.path(), {"a.json", "b.json"});
  publish(folder_.path(), {"b.json", "c.json"}, true);
  EXPECT_THAT(names_below(folder_.path()),
              UnorderedElementsAre("a.json", "b.json", "c.json", "checksums.sha256"));
  EXPECT_EQ(files::read_checksums(folder_.path()).size(), 3U);
  files::require_intact(folder_.path());
}

/// A publication that is cut off after the set was made complete, with some files moved and some not.
TEST_F(ResultFolders, APublicationThatWasCutOffIsEnded) {
  for (const bool listed : {true, false}) {
    const test::TemporaryFolder folder;
    publish(folder.path(), {"run.json", "fronts.csv", "fields.vtkhdf"});
    {
      ResultFolder next(folder.path(), "test");
      next.begin();
      files::write_text(next.unfinished() / "run.json", "new");
      files::write_text(next.unfinished() / "fronts.csv", "new");
      seal(next.unfinished());
    }
    fs::rename(folder / "unfinished", folder / "publishing");
    fs::rename(folder / "publishing/fronts.csv", folder / "fronts.csv");
    EXPECT_EQ(test::read_file(published(folder.path(), "run.json")), "new");
    EXPECT_EQ(test::read_file(published(folder.path(), "fronts.csv")), "new");
    if (!listed) {  // at the very end
      fs::rename(folder / "publishing/run.json", folder / "run.json");
      fs::rename(folder / "publishing/checksums.sha256", folder / "checksums.sha256");
      fs::remove(folder / "fields.vtkhdf");
      fs::remove_all(folder / "publishing/state");
    }
    { const ResultFolder claimed(folder.path(), "test"); }
    EXPECT_THAT(names_below(folder.path()),
                UnorderedElementsAre("run.json", "fronts.csv", "checksums.sha256"));
    EXPECT_EQ(test::read_file(folder / "run.json"), "new");
    files::require_intact(folder.path());
  }
}

TEST_F(ResultFolders, ForeignFoldersAndLinksOfItsNamesAreLeftAlone) {
  for (const char* name : {"unfinished", "publishing"}) {
    const test::TemporaryFolder folder, elsewhere;
    test::write_file(elsewhere / "precious", "x");
    fs::create_directory_symlink(elsewhere.path(), folder / name);
    EXPECT_THAT(error_of([&] { ResultFolder(folder.path(), "test"); }), EndsWith("; move it away"));
    fs::remove(folder / name);
    fs::create_directory(folder / name);
    test::write_file(folder / name / "precious", "x");
    EXPECT_THAT(error_of([&] { ResultFolder(folder.path(), "test"); }), EndsWith("; move it away"));
    EXPECT_EQ(test::read_file(folder / name / "precious"), "x");
    EXPECT_EQ(test::read_file(elsewhere / "precious"), "x");
  }
}

TEST_F(ResultFolders, IsNotMadeInsideAnothersWork) {
  ResultFolder other(folder_ / "a", "test");
  other.begin();
  EXPECT_THAT(error_of([&] { ResultFolder(folder_ / "a" / "unfinished" / "b" / "c", "test"); }),
              HasSubstr("is inside " + (folder_ / "a" / "unfinished").string()));
  fs::create_directories(folder_ / "unfinished");  // somebody's, who likes the name
  EXPECT_NO_THROW(ResultFolder(folder_ / "unfinished" / "d", "test"));
}

TEST_F(ResultFolders, LeavesTheTargetOfALinkAlone) {
  const test::TemporaryFolder elsewhere;
  test::write_file(elsewhere / "run.json", "precious");
  publish(folder_.path(), {"run.json"});
  ASSERT_TRUE(fs::remove(folder_ / "run.json"));
  fs::create_symlink(elsewhere / "run.json", folder_ / "run.json");
  publish(folder_.path(), {"run.json"});
  EXPECT_FALSE(fs::is_symlink(folder_ / "run.json"));
  EXPECT_EQ(test::read_file(elsewhere / "run.json"), "precious");
}

/// A file of the text beside others, named by an earlier set that a link or a file has come into.
TEST_F(ResultFolders, FollowsNoLinkBelowIt) {
  const auto sum = files::sha256("precious") + "  ";
  for (const auto& [link, listed] : {std::pair<const char*, const char*>{"sub", "sub/a.txt"},
                                     {"sub/inner", "sub/inner/a.txt"},
                                     {"sub", "sub/inner/a.txt"},
                                     {"sub", "sub/checksums.sha256"},
                                     {"a.txt", "a.txt"}}) {
    const test::TemporaryFolder folder, elsewhere;
    for (const auto& place : {elsewhere.path(), elsewhere / "inner"}) {
      fs::create_directories(place);
      test::write_file(place / "a.txt", "precious");
      test::write_file(place / files::checksum_list, sum + "a.txt\n");
    }
    const auto before = names_below(elsewhere.path());
    publish(folder.path(), {"run.json"});
    const auto target = std::string(link) == listed ? elsewhere / "a.txt" : elsewhere.path();
    fs::create_directories((folder / link).parent_path());
    fs::create_symlink(target, folder / link);
    std::ofstream(folder / files::checksum_list, std::ios::app) << sum << listed << "\n";
    publish(folder.path(), {"run.json"});
    EXPECT_EQ(names_below(elsewhere.path()), before) << listed;
    // What the list names goes: here the link itself.
    EXPECT_EQ(fs::is_symlink(folder / link), std::string(link) != listed) << listed;
  }
}

TEST_F(ResultFolders, NeitherFilesNorLinksAreTakenForItsFolders) {
  for (const bool is_link : {true, false}) {
    const test::TemporaryFolder folder, elsewhere;
    if (is_link)
      fs::create_directory_symlink(elsewhere.path(), folder / "sub");
    else
      test::write_file(folder / "sub", "mine");
    test::write_file(folder / files::checksum_list, files::sha256("") + "  sub/a.txt\n");
    EXPECT_THAT(
        error_of([&] { publish(folder.path(), {"sub/run.json"}); }),
        HasSubstr((folder / "sub").string() + ": is no folder, where one is to go; move it away; the"));
    EXPECT_THAT(names_below(elsewhere.path()), IsEmpty());
    publish(folder.path(), {"run.json"});
    EXPECT_TRUE(fs::exists(folder / "sub"));
  }
}

TEST_F(ResultFolders, MayBeReachedByLinks) {
  const auto place = folder_ / "place";
  fs::create_directory(place);
  fs::create_directory_symlink(place, folder_ / "link");
  publish(folder_ / "link/", {"run.json"});
  publish(folder_ / "link" / "new", {"a/b/run.json"});
  publish(folder_ / "link" / "new", {"a/run.json"});
  EXPECT_THAT(names_below(place), UnorderedElementsAre("run.json", "checksums.sha256", "new", "new/a",
                                                       "new/a/run.json", "new/checksums.sha256"));
}

TEST_F(ResultFolders, ListsThatNameThemselvesAreRead) {
  fs::create_directory(folder_ / "a");
  const auto own = files::sha256("") + "  checksums.sha256\n";
  test::write_file(folder_ / "a" / files::checksum_list, own);
  test::write_file(folder_ / files::checksum_list, own + files::sha256("") + "  a/checksums.sha256\n");
  publish(folder_.path(), {"run.json"});
  EXPECT_THAT(names_below(folder_.path()), UnorderedElementsAre("run.json", "checksums.sha256"));
}

TEST_F(ResultFolders, AFolderInPlaceOfAResultIsRefused) {
  fs::create_directory(folder_ / "run.json");
  EXPECT_THAT(error_of([&] { ResultFolder(folder_.path(), "test"); }),
              HasSubstr("is a folder where a result"));
  EXPECT_TRUE(fs::is_directory(folder_ / "run.json"));
}

TEST_F(ResultFolders, WhatCannotBeAFolderIsRefused) {
  test::write_file(folder_ / "file", "x");
  fs::create_symlink(folder_ / "loop", folder_ / "loop");
  for (const auto& [name, message] :
       {std::pair<fs::path, const char*>{"file", ": is a file; choose another name"},
        {"file/inner", "; choose another place"},
        {std::string(300, 'a'), "; choose another place"},
        {"loop", "; choose another place"},
        // Nobody, root included, makes folders in /proc.
        {"/proc/slipfront", "output folder /proc/slipfront: cannot be created ("}})
    EXPECT_THAT(error_of([&, &to = name] { ResultFolder(folder_ / to, "test"); }), HasSubstr(message));
}

TEST_F(ResultFolders, IsHeldByOneProcessAtATime) {
  int ready[2], leave[2];
  ASSERT_EQ(pipe(ready), 0);
  ASSERT_EQ(pipe(leave), 0);
  const pid_t child = fork();
  if (child == 0) {
    const ResultFolder held(folder_.path(), "test");
    char c = 'x';
    _exit(write(ready[1], &c, 1) == 1 && read(leave[0], &c, 1) == 1 ? 1 : 2);  // as by a kill: not given back
  }
  char c = 'x';
  ASSERT_EQ(read(ready[0], &c, 1), 1);
  EXPECT_THAT(error_of([&] { ResultFolder(folder_.path(), "test"); }),
              HasSubstr(fmt::format("is in use by process {} on ", child)));
  ASSERT_EQ(write(leave[1], &c, 1), 1);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_TRUE(fs::exists(folder_ / ".slipfront.lock"));  // a file that is left is no lock
  { const ResultFolder taken(folder_.path(), "test"); }
  EXPECT_THAT(names_below(folder_.path()), IsEmpty());
}

TEST_F(ResultFolders, OfManyThatWantItAtOnceEachHasItOrIsToldWhoHas) {
  std::vector<std::string> refusals(4);
  std::vector<std::thread> threads;
  for (auto& refusal : refusals)
    threads.emplace_back([this, &refusal] {
      for (int k = 0; k < 200 && refusal.empty(); ++k) {
        const auto error = error_of([&] { ResultFolder(folder_.path(), "test"); });
        if (error != "(nothing thrown)" && error.find("is in use by") == std::string::npos) refusal = error;
      }
    });
  for (auto& thread : threads) thread.join();
  EXPECT_THAT(refusals, Each(IsEmpty()));
}

TEST_F(Checksums, AreThoseOfSha256sum) {
  // Of "abc", FIPS 180-4.
  EXPECT_EQ(files::sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  test::write_file(folder_ / "abc", "abc");
  EXPECT_EQ(files::sha256_of_file(folder_ / "abc"), files::sha256("abc"));
  seal(folder_.path());
  EXPECT_EQ(test::read_file(folder_ / files::checksum_list), files::sha256("abc") + "  abc\n");
}

TEST_F(Checksums, TellDamage) {
  test::write_file(folder_ / "a", "abc");
  seal(folder_.path());
  test::write_file(folder_ / "a", "abd");
  EXPECT_EQ(error_of([&] { files::require_intact(folder_.path()); }),
            (folder_ / "a").string() +
                ": does not match checksums.sha256: it was changed or damaged; run the case again");
  fs::remove(folder_ / "a");
  EXPECT_THAT(error_of([&] { files::require_intact(folder_.path()); }), HasSubstr("a: is missing"));
}

TEST_F(Checksums, ListsWithNamesOfOtherPlacesOrThatCannotBeShownAreRefused) {
  for (const char* name : {"../a", "/etc/passwd", "a/../../b", "", "run\r.json", "\x1b[2J"}) {
    test::write_file(folder_ / files::checksum_list, files::sha256("") + "  " + name + "\n");
    EXPECT_EQ(error_of([&] { files::read_checksums(folder_.path()); }),
              (folder_ / files::checksum_list).string() + ": is not a list of checksums; run the case again");
  }
}

}  // namespace
}  // namespace slipfront::results
