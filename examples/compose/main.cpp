// SPDX-License-Identifier: BSD-3-Clause
// Ruptures on a rigid plane, between two bodies, with a friction law and a loading of one's own.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "gradual_weakening.hpp"
#include "rupture.hpp"

namespace {

void print(const char* name, const std::vector<double>& first_s) {
  const auto n = std::ranges::count_if(first_s, [](double time_s) { return std::isfinite(time_s); });
  std::printf("%s: %td of %zu nodes slip\n", name, n, first_s.size());
}

}  // namespace

int main() {
  using slipfront::solid::Material;
  const Material pmma;
  const Material aluminium = {.youngs_modulus_Pa = 70e9, .poissons_ratio = 0.33, .density_kg_per_m3 = 2700};
  const slipfront::interface::SlipWeakening linear { .mu_s = 0.7, .mu_k = 0.4, .d_c_m = 4e-6 };
  print("rigid plane", rupture(linear, std::array{pmma}));
  print("two bodies", rupture(linear, std::array{pmma, aluminium}));
  print("own friction law", rupture(without_registry({}), std::array{pmma}));
  print("own loading", rupture(linear, std::array{pmma}, 30e-6));
}
