// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "input/schema.hpp"
#include "support/files.hpp"

namespace slipfront::input {

inline Case parsed(const std::string& text, const std::vector<Override>& overrides = {}) {
  return parse_case(text, "c.toml", overrides);
}

inline std::string parse_error(const std::string& text, const std::vector<Override>& overrides = {}) {
  const auto message = test::error_of([&] { parsed(text, overrides); });
  EXPECT_EQ(message.find('\n'), std::string::npos) << "more than one line: " << message;
  return message;
}

/// How a message of one line begins, and what else it says.
inline void expect_message(const std::string& message, const std::string& begins,
                           const std::string& contains = "") {
  EXPECT_EQ(message.find('\n'), std::string::npos) << "more than one line: " << message;
  EXPECT_TRUE(message.starts_with(begins)) << message << "\ndoes not begin with " << begins;
  EXPECT_NE(message.find(contains), std::string::npos) << message << "\nlacks " << contains;
}

}  // namespace slipfront::input
