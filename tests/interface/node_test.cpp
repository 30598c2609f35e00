// SPDX-License-Identifier: BSD-3-Clause
#include "interface/node.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <variant>
#include <vector>

#include "interface/friction/registry.hpp"
#include "one_node.hpp"

namespace slipfront::interface {
namespace {

using test::dt;
using test::for_each_model;

/// All arrays of the state that an update writes, flags as numbers.
std::vector<std::vector<double>> arrays(const Interface& s) {
  return {s.v_x_m_per_s,
          s.v_y_m_per_s,
          s.u_y_m,
          s.slip_rate_m_per_s,
          s.t_Pa,
          s.p_Pa,
          s.trial_traction_Pa,
          s.strength_Pa,
          s.slip_m,
          s.relaxed_Pa,
          s.target_Pa,
          s.acceleration_m_per_s2,
          {s.slipping.begin(), s.slipping.end()},
          {s.locked.begin(), s.locked.end()}};
}

/// Whether b's nodes from b_begin on are a's, bit by bit.
void expect_same_bits(const Interface& a, const Interface& b, std::size_t b_begin) {
  const auto of_a = arrays(a), of_b = arrays(b);
  for (std::size_t k = 0; k < of_a.size(); ++k)
    for (std::size_t i = 0; i < a.size(); ++i)
      ASSERT_EQ(bits_of(of_a[k][i]), bits_of(of_b[k][b_begin + i])) << "array " << k << ", node " << i;
}

/// But for roundings: the compiler may fuse a product and a sum in one of them.
void expect_same_values(const Interface& a, const Interface& b) {
  const auto of_a = arrays(a), of_b = arrays(b);
  for (std::size_t k = 0; k < of_a.size(); ++k) {
    double largest = 0;
    for (const double value : of_a[k]) largest = std::max(largest, std::isnan(value) ? 0 : std::abs(value));
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double value = of_a[k][i], other = of_b[k][i];
      ASSERT_TRUE(std::isnan(value) ? std::isnan(other) : std::abs(value - other) <= 4e-15 * largest)
          << "array " << k << ", node " << i << ": " << value << ", " << other;
    }
  }
}

/// The update as it would be written for one node at a time.
template <ContactAlgorithm algorithm, class Law, class Form>
bool update_one_by_one(const Law& law, const Form& form, Interface& s) {
  const auto constants = constants_of(law);
  bool changed = false;
  for (std::size_t i = 0; i < s.size(); ++i) {
    Node<double> n{s.initial_gap_m[i],
                   s.mass_per_length_kg_m2[i],
                   s.tangential_mass_ratio[i],
                   s.intact[i],
                   s.v_x_m_per_s[i],
                   s.v_y_m_per_s[i],
                   s.u_y_m[i],
                   s.slip_rate_m_per_s[i],
                   s.t_Pa[i],
                   s.p_Pa[i],
                   s.trial_traction_Pa[i],
                   s.strength_Pa[i],
                   s.slipping[i] != 0,
                   s.slip_m[i],
                   {s.relaxed_Pa[i], s.target_Pa[i]},
                   s.acceleration_m_per_s2[i],
                   s.locked[i] != 0};
    changed = update_node<algorithm, Law::memory>(constants, form, dt, n) || changed;
    s.v_x_m_per_s[i] = n.v_x_m_per_s;
    s.v_y_m_per_s[i] = n.v_y_m_per_s;
    s.u_y_m[i] = n.u_y_m;
    s.slip_rate_m_per_s[i] = n.slip_rate_m_per_s;
    s.t_Pa[i] = n.t_Pa;
    s.p_Pa[i] = n.p_Pa;
    s.trial_traction_Pa[i] = n.trial_traction_Pa;
    s.strength_Pa[i] = n.strength_Pa;
    s.slipping[i] = n.slipping;
    s.slip_m[i] = n.slip_m;
    s.relaxed_Pa[i] = n.memory.relaxed_Pa;
    s.target_Pa[i] = n.memory.target_Pa;
    s.acceleration_m_per_s2[i] = n.acceleration_m_per_s2;
    s.locked[i] = n.locked;
  }
  return changed;
}

bool update_one_by_one(const ContactModel& model, double since_last_s, Interface& s) {
  return visit(model.law, [&](const auto& law) {
    return with_form(model.regularisation, since_last_s, [&](const auto& form) {
      return model.algorithm == ContactAlgorithm::direct
                 ? update_one_by_one<ContactAlgorithm::direct>(law, form, s)
                 : update_one_by_one<ContactAlgorithm::predictor_corrector>(law, form, s);
    });
  });
}

/// A motion that makes nodes stick, slip, open, land and turn round; every 50th is not a number.
struct Motion {
  std::mt19937_64 random{1};
  void push(Interface& s) {
    std::uniform_real_distribution<double> within(-1, 1);
    for (std::size_t i = 0; i < s.size(); ++i) {
      s.v_x_m_per_s[i] = 4 * s.slip_rate_m_per_s[i] / 5 + within(random);
      s.v_y_m_per_s[i] = within(random) - 0.6;
      s.u_y_m[i] += dt * (within(random) + 0.3);
      if (i % 50 == 49) (i % 100 == 49 ? s.v_x_m_per_s : s.v_y_m_per_s)[i] = std::nan("");
    }
  }
};

Interface nodes(std::size_t n, const ContactModel& model) {
  Interface s(n);
  for (std::size_t i = 0; i < n; ++i) {
    s.mass_per_length_kg_m2[i] = test::mass * (1 + 0.01 * static_cast<double>(i));
    s.tangential_mass_ratio[i] = i % 10 == 0 ? 1.25 : 1;
    s.intact[i] = i % 7 == 0 ? 0.5 : 1;
    s.p_Pa[i] = i % 9 == 0 ? 0 : 0.5e6;
  }
  start_contact(model, s);
  return s;
}

TEST(NodeUpdate, OfLanesIsThatOfDoubles) {
  for_each_model([](const ContactModel& model) {
    auto s = nodes(203, model);
    Motion motion;
    int n_slip = 0, n_stick = 0, n_open = 0, n_changes = 0;
    for (int k = 0; k < 20; ++k) {
      motion.push(s);
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
    Motion motion;
    motion.push(before);
    update_contact(model, dt, before);
    motion.push(before);
    auto whole = before;
    update_contact(model, dt, whole);
    for (std::size_t begin = 1; begin < n; ++begin) {
      auto part = before;
      const auto cut = [&](auto& values) {
        values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(begin));
      };
      for (auto* values :
           {&part.initial_gap_m, &part.mass_per_length_kg_m2, &part.tangential_mass_ratio, &part.intact,
            &part.v_x_m_per_s, &part.v_y_m_per_s, &part.u_y_m, &part.slip_rate_m_per_s, &part.t_Pa,
            &part.p_Pa, &part.trial_traction_Pa, &part.strength_Pa, &part.slip_m, &part.relaxed_Pa,
            &part.target_Pa, &part.acceleration_m_per_s2})
        cut(*values);
      cut(part.slipping);
      cut(part.locked);
      update_contact(model, dt, part);
      ASSERT_NO_FATAL_FAILURE(expect_same_bits(part, whole, begin));
    }
  });
}

TEST(NodeUpdate, MotionThatIsNotANumberShowsUpAsASlipRate) {
  for_each_model([](const ContactModel& model) {
    auto s = nodes(2 * lanes, model);
    Motion motion;
    motion.push(s);
    s.v_x_m_per_s[3] = std::nan("");
    update_contact(model, dt, s);
    for (std::size_t i = 0; i < s.size(); ++i) EXPECT_EQ(std::isnan(s.slip_rate_m_per_s[i]), i == 3);
  });
}

}  // namespace
}  // namespace slipfront::interface
