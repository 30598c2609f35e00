// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "interface/friction/velocity_weakening.hpp"
#include "papers/kammer2012/circle.hpp"
#include "papers/kammer2012/scorecard.hpp"

// Events made by formula instead of by computation: the speed, the static and dynamic stress ratio and the
// energy rise of every point are given, so that what each claim's test has to answer is known.
namespace slipfront::kammer2012::synthetic {

using interface::EventKind;

inline constexpr double peak_x_m = 0.145;
inline constexpr double contact_from_m = 0.008, contact_to_m = 0.196;
inline constexpr double spacing_m = 1e-3;
inline constexpr double pressure_Pa = 5e6;
inline constexpr double stored_J_per_m3 = 1e4;

/// t_s/p_s: greatest at peak_x_m, falling linearly to both sides.
inline double static_ratio(double x_m) {
  return 0.999 * 1.3 - 6 * std::abs(x_m - peak_x_m);
}

/// The same from about 0 at the left edge to 1 at the peak.
inline double shape(double x_m) {
  return (static_ratio(x_m) - 0.45) / 0.85;
}

/// The energy rise at which the paper's fit gives this speed. @pre 0.76 < v < 2.56
inline double energy_rise_for(double v_over_c_L) {
  const PaperFit fit;
  const double s = std::log(fit.b / (v_over_c_L - fit.a)) / fit.c;
  return s * s;
}

inline void set_energy_rise(fronts::FrontPoint& p, double rise) {
  p.U_s_J_per_m3 = stored_J_per_m3;
  p.U_r_J_per_m3 = stored_J_per_m3 * (1 + rise);
}

inline void set_dynamic_ratio(fronts::FrontPoint& p, double ratio) {
  p.p_d_Pa = pressure_Pa;
  p.t_d_Pa = ratio * pressure_Pa;
}

using Profile = std::function<double(double x_m)>;

/// A front with the given speed over c_L, crack-like; nothing is defined at its first point. The energy rise
/// is the paper's for that speed. At equal t_d/p_d it is `against` times faster against the shear and
/// `accelerating` times faster while it accelerates.
inline fronts::Front make_front(double from_m, double to_m, const Profile& v_over_c_L, double c_L,
                                double against = 1.1, double accelerating = 1.05) {
  fronts::Front front;
  front.direction = to_m > from_m ? 1 : -1;
  front.end = fronts::End::arrest;
  front.mode = fronts::SlipMode::crack;
  const int n = static_cast<int>(std::lround(std::abs(to_m - from_m) / spacing_m));
  double time_s = 0;
  for (int k = 0; k <= n; ++k) {
    fronts::FrontPoint p;
    p.node = k;
    p.x_m = from_m + front.direction * k * spacing_m;
    p.onset_s = time_s;
    const double v = v_over_c_L(p.x_m);
    time_s += spacing_m / (v * c_L);
    p.p_s_Pa = pressure_Pa;
    p.t_s_Pa = static_ratio(p.x_m) * pressure_Pa;
    if (k > 0) {
      p.v_tip_m_per_s = v * c_L;
      p.accelerating = v_over_c_L(p.x_m + front.direction * spacing_m) > v;
      const double faster = (front.direction < 0 ? against : 1.0) * (p.accelerating ? accelerating : 1.0);
      set_dynamic_ratio(p, v / (2 * faster));
      if (v > 0.77 && v < 2.55) set_energy_rise(p, energy_rise_for(v));
      p.slipping_share = 0.8;
    }
    front.points.push_back(p);
  }
  return front;
}

/// An event without fronts.
inline Outcome make_event(const std::string& name, EventKind kind, double mu_k = 0.6) {
  Outcome o;
  o.name = name;
  o.config.event = kind;
  o.config.friction.parameter("mu_k") = mu_k;
  o.speeds = run::wave_speeds(o.config.material);
  for (int k = 0; k <= 200; ++k) {
    const double x = k * spacing_m;
    o.common.x_m.push_back(x);
    o.common.p_s_Pa.push_back(pressure_Pa);
    o.common.t_s_Pa.push_back(static_ratio(x) * pressure_Pa);
  }
  o.contact_from_m = contact_from_m;
  o.contact_to_m = contact_to_m;
  o.inside_from_m = contact_from_m + 10e-3;
  o.inside_to_m = contact_to_m - 10e-3;
  o.peak_x_m = peak_x_m;
  o.first_onset_x_m = peak_x_m + 1e-3;
  o.critical_shear_m = 0.47e-3;
  o.ramp_critical_shear_m = nan;
  return o;
}

inline Profile linear(double base, double rise) {
  return [=](double x) { return base + rise * shape(x); };
}
inline Profile square(double base, double rise) {
  return [=](double x) { return base + rise * shape(x) * shape(x); };
}

/// The spontaneous event with fronts of these speeds to both sides.
inline Outcome make_spontaneous(const Profile& against = linear(0.8, 1.5),
                                const Profile& along = linear(0.8, 1.2), double to_left_m = 0.01,
                                double to_right_m = 0.194) {
  Outcome o = make_event("spontaneous", EventKind::spontaneous);
  o.fronts = {make_front(peak_x_m, to_left_m, against, o.speeds.c_L),
              make_front(peak_x_m, to_right_m, along, o.speeds.c_L)};
  return o;
}

inline Outcome make_left(const Profile& v) {
  Outcome o = make_event("left", EventKind::left);
  o.fronts = {make_front(contact_from_m, 0.194, v, o.speeds.c_L)};
  for (const double time_s : wave_times_s(o))
    for (const double angle_deg : {30.0, 45.0})
      o.waves.push_back({time_s, angle_deg, 0.95 * o.speeds.c_L * time_s, 2, 0.5});
  return o;
}

inline Outcome make_right(const Profile& v) {
  Outcome o = make_event("right", EventKind::right);
  o.fronts = {make_front(contact_to_m, 0.01, v, o.speeds.c_L)};
  return o;
}

/// From x = 80 to 50 mm the dynamic ratio rises while the speed goes on falling.
inline void let_ratio_rise(fronts::Front& front, double from_m = 0.08, double to_m = 0.05) {
  const int direction = front.direction;
  double at_begin = nan;
  for (auto& p : front.points) {
    const double into = direction * (p.x_m - from_m);
    if (into < -1e-9 || into > std::abs(to_m - from_m) + 1e-9) continue;
    if (std::isnan(at_begin)) at_begin = p.t_d_Pa / p.p_d_Pa;
    set_dynamic_ratio(p, at_begin + 8 * into);
  }
}

/// A share of every 20 neighbours is crack-like; the rest alternates between pulse-like and mixed.
inline void set_kinds(Outcome& o, double crack_share) {
  for (auto& front : o.fronts) {
    for (std::size_t k = 1; k < front.points.size(); ++k) {
      const auto place = static_cast<double>(k % 20) / 20;
      front.points[k].slipping_share = place < crack_share - 1e-9 ? 0.8 : k % 2 == 0 ? 0.1 : 0.35;
    }
  }
}

/// Study over mu_k of spontaneous events with these shares of crack-like path.
inline StudyOutcome make_mu_k_study(const std::vector<double>& crack_shares) {
  StudyOutcome result;
  result.study.name = "mu_k";
  result.study.key = "friction.mu_k";
  for (std::size_t k = 0; k < crack_shares.size(); ++k) {
    const double mu_k = 0.4 + 0.2 * static_cast<double>(k);
    result.study.points.push_back({fmt::format("{:g}", mu_k), mu_k, {}});
    Outcome o = make_spontaneous();
    set_kinds(o, crack_shares[k]);
    result.outcomes.push_back({o});
  }
  return result;
}

/// Study over alpha of spontaneous events; each speed is cut by drop[k] in the middle of the path and by
/// drop[k] times `ends` in its first and last fifth.
inline StudyOutcome make_alpha_study(const std::vector<double>& drop, double ends) {
  StudyOutcome result;
  result.study.name = "alpha";
  result.study.key = "friction.alpha_m2_per_s2";
  const double to_left_m = 0.01, to_right_m = 0.194;
  for (std::size_t k = 0; k < drop.size(); ++k) {
    result.study.points.push_back({fmt::format("{:g}", std::pow(10.0, k)), std::pow(10.0, k), {}});
    const auto slowed = [&](double rise, double to_m) {
      return [=, cut = drop[k]](double x) {
        const double part = std::abs(x - peak_x_m) / std::abs(to_m - peak_x_m);
        return (0.8 + rise * shape(x)) * (1 - cut * (part < 0.2 || part >= 0.8 ? ends : 1.0));
      };
    };
    result.outcomes.push_back(
        {make_spontaneous(slowed(1.5, to_left_m), slowed(1.2, to_right_m), to_left_m, to_right_m)});
  }
  return result;
}

inline void for_three(Reproduction& r,
                      const std::function<void(const Outcome&, fronts::Front&, fronts::FrontPoint&)>& f) {
  for (auto* o : {&r.spontaneous, &r.left, &r.right})
    for (auto& front : o->fronts)
      for (auto& p : front.points) f(*o, front, p);
}

/// All fronts may still run.
inline void leave_running(Reproduction& r) {
  for (auto* o : {&r.spontaneous, &r.left, &r.right})
    for (auto& front : o->fronts) front.end = fronts::End::record_end;
}

/// Runs for which every claim of the paper holds.
inline Reproduction make_good() {
  Reproduction r;
  r.spontaneous = make_spontaneous();
  let_ratio_rise(r.spontaneous.fronts[0]);
  r.left = make_left(square(0.8, 0.4));
  r.right = make_right(square(0.8, 1.6));
  r.spontaneous_mu_k_1 = make_event("spontaneous_mu_k_1.0", EventKind::spontaneous, 1.0);
  const double c_L = r.spontaneous_mu_k_1.speeds.c_L;
  r.spontaneous_mu_k_1.fronts = {make_front(peak_x_m, 0.115, linear(0.8, 1.0), c_L),
                                 make_front(peak_x_m, 0.194, linear(0.6, 0.75), c_L)};
  r.studies = {make_mu_k_study({0.9, 0.8, 0.6, 0.5, 0.3}), make_alpha_study({0, 0.02, 0.05}, 2)};
  r.loaded_on = {{1.3, 0.6, 0.8, 1}, {1.3, 1.0, 1.1, 9}};
  return r;
}

}  // namespace slipfront::kammer2012::synthetic
