// SPDX-License-Identifier: BSD-3-Clause
#include "files/fields.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace slipfront::files {
namespace {

std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

}  // namespace

void for_each_row(std::string_view text,
                  const std::function<void(int line, const std::vector<std::string_view>& fields)>& take) {
  std::vector<std::string_view> fields;
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view rest = without_blanks(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (rest.empty() || rest.front() == '#') continue;
    fields.clear();
    for (std::size_t comma = 0; comma != std::string_view::npos;) {
      comma = rest.find(',');
      fields.push_back(without_blanks(rest.substr(0, comma)));
      if (comma != std::string_view::npos) rest.remove_prefix(comma + 1);
    }
    take(line, fields);
  }
}

std::optional<double> number_of(std::string_view field) {
  if (field.starts_with('+')) {
    field.remove_prefix(1);
    if (field.starts_with('-')) return std::nullopt;
  }
  double number = 0;
  const char* end = field.data() + field.size();
  const auto [rest, error] = std::from_chars(field.data(), end, number);
  if (error != std::errc{} || rest != end || !std::isfinite(number)) return std::nullopt;
  return number;
}

}  // namespace slipfront::files
