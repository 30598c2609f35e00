// SPDX-License-Identifier: BSD-3-Clause
#include "run/sequence.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <map>
#include <array>

#include "cases.hpp"
#include "run/choices.hpp"

namespace slipfront::run {
namespace {

/// Takes the motion with which an event ends.
struct Last final : motion::Observer {
  explicit Last(motion::Snapshot& to) : snapshot(to) {}
  void at_end(motion::Pause& pause) override { snapshot = pause.stepper().snapshot(); }
  motion::Snapshot& snapshot;
};

struct Step {
  statics::Equilibrium before;
  Result result;
  Rest rest;
};

Step run_next(Sequence& sequence, const input::Case& config) {
  const auto& initial = sequence.next();
  motion::Snapshot last;
  motion::Observers more;
  more.push_back(std::make_unique<Last>(last));
  auto result = run_from(config, initial, test::go_on, {}, std::move(more));
  const double shear_m = initial.spontaneous.shear_m + top_speed_m_per_s(config) * result.event.time_s;
  return {initial.spontaneous, std::move(result), rest_of(last, initial, shear_m)};
}

/// The paper's plate, damped so that events come to rest.
input::Case damped_case() {
  auto config = test::coarse_case(interface::EventKind::spontaneous);
  config.material.stiffness_damping_s = 2e-6;
  config.time.end_s = 20e-3;
  config.time.interface_substeps = std::getenv("SUB") ? std::atoi(std::getenv("SUB")) : 1; if (std::getenv("END")) config.time.end_s = std::atof(std::getenv("END")); if (std::getenv("BETA")) config.material.stiffness_damping_s = std::atof(std::getenv("BETA"));
  config.sequence.max_events = 100; if (std::getenv("V")) config.loading.shear_speed_over_c_L = std::atof(std::getenv("V")); config.time.quiet_s = 0.4e-3; if (std::getenv("H")) config.plate.element_size_m = std::atof(std::getenv("H"));if (std::getenv("MUK")) config.friction.parameter("mu_k") = std::atof(std::getenv("MUK"));
  return config;
}

TEST(Sequence, Explore) {
  const auto config = damped_case();
  Sequence sequence(config, test::go_on);
  const int n = std::getenv("N") ? std::atoi(std::getenv("N")) : 4;
  for (int event = 0; event < n; ++event) {
    const auto [before, result, rest] = run_next(sequence, config);
    const auto f = contact_force(before, mesh::tributary_lengths_m(sequence.mesh()));
    const auto at_rest = sequence.hold(rest);
    const auto g = contact_force(at_rest, mesh::tributary_lengths_m(sequence.mesh()));
    const auto& r = result.event.last_row;
    double potency = 0, slip_max = 0; int slipped = 0;
    const auto a = mesh::tributary_lengths_m(sequence.mesh());
    for (std::size_t k = 0; k < a.size(); ++k) { potency += r.slip_m[k] * a[k]; slip_max = std::max(slip_max, r.slip_m[k]); slipped += r.slip_m[k] != 0; }
    double from = 1, to = 0;
    for (const auto& o : result.event.record.onsets) { from = std::min(from, result.event.record.x_m[o.node]); to = std::max(to, result.event.record.x_m[o.node]); }
    { std::map<int, std::array<int, 8>> late; const auto& rec = result.event.record;
      for (const auto& o : rec.onsets) late[std::min(10, int(o.time_s / 0.5e-3))][std::min(7, int(rec.x_m[o.node] / 0.025))]++;
      for (const auto& s : rec.stops) late[100+std::min(10, int(s.time_s / 0.5e-3))][std::min(7, int(rec.x_m[s.node] / 0.025))]++;
      for (const auto& [t, row] : late) { fmt::print("   {:4} :", t); for (int c : row) fmt::print(" {:4}", c); fmt::print("\n"); }
      fmt::print("   inside {:.4f} {:.4f} energies", before.inside_from_m, before.inside_to_m);
      for (std::size_t k = 0; k < result.event.energies.size(); k += 25) { fmt::print(" {:.2g}", result.event.energies[k].kinetic); }
 fmt::print("\n"); }
    int open=0, slip=0; for (auto c : before.contact) { open += c == statics::Contact::open; slip += c == statics::Contact::slip; }
    fmt::print("{:2} shear {:.5g} F {:.4f} -> {:.4f} at {:.4f} slip {:.4f}-{:.4f} onsets {} potency {:.3g} max {:.3g} end {} t {:.4g} K {:.3g} open {} slip {} fronts {}\n", event, before.shear_m, f.shear_N_per_m/f.normal_N_per_m, g.shear_N_per_m/g.normal_N_per_m, before.peak_x_m, from, to, result.event.record.n_onsets(), potency, slip_max, static_cast<int>(result.event.end), result.event.time_s, result.event.energies.back().kinetic, open, slip, result.fronts.size());
  }
}

}  // namespace
}  // namespace slipfront::run
