// SPDX-License-Identifier: BSD-3-Clause
#include "input/friction_table.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "files/fields.hpp"
#include "files/text.hpp"
#include "input/entries.hpp"
#include "input/table_along_x.hpp"

namespace slipfront::input {

namespace {

using interface::FrictionLaw;

constexpr const char* x_column = "x_m";

std::vector<std::string> keys_of(const FrictionLaw& law) {
  std::vector<std::string> keys;
  for (const auto& parameter : description_of(law).parameters) keys.emplace_back(parameter.key);
  return keys;
}

/// What is wrong with a parameter; empty where it is allowed.
std::string fault_of_parameter(const std::string& key, double value, const Range& range) {
  const Magnitudes& allowed = magnitudes_of(unit_of(key));
  if (!contains(range, value)) return fmt::format("{} is {}; it must be {}", key, value, describe(range, ""));
  const double size = std::abs(value);
  if (value != 0 && (size < allowed.least || size > allowed.most))
    return fmt::format("{} is {}; its magnitude must be at least {:g} and at most {:g}", key, value,
                       allowed.least, allowed.most);
  return {};
}

void check_header(const std::vector<std::string_view>& fields, const FrictionLaw& law, const Message& at) {
  const auto keys = keys_of(law);
  const auto wanted =
      fmt::format("the first line must be the header {} and any of {}", x_column, fmt::join(keys, ", "));
  if (fields.size() < 2 || fields.front() != x_column) throw UserError("{}: {}", at, wanted);
  for (std::size_t k = 1; k < fields.size(); ++k) {
    if (std::ranges::find(keys, fields[k]) == keys.end())
      throw UserError("{}: has a column \"{}\"; {}", at, files::shortened(fields[k]), wanted);
    if (std::find(fields.begin() + 1, fields.begin() + static_cast<std::ptrdiff_t>(k), fields[k]) !=
        fields.begin() + static_cast<std::ptrdiff_t>(k))
      throw UserError("{}: has the column {} twice; remove one", at, fields[k]);
  }
}

void append_row(const std::vector<std::string_view>& fields, const FrictionLaw& law, const Message& at,
                FrictionTable& table) {
  if (fields.size() != table.keys.size() + 1)
    throw UserError("{}: has {} columns; a row is {},{}", at, fields.size(), x_column,
                    fmt::join(table.keys, ","));
  const double x_m = number_in(fields.front(), x_column, at);
  require_at_most(x_m, magnitudes_of("m").most, x_column, at);
  require_ascending(x_m, table.x_m, at);
  table.x_m.push_back(x_m);
  FrictionLaw here = law;
  for (std::size_t k = 0; k < table.keys.size(); ++k) {
    const double value = number_in(fields[k + 1], table.keys[k], at);
    table.values[k].push_back(value);
    here.parameter(table.keys[k]) = value;
  }
  if (const auto fault = fault_of(here); !fault.empty()) throw UserError("{}: {}", at, fault);
}

}  // namespace

Message in_friction_file(const std::filesystem::path& file) {
  return Message("{}: {}", Key("friction.file"), files::one_line(file.native()));
}

std::string fault_of(const FrictionLaw& law) {
  std::string values;
  for (const auto& [key, min, max, help] : description_of(law).parameters) {
    const double value = law.parameter(key);
    if (auto fault = fault_of_parameter(key, value, {min, max, false, false}); !fault.empty()) return fault;
    values += fmt::format("{}{} = {}", values.empty() ? "" : ", ", key, value);
  }
  const std::string together = inconsistency(law).text;
  return together.empty() ? "" : fmt::format("{} ({})", together, values);
}

FrictionTable read_friction_table(const std::filesystem::path& file, const FrictionLaw& law) {
  constexpr std::size_t max_bytes = std::size_t{1} << 30U;
  FrictionTable table{files::read_text(file, in_friction_file(file), "table", max_bytes), {}, {}, {}};
  files::for_each_row(table.text, [&](int line, const std::vector<std::string_view>& fields) {
    const Message at("{}:{}", in_friction_file(file), line);
    if (!table.keys.empty()) return append_row(fields, law, at, table);
    check_header(fields, law, at);
    table.keys.assign(fields.begin() + 1, fields.end());
    table.values.resize(table.keys.size());
  });
  if (table.x_m.empty())
    throw UserError("{}: holds no rows; write the header {} and any of {}, and a row per position",
                    in_friction_file(file), x_column, fmt::join(keys_of(law), ", "));
  return table;
}

}  // namespace slipfront::input
