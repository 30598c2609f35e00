// SPDX-License-Identifier: BSD-3-Clause
#include "verification/rupture.hpp"

#include <memory>
#include <numeric>
#include <utility>

#include "motion/observers/history_rows.hpp"

namespace slipfront::verification {

Rupture run_rupture(motion::TimeStepper& stepper, const statics::Equilibrium& state,
                    const motion::TimeStepping& time, const solid::Material& material, double mu_s,
                    double history_interval_s, double energy_interval_s) {
  const motion::EventSetup setup{.state = state,
                                 .mu_s = mu_s,
                                 .waves = {solid::longitudinal_speed_m_per_s(material), 1e6},
                                 .loads_settle_s = 0,
                                 .time = time,
                                 .tip_slip_interval_s = history_interval_s,
                                 .energy_interval_s = energy_interval_s,
                                 .halo = 1};
  record::History history;
  motion::Observers observers;
  observers.push_back(std::make_unique<motion::HistoryRows>(history_interval_s, [&](const auto& row) {
    history.law_states.resize(row.law_states.size());
    record::append_rows(members_of(history), members_of(row));
  }));
  auto event = motion::EventRun(
                   stepper, setup, [](auto, auto) { return true; }, std::move(observers))
                   .run();
  fronts::FrontOptions options;
  options.l_star_m = 5e-3;
  options.mu_s = mu_s;
  options.elasticity = {material.youngs_modulus_Pa, material.poissons_ratio, false};
  auto found = fronts::find_fronts(event.record, state.tractions, options);
  return {std::move(event), std::move(found), std::move(history)};
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace slipfront::verification
