// SPDX-License-Identifier: BSD-3-Clause
#include "processes/processes.hpp"

#include "processes/tree.hpp"

namespace slipfront {

OneProcess& one_process() {
  static OneProcess one;
  return one;
}

MessageBuffer Processes::broadcast(MessageBuffer buffer) {
  if (!is_root()) buffer = receive(parent_in_tree(rank()));
  const auto below = children_in_tree(rank(), size());
  // First to the rank with most of them below it.
  for (auto child = below.rbegin(); child != below.rend(); ++child) send(*child, buffer);
  return buffer;
}

std::vector<MessageBuffer> Processes::all_gather(const MessageBuffer& own) {
  // Ranks below one in the tree follow it in their numbers.
  auto all = packed(own);
  for (const int child : children_in_tree(rank(), size())) all.append(receive(child));
  if (!is_root()) send(parent_in_tree(rank()), all);
  all = broadcast(std::move(all));
  std::vector<MessageBuffer> buffers;
  for (int k = 0; k < size(); ++k) buffers.push_back(unpacked<MessageBuffer>(all));
  return buffers;
}

void Processes::gather(MessageBuffer own, const std::function<void(int rank, MessageBuffer& buffer)>& take) {
  if (!is_root()) return send(0, own);
  take(0, own);
  own = {};
  for (int other = 1; other < size(); ++other) {
    auto buffer = receive(other);
    take(other, buffer);
  }
}

MessageBuffer Processes::scatter(const std::function<MessageBuffer(int rank)>& make) {
  if (!is_root()) return receive(0);
  for (int other = 1; other < size(); ++other) send(other, make(other));
  return make(0);
}

MessageBuffer Processes::from_root(const std::function<void(MessageBuffer& to)>& make) {
  auto made = packed(true);
  if (is_root()) {
    try {
      make(made);
    } catch (...) {
      broadcast(packed(false));
      set_awaited(false);
      throw;
    }
  }
  made = broadcast(std::move(made));
  if (!unpacked<bool>(made)) throw FailedElsewhere();
  return made;
}

void Processes::together(const std::function<void()>& work) {
  std::exception_ptr failure;
  std::string reason;
  try {
    work();
  } catch (const std::exception& error) {
    failure = std::current_exception();
    reason = reason_of(error);
  }
  auto reasons = all_gather(packed(failure != nullptr, reason));
  for (int other = 0; other < size(); ++other) {
    auto& of_rank = reasons[static_cast<std::size_t>(other)];
    if (!unpacked<bool>(of_rank)) continue;
    set_awaited(false);
    if (!is_root()) throw FailedElsewhere();
    if (failure != nullptr) std::rethrow_exception(failure);
    throw ProcessError("rank " + std::to_string(other) + ": " + unpacked<std::string>(of_rank));
  }
}

}  // namespace slipfront
