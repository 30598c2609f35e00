// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "interface/trigger.hpp"
#include "motion/stepper.hpp"
#include "processes/message_buffer.hpp"
#include "solid/operator.hpp"

namespace slipfront::motion {

/// State of a Stepper in the owned columns of a subdomain, or in all columns, keyed by global node numbers,
/// so that it fits any other partition.
///
/// Sums over nodes, such as works, add up over the subdomains.
struct StateByNode {
  using By = StateKey;
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
  std::vector<std::vector<double>> sums;  ///< of each subdomain
  std::vector<std::uint8_t> flags;        ///< the same in all subdomains
  interface::Trigger trigger;

  /// @throws UserError where lists have other lengths than they say
  void require_consistent() const;
  /// Adds what another subdomain keeps, of n_subdomains nearly equal ones.
  void add(StateByNode subdomain, int n_subdomains);
  /// Sorts each list by its keys, as restore requires.
  void sort();
  /// What is in some columns, and places along the interface, in the same order.
  /// @param bodies    the whole ones
  /// @param has_sums  0 instead of them, if not
  StateByNode in(const mesh::Subset& columns, const mesh::Subset& interface_nodes,
                 std::span<const mesh::NodeColumns> bodies, bool has_sums) const;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(step, values, sums, flags, trigger);
  }
  void put(MessageBuffer& to) const;
  static StateByNode take(MessageBuffer& from);
};

StateByNode keep(Stepper& stepper, const SubdomainPlace& place);
/// Restores the sorted state of the whole bodies in a stepper of all or some of their columns.
/// @throws UserError where it is of other bodies
void restore(const StateByNode& kept, Stepper& stepper, const SubdomainPlace& place);

}  // namespace slipfront::motion
