// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "record/record.hpp"

// Arrivals of another code, see cases/reference/data/README.md.
namespace slipfront::test {

inline const std::filesystem::path reference =
    std::filesystem::path(SLIPFRONT_SOURCE_DIR) / "cases/reference";

/// First time at which the slip rate at each node passes 1 mm/s, linear between the samples.
inline std::vector<double> arrivals(const record::History& h) {
  const std::size_t n = h.x_m.size();
  std::vector<double> times(n, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 1; k < h.time_s.size(); ++k) {
      const double before = h.slip_rate_m_per_s[(k - 1) * n + i], now = h.slip_rate_m_per_s[k * n + i];
      if (now <= 1e-3) continue;
      const double part = before < 1e-3 ? (1e-3 - before) / (now - before) : 0;
      times[i] = h.time_s[k - 1] + part * (h.time_s[k] - h.time_s[k - 1]);
      break;
    }
  return times;
}

/// Arrivals of another code by position in mm.
inline std::map<int, double> reference_arrivals(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line, field;
  std::getline(stream, line);
  std::istringstream header(line);
  int column = -1;
  while (field != "t_slip_uguca_extrap_s" && std::getline(header, field, ',')) ++column;
  std::map<int, double> times;
  while (std::getline(stream, line)) {
    std::istringstream row(line);
    std::string x, value;
    std::getline(row, x, ',');
    for (int k = 0; k < column; ++k) std::getline(row, value, ',');
    times[static_cast<int>(std::lround(1e3 * std::stod(x)))] = std::stod(value);
  }
  EXPECT_FALSE(times.empty()) << file;
  return times;
}

/// Largest difference of arrivals for 60 mm <= |x| <= 140 mm, x from the patch's centre.
inline double largest_difference_s(const record::History& h, double centre_m,
                                   const std::map<int, double>& expected) {
  const auto times = arrivals(h);
  double largest = 0;
  for (std::size_t i = 0; i < h.x_m.size(); ++i) {
    const double x_mm = 1e3 * (h.x_m[i] - centre_m);
    if (std::abs(x_mm) < 59.5 || std::abs(x_mm) > 140.5) continue;
    largest = std::max(largest, std::abs(times[i] - expected.at(static_cast<int>(std::lround(x_mm)))));
  }
  return largest;
}

}  // namespace slipfront::test
