// SPDX-License-Identifier: BSD-3-Clause
#include "motion/part.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <numeric>
#include <type_traits>
#include <utility>

#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/memory.hpp"
#include "statics/pieces.hpp"

namespace slipfront::motion {

namespace {

/// Most steps between two exchanges: what several steps in one sweep through memory gain is gained with
/// these.
constexpr int most_steps_per_exchange = 16;
/// A halo on either side adds this part of a process's own work at most, if that allows a step.
constexpr double tolerated_halo = 0.1;

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

mesh::Subset Division::all(int part) const {
  const auto columns = own(part);
  const int begin = columns.begin - halo_below(part), end = columns.end + halo_above(part);
  if (begin < 0) return mesh::Subset({{0, end}, {first.back() + begin, n_columns()}});
  if (end > first.back()) return mesh::Subset({{0, end - first.back()}, {begin, n_columns()}});
  return mesh::Subset({{begin, end}});
}

int columns_per_step(std::span<const BodySource> bodies, std::span<const BodySteps> steps,
                     const TimeStepping& time) {
  const double least_s = std::ranges::min(steps, {}, &BodySteps::stable_step_s).stable_step_s;
  std::vector<std::vector<LevelReach>> levels;
  int substeps = 1;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    auto of_body = time;
    of_body.interface_substeps *= steps_at_once(steps[b].stable_step_s, least_s);
    levels.push_back(reach_of_levels(bodies[b].mesh, of_body, steps[b].multiples));
    substeps = std::lcm(substeps, levels.back().front().period);
  }
  int columns = 0;
  for (int k = 0; k < substeps; ++k) {
    int farthest = 0;
    for (const auto& of_body : levels) {
      int together = 0;
      for (const auto& level : of_body)
        if (k % level.period == 0) together += level.columns;
      farthest = std::max(farthest, together);
    }
    columns += farthest;
  }
  return columns;
}

Division divide_columns(const mesh::Mesh& mesh, int n_parts, int columns_per_step, int reach) {
  Division division;
  division.is_ring = mesh.period_m > 0;
  const int n_columns = mesh.grid.stride() - (division.is_ring ? 1 : 0);
  for (int k = 0; k <= n_parts; ++k)
    division.first.push_back(static_cast<int>(static_cast<std::int64_t>(n_columns) * k / n_parts));
  const int width = n_columns / n_parts;
  division.steps_per_exchange = std::clamp(static_cast<int>(0.5 * tolerated_halo * width / columns_per_step),
                                           1, most_steps_per_exchange);
  division.columns_per_step = columns_per_step;
  division.halo = division.steps_per_exchange * columns_per_step + reach;
  return division;
}

namespace {

/// Why parts do not know of the whole what they need; empty where they do.
/// @param widest_cell  columns over which it reaches: the halos of a part that go round a ring do not meet
/// @param corner       columns at either end among which no part begins or ends
std::string reason_against(const Division& division, int widest_cell, int corner) {
  const int n_parts = division.n_parts(), n_columns = division.first.back();
  if (n_parts == 1) return {};
  const int width = n_columns / n_parts;
  int least_width = division.halo;
  if (division.is_ring && n_parts <= 3) {
    const int others = 2 * division.halo + widest_cell;
    least_width = std::max(least_width, (others + n_parts - 2) / (n_parts - 1));
  }
  if (width < least_width)
    return fmt::format("{} processes have {} columns of elements each, fewer than the {} that they need",
                       n_parts, width, least_width);
  const int last = division.n_columns() - 1;
  const auto is_at_corner = [&](int column) { return std::min(column, last - column) <= corner; };
  for (int part = 0; part < n_parts && corner > 0; ++part) {
    const auto own = division.own(part);
    const int begin = own.begin - division.halo_below(part), end = own.end - 1 + division.halo_above(part);
    if ((begin > 0 && is_at_corner(begin)) || (end < last && is_at_corner(end)))
      return fmt::format("of {} processes one would compute a part that ends at a rounded corner", n_parts);
  }
  return {};
}

}  // namespace

Division divide_bodies(std::span<const BodySource> bodies, std::span<const BodySteps> steps,
                       const TimeStepping& time, int n_parts) {
  // Probes look at all nodes of a cell, wherever its first one lies.
  int widest_cell = 1, corner = 0;
  for (const auto& body : bodies) {
    widest_cell = std::max(widest_cell, 1 << body.mesh.coarser.size());
    corner = std::max(
        {corner, mesh::columns_of_wrapped_cells(body.mesh), columns_of_rounded_layer(body.mesh, time)});
  }
  const int per_step = columns_per_step(bodies, steps, time);
  const auto divided = [&](int n) { return divide_columns(bodies.front().mesh, n, per_step, widest_cell); };
  const auto why_not = [&](int n) { return reason_against(divided(n), widest_cell, corner); };
  const auto reason = why_not(n_parts);
  if (reason.empty()) return divided(n_parts);
  int most = n_parts - 1;
  while (!why_not(most).empty()) --most;
  throw UserError("{}; choose at most {}", reason, most);
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
    : processes_(processes),
      division_(division),
      place_{division.own(processes.rank()), lower},
      displacements_(kept) {
  const int rank = processes.rank(), n_parts = division.n_parts();
  stepper_ = std::make_unique<Stepper>(sources, contact, time, execution);
  const auto width = [](int begin, int count) { return solid::Span{begin, begin + count}; };
  // Beyond the sides of a plate that repeats lie the columns of its other end.
  const auto beyond = [&](int first_column, int count) {
    const int n = division.first.back();
    return width((first_column + n) % n, count);
  };
  const int below = division.halo_below(rank), above = division.halo_above(rank);
  const auto own = place_.own;
  if (below > 0)
    neighbours_.push_back({(rank + n_parts - 1) % n_parts,
                           width(own.begin, below),
                           beyond(own.begin - below, below),
                           true,
                           {},
                           {}});
  if (above > 0)
    neighbours_.push_back(
        {(rank + 1) % n_parts, width(own.end - above, above), beyond(own.end, above), false, {}, {}});
  // Messages between the same two are matched in their order.
  if (n_parts == 2 && rank == 1 && neighbours_.size() == 2) std::swap(neighbours_[0], neighbours_[1]);
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
      if (given.take<int>() == processes_.rank())
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
      steps_since_exchange_ = 0;
      finder_.reset();
      begin_counting();
      break;
    }
    case PartCommand::network:
    case PartCommand::statics:
    case PartCommand::build:
    case PartCommand::release:
    case PartCommand::end:
      SLIPFRONT_ASSERT(false, "a command of the part's owner");
  }
}

void Part::place(Parcel& given) {
  if (given.is_empty()) return;
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
  renew_halo();
  begin_counting();
}

void Part::begin_counting() {
  counted_before_ = processes_.counters();
  first_counted_step_ = stepper_->step();
  computing_s_ = 0;
}

PartCost Part::cost() const {
  const auto& now = processes_.counters();
  return {.steps = stepper_->step() - first_counted_step_,
          .messages = now.messages - counted_before_.messages,
          .bytes = now.bytes - counted_before_.bytes,
          .computing_s = computing_s_,
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
  for (std::int64_t done = 0; done < n_steps;) {
    const auto n = std::min(division_.steps_per_exchange - steps_since_exchange_, n_steps - done);
    const auto begin = Clock::now();
    advance_between_exchanges(log, n, between);
    computing_s_ += seconds_since(begin);
    done += n;
    if (steps_since_exchange_ == division_.steps_per_exchange) renew_halo();
  }
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

void Part::advance_between_exchanges(UpdateObserver& observer, std::int64_t n_steps, const Between& between) {
#ifdef NDEBUG
  stepper_->advance(observer, n_steps, between);
#else
  for (std::int64_t k = 1; k <= n_steps; ++k) {
    stepper_->advance(observer, 1, between);
    const auto n_wrong = static_cast<int>(steps_since_exchange_ + k) * division_.columns_per_step;
    const auto all_finite = [&](solid::Span columns) {
      bool finite = true;
      stepper_->visit_columns(columns, [&](const auto* values, std::size_t n) {
        for (std::size_t i = 0; i < n; ++i) finite &= std::isfinite(static_cast<double>(values[i]));
      });
      return finite;
    };
    for (const auto& [rank, out, in, is_below, sent, received] : neighbours_) {
      const solid::Span wrong =
          is_below ? solid::Span{in.begin, in.begin + n_wrong} : solid::Span{in.end - n_wrong, in.end};
      const solid::Span right =
          is_below ? solid::Span{wrong.end, in.end} : solid::Span{in.begin, wrong.begin};
      if (stepper_->slip_rates().finite)
        SLIPFRONT_ASSERT(all_finite(right) && all_finite(out), "a step reads beyond its part");
      stepper_->visit_columns(wrong, []<class T>(T* values, std::size_t n) {
        if constexpr (std::is_floating_point_v<T>)
          std::fill_n(values, n, std::numeric_limits<T>::quiet_NaN());
      });
    }
    stepper_->take_columns();
  }
#endif
  steps_since_exchange_ += n_steps;
}

void Part::renew_halo() {
  steps_since_exchange_ = 0;
  std::vector<Processes::Exchange> exchanges;
  for (auto& neighbour : neighbours_) {
    neighbour.sent.clear();
    stepper_->visit_columns(neighbour.out, [&](const auto* values, std::size_t n) {
      for (std::size_t k = 0; k < n; ++k) neighbour.sent.push_back(values[k]);
    });
    if (neighbour.received.empty()) {
      std::size_t n_in = 0;
      stepper_->visit_columns(neighbour.in, [&](const auto*, std::size_t n) { n_in += n; });
      neighbour.received.resize(n_in);
    }
    exchanges.push_back({neighbour.rank, neighbour.sent, neighbour.received});
  }
  processes_.exchange(exchanges);
  for (auto& neighbour : neighbours_) {
    auto from = neighbour.received.cbegin();
    stepper_->visit_columns(neighbour.in, [&]<class T>(T* values, std::size_t n) {
      for (std::size_t k = 0; k < n; ++k) values[k] = static_cast<T>(*from++);
    });
  }
  stepper_->take_columns();
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
