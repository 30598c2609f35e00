// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "base/message.hpp"

namespace slipfront::interface {

/// A friction law's parameter as the case file sees it; the schema, its checks and its help come from here.
template <class Law>
struct Parameter {
  const char* key;  ///< in the table [friction], with its unit
  double Law::*member;
  double min;  ///< smallest value allowed
  double max;  ///< largest value allowed
  const char* help;
};

/// A parameter that is a list of numbers.
template <class Law>
struct ListParameter {
  const char* key;
  std::span<const double> Law::*member;
  double min;
  double max;
  const char* help;
};

/// A state variable of a law: a number at each node, remembered from one contact update to the next.
struct LawState {
  const char* name;  ///< in results; it ends with the unit
  const char* unit;
  const char* description;
};

template <class Law>
concept HasStates = requires {
  Law::states;
};

/// Whether mu rises with the slip rate somewhere; a law that can do so has this as a member.
template <class Law>
bool strengthens(const Law& law) {
  if constexpr (requires { law.strengthens(); }) return law.strengthens();
  return false;
}

/// What a friction law knows of the slip so far.
enum class SlipMemory {
  none,         ///< nothing: the coefficient depends on the slip rate alone
  lasting,      ///< the whole slip path
  until_stick,  ///< the slip path since the node last stuck
};

}  // namespace slipfront::interface
