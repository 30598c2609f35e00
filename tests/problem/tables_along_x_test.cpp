// SPDX-License-Identifier: BSD-3-Clause
// Tractions and friction by tables, friction by random fields.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "input/friction_table.hpp"
#include "input/messages.hpp"
#include "input/prestress.hpp"
#include "interface/friction/velocity_weakening.hpp"
#include "problem/contact.hpp"

namespace slipfront::problem {

using namespace input;  // its tables are what is tested
namespace {

using interface::VelocityWeakening;
using test::error_of;
using ::testing::AllOf;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pointwise;
using ::testing::StartsWith;

const interface::FrictionLaw law = VelocityWeakening{1.3, 0.6, 0.1};
const std::string rows = "x_m,t_Pa,p_Pa\n0,1e6,4e6\n0.1,-2e6,5e6\n0.4,0,2e6\n";

std::vector<double> mu_k_at(const Case& config, const std::vector<double>& x_m) {
  std::vector<double> values;
  for (const auto& l : friction_at(make_problem(config), x_m))
    values.push_back(l.as<VelocityWeakening>().mu_k);
  return values;
}

/// A case whose mu_k is a random field.
Case with_random_mu_k() {
  Case c;
  c.friction = law;
  c.friction_along_x.random_key = "mu_k";
  return c;
}

/// A table whose text lacks what does not matter, what is wrong with it.
struct Wrong {
  const char *text, *error;
};

class Table : public testing::Test {
 protected:
  PrestressTable tractions(const std::string& text) const {
    test::write_file(file_, text);
    return read_prestress(file_);
  }
  FrictionTable friction(const std::string& text) const {
    test::write_file(file_, text);
    return read_friction_table(file_, law);
  }
  Prestress with_tractions(const std::string& text) const {
    return {.file = file_.string(), .table = tractions(text)};
  }
  Case with_friction(const std::string& text, BetweenRows between_rows = {}) const {
    Case c;
    c.friction = law;
    c.friction_along_x.file = file_.string();
    c.friction_along_x.table = friction(text);
    c.friction_along_x.between_rows = between_rows;
    return c;
  }

  test::TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_ / "table.csv";
};

TEST_F(Table, OfTractionsIsInterpolatedLinearly) {
  const auto prestress = with_tractions("# a comment\n\n" + rows);
  EXPECT_EQ(prestress.table.text, "# a comment\n\n" + rows);
  const std::vector<double> x_m = {0, 0.05, 0.1, 0.2, 0.4};
  const auto state = prestress_at(prestress, x_m);
  EXPECT_EQ(state.x_m, x_m);
  EXPECT_THAT(state.t_s_Pa, Pointwise(DoubleNear(1e-9), {1e6, -0.5e6, -2e6, -4e6 / 3, 0.0}));
  EXPECT_THAT(state.p_s_Pa, Pointwise(DoubleNear(1e-9), {4e6, 4.5e6, 5e6, 4e6, 2e6}));
}

TEST_F(Table, OfFrictionIsLinearOrStepwiseBetweenItsRows) {
  const std::string text = "# barrier\nx_m,mu_k\n0,0.6\n0.04,1.0\n0.08,0.8\n";
  const std::vector<double> x_m = {0, 0.01, 0.0399, 0.04 - 1e-16, 0.04, 0.06, 0.08};
  EXPECT_THAT(mu_k_at(with_friction(text), x_m),
              Pointwise(DoubleNear(1e-12), {0.6, 0.7, 0.999, 1.0, 1.0, 0.9, 0.8}));
  // A node at a row but for rounding has that row's value.
  EXPECT_THAT(mu_k_at(with_friction(text, BetweenRows::stepwise), x_m),
              ElementsAre(0.6, 0.6, 0.6, 1.0, 1.0, 1.0, 0.8));
}

TEST_F(Table, ParametersWithoutAColumnKeepTheCasesValues) {
  for (const auto& l :
       friction_at(make_problem(with_friction("x_m,alpha_m2_per_s2,mu_s\n0,0.2,1.4\n1,0.2,1.4\n")), {0, 1}))
    EXPECT_THAT(l.as<VelocityWeakening>(), testing::FieldsAre(1.4, 0.6, 0.2));
  EXPECT_TRUE(friction_at(make_problem(Case{}), {0, 1}).empty());
  EXPECT_TRUE(contact_model(make_problem(Case{}), {0, 1}).law_per_node.empty());
}

TEST_F(Table, MustCoverTheInterface) {
  const auto prestress = with_tractions(rows);
  const auto error = [&](std::vector<double> x_m) { return error_of([&] { prestress_at(prestress, x_m); }); };
  EXPECT_EQ(error({0, 0.5}), "prestress.file: " + file_.string() +
                                 ": covers x = 0 to 0.4 m, the interface reaches from 0 to 0.5 m; add rows");
  EXPECT_THAT(error({-0.1, 0.4}), HasSubstr("add rows"));
  // Rounding of positions is none of the user's business.
  EXPECT_EQ(prestress_at(prestress, {0, 0.4 + 1e-12}).p_s_Pa.back(), 2e6);
  const auto c = with_friction("x_m,mu_k\n0,0.6\n0.4,0.6\n");
  EXPECT_THAT(error_of([&] {
                friction_at(make_problem(c), {0, 0.5});
              }),
              StartsWith("friction.file: " + file_.string() + ": covers x = 0 to 0.4 m"));
  EXPECT_EQ(mu_k_at(c, {0, 0.4 + 1e-12}).back(), 0.6);
}

TEST_F(Table, ErrorsNameFileAndLine) {
  for (const auto& [text, error] : {
           Wrong{"x_m,t_MPa,p_MPa\n", ":1: the first line must be the header x_m,t_Pa,p_Pa"},
           {"0,1e6,4e6\n", ":1: the first line must be the header"},
           {"# note\nx_m,t_Pa,p_Pa\n0,1e6\n", ":3: has 2 columns; a row is x_m,t_Pa,p_Pa"},
           {"x_m,t_Pa,p_Pa\n0,inf,4e6\n", ":2: t_Pa is \"inf\"; it must be a finite number"},
           {"x_m,t_Pa,p_Pa\n0,,4e6\n", ":2: t_Pa is \"\"; it must be a finite number"},
           {"x_m,t_Pa,p_Pa\n0,0,4e6\n0,0,4e6\n", ":3: x_m is 0 after 0; write the rows with x ascending"},
           {"x_m,t_Pa,p_Pa\n0,0,0\n", ":2: p_Pa is 0; it must be greater than 0"},
           {"x_m,t_Pa,p_Pa\n", ": holds no rows"},
       })
    expect_message(error_of([&, &text = text] { tractions(text); }),
                   "prestress.file: " + file_.string() + error);
  for (const auto& [text, error] : {
           Wrong{"x,mu_s\n",
                 ":1: the first line must be the header x_m and any of mu_s, mu_k, alpha_m2_per_s2, "
                 "cohesion_Pa"},
           {"x_m\n0\n", ":1: the first line must be the header"},
           {"x_m,d_c_m\n", ":1: has a column \"d_c_m\"; the first line must be the header"},
           {"x_m,mu_s,mu_s\n", ":1: has the column mu_s twice"},
           {"# note\nx_m,mu_k\n0\n", ":3: has 1 columns; a row is x_m,mu_k"},
           {"x_m,mu_k\n0,0.5\n0,0.5\n", ":3: x_m is 0 after 0"},
           {"x_m,mu_k\n1e7,0.5\n", ":2: x_m is 10000000; its magnitude must be at most 1e+06"},
           {"x_m,mu_k\n0,-0.5\n", ":2: mu_k is -0.5; it must be at least 0 and at most 100"},
           {"x_m,mu_k\n0,1e-30\n", ":2: mu_k is 1e-30; its magnitude must be at least 1e-18"},
           {"x_m,cohesion_Pa\n0,-1\n", ":2: cohesion_Pa is -1; it must be at least 0"},
           {"x_m,mu_k\n", ": holds no rows"},
       })
    expect_message(error_of([&, &text = text] { friction(text); }),
                   "friction.file: " + file_.string() + error);
  expect_message(error_of([&] { read_prestress(folder_ / "none.csv"); }),
                 "prestress.file: " + (folder_ / "none.csv").string(), ": cannot be read (No such file");
  EXPECT_THAT(error_of([&] { read_prestress(folder_.path()); }), HasSubstr("is a folder"));
}

TEST_F(Table, NumbersAreReadRightOrRefused) {
  const auto pressure = [&](const std::string& text) {
    return tractions("x_m,t_Pa,p_Pa\n0,0," + text).rows.p_s_Pa.at(0);
  };
  for (const char* right : {"+4e6\n", "4000000.\n", "\t4E+6 \r\n", "4e6"}) EXPECT_EQ(pressure(right), 4e6);
  for (const std::string wrong : {"nan",  "inf", "0x10", "1e999", "1e-999", "1 000",        "1\t2",
                                  "1e6e", "+-1", "++1",  "1_000", "1'000",  "\"1\"",        "1d6",
                                  "--1",  ".",   "e5",   "1\xa0", "1\r2",   "\xe2\x88\x92", "1 MPa"})
    EXPECT_THAT(error_of([&] { pressure(wrong + "\n"); }),
                AllOf(HasSubstr("table.csv:2: p_Pa is \""), HasSubstr("it must be a finite number")))
        << wrong;
  EXPECT_THAT(error_of([&] { pressure(std::string("1\0002", 3)); }), HasSubstr("\"1 2\"; it must be"));
  EXPECT_THAT(error_of([&] { pressure("1e200"); }), HasSubstr("its magnitude must be at most 1e+15"));
  EXPECT_THAT(error_of([&] { pressure("1e-200"); }), HasSubstr("it must be at least 1e-06"));
  EXPECT_LT(error_of([&] { pressure(std::string(3000000, '1')); }).size(), 500U);
}

TEST_F(Table, CommentsLineEndsAndAByteOrderMarkArePassedOver) {
  const auto table =
      tractions("\xef\xbb\xbf# in Latin-1: \xb5\r\n\r\nx_m, t_Pa, p_Pa\r\n  # more\r\n0, 1, 2\r\n1,3,4");
  EXPECT_THAT(table.rows.t_s_Pa, ElementsAre(1, 3));
  EXPECT_THAT(table.rows.p_s_Pa, ElementsAre(2, 4));
}

TEST_F(Table, PathsAreRelativeToTheCaseFile) {
  const auto in_case = folder_ / "c.toml", table = folder_ / "sub/table.csv", elsewhere = folder_ / "t.csv";
  std::filesystem::create_directory(folder_ / "sub");
  for (const auto& file : {table, elsewhere}) test::write_file(file, rows);
  test::write_file(in_case,
                   "plate.corner = \"none\"\nevent.kind = \"none\"\nloading.method = \"prestress\"\n"
                   "prestress.file = \"sub/table.csv\"\n");
  EXPECT_EQ(read_case(in_case).prestress.file, table.string());
  EXPECT_EQ(read_case(in_case).prestress.table.text, rows);
  EXPECT_EQ(read_case(in_case, {{"prestress.file", elsewhere.string()}}).prestress.file, elsewhere.string());

  test::write_file(table, "x_m,mu_s\n0,1\n");
  test::write_file(in_case, "[friction]\nfile = \"sub/table.csv\"\nbetween_rows = \"stepwise\"\n");
  const auto along_x = read_case(in_case).friction_along_x;
  EXPECT_EQ(along_x.file, table.string());
  EXPECT_EQ(along_x.table.text, "x_m,mu_s\n0,1\n");
  EXPECT_EQ(along_x.between_rows, BetweenRows::stepwise);
}

TEST(FrictionAlongX, KeysThatDoNothingAreRefused) {
  for (const auto& [line, error] :
       {Wrong{"between_rows = \"linear\"", "between_rows applies only with friction.file"},
        {"random_seed = 3", "random_seed applies only with friction.random_key other than none"},
        {"random_key = \"alpha_m2_per_s2\"",
         "random_key is alpha_m2_per_s2; the friction law slip_weakening has mu_s, mu_k, "},
        {"random_key = \"mu_x\"", "random_key is \"mu_x\"; it must be one of none, mu_s, mu_k"}})
    expect_message(parse_error(std::string("[friction]\n") + line),
                   std::string("c.toml:2: friction.") + error);
}

TEST_F(Table, IsMultipliedByTheRandomField) {
  auto c = with_friction("x_m,mu_k\n0,0.4\n0.1,0.8\n");
  c.friction_along_x.random_key = "mu_k";
  c.friction_along_x.random_share = 0;
  const std::vector<double> x_m = {0, 0.05, 0.1};
  EXPECT_THAT(mu_k_at(c, x_m), Pointwise(DoubleNear(1e-15), {0.4, 0.6, 0.8}));
  c.friction_along_x.random_share = 0.01;
  const auto with_both = mu_k_at(c, x_m);
  c.friction_along_x.file.clear();
  const auto random = mu_k_at(c, x_m);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(with_both[i] / (0.4 + 4 * x_m[i]), random[i] / 0.6, 1e-14);
    EXPECT_NE(random[i], 0.6);
  }
  c.friction_along_x.random_seed = 2;
  EXPECT_NE(mu_k_at(c, x_m), random);
}

TEST(FrictionAlongX, RepeatsWithThePlate) {
  auto c = with_random_mu_k();
  c.plate.width_m = 0.1;
  const auto difference = [&] {
    const auto mu_k = mu_k_at(c, {0, 0.1});
    return std::abs(mu_k[1] - mu_k[0]);
  };
  EXPECT_GT(difference(), 1e-3);
  c.plate.sides = mesh::Sides::periodic;
  EXPECT_LT(difference(), 1e-12);
}

TEST(FrictionAlongX, NodesThatAreNotAllowedAreNamed) {
  auto c = with_random_mu_k();
  c.friction_along_x.random_share = 5;
  std::vector<double> x_m;
  for (int i = 0; i <= 100; ++i) x_m.push_back(1e-2 * i);
  expect_message(error_of([&] { friction_at(make_problem(c), x_m); }),
                 "friction.random_share: at x = ", " m mu_k ");
}

}  // namespace
}  // namespace slipfront::problem
