// SPDX-License-Identifier: BSD-3-Clause
#include "run/stick.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace slipfront::run {

using record::LoadingPhase;

namespace {

/// Heals until the first shear since normal loading, at most that of sequence.end_s, at which t/p inside
/// reaches mu_s, which grows.
void heal_to_critical(Sample& sample) {
  // From below: what mu_s has grown to at a shear is reached at a later one, until they meet.
  constexpr double accuracy = 1e-10;
  constexpr int most = 1000;
  const double end_m = sample.path.shear_m(sample.path.end_s()) - sample.rest.moved_m;
  double shear_m = sample.at_rest.shear_m;
  for (int i = 0; i < most && shear_m < end_m; ++i) {
    sample.heal_until(sample.time_s(shear_m));
    const double critical_m = sample.statics.shear_to(1).shear_m;
    if (critical_m - shear_m <= accuracy * std::abs(critical_m + sample.rest.moved_m)) return;
    shear_m = critical_m;
  }
  if (shear_m < end_m)
    throw UserError("{} heals the interface faster than the load grows; reduce it, or raise {}",
                    Key("sequence.healing_per_e_fold"), Key("loading.shear_speed_m_per_s"));
  sample.heal_until(sample.path.end_s());
}

}  // namespace

bool stick_to_next(Sample& sample) {
  if (sample.problem.heals()) heal_to_critical(sample);
  const double margin = sample.problem.loading.critical_margin;
  // Where a share is passed at rest, there may be no shear that brings it about: a strength with a memory
  // leaves nodes beyond mu_s.
  const auto at_share = [&](double share) {
    if (!sample.events.empty() && sample.statics.share_of_strength(sample.at_rest) >= share)
      return sample.at_rest;
    auto state = sample.statics.shear_to(share);
    return state.shear_m > sample.at_rest.shear_m ? state : sample.at_rest;
  };
  auto critical = at_share(1);
  sample.initial.critical_shear_m = critical.shear_m + sample.rest.moved_m;
  sample.initial.subcritical = at_share(1 - margin);
  sample.initial.supercritical = at_share(1 + margin);
  // An event may last beyond the end: the load then goes on to where the path ends, at once.
  if (const double end_m = sample.path.shear_m(sample.path.end_s()) - sample.rest.moved_m;
      sample.initial.supercritical.shear_m > end_m) {
    sample.load_to(LoadingPhase::loaded, sample.statics.shear_by(std::max(sample.at_rest.shear_m, end_m)));
    return false;
  }
  sample.load_to(LoadingPhase::event_begins, sample.initial.supercritical);
  for (auto* state : {&critical, &sample.initial.subcritical, &sample.initial.supercritical})
    state->shear_m += sample.rest.moved_m;
  if (setup::has_forces(sample.problem))
    sample.initial.loads = setup::resolved_loads(sample.problem, sample.statics, critical,
                                                 sample.initial.subcritical, sample.initial.tributary_m);
  return true;
}

}  // namespace slipfront::run
