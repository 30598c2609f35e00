// SPDX-License-Identifier: BSD-3-Clause
#include "base/version.hpp"

#include <gtest/gtest.h>

#include <string>

namespace slipfront {
namespace {

TEST(Version, NamesTheCompilerThatMadeTheProgram) {
  const std::string name = compiler();
#ifdef __clang__
  EXPECT_NE(name.find("lang"), std::string::npos) << name;
  EXPECT_EQ(name.find("g++"), std::string::npos) << name;
#else
  EXPECT_EQ(name.find("g++ "), 0) << name;
#endif
  EXPECT_NE(name.find('.'), std::string::npos) << name;
}

}  // namespace
}  // namespace slipfront
