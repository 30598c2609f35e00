// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "motion/subdomain.hpp"
#include "motion/time_stepper.hpp"

namespace slipfront::motion {

struct SlipUpdates;

/// Places in Mesh::interface_nodes of the nodes in some columns.
mesh::Subset interface_nodes_in(const mesh::Mesh& mesh, const mesh::Subset& columns);

/// The chunks of a snapshot of whole bodies, in its order.
std::vector<SnapshotChunk> snapshot_chunks(std::span<const mesh::NodeColumns> bodies);
/// Nodes of a chunk, by their numbers in its whole body.
mesh::NodeColumns::Nodes nodes_of(const SnapshotChunk& chunk, std::span<const mesh::NodeColumns> bodies);

/// Steps the bodies of an event on several ranks, each with a Subdomain; the leader has this as well. A
/// node's result does not depend on its subdomain: displacements, tractions and onsets are those of one
/// process, to the last bit; energies but for the order of summation.
class DistributedStepper final : public TimeStepper {
 public:
  /// @param own     the leader's subdomain; the others have theirs
  /// @param bodies  the whole meshes of the bodies
  DistributedStepper(Processes& processes, const Partition& partition, std::unique_ptr<Subdomain> own,
                     std::span<const mesh::Mesh* const> bodies);
  ~DistributedStepper() override;
  DistributedStepper(const DistributedStepper&) = delete;
  DistributedStepper& operator=(const DistributedStepper&) = delete;

  void start(const statics::Equilibrium& equilibrium, double top_speed_m_per_s, const Loads& loads);
  void set_probes(std::vector<Probe> probes);

  double stable_step_s() const override { return own_->stepper().stable_step_s(); }
  double step_s() const override { return own_->stepper().step_s(); }
  double lowest_step_s() const override { return own_->stepper().lowest_step_s(); }
  double substep_s() const override { return own_->stepper().substep_s(); }
  double node_updates_per_step() const override;
  std::int64_t n_nodes() const override;
  std::int64_t step() const override { return step_; }
  const std::vector<Probe>& probes() const override { return probes_; }
  std::vector<double> probed_u_m() const override { return probed(0); }
  std::vector<double> probed_v_m_per_s() const override { return probed(1); }
  std::int64_t advance(SlipObserver& observer, std::int64_t max_steps,
                       const StepCallbacks& callbacks) override;
  record::Energies energies() override;
  double kinetic_energy_J_per_m() const override;
  double mass_kg_per_m() const override;
  double energy_of_tractions_J_per_m() const override;
  int n_snapshot_chunks() const override { return static_cast<int>(snapshot_chunks_.size()); }
  std::size_t snapshot_chunk_bytes() const override;
  std::vector<double> snapshot_chunk(int k) const override;

  const Partition& partition() const { return partition_; }
  /// What each subdomain has cost since this process began or went on with the event.
  std::vector<SubdomainCost> costs() const;

  /// A chunk of each subdomain.
  void keep(const std::function<void(const StateByNode& chunk)>& take) override;
  void restore(const Loads& loads, const std::function<StateByNode()>& next) override;

 private:
  /// Sends each subdomain a command with its values, and receives the answers.
  /// @throws std::runtime_error for what another process has failed in
  std::vector<MessageBuffer> ask(SubdomainCommand command,
                                 const std::function<MessageBuffer(int subdomain)>& given = nothing) const;
  /// The same, with answers taken one by one, in the order of the subdomains.
  void ask(SubdomainCommand command, const std::function<MessageBuffer(int subdomain)>& given,
           const std::function<void(MessageBuffer& answer)>& take) const {
    ask(all_ranks_, command, given, take);
  }
  /// The same of some subdomains, in ascending order.
  void ask(std::span<const int> parts, SubdomainCommand command,
           const std::function<MessageBuffer(int subdomain)>& given,
           const std::function<void(MessageBuffer& answer)>& take) const;
  /// Gives all subdomains a command for all.
  /// @return see execute_in_tree
  /// @throws as ask
  std::vector<MessageBuffer> ask_all(SubdomainCommand command, const MessageBuffer& given) const;
  MessageBuffer gather_joined(SubdomainCommand command) const;
  static MessageBuffer nothing(int /*subdomain*/) { return {}; }
  /// Gives the subdomains what processes keep of an equilibrium, one process's share after the other.
  void place(const statics::DistributedField& u_m, const statics::DistributedField& u_per_shear);
  struct Steps {
    std::int64_t taken = 0;
    bool goes_on = false;
  };
  /// Steps before which may_continue does not refuse a motion that is physical.
  Steps advance_guaranteed(SlipObserver& observer, std::int64_t n_steps, const StepCallbacks& callbacks);
  /// Asks for tractions around onsets near a subdomain's end, in the last command's updates, which the
  /// subdomains beside it know.
  void add_tractions_of_others(SlipUpdates& seen, std::size_t n_around) const;
  std::vector<double> probed(int which) const;
  /// @param report  values of the probes, one subdomain after the other
  void put_probes_in_order(std::span<const double> report, double* to) const;
  std::vector<SubdomainMeasures> measures() const;

  Processes& processes_;
  Partition partition_;
  std::unique_ptr<Subdomain> own_;
  std::vector<int> all_ranks_;
  std::vector<mesh::NodeColumns> columns_;  ///< of the whole bodies
  /// Interface nodes of each subdomain: all that it computes, and those that count.
  std::vector<mesh::Subset> all_interface_nodes_;
  std::vector<solid::Span> own_interface_nodes_;
  std::vector<SnapshotChunk> snapshot_chunks_;
  std::vector<Probe> probes_;
  std::vector<std::size_t> probe_order_;  ///< the probes in the order of the subdomains
  bool has_finders_ = false;
  std::int64_t step_ = 0;
};

}  // namespace slipfront::motion
