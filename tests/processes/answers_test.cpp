// SPDX-License-Identifier: BSD-3-Clause
#include "processes/answers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <new>
#include <vector>

#include "support/processes.hpp"

namespace slipfront {
namespace {

class OfThree : public testing::Test {
 protected:
  void answer(int rank, const std::function<void(MessageBuffer&)>& work) {
    test::ThreadProcess process(mail_, rank);
    process.send(0, answer_of(process, work));
  }
  /// Takes those of the others. @return numbers in them
  std::vector<int> taken(const std::function<void()>& own = [] {}) {
    std::vector<int> numbers;
    Answers answers(leader_);
    answers.unless_failed(own);
    for (const int rank : {1, 2})
      answers.take(rank, [&](MessageBuffer& a) { numbers.push_back(a.take<int>()); });
    answers.end();
    return numbers;
  }

  test::Mailboxes mail_{3};
  test::ThreadProcess leader_{mail_, 0};
};

TEST_F(OfThree, AreTakenInOrder) {
  answer(2, [](MessageBuffer& to) { to.put(22); });
  answer(1, [](MessageBuffer& to) { to.put(11); });
  EXPECT_THAT(taken(), testing::ElementsAre(11, 22));
}

TEST_F(OfThree, TellWhichProcessFailedAndPassOnWhatAnotherOneTold) {
  const auto failure = [&](const std::function<void(MessageBuffer&)>& work) -> std::string {
    answer(1, work);
    answer(2, [](MessageBuffer& to) { to.put(22); });
    try {
      taken();
    } catch (const ProcessError& error) {
      return error.what();
    }
    return "(nothing thrown)";
  };
  EXPECT_THAT(failure([](MessageBuffer& to) {
                to.put(11);
                throw std::bad_alloc();
              }),
              testing::StartsWith("process 1 of 3: not enough memory"));
  EXPECT_EQ(failure([](MessageBuffer&) { throw ProcessError("process 7 of 9: lost"); }),
            "process 7 of 9: lost");
}

TEST_F(OfThree, AreAllTakenWhereTheLeaderFails) {
  for (const int rank : {1, 2}) answer(rank, [rank](MessageBuffer& to) { to.put(rank); });
  EXPECT_THROW(taken([] { throw std::runtime_error("own"); }), std::runtime_error);
  for (const int rank : {1, 2}) answer(rank, [rank](MessageBuffer& to) { to.put(10 * rank); });
  EXPECT_THAT(taken(), testing::ElementsAre(10, 20));
}

}  // namespace
}  // namespace slipfront
