// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <new>
#include <string>
#include <vector>

#include "support/processes.hpp"

namespace slipfront {
namespace {

/// Ranks in threads.
class Ranks {
 public:
  explicit Ranks(int n) : mail_(n) {
    for (int rank = 0; rank < n; ++rank) processes_.emplace_back(mail_, rank);
  }
  /// Runs f(process) on each. @throws what rank 0 throws
  template <class F>
  void run(F&& f) {
    test::on_ranks(mail_.size(), [&](int rank) { f(processes_[static_cast<std::size_t>(rank)]); });
  }
  /// The line with which rank 0 fails; empty where it does not.
  template <class F>
  std::string failure(F&& f) {
    try {
      run(f);
    } catch (const std::exception& error) {
      return error.what();
    }
    return {};
  }

 private:
  test::Mailboxes mail_;
  std::deque<test::ThreadProcess> processes_;
};

/// Work that fails on rank 0 and ends on the others.
template <class F>
void expect_end(const Processes& processes, F&& work) {
  if (processes.is_root()) return work();
  EXPECT_THROW(work(), FailedElsewhere);
}

TEST(Collectives, GiveEachRankItsNumbersInTheirOrder) {
  for (int n = 1; n < 12; ++n) {
    Ranks ranks(n);
    std::vector<int> expected, gathered;
    for (int rank = 0; rank < n; ++rank) expected.push_back(10 * rank);
    ranks.run([&](Processes& processes) {
      EXPECT_EQ(unpacked<int>(processes.broadcast(packed(processes.is_root() ? 7 : 0))), 7);
      std::vector<int> all;
      for (auto& buffer : processes.all_gather(packed(10 * processes.rank())))
        all.push_back(unpacked<int>(buffer));
      EXPECT_EQ(all, expected);
      EXPECT_EQ(unpacked<int>(processes.scatter([](int rank) { return packed(10 * rank); })),
                10 * processes.rank());
      processes.gather(packed(10 * processes.rank()), [&](int rank, MessageBuffer& buffer) {
        EXPECT_TRUE(processes.is_root());
        EXPECT_EQ(rank, static_cast<int>(gathered.size()));
        gathered.push_back(unpacked<int>(buffer));
      });
      EXPECT_EQ(unpacked<int>(processes.from_root([](MessageBuffer& to) { to.append(packed(3)); })), 3);
    });
    EXPECT_EQ(gathered, expected);
  }
}

TEST(Collectives, EndOnAllRanksWhereOneFails) {
  Ranks ranks(5);
  const auto fails_on = [&](int failing, auto&& fail) {
    return ranks.failure([&](Processes& processes) {
      processes.set_awaited(true);
      expect_end(processes, [&] {
        processes.together([&] {
          if (processes.rank() == failing) fail();
        });
      });
    });
  };
  const auto no_memory = [] { throw std::bad_alloc(); };
  EXPECT_EQ(fails_on(0, [] { throw UserError("own"); }), "own");
  EXPECT_THAT(fails_on(3, no_memory), testing::StartsWith("rank 3: not enough memory"));
  // None is left behind.
  EXPECT_EQ(ranks.failure([&](Processes& processes) {
    EXPECT_FALSE(processes.is_awaited());
    expect_end(processes,
               [&] { processes.from_root([](MessageBuffer&) { throw UserError("no such file"); }); });
  }),
            "no such file");
  ranks.run([](Processes& processes) { processes.together([] {}); });
}

TEST(MessageArchive, ReadsWhatItHasWritten) {
  auto buffer = packed(std::vector<double>{1, 2.5}, std::string("text"), true);
  std::vector<double> numbers;
  std::string text;
  bool flag = false;
  MessageArchive::reader(buffer)(numbers, text, flag);
  EXPECT_THAT(numbers, testing::ElementsAre(1, 2.5));
  EXPECT_EQ(text, "text");
  EXPECT_TRUE(flag);
}

}  // namespace
}  // namespace slipfront
