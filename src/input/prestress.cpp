// SPDX-License-Identifier: BSD-3-Clause
#include "input/prestress.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/error.hpp"
#include "files/fields.hpp"
#include "files/text.hpp"
#include "input/entries.hpp"
#include "input/table_along_x.hpp"

namespace slipfront::input {

namespace {

constexpr std::array<const char*, 3> wanted_columns = {"x_m", "t_Pa", "p_Pa"};
constexpr const char* header = "x_m,t_Pa,p_Pa";
using Row = std::array<double, 3>;

Message in_prestress_file(const std::filesystem::path& file) {
  return Message("{}: {}", Key("prestress.file"), files::one_line(file.native()));
}

Row row_of(const std::vector<std::string_view>& fields, const Message& at) {
  if (fields.size() != wanted_columns.size())
    throw UserError("{}: has {} columns; a row is {}", at, fields.size(), header);
  Row row{};
  for (std::size_t k = 0; k < row.size(); ++k) {
    row[k] = number_in(fields[k], wanted_columns[k], at);
    require_at_most(row[k], magnitudes_of(unit_of(wanted_columns[k])).most, wanted_columns[k], at);
  }
  return row;
}

void append(const Row& row, const Message& at, record::StaticState& rows) {
  const auto [x_m, t_Pa, p_Pa] = row;
  require_ascending(x_m, rows.x_m, at);
  if (p_Pa <= 0)
    throw UserError("{}: p_Pa is {}; it must be greater than 0, the interface starts in contact", at, p_Pa);
  const double min_Pa = magnitudes_of("Pa").least;
  if (p_Pa < min_Pa) throw UserError("{}: p_Pa is {}; it must be at least {:g}", at, p_Pa, min_Pa);
  rows.x_m.push_back(x_m);
  rows.t_s_Pa.push_back(t_Pa);
  rows.p_s_Pa.push_back(p_Pa);
}

}  // namespace

PrestressTable read_prestress(const std::filesystem::path& file) {
  constexpr std::size_t max_bytes = std::size_t{1} << 30U;
  PrestressTable table{files::read_text(file, in_prestress_file(file), "table", max_bytes), {}};
  bool have_header = false;
  files::for_each_row(table.text, [&](int line, const std::vector<std::string_view>& fields) {
    const Message at("{}:{}", in_prestress_file(file), line);
    if (have_header) return append(row_of(fields, at), at, table.rows);
    have_header = true;
    if (!std::ranges::equal(fields, wanted_columns))
      throw UserError("{}: the first line must be the header {}", at, header);
  });
  if (table.rows.x_m.empty())
    throw UserError("{}: holds no rows; write the header {} and a row per position", in_prestress_file(file),
                    header);
  return table;
}

record::StaticState prestress_at(const Prestress& prestress, const std::vector<double>& x_m) {
  const record::StaticState& rows = prestress.table.rows;
  SLIPFRONT_ASSERT(!rows.x_m.empty(), "the table of prestress.file has not been read");
  require_covers(rows.x_m, x_m, in_prestress_file(prestress.file));
  record::StaticState state;
  state.x_m = x_m;
  for (const double wanted : x_m) {
    const double x = std::clamp(wanted, rows.x_m.front(), rows.x_m.back());
    const auto after = std::ranges::lower_bound(rows.x_m, x);
    const auto k = static_cast<std::size_t>(after - rows.x_m.begin());
    const std::size_t before = k > 0 ? k - 1 : 0;
    const double part = k > 0 ? (x - rows.x_m[before]) / (rows.x_m[k] - rows.x_m[before]) : 1;
    const auto between = [&](const std::vector<double>& y) { return y[before] + part * (y[k] - y[before]); };
    state.t_s_Pa.push_back(between(rows.t_s_Pa));
    state.p_s_Pa.push_back(between(rows.p_s_Pa));
  }
  return state;
}

}  // namespace slipfront::input
