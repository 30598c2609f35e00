// SPDX-License-Identifier: BSD-3-Clause
#include "motion/state_by_node.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/error.hpp"
#include "base/state.hpp"

namespace slipfront::motion {

namespace {

/// Most nodes of a chunk on one rank.
constexpr std::int64_t nodes_of_state_chunk = 1 << 19;

void require_of_these(bool is_of_these) {
  if (!is_of_these) throw StateError("the saved state belongs to other bodies (number of nodes differs)");
}

/// The entry with a key, n where there is none. @param near  tried first
std::size_t find(const StateView& state, const StateView::List& list, std::int64_t key, std::size_t near) {
  if (near < list.n && state.key(list, near) == key) return near;
  std::size_t begin = 0, end = list.n;
  while (begin < end) {
    const auto middle = begin + (end - begin) / 2;
    if (state.key(list, middle) < key)
      begin = middle + 1;
    else
      end = middle;
  }
  return begin < list.n && state.key(list, begin) == key ? begin : list.n;
}

}  // namespace

void StateArray::set(std::size_t k, double value) const {
  if (expected_ != nullptr) {
    slipfront::require_possible(value == expected_[k], "loads");
  } else if (flags_ != nullptr) {
    slipfront::require_possible(value == 0 || value == 1, "numbers");
    flags_[k] = value != 0;
  } else {
    numbers_[k] = value;
  }
}

std::int64_t StateView::key(const List& list, std::size_t k) const {
  if (list.by == StateKey::place) return interface_nodes.number_at(static_cast<int>(k));
  const auto* columns = bodies[list.body].columns;
  return columns != nullptr ? columns->global_number(list.node(k)) : list.node(k);
}

bool StateView::is_own(const List& list, std::size_t k) const {
  const auto* is_own = bodies[list.body].is_own;
  return is_own == nullptr || is_own->empty() || (*is_own)[list.node(k)];
}

void StateByNode::require_possible() const {
  require_of_these(number >= 0 && number < n_chunks);
  auto left = values.size();
  for (const auto& run : runs) {
    require_of_these(run.width > 0 && run.count <= left / run.width && run.key >= 0 &&
                     run.key <= std::numeric_limits<std::int64_t>::max() / 2);
    left -= run.count * run.width;
  }
  require_of_these(left == 0);
  slipfront::require_possible(std::ranges::all_of(values, is_possible<double>) &&
                                  std::ranges::all_of(sums, is_possible<double>) &&
                                  std::ranges::all_of(flags, is_possible<std::uint8_t>),
                              "numbers");
}

void StateByNode::require_of(std::span<const mesh::NodeColumns> bodies) const {
  for (const auto& run : runs)
    require_of_these(run.body < bodies.size() &&
                     run.key + static_cast<std::int64_t>(run.count) <= bodies[run.body].n_nodes());
}

StateByNode StateByNode::in(const mesh::Subset& columns, const mesh::Subset& interface_nodes,
                            std::span<const mesh::NodeColumns> bodies, bool has_sums) const {
  StateByNode some{number, n_chunks, step, {}, {}, has_sums ? sums : std::vector<double>(), flags};
  for_each_entry([&](const Run& run, std::int64_t key, std::span<const double> of_entry) {
    if (run.by == StateKey::place ? !interface_nodes.has(static_cast<int>(key))
                                  : !columns.has(bodies[run.body].global_column_of(key)))
      return;
    some.add_entry(run, key);
    some.values.insert(some.values.end(), of_entry.begin(), of_entry.end());
  });
  return some;
}

void StateByNode::add_entry(const Run& like, std::int64_t key) {
  if (!runs.empty() && runs.back().list == like.list &&
      runs.back().key + static_cast<std::int64_t>(runs.back().count) == key) {
    ++runs.back().count;
    return;
  }
  runs.push_back(like);
  runs.back().key = key;
  runs.back().count = 1;
}

StateByNode keep(const StateView& state, std::int64_t step, int number, int n_chunks) {
  StateByNode chunk{number, n_chunks, step, {}, {}, {}, {}};
  const auto begin = [&](const StateView::List& list, int of) {
    return list.n * static_cast<std::size_t>(of) / static_cast<std::size_t>(n_chunks);
  };
  std::size_t n_values = 0;
  for (const auto& list : state.lists)
    n_values += (begin(list, number + 1) - begin(list, number)) * list.arrays.size();
  chunk.values.reserve(n_values);
  for (std::size_t l = 0; l < state.lists.size(); ++l) {
    const auto& list = state.lists[l];
    const StateByNode::Run run{.list = static_cast<std::uint32_t>(l),
                               .width = static_cast<std::uint16_t>(list.arrays.size()),
                               .body = static_cast<std::uint8_t>(list.body),
                               .by = list.by};
    for (auto k = begin(list, number); k < begin(list, number + 1); ++k) {
      if (!state.is_own(list, k)) continue;
      chunk.add_entry(run, state.key(list, k));
      for (const auto& array : list.arrays) chunk.values.push_back(array.get(k));
    }
  }
  if (number == 0)
    for (const auto* sum : state.sums) chunk.sums.push_back(*sum);
  for (const auto* flag : state.flags) chunk.flags.push_back(*flag ? 1 : 0);
  return chunk;
}

void keep_in_chunks(const StateView& state, std::int64_t step, std::int64_t n_nodes,
                    const std::function<void(const StateByNode& chunk)>& take) {
  const auto n_chunks = static_cast<int>(1 + n_nodes / nodes_of_state_chunk);
  for (int number = 0; number < n_chunks; ++number) take(keep(state, step, number, n_chunks));
}

StateRestorer::StateRestorer(StateView state) : state_(std::move(state)) {
  for (const auto& list : state_.lists) {
    is_restored_.emplace_back(list.n);
    for (std::size_t k = 1; k < list.n; ++k)
      SLIPFRONT_ASSERT(state_.key(list, k - 1) < state_.key(list, k), "keys ascend");
  }
}

void StateRestorer::add(const StateByNode& chunk) {
  if (n_added_ == 0) {
    n_chunks_ = chunk.n_chunks;
    step_ = chunk.step;
  }
  require_of_these(chunk.number == n_added_++ && chunk.n_chunks == n_chunks_ && chunk.step == step_ &&
                   chunk.flags.size() == state_.flags.size() &&
                   (chunk.sums.empty() || chunk.sums.size() == state_.sums.size()));
  std::size_t near = 0;
  chunk.for_each_entry([&](const StateByNode::Run& run, std::int64_t key, std::span<const double> values) {
    require_of_these(run.list < state_.lists.size());
    const auto& list = state_.lists[run.list];
    require_of_these(run.by == list.by && run.body == list.body && run.width == list.arrays.size());
    const auto k = find(state_, list, key, near);
    // At a subdomain's edge nodes of the whole may have rows of another kind.
    const auto* is_own = state_.bodies[list.body].is_own;
    require_of_these(k < list.n || (is_own != nullptr && !is_own->empty()));
    if (k == list.n) return;
    for (std::size_t a = 0; a < values.size(); ++a) list.arrays[a].set(k, values[a]);
    is_restored_[run.list][k] = true;
    near = k + 1;
  });
  if (sums_.empty()) {
    sums_ = chunk.sums;
  } else {
    for (std::size_t k = 0; k < chunk.sums.size(); ++k) sums_[k] += chunk.sums[k];
  }
  for (std::size_t k = 0; k < chunk.flags.size(); ++k) *state_.flags[k] = chunk.flags[k] != 0;
}

std::int64_t StateRestorer::finish() {
  for (std::size_t l = 0; l < state_.lists.size(); ++l) {
    const auto& list = state_.lists[l];
    const auto* is_orphan = state_.bodies[list.body].is_orphan;
    for (std::size_t k = 0; k < list.n; ++k)
      require_of_these(is_restored_[l][k] || !state_.is_own(list, k) ||
                       (is_orphan != nullptr && (*is_orphan)[list.node(k)]));
  }
  sums_.resize(state_.sums.size(), 0.0);
  for (std::size_t k = 0; k < sums_.size(); ++k) *state_.sums[k] = sums_[k];
  return step_;
}

std::int64_t restore_chunks(StateView state, const std::function<StateByNode()>& next) {
  StateRestorer restorer(std::move(state));
  for (bool is_last = false; !is_last;) {
    const auto chunk = next();
    restorer.add(chunk);
    is_last = chunk.is_last();
  }
  return restorer.finish();
}

}  // namespace slipfront::motion
