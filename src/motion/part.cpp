// SPDX-License-Identifier: BSD-3-Clause
#include "motion/part.hpp"

#include <utility>

#include "base/error.hpp"
#include "base/memory.hpp"
#include "motion/steps_told.hpp"
#include "processes/answers.hpp"
#include "processes/tree.hpp"
#include "statics/pieces.hpp"

namespace slipfront::motion {

namespace {

solid::Field take_field(Parcel& given) {
  solid::Field field;
  field.x = given.take_all<double>();
  field.y = given.take_all<double>();
  return field;
}

/// Sees the contact updates of several steps, to be told later.
class Log final : public UpdateObserver {
 public:
  /// @param lower  places of the part's nodes along the whole interface
  Log(SlipFinder& finder, const mesh::Subset& lower, TractionLog& tractions, SlipsSeen& to)
      : finder_(finder), lower_(lower), tractions_(tractions), to_(to) {}
  void observe(double time_s, const interface::Interface& state, bool changed) override {
    finder_.find(time_s, state, changed, seen_);
    tractions_.add(state.t_Pa, state.p_Pa);
    for (auto& change : seen_.changes) change.node = lower_.number_at(change.node);
    to_.add(seen_);
  }

 private:
  SlipFinder& finder_;
  const mesh::Subset& lower_;
  TractionLog& tractions_;
  SlipsSeen& to_;
  SlipSeen seen_;
};

}  // namespace

bool is_for_all(PartCommand command) {
  return command == PartCommand::advance || command == PartCommand::energies ||
         command == PartCommand::measures;
}

TractionLog::TractionLog(solid::Span own, int reach) {
  if (own.end - own.begin <= 2 * reach)
    places_ = {own};
  else if (reach > 0)
    places_ = {{own.begin, own.begin + reach}, {own.end - reach, own.end}};
  for (const auto& place : places_) width_ += static_cast<std::size_t>(place.end - place.begin);
}

void TractionLog::add(std::span<const double> t_Pa, std::span<const double> p_Pa) {
  for (const auto& values : {t_Pa, p_Pa})
    for (const auto& place : places_)
      values_.insert(values_.end(), values.begin() + place.begin, values.begin() + place.end);
}

record::Traction TractionLog::at(std::size_t update, int node) const {
  std::size_t before = 2 * width_ * update;
  for (const auto& place : places_) {
    if (node >= place.begin && node < place.end) {
      const auto k = before + static_cast<std::size_t>(node - place.begin);
      return {values_[k], values_[k + width_]};
    }
    before += static_cast<std::size_t>(place.end - place.begin);
  }
  SLIPFRONT_ASSERT(false, "within reach of an end");
  return {};
}

Part::Part(Processes& processes, const Division& division, std::span<const BodySource> sources,
           const interface::ContactModel& contact, const TimeStepping& time, const Execution& execution,
           const mesh::Subset& lower, statics::KeptDisplacements* kept)
    : processes_(processes), place_{division.own(processes.rank()), lower}, displacements_(kept) {
  auto sharing = execution;
  sharing.most_steps = division.steps_per_exchange;
  stepper_ = std::make_unique<Stepper>(sources, contact, time, sharing);
  halo_ = std::make_unique<Halo>(processes, division, *stepper_, sharing.halo_stage_bytes);
}

void Part::carry_out(PartCommand command, Parcel& given, Parcel& answer) {
  // These look at no motion beside the interface.
  if (command != PartCommand::advance && command != PartCommand::tractions) halo_->finish();
  switch (command) {
    case PartCommand::start:
      or_fail(processes_, [&] { start(given); });
      break;
    case PartCommand::watch: {
      std::vector<Probe> probes(given.take<std::uint64_t>());
      for (auto& probe : probes) {
        probe.body = given.take<std::size_t>();
        std::ranges::copy(given.take<mesh::Cell>(), probe.node.begin());
      }
      stepper_->watch(std::move(probes));
      break;
    }
    case PartCommand::kept:
      SLIPFRONT_ASSERT(displacements_ != nullptr, "a part whose process has shared the statics");
      for (int k = 0; k < 2; ++k) answer.put(displacements_->own(given.take<int>()));
      break;
    case PartCommand::place:
      place(given);
      break;
    case PartCommand::memory:
      make_finder(given);
      break;
    case PartCommand::advance:
      or_fail(processes_, [&] { advance(given, answer); });
      break;
    case PartCommand::tractions:
      for (const auto& [update, nodes] : given.take_all<TractionsWanted>())
        for (int n = nodes.begin; n < nodes.end; ++n)
          answer.put(log_.at(static_cast<std::size_t>(update), n))
              .put(log_.at(static_cast<std::size_t>(update) + 1, n));
      break;
    case PartCommand::energies:
      answer.put(stepper_->energies());
      break;
    case PartCommand::measures:
      answer.put(std::vector{PartMeasures{stepper_->kinetic_energy_J_per_m(), stepper_->mass_kg_per_m(),
                                          stepper_->bodies().front().mass_kg_per_m(),
                                          stepper_->largest_acceleration_m_per_s2(),
                                          stepper_->node_updates_per_step(), cost()}});
      break;
    case PartCommand::snapshot:
      put_snapshot(given.take<SnapshotPiece>(), answer);
      break;
    case PartCommand::probed:
      answer.put(stepper_->probed_u_m()).put(stepper_->probed_v_m_per_s());
      break;
    case PartCommand::keep:
      keep(*stepper_, place_).put(answer);
      break;
    case PartCommand::restore: {
      const bool is_last = given.take<std::uint8_t>() != 0;
      kept_.add(KeptMotion::take(given), 1);
      if (!is_last) break;
      given = {};
      kept_.sort();
      restore(std::exchange(kept_, {}), *stepper_, place_);
      return_freed_memory();
      halo_->begin_anew();
      finder_.reset();
      begin_counting();
      break;
    }
    case PartCommand::network:
    case PartCommand::statics:
    case PartCommand::fields:
    case PartCommand::build:
    case PartCommand::release:
    case PartCommand::end:
      SLIPFRONT_ASSERT(false, "a command of the part's owner");
  }
}

void Part::place(Parcel& given) {
  for (std::size_t b = 0; b < stepper_->bodies().size(); ++b) {
    const auto nodes = given.take_all<mesh::Node>();
    for (auto& field : placed_[b]) {
      if (field.size() == 0) field = solid::Field(stepper_->bodies()[b].u_m().size());
      const auto values = given.take_all<double>();
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        field.x[nodes[k]] = values[2 * k];
        field.y[nodes[k]] = values[2 * k + 1];
      }
    }
  }
}

void Part::start(Parcel& given) {
  statics::Equilibrium e;
  for (auto* field : {&e.u_m, &e.u_per_shear, &e.below_u_m, &e.below_u_per_shear}) *field = take_field(given);
  if (const bool base_is_relative = given.take<std::uint8_t>() != 0; placed_[0][0].size() > 0) {
    const auto& bodies = stepper_->bodies();
    if (bodies.size() > 1)
      for (std::size_t k = 0; k < 2; ++k)
        statics::make_absolute(placed_[0][k], bodies.front().lower(), placed_[1][k], bodies.back().lower(),
                               base_is_relative);
    e.u_m = std::exchange(placed_[0][0], {});
    e.u_per_shear = std::exchange(placed_[0][1], {});
    e.below_u_m = std::exchange(placed_[1][0], {});
    e.below_u_per_shear = std::exchange(placed_[1][1], {});
  }
  if (displacements_ != nullptr) displacements_->clear();
  e.tractions.t_s_Pa = given.take_all<double>();
  e.tractions.p_s_Pa = given.take_all<double>();
  e.contact = given.take_all<statics::Contact>();
  const auto top_speed_m_per_s = given.take<double>();
  Loads loads;
  for (auto* values :
       {&loads.prestress_t_Pa, &loads.prestress_p_Pa, &loads.trigger_force_N_per_m, &loads.intact})
    *values = given.take_all<double>();
  loads.trigger = given.take<interface::Trigger>();
  stepper_->start(e, top_speed_m_per_s, std::move(loads));
  finder_.reset();
  e = {};
  return_freed_memory();
  halo_->renew();
  begin_counting();
}

void Part::begin_counting() {
  counted_before_ = processes_.counters();
  first_counted_step_ = stepper_->step();
}

PartCost Part::cost() const {
  const auto& now = processes_.counters();
  return {.steps = stepper_->step() - first_counted_step_,
          .messages = now.messages - counted_before_.messages,
          .bytes = now.bytes - counted_before_.bytes,
          .computing_s = halo_->computing_s(),
          .exchange_s = now.exchange_s - counted_before_.exchange_s,
          .command_s = now.command_s - counted_before_.command_s};
}

void Part::make_finder(Parcel& given) {
  SlipFinder::Memory memory;
  memory.time_s = given.take<double>();
  for (auto* values : {&memory.t_Pa, &memory.p_Pa, &memory.strength_Pa}) *values = given.take_all<double>();
  memory.slipping = given.take_all<std::uint8_t>();
  const int halo = given.take<int>();
  const auto creep_m_per_s = given.take<double>();
  const auto own = stepper_->bodies().front().own_lower();
  finder_.emplace(std::move(memory), static_cast<std::size_t>(own.begin), static_cast<std::size_t>(own.end),
                  halo, creep_m_per_s);
  log_ = TractionLog(own, halo);
}

void Part::advance(Parcel& given, Parcel& answer) {
  SLIPFRONT_ASSERT(finder_, "the last contact update is known");
  const auto is_sampled = given.take_all<std::uint8_t>();
  const auto n_steps = std::ssize(is_sampled);
  const auto first_step = stepper_->step();
  const std::size_t n_values = displacement_values(stepper_->probes());
  StepsTold told;
  told.displacements.resize(n_values * static_cast<std::size_t>(n_steps));
  log_.clear();
  log_.add(finder_->memory().t_Pa, finder_->memory().p_Pa);
  Log log(*finder_, place_.lower, log_, told.seen);
  record::History samples;
  std::int64_t next_sample = 0;
  Between between;
  between.sample = [&]() -> record::History* {
    return is_sampled[static_cast<std::size_t>(next_sample++)] != 0 ? &samples : nullptr;
  };
  between.go_on = [&](const SlipRates& of_step) {
    told.rates.push_back(of_step);
    return true;
  };
  if (n_values > 0)
    between.displacements = [&](std::int64_t step) {
      return told.displacements.data() + n_values * static_cast<std::size_t>(step - first_step - 1);
    };
  halo_->advance(log, n_steps, between);
  const auto& memory = finder_->memory();
  // Of nodes along the interface only own ones.
  const auto own = stepper_->bodies().front().own_lower();
  const auto width = stepper_->interface_state().size();
  const auto append_own = [&]<class T>(const std::vector<T>& values, std::size_t row, std::vector<T>& to) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(row * width);
    to.insert(to.end(), begin + own.begin, begin + own.end);
  };
  told.memory.time_s = memory.time_s;
  append_own(memory.t_Pa, 0, told.memory.t_Pa);
  append_own(memory.p_Pa, 0, told.memory.p_Pa);
  append_own(memory.strength_Pa, 0, told.memory.strength_Pa);
  append_own(memory.slipping, 0, told.memory.slipping);
  for (std::size_t f = 0; f < told.samples.size(); ++f)
    for (std::size_t row = 0; row < samples.time_s.size(); ++row)
      append_own(samples.*record::history_fields[f].member, row, told.samples[f]);
  told.put(answer);
}

void Part::put_snapshot(const SnapshotPiece& piece, Parcel& answer) const {
  const auto body = static_cast<std::size_t>(piece.body);
  const auto& columns = stepper_->bodies()[body].columns();
  std::vector<double> own;
  for (int r = piece.first_row; r < piece.end_row; ++r) {
    const auto nodes = columns.nodes(r, {place_.own.begin, place_.own.end});
    stepper_->append(piece.component, body, static_cast<mesh::Node>(nodes.first),
                     static_cast<mesh::Node>(nodes.end()), own);
  }
  answer.put(own);
}

Parcel joined(PartCommand command, std::span<Parcel> answers) {
  if (answers.size() == 1) return std::move(answers.front());
  Parcel all;
  if (command == PartCommand::advance) {
    StepsTold::take_joined(answers).put(all);
  } else if (command == PartCommand::energies) {
    auto sum = answers.front().take<record::Energies>();
    for (auto& answer : answers.subspan(1)) add_terms(sum, answer.take<record::Energies>());
    all.put(sum);
  } else {
    SLIPFRONT_ASSERT(command == PartCommand::measures, "a command for all");
    std::vector<PartMeasures> measures;
    for (auto& answer : answers)
      for (const auto& of_part : answer.take_all<PartMeasures>()) measures.push_back(of_part);
    all.put(measures);
  }
  return all;
}

std::vector<Parcel> carry_out_with_others(Processes& processes, Part& part, const Parcel& parcel) {
  const auto below = below_in_tree(processes.rank(), processes.size());
  std::vector<Parcel> all(1 + below.size());
  or_fail(processes, [&] {
    // First to the process with most of them below it.
    for (std::size_t k = below.size(); k-- > 0;) processes.send(below[k], parcel);
  });
  Answers answers(processes);
  answers.unless_failed([&] {
    auto given = parcel;
    const auto command = given.take<PartCommand>();
    part.carry_out(command, given, all.front());
  });
  for (std::size_t k = 0; k < below.size(); ++k)
    answers.take(below[k], [&](Parcel& answer) { all[k + 1] = std::move(answer); });
  answers.end();
  return all;
}

void serve(Processes& processes, Part& part) {
  for (;;) {
    const auto parcel = processes.receive_any();
    auto given = parcel;
    const auto command = given.take<PartCommand>();
    if (command == PartCommand::release) return;
    const int asks = is_for_all(command) ? above_in_tree(processes.rank()) : 0;
    processes.send(asks, answer_of(processes, [&](Parcel& answer) {
                     if (!is_for_all(command)) return part.carry_out(command, given, answer);
                     auto answers = carry_out_with_others(processes, part, parcel);
                     answer.append(joined(command, answers));
                   }));
  }
}

}  // namespace slipfront::motion
