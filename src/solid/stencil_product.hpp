// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/lanes.hpp"
#include "solid/operator.hpp"

// The interior stencil's product with rows of a vector field: for one column, or for as many as a vector has
// lanes.
namespace slipfront::solid {

/// The stencil in the precision of the product.
template <class Real>
struct StencilOf {
  Real centre, along, across, corner, twist;
  explicit StencilOf(const InteriorStencil& s)
      : centre(static_cast<Real>(s.centre)),
        along(static_cast<Real>(s.along)),
        across(static_cast<Real>(s.across)),
        corner(static_cast<Real>(s.corner)),
        twist(static_cast<Real>(s.twist)) {}
};

/// The stencil's terms by the column they come from, so that two vectors per component have to be shifted:
/// unaligned loads of all neighbours cost more than the arithmetic.
template <class V>
struct StencilTerms {
  V w_x, w_y;
  V own_x, own_y;            ///< for the columns themselves
  V to_right_x, to_right_y;  ///< for the columns to the right of them
  V to_left_x, to_left_y;
};

/// Terms of the columns from i on.
template <class V, class Real, class In>
inline StencilTerms<V> stencil_terms(const StencilOf<Real>& s, int i, ConstRowOf<In> south,
                                     ConstRowOf<In> middle, ConstRowOf<In> north) {
  const V south_x = load_as<V>(south.x + i), south_y = load_as<V>(south.y + i);
  const V north_x = load_as<V>(north.x + i), north_y = load_as<V>(north.y + i);
  const V w_x = load_as<V>(middle.x + i), w_y = load_as<V>(middle.y + i);
  const V sum_x = south_x + north_x, twist_x = s.twist * (north_x - south_x);
  const V sum_y = south_y + north_y, twist_y = s.twist * (north_y - south_y);
  const V beside_x = s.along * w_x + s.corner * sum_x, beside_y = s.across * w_y + s.corner * sum_y;
  return {w_x,
          w_y,
          s.centre * w_x + s.across * sum_x,
          s.centre * w_y + s.along * sum_y,
          beside_x - twist_y,
          beside_y - twist_x,
          beside_x + twist_y,
          beside_y + twist_x};
}

template <class V>
struct StencilProduct {
  V x, y;
};

/// For the columns `here`, between those on the left and on the right.
template <class V>
inline StencilProduct<V> stencil_product(const StencilTerms<V>& left, const StencilTerms<V>& here,
                                         const StencilTerms<V>& right) {
  return {here.own_x +
              (from_left(left.to_right_x, here.to_right_x) + from_right(here.to_left_x, right.to_left_x)),
          here.own_y +
              (from_left(left.to_right_y, here.to_right_y) + from_right(here.to_left_y, right.to_left_y))};
}

}  // namespace slipfront::solid
