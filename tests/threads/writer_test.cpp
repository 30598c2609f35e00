// SPDX-License-Identifier: BSD-3-Clause
#include "threads/writer.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <numeric>
#include <thread>
#include <vector>

#include "base/error.hpp"
#include "support/files.hpp"

namespace slipfront::threads {
namespace {

using test::error_of;

TEST(Writer, DoesJobsInTheirOrderInAThreadOfItsOwn) {
  std::vector<int> done, expected(1000);
  std::iota(expected.begin(), expected.end(), 0);
  std::thread::id thread;
  Writer writer(100);
  for (const int k : expected)
    writer.put(1, [&, k] {
      done.push_back(k);
      thread = std::this_thread::get_id();
    });
  writer.finish();
  EXPECT_EQ(done, expected);
  EXPECT_NE(thread, std::this_thread::get_id());
}

TEST(Writer, IsFinishedWhenTheJobUnderWayIs) {
  std::promise<void> begun, go;
  std::atomic<bool> done = false;
  Writer writer(100);
  writer.put(1, [&] {
    begun.set_value();
    go.get_future().wait();
    done = true;
  });
  begun.get_future().wait();
  auto finished = std::async(std::launch::async, [&] {
    writer.finish();
    return done.load();
  });
  finished.wait_for(std::chrono::milliseconds(50));  // for one that does not wait
  go.set_value();
  EXPECT_TRUE(finished.get());
}

TEST(Writer, HoldsNoMoreThanItMay) {
  constexpr std::size_t most = 100, each = 30;
  std::atomic<std::size_t> held = 0, largest = 0;
  Writer writer(most);
  for (int k = 0; k < 200; ++k) {
    writer.wait_for_room(each);
    held += each;
    if (held > largest) largest = held.load();
    // What a job holds counts until it is done.
    writer.put(each, [&] { held -= each; });
  }
  writer.finish();
  EXPECT_EQ(held, 0U);
  EXPECT_LE(largest, most);
}

TEST(Writer, LetsTheCallerWaitForRoom) {
  std::promise<void> go;
  std::atomic<bool> first_done = false;
  bool was_done = false;
  Writer writer(100);
  writer.put(80, [&] {
    go.get_future().wait();
    first_done = true;
  });
  std::thread caller([&] {
    writer.put(80, [] {});
    was_done = first_done;
  });
  go.set_value();
  caller.join();
  EXPECT_TRUE(was_done);
  writer.finish();
}

TEST(Writer, TakesAJobThatHoldsMoreThanAllMayAlone) {
  int done = 0;
  Writer writer(10);
  for (int k = 0; k < 3; ++k) writer.put(1000, [&] { ++done; });
  writer.finish();
  EXPECT_EQ(done, 3);
}

TEST(Writer, AnErrorReachesTheCallerAndEndsTheWork) {
  std::atomic<int> done = 0;
  Writer writer(1);
  writer.put(1, [&] { ++done; });
  writer.put(1, [] { throw UserError("out/interface.h5: cannot write t_Pa"); });
  // Puts wait for room, so that the second of these finds the failure at the latest.
  const auto more = [&] {
    for (int k = 0; k < 3; ++k) writer.put(1, [&] { ++done; });
  };
  EXPECT_EQ(error_of(more), "out/interface.h5: cannot write t_Pa");
  EXPECT_EQ(error_of([&] { writer.finish(); }), "out/interface.h5: cannot write t_Pa");
  EXPECT_EQ(error_of([&] { writer.put(1, [] {}); }), "out/interface.h5: cannot write t_Pa");
  EXPECT_EQ(error_of([&] { writer.wait_for_room(1); }), "out/interface.h5: cannot write t_Pa");
  EXPECT_EQ(done, 1);
}

TEST(Writer, AnErrorWakesACallerThatWaits) {
  std::promise<void> go;
  Writer writer(1);
  writer.put(1, [&] {
    go.get_future().wait();
    throw UserError("full");
  });
  auto waiting = std::async(std::launch::async, [&] { return error_of([&] { writer.finish(); }); });
  go.set_value();
  EXPECT_EQ(waiting.get(), "full");
}

TEST(Writer, AtItsEndDropsWhatHasNotBegun) {
  std::promise<void> begun, go;
  bool first = false, second = false;
  {
    Writer writer(100);
    writer.put(1, [&] {
      begun.set_value();
      go.get_future().wait();
      first = true;
    });
    // The first job goes on once the second one is dropped.
    std::shared_ptr<void> dropped(nullptr, [&](void*) { go.set_value(); });
    writer.put(1, [&second, kept = std::move(dropped)] { second = true; });
    begun.get_future().wait();
  }
  EXPECT_TRUE(first);
  EXPECT_FALSE(second);
}

}  // namespace
}  // namespace slipfront::threads
