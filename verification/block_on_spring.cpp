// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "boundary/machine.hpp"
#include "interface/friction/slip_weakening.hpp"
#include "verification/body.hpp"
#include "verification/problems.hpp"

namespace slipfront::verification::block_on_spring {

namespace {

constexpr double H_m = 0.1;
constexpr double p_Pa = 1e9, mu_s = 0.6, mu_k = 0.4;
constexpr double drop_Pa = (mu_s - mu_k) * p_Pa;
/// How fast friction weakens, over the spring's stiffness.
constexpr double weakening = 3;

/// The block as a point of mass m per area behind a spring k that moves on at V. Times in 1/omega =
/// sqrt(m/k), slip in the strength drop over k, tractions in the drop; t_s is reached at time 0.
class Slider {
 public:
  /// @param speed  V over drop/sqrt(k m)
  explicit Slider(double speed) : speed_(speed) {
    // x'' = 2 x + V t until x = d_c: x = V (sinh(l t)/l - t)/l^2, l^2 = weakening - 1.
    double below = 0, above = 100;
    for (int bisection = 0; bisection < 200; ++bisection) {
      weak_ = 0.5 * (below + above);
      (weakening_slip(weak_) < d_c ? below : above) = weak_;
    }
    // Then x'' = 1 + V t - x: a swing about 1 + V t.
    const double v = speed_ * (std::cosh(rate * weak_) - 1) / (rate * rate);
    cosine_ = d_c - 1 - speed_ * weak_;
    sine_ = v - speed_;
    double moving = weak_;
    while (swing_velocity(moving) > 0) moving += 1e-3;
    below = moving - 1e-3, above = moving;
    for (int bisection = 0; bisection < 100; ++bisection) {
      end_ = 0.5 * (below + above);
      (swing_velocity(end_) > 0 ? below : above) = end_;
    }
  }
  static constexpr double d_c = 1 / weakening;
  double weak() const { return weak_; }  ///< when slip is d_c
  double end() const { return end_; }    ///< when it stops
  double slip(double time) const {
    if (time < weak_) return time > 0 ? weakening_slip(time) : 0;
    const double t = std::min(time, end_) - weak_;
    return 1 + speed_ * (weak_ + t) + cosine_ * std::cos(t) + sine_ * std::sin(t);
  }
  /// Force of the spring per area, less t_s.
  double force(double time) const { return speed_ * time - slip(time); }
  double largest_velocity() const { return speed_ + std::hypot(cosine_, sine_); }

 private:
  static constexpr double rate = 1.4142135623730951;
  double weakening_slip(double time) const {
    return speed_ * (std::sinh(rate * time) / rate - time) / (rate * rate);
  }
  double swing_velocity(double time) const {
    const double t = time - weak_;
    return speed_ - cosine_ * std::sin(t) + sine_ * std::cos(t);
  }
  double speed_;
  double weak_ = 0, end_ = 0, cosine_ = 0, sine_ = 0;
};

/// In the slider's units.
struct Event {
  Curve slip, force;
  double weak = 0, end = 0, largest_velocity = 0;
};

/// A layer that moves uniformly across, its spring `softness` times as stiff as itself, G/H.
Event program(double softness, int rows) {
  const double h_m = H_m / rows, rho = undamped.density_kg_per_m3;
  const double k_Pa_per_m = softness * solid::shear_modulus_Pa(undamped) / H_m, m = rho * H_m;
  const double unit_s = std::sqrt(m / k_Pa_per_m), unit_m = drop_Pa / k_Pa_per_m;
  const double speed_m_per_s = 1;  // of the machine in a verification's start
  auto plate = mesh::Plate{.width_m = 3 * h_m, .height_m = H_m, .element_size_m = h_m};
  plate.corner = mesh::Corner::none;
  plate.sides = mesh::Sides::periodic;
  const boundary::Machine machine{.shear_stiffness_Pa_per_m = k_Pa_per_m};
  const auto mesh = mesh::make_plate(plate);
  const interface::SlipWeakeningHealing law { .mu_s = mu_s, .mu_k = mu_k, .d_c_m = Slider::d_c * unit_m };
  const motion::BodySource block{mesh, undamped, nullptr, nullptr, machine};
  motion::Stepper stepper(std::span(&block, 1), {law, {.relaxed = interface::Relaxed::pressure}},
                          plain_stepping());
  const double strain = mu_s * p_Pa / solid::shear_modulus_Pa(undamped);
  start(stepper, mesh,
        {.u_x_m = [&](mesh::Node n, double) { return mesh.y_m[n] * strain; },
         .contact = statics::Contact::stick,
         .t_Pa = mu_s * p_Pa,
         .p_Pa = p_Pa,
         .loads = {std::vector<double>(mesh.interface_nodes.size(), 0.0),
                   std::vector<double>(mesh.interface_nodes.size(), p_Pa)}});
  const auto below = mesh.interface_nodes[0], above = mesh.far_edge_nodes[0];
  const double above_at_start_m = stepper.u_m().x[above];
  const Slider slider(speed_m_per_s * unit_s / unit_m);
  Event event;
  double slip_before = 0;
  while (stepper.time_s() < 1.15 * slider.end() * unit_s) {
    const double time = stepper.time_s() / unit_s, slip = stepper.u_m().x[below] / unit_m;
    event.slip.add(time, slip);
    event.force.add(time, speed_m_per_s * stepper.time_s() / unit_m -
                              (stepper.u_m().x[above] - above_at_start_m) / unit_m);
    if (slip >= Slider::d_c && event.weak == 0) event.weak = time;
    if (slip > slip_before) event.end = time;
    event.largest_velocity = std::max(event.largest_velocity, stepper.v_m_per_s().x[below] * unit_s / unit_m);
    slip_before = slip;
    advance(stepper);
  }
  return event;
}

Curve points(const char* label, const Curve& all) {
  Curve curve{label};
  const std::size_t every = all.x.size() / 50;
  for (std::size_t i = 0; i < all.x.size(); i += every) curve.add(all.x[i], all.y[i]);
  return curve;
}

double speed_of_machine(double softness) {
  const double k = softness * solid::shear_modulus_Pa(undamped) / H_m;
  return std::sqrt(k * undamped.density_kg_per_m3 * H_m) / drop_Pa;
}

void check(double softness, int rows, bool is_drawn, Outcome& outcome) {
  const Slider slider(speed_of_machine(softness));
  const auto event = program(softness, rows);
  const auto name = [&](const char* what) { return fmt::format("{}, k = {:g} G/H", what, softness); };
  // At rest the layer yields by k H/G of the spring's part; its inertia adds a third of that to the swing.
  const char* reason = "the layer yields, too, by k H/G of the spring's part: twice that";
  const auto expect = [&](const char* what, double measured, double expected) {
    outcome.check(name(what), measured, expected, 2 * softness * expected, reason);
  };
  const double end = event.slip.y.back();
  expect("slip k/(t_s - t_k)", end, slider.slip(slider.end()));
  expect("drop of the spring's force over that of the strength", -event.force.value_at(event.end),
         -slider.force(slider.end()));
  expect("time from the slip d_c to rest, sqrt(k/m)", event.end - event.weak, slider.end() - slider.weak());
  expect("largest slip rate sqrt(k m)/(t_s - t_k)", event.largest_velocity, slider.largest_velocity());
  if (!is_drawn) return;
  for (const bool is_slip : {true, false}) {
    Curve theory{"rigid block", Curve::Kind::theory};
    const auto& measured = is_slip ? event.slip : event.force;
    for (const double time : measured.x)
      theory.add(time, is_slip ? slider.slip(time) : slider.force(std::min(time, slider.end())));
    outcome.charts.push_back(
        {.x_label = "time sqrt(k/m)",
         .y_label = is_slip ? "slip k / strength drop" : "change of the spring's force / strength drop",
         .curves = {theory, points("program", measured)}});
  }
}

}  // namespace

Outcome verify(Effort effort) {
  Outcome outcome;
  check(0.03, 20, effort == Effort::quick, outcome);
  if (effort == Effort::quick) return outcome;
  check(0.01, 20, false, outcome);
  check(0.003, 20, true, outcome);
  return outcome;
}

}  // namespace slipfront::verification::block_on_spring
