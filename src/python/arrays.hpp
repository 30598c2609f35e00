// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/ndarray.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "python/bindings.hpp"

namespace slipfront::python {

/// Arrays that Python hands in: doubles side by side.
using Values = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Rows = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
/// NumPy arrays that Python gets.
using Array = nb::ndarray<nb::numpy, const double, nb::ndim<1>>;

inline std::span<const double> view(const Values& values) {
  return {values.data(), values.size()};
}

inline std::vector<double> to_vector(const Values& values) {
  return {values.data(), values.data() + values.size()};
}

inline std::vector<double> to_vector(const Rows& rows) {
  return {rows.data(), rows.data() + rows.size()};
}

/// A NumPy array that owns the vector's memory.
inline Array to_array(std::vector<double> values) {
  auto* kept = new std::vector<double>(std::move(values));
  const nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
  return Array(kept->data(), {kept->size()}, owner);
}

/// A view that cannot be written to, and keeps its owner.
template <class Owner>
Array view_of(const std::vector<double>& values, const Owner& owner) {
  return Array(values.data(), {values.size()}, nb::find(owner));
}
/// Views of several lists.
template <class Owner>
nb::typed<nb::list, Array> views_of(const std::vector<std::vector<double>>& all, const Owner& owner) {
  nb::list views;
  for (const auto& values : all) views.append(view_of(values, owner));
  return nb::borrow<nb::typed<nb::list, Array>>(views);
}

/// Becomes a ValueError.
inline void require(bool holds, const std::string& what) {
  if (!holds) throw std::invalid_argument(what);
}

inline void require_ascending(std::span<const double> values, const char* name) {
  // Not its contrary: nothing compares with what is no number.
  for (std::size_t k = 1; k < values.size(); ++k)
    require(values[k] > values[k - 1], std::string(name) + " must ascend strictly");
}

inline void require_length(const Values& values, std::size_t n, const char* name) {
  require(values.size() == n,
          std::string(name) + " has " + std::to_string(values.size()) + " values, not " + std::to_string(n));
}

}  // namespace slipfront::python
