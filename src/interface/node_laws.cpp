// SPDX-License-Identifier: BSD-3-Clause
#include "interface/node_laws.hpp"

#include <algorithm>
#include <utility>

#include "base/error.hpp"
#include "interface/friction/registry.hpp"

namespace slipfront::interface {
NodeLaws::NodeLaws(std::vector<FrictionLaw> laws, bool some_strengthens)
    : laws_(std::move(laws)), some_strengthens_(some_strengthens) {
  const std::size_t n_blocks = (laws_.size() + lanes - 1) / lanes;
  for (std::size_t node = 0; node < n_blocks * lanes; ++node) {
    const FrictionLaw& law = laws_[std::min(node, laws_.size() - 1)];
    SLIPFRONT_ASSERT(law.name() == laws_.front().name(), "laws of one type along the interface");
    const auto values = visit(law, [&](const auto& l) {
      some_strengthens_ = some_strengthens_ || strengthens(l);
      const auto folded = values_of<double>(constants_of(law, l));
      return std::vector<double>(folded.begin(), folded.end());
    });
    constants_.resize(n_blocks * values.size() * lanes);
    double* to = constants_.data() + node / lanes * values.size() * lanes + node % lanes;
    for (std::size_t k = 0; k < values.size(); ++k) to[k * lanes] = values[k];
  }
}

}  // namespace slipfront::interface
