// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace slipfront::input {

/// A value that no key takes, e.g. a date; `type` is its name for messages.
struct Unsupported {
  std::string type;
};

/// A value of a case file. Integers and numbers are told apart as they were written.
using Value = std::variant<bool, std::int64_t, double, std::string, std::vector<double>,
                           std::vector<std::string>, Unsupported>;

/// One key of a case file, or one override.
struct Setting {
  std::string key;  ///< dotted, e.g. plate.width_m
  Value value;
  std::string place;  ///< "FILE:LINE" or "--set key=value"
  int line = 0;       ///< in the file; 0 for an override
  bool is_override() const { return line == 0; }
};

/// A table that a case file opens, e.g. [plate].
struct TableHeader {
  std::string key;
  std::string place;
  int line = 0;
};

/// A case file before any check of its contents, in the order of its lines.
struct Document {
  std::vector<Setting> settings;
  std::vector<TableHeader> tables;

  /// Null where nothing sets the key.
  const Setting* find(const std::string& key) const;
};

/// Reads TOML; `name` stands for the file in places and messages. @throws UserError for a syntax error, bytes
/// that are no UTF-8, and tables or lists nested far beyond what any key asks for.
Document parse_document(const std::string& text, const std::string& name);

/// Reads what stands behind the "=" of an override; text that is no TOML value counts as a string.
Value parse_value(const std::string& text);

/// "a number", "a string", ...
std::string type_name(const Value& value);

/// The value as TOML, doubles as the shortest text that reads back to the same double.
std::string toml_text(const Value& value);

}  // namespace slipfront::input
