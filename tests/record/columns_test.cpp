// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "record/energies.hpp"
#include "record/record.hpp"
#include "support/files.hpp"

namespace slipfront::record {
namespace {

using ::testing::HasSubstr;

std::string page(const std::string& name) {
  return test::read_file(std::string(SLIPFRONT_SOURCE_DIR) + "/docs/" + name);
}

template <class T>
std::string row_of(const T& column) {
  return std::string("| `") + column.name + "` | " + column.unit + " | " + column.description + " |\n";
}

TEST(Columns, AreThoseOfThePage) {
  std::string history = row_of(history_time) + row_of(history_place), energies = row_of(energy_time);
  for (const auto& field : history_fields) history += row_of(field);
  for (const auto& term : energy_terms) energies += row_of(term);
  EXPECT_THAT(page("files.md"), HasSubstr("|---|---|---|\n" + history + "\n"));
  EXPECT_THAT(page("files.md"), HasSubstr("|---|---|---|\n" + energies + "| `" + imbalance_name + "`"));
}

TEST(Columns, NamesEndWithTheUnit) {
  const auto ends_with_unit = [](const auto& column) {
    std::string unit = column.unit;
    if (const auto slash = unit.find('/'); slash != std::string::npos) unit.replace(slash, 1, "_per_");
    return std::string(column.name).ends_with("_" + unit);
  };
  EXPECT_TRUE(ends_with_unit(history_time) && ends_with_unit(history_place) && ends_with_unit(energy_time));
  EXPECT_TRUE(std::ranges::all_of(history_fields, ends_with_unit));
  EXPECT_TRUE(std::ranges::all_of(energy_terms, ends_with_unit));
}

/// Energies that are all different: 1 of the first term, 2 of the second, 4 ...
Energies powers_of_two() {
  Energies e;
  double value = 1;
  for (const auto& term : energy_terms) {
    e.*term.member = value;
    value *= 2;
  }
  return e;
}

TEST(Energies, TheTableNamesEveryMemberOnce) {
  // A member besides the time that the table lacked would make the struct longer.
  EXPECT_EQ(sizeof(Energies), (1 + energy_terms.size()) * sizeof(double));
  const auto e = powers_of_two();
  double value = 1;
  for (const auto& term : energy_terms) {
    EXPECT_EQ(e.*term.member, value) << term.name << " stands for another one's member";
    value *= 2;
  }
}

TEST(Energies, StrainMotionAndTheMachineAreStored) {
  const auto e = powers_of_two();
  EXPECT_EQ(e.stored(), e.strain + e.kinetic + e.machine);
  EXPECT_EQ(e.work(), 2047 - e.stored());
}

TEST(Energies, TermsAreAddedAndTheTimeStays) {
  auto sum = powers_of_two();
  sum.time_s = 1;
  auto more = powers_of_two();
  more.time_s = 5;
  add_terms(sum, more);
  EXPECT_EQ(sum.time_s, 1);
  for (const auto& term : energy_terms) EXPECT_EQ(sum.*term.member, 2 * (more.*term.member)) << term.name;
}

struct Counter {
  std::vector<double> values;
  template <class... T>
  void operator()(const T&... value) {
    (values.push_back(value), ...);
  }
};

TEST(Energies, AreKeptWithAllTheirTerms) {
  auto e = powers_of_two();
  e.time_s = -1;
  Counter archive;
  e.serialize(archive);
  EXPECT_EQ(archive.values.size(), 1 + energy_terms.size());
  std::ranges::sort(archive.values);
  EXPECT_EQ(archive.values.front(), -1);
  for (std::size_t k = 1; k < archive.values.size(); ++k) EXPECT_EQ(archive.values[k], 1 << (k - 1));
}

TEST(History, TheTableNamesEveryMember) {
  EXPECT_EQ(sizeof(History), (3 + history_fields.size()) * sizeof(std::vector<double>));
  EXPECT_EQ(history_row_values(10, 2), 1 + 10 * (history_fields.size() + 2));
}

TEST(History, RowsAreThoseOfThePage) {
  std::string rows = "per row `" + std::string(history_time.name) + "`, then ";
  for (std::size_t k = 0; k < history_fields.size(); ++k)
    rows += (k == 0                          ? "`"
             : k + 1 < history_fields.size() ? ", `"
                                             : " and `") +
            std::string(history_fields[k].name) + "`";
  EXPECT_THAT(page("checkpoints.md"), HasSubstr(rows + " at all nodes"));
}

}  // namespace
}  // namespace slipfront::record
