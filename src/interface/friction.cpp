// SPDX-License-Identifier: BSD-3-Clause
#include "interface/friction.hpp"

#include <algorithm>
#include <utility>

#include "base/numbers.hpp"
#include "interface/friction/registry.hpp"

namespace slipfront::interface {
namespace {

template <class Law>
LawDescription describe_law() {
  LawDescription description{Law::name, Law::help, Law{}, {}, {}};
  for (const auto& p : Law::parameters()) description.parameters.push_back({p.key, p.min, p.max, p.help});
  if constexpr (!HasStates<Law>)
    description.parameters.push_back(
        {FrictionLaw::cohesion_key, 0, 1e15,
         "strength in contact besides mu p, before and after slip; with loading.method = prestress"});
  if constexpr (requires { Law::lists(); })
    for (const auto& list : Law::lists())
      description.lists.push_back({list.key, list.min, list.max, list.help});
  return description;
}

template <class... Laws>
std::vector<LawDescription> describe_laws(LawList<Laws...>) {
  return {describe_law<Laws>()...};
}

std::size_t place_of(std::string_view key, const std::vector<LawDescription::Key>& keys) {
  const auto found = std::ranges::find(keys, key, &LawDescription::Key::key);
  SLIPFRONT_ASSERT(found != keys.end(), "a parameter of another friction law");
  return static_cast<std::size_t>(found - keys.begin());
}

}  // namespace

FrictionLaw::FrictionLaw() : FrictionLaw(FirstLaw{}) {}

bool FrictionLaw::has_parameter(std::string_view key) const {
  return std::ranges::find(description_of(*this).parameters, key, &LawDescription::Key::key) !=
         description_of(*this).parameters.end();
}

double& FrictionLaw::parameter(std::string_view key) {
  if (key == cohesion_key && !never_sticks()) return cohesion_Pa_;
  return values_[place_of(key, description_of(*this).parameters)];
}

double FrictionLaw::parameter(std::string_view key) const {
  if (key == cohesion_key && !never_sticks()) return cohesion_Pa_;
  return values_[place_of(key, description_of(*this).parameters)];
}

const std::vector<double>& FrictionLaw::list(std::string_view key) const {
  return (*lists_)[place_of(key, description_of(*this).lists)];
}

void FrictionLaw::set_list(std::string_view key, std::vector<double> numbers) {
  Lists lists = *lists_;
  lists[place_of(key, description_of(*this).lists)] = std::move(numbers);
  lists_ = std::make_shared<const Lists>(std::move(lists));
}

const std::vector<LawDescription>& law_descriptions() {
  static const std::vector<LawDescription> all = describe_laws(Registry{});
  return all;
}

const LawDescription& description_of(const FrictionLaw& law) {
  return *std::ranges::find(law_descriptions(), law.name(), &LawDescription::name);
}

double static_coefficient(const FrictionLaw& law) {
  return visit(law, []<class Law>(const Law& l) {
    if constexpr (HasStates<Law>)
      return steady_coefficient(l, l.V_i_m_per_s);
    else
      return l.static_coefficient();
  });
}

bool has_static_coefficient(const FrictionLaw& law) {
  return description_of(law).parameters.front().key == std::string_view("mu_s");
}

double static_strength_Pa(const FrictionLaw& law, double p_Pa) {
  return static_coefficient(law) * p_Pa + law.cohesion_Pa();
}

double kinetic_coefficient(const FrictionLaw& law) {
  return visit(law, []<class Law>(const Law& l) {
    if constexpr (HasStates<Law>)
      return steady_coefficient(l, std::max(1.0, l.V_i_m_per_s));
    else
      return l.kinetic_coefficient();
  });
}

double friction_coefficient(const FrictionLaw& law, double speed_m_per_s, double slip_m) {
  return visit(law, [&]<class Law>(const Law& l) {
    if constexpr (HasStates<Law>)
      return steady_coefficient(l, std::max(speed_m_per_s, l.V_i_m_per_s));
    else
      return l.evaluator()(speed_m_per_s, slip_m);
  });
}

double friction_slope_s_per_m(const FrictionLaw& law, double speed_m_per_s, double slip_m) {
  return visit(law, [&]<class Law>(const Law& l) {
    if constexpr (HasStates<Law>)
      return steady_slope_s_per_m(l, std::max(speed_m_per_s, l.V_i_m_per_s));
    else
      return l.evaluator().slope_s_per_m(speed_m_per_s, slip_m);
  });
}

bool strengthens(const FrictionLaw& law) {
  return visit(law, [](const auto& l) { return strengthens(l); });
}

std::optional<StateResponse> state_response(const FrictionLaw& law, double speed_m_per_s) {
  return visit(law, [&]<class Law>(const Law& l) -> std::optional<StateResponse> {
    if constexpr (!HasStates<Law>)
      return {};
    else {
      const double V = std::max(speed_m_per_s, l.V_i_m_per_s);
      const double a = direct_effect(l.evaluator(), V, steady_states(l, V));
      return StateResponse{a, a - V * steady_slope_s_per_m(l, V), following_slip_m(l, V), V,
                           breakdown_per_m(l)};
    }
  });
}

double direct_effect(const FrictionLaw& law) {
  return visit(law, []<class Law>(const Law& l) {
    if constexpr (HasStates<Law>)
      return direct_effect(l.evaluator(), l.V_i_m_per_s, steady_states(l, l.V_i_m_per_s));
    return nan;
  });
}

std::optional<StateBreakdown> state_breakdown(const FrictionLaw& law, double t_Pa, double p_Pa,
                                              double speed_m_per_s) {
  return visit(law, [&]<class Law>(const Law& l) -> std::optional<StateBreakdown> {
    if constexpr (!HasStates<Law>)
      return {};
    else {
      const auto evaluator = l.evaluator();
      const auto strength = [&](const auto& states) {
        if constexpr (IsArsinh<decltype(evaluator)>)
          return sum_of(states);  // from which mu differs by the same at all times
        else
          return evaluator.coefficient(speed_m_per_s, states);
      };
      auto states = l.initial(t_Pa, p_Pa);
      const double steady = strength(steady_states(l, speed_m_per_s)), first = strength(states);
      constexpr double part_of_d_c = 0.01, rest = 1e-4;
      constexpr int most_steps = 1'000'000;
      const double slip_m = part_of_d_c * following_slip_m(l, l.V_i_m_per_s);
      double now = first, energy_m = 0;
      for (int k = 0; k < most_steps && now - steady > rest * (first - steady); ++k) {
        states = evaluator.evolved(states, speed_m_per_s, slip_m / speed_m_per_s);
        const double next = strength(states);
        energy_m += (0.5 * (now + next) - steady) * slip_m;
        now = next;
      }
      return StateBreakdown{energy_m, steady_coefficient(l, speed_m_per_s)};
    }
  });
}

double traction_before_Pa(const FrictionLaw& law, double p_Pa) {
  return visit(law, [&]<class Law>(const Law& l) {
    if constexpr (requires { l.traction_before_Pa(p_Pa); })
      return l.traction_before_Pa(p_Pa);
    else if constexpr (HasStates<Law>)
      return steady_coefficient(l, l.V_i_m_per_s) * p_Pa;
    else
      return nan;
  });
}

void set_initial_slip_rate(FrictionLaw& law, double t_Pa, double p_Pa) {
  visit(law, [&]<class Law>(const Law& l) {
    if constexpr (requires { l.theta_i_s; })
      if (l.theta_i_s > 0) law.parameter("V_i_m_per_s") = l.slip_rate_before_m_per_s(t_Pa, p_Pa);
  });
}

std::optional<double> weakening_slip_m(const FrictionLaw& law) {
  return visit(law, [](const auto& l) -> std::optional<double> {
    if constexpr (requires { l.weakening_slip_m(); }) return l.weakening_slip_m();
    return {};
  });
}

Message inconsistency(const FrictionLaw& law) {
  return visit(law, [](const auto& l) { return l.inconsistency(); });
}

std::string static_coefficient_key(const FrictionLaw& law) {
  return std::string("friction.") + description_of(law).parameters.front().key;
}

}  // namespace slipfront::interface
