// SPDX-License-Identifier: BSD-3-Clause
#include "motion/subdomain.hpp"

#include <utility>

#include "base/error.hpp"
#include "base/memory.hpp"
#include "motion/step_report.hpp"
#include "processes/answers.hpp"
#include "processes/tree.hpp"
#include "statics/subdomains.hpp"

namespace slipfront::motion {

namespace {

solid::Field take_field(MessageBuffer& given) {
  solid::Field field;
  field.x = given.take_all<double>();
  field.y = given.take_all<double>();
  return field;
}

Loads take_loads(MessageBuffer& given) {
  Loads loads;
  for (auto* values :
       {&loads.prestress_t_Pa, &loads.prestress_p_Pa, &loads.trigger_force_N_per_m, &loads.intact})
    *values = given.take_all<double>();
  loads.trigger = given.take<interface::Trigger>();
  return loads;
}

/// Logs the contact updates of several steps for the report.
class Log final : public UpdateObserver {
 public:
  /// @param interface_nodes  places of the subdomain's nodes along the whole interface
  Log(SlipFinder& finder, const mesh::Subset& interface_nodes, TractionLog& tractions, SlipUpdates& to)
      : finder_(finder), interface_nodes_(interface_nodes), tractions_(tractions), to_(to) {}
  void observe(double time_s, const interface::Interface& state, bool changed) override {
    finder_.find(time_s, state, changed, seen_);
    tractions_.add(state.t_Pa, state.p_Pa);
    for (auto& change : seen_.changes) change.node = interface_nodes_.number_at(change.node);
    to_.add(seen_);
  }

 private:
  SlipFinder& finder_;
  const mesh::Subset& interface_nodes_;
  TractionLog& tractions_;
  SlipUpdates& to_;
  SlipUpdate seen_;
};

}  // namespace

bool is_collective(SubdomainCommand command) {
  return command == SubdomainCommand::advance || command == SubdomainCommand::energies ||
         command == SubdomainCommand::measures;
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

Subdomain::Subdomain(Processes& processes, const Partition& partition, std::span<const BodySource> sources,
                     const interface::ContactModel& contact, const TimeStepping& time,
                     const Execution& execution, const mesh::Subset& interface_nodes,
                     statics::DistributedFields* kept)
    : processes_(processes), place_{partition.own(processes.rank()), interface_nodes}, displacements_(kept) {
  auto sharing = execution;
  sharing.max_steps = partition.steps_per_exchange;
  stepper_ = std::make_unique<Stepper>(sources, contact, time, sharing);
  halo_ = std::make_unique<Halo>(processes, partition, *stepper_, sharing.halo_stage_bytes);
}

void Subdomain::execute(SubdomainCommand command, MessageBuffer& given, MessageBuffer& answer) {
  // These look at no motion beside the interface.
  if (command != SubdomainCommand::advance && command != SubdomainCommand::tractions) halo_->finish();
  switch (command) {
    case SubdomainCommand::start:
      or_fail(processes_, [&] { start(given); });
      break;
    case SubdomainCommand::set_probes: {
      std::vector<Probe> probes(given.take<std::uint64_t>());
      for (auto& probe : probes) {
        probe.body = given.take<std::size_t>();
        std::ranges::copy(given.take<mesh::Cell>(), probe.node.begin());
      }
      stepper_->set_probes(std::move(probes));
      break;
    }
    case SubdomainCommand::kept:
      SLIPFRONT_ASSERT(displacements_ != nullptr, "a subdomain whose rank has shared the statics");
      for (int k = 0; k < 2; ++k) answer.put(displacements_->own(given.take<int>()));
      break;
    case SubdomainCommand::place:
      place(given);
      break;
    case SubdomainCommand::memory:
      make_finder(given);
      break;
    case SubdomainCommand::advance:
      or_fail(processes_, [&] { advance(given, answer); });
      break;
    case SubdomainCommand::tractions:
      for (const auto& [update, nodes] : given.take_all<TractionRequest>())
        for (int n = nodes.begin; n < nodes.end; ++n)
          answer.put(log_.at(static_cast<std::size_t>(update), n))
              .put(log_.at(static_cast<std::size_t>(update) + 1, n));
      break;
    case SubdomainCommand::energies:
      answer.put(stepper_->energies());
      break;
    case SubdomainCommand::measures:
      answer.put(std::vector{SubdomainMeasures{stepper_->kinetic_energy_J_per_m(), stepper_->mass_kg_per_m(),
                                               stepper_->bodies().front().mass_kg_per_m(),
                                               stepper_->largest_acceleration_m_per_s2(),
                                               stepper_->node_updates_per_step(), cost()}});
      break;
    case SubdomainCommand::snapshot:
      put_snapshot(given.take<SnapshotChunk>(), answer);
      break;
    case SubdomainCommand::probed:
      answer.put(stepper_->probed_u_m()).put(stepper_->probed_v_m_per_s());
      break;
    case SubdomainCommand::keep:
      keep(stepper_->state(place_.interface_nodes), stepper_->step()).put(answer);
      break;
    case SubdomainCommand::restore:
      restore(given);
      break;
    case SubdomainCommand::network:
    case SubdomainCommand::statics:
    case SubdomainCommand::fields:
    case SubdomainCommand::build:
    case SubdomainCommand::release:
    case SubdomainCommand::end:
      SLIPFRONT_ASSERT(false, "a command of the subdomain's owner");
  }
}

void Subdomain::place(MessageBuffer& given) {
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

void Subdomain::start(MessageBuffer& given) {
  statics::Equilibrium e;
  for (auto* field : {&e.u_m, &e.u_per_shear, &e.below_u_m, &e.below_u_per_shear}) *field = take_field(given);
  if (const bool base_is_relative = given.take<std::uint8_t>() != 0; placed_[0][0].size() > 0) {
    const auto& bodies = stepper_->bodies();
    if (bodies.size() > 1)
      for (std::size_t k = 0; k < 2; ++k)
        statics::make_absolute(placed_[0][k], bodies.front().interface_side().nodes, placed_[1][k],
                               bodies.back().interface_side().nodes, base_is_relative);
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
  stepper_->start(e, top_speed_m_per_s, take_loads(given));
  finder_.reset();
  e = {};
  return_freed_memory();
  halo_->renew();
  begin_counting();
}

void Subdomain::restore(MessageBuffer& given) {
  const auto loads = take_loads(given);
  const auto chunk = StateByNode::take(given);
  given = {};
  if (!restorer_) {
    stepper_->set_loads(loads);
    restorer_.emplace(stepper_->state(place_.interface_nodes));
  }
  restorer_->add(chunk);
  if (!chunk.is_last()) return;
  stepper_->update_after_restore(restorer_->finish());
  restorer_.reset();
  return_freed_memory();
  halo_->begin_anew();
  finder_.reset();
  begin_counting();
}

void Subdomain::begin_counting() {
  counted_before_ = processes_.counters();
  first_counted_step_ = stepper_->step();
}

SubdomainCost Subdomain::cost() const {
  const auto& now = processes_.counters();
  return {.steps = stepper_->step() - first_counted_step_,
          .messages = now.messages - counted_before_.messages,
          .bytes = now.bytes - counted_before_.bytes,
          .computing_s = halo_->computing_s(),
          .exchange_s = now.exchange_s - counted_before_.exchange_s,
          .command_s = now.command_s - counted_before_.command_s};
}

void Subdomain::make_finder(MessageBuffer& given) {
  SlipFinder::Memory memory;
  memory.time_s = given.take<double>();
  for (auto* values : {&memory.t_Pa, &memory.p_Pa, &memory.strength_Pa}) *values = given.take_all<double>();
  memory.slipping = given.take_all<std::uint8_t>();
  const int halo = given.take<int>();
  const auto creep_m_per_s = given.take<double>();
  const auto own = stepper_->bodies().front().interface_side().own;
  finder_.emplace(std::move(memory), static_cast<std::size_t>(own.begin), static_cast<std::size_t>(own.end),
                  halo, creep_m_per_s);
  log_ = TractionLog(own, halo);
}

void Subdomain::advance(MessageBuffer& given, MessageBuffer& answer) {
  SLIPFRONT_ASSERT(finder_, "the last contact update is known");
  const auto is_sampled = given.take_all<std::uint8_t>();
  const auto n_steps = std::ssize(is_sampled);
  const auto first_step = stepper_->step();
  const std::size_t n_values = displacement_values(stepper_->probes());
  StepReport report;
  report.displacements.resize(n_values * static_cast<std::size_t>(n_steps));
  log_.clear();
  log_.add(finder_->memory().t_Pa, finder_->memory().p_Pa);
  Log log(*finder_, place_.interface_nodes, log_, report.seen);
  record::History samples;
  std::int64_t next_sample = 0;
  StepCallbacks callbacks;
  callbacks.sample = [&]() -> record::History* {
    return is_sampled[static_cast<std::size_t>(next_sample++)] != 0 ? &samples : nullptr;
  };
  callbacks.may_continue = [&](const SlipRates& of_step) {
    report.rates.push_back(of_step);
    return true;
  };
  if (n_values > 0)
    callbacks.displacements = [&](std::int64_t step) {
      return report.displacements.data() + n_values * static_cast<std::size_t>(step - first_step - 1);
    };
  halo_->advance(log, n_steps, callbacks);
  const auto& memory = finder_->memory();
  // Of nodes along the interface only own ones.
  const auto own = stepper_->bodies().front().interface_side().own;
  const auto width = stepper_->interface_state().size();
  const auto append_own = [&]<class T>(const std::vector<T>& values, std::size_t row, std::vector<T>& to) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(row * width);
    to.insert(to.end(), begin + own.begin, begin + own.end);
  };
  report.memory.time_s = memory.time_s;
  append_own(memory.t_Pa, 0, report.memory.t_Pa);
  append_own(memory.p_Pa, 0, report.memory.p_Pa);
  append_own(memory.strength_Pa, 0, report.memory.strength_Pa);
  append_own(memory.slipping, 0, report.memory.slipping);
  for (std::size_t f = 0; f < report.samples.size(); ++f)
    for (std::size_t row = 0; row < samples.time_s.size(); ++row)
      append_own(samples.*record::history_fields[f].member, row, report.samples[f]);
  report.put(answer);
}

void Subdomain::put_snapshot(const SnapshotChunk& chunk, MessageBuffer& answer) const {
  const auto body = static_cast<std::size_t>(chunk.body);
  const auto& columns = stepper_->bodies()[body].columns();
  std::vector<double> own;
  for (int r = chunk.first_row; r < chunk.end_row; ++r) {
    const auto nodes = columns.nodes(r, {place_.own.begin, place_.own.end});
    stepper_->append(chunk.component, body, static_cast<mesh::Node>(nodes.first),
                     static_cast<mesh::Node>(nodes.end()), own);
  }
  answer.put(own);
}

MessageBuffer joined(SubdomainCommand command, std::span<MessageBuffer> answers) {
  if (answers.size() == 1) return std::move(answers.front());
  MessageBuffer all;
  if (command == SubdomainCommand::advance) {
    StepReport::take_joined(answers).put(all);
  } else if (command == SubdomainCommand::energies) {
    auto sum = answers.front().take<record::Energies>();
    for (auto& answer : answers.subspan(1)) add_terms(sum, answer.take<record::Energies>());
    all.put(sum);
  } else {
    SLIPFRONT_ASSERT(command == SubdomainCommand::measures, "a command for all");
    std::vector<SubdomainMeasures> measures;
    for (auto& answer : answers)
      for (const auto& of_subdomain : answer.take_all<SubdomainMeasures>()) measures.push_back(of_subdomain);
    all.put(measures);
  }
  return all;
}

std::vector<MessageBuffer> execute_in_tree(Processes& processes, Subdomain& subdomain,
                                           const MessageBuffer& buffer) {
  const auto below = children_in_tree(processes.rank(), processes.size());
  std::vector<MessageBuffer> all(1 + below.size());
  or_fail(processes, [&] {
    // First to the process with most of them below it.
    for (std::size_t k = below.size(); k-- > 0;) processes.send(below[k], buffer);
  });
  Answers answers(processes);
  answers.unless_failed([&] {
    auto given = buffer;
    const auto command = given.take<SubdomainCommand>();
    subdomain.execute(command, given, all.front());
  });
  for (std::size_t k = 0; k < below.size(); ++k)
    answers.take(below[k], [&](MessageBuffer& answer) { all[k + 1] = std::move(answer); });
  answers.end();
  return all;
}

void serve(Processes& processes, Subdomain& subdomain) {
  for (;;) {
    const auto buffer = processes.receive_any();
    auto given = buffer;
    const auto command = given.take<SubdomainCommand>();
    if (command == SubdomainCommand::release) return;
    const int asks = is_collective(command) ? parent_in_tree(processes.rank()) : 0;
    processes.send(asks, answer_of(processes, [&](MessageBuffer& answer) {
                     if (!is_collective(command)) return subdomain.execute(command, given, answer);
                     auto answers = execute_in_tree(processes, subdomain, buffer);
                     answer.append(joined(command, answers));
                   }));
  }
}

}  // namespace slipfront::motion
