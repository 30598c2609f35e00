// SPDX-License-Identifier: BSD-3-Clause
#include "input/prestress.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "input/schema.hpp"
#include "support/files.hpp"

namespace slipfront::input {
namespace {

using test::error_of;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string rows = "x_m,t_Pa,p_Pa\n0,1e6,4e6\n0.1,-2e6,5e6\n0.4,0,2e6\n";

Prestress of_table(const std::filesystem::path& file, const PrestressTable& table) {
  return {.file = file.string(), .table = table};
}

TEST(PrestressTable, IsReadAndInterpolatedLinearly) {
  const test::TemporaryFolder folder;
  const auto file = folder / "table.csv";
  test::write_file(file, "# a comment\n\n" + rows);
  const auto table = read_prestress(file);
  EXPECT_THAT(table.rows.x_m, ::testing::ElementsAre(0, 0.1, 0.4));
  EXPECT_EQ(table.text, "# a comment\n\n" + rows);
  const auto state = prestress_at(of_table(file, table), {0, 0.05, 0.1, 0.2, 0.4});
  EXPECT_THAT(state.x_m, ::testing::ElementsAre(0, 0.05, 0.1, 0.2, 0.4));
  const double rounding = 1e-9;
  EXPECT_THAT(state.t_s_Pa, ::testing::Pointwise(::testing::DoubleNear(rounding),
                                                 std::vector<double>{1e6, -0.5e6, -2e6, -4e6 / 3, 0}));
  EXPECT_THAT(state.p_s_Pa, ::testing::Pointwise(::testing::DoubleNear(rounding),
                                                 std::vector<double>{4e6, 4.5e6, 5e6, 4e6, 2e6}));
}

TEST(PrestressTable, MustCoverTheInterface) {
  const test::TemporaryFolder folder;
  const auto file = folder / "table.csv";
  test::write_file(file, rows);
  const auto prestress = of_table(file, read_prestress(file));
  EXPECT_EQ(error_of([&] {
              prestress_at(prestress, {0, 0.5});
            }),
            "prestress.file: " + file.string() +
                ": covers x = 0 to 0.4 m, the interface reaches from 0 to 0.5 m; add rows");
  EXPECT_THAT(error_of([&] { prestress_at(prestress, {-0.1, 0.4}); }), HasSubstr("add rows"));
  // Rounding of positions is none of the user's business.
  EXPECT_EQ(prestress_at(prestress, {0, 0.4 + 1e-12}).p_s_Pa.back(), 2e6);
}

TEST(PrestressTable, ErrorsNameFileAndLine) {
  const test::TemporaryFolder folder;
  const auto file = folder / "table.csv";
  const auto error = [&](const std::string& text) {
    test::write_file(file, text);
    const std::string message = error_of([&] { read_prestress(file); });
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    const std::string start = "prestress.file: " + file.string();
    EXPECT_THAT(message, StartsWith(start));
    return message.substr(std::min(message.size(), start.size()));
  };
  const std::string header = "x_m,t_Pa,p_Pa\n";
  EXPECT_EQ(error("x_m,t_MPa,p_MPa\n"), ":1: the first line must be the header x_m,t_Pa,p_Pa");
  EXPECT_EQ(error("0,1e6,4e6\n"), ":1: the first line must be the header x_m,t_Pa,p_Pa");
  EXPECT_EQ(error("# note\n" + header + "0,1e6\n"), ":3: has 2 columns; a row is x_m,t_Pa,p_Pa");
  EXPECT_EQ(error(header + "0,1e6,4 MPa\n"), ":2: p_Pa is \"4 MPa\"; it must be a finite number");
  EXPECT_EQ(error(header + "0,inf,4e6\n"), ":2: t_Pa is \"inf\"; it must be a finite number");
  EXPECT_EQ(error(header + "0,,4e6\n"), ":2: t_Pa is \"\"; it must be a finite number");
  EXPECT_EQ(error(header + "0,0,4e6\n0,0,4e6\n"), ":3: x_m is 0 after 0; write the rows with x ascending");
  EXPECT_EQ(error(header + "0,0,0\n"),
            ":2: p_Pa is 0; it must be greater than 0, the interface starts in contact");
  EXPECT_EQ(error(header), ": holds no rows; write the header x_m,t_Pa,p_Pa and a row per position");
  EXPECT_EQ(error_of([&] { read_prestress(folder / "none.csv"); }),
            "prestress.file: " + (folder / "none.csv").string() +
                ": cannot be read (No such file or directory); check the path");
  EXPECT_THAT(error_of([&] { read_prestress(folder.path()); }),
              HasSubstr("is a folder; name the table in it"));
}

TEST(PrestressTable, NumbersAreReadRightOrRefused) {
  const test::TemporaryFolder folder;
  const auto file = folder / "table.csv";
  const auto pressure = [&](const std::string& text) {
    test::write_file(file, "x_m,t_Pa,p_Pa\n0,0," + text);
    return read_prestress(file).rows.p_s_Pa.at(0);
  };
  EXPECT_EQ(pressure("+4e6\n"), 4e6);
  EXPECT_EQ(pressure("4000000.\n"), 4e6);
  EXPECT_EQ(pressure("\t4E+6 \r\n"), 4e6);
  EXPECT_EQ(pressure("4e6"), 4e6);  // without an end of line
  for (const std::string wrong : {"nan",  "inf", "0x10", "1e999", "1e-999", "1 000",        "1\t2",
                                  "1e6e", "+-1", "++1",  "1_000", "1'000",  "\"1\"",        "1d6",
                                  "--1",  ".",   "e5",   "1\xa0", "1\r2",   "\xe2\x88\x92", "1 MPa"}) {
    const std::string message = error_of([&] { pressure(wrong + "\n"); });
    EXPECT_THAT(message, HasSubstr("table.csv:2: p_Pa is \"")) << wrong;
    EXPECT_THAT(message, HasSubstr("it must be a finite number"));
  }
  EXPECT_THAT(error_of([&] { pressure(std::string("1\0002", 3)); }), HasSubstr("\"1 2\"; it must be"));
  EXPECT_THAT(error_of([&] { pressure("1e200"); }), HasSubstr("its magnitude must be at most 1e+15"));
  EXPECT_THAT(error_of([&] { pressure("1e-200"); }), HasSubstr("it must be at least 1e-06"));
  const std::string long_line(3000000, '1');
  EXPECT_LT(error_of([&] { pressure(long_line); }).size(), 500U);
}

TEST(PrestressTable, CommentsLineEndsAndAByteOrderMarkArePassedOver) {
  const test::TemporaryFolder folder;
  const auto file = folder / "table.csv";
  test::write_file(file,
                   "\xef\xbb\xbf# in Latin-1: \xb5\r\n\r\nx_m, t_Pa, p_Pa\r\n  # more\r\n0, 1, 2\r\n1,3,4");
  const auto table = read_prestress(file);
  EXPECT_THAT(table.rows.t_s_Pa, ::testing::ElementsAre(1, 3));
  EXPECT_THAT(table.rows.p_s_Pa, ::testing::ElementsAre(2, 4));
}

TEST(PrestressTable, PathsAreRelativeToTheCaseFile) {
  const test::TemporaryFolder folder;
  const std::string keys =
      "[plate]\ncorner = \"none\"\n[event]\nkind = \"none\"\n[loading]\nmethod = \"prestress\"\n";
  test::write_file(folder / "c.toml", keys + "[prestress]\nfile = \"sub/table.csv\"\n");
  std::filesystem::create_directory(folder / "sub");
  test::write_file(folder / "sub/table.csv", rows);
  const auto elsewhere = (folder / "t.csv").string();
  test::write_file(elsewhere, rows);
  EXPECT_EQ(read_case(folder / "c.toml").prestress.file, (folder / "sub/table.csv").string());
  EXPECT_EQ(read_case(folder / "c.toml", {{"prestress.file", elsewhere}}).prestress.file, elsewhere);
  EXPECT_EQ(read_case(folder / "c.toml").prestress.table.text, rows);
}

}  // namespace
}  // namespace slipfront::input
