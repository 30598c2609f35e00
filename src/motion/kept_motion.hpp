// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "interface/trigger.hpp"
#include "motion/stepper.hpp"
#include "processes/parcel.hpp"
#include "solid/operator.hpp"

namespace slipfront::motion {

/// All that changes in a Stepper, in the columns of nodes that a part of the bodies accounts for, or in all
/// of them: by the nodes' numbers in the whole bodies, so that it goes into parts of any other division.
///
/// Of sums over nodes, works among them, the parts' add up to the whole's.
struct KeptMotion {
  using By = KeptBy;
  /// Values of some of them, `width` of each.
  struct Values {
    By by = By::node;
    std::uint8_t body = 0;
    std::uint32_t width = 0;
    std::vector<std::int64_t> key;  ///< a column's is that of the whole, n_columns more for each further row
    std::vector<double> value;      ///< [keys x width]
    template <class Archive>
    void serialize(Archive& archive) {
      archive(by, body, width, key, value);
    }
  };
  std::int64_t step = 0;
  std::vector<Values> values;             ///< lists in a fixed order
  std::vector<std::vector<double>> sums;  ///< of each part
  std::vector<std::uint8_t> flags;        ///< the same in all parts
  interface::Trigger trigger;

  /// @throws UserError where lists have other lengths than they say
  void require_consistent() const;
  /// Adds what another part keeps, of n_parts nearly equal ones.
  void add(KeptMotion part, int n_parts);
  /// Brings each list into the order of its keys, which restore needs.
  void sort();
  /// What is in some columns, and places along the interface, in the same order.
  /// @param bodies    the whole ones
  /// @param has_sums  0 instead of them, if not
  KeptMotion in(const mesh::Subset& columns, const mesh::Subset& lower,
                std::span<const mesh::NodeColumns> bodies, bool has_sums) const;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(step, values, sums, flags, trigger);
  }
  void put(Parcel& to) const;
  static KeptMotion take(Parcel& from);
};

KeptMotion keep(Stepper& stepper, const PlaceInWhole& place);
/// Puts what was kept of the whole bodies, sorted, into a stepper of all or some of their columns.
/// @throws UserError where it is of other bodies
void restore(const KeptMotion& kept, Stepper& stepper, const PlaceInWhole& place);

}  // namespace slipfront::motion
