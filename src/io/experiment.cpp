// SPDX-License-Identifier: BSD-3-Clause
#include "io/experiment.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include "base/error.hpp"
#include "io/fields.hpp"

namespace slipfront::io {

Experiment read_experiment(const std::filesystem::path& file, double c_L_m_per_s) {
  std::ifstream stream(file);
  if (!stream) throw UserError("{}: cannot be read; check the path", file.string());
  Experiment experiment;
  std::vector<std::string> header;
  std::size_t ratio_column = 0, speed_column = 0;
  double speed_unit = 1;
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    const auto fields = fields_of(line);
    if (fields.size() == 1 && fields[0].empty()) continue;
    if (fields[0].starts_with('#')) continue;
    if (header.empty()) {
      header = fields;
      const auto column = [&](const char* name) {
        return static_cast<std::size_t>(std::ranges::find(header, name) - header.begin());
      };
      ratio_column = column("static_ratio");
      speed_column = column("v_over_c_L");
      if (speed_column == header.size()) {
        speed_column = column("v_m_per_s");
        speed_unit = c_L_m_per_s;
      }
      if (ratio_column == header.size() || speed_column == header.size())
        throw UserError(
            "{}:{}: needs the columns static_ratio and v_over_c_L (or v_m_per_s); add a header line with "
            "them",
            file.string(), number);
      continue;
    }
    const auto value = [&](std::size_t column) {
      double result = std::nan("");
      std::size_t used = 0;
      try {
        if (column < fields.size()) result = std::stod(fields[column], &used);
      } catch (const std::exception&) {
        used = 0;
      }
      if (used == 0 || used != fields[column].size() || !std::isfinite(result))
        throw UserError("{}:{}: column {} must be a number", file.string(), number, header[column]);
      return result;
    };
    experiment.static_ratio.push_back(value(ratio_column));
    experiment.v_over_c_L.push_back(value(speed_column) / speed_unit);
  }
  if (experiment.static_ratio.empty())
    throw UserError("{}: holds no points; add a line per point", file.string());
  return experiment;
}

}  // namespace slipfront::io
