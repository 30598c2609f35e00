// SPDX-License-Identifier: BSD-3-Clause
// What case files may hold that is no key and no value of one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "input/entries.hpp"
#include "messages.hpp"

namespace slipfront::input {
namespace {

using test::error_of;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string repeated(const std::string& part, int n) {
  std::string text;
  for (int k = 0; k < n; ++k) text += part;
  return text;
}

TEST(CaseText, BytesThatAreNoUtf8AreRefused) {
  // A stray continuation byte, Latin-1, overlong, half of a surrogate pair, beyond the last character, cut
  // off.
  for (const std::string bytes :
       {"\x80", "\xe9 ", "\xc0\xaf", "\xe0\x80\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xe2\x82"}) {
    EXPECT_THAT(parse_error("[plate]\nwidth_m = 0.2\n\ntitle = \"" + bytes + "\""),
                StartsWith("c.toml:4: holds bytes that are no utf-8"));
    EXPECT_THAT(parse_error("", {{"title", bytes}}),
                AllOf(StartsWith("--set title="), HasSubstr("no utf-8")));
    EXPECT_THAT(parse_error("", {{"ti" + bytes + "tle", "1"}}), HasSubstr("no utf-8"));
  }
  const std::string good = "\xc2\xb5 \xe2\x82\xac \xf0\x9f\x98\x80";
  EXPECT_EQ(parsed("title = \"" + good + "\"").title, good);
}

TEST(CaseText, DeepNestingIsRefused) {
  constexpr int deep = 100000;
  const std::string key = repeated("a.", deep) + "a", header = "[" + key + "]";
  const std::string lists = repeated("[", deep), tables = repeated("{a=", deep);
  for (const std::string& line :
       {key + " = 1", header, "[" + header + "]", "a = " + lists, "a = " + tables,
        "a = " + repeated("[{a=", deep), "\"b\"." + key + " = 1", "a = {x = \"\\\"\", b = " + lists,
        "a = {b = \"\"\"\"\"\", c = " + lists, "a = {b = '''''', c = " + lists}) {
    EXPECT_THAT(parse_error("[plate]\n# [[[[\n" + line),
                StartsWith("c.toml:3: is nested more than 32 levels deep"))
        << line.substr(0, 20);
  }
  EXPECT_THAT(parse_error("", {{"plate.width_m", lists}}), HasSubstr("nested more than 32 levels deep"));
  EXPECT_THAT(parse_error("", {{key, "1"}}), HasSubstr("unknown key a.a.a"));
}

TEST(CaseText, CharactersBeyondAsciiStandInQuotesAndComments) {
  for (const auto& line : std::initializer_list<std::string>{
           "width\xc3\xa9_m = 0.2", std::string("width_m =\xc2\xa0") + "0.2", "\xef\xbb\xb7width_m = 0.2",
           "[plate\xe2\x80\x89]", "title = \"\"\"a\\ \n \xc3\xa9\"\"\"", "title = \"\\\xc3\xa9\""})
    EXPECT_THAT(parse_error("[plate]\n# \xc3\xa9\n" + line),
                StartsWith("c.toml:3: has a character beyond ASCII outside quotes"))
        << line;
  EXPECT_EQ(parsed("\xef\xbb\xbftitle = \"\\\\\xc3\xa9\" # \xc2\xa0").title, "\\\xc3\xa9");
  EXPECT_EQ(parsed("", {{"title", "\xc3\xa9"}}).title, "\xc3\xa9");
}

TEST(CaseText, StringsAndCommentsAreNotTakenForNesting) {
  const std::string dots = repeated(".[{", 50);
  for (const std::string quote : {"\"", "'", "\"\"\"", "'''"})
    EXPECT_EQ(parsed("title = " + quote + dots + quote + " # " + dots).title, dots);
  EXPECT_EQ(parsed("title = \"\"\"a\"\"\\\"\"" + dots + "\"\"\"\"").title, "a\"\"\"\"" + dots + "\"");
  EXPECT_EQ(parsed("[output]\nsnapshot_times_s = [0.25, 0.5,\n 0.75]").output.snapshot_times_s.size(), 3U);
}

TEST(CaseText, AQuotedKeyIsNoDottedOne) {
  EXPECT_THAT(parse_error("\"plate.width_m\" = 1\n[plate]\nwidth_m = 2"),
              StartsWith("c.toml:1: unknown key \"plate.width_m\"; write keys as table.key, without quotes"));
}

TEST(CaseText, MessagesStayShort) {
  constexpr std::size_t most = 800;
  const std::string long_text(100000, 'x');
  for (const std::string& text : {"[plate]\n" + long_text + " = 1", "[" + long_text + "]\na = 1",
                                  "[event]\nkind = \"" + long_text + "\"", "a = " + long_text})
    EXPECT_LT(parse_error(text).size(), most);
  for (const auto& [key, value] :
       {std::pair<std::string, std::string>{"event.kind", long_text}, {long_text, "1"}})
    EXPECT_LT(parse_error("", {{key, value}}).size(), most);
  EXPECT_LT(error_of([&] { parse_override(long_text); }).size(), most);
}

TEST(CaseText, AFileNeedsAKey) {
  const test::TemporaryFolder folder;
  const auto file = folder / "c.toml";
  const std::vector<Override> overrides = {{"plate.width_m", "0.4"}};
  for (const std::string text : {"", "\n \n", "# a comment\n", "[plate]\n"}) {
    test::write_file(file, text);
    EXPECT_THAT(error_of([&] { read_case(file, overrides); }), StartsWith(file.string() + ": sets no key"));
  }
}

TEST(CaseText, AWrongTableIsNamedWithThePlaceOfItsKey) {
  const test::TemporaryFolder folder;
  const auto file = folder / "c.toml";
  test::write_file(file,
                   "event.kind = \"none\"\nplate.corner = \"none\"\nloading.method = \"prestress\"\n"
                   "prestress.file = \"t.csv\"\n");
  test::write_file(folder / "t.csv", "x_m,t_Pa,p_Pa\n0,1e6,-1\n");
  EXPECT_THAT(error_of([&] { read_case(file); }),
              StartsWith(file.string() + ":4: prestress.file: " + (folder / "t.csv").string() +
                         ":2: p_Pa is -1; it must be greater than 0"));
}

const std::string prestressed = R"(
plate.corner = "none"
loading.method = "prestress"
loading.shear_speed_m_per_s = 1e-6
prestress.t_Pa = 1e6
prestress.p_Pa = 5e6
[event]
kind = "nucleation"
[nucleation]
form = "overstress"
x_m = 0.1
)";

TEST(Magnitudes, EveryNumberHasThem) {
  for (const std::string& text : {std::string("title = \"\""), prestressed}) {
    const Case config = parsed(text);
    for (const Entry& entry : entries_of(config)) {
      if (entry.kind != Kind::number) continue;
      for (const std::string extreme : {"1e300", "1e-300", "-1e300", "-1e-300"})
        EXPECT_THAT(parse_error(text, {{entry.key, extreme}}), StartsWith("--set " + entry.key + "="));
    }
  }
}

TEST(Magnitudes, AreOfTheUnit) {
  EXPECT_THAT(
      parse_error("[material]\nyoungs_modulus_Pa = 1e150"),
      AllOf(StartsWith("c.toml:2: material.youngs_modulus_Pa is 1e+150 Pa; its magnitude must be at "),
            EndsWith("at most 1e+15 Pa")));
  EXPECT_THAT(parse_error("[output]\nsnapshot_times_s = [0, 1e-5, 1e13]"),
              AllOf(StartsWith("c.toml:2: "), EndsWith("at most 1e+12 s")));
}

TEST(Steps, CanBeCounted) {
  EXPECT_THAT(parse_error("[time]\nstep_factor = 1e-12\nend_s = 1"),
              AllOf(StartsWith("c.toml:3: time.end_s = 1 s takes about"), EndsWith("choose an earlier end")));
  EXPECT_THAT(parse_error("[material]\nstiffness_damping_s = 1e6\n"), HasSubstr("choose an earlier end"));
  EXPECT_THAT(parse_error("[base]\nkind = 'body'\nheight_m = 0.1\nyoungs_modulus_Pa = 2e11\n"
                          "poissons_ratio = 0.3\ndensity_kg_per_m3 = 7800\nstiffness_damping_s = 1e6\n"),
              HasSubstr("choose an earlier end"));
}

}  // namespace
}  // namespace slipfront::input
