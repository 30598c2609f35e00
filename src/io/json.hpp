// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace slipfront::io {

/// A JSON value to be written, null at first; objects keep the order in which their entries came. Only
/// json.cpp includes the library that writes the text: its header takes longer to compile than most of our
/// files.
class Json {
 public:
  using Array = std::vector<Json>;
  using Object = std::vector<std::pair<std::string, Json>>;
  using Value = std::variant<std::nullptr_t, bool, std::int64_t, double, std::string, Array, Object>;

  static Json array() { return Json(Value(Array())); }
  static Json object() { return Json(Value(Object())); }

  Json() = default;
  Json(std::nullptr_t) {}
  Json(bool value) : value_(value) {}
  template <std::integral T>
  Json(T value) : value_(static_cast<std::int64_t>(value)) {}
  Json(double value) : value_(value) {}  ///< what is not finite is written as null
  Json(std::string text) : value_(std::move(text)) {}
  Json(std::string_view text) : value_(std::string(text)) {}
  Json(const char* text) : value_(std::string(text)) {}
  template <class T>
  Json(const std::vector<T>& values) : value_(Array(values.begin(), values.end())) {}
  /// An object where each element is a list of a text and a value, else an array.
  Json(std::initializer_list<Json> elements);

  /// The entry of an object, made where there is none.
  Json& operator[](std::string_view key);
  void push_back(Json element);
  /// Sets all entries of another object.
  void update(const Json& object);

  const Value& value() const { return value_; }
  std::string dump(int indent) const;

 private:
  explicit Json(Value value) : value_(std::move(value)) {}
  Value value_;
};

}  // namespace slipfront::io
