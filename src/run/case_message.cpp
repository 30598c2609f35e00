// SPDX-License-Identifier: BSD-3-Clause
#include "run/case_message.hpp"

#include <cstdint>

#include "input/schema.hpp"
#include "run/run.hpp"

namespace slipfront::run {

void pack_case(const input::Case& config, MessageBuffer& to) {
  const auto& table = config.friction_along_x.table;
  to.put(resolved_text(config)).put(table.x_m).put(static_cast<std::uint64_t>(table.keys.size()));
  for (std::size_t k = 0; k < table.keys.size(); ++k) to.put(table.keys[k]).put(table.values[k]);
}

input::Case unpack_case(MessageBuffer& from) {
  auto config = input::parse_case(from.take_text(), case_file);
  auto& table = config.friction_along_x.table;
  table.x_m = from.take_all<double>();
  for (auto n = from.take<std::uint64_t>(); n > 0; --n) {
    table.keys.push_back(from.take_text());
    table.values.push_back(from.take_all<double>());
  }
  return config;
}

}  // namespace slipfront::run
