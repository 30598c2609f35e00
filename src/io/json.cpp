// SPDX-License-Identifier: BSD-3-Clause
#include "io/json.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace slipfront::io {
namespace {

/// The text and the value where an element is an entry of an object.
const Json::Array* entry(const Json& element) {
  const auto* pair = std::get_if<Json::Array>(&element.value());
  const bool is_entry =
      pair != nullptr && pair->size() == 2 && std::holds_alternative<std::string>(pair->front().value());
  return is_entry ? pair : nullptr;
}

using Written = nlohmann::ordered_json;

Written written(const Json& json);

struct Converter {
  Written operator()(const Json::Array& array) const {
    Written all = Written::array();
    for (const auto& element : array) all.push_back(written(element));
    return all;
  }
  Written operator()(const Json::Object& object) const {
    Written all = Written::object();
    for (const auto& [key, value] : object) all[key] = written(value);
    return all;
  }
  template <class Plain>
  Written operator()(const Plain& value) const {
    return value;
  }
};

Written written(const Json& json) {
  return std::visit(Converter{}, json.value());
}

}  // namespace

Json::Json(std::initializer_list<Json> elements) {
  if (!std::ranges::all_of(elements, [](const Json& element) { return entry(element) != nullptr; })) {
    value_ = Array(elements);
    return;
  }
  Object object;
  for (const auto& element : elements)
    object.emplace_back(std::get<std::string>(entry(element)->front().value()), entry(element)->back());
  value_ = std::move(object);
}

Json& Json::operator[](std::string_view key) {
  if (std::holds_alternative<std::nullptr_t>(value_)) value_ = Object();
  auto& object = std::get<Object>(value_);
  const auto found = std::ranges::find(object, key, &Object::value_type::first);
  return found != object.end() ? found->second : object.emplace_back(key, Json()).second;
}

void Json::push_back(Json element) {
  if (std::holds_alternative<std::nullptr_t>(value_)) value_ = Array();
  std::get<Array>(value_).push_back(std::move(element));
}

void Json::update(const Json& object) {
  for (const auto& [key, value] : std::get<Object>(object.value_)) (*this)[key] = value;
}

std::string Json::dump(int indent) const {
  return written(*this).dump(indent);
}

}  // namespace slipfront::io
