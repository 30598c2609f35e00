// SPDX-License-Identifier: BSD-3-Clause
#include "interface/quasi_dynamic.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "interface/answers.hpp"
#include "interface/balance.hpp"
#include "interface/friction/registry.hpp"

namespace slipfront::interface {
namespace {

template <class V, std::size_t n>
std::array<V, n> states_at(const LawStates& states, std::size_t node) {
  std::array<V, n> of_node;
  for (std::size_t k = 0; k < n; ++k) of_node[k] = states[k][node];
  return of_node;
}

template <class Evaluator, std::size_t n>
concept HasRates = requires(const Evaluator& law, const std::array<double, n>& states) {
  law.rates_per_s(states, 1.0);
};

/// d states/dt at a slip rate.
template <class Evaluator, std::size_t n>
std::array<double, n> rates_per_s(const Evaluator& law, const std::array<double, n>& states, double V,
                                  double short_s) {
  if constexpr (HasRates<Evaluator, n>) {
    return law.rates_per_s(states, V);
  } else {
    auto rates = law.evolved(states, V, short_s);
    for (std::size_t k = 0; k < n; ++k) rates[k] = (rates[k] - states[k]) / short_s;
    return rates;
  }
}

/// The slip rate >= 0 under a traction t > 0 and p > 0. @param before  what it may be near to, or 0
template <class Evaluator, std::size_t n>
double slip_rate_m_per_s(const Evaluator& law, const std::array<double, n>& states, double t_Pa, double p_Pa,
                         double radiation_damping, double before) {
  if constexpr (IsArsinh<Evaluator>) {
    const double per_a_p = law.per_a / p_Pa, V0 = law.V0_m_per_s;
    const double s = std::max(sum_of(states) * law.per_a, least_state);
    const double y = root_of_traction(t_Pa * per_a_p, radiation_damping * V0 * per_a_p, s,
                                      std::log(t_Pa / (radiation_damping * V0)));
    return V0 * std::exp(y - s) * -std::expm1(-2 * y);
  } else {
    const double most = t_Pa / radiation_damping;
    const auto mu = [&](double speed) { return law.coefficient(speed, states); };
    const double guess = before > 0 ? std::log(most / before) : 0;
    return most * std::exp(-log_slowing(mu, most, p_Pa / t_Pa, guess));
  }
}

}  // namespace

/// The law of all nodes.
struct QuasiDynamicFriction::Nodes {
  Nodes() = default;
  Nodes(const Nodes&) = delete;
  Nodes& operator=(const Nodes&) = delete;
  virtual ~Nodes() = default;
  virtual bool takes_differences() const = 0;
  virtual void balance(double radiation_damping, std::span<const double> t_Pa, std::span<const double> p_Pa,
                       const LawStates& states, double short_s, std::span<double> slip_rate_m_per_s,
                       LawStates& states_per_s) const = 0;
};

template <class Law>
struct QuasiDynamicFriction::NodesOf final : Nodes {
  using Evaluator = typename Law::template Evaluator<double>;
  std::vector<Evaluator> laws;

  bool takes_differences() const override { return !HasRates<Evaluator, n_states_of<Law>>; }

  void balance(double radiation_damping, std::span<const double> t_Pa, std::span<const double> p_Pa,
               const LawStates& states, double short_s, std::span<double> slip_rate,
               LawStates& states_per_s) const override {
    for (std::size_t i = 0; i < laws.size(); ++i) {
      const auto of_node = states_at<double, n_states_of<Law>>(states, i);
      double V = 0;
      if (const double size_Pa = std::abs(t_Pa[i]); p_Pa[i] > 0 && size_Pa > 0)
        V = slip_rate_m_per_s(laws[i], of_node, size_Pa, p_Pa[i], radiation_damping, std::abs(slip_rate[i]));
      slip_rate[i] = std::copysign(V, t_Pa[i]);
      const auto rates = rates_per_s(laws[i], of_node, V, short_s);
      for (std::size_t k = 0; k < rates.size(); ++k) states_per_s[k][i] = rates[k];
    }
  }
};

struct QuasiDynamicFriction::NodesOfFunction final : Nodes {
  std::shared_ptr<const StateArrayLaw> law;

  bool takes_differences() const override { return true; }

  void balance(double radiation_damping, std::span<const double> t_Pa, std::span<const double> p_Pa,
               const LawStates& states, double short_s, std::span<double> slip_rate,
               LawStates& states_per_s) const override {
    const std::size_t n = t_Pa.size();
    std::vector<double> speed_m_per_s(n);
    Answers answers(n);
    const auto attempt = [&] {
      for (std::size_t i = 0; i < n; ++i)
        if (const double size_Pa = std::abs(t_Pa[i]); p_Pa[i] > 0 && size_Pa > 0)
          speed_m_per_s[i] =
              slip_rate_m_per_s(Answers::Evaluator<double>{&answers, i}, std::array<double, 0>{}, size_Pa,
                                p_Pa[i], radiation_damping, std::abs(slip_rate[i]));
    };
    answers.complete(attempt,
                     [&](auto speed, auto /*slip_m*/, auto mu) { coefficients(*law, speed, states, mu); });
    for (std::size_t i = 0; i < n; ++i) slip_rate[i] = std::copysign(speed_m_per_s[i], t_Pa[i]);
    states_per_s = states;
    law->evolve(speed_m_per_s, short_s, states_per_s);
    for (std::size_t k = 0; k < states.size(); ++k)
      for (std::size_t i = 0; i < n; ++i) states_per_s[k][i] = (states_per_s[k][i] - states[k][i]) / short_s;
  }
  /// |d mu/d state| of each state at given slip rates.
  LawStates effects(std::span<const double> speed_m_per_s, const LawStates& states) const {
    std::vector<double> mu(speed_m_per_s.size()), further(speed_m_per_s.size());
    law->coefficient(speed_m_per_s, states, mu);
    LawStates all;
    for (std::size_t k = 0; k < states.size(); ++k) {
      auto other = states;
      for (double& value : other[k]) value += small_change(value);
      law->coefficient(speed_m_per_s, other, further);
      auto& of_state = all.emplace_back();
      for (std::size_t i = 0; i < mu.size(); ++i)
        of_state.push_back(std::abs(further[i] - mu[i]) / small_change(states[k][i]));
    }
    return all;
  }
};

QuasiDynamicFriction::QuasiDynamicFriction(const ContactModel& model, std::size_t n_nodes,
                                           double radiation_damping_Pa_s_per_m)
    : radiation_damping_(radiation_damping_Pa_s_per_m),
      initial_states_(model.law.states().size(), std::vector<double>(n_nodes)),
      state_scales_(initial_states_) {
  SLIPFRONT_ASSERT(model.law.has_states(), "a law without a state has no slip rate at rest");
  const std::vector<double> none(n_nodes);
  set_initial_states(model, none, none, initial_states_);
  std::vector<double> V_i;
  visit(model.law, [&]<class Law>(const Law&) {
    if constexpr (HasStates<Law>) {
      auto nodes = std::make_shared<NodesOf<Law>>();
      for (std::size_t i = 0; i < n_nodes; ++i) {
        const auto law = model.law_at(i).as<Law>();
        const auto evaluator = nodes->laws.emplace_back(law.evaluator());
        const auto states = law.initial(0, 0);
        V_i.push_back(law.V_i_m_per_s);
        a_.push_back(direct_effect(evaluator, law.V_i_m_per_s, states));
        d_c_m_.push_back(following_slip_m(law, law.V_i_m_per_s));
        if (model.law.state_function() != nullptr) continue;
        for (std::size_t k = 0; k < states.size(); ++k)
          state_scales_[k][i] = a_[i] / state_effect(evaluator, law.V_i_m_per_s, states, k);
      }
      nodes_ = nodes;
    }
  });
  if (model.law.state_function() == nullptr) return;
  auto nodes = std::make_shared<NodesOfFunction>();
  nodes->law = model.law.state_function();
  const auto effects = nodes->effects(V_i, initial_states_);
  for (std::size_t k = 0; k < effects.size(); ++k)
    for (std::size_t i = 0; i < n_nodes; ++i) state_scales_[k][i] = a_[i] / effects[k][i];
  nodes_ = nodes;
}

bool QuasiDynamicFriction::takes_differences() const {
  return nodes_->takes_differences();
}

void QuasiDynamicFriction::balance(std::span<const double> t_Pa, std::span<const double> p_Pa,
                                   const LawStates& states, double short_s,
                                   std::span<double> slip_rate_m_per_s, LawStates& states_per_s) const {
  nodes_->balance(radiation_damping_, t_Pa, p_Pa, states, short_s, slip_rate_m_per_s, states_per_s);
}

}  // namespace slipfront::interface
