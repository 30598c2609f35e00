// SPDX-License-Identifier: BSD-3-Clause
#include "interface/node_laws.hpp"

#include <algorithm>
#include <utility>

#include "base/error.hpp"
#include "interface/friction/registry.hpp"

namespace slipfront::interface {
namespace {

/// An evaluator is an aggregate of its constants.
template <class Law>
std::vector<double> constants_of(const Law& law) {
  const auto evaluator = law.evaluator();
  static_assert(sizeof(evaluator) % sizeof(double) == 0);
  const auto folded = std::bit_cast<std::array<double, sizeof(evaluator) / sizeof(double)>>(evaluator);
  std::vector<double> constants(folded.begin(), folded.end());
  constants.push_back(evaluator(0, 0));
  constants.push_back(law.kinetic_coefficient());
  return constants;
}

std::vector<double> constants_of(const FrictionLaw& law) {
  return visit(law, [](const auto& l) { return constants_of(l); });
}

}  // namespace

NodeLaws::NodeLaws(std::vector<FrictionLaw> laws) : laws_(std::move(laws)) {
  const std::size_t n_blocks = (laws_.size() + lanes - 1) / lanes;
  for (std::size_t node = 0; node < n_blocks * lanes; ++node) {
    const FrictionLaw& law = laws_[std::min(node, laws_.size() - 1)];
    SLIPFRONT_ASSERT(law.name() == laws_.front().name(), "laws of one type along the interface");
    const auto values = constants_of(law);
    constants_.resize(n_blocks * values.size() * lanes);
    double* to = constants_.data() + node / lanes * values.size() * lanes + node % lanes;
    for (std::size_t k = 0; k < values.size(); ++k) to[k * lanes] = values[k];
  }
}

}  // namespace slipfront::interface
