// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "input/case.hpp"
#include "input/document.hpp"

namespace slipfront::input {

/// `--set key=value` from the command line: dotted key, value as TOML; a word or text needs no quotes.
using Override = std::pair<std::string, std::string>;

/// Splits "key=value". @throws UserError where there is no "=" or no key.
Override parse_override(const std::string& text);

/// A case as a text that is in no file.
struct CaseText {
  std::string text;
  std::string name;              ///< stands for the file in messages
  std::filesystem::path folder;  ///< from which the paths of its tables count
};

/// A case file, read once, since it may be a pipe, with the overrides of the command line. What it does not
/// name keeps its default. Overrides win over the file, the last one over earlier ones. Where an override
/// changes friction.law, the file's parameters of its own law do not count. The tables of
/// prestress.file and friction.file are read as well.
class CaseFile {
 public:
  /// @throws UserError with file, line and what to do: missing file, no key in it, syntax, unknown key (with
  /// the nearest known one), wrong type, value out of range, parameters that do not fit together, table.
  explicit CaseFile(const std::filesystem::path& file, const std::vector<Override>& overrides = {});
  /// Reads a text, which may set no key if there are overrides.
  explicit CaseFile(const CaseText& text, const std::vector<Override>& overrides = {});

  const Case& config() const { return config_; }
  /// Keys of the file that overrides leave without effect, a line for each reason.
  const std::vector<std::string>& notes() const { return notes_; }

  /// An error found after reading (geometry, step) with its place, "FILE:LINE: message", "--set key=value:
  /// ..." or "FILE: ...". Of the error's keys that counts which an override sets, else the first that the
  /// file sets.
  UserError with_place(const UserError& error) const;
  /// Does work on the case; its errors get their place.
  template <class Work>
  auto placing_errors(Work&& work) const {
    try {
      return work();
    } catch (const UserError& error) {
      throw with_place(error);
    }
  }

 private:
  void require_a_key() const;
  /// Makes the case of the document.
  void read(const std::filesystem::path& folder, const std::vector<Override>& overrides);

  std::string name_;
  Document document_;  ///< overrides included
  Case config_;
  std::vector<std::string> notes_;
};

/// The case alone.
Case read_case(const std::filesystem::path& file, const std::vector<Override>& overrides = {});

/// Parses a case from a text; `name` stands for the file in messages. No table is read.
Case parse_case(const std::string& text, const std::string& name,
                const std::vector<Override>& overrides = {});

/// Tables of a case that stand by themselves, such as those of one body: what they ask of other tables is not
/// checked. Files that they name are read; paths count from the working folder.
Case parse_tables(const std::vector<Override>& keys);

/// Every key with its value, as a case file that reads back to the same case (doubles to full precision),
/// each with its help as a comment.
std::string to_toml(const Case& config);

/// Reference page of all keys (Markdown): per table a row per key with type, unit, default, range, meaning.
std::string schema_reference();
/// The part of it on a table, "friction", or a key, "friction.mu_k". @throws UserError where there is none
std::string schema_reference_of(const std::string& part);

}  // namespace slipfront::input
