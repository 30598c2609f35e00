// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "base/lanes.hpp"
#include "interface/friction.hpp"
#include "interface/friction/state_law.hpp"

namespace slipfront::interface {

/// A friction law as the update of a node, or of `lanes` of them, takes it. An aggregate of values V.
/// @tparam Coefficient  the law's evaluator for V
template <class Coefficient, class V>
struct LawConstants {
  Coefficient mu;
  V mu_at_rest, mu_k;
  V cohesion_Pa;
  V strengthens;  ///< 1 where mu rises with the slip rate somewhere, else 0
};
/// Constants of a law with a state, which never sticks.
/// @tparam Evolving  the law's evaluator for V
template <class Evolving, class V>
struct StateLawConstants {
  Evolving law;
  V tip_slip_rate_m_per_s;  ///< see ContactModel
};
template <class Law, class V, class Evaluator = typename Law::template Evaluator<V>>
using ConstantsOf =
    std::conditional_t<HasStates<Law>, StateLawConstants<Evaluator, V>, LawConstants<Evaluator, V>>;

/// @param law  `of` as its struct
template <class Law>
ConstantsOf<Law, double> constants_of(const FrictionLaw& of, const Law& law) {
  const auto evaluator = law.evaluator();
  if constexpr (HasStates<Law>)
    return {evaluator, 0};
  else
    return {evaluator, evaluator(0, 0), law.kinetic_coefficient(), of.cohesion_Pa(),
            strengthens(law) ? 1.0 : 0.0};
}
/// The values of an aggregate of them.
template <class V, class Constants>
auto values_of(const Constants& constants) {
  static_assert(sizeof(Constants) % sizeof(V) == 0);
  return std::bit_cast<std::array<V, sizeof(Constants) / sizeof(V)>>(constants);
}
/// The same law in all lanes.
template <class Law>
ConstantsOf<Law, SimdVector> in_lanes(const FrictionLaw& of, const Law& law) {
  const auto values = values_of<double>(constants_of(of, law));
  std::array<SimdVector, values.size()> in_lanes;
  for (std::size_t k = 0; k < values.size(); ++k) in_lanes[k] = SimdVector{} + values[k];
  return std::bit_cast<ConstantsOf<Law, SimdVector>>(in_lanes);
}

/// A friction law per node, all of one type, and their constants as the loop over nodes takes them: those of
/// `lanes` nodes side by side, in blocks.
class NodeLaws {
 public:
  /// None.
  NodeLaws() = default;
  /// @param some_strengthens  whether a node strengthens where there are others than these
  explicit NodeLaws(std::vector<FrictionLaw> laws, bool some_strengthens = false);

  bool empty() const { return laws_.empty(); }
  std::size_t size() const { return laws_.size(); }
  const FrictionLaw& operator[](std::size_t node) const { return laws_[node]; }
  /// Whether the coefficient of any rises with the slip rate.
  bool some_strengthens() const { return some_strengthens_; }

  /// The constants of the nodes from lanes * block on, those of the last node in lanes left over.
  template <class Law>
  ConstantsOf<Law, SimdVector> constants(std::size_t block) const {
    std::array<SimdVector, sizeof(ConstantsOf<Law, double>) / sizeof(double)> values;
    const double* from = constants_.data() + block * values.size() * lanes;
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = load(from + k * lanes);
    return std::bit_cast<ConstantsOf<Law, SimdVector>>(values);
  }

 private:
  std::vector<FrictionLaw> laws_;  ///< [nodes]
  std::vector<double> constants_;  ///< [blocks x constants x lanes]
  bool some_strengthens_ = false;
};

}  // namespace slipfront::interface
