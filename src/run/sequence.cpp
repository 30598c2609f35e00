// SPDX-License-Identifier: BSD-3-Clause
#include "run/sequence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/clock.hpp"
#include "base/error.hpp"
#include "boundary/boundary.hpp"
#include "fronts/fit.hpp"
#include "problem/contact.hpp"
#include "setup/event_loads.hpp"
#include "stability/verdict.hpp"

namespace slipfront::run {

namespace {

using record::LoadingPhase;
using record::LoadingRow;

/// Displacements of the plate at the interface relative to those of a base. [interface nodes]
struct Relative {
  std::vector<double> x_m, y_m;
};
Relative relative(const InitialState& initial, const statics::Equilibrium& state) {
  Relative u;
  for (std::size_t k = 0; k < initial.mesh.interface_nodes.size(); ++k) {
    const auto n = initial.mesh.interface_nodes[k];
    u.x_m.push_back(state.u_m.x[n]);
    u.y_m.push_back(state.u_m.y[n]);
    if (!initial.base) continue;
    const auto below = initial.base->interface_nodes[k];  // described upside down
    u.x_m.back() -= state.below_u_m.x[below];
    u.y_m.back() += state.below_u_m.y[below];
  }
  return u;
}

/// Adds the works between two equilibria to those of `sum`: by the mean of the forces at both, which is what
/// the strain energy changes by.
void add_works(const InitialState& initial, const statics::Equilibrium& from, const statics::Equilibrium& to,
               record::Energies& sum) {
  const auto u_from = relative(initial, from), u_to = relative(initial, to);
  double force_N_per_m = 0;
  for (std::size_t k = 0; k < initial.tributary_m.size(); ++k) {
    const double half_m = 0.5 * initial.tributary_m[k];
    const double t = half_m * (from.tractions.t_s_Pa[k] + to.tractions.t_s_Pa[k]);
    const double p = half_m * (from.tractions.p_s_Pa[k] + to.tractions.p_s_Pa[k]);
    force_N_per_m += t;
    sum.friction_work -= t * (u_to.x_m[k] - u_from.x_m[k]);
    sum.contact_work += p * (u_to.y_m[k] - u_from.y_m[k]);
  }
  sum.far_edge_work += force_N_per_m * (to.shear_m - from.shear_m);
}

void add_event_works(const record::Energies& of_event, record::Energies& sum) {
  for (const auto& term : record::energy_terms)
    if (term.kind == record::EnergyKind::work) sum.*term.member += of_event.*term.member;
}

}  // namespace

Sequence::Sequence(const Problem& problem, const motion::Monitor& monitor, const Processes& processes)
    : problem_(problem),
      path_(problem.path()),
      initial_(setup::unloaded_state(problem, processes)),
      statics_(setup::statics_of(problem_, initial_, [monitor] { return monitor(0, 0); })),
      plate_(
          solid::make_operator(initial_.mesh, problem.above().material,
                               boundary::make_boundary(initial_.mesh, problem.above().machine).edge_sets())),
      monitor_(monitor) {
  if (initial_.base) base_ = solid::make_operator(*initial_.base, problem.below().material);
  setup::describe_solver(problem, statics_, initial_);
  at_rest_ = statics_.tilted();
  if (problem.heals()) rest_.rests_since_s.assign(initial_.tributary_m.size(), 0);
  if (problem.friction.law.never_sticks())
    begin_slow_slip();
  else if (advice::has_fracture_energy(problem))
    predictor_.emplace(problem);
  loading_.push_back(row(LoadingPhase::tilted, 0, 0, at_rest_.tractions));
  add_state(at_rest_, loading_.back());
  n_rows_at_rest_ = loading_.size();
}

void Sequence::add_state(const statics::Equilibrium& state, LoadingRow& row) const {
  row.energies.strain = solid::strain_energy_J_per_m(plate_, state.u_m);
  if (base_) row.energies.strain += solid::strain_energy_J_per_m(*base_, state.below_u_m);
  row.energies.machine = statics_.machine_energy_J_per_m(state);
  row.shear_height_m = statics_.shear_height_m(state);
}

LoadingRow Sequence::row(LoadingPhase phase, double time_s, double shear_m,
                         const record::StaticState& tractions) const {
  LoadingRow row = loading_.empty() ? LoadingRow{} : loading_.back();
  row.phase = phase;
  row.n_events =
      static_cast<std::int32_t>(events_.size()) + (is_of_event(phase) ? 1 : 0);  // not yet among them
  row.shear_m = shear_m;
  row.time_s = time_s;
  row.energies.time_s = row.time_s;
  row.energies.kinetic = 0;
  row.fastest_slip_rate_m_per_s = 0;
  double normal = 0, shear = 0, moment = 0;
  for (std::size_t k = 0; k < initial_.tributary_m.size(); ++k) {
    const double p = tractions.p_s_Pa[k] * initial_.tributary_m[k];
    normal += p;
    shear += tractions.t_s_Pa[k] * initial_.tributary_m[k];
    moment += p * tractions.x_m[k];
  }
  row.normal_force_N_per_m = normal;
  row.shear_force_N_per_m = shear;
  row.shear_over_normal = shear / normal;
  row.normal_force_x_m = moment / normal;
  row.pressure_moment_N = moment - normal * 0.5 * (tractions.x_m.front() + tractions.x_m.back());
  row.shear_height_m = nan;
  return row;
}

std::string Sequence::end() const {
  const auto& sequence = problem_.sequence;
  if (std::ssize(events_) >= sequence.max_events)
    return fmt::format("sequence.max_events = {} was reached", sequence.max_events);
  if (sequence.to_global_sliding && !events_.empty() && events_.back().is_global != 0)
    return "all nodes inside have slipped in one event";
  return {};
}

void Sequence::require_stands(double time_s, double shear_m, const std::vector<double>& t_Pa,
                              const std::vector<double>& p_Pa) const {
  const auto& plate = problem_.above().plate;
  const auto& x_m = at_rest_.tractions.x_m;
  const auto at = fmt::format("{:.6g} s after normal loading, at a shear of {:.6g} m", time_s, shear_m);
  double force = 0, shear_force = 0, moment = 0, from_m = nan, to_m = nan;
  for (std::size_t k = 0; k < x_m.size(); ++k) {
    const double p = p_Pa[k] * initial_.tributary_m[k];
    force += p;
    shear_force += t_Pa[k] * initial_.tributary_m[k];
    moment += p * x_m[k];
    if (!(p > 0)) continue;
    if (std::isnan(from_m)) from_m = x_m[k];
    to_m = x_m[k];
  }
  const double acts_m = moment / force;
  // A pressure above 0 acts further inside, unless a single node bears it.
  const bool stands = force > 0 && std::min(acts_m - from_m, to_m - acts_m) > 0.5 * plate.element_size_m;
  if (!stands && plate.sides != mesh::Sides::periodic)
    throw UserError(
        "{} the plate tips: its normal force acts at the end of the contact, x = {:.4g} m; choose a "
        "lower {} or a larger {}",
        at, acts_m, Key("plate.height_m"), Key("plate.width_m"));
  const double most_m = std::max(plate.width_m, plate.height_m);
  const double stiffness_Pa = problem_.above().machine.shear_stiffness_Pa_per_m *
                              problem_.above().machine.moved_length_m(plate.width_m);
  const double edge_m = shear_m - rest_.shear_m - rest_.moved_m - shear_force / stiffness_Pa;
  if (std::isinf(path_.end_s()) && !(edge_m <= most_m))
    throw UserError(
        "{} no event has begun, and the loaded edge has moved by more than the plate's size, {:g} m: "
        "nothing brings one about; give {}, or choose other loads or friction",
        at, most_m, Key("sequence.end_s"));
}

void Sequence::load_to(LoadingPhase phase, const statics::Equilibrium& state) {
  const double time =
      phase == LoadingPhase::loaded ? std::max(path_.end_s(), rest_.time_s) : time_s(state.shear_m);
  require_stands(time, state.shear_m + rest_.moved_m, state.tractions.t_s_Pa, state.tractions.p_s_Pa);
  auto loaded = row(phase, time, state.shear_m + rest_.moved_m, state.tractions);
  add_works(initial_, at_rest_, state, loaded.energies);
  add_state(state, loaded);
  loading_.push_back(loaded);
}

void Sequence::begin_slow_slip() {
  const auto model = contact_model(problem_, mesh::interface_x_m(initial_.mesh));
  interface::QuasiDynamicFriction friction(model, initial_.tributary_m.size(),
                                           stability::radiation_damping_Pa_s_per_m(materials_of(problem_)));
  rest_ = {0, 0, 0, at_rest_.contact, relative(initial_, at_rest_).x_m, friction.initial_states(), {}};
  slow_ = std::make_unique<motion::QuasiDynamicSlip>(statics_, std::move(friction), initial_.tributary_m,
                                                     problem_.shear_speed_m_per_s);
}

const InitialState* Sequence::next(const SlowRows& slow_rows) {
  const auto start = Clock::now();
  if (!(slow_ ? slip_to_next(slow_rows) : stick_to_next())) return nullptr;
  initial_.cost.wall_s = seconds_since(start);
  u_begins_x_m_ = relative(initial_, initial_.supercritical).x_m;
  return &initial_;
}

void Sequence::heal_until(double time_s) {
  const auto& sequence = problem_.sequence;
  initial_.healed.clear();
  for (const double since_s : rest_.rests_since_s)
    initial_.healed.push_back(sequence.healing_per_e_fold *
                              std::log1p((time_s - since_s) / sequence.healing_time_s));
  const auto x_m = mesh::interface_x_m(initial_.mesh);
  statics_.set_mu_s(setup::strength_over_pressure(problem_, x_m, initial_.healed).at_all(x_m.size()),
                    "sequence.healing_per_e_fold");
}

void Sequence::heal_to_critical() {
  // From below: what mu_s has grown to at a shear is reached at a later one, until they meet.
  constexpr double accuracy = 1e-10;
  constexpr int most = 1000;
  const double end_m = path_.shear_m(path_.end_s()) - rest_.moved_m;
  double shear_m = at_rest_.shear_m;
  for (int i = 0; i < most && shear_m < end_m; ++i) {
    heal_until(time_s(shear_m));
    const double critical_m = statics_.shear_to(1).shear_m;
    if (critical_m - shear_m <= accuracy * std::abs(critical_m + rest_.moved_m)) return;
    shear_m = critical_m;
  }
  if (shear_m < end_m)
    throw UserError("{} heals the interface faster than the load grows; reduce it, or raise {}",
                    Key("sequence.healing_per_e_fold"), Key("loading.shear_speed_m_per_s"));
  heal_until(path_.end_s());
}

bool Sequence::stick_to_next() {
  if (problem_.heals()) heal_to_critical();
  const double margin = problem_.loading.critical_margin;
  // Where a share is passed at rest, there may be no shear that brings it about: a strength with a memory
  // leaves nodes beyond mu_s.
  const auto at_share = [&](double share) {
    if (!events_.empty() && statics_.share_of_strength(at_rest_) >= share) return at_rest_;
    auto state = statics_.shear_to(share);
    return state.shear_m > at_rest_.shear_m ? state : at_rest_;
  };
  auto critical = at_share(1);
  initial_.critical_shear_m = critical.shear_m + rest_.moved_m;
  initial_.subcritical = at_share(1 - margin);
  initial_.supercritical = at_share(1 + margin);
  // An event may last beyond the end: the load then goes on to where the path ends, at once.
  if (const double end_m = path_.shear_m(path_.end_s()) - rest_.moved_m;
      initial_.supercritical.shear_m > end_m) {
    load_to(LoadingPhase::loaded, statics_.shear_by(std::max(at_rest_.shear_m, end_m)));
    return false;
  }
  load_to(LoadingPhase::event_begins, initial_.supercritical);
  for (auto* state : {&critical, &initial_.subcritical, &initial_.supercritical})
    state->shear_m += rest_.moved_m;
  if (setup::has_forces(problem_))
    initial_.loads =
        setup::resolved_loads(problem_, statics_, critical, initial_.subcritical, initial_.tributary_m);
  return true;
}

statics::Equilibrium Sequence::slid_to(const motion::QuasiDynamicState& state,
                                       std::vector<double> u_x_per_shear) const {
  return statics_.slid_to(state.contact, state.u_x_m, std::move(u_x_per_shear), state.shear_m);
}

LoadingRow Sequence::slow_row(LoadingPhase phase, const LoadingRow& from) const {
  const auto& state = slow_->state();
  const auto& works = slow_->works();
  const auto equilibrium = slid_to(state, {});
  auto now = row(phase, state.time_s, state.shear_m + rest_.moved_m, equilibrium.tractions);
  now.energies = from.energies;
  now.energies.time_s = now.time_s;
  now.energies.kinetic = 0;
  add_state(equilibrium, now);
  now.energies.far_edge_work += works.of_load_J_per_m;
  now.energies.friction_work += works.of_friction_J_per_m;
  now.energies.contact_work += works.of_contact_J_per_m;
  now.wave_loss_J_per_m = from.wave_loss_J_per_m + works.radiated_J_per_m;
  now.fastest_slip_rate_m_per_s = state.fastest_m_per_s();
  return now;
}

void Sequence::begin_creep() {
  slow_->start(rest_.time_s, rest_.shear_m, rest_.contact, rest_.u_x_m, rest_.law_states);
  const auto& state = slow_->state();
  if (events_.empty() && state.fastest_m_per_s() >= inertia_slip_rate_m_per_s(problem_))
    throw UserError(
        "normal loading alone lets the interface slip at {:.3g} m/s, where an event begins; choose a larger "
        "{} or a smaller {}",
        state.fastest_m_per_s(), Key("friction.theta_i_s"), Key("friction.V_i_m_per_s"));
  creep_.emplace(*slow_, initial_.tributary_m);
}

bool Sequence::slip_to_next(const SlowRows& slow_rows) {
  if (!creep_) begin_creep();
  const auto from = loading_[n_rows_at_rest_ - 1];
  const auto& state = slow_->state();
  const auto u_tilted = relative(initial_, statics_.tilted());
  const auto give_row = [&] {
    if (!creep_->takes_row(state)) return;
    record::History row{
        {state.time_s}, at_rest_.tractions.x_m, state.u_x_m, state.slip_rate_m_per_s, state.t_Pa,
        state.p_Pa,     state.law_states};
    for (std::size_t k = 0; k < row.slip_m.size(); ++k) row.slip_m[k] += rest_.moved_m - u_tilted.x_m[k];
    slow_rows(row);
  };
  if (creep_->n_rows() == 0) give_row();
  const auto after_step = [&] {
    require_stands(state.time_s, state.shear_m + rest_.moved_m, state.t_Pa, state.p_Pa);
    if (std::isinf(path_.end_s()) && creep_->is_steady(*slow_))
      throw UserError(
          "{:.6g} s after normal loading the interface slips steadily, at {:.3g} m/s: no event comes; give "
          "{}, or a softer machine ({})",
          state.time_s, state.fastest_m_per_s(), Key("sequence.end_s"),
          Key("loading.shear_stiffness_Pa_per_m"));
    if (creep_->is_row_due(*slow_)) give_row();
    if (creep_->is_loading_row_due(state, initial_.tributary_m))
      loading_.push_back(slow_row(LoadingPhase::creep, from));
    if (!monitor_(0, 0))
      throw Interrupted(fmt::format("interrupted in slow slip, {:.6g} s after normal loading", state.time_s));
    return true;
  };
  bool begins = false;
  while (!begins && state.time_s < path_.end_s()) {
    slow_->set_edge_speed(path_.speed_m_per_s(state.time_s, state.shear_m + rest_.moved_m));
    begins =
        slow_->slip_until(path_.part_end_s(state.time_s), inertia_slip_rate_m_per_s(problem_), after_step);
  }
  give_row();
  creep_.reset();
  loading_.push_back(slow_row(begins ? LoadingPhase::event_begins : LoadingPhase::loaded, from));
  if (!begins) return false;
  std::vector<double> per_shear;
  for (const double V : state.slip_rate_m_per_s) per_shear.push_back(V / problem_.shear_speed_m_per_s);
  initial_.supercritical = slid_to(state, std::move(per_shear));
  initial_.supercritical.shear_m += rest_.moved_m;
  for (auto& contact : initial_.supercritical.contact)
    if (contact == statics::Contact::slip) contact = statics::Contact::stick;
  initial_.subcritical = initial_.supercritical;
  initial_.critical_shear_m = initial_.subcritical.shear_m;
  initial_.law_states = state.law_states;
  if (setup::has_forces(problem_))
    initial_.loads = setup::resolved_loads(problem_, statics_, initial_.subcritical, initial_.subcritical,
                                           initial_.tributary_m);
  return true;
}

void Sequence::record_event(const Result& result) {
  const auto& event = result.event;
  SLIPFRONT_ASSERT(event.end == motion::EventEnd::quiet, "the event has not come to rest");
  const auto begins = loading_.back();
  const auto& at_end = event.interface_at_end;
  const record::StaticState tractions_at_end{event.record.x_m, at_end.t_Pa, at_end.p_Pa};
  const double shear_m = begins.shear_m + shear_speed_in_event_m_per_s(problem_) * event.time_s;
  rest_.contact.clear();
  rest_.u_x_m.clear();
  double mean_m = 0;
  for (std::size_t k = 0; k < u_begins_x_m_.size(); ++k) {
    rest_.contact.push_back(at_end.p_Pa[k] > 0 ? statics::Contact::stick : statics::Contact::open);
    rest_.u_x_m.push_back(u_begins_x_m_[k] + at_end.slip_m[k]);
    mean_m += rest_.u_x_m.back() / static_cast<double>(u_begins_x_m_.size());
  }
  for (double& u_x_m : rest_.u_x_m) u_x_m -= mean_m;
  rest_.moved_m += mean_m;
  rest_.shear_m = shear_m - rest_.moved_m;
  rest_.time_s = begins.time_s + (shear_speed_in_event_m_per_s(problem_) > 0 ? event.time_s : 0);
  auto ends = row(LoadingPhase::slip_ends, rest_.time_s, shear_m, tractions_at_end);
  // Changes, since the strain energy of a motion belongs to half a step earlier.
  const auto &first = event.energies.front(), &last = event.energies.back();
  ends.energies.kinetic = last.kinetic;
  ends.energies.machine = begins.energies.machine + last.machine - first.machine;
  ends.energies.strain = begins.energies.stored() + last.stored() - first.stored() - last.kinetic;
  ends.energies.strain -= ends.energies.machine;
  add_event_works(last, ends.energies);
  loading_.push_back(ends);

  if (slow_) rest_.law_states = at_end.law_states;
  if (!rest_.rests_since_s.empty())
    for (const auto& onset : event.record.onsets) rest_.rests_since_s[onset.node] = rest_.time_s;
  equilibrate();
  require_stands(rest_.time_s, shear_m, at_rest_.tractions.t_s_Pa, at_rest_.tractions.p_s_Pa);
  auto rests = row(LoadingPhase::at_rest, rest_.time_s, shear_m, at_rest_.tractions);
  add_state(at_rest_, rests);
  rests.wave_loss_J_per_m += ends.energies.stored() - rests.energies.stored();
  for (std::size_t k = 0; slow_ && k < at_end.slip_rate_m_per_s.size(); ++k)
    if (at_end.p_Pa[k] > 0)
      rests.fastest_slip_rate_m_per_s =
          std::max(rests.fastest_slip_rate_m_per_s, std::abs(at_end.slip_rate_m_per_s[k]));
  loading_.push_back(rests);
  n_rows_at_rest_ = loading_.size();
  add_event(result, begins, rests, at_rest_.tractions);
  u_begins_x_m_.clear();
}

void Sequence::equilibrate() {
  if (slow_) {
    at_rest_ = statics_.slid_to(rest_.contact, rest_.u_x_m, {}, rest_.shear_m);
    return;
  }
  if (problem_.heals()) heal_until(rest_.time_s);
  statics_.hold(rest_.contact, rest_.u_x_m);
  at_rest_ = statics_.shear_by(rest_.shear_m);
}

void Sequence::add_event(const Result& result, const LoadingRow& before, const LoadingRow& after,
                         const record::StaticState& tractions_after) {
  const auto& record = result.event.record;
  const auto& state = initial_.supercritical;
  const auto is_inside = [&](std::int32_t node) { return state.is_inside(record.x_m[node]); };
  record::SequenceEvent e;
  e.begin_s = before.time_s;
  e.shear_m = before.shear_m;
  std::vector<bool> slips(record.x_m.size());
  std::vector<std::size_t> first;  // nodes that begin together
  double first_s = nan, last_s = nan;
  for (const auto& onset : record.onsets) {
    slips[onset.node] = true;
    if (!is_inside(onset.node)) continue;
    if (std::isnan(first_s)) first_s = onset.time_s;
    if (onset.time_s <= first_s + result.substep_s) first.push_back(static_cast<std::size_t>(onset.node));
  }
  if (!first.empty()) {
    // The first one along x where several patches begin.
    const auto begins = [&](std::size_t node) { return std::ranges::find(first, node) != first.end(); };
    auto from = first.front(), to = from;
    while (from > 0 && begins(from - 1)) --from;
    while (begins(to + 1)) ++to;
    e.begin_x_m = 0.5 * (record.x_m[from] + record.x_m[to]);
  }
  for (const auto& stop : record.stops)
    if (is_inside(stop.node)) last_s = stop.time_s;
  e.slip_s = last_s - first_s;
  e.is_global = 1;
  double drop_N_per_m = 0, patch_m = 0;
  for (std::size_t k = 0; k < slips.size(); ++k) {
    if (!slips[k]) {
      patch_m = 0;
      if (is_inside(static_cast<std::int32_t>(k))) e.is_global = 0;
      continue;
    }
    const double a = initial_.tributary_m[k], slip_m = result.event.interface_at_end.slip_m[k];
    e.from_x_m = std::isnan(e.from_x_m) ? record.x_m[k] : e.from_x_m;
    e.to_x_m = record.x_m[k];
    e.length_m += a;
    e.longest_patch_m = std::max(e.longest_patch_m, patch_m += a);
    e.potency_m2 += slip_m * a;
    e.max_slip_m = std::max(e.max_slip_m, slip_m);
    drop_N_per_m += a * (state.tractions.t_s_Pa[k] - tractions_after.t_s_Pa[k]);
  }
  e.breakdown_work_J_per_m = result.event.breakdown.total_work_J_per_m(initial_.tributary_m);
  e.nucleation_length_m = result.rupture.of_nodes.nucleation_length_m.value_or(nan);
  if (e.length_m > 0) {
    e.mean_slip_m = e.potency_m2 / e.length_m;
    e.stress_drop_Pa = drop_N_per_m / e.length_m;
  } else {
    e.is_global = 0;
  }
  e.normal_force_N_per_m = before.normal_force_N_per_m;
  e.shear_force_N_per_m = before.shear_force_N_per_m;
  e.friction_before = before.shear_over_normal;
  e.friction_after = after.shear_over_normal;
  e.released_J_per_m = before.energies.stored() - after.energies.stored();
  e.friction_work_J_per_m = -result.event.energies.back().friction_work;
  e.wave_loss_J_per_m = after.wave_loss_J_per_m - before.wave_loss_J_per_m;
  e.n_fronts = static_cast<double>(result.fronts.size());
  const auto longest =
      std::ranges::max_element(result.fronts, {}, [](const auto& f) { return f.points.size(); });
  if (longest != result.fronts.end()) {
    std::vector<double> speeds;
    for (const auto& point : longest->points) speeds.push_back(point.v_tip_m_per_s);
    e.median_speed_m_per_s = fronts::median(speeds);
  }
  if (!(e.longest_patch_m < e.nucleation_length_m)) predict(e);
  events_.push_back(e);
}

void Sequence::predict(record::SequenceEvent& event) {
  if (!predictor_) return;
  predictor_->set_healed(initial_.supercritical.tractions.x_m, initial_.healed);
  const auto p = predictor_->predict({}, initial_.supercritical.peak_x_m, &initial_.supercritical.tractions);
  for (const auto& front : p.of_fronts.fronts) {
    // The last node of a front that arrests is the one that it does not break.
    const std::size_t unbroken = front.arrests() ? 1 : 0;
    if (front.points.size() <= unbroken) continue;
    const double end_x_m = front.points[front.points.size() - 1 - unbroken].x_m;
    (front.direction < 0 ? event.predicted_from_x_m : event.predicted_to_x_m) = end_x_m;
  }
}

void Sequence::resume_event(const InitialState& initial) {
  for (auto member : {&InitialState::subcritical, &InitialState::supercritical})
    initial_.*member = initial.*member;
  initial_.critical_shear_m = initial.critical_shear_m;
  initial_.healed = initial.healed;
  initial_.law_states = initial.law_states;
  initial_.loads = initial.loads;
}

void Sequence::serialize(StateArchive& archive) {
  auto rows = loading_;
  bool is_creeping = creep_.has_value();
  if (!archive.is_loading() && !is_in_event() && !is_creeping) rows.resize(n_rows_at_rest_);
  archive(rest_.time_s, rest_.moved_m, rest_.shear_m, rest_.contact, rest_.u_x_m, rest_.law_states,
          rest_.rests_since_s, u_begins_x_m_, n_rows_at_rest_, rows, events_, is_creeping);
  if (!archive.is_loading()) {
    if (creep_) archive(*slow_, *creep_);
    return;
  }
  loading_ = std::move(rows);
  const std::size_t n = initial_.tributary_m.size();
  const std::size_t n_at_rest = slow_ || !events_.empty() ? n : 0;
  const auto is_of = [](const std::vector<double>& values, std::size_t size) {
    return values.size() == size &&
           std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
  };
  const std::size_t n_rows = 1 + 3 * events_.size() + (is_in_event() ? 1 : 0);
  require_possible(
      rest_.contact.size() == n_at_rest &&
          std::ranges::all_of(rest_.contact,
                              [](auto contact) { return contact <= statics::Contact::open; }) &&
          is_of(rest_.u_x_m, n_at_rest) &&
          rest_.law_states.size() == (slow_ ? problem_.friction.law.states().size() : 0) &&
          std::ranges::all_of(rest_.law_states, [&](const auto& values) { return is_of(values, n); }) &&
          is_of(rest_.rests_since_s, problem_.heals() ? n : 0) &&
          is_of(u_begins_x_m_, is_in_event() ? n : 0) && n_rows_at_rest_ > 0 &&
          n_rows_at_rest_ <= loading_.size() && std::isfinite(rest_.shear_m) && std::isfinite(rest_.time_s) &&
          std::isfinite(rest_.moved_m) && (slow_ ? loading_.size() >= n_rows : loading_.size() == n_rows) &&
          std::ranges::all_of(loading_,
                              [](const LoadingRow& row) { return row.phase <= LoadingPhase::creep; }),
      "a sequence");
  if (!events_.empty()) equilibrate();
  if (!is_creeping) return;
  require_possible(slow_ != nullptr && !is_in_event(), "slow slip");
  archive(*slow_);
  creep_.emplace(*slow_, initial_.tributary_m);
  archive(*creep_);
}

}  // namespace slipfront::run
