// SPDX-License-Identifier: BSD-3-Clause
#include "study/convergence.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/error.hpp"
#include "fronts/fit.hpp"
#include "fronts/measures.hpp"
#include "input/schema.hpp"

namespace slipfront::study {

namespace {

bool same(double a, double b) {
  return std::abs(a - b) <= 1e-9 * std::abs(b);
}

/// Finds the case's own member and the last three above the limit.
Plan finish(Plan plan) {
  std::size_t n_positive = 0;
  for (std::size_t k = 0; k < plan.members.size(); ++k) {
    if (plan.members[k].step_size > 0) ++n_positive;
    if (same(plan.members[k].value, plan.case_value)) plan.own = k;
  }
  SLIPFRONT_ASSERT(n_positive >= 3, "a sequence needs three step sizes");
  std::iota(plan.last.begin(), plan.last.end(), n_positive - 3);
  return plan;
}

std::vector<double> element_sizes(const input::Case& config, const ConvergenceOptions& options) {
  const double h = config.plate.element_size_m;
  auto sizes = options.element_sizes_m;
  if (sizes.empty()) sizes = {2 * h, h, h / 2};
  std::sort(sizes.rbegin(), sizes.rend());
  sizes.erase(std::unique(sizes.begin(), sizes.end(), same), sizes.end());
  if (sizes.size() < 3) throw UserError("--element-sizes: give at least three different sizes in m");
  if (sizes.back() <= 0) throw UserError("--element-sizes: sizes must be above 0 m");
  if (std::none_of(sizes.begin(), sizes.end(), [&](double s) { return same(s, h); }))
    throw UserError("--element-sizes: the case's own {} = {:.8g} must be among them",
                    Key("plate.element_size_m"), h);
  return sizes;
}

Plan element_plan(const input::Case& base, const std::vector<double>& sizes) {
  Plan plan{"plate.element_size_m", base.plate.element_size_m, {}, {}, 0};
  for (const double h : sizes) {
    input::Case c = base;
    // The case's own size to the last digit: it shares the base run.
    c.plate.element_size_m = same(h, base.plate.element_size_m) ? base.plate.element_size_m : h;
    plan.members.push_back({h, h, c});
  }
  return finish(std::move(plan));
}

/// @throws UserError that names the option, since the case has another size
void require_sizes_fit(const Plan& plan) {
  for (const auto& member : plan.members) {
    try {
      run::check(member.config);
    } catch (const UserError& error) {
      throw error.at(fmt::format("element size {:.8g} m of the study, see --element-sizes", member.value));
    }
  }
}

Plan step_plan(const input::Case& base) {
  const int n = base.time.interface_substeps;
  if (n == 1 || base.time.interface_rows == 0) {
    Plan plan{"time.step_factor", base.time.step_factor, {}, {}, 0};
    for (const double factor : {1.0, 0.5, 0.25}) {
      input::Case c = base;
      c.time.step_factor *= factor;
      plan.members.push_back({c.time.step_factor, c.time.step_factor, c});
    }
    return finish(std::move(plan));
  }
  Plan plan{"time.interface_substeps", static_cast<double>(n), {}, {}, 0};
  for (const int m : {n / 2, n, 2 * n, 4 * n}) {
    input::Case c = base;
    c.time.interface_substeps = m;
    plan.members.push_back({static_cast<double>(m), 1.0 / m, c});
  }
  return finish(std::move(plan));
}

Plan damping_plan(const input::Case& base) {
  Plan plan{"material.stiffness_damping_s", base.material.stiffness_damping_s, {}, {}, 0};
  for (const double factor : {2.0, 1.0, 0.5, 0.0}) {
    input::Case c = base;
    c.material.stiffness_damping_s *= factor;
    plan.members.push_back({c.material.stiffness_damping_s, c.material.stiffness_damping_s, c});
  }
  return finish(std::move(plan));
}

Summary summarise_direction(const std::vector<Station>& stations, const Plan& plan, int direction,
                            double tolerance) {
  std::array<double, 3> q{};
  for (std::size_t k = 0; k < 3; ++k) q[k] = plan.members[plan.last[k]].step_size;
  std::vector<StationSummary> list;
  int n_wanted = 0;
  for (const auto& s : stations) {
    if (direction != 0 && s.direction != direction) continue;
    ++n_wanted;
    const double own = s.v_tip_m_per_s[plan.own];
    const auto f = [&](std::size_t k) { return s.v_tip_m_per_s[plan.last[k]]; };
    list.push_back({s.error_m_per_s[plan.own] / own, s.limit.order,
                    std::abs(f(0) - f(1)) / own / std::log(q[0] / q[1]),
                    std::abs(f(1) - f(2)) / own / std::log(q[1] / q[2])});
  }
  return summarise(list, n_wanted, tolerance);
}

Sequence compare(const Plan& plan, const std::vector<Run>& runs, const ConvergenceOptions& options) {
  Sequence sequence;
  sequence.plan = plan;
  const auto& own = runs[plan.members[plan.own].run];
  for (const auto& [x_m, direction] : stations(own.main, options.station_spacing_m))
    sequence.stations.push_back({x_m, direction, {}, {}, {}});
  std::array<double, 3> q{}, f{};
  for (std::size_t k = 0; k < 3; ++k) q[k] = plan.members[plan.last[k]].step_size;
  std::vector<double> at_limit;
  for (auto& s : sequence.stations) {
    for (const auto& member : plan.members)
      s.v_tip_m_per_s.push_back(speed_at(runs[member.run].main, {s.x_m, s.direction}));
    for (std::size_t k = 0; k < 3; ++k) f[k] = s.v_tip_m_per_s[plan.last[k]];
    const double v = s.v_tip_m_per_s[plan.own];
    s.limit = extrapolate(q, f);
    for (const double value : s.v_tip_m_per_s) s.error_m_per_s.push_back(error_of(value, s.limit, f));
    if (plan.members.back().step_size == 0)
      at_limit.push_back(std::abs(s.v_tip_m_per_s.back() - s.limit.value) / v);
  }
  sequence.relative_difference_at_limit = fronts::median(at_limit);
  sequence.both = summarise_direction(sequence.stations, plan, 0, options.tolerance);
  sequence.left = summarise_direction(sequence.stations, plan, -1, options.tolerance);
  sequence.right = summarise_direction(sequence.stations, plan, 1, options.tolerance);
  return sequence;
}

}  // namespace

std::vector<Plan> plan_convergence(const input::Case& config, const ConvergenceOptions& options) {
  const auto sizes = element_sizes(config, options);
  input::Case base = for_study(config);
  base.fronts.l_star_m = std::max(base.fronts.l_star_m, sizes.front());
  std::vector<Plan> plans = {element_plan(base, sizes), step_plan(base)};
  if (base.material.stiffness_damping_s > 0) plans.push_back(damping_plan(base));
  return plans;
}

Convergence study_convergence(const input::Case& config, const ConvergenceOptions& options,
                              const StudyMonitor& monitor) {
  auto plans = plan_convergence(config, options);
  require_sizes_fit(plans.front());
  std::vector<input::Case> cases;
  std::map<std::string, std::size_t> index;
  const auto add = [&](const input::Case& c) {
    const auto [it, is_new] = index.try_emplace(input::to_toml(c), cases.size());
    if (is_new) cases.push_back(c);
    return it->second;
  };
  // The finest mesh takes longest: first.
  for (auto& plan : plans)
    for (auto it = plan.members.rbegin(); it != plan.members.rend(); ++it) it->run = add(it->config);

  Convergence result;
  result.options = options;
  result.l_star_m = cases.front().fronts.l_star_m;
  const auto runs = run_cases(cases, options.threads, monitor, options.kept);
  result.counts = counts_of(runs);
  for (const auto& plan : plans) {
    for (const auto& member : plan.members)
      if (const auto& what = runs[member.run].blow_up; !what.empty())
        result.warnings.push_back(fmt::format("{} = {:g}: {}", plan.parameter, member.value, what));
    result.sequences.push_back(compare(plan, runs, options));
  }
  if (std::ranges::all_of(result.sequences, [](const Sequence& s) { return s.stations.empty(); }))
    result.warnings.emplace_back(
        "no front of the case's own run goes far enough beyond its beginning to be measured: nothing is "
        "compared");
  return result;
}

}  // namespace slipfront::study
