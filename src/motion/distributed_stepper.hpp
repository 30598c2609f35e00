// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "motion/halo.hpp"
#include "motion/partition.hpp"
#include "motion/slip_finder.hpp"
#include "motion/stepper.hpp"
#include "motion/time_stepper.hpp"
#include "processes/processes.hpp"

namespace slipfront::motion {

struct SlipUpdates;
struct StepReport;

/// The whole bodies and their subdomains, as every rank knows them.
struct Decomposition {
  Partition partition;
  std::vector<std::vector<mesh::Grid>> blocks;  ///< of each body's mesh, upwards
  /// Interface nodes of each subdomain: all that it computes, and those that it owns.
  std::vector<mesh::Subset> interface_nodes;
  std::vector<solid::Span> own_interface_nodes;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(partition, blocks, interface_nodes, own_interface_nodes);
  }
};
/// @param bodies  the whole meshes, or those of their interfaces
Decomposition decomposition_of(Partition partition, std::span<const mesh::Mesh* const> bodies);

/// Places in Mesh::interface_nodes of the nodes in some columns.
mesh::Subset interface_nodes_in(const mesh::Mesh& mesh, const mesh::Subset& columns);

/// Most nodes of a chunk of a snapshot, unless a single row has more.
inline constexpr int nodes_of_snapshot_chunk = 1 << 19;

/// Some rows of nodes in a snapshot.
struct SnapshotChunk {
  MotionComponent component = MotionComponent::u_x;
  int body = 0;
  int first_row = 0, end_row = 0;
};
/// The chunks of a snapshot of whole bodies, in its order.
std::vector<SnapshotChunk> snapshot_chunks(std::span<const mesh::NodeColumns> bodies);
/// Nodes of a chunk, by their numbers in its whole body.
mesh::NodeColumns::Nodes nodes_of(const SnapshotChunk& chunk, std::span<const mesh::NodeColumns> bodies);

/// Cost of a subdomain since it was started or restored.
struct SubdomainCost {
  std::int64_t steps = 0;
  std::int64_t messages = 0, bytes = 0;  ///< that its rank has sent
  double computing_s = 0;
  double exchange_s = 0;    ///< in exchanges with its neighbours
  double collective_s = 0;  ///< in functions that all ranks call
};

/// Tractions near the ends of a subdomain at successive contact updates, for onsets of the neighbours' nodes.
class TractionLog {
 public:
  TractionLog() = default;
  /// @param own    places of the subdomain's nodes along its interface
  /// @param reach  nodes around an onset whose tractions are recorded
  TractionLog(solid::Span own, int reach);

  void clear() { values_.clear(); }
  /// Those of the next update, [interface nodes of the subdomain]; first those before the steps.
  void add(std::span<const double> t_Pa, std::span<const double> p_Pa);
  /// @pre the nodes lie within reach of an end
  record::Traction at(std::size_t update, int node) const;
  static double bytes_per_update(int n_own, int reach) {
    return 2.0 * sizeof(double) * std::min(n_own, 2 * reach);
  }

 private:
  std::vector<solid::Span> places_;
  std::size_t width_ = 0;  ///< nodes of them
  std::vector<double> values_;
};

/// Steps the bodies of an event on several ranks, each with one subdomain. A node's result does not depend on
/// its subdomain: displacements, tractions and onsets are those of one process, to the last bit; energies but
/// for the order of summation.
///
/// All functions are collective but those of times, places and sizes that do not change. Observers are shown
/// the same on every rank, the whole interface, so that all ranks come to the same decisions.
class DistributedStepper final : public TimeStepper {
 public:
  /// @param own      the bodies' columns `partition.all(rank)`, with their BodySubdomain
  /// @param contact  of the subdomain's interface nodes
  DistributedStepper(Processes& processes, Decomposition whole, std::span<const BodySource> own,
                     const interface::ContactModel& contact, const TimeStepping& time,
                     const Execution& execution);
  ~DistributedStepper() override;
  DistributedStepper(const DistributedStepper&) = delete;
  DistributedStepper& operator=(const DistributedStepper&) = delete;

  /// @param equilibrium  the whole interface; on rank 0 with the whole displacements
  void start(const statics::Equilibrium& equilibrium, double top_speed_m_per_s, Loads loads) override;
  void set_probes(std::vector<Probe> probes) override;

  double stable_step_s() const override { return stepper_->stable_step_s(); }
  double step_s() const override { return stepper_->step_s(); }
  double lowest_step_s() const override { return stepper_->lowest_step_s(); }
  double substep_s() const override { return stepper_->substep_s(); }
  double node_updates_per_step() const override;
  std::int64_t n_nodes() const override;
  std::int64_t step() const override { return step_; }
  const std::vector<Probe>& probes() const override { return probes_; }
  std::vector<double> probed_u_m() const override;
  std::vector<double> probed_v_m_per_s() const override;
  std::int64_t advance(SlipObserver& observer, std::int64_t max_steps) override;
  bool is_interrupted() const override { return is_interrupted_; }
  record::Energies energies() override;
  record::Breakdown breakdown() const override;
  record::History interface_row() const override;
  double kinetic_energy_J_per_m() const override;
  double mass_kg_per_m() const override;
  double energy_of_tractions_J_per_m() const override;
  int n_snapshot_chunks() const override { return static_cast<int>(snapshot_chunks_.size()); }
  std::size_t snapshot_chunk_bytes() const override;
  /// Empty but on rank 0.
  std::vector<double> snapshot_chunk(int k) const override;

  const Partition& partition() const { return whole_.partition; }
  /// What each subdomain has cost since the ranks began or went on with the event.
  std::vector<SubdomainCost> costs() const;

  /// Shows rank 0 a chunk of each subdomain.
  void keep(const std::function<void(const StateByNode& chunk)>& take) override;
  /// @param loads  of the whole interface
  /// @param next   called on rank 0
  void restore(const Loads& loads, const std::function<StateByNode()>& next) override;

 private:
  struct Steps {
    std::int64_t shown = 0;
    bool goes_on = false;
  };
  /// Takes some steps whatever after_step says, and shows them to the observer until it refuses more.
  Steps advance_guaranteed(SlipObserver& observer, std::int64_t n_steps);
  /// The steps in the own subdomain.
  StepReport advance_own(const std::vector<std::uint8_t>& is_sampled);
  /// Makes the finder of own nodes, with what one of the whole interface knows.
  void make_finder(const SlipFinder& whole);
  /// Adds tractions around onsets near a subdomain's end, which the subdomains beside it know.
  void add_tractions_of_others(SlipUpdates& seen, std::size_t n_around);
  void begin_counting();
  /// Values of the probes of all ranks, in the probes' order.
  std::vector<double> gathered(const std::vector<double>& own) const;
  /// @param report  values of the probes, one subdomain after the other
  void put_probes_in_order(std::span<const double> report, double* to) const;
  /// Sums over all ranks.
  double sum(double own) const;

  const mesh::Subset& own_places() const { return whole_.interface_nodes[rank()]; }
  std::size_t rank() const { return static_cast<std::size_t>(processes_.rank()); }

  Processes& processes_;
  Decomposition whole_;
  std::vector<mesh::NodeColumns> columns_;  ///< of the whole bodies
  std::unique_ptr<Stepper> stepper_;
  std::unique_ptr<Halo> halo_;
  std::optional<SlipFinder> finder_;  ///< of own nodes
  TractionLog log_;
  std::vector<SnapshotChunk> snapshot_chunks_;
  std::vector<Probe> probes_;
  std::vector<std::size_t> probe_order_;  ///< the probes in the order of the subdomains
  Processes::Counters counted_before_;
  std::int64_t first_counted_step_ = 0;
  std::int64_t step_ = 0;
  bool is_interrupted_ = false;
};

}  // namespace slipfront::motion
