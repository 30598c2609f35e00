// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "interface/friction.hpp"
#include "interface/friction/coulomb.hpp"
#include "interface/friction/exponential_slip_weakening.hpp"
#include "interface/friction/rate_and_state.hpp"
#include "interface/friction/rate_and_state_two.hpp"
#include "interface/friction/slip_weakening.hpp"
#include "interface/friction/table.hpp"
#include "interface/friction/velocity_weakening.hpp"

namespace slipfront::interface {

template <class... Laws>
struct LawList {};

/// All friction laws the case file can name; a new law is one more type in this list. The first is the
/// default.
using Registry = LawList<SlipWeakening, SlipWeakeningHealing, ExponentialSlipWeakening, VelocityWeakening,
                         Coulomb, SlipTable, SlipRateTable, RateAndStateAging, RateAndStateSlip,
                         RateAndStateStrong, RateAndStateAgingTwo>;
using FirstLaw = decltype([]<class First, class... Others>(LawList<First, Others...>) {
  return First{};
}(Registry{}));

/// f(law), with the law's struct.
template <class F, class First, class... Others>
auto visit(const FrictionLaw& law, LawList<First, Others...> /*any of these*/, F&& f) {
  if constexpr (sizeof...(Others) > 0)
    if (law.name() != First::name) return visit(law, LawList<Others...>{}, f);
  return f(law.as<First>());
}
template <class F>
auto visit(const FrictionLaw& law, F&& f) {
  return visit(law, Registry{}, f);
}

}  // namespace slipfront::interface
