// SPDX-License-Identifier: BSD-3-Clause
#include "papers/kammer2012/second_tests.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "base/numbers.hpp"
#include "fronts/measures.hpp"
#include "papers/kammer2012/evidence.hpp"
#include "papers/kammer2012/main_fronts.hpp"

namespace slipfront::kammer2012 {

namespace {

using fronts::Front;
using fronts::FrontPoint;

constexpr double fall_length_m = 5e-3;  ///< V_tip falls rapidly: by fall_share within this length
constexpr double fall_share = 0.1;
constexpr double initiation_m = 5e-3;  ///< from the start of the stretch that two fronts cover
constexpr double arrest_m = 10e-3;     ///< before the slower front's end

/// Lengths that are whole numbers of elements do not fall on either side of a limit by rounding.
bool within(double distance_m, double limit_m) {
  return distance_m <= limit_m * (1 + 1e-9);
}

/// "; " between parts, nothing before the first.
void append(std::string& text, const std::string& part) {
  if (!text.empty()) text += "; ";
  text += part;
}

/// A second test that has not been done yet.
/// @param suffix  of its id
Claim second_test(std::span<const Claim> first, const char* of, const char* why, std::string how,
                  const char* suffix = "b") {
  Claim row = *std::ranges::find(first, of, &Claim::id);
  row.id = std::string(of) + suffix;
  row.second_test_of = of;
  row.why = why;
  row.how = std::move(how);
  row.holds.reset();
  row.used_to_choose = false;
  row.figures.clear();
  return row;
}

// C11b

Claim trigger_choice(const std::optional<TriggerSample>& sample, std::span<const Claim> first) {
  Claim row = second_test(
      first, "C11",
      "the paper does not give its trigger, and the left-triggered maximum follows it: the first test judges "
      "our choice",
      fmt::format("of the triggers sampled within the stated ranges there is one for which the "
                  "left-triggered maximum is at most {} of the other two while C1 to C10 hold",
                  percent(most_left_over_others)));
  row.measured = "not tested: no study of the open choices";
  if (!sample || sample->n_triggers == 0) return row;
  const double share = static_cast<double>(sample->n_holding) / sample->n_triggers;
  row.measured = fmt::format("{} of {} triggers ({})", sample->n_holding, sample->n_triggers, percent(share));
  row.figures = {{"share", 100 * share, "%"}};
  row.holds = sample->n_holding > 0;
  return row;
}

// C18b and C18c

/// Fit and share in the band; then the spreads.
std::array<Claim, 2> collapse_of_main_fronts(std::span<const MainFront> mains, std::span<const Claim> first) {
  Claim fit =
      second_test(first, "C18", "its points are those of late fronts in the wake of others, too",
                  fmt::format("main fronts without their last {:g} mm: (a) and (b) as C18", tail_m * mm));
  Claim order = second_test(
      first, "C18", "a curve is one thing, which quantity orders the speeds another",
      fmt::format("main fronts without their last {:g} mm: the median relative spread of V_tip between the "
                  "fronts is smaller at equal (U_r-U_s)/U_s than at equal t_d/p_d and at equal t_s/p_s",
                  tail_m * mm),
      "c");
  order.claim = "the energy rise orders the speeds of fronts, the ratios of the tractions do not";
  order.paper = "Conclusions";
  const Collapse c = collapse_without_tails(mains);
  if (!c.fitted) {
    fit.measured = order.measured = "too few points for a fit";
    return {fit, order};
  }
  const double by_energy = c.energy_rise.fronts.median_relative,
               by_dynamic = c.dynamic_ratio.fronts.median_relative,
               by_static = c.static_ratio.fronts.median_relative;
  const PaperFit paper;
  fit.measured = fmt::format("{}; the paper: a = {:.2f}, b = {:.2f}, c = {:.2f}", describe(c), paper.a,
                             paper.b, paper.c);
  fit.figures = figures_of(c);
  fit.holds = c.fit.rms <= paper.band && c.share_in_paper_band >= wanted_share_in_band;
  order.measured = fmt::format("spread {} at equal (U_r-U_s)/U_s, {} at equal t_d/p_d, {} at equal t_s/p_s",
                               percent(by_energy), percent(by_dynamic), percent(by_static));
  order.figures = {{"energy", 100 * by_energy, "%"},
                   {"t_d/p_d", 100 * by_dynamic, "%"},
                   {"t_s/p_s", 100 * by_static, "%"}};
  order.holds = by_energy < by_dynamic && by_energy < by_static;
  return {fit, order};
}

// C19b

/// For each point whether it lies on a stretch of at most fall_length_m from whose first to whose last point
/// V_tip falls by more than fall_share.
std::vector<bool> where_speed_falls(std::span<const FrontPoint> points) {
  std::vector<bool> falls(points.size(), false);
  for (std::size_t a = 0; a < points.size(); ++a)
    for (std::size_t b = a + 1;
         b < points.size() && within(std::abs(points[b].x_m - points[a].x_m), fall_length_m); ++b)
      if (points[b].v_tip_m_per_s < (1 - fall_share) * points[a].v_tip_m_per_s)
        std::fill(falls.begin() + static_cast<std::ptrdiff_t>(a),
                  falls.begin() + static_cast<std::ptrdiff_t>(b) + 1, true);
  return falls;
}

Claim points_outside_the_band(std::span<const MainFront> mains, std::span<const Claim> first) {
  Claim row = second_test(
      first, "C19", "rapid deceleration is a matter of speed, not of a fixed distance from the arrest",
      fmt::format("of the main fronts' points outside the band at least {} lie in the last {:g} mm before a "
                  "front's end, or on a stretch of at most {:g} mm along which V_tip falls by more than {}",
                  percent(wanted_share_near_end), tail_m * mm, fall_length_m * mm, percent(fall_share)));
  int all = 0, outside = 0, near_end = 0, falling = 0, explained = 0;
  for (const auto& m : mains) {
    const auto falls = where_speed_falls(m.points);
    for (std::size_t k = 0; k < m.points.size(); ++k) {
      const FrontPoint& p = m.points[k];
      const double rise = criterion_value(p, Criterion::energy_rise);
      if (!std::isfinite(p.v_tip_m_per_s) || !std::isfinite(rise)) continue;
      ++all;
      if (in_paper_band(rise, p.v_tip_m_per_s / m.outcome->speeds.c_L)) continue;
      ++outside;
      near_end += in_tail(m, p);
      falling += falls[k];
      explained += in_tail(m, p) || falls[k];
    }
  }
  row.measured = "no points";
  if (all == 0) return row;
  row.measured =
      outside == 0
          ? fmt::format("none of {} points outside", all)
          : fmt::format(
                "{} of the {} points outside the band ({} near an end, {} where V_tip falls), of {} in all",
                percent(double(explained) / outside), outside, near_end, falling, all);
  row.figures = {{"points outside", double(outside), ""},
                 {"near an end", double(near_end), ""},
                 {"where V_tip falls", double(falling), ""}};
  if (outside > 0) row.figures.push_back({"share", 100.0 * explained / outside, "%"});
  row.holds = explained >= wanted_share_near_end * outside;
  return row;
}

// C20b

Claim trend_of_crack_share(const Reproduction& runs, std::span<const Claim> first) {
  Claim row = second_test(
      first, "C20",
      "the paper tells a tendency, which one step against it does not refute; and behind a trigger that is "
      "held the interface slips whatever mu_k",
      fmt::format(
          "spontaneous events: rank correlation of mu_k with the share of crack-like path at most {}; "
          "each kind occurs over the study",
          -min_correlation));
  const auto* study = find_study(runs, "mu_k");
  row.measured = "not tested: no studies";
  if (study == nullptr) return row;
  std::vector<double> mu_k, shares;
  std::array<int, 3> total = {0, 0, 0};
  std::string text;
  for (std::size_t k = 0; k < study->outcomes.size(); ++k) {
    const auto& point = study->study.points[k];
    const auto every = count_kinds(study->outcomes[k], false);
    for (int kind = 0; kind < 3; ++kind) total[kind] += every[kind];
    const auto n = count_kinds(study->outcomes[k], true);
    const int sum = n[0] + n[1] + n[2];
    if (sum == 0) continue;
    mu_k.push_back(point.number);
    shares.push_back(double(n[0]) / sum);
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", point.value, percent(shares.back()));
    row.figures.push_back({point.value, 100 * shares.back(), "%"});
  }
  if (shares.size() < 3) {
    row.measured = "not tested: fronts at fewer than 3 values of mu_k";
    row.figures.clear();
    return row;
  }
  const double trend = fronts::rank_correlation(mu_k, shares);
  const int sum = total[0] + total[1] + total[2];
  row.measured = fmt::format(
      "{} (share of crack-like path at mu_k = {}); of the study's path: crack {}, pulse {}, mixed {}",
      std::isfinite(trend) ? fmt::format("rank correlation {:.2f}", trend) : "the same share throughout",
      text, percent(double(total[0]) / sum), percent(double(total[1]) / sum),
      percent(double(total[2]) / sum));
  row.figures.insert(row.figures.end(), {{"rank correlation", trend, ""},
                                         {"crack", 100.0 * total[0] / sum, "%"},
                                         {"pulse", 100.0 * total[1] / sum, "%"},
                                         {"mixed", 100.0 * total[2] / sum, "%"}});
  row.holds = trend <= -min_correlation && std::ranges::min(total) > 0;
  return row;
}

// C22b

/// Relative drop of V_tip from one front to another at the same nodes: medians over parts of the stretch that
/// both cover. NaN where a part has no node at which both have a speed.
struct Drops {
  double initiation = nan;  ///< the first initiation_m
  double middle = nan;      ///< the middle third
  double arrest = nan;      ///< the last arrest_m before the slower front's end
};

/// @pre both run in one direction, on one mesh
Drops drops_at_equal_x(const Front& fast, const Front& slow) {
  const auto along = [&](const FrontPoint& p) { return slow.direction * p.x_m; };
  const double begin = std::max(along(fast.points.front()), along(slow.points.front()));
  const double end = std::min(along(fast.points.back()), along(slow.points.back()));
  std::map<int, double> fast_speeds;
  for (const auto& p : fast.points)
    if (std::isfinite(p.v_tip_m_per_s)) fast_speeds[p.node] = p.v_tip_m_per_s;
  std::vector<double> initiation, middle, arrest;
  for (const auto& p : slow.points) {
    const auto other = fast_speeds.find(p.node);
    const double s = along(p) - begin, length = end - begin;
    if (other == fast_speeds.end() || !std::isfinite(p.v_tip_m_per_s) || s < 0 || s > length) continue;
    const double drop = 1 - p.v_tip_m_per_s / other->second;
    if (within(s, initiation_m)) initiation.push_back(drop);
    if (s >= length / 3 && s <= 2 * length / 3) middle.push_back(drop);
    if (within(along(slow.points.back()) - along(p), arrest_m)) arrest.push_back(drop);
  }
  return {fronts::median(initiation), fronts::median(middle), fronts::median(arrest)};
}

const Outcome* spontaneous_event(std::span<const Outcome> outcomes) {
  const auto found = std::ranges::find(outcomes, interface::EventKind::spontaneous,
                                       [](const Outcome& o) { return o.config.event; });
  return found == outcomes.end() ? nullptr : &*found;
}

/// Mean V_tip/c_L over both fronts of a spontaneous event; NaN without points.
double mean_speed(const Outcome* o) {
  double sum = 0, n = 0;
  for (const int direction : {-1, 1}) {
    const Front* front = o != nullptr ? first_front(*o, direction) : nullptr;
    if (front == nullptr) continue;
    for (const auto* p : speed_points(*o, *front, near_nucleation_m)) {
      sum += p->v_tip_m_per_s / o->speeds.c_L;
      n += 1;
    }
  }
  return sum / n;
}

/// Mean speeds over alpha, in words and as figures. Whether they fall at every step.
bool state_mean_speeds(const StudyOutcome& alpha, Claim& row) {
  bool falls = true;
  double before = infinity;
  std::string text;
  for (std::size_t k = 0; k < alpha.outcomes.size(); ++k) {
    const double mean = mean_speed(spontaneous_event(alpha.outcomes[k]));
    const auto& value = alpha.study.points[k].value;
    text += fmt::format("{}{}: {}", text.empty() ? "mean V_tip/c_L at alpha = " : ", ", value,
                        std::isfinite(mean) ? fmt::format("{:.2f}", mean) : "no front");
    row.figures.push_back({value, mean, "c_L"});
    falls = falls && mean < before;
    before = mean;
  }
  append(row.measured, text);
  return falls;
}

/// The claim as a whole, and its two halves for comparison.
std::array<Claim, 3> drops_with_alpha(const Reproduction& runs, std::span<const Claim> first) {
  const char* why =
      "a slower front arrests earlier, so that the same fifth of two fronts' own paths lies at different "
      "stresses";
  const auto compared = fmt::format(
      "spontaneous, from the least to the largest alpha, at equal x on the stretch that both "
      "fronts cover, in each direction: the median relative drop of V_tip is larger ");
  const auto at_initiation = fmt::format("in the first {:g} mm", initiation_m * mm),
             at_arrest = fmt::format("in the last {:g} mm before the slower front's end", arrest_m * mm);
  Claim whole = second_test(first, "C22", why,
                            fmt::format("{}{} and {} than in the middle third; mean V_tip falls at every "
                                        "step of alpha",
                                        compared, at_initiation, at_arrest));
  const auto half = [&](const char* suffix, const char* claim, const std::string& where) {
    Claim row =
        second_test(first, "C22", why, fmt::format("{}{} than in the middle third", compared, where), suffix);
    row.claim = claim;
    row.second_test_of.clear();
    row.why.clear();
    return row;
  };
  Claim initiation = half("b1+", "higher alpha: slower, above all at initiation", at_initiation),
        arrest = half("b2+", "higher alpha: slower, above all at arrest", at_arrest);
  const auto not_tested = [&](const char* reason) {
    for (auto* row : {&whole, &initiation, &arrest}) {
      row->measured = reason;
      row->figures.clear();
    }
    return std::array{whole, initiation, arrest};
  };
  const auto* alpha = find_study(runs, "alpha");
  if (alpha == nullptr) return not_tested("not tested: no studies");
  const Outcome* least = spontaneous_event(alpha->outcomes.front());
  const Outcome* largest = spontaneous_event(alpha->outcomes.back());
  for (auto* row : {&whole, &initiation, &arrest}) row->measured.clear();
  bool first_drops = true, last_drops = true;
  for (const auto& [direction, name] : {std::pair{-1, "against"}, {1, "along"}}) {
    const Front* fast = least != nullptr ? first_front(*least, direction) : nullptr;
    const Front* slow = largest != nullptr ? first_front(*largest, direction) : nullptr;
    if (fast == nullptr || slow == nullptr) return not_tested("not tested: no fronts to compare");
    const Drops drops = drops_at_equal_x(*fast, *slow);
    first_drops = first_drops && drops.initiation > drops.middle;
    last_drops = last_drops && drops.arrest > drops.middle;
    const auto state = [&, name = name](Claim& row, bool with_first, bool with_last) {
      const auto part = [&](const char* figure_name, double drop, const std::string& where) {
        row.measured += fmt::format("{} {}", row.measured.ends_with(':') ? "" : ",", percent(drop)) + where;
        row.figures.push_back({std::string(name) + " " + figure_name, 100 * drop, "%"});
      };
      append(row.measured, fmt::format("drop {} the shear:", name));
      if (with_first)
        part("first", drops.initiation, fmt::format(" in the first {:g} mm", initiation_m * mm));
      part("middle", drops.middle, " in the middle third");
      if (with_last) part("last", drops.arrest, fmt::format(" in the last {:g} mm", arrest_m * mm));
    };
    state(whole, true, true);
    state(initiation, true, false);
    state(arrest, false, true);
  }
  const bool falls = state_mean_speeds(*alpha, whole);
  whole.holds = falls && first_drops && last_drops;
  initiation.holds = first_drops;
  arrest.holds = last_drops;
  return {whole, initiation, arrest};
}

}  // namespace

bool is_first_test(const Claim& claim) {
  return claim.second_test_of.empty() && !claim.id.ends_with('+');
}

std::vector<Claim> second_tests(const Reproduction& runs, std::span<const Claim> first) {
  const std::array<const Outcome*, 3> three = {&runs.spontaneous, &runs.left, &runs.right};
  const auto mains = main_fronts(three);
  std::vector<Claim> rows = {trigger_choice(runs.triggers, first)};
  std::ranges::move(collapse_of_main_fronts(mains, first), std::back_inserter(rows));
  rows.push_back(points_outside_the_band(mains, first));
  rows.push_back(trend_of_crack_share(runs, first));
  std::ranges::move(drops_with_alpha(runs, first), std::back_inserter(rows));
  return rows;
}

void choose_verdicts(std::span<Claim> claims) {
  for (auto& claim : claims) claim.counts = is_first_test(claim);
  for (auto& second : claims) {
    if (second.second_test_of.empty() || !second.holds) continue;
    auto& claim = *std::ranges::find(claims, second.second_test_of, &Claim::id);
    if (!claim.counts) continue;  // another second test counts already
    second.counts = true;
    claim.counts = false;
  }
}

}  // namespace slipfront::kammer2012
