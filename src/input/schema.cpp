// SPDX-License-Identifier: BSD-3-Clause
#include "input/schema.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <string_view>

#include "base/error.hpp"
#include "files/text.hpp"
#include "input/document.hpp"
#include "input/entries.hpp"
#include "input/friction_along_x.hpp"
#include "input/prestress.hpp"
#include "solid/operator.hpp"
#include "statics/plate_solver.hpp"

namespace slipfront::input {
namespace {

std::string trimmed(const std::string& text) {
  const char* blanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// Levenshtein's distance: the fewest letters to insert, remove or replace.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row[b.size()];
}

/// The candidate nearest to `text`, if it is near enough to be meant.
std::optional<std::string> nearest(const std::string& text, const std::vector<std::string>& candidates) {
  constexpr std::size_t longest_name = 100;
  if (text.size() > longest_name) return std::nullopt;
  std::optional<std::string> best;
  std::size_t least = std::max<std::size_t>(2, text.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(text, candidate);
    if (distance < least) {
      least = distance;
      best = candidate;
    }
  }
  return best;
}

const Entry* find_entry(const std::vector<Entry>& entries, const std::string& key) {
  const auto found =
      std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.key == key; });
  return found == entries.end() ? nullptr : &*found;
}

/// The friction law, other than `except`, that has a parameter of this key; null where none has.
const LawEntries* law_with(const std::string& key, const LawEntries* except) {
  for (const LawEntries& law : friction_laws())
    if (&law != except && find_entry(law.entries, key)) return &law;
  return nullptr;
}

std::vector<std::string> tables_of(const std::vector<Entry>& entries) {
  std::vector<std::string> tables;
  for (const Entry& entry : entries) {
    const std::string table = table_of(entry.key);
    if (!table.empty() && (tables.empty() || tables.back() != table)) tables.push_back(table);
  }
  return tables;
}

bool contains_word(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::string with_unit(const std::string& number, const std::string& unit) {
  return unit.empty() ? number : number + " " + unit;
}

std::string_view kind_name(Kind kind) {
  switch (kind) {
    case Kind::number:
      return "a number";
    case Kind::integer:
      return "an integer";
    case Kind::flag:
      return "true or false";
    case Kind::text:
      return "a string";
    case Kind::word:
      return "a word in quotes";
    case Kind::numbers:
      return "a list of numbers";
  }
  return "";
}

// --- Overrides
// ---------------------------------------------------------------------------------------------------

std::string place_of(const Override& override) {
  return files::shortened(fmt::format("--set {}={}", override.first, override.second));
}

bool takes_bare_text(const std::string& key) {
  const Entry* entry = find_entry(common_entries(), key);
  return entry && (entry->kind == Kind::word || entry->kind == Kind::text);
}

Setting to_setting(const Override& override) {
  const auto& [key, text] = override;
  if (files::line_outside_utf8(key + text) > 0)
    throw UserError("{}: holds bytes that are no utf-8; write it in that encoding", place_of(override));
  const bool in_quotes = !text.empty() && (text.front() == '"' || text.front() == '\'');
  Value value = takes_bare_text(key) && !in_quotes ? Value(text) : parse_value(text);
  return {files::one_line(key), std::move(value), place_of(override), 0};
}

const Setting* find_setting(const Document& document, const std::string& key) {
  const auto found = std::find_if(document.settings.begin(), document.settings.end(),
                                  [&](const Setting& setting) { return setting.key == key; });
  return found == document.settings.end() ? nullptr : &*found;
}

void apply(const std::vector<Override>& overrides, Document& document) {
  for (const Override& override : overrides) {
    auto& settings = document.settings;
    settings.erase(std::remove_if(settings.begin(), settings.end(),
                                  [&](const Setting& setting) { return setting.key == override.first; }),
                   settings.end());
    settings.push_back(to_setting(override));
  }
}

/// Keys whose values decide which later ones of these, and which other keys, there are.
constexpr std::array deciding_keys = {
    "plate.coarsenings", "base.kind",           "base.coarsenings", "loading.method",     "prestress.file",
    "friction.file",     "friction.random_key", "event.kind",       "event.trigger_form", "nucleation.form"};

bool applies(const Entry& entry, const Case& config) {
  return !entry.only_with || entry.only_with->holds(config);
}

/// Where an override decides that a key of the file does not apply, that is out of date rather than wrong.
void drop_keys_that_overrides_exclude(const Case& config, Document& document) {
  const auto overridden = [&](const Entry& entry) {
    return std::ranges::any_of(deciding_keys, [&](const char* key) {
      const Setting* setting = find_setting(document, key);
      return setting && setting->is_override() && entry.only_with->text.find(key) != std::string::npos;
    });
  };
  std::vector<std::string> dropped;
  for (const Entry& entry : common_entries())
    if (!applies(entry, config) && overridden(entry)) dropped.push_back(entry.key);
  std::erase_if(document.settings, [&](const Setting& setting) {
    return !setting.is_override() && contains_word(dropped, setting.key);
  });
}

/// Where an override names the law, what the file says of other laws is out of date rather than wrong.
void drop_parameters_of_other_laws(const Case& config, Document& document) {
  const Setting* law = find_setting(document, "friction.law");
  if (!law || !law->is_override()) return;
  const LawEntries& current = law_of(config);
  auto& settings = document.settings;
  settings.erase(std::remove_if(settings.begin(), settings.end(),
                                [&](const Setting& setting) {
                                  return !setting.is_override() &&
                                         !find_entry(current.entries, setting.key) &&
                                         law_with(setting.key, &current);
                                }),
                 settings.end());
}

// --- Single keys
// -------------------------------------------------------------------------------------------------

[[noreturn]] void throw_unknown_table(const TableHeader& table, const std::vector<std::string>& tables) {
  const auto guess = nearest(table.key, tables);
  if (guess) throw UserError("{}: unknown table [{}]; did you mean [{}]?", table.place, table.key, *guess);
  throw UserError("{}: unknown table [{}]; tables are {}", table.place, files::shortened(table.key),
                  fmt::join(tables, ", "));
}

[[noreturn]] void throw_unknown_key(const Setting& setting, const std::vector<Entry>& entries,
                                    const Case& config) {
  const std::string& key = setting.key;
  if (const LawEntries* other = law_with(key, &law_of(config)))
    throw UserError(
        "{}: {} belongs to the friction law {}, but friction.law is {}; remove the key or set the law",
        setting.place, key, other->name, law_of(config).name);
  if (const Entry* entry = find_entry(common_entries(), key))
    throw UserError("{}: {} applies only with {}; remove the key or set that", setting.place, key,
                    entry->only_with->text);
  std::vector<std::string> keys;
  for (const Entry& entry : entries) {
    // The right name in the wrong table is the likelier slip than any misspelling.
    if (leaf_of(entry.key) == leaf_of(key))
      throw UserError("{}: unknown key {}; did you mean {}?", setting.place, files::shortened(key),
                      entry.key);
    keys.push_back(entry.key);
  }
  if (const auto guess = nearest(key, keys))
    throw UserError("{}: unknown key {}; did you mean {}?", setting.place, key, *guess);
  throw UserError("{}: unknown key {}; `slipfront keys` lists all keys", setting.place,
                  files::shortened(key));
}

[[noreturn]] void throw_wrong_type(const Entry& entry, const Setting& setting, const Value& default_value) {
  const std::string& key = entry.key;
  const std::string value = entry.kind == Kind::numbers ? "[1e-5, 2e-5]" : toml_text(default_value);
  const std::string example = setting.is_override() ? fmt::format("--set {}={}", key, value)
                                                    : fmt::format("{} = {}", leaf_of(key), value);
  throw UserError("{}: {} must be {}, is {}; write for example {}", setting.place, key, kind_name(entry.kind),
                  type_name(setting.value), example);
}

void require_in_range(const Entry& entry, const Setting& setting, double value) {
  if (contains(entry.range, value)) return;
  const std::string unit = unit_of(entry.key);
  std::string allowed = describe(entry.range, unit);
  if (!std::isfinite(value) && entry.range.max_open)
    allowed = "a finite number" + (allowed.empty() ? "" : " " + allowed);
  throw UserError("{}: {} is {}; it must be {}", setting.place, entry.key,
                  with_unit(fmt::format("{}", value), unit), allowed);
}

/// The setting's value in the type that the entry takes; an integer does for a number.
Value checked(const Entry& entry, const Setting& setting, const Value& default_value) {
  const Value& value = setting.value;
  switch (entry.kind) {
    case Kind::number: {
      const auto* integer = std::get_if<std::int64_t>(&value);
      if (!integer && !std::holds_alternative<double>(value)) break;
      const double number = integer ? static_cast<double>(*integer) : std::get<double>(value);
      require_in_range(entry, setting, number);
      return number;
    }
    case Kind::integer:
      if (!std::holds_alternative<std::int64_t>(value)) break;
      require_in_range(entry, setting, static_cast<double>(std::get<std::int64_t>(value)));
      return value;
    case Kind::flag:
      if (!std::holds_alternative<bool>(value)) break;
      return value;
    case Kind::text:
      if (!std::holds_alternative<std::string>(value)) break;
      return value;
    case Kind::word: {
      const auto* word = std::get_if<std::string>(&value);
      if (!word) break;
      if (contains_word(entry.words, *word)) return value;
      const auto guess = nearest(*word, entry.words);
      throw UserError("{}: {} is {}; it must be one of {}{}", setting.place, entry.key,
                      files::shortened(toml_text(value)), fmt::join(entry.words, ", "),
                      guess ? fmt::format(" (did you mean {}?)", *guess) : "");
    }
    case Kind::numbers: {
      const auto* list = std::get_if<std::vector<double>>(&value);
      if (!list) break;
      for (const double number : *list) require_in_range(entry, setting, number);
      return value;
    }
  }
  throw_wrong_type(entry, setting, default_value);
}

void assign(const Entry& entry, const Setting& setting, Case& config) {
  entry.set(config, checked(entry, setting, entry.get(config)));
}

void check_tables(const Document& document, const std::vector<Entry>& entries) {
  const std::vector<std::string> tables = tables_of(entries);
  for (const TableHeader& table : document.tables) {
    if (contains_word(tables, table.key)) continue;
    if (const Entry* entry = find_entry(entries, table.key))
      throw UserError("{}: {} must be {}, is a table; write it as a key", table.place, table.key,
                      kind_name(entry->kind));
    throw_unknown_table(table, tables);
  }
  for (const Setting& setting : document.settings)
    if (contains_word(tables, setting.key))
      throw UserError("{}: {} is a table, not a key; set its keys, {}.NAME, one by one", setting.place,
                      setting.key, setting.key);
}

// --- Keys together
// -----------------------------------------------------------------------------------------------

/// Place of the first of these keys that is set, an override before the file; `name` where none is.
std::string place_of(const Document& document, const std::vector<std::string>& keys,
                     const std::string& name) {
  std::string place = name;
  for (const std::string& key : keys) {
    const Setting* setting = find_setting(document, key);
    if (!setting) continue;
    if (setting->is_override()) return setting->place;
    if (place == name) place = setting->place;
  }
  return place;
}

void check_friction(const Case& config, const Document& document, const std::string& name) {
  const LawEntries& law = law_of(config);
  const std::string message = law.inconsistency(config);
  if (message.empty()) return;
  std::vector<std::string> keys;
  for (const Entry& entry : law.entries)
    if (message.find(leaf_of(entry.key)) != std::string::npos) keys.push_back(entry.key);
  keys.push_back("friction.law");
  std::string values;
  for (const Entry& entry : law.entries)
    values += fmt::format("{}{} = {}", values.empty() ? "" : ", ", leaf_of(entry.key),
                          toml_text(entry.get(config)));
  throw UserError("{}: friction: {} ({})", place_of(document, keys, name), message, values);
}

using Require = std::function<void(bool holds, const std::vector<std::string>& keys, const std::string&)>;

void check_friction_along_x(const Case& config, const Require& require) {
  const std::string& key = config.friction_along_x.random_key;
  std::vector<std::string> keys;
  for (const Entry& entry : law_of(config).entries) keys.push_back(leaf_of(entry.key));
  require(key == "none" || contains_word(keys, key), {"friction.random_key", "friction.law"},
          fmt::format("friction.random_key is {}; the friction law {} has {}", key, law_of(config).name,
                      fmt::join(keys, ", ")));
}

/// Whether a weakened patch can do nothing, whatever the place; where friction varies, the nodes decide.
bool never_weakens(const Case& config) {
  return !config.friction_along_x.varies() &&
         interface::kinetic_coefficient(config.friction) >= interface::static_coefficient(config.friction);
}

/// What a prescribed state, or the lack of one, asks of the other keys.
void check_prestress(const Case& config, const Document& document, const Require& require) {
  using interface::EventKind;
  if (config.loading.method != statics::LoadingMethod::prestress) {
    require(config.loading.shear_speed_over_c_L > 0, {"loading.shear_speed_over_c_L"},
            "loading.shear_speed_over_c_L is 0; that holds the top edge still, choose loading.method = "
            "prestress or a speed greater than 0");
    return;
  }
  const bool uniform = find_setting(document, "prestress.t_Pa") && find_setting(document, "prestress.p_Pa");
  require(uniform || !config.prestress.file.empty(), {"loading.method"},
          "loading.method = prestress needs prestress.t_Pa and prestress.p_Pa, or prestress.file");
  require(config.plate.corner == mesh::Corner::none, {"plate.corner", "loading.method"},
          "loading.method = prestress needs plate.corner = none: the whole lower edge starts in contact");
  require(config.event != EventKind::spontaneous, {"event.kind", "loading.method"},
          "event.kind = spontaneous raises the shear past the critical one, which loading.method = prestress "
          "does not know; choose nucleation, left, right or none");
  const bool at_edge = interface::is_at_edge(config.event);
  require(!at_edge || config.plate.sides != mesh::Sides::periodic, {"event.kind", "plate.sides"},
          "event.kind = left and right need an edge, which plate.sides = periodic does not have; choose "
          "nucleation");
}

void check_base(const Case& config, const Document& document, const Require& require) {
  if (!has_base_body(config)) return;
  const bool repeats = config.plate.sides == mesh::Sides::periodic;
  require((config.base.plate.sides == mesh::Sides::periodic) == repeats, {"base.sides", "plate.sides"},
          "base.sides and plate.sides must both be periodic, or neither of them");
  require(config.plate.corner != mesh::Corner::fillet, {"plate.corner", "base.kind"},
          "plate.corner = fillet leaves nodes that face none of base.kind = body; choose none or relief");
  // The defaults are those of the paper's plate, which nobody means for a base.
  for (const char* key : {"base.youngs_modulus_Pa", "base.poissons_ratio", "base.density_kg_per_m3",
                          "base.stiffness_damping_s", "base.height_m"})
    require(find_setting(document, key), {"base.kind"},
            fmt::format("base.kind = body needs {}; set it", key));
  require(config.loading.method == statics::LoadingMethod::prestress || config.base.plate.coarsenings == 0 ||
              config.loading.solver != statics::StaticSolver::iterative,
          {"loading.solver", "base.coarsenings"},
          "loading.solver = iterative knows no graded base; choose auto or direct, or base.coarsenings = 0");
}

void check_nucleation(const Case& config, const Require& require) {
  if (config.event != interface::EventKind::nucleation) return;
  const auto& n = config.nucleation;
  const double width_m = config.plate.width_m;
  require(n.x_m >= 0 && n.x_m <= width_m, {"nucleation.x_m", "plate.width_m"},
          fmt::format("nucleation.x_m is {} m; it must be on the interface, at 0 to {} m", n.x_m, width_m));
  require(n.half_length_m + n.taper_m > 0, {"nucleation.half_length_m", "nucleation.taper_m"},
          "nucleation.half_length_m and nucleation.taper_m are both 0; give the patch a length");
  require(config.plate.sides != mesh::Sides::periodic || 2 * (n.half_length_m + n.taper_m) <= width_m,
          {"nucleation.half_length_m", "nucleation.taper_m", "plate.width_m"},
          fmt::format("nucleation.half_length_m + taper_m is {} m; with plate.sides = periodic it must be at "
                      "most half of plate.width_m, {} m",
                      n.half_length_m + n.taper_m, 0.5 * width_m));
  require(
      n.form != interface::NucleationForm::weakened || !never_weakens(config),
      {"nucleation.form", "event.kind", "friction.law"},
      "nucleation.form = weakened does nothing where the friction law does not weaken; choose overstress");
}

void check_trigger(const Case& config, const Require& require) {
  if (!interface::is_at_edge(config.event)) return;
  require(
      config.trigger.form != interface::TriggerForm::weakened || !never_weakens(config),
      {"event.trigger_form", "event.kind", "friction.law"},
      "event.trigger_form = weakened does nothing where the friction law does not weaken; choose added or "
      "raised");
}

/// Relations between keys that need no mesh; mesh::make_plate checks the rest of the geometry.
void check_relations(const Case& config, const Document& document, const std::string& name) {
  const auto require = [&](bool holds, const std::vector<std::string>& keys, const std::string& message) {
    if (!holds) throw UserError("{}: {}", place_of(document, keys, name), message);
  };
  const auto& plate = config.plate;
  const auto& loading = config.loading;
  constexpr double most_nodes = std::numeric_limits<mesh::Node>::max();
  require(
      (plate.width_m / plate.element_size_m + 1) * (plate.height_m / plate.element_size_m + 1) <= most_nodes,
      {"plate.element_size_m", "plate.width_m", "plate.height_m"},
      fmt::format("plate.element_size_m is {} m; that makes more than {:.3g} nodes, choose a larger one",
                  plate.element_size_m, most_nodes));
  const bool at_edge = interface::is_at_edge(config.event);
  const double shorter_m = std::min(plate.width_m, plate.height_m);
  require(plate.element_size_m <= shorter_m, {"plate.element_size_m", "plate.width_m", "plate.height_m"},
          fmt::format("plate.element_size_m is {} m; it must be at most the plate's shorter side, {} m",
                      plate.element_size_m, shorter_m));
  check_prestress(config, document, require);
  const bool tilted = loading.method != statics::LoadingMethod::prestress;
  const double tilt_m = std::max(loading.tilt_left_m, loading.tilt_right_m);
  require(
      !tilted || tilt_m < plate.height_m, {"loading.tilt_left_m", "loading.tilt_right_m", "plate.height_m"},
      fmt::format(
          "loading.tilt_left_m and tilt_right_m go up to {} m; they must be less than plate.height_m, {} m",
          tilt_m, plate.height_m));
  require(!tilted || loading.edge_margin_m < 0.5 * plate.width_m, {"loading.edge_margin_m", "plate.width_m"},
          fmt::format("loading.edge_margin_m is {} m; it must be less than half of plate.width_m, {} m",
                      loading.edge_margin_m, 0.5 * plate.width_m));
  require(!(tilted || at_edge) || config.trigger.zone_m <= plate.width_m,
          {"event.trigger_zone_m", "plate.width_m"},
          fmt::format("event.trigger_zone_m is {} m; it must be at most plate.width_m, {} m",
                      config.trigger.zone_m, plate.width_m));
  require(
      plate.coarsenings == 0 || loading.solver != statics::StaticSolver::iterative,
      {"loading.solver", "plate.coarsenings"},
      "loading.solver = iterative knows no graded plates; choose auto or direct, or plate.coarsenings = 0");
  require(!tilted || loading.solver != statics::StaticSolver::iterative ||
              plate.height_m + (has_base_body(config) ? config.base.plate.height_m : 0) <=
                  2 * statics::most_iterative_slenderness * plate.width_m,
          {"loading.solver", "plate.height_m", "plate.width_m"},
          "loading.solver = iterative does not converge on a plate so much higher than wide; choose auto or "
          "direct");
  require(
      config.time.step_factor <= 1 || config.time.allow_unstable, {"time.step_factor", "time.allow_unstable"},
      fmt::format(
          "time.step_factor is {}, beyond the stable step; use at most 1, or set time.allow_unstable = true",
          config.time.step_factor));
  check_base(config, document, require);
  check_trigger(config, require);
  check_nucleation(config, require);
  check_friction_along_x(config, require);
  require(config.fronts.l_star_m < plate.width_m, {"fronts.l_star_m", "plate.width_m"},
          fmt::format("fronts.l_star_m is {} m; it must be less than plate.width_m, {} m",
                      config.fronts.l_star_m, plate.width_m));
  require(config.fronts.pulse_share <= config.fronts.crack_share,
          {"fronts.pulse_share", "fronts.crack_share"},
          fmt::format("fronts.pulse_share is {}; it must be at most fronts.crack_share, {}",
                      config.fronts.pulse_share, config.fronts.crack_share));
  const auto& relaxation = config.regularisation;
  if (relaxation.relaxed != interface::Relaxed::none) {
    require(
        std::isfinite(relaxation.length_m) || std::isfinite(relaxation.time_s), {"friction.regularisation"},
        "friction.regularisation needs a finite friction.relaxation_length_m or relaxation_time_s; set one");
    require(relaxation.slip_rate_m_per_s == 0 || std::isfinite(relaxation.length_m),
            {"friction.relaxation_slip_rate_m_per_s"},
            "friction.relaxation_slip_rate_m_per_s does nothing without a finite "
            "friction.relaxation_length_m; set that, or remove it");
  }
  const auto& times = config.output.snapshot_times_s;
  const auto fall = std::adjacent_find(times.begin(), times.end(), std::greater_equal<>());
  if (fall != times.end())
    require(false, {"output.snapshot_times_s"},
            fmt::format("output.snapshot_times_s has {} s before {} s; write the times in ascending order",
                        *fall, *std::next(fall)));
}

/// The values of a number or a list of them.
std::vector<double> numbers_of(const Value& value) {
  if (const auto* number = std::get_if<double>(&value)) return {*number};
  if (const auto* list = std::get_if<std::vector<double>>(&value)) return *list;
  return {};
}

/// Refuses numbers of which products or quotients could leave the range of doubles.
void check_magnitudes(const Case& config, const Document& document, const std::string& name) {
  for (const Entry& entry : entries_of(config))
    for (const double number : numbers_of(entry.get(config))) {
      const std::string unit = unit_of(entry.key);
      const Magnitudes& magnitudes = magnitudes_of(unit);
      const double size = std::abs(number);
      if (size == 0 || std::isinf(size) || (size >= magnitudes.least && size <= magnitudes.most)) continue;
      throw UserError("{}: {} is {}; its magnitude must be at least {:g} and at most {}",
                      place_of(document, {entry.key}, name), entry.key,
                      with_unit(fmt::format("{}", number), unit), magnitudes.least,
                      with_unit(fmt::format("{:g}", magnitudes.most), unit));
    }
}

/// Refuses more steps than can be taken or counted. The step is estimated from the time in which a wave
/// crosses an element.
void check_duration(const Case& config, const Document& document, const std::string& name) {
  constexpr double most_steps = 1e12;
  const auto stable_step_s = [&](const solid::Material& material) {
    const double crossing_s = config.plate.element_size_m / solid::longitudinal_speed_m_per_s(material);
    return solid::stable_step_s(2 / crossing_s, material.stiffness_damping_s);
  };
  double step_s = config.time.step_factor * stable_step_s(config.material);
  if (has_base_body(config))
    step_s = std::min(step_s, config.time.step_factor * stable_step_s(base_material(config)));
  const double steps = config.time.end_s / step_s;
  if (steps > most_steps)
    throw UserError(
        "{}: time.end_s = {:g} s takes about {:.3g} steps of {:.3g} s, more than {:g}; choose an earlier end",
        place_of(document, {"time.end_s"}, name), config.time.end_s, steps, step_s, most_steps);
}

// --- Reference
// ---------------------------------------------------------------------------------------------------

std::string reference_row(const Entry& entry, const Case& defaults) {
  std::string type(kind_name(entry.kind));
  std::string allowed = describe(entry.range, "");
  if (entry.kind == Kind::word) {
    type = "word";
    allowed = fmt::format("`\"{}\"`", fmt::join(entry.words, "\"`, `\""));
  }
  for (const std::string_view article : {"a ", "an "})
    if (type.rfind(article, 0) == 0) type.erase(0, article.size());
  std::string help;
  for (const char c : entry.help) help += c == '|' ? std::string("\\|") : std::string(1, c);
  if (entry.only_with) help += "; only with " + entry.only_with->text;
  return fmt::format("| `{}` | {} | {} | `{}` | {} | {} |\n", leaf_of(entry.key), type, unit_of(entry.key),
                     toml_text(entry.get(defaults)), allowed, help);
}

constexpr std::string_view reference_head =
    "| key | type | unit | default | allowed | meaning |\n|---|---|---|---|---|---|\n";

}  // namespace

Override parse_override(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string key = trimmed(text.substr(0, equals));
  if (equals == std::string::npos || key.empty())
    throw UserError("--set {}: is not of the form key=value; write for example --set friction.mu_k=1.0",
                    files::shortened(text));
  return {key, trimmed(text.substr(equals + 1))};
}

namespace {

Case case_of(Document document, const std::string& name) {
  check_tables(document, common_entries());

  Case config;
  // The law first: it decides which keys there are.
  if (const Setting* law = find_setting(document, "friction.law"))
    assign(*find_entry(common_entries(), "friction.law"), *law, config);
  drop_parameters_of_other_laws(config, document);
  for (const char* key : deciding_keys) {
    const Entry& entry = *find_entry(common_entries(), key);
    if (const Setting* setting = find_setting(document, key); setting && applies(entry, config))
      assign(entry, *setting, config);
  }
  drop_keys_that_overrides_exclude(config, document);
  const std::vector<Entry> entries = entries_of(config);
  for (const Setting& setting : document.settings) {
    const Entry* entry = find_entry(entries, setting.key);
    if (!entry) throw_unknown_key(setting, entries, config);
    if (entry->key != "friction.law") assign(*entry, setting, config);
  }
  check_friction(config, document, name);
  check_relations(config, document, name);
  check_magnitudes(config, document, name);
  check_duration(config, document, name);
  return config;
}

/// The path of a table that a key names; it counts from the folder of the case file.
std::string path_of_table(const std::filesystem::path& folder, const char* key, const std::string& file) {
  std::error_code error;
  const auto path = std::filesystem::absolute(folder / file, error).lexically_normal();
  if (error)
    throw UserError("{}: {}: the working folder cannot be found ({}); change to another one", key,
                    files::one_line(file), error.message());
  if (files::line_outside_utf8(path.native()) > 0)  // the path goes into files that are UTF-8
    throw UserError("{}: {}: its path holds bytes that are no utf-8; rename the folder or the file", key,
                    files::one_line(path.native()));
  return path.string();
}

/// Reads the tables that a case names.
void read_tables(const std::filesystem::path& folder, Case& config) {
  if (auto& prestress = config.prestress; !prestress.file.empty()) {
    prestress.file = path_of_table(folder, "prestress.file", prestress.file);
    prestress.table = read_prestress(prestress.file);
  }
  if (auto& along_x = config.friction_along_x; !along_x.file.empty()) {
    along_x.file = path_of_table(folder, "friction.file", along_x.file);
    along_x.table = read_friction_table(along_x.file, config.friction);
  }
}

}  // namespace

Case parse_case(const std::string& text, const std::string& name, const std::vector<Override>& overrides) {
  Document document = parse_document(text, name);
  apply(overrides, document);
  return case_of(std::move(document), name);
}

CaseFile::CaseFile(const std::filesystem::path& file, const std::vector<Override>& overrides)
    : name_(file.empty() ? "CASE" : files::one_line(file.native())) {
  constexpr std::size_t most_bytes = std::size_t{64} << 20U;
  document_ = parse_document(files::read_text(file, name_, "case file", most_bytes), name_);
  if (document_.settings.empty())
    throw UserError("{}: sets no key; write at least one, `slipfront keys` lists them", name_);
  apply(overrides, document_);
  config_ = case_of(document_, name_);
  try {
    read_tables(file.parent_path(), config_);
  } catch (const UserError& error) {
    throw UserError(with_place(error.what()));
  }
}

Case read_case(const std::filesystem::path& file, const std::vector<Override>& overrides) {
  return CaseFile(file, overrides).config();
}

std::string to_toml(const Case& config) {
  std::string text;
  std::string open_table;
  for (const Entry& entry : entries_of(config)) {
    const std::string table = table_of(entry.key);
    if (table != open_table) text += fmt::format("\n[{}]\n", table);
    open_table = table;
    text += fmt::format("{} = {}  # {}\n", leaf_of(entry.key), toml_text(entry.get(config)), entry.help);
  }
  return text;
}

std::string schema_reference() {
  std::string text =
      "# Keys of the case file\n\n"
      "A key that is not set keeps its default. On the command line, `--set table.key=value` wins over the "
      "file.\n"
      "All quantities are in SI units, named by the ending of the key. A file sets at least one key. Numbers "
      "other "
      "than 0\nmust be within these magnitudes, beyond which products of them would leave the range of "
      "doubles:\n\n"
      "| unit | at least | at most |\n|---|---|---|\n";
  for (const auto& [unit, least, most] : all_magnitudes())
    text += fmt::format("| {} | {:g} | {:g} |\n", unit.empty() ? "others" : unit, least, most);
  text += "\n";
  text += reference_head;
  const Case defaults;
  std::string open_table;
  const auto close_table = [&] {
    if (open_table != "friction") return;
    for (const LawEntries& law : friction_laws()) {
      Case of_law;
      of_law.friction = law.defaults;
      text += fmt::format("\nWith `law = \"{}\"` ({}):\n\n{}", law.name, law.help, reference_head);
      for (const Entry& parameter : law.entries) text += reference_row(parameter, of_law);
    }
  };
  for (const Entry& entry : common_entries()) {
    const std::string table = table_of(entry.key);
    if (table != open_table) {
      close_table();
      text += fmt::format("\n## [{}]\n\n{}", table, reference_head);
    }
    open_table = table;
    text += reference_row(entry, defaults);
  }
  return text;
}

std::string CaseFile::place_of_key(const std::string& key) const {
  return place_of(document_, {key}, name_);
}

std::string CaseFile::with_place(const std::string& message) const {
  std::string first_key;
  std::size_t first = std::string::npos;
  const auto consider = [&](const std::vector<Entry>& entries) {
    for (const Entry& entry : entries) {
      if (table_of(entry.key).empty()) continue;
      const std::size_t position = message.find(entry.key);
      if (position == std::string::npos) continue;
      if (first_key.empty() || position < first ||
          (position == first && entry.key.size() > first_key.size())) {
        first = position;
        first_key = entry.key;
      }
    }
  };
  consider(common_entries());
  for (const LawEntries& law : friction_laws()) consider(law.entries);
  const std::string place = first_key.empty() ? name_ : place_of_key(first_key);
  return fmt::format("{}: {}", place, message);
}

}  // namespace slipfront::input
