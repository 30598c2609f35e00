// SPDX-License-Identifier: BSD-3-Clause
#include "motion/part.hpp"

#include <exception>
#include <utility>

#include "base/error.hpp"
#include "base/memory.hpp"
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
  Log(SlipFinder& finder, TractionLog& tractions, Parcel& to)
      : finder_(finder), tractions_(tractions), to_(to) {}
  void observe(double time_s, const interface::Interface& state, bool changed) override {
    finder_.find(time_s, state, changed, seen_);
    tractions_.add(state.t_Pa, state.p_Pa);
    to_.put(seen_.time_s).put(static_cast<std::uint8_t>(seen_.moves)).put(seen_.changes).put(seen_.around);
  }

 private:
  SlipFinder& finder_;
  TractionLog& tractions_;
  Parcel& to_;
  SlipSeen seen_;
};

}  // namespace

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

template <class F>
void Part::or_fail(F&& f) {
  try {
    f();
  } catch (const std::exception& error) {
    processes_.fail(reason_of(error));
  }
}

void Part::carry_out(PartCommand command, Parcel& given, Parcel& answer) {
  // These look at no motion beside the interface.
  if (command != PartCommand::advance && command != PartCommand::tractions) halo_->finish();
  switch (command) {
    case PartCommand::start:
      or_fail([&] { start(given); });
      break;
    case PartCommand::watch: {
      std::vector<Probe> probes(given.take<std::uint64_t>());
      for (auto& probe : probes) {
        probe.body = given.take<std::size_t>();
        probe.node = given.take<mesh::Cell>();
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
    case PartCommand::advance:
      or_fail([&] { advance(given, answer); });
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
      answer.put(PartMeasures{stepper_->kinetic_energy_J_per_m(), stepper_->mass_kg_per_m(),
                              stepper_->bodies().front().mass_kg_per_m(),
                              stepper_->largest_acceleration_m_per_s2(), stepper_->node_updates_per_step(),
                              cost()});
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

void Part::make_finder(SlipFinder::Memory memory, int halo, double creep_m_per_s) {
  const auto own = stepper_->bodies().front().own_lower();
  finder_.emplace(std::move(memory), static_cast<std::size_t>(own.begin), static_cast<std::size_t>(own.end),
                  halo, creep_m_per_s);
  log_ = TractionLog(own, halo);
}

void Part::advance(Parcel& given, Parcel& answer) {
  if (given.take<std::uint8_t>() != 0) {
    SlipFinder::Memory memory;
    memory.time_s = given.take<double>();
    for (auto* values : {&memory.t_Pa, &memory.p_Pa, &memory.strength_Pa}) *values = given.take_all<double>();
    memory.slipping = given.take_all<std::uint8_t>();
    const int halo = given.take<int>();
    make_finder(std::move(memory), halo, given.take<double>());
  }
  const auto is_sampled = given.take_all<std::uint8_t>();
  const auto n_steps = std::ssize(is_sampled);
  const auto first_step = stepper_->step();
  const std::size_t n_values = displacement_values(stepper_->probes());
  Parcel seen;
  log_.clear();
  log_.add(finder_->memory().t_Pa, finder_->memory().p_Pa);
  Log log(*finder_, log_, seen);
  record::History samples;
  std::vector<SlipRates> rates;
  std::vector<double> displacements(n_values * static_cast<std::size_t>(n_steps));
  std::int64_t next_sample = 0;
  Between between;
  between.sample = [&]() -> record::History* {
    return is_sampled[static_cast<std::size_t>(next_sample++)] != 0 ? &samples : nullptr;
  };
  between.go_on = [&](const SlipRates& of_step) {
    rates.push_back(of_step);
    return true;
  };
  if (n_values > 0)
    between.displacements = [&](std::int64_t step) {
      return displacements.data() + n_values * static_cast<std::size_t>(step - first_step - 1);
    };
  halo_->advance(log, n_steps, between);
  const auto& memory = finder_->memory();
  answer.put(memory.time_s);
  // Of nodes along the interface only own ones.
  const auto own = stepper_->bodies().front().own_lower();
  const auto width = stepper_->interface_state().size();
  const auto n_rows = samples.time_s.size();
  const auto of_own = [&]<class T>(const std::vector<T>& values) {
    return std::span(values).subspan(static_cast<std::size_t>(own.begin),
                                     static_cast<std::size_t>(own.end - own.begin));
  };
  for (const auto* values : {&memory.t_Pa, &memory.p_Pa, &memory.strength_Pa}) answer.put(of_own(*values));
  answer.put(of_own(memory.slipping));
  answer.put(rates).put(std::vector<std::byte>(seen.bytes().begin(), seen.bytes().end()));
  for (const auto& field : record::history_fields) {
    std::vector<double> values;
    for (std::size_t row = 0; row < n_rows; ++row) {
      const auto begin = (samples.*field.member).begin() + static_cast<std::ptrdiff_t>(row * width);
      values.insert(values.end(), begin + own.begin, begin + own.end);
    }
    answer.put(values);
  }
  answer.put(displacements);
}

void Part::put_snapshot(const SnapshotPiece& piece, Parcel& answer) const {
  const auto body = static_cast<std::size_t>(piece.body);
  const auto& columns = stepper_->bodies()[body].columns();
  std::vector<double> own;
  for (int r = piece.first_row; r < piece.end_row; ++r) {
    const auto nodes = columns.nodes(r, {place_.own.begin, place_.own.end});
    stepper_->append(piece.component, body, nodes.first, nodes.end(), own);
  }
  answer.put(own);
}

void serve(Processes& processes, Part& part) {
  for (;;) {
    auto parcel = processes.receive(0);
    const auto command = parcel.take<PartCommand>();
    if (command == PartCommand::release) return;
    Parcel answer;
    try {
      answer.put(std::string());
      part.carry_out(command, parcel, answer);
    } catch (const std::exception& failure) {
      answer = Parcel();
      answer.put(reason_of(failure));
    }
    processes.send(0, answer);
  }
}

}  // namespace slipfront::motion
