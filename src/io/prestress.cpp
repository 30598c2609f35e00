// SPDX-License-Identifier: BSD-3-Clause
#include "io/prestress.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>

#include "base/error.hpp"
#include "io/fields.hpp"

namespace slipfront::io {

namespace {

constexpr std::array<const char*, 3> columns = {"x_m", "t_Pa", "p_Pa"};
constexpr const char* header = "x_m,t_Pa,p_Pa";

/// The key that names the file comes first, so that the message finds its place in the case file.
std::string place(const std::filesystem::path& file) {
  return "prestress.file: " + file.string();
}

}  // namespace

PrestressTable read_prestress(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream || std::filesystem::is_directory(file))
    throw UserError("{}: cannot be read; check the path", place(file));
  PrestressTable table;
  bool have_header = false;
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    const auto at = [&] { return fmt::format("{}:{}", place(file), number); };
    const auto fields = fields_of(line);
    if ((fields.size() == 1 && fields[0].empty()) || fields[0].starts_with('#')) continue;
    if (!have_header) {
      have_header = true;
      if (!std::ranges::equal(fields, columns))
        throw UserError("{}: the first line must be the header {}", at(), header);
      continue;
    }
    if (fields.size() != columns.size())
      throw UserError("{}: has {} columns; a row is {}", at(), fields.size(), header);
    std::array<double, 3> row{};
    for (std::size_t k = 0; k < row.size(); ++k) {
      const char* end = fields[k].data() + fields[k].size();
      const auto [rest, error] = std::from_chars(fields[k].data(), end, row[k]);
      if (error != std::errc{} || rest != end || !std::isfinite(row[k]))
        throw UserError("{}: {} is \"{}\"; it must be a finite number", at(), columns[k], fields[k]);
    }
    if (!table.x_m.empty() && row[0] <= table.x_m.back())
      throw UserError("{}: x_m is {} after {}; write the rows with x ascending", at(), row[0],
                      table.x_m.back());
    if (row[2] <= 0)
      throw UserError("{}: p_Pa is {}; it must be greater than 0, the interface starts in contact", at(),
                      row[2]);
    table.x_m.push_back(row[0]);
    table.t_s_Pa.push_back(row[1]);
    table.p_s_Pa.push_back(row[2]);
  }
  if (table.x_m.empty())
    throw UserError("{}: holds no rows; write the header {} and a row per position", place(file), header);
  return table;
}

fronts::StaticState prestress_at(const PrestressTable& table, const std::vector<double>& x_m,
                                 const std::filesystem::path& file) {
  // Positions in a table are written with few digits.
  const double tolerance_m = 1e-6 * (x_m.back() - x_m.front());
  if (table.x_m.front() > x_m.front() + tolerance_m || table.x_m.back() < x_m.back() - tolerance_m)
    throw UserError(
        "{}: covers x = {:.6g} to {:.6g} m, the interface reaches from {:.6g} to {:.6g} m; add rows",
        place(file), table.x_m.front(), table.x_m.back(), x_m.front(), x_m.back());
  fronts::StaticState state;
  state.x_m = x_m;
  for (const double wanted : x_m) {
    const double x = std::clamp(wanted, table.x_m.front(), table.x_m.back());
    const auto after = std::ranges::lower_bound(table.x_m, x);
    const auto k = static_cast<std::size_t>(after - table.x_m.begin());
    const std::size_t before = k > 0 ? k - 1 : 0;
    const double part = k > 0 ? (x - table.x_m[before]) / (table.x_m[k] - table.x_m[before]) : 1;
    const auto between = [&](const std::vector<double>& y) { return y[before] + part * (y[k] - y[before]); };
    state.t_s_Pa.push_back(between(table.t_s_Pa));
    state.p_s_Pa.push_back(between(table.p_s_Pa));
  }
  return state;
}

}  // namespace slipfront::io
