// SPDX-License-Identifier: BSD-3-Clause
#include "io/fields.hpp"

namespace slipfront::io {

std::vector<std::string> fields_of(std::string_view line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',') fields.emplace_back();
    if (c != ',' && c != ' ' && c != '\t' && c != '\r') fields.back() += c;
  }
  return fields;
}

}  // namespace slipfront::io
