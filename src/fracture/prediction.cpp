// SPDX-License-Identifier: BSD-3-Clause
#include "fracture/prediction.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "fracture/static_crack.hpp"

namespace slipfront::fracture {

namespace {

constexpr int speeds_in_table = 400;
/// Tips that differ by less differ by rounding: neither comes first.
constexpr double rounding = 1e-9;

/// The tip of a front on its way to the next node.
struct Tip {
  PredictedFront front;
  double share = infinity;  ///< of the fracture energy in G_static
  double v_m_per_s = 0;
  double way_m = 0;  ///< left to the next node

  int side() const { return front.direction; }
};

class Growth {
 public:
  Growth(const SlipResponse& response, const CrackLoads& loads, const std::vector<double>& fracture_energy,
         std::size_t first, std::size_t last, const SpeedLaw& law)
      : x_m_(response.x_m),
        fracture_energy_(fracture_energy),
        law_(law),
        crack_(response, loads),
        spacing_m_(response.spacing_m()) {
    crack_.begin(first);
    while (crack_.next(1) <= static_cast<std::ptrdiff_t>(last)) crack_.release(1);
    for (const int side : {-1, 1}) {
      Tip tip;
      tip.front.direction = side;
      tip.way_m = spacing_m_;
      tips_[side > 0] = tip;
    }
    look();
  }

  Prediction run() {
    Prediction p;
    p.first_length_m = length_m();
    p.starts = runs();
    while (!runs() && has_next()) release_nearer();
    if (!runs()) return p;
    p.critical_length_m = length_m();
    while (runs()) step();
    for (auto& tip : tips_) {
      if (crack_.has_next(tip.side()))
        tip.front.points.push_back(point(tip, nan));
      else
        tip.front.end = PredictedEnd::contact_end;
      if (!tip.front.points.empty()) p.fronts.push_back(std::move(tip.front));
    }
    return p;
  }

 private:
  bool has_next() const { return crack_.has_next(-1) || crack_.has_next(1); }
  bool runs() const { return tips_[0].v_m_per_s > 0 || tips_[1].v_m_per_s > 0; }
  double length_m() const { return spacing_m_ * static_cast<double>(crack_.next(1) - crack_.next(-1) - 1); }
  /// At the energy release rates of the crack as it is.
  void look() {
    for (auto& tip : tips_) {
      tip.share = infinity;
      tip.v_m_per_s = 0;
      if (!crack_.has_next(tip.side())) continue;
      const double G = crack_.energy_release_rate_J_per_m2(tip.side());
      tip.share = G > 0 ? fracture_energy_[static_cast<std::size_t>(crack_.next(tip.side()))] / G : infinity;
      tip.v_m_per_s = law_.speed_m_per_s(tip.share);
    }
  }
  PredictedPoint point(const Tip& tip, double time_s) const {
    const auto node = static_cast<std::size_t>(crack_.next(tip.side()));
    return {x_m_[node],
            length_m() + 0.5 * spacing_m_,
            crack_.energy_release_rate_J_per_m2(tip.side()),
            fracture_energy_[node],
            tip.v_m_per_s,
            time_s,
            node};
  }
  /// The nodes beside the crack that are nearest to breaking.
  void release_nearer() {
    const double least = std::min(tips_[0].share, tips_[1].share);
    for (const auto& tip : tips_)
      if (crack_.has_next(tip.side()) && !(tip.share > (1 + rounding) * least)) crack_.release(tip.side());
    look();
  }
  /// To the time at which the first of the tips is at its next node.
  void step() {
    const auto takes_s = [](const Tip& tip) {
      return tip.v_m_per_s > 0 ? tip.way_m / tip.v_m_per_s : infinity;
    };
    const std::array takes = {takes_s(tips_[0]), takes_s(tips_[1])};
    const double dt_s = std::min(takes[0], takes[1]);
    time_s_ += dt_s;
    std::array<bool, 2> arrives = {};
    for (const bool right : {false, true}) {
      auto& tip = tips_[right];
      arrives[right] = takes[right] <= (1 + rounding) * dt_s;
      if (arrives[right]) tip.front.points.push_back(point(tip, time_s_));
      tip.way_m = arrives[right] ? spacing_m_ : tip.way_m - dt_s * tip.v_m_per_s;
    }
    for (const bool right : {false, true})
      if (arrives[right]) crack_.release(tips_[right].side());
    look();
  }

  const std::vector<double>& x_m_;
  const std::vector<double>& fracture_energy_;
  const SpeedLaw& law_;
  StaticCrack crack_;
  double spacing_m_, time_s_ = 0;
  std::array<Tip, 2> tips_;  ///< to the left, to the right
};

}  // namespace

SpeedLaw::SpeedLaw(const Bodies& bodies) : limit_m_per_s_(limiting_speed_m_per_s(bodies)) {
  factor_.push_back(1);
  for (int k = 1; k < speeds_in_table; ++k)
    factor_.push_back(speed_factor(bodies, limit_m_per_s_ * k / speeds_in_table));
  factor_.push_back(speed_factor(bodies, limit_m_per_s_ * (1 - 1e-9)));  // above 0 on a rigid plane
}

double SpeedLaw::speed_m_per_s(double share) const {
  if (!(share < 1)) return 0;
  const auto above = std::ranges::lower_bound(factor_, share, std::greater{});
  if (above == factor_.end()) return limit_m_per_s_;
  const auto k = above - factor_.begin();
  const double part = (factor_[k - 1] - share) / (factor_[k - 1] - factor_[k]);
  return limit_m_per_s_ * (static_cast<double>(k) - 1 + part) / speeds_in_table;
}

Prediction predict(const SlipResponse& response, const CrackLoads& loads,
                   const std::vector<double>& fracture_energy_J_per_m2, std::size_t first, std::size_t last,
                   const SpeedLaw& law) {
  SLIPFRONT_ASSERT(first <= last && last < response.x_m.size(), "nodes of the first crack");
  return Growth(response, loads, fracture_energy_J_per_m2, first, last, law).run();
}

}  // namespace slipfront::fracture
