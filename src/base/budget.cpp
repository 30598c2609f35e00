// SPDX-License-Identifier: BSD-3-Clause
#include "base/budget.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/memory.hpp"

namespace slipfront {

Message larger_elements() {
  return Message("a larger {}", Key("plate.element_size_m"));
}

double total_bytes(const Budget& budget) {
  double sum = 0;
  for (const auto& item : budget) sum += item.bytes;
  return sum;
}

void require_room(const Budget& budget, double available, std::string_view work, std::string_view where,
                  std::string_view room, std::string_view instead) {
  const double needed = total_bytes(budget);
  if (budget.empty() || needed <= available) return;
  const auto& largest = *std::ranges::max_element(budget, {}, &BudgetItem::bytes);
  throw UserError("{} needs about {:.3g} GB {}, {:.3g} GB of it for {}, and {}; choose {}{}", work,
                  needed * 1e-9, where, largest.bytes * 1e-9, largest.what, room, largest.remedy, instead);
}

void require_memory(const Budget& budget, std::string_view work, std::string_view instead) {
  const double available = available_memory_bytes();
  require_room(budget, available, work, "of memory", fmt::format("{:.3g} GB are available", available * 1e-9),
               instead);
}

}  // namespace slipfront
