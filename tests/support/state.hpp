// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "processes/processes.hpp"

namespace slipfront::test {

/// The state of something that has `archive`.
template <class T>
MessageBuffer state_of(T& from) {
  MessageBuffer state;
  MessageArchive archive(state);
  from.archive(archive);
  return state;
}

/// Reads such a state.
template <class T>
void restore(MessageBuffer state, T& to) {
  auto archive = MessageArchive::reader(state);
  to.archive(archive);
}

/// The same for another one of its kind.
template <class T>
void copy_state(T& from, T& to) {
  restore(state_of(from), to);
}

}  // namespace slipfront::test
