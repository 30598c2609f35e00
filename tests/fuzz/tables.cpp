// SPDX-License-Identifier: BSD-3-Clause
// Tables of tractions and of friction: what is taken must hold what their readers promise.
#include <cmath>

#include "fuzz.hpp"
#include "input/friction_table.hpp"
#include "input/prestress.hpp"
#include "interface/friction/slip_weakening.hpp"

using namespace slipfront;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::Scratch scratch;
  const auto file = scratch.write("table.csv", fuzz::text_of(data, size));
  fuzz::takes([&] {
    const auto table = input::read_prestress(file).rows;
    const std::size_t n = table.x_m.size();
    fuzz::require(n > 0 && table.t_s_Pa.size() == n && table.p_s_Pa.size() == n, "columns differ in length");
    for (std::size_t k = 0; k < n; ++k)
      fuzz::require(std::isfinite(table.x_m[k]) && std::isfinite(table.t_s_Pa[k]) &&
                        std::isfinite(table.p_s_Pa[k]) && table.p_s_Pa[k] > 0 &&
                        (k == 0 || table.x_m[k] > table.x_m[k - 1]),
                    "a row that should be refused");
  });
  fuzz::takes([&] {
    const auto table = input::read_friction_table(file, interface::SlipWeakening{});
    fuzz::require(!table.x_m.empty() && !table.keys.empty() && table.values.size() == table.keys.size(),
                  "columns that are missing");
    for (const auto& values : table.values) {
      fuzz::require(values.size() == table.x_m.size(), "columns differ in length");
      for (const double value : values)
        fuzz::require(value >= 0 && value <= 1e3, "a parameter that should be refused");
    }
  });
  return 0;
}
