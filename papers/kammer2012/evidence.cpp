// SPDX-License-Identifier: BSD-3-Clause
#include "papers/kammer2012/evidence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace slipfront::kammer2012 {

using fronts::Front;
using fronts::FrontPoint;

std::string percent(double share) {
  return fmt::format("{:.0f} %", 100 * share);
}

std::vector<const FrontPoint*> speed_points(const Outcome& outcome, const Front& front, double leave_out) {
  std::vector<const FrontPoint*> points;
  for (const auto& p : front.points)
    if (counts(outcome, front, p, leave_out) && std::isfinite(p.v_tip_m_per_s)) points.push_back(&p);
  return points;
}

bool in_paper_band(double energy_rise, double v_over_c_L) {
  const PaperFit paper;
  return energy_rise >= 0 && std::abs(v_over_c_L - paper(energy_rise)) <= paper.band;
}

std::string describe(const Collapse& c) {
  return fmt::format(
      "(a) rms {:.3f} c_L about a = {:.2f} [{:.2f}, {:.2f}], b = {:.2f} [{:.2f}, {:.2f}], "
      "c = {:.2f} [{:.2f}, {:.2f}]; (b) {} of {} points within the paper's band",
      c.fit.rms, c.fit.a.value, c.fit.a.low, c.fit.a.high, c.fit.b.value, c.fit.b.low, c.fit.b.high,
      c.fit.c.value, c.fit.c.low, c.fit.c.high, percent(c.share_in_paper_band), c.n_points);
}

std::vector<Figure> figures_of(const Collapse& c) {
  return {{"rms", c.fit.rms, "c_L"},
          {"a", c.fit.a.value, ""},
          {"b", c.fit.b.value, ""},
          {"c", c.fit.c.value, ""},
          {"within the band", 100 * c.share_in_paper_band, "%"}};
}

Kind kind_of(const Outcome& o, const FrontPoint& p) {
  if (p.slipping_share > o.config.fronts.crack_share) return Kind::crack;
  return p.slipping_share < o.config.fronts.pulse_share ? Kind::pulse : Kind::mixed;
}

std::array<int, 3> count_kinds(std::span<const Outcome> outcomes, bool spontaneous_only) {
  std::array<int, 3> n = {0, 0, 0};
  for (const auto& o : outcomes) {
    if (spontaneous_only && o.triggered()) continue;
    for (const auto& front : o.fronts)
      for (const auto& p : front.points)
        if (std::isfinite(p.slipping_share)) ++n[static_cast<int>(kind_of(o, p))];
  }
  return n;
}

const StudyOutcome* find_study(const Reproduction& runs, std::string_view name) {
  const auto found =
      std::ranges::find(runs.studies, name, [](const StudyOutcome& s) { return s.study.name; });
  return found == runs.studies.end() ? nullptr : &*found;
}

}  // namespace slipfront::kammer2012
