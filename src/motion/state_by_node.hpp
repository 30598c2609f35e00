// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "mesh/node_columns.hpp"

namespace slipfront::motion {

/// An array of a stepper: numbers, flags, or numbers that follow from the case, with which saved ones are
/// compared.
class StateArray {
 public:
  StateArray(double* numbers) : numbers_(numbers) {}                               // NOLINT: is one
  StateArray(std::vector<double>& numbers) : numbers_(numbers.data()) {}           // NOLINT
  StateArray(std::vector<std::uint8_t>& flags) : flags_(flags.data()) {}           // NOLINT
  StateArray(const std::vector<double>& expected) : expected_(expected.data()) {}  // NOLINT

  double get(std::size_t k) const {
    return numbers_ != nullptr ? numbers_[k] : flags_ != nullptr ? flags_[k] : expected_[k];
  }
  /// @throws StateError where the value is no flag, or not the one expected
  void set(std::size_t k, double value) const;

 private:
  double* numbers_ = nullptr;
  std::uint8_t* flags_ = nullptr;
  const double* expected_ = nullptr;
};

/// Key of a list's entries: nodes, by their number in the whole body; places along the whole interface.
enum class StateKey : std::uint8_t { node, place };

/// All that changes in a stepper between two calls of advance, to be read and written.
struct StateView {
  /// Null: numbers are those of the whole, all nodes are own, none is without cells.
  struct Body {
    const mesh::NodeColumns* columns = nullptr;
    const std::vector<bool>*is_own = nullptr, *is_orphan = nullptr;
  };
  /// Values of some nodes.
  struct List {
    StateKey by = StateKey::node;
    std::size_t body = 0, n = 0;
    const mesh::Node* nodes = nullptr;  ///< [n], keys ascending; null: all
    std::vector<StateArray> arrays;     ///< [n]

    mesh::Node node(std::size_t k) const { return nodes != nullptr ? nodes[k] : static_cast<mesh::Node>(k); }
  };
  std::vector<Body> bodies;
  mesh::Subset interface_nodes;  ///< places along the whole interface
  std::vector<List> lists;
  std::vector<double*> sums;  ///< over nodes, such as works: they add up over the subdomains
  std::vector<bool*> flags;   ///< the same in all subdomains

  std::int64_t key(const List& list, std::size_t k) const;
  bool is_own(const List& list, std::size_t k) const;
};

/// A chunk of a saved state, keyed so that it fits any partition.
struct StateByNode {
  /// Entries of a list with consecutive keys.
  struct Run {
    std::int64_t key = 0;
    std::uint64_t count = 0;
    std::uint32_t list = 0;
    std::uint16_t width = 0;  ///< values of an entry
    std::uint8_t body = 0;
    StateKey by = StateKey::node;
    template <class Archive>
    void serialize(Archive& archive) {
      archive(key, count, list, width, body, by);
    }
  };
  std::int32_t number = 0, n_chunks = 1;  ///< of the chunks of a state
  std::int64_t step = 0;
  std::vector<Run> runs;
  std::vector<double> values;  ///< of the runs, entry by entry
  std::vector<double> sums;    ///< of the subdomain; none in further chunks of one
  std::vector<std::uint8_t> flags;

  bool is_last() const { return number + 1 == n_chunks; }
  /// @throws StateError where runs have other lengths than they say, or values are no numbers
  void require_possible() const;
  /// @throws StateError where it is of other bodies
  void require_of(std::span<const mesh::NodeColumns> bodies) const;
  /// What is in some columns, and places along the interface.
  /// @param bodies    the whole ones
  /// @param has_sums  whether the sums go with it
  /// @pre it is of these bodies
  StateByNode in(const mesh::Subset& columns, const mesh::Subset& interface_nodes,
                 std::span<const mesh::NodeColumns> bodies, bool has_sums) const;

  /// The entry that follows, of the same list as a run. Its values have to be appended.
  void add_entry(const Run& like, std::int64_t key);
  /// Calls f(run, key, values) for each entry.
  template <class F>
  void for_each_entry(F&& f) const {
    const double* from = values.data();
    for (const auto& run : runs)
      for (std::uint64_t i = 0; i < run.count; ++i, from += run.width)
        f(run, run.key + static_cast<std::int64_t>(i), std::span<const double>(from, run.width));
  }

  template <class Archive>
  void serialize(Archive& archive) {
    // The largest last: so the memory of a message is asked for once.
    archive(number, n_chunks, step, runs, sums, flags, values);
  }
};

/// A chunk of the own entries of a state: of each list the same share.
StateByNode keep(const StateView& state, std::int64_t step, int number = 0, int n_chunks = 1);
/// Shows all chunks of a state on one rank, of bounded size. @param n_nodes  of all bodies
void keep_in_chunks(const StateView& state, std::int64_t step, std::int64_t n_nodes,
                    const std::function<void(const StateByNode& chunk)>& take);

/// Restores the chunks of a state in a stepper of all or some columns of the same bodies.
class StateRestorer {
 public:
  explicit StateRestorer(StateView state);
  /// The next chunk. @throws StateError where it is of other bodies
  void add(const StateByNode& chunk);
  /// After the last one. @return the step. @throws StateError where an own entry was in none
  std::int64_t finish();

 private:
  StateView state_;
  std::vector<std::vector<bool>> is_restored_;  ///< [lists][entries]
  std::vector<double> sums_;
  std::int32_t n_added_ = 0, n_chunks_ = 0;
  std::int64_t step_ = 0;
};
/// All of them. @return the step
std::int64_t restore_chunks(StateView state, const std::function<StateByNode()>& next);

}  // namespace slipfront::motion
