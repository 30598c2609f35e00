// SPDX-License-Identifier: BSD-3-Clause
#include "motion/distributed_stepper.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "base/error.hpp"
#include "base/memory.hpp"
#include "motion/step_report.hpp"

namespace slipfront::motion {

namespace {

solid::Span own_interface_nodes_in(const mesh::Mesh& mesh, solid::Span columns) {
  const auto places = interface_nodes_in(mesh, mesh::Subset({columns}));
  SLIPFRONT_ASSERT(places.ranges().size() == 1, "interface nodes in the order of columns");
  return places.ranges().front();
}

Loads cut(Loads loads, const mesh::Subset& places) {
  for (auto* values : Loads::arrays(loads)) *values = places.of(*values);
  for (auto& values : loads.law_states) values = places.of(values);
  return loads;
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
    MessageArchive archive(to);
    archive(values);
  }
}

/// Rows of a body in groups of a chunk's nodes, at most, or single ones.
std::vector<solid::Span> rows_at_once(const mesh::NodeColumns& body) {
  std::vector<solid::Span> groups;
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

/// Logs several steps for the report.
class Log final : public StepObserver {
 public:
  /// @param places      of the subdomain's nodes along the whole interface
  /// @param is_sampled  of each step
  /// @param n_values    of the probes in a step
  Log(SlipFinder& finder, const mesh::Subset& places, TractionLog& tractions,
      const std::vector<std::uint8_t>& is_sampled, std::int64_t first_step, std::size_t n_values,
      StepReport& to)
      : finder_(finder),
        places_(places),
        tractions_(tractions),
        is_sampled_(is_sampled),
        first_step_(first_step),
        n_values_(n_values),
        to_(to) {}
  void observe(double time_s, const interface::Interface& state, bool changed) override {
    finder_.find(time_s, state, changed, seen_);
    tractions_.add(state.t_Pa, state.p_Pa);
    for (auto& change : seen_.changes) change.node = places_.number_at(change.node);
    to_.seen.add(seen_);
  }
  record::History* row() override { return is_sampled_[n_asked_++] != 0 ? &samples_ : nullptr; }
  double* displacements(std::int64_t step) override {
    return to_.displacements.data() + n_values_ * static_cast<std::size_t>(step - first_step_ - 1);
  }
  bool after_step(const SlipRates& rates) override {
    to_.rates.push_back(rates);
    return true;
  }
  record::History& samples() { return samples_; }

 private:
  SlipFinder& finder_;
  const mesh::Subset& places_;
  TractionLog& tractions_;
  const std::vector<std::uint8_t>& is_sampled_;
  std::int64_t first_step_;
  std::size_t n_values_;
  StepReport& to_;
  SlipUpdate seen_;
  record::History samples_;
  std::size_t n_asked_ = 0;
};

}  // namespace

mesh::Subset interface_nodes_in(const mesh::Mesh& mesh, const mesh::Subset& columns) {
  // There each node has its own column; it is asked for each rank.
  if (mesh.is_interface()) return columns.below(static_cast<int>(std::ssize(mesh.interface_nodes)));
  const mesh::NodeColumns of_nodes(mesh);
  std::vector<solid::Span> ranges;
  for (int k = 0; k < std::ssize(mesh.interface_nodes); ++k) {
    if (!columns.has(of_nodes.column_of(mesh.interface_nodes[static_cast<std::size_t>(k)]))) continue;
    if (!ranges.empty() && ranges.back().end == k)
      ++ranges.back().end;
    else
      ranges.push_back({k, k + 1});
  }
  return mesh::Subset(std::move(ranges));
}

Decomposition decomposition_of(Partition partition, std::span<const mesh::Mesh* const> bodies) {
  Decomposition whole{std::move(partition), {}, {}, {}};
  for (const auto* body : bodies) whole.blocks.push_back(mesh::blocks(*body));
  for (int k = 0; k < whole.partition.n_subdomains(); ++k) {
    whole.interface_nodes.push_back(interface_nodes_in(*bodies.front(), whole.partition.all(k)));
    whole.own_interface_nodes.push_back(own_interface_nodes_in(*bodies.front(), whole.partition.own(k)));
  }
  return whole;
}

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

DistributedStepper::DistributedStepper(Processes& processes, Decomposition whole,
                                       std::span<const BodySource> own,
                                       const interface::ContactModel& contact, const TimeStepping& time,
                                       const Execution& execution)
    : processes_(processes), whole_(std::move(whole)) {
  for (const auto& blocks : whole_.blocks) columns_.emplace_back(blocks);
  snapshot_chunks_ = snapshot_chunks(columns_);
  auto sharing = execution;
  sharing.max_steps = partition().steps_per_exchange;
  stepper_ = std::make_unique<Stepper>(own, contact, time, sharing);
  halo_ = std::make_unique<Halo>(processes, partition(), *stepper_, sharing.halo_stage_bytes);
}

DistributedStepper::~DistributedStepper() = default;

void DistributedStepper::start(const statics::Equilibrium& e, double top_speed_m_per_s, Loads loads) {
  halo_->finish();
  auto fields = processes_.scatter([&](int subdomain) {
    MessageBuffer buffer;
    const auto columns = partition().all(subdomain);
    put_columns(columns_.front(), columns, e.u_m, buffer);
    put_columns(columns_.front(), columns, e.u_per_shear, buffer);
    put_columns(columns_.back(), columns, e.below_u_m, buffer);
    put_columns(columns_.back(), columns, e.below_u_per_shear, buffer);
    return buffer;
  });
  statics::Equilibrium own;
  for (auto* field : own.displacements()) *field = unpacked<solid::Field>(fields);
  fields = {};
  own.tractions.t_s_Pa = own_places().of(e.tractions.t_s_Pa);
  own.tractions.p_s_Pa = own_places().of(e.tractions.p_s_Pa);
  own.contact = own_places().of(e.contact);
  stepper_->start(own, top_speed_m_per_s, cut(std::move(loads), own_places()));
  own = {};
  return_freed_memory();
  halo_->renew();
  begin_counting();
}

void DistributedStepper::begin_counting() {
  finder_.reset();
  step_ = stepper_->step();
  counted_before_ = processes_.counters();
  first_counted_step_ = step_;
}

void DistributedStepper::set_probes(std::vector<Probe> probes) {
  probes_ = std::move(probes);
  std::vector<int> subdomain_of_probe;
  std::vector<Probe> own;
  for (const auto& probe : probes_) {
    const auto& body = columns_[probe.body];
    const auto after = std::ranges::upper_bound(partition().first, body.column_of(probe.node[0]));
    const int subdomain =
        std::min(static_cast<int>(after - partition().first.begin()) - 1, partition().n_subdomains() - 1);
    subdomain_of_probe.push_back(subdomain);
    if (subdomain != processes_.rank()) continue;
    const auto held = body.of_subdomain(partition().all(subdomain));
    own.push_back(probe);
    for (auto& n : own.back().node) n = held.local_node(n);
  }
  probe_order_.resize(probes_.size());
  std::iota(probe_order_.begin(), probe_order_.end(), std::size_t{0});
  std::ranges::stable_sort(probe_order_, {}, [&](std::size_t p) { return subdomain_of_probe[p]; });
  stepper_->set_probes(std::move(own));
}

std::vector<double> DistributedStepper::gathered(const std::vector<double>& own) const {
  std::vector<double> report;
  for (auto& of_rank : processes_.all_gather(packed(own))) {
    const auto values = unpacked<std::vector<double>>(of_rank);
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

std::int64_t DistributedStepper::advance(SlipObserver& observer, std::int64_t max_steps) {
  // Each rank logs tractions near its ends, and all hold what they are shown of the whole interface.
  constexpr double max_bytes = 16e6;
  int widest = 0;
  for (const auto& own : whole_.own_interface_nodes) widest = std::max(widest, own.end - own.begin);
  const double of_update = TractionLog::bytes_per_update(widest, observer.finder().halo());
  const auto of_row = static_cast<double>(
      sizeof(double) *
      record::history_row_values(static_cast<std::size_t>(whole_.own_interface_nodes.back().end),
                                 stepper_->interface_state().law_states.size()));
  const double bytes = of_update * stepper_->plan().period + of_row;
  const auto at_once = std::max(std::int64_t{1}, static_cast<std::int64_t>(max_bytes / bytes));
  std::int64_t taken = 0;
  for (is_interrupted_ = false; taken < max_steps && !is_interrupted_;) {
    const auto n = std::min({max_steps - taken, observer.guaranteed_steps(), at_once});
    const auto steps = advance_guaranteed(observer, n);
    taken += steps.shown;
    if (!steps.goes_on) break;
  }
  return taken;
}

DistributedStepper::Steps DistributedStepper::advance_guaranteed(SlipObserver& observer,
                                                                 std::int64_t n_steps) {
  const auto first_step = step_;
  std::vector<record::History*> samples;
  std::vector<std::uint8_t> is_sampled;
  for (std::int64_t k = 0; k < n_steps; ++k, ++step_) {
    samples.push_back(observer.row());
    is_sampled.push_back(samples.back() != nullptr);
  }
  step_ = first_step;
  auto& finder = observer.finder();
  if (!finder_) make_finder(finder);
  auto own = advance_own(is_sampled);
  own.is_interrupted = observer.is_interrupted();
  auto report = StepReport::joined(processes_.all_gather(packed(own)));
  is_interrupted_ = report.is_interrupted;
  SLIPFRONT_ASSERT(report.memory.t_Pa.size() == finder.memory().t_Pa.size(), "the subdomains have all nodes");
  finder.memory() = std::move(report.memory);
  add_tractions_of_others(report.seen, finder.n_around());
  SlipUpdateIterator slips(report.seen, finder.n_around());
  const auto n_nodes = static_cast<std::ptrdiff_t>(finder.memory().t_Pa.size());
  const auto n_displacements = displacement_values(probes_);
  std::ptrdiff_t row = 0;
  for (std::int64_t k = 0; k < n_steps; ++k) {
    for (int substep = 0; substep < stepper_->plan().period; ++substep) observer.at_update(slips.next());
    if (auto* to = samples[static_cast<std::size_t>(k)]; to != nullptr) {
      to->time_s.push_back(time_s());
      to->law_states.resize(stepper_->interface_state().law_states.size());
      const auto members = members_of(*to);
      for (std::size_t f = 0; f < report.samples.size(); ++f) {
        auto& field = *members[1 + f];
        const auto from = report.samples[f].begin() + row * n_nodes;
        field.insert(field.end(), from, from + n_nodes);
      }
      ++row;
    }
    if (n_displacements > 0)
      if (double* to = observer.displacements(step_ + 1); to != nullptr)
        put_probes_in_order(std::span(report.displacements)
                                .subspan(static_cast<std::size_t>(k) * n_displacements, n_displacements),
                            to);
    ++step_;
    // Before the last of these steps only a motion that is not physical is refused. The subdomains have gone
    // on: the energy reported is that of the last step.
    if (!observer.after_step(report.rates[static_cast<std::size_t>(k)])) return {k + 1, false};
  }
  return {n_steps, true};
}

void DistributedStepper::make_finder(const SlipFinder& whole) {
  const auto& known = whole.memory();
  const auto& places = own_places();
  SlipFinder::Memory memory{known.time_s,
                            places.of(known.t_Pa),
                            places.of(known.p_Pa),
                            places.of(known.strength_Pa),
                            places.of(known.onset_ratio),
                            places.of(known.slipping)};
  const auto own = stepper_->bodies().front().interface_side().own;
  finder_.emplace(std::move(memory), static_cast<std::size_t>(own.begin), static_cast<std::size_t>(own.end),
                  whole.halo(), whole.creep_m_per_s());
  log_ = TractionLog(own, whole.halo());
}

StepReport DistributedStepper::advance_own(const std::vector<std::uint8_t>& is_sampled) {
  const auto n_steps = std::ssize(is_sampled);
  const std::size_t n_values = displacement_values(stepper_->probes());
  StepReport report;
  report.displacements.resize(n_values * static_cast<std::size_t>(n_steps));
  log_.clear();
  log_.add(finder_->memory().t_Pa, finder_->memory().p_Pa);
  Log log(*finder_, own_places(), log_, is_sampled, stepper_->step(), n_values, report);
  halo_->advance(log, n_steps);
  const auto& memory = finder_->memory();
  // Only own nodes of the interface count; the samples have no others.
  const auto own = stepper_->bodies().front().interface_side().own;
  const auto own_of = [&]<class T>(const std::vector<T>& values) {
    return std::vector<T>(values.begin() + own.begin, values.begin() + own.end);
  };
  report.memory = {memory.time_s,
                   own_of(memory.t_Pa),
                   own_of(memory.p_Pa),
                   own_of(memory.strength_Pa),
                   own_of(memory.onset_ratio),
                   own_of(memory.slipping)};
  auto& samples = log.samples();
  for (auto* values : members_of(samples))
    if (values != &samples.time_s) report.samples.push_back(std::move(*values));
  return report;
}

void DistributedStepper::add_tractions_of_others(SlipUpdates& seen, std::size_t n_around) {
  const int reach = static_cast<int>(n_around / 2);
  struct Gap {  // a node near an onset that another subdomain owns
    std::size_t owner = 0, update = 0;
    int node = 0;
    std::size_t at = 0;  // where its tractions are to go in SlipUpdates::around
    double share = 0;
  };
  std::vector<Gap> gaps;
  const auto& owned = whole_.own_interface_nodes;
  std::size_t first_around = 0;
  for (std::size_t c = 0; c < seen.changes.size(); ++c) {
    const auto& change = seen.changes[c];
    if (!change.begins) continue;
    auto other = std::ranges::upper_bound(owned, change.node - reach, {}, &solid::Span::end);
    for (; other != owned.end() && other->begin <= change.node + reach; ++other) {
      if (change.node >= other->begin && change.node < other->end) continue;  // it knows them itself
      for (int n = std::max(other->begin, change.node - reach);
           n < std::min(other->end, change.node + reach + 1); ++n)
        gaps.push_back({static_cast<std::size_t>(other - owned.begin()),
                        static_cast<std::size_t>(seen.update[c]), n,
                        first_around + static_cast<std::size_t>(n - (change.node - reach)), change.share});
    }
    first_around += n_around;
  }
  SLIPFRONT_ASSERT(seen.around.size() == first_around, "tractions around each onset");
  if (gaps.empty()) return;  // on all ranks
  MessageBuffer own;
  MessageArchive archive(own);
  for (const auto& gap : gaps) {
    if (gap.owner != rank()) continue;
    const int place = own_places().place_of(gap.node);
    archive(record::between(log_.at(gap.update, place), log_.at(gap.update + 1, place), gap.share));
  }
  auto of_ranks = processes_.all_gather(own);
  for (const auto& gap : gaps) seen.around[gap.at] = unpacked<record::Traction>(of_ranks[gap.owner]);
}

std::vector<double> DistributedStepper::probed_u_m() const {
  halo_->finish();
  return gathered(stepper_->probed_u_m());
}

std::vector<double> DistributedStepper::probed_v_m_per_s() const {
  halo_->finish();
  return gathered(stepper_->probed_v_m_per_s());
}

double DistributedStepper::sum(double own) const {
  const auto of_ranks = processes_.all_gather_value(own);
  return std::accumulate(of_ranks.begin(), of_ranks.end(), 0.0);
}

record::Energies DistributedStepper::energies() {
  halo_->finish();
  record::Energies sum;
  for (const auto& of_rank : processes_.all_gather_value(stepper_->energies())) add_terms(sum, of_rank);
  sum.time_s = time_s();
  return sum;
}

record::Breakdown DistributedStepper::breakdown() const {
  halo_->finish();
  record::Breakdown all;
  for (const auto& own : processes_.all_gather_value(stepper_->breakdown()))
    for (const auto& field : record::breakdown_fields)
      (all.*field.member)
          .insert((all.*field.member).end(), (own.*field.member).begin(), (own.*field.member).end());
  return all;
}

record::History DistributedStepper::interface_row() const {
  halo_->finish();
  auto row = stepper_->interface_row();
  for (auto* values : members_of(row)) {
    if (values == &row.time_s) continue;
    const auto of_ranks = processes_.all_gather_value(std::exchange(*values, {}));
    for (const auto& own : of_ranks) values->insert(values->end(), own.begin(), own.end());
  }
  return row;
}

std::vector<SubdomainCost> DistributedStepper::costs() const {
  const auto& now = processes_.counters();
  return processes_.all_gather_value(
      SubdomainCost{.steps = stepper_->step() - first_counted_step_,
                    .messages = now.messages - counted_before_.messages,
                    .bytes = now.bytes - counted_before_.bytes,
                    .computing_s = halo_->computing_s(),
                    .exchange_s = now.exchange_s - counted_before_.exchange_s,
                    .collective_s = now.collective_s - counted_before_.collective_s});
}

double DistributedStepper::node_updates_per_step() const {
  return sum(stepper_->node_updates_per_step());
}

double DistributedStepper::kinetic_energy_J_per_m() const {
  halo_->finish();
  return sum(stepper_->kinetic_energy_J_per_m());
}

double DistributedStepper::mass_kg_per_m() const {
  return sum(stepper_->mass_kg_per_m());
}

double DistributedStepper::energy_of_tractions_J_per_m() const {
  halo_->finish();
  double a_m_per_s2 = stepper_->largest_acceleration_m_per_s2();
  processes_.reduce_max(std::span(&a_m_per_s2, 1));
  const double v_m_per_s = stable_step_s() * a_m_per_s2;
  return 0.5 * sum(stepper_->bodies().front().mass_kg_per_m()) * v_m_per_s * v_m_per_s;
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
  halo_->finish();
  const auto& chunk = snapshot_chunks_[static_cast<std::size_t>(k)];
  const auto body = static_cast<std::size_t>(chunk.body);
  // In rows [first, end) of a body those of a subdomain's own columns.
  const auto for_own_nodes = [&](const mesh::NodeColumns& columns, int subdomain, auto&& f) {
    const auto own = partition().own(subdomain);
    for (int r = chunk.first_row; r < chunk.end_row; ++r) f(columns.nodes(r, own));
  };
  std::vector<double> own;
  for_own_nodes(stepper_->bodies()[body].columns(), processes_.rank(), [&](const auto& nodes) {
    stepper_->append(chunk.component, body, static_cast<mesh::Node>(nodes.first),
                     static_cast<mesh::Node>(nodes.end()), own);
  });
  const auto all = nodes_of(chunk, columns_);
  std::vector<double> values(processes_.is_root() ? static_cast<std::size_t>(all.count) : 0);
  processes_.gather(packed(own), [&](int subdomain, MessageBuffer& buffer) {
    const auto of_subdomain = unpacked<std::vector<double>>(buffer);
    auto from = of_subdomain.begin();
    for_own_nodes(columns_[body], subdomain, [&](const auto& nodes) {
      std::copy_n(from, nodes.count, values.begin() + (nodes.first - all.first));
      from += nodes.count;
    });
  });
  return values;
}

void DistributedStepper::keep(const std::function<void(const StateByNode& chunk)>& take) {
  halo_->finish();
  auto own = packed(motion::keep(stepper_->state(own_places()), stepper_->step()));
  processes_.gather(std::move(own), [&](int subdomain, MessageBuffer& buffer) {
    auto chunk = unpacked<StateByNode>(buffer);
    buffer = {};
    chunk.step = step_;
    chunk.number = subdomain;
    chunk.n_chunks = partition().n_subdomains();
    take(chunk);
  });
}

void DistributedStepper::restore(const Loads& loads, const std::function<StateByNode()>& next) {
  halo_->finish();
  stepper_->set_loads(cut(loads, own_places()));
  StateRestorer restorer(stepper_->state(own_places()));
  for (bool is_last = false; !is_last;) {
    StateByNode chunk;
    is_last = unpacked<bool>(processes_.from_root([&](MessageBuffer& to) {
      chunk = next();
      chunk.require_of(columns_);
      to.append(packed(chunk.is_last()));
    }));
    auto part = processes_.scatter([&](int subdomain) {
      // As many subdomains as kept them go on with their own sums; of another number the first one has them
      // all.
      const bool has_sums =
          chunk.n_chunks == partition().n_subdomains() ? subdomain == chunk.number : subdomain == 0;
      return packed(chunk.in(partition().all(subdomain),
                             whole_.interface_nodes[static_cast<std::size_t>(subdomain)], columns_,
                             has_sums));
    });
    processes_.together([&] { restorer.add(unpacked<StateByNode>(part)); });
  }
  processes_.together([&] { stepper_->update_after_restore(restorer.finish()); });
  return_freed_memory();
  halo_->begin_anew();
  begin_counting();
}

}  // namespace slipfront::motion
