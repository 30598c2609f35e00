// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fronts/front.hpp"
#include "motion/observers/onsets.hpp"
#include "motion/support.hpp"
#include "support/state.hpp"

namespace slipfront::motion {
namespace {

constexpr double static_mu = 0.5;
constexpr std::size_t n_nodes = 5;

/// Nodes 1 mm apart under p = 4 Pa, each at t/p = 0.25, half of static_mu.
statics::Equilibrium at_rest(std::size_t n = n_nodes, statics::Contact contact = statics::Contact::stick) {
  statics::Equilibrium e;
  for (std::size_t k = 0; k < n; ++k) e.tractions.x_m.push_back(1e-3 * static_cast<double>(k));
  e.tractions.t_s_Pa.assign(n, 1.0);
  e.tractions.p_s_Pa.assign(n, 4.0);
  e.contact.assign(n, contact);
  return e;
}

interface::Interface unchanged() {
  interface::Interface s(n_nodes);
  s.t_Pa.assign(n_nodes, 1.0);
  s.p_Pa.assign(n_nodes, 4.0);
  s.strength_Pa.assign(n_nodes, static_mu * 4.0);
  s.onset_ratio.assign(n_nodes, 1 / (static_mu * 4.0));
  return s;
}

void set(interface::Interface& s, std::size_t node, double trial, double t, double p, bool slips) {
  s.t_Pa[node] = t;
  s.p_Pa[node] = p;
  s.strength_Pa[node] = static_mu * p;
  s.onset_ratio[node] = p > 0 ? trial / (static_mu * p) : 0;
  s.slipping[node] = slips;
}

TEST(Recorder, LocatesTheOnsetInsideTheStep) {
  Recorder recorder(at_rest(), static_mu, 1);
  recorder.observe(0, unchanged(), false);
  recorder.observe(1, unchanged(), false);
  auto s = unchanged();
  // |t| / (static_mu p) goes from 0.5 to 2.5: through 1 after a quarter of the step from 1 s to 3 s.
  set(s, 2, 2.5 * static_mu * 8, 0.3 * 8, 8, true);
  set(s, 1, 3, 3, 12, false);
  set(s, 3, 1.8, 1.8, 3.6, false);
  recorder.observe(3, s, true);
  const auto record = recorder.record_until(4);
  ASSERT_EQ(record.onsets.size(), 1);
  EXPECT_EQ(record.onsets[0].node, 2);
  EXPECT_DOUBLE_EQ(record.onsets[0].time_s, 1.5);
  EXPECT_EQ(record.end_time_s, 4);
  EXPECT_EQ(record.x_m, at_rest().tractions.x_m);
  // Tractions interpolated to that time; at the node itself the strength static_mu p, not the weakened
  // traction.
  EXPECT_EQ(record.halo, 1);
  const auto around = record.around_onset(0);
  ASSERT_EQ(around.size(), 3);
  EXPECT_DOUBLE_EQ(around[0].t_Pa, 1.5);
  EXPECT_DOUBLE_EQ(around[0].p_Pa, 6);
  EXPECT_DOUBLE_EQ(around[1].t_Pa, static_mu * 5);
  EXPECT_DOUBLE_EQ(around[1].p_Pa, 5);
  EXPECT_DOUBLE_EQ(around[2].t_Pa, 1.2);
  EXPECT_DOUBLE_EQ(around[2].p_Pa, 3.9);
}

TEST(Recorder, HasNoTractionsBeyondTheEnds) {
  Recorder recorder(at_rest(), static_mu, 2);
  recorder.observe(0, unchanged(), false);
  auto s = unchanged();
  set(s, 1, 4, 2, 4, true);
  set(s, 4, 6, 2, 4, true);
  recorder.observe(1, s, true);
  const auto record = recorder.record_until(1);
  ASSERT_EQ(record.onsets.size(), 2);
  ASSERT_EQ(record.around.size(), 10);
  // The node at the right end passes its strength first (ratio to 3, against 2).
  EXPECT_EQ(record.onsets[0].node, 4);
  EXPECT_DOUBLE_EQ(record.onsets[0].time_s, 0.2);
  EXPECT_EQ(record.onsets[1].node, 1);
  EXPECT_DOUBLE_EQ(record.onsets[1].time_s, 1.0 / 3);
  const auto at_end = record.around_onset(0), near_start = record.around_onset(1);
  for (int k = 0; k < 5; ++k) {
    EXPECT_EQ(std::isnan(at_end[k].t_Pa), k > 2) << k;
    EXPECT_EQ(std::isnan(at_end[k].p_Pa), k > 2) << k;
    EXPECT_EQ(std::isnan(near_start[k].t_Pa), k < 1) << k;
  }
  // The halo went with its onset when they were put in order: both nodes slip at 2 of 4 Pa.
  EXPECT_DOUBLE_EQ(at_end[2].t_Pa, static_mu * 4);
  EXPECT_DOUBLE_EQ(near_start[2].t_Pa, static_mu * 4);
  EXPECT_DOUBLE_EQ(at_end[1].t_Pa, 1);
}

/// Node 2 between two observations 2 s apart.
record::SlipRecord record_of(const statics::Equilibrium& before, const interface::Interface& first,
                             const interface::Interface& second) {
  Recorder recorder(before, static_mu, 0);
  recorder.observe(0, first, false);
  recorder.observe(2, second, true);
  auto record = recorder.record_until(2);
  EXPECT_EQ(record.onsets.size(), 1);
  return record;
}

TEST(Recorder, KeepsTheSignOfTheTraction) {
  auto s = unchanged();
  set(s, 2, 6, -2, 4, true);
  EXPECT_DOUBLE_EQ(record_of(at_rest(), unchanged(), s).around_onset(0)[0].t_Pa, -static_mu * 4);
}

TEST(Recorder, ANodeThatWasNotPressedBeginsNow) {
  auto before = at_rest();
  before.contact[2] = statics::Contact::open;
  before.tractions.t_s_Pa[2] = before.tractions.p_s_Pa[2] = 0;
  auto first = unchanged(), second = unchanged();
  set(first, 2, 0, 0, 0, false);
  set(second, 2, 6, 2, 4, true);
  EXPECT_EQ(record_of(before, first, second).onsets[0].time_s, 2);
}

TEST(Recorder, TheOnsetIsWhereTheStrengthIsPassed) {
  // A strength that is not static_mu p: relaxed, or of a weakened node. It falls from 2 Pa to 1.6 Pa while
  // the trial traction rises from 1.6 Pa to 1.92 Pa: the ratio from 0.8 to 1.2, through 1 after half of the
  // step.
  auto first = unchanged(), second = unchanged();
  first.t_Pa[2] = 1.6;
  first.onset_ratio[2] = 0.8;
  set(second, 2, 1.92, 1.6, 4, true);
  second.strength_Pa[2] = 1.6;
  second.onset_ratio[2] = 1.2;
  const auto record = record_of(at_rest(), first, second);
  EXPECT_DOUBLE_EQ(record.onsets[0].time_s, 1);
  EXPECT_DOUBLE_EQ(record.around_onset(0)[0].t_Pa, 1.8);
  EXPECT_DOUBLE_EQ(record.around_onset(0)[0].p_Pa, 4);
}

TEST(Recorder, SlipInTheFirstUpdateBeginsAtTimeZero) {
  Recorder recorder(at_rest(), static_mu, 0);
  auto s = unchanged();
  set(s, 0, 6, 2, 4, true);
  recorder.observe(0, s, true);
  const auto record = recorder.record_until(1);
  ASSERT_EQ(record.onsets.size(), 1);
  EXPECT_EQ(record.onsets[0].time_s, 0);
}

TEST(Recorder, InitiallySlippingNodesHaveNoOnsetUntilTheySlipAnew) {
  auto before = at_rest();
  before.contact[2] = statics::Contact::slip;
  Recorder recorder(before, static_mu, 0);
  EXPECT_EQ(recorder.finder().n_slipping(), 1);
  auto s = unchanged();
  set(s, 2, 2, 2, 4, true);
  recorder.observe(0, s, false);
  set(s, 2, 1, 1, 4, false);
  recorder.observe(1, s, true);
  EXPECT_EQ(recorder.finder().n_slipping(), 0);
  set(s, 2, 3, 2, 4, true);
  recorder.observe(2, s, true);
  EXPECT_EQ(recorder.finder().n_slipping(), 1);
  recorder.observe(3, s, false);
  const auto record = recorder.record_until(3);
  ASSERT_EQ(record.stops.size(), 1);
  EXPECT_EQ(record.stops[0].node, 2);
  EXPECT_EQ(record.stops[0].time_s, 1);
  ASSERT_EQ(record.onsets.size(), 1);
  EXPECT_DOUBLE_EQ(record.onsets[0].time_s, 1.5);  // ratio from 0.5 to 1.5
}

TEST(Recorder, SeesTheMotionOfAnyNodeThatSlipsFasterThanCreep) {
  // More nodes than the vectors of the search hold, and a rest.
  constexpr std::size_t n = 19;
  for (std::size_t node = 0; node < n; ++node) {
    Recorder recorder(at_rest(n, statics::Contact::slip), static_mu, 0, 0.01);
    interface::Interface s(n);
    const double sign = node % 2 == 0 ? -1 : 1;
    s.slipping.assign(n, 1);
    s.slip_rate_m_per_s.assign(n, sign * 0.009);
    s.slipping[node] = 0;
    s.slip_rate_m_per_s[node] = 1;  // in the air
    recorder.observe(1, s, true);
    EXPECT_FALSE(recorder.seen().moves) << node;
    s.slipping[node] = 1;
    s.slip_rate_m_per_s[node] = sign * 0.011;
    recorder.observe(2, s, true);
    EXPECT_TRUE(recorder.seen().moves) << node;
    s.slip_rate_m_per_s[node] = sign * 0.009;
    recorder.observe(3, s, false);
    EXPECT_FALSE(recorder.seen().moves) << node;
  }
}

/// Keeps every beginning and end of slip, in the order in which they are seen.
class EveryChange {
 public:
  EveryChange(const statics::Equilibrium& before, int halo) : before_(before), halo_(halo) {
    record_.x_m = before.tractions.x_m;
    record_.halo = halo;
    for (const auto contact : before.contact) slipping_.push_back(contact == statics::Contact::slip);
  }

  void observe(double time_s, const interface::Interface& state) {
    for (std::size_t i = 0; i < state.size(); ++i) {
      if (state.slipping[i] == slipping_[i]) continue;
      slipping_[i] = state.slipping[i];
      if (state.slipping[i] != 0)
        add_onset(i, time_s, state);
      else
        record_.stops.push_back({static_cast<std::int32_t>(i), time_s});
    }
    record_.resolution_s = std::max(record_.resolution_s, time_s - time_s_);
    before_.tractions.t_s_Pa = state.t_Pa;
    before_.tractions.p_s_Pa = state.p_Pa;
    strength_Pa_ = state.strength_Pa;
    onset_ratio_ = state.onset_ratio;
    time_s_ = time_s;
  }

  record::SlipRecord record_until(double end_time_s) {
    record_.end_time_s = end_time_s;
    return record_;
  }

 private:
  /// A recorder that knows the last state and sees one node begin.
  void add_onset(std::size_t i, double time_s, interface::Interface state) {
    auto before = before_;
    before.contact.assign(state.size(), statics::Contact::stick);
    Recorder recorder(before, 0, halo_);
    interface::Interface last(state.size());
    last.t_Pa = before.tractions.t_s_Pa;
    last.p_Pa = before.tractions.p_s_Pa;
    last.strength_Pa = strength_Pa_;
    last.onset_ratio = onset_ratio_;
    recorder.observe(time_s_, last, false);
    state.slipping.assign(state.size(), 0);
    state.slipping[i] = 1;
    recorder.observe(time_s, state, true);
    const auto one = recorder.record_until(time_s);
    record_.onsets.push_back(one.onsets.at(0));
    record_.around.insert(record_.around.end(), one.around.begin(), one.around.end());
  }

  statics::Equilibrium before_;
  int halo_;
  record::SlipRecord record_;
  std::vector<std::uint8_t> slipping_;
  std::vector<double> strength_Pa_ = std::vector<double>(before_.tractions.x_m.size(), 0.0);
  std::vector<double> onset_ratio_ = strength_Pa_;
  double time_s_ = 0;
};

void expect_same(double a, double b) {
  EXPECT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << a << " and " << b;
}

void expect_same_fronts(const record::SlipRecord& a, const record::SlipRecord& b,
                        const record::StaticState& state, const fronts::FrontOptions& options) {
  const auto one = fronts::find_fronts(a, state, options), other = fronts::find_fronts(b, state, options);
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t f = 0; f < one.size(); ++f) {
    EXPECT_EQ(one[f].end, other[f].end);
    EXPECT_EQ(one[f].mode, other[f].mode);
    ASSERT_EQ(one[f].points.size(), other[f].points.size());
    for (std::size_t k = 0; k < one[f].points.size(); ++k) {
      const auto &p = one[f].points[k], &q = other[f].points[k];
      EXPECT_EQ(p.node, q.node);
      EXPECT_EQ(p.accelerating, q.accelerating);
      using P = fronts::FrontPoint;
      for (const auto value : {&P::onset_s, &P::v_tip_m_per_s, &P::t_d_Pa, &P::p_d_Pa, &P::t_r_Pa, &P::p_r_Pa,
                               &P::U_s_J_per_m3, &P::slipping_share})
        expect_same(p.*value, q.*value);
    }
  }
}

/// Nodes of a line that slip at random once a front has reached them, some of them before.
struct RandomSlip {
  explicit RandomSlip(std::uint64_t seed) : random(seed), state(n), before(make_before()) {
    state.t_Pa.assign(n, 1);
    state.p_Pa.assign(n, 4);
  }
  statics::Equilibrium make_before() {
    auto e = at_rest(n);
    for (std::size_t k = 0; k < n; ++k) {
      state.slipping[k] = random() > 0.9;
      if (state.slipping[k] != 0) e.contact[k] = statics::Contact::slip;
    }
    return e;
  }
  /// Onsets at the step's beginning, its end and in between.
  void advance(int step) {
    for (std::size_t k = 0; k < n; ++k) {
      state.strength_Pa[k] = 2;
      const bool reached = 3 * static_cast<int>(k) < step || random() > 0.999;
      if (reached) state.slipping[k] = random() > (step / 40 % 2 == 0 ? 0.2 : -0.6);
      const double ratio = random();
      state.t_Pa[k] = state.slipping[k] != 0 ? 2 : ratio > 0.5 ? 2 : 1 + ratio;
      state.onset_ratio[k] = (state.slipping[k] == 0 ? state.t_Pa[k] : ratio < -0.5 ? 2 : 3 + ratio) / 2;
    }
  }

  static constexpr std::size_t n = 60;
  Random random;
  interface::Interface state;
  statics::Equilibrium before;
};

TEST(Recorder, LeavesOutWhatNoFrontNeeds) {
  fronts::FrontOptions options;
  options.mu_s = static_mu;
  options.elasticity = {1e9, 0.3, false};
  options.l_star_m = 1e-3;
  options.arrest_time_s = 20;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    RandomSlip slip(seed);
    Recorder recorder(slip.before, static_mu, 2);
    EveryChange every(slip.before, 2);
    for (int step = 0; step < 2000; ++step) {
      slip.advance(step);
      recorder.observe(step, slip.state, true);
      every.observe(step, slip.state);
    }
    const auto record = recorder.record_until(2000), all = every.record_until(2000);
    EXPECT_EQ(record.n_onsets(), all.onsets.size());
    EXPECT_LT(10 * record.onsets.size(), all.onsets.size());
    EXPECT_LT(10 * record.stops.size(), all.stops.size());
    EXPECT_TRUE(std::ranges::is_sorted(record.onsets, {}, &record::Onset::time_s));
    EXPECT_TRUE(std::ranges::is_sorted(record.stops, {}, &record::Stop::time_s));
    expect_same_fronts(record, all, slip.before.tractions, options);
  }
}

TEST(Recorder, GoesOnFromWhatItHasWritten) {
  for (const int stop : {0, 100}) {
    RandomSlip slip(7);
    Recorder whole(slip.before, static_mu, 2), second(slip.before, static_mu, 2);
    for (int step = 0; step < 600; ++step) {
      if (step == stop) {
        test::copy_state(whole, second);
      }
      slip.advance(step);
      whole.observe(step, slip.state, true);
      if (step >= stop) second.observe(step, slip.state, true);
    }
    const auto of_whole = packed(whole.record_until(600)), of_second = packed(second.record_until(600));
    EXPECT_TRUE(std::ranges::equal(of_whole.bytes(), of_second.bytes()));
    EXPECT_EQ(whole.finder().n_slipping(), second.finder().n_slipping());
  }
}

}  // namespace
}  // namespace slipfront::motion
