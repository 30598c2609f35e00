// SPDX-License-Identifier: BSD-3-Clause
#include "input/experiment.hpp"

#include <algorithm>
#include <string>

#include "base/error.hpp"
#include "files/fields.hpp"
#include "files/text.hpp"

namespace slipfront::input {
namespace {

using Fields = std::vector<std::string_view>;

/// Where the two columns are, and what a speed is divided by.
struct Columns {
  std::vector<std::string> header;
  std::size_t ratio = 0, speed = 0;
  double speed_unit = 1;
};

Columns find_columns(const Fields& fields, const std::string& at, double c_L_m_per_s) {
  Columns columns{{fields.begin(), fields.end()}};
  const auto column = [&](std::string_view name) {
    if (std::ranges::count(fields, name) > 1)
      throw UserError("{}: has the column {} more than once; keep one of them", at, name);
    return static_cast<std::size_t>(std::ranges::find(fields, name) - fields.begin());
  };
  columns.ratio = column("static_ratio");
  columns.speed = column("v_over_c_L");
  if (columns.speed == fields.size()) {
    columns.speed = column("v_m_per_s");
    columns.speed_unit = c_L_m_per_s;
  }
  if (columns.ratio == fields.size() || columns.speed == fields.size())
    throw UserError(
        "{}: needs the columns static_ratio and v_over_c_L (or v_m_per_s); add a header line with them", at);
  return columns;
}

double value_in(const Fields& fields, std::size_t column, const Columns& columns, const std::string& at) {
  const auto value = column < fields.size() ? files::number_of(fields[column]) : std::nullopt;
  if (!value) throw UserError("{}: column {} must be a number", at, columns.header[column]);
  return *value;
}

}  // namespace

Experiment read_experiment(const std::filesystem::path& file, double c_L_m_per_s) {
  constexpr std::size_t max_bytes = std::size_t{1} << 26U;
  const std::string name = files::one_line(file.native());
  Experiment experiment;
  Columns columns;
  const std::string text = files::read_text(file, name, "table", max_bytes);
  files::for_each_row(text, [&](int line, const Fields& fields) {
    const std::string at = fmt::format("{}:{}", name, line);
    if (columns.header.empty()) {
      columns = find_columns(fields, at, c_L_m_per_s);
      return;
    }
    if (fields.size() > columns.header.size())
      throw UserError("{}: has {} columns, the header {}; write numbers with a decimal point", at,
                      fields.size(), columns.header.size());
    experiment.static_ratio.push_back(value_in(fields, columns.ratio, columns, at));
    experiment.v_over_c_L.push_back(value_in(fields, columns.speed, columns, at) / columns.speed_unit);
  });
  if (experiment.static_ratio.empty()) throw UserError("{}: holds no points; add a line per point", name);
  return experiment;
}

}  // namespace slipfront::input
