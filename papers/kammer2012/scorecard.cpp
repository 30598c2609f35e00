// SPDX-License-Identifier: BSD-3-Clause
#include "papers/kammer2012/scorecard.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

#include "base/numbers.hpp"
#include "fronts/measures.hpp"
#include "papers/kammer2012/circle.hpp"
#include "papers/kammer2012/evidence.hpp"
#include "papers/kammer2012/second_tests.hpp"

namespace slipfront::kammer2012 {

namespace {

using fronts::Front;
using fronts::FrontPoint;

constexpr double min_spread = 0.2;  ///< of V_tip at equal t_s/p_s that leaves no unique one

std::string share(double part, double whole) {
  return whole > 0 ? percent(part / whole) : "no share";
}

/// Highest speed of a front over c_L and where; zero without points.
struct Peak {
  double v_over_c_L = 0, x_m = nan;
};
Peak peak_speed(const Outcome& o, const Front* front) {
  Peak peak;
  if (front == nullptr) return peak;
  for (const auto* p : speed_points(o, *front, near_nucleation_m))
    if (p->v_tip_m_per_s / o.speeds.c_L > peak.v_over_c_L) peak = {p->v_tip_m_per_s / o.speeds.c_L, p->x_m};
  return peak;
}

double max_speed(const Outcome& o) {
  double v = 0;
  for (const auto& front : o.fronts) v = std::max(v, peak_speed(o, &front).v_over_c_L);
  return v;
}

/// Length of the longest run of neighbouring points that satisfy a condition, over all fronts of a run.
double longest_stretch_m(const Outcome& o, double leave_out,
                         const std::function<bool(const FrontPoint&)>& condition) {
  double longest = 0;
  for (const auto& front : o.fronts) {
    double begin = nan;
    for (const auto& p : front.points) {
      const bool in = counts(o, front, p, leave_out) && std::isfinite(p.v_tip_m_per_s) && condition(p);
      if (!in) begin = nan;
      if (in && std::isnan(begin)) begin = p.x_m;
      if (in) longest = std::max(longest, std::abs(p.x_m - begin));
    }
  }
  return longest;
}

double speed_ratio_correlation(const Outcome& o, const Front* front) {
  if (front == nullptr) return nan;
  std::vector<double> x, y;
  for (const auto* p : speed_points(o, *front)) {
    x.push_back(p->t_s_Pa / p->p_s_Pa);
    y.push_back(p->v_tip_m_per_s);
  }
  return fronts::rank_correlation(x, y);
}

/// Speed over c_L against a criterion, of all points of the runs that a condition picks, as one series.
fronts::Series pick(std::span<const Outcome* const> outcomes, Criterion criterion,
                    const std::function<bool(const Front&, const FrontPoint&)>& condition) {
  fronts::Series series;
  for (const auto* o : outcomes) {
    for (const auto& front : o->fronts) {
      for (const auto* p : speed_points(*o, front)) {
        const double x = criterion_value(*p, criterion);
        if (!std::isfinite(x) || !condition(front, *p)) continue;
        series.x.push_back(x);
        series.y.push_back(p->v_tip_m_per_s / o->speeds.c_L);
      }
    }
  }
  return series;
}

class Scorecard {
 public:
  explicit Scorecard(const Reproduction& runs)
      : r_(runs), three_{&runs.spontaneous, &runs.left, &runs.right}, collapse_(collapse(three_)) {}

  std::vector<Claim> all() {
    wave_speeds();
    static_state();
    mu_k_1();
    speeds_of_events();
    criteria();
    energy();
    slip_modes();
    transition_parameter();
    longitudinal_wave();
    global_friction();
    wave_stands_apart();
    experiment();
    std::ranges::move(second_tests(r_, claims_), std::back_inserter(claims_));
    choose_verdicts(claims_);
    // A further test stands behind the one it goes with.
    std::ranges::stable_sort(
        claims_, {}, [](const Claim& c) { return c.id[0] == 'C' ? std::stoi(c.id.substr(1)) : 1000; });
    return std::move(claims_);
  }

 private:
  void add(const char* id, std::string claim, const char* paper, std::string measured,
           std::vector<Figure> figures, std::optional<bool> holds, std::string how) {
    claims_.push_back(
        {id, std::move(claim), paper, std::move(measured), holds, std::move(how), std::move(figures), {}});
  }

  void wave_speeds() {
    const auto& s = r_.spontaneous.speeds;
    constexpr double c_L = 1584, c_S = 890, within = 1;
    add("C1", fmt::format("c_L = {} m/s and c_S = {} m/s follow from E, nu, rho in plane stress", c_L, c_S),
        "Table 1", fmt::format("c_L = {:.1f} m/s, c_S = {:.1f} m/s", s.c_L, s.c_S),
        {{"c_L", s.c_L, "m/s"}, {"c_S", s.c_S, "m/s"}},
        std::abs(s.c_L - c_L) <= within && std::abs(s.c_S - c_S) <= within,
        fmt::format("each within {} m/s", within));
  }

  void static_state() {
    const auto& o = r_.spontaneous;
    const double w = o.config.plate.width_m;
    double least = infinity, most = 0;
    for (std::size_t k = 0; k < o.common.x_m.size(); ++k) {
      if (o.common.x_m[k] < o.inside_from_m || o.common.x_m[k] > o.inside_to_m) continue;
      const double ratio = o.common.t_s_Pa[k] / o.common.p_s_Pa[k];
      least = std::min(least, ratio);
      most = std::max(most, ratio);
    }
    const double from_edge = std::min(o.peak_x_m, w - o.peak_x_m);
    constexpr double far_over_w = 0.2, max_of_maximum = 0.6;
    add("C2", "t_s/p_s is nonuniform with its maximum far from the edges", "Set-up",
        fmt::format("maximum {:.1f} mm from the nearer edge, minimum inside {} of it", from_edge * mm,
                    percent(least / most)),
        {{"maximum", from_edge * mm, "mm"}, {"minimum", 100 * least / most, "%"}},
        from_edge > far_over_w * w && least < max_of_maximum * most,
        fmt::format("maximum more than {} w from both edges; minimum inside below {} of it", far_over_w,
                    max_of_maximum));
    nucleation_at_the_maximum(o);
  }

  void nucleation_at_the_maximum(const Outcome& o) {
    constexpr double within_m = 2e-3;
    const double off = std::abs(o.first_onset_x_m - o.peak_x_m);
    add("C3", "slip nucleates spontaneously at that maximum", "Set-up",
        fmt::format("first onset {:.2f} mm from it", off * mm), {{"distance", off * mm, "mm"}},
        off <= within_m,
        fmt::format("first onset inside within {:g} mm of it (of several at once, the farthest)",
                    within_m * mm));
  }

  void mu_k_1() {
    const auto& o = r_.spontaneous_mu_k_1;
    correlation_at_mu_k_1(o);
    asymmetry_at_mu_k_1(o);
    arrest_at_mu_k_1(main_front(o, -1));
  }

  void correlation_at_mu_k_1(const Outcome& o) {
    const double c_against = speed_ratio_correlation(o, main_front(o, -1)),
                 c_along = speed_ratio_correlation(o, main_front(o, 1));
    add("C4", "mu_k = 1.0: V_tip grows with t_s/p_s", "Fig. 2",
        fmt::format("rank correlation {:.2f} against the shear, {:.2f} along", c_against, c_along),
        {{"against", c_against, ""}, {"along", c_along, ""}},
        c_against > min_correlation && c_along > min_correlation,
        fmt::format("rank correlation above {} for each direction", min_correlation));
  }

  void asymmetry_at_mu_k_1(const Outcome& o) {
    constexpr double slower = 0.9;
    const std::array<const Outcome*, 1> one = {&o};
    const auto series = [&](int direction) {
      return pick(one, Criterion::static_ratio,
                  [direction](const Front& f, const FrontPoint&) { return f.direction == direction; });
    };
    const auto ratio = fronts::ratio_at_equal_x(series(1), series(-1), criterion_bins);
    add("C5", "mu_k = 1.0: the front along the shear is considerably slower", "Fig. 2",
        fmt::format("V along / V against = {:.2f} ({:.2f} to {:.2f} over {} bins)", ratio.median, ratio.low,
                    ratio.high, ratio.n_bins),
        {{"ratio", ratio.median, ""}}, ratio.median < slower,
        fmt::format("median over bins of t_s/p_s of V along / V against below {}", slower));
  }

  void arrest_at_mu_k_1(const Front* against) {
    constexpr double within_m = 50e-3, from_edge_m = 20e-3;
    const char* claim = "mu_k = 1.0: the front against the shear arrests not far from the initiation zone";
    const auto how = fmt::format("arrest within {:g} mm of nucleation, more than {:g} mm from the edge",
                                 within_m * mm, from_edge_m * mm);
    if (against == nullptr) {
      add("C6", claim, "Results", "no front against the shear", {}, false, how);
      return;
    }
    const double run = fronts::length_m(*against), edge = against->points.back().x_m;
    add("C6", claim, "Results",
        fmt::format("{} after {:.1f} mm, {:.1f} mm from the edge",
                    against->end == fronts::End::arrest ? "arrest" : name(against->end), run * mm, edge * mm),
        {{"length", run * mm, "mm"}, {"from the edge", edge * mm, "mm"}},
        against->end == fronts::End::arrest && run < within_m && edge > from_edge_m, how);
  }

  void speeds_of_events() {
    no_slow_fronts();
    fast_toward_both_edges();
    supersonic_fronts();
    edge_triggered_fronts();
    left_triggered_maximum();
  }

  void no_slow_fronts() {
    constexpr double slow_over_c_L = 0.1, longest_m = 10e-3;
    double slow = 0;
    bool all_run = true;
    for (const auto* o : {&r_.spontaneous, &r_.left, &r_.right, &r_.spontaneous_mu_k_1}) {
      all_run = all_run && !o->fronts.empty();
      slow = std::max(slow, longest_stretch_m(*o, 0, [&](const FrontPoint& p) {
                        return p.v_tip_m_per_s < slow_over_c_L * o->speeds.c_L;
                      }));
    }
    add("C7", "no slow fronts under this loading", "Results",
        fmt::format("longest stretch below {} c_L: {:.1f} mm{}", slow_over_c_L, slow * mm,
                    all_run ? "" : "; an event without a front"),
        {{"stretch", slow * mm, "mm"}}, all_run && slow <= longest_m,
        fmt::format("V_tip below {} c_L nowhere over more than {:g} mm, in all four events", slow_over_c_L,
                    longest_m * mm));
  }

  void fast_toward_both_edges() {
    const auto& s = r_.spontaneous;
    const double against = speed_ratio_correlation(s, main_front(s, -1)),
                 along = speed_ratio_correlation(s, main_front(s, 1));
    add("C8", "mu_k = 0.6, spontaneous: fast toward both edges, slower as t_s/p_s falls", "Fig. 3d",
        fmt::format("rank correlation {:.2f} against the shear, {:.2f} along", against, along),
        {{"against", against, ""}, {"along", along, ""}},
        against > min_correlation && along > min_correlation,
        fmt::format("rank correlation of V_tip and t_s/p_s above {}, both directions", min_correlation));
  }

  void supersonic_fronts() {
    constexpr double shortest_m = 10e-3;
    double fast = 0;
    for (const auto* o : three_)
      fast = std::max(fast, longest_stretch_m(*o, near_nucleation_m, [&](const FrontPoint& p) {
                        return p.v_tip_m_per_s > o->speeds.c_L;
                      }));
    add("C9", "supersonic fronts occur", "Results",
        fmt::format("longest stretch above c_L: {:.1f} mm", fast * mm), {{"stretch", fast * mm, "mm"}},
        fast >= shortest_m,
        fmt::format("V_tip above c_L over at least {:g} mm, {:g} mm next to spontaneous nucleation left out",
                    shortest_m * mm, near_nucleation_m * mm));
  }

  /// Mean speed over c_L of the points within a length of one of a front's ends.
  static double mean_near(const Outcome& o, std::span<const FrontPoint* const> points, double x_end_m,
                          double length_m) {
    double sum = 0;
    int n = 0;
    for (const auto* p : points)
      if (std::abs(p->x_m - x_end_m) <= length_m) sum += p->v_tip_m_per_s / o.speeds.c_L, ++n;
    return sum / n;
  }

  void edge_triggered_fronts() {
    constexpr double within_m = 10e-3, end_m = 10e-3, slower = 0.9;
    std::string text;
    std::vector<Figure> figures;
    bool holds = true;
    for (const auto* o : {&r_.left, &r_.right}) {
      const auto* front = main_front(*o, o->config.event == interface::EventKind::left ? 1 : -1);
      const auto points = front != nullptr ? speed_points(*o, *front) : std::vector<const FrontPoint*>{};
      if (points.empty()) {
        holds = false;
        text += fmt::format("{}{}: no front", text.empty() ? "" : "; ", o->name);
        continue;
      }
      const Peak peak = peak_speed(*o, front);
      const double first = mean_near(*o, points, points.front()->x_m, end_m) / peak.v_over_c_L,
                   last = mean_near(*o, points, points.back()->x_m, end_m) / peak.v_over_c_L;
      const double off = std::abs(peak.x_m - o->peak_x_m);
      holds = holds && off <= within_m && first < slower && last < slower;
      text += fmt::format(
          "{}{}: peak {:.2f} c_L {:.1f} mm from the maximum, first {:g} mm at {} and last at {} of it",
          text.empty() ? "" : "; ", o->name, peak.v_over_c_L, off * mm, end_m * mm, percent(first),
          percent(last));
      figures.insert(figures.end(), {{o->name + " peak", peak.v_over_c_L, "c_L"},
                                     {o->name + " from the maximum", off * mm, "mm"},
                                     {o->name + " first", 100 * first, "%"},
                                     {o->name + " last", 100 * last, "%"}});
    }
    add("C10", "edge-triggered fronts start slowly, accelerate, peak at the maximal t_s/p_s, decelerate",
        "Fig. 3d", text, figures, holds,
        fmt::format("peak within {:g} mm of the maximum; means of the first and last {:g} mm below {} of the "
                    "peak; trigger zone and margin left out",
                    within_m * mm, end_m * mm, slower));
  }

  void left_triggered_maximum() {
    const double left = max_speed(r_.left), spontaneous = max_speed(r_.spontaneous),
                 right = max_speed(r_.right);
    add("C11",
        fmt::format("the left-triggered maximum is at most {} of that of the other two",
                    percent(most_left_over_others)),
        "Results",
        fmt::format("left {:.2f}, spontaneous {:.2f}, right {:.2f} c_L: {} and {}", left, spontaneous, right,
                    share(left, spontaneous), share(left, right)),
        {{"left", left, "c_L"},
         {"spontaneous", spontaneous, "c_L"},
         {"right", right, "c_L"},
         {"left/spontaneous", spontaneous > 0 ? 100 * left / spontaneous : nan, "%"},
         {"left/right", right > 0 ? 100 * left / right : nan, "%"}},
        left > 0 && left <= most_left_over_others * spontaneous && left <= most_left_over_others * right,
        fmt::format("ratio of maxima to each at most {}; {:g} mm next to spontaneous nucleation, trigger "
                    "zones and margins left out",
                    most_left_over_others, near_nucleation_m * mm));
    claims_.back().used_to_choose = true;
  }

  void criteria() {
    spread_claims(
        "C12", "C14", [](const Collapse::Spreads& s) { return s.cases; },
        fmt::format("spread at equal t_s/p_s over the three cases above {}: (largest - smallest median of a "
                    "case) / mean of the medians, median over bins",
                    percent(min_spread)),
        "same measure as C12, smaller");
    spread_claims(
        "C12+", "C14+", [](const Collapse::Spreads& s) { return s.fronts; },
        "as C12 over all fronts of the three cases, each direction and each later front for itself",
        "same measure as C12+, smaller");
    distance_of_dynamic_ratio();
    faster_against_the_sliding();
    faster_when_accelerating();
    speed_falls_while_ratio_rises();
  }

  /// Spreads of V_tip at equal t_s/p_s (C12) and at equal t_d/p_d (C14).
  template <class Value>
  void spread_claims(const char* c12, const char* c14, Value value, std::string how12, const char* how14) {
    const fronts::Spread of_static = value(collapse_.static_ratio),
                         of_dynamic = value(collapse_.dynamic_ratio);
    const double by_energy = value(collapse_.energy_rise).median_relative;
    add(c12, "no unique V_tip for a given t_s/p_s", "Fig. 3d",
        fmt::format("median relative spread {} over {} bins", percent(of_static.median_relative),
                    of_static.n_bins),
        {{"spread", 100 * of_static.median_relative, "%"}}, of_static.median_relative > min_spread,
        std::move(how12));
    add(c14, "the spread of V_tip is smaller against t_d/p_d than against t_s/p_s", "Fig. 5",
        fmt::format(
            "median relative spread {} against t_d/p_d, {} against t_s/p_s ({} against the energy rise)",
            percent(of_dynamic.median_relative), percent(of_static.median_relative), percent(by_energy)),
        {{"t_d/p_d", 100 * of_dynamic.median_relative, "%"},
         {"t_s/p_s", 100 * of_static.median_relative, "%"},
         {"energy", 100 * by_energy, "%"}},
        of_dynamic.median_relative < of_static.median_relative, how14);
  }

  void distance_of_dynamic_ratio() {
    constexpr double far_over_mu_s = 0.9, min_difference = 0.1;
    double difference = 0, n = 0, below = 0;
    for (const auto* o : three_) {
      const double mu_s = interface::static_coefficient(o->config.friction);
      for (const auto& front : o->fronts) {
        for (const auto& p : front.points) {
          const double s = p.t_s_Pa / p.p_s_Pa, d = p.t_d_Pa / p.p_d_Pa;
          if (!counts(*o, front, p) || !std::isfinite(s) || !std::isfinite(d)) continue;  // no pressure
          difference += std::abs(d - s) / s;
          below += d < far_over_mu_s * mu_s ? 1 : 0;
          n += 1;
        }
      }
    }
    add("C13", "t_d/p_d differs significantly from t_s/p_s and is far from mu_s over most of the path",
        "Fig. 4",
        fmt::format("mean relative difference {}, below {} mu_s over {} of the path", percent(difference / n),
                    far_over_mu_s, percent(below / n)),
        {{"difference", 100 * difference / n, "%"}, {"below", 100 * below / n, "%"}},
        difference / n > min_difference && below / n > 0.5,
        fmt::format("mean relative difference above {}; below {} mu_s over more than half the path",
                    percent(min_difference), far_over_mu_s));
  }

  void faster_against_the_sliding() {
    const auto by_direction = [&](int direction) {
      return pick(three_, Criterion::dynamic_ratio,
                  [direction](const Front& f, const FrontPoint&) { return f.direction == direction; });
    };
    const auto ratio = fronts::ratio_at_equal_x(by_direction(-1), by_direction(1), criterion_bins);
    add("C15", "at equal t_d/p_d fronts against the sliding are faster", "Fig. 5",
        fmt::format("V against / V along = {:.2f} ({:.2f} to {:.2f} over {} bins)", ratio.median, ratio.low,
                    ratio.high, ratio.n_bins),
        {{"ratio", ratio.median, ""}}, ratio.median > 1,
        "median over bins of t_d/p_d above 1, the three cases together");
  }

  void faster_when_accelerating() {
    std::string text;
    std::vector<Figure> figures;
    bool holds = true;
    for (const auto* o : {&r_.left, &r_.right}) {
      const auto* main = main_front(*o, o->config.event == interface::EventKind::left ? 1 : -1);
      const std::array<const Outcome*, 1> one = {o};
      const auto branch = [&](bool accelerating) {
        return pick(one, Criterion::dynamic_ratio, [=](const Front& f, const FrontPoint& p) {
          return &f == main && p.accelerating == accelerating;
        });
      };
      const auto both = fronts::ratio_at_equal_x(branch(true), branch(false), criterion_bins);
      holds = holds && both.median > 1;
      text += fmt::format("{}{}: {:.2f} ({:.2f} to {:.2f} over {} bins)", text.empty() ? "" : "; ", o->name,
                          both.median, both.low, both.high, both.n_bins);
      figures.push_back({o->name, both.median, ""});
    }
    add("C16", "at equal t_d/p_d accelerating fronts are faster than decelerating ones", "Fig. 5", text,
        figures, holds, "V accelerating / V decelerating above 1 within each edge-triggered front");
  }

  void speed_falls_while_ratio_rises() {
    const fronts::StretchOptions options;
    std::array<double, 2> length = {0, 0};  // against, along
    std::array<int, 2> count = {0, 0};
    for (const auto* o : three_) {
      for (const auto& front : o->fronts) {
        Front counted = front;
        std::erase_if(counted.points, [&](const FrontPoint& p) { return !counts(*o, front, p); });
        for (const auto& stretch : fronts::speed_falls_ratio_rises(counted, options)) {
          length[front.direction > 0] = std::max(length[front.direction > 0], stretch.length_m);
          ++count[front.direction > 0];
        }
      }
    }
    add("C17", "V_tip drops while t_d/p_d rises only for fronts against the sliding", "Fig. 5",
        fmt::format("against: {} stretches, longest {:.1f} mm; along: {}, longest {:.1f} mm", count[0],
                    length[0] * mm, count[1], length[1] * mm),
        {{"stretches against", static_cast<double>(count[0]), ""},
         {"longest against", length[0] * mm, "mm"},
         {"stretches along", static_cast<double>(count[1]), ""},
         {"longest along", length[1] * mm, "mm"}},
        count[0] > 0 && count[1] == 0,
        fmt::format("stretches of at least {:g} mm: found against the sliding, none along it",
                    options.min_length_m * mm));
  }

  void collapse_claim(const char* id, const Collapse& c, std::string how) {
    const char* claim = "all three cases collapse against (U_r-U_s)/U_s on a + b exp(-c sqrt(.))";
    if (!c.fitted) {
      add(id, claim, "Fig. 6", "too few points for a fit", {}, std::nullopt, std::move(how));
      return;
    }
    add(id, claim, "Fig. 6", describe(c), figures_of(c),
        c.fit.rms <= PaperFit{}.band && c.share_in_paper_band >= wanted_share_in_band, std::move(how));
  }

  void energy() {
    const PaperFit paper;
    collapse_claim("C18", collapse_,
                   fmt::format("(a) rms about our own fit at most {0} c_L; (b) at least {1} of the points "
                               "within a = {2:.2f} +- {0}, b = {3:.2f}, c = {4:.2f}",
                               paper.band, percent(wanted_share_in_band), paper.a, paper.b, paper.c));
    collapse_claim("C18+", collapse(three_, true),
                   fmt::format("as C18 without the last {:g} mm before a front's end, which the paper sees "
                               "fall outside (C19)",
                               tail_m * mm));
    points_outside_the_band();
  }

  void points_outside_the_band() {
    int outside = 0, near_end = 0;
    for (const auto* o : three_) {
      for (const auto& front : o->fronts) {
        for (const auto* p : speed_points(*o, front)) {
          const double rise = criterion_value(*p, Criterion::energy_rise);
          if (!std::isfinite(rise) || in_paper_band(rise, p->v_tip_m_per_s / o->speeds.c_L)) continue;
          ++outside;
          near_end += in_tail(front, *p);
        }
      }
    }
    const char* claim = "points outside the band are fronts decelerating rapidly before arrest";
    const auto how = fmt::format("at least {} of them lie in the last {:g} mm before arrest",
                                 percent(wanted_share_near_end), tail_m * mm);
    if (collapse_.n_points == 0) {
      add("C19", claim, "Fig. 6", "no points", {}, std::nullopt, how);
      return;
    }
    add("C19", claim, "Fig. 6",
        outside == 0
            ? "no points outside"
            : fmt::format("{} of {} points outside the band", percent(double(near_end) / outside), outside),
        {{"share", outside > 0 ? 100.0 * near_end / outside : nan, "%"}},
        outside == 0 || near_end >= wanted_share_near_end * outside, how);
  }

  void crack_share_claim(const char* id, const StudyOutcome& mu_k, bool spontaneous_only, const char* how) {
    std::string text;
    std::vector<Figure> figures;
    std::array<int, 3> total = {0, 0, 0};
    bool falls = true;
    std::vector<double> shares;
    for (std::size_t k = 0; k < mu_k.outcomes.size(); ++k) {
      const auto n = count_kinds(mu_k.outcomes[k], spontaneous_only);
      const int sum = n[0] + n[1] + n[2];
      text += fmt::format("{}{}: {}", text.empty() ? "share of crack-like path at mu_k = " : ", ",
                          mu_k.study.points[k].value, sum > 0 ? percent(double(n[0]) / sum) : "no front");
      for (int j = 0; j < 3; ++j) total[j] += n[j];
      if (sum == 0) continue;
      figures.push_back({mu_k.study.points[k].value, 100.0 * n[0] / sum, "%"});
      falls = falls && (shares.empty() || double(n[0]) / sum <= shares.back());
      shares.push_back(double(n[0]) / sum);
    }
    const int sum = total[0] + total[1] + total[2];
    text += fmt::format("; of all: crack {}, pulse {}, mixed {}", percent(double(total[0]) / sum),
                        percent(double(total[1]) / sum), percent(double(total[2]) / sum));
    if (sum > 0)
      for (const auto& [kind, n] : {std::pair{"crack", total[0]}, {"pulse", total[1]}, {"mixed", total[2]}})
        figures.push_back({kind, 100.0 * n / sum, "%"});
    add(id, "larger mu_s - mu_k: crack-like; smaller: pulse-like; mixed modes exist", "Results", text,
        figures, falls && shares.size() > 1 && shares.back() < shares.front() && std::ranges::min(total) > 0,
        how);
  }

  /// Speeds against the energy rise by kind of slip: crack, pulse, mixed.
  static std::array<fronts::Series, 3> series_by_kind(std::span<const Outcome* const> outcomes) {
    std::array<fronts::Series, 3> kinds;
    for (const auto* o : outcomes) {
      for (int kind = 0; kind < 3; ++kind) {
        const auto part = pick({&o, 1}, Criterion::energy_rise, [&](const Front&, const FrontPoint& p) {
          return std::isfinite(p.slipping_share) && static_cast<int>(kind_of(*o, p)) == kind;
        });
        kinds[kind].x.insert(kinds[kind].x.end(), part.x.begin(), part.x.end());
        kinds[kind].y.insert(kinds[kind].y.end(), part.y.begin(), part.y.end());
      }
    }
    return kinds;
  }

  void slip_modes() {
    const char* how =
        "mu_k = 0.4 to 1.2, three events each: share of crack-like path falls at every step; each kind "
        "occurs";
    const auto* mu_k = find_study(r_, "mu_k");
    if (mu_k == nullptr) {
      add("C20", "larger mu_s - mu_k: crack-like; smaller: pulse-like; mixed modes exist", "Results",
          "not tested: no studies", {}, std::nullopt, how);
    } else {
      crack_share_claim("C20", *mu_k, false, how);
      crack_share_claim("C20+", *mu_k, true,
                        "as C20 for the spontaneous event alone: behind the right-hand trigger, which is "
                        "held, the interface slips whatever mu_k");
    }
    independence_of_slip_mode(mu_k);
  }

  void independence_of_slip_mode(const StudyOutcome* mu_k) {
    constexpr double max_over_c_L = 2 * PaperFit{}.band;
    const char* independent = "V_tip against the stress state does not depend on the type of slip";
    const auto how = fmt::format(
        "over the mu_k study: at equal (U_r-U_s)/U_s the largest difference of the kinds' medians, median "
        "over bins, below the band's full width, {:.2f} c_L",
        max_over_c_L);
    if (mu_k == nullptr) {
      add("C21", independent, "Results", "not tested: no studies", {}, std::nullopt, how);
      return;
    }
    const auto verdict = [&](const char* id, double difference, std::string text, std::string test) {
      const bool known = std::isfinite(difference);
      add(id, independent, "Results",
          known ? fmt::format("median difference between kinds {:.3f} c_L{}", difference, text)
                : "only one kind of slip",
          {{"difference", difference, "c_L"}},
          known ? std::optional(difference < max_over_c_L) : std::nullopt, std::move(test));
    };
    std::vector<const Outcome*> all;
    std::vector<double> differences;
    std::string each;
    for (std::size_t k = 0; k < mu_k->outcomes.size(); ++k) {
      std::vector<const Outcome*> one;
      for (const auto& o : mu_k->outcomes[k]) one.push_back(&o);
      all.insert(all.end(), one.begin(), one.end());
      const double difference = median_difference(series_by_kind(one));
      if (!std::isfinite(difference)) continue;
      differences.push_back(difference);
      each +=
          fmt::format("{}{}: {:.3f}", each.empty() ? " (" : ", ", mu_k->study.points[k].value, difference);
    }
    const auto kinds = series_by_kind(all);
    verdict("C21", median_difference(kinds),
            fmt::format(" ({} crack, {} pulse, {} mixed points)", kinds[0].x.size(), kinds[1].x.size(),
                        kinds[2].x.size()),
            how);
    verdict("C21+", fronts::median(differences), each.empty() ? "" : each + ")",
            "as C21 at one mu_k at a time, median over mu_k: the relation itself changes with mu_k");
    claims_.back().second_test_of = "C21";
    claims_.back().why =
        "the relation of speed and stress state changes with mu_k, whatever the kind of slip";
  }

  /// Median over bins of x of the largest difference of the series' medians of y, in bins that at least two
  /// reach.
  static double median_difference(std::span<const fronts::Series> kinds) {
    double low = infinity, high = -low;
    for (const auto& s : kinds)
      for (const double x : s.x) low = std::min(low, x), high = std::max(high, x);
    std::vector<double> differences;
    for (int bin = 0; bin < criterion_bins; ++bin) {
      std::vector<double> medians;
      for (const auto& s : kinds) {
        std::vector<double> y;
        for (std::size_t k = 0; k < s.x.size(); ++k)
          if (std::clamp(static_cast<int>((s.x[k] - low) / (high - low) * criterion_bins), 0,
                         criterion_bins - 1) == bin)
            y.push_back(s.y[k]);
        if (!y.empty()) medians.push_back(fronts::median(y));
      }
      if (medians.size() < 2) continue;
      const auto [least, most] = std::ranges::minmax(medians);
      differences.push_back(most - least);
    }
    return fronts::median(differences);
  }

  void transition_parameter() {
    const auto* alpha = find_study(r_, "alpha");
    const char* how =
        "alpha = 0.01 to 1 m2/s2, spontaneous: mean V_tip falls at every step; from least to largest alpha "
        "it drops more in the first and last "
        "fifth of the path than between";
    if (alpha == nullptr) {
      add("C22", "higher alpha: slower, above all at initiation and arrest", "Results",
          "not tested: no studies", {}, std::nullopt, how);
      return;
    }
    std::string text;
    std::vector<Figure> figures;
    std::vector<Fifths> fifths;
    std::vector<double> means;
    for (std::size_t k = 0; k < alpha->outcomes.size(); ++k) {
      const auto speeds = speeds_by_fifths(alpha->outcomes[k]);
      const auto& value = alpha->study.points[k].value;
      text += fmt::format("{}{}: {}", text.empty() ? "mean V_tip/c_L at alpha = " : ", ", value,
                          speeds ? fmt::format("{:.2f}", speeds->mean) : "no front");
      if (!speeds) continue;
      figures.push_back({value, speeds->mean, "c_L"});
      fifths.push_back(speeds->of_fifths);
      means.push_back(speeds->mean);
    }
    bool falls = means.size() > 1;
    for (std::size_t k = 1; k < means.size(); ++k) falls = falls && means[k] < means[k - 1];
    const bool ends = means.size() > 1 && drops_at_ends(fifths.front(), fifths.back(), text, figures);
    add("C22", "higher alpha: slower, above all at initiation and arrest", "Results", text, figures,
        falls && ends, how);
  }

  /// Mean speeds over c_L in fifths of the path.
  using Fifths = std::array<double, 5>;
  struct SpeedsByFifths {
    Fifths of_fifths;
    double mean;  ///< over all points
  };

  /// Over both fronts of the spontaneous event; none without points.
  static std::optional<SpeedsByFifths> speeds_by_fifths(std::span<const Outcome> outcomes) {
    Fifths sum{}, n{};
    for (const auto& o : outcomes) {
      if (o.config.event != interface::EventKind::spontaneous) continue;
      for (const int direction : {-1, 1}) {
        const auto* front = main_front(o, direction);
        if (front == nullptr) continue;
        for (const auto* p : speed_points(o, *front, near_nucleation_m)) {
          const double s = std::abs(p->x_m - front->points.front().x_m) / fronts::length_m(*front);
          const int fifth = std::min(4, static_cast<int>(5 * s));
          sum[fifth] += p->v_tip_m_per_s / o.speeds.c_L;
          n[fifth] += 1;
        }
      }
    }
    double total = 0, points = 0;
    for (int j = 0; j < 5; ++j) total += sum[j], points += n[j], sum[j] /= n[j];
    if (points == 0) return std::nullopt;
    return SpeedsByFifths{sum, total / points};
  }

  /// Whether the speed drops more in the first and in the last fifth than between; says by how much.
  static bool drops_at_ends(const Fifths& fast, const Fifths& slow, std::string& text,
                            std::vector<Figure>& figures) {
    Fifths drop{};
    for (int j = 0; j < 5; ++j) drop[j] = 1 - slow[j] / fast[j];
    const double middle = (drop[1] + drop[2] + drop[3]) / 3;
    text += fmt::format("; relative drop in the first fifth {}, between {}, in the last {}", percent(drop[0]),
                        percent(middle), percent(drop[4]));
    figures.insert(figures.end(), {{"first fifth", 100 * drop[0], "%"},
                                   {"between", 100 * middle, "%"},
                                   {"last fifth", 100 * drop[4], "%"}});
    return drop[0] > middle && drop[4] > middle;
  }

  void experiment() {
    const char* claim = "mu_k = 1.0 agrees quantitatively with the experiments";
    constexpr double max_deviation = 0.2, near_ratio = 0.02;
    const auto how = fmt::format(
        "only with a user's file of points: median over the points of |V - V_measured| / V_measured at most "
        "{}, V the median speed of the mu_k = 1.0 run within {} of the point's t_s/p_s",
        percent(max_deviation), near_ratio);
    if (!r_.experiment) {
      add("E1", claim, "Fig. 2", "not tested: no data", {}, std::nullopt, how);
      return;
    }
    const std::array<const Outcome*, 1> one = {&r_.spontaneous_mu_k_1};
    const auto ours =
        pick(one, Criterion::static_ratio, [](const Front&, const FrontPoint&) { return true; });
    std::vector<double> deviations;
    for (std::size_t k = 0; k < r_.experiment->static_ratio.size(); ++k) {
      std::vector<double> near;
      for (std::size_t j = 0; j < ours.x.size(); ++j)
        if (std::abs(ours.x[j] - r_.experiment->static_ratio[k]) <= near_ratio) near.push_back(ours.y[j]);
      if (!near.empty())
        deviations.push_back(std::abs(fronts::median(near) / r_.experiment->v_over_c_L[k] - 1));
    }
    const double deviation = fronts::median(deviations);
    add("E1", claim, "Fig. 2",
        fmt::format(
            "median relative deviation {} over the {} of {} points within the range of t_s/p_s of our fronts",
            percent(deviation), deviations.size(), r_.experiment->static_ratio.size()),
        {{"deviation", 100 * deviation, "%"}},
        deviations.empty() ? std::nullopt : std::optional(deviation <= max_deviation), how);
  }

  void longitudinal_wave() {
    const auto& o = r_.left;
    const auto* front = main_front(o, 1);
    double supershear = 0, behind = 0;
    double min_lag = infinity;
    if (front != nullptr) {
      const double source = o.contact_from_m + o.config.trigger.zone_m;
      for (const auto* p : speed_points(o, *front)) {
        if (p->v_tip_m_per_s <= o.speeds.c_S) continue;
        const double lag = source + o.speeds.c_L * p->onset_s - p->x_m;
        min_lag = std::min(min_lag, lag);
        supershear += 1;
        behind += lag > 0 ? 1 : 0;
      }
    }
    add("C23", "the super-shear tip follows the longitudinal wave front", "Fig. 3a",
        supershear > 0
            ? fmt::format(
                  "tip behind c_L (t - t_trigger) at {} of the super-shear points, by at least {:.1f} mm",
                  percent(behind / supershear), min_lag * mm)
            : "no super-shear points",
        supershear > 0 ? std::vector<Figure>{{"share", 100 * behind / supershear, "%"},
                                             {"least distance", min_lag * mm, "mm"}}
                       : std::vector<Figure>{},
        supershear > 0 && behind == supershear,
        "left-triggered: wherever V_tip exceeds c_S the tip is behind the wave from the trigger zone's inner "
        "end");
  }

  void global_friction() {
    constexpr double most_of_local = 0.9;
    std::string measured;
    std::vector<Figure> figures;
    bool holds = true;
    for (const auto& l : r_.loaded_on) {
      measured +=
          fmt::format("{}mu_k = {:g}: {:.3f}, {} of {:g}, after {} events", measured.empty() ? "" : "; ",
                      l.mu_k, l.largest_friction, percent(l.largest_friction / l.mu_s), l.mu_s, l.n_events);
      figures.push_back({fmt::format("mu_k = {:g}", l.mu_k), l.largest_friction, ""});
      holds = holds && l.largest_friction <= most_of_local * l.mu_s;
    }
    add("C24", "the local mu_s is considerably higher than the global static coefficient of friction",
        "Set-up", measured.empty() ? "not tested: no sequences" : measured, std::move(figures),
        measured.empty() ? std::nullopt : std::optional(holds),
        fmt::format(
            "the plate loaded on until all nodes inside slip in one event: largest F_S/F_N before it at "
            "most {:g} mu_s, for both mu_k",
            most_of_local));
  }

  void wave_stands_apart() {
    const auto wave = circle(r_.left);
    const char* claim = "the longitudinal wave of the left trigger is a light circle apart from what follows";
    const auto how = fmt::format(
        "snapshots every {:g} us while the left-triggered tip is between {:g} and {:g} mm, rays of 30 and 45 "
        "degrees from the left corner: in at least {} of the snapshots, on both rays, the outermost maximum "
        "of "
        "the velocity from {:g} m/s on lies within {} of c_L (t - t_trigger) from the trigger zone, and the "
        "lowest velocity behind it, before it is exceeded, is at most {:g} of it",
        wave_interval_s * 1e6, tip_from_m * mm, tip_to_m * mm, percent(min_share_of_snapshots),
        min_peak_m_per_s, percent(max_off_c_L_t), max_gap);
    if (!wave) {
      add("C25", claim, "Fig. 3a", "not tested: no snapshots", {}, std::nullopt, how);
      return;
    }
    add("C25", claim, "Fig. 3a",
        fmt::format(
            "in {} of {} snapshots; medians: {:.1f} m/s, at {:.2f} c_L (t - t_trigger), lowest behind "
            "{:.2f} of it",
            wave->n_apart, wave->n_snapshots, wave->peak_m_per_s, wave->over_c_L_t, wave->gap),
        {{"share", 100.0 * wave->n_apart / wave->n_snapshots, "%"},
         {"peak", wave->peak_m_per_s, "m/s"},
         {"lowest behind", wave->gap, ""}},
        wave->holds(), how);
    claims_.back().used_to_choose = true;
  }

  const Reproduction& r_;
  std::array<const Outcome*, 3> three_;
  Collapse collapse_;
  std::vector<Claim> claims_;
};

}  // namespace

std::vector<Claim> scorecard(const Reproduction& runs) {
  return Scorecard(runs).all();
}

void add_variation(std::vector<Claim>& claims, const Variation& variation, std::span<const Claim> varied) {
  for (auto& claim : claims) {
    const auto other = std::ranges::find(varied, claim.id, &Claim::id);
    if (other == varied.end()) continue;
    ClaimVariation result{variation.name, variation.key, variation.value, other->measured, other->holds, {}};
    for (const auto& figure : claim.figures) {
      const auto same = std::ranges::find(other->figures, figure.name, &Figure::name);
      result.differences.push_back(same == other->figures.end() ? nan : std::abs(same->value - figure.value));
    }
    claim.variations.push_back(std::move(result));
  }
}

std::string summary(std::span<const Claim> claims) {
  struct Verdicts {
    int n = 0, n_hold = 0, n_not = 0, n_open = 0, n_used = 0;
    void add(const Claim& c) {
      ++n;
      ++(!c.holds ? n_open : !*c.holds ? n_not : c.used_to_choose ? n_used : n_hold);
    }
    std::string text() const {
      return fmt::format("{} hold, {} do not, {} not tested{}", n_hold, n_not, n_open,
                         n_used > 0 ? fmt::format(", {} used to choose", n_used) : "");
    }
  } counted, first;
  for (const auto& c : claims) {
    if (!c.id.starts_with('C')) continue;
    if (c.counts) counted.add(c);
    if (is_first_test(c)) first.add(c);
  }
  return fmt::format(
      "Of the paper's {} claims {}, where second tests take the place of first ones; by the first tests "
      "alone {}.",
      counted.n, counted.text(), first.text());
}

std::string_view verdict(const Claim& claim) {
  if (!claim.holds) return "not tested";
  if (!*claim.holds) return "does not hold";
  return claim.used_to_choose ? "used to choose" : "holds";
}

std::string describe(const Claim& claim, const ClaimVariation& variation) {
  const auto difference = [](double d, const std::string& unit) {
    const std::string ending = unit.empty() ? "" : " " + unit;
    if (!std::isfinite(d)) return std::string("undefined");
    if (d > 0 && d < 1e-3) return "< 0.001" + ending;
    return (d < 10 ? fmt::format("{:.2g}", d) : fmt::format("{:.0f}", d)) + ending;
  };
  if (claim.holds && !variation.holds) return "not tested";
  std::string text;
  for (std::size_t k = 0; k < claim.figures.size(); ++k) {
    if (k > 0) text += ", ";
    if (claim.figures.size() > 1) text += claim.figures[k].name + ": ";
    text += difference(variation.differences[k], claim.figures[k].unit);
  }
  if (variation.holds != claim.holds)
    text += fmt::format("{}there {}", text.empty() ? "" : "; ", *variation.holds ? "holds" : "does not hold");
  return text;
}

}  // namespace slipfront::kammer2012
