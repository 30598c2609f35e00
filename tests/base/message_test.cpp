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

TEST(Message, CarriesTheKeysAmongItsArguments) {
  const Message message("{} = {} m is less than {}", width, 0.2, height);
  EXPECT_EQ(message.text, "plate.width_m = 0.2 m is less than plate.height_m");
  EXPECT_THAT(message.keys, ElementsAre("plate.width_m", "plate.height_m"));
}

TEST(Message, NamesAKeyWithoutItsTable) {
  EXPECT_EQ(Message("{} and {:leaf}", width, height).text, "plate.width_m and height_m");
  EXPECT_EQ(Message("{:leaf}", Key("title")).text, "title");
}

TEST(Message, TakesItsKeysInTheOrderOfTheArguments) {
  const Message message("{1} asks for another {0}", width, height);
  EXPECT_EQ(message.text, "plate.height_m asks for another plate.width_m");
  EXPECT_THAT(message.keys, ElementsAre("plate.width_m", "plate.height_m"));
}

TEST(Message, TakesOverTheKeysOfItsParts) {
  const Message message("{}; {}", Message("{} is 0", width), Message("choose a larger {}", height));
  EXPECT_EQ(message.text, "plate.width_m is 0; choose a larger plate.height_m");
  EXPECT_THAT(message.keys, ElementsAre("plate.width_m", "plate.height_m"));
}

TEST(Message, DoesNotSearchItsText) {
  EXPECT_THAT(Message("plate.width_m").keys, IsEmpty());
  EXPECT_THAT(Message("{}", "plate.width_m {}").keys, IsEmpty());
  EXPECT_EQ(Message("{}").text, "{}");
}

TEST(UserError, KeepsItsKeysWhenItGetsAPlaceAndFurtherOnes) {
  const UserError error = UserError("{} is 0", width).about("plate.height_m").at("c.toml:3");
  EXPECT_STREQ(error.what(), "c.toml:3: plate.width_m is 0");
  EXPECT_THAT(error.keys(), ElementsAre("plate.width_m", "plate.height_m"));
  EXPECT_THAT(UserError("no key").keys(), IsEmpty());
}

}  // namespace
}  // namespace slipfront
