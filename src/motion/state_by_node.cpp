// SPDX-License-Identifier: BSD-3-Clause
#include "motion/state_by_node.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/state.hpp"

namespace slipfront::motion {

namespace {

[[noreturn]] void throw_of_others() {
  throw StateError("the saved state belongs to other bodies (number of nodes differs)");
}

/// Those of all subdomains together.
std::vector<double> total(const std::vector<std::vector<double>>& sums) {
  std::vector<double> all;
  for (const auto& of_subdomain : sums) {
    if (all.empty()) all.assign(of_subdomain.size(), 0.0);
    if (of_subdomain.size() != all.size()) throw_of_others();
    for (std::size_t k = 0; k < all.size(); ++k) all[k] += of_subdomain[k];
  }
  return all;
}

/// Writes lists of what a stepper shows of its state.
class Keeper {
 public:
  Keeper(StateByNode& kept, const SubdomainPlace& place) : kept_(kept), place_(place) {}

  /// @param key_of(k)    see StateByNode::Values, in the stepper's own count
  /// @param column_of(k) in the stepper's own count
  /// @param each(k, f)   calls f with all values of entry k
  template <class Key, class Column, class Each>
  void list(StateByNode::By by, std::size_t body, std::size_t n, Key&& key_of, Column&& column_of,
            Each&& each) {
    StateByNode::Values list{by, static_cast<std::uint8_t>(body), 0, {}, {}};
    list.key.reserve(n);
    for (std::size_t k = 0; k < n; ++k) {
      const int column = column_of(k);
      if (column < place_.own.begin || column >= place_.own.end) continue;
      list.key.push_back(key_of(k));
      each(k, [&](auto& value) { list.value.push_back(static_cast<double>(value)); });
      if (list.key.size() == 1) list.value.reserve(n * list.value.size());
    }
    if (!list.key.empty()) list.width = static_cast<std::uint32_t>(list.value.size() / list.key.size());
    kept_.values.push_back(std::move(list));
  }
  void sum(double& value) { kept_.sums.front().push_back(value); }
  void flag(bool& value) { kept_.flags.push_back(value ? 1 : 0); }
  void trigger(interface::Trigger& value) { kept_.trigger = value; }

 private:
  StateByNode& kept_;
  const SubdomainPlace& place_;
};

/// Reads them.
class Restorer {
 public:
  Restorer(const StateByNode& kept, const SubdomainPlace& place)
      : kept_(kept), sums_(total(kept.sums)), place_(place) {}

  template <class Key, class Column, class Each>
  void list(StateByNode::By by, std::size_t body, std::size_t n, Key&& key_of, Column&& column_of,
            Each&& each) {
    if (next_list_ == kept_.values.size()) throw_of_others();
    const auto& list = kept_.values[next_list_++];
    if (list.by != by || list.body != body || list.value.size() != list.key.size() * list.width)
      throw_of_others();
    auto near = list.key.begin();
    for (std::size_t k = 0; k < n; ++k) {
      const auto key = key_of(k);
      // Most entries follow each other.
      if (near == list.key.end() || *near != key) near = std::ranges::lower_bound(list.key, key);
      if (near == list.key.end() || *near != key) {
        // At a subdomain's edge nodes have block rows that have none in the whole.
        const int column = column_of(k);
        if (column >= place_.own.begin && column < place_.own.end) throw_of_others();
        continue;
      }
      auto from = list.value.begin() + (near - list.key.begin()) * static_cast<std::ptrdiff_t>(list.width);
      const auto end = from + static_cast<std::ptrdiff_t>(list.width);
      each(k, [&]<class T>(T& value) {
        if (from == end) throw_of_others();
        value = static_cast<T>(*from++);
      });
      if (from != end) throw_of_others();
      ++near;
    }
  }
  void sum(double& value) {
    if (next_sum_ == sums_.size()) throw_of_others();
    value = sums_[next_sum_++];
  }
  void flag(bool& value) {
    if (next_flag_ == kept_.flags.size()) throw_of_others();
    value = kept_.flags[next_flag_++] != 0;
  }
  void trigger(interface::Trigger& value) { value = kept_.trigger; }
  void require_end() const {
    if (next_list_ != kept_.values.size() || next_sum_ != sums_.size() || next_flag_ != kept_.flags.size())
      throw_of_others();
  }

 private:
  const StateByNode& kept_;
  std::vector<double> sums_;
  const SubdomainPlace& place_;
  std::size_t next_list_ = 0, next_sum_ = 0, next_flag_ = 0;
};

}  // namespace

void StateByNode::require_consistent() const {
  for (const auto& list : values)
    if (list.value.size() != list.key.size() * list.width) throw_of_others();
}

void StateByNode::add(StateByNode subdomain, int n_subdomains) {
  if (values.empty()) {
    *this = std::move(subdomain);
    // Subdomains are nearly equal: no list is copied to make room.
    const auto make_room = [&](auto& list) { list.reserve((list.size() + 1) * (n_subdomains + 1)); };
    for (auto& list : values) {
      make_room(list.key);
      make_room(list.value);
    }
    return;
  }
  if (subdomain.values.size() != values.size()) throw_of_others();
  for (std::size_t l = 0; l < values.size(); ++l) {
    auto& to = values[l];
    const auto& from = subdomain.values[l];
    to.width = std::max(to.width, from.width);
    to.key.insert(to.key.end(), from.key.begin(), from.key.end());
    to.value.insert(to.value.end(), from.value.begin(), from.value.end());
  }
  sums.insert(sums.end(), subdomain.sums.begin(), subdomain.sums.end());
}

void StateByNode::sort() {
  for (auto& list : values) {
    std::vector<std::size_t> order(list.key.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t k) { return list.key[k]; });
    Values sorted{list.by, list.body, list.width, {}, {}};
    sorted.key.reserve(list.key.size());
    sorted.value.reserve(list.value.size());
    for (const auto k : order) {
      sorted.key.push_back(list.key[k]);
      const auto from = list.value.begin() + static_cast<std::ptrdiff_t>(k * list.width);
      sorted.value.insert(sorted.value.end(), from, from + static_cast<std::ptrdiff_t>(list.width));
    }
    list = std::move(sorted);
  }
}

StateByNode StateByNode::in(const mesh::Subset& columns, const mesh::Subset& interface_nodes,
                            std::span<const mesh::NodeColumns> bodies, bool has_sums) const {
  auto its_sums = total(sums);
  if (!has_sums) std::ranges::fill(its_sums, 0.0);
  StateByNode of_subdomain{step, {}, {std::move(its_sums)}, flags, trigger};
  for (const auto& list : values) {
    if (list.body >= bodies.size()) throw_of_others();
    const auto& body = bodies[list.body];
    const auto& subset = list.by == By::place ? interface_nodes : columns;
    const auto number_of = [&](std::int64_t key) {
      if (list.by == By::place) return static_cast<int>(key);
      return list.by == By::node ? body.global_column_of(key) : static_cast<int>(key % body.n_columns());
    };
    Values some{list.by, list.body, list.width, {}, {}};
    for (std::size_t k = 0; k < list.key.size(); ++k) {
      if (!subset.has(number_of(list.key[k]))) continue;
      some.key.push_back(list.key[k]);
      const auto from = list.value.begin() + static_cast<std::ptrdiff_t>(k * list.width);
      some.value.insert(some.value.end(), from, from + static_cast<std::ptrdiff_t>(list.width));
    }
    of_subdomain.values.push_back(std::move(some));
  }
  return of_subdomain;
}

void StateByNode::put(MessageBuffer& to) const {
  std::size_t bytes = 4096 + 1024 * sums.size();  // more than what is not in the lists
  for (const auto& list : values) bytes += 64 + (list.key.size() + list.value.size()) * sizeof(double);
  to.reserve(bytes);
  to.put(step).put(static_cast<std::uint64_t>(values.size()));
  for (const auto& list : values)
    to.put(list.by).put(list.body).put(list.width).put(list.key).put(list.value);
  to.put(static_cast<std::uint64_t>(sums.size()));
  for (const auto& of_subdomain : sums) to.put(of_subdomain);
  to.put(flags).put(trigger);
}

StateByNode StateByNode::take(MessageBuffer& from) {
  StateByNode kept;
  kept.step = from.take<std::int64_t>();
  kept.values.resize(from.take<std::uint64_t>());
  for (auto& list : kept.values) {
    list.by = from.take<By>();
    list.body = from.take<std::uint8_t>();
    list.width = from.take<std::uint32_t>();
    list.key = from.take_all<std::int64_t>();
    list.value = from.take_all<double>();
  }
  kept.sums.resize(from.take<std::uint64_t>());
  for (auto& of_subdomain : kept.sums) of_subdomain = from.take_all<double>();
  kept.flags = from.take_all<std::uint8_t>();
  kept.trigger = from.take<interface::Trigger>();
  return kept;
}

StateByNode keep(Stepper& stepper, const SubdomainPlace& place) {
  StateByNode kept;
  kept.step = stepper.step();
  kept.sums.resize(1);
  Keeper keeper(kept, place);
  stepper.visit_state(keeper, place);
  return kept;
}

void restore(const StateByNode& kept, Stepper& stepper, const SubdomainPlace& place) {
  Restorer restorer(kept, place);
  stepper.visit_state(restorer, place);
  restorer.require_end();
  stepper.update_after_restore(kept.step);
}

}  // namespace slipfront::motion
