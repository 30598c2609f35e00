// SPDX-License-Identifier: BSD-3-Clause
#include "input/friction_along_x.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "input/schema.hpp"
#include "interface/friction/slip_weakening.hpp"
#include "interface/friction/velocity_weakening.hpp"
#include "support/files.hpp"

namespace slipfront::input {
namespace {

using interface::VelocityWeakening;
using test::error_of;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const interface::FrictionLaw law = VelocityWeakening{1.3, 0.6, 0.1};

Case with_table(const test::TemporaryFolder& folder, const std::string& text, BetweenRows between_rows = {}) {
  const auto file = folder / "table.csv";
  test::write_file(file, text);
  Case c;
  c.friction = law;
  c.friction_along_x.file = file.string();
  c.friction_along_x.table = read_friction_table(file, law);
  c.friction_along_x.between_rows = between_rows;
  return c;
}

std::vector<double> mu_k_at(const Case& config, const std::vector<double>& x_m) {
  std::vector<double> values;
  for (const auto& l : friction_at(config, x_m)) values.push_back(l.as<VelocityWeakening>().mu_k);
  return values;
}

TEST(FrictionTable, IsLinearOrStepwiseBetweenItsRows) {
  const test::TemporaryFolder folder;
  const std::string text = "# barrier\nx_m,mu_k\n0,0.6\n0.04,1.0\n0.08,0.8\n";
  const std::vector<double> x_m = {0, 0.01, 0.0399, 0.04 - 1e-16, 0.04, 0.06, 0.08};
  EXPECT_THAT(mu_k_at(with_table(folder, text), x_m),
              ::testing::Pointwise(::testing::DoubleNear(1e-12),
                                   std::vector<double>{0.6, 0.7, 0.999, 1.0, 1.0, 0.9, 0.8}));
  // A node at a row but for rounding has that row's value.
  EXPECT_THAT(mu_k_at(with_table(folder, text, BetweenRows::stepwise), x_m),
              ::testing::ElementsAre(0.6, 0.6, 0.6, 1.0, 1.0, 1.0, 0.8));
}

TEST(FrictionTable, OtherParametersKeepTheCasesValues) {
  const test::TemporaryFolder folder;
  const auto laws =
      friction_at(with_table(folder, "x_m,alpha_m2_per_s2,mu_s\n0,0.2,1.4\n1,0.2,1.4\n"), {0, 1});
  for (const auto& l : laws) {
    EXPECT_EQ(l.as<VelocityWeakening>().mu_s, 1.4);
    EXPECT_EQ(l.as<VelocityWeakening>().mu_k, 0.6);
    EXPECT_EQ(l.as<VelocityWeakening>().alpha_m2_per_s2, 0.2);
  }
}

TEST(FrictionTable, ACaseWithoutOneHasNoLawsOfNodes) {
  EXPECT_TRUE(friction_at(Case{}, {0, 1}).empty());
  EXPECT_TRUE(contact_model(Case{}, {0, 1}).of_nodes.empty());
}

TEST(FrictionTable, MustCoverTheInterface) {
  const test::TemporaryFolder folder;
  const auto c = with_table(folder, "x_m,mu_k\n0,0.6\n0.4,0.6\n");
  EXPECT_EQ(error_of([&] {
              friction_at(c, {0, 0.5});
            }),
            "friction.file: " + c.friction_along_x.file +
                ": covers x = 0 to 0.4 m, the interface reaches from 0 to 0.5 m; add rows");
  EXPECT_THAT(error_of([&] { friction_at(c, {-0.1, 0.4}); }), HasSubstr("add rows"));
  EXPECT_EQ(mu_k_at(c, {0, 0.4 + 1e-12}).back(), 0.6);
}

TEST(FrictionTable, ErrorsNameFileAndLine) {
  const test::TemporaryFolder folder;
  const auto file = folder / "table.csv";
  const auto error = [&](const std::string& text) {
    test::write_file(file, text);
    const std::string message = error_of([&] { read_friction_table(file, law); });
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    const std::string start = "friction.file: " + file.string();
    EXPECT_THAT(message, StartsWith(start));
    return message.substr(std::min(message.size(), start.size()));
  };
  const std::string header = "the first line must be the header x_m and any of mu_s, mu_k, alpha_m2_per_s2";
  EXPECT_EQ(error("x,mu_s\n"), ":1: " + header);
  EXPECT_EQ(error("x_m\n0\n"), ":1: " + header);
  EXPECT_EQ(error("x_m,d_c_m\n"), ":1: has a column \"d_c_m\"; " + header);
  EXPECT_EQ(error("x_m,mu_s,mu_s\n"), ":1: has the column mu_s twice; remove one");
  EXPECT_EQ(error("# note\nx_m,mu_k\n0\n"), ":3: has 1 columns; a row is x_m,mu_k");
  EXPECT_EQ(error("x_m,mu_k\n1e7,0.5\n"), ":2: x_m is 10000000; its magnitude must be at most 1e+06");
  EXPECT_EQ(error("x_m,mu_k\n0,-0.5\n"), ":2: mu_k is -0.5; it must be at least 0 and at most 100");
  EXPECT_EQ(error("x_m,mu_k\n0,1e-30\n"),
            ":2: mu_k is 1e-30; its magnitude must be at least 1e-18 and at most 1e+09");
  EXPECT_THAT(error("x_m,mu_k\n0,1.31\n"), StartsWith(":2: mu_k must be at most mu_s"));
  EXPECT_THAT(error("x_m,mu_k\n"), StartsWith(": holds no rows"));
}

TEST(FrictionTable, PathsAreRelativeToTheCaseFile) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder / "sub");
  test::write_file(folder / "c.toml", "[friction]\nfile = \"sub/f.csv\"\nbetween_rows = \"stepwise\"\n");
  test::write_file(folder / "sub/f.csv", "x_m,mu_s\n0,1\n");
  const auto along_x = read_case(folder / "c.toml").friction_along_x;
  EXPECT_EQ(along_x.file, (folder / "sub/f.csv").string());
  EXPECT_EQ(along_x.table.text, "x_m,mu_s\n0,1\n");
  EXPECT_EQ(along_x.between_rows, BetweenRows::stepwise);
}

TEST(FrictionAlongX, KeysThatDoNothingAreRefused) {
  const auto error = [](const std::string& text) { return error_of([&] { parse_case(text, "c.toml"); }); };
  EXPECT_EQ(error("[friction]\nbetween_rows = \"linear\""),
            "c.toml:2: friction.between_rows applies only with friction.file; remove the key or set that");
  EXPECT_EQ(
      error("[friction]\nrandom_seed = 3"),
      "c.toml:2: friction.random_seed applies only with friction.random_key other than none; remove the key "
      "or set that");
  EXPECT_EQ(error("[friction]\nrandom_key = \"d_c_m\""),
            "c.toml:2: friction.random_key is d_c_m; the friction law velocity_weakening has mu_s, mu_k, "
            "alpha_m2_per_s2");
  EXPECT_THAT(error("[friction]\nrandom_key = \"mu_x\""), HasSubstr("it must be one of none, mu_s, mu_k"));
}

TEST(FrictionAlongX, TheFieldMultipliesTheTable) {
  const test::TemporaryFolder folder;
  auto c = with_table(folder, "x_m,mu_k\n0,0.4\n0.1,0.8\n");
  c.friction_along_x.random_key = "mu_k";
  c.friction_along_x.random_share = 0;
  const std::vector<double> x_m = {0, 0.05, 0.1};
  EXPECT_THAT(mu_k_at(c, x_m), ::testing::Pointwise(::testing::DoubleNear(1e-15), {0.4, 0.6, 0.8}));
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
  Case c;
  c.friction = law;
  c.friction_along_x.random_key = "mu_k";
  c.plate.width_m = 0.1;
  const std::vector<double> x_m = {0, 0.1};
  EXPECT_GT(std::abs(mu_k_at(c, x_m)[1] - mu_k_at(c, x_m)[0]), 1e-3);
  c.plate.sides = mesh::Sides::periodic;
  EXPECT_NEAR(mu_k_at(c, x_m)[1], mu_k_at(c, x_m)[0], 1e-12);
}

TEST(FrictionAlongX, NodesThatAreNotAllowedAreNamed) {
  Case c;
  c.friction = law;
  c.friction_along_x.random_key = "mu_k";
  c.friction_along_x.random_share = 5;
  std::vector<double> x_m;
  for (int i = 0; i <= 100; ++i) x_m.push_back(1e-2 * i);
  const auto message = error_of([&] { friction_at(c, x_m); });
  EXPECT_THAT(message, StartsWith("friction.random_share: at x = "));
  EXPECT_THAT(message, HasSubstr(" m mu_k "));
  EXPECT_THAT(message, HasSubstr("; choose a smaller share"));
}

}  // namespace
}  // namespace slipfront::input
