// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/message.hpp"

namespace slipfront {

/// Something that takes memory or room on a disk.
struct BudgetItem {
  std::string what;
  double bytes = 0;
  Message remedy;  ///< what to choose for less of it: "a larger ..."
};

/// The remedy of what grows with the mesh.
Message larger_elements();

/// What is there at one time.
using Budget = std::vector<BudgetItem>;

double total_bytes(const Budget& budget);

/// Refuses work that needs more than `available` bytes, by its largest item and that one's remedy.
/// @param where  such as "of memory"
/// @param room   who has how much, such as "2 GB are available"
/// @param instead  another way out than the remedy, such as " or another folder"; may be empty
/// @throws UserError "<work> needs about ... GB <where>, ... GB of it for <item>, and <room>; choose
/// <remedy>"
void require_room(const Budget& budget, double available, std::string_view work, std::string_view where,
                  std::string_view room, std::string_view instead = "");

/// Requires memory that can be allocated without swapping.
void require_memory(const Budget& budget, std::string_view work, std::string_view instead = "");

}  // namespace slipfront
