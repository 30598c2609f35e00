// SPDX-License-Identifier: BSD-3-Clause
#include "interface/interface.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "interface/friction/registry.hpp"
#include "interface/node.hpp"
#include "interface/state_array_law.hpp"

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

/// Coefficients that an ArrayLaw has given, evaluation by evaluation, and what is asked for beyond them.
/// Arrays are as long as all lanes are.
struct Answers {
  std::vector<std::vector<double>> mu;        ///< [evaluations][nodes]
  std::vector<double> speed_m_per_s, slip_m;  ///< of the evaluation that is asked for [nodes]
  bool asked = false;
};

/// The evaluator of one block of lanes: its k-th call takes the k-th answer, or asks.
struct AskedInLanes {
  Answers* answers;
  std::size_t node = 0;
  mutable std::size_t calls = 0;  ///< of this block so far
  SimdVector operator()(SimdVector speed_m_per_s, SimdVector slip_m) const {
    const std::size_t k = calls++;
    if (k < answers->mu.size()) return load(answers->mu[k].data() + node);
    if (k == answers->mu.size()) {
      store(answers->speed_m_per_s.data() + node, speed_m_per_s);
      store(answers->slip_m.data() + node, slip_m);
      answers->asked = true;
    }
    return SimdVector{};
  }
};

struct LawOverArrays {
  static constexpr bool strengthens = false;
  static constexpr SlipMemory memory = SlipMemory::lasting;  // the strength at rest is asked for as well
  static constexpr std::size_t n_states = 0;
  LawConstants<AskedInLanes, SimdVector> constants;
  void go_to(std::size_t node) { constants.mu = {constants.mu.answers, node}; }
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

/// The update by a law over arrays: again and again from the same state, each time with one more answer,
/// until nothing is left to ask.
template <ContactAlgorithm algorithm, class Regularised>
bool update_by(const FrictionLaw& of, const Regularised& regularisation, double dt_s, Interface& state) {
  const ArrayLaw& law = *of.function();
  const std::size_t padded = (state.size() + lanes - 1) / lanes * lanes;
  Answers answers;
  const auto all = [](double value) { return SimdVector{} + value; };
  const LawOverArrays asking{
      {{&answers}, all(static_coefficient(of)), all(kinetic_coefficient(of)), all(of.cohesion_Pa()), all(0)}};
  while (true) {
    answers.asked = false;
    answers.speed_m_per_s.assign(padded, 0);
    answers.slip_m.assign(padded, 0);
    Interface trial = state;
    const bool changed = update<algorithm>(asking, regularisation, dt_s, trial);
    if (!answers.asked) {
      state = std::move(trial);
      return changed;
    }
    auto& mu = answers.mu.emplace_back(padded);
    law({answers.speed_m_per_s.data(), state.size()}, {answers.slip_m.data(), state.size()},
        {mu.data(), state.size()});
    std::fill(mu.begin() + std::ssize(state.t_Pa), mu.end(), mu[state.size() - 1]);
  }
}

}  // namespace

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
  visit(model.law, [&]<class Law>(const Law&) {
    if constexpr (HasStates<Law>)
      for (std::size_t i = 0; i < s.size(); ++i)
        s.law_states[0][i] = model.law_at(i).as<Law>().state_before(s.t_Pa[i], s.p_Pa[i]);
  });
}

bool update_contact(const ContactModel& model, double dt_s, Interface& state) {
  const double since_last_s = state.begun ? dt_s : 0;
  state.begun = true;
  if (model.law.function())
    return with_regularisation(model.regularisation, since_last_s, [&](const auto& regularisation) {
      return model.algorithm == ContactAlgorithm::direct
                 ? update_by<ContactAlgorithm::direct>(model.law, regularisation, dt_s, state)
                 : update_by<ContactAlgorithm::predictor_corrector>(model.law, regularisation, dt_s, state);
    });
  if (const auto* law = model.law.state_function())
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
