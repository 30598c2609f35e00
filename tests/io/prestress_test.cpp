// SPDX-License-Identifier: BSD-3-Clause
#include "io/prestress.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/schema.hpp"
#include "support.hpp"

namespace slipfront::io {
namespace {

using test::error_of;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string rows = "x_m,t_Pa,p_Pa\n0,1e6,4e6\n0.1,-2e6,5e6\n0.4,0,2e6\n";

TEST(PrestressTable, IsReadAndInterpolatedLinearly) {
  const test::TemporaryFolder folder;
  const auto file = folder / "table.csv";
  test::write_file(file, "# a comment\n\n" + rows);
  const auto table = read_prestress(file);
  EXPECT_THAT(table.x_m, ::testing::ElementsAre(0, 0.1, 0.4));
  const auto state = prestress_at(table, {0, 0.05, 0.1, 0.2, 0.4}, file);
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
  const auto table = read_prestress(file);
  EXPECT_EQ(error_of([&] {
              prestress_at(table, {0, 0.5}, file);
            }),
            "prestress.file: " + file.string() +
                ": covers x = 0 to 0.4 m, the interface reaches from 0 to 0.5 m; add rows");
  EXPECT_THAT(error_of([&] { prestress_at(table, {-0.1, 0.4}, file); }), HasSubstr("add rows"));
  // Rounding of positions is none of the user's business.
  EXPECT_EQ(prestress_at(table, {0, 0.4 + 1e-12}, file).p_s_Pa.back(), 2e6);
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
  EXPECT_EQ(error(header + "0,1e6,4 MPa\n"), ":2: p_Pa is \"4MPa\"; it must be a finite number");
  EXPECT_EQ(error(header + "0,inf,4e6\n"), ":2: t_Pa is \"inf\"; it must be a finite number");
  EXPECT_EQ(error(header + "0,,4e6\n"), ":2: t_Pa is \"\"; it must be a finite number");
  EXPECT_EQ(error(header + "0,0,4e6\n0,0,4e6\n"), ":3: x_m is 0 after 0; write the rows with x ascending");
  EXPECT_EQ(error(header + "0,0,0\n"),
            ":2: p_Pa is 0; it must be greater than 0, the interface starts in contact");
  EXPECT_EQ(error(header), ": holds no rows; write the header x_m,t_Pa,p_Pa and a row per position");
  EXPECT_EQ(error_of([&] { read_prestress(folder / "none.csv"); }),
            "prestress.file: " + (folder / "none.csv").string() + ": cannot be read; check the path");
  EXPECT_THAT(error_of([&] { read_prestress(folder.path()); }), HasSubstr("cannot be read"));
}

TEST(PrestressTable, PathsAreRelativeToTheCaseFile) {
  const test::TemporaryFolder folder;
  const std::string keys =
      "[plate]\ncorner = \"none\"\n[event]\nkind = \"none\"\n[loading]\nmethod = \"prestress\"\n";
  test::write_file(folder / "c.toml", keys + "[prestress]\nfile = \"sub/table.csv\"\n");
  EXPECT_EQ(read_case(folder / "c.toml").prestress.file, (folder / "sub/table.csv").string());
  EXPECT_EQ(read_case(folder / "c.toml", {{"prestress.file", "/t.csv"}}).prestress.file, "/t.csv");
}

}  // namespace
}  // namespace slipfront::io
