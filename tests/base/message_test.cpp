// SPDX-License-Identifier: BSD-3-Clause
#include "base/message.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"

namespace slipfront {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const Key width("plate.width_m"), height("plate.height_m");

void expect(const Message& message, const std::string& text, const std::vector<std::string>& keys) {
  EXPECT_EQ(message.text, text);
  EXPECT_EQ(message.keys, keys) << text;
}

TEST(Message, CarriesTheKeysAmongItsArguments) {
  const std::vector<std::string> both = {"plate.width_m", "plate.height_m"};
  expect(Message("{} = {} m is less than {}", width, 0.2, height),
         "plate.width_m = 0.2 m is less than plate.height_m", both);
  expect(Message("{} and {:leaf}", width, height), "plate.width_m and height_m", both);
  expect(Message("{:leaf}", Key("title")), "title", {"title"});
  expect(Message("{1} for {0}", width, height), "plate.height_m for plate.width_m", both);
  expect(Message("{}; {}", Message("{} is 0", width), Message("choose a larger {}", height)),
         "plate.width_m is 0; choose a larger plate.height_m", both);
}

TEST(Message, DoesNotSearchItsText) {
  for (const char* text : {"plate.width_m", "plate.width_m {}", "{}"}) expect(text, text, {});
  expect(Message("{}", "plate.width_m {}"), "plate.width_m {}", {});
}

TEST(UserError, KeepsItsKeysWhenItGetsAPlaceAndFurtherOnes) {
  const UserError error = UserError("{} is 0", width).about("plate.height_m").at("c.toml:3");
  EXPECT_STREQ(error.what(), "c.toml:3: plate.width_m is 0");
  EXPECT_THAT(error.keys(), ElementsAre("plate.width_m", "plate.height_m"));
  EXPECT_THAT(UserError("no key").keys(), IsEmpty());
}

}  // namespace
}  // namespace slipfront
