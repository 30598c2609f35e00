// SPDX-License-Identifier: BSD-3-Clause
#include "motion/distributed_stepper.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <utility>

#include "base/error.hpp"
#include "motion/step_report.hpp"
#include "processes/answers.hpp"

namespace slipfront::motion {

mesh::Subset interface_nodes_in(const mesh::Mesh& mesh, const mesh::Subset& columns) {
  // There each node has its own column; many processes ask for theirs.
  if (mesh.is_interface()) return columns.below(static_cast<int>(std::ssize(mesh.interface_nodes)));
  const mesh::NodeColumns of_nodes(mesh);
  std::vector<mesh::Subset::Range> ranges;
  for (int k = 0; k < std::ssize(mesh.interface_nodes); ++k) {
    if (!columns.has(of_nodes.column_of(mesh.interface_nodes[static_cast<std::size_t>(k)]))) continue;
    if (!ranges.empty() && ranges.back().end == k)
      ++ranges.back().end;
    else
      ranges.push_back({k, k + 1});
  }
  return mesh::Subset(std::move(ranges));
}

namespace {

solid::Span own_interface_nodes_in(const mesh::Mesh& mesh, solid::Span columns) {
  const auto places = interface_nodes_in(mesh, mesh::Subset({{columns.begin, columns.end}}));
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

void put_loads(const Loads& loads, const mesh::Subset& interface_nodes, MessageBuffer& to) {
  for (const auto* values :
       {&loads.prestress_t_Pa, &loads.prestress_p_Pa, &loads.trigger_force_N_per_m, &loads.intact})
    to.put(cut(*values, interface_nodes));
  to.put(loads.trigger);
}

/// Some columns of a field over a whole body, or none of an empty one.
void put_columns(const mesh::NodeColumns& body, const mesh::Subset& columns, const solid::Field& field,
                 MessageBuffer& to) {
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

/// Rows of a body in groups of a chunk's nodes, at most, or single ones.
std::vector<mesh::Subset::Range> rows_at_once(const mesh::NodeColumns& body) {
  std::vector<mesh::Subset::Range> groups;
  std::int64_t nodes = 0;
  for (int r = 0; r < body.n_rows(); ++r) {
    const int of_row = body.row(r).count;
    if (groups.empty() || nodes + of_row > nodes_of_snapshot_chunk) {
      groups.push_back({r, r});
      nodes = 0;
    }
    groups.back().end = r + 1;
    nodes += of_row;
  }
  return groups;
}

}  // namespace

std::vector<SnapshotChunk> snapshot_chunks(std::span<const mesh::NodeColumns> bodies) {
  std::vector<SnapshotChunk> chunks;
  for (int component = 0; component < n_motion_components; ++component)
    for (std::size_t b = 0; b < bodies.size(); ++b)
      for (const auto& [first, end] : rows_at_once(bodies[b]))
        chunks.push_back({MotionComponent{component}, static_cast<int>(b), first, end});
  return chunks;
}

mesh::NodeColumns::Nodes nodes_of(const SnapshotChunk& chunk, std::span<const mesh::NodeColumns> bodies) {
  const auto& body = bodies[static_cast<std::size_t>(chunk.body)];
  const auto first = body.row(chunk.first_row).first;
  return {first, static_cast<int>(body.row(chunk.end_row - 1).end() - first)};
}

DistributedStepper::DistributedStepper(Processes& processes, const Partition& partition,
                                       std::unique_ptr<Subdomain> own,
                                       std::span<const mesh::Mesh* const> bodies)
    : processes_(processes), partition_(partition), own_(std::move(own)) {
  for (const auto* body : bodies) columns_.emplace_back(*body);
  for (int subdomain = 0; subdomain < partition.n_subdomains(); ++subdomain) {
    all_ranks_.push_back(subdomain);
    all_interface_nodes_.push_back(interface_nodes_in(*bodies.front(), partition.all(subdomain)));
    own_interface_nodes_.push_back(own_interface_nodes_in(*bodies.front(), partition.own(subdomain)));
  }
  snapshot_chunks_ = snapshot_chunks(columns_);
}

DistributedStepper::~DistributedStepper() {
  const MessageBuffer release = MessageBuffer().put(SubdomainCommand::release);
  for (int rank = 1; rank < processes_.size(); ++rank) processes_.send(rank, release);
}

void DistributedStepper::ask(std::span<const int> parts, SubdomainCommand command,
                             const std::function<MessageBuffer(int subdomain)>& given,
                             const std::function<void(MessageBuffer& answer)>& take) const {
  const bool asks_own = !parts.empty() && parts.front() == 0;
  const auto others = parts.subspan(asks_own ? 1 : 0);
  or_fail(processes_, [&] {
    for (const int rank : others) processes_.send(rank, MessageBuffer().put(command).append(given(rank)));
  });
  Answers answers(processes_);
  answers.unless_failed([&] {
    if (!asks_own) return;
    auto own = given(0);
    MessageBuffer answer;
    own_->execute(command, own, answer);
    take(answer);
  });
  for (const int rank : others) answers.take(rank, take);
  answers.end();
}

std::vector<MessageBuffer> DistributedStepper::ask_all(SubdomainCommand command,
                                                       const MessageBuffer& given) const {
  return execute_in_tree(processes_, *own_, MessageBuffer().put(command).append(given));
}

MessageBuffer DistributedStepper::gather_joined(SubdomainCommand command) const {
  auto answers = ask_all(command, {});
  return joined(command, answers);
}

std::vector<MessageBuffer> DistributedStepper::ask(
    SubdomainCommand command, const std::function<MessageBuffer(int subdomain)>& given) const {
  std::vector<MessageBuffer> answers;
  ask(command, given, [&](MessageBuffer& answer) { answers.push_back(std::move(answer)); });
  return answers;
}

void DistributedStepper::place(const statics::DistributedField& u_m,
                               const statics::DistributedField& u_per_shear) {
  for (int owner = 0; owner < u_m.partition->n_subdomains(); ++owner) {
    std::array<std::vector<double>, 2> values;  // of one process after the other: no one has all of them
    ask(
        std::array{owner}, SubdomainCommand::kept,
        [&](int) { return std::move(MessageBuffer().put(u_m.number).put(u_per_shear.number)); },
        [&](MessageBuffer& answer) {
          for (auto& of_owner : values) of_owner = answer.take_all<double>();
        });
    const auto nodes = u_m.partition->nodes_of_subdomain(columns_, owner);
    const int first = u_m.partition->first_column[static_cast<std::size_t>(owner)];
    const int end = u_m.partition->first_column[static_cast<std::size_t>(owner) + 1];
    std::vector<int> reached;
    for (const int subdomain : all_ranks_)
      if (const auto columns = partition_.all(subdomain);
          columns.ranges().front().begin < end && columns.ranges().back().end > first)
        reached.push_back(subdomain);
    const auto placed = [&](int subdomain) {
      const auto columns = partition_.all(subdomain);
      MessageBuffer buffer;
      std::size_t before = 0;
      for (std::size_t b = 0; b < columns_.size(); ++b) {
        const auto held = columns_[b].of_subdomain(columns);
        std::vector<mesh::Node> here;
        std::array<std::vector<double>, 2> some;
        for (std::size_t k = 0; k < nodes[b].size(); ++k) {
          if (!columns.has(columns_[b].column_of(nodes[b][k]))) continue;
          here.push_back(held.local_node(nodes[b][k]));
          for (std::size_t f = 0; f < 2; ++f) {
            const auto from = values[f].begin() + static_cast<std::ptrdiff_t>(2 * (before + k));
            some[f].insert(some[f].end(), from, from + 2);
          }
        }
        before += nodes[b].size();
        buffer.put(here).put(some[0]).put(some[1]);
      }
      return buffer;
    };
    ask(reached, SubdomainCommand::place, placed, [](MessageBuffer&) {});
  }
}

void DistributedStepper::start(const statics::Equilibrium& e, double top_speed_m_per_s, const Loads& loads) {
  const bool is_elsewhere = e.u_m.size() == 0 && e.distributed_u_m;
  if (is_elsewhere) place(*e.distributed_u_m, *e.distributed_u_per_shear);
  ask(SubdomainCommand::start, [&](int subdomain) {
    MessageBuffer buffer;
    const auto columns = partition_.all(subdomain);
    const auto& interface_nodes = all_interface_nodes_[static_cast<std::size_t>(subdomain)];
    put_columns(columns_.front(), columns, e.u_m, buffer);
    put_columns(columns_.front(), columns, e.u_per_shear, buffer);
    put_columns(columns_.back(), columns, e.below_u_m, buffer);
    put_columns(columns_.back(), columns, e.below_u_per_shear, buffer);
    buffer.put(static_cast<std::uint8_t>(is_elsewhere && e.distributed_u_m->partition->base_is_relative));
    buffer.put(cut(e.tractions.t_s_Pa, interface_nodes)).put(cut(e.tractions.p_s_Pa, interface_nodes));
    buffer.put(cut(e.contact, interface_nodes)).put(top_speed_m_per_s);
    put_loads(loads, interface_nodes, buffer);
    return buffer;
  });
  has_finders_ = false;
  step_ = 0;
}

void DistributedStepper::set_probes(std::vector<Probe> probes) {
  probes_ = std::move(probes);
  std::vector<std::vector<std::pair<std::size_t, mesh::Cell>>> of_subdomain(
      static_cast<std::size_t>(partition_.n_subdomains()));
  std::vector<int> part_of_probe;
  for (const auto& probe : probes_) {
    const auto& body = columns_[probe.body];
    const int column = body.column_of(probe.node[0]);
    const auto after = std::ranges::upper_bound(partition_.first, column);
    const int subdomain =
        std::min(static_cast<int>(after - partition_.first.begin()) - 1, partition_.n_subdomains() - 1);
    part_of_probe.push_back(subdomain);
    const auto held = body.of_subdomain(partition_.all(subdomain));
    mesh::Cell node{};
    std::ranges::transform(probe.node, node.begin(), [&](std::int64_t n) { return held.local_node(n); });
    of_subdomain[static_cast<std::size_t>(subdomain)].emplace_back(probe.body, node);
  }
  probe_order_.resize(probes_.size());
  std::iota(probe_order_.begin(), probe_order_.end(), std::size_t{0});
  std::ranges::stable_sort(probe_order_, {}, [&](std::size_t p) { return part_of_probe[p]; });
  ask(SubdomainCommand::set_probes, [&](int subdomain) {
    const auto& list = of_subdomain[static_cast<std::size_t>(subdomain)];
    MessageBuffer buffer;
    buffer.put(static_cast<std::uint64_t>(list.size()));
    for (const auto& [body, node] : list) buffer.put(body).put(node);
    return buffer;
  });
}

std::vector<double> DistributedStepper::probed(int which) const {
  std::vector<double> report;
  for (auto& answer : ask(SubdomainCommand::probed)) {
    auto values = answer.take_all<double>();
    if (which > 0) values = answer.take_all<double>();
    report.insert(report.end(), values.begin(), values.end());
  }
  std::vector<double> values(report.size());
  put_probes_in_order(report, values.data());
  return values;
}

void DistributedStepper::put_probes_in_order(std::span<const double> report, double* to) const {
  constexpr std::size_t n_values = 8;
  for (std::size_t k = 0; k < probe_order_.size(); ++k)
    std::ranges::copy(report.subspan(n_values * k, n_values), to + n_values * probe_order_[k]);
}

std::int64_t DistributedStepper::advance(SlipObserver& observer, std::int64_t max_steps,
                                         const StepCallbacks& callbacks) {
  std::int64_t taken = 0;
  // Subdomains keep their logs of tractions between commands.
  constexpr double max_bytes = 16e6;
  int widest = 0;
  for (const auto& own : own_interface_nodes_) widest = std::max(widest, own.end - own.begin);
  const double logged =
      TractionLog::bytes_per_update(widest, observer.finder().halo()) * std::round(step_s() / substep_s());
  const auto at_once = std::max(std::int64_t{1}, static_cast<std::int64_t>(max_bytes / (logged + 1)));
  while (taken < max_steps) {
    const auto n = std::min({max_steps - taken, callbacks.guaranteed_steps(), at_once});
    const auto steps = advance_guaranteed(observer, n, callbacks);
    taken += steps.taken;
    if (!steps.goes_on || callbacks.interrupted()) break;
  }
  return taken;
}

DistributedStepper::Steps DistributedStepper::advance_guaranteed(SlipObserver& observer, std::int64_t n_steps,
                                                                 const StepCallbacks& callbacks) {
  const auto first_step = step_;
  std::vector<record::History*> samples;
  std::vector<std::uint8_t> is_sampled;
  for (std::int64_t k = 0; k < n_steps; ++k, ++step_) {
    samples.push_back(callbacks.sample());
    is_sampled.push_back(samples.back() != nullptr);
  }
  step_ = first_step;
  auto& finder = observer.finder();
  if (!has_finders_)
    ask(SubdomainCommand::memory, [&](int subdomain) {
      const auto& known = finder.memory();
      const auto& interface_nodes = all_interface_nodes_[static_cast<std::size_t>(subdomain)];
      MessageBuffer buffer;
      buffer.put(known.time_s);
      for (const auto* values : {&known.t_Pa, &known.p_Pa, &known.strength_Pa})
        buffer.put(cut(*values, interface_nodes));
      buffer.put(cut(known.slipping, interface_nodes)).put(finder.halo()).put(finder.creep_m_per_s());
      return buffer;
    });
  has_finders_ = true;

  auto answers = ask_all(SubdomainCommand::advance, MessageBuffer().put(is_sampled));
  auto report = StepReport::take_joined(answers);
  SLIPFRONT_ASSERT(report.memory.t_Pa.size() == finder.memory().t_Pa.size(), "the subdomains have all nodes");
  finder.memory() = std::move(report.memory);
  add_tractions_of_others(report.seen, finder.n_around());
  SlipUpdateIterator slips(report.seen, finder.n_around());
  const auto n_substeps = std::lround(step_s() / substep_s());
  const auto n_nodes = static_cast<std::ptrdiff_t>(finder.memory().t_Pa.size());
  const auto n_displacements = displacement_values(probes_);
  std::ptrdiff_t row = 0;
  for (std::int64_t k = 0; k < n_steps; ++k) {
    for (long substep = 0; substep < n_substeps; ++substep) observer.at_update(slips.next());
    if (auto* to = samples[static_cast<std::size_t>(k)]; to != nullptr) {
      to->time_s.push_back(time_s());
      for (std::size_t f = 0; f < record::history_fields.size(); ++f) {
        auto& field = to->*record::history_fields[f].member;
        const auto from = report.samples[f].begin() + row * n_nodes;
        field.insert(field.end(), from, from + n_nodes);
      }
      ++row;
    }
    if (n_displacements > 0)
      if (double* to = callbacks.displacements(step_ + 1); to != nullptr)
        put_probes_in_order(std::span(report.displacements)
                                .subspan(static_cast<std::size_t>(k) * n_displacements, n_displacements),
                            to);
    ++step_;
    // Before the last of these steps only a motion that is not physical is refused. The subdomains have gone
    // on: the energy reported is that of the last step.
    if (!callbacks.may_continue(report.rates[static_cast<std::size_t>(k)])) return {k + 1, false};
  }
  return {n_steps, true};
}

void DistributedStepper::add_tractions_of_others(SlipUpdates& seen, std::size_t n_around) const {
  const int reach = static_cast<int>(n_around / 2);
  struct Gap {           // of some nodes around an onset, which another subdomain knows
    std::size_t at = 0;  // where their tractions are to go in SlipUpdates::around
    double share = 0;
  };
  struct Asked {
    std::vector<TractionRequest> wanted;
    std::vector<Gap> gaps;
  };
  std::map<int, Asked> of_subdomain;
  std::size_t first_around = 0;
  for (std::size_t c = 0; c < seen.changes.size(); ++c) {
    const auto& change = seen.changes[c];
    if (!change.begins) continue;
    auto other = std::ranges::upper_bound(own_interface_nodes_, change.node - reach, {}, &solid::Span::end);
    for (; other != own_interface_nodes_.end() && other->begin <= change.node + reach; ++other) {
      if (change.node >= other->begin && change.node < other->end) continue;  // it knows them itself
      const auto subdomain = static_cast<int>(other - own_interface_nodes_.begin());
      const int begin = std::max(other->begin, change.node - reach);
      const int end = std::min(other->end, change.node + reach + 1);
      const int place = all_interface_nodes_[static_cast<std::size_t>(subdomain)].place_of(begin);
      auto& asked = of_subdomain[subdomain];
      asked.wanted.push_back({seen.update[c], {place, place + end - begin}});
      asked.gaps.push_back(
          {first_around + static_cast<std::size_t>(begin - (change.node - reach)), change.share});
    }
    first_around += n_around;
  }
  SLIPFRONT_ASSERT(seen.around.size() == first_around, "tractions around each onset");
  std::vector<int> parts;
  for (const auto& asked : of_subdomain) parts.push_back(asked.first);
  auto next = of_subdomain.begin();
  ask(
      parts, SubdomainCommand::tractions,
      [&](int subdomain) { return std::move(MessageBuffer().put(of_subdomain[subdomain].wanted)); },
      [&](MessageBuffer& answer) {
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

record::Energies DistributedStepper::energies() {
  auto sum = gather_joined(SubdomainCommand::energies).take<record::Energies>();
  sum.time_s = time_s();
  return sum;
}

std::vector<SubdomainMeasures> DistributedStepper::measures() const {
  return gather_joined(SubdomainCommand::measures).take_all<SubdomainMeasures>();
}

std::vector<SubdomainCost> DistributedStepper::costs() const {
  std::vector<SubdomainCost> costs;
  for (const auto& m : measures()) costs.push_back(m.cost);
  return costs;
}

double DistributedStepper::node_updates_per_step() const {
  double sum = 0;
  for (const auto& m : measures()) sum += m.node_updates_per_step;
  return sum;
}

double DistributedStepper::kinetic_energy_J_per_m() const {
  double sum = 0;
  for (const auto& m : measures()) sum += m.kinetic_J_per_m;
  return sum;
}

double DistributedStepper::mass_kg_per_m() const {
  double sum = 0;
  for (const auto& m : measures()) sum += m.mass_kg_per_m;
  return sum;
}

double DistributedStepper::energy_of_tractions_J_per_m() const {
  double mass = 0, a = 0;
  for (const auto& m : measures()) {
    mass += m.plate_mass_kg_per_m;
    a = std::max(a, m.largest_acceleration_m_per_s2);
  }
  const double v = stable_step_s() * a;
  return 0.5 * mass * v * v;
}

std::int64_t DistributedStepper::n_nodes() const {
  std::int64_t n = 0;
  for (const auto& body : columns_) n += body.n_nodes();
  return n;
}

std::size_t DistributedStepper::snapshot_chunk_bytes() const {
  int most = 0;
  for (const auto& chunk : snapshot_chunks_) most = std::max(most, nodes_of(chunk, columns_).count);
  return sizeof(double) * static_cast<std::size_t>(most);
}

std::vector<double> DistributedStepper::snapshot_chunk(int k) const {
  const auto& chunk = snapshot_chunks_[static_cast<std::size_t>(k)];
  const auto& body = columns_[static_cast<std::size_t>(chunk.body)];
  const auto all = nodes_of(chunk, columns_);
  std::vector<double> values(static_cast<std::size_t>(all.count));
  int subdomain = 0;
  ask(
      SubdomainCommand::snapshot, [&](int) { return MessageBuffer().put(chunk); },
      [&](MessageBuffer& answer) {
        const auto own = partition_.own(subdomain++);
        const auto of_subdomain = answer.take_all<double>();
        auto from = of_subdomain.begin();
        for (int r = chunk.first_row; r < chunk.end_row; ++r) {
          const auto nodes = body.nodes(r, {own.begin, own.end});
          std::copy_n(from, nodes.count, values.begin() + (nodes.first - all.first));
          from += nodes.count;
        }
      });
  return values;
}

void DistributedStepper::keep(const std::function<void(const StateByNode& chunk)>& take) {
  int number = 0;
  ask(SubdomainCommand::keep, nothing, [&](MessageBuffer& answer) {
    auto chunk = StateByNode::take(answer);
    answer = {};
    chunk.step = step_;
    chunk.number = number++;
    chunk.n_chunks = partition_.n_subdomains();
    take(chunk);
  });
}

void DistributedStepper::restore(const Loads& loads, const std::function<StateByNode()>& next) {
  for (bool is_last = false; !is_last;) {
    const auto chunk = next();
    ask(SubdomainCommand::restore, [&](int subdomain) {
      // As many subdomains as kept them go on with their own sums; of another number the first one has them
      // all.
      const bool has_sums =
          chunk.n_chunks == partition_.n_subdomains() ? subdomain == chunk.number : subdomain == 0;
      const auto& interface_nodes = all_interface_nodes_[static_cast<std::size_t>(subdomain)];
      MessageBuffer buffer;
      put_loads(loads, interface_nodes, buffer);
      chunk.in(partition_.all(subdomain), interface_nodes, columns_, has_sums).put(buffer);
      return buffer;
    });
    step_ = chunk.step;
    is_last = chunk.is_last();
  }
  has_finders_ = false;
}

}  // namespace slipfront::motion
