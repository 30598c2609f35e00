// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

namespace slipfront::input {

/// Measured front speeds against the static stress ratio, for comparison with Fig. 2 of the paper. [points]
struct Experiment {
  std::vector<double> static_ratio;  ///< local tau_s / sigma_s before slip
  std::vector<double> v_over_c_L;
};

/// Reads a CSV file with the columns static_ratio and v_over_c_L, or v_m_per_s, which is divided by
/// c_L_m_per_s. Lines that are empty or begin with # are passed over.
/// @throws UserError with file, line and what to do.
Experiment read_experiment(const std::filesystem::path& file, double c_L_m_per_s);

}  // namespace slipfront::input
