// SPDX-License-Identifier: BSD-3-Clause
#include "run/sequence.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/clock.hpp"
#include "base/error.hpp"
#include "run/sequence_event.hpp"
#include "run/stick.hpp"

namespace slipfront::run {

namespace {

using record::LoadingPhase;

void add_event_works(const record::Energies& of_event, record::Energies& sum) {
  for (const auto& term : record::energy_terms)
    if (term.kind == record::EnergyKind::work) sum.*term.member += of_event.*term.member;
}

}  // namespace

Sequence::Sequence(const Problem& problem, const motion::Monitor& monitor, const Processes& processes)
    : sample_(problem, monitor, processes) {
  if (problem.friction.law.never_sticks())
    creep_.emplace(sample_);
  else if (advice::has_fracture_energy(problem))
    predictor_.emplace(problem);
}

std::string Sequence::end() const {
  const auto& sequence = sample_.problem.sequence;
  if (std::ssize(sample_.events) >= sequence.max_events)
    return fmt::format("sequence.max_events = {} was reached", sequence.max_events);
  if (sequence.to_global_sliding && !sample_.events.empty() && sample_.events.back().is_global != 0)
    return "all nodes inside have slipped in one event";
  return {};
}

const InitialState* Sequence::next(const Creep::Rows& rows) {
  const auto start = Clock::now();
  if (!(creep_ ? creep_->slip_to_next(rows) : stick_to_next(sample_))) return nullptr;
  sample_.initial.cost.wall_s = seconds_since(start);
  u_begins_x_m_ = relative(sample_.initial, sample_.initial.supercritical).x_m;
  return &sample_.initial;
}

void Sequence::record_event(const Result& result) {
  const auto& event = result.event;
  SLIPFRONT_ASSERT(event.end == motion::EventEnd::quiet, "the event has not come to rest");
  const auto begins = sample_.loading.back();
  const auto& at_end = event.interface_at_end;
  const record::StaticState tractions_at_end{event.record.x_m, at_end.t_Pa, at_end.p_Pa};
  const double shear_m = begins.shear_m + shear_speed_in_event_m_per_s(sample_.problem) * event.time_s;
  sample_.rest.contact.clear();
  sample_.rest.u_x_m.clear();
  double mean_m = 0;
  for (std::size_t k = 0; k < u_begins_x_m_.size(); ++k) {
    sample_.rest.contact.push_back(at_end.p_Pa[k] > 0 ? statics::Contact::stick : statics::Contact::open);
    sample_.rest.u_x_m.push_back(u_begins_x_m_[k] + at_end.slip_m[k]);
    mean_m += sample_.rest.u_x_m.back() / static_cast<double>(u_begins_x_m_.size());
  }
  for (double& u_x_m : sample_.rest.u_x_m) u_x_m -= mean_m;
  sample_.rest.moved_m += mean_m;
  sample_.rest.shear_m = shear_m - sample_.rest.moved_m;
  sample_.rest.time_s =
      begins.time_s + (shear_speed_in_event_m_per_s(sample_.problem) > 0 ? event.time_s : 0);
  auto ends = sample_.row(LoadingPhase::slip_ends, sample_.rest.time_s, shear_m, tractions_at_end);
  // Changes, since the strain energy of a motion belongs to half a step earlier.
  const auto &first = event.energies.front(), &last = event.energies.back();
  ends.energies.kinetic = last.kinetic;
  ends.energies.machine = begins.energies.machine + last.machine - first.machine;
  ends.energies.strain = begins.energies.stored() + last.stored() - first.stored() - last.kinetic;
  ends.energies.strain -= ends.energies.machine;
  add_event_works(last, ends.energies);
  sample_.loading.push_back(ends);

  if (creep_) sample_.rest.law_states = at_end.law_states;
  if (!sample_.rest.rests_since_s.empty())
    for (const auto& onset : event.record.onsets)
      sample_.rest.rests_since_s[onset.node] = sample_.rest.time_s;
  sample_.equilibrate();
  sample_.require_stands(sample_.rest.time_s, shear_m, sample_.at_rest.tractions.t_s_Pa,
                         sample_.at_rest.tractions.p_s_Pa);
  auto rests = sample_.row(LoadingPhase::at_rest, sample_.rest.time_s, shear_m, sample_.at_rest.tractions);
  sample_.add_state(sample_.at_rest, rests);
  rests.wave_loss_J_per_m += ends.energies.stored() - rests.energies.stored();
  for (std::size_t k = 0; creep_ && k < at_end.slip_rate_m_per_s.size(); ++k)
    if (at_end.p_Pa[k] > 0)
      rests.fastest_slip_rate_m_per_s =
          std::max(rests.fastest_slip_rate_m_per_s, std::abs(at_end.slip_rate_m_per_s[k]));
  sample_.loading.push_back(rests);
  sample_.n_rows_at_rest = sample_.loading.size();
  auto done = sequence_event(result, sample_.initial, begins, rests, sample_.at_rest.tractions);
  if (!(done.longest_patch_m < done.nucleation_length_m)) predict(done);
  sample_.events.push_back(done);
  u_begins_x_m_.clear();
}

void Sequence::predict(record::SequenceEvent& event) {
  if (!predictor_) return;
  predictor_->set_healed(sample_.initial.supercritical.tractions.x_m, sample_.initial.healed);
  const auto p = predictor_->predict({}, sample_.initial.supercritical.peak_x_m,
                                     &sample_.initial.supercritical.tractions);
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
    sample_.initial.*member = initial.*member;
  sample_.initial.critical_shear_m = initial.critical_shear_m;
  sample_.initial.healed = initial.healed;
  sample_.initial.law_states = initial.law_states;
  sample_.initial.loads = initial.loads;
}

void Sequence::serialize(StateArchive& archive) {
  auto rows = sample_.loading;
  bool is_creeping = this->is_creeping();
  if (!archive.is_loading() && !is_in_event() && !is_creeping) rows.resize(sample_.n_rows_at_rest);
  archive(sample_.rest.time_s, sample_.rest.moved_m, sample_.rest.shear_m, sample_.rest.contact,
          sample_.rest.u_x_m, sample_.rest.law_states, sample_.rest.rests_since_s, u_begins_x_m_,
          sample_.n_rows_at_rest, rows, sample_.events, is_creeping);
  if (!archive.is_loading()) {
    if (is_creeping) creep_->serialize(archive);
    return;
  }
  sample_.loading = std::move(rows);
  const std::size_t n = sample_.initial.tributary_m.size();
  const std::size_t n_at_rest = creep_ || !sample_.events.empty() ? n : 0;
  const auto is_of = [](const std::vector<double>& values, std::size_t size) {
    return values.size() == size &&
           std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
  };
  const std::size_t n_rows = 1 + 3 * sample_.events.size() + (is_in_event() ? 1 : 0);
  require_possible(
      sample_.rest.contact.size() == n_at_rest &&
          std::ranges::all_of(sample_.rest.contact,
                              [](auto contact) { return contact <= statics::Contact::open; }) &&
          is_of(sample_.rest.u_x_m, n_at_rest) &&
          sample_.rest.law_states.size() == (creep_ ? sample_.problem.friction.law.states().size() : 0) &&
          std::ranges::all_of(sample_.rest.law_states,
                              [&](const auto& values) { return is_of(values, n); }) &&
          is_of(sample_.rest.rests_since_s, sample_.problem.heals() ? n : 0) &&
          is_of(u_begins_x_m_, is_in_event() ? n : 0) && sample_.n_rows_at_rest > 0 &&
          sample_.n_rows_at_rest <= sample_.loading.size() && std::isfinite(sample_.rest.shear_m) &&
          std::isfinite(sample_.rest.time_s) && std::isfinite(sample_.rest.moved_m) &&
          (creep_ ? sample_.loading.size() >= n_rows : sample_.loading.size() == n_rows) &&
          std::ranges::all_of(sample_.loading,
                              [](const record::LoadingRow& row) { return row.phase <= LoadingPhase::creep; }),
      "a sequence");
  if (!sample_.events.empty()) sample_.equilibrate();
  if (!is_creeping) return;
  require_possible(creep_.has_value() && !is_in_event(), "slow slip");
  creep_->serialize(archive);
}

}  // namespace slipfront::run
