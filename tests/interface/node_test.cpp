// SPDX-License-Identifier: BSD-3-Clause
#include "interface/node.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>

#include "interface/friction/registry.hpp"
#include "one_node.hpp"

namespace slipfront::interface {
namespace {

using namespace test;

/// Whether b's nodes from b_begin on are a's, bit by bit.
void expect_same_bits(const Interface& a, const Interface& b, std::size_t b_begin) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto of_a = results_at(a, i), of_b = results_at(b, b_begin + i);
    for (std::size_t k = 0; k < of_a.size(); ++k)
      ASSERT_EQ(bits_of(of_a[k]), bits_of(of_b[k])) << "array " << k << ", node " << i;
  }
}

/// But for roundings: the compiler may fuse a product and a sum in one of them. They are amplified in the
/// ratio to a small strength, and under a law with a state by tau/(a p), the exponent. A strength that is
/// nothing but roundings has no ratio.
void expect_same_values(Interface a, Interface b) {
  const double rounding = a.law_states.empty() ? 4e-14 : 4e-13;
  const double no_strength_Pa = rounding * std::ranges::max(a.strength_Pa);
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a.strength_Pa[i] < no_strength_Pa && b.strength_Pa[i] < no_strength_Pa)
      a.onset_ratio[i] = b.onset_ratio[i] = 0;
  ASSERT_EQ(a.slipping, b.slipping);
  ASSERT_EQ(a.locked, b.locked);
  std::vector<double> largest(results_at(a, 0).size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto values = results_at(a, i);
    for (std::size_t k = 0; k < largest.size(); ++k)
      if (std::isfinite(values[k])) largest[k] = std::max(largest[k], std::abs(values[k]));
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto of_a = results_at(a, i), of_b = results_at(b, i);
    for (std::size_t k = 0; k < largest.size(); ++k) {
      const double value = of_a[k], other = of_b[k];
      ASSERT_TRUE(std::isnan(value) ? std::isnan(other)
                                    : value == other || std::abs(value - other) <= rounding * largest[k])
          << "array " << k << ", node " << i << ": " << value << ", " << other;
    }
  }
}

/// The update as it would be written for one node at a time.
template <ContactAlgorithm algorithm, bool strengthens, class Law, class Form>
bool update_one_by_one(const FrictionLaw& of, const Law& law, const Form& form, Interface& s) {
  auto constants = constants_of(of, law);
  if constexpr (HasStates<Law>) constants.tip_slip_rate_m_per_s = ContactModel{}.tip_slip_rate_m_per_s;
  bool changed = false;
  for (std::size_t i = 0; i < s.size(); ++i) {
    Node<double, n_states_of<Law>> n{};
    const auto for_each_entry = [&](auto&& f) {
      f(n.initial_gap_m, s.initial_gap_m);
      f(n.mass_per_length_kg_m2, s.mass_per_length_kg_m2);
      f(n.tangential_mass_ratio, s.tangential_mass_ratio);
      f(n.strength_fraction, s.strength_fraction);
      f(n.v_x_m_per_s, s.v_x_m_per_s);
      f(n.v_y_m_per_s, s.v_y_m_per_s);
      f(n.u_y_m, s.u_y_m);
      f(n.slip_rate_m_per_s, s.slip_rate_m_per_s);
      f(n.t_Pa, s.t_Pa);
      f(n.p_Pa, s.p_Pa);
      f(n.onset_ratio, s.onset_ratio);
      f(n.strength_Pa, s.strength_Pa);
      f(n.slipping, s.slipping);
      f(n.slip_m, s.slip_m);
      f(n.memory.relaxed_Pa, s.relaxed_Pa);
      f(n.memory.target_Pa, s.target_Pa);
      f(n.acceleration_m_per_s2, s.acceleration_m_per_s2);
      f(n.locked, s.locked);
      for (std::size_t k = 0; k < n.law_states.size(); ++k) f(n.law_states[k], s.law_states[k]);
    };
    for_each_entry([i](auto& entry, const auto& values) { entry = values[i]; });
    changed = update_node < algorithm, Law::memory, requires {
      law.strengthens();
    }
    > (constants, form, dt, n) || changed;
    for_each_entry([i](const auto& entry, auto& values) { values[i] = entry; });
  }
  return changed;
}

bool update_one_by_one(const ContactModel& model, double since_last_s, Interface& s) {
  return visit(model.law, [&]<class Law>(const Law& law) {
    return with_regularisation(model.regularisation, since_last_s, [&](const auto& form) {
      if constexpr (!HasStates<Law>)
        if (model.algorithm == ContactAlgorithm::predictor_corrector)
          return update_one_by_one<ContactAlgorithm::predictor_corrector, false>(model.law, law, form, s);
      if constexpr (requires { law.strengthens(); })
        if (law.strengthens())
          return update_one_by_one<ContactAlgorithm::direct, true>(model.law, law, form, s);
      return update_one_by_one<ContactAlgorithm::direct, false>(model.law, law, form, s);
    });
  });
}

/// Every 50th node's motion is not a number.
void push(Interface& s, std::mt19937_64& random) {
  const auto motions = Motion::of(s.size(), random);
  for (std::size_t i = 0; i < s.size(); ++i) {
    motions[i].push(s, i);
    if (i % 50 == 49) (i % 100 == 49 ? s.v_x_m_per_s : s.v_y_m_per_s)[i] = std::nan("");
  }
}

Interface nodes(std::size_t n, const ContactModel& model) {
  auto s = many_nodes(n, model);
  for (std::size_t i = 0; i < n; i += 10) s.tangential_mass_ratio[i] = 1.25;
  start_contact(model, s);
  return s;
}

TEST(InterfaceFields, AreAllArraysThatNodesHave) {
  constexpr std::array<LawState, 2> states = {{{"theta_s", "s", ""}, {"age_s", "s", ""}}};
  Interface s(3, states);
  std::set<const void*> arrays;
  for_each_field(s, [&](FieldKind, const auto& values) {
    EXPECT_EQ(values.size(), 3U);
    arrays.insert(values.data());
  });
  EXPECT_EQ(arrays.size(), interface_fields.size() + states.size());
  // An array that the table lacks would make the struct larger.
  struct Expected {
    std::vector<double> fields[interface_fields.size()];
    decltype(Interface::law_states) of_law;
    bool begun;
  };
  EXPECT_EQ(sizeof(Interface), sizeof(Expected));
}

TEST(NodeUpdate, OfLanesIsThatOfDoubles) {
  for_each_model([](const ContactModel& model) {
    SCOPED_TRACE(testing::Message() << model.law.name() << ", "
                                    << static_cast<int>(model.regularisation.relaxed));
    auto s = nodes(203, model);
    std::mt19937_64 random(1);
    int n_slip = 0, n_stick = 0, n_open = 0, n_changes = 0;
    for (int k = 0; k < 20; ++k) {
      push(s, random);
      auto one_by_one = s;
      const bool changed = update_one_by_one(model, k == 0 ? 0 : dt, one_by_one);
      EXPECT_EQ(update_contact(model, dt, s), changed);
      ASSERT_NO_FATAL_FAILURE(expect_same_values(s, one_by_one));
      n_changes += changed;
      for (std::size_t i = 0; i < s.size(); ++i)
        ++(s.p_Pa[i] == 0 ? n_open : s.slipping[i] != 0 ? n_slip : n_stick);
    }
    for (const int count : {n_slip, n_stick, n_open}) EXPECT_GT(count, 100);
    EXPECT_GT(n_changes, 10);
  });
}

TEST(NodeUpdate, DoesNotDependOnThePlaceInTheArray) {
  // The last nodes alone, so that each of them comes to every lane, and to a vector that is not full.
  for_each_model([](const ContactModel& model) {
    const std::size_t n = 3 * lanes;
    Interface before = nodes(n, model);
    std::mt19937_64 random(1);
    push(before, random);
    update_contact(model, dt, before);
    push(before, random);
    auto whole = before;
    update_contact(model, dt, whole);
    for (std::size_t begin = 1; begin < n; ++begin) {
      auto part = before;
      for_each_field(part, [&](FieldKind, auto& values) {
        values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(begin));
      });
      update_contact(model, dt, part);
      ASSERT_NO_FATAL_FAILURE(expect_same_bits(part, whole, begin));
    }
  });
}

TEST(NodeUpdate, MotionThatIsNotANumberShowsUpAsASlipRate) {
  for_each_model([](const ContactModel& model) {
    auto s = nodes(2 * lanes, model);
    std::mt19937_64 random(1);
    push(s, random);
    s.v_x_m_per_s[3] = std::nan("");
    update_contact(model, dt, s);
    for (std::size_t i = 0; i < s.size(); ++i) EXPECT_EQ(std::isnan(s.slip_rate_m_per_s[i]), i == 3);
  });
}

}  // namespace
}  // namespace slipfront::interface
