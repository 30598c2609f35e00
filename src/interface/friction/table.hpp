// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <span>

#include "base/lanes.hpp"
#include "base/message.hpp"
#include "interface/friction/parameter.hpp"

namespace slipfront::interface {

/// mu as the case file's table gives it, linear between rows and constant after the last, over the slip path
/// (memory lasting) or over the slip rate (memory none).
template <SlipMemory slip_memory>
struct FrictionTableLaw {
  static constexpr bool over_slip = slip_memory == SlipMemory::lasting;
  static constexpr const char* name = over_slip ? "slip_table" : "slip_rate_table";
  static constexpr const char* help =
      over_slip ? "mu over the slip path, by a table" : "mu over the slip rate, by a table";
  static constexpr SlipMemory memory = slip_memory;
  static constexpr std::size_t max_rows = 32;

  static constexpr std::array<double, 3> default_at =
      over_slip ? std::array{0.0, 2e-6, 1e-5} : std::array{0.0, 0.1, 1.0};
  static constexpr std::array<double, 3> default_mu = {0.6, 0.4, 0.3};
  double mu_factor = 1;
  std::span<const double> at = default_at;  ///< slip paths in m, or slip rates in m/s
  std::span<const double> mu = default_mu;

  static constexpr std::array<Parameter<FrictionTableLaw>, 1> parameters() {
    return {{{"mu_factor", &FrictionTableLaw::mu_factor, 0, 100, "multiplies table_mu"}}};
  }
  static constexpr std::array<ListParameter<FrictionTableLaw>, 2> lists() {
    return {{{over_slip ? "table_slip_m" : "table_slip_rate_m_per_s", &FrictionTableLaw::at, 0, 1e6,
              over_slip ? "slip path" : "slip rate"},
             {"table_mu", &FrictionTableLaw::mu, 0, 100, "friction coefficient there"}}};
  }
  Message inconsistency() const {
    const Key rows(over_slip ? "friction.table_slip_m" : "friction.table_slip_rate_m_per_s");
    const Key coefficients("friction.table_mu");
    if (at.size() < 2 || at.size() > max_rows || at.size() != mu.size())
      return Message("{} and {} must be of one length, 2 to {} numbers", rows, coefficients, max_rows);
    if (at.front() != 0 || std::ranges::adjacent_find(at, std::greater_equal()) != at.end())
      return Message("{} must begin with 0 and ascend", rows);
    return {};
  }

  double static_coefficient() const { return mu_factor * mu.front(); }
  double kinetic_coefficient() const { return mu_factor * std::ranges::min(mu); }

  /// With the slip rate.
  bool strengthens() const requires(!over_slip) {
    return std::ranges::adjacent_find(mu, std::less()) != mu.end();
  }

  /// Twice what mu exceeds its least by, over the slip until it is least, through the whole drop.
  double weakening_slip_m() const requires over_slip {
    const auto least_at = static_cast<std::size_t>(std::ranges::min_element(mu) - mu.begin());
    const double least = mu[least_at];
    double area_m = 0;
    for (std::size_t k = 0; k < least_at; ++k)
      area_m += (0.5 * (mu[k] + mu[k + 1]) - least) * (at[k + 1] - at[k]);
    return mu.front() > least ? 2 * area_m / (mu.front() - least) : at.back();
  }

  /// Every row's share of the way to the next, from 0 to 1, times what mu loses there: without a search, the
  /// same for all nodes. Rows that the table has not lose nothing.
  template <class V>
  struct Evaluator {
    using Rows = std::array<V, max_rows - 1>;
    V at_rest, least;
    Rows from, per_width, drop;

    V operator()(V speed_m_per_s, V slip_m) const {
      const V x = over_slip ? slip_m : speed_m_per_s;
      V value = at_rest;
      for (std::size_t k = 0; k < from.size(); ++k) {
        const V share = positive_part((x - from[k]) * per_width[k]);
        value -= drop[k] * select(share < 1, share, V{} + 1);
      }
      return select(value < least, least, value);  // by rounding alone
    }
    V slope_s_per_m(V speed_m_per_s, V /*slip_m*/) const {
      V slope{};
      if constexpr (!over_slip)
        for (std::size_t k = 0; k < from.size(); ++k) {
          const V share = (speed_m_per_s - from[k]) * per_width[k];
          slope -= select(share >= 0 && share < 1, drop[k] * per_width[k], V{});
        }
      return slope;
    }
  };
  Evaluator<double> evaluator() const {
    Evaluator<double> e{static_coefficient(), kinetic_coefficient(), {}, {}, {}};
    for (std::size_t k = 0; k + 1 < at.size(); ++k) {
      e.from[k] = at[k];
      e.per_width[k] = 1 / (at[k + 1] - at[k]);
      e.drop[k] = mu_factor * (mu[k] - mu[k + 1]);
    }
    return e;
  }
};

using SlipTable = FrictionTableLaw<SlipMemory::lasting>;
using SlipRateTable = FrictionTableLaw<SlipMemory::none>;

}  // namespace slipfront::interface
