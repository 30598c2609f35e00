// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/message.hpp"
#include "base/numbers.hpp"
#include "input/case.hpp"
#include "input/document.hpp"

namespace slipfront::input {

/// What a key takes.
enum class Kind { number, integer, flag, text, word, numbers, texts };

/// Interval of allowed numbers; an open end at infinity asks for a finite value.
struct Range {
  double min = -infinity;
  double max = infinity;
  bool min_open = true;
  bool max_open = true;
};
bool contains(const Range& range, double value);

/// "greater than 0 m", "at least 0 and at most 1", ...; empty where every finite number is allowed.
std::string describe(const Range& range, const std::string& unit);

/// Magnitudes of numbers other than 0, by their unit. They are far beyond any use, and such that no product
/// or quotient of the program leaves the range of doubles.
struct Magnitudes {
  std::string unit;
  double least = 0, most = 0;
};
const std::vector<Magnitudes>& all_magnitudes();
/// Those of a unit, e.g. "m"; of plain numbers, the last ones, where it has none of its own.
const Magnitudes& magnitudes_of(std::string_view unit);

/// A setting on which a key depends, e.g. "event.kind = nucleation".
struct Condition {
  Message setting;
  std::function<bool(const Case&)> holds;
};

/// The first part of a run that a key affects; a state before the event is shared between cases that agree in
/// the keys it depends on.
enum class Stage {
  mesh,        ///< and all that follows; what a key affects that says nothing
  statics,     ///< equilibria of the tilted plate
  tractions,   ///< prescribed ones
  motion,      ///< explicit steps, those of a ramp before the event included
  event,       ///< how it starts
  evaluation,  ///< fronts and files
};

/// A key of the case file: everything the program knows about it. Its default is the struct's own.
struct Entry {
  std::string key;  ///< dotted
  Kind kind = Kind::number;
  Range range;                     ///< of a number, an integer, each number of a list
  std::vector<std::string> words;  ///< allowed for Kind::word
  std::string help;
  std::function<Value(const Case&)> get;
  /// @pre the value is of the entry's kind and allowed: a double for a number, std::int64_t for an integer.
  std::function<void(Case&, const Value&)> set;
  /// The setting without which the key does nothing, and may not be set.
  std::optional<Condition> only_with = {};
  Stage stage = Stage::mesh;
  /// Whether a case to which it applies has to set it: no default is meant.
  bool has_to_be_set = false;
  /// Whether a case has a key without a default, which decides by being set. `get` gives an example
  /// else.
  std::function<bool(const Case&)> is_set = {};
  /// Whether an override that excludes it is refused: a default would take the place of what the file says.
  bool is_never_left_out = false;
};

/// Whether a key does something in a case.
bool applies(const Entry& entry, const Case& config);
/// Whether a case has a value of a key that applies to it.
bool has_value(const Entry& entry, const Case& config);

/// The unit that a key ends with: "m" for plate.width_m, "kg/m3" for density_kg_per_m3; empty for a plain
/// number. Friction coefficients, mu..., have none.
std::string unit_of(std::string_view key);

/// The last part of a key: "width" and "m" of plate.width_m.
struct NameAndUnit {
  std::string name, unit;
};
NameAndUnit parts_of(std::string_view key);

/// A friction law of the registry and the keys of its parameters.
struct LawEntries {
  std::string name;
  std::string help;
  interface::FrictionLaw defaults;
  std::vector<Entry> entries;
};
const std::vector<LawEntries>& friction_laws();

/// The law that a case holds.
const LawEntries& law_of(const Case& config);

/// Keys of every case, in the order of the case file; those of the friction laws follow `friction.law`.
const std::vector<Entry>& common_entries();

/// The entry of a key; null where none is that.
const Entry* find_entry(const std::vector<Entry>& entries, const std::string& key);
/// One of common_entries. @pre it is
const Entry& entry_of(const std::string& key);

/// All keys that a case can set, those of its friction law among them, in the order of the case file.
std::vector<Entry> entries_of(const Case& config);

/// What of a case its state before the event depends on: the keys of some stages with their values, and the
/// contents of the tables that they name.
std::string text_of_stages(const Case& config, const std::vector<Stage>& stages);

/// "0.2 m", or the number alone.
std::string with_unit(const std::string& number, const std::string& unit);

/// The part before the last dot: "plate"; empty for a key outside all tables.
std::string table_of(const std::string& key);
/// The part after the last dot: "width_m".
std::string leaf_of(const std::string& key);

}  // namespace slipfront::input
