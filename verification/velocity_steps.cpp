// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "interface/friction/rate_and_state.hpp"
#include "interface/interface.hpp"
#include "verification/problems.hpp"

namespace slipfront::verification::velocity_steps {

namespace {

constexpr double a = 0.008, b = 0.016, f0 = 0.6, f_w = 0.5;
constexpr double d_c_m = 1e-6, V0_m_per_s = 1e-6, V_w_m_per_s = 1e-3;
constexpr double V_m_per_s = 1e-3;  ///< before a step or a hold
constexpr double p_Pa = 5e6;
constexpr const char* rounding = "rounding in 100 updates, each some 1e-16, over b";

enum class Law { aging, slip, strong };
constexpr std::array laws = {Law::aging, Law::slip, Law::strong};

const char* name(Law law) {
  return law == Law::aging ? "aging law" : law == Law::slip ? "slip law" : "strong weakening";
}

template <class L>
interface::FrictionLaw with_constants(L law) {
  law.a = a, law.b = b, law.d_c_m = d_c_m, law.f0 = f0, law.V0_m_per_s = V0_m_per_s;
  law.V_i_m_per_s = V_m_per_s;
  if constexpr (L::weakens_strongly) law.f_w = f_w, law.V_w_m_per_s = V_w_m_per_s;
  return law;
}
interface::ContactModel contact(Law law) {
  if (law == Law::aging) return {with_constants(interface::RateAndStateAging{})};
  if (law == Law::slip) return {with_constants(interface::RateAndStateSlip{})};
  return {with_constants(interface::RateAndStateStrong{})};
}

double direct(double V) {
  return a * std::log(V / V0_m_per_s);
}
double steady(Law law, double V) {
  const double f = f0 + (a - b) * std::log(V / V0_m_per_s);
  return law == Law::strong ? f_w + (f - f_w) / std::pow(1 + std::pow(V / V_w_m_per_s, 8), 0.125) : f;
}
/// psi where the surfaces, before in steady sliding at V, have slid by slip_m at another rate.
double state(Law law, double V, double slip_m) {
  const double left = std::exp(-slip_m / d_c_m);
  if (law == Law::aging) {
    const double before_s = d_c_m / V_m_per_s, after_s = d_c_m / V;
    return f0 + b * std::log(V0_m_per_s / d_c_m * (after_s + (before_s - after_s) * left));
  }
  const double before = steady(law, V_m_per_s) - direct(V_m_per_s), after = steady(law, V) - direct(V);
  return after + (before - after) * left;
}

/// A node so heavy that friction does not change its slip rate, at first in steady sliding at V.
class HeavyNode {
 public:
  explicit HeavyNode(Law law) : model_(contact(law)), node_(1, model_.law.states()) {
    node_.mass_per_length_kg_m2[0] = 1e80;
    node_.p_Pa[0] = p_Pa;
    node_.t_Pa[0] = steady(law, V_m_per_s) * p_Pa;
    start_contact(model_, node_);
    node_.slip_rate_m_per_s[0] = V_m_per_s;
  }

  /// The coefficient at the beginning of the time for which the node slides at V.
  double slide(double V, double for_s) {
    node_.v_x_m_per_s[0] = V;
    node_.v_y_m_per_s[0] = -for_s * p_Pa / node_.mass_per_length_kg_m2[0];
    update_contact(model_, for_s, node_);
    return node_.t_Pa[0] / node_.p_Pa[0];
  }

 private:
  interface::ContactModel model_;
  interface::Interface node_;
};

/// The slip rate steps to `ratio` of it. Coefficients of steady sliding before are taken off.
void check_step(Law law, double ratio, Outcome& outcome, Chart* chart) {
  const double V = ratio * V_m_per_s, before = steady(law, V_m_per_s);
  Curve theory{chart && chart->curves.empty() ? "theory" : "", Curve::Kind::theory}, found{name(law)};
  HeavyNode node(law);
  const double step_s = 0.05 * d_c_m / V;
  const std::string what = fmt::format("{}, V steps to {} V", name(law), ratio);
  // The step lies between two half-steps; the coefficient there is that of the mean slip rate.
  outcome.check(fmt::format("{}: jump of mu over a", what), (node.slide(V, step_s) - before) / a,
                std::log(0.5 * (1 + ratio)), 1e-12, rounding);
  double error = 0;
  for (int n = 1; n <= 100; ++n) {
    const double slip_m = n * V * step_s, mu = node.slide(V, step_s),
                 exact = direct(V) + state(law, V, slip_m);
    error = std::max(error, std::abs(mu - exact));
    theory.add(slip_m / d_c_m, exact - before);
    if (n % 5 == 1) found.add(slip_m / d_c_m, mu - before);
  }
  outcome.check(fmt::format("{}: largest difference of mu from the exact one over b", what), error / b, 0,
                1e-12, rounding);
  if (!chart) return;
  chart->curves.push_back(std::move(theory));
  chart->curves.push_back(std::move(found));
}

/// A hold at rest, after which the surfaces slide at V again.
void check_holds(Law law, Outcome& outcome, Chart& chart) {
  Curve theory{chart.curves.empty() ? "theory" : "", Curve::Kind::theory}, found{name(law)};
  double error = 0;
  for (double hold = 1e-2; hold < 2e6; hold *= 10) {  // over d_c/V
    HeavyNode node(law);
    const double step_s = 0.1 * hold * d_c_m / V_m_per_s;
    for (int n = 0; n < 10; ++n) node.slide(0, step_s);
    // A node at rest has a stiff balance: mu is that at the end of the step.
    const double gained = node.slide(V_m_per_s, step_s) - steady(law, V_m_per_s);
    const double exact = law == Law::aging ? b * std::log(1 + hold) : 0;
    error = std::max(error, std::abs(gained - exact));
    theory.add(hold, exact / b);
    found.add(hold, gained / b);
  }
  outcome.check(fmt::format("{}: largest difference of mu after a hold from the exact one over b", name(law)),
                error / b, 0, 1e-12, rounding);
  chart.curves.push_back(std::move(theory));
  chart.curves.push_back(std::move(found));
}

}  // namespace

Outcome verify(Effort /*effort*/) {
  Outcome outcome;
  const Chart steps{.x_label = "slip / d_c", .y_label = "mu - mu before"};
  Chart up = steps, down = steps,
        holds{.x_label = "time at rest / (d_c / V)", .y_label = "gain of mu / b", .log_x = true};
  for (const Law law : laws) {
    for (const double ratio : {10.0, 0.1, 1e3, 1e-3})
      check_step(law, ratio, outcome, ratio == 10 ? &up : ratio == 0.1 ? &down : nullptr);
    check_holds(law, outcome, holds);
  }
  outcome.charts = {std::move(up), std::move(down), std::move(holds)};
  return outcome;
}

}  // namespace slipfront::verification::velocity_steps
