// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "fronts/fit.hpp"

// How the files of studies and analyses show a number that may be undefined.
namespace slipfront::kammer2012 {

inline nlohmann::ordered_json number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

/// An estimate with its interval.
inline nlohmann::ordered_json number(const fronts::Estimate& e) {
  return {{"value", number(e.value)}, {"low", number(e.low)}, {"high", number(e.high)}};
}

/// Of a CSV table: empty where undefined.
inline std::string cell(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : std::string();
}

}  // namespace slipfront::kammer2012
