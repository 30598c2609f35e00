// SPDX-License-Identifier: BSD-3-Clause
#include "interface/node_laws.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "interface/interface.hpp"
#include "one_node.hpp"

namespace slipfront::interface {
namespace {

using namespace test;

/// A separate node, in the state of one of many.
Interface alone(const Interface& s, std::size_t i) {
  Interface one(1);
  one.law_states.assign(s.law_states.size(), {0.0});
  const auto take = [i](auto& to, const auto& from) { to[0] = from[i]; };
  take(one.mass_per_length_kg_m2, s.mass_per_length_kg_m2);
  take(one.strength_fraction, s.strength_fraction);
  take(one.p_Pa, s.p_Pa);
  return one;
}

/// Laws of the model's type whose parameters lie between 0.5 and 1 of its own: mu_k stays below mu_s.
std::vector<FrictionLaw> random_laws(const ContactModel& model, std::size_t n, std::mt19937_64& random) {
  std::vector<FrictionLaw> laws(n, model.law);
  std::uniform_real_distribution<double> share(0.5, 1);
  for (auto& law : laws) do {
      law = model.law;
      for (const auto& parameter : description_of(law).parameters)
        law.parameter(parameter.key) *= share(random);
    } while (!inconsistency(law).text.empty() || strengthens(law) != strengthens(model.law));
  return laws;
}

TEST(NodeLaws, EachNodeFollowsItsOwn) {
  // All lanes, and every number of nodes left over.
  for_each_model([](const ContactModel& model) {
    std::mt19937_64 random(3);
    for (std::size_t n = 1; n <= 2 * lanes + 1; ++n) {
      const auto laws = random_laws(model, n, random);
      auto varying = model;
      varying.law_per_node = NodeLaws(laws);
      auto together = many_nodes(n, model);
      start_contact(varying, together);
      std::vector<ContactModel> models(n, model);
      std::vector<Interface> single;
      for (std::size_t i = 0; i < n; ++i) {
        models[i].law = laws[i];
        single.push_back(alone(many_nodes(n, model), i));
        start_contact(models[i], single[i]);
        EXPECT_EQ(results_at(together, i), results_at(single[i], 0));
      }
      for (int k = 0; k < 10; ++k) {
        const auto motions = Motion::of(n, random);
        for (std::size_t i = 0; i < n; ++i) motions[i].push(together, i);
        const bool changed = update_contact(varying, dt, together);
        bool any_changed = false;
        for (std::size_t i = 0; i < n; ++i) {
          motions[i].push(single[i], 0);
          any_changed = update_contact(models[i], dt, single[i]) || any_changed;
          ASSERT_EQ(results_at(together, i), results_at(single[i], 0)) << "node " << i << " of " << n;
        }
        EXPECT_EQ(changed, any_changed);
      }
    }
  });
}

}  // namespace
}  // namespace slipfront::interface
