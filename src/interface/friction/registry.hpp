// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <variant>

#include "interface/friction/coulomb.hpp"
#include "interface/friction/velocity_weakening.hpp"

namespace slipfront::interface {

/// All friction laws the case file can name; a new law is one more type in this list.
using FrictionLaw = std::variant<VelocityWeakening, Coulomb>;

inline double static_coefficient(const FrictionLaw& law) {
  return std::visit([](const auto& l) { return l.static_coefficient(); }, law);
}

/// Its key in the case file: every law names its coefficient at rest first.
inline std::string static_coefficient_key(const FrictionLaw& law) {
  return std::visit([](const auto& l) { return std::string("friction.") + l.parameters()[0].key; }, law);
}

}  // namespace slipfront::interface
