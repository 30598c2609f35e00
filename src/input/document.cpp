// SPDX-License-Identifier: BSD-3-Clause
// The only file that sees toml++.
#include "input/document.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

// What a user mistypes is an error; toml++ asserts some of it away first where assertions are on.
#define TOML_ASSERT(condition) static_assert(true)
#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include "base/error.hpp"
#include "files/text.hpp"

namespace slipfront::input {
namespace {

/// Levels that tables and lists may be nested; keys need two. The parser calls itself for each of them, and
/// some thousands exhaust the stack.
constexpr int max_levels = 32;

/// Where the string that begins at `i` ends, one past its last quote. A string that is not closed ends with
/// its line, or with the text; the parser finds it.
std::size_t end_of_string(std::string_view text, std::size_t i) {
  const char quote = text[i];
  const std::string three(3, quote);
  const bool many_lines = text.substr(i, 3) == three;
  for (i += many_lines ? 3 : 1; i < text.size(); ++i) {
    if (text[i] == '\\' && quote == '"')
      ++i;
    else if (many_lines && text.substr(i, 3) == three) {
      i += 3;
      while (i < text.size() && text[i] == quote) ++i;  // quotes that belong to the text
      return i;
    } else if (!many_lines && (text[i] == quote || text[i] == '\n')) {
      return text[i] == quote ? i + 1 : i;
    }
  }
  return text.size();
}

/// What the parser must not be given: tables or lists nested too deeply, by brackets or by the parts of a
/// key; and characters beyond ASCII where it looks for blanks, which leaves its behaviour undefined
/// (toml++ 3.3, 3.4).
struct Fault {
  enum Kind { too_deep, beyond_ascii } kind;
  std::ptrdiff_t line;  ///< from 1
};

bool is_ascii(char c) {
  return static_cast<unsigned char>(c) < 0x80;
}

/// Whether the parser looks for blanks beyond ASCII within a string: where its line is continued.
bool continues_beyond_ascii(std::string_view string) {
  for (auto i = string.find('\\'); i != std::string_view::npos; i = string.find('\\', i + 2)) {
    const auto next = string.find_first_not_of(" \t\r\n", i + 1);
    if (next != std::string_view::npos && !is_ascii(string[next])) return true;
  }
  return false;
}

std::optional<Fault> find_fault(std::string_view text) {
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
  int brackets = 0, dots = 0;
  const auto fault_at = [&](Fault::Kind kind, std::size_t i) {
    return Fault{kind, 1 + std::ranges::count(text.substr(0, i), '\n')};
  };
  for (std::size_t i = text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0; i < text.size();) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      const auto end = end_of_string(text, i);
      if (c == '"' && continues_beyond_ascii(text.substr(i, end - i)))
        return fault_at(Fault::beyond_ascii, i);
      i = end;
      continue;
    }
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size());
      continue;
    }
    if (c == '[' || c == '{') ++brackets;
    if (c == ']' || c == '}') brackets = std::max(brackets - 1, 0);
    if (c == '.')
      ++dots;
    else if (c == '\n' || c == '=' || c == ',' || c == '[' || c == '{')
      dots = 0;
    if (brackets > max_levels || dots >= max_levels) return fault_at(Fault::too_deep, i);
    if (!is_ascii(c)) return fault_at(Fault::beyond_ascii, i);
    ++i;
  }
  return std::nullopt;
}

Value list_value(const toml::array& array) {
  std::vector<double> numbers;
  std::vector<std::string> texts;
  for (const toml::node& element : array) {
    if (element.is_number())
      numbers.push_back(*element.value<double>());
    else if (element.is_string())
      texts.push_back(*element.value<std::string>());
    else
      return Unsupported{"a list with something else than numbers in it"};
  }
  if (texts.empty()) return numbers;
  if (!numbers.empty()) return Unsupported{"a list with something else than numbers in it"};
  return texts;
}

Value to_value(const toml::node& node) {
  if (const auto* flag = node.as_boolean()) return flag->get();
  if (const auto* integer = node.as_integer()) return integer->get();
  if (const auto* number = node.as_floating_point()) return number->get();
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* array = node.as_array()) return list_value(*array);
  if (node.is_table()) return Unsupported{"a table"};
  return Unsupported{"a date or time"};
}

void flatten(const toml::table& table, const std::string& prefix, const std::string& name,
             Document& document) {
  for (const auto& [name_in_table, node] : table) {
    const std::string key = prefix + files::one_line(name_in_table.str());
    const int line = static_cast<int>(name_in_table.source().begin.line);
    const std::string place = fmt::format("{}:{}", name, line);
    if (name_in_table.str().find('.') != std::string_view::npos)  // it would pass for a key of a table
      throw UserError("{}: unknown key \"{}\"; write keys as table.key, without quotes", place,
                      files::shortened(name_in_table.str()));
    if (const toml::table* inner = node.as_table()) {
      document.tables.push_back({key, place, line});
      flatten(*inner, key + ".", name, document);
    } else {
      document.settings.push_back({key, to_value(node), place, line});
    }
  }
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      result += std::string{'\\', c};
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      result += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
    else
      result += c;
  }
  return result + '"';
}

}  // namespace

const Setting* Document::find(const std::string& key) const {
  const auto found = std::ranges::find(settings, key, &Setting::key);
  return found == settings.end() ? nullptr : &*found;
}

Document parse_document(const std::string& text, const std::string& name) {
  if (const int line = files::line_outside_utf8(text); line > 0)
    throw UserError("{}:{}: holds bytes that are no utf-8; save the file in that encoding", name, line);
  if (const auto fault = find_fault(text)) {
    if (fault->kind == Fault::too_deep)
      throw UserError("{}:{}: is nested more than {} levels deep; keys are of the form table.key = value",
                      name, fault->line, max_levels);
    throw UserError(
        "{}:{}: has a character beyond ASCII outside quotes, a letter or a blank; retype the line", name,
        fault->line);
  }
  Document document;
  try {
    flatten(toml::parse(text, name), "", name, document);
  } catch (const toml::parse_error& error) {
    const bool twice = error.description().find("redefine") != std::string_view::npos;
    throw UserError("{}:{}: {}; {}", name, error.source().begin.line, files::shortened(error.description()),
                    twice ? "keep only one of the two" : "correct the TOML there");
  }
  // toml++ sorts keys by name; messages are to follow the file.
  const auto by_line = [](const auto& a, const auto& b) { return a.line < b.line; };
  std::stable_sort(document.settings.begin(), document.settings.end(), by_line);
  std::stable_sort(document.tables.begin(), document.tables.end(), by_line);
  return document;
}

Value parse_value(const std::string& text) {
  if (const auto fault = find_fault(text)) {
    if (fault->kind == Fault::beyond_ascii) return text;
    return Unsupported{fmt::format("nested more than {} levels deep", max_levels)};
  }
  try {
    const toml::table table = toml::parse("value = " + text);
    if (table.size() == 1) return to_value(table.begin()->second);
  } catch (const toml::parse_error&) {
  }
  const auto is_beyond = [&](auto number) {
    return std::from_chars(text.data(), text.data() + text.size(), number).ec ==
           std::errc::result_out_of_range;
  };
  if (is_beyond(0.0) || is_beyond(std::int64_t{})) return Unsupported{"a number out of range"};
  return text;
}

std::string type_name(const Value& value) {
  struct Namer {
    std::string operator()(bool) const { return "a boolean"; }
    std::string operator()(std::int64_t) const { return "an integer"; }
    std::string operator()(double) const { return "a number"; }
    std::string operator()(const std::string&) const { return "a string"; }
    std::string operator()(const std::vector<double>&) const { return "a list of numbers"; }
    std::string operator()(const std::vector<std::string>&) const { return "a list of strings"; }
    std::string operator()(const Unsupported& other) const { return other.type; }
  };
  return std::visit(Namer{}, value);
}

std::string toml_text(const Value& value) {
  struct Writer {
    std::string operator()(bool flag) const { return flag ? "true" : "false"; }
    std::string operator()(std::int64_t integer) const { return fmt::format("{}", integer); }
    std::string operator()(double number) const { return fmt::format("{}", number); }
    std::string operator()(const std::string& text) const { return quoted(text); }
    std::string operator()(const std::vector<double>& list) const {
      return fmt::format("[{}]", fmt::join(list, ", "));
    }
    std::string operator()(const std::vector<std::string>& list) const {
      std::vector<std::string> in_quotes;
      for (const auto& text : list) in_quotes.push_back(quoted(text));
      return fmt::format("[{}]", fmt::join(in_quotes, ", "));
    }
    std::string operator()(const Unsupported& other) const { return other.type; }
  };
  return std::visit(Writer{}, value);
}

}  // namespace slipfront::input
