// SPDX-License-Identifier: BSD-3-Clause
#include "motion/parted_stepper.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <utility>

#include "base/error.hpp"
#include "motion/steps_told.hpp"
#include "processes/answers.hpp"

namespace slipfront::motion {

mesh::Subset lower_in(const mesh::Mesh& mesh, const mesh::Subset& columns) {
  // There each node has its own column; many processes ask for theirs.
  if (mesh.is_interface()) return columns.below(static_cast<int>(std::ssize(mesh.lower)));
  const mesh::NodeColumns of_nodes(mesh);
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

/// Rows of a body in groups of a piece's nodes, at most, or single ones.
std::vector<mesh::Subset::Range> rows_at_once(const mesh::NodeColumns& body) {
  std::vector<mesh::Subset::Range> groups;
  std::int64_t nodes = 0;
  for (int r = 0; r < body.n_rows(); ++r) {
    const int of_row = body.row(r).count;
    if (groups.empty() || nodes + of_row > nodes_of_snapshot_piece) {
      groups.push_back({r, r});
      nodes = 0;
    }
    groups.back().end = r + 1;
    nodes += of_row;
  }
  return groups;
}

}  // namespace

std::vector<SnapshotPiece> snapshot_pieces(std::span<const mesh::NodeColumns> bodies) {
  std::vector<SnapshotPiece> pieces;
  for (int component = 0; component < n_motion_components; ++component)
    for (std::size_t b = 0; b < bodies.size(); ++b)
      for (const auto& [first, end] : rows_at_once(bodies[b]))
        pieces.push_back({MotionComponent{component}, static_cast<int>(b), first, end});
  return pieces;
}

mesh::NodeColumns::Nodes nodes_of(const SnapshotPiece& piece, std::span<const mesh::NodeColumns> bodies) {
  const auto& body = bodies[static_cast<std::size_t>(piece.body)];
  const auto first = body.row(piece.first_row).first;
  return {first, static_cast<int>(body.row(piece.end_row - 1).end() - first)};
}

PartedStepper::PartedStepper(Processes& processes, const Division& division, std::unique_ptr<Part> own,
                             std::span<const mesh::Mesh* const> bodies)
    : processes_(processes), division_(division), own_(std::move(own)) {
  for (const auto* body : bodies) columns_.emplace_back(*body);
  for (int part = 0; part < division.n_parts(); ++part) {
    all_parts_.push_back(part);
    all_lower_.push_back(lower_in(*bodies.front(), division.all(part)));
    own_lower_.push_back(own_lower_in(*bodies.front(), division.own(part)));
  }
  snapshot_pieces_ = snapshot_pieces(columns_);
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
  or_fail(processes_, [&] {
    for (const int rank : others) processes_.send(rank, Parcel().put(command).append(given(rank)));
  });
  Answers answers(processes_);
  answers.unless_failed([&] {
    if (!asks_own) return;
    auto own = given(0);
    Parcel answer;
    own_->carry_out(command, own, answer);
    take(answer);
  });
  for (const int rank : others) answers.take(rank, take);
  answers.end();
}

std::vector<Parcel> PartedStepper::ask_all(PartCommand command, const Parcel& given) const {
  return carry_out_with_others(processes_, *own_, Parcel().put(command).append(given));
}

Parcel PartedStepper::all_told(PartCommand command) const {
  auto answers = ask_all(command, {});
  return joined(command, answers);
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
  std::vector<std::vector<std::pair<std::size_t, mesh::Cell>>> of_part(
      static_cast<std::size_t>(division_.n_parts()));
  std::vector<int> part_of_probe;
  for (const auto& probe : probes_) {
    const auto& body = columns_[probe.body];
    const int column = body.column_of(probe.node[0]);
    const auto after = std::ranges::upper_bound(division_.first, column);
    const int part = std::min(static_cast<int>(after - division_.first.begin()) - 1, division_.n_parts() - 1);
    part_of_probe.push_back(part);
    const auto held = body.of_part(division_.all(part));
    mesh::Cell node{};
    std::ranges::transform(probe.node, node.begin(), [&](std::int64_t n) { return held.node_of_whole(n); });
    of_part[static_cast<std::size_t>(part)].emplace_back(probe.body, node);
  }
  told_probes_.resize(probes_.size());
  std::iota(told_probes_.begin(), told_probes_.end(), std::size_t{0});
  std::ranges::stable_sort(told_probes_, {}, [&](std::size_t p) { return part_of_probe[p]; });
  ask(PartCommand::watch, [&](int part) {
    const auto& list = of_part[static_cast<std::size_t>(part)];
    Parcel parcel;
    parcel.put(static_cast<std::uint64_t>(list.size()));
    for (const auto& [body, node] : list) parcel.put(body).put(node);
    return parcel;
  });
}

std::vector<double> PartedStepper::probed(int which) const {
  std::vector<double> told;
  for (auto& answer : ask(PartCommand::probed)) {
    auto values = answer.take_all<double>();
    if (which > 0) values = answer.take_all<double>();
    told.insert(told.end(), values.begin(), values.end());
  }
  std::vector<double> values(told.size());
  put_probes_in_order(told, values.data());
  return values;
}

void PartedStepper::put_probes_in_order(std::span<const double> told, double* to) const {
  constexpr std::size_t n_values = 8;
  for (std::size_t k = 0; k < told_probes_.size(); ++k)
    std::ranges::copy(told.subspan(n_values * k, n_values), to + n_values * told_probes_[k]);
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
  auto& finder = recorder.finder();
  if (!has_finders_)
    ask(PartCommand::memory, [&](int part) {
      const auto& known = finder.memory();
      const auto& lower = all_lower_[static_cast<std::size_t>(part)];
      Parcel parcel;
      parcel.put(known.time_s);
      for (const auto* values : {&known.t_Pa, &known.p_Pa, &known.strength_Pa})
        parcel.put(cut(*values, lower));
      parcel.put(cut(known.slipping, lower)).put(recorder.record().halo).put(finder.creep_m_per_s());
      return parcel;
    });
  has_finders_ = true;

  auto answers = ask_all(PartCommand::advance, Parcel().put(is_sampled));
  auto told = StepsTold::take_joined(answers);
  SLIPFRONT_ASSERT(told.memory.t_Pa.size() == finder.memory().t_Pa.size(), "the parts have all nodes");
  finder.memory() = std::move(told.memory);
  add_tractions_of_others(told.seen, finder.n_around());
  SlipsInTurn slips(told.seen, finder.n_around());
  const auto n_substeps = std::lround(step_s() / substep_s());
  const auto n_nodes = static_cast<std::ptrdiff_t>(finder.memory().t_Pa.size());
  const auto n_displacements = displacement_values(probes_);
  std::ptrdiff_t row = 0;
  for (std::int64_t k = 0; k < n_steps; ++k) {
    for (long substep = 0; substep < n_substeps; ++substep) recorder.take(slips.next());
    if (auto* to = samples[static_cast<std::size_t>(k)]; to != nullptr) {
      to->time_s.push_back(time_s());
      for (std::size_t f = 0; f < record::history_fields.size(); ++f) {
        auto& field = to->*record::history_fields[f].member;
        const auto from = told.samples[f].begin() + row * n_nodes;
        field.insert(field.end(), from, from + n_nodes);
      }
      ++row;
    }
    if (n_displacements > 0)
      if (double* to = between.displacements(step_ + 1); to != nullptr)
        put_probes_in_order(std::span(told.displacements)
                                .subspan(static_cast<std::size_t>(k) * n_displacements, n_displacements),
                            to);
    ++step_;
    // Before the last of these steps only a motion that is not physical is refused. The parts have gone on:
    // what is told of its energy is that of their last step.
    if (!between.go_on(told.rates[static_cast<std::size_t>(k)])) return {k + 1, false};
  }
  return {n_steps, true};
}

void PartedStepper::add_tractions_of_others(SlipsSeen& seen, std::size_t n_around) const {
  const int reach = static_cast<int>(n_around / 2);
  struct Gap {           // of some nodes around an onset, which another part knows
    std::size_t at = 0;  // where their tractions are to go in SlipsSeen::around
    double share = 0;
  };
  struct Asked {
    std::vector<TractionsWanted> wanted;
    std::vector<Gap> gaps;
  };
  std::map<int, Asked> of_part;
  std::size_t first_around = 0;
  for (std::size_t c = 0; c < seen.changes.size(); ++c) {
    const auto& change = seen.changes[c];
    if (!change.begins) continue;
    auto other = std::ranges::upper_bound(own_lower_, change.node - reach, {}, &solid::Span::end);
    for (; other != own_lower_.end() && other->begin <= change.node + reach; ++other) {
      if (change.node >= other->begin && change.node < other->end) continue;  // it knows them itself
      const auto part = static_cast<int>(other - own_lower_.begin());
      const int begin = std::max(other->begin, change.node - reach);
      const int end = std::min(other->end, change.node + reach + 1);
      const int place = all_lower_[static_cast<std::size_t>(part)].place_of(begin);
      auto& asked = of_part[part];
      asked.wanted.push_back({seen.update[c], {place, place + end - begin}});
      asked.gaps.push_back(
          {first_around + static_cast<std::size_t>(begin - (change.node - reach)), change.share});
    }
    first_around += n_around;
  }
  SLIPFRONT_ASSERT(seen.around.size() == first_around, "tractions around each onset");
  std::vector<int> parts;
  for (const auto& asked : of_part) parts.push_back(asked.first);
  auto next = of_part.begin();
  ask(
      parts, PartCommand::tractions, [&](int part) { return std::move(Parcel().put(of_part[part].wanted)); },
      [&](Parcel& answer) {
        const auto& [wanted, gaps] = next->second;
        for (std::size_t k = 0; k < wanted.size(); ++k)
          for (int n = 0; n < wanted[k].nodes.end - wanted[k].nodes.begin; ++n) {
            const auto before = answer.take<record::Traction>();
            const auto after = answer.take<record::Traction>();
            seen.around[gaps[k].at + static_cast<std::size_t>(n)] =
                traction_between(before, after, gaps[k].share);
          }
        ++next;
      });
}

record::Energies PartedStepper::energies() {
  auto sum = all_told(PartCommand::energies).take<record::Energies>();
  sum.time_s = time_s();
  return sum;
}

std::vector<PartMeasures> PartedStepper::measures() const {
  return all_told(PartCommand::measures).take_all<PartMeasures>();
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

std::size_t PartedStepper::snapshot_piece_bytes() const {
  int most = 0;
  for (const auto& piece : snapshot_pieces_) most = std::max(most, nodes_of(piece, columns_).count);
  return sizeof(double) * static_cast<std::size_t>(most);
}

std::vector<double> PartedStepper::snapshot_piece(int k) const {
  const auto& piece = snapshot_pieces_[static_cast<std::size_t>(k)];
  const auto& body = columns_[static_cast<std::size_t>(piece.body)];
  const auto all = nodes_of(piece, columns_);
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
