// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "interface/friction/coulomb.hpp"
#include "verification/body.hpp"
#include "verification/problems.hpp"

namespace slipfront::verification::time_reversal {

namespace {

double largest_difference(const solid::Field& a, const solid::Field& b) {
  double largest = 0;
  for (std::size_t n = 0; n < a.size(); ++n)
    largest = std::max({largest, std::abs(a.x[n] - b.x[n]), std::abs(a.y[n] - b.y[n])});
  return largest;
}

constexpr double width_m = 0.04, height_m = 0.02, h_m = 1e-3;
constexpr double pressure_Pa = 1e6, amplitude_m = 1e-7, lift_m = 1e-5;

/// Undamped, without friction; in the air, or pressed down by more than the waves lift.
struct Setting {
  bool contact, subcycled;
  std::string name() const {
    return fmt::format("{}, {}", contact ? "plane" : "air", subcycled ? "sub-cycled" : "one step");
  }
};

/// Of the plate at rest on the plane.
const double strain = pressure_Pa / solid::longitudinal_modulus_Pa(undamped);

/// A motion there and back.
class Journey {
 public:
  Journey(const mesh::Mesh& mesh, const Setting& setting, int n_steps)
      : setting_(setting),
        n_steps_(n_steps),
        stepper_(mesh, undamped, {interface::Coulomb{0}},
                 setting.subcycled ? motion::TimeStepping{} : plain_stepping()),
        state_(begin(mesh)) {}

  void go_there_and_back() {
    go(0);
    reverse(stepper_);
    turned_ = state_;
    turned_.u_m = stepper_.u_m();
    turned_.u_per_shear = stepper_.v_m_per_s();
    go(n_steps_);
  }
  double distance_m() const { return largest_difference(stepper_.u_m(), state_.u_m); }
  double largest_distance_m() const { return largest_m_; }
  std::ptrdiff_t n_open() const { return n_open_; }

  /// Distances over the largest one.
  Curve distances() const {
    Curve curve = curve_;
    for (double& y : curve.y) y /= largest_m_;
    return curve;
  }
  /// The same way back, begun by a new start, with the steady part of the forces of the turned state.
  Curve distances_after_new_start() {
    stepper_.start(turned_, 1);
    Curve restarted{"air, sub-cycled, new start"};
    for (int i = 1; i <= n_steps_; ++i) {
      advance(stepper_);
      if (i % (n_steps_ / 25) != 0) continue;
      restarted.add(n_steps_ + i, distance_m() / largest_m_);
    }
    return restarted;
  }

 private:
  /// A bump that moves to the upper right and breaks up at the edges.
  statics::Equilibrium begin(const mesh::Mesh& mesh) {
    const auto bump = [&](mesh::Node n, double time) {
      const double x = mesh.x_m[n] - 0.3 * width_m - 700 * time,
                   y = mesh.y_m[n] - 0.4 * height_m - 400 * time;
      return amplitude_m * std::exp(-(x * x + y * y) / (2 * 9e-6)) *
             (1 - std::pow(mesh.y_m[n] / height_m, 8));
    };
    const auto rest = [&](mesh::Node n) { return setting_.contact ? -strain * mesh.y_m[n] : lift_m; };
    return start(stepper_, mesh,
                 {.u_x_m = bump,
                  .u_y_m = [&](mesh::Node n,
                               double time) { return rest(n) + (mesh.y_m[n] > 0 ? 0.5 * bump(n, time) : 0); },
                  .contact = setting_.contact ? statics::Contact::slip : statics::Contact::open,
                  .p_Pa = setting_.contact ? pressure_Pa : 0});
  }
  void go(int from) {
    for (int i = 1; i <= n_steps_; ++i) {
      advance(stepper_);
      const double distance = distance_m();
      if (setting_.contact) n_open_ += std::ranges::count(stepper_.interface_state().p_Pa, 0.0);
      largest_m_ = std::max(largest_m_, distance);
      if ((from + i) % (n_steps_ / 25) == 0) curve_.add(from + i, distance);
    }
  }

  Setting setting_;
  int n_steps_;
  motion::Stepper stepper_;
  statics::Equilibrium state_, turned_;
  double largest_m_ = 0;
  std::ptrdiff_t n_open_ = 0;  ///< interface nodes off the plane, summed over the steps
  Curve curve_{setting_.name()};
};

void check(const Journey& journey, const Setting& setting, double rest_m, int n_steps, Outcome& outcome) {
  outcome.check(fmt::format("distance from the start after {} steps there and back, over the "
                            "largest on the way, {}",
                            n_steps, setting.name()),
                journey.distance_m() / journey.largest_distance_m(), 0,
                2 * n_steps * std::numeric_limits<double>::epsilon() * rest_m / journey.largest_distance_m(),
                "one rounding of the largest displacement a step");
  if (setting.contact)
    outcome.check(fmt::format("nodes off the plane at the end of a step, {}", setting.name()),
                  static_cast<double>(journey.n_open()), 0, 0, "a landing would cost energy");
}

}  // namespace

Outcome verify(Effort effort) {
  Outcome outcome;
  const auto mesh = mesh::make_plate(
      {.width_m = width_m, .height_m = height_m, .element_size_m = h_m, .corner = mesh::Corner::none});
  const int n_steps = effort == Effort::quick ? 500 : 5000;
  Chart chart{
      .x_label = "steps, there and back", .y_label = "distance from the start / largest", .log_y = true};
  for (const bool contact : {false, true})
    for (const bool subcycled : {false, true}) {
      const Setting setting{contact, subcycled};
      Journey journey(mesh, setting, n_steps);
      journey.go_there_and_back();
      check(journey, setting, contact ? strain * height_m : lift_m, n_steps, outcome);
      chart.curves.push_back(journey.distances());
      if (subcycled && !contact) chart.curves.push_back(journey.distances_after_new_start());
    }
  outcome.charts.push_back(std::move(chart));
  return outcome;
}

}  // namespace slipfront::verification::time_reversal
