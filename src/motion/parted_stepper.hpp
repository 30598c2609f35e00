// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "motion/kept_motion.hpp"
#include "motion/part.hpp"
#include "motion/time_stepper.hpp"

namespace slipfront::motion {

struct SlipsSeen;

/// Places in Mesh::lower of the nodes in some columns.
mesh::Subset lower_in(const mesh::Mesh& mesh, const mesh::Subset& columns);

/// The pieces of a snapshot of whole bodies, in its order.
std::vector<SnapshotPiece> snapshot_pieces(std::span<const mesh::NodeColumns> bodies);
/// Nodes of a piece, by their numbers in its whole body.
mesh::NodeColumns::Nodes nodes_of(const SnapshotPiece& piece, std::span<const mesh::NodeColumns> bodies);

/// Steps the bodies of an event with several processes, each of which has a Part; the one that leads has this
/// as well. What is computed of a node does not depend on the part that it lies in: displacements, tractions
/// and onsets are those of one process, to the last bit; energies but for the order of summation.
class PartedStepper final : public TimeStepper {
 public:
  /// @param own     the leader's part; the others have theirs
  /// @param bodies  the whole meshes of the bodies
  PartedStepper(Processes& processes, const Division& division, std::unique_ptr<Part> own,
                std::span<const mesh::Mesh* const> bodies);
  ~PartedStepper() override;
  PartedStepper(const PartedStepper&) = delete;
  PartedStepper& operator=(const PartedStepper&) = delete;

  void start(const statics::Equilibrium& equilibrium, double top_speed_m_per_s, const Loads& loads);
  void watch(std::vector<Probe> probes);

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
  std::int64_t advance(Recorder& recorder, std::int64_t most_steps, const Between& between) override;
  record::Energies energies() override;
  double kinetic_energy_J_per_m() const override;
  double mass_kg_per_m() const override;
  double energy_of_tractions_J_per_m() const override;
  int n_snapshot_pieces() const override { return static_cast<int>(snapshot_pieces_.size()); }
  std::size_t snapshot_piece_bytes() const override;
  std::vector<double> snapshot_piece(int k) const override;

  const Division& division() const { return division_; }
  /// What each part has cost since this process began or went on with the event.
  std::vector<PartCost> costs() const;

  /// Shows what changes, as each part in turn keeps it.
  void keep(const std::function<void(const KeptMotion& piece)>& take) const;
  /// Puts such pieces back, of any number of parts, one after the other.
  void restore(int n_pieces, const std::function<KeptMotion()>& next);

 private:
  /// Gives each part a command, with values of its own, and has their answers.
  /// @throws std::runtime_error for what another process has failed in
  std::vector<Parcel> ask(PartCommand command, const std::function<Parcel(int part)>& given = nothing) const;
  /// The same, with answers taken one by one, in the order of the parts.
  void ask(PartCommand command, const std::function<Parcel(int part)>& given,
           const std::function<void(Parcel& answer)>& take) const {
    ask(all_parts_, command, given, take);
  }
  /// The same of some parts, in ascending order.
  void ask(std::span<const int> parts, PartCommand command, const std::function<Parcel(int part)>& given,
           const std::function<void(Parcel& answer)>& take) const;
  /// Gives all parts a command for all.
  /// @return see carry_out_with_others
  /// @throws as ask
  std::vector<Parcel> ask_all(PartCommand command, const Parcel& given) const;
  Parcel all_told(PartCommand command) const;
  static Parcel nothing(int /*part*/) { return {}; }
  /// Gives the parts what processes keep of an equilibrium, one process's share after the other.
  void place(const statics::KeptDisplacement& u_m, const statics::KeptDisplacement& u_per_shear);
  struct Steps {
    std::int64_t taken = 0;
    bool goes_on = false;
  };
  /// Steps before which go_on does not refuse a motion that is physical.
  Steps advance_surely(Recorder& recorder, std::int64_t n_steps, const Between& between);
  /// Asks for tractions around onsets near a part's end, in the last command's updates, which the parts
  /// beside it know.
  void add_tractions_of_others(SlipsSeen& seen, std::size_t n_around) const;
  std::vector<double> probed(int which) const;
  /// @param told  values of the probes as the parts tell them, one part after the other
  void put_probes_in_order(std::span<const double> told, double* to) const;
  std::vector<PartMeasures> measures() const;

  Processes& processes_;
  Division division_;
  std::unique_ptr<Part> own_;
  std::vector<int> all_parts_;
  std::vector<mesh::NodeColumns> columns_;  ///< of the whole bodies
  /// Interface nodes of each part: all that it computes, and those that count.
  std::vector<mesh::Subset> all_lower_;
  std::vector<solid::Span> own_lower_;
  std::vector<SnapshotPiece> snapshot_pieces_;
  std::vector<Probe> probes_;
  std::vector<std::size_t> told_probes_;  ///< the probes in the order in which parts tell of them
  bool has_finders_ = false;
  std::int64_t step_ = 0;
};

}  // namespace slipfront::motion
