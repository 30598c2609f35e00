// SPDX-License-Identifier: BSD-3-Clause
#include "results/table.hpp"

#include <algorithm>
#include <utility>

namespace slipfront::results {
namespace {

void describe(const hdf5::File& file, const Description& about) {
  hdf5::set_attribute(file, about.name, "unit", std::string(about.unit));
  hdf5::set_attribute(file, about.name, "description", std::string(about.description));
}

}  // namespace

std::uint64_t Table::head_bytes() const {
  std::size_t longest = 0;
  for (const auto& name : names) longest = std::max(longest, name.size());
  return results::head_bytes(origin, n_places() * (axes.size() * sizeof(double) + longest));
}

RowFormat row_format(const char* file, Table table) {
  RowFormat format{.file = file, .head_bytes = table.head_bytes(), .n_places = table.n_places()};
  format.names.push_back(table.time.name);
  for (const auto& field : table.fields) format.names.push_back(field.name);
  format.finish = [table = std::move(table)](const std::filesystem::path& path) { finish(path, table); };
  return format;
}

std::vector<double> rows_of(std::span<const std::vector<double>* const> members) {
  std::vector<double> rows;
  const auto n_rows = members.front()->size();
  for (std::size_t row = 0; row < n_rows; ++row)
    for (const auto* values : members) {
      const auto n = static_cast<std::ptrdiff_t>(values->size() / n_rows);
      const auto first = values->begin() + static_cast<std::ptrdiff_t>(row) * n;
      rows.insert(rows.end(), first, first + n);
    }
  return rows;
}

void finish(const std::filesystem::path& path, const Table& table) {
  const auto n = table.n_places();
  const auto n_rows = RowReader(path, table.row_values()).n_rows();
  const hdf5::Rows rows{rows_name, n_rows, table.row_values()};
  // Places with a name are numbered, others are at their coordinate.
  const std::string row = "row_value";
  std::string place;
  if (!table.axes.empty()) place = table.names.empty() ? table.axes.front().about.name : "probe";
  const auto describe_all = [&](const hdf5::File& file) {
    std::vector<hdf5::Dimensions> dimensions = {{rows_name, {table.time.name, row}}};
    hdf5::create_dimension(file, row, table.row_values());
    describe(file, {row.c_str(), "1", "number of a value in a row"});
    if (!table.names.empty()) {
      hdf5::create_dimension(file, place, n);
      describe(file, {place.c_str(), "1", "number of the probe"});
      dimensions.push_back({"name", {place}});
      hdf5::write_texts(file, "name", table.names);
      hdf5::set_attribute(file, "name", "description", std::string("name of the probe"));
    }
    for (const auto& axis : table.axes) {
      hdf5::write(file, axis.about.name, axis.values, {n});
      describe(file, axis.about);
      if (!table.names.empty()) dimensions.push_back({axis.about.name, {place}});
    }
    if (table.names.empty() && !place.empty()) hdf5::make_scale(file, place);
    hdf5::create_view(file, table.time.name, {n_rows}, rows, {{.first = 0, .n = 1}});
    describe(file, table.time);
    hdf5::make_scale(file, table.time.name);
    for (std::size_t k = 0; k < table.fields.size(); ++k) {
      const char* name = table.fields[k].name;
      const auto of_time = place.empty();
      hdf5::create_view(file, name, of_time ? hdf5::Shape{n_rows} : hdf5::Shape{n_rows, n}, rows,
                        {{.first = 1 + k * n, .n = n}});
      describe(file, table.fields[k]);
      dimensions.push_back({name, of_time ? std::vector<std::string>{table.time.name}
                                          : std::vector<std::string>{table.time.name, place}});
    }
    hdf5::set_dimensions(file, dimensions);
  };
  Layout(path, table.head_bytes(), rows, table.origin, describe_all).finish();
}

}  // namespace slipfront::results
