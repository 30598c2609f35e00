// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "interface/friction/rate_and_state.hpp"
#include "interface/interface.hpp"
#include "verification/orders.hpp"
#include "verification/problems.hpp"

namespace slipfront::verification::recontact {

namespace {

constexpr double a = 0.008, b = 0.016, f0 = 0.6, d_c_m = 1e-6;
constexpr double V_m_per_s = 0.1;  ///< of the spring's other end; V0 too
constexpr double pressure_Pa = 5e6, mass_kg_per_m2 = 1000;
constexpr double k_Pa_per_m = pressure_Pa / d_c_m;
constexpr double unit_s = d_c_m / V_m_per_s;
constexpr double pull_s = 2 * unit_s, end_s = 6 * unit_s;
constexpr int n_samples = 60;

/// The pressure on the node, which pulls in the middle third.
double applied_Pa(double time_s) {
  const double s = time_s < pull_s ? std::sin(std::numbers::pi * time_s / pull_s) : 0;
  return pressure_Pa * (1 - 1.2 * s * s);
}

struct Motion {
  double stretch_m, v_m_per_s, psi;
};
Motion operator+(const Motion& m, const Motion& n) {
  return {m.stretch_m + n.stretch_m, m.v_m_per_s + n.v_m_per_s, m.psi + n.psi};
}
Motion operator*(double c, const Motion& m) {
  return {c * m.stretch_m, c * m.v_m_per_s, c * m.psi};
}

/// Runge and Kutta's method.
template <class F>
Motion integrated(Motion m, double from, double to, int n, const F& rate) {
  const double d = (to - from) / n;
  for (int j = 0; j < n; ++j) {
    const double t = from + j * d;
    const Motion k1 = rate(t, m), k2 = rate(t + 0.5 * d, m + 0.5 * d * k1),
                 k3 = rate(t + 0.5 * d, m + 0.5 * d * k2), k4 = rate(t + d, m + d * k3);
    m = m + d / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return m;
}

double coefficient(const Motion& m) {
  return m.psi + a * std::log(m.v_m_per_s / V_m_per_s);
}

/// Times at which the node leaves the plane and lands, and the speed at which it does.
struct Flight {
  double from_s, to_s, speed_m_per_s;
};
Flight flight() {
  const double w = 2 * std::numbers::pi / pull_s, g = pressure_Pa / mass_kg_per_m2;
  const double from = std::asin(std::sqrt(1 / 1.2)) * 2 / w;
  // y'' = -g (0.4 + 0.6 cos w t)
  const auto speed = [&](double t) {
    return -g * (0.4 * (t - from) + 0.6 / w * (std::sin(w * t) - std::sin(w * from)));
  };
  const auto height = [&](double t) {
    return -g * (0.2 * (t - from) * (t - from) - 0.6 / w * std::sin(w * from) * (t - from) -
                 0.6 / (w * w) * (std::cos(w * t) - std::cos(w * from)));
  };
  double low = pull_s - from, high = pull_s;
  for (int i = 0; i < 100; ++i) {
    const double t = 0.5 * (low + high);
    (height(t) > 0 ? low : high) = t;
  }
  return {from, low, -speed(low)};
}

template <class Law>
struct Problem {
  Law law;

  Problem() {
    law.a = a, law.b = b, law.f0 = f0, law.d_c_m = d_c_m;
    law.V0_m_per_s = law.V_i_m_per_s = V_m_per_s;
  }

  double psi_rate(const Motion& m) const {
    const double V = m.v_m_per_s;
    if constexpr (std::is_same_v<Law, interface::RateAndStateAging>)
      return b / d_c_m * (V_m_per_s * std::exp((f0 - m.psi) / b) - V);
    else
      return -V / d_c_m * (m.psi - f0 + b * std::log(V / V_m_per_s));
  }

  /// By steps of a 64th, from event to event. [samples]
  std::vector<Motion> reference() const {
    constexpr int n = 64;
    const auto [lift_s, land_s, fall_m_per_s] = flight();
    const auto slides = [&](bool touches) {
      return [this, touches](double t, const Motion& m) {
        const double t_Pa = touches ? coefficient(m) * applied_Pa(t) : 0;
        return Motion{V_m_per_s - m.v_m_per_s, (k_Pa_per_m * m.stretch_m - t_Pa) / mass_kg_per_m2,
                      psi_rate(m)};
      };
    };
    const auto lands = [](double /*impulse*/, const Motion& m) { return Motion{0, -coefficient(m), 0}; };
    Motion m{f0 * pressure_Pa / k_Pa_per_m, V_m_per_s, f0};
    std::vector<Motion> samples;
    double t = 0;
    for (int j = 1; j <= n_samples; ++j) {
      const double to = j * end_s / n_samples;
      if (lift_s > t && lift_s <= to) {
        m = integrated(m, t, lift_s, n, slides(true));
        t = lift_s;
      }
      if (land_s > t && land_s <= to) {
        m = integrated(m, t, land_s, n, slides(false));
        m = integrated(m, 0, fall_m_per_s, n, lands);
        t = land_s;
      }
      m = integrated(m, t, to, n, slides(t < lift_s || t >= land_s));
      t = to;
      samples.push_back(m);
    }
    return samples;
  }

  /// @param n  steps from one sample to the next
  std::vector<Motion> program(int n) const {
    const interface::ContactModel model { law };
    interface::Interface node(1, model.law.states());
    const double dt = end_s / (n * n_samples);
    node.mass_per_length_kg_m2[0] = mass_kg_per_m2;
    node.p_Pa[0] = pressure_Pa;
    node.t_Pa[0] = f0 * pressure_Pa;
    start_contact(model, node);
    node.slip_rate_m_per_s[0] = V_m_per_s;
    double stretch_m = f0 * pressure_Pa / k_Pa_per_m, v_x = V_m_per_s, v_y = 0;
    std::vector<Motion> samples;
    for (int j = 0; j < n * n_samples; ++j) {
      node.v_x_m_per_s[0] = v_x + dt * k_Pa_per_m * stretch_m / mass_kg_per_m2;
      node.v_y_m_per_s[0] = v_y - dt * applied_Pa(j * dt) / mass_kg_per_m2;
      update_contact(model, dt, node);
      v_x = node.v_x_m_per_s[0];
      v_y = node.v_y_m_per_s[0];
      stretch_m += dt * (V_m_per_s - v_x);
      node.u_y_m[0] += dt * v_y;
      if ((j + 1) % n == 0) samples.push_back({stretch_m, v_x, node.law_states[0][0]});
    }
    return samples;
  }
};

/// Errors over the step in d_c/V, of the slip and of the state.
template <class Law>
void check(const char* name, Effort effort, Outcome& outcome, Chart& motion, Chart& errors) {
  const Problem<Law> problem;
  const auto exact = problem.reference();
  std::vector<double> steps, of_slip, of_state;
  for (const int n :
       effort == Effort::full ? std::vector{1, 2, 3, 4, 6, 8, 12, 16} : std::vector{2, 3, 4, 6, 8}) {
    const auto found = problem.program(n);
    double slip_m = 0, state = 0;
    for (std::size_t j = 0; j < exact.size(); ++j) {
      slip_m = std::max(slip_m, std::abs(found[j].stretch_m - exact[j].stretch_m));
      state = std::max(state, std::abs(found[j].psi - exact[j].psi));
    }
    steps.push_back(end_s / unit_s / (n * n_samples));
    of_slip.push_back(slip_m / d_c_m);
    of_state.push_back(state / b);
  }
  outcome.check(fmt::format("order of the error of slip, {}", name), observed_order(steps, of_slip), 2, 0.1,
                "the scheme's");
  outcome.check(fmt::format("order of the error of the state, {}", name), observed_order(steps, of_state), 2,
                0.4, "where in its step the node leaves and lands");
  if (errors.curves.empty()) errors.curves.push_back(order_line(2, steps, of_slip.back()));
  errors.curves.push_back({fmt::format("slip / d_c, {}", name), Curve::Kind::program, steps, of_slip});
  errors.curves.push_back({fmt::format("psi / b, {}", name), Curve::Kind::program, steps, of_state});
  Curve theory{motion.curves.empty() ? "reference" : "", Curve::Kind::theory}, found{name};
  const auto coarse = problem.program(1);
  for (std::size_t j = 0; j < exact.size(); ++j) {
    const double time = end_s / unit_s * static_cast<double>(j + 1) / n_samples;
    theory.add(time, (exact[j].psi - f0) / b);
    if (j % 2 == 1) found.add(time, (coarse[j].psi - f0) / b);
  }
  motion.curves.push_back(std::move(theory));
  motion.curves.push_back(std::move(found));
}

}  // namespace

Outcome verify(Effort effort) {
  Outcome outcome;
  Chart motion{.x_label = "time / (d_c / V)", .y_label = "(psi - psi before) / b"};
  Chart errors{.x_label = "step / (d_c / V)", .y_label = "largest error", .log_x = true, .log_y = true};
  check<interface::RateAndStateAging>("aging law", effort, outcome, motion, errors);
  check<interface::RateAndStateSlip>("slip law", effort, outcome, motion, errors);
  outcome.charts = {std::move(motion), std::move(errors)};
  return outcome;
}

}  // namespace slipfront::verification::recontact
