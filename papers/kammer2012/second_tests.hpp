// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "papers/kammer2012/scorecard.hpp"

namespace slipfront::kammer2012 {

/// Better tests of claims that the first one misjudges: C11b, C18b and C18c, C19b, C20b, C22b. Each names its
/// first test and why that misjudges the claim. With C22b stand the halves of its sentence, for comparison.
/// @param first  rows of the first tests, for the claims' wording
std::vector<Claim> second_tests(const Reproduction& runs, std::span<const Claim> first);

/// Whether a row is the test that was there first for its claim.
bool is_first_test(const Claim& claim);

/// Decides which row's verdict counts for its claim: that of the first of its second tests that was done,
/// else that of the first test. Rows that are only further tests do not count.
void choose_verdicts(std::span<Claim> claims);

}  // namespace slipfront::kammer2012
