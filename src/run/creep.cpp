// SPDX-License-Identifier: BSD-3-Clause
#include "run/creep.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "problem/contact.hpp"
#include "record/sequence.hpp"
#include "stability/verdict.hpp"
#include "statics/statics.hpp"

namespace slipfront::run {
namespace {

/// Of a node's states.
double change(const interface::QuasiDynamicFriction& friction, std::size_t node,
              const interface::LawStates& states, const interface::LawStates& before) {
  return friction.change(node, [&](std::size_t k) { return states[k][node] - before[k][node]; });
}

double friction(const motion::QuasiDynamicState& state, const std::vector<double>& tributary_m) {
  const auto force = statics::contact_force(state.p_Pa, state.t_Pa, tributary_m);
  return force.shear_N_per_m / force.normal_N_per_m;
}

}  // namespace

bool TurnFinder::see(double value) {
  const double back = direction_ * (extreme_ - value);
  if (back > 0 && back < amount_) return false;
  extreme_ = value;
  if (back <= 0) return false;
  direction_ = -direction_;
  return true;
}

CreepRows::CreepRows(const motion::QuasiDynamicSlip& slow, const std::vector<double>& tributary_m)
    : turns_(friction(slow.state(), tributary_m), 0.01 * std::ranges::min(slow.friction().a())) {}

bool CreepRows::is_row_due(const motion::QuasiDynamicSlip& slow) const {
  if (slow.n_steps() % record::steps_per_slow_row != 0) return false;
  if (n_rows_ < record::all_slow_rows) return true;
  // States have changed by this share of an e-fold slip rate; rates have doubled or halved, of nodes that are
  // not far slower than the fastest: those of nodes that bear little go up and down by some per cent from
  // step to step.
  constexpr double of_state = 0.1, of_rate = 0.5, far_slower = 0.1;
  const auto& state = slow.state();
  const double least_m_per_s = far_slower * state.fastest_m_per_s();
  for (std::size_t k = 0; k < row_V_m_per_s_.size(); ++k) {
    const double V = std::abs(state.slip_rate_m_per_s[k]), row_V = std::abs(row_V_m_per_s_[k]);
    if (state.contact[k] == statics::Contact::stick &&
        (change(slow.friction(), k, state.law_states, row_states_) > of_state ||
         std::abs(V - row_V) > of_rate * std::max({V, row_V, least_m_per_s})))
      return true;
  }
  return false;
}

bool CreepRows::takes_row(const motion::QuasiDynamicState& state) {
  if (n_rows_ > 0 && last_row_s_ == state.time_s) return false;  // the end is such a step, too
  last_row_s_ = state.time_s;
  row_V_m_per_s_ = state.slip_rate_m_per_s;
  row_states_ = state.law_states;
  ++n_rows_;
  return true;
}

bool CreepRows::is_loading_row_due(const motion::QuasiDynamicState& state,
                                   const std::vector<double>& tributary_m) {
  constexpr double factor = 2;
  const double rate = state.fastest_m_per_s();
  const bool has_turned = turns_.see(friction(state, tributary_m));
  if (!has_turned && rate <= factor * loading_rate_m_per_s_ && rate >= loading_rate_m_per_s_ / factor)
    return false;
  loading_rate_m_per_s_ = rate;
  return true;
}

bool CreepRows::is_steady(const motion::QuasiDynamicSlip& slow) {
  constexpr double many = 10, least_change = 1e-3;  // of d_c, and of that by which the rate changes e-fold
  const auto& state = slow.state();
  bool has_slipped = !steady_u_x_m_.empty();
  for (std::size_t k = 0; k < steady_u_x_m_.size(); ++k) {
    if (state.contact[k] != statics::Contact::stick) continue;
    if (change(slow.friction(), k, state.law_states, steady_states_) > least_change) {
      steady_u_x_m_.clear();
      break;
    }
    has_slipped =
        has_slipped && std::abs(state.u_x_m[k] - steady_u_x_m_[k]) > many * slow.friction().d_c_m()[k];
  }
  if (!steady_u_x_m_.empty()) return has_slipped;
  steady_u_x_m_ = state.u_x_m;
  steady_states_ = state.law_states;
  return false;
}

/// Friction at the nodes of a sample between events.
static interface::QuasiDynamicFriction friction_of(const Sample& sample) {
  return {contact_model(sample.problem, mesh::interface_x_m(sample.initial.mesh)),
          sample.initial.tributary_m.size(),
          stability::radiation_damping_Pa_s_per_m(materials_of(sample.problem))};
}

Creep::Creep(Sample& sample)
    : sample_(sample),
      slow_(sample.statics, friction_of(sample), sample.initial.tributary_m,
            sample.problem.shear_speed_m_per_s) {
  sample_.rest = {0,
                  0,
                  0,
                  sample.at_rest.contact,
                  relative(sample.initial, sample.at_rest).x_m,
                  slow_.friction().initial_states(),
                  {}};
}

statics::Equilibrium Creep::slid_to(std::vector<double> u_x_per_shear) const {
  const auto& state = slow_.state();
  return sample_.statics.slid_to(state.contact, state.u_x_m, std::move(u_x_per_shear), state.shear_m);
}

record::LoadingRow Creep::loading_row(record::LoadingPhase phase, const record::LoadingRow& from) const {
  const auto& state = slow_.state();
  const auto& works = slow_.works();
  const auto equilibrium = slid_to({});
  auto now = sample_.row(phase, state.time_s, state.shear_m + sample_.rest.moved_m, equilibrium.tractions);
  now.energies = from.energies;
  now.energies.time_s = now.time_s;
  now.energies.kinetic = 0;
  sample_.add_state(equilibrium, now);
  now.energies.far_edge_work += works.of_load_J_per_m;
  now.energies.friction_work += works.of_friction_J_per_m;
  now.energies.contact_work += works.of_contact_J_per_m;
  now.wave_loss_J_per_m = from.wave_loss_J_per_m + works.radiated_J_per_m;
  now.fastest_slip_rate_m_per_s = state.fastest_m_per_s();
  return now;
}

void Creep::begin_part(double time_s, double shear_m) {
  part_end_s_ = sample_.path.part_end_s(time_s);
  slow_.set_edge_speed(sample_.path.speed_m_per_s(time_s, shear_m + sample_.rest.moved_m));
}

void Creep::begin() {
  if (sample_.rest.time_s < sample_.path.end_s()) begin_part(sample_.rest.time_s, sample_.rest.shear_m);
  slow_.start(sample_.rest.time_s, sample_.rest.shear_m, sample_.rest.contact, sample_.rest.u_x_m,
              sample_.rest.law_states);
  const auto& state = slow_.state();
  if (sample_.events.empty() && state.fastest_m_per_s() >= inertia_slip_rate_m_per_s(sample_.problem))
    throw UserError(
        "normal loading alone lets the interface slip at {:.3g} m/s, where an event begins; choose a larger "
        "{} or a smaller {}",
        state.fastest_m_per_s(), Key("friction.theta_i_s"), Key("friction.V_i_m_per_s"));
  rows_.emplace(slow_, sample_.initial.tributary_m);
}

bool Creep::slip_to_next(const Rows& rows) {
  if (!rows_) begin();
  const auto from = sample_.loading[sample_.n_rows_at_rest - 1];
  const auto& state = slow_.state();
  const auto u_tilted = relative(sample_.initial, sample_.statics.tilted());
  const auto give_row = [&] {
    if (!rows_->takes_row(state)) return;
    record::History row{{state.time_s},  sample_.at_rest.tractions.x_m,
                        state.u_x_m,     state.slip_rate_m_per_s,
                        state.t_Pa,      state.p_Pa,
                        state.law_states};
    for (std::size_t k = 0; k < row.slip_m.size(); ++k)
      row.slip_m[k] += sample_.rest.moved_m - u_tilted.x_m[k];
    rows(row);
  };
  if (rows_->n_rows() == 0) give_row();
  const auto after_step = [&] {
    sample_.require_stands(state.time_s, state.shear_m + sample_.rest.moved_m, state.t_Pa, state.p_Pa);
    if (std::isinf(sample_.path.end_s()) && rows_->is_steady(slow_))
      throw UserError(
          "{:.6g} s after normal loading the interface slips steadily, at {:.3g} m/s: no event comes; give "
          "{}, or a softer machine ({})",
          state.time_s, state.fastest_m_per_s(), Key("sequence.end_s"),
          Key("loading.shear_stiffness_Pa_per_m"));
    if (rows_->is_row_due(slow_)) give_row();
    if (rows_->is_loading_row_due(state, sample_.initial.tributary_m))
      sample_.loading.push_back(loading_row(record::LoadingPhase::creep, from));
    if (!sample_.monitor(0, 0))
      throw Interrupted(fmt::format("interrupted in slow slip, {:.6g} s after normal loading", state.time_s));
    return true;
  };
  bool begins = false;
  while (!begins && state.time_s < sample_.path.end_s()) {
    if (state.time_s >= part_end_s_) begin_part(state.time_s, state.shear_m);
    begins = slow_.slip_until(part_end_s_, inertia_slip_rate_m_per_s(sample_.problem), after_step);
  }
  give_row();
  rows_.reset();
  sample_.loading.push_back(
      loading_row(begins ? record::LoadingPhase::event_begins : record::LoadingPhase::loaded, from));
  if (!begins) return false;
  std::vector<double> per_shear;
  for (const double V : state.slip_rate_m_per_s) per_shear.push_back(V / sample_.problem.shear_speed_m_per_s);
  sample_.initial.supercritical = slid_to(std::move(per_shear));
  sample_.initial.supercritical.shear_m += sample_.rest.moved_m;
  for (auto& contact : sample_.initial.supercritical.contact)
    if (contact == statics::Contact::slip) contact = statics::Contact::stick;
  sample_.initial.subcritical = sample_.initial.supercritical;
  sample_.initial.critical_shear_m = sample_.initial.subcritical.shear_m;
  sample_.initial.law_states = state.law_states;
  if (setup::has_forces(sample_.problem))
    sample_.initial.loads =
        setup::resolved_loads(sample_.problem, sample_.statics, sample_.initial.subcritical,
                              sample_.initial.subcritical, sample_.initial.tributary_m);
  return true;
}

void Creep::serialize(StateArchive& archive) {
  archive(slow_, part_end_s_);
  if (archive.is_loading()) rows_.emplace(slow_, sample_.initial.tributary_m);
  archive(*rows_);
}

}  // namespace slipfront::run
