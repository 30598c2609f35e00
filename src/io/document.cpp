// SPDX-License-Identifier: BSD-3-Clause
// The only file that sees toml++.
#include "io/document.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <string_view>

#include "base/error.hpp"

namespace slipfront::io {
namespace {

Value list_value(const toml::array& array) {
  std::vector<double> numbers;
  for (const toml::node& element : array) {
    if (!element.is_number()) return Unsupported{"a list with something else than numbers in it"};
    numbers.push_back(*element.value<double>());
  }
  return numbers;
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
    const std::string key = prefix + one_line(name_in_table.str());
    const int line = static_cast<int>(name_in_table.source().begin.line);
    const std::string place = fmt::format("{}:{}", name, line);
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

Document parse_document(const std::string& text, const std::string& name) {
  Document document;
  try {
    flatten(toml::parse(text, name), "", name, document);
  } catch (const toml::parse_error& error) {
    const bool twice = error.description().find("redefine") != std::string_view::npos;
    throw UserError("{}:{}: {}; {}", name, error.source().begin.line, one_line(error.description()),
                    twice ? "keep only one of the two" : "correct the TOML there");
  }
  // toml++ sorts keys by name; messages are to follow the file.
  const auto by_line = [](const auto& a, const auto& b) { return a.line < b.line; };
  std::stable_sort(document.settings.begin(), document.settings.end(), by_line);
  std::stable_sort(document.tables.begin(), document.tables.end(), by_line);
  return document;
}

Value parse_value(const std::string& text) {
  try {
    const toml::table table = toml::parse("value = " + text);
    if (table.size() == 1) return to_value(table.begin()->second);
  } catch (const toml::parse_error&) {
  }
  return text;
}

std::string one_line(std::string_view text) {
  std::string line(text);
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return line;
}

std::string type_name(const Value& value) {
  struct Namer {
    std::string operator()(bool) const { return "a boolean"; }
    std::string operator()(std::int64_t) const { return "an integer"; }
    std::string operator()(double) const { return "a number"; }
    std::string operator()(const std::string&) const { return "a string"; }
    std::string operator()(const std::vector<double>&) const { return "a list of numbers"; }
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
    std::string operator()(const Unsupported& other) const { return other.type; }
  };
  return std::visit(Writer{}, value);
}

}  // namespace slipfront::io
