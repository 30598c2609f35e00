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

#include "base/caller.hpp"
#include "base/error.hpp"
#include "files/text.hpp"
#include "input/default_rules.hpp"
#include "input/document.hpp"
#include "input/entries.hpp"
#include "input/friction_table.hpp"
#include "input/prestress.hpp"
#include "input/relations.hpp"

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

/// A key as who knows no more than its words may write it: without "_" and the unit at its end.
std::string plain_key(const std::string& key) {
  std::string plain = parts_of(key).name;
  std::erase(plain, '_');
  return table_of(key) + "." + plain;
}

/// The key nearest to one that is not known, if it is near enough to be meant.
std::optional<std::string> nearest_key(const std::string& key, const std::vector<std::string>& keys) {
  std::vector<std::string> plain;
  for (const std::string& each : keys) plain.push_back(plain_key(each));
  const auto found = nearest(plain_key(key), plain);
  if (!found) return std::nullopt;
  return keys[static_cast<std::size_t>(std::ranges::find(plain, *found) - plain.begin())];
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
  return std::ranges::find(words, word) != words.end();
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
    case Kind::texts:
      return "a list of strings";
  }
  return "";
}

// --- Overrides

std::string place_of(const Override& override) {
  return files::shortened(for_caller("--set {}={}", "{} = {}", override.first, override.second));
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

void apply(const std::vector<Override>& overrides, Document& document) {
  for (const Override& override : overrides) {
    std::erase_if(document.settings, [&](const Setting& setting) { return setting.key == override.first; });
    Setting setting = to_setting(override);
    if (override.second == "{}")
      document.tables.push_back({setting.key, setting.place, 0});
    else
      document.settings.push_back(std::move(setting));
  }
}

/// Keys that decide by their values which others there are, in the order of the case file.
const std::vector<const Entry*>& deciding_entries() {
  static const std::vector<const Entry*> deciding = [] {
    std::vector<const Entry*> all;
    for (const Entry& entry : common_entries())
      if (std::ranges::any_of(common_entries(), [&](const Entry& other) {
            return other.only_with && contains_word(other.only_with->setting.keys, entry.key);
          }))
        all.push_back(&entry);
    return all;
  }();
  return deciding;
}

/// Removes keys of the file. @return a note of it, empty where there are none
std::string drop(const std::function<bool(const Setting&)>& is_dropped, const std::string& why,
                 Document& document) {
  std::vector<std::string> keys;
  std::erase_if(document.settings, [&](const Setting& setting) {
    if (setting.is_override() || !is_dropped(setting)) return false;
    keys.push_back(setting.key);
    return true;
  });
  if (keys.empty()) return {};
  return fmt::format("{} of the case file {} not apply with {} and {} left out", fmt::join(keys, ", "),
                     keys.size() == 1 ? "does" : "do", why, keys.size() == 1 ? "is" : "are");
}

/// Where an override decides that a key of the file does not apply, that is out of date rather than wrong.
std::string drop_keys_that_overrides_exclude(const Case& config, Document& document) {
  std::vector<std::string> why, dropped;
  const auto overridden = [&](const Entry& entry) {
    return std::ranges::any_of(entry.only_with->setting.keys, [&](const std::string& key) {
      const Setting* setting = document.find(key);
      if (!setting) return false;
      if (contains_word(dropped, key)) return true;
      if (!setting->is_override()) return false;
      if (!contains_word(why, setting->place)) why.push_back(setting->place);
      return true;
    });
  };
  for (const Entry& entry : common_entries())
    if (!entry.is_never_left_out && !applies(entry, config) && overridden(entry))
      dropped.push_back(entry.key);
  return drop([&](const Setting& setting) { return contains_word(dropped, setting.key); },
              fmt::format("{}", fmt::join(why, ", ")), document);
}

/// Where an override names the law, what the file says of other laws is out of date rather than wrong.
std::string drop_parameters_of_other_laws(const Case& config, Document& document) {
  const Setting* law = document.find("friction.law");
  if (!law || !law->is_override()) return {};
  const LawEntries& current = law_of(config);
  const std::string why = law->place;
  return drop(
      [&](const Setting& setting) {
        return !find_entry(current.entries, setting.key) && law_with(setting.key, &current) != nullptr;
      },
      why, document);
}

// --- Single keys

[[noreturn]] void throw_unknown_table(const TableHeader& table, const std::vector<std::string>& tables) {
  const auto guess = nearest(table.key, tables);
  if (guess) throw UserError("{}: unknown table [{}]; did you mean [{}]?", table.place, table.key, *guess);
  throw UserError("{}: unknown table [{}]; tables are {}", table.place, files::shortened(table.key),
                  fmt::join(tables, ", "));
}

/// Symbols and short names that stand for a key's last part.
constexpr std::array<std::pair<const char*, const char*>, 11> short_names = {
    {{"E", "youngs_modulus_Pa"},
     {"youngs_modulus", "youngs_modulus_Pa"},
     {"nu", "poissons_ratio"},
     {"rho", "density_kg_per_m3"},
     {"density", "density_kg_per_m3"},
     {"beta", "stiffness_damping_s"},
     {"beta_R", "stiffness_damping_s"},
     {"damping", "stiffness_damping_s"},
     {"h", "element_size_m"},
     {"normal_force_N", "normal_force_N_per_m"},
     {"shear_force_N", "shear_force_N_per_m"}}};

/// The key of the same table that a short name stands for.
std::optional<std::string> key_of_short_name(const std::string& key) {
  for (const auto& [name, leaf] : short_names)
    if (const auto meant = table_of(key) + "." + leaf;
        leaf_of(key) == name && find_entry(common_entries(), meant))
      return meant;
  return std::nullopt;
}

/// A key of the version before, and what became of it.
struct RenamedKey {
  const char* old_key;
  const char* key;
  const char* how;  ///< its number follows from the old one
};
constexpr std::array<RenamedKey, 4> renamed_keys = {
    {{"loading.shear_speed_over_c_L", "loading.shear_speed_m_per_s",
      "in m/s: the number times c_L, which slipfront info tells"},
     {"loading.shear_stiffness_Pa", "loading.shear_stiffness_Pa_per_m",
      "stress per metre: the number over plate.width_m, or over the pusher's length"},
     {"loading.normal_stiffness_Pa", "loading.normal_stiffness_Pa_per_m",
      "stress per metre: the number over plate.width_m"},
     {"event.trigger_amount", "event.trigger_over_missing",
      "with event.trigger_form = raised event.trigger_over_strength; the number stays"}}};

void refuse_renamed(const std::string& place, const std::string& key) {
  for (const auto& [old_key, now, how] : renamed_keys)
    if (key == old_key) throw UserError("{}: {} is {} now, {}", place, key, now, how);
}

[[noreturn]] void throw_unknown_key(const Setting& setting, const std::vector<Entry>& entries,
                                    const Case& config) {
  const std::string& key = setting.key;
  refuse_renamed(setting.place, key);
  if (const LawEntries* other = law_with(key, &law_of(config)))
    throw UserError("{}: {} belongs to the friction law {}, but {} is {}; remove the key or set the law",
                    setting.place, key, other->name, Key("friction.law"), law_of(config).name);
  if (const Entry* entry = find_entry(common_entries(), key))
    throw UserError("{}: {} applies only with {}; remove the key or set that", setting.place, key,
                    entry->only_with->setting);
  if (const auto meant = key_of_short_name(key))
    throw UserError("{}: unknown key {}; did you mean {}?", setting.place, key, *meant);
  std::vector<std::string> keys;
  for (const Entry& entry : entries) {
    // The right name in the wrong table is the likelier slip than any misspelling.
    if (leaf_of(entry.key) == leaf_of(key))
      throw UserError("{}: unknown key {}; did you mean {}?", setting.place, files::shortened(key),
                      entry.key);
    keys.push_back(entry.key);
  }
  const auto guess = nearest_key(key, keys);
  // A key that does not apply, or a parameter of another law, but for its unit, before one that is only
  // alike.
  if (!guess || plain_key(*guess) != plain_key(key)) {
    for (const Entry& entry : common_entries())
      if (plain_key(entry.key) == plain_key(key))
        throw UserError("{}: unknown key {}; did you mean {}?", setting.place, key, entry.key);
    for (const LawEntries& law : friction_laws())
      for (const Entry& entry : law.entries)
        if (plain_key(entry.key) == plain_key(key))
          throw UserError("{}: unknown key {}; did you mean {} of the friction law {}?", setting.place, key,
                          entry.key, law.name);
  }
  if (guess) throw UserError("{}: unknown key {}; did you mean {}?", setting.place, key, *guess);
  throw UserError("{}: unknown key {}; the command `slipfront keys` lists all", setting.place,
                  key.empty() ? "\"\"" : files::shortened(key));
}

[[noreturn]] void throw_wrong_type(const Entry& entry, const Setting& setting, const Value& default_value) {
  const std::string& key = entry.key;
  const std::string value = entry.kind == Kind::numbers ? "[1e-5, 2e-5]"
                            : entry.kind == Kind::texts ? "[\"left\", \"right\"]"
                                                        : toml_text(default_value);
  const std::string example = setting.is_override() ? for_caller("--set {}={}", "{} = {}", key, value)
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

/// A byte 0 ends a text for the files that it goes into.
void require_text(const Entry& entry, const Setting& setting, const std::string& text) {
  if (text.find('\0') != std::string::npos)
    throw UserError("{}: {} holds the character U+0000; remove it", setting.place, entry.key);
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
    case Kind::text: {
      const auto* text = std::get_if<std::string>(&value);
      if (!text) break;
      require_text(entry, setting, *text);
      return value;
    }
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
    case Kind::texts: {
      const auto* none = std::get_if<std::vector<double>>(&value);
      if (none && none->empty()) return std::vector<std::string>{};
      const auto* texts = std::get_if<std::vector<std::string>>(&value);
      if (!texts) break;
      for (const auto& text : *texts) require_text(entry, setting, text);
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

// --- Places

/// Place of the first of these keys that is set, an override before the file; `name` where none is.
std::string place_of(const Document& document, const std::vector<std::string>& keys,
                     const std::string& name) {
  std::string place = name;
  for (const std::string& key : keys) {
    const Setting* setting = document.find(key);
    if (!setting) continue;
    if (setting->is_override()) return setting->place;
    if (place == name) place = setting->place;
  }
  return place;
}

UserError with_place(const UserError& error, const Document& document, const std::string& name) {
  return error.at(place_of(document, error.keys(), name));
}

// --- Reference

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
  if (entry.only_with) help += "; only with " + entry.only_with->setting.text;
  const DefaultRule* rule = default_rule_of(entry.key);
  const std::string standard = entry.has_to_be_set ? "none: to be set"
                               : entry.is_set      ? "none"
                               : rule              ? rule->text
                                                   : fmt::format("`{}`", toml_text(entry.get(defaults)));
  return fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", leaf_of(entry.key), type, unit_of(entry.key),
                     standard, allowed, help);
}

constexpr std::string_view reference_head =
    "| key | type | unit | default | allowed | meaning |\n|---|---|---|---|---|---|\n";

using Wanted = std::function<bool(const Entry&)>;

/// Rows of the entries that are wanted below a heading; empty where none is.
std::string section(const std::string& heading, const std::vector<Entry>& entries, const Case& defaults,
                    const Wanted& is_wanted) {
  std::string rows;
  for (const Entry& entry : entries)
    if (is_wanted(entry)) rows += reference_row(entry, defaults);
  return rows.empty() ? "" : heading + std::string(reference_head) + rows;
}

/// Sections of the entries that are wanted.
std::string reference_of(const Wanted& is_wanted) {
  std::vector<std::string> tables = tables_of(common_entries());
  tables.insert(tables.begin(), "");
  std::string text;
  for (const std::string& table : tables) {
    const auto is_of_table = [&](const Entry& entry) {
      return table_of(entry.key) == table && is_wanted(entry);
    };
    const auto between = [&] { return text.empty() ? "" : "\n"; };
    text += section(table.empty() ? "" : fmt::format("{}## [{}]\n\n", between(), table), common_entries(),
                    Case{}, is_of_table);
    if (table != "friction") continue;
    for (const LawEntries& law : friction_laws()) {
      Case of_law;
      of_law.friction = law.defaults;
      text += section(fmt::format("{}With `law = \"{}\"` ({}):\n\n", between(), law.name, law.help),
                      law.entries, of_law, is_wanted);
    }
  }
  return text;
}

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

/// @param check  of the whole case
Case case_of(Document document, const std::string& name, std::vector<std::string>& notes,
             const std::function<void(const Case&, const Document&)>& check = check_relations) {
  check_tables(document, common_entries());

  Case config;
  // The law first: it decides which keys there are.
  if (const Setting* law = document.find("friction.law")) assign(entry_of("friction.law"), *law, config);
  notes.push_back(drop_parameters_of_other_laws(config, document));
  const auto decide = [&](auto&& counts) {
    for (const Entry* entry : deciding_entries())
      if (const Setting* setting = document.find(entry->key);
          setting && counts(*entry, *setting) && applies(*entry, config))
        assign(*entry, *setting, config);
  };
  decide([](const Entry& entry, const Setting&) { return !entry.is_set; });
  // Keys that decide by being set exclude others of their kind: overrides win.
  decide([](const Entry& entry, const Setting& setting) { return entry.is_set && setting.is_override(); });
  decide([](const Entry& entry, const Setting&) { return static_cast<bool>(entry.is_set); });
  notes.push_back(drop_keys_that_overrides_exclude(config, document));
  std::erase(notes, "");
  const std::vector<Entry> entries = entries_of(config);
  for (const Setting& setting : document.settings) {
    const Entry* entry = find_entry(entries, setting.key);
    if (!entry) throw_unknown_key(setting, entries, config);
    if (entry->key != "friction.law") assign(*entry, setting, config);
  }
  set_defaults_by_rule(document, config);
  try {
    check(config, document);
  } catch (const UserError& error) {
    throw with_place(error, document, name);
  }
  return config;
}

/// The path of a table that a key names; it counts from the folder of the case file.
std::string path_of_table(const std::filesystem::path& folder, const char* key, const std::string& file) {
  std::error_code error;
  const auto path = std::filesystem::absolute(folder / file, error).lexically_normal();
  if (error)
    throw UserError("{}: {}: the working folder cannot be found ({}); change to another one", Key(key),
                    files::one_line(file), error.message());
  if (files::line_outside_utf8(path.native()) > 0)  // the path goes into files that are UTF-8
    throw UserError("{}: {}: its path holds bytes that are no utf-8; rename the folder or the file", Key(key),
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
  std::vector<std::string> notes;
  return case_of(std::move(document), name, notes);
}

Case parse_tables(const std::vector<Override>& keys) {
  Document document;
  apply(keys, document);
  std::vector<std::string> notes;
  Case config = case_of(std::move(document), "case", notes,
                        [](const Case& tables, const Document&) { check_each_table(tables); });
  read_tables({}, config);
  return config;
}

CaseFile::CaseFile(const std::filesystem::path& file, const std::vector<Override>& overrides)
    : name_(file.empty() ? "CASE" : files::one_line(file.native())) {
  constexpr std::size_t max_bytes = std::size_t{64} << 20U;
  document_ = parse_document(files::read_text(file, name_, "case file", max_bytes), name_);
  require_a_key();
  read(file.parent_path(), overrides);
}

CaseFile::CaseFile(const CaseText& text, const std::vector<Override>& overrides)
    : name_(files::one_line(text.name)), document_(parse_document(text.text, name_)) {
  read(text.folder, overrides);
}

void CaseFile::require_a_key() const {
  if (document_.settings.empty())
    throw UserError("{}: sets no key; write at least one; the command `slipfront keys` lists all", name_);
}

void CaseFile::read(const std::filesystem::path& folder, const std::vector<Override>& overrides) {
  apply(overrides, document_);
  config_ = case_of(document_, name_, notes_);
  require_a_key();
  placing_errors([&] { read_tables(folder, config_); });
}

Case read_case(const std::filesystem::path& file, const std::vector<Override>& overrides) {
  return CaseFile(file, overrides).config();
}

std::string to_toml(const Case& config) {
  std::string text;
  std::string open_table;
  for (const Entry& entry : entries_of(config)) {
    if (!has_value(entry, config)) continue;
    const std::string table = table_of(entry.key);
    if (table != open_table) text += fmt::format("\n[{}]\n", table);
    open_table = table;
    text += fmt::format("{} = {}  # {}\n", leaf_of(entry.key), toml_text(entry.get(config)), entry.help);
  }
  return text;
}

std::string schema_reference() {
  std::string text = R"(# Keys of the case file

A key that is not set keeps its default. On the command line, `--set table.key=value` wins over the file.
All quantities are in SI units, named by the ending of the key. A file sets at least one key. Numbers other than 0
must be within these magnitudes, beyond which products of them would leave the range of doubles:

| unit | at least | at most |
|---|---|---|
)";
  for (const auto& [unit, least, most] : all_magnitudes())
    text += fmt::format("| {} | {:g} | {:g} |\n", unit.empty() ? "others" : unit, least, most);
  text += R"(
Defaults that are lengths or times are multiples of `plate.width_m`, of `plate.height_m` or of the time width_m / c_S
in which a shear wave crosses the plate (of two bodies with the slower one's c_S). `case.resolved.toml` beside the
results has the values. Without any key two bodies of PMMA, each 100 mm wide and 50 mm high, are pressed together by
0.25 mm at the left and 0.2 mm at the right, and sheared until a front nucleates spontaneously.

)";
  return text + reference_of([](const Entry&) { return true; });
}

std::string schema_reference_of(const std::string& part) {
  std::string text = reference_of([&](const Entry& entry) {
    return entry.key == part || table_of(entry.key) == part || leaf_of(entry.key) == part;
  });
  if (!text.empty()) return text;
  refuse_renamed("slipfront: keys", part);
  std::vector<std::string> keys = tables_of(common_entries());
  for (const Entry& entry : common_entries()) keys.push_back(entry.key);
  for (const LawEntries& law : friction_laws())
    for (const Entry& entry : law.entries) keys.push_back(entry.key);
  const auto guess = nearest_key(part, keys);
  throw UserError("slipfront: keys {}: is no table and no key; {}", files::shortened(part),
                  guess ? fmt::format("did you mean {}?", *guess) : "slipfront keys lists all");
}

UserError CaseFile::with_place(const UserError& error) const {
  return input::with_place(error, document_, name_);
}

}  // namespace slipfront::input
