// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

/// What a friction law knows of the slip so far.
enum class SlipMemory {
  none,         ///< nothing: the coefficient depends on the slip rate alone
  lasting,      ///< the whole slip path
  until_stick,  ///< the slip path since the node last stuck
};

}  // namespace slipfront::interface
