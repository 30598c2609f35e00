// SPDX-License-Identifier: BSD-3-Clause
#include "run/case_message.hpp"

#include "input/schema.hpp"
#include "run/run.hpp"

namespace slipfront::run {

void pack_case(const input::Case& config, MessageBuffer& to) {
  const auto& table = config.friction_along_x.table;
  to.append(packed(resolved_text(config), table.x_m, table.keys, table.values));
}

input::Case unpack_case(MessageBuffer& from) {
  auto archive = MessageArchive::reader(from);
  std::string text;
  archive(text);
  auto config = input::parse_case(text, case_file);
  auto& table = config.friction_along_x.table;
  archive(table.x_m, table.keys, table.values);
  return config;
}

}  // namespace slipfront::run
