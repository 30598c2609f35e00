// SPDX-License-Identifier: BSD-3-Clause
#include "interface/interface.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "interface/answers.hpp"
#include "interface/friction/registry.hpp"
#include "interface/node.hpp"

namespace slipfront::interface {

Interface::Interface(std::size_t n, std::span<const LawState> states_of_law) {
  for (const auto& field : interface_fields)
    std::visit([&](auto array) { (this->*array).assign(n, field.initial); }, field.array);
  law_states.assign(states_of_law.size(), std::vector<double>(n));
}

namespace {

/// The nodes [begin, begin + lanes).
struct AllLanes {
  std::size_t begin;
  template <class T>
  auto read(const std::vector<T>& from) const {
    return load(from.data() + begin);
  }
  template <class T, class V>
  void write(std::vector<T>& to, V values) const {
    store(to.data() + begin, values);
  }
};

/// The nodes [begin, begin + count), fewer than lanes; the lanes left over repeat the last one of them.
struct SomeLanes {
  std::size_t begin;
  int count;
  template <class T>
  auto read(const std::vector<T>& from) const {
    return load_partial(from.data() + begin, count);
  }
  template <class T, class V>
  void write(std::vector<T>& to, V values) const {
    store_partial(to.data() + begin, values, count);
  }
};

/// Whether a value goes into a node's update, and whether it comes out of it.
template <bool in, bool out>
struct Flow {};

/// Calls visit(flow, array, value) for all that a node of an update shares with the interface's arrays.
template <ContactAlgorithm algorithm, bool remembers, class NodeOfLanes, class Visit>
void for_each_value(Interface& s, NodeOfLanes& n, Visit&& visit) {
  constexpr bool predicts = algorithm == ContactAlgorithm::predictor_corrector;
  constexpr Flow<true, false> in;
  constexpr Flow<false, true> out;
  constexpr Flow<true, true> both;
  visit(in, s.initial_gap_m, n.initial_gap_m);
  visit(in, s.mass_per_length_kg_m2, n.mass_per_length_kg_m2);
  visit(in, s.tangential_mass_ratio, n.tangential_mass_ratio);
  visit(in, s.strength_fraction, n.strength_fraction);
  visit(both, s.v_x_m_per_s, n.v_x_m_per_s);
  visit(both, s.v_y_m_per_s, n.v_y_m_per_s);
  visit(Flow<true, predicts>{}, s.u_y_m, n.u_y_m);
  visit(both, s.slip_rate_m_per_s, n.slip_rate_m_per_s);
  visit(out, s.t_Pa, n.t_Pa);
  visit(out, s.p_Pa, n.p_Pa);
  visit(out, s.onset_ratio, n.onset_ratio);
  visit(out, s.strength_Pa, n.strength_Pa);
  visit(both, s.slipping, n.slipping);
  visit(both, s.slip_m, n.slip_m);
  if constexpr (remembers) {
    visit(both, s.relaxed_Pa, n.memory.relaxed_Pa);
    visit(both, s.target_Pa, n.memory.target_Pa);
  }
  if constexpr (predicts) {
    visit(both, s.acceleration_m_per_s2, n.acceleration_m_per_s2);
    visit(both, s.locked, n.locked);
  }
  for (std::size_t k = 0; k < n.law_states.size(); ++k) visit(both, s.law_states[k], n.law_states[k]);
}

/// A law of the registry, the same for all nodes or one for each.
template <class Law, bool may_strengthen>
struct RegistryLaw {
  static constexpr bool strengthens = may_strengthen;
  static constexpr SlipMemory memory = Law::memory;
  static constexpr std::size_t n_states = n_states_of<Law>;
  const NodeLaws* law_per_node;  ///< null where all have the same
  double tip_slip_rate_m_per_s;
  ConstantsOf<Law, SimdVector> constants;
  RegistryLaw(const ContactModel& model, const Law& law)
      : law_per_node(model.law_per_node.empty() ? nullptr : &model.law_per_node),
        tip_slip_rate_m_per_s(model.tip_slip_rate_m_per_s),
        constants(in_lanes(model.law, law)) {
    set_tip();
  }
  void go_to(std::size_t node) {
    if (!law_per_node) return;
    constants = law_per_node->constants<Law>(node / lanes);
    set_tip();
  }
  void set_tip() {
    if constexpr (HasStates<Law>) constants.tip_slip_rate_m_per_s = SimdVector{} + tip_slip_rate_m_per_s;
  }
};

/// A law over arrays.
struct ArrayLawInLanes {
  static constexpr bool strengthens = false;
  static constexpr SlipMemory memory = SlipMemory::lasting;  // the strength at rest is asked for as well
  static constexpr std::size_t n_states = 0;
  LawConstants<Answers::Evaluator<SimdVector>, SimdVector> constants;
  void go_to(std::size_t node) { constants.mu = {constants.mu.answers, node}; }
};
struct StateArrayLawInLanes {
  static constexpr bool strengthens = false;
  static constexpr SlipMemory memory = SlipMemory::none;
  static constexpr std::size_t n_states = 0;  // all nodes' evolve at once
  StateLawConstants<Answers::Evaluator<SimdVector>, SimdVector> constants;
  void go_to(std::size_t node) { constants.law = {constants.law.answers, node}; }
};

// Flattened: the compiler would keep the nodes in memory between these functions. The constants are copied:
// what is written to the nodes cannot be theirs then, and they stay in registers. Not as an argument: clang
// 14 aligns those on the stack to 32 bytes, where vectors may need 64.
template <ContactAlgorithm algorithm, class Law, class Regularised>
[[gnu::flatten, gnu::noinline]] bool update(const Law& given, const Regularised regularisation, double dt_s,
                                            Interface& s) {
  Law law = given;
  SimdMask changed{};
  const auto update_at = [&](auto at) {
    Node<SimdVector, Law::n_states> nodes{};
    nodes.is_time_weakening = s.is_time_weakening;
    for_each_value<algorithm, Regularised::remembers>(
        s, nodes, [&]<bool in, bool out>(Flow<in, out>, const auto& array, auto& value) {
          if constexpr (in) value = at.read(array);
        });
    law.go_to(at.begin);
    changed |=
        update_node<algorithm, Law::memory, Law::strengthens>(law.constants, regularisation, dt_s, nodes);
    for_each_value<algorithm, Regularised::remembers>(
        s, nodes, [&]<bool in, bool out>(Flow<in, out>, auto& array, const auto& value) {
          if constexpr (out) at.write(array, value);
        });
  };
  std::size_t i = 0;
  for (; i + lanes <= s.size(); i += lanes) update_at(AllLanes{i});
  if (i < s.size()) update_at(SomeLanes{i, static_cast<int>(s.size() - i)});
  return any(changed);
}

/// The update by a law over arrays, which is asked by `law`.
template <ContactAlgorithm algorithm, class Law, class Regularised, class Ask>
bool update_by(Answers& answers, const Law& law, const Regularised& regularisation, double dt_s,
               Interface& state, const Ask& ask) {
  Interface trial = state;
  bool changed = false;
  answers.complete(
      [&] {
        trial = state;
        changed = update<algorithm>(law, regularisation, dt_s, trial);
      },
      ask);
  state = std::move(trial);
  return changed;
}

template <ContactAlgorithm algorithm, class Regularised>
bool update_by(const ArrayLaw& function, const FrictionLaw& of, const Regularised& regularisation,
               double dt_s, Interface& state) {
  Answers answers(state.size());
  const auto all = [](double value) { return SimdVector{} + value; };
  const ArrayLawInLanes law{
      {{&answers}, all(static_coefficient(of)), all(kinetic_coefficient(of)), all(of.cohesion_Pa()), all(0)}};
  return update_by<algorithm>(answers, law, regularisation, dt_s, state, function);
}

template <class Regularised>
bool update_by(const StateArrayLaw& function, const ContactModel& model, const Regularised& regularisation,
               double dt_s, Interface& state) {
  Answers answers(state.size());
  const StateArrayLawInLanes law{{{&answers}, SimdVector{} + model.tip_slip_rate_m_per_s}};
  const bool changed = update_by<ContactAlgorithm::direct>(
      answers, law, regularisation, dt_s, state, [&](auto speed_m_per_s, auto /*slip_m*/, auto mu) {
        coefficients(function, speed_m_per_s, state.law_states, mu);
      });
  std::vector<double> speed_m_per_s;
  for (const double V : state.slip_rate_m_per_s) speed_m_per_s.push_back(std::abs(V));
  function.evolve(speed_m_per_s, dt_s, state.law_states);
  return changed;
}

}  // namespace

void set_initial_states(const ContactModel& model, std::span<const double> t_Pa, std::span<const double> p_Pa,
                        LawStates& states) {
  if (const auto& law = model.law.state_function(); law && law->initial)
    return law->initial(t_Pa, p_Pa, states);
  visit(model.law, [&]<class Law>(const Law&) {
    if constexpr (HasStates<Law>)
      for (std::size_t i = 0; i < t_Pa.size(); ++i) {
        const auto of_node = model.law_at(i).as<Law>().initial(t_Pa[i], p_Pa[i]);
        for (std::size_t k = 0; k < of_node.size(); ++k) states[k][i] = of_node[k];
      }
  });
}

void start_contact(const ContactModel& model, Interface& s) {
  s.begun = false;
  with_regularisation(model.regularisation, 0, [&](const auto& regularisation) {
    for (std::size_t i = 0; i < s.size(); ++i) {
      const FrictionLaw& law = model.law_at(i);
      const double mu_s = static_coefficient(law), mu_k = kinetic_coefficient(law);
      const double mu_0 =
          ForcedWeakening<double>(mu_s, mu_k, s.strength_fraction[i], s.is_time_weakening)(mu_s);
      s.strength_Pa[i] = mu_0 * s.p_Pa[i] + (s.p_Pa[i] > 0 ? law.cohesion_Pa() : 0);
      const auto memory = regularisation.initial(mu_0, s.p_Pa[i]);
      s.relaxed_Pa[i] = memory.relaxed_Pa;
      s.target_Pa[i] = memory.target_Pa;
      s.slip_m[i] = 0;
      s.acceleration_m_per_s2[i] = 0;
      s.locked[i] = s.p_Pa[i] > 0;
    }
  });
  set_initial_states(model, s.t_Pa, s.p_Pa, s.law_states);
}

bool update_contact(const ContactModel& model, double dt_s, Interface& state) {
  const double since_last_s = state.begun ? dt_s : 0;
  state.begun = true;
  if (const auto* law = model.law.function())
    return with_regularisation(model.regularisation, since_last_s, [&](const auto& regularisation) {
      return model.algorithm == ContactAlgorithm::direct
                 ? update_by<ContactAlgorithm::direct>(*law, model.law, regularisation, dt_s, state)
                 : update_by<ContactAlgorithm::predictor_corrector>(*law, model.law, regularisation, dt_s,
                                                                    state);
    });
  if (const auto& law = model.law.state_function())
    return with_regularisation(model.regularisation, since_last_s, [&](const auto& regularisation) {
      return update_by(*law, model, regularisation, dt_s, state);
    });
  return visit(model.law, [&]<class Law>(const Law& one) {
    const auto update_by_law = [&](const auto& law) {
      return with_regularisation(model.regularisation, since_last_s, [&](const auto& regularisation) {
        if constexpr (!HasStates<Law>)
          if (model.algorithm == ContactAlgorithm::predictor_corrector)
            return update<ContactAlgorithm::predictor_corrector>(law, regularisation, dt_s, state);
        SLIPFRONT_ASSERT(model.algorithm == ContactAlgorithm::direct, "a state needs the direct algorithm");
        return update<ContactAlgorithm::direct>(law, regularisation, dt_s, state);
      });
    };
    if constexpr (requires { one.strengthens(); })
      if (model.law_per_node.empty() ? one.strengthens() : model.law_per_node.some_strengthens())
        return update_by_law(RegistryLaw<Law, true>(model, one));
    return update_by_law(RegistryLaw<Law, false>(model, one));
  });
}

}  // namespace slipfront::interface
