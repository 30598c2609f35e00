// SPDX-License-Identifier: BSD-3-Clause
#include "motion/step_report.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace slipfront::motion {
namespace {

constexpr std::size_t n_around = 3;
constexpr int n_reported = 4, n_reported_substeps = 2, sampled_rows = 2, sampled_fields = 5;

/// Of nodes [first, first + n): each value tells where it belongs.
StepReport of_nodes(int first, int n, int n_probes) {
  StepReport report;
  report.memory.time_s = 7;
  for (int node = first; node < first + n; ++node) {
    report.memory.t_Pa.push_back(node);
    report.memory.p_Pa.push_back(100 + node);
    report.memory.strength_Pa.push_back(200 + node);
    report.memory.slipping.push_back(static_cast<std::uint8_t>(node % 2));
  }
  for (int step = 0; step < n_reported; ++step)
    report.rates.push_back({first != 5 || step != 2, static_cast<double>(first * (step % 2)), 0.5 * first});
  for (int update = 0; update < n_reported * n_reported_substeps; ++update) {
    SlipUpdate seen;
    seen.time_s = update;
    seen.moves = update == first;
    for (int node = first; node < first + n; ++node) {
      if ((node + update) % 3 != 0) continue;
      seen.changes.push_back({node, (node + update) % 2 == 0, 10.0 * update, 0.25});
      if (!seen.changes.back().begins) continue;
      for (std::size_t k = 0; k < n_around; ++k)
        seen.around.push_back({100.0 * update + node, static_cast<double>(k)});
    }
    report.seen.add(seen);
  }
  report.samples.resize(sampled_fields);
  for (std::size_t f = 0; f < report.samples.size(); ++f)
    for (int row = 0; row < sampled_rows; ++row)
      for (int node = first; node < first + n; ++node)
        report.samples[f].push_back(1e4 * static_cast<double>(f) + 100 * row + node);
  for (int step = 0; step < n_reported; ++step)
    for (int k = 0; k < 8 * n_probes; ++k) report.displacements.push_back(1000 * first + 100 * step + k);
  return report;
}

/// All numbers, list by list, each after its length.
std::vector<double> numbers_of(const StepReport& report) {
  std::vector<double> all;
  const auto add = [&](const auto& values, const auto&... members) {
    all.push_back(static_cast<double>(values.size()));
    for (const auto& value : values) (all.push_back(static_cast<double>(value.*members)), ...);
  };
  const auto add_plain = [&](const auto& values) {
    all.push_back(static_cast<double>(values.size()));
    all.insert(all.end(), values.begin(), values.end());
  };
  const auto& [memory, rates, seen, samples, displacements, is_interrupted] = report;
  all.push_back(is_interrupted);
  all.push_back(memory.time_s);
  add_plain(memory.t_Pa);
  add_plain(memory.p_Pa);
  add_plain(memory.strength_Pa);
  add_plain(memory.slipping);
  add(rates, &SlipRates::finite, &SlipRates::fastest_m_per_s, &SlipRates::fastest_slipping_m_per_s);
  add_plain(seen.time_s);
  add_plain(seen.moves);
  add_plain(seen.update);
  add(seen.changes, &SlipChange::node, &SlipChange::begins, &SlipChange::time_s, &SlipChange::share);
  add(seen.around, &record::Traction::t_Pa, &record::Traction::p_Pa);
  for (const auto& field : samples) add_plain(field);
  add_plain(displacements);
  return all;
}

StepReport joined(const std::vector<StepReport>& parts) {
  std::vector<MessageBuffer> messages;
  for (const auto& part : parts) messages.push_back(packed(part));
  return StepReport::joined(std::move(messages));
}

TEST(StepReport, OfPartsAreThoseOfAllNodes) {
  const std::vector<StepReport> parts = {of_nodes(0, 5, 0), of_nodes(5, 1, 0), of_nodes(6, 7, 0)};
  auto all = of_nodes(0, 13, 0);
  for (int k = 0; k < n_reported; ++k) all.rates[static_cast<std::size_t>(k)] = {k != 2, 6.0 * (k % 2), 3};
  all.seen.moves = {1, 0, 0, 0, 0, 1, 1, 0};
  EXPECT_EQ(numbers_of(joined(parts)), numbers_of(all));
}

TEST(StepReport, HasTheProbesOfAllPartsInEachStepAndWhatOneIsToldToEnd) {
  std::vector<StepReport> parts = {of_nodes(0, 5, 1), of_nodes(5, 1, 0), of_nodes(6, 7, 2),
                                   of_nodes(13, 2, 1)};
  EXPECT_FALSE(joined(parts).is_interrupted);
  parts.front().is_interrupted = true;
  const auto all = joined(parts);
  EXPECT_TRUE(all.is_interrupted);
  // Probes of all parts in each step.
  ASSERT_EQ(all.displacements.size(), n_reported * 32U);
  EXPECT_EQ(all.displacements[32 * 3 + 0], 300);
  EXPECT_EQ(all.displacements[32 * 3 + 8], 6300);
  EXPECT_EQ(all.displacements[32 * 3 + 23], 6315);
}

}  // namespace
}  // namespace slipfront::motion
