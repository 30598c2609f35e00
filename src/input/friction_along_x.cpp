// SPDX-License-Identifier: BSD-3-Clause
#include "input/friction_along_x.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>

#include "base/error.hpp"
#include "files/fields.hpp"
#include "files/text.hpp"
#include "input/entries.hpp"
#include "input/pressure.hpp"
#include "input/random_field.hpp"
#include "input/table_along_x.hpp"
#include "mesh/plate.hpp"

namespace slipfront::input {

namespace {

using interface::FrictionLaw;

constexpr const char* x_column = "x_m";
constexpr const char* friction_table_name = "friction.csv";

Message in_friction_file(const std::filesystem::path& file) {
  return Message("{}: {}", Key("friction.file"), files::one_line(file.native()));
}

std::vector<std::string> keys_of(const FrictionLaw& law) {
  std::vector<std::string> keys;
  for (const auto& parameter : description_of(law).parameters) keys.emplace_back(parameter.key);
  return keys;
}

/// What is wrong with a parameter; empty where it is allowed.
std::string problem_of(const std::string& key, double value, const Range& range) {
  const Magnitudes& allowed = magnitudes_of(unit_of(key));
  if (!contains(range, value)) return fmt::format("{} is {}; it must be {}", key, value, describe(range, ""));
  const double size = std::abs(value);
  if (value != 0 && (size < allowed.least || size > allowed.most))
    return fmt::format("{} is {}; its magnitude must be at least {:g} and at most {:g}", key, value,
                       allowed.least, allowed.most);
  return {};
}

/// What is wrong with a law; empty where nothing is.
std::string problem_of(const FrictionLaw& law) {
  std::string values;
  for (const auto& [key, min, max, help] : description_of(law).parameters) {
    const double value = law.parameter(key);
    if (auto problem = problem_of(key, value, {min, max, false, false}); !problem.empty()) return problem;
    values += fmt::format("{}{} = {}", values.empty() ? "" : ", ", key, value);
  }
  const std::string together = inconsistency(law).text;
  return together.empty() ? "" : fmt::format("{} ({})", together, values);
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
  if (const auto problem = problem_of(here); !problem.empty()) throw UserError("{}: {}", at, problem);
}

/// Where a position lies among the rows of a table: between two, or at one.
struct AmongRows {
  std::size_t before, after;
  double part;  ///< of the way from the one before to the one after
  double value(const std::vector<double>& of_rows) const {
    return of_rows[before] + part * (of_rows[after] - of_rows[before]);
  }
};

AmongRows among_rows(const std::vector<double>& rows_x_m, double x_m, BetweenRows between,
                     double tolerance_m) {
  // The position is at the later one of two rows as near as rounding.
  const auto beyond = std::ranges::upper_bound(rows_x_m, x_m + tolerance_m) - rows_x_m.begin();
  const auto last = static_cast<std::size_t>(std::max<std::ptrdiff_t>(beyond - 1, 0));
  if (between == BetweenRows::stepwise || last + 1 == rows_x_m.size() || x_m <= rows_x_m[last])
    return {last, last, 0};
  return {last, last + 1, (x_m - rows_x_m[last]) / (rows_x_m[last + 1] - rows_x_m[last])};
}

/// Gives each node the table's values.
void apply_table(const FrictionAlongX& along_x, const std::vector<double>& x_m,
                 std::vector<FrictionLaw>& laws) {
  const FrictionTable& table = along_x.table;
  SLIPFRONT_ASSERT(!table.x_m.empty(), "the table of friction.file has not been read");
  require_covers(table.x_m, x_m, in_friction_file(along_x.file));
  const double tolerance_m = position_tolerance * (x_m.back() - x_m.front());
  for (std::size_t i = 0; i < x_m.size(); ++i) {
    const auto at = among_rows(table.x_m, x_m[i], along_x.between_rows, tolerance_m);
    for (std::size_t k = 0; k < table.keys.size(); ++k)
      laws[i].parameter(table.keys[k]) = at.value(table.values[k]);
  }
}

/// Multiplies a parameter of each node.
void apply_field(const Case& config, const std::vector<double>& x_m, std::vector<FrictionLaw>& laws) {
  const FrictionAlongX& along_x = config.friction_along_x;
  const double period_m = config.plate.sides == mesh::Sides::periodic ? config.plate.width_m : 0;
  const RandomField field(along_x.random_correlation_length_m, period_m,
                          static_cast<std::uint64_t>(along_x.random_seed));
  for (std::size_t i = 0; i < x_m.size(); ++i)
    laws[i].parameter(along_x.random_key) *= 1 + along_x.random_share * field(x_m[i]);
}

void require_allowed(const Case& config, const std::vector<double>& x_m,
                     const std::vector<FrictionLaw>& laws) {
  const FrictionAlongX& along_x = config.friction_along_x;
  const bool random = along_x.random_key != "none";
  for (std::size_t i = 0; i < laws.size(); ++i) {
    auto problem = problem_of(laws[i]);
    if (problem.empty() && !is_prestressed(config) && laws[i].cohesion_Pa() > 0)
      problem = "cohesion_Pa needs loading.method = prestress";
    if (problem.empty()) continue;
    if (random)
      throw UserError("{}: at x = {:.6g} m {}; choose a smaller share", Key("friction.random_share"), x_m[i],
                      problem)
          .about("friction.random_key");
    throw UserError("{}: at x = {:.6g} m {}", in_friction_file(along_x.file), x_m[i], problem);
  }
}

/// Two of t, V_i and theta_i decide the third, at all nodes the same.
void require_one_initial_state(const Case& config, const std::vector<FrictionLaw>& laws) {
  if (!config.friction.has_parameter("theta_i_s")) return;
  const FrictionAlongX& along_x = config.friction_along_x;
  const auto given =
      std::ranges::count_if(laws, [](const auto& law) { return law.parameter("theta_i_s") > 0; });
  if (given == 0) return;
  const auto place = in_friction_file(along_x.file);
  if (is_sequence(config)) return;
  if (!is_prestressed(config) || !config.prestress.file.empty())
    throw UserError("{}: theta_i_s needs {} = prestress and {}, not a table; remove the column", place,
                    Key("loading.method"), Key("prestress.p_Pa"));
  if (given != std::ssize(laws))
    throw UserError("{}: theta_i_s is 0 at some nodes and not at others; give it everywhere, or nowhere",
                    place);
  const bool V_i_varies = std::ranges::find(along_x.table.keys, "V_i_m_per_s") != along_x.table.keys.end() ||
                          along_x.random_key == "V_i_m_per_s";
  if (V_i_varies && config.prestress.t_Pa)
    throw UserError("{}: {} and {} decide on V_i, which cannot vary by itself; leave one of the three out",
                    along_x.random_key == "V_i_m_per_s" ? Message("{}", Key("friction.random_key")) : place,
                    Key("prestress.t_Pa"), Key("friction.theta_i_s"));
}

}  // namespace

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

std::vector<FrictionLaw> friction_at(const Case& config, const std::vector<double>& x_m) {
  const FrictionAlongX& along_x = config.friction_along_x;
  if (!along_x.varies()) return {};
  std::vector<FrictionLaw> laws(x_m.size(), config.friction);
  if (!along_x.file.empty()) apply_table(along_x, x_m, laws);
  if (along_x.random_key != "none") apply_field(config, x_m, laws);
  require_one_initial_state(config, laws);
  for (auto& law : laws)
    if (config.prestress.t_Pa) set_initial_slip_rate(law, *config.prestress.t_Pa, config.prestress.p_Pa);
  require_allowed(config, x_m, laws);
  return laws;
}

Case with_friction_at(Case config, const std::vector<double>& x_m, const std::vector<FrictionLaw>& laws) {
  FrictionTable table{x_column, x_m, {}, {}};
  for (const auto& key : keys_of(config.friction)) {
    std::vector<double> values;
    for (const auto& law : laws) values.push_back(law.parameter(key));
    const double of_case = config.friction.parameter(key);
    if (std::ranges::all_of(values, [&](double value) { return value == of_case; })) continue;
    table.text += "," + key;
    table.keys.push_back(key);
    table.values.push_back(std::move(values));
  }
  if (table.keys.empty()) return config;
  for (std::size_t i = 0; i < x_m.size(); ++i) {
    table.text += fmt::format("\n{}", x_m[i]);
    for (const auto& values : table.values) table.text += fmt::format(",{}", values[i]);
  }
  table.text += "\n";
  config.friction_along_x = {};
  config.friction_along_x.file = friction_table_name;
  config.friction_along_x.table = std::move(table);
  return config;
}

double radiation_slip_rate_m_per_s(const Case& config) {
  double admittance = solid::shear_admittance_m_per_Pa_s(config.material);
  if (has_base_body(config)) admittance += solid::shear_admittance_m_per_Pa_s(base_material(config));
  return admittance * direct_effect(config.friction) * nominal_pressure_Pa(config);
}

double tip_slip_rate_m_per_s(const Case& config) {
  return config.tip_slip_rate_m_per_s.value_or(
      std::max(radiation_slip_rate_m_per_s(config), 10 * config.friction.parameter("V_i_m_per_s")));
}

double inertia_slip_rate_m_per_s(const Case& config) {
  constexpr double share = 0.1;
  return config.sequence.inertia_slip_rate_m_per_s.value_or(
      share * std::min(radiation_slip_rate_m_per_s(config), tip_slip_rate_m_per_s(config)));
}

double slow_slip_rate_m_per_s(const Case& config) {
  return 0.5 * inertia_slip_rate_m_per_s(config);
}

interface::ContactModel contact_model(const Case& config, const std::vector<double>& x_m,
                                      const mesh::Subset& places) {
  interface::ContactModel model {
    config.friction, config.regularisation, config.contact
  };
  if (config.friction.never_sticks()) model.tip_slip_rate_m_per_s = tip_slip_rate_m_per_s(config);
  const auto laws = friction_at(config, x_m);
  if (!laws.empty())
    model.law_per_node = interface::NodeLaws(
        places.of(laws), std::ranges::any_of(laws, [](const FrictionLaw& law) { return strengthens(law); }));
  return model;
}

}  // namespace slipfront::input
