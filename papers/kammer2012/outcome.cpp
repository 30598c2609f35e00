// SPDX-License-Identifier: BSD-3-Clause
#include "papers/kammer2012/outcome.hpp"

#include <algorithm>
#include <cmath>

#include "base/numbers.hpp"
#include "fronts/measures.hpp"
#include "papers/kammer2012/circle.hpp"

namespace slipfront::kammer2012 {

Outcome make_outcome(const std::string& name, const run::Result& result, const run::InitialState& initial) {
  Outcome o;
  o.name = name;
  o.config = result.config;
  o.speeds = result.speeds;
  for (const auto& front : result.fronts)
    if (fronts::length_m(front) >= criteria_length_m * (1 - 1e-9)) o.fronts.push_back(front);
  o.common = initial.subcritical.tractions;
  o.inside_from_m = initial.subcritical.inside_from_m;
  o.inside_to_m = initial.subcritical.inside_to_m;
  o.contact_from_m = o.inside_from_m - result.config.loading.edge_margin_m;
  o.contact_to_m = o.inside_to_m + result.config.loading.edge_margin_m;
  o.peak_x_m = initial.subcritical.peak_x_m;
  o.critical_shear_m = initial.critical_shear_m;
  o.ramp_critical_shear_m = initial.ramp ? initial.ramp->supercritical.shear_m : nan;
  o.ramp_onsets = initial.ramp ? initial.ramp->record.n_onsets() : 0;

  o.trigger_work_J_per_m = result.event.energies.empty() ? nan : result.event.energies.back().trigger_work;
  if (o.config.event == interface::EventKind::left)
    o.waves = waves_on_rays(result.event.snapshots, initial.mesh, o.contact_from_m,
                            o.contact_from_m + o.config.trigger.zone_m);

  o.first_onset_x_m = nan;
  double first_s = infinity;
  for (const auto& onset : result.event.record.onsets) {
    const double x = result.event.record.x_m[onset.node];
    if (x < o.inside_from_m || x > o.inside_to_m || onset.time_s > first_s) continue;
    const bool same_time = onset.time_s == first_s;
    if (!same_time || std::abs(x - o.peak_x_m) > std::abs(o.first_onset_x_m - o.peak_x_m))
      o.first_onset_x_m = x;
    first_s = onset.time_s;
  }
  return o;
}

const fronts::Front* main_front(const Outcome& outcome, int direction) {
  const fronts::Front* longest = nullptr;
  for (const auto& front : outcome.fronts)
    if (front.direction == direction &&
        (longest == nullptr || fronts::length_m(front) > fronts::length_m(*longest)))
      longest = &front;
  return longest;
}

const fronts::Front* longest_front(const Outcome& outcome) {
  const auto* left = main_front(outcome, -1);
  const auto* right = main_front(outcome, 1);
  if (left == nullptr || right == nullptr) return left != nullptr ? left : right;
  return fronts::length_m(*left) > fronts::length_m(*right) ? left : right;
}

bool counts(const Outcome& outcome, const fronts::Front& front, const fronts::FrontPoint& point,
            double leave_out_m) {
  const double omitted = outcome.config.trigger.zone_m + outcome.config.fronts.trigger_margin_m;
  const bool left = outcome.config.event == interface::EventKind::left;
  const bool right = outcome.config.event == interface::EventKind::right;
  const auto near_trigger = [&](double x_m) {
    return (left && x_m < outcome.contact_from_m + omitted) ||
           (right && x_m > outcome.contact_to_m - omitted);
  };
  if (near_trigger(point.x_m)) return false;
  const double start_m = front.points.front().x_m;
  return near_trigger(start_m) || std::abs(point.x_m - start_m) >= leave_out_m;
}

double criterion_value(const fronts::FrontPoint& point, Criterion criterion) {
  switch (criterion) {
    case Criterion::static_ratio:
      return point.t_s_Pa / point.p_s_Pa;
    case Criterion::dynamic_ratio:
      return point.t_d_Pa / point.p_d_Pa;
    case Criterion::energy_rise:
      return fronts::relative_energy_rise(point);
  }
  return nan;
}

bool in_tail(const fronts::Front& front, const fronts::FrontPoint& point) {
  const bool stops = front.end == fronts::End::arrest || front.end == fronts::End::contact_end;
  return stops && std::abs(point.x_m - front.points.back().x_m) <= tail_m;
}

std::vector<fronts::Series> criterion_series(std::span<const Outcome* const> outcomes, Criterion criterion,
                                             bool without_tails) {
  std::vector<fronts::Series> list;
  for (const auto* outcome : outcomes) {
    for (const auto& front : outcome->fronts) {
      fronts::Series series;
      for (const auto& point : front.points) {
        const double x = criterion_value(point, criterion);
        // The same points for every criterion: those where all are defined.
        if (!counts(*outcome, front, point) || !std::isfinite(point.v_tip_m_per_s) ||
            !std::isfinite(point.U_s_J_per_m3) || !std::isfinite(x) ||
            (without_tails && in_tail(front, point)))
          continue;
        series.x.push_back(x);
        series.y.push_back(point.v_tip_m_per_s / outcome->speeds.c_L);
      }
      if (!series.x.empty()) list.push_back(std::move(series));
    }
  }
  return list;
}

std::vector<fronts::Series> case_series(std::span<const Outcome* const> outcomes, Criterion criterion) {
  std::vector<fronts::Series> list;
  for (const auto* outcome : outcomes) {
    fronts::Series all;
    for (const auto& front : criterion_series({&outcome, 1}, criterion)) {
      all.x.insert(all.x.end(), front.x.begin(), front.x.end());
      all.y.insert(all.y.end(), front.y.begin(), front.y.end());
    }
    if (!all.x.empty()) list.push_back(std::move(all));
  }
  return list;
}

double PaperFit::operator()(double energy_rise) const {
  return a + b * std::exp(-c * std::sqrt(energy_rise));
}

Collapse collapse(std::span<const Outcome* const> outcomes, bool without_tails) {
  Collapse result;
  const auto spreads = [&](Criterion criterion) {
    return Collapse::Spreads{
        spread_at_equal_x(case_series(outcomes, criterion), criterion_bins),
        spread_at_equal_x(criterion_series(outcomes, criterion, without_tails), criterion_bins)};
  };
  result.static_ratio = spreads(Criterion::static_ratio);
  result.dynamic_ratio = spreads(Criterion::dynamic_ratio);
  result.energy_rise = spreads(Criterion::energy_rise);
  const auto energy = criterion_series(outcomes, Criterion::energy_rise, without_tails);
  const PaperFit paper;
  std::size_t n_inside = 0;
  std::size_t n_usable = 0;
  for (const auto& series : energy) {
    for (std::size_t k = 0; k < series.x.size(); ++k) {
      ++result.n_points;
      n_usable += series.x[k] >= 0;
      n_inside += series.x[k] >= 0 && std::abs(series.y[k] - paper(series.x[k])) <= paper.band;
    }
  }
  result.share_in_paper_band =
      result.n_points > 0 ? static_cast<double>(n_inside) / static_cast<double>(result.n_points) : nan;
  if (n_usable >= 10) {
    result.fit = fronts::fit_exponential(energy);
    result.fitted = true;
  }
  return result;
}

SpeedChange speed_change(const Outcome& run, const Outcome& reference) {
  std::vector<double> changes, sizes;
  for (const int direction : {-1, 1}) {
    const auto* ours = main_front(run, direction);
    const auto* theirs = main_front(reference, direction);
    if (ours == nullptr || theirs == nullptr) continue;
    // Our speeds by x, to interpolate at the reference's nodes.
    std::vector<std::pair<double, double>> speeds;
    for (const auto& p : ours->points)
      if (counts(run, *ours, p, 5e-3) && std::isfinite(p.v_tip_m_per_s))
        speeds.emplace_back(p.x_m, p.v_tip_m_per_s);
    std::ranges::sort(speeds);
    for (const auto& p : theirs->points) {
      if (!counts(reference, *theirs, p, 5e-3) || !std::isfinite(p.v_tip_m_per_s) || speeds.size() < 2)
        continue;
      if (p.x_m < speeds.front().first || p.x_m > speeds.back().first) continue;
      auto after = std::ranges::lower_bound(speeds, p.x_m, {}, [](const auto& s) { return s.first; });
      if (after == speeds.begin()) ++after;
      const auto& [x1, v1] = *after;
      const auto& [x0, v0] = *(after - 1);
      const double v = v0 + (v1 - v0) * (p.x_m - x0) / (x1 - x0);
      changes.push_back(v / p.v_tip_m_per_s - 1);
      sizes.push_back(std::abs(changes.back()));
    }
  }
  SpeedChange change;
  change.n_points = changes.size();
  change.median = fronts::median(changes);
  change.median_absolute = fronts::median(sizes);
  change.largest = sizes.empty() ? nan : std::ranges::max(sizes);
  return change;
}

}  // namespace slipfront::kammer2012
