// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "papers/kammer2012/scorecard.hpp"

namespace slipfront::kammer2012 {

/// scorecard.json: a list of id, claim, paper, measured, holds (true, false, or null where not tested), how,
/// counts (whether the verdict is the claim's), figures; of second tests also second_test_of and why.
void write_scorecard(const std::filesystem::path& file, const std::vector<Claim>& claims);

/// analysis.json: the fit of V_tip/c_L against the energy rise with its intervals, the paper's fit, the
/// spreads against the three criteria, and for every study point the speeds, kinds of slip, changes against
/// the paper's runs, fit and spreads.
void write_analysis(const std::filesystem::path& file, const Reproduction& runs);

}  // namespace slipfront::kammer2012
