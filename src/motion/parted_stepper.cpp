// SPDX-License-Identifier: BSD-3-Clause
#include "motion/parted_stepper.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <utility>

#include "base/error.hpp"

namespace slipfront::motion {

mesh::Subset lower_in(const mesh::Mesh& mesh, const mesh::Subset& columns) {
  const mesh::NodeColumns of_nodes(mesh::blocks(mesh));
  std::vector<mesh::Subset::Range> ranges;
  for (int k = 0; k < std::ssize(mesh.lower); ++k) {
    if (!columns.has(of_nodes.column_of(mesh.lower[static_cast<std::size_t>(k)]))) continue;
    if (!ranges.empty() && ranges.back().end == k)
      ++ranges.back().end;
    else
      ranges.push_back({k, k + 1});
  }
  return mesh::Subset(std::move(ranges));
}

namespace {

solid::Span own_lower_in(const mesh::Mesh& mesh, solid::Span columns) {
  const auto places = lower_in(mesh, mesh::Subset({{columns.begin, columns.end}}));
  SLIPFRONT_ASSERT(places.ranges().size() == 1, "interface nodes in the order of columns");
  return {places.ranges().front().begin, places.ranges().front().end};
}

template <class T>
std::vector<T> cut(const std::vector<T>& values, const mesh::Subset& places) {
  std::vector<T> some;
  if (values.empty()) return some;
  for (const auto& range : places.ranges())
    some.insert(some.end(), values.begin() + range.begin, values.begin() + range.end);
  return some;
}

/// Some columns of a field over a whole body, or none of an empty one.
void put_columns(const mesh::NodeColumns& body, const mesh::Subset& columns, const solid::Field& field,
                 Parcel& to) {
  std::vector<double> values;
  for (const auto* component : {&field.x, &field.y}) {
    values.clear();
    for (int r = 0; r < (component->empty() ? 0 : body.n_rows()); ++r)
      for (const auto& range : columns.ranges()) {
        const auto nodes = body.nodes(r, range);
        values.insert(values.end(), component->begin() + nodes.first, component->begin() + nodes.end());
      }
    to.put(values);
  }
}

/// Rows of a body in groups of so many nodes, at most, or single ones.
std::vector<mesh::Subset::Range> rows_at_once(const mesh::NodeColumns& body) {
  constexpr int most_nodes = 1 << 19;
  std::vector<mesh::Subset::Range> groups;
  int nodes = 0;
  for (int r = 0; r < body.n_rows(); ++r) {
    const int of_row = body.row(r).count;
    if (groups.empty() || nodes + of_row > most_nodes) {
      groups.push_back({r, r});
      nodes = 0;
    }
    groups.back().end = r + 1;
    nodes += of_row;
  }
  return groups;
}

}  // namespace

PartedStepper::PartedStepper(Processes& processes, const Division& division, std::unique_ptr<Part> own,
                             std::span<const mesh::Mesh* const> bodies)
    : processes_(processes), division_(division), own_(std::move(own)) {
  for (const auto* body : bodies) columns_.emplace_back(mesh::blocks(*body));
  for (int part = 0; part < division.n_parts(); ++part) {
    all_parts_.push_back(part);
    all_lower_.push_back(lower_in(*bodies.front(), division.all(part)));
    own_lower_.push_back(own_lower_in(*bodies.front(), division.own(part)));
  }
  for (int component = 0; component < n_motion_components; ++component)
    for (std::size_t b = 0; b < columns_.size(); ++b)
      for (const auto& [first, end] : rows_at_once(columns_[b]))
        snapshot_pieces_.push_back({MotionComponent{component}, static_cast<int>(b), first, end});
}

PartedStepper::~PartedStepper() {
  const Parcel release = Parcel().put(PartCommand::release);
  for (int rank = 1; rank < processes_.size(); ++rank) processes_.send(rank, release);
}

void PartedStepper::ask(std::span<const int> parts, PartCommand command,
                        const std::function<Parcel(int part)>& given,
                        const std::function<void(Parcel& answer)>& take) const {
  const bool asks_own = !parts.empty() && parts.front() == 0;
  const auto others = parts.subspan(asks_own ? 1 : 0);
  // Others wait for what is not sent, or not received: there is no way back.
  const auto or_fail = [&](auto&& talk) {
    try {
      for (const int rank : others) talk(rank);
    } catch (const std::exception& error) {
      processes_.fail(reason_of(error));
    }
  };
  or_fail([&](int rank) {
    Parcel parcel;
    parcel.put(command).append(given(rank));
    processes_.send(rank, parcel);
  });
  // All answers are taken, whatever fails: the next command's are not to be mixed up with them.
  std::exception_ptr failure;
  const auto unless_failed = [&](auto&& f) {
    if (failure != nullptr) return;
    try {
      f();
    } catch (...) {
      failure = std::current_exception();
    }
  };
  unless_failed([&] {
    if (!asks_own) return;
    auto own = given(0);
    Parcel answer;
    own_->carry_out(command, own, answer);
    take(answer);
  });
  or_fail([&](int rank) {
    auto answer = processes_.receive(rank);
    unless_failed([&] {
      const auto error = answer.take_text();
      if (!error.empty())
        throw ProcessError(fmt::format("process {} of {}: {}", rank, processes_.size(), error));
      take(answer);
    });
  });
  if (failure != nullptr) std::rethrow_exception(failure);
}

std::vector<Parcel> PartedStepper::ask(PartCommand command,
                                       const std::function<Parcel(int part)>& given) const {
  std::vector<Parcel> answers;
  ask(command, given, [&](Parcel& answer) { answers.push_back(std::move(answer)); });
  return answers;
}

void PartedStepper::place(const statics::KeptDisplacement& u_m,
                          const statics::KeptDisplacement& u_per_shear) {
  for (int piece = 0; piece < u_m.cut->n_pieces(); ++piece) {
    std::array<std::vector<double>, 2> values;  // of one process after the other: no one has all of them
    ask(
        std::array{piece}, PartCommand::kept,
        [&](int) { return std::move(Parcel().put(u_m.number).put(u_per_shear.number)); },
        [&](Parcel& answer) {
          for (auto& of_piece : values) of_piece = answer.take_all<double>();
        });
    const auto nodes = u_m.cut->nodes_of_piece(columns_, piece);
    const int first = u_m.cut->first_column[static_cast<std::size_t>(piece)];
    const int end = u_m.cut->first_column[static_cast<std::size_t>(piece) + 1];
    std::vector<int> reached;
    for (const int part : all_parts_)
      if (const auto columns = division_.all(part);
          columns.ranges().front().begin < end && columns.ranges().back().end > first)
        reached.push_back(part);
    const auto placed = [&](int part) {
      const auto columns = division_.all(part);
      Parcel parcel;
      std::size_t before = 0;
      for (std::size_t b = 0; b < columns_.size(); ++b) {
        const auto held = columns_[b].of_part(columns);
        std::vector<mesh::Node> here;
        std::array<std::vector<double>, 2> some;
        for (std::size_t k = 0; k < nodes[b].size(); ++k) {
          if (!columns.has(columns_[b].column_of(nodes[b][k]))) continue;
          here.push_back(held.node_of_whole(nodes[b][k]));
          for (std::size_t f = 0; f < 2; ++f) {
            const auto from = values[f].begin() + static_cast<std::ptrdiff_t>(2 * (before + k));
            some[f].insert(some[f].end(), from, from + 2);
          }
        }
        before += nodes[b].size();
        parcel.put(here).put(some[0]).put(some[1]);
      }
      return parcel;
    };
    ask(reached, PartCommand::place, placed, [](Parcel&) {});
  }
}

void PartedStepper::start(const statics::Equilibrium& e, double top_speed_m_per_s, const Loads& loads) {
  const bool is_elsewhere = e.u_m.size() == 0 && e.kept_u_m;
  if (is_elsewhere) place(*e.kept_u_m, *e.kept_u_per_shear);
  ask(PartCommand::start, [&](int part) {
    Parcel parcel;
    const auto columns = division_.all(part);
    const auto& lower = all_lower_[static_cast<std::size_t>(part)];
    put_columns(columns_.front(), columns, e.u_m, parcel);
    put_columns(columns_.front(), columns, e.u_per_shear, parcel);
    put_columns(columns_.back(), columns, e.below_u_m, parcel);
    put_columns(columns_.back(), columns, e.below_u_per_shear, parcel);
    parcel.put(static_cast<std::uint8_t>(is_elsewhere && e.kept_u_m->cut->base_is_relative));
    parcel.put(cut(e.tractions.t_s_Pa, lower)).put(cut(e.tractions.p_s_Pa, lower));
    parcel.put(cut(e.contact, lower)).put(top_speed_m_per_s);
    for (const auto* values :
         {&loads.prestress_t_Pa, &loads.prestress_p_Pa, &loads.trigger_force_N_per_m, &loads.intact})
      parcel.put(cut(*values, lower));
    parcel.put(loads.trigger);
    return parcel;
  });
  has_finders_ = false;
  step_ = 0;
}

void PartedStepper::watch(std::vector<Probe> probes) {
  probes_ = std::move(probes);
  part_of_probe_.clear();
  std::vector<std::vector<std::pair<std::size_t, mesh::Cell>>> of_part(
      static_cast<std::size_t>(division_.n_parts()));
  for (const auto& probe : probes_) {
    const auto& body = columns_[probe.body];
    const int column = body.column_of(probe.node[0]);
    const auto after = std::ranges::upper_bound(division_.first, column);
    const int part = std::min(static_cast<int>(after - division_.first.begin()) - 1, division_.n_parts() - 1);
    part_of_probe_.push_back(part);
    const auto held = body.of_part(division_.all(part));
    auto node = probe.node;
    for (auto& n : node) n = held.node_of_whole(n);
    of_part[static_cast<std::size_t>(part)].emplace_back(probe.body, node);
  }
  ask(PartCommand::watch, [&](int part) {
    const auto& list = of_part[static_cast<std::size_t>(part)];
    Parcel parcel;
    parcel.put(static_cast<std::uint64_t>(list.size()));
    for (const auto& [body, node] : list) parcel.put(body).put(node);
    return parcel;
  });
}

std::vector<double> PartedStepper::probed(int which) const {
  std::vector<std::vector<double>> of_part;
  for (auto& answer : ask(PartCommand::probed)) {
    auto values = answer.take_all<double>();
    if (which > 0) values = answer.take_all<double>();
    of_part.push_back(std::move(values));
  }
  std::vector<std::size_t> taken(of_part.size());
  std::vector<double> values;
  for (const int part : part_of_probe_) {
    auto& at = taken[static_cast<std::size_t>(part)];
    const auto from = of_part[static_cast<std::size_t>(part)].begin() + static_cast<std::ptrdiff_t>(at);
    values.insert(values.end(), from, from + 8);
    at += 8;
  }
  return values;
}

std::int64_t PartedStepper::advance(Recorder& recorder, std::int64_t most_steps, const Between& between) {
  std::int64_t taken = 0;
  // Parts keep their logs of tractions between commands.
  constexpr double most_bytes = 16e6;
  int widest = 0;
  for (const auto& own : own_lower_) widest = std::max(widest, own.end - own.begin);
  const double logged =
      TractionLog::bytes_per_update(widest, recorder.record().halo) * std::round(step_s() / substep_s());
  const auto at_once = std::max(std::int64_t{1}, static_cast<std::int64_t>(most_bytes / (logged + 1)));
  while (taken < most_steps) {
    const auto n = std::min({most_steps - taken, between.sure_steps(), at_once});
    const auto steps = advance_surely(recorder, n, between);
    taken += steps.taken;
    if (!steps.goes_on) break;
  }
  return taken;
}

PartedStepper::Steps PartedStepper::advance_surely(Recorder& recorder, std::int64_t n_steps,
                                                   const Between& between) {
  const auto first_step = step_;
  std::vector<record::History*> samples;
  std::vector<std::uint8_t> is_sampled;
  for (std::int64_t k = 0; k < n_steps; ++k, ++step_) {
    samples.push_back(between.sample());
    is_sampled.push_back(samples.back() != nullptr);
  }
  step_ = first_step;
  auto answers = ask(PartCommand::advance, [&](int part) {
    Parcel parcel;
    parcel.put(static_cast<std::uint8_t>(!has_finders_));
    if (!has_finders_) {
      const auto& known = recorder.finder().memory();
      const auto& lower = all_lower_[static_cast<std::size_t>(part)];
      parcel.put(known.time_s);
      for (const auto* values : {&known.t_Pa, &known.p_Pa, &known.strength_Pa})
        parcel.put(cut(*values, lower));
      parcel.put(cut(known.slipping, lower));
      parcel.put(recorder.record().halo).put(recorder.finder().creep_m_per_s());
    }
    parcel.put(is_sampled);
    return parcel;
  });
  has_finders_ = true;

  struct Told {
    std::vector<SlipRates> rates;
    std::vector<std::vector<double>> samples;  ///< of each field
    std::vector<double> displacements;
  };
  std::vector<Told> told;
  std::vector<Parcel> seen_by_part;
  auto& memory = recorder.finder().memory();
  for (std::size_t part = 0; part < answers.size(); ++part) {
    auto& answer = answers[part];
    memory.time_s = answer.take<double>();
    const auto take = [&]<class T>(std::vector<T>& to) {
      std::ranges::copy(answer.take_all<T>(), to.begin() + own_lower_[part].begin);
    };
    for (auto* values : {&memory.t_Pa, &memory.p_Pa, &memory.strength_Pa}) take(*values);
    take(memory.slipping);
    Told of_part;
    of_part.rates = answer.take_all<SlipRates>();
    seen_by_part.emplace_back(answer.take_all<std::byte>());
    for (std::size_t f = 0; f < record::history_fields.size(); ++f)
      of_part.samples.push_back(answer.take_all<double>());
    of_part.displacements = answer.take_all<double>();
    told.push_back(std::move(of_part));
  }
  const auto n_substeps = std::lround(step_s() / substep_s());
  const auto seen = joined(std::move(seen_by_part), static_cast<std::size_t>(n_steps * n_substeps),
                           recorder.finder().n_around());
  auto next_seen = seen.begin();
  std::ptrdiff_t row = 0;
  for (std::int64_t k = 0; k < n_steps; ++k) {
    for (long substep = 0; substep < n_substeps; ++substep) recorder.take(*next_seen++);
    if (auto* to = samples[static_cast<std::size_t>(k)]; to != nullptr) {
      to->time_s.push_back(time_s());
      for (std::size_t f = 0; f < record::history_fields.size(); ++f) {
        auto& field = to->*record::history_fields[f].member;
        for (std::size_t part = 0; part < told.size(); ++part) {
          const auto width = own_lower_[part].end - own_lower_[part].begin;
          const auto from = told[part].samples[f].begin() + row * width;
          field.insert(field.end(), from, from + width);
        }
      }
      ++row;
    }
    if (!probes_.empty())
      if (double* to = between.displacements(step_ + 1); to != nullptr) {
        std::vector<std::size_t> taken(told.size());
        for (std::size_t p = 0; p < probes_.size(); ++p) {
          const auto part = static_cast<std::size_t>(part_of_probe_[p]);
          const auto& from = told[part].displacements;
          const auto per_step = from.size() / static_cast<std::size_t>(n_steps);
          std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(k) * per_step +
                                                                 8 * taken[part]++),
                      8, to + 8 * p);
        }
      }
    ++step_;
    SlipRates rates;
    for (const auto& of_part : told) {
      const auto& r = of_part.rates[static_cast<std::size_t>(k)];
      rates.finite &= r.finite;
      rates.fastest_m_per_s = std::max(rates.fastest_m_per_s, r.fastest_m_per_s);
      rates.fastest_slipping_m_per_s = std::max(rates.fastest_slipping_m_per_s, r.fastest_slipping_m_per_s);
    }
    // Before the last of these steps only a motion that is not physical is refused. The parts have gone on:
    // what is told of its energy is that of their last step.
    if (!between.go_on(rates)) return {k + 1, false};
  }
  return {n_steps, true};
}

std::vector<SlipSeen> PartedStepper::joined(std::vector<Parcel> seen_by_part, std::size_t n_updates,
                                            std::size_t n_around) const {
  const int reach = static_cast<int>(n_around / 2);
  struct Gap {                       // of some nodes around an onset, which another part knows
    std::size_t update = 0, at = 0;  // where the tractions are to go in SlipSeen::around
    double share = 0;
  };
  std::vector<std::vector<TractionsWanted>> wanted(own_lower_.size());
  std::vector<std::vector<Gap>> gaps(own_lower_.size());
  std::vector<SlipSeen> seen(n_updates);
  for (std::size_t part = 0; part < seen_by_part.size(); ++part) {
    auto& from = seen_by_part[part];
    for (std::size_t update = 0; update < n_updates; ++update) {
      auto& all = seen[update];
      all.time_s = from.take<double>();
      all.moves |= from.take<std::uint8_t>() != 0;
      auto first_around = all.around.size();
      for (auto change : from.take_all<SlipChange>()) {
        change.node = all_lower_[part].number_at(change.node);
        all.changes.push_back(change);
        if (!change.begins) continue;
        const auto near = std::ranges::upper_bound(own_lower_, change.node - reach, {}, &solid::Span::end);
        for (auto other = static_cast<std::size_t>(near - own_lower_.begin());
             other < own_lower_.size() && own_lower_[other].begin <= change.node + reach; ++other) {
          if (other == part) continue;
          const int begin = std::max(own_lower_[other].begin, change.node - reach);
          const int end = std::min(own_lower_[other].end, change.node + reach + 1);
          const int place = all_lower_[other].place_of(begin);
          wanted[other].push_back({static_cast<std::int64_t>(update), {place, place + end - begin}});
          gaps[other].push_back(
              {update, first_around + static_cast<std::size_t>(begin - (change.node - reach)), change.share});
        }
        first_around += n_around;
      }
      const auto around = from.take_all<record::Traction>();
      all.around.insert(all.around.end(), around.begin(), around.end());
      SLIPFRONT_ASSERT(all.around.size() == first_around, "tractions around each onset");
    }
  }
  if (std::ranges::all_of(wanted, [](const auto& of_part) { return of_part.empty(); })) return seen;
  std::size_t part = 0;
  ask(
      PartCommand::tractions,
      [&](int other) {
        Parcel parcel;
        parcel.put(wanted[static_cast<std::size_t>(other)]);
        return parcel;
      },
      [&](Parcel& answer) {
        for (std::size_t k = 0; k < wanted[part].size(); ++k) {
          const auto& [update, nodes] = wanted[part][k];
          const auto& gap = gaps[part][k];
          for (int n = 0; n < nodes.end - nodes.begin; ++n) {
            const auto before = answer.take<record::Traction>();
            const auto after = answer.take<record::Traction>();
            seen[gap.update].around[gap.at + static_cast<std::size_t>(n)] =
                traction_between(before, after, gap.share);
          }
        }
        ++part;
      });
  return seen;
}

record::Energies PartedStepper::energies() {
  auto answers = ask(PartCommand::energies);
  auto sum = answers.front().take<record::Energies>();
  for (auto& answer : std::span(answers).subspan(1)) add_terms(sum, answer.take<record::Energies>());
  sum.time_s = time_s();
  return sum;
}

std::vector<PartMeasures> PartedStepper::measures() const {
  std::vector<PartMeasures> all;
  for (auto& answer : ask(PartCommand::measures)) all.push_back(answer.take<PartMeasures>());
  return all;
}

std::vector<PartCost> PartedStepper::costs() const {
  std::vector<PartCost> costs;
  for (const auto& m : measures()) costs.push_back(m.cost);
  return costs;
}

double PartedStepper::node_updates_per_step() const {
  double sum = 0;
  for (const auto& m : measures()) sum += m.node_updates_per_step;
  return sum;
}

double PartedStepper::kinetic_energy_J_per_m() const {
  double sum = 0;
  for (const auto& m : measures()) sum += m.kinetic_J_per_m;
  return sum;
}

double PartedStepper::mass_kg_per_m() const {
  double sum = 0;
  for (const auto& m : measures()) sum += m.mass_kg_per_m;
  return sum;
}

double PartedStepper::energy_of_tractions_J_per_m() const {
  double mass = 0, a = 0;
  for (const auto& m : measures()) {
    mass += m.plate_mass_kg_per_m;
    a = std::max(a, m.largest_acceleration_m_per_s2);
  }
  const double v = stable_step_s() * a;
  return 0.5 * mass * v * v;
}

std::int64_t PartedStepper::n_nodes() const {
  std::int64_t n = 0;
  for (const auto& body : columns_) n += body.n_nodes();
  return n;
}

mesh::NodeColumns::Nodes PartedStepper::nodes_of(const SnapshotPiece& piece) const {
  const auto& body = columns_[static_cast<std::size_t>(piece.body)];
  const auto first = body.row(piece.first_row).first;
  return {first, body.row(piece.end_row - 1).end() - first};
}

std::size_t PartedStepper::snapshot_piece_bytes() const {
  int most = 0;
  for (const auto& piece : snapshot_pieces_) most = std::max(most, nodes_of(piece).count);
  return sizeof(double) * static_cast<std::size_t>(most);
}

std::vector<double> PartedStepper::snapshot_piece(int k) const {
  const auto& piece = snapshot_pieces_[static_cast<std::size_t>(k)];
  const auto& body = columns_[static_cast<std::size_t>(piece.body)];
  const auto all = nodes_of(piece);
  std::vector<double> values(static_cast<std::size_t>(all.count));
  int part = 0;
  ask(
      PartCommand::snapshot, [&](int) { return Parcel().put(piece); },
      [&](Parcel& answer) {
        const auto own = division_.own(part++);
        const auto of_part = answer.take_all<double>();
        auto from = of_part.begin();
        for (int r = piece.first_row; r < piece.end_row; ++r) {
          const auto nodes = body.nodes(r, {own.begin, own.end});
          std::copy_n(from, nodes.count, values.begin() + (nodes.first - all.first));
          from += nodes.count;
        }
      });
  return values;
}

void PartedStepper::keep(const std::function<void(const KeptMotion& piece)>& take) const {
  ask(PartCommand::keep, nothing, [&](Parcel& answer) {
    auto piece = KeptMotion::take(answer);
    answer = {};
    piece.step = step_;
    take(piece);
  });
}

void PartedStepper::restore(int n_pieces, const std::function<KeptMotion()>& next) {
  for (int k = 0; k < n_pieces; ++k) {
    const auto piece = next();
    ask(PartCommand::restore, [&](int part) {
      // As many parts as kept them go on with their own sums; of another number the first one has them all.
      const bool has_sums = n_pieces == division_.n_parts() ? part == k : part == 0;
      Parcel parcel;
      parcel.put(static_cast<std::uint8_t>(k + 1 == n_pieces));
      piece.in(division_.all(part), all_lower_[static_cast<std::size_t>(part)], columns_, has_sums)
          .put(parcel);
      return parcel;
    });
    step_ = piece.step;
  }
  has_finders_ = false;
}

}  // namespace slipfront::motion
