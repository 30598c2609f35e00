// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace slipfront {

/// A key of the case file, "table.name", as an argument of a message; "{:leaf}" writes the name alone.
struct Key {
  explicit Key(std::string dotted) : name(std::move(dotted)) {}
  std::string name;
};

/// A text for the user, or a part of one, with the keys among its arguments. By them, whoever has read the
/// case finds the line that the text is about.
struct Message {
  // A text without keys.
  Message() = default;
  Message(const char* words) : text(words) {}
  Message(std::string words) : text(std::move(words)) {}
  template <typename... Args>
  explicit Message(fmt::format_string<Args...> format, Args&&... args) {
    (add_keys_of(args), ...);
    text = fmt::format(format, std::forward<Args>(args)...);
  }

  std::string text;
  std::vector<std::string>
      keys;  ///< dotted, in the order of the arguments, which need not be that of the text

 private:
  template <class Arg>
  void add_keys_of(const Arg& argument) {
    if constexpr (std::is_same_v<Arg, Key>) keys.push_back(argument.name);
    if constexpr (std::is_same_v<Arg, Message>)
      keys.insert(keys.end(), argument.keys.begin(), argument.keys.end());
  }
};

}  // namespace slipfront

template <>
struct fmt::formatter<slipfront::Key> {
  constexpr auto parse(fmt::format_parse_context& context) {
    constexpr std::string_view leaf = "leaf";
    const std::string_view spec(context.begin(), static_cast<std::size_t>(context.end() - context.begin()));
    leaf_alone_ = spec.substr(0, leaf.size()) == leaf;
    return context.begin() + (leaf_alone_ ? leaf.size() : 0);
  }
  template <class Context>
  auto format(const slipfront::Key& key, Context& context) const {
    const auto from = leaf_alone_ ? key.name.rfind('.') + 1 : 0;
    return std::copy(key.name.begin() + static_cast<std::ptrdiff_t>(from), key.name.end(), context.out());
  }

 private:
  bool leaf_alone_ = false;
};

template <>
struct fmt::formatter<slipfront::Message> {
  constexpr auto parse(fmt::format_parse_context& context) { return context.begin(); }
  template <class Context>
  auto format(const slipfront::Message& message, Context& context) const {
    return std::copy(message.text.begin(), message.text.end(), context.out());
  }
};
