// SPDX-License-Identifier: BSD-3-Clause
#include "run/sequence.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

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
  {
    std::vector<std::pair<double, std::size_t>> v;
    for (std::size_t k = 0; k < last.v_m_per_s.x.size(); ++k) v.emplace_back(std::hypot(last.v_m_per_s.x[k], last.v_m_per_s.y[k]), k);
    std::ranges::sort(v, std::greater{});
    for (int k = 0; k < 6; ++k) fmt::print("v {:.3g} ({:.3g}, {:.3g}) at {:.4f} {:.4f}\n", v[k].first, last.v_m_per_s.x[v[k].second], last.v_m_per_s.y[v[k].second], initial.mesh.x_m[v[k].second], initial.mesh.y_m[v[k].second]);
  }
  return {initial.spontaneous, std::move(result), rest_of(last, initial, shear_m)};
}

/// The paper's plate, damped so that events come to rest.
input::Case damped_case() {
  auto config = test::coarse_case(interface::EventKind::spontaneous);
  config.material.stiffness_damping_s = 2e-6;
  config.time.end_s = 20e-3;
  config.time.interface_substeps = 1;
  config.loading.shear_speed_over_c_L = 1e-9;
  return config;
}

TEST(Sequence, StaticsHoldTheTractionsWithWhichAnEventComesToRest) {
  const auto config = damped_case();
  Sequence sequence(config, test::go_on);
  for (int event = 0; event < 4; ++event) {
    const auto [before, result, rest] = run_next(sequence, config);
    for (std::size_t k = 0; k < result.event.energies.size(); k += 40) fmt::print("{:.4g} {:.3g} {:.6g} {:.4g}\n", result.event.energies[k].time_s, result.event.energies[k].kinetic, result.event.energies[k].strain, result.event.energies[k].friction_work);
    fmt::print("onsets {}\n", result.event.record.n_onsets());
    ASSERT_EQ(result.event.end, motion::EventEnd::quiet);
    const auto at_rest = sequence.hold(rest);
    const auto& history = result.event.history;
    const std::size_t n = history.x_m.size(), row = (history.time_s.size() - 1) * n;
    double p_Pa = 0, off = 0;
    for (std::size_t k = 0; k < n; ++k) {
      p_Pa += at_rest.tractions.p_s_Pa[k] / static_cast<double>(n);
      off = std::max({off, std::abs(at_rest.tractions.t_s_Pa[k] - history.t_Pa[row + k]), std::abs(at_rest.tractions.p_s_Pa[k] - history.p_Pa[row + k])});
    }
    for (std::size_t k = 0; k < n; ++k)
      fmt::print("  {:.3f} {} dyn {:.4g} {:.4g} static {:.4g} {:.4g} before {:.4g}\n", history.x_m[k], static_cast<int>(at_rest.contact[k]), history.t_Pa[row + k], history.p_Pa[row + k], at_rest.tractions.t_s_Pa[k], at_rest.tractions.p_s_Pa[k], before.tractions.t_s_Pa[k]);
    fmt::print("{} off {} of {} time {}\n", event, off, p_Pa, result.event.time_s);
  }
}

}  // namespace
}  // namespace slipfront::run
