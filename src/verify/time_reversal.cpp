// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "verify/body.hpp"
#include "verify/problems.hpp"

namespace slipfront::verify {

namespace {

double largest_difference(const solid::Field& a, const solid::Field& b) {
  double largest = 0;
  for (std::size_t n = 0; n < a.size(); ++n)
    largest = std::max({largest, std::abs(a.x[n] - b.x[n]), std::abs(a.y[n] - b.y[n])});
  return largest;
}

}  // namespace

Outcome time_reversal(Effort effort) {
  Outcome outcome;
  const solid::Material material{.stiffness_damping_s = 0};
  constexpr double width = 0.04, height = 0.02, h = 1e-3, pressure = 1e6, amplitude = 1e-7, lift = 1e-5;
  const auto mesh = mesh::make_plate(
      {.width_m = width, .height_m = height, .element_size_m = h, .corner = mesh::Corner::none});
  const double strain = pressure / solid::longitudinal_modulus_Pa(material);
  const int n_steps = effort == Effort::quick ? 500 : 5000;
  Chart chart{
      .x_label = "steps, there and back", .y_label = "distance from the start / largest", .log_y = true};
  for (const bool contact : {false, true})
    for (const bool subcycled : {false, true}) {
      // Undamped, without friction; in the air, or pressed down by more than the waves lift.
      motion::Stepper stepper(mesh, material, {interface::Coulomb{0}},
                              subcycled ? motion::TimeStepping{} : plain_stepping());
      // A bump that moves to the upper right and breaks up at the edges.
      const auto bump = [&](mesh::Node n, double time) {
        const double x = mesh.x_m[n] - 0.3 * width - 700 * time, y = mesh.y_m[n] - 0.4 * height - 400 * time;
        return amplitude * std::exp(-(x * x + y * y) / (2 * 9e-6)) * (1 - std::pow(mesh.y_m[n] / height, 8));
      };
      const auto rest = [&](mesh::Node n) { return contact ? -strain * mesh.y_m[n] : lift; };
      const auto state =
          start(stepper, mesh,
                {.u_x_m = bump,
                 .u_y_m = [&](mesh::Node n,
                              double time) { return rest(n) + (mesh.y_m[n] > 0 ? 0.5 * bump(n, time) : 0); },
                 .contact = contact ? statics::Contact::slip : statics::Contact::open,
                 .p_Pa = contact ? pressure : 0});
      motion::Recorder recorder(state, 1, 0);
      double motion = 0;
      Curve curve{fmt::format("{}, {}", contact ? "plane" : "air", subcycled ? "sub-cycled" : "one step"),
                  Curve::Kind::program,
                  {},
                  {}};
      std::ptrdiff_t n_open = 0;
      const auto go = [&](int from) {
        for (int i = 1; i <= n_steps; ++i) {
          stepper.advance(recorder);
          const double distance = largest_difference(stepper.u_m(), state.u_m);
          if (contact) n_open += std::ranges::count(stepper.interface_state().p_Pa, 0.0);
          motion = std::max(motion, distance);
          if ((from + i) % (n_steps / 25) == 0) curve.x.push_back(from + i), curve.y.push_back(distance);
        }
      };
      go(0);
      stepper.reverse(recorder);
      auto turned = state;
      turned.u_m = stepper.u_m();
      turned.u_per_shear = stepper.v_m_per_s();
      go(n_steps);
      const double left = largest_difference(stepper.u_m(), state.u_m);
      outcome.checks.push_back(
          {fmt::format("distance from the start after {} steps there and back, over the "
                       "largest on the way, {}",
                       n_steps, curve.label),
           "", left / motion, 0,
           2 * n_steps * std::numeric_limits<double>::epsilon() * (contact ? strain * height : lift) / motion,
           "one rounding of the largest displacement a step"});
      if (contact)
        outcome.checks.push_back({fmt::format("nodes off the plane at the end of a step, {}", curve.label),
                                  "", static_cast<double>(n_open), 0, 0, "a landing would cost energy"});
      for (double& y : curve.y) y /= motion;
      chart.curves.push_back(std::move(curve));
      if (!subcycled || contact) continue;
      // The same way back, begun by a new start, with the steady part of the forces of the turned state.
      stepper.start(turned, 1);
      Curve restarted{"air, sub-cycled, new start", Curve::Kind::program, {}, {}};
      for (int i = 1; i <= n_steps; ++i) {
        stepper.advance(recorder);
        if (i % (n_steps / 25) != 0) continue;
        restarted.x.push_back(n_steps + i);
        restarted.y.push_back(largest_difference(stepper.u_m(), state.u_m) / motion);
      }
      chart.curves.push_back(std::move(restarted));
    }
  outcome.charts.push_back(std::move(chart));
  return outcome;
}

}  // namespace slipfront::verify
