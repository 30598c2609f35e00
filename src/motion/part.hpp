// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "motion/division.hpp"
#include "motion/halo.hpp"
#include "motion/kept_motion.hpp"
#include "motion/recorder.hpp"
#include "motion/stepper.hpp"
#include "processes/processes.hpp"
#include "statics/kept_displacements.hpp"

namespace slipfront::motion {

/// What is asked of all parts at a time. The number of the command is followed by its values.
enum class PartCommand : int {
  network,    ///< run::serve measures it, or answers one that does
  statics,    ///< run::serve does its share of the statics
  fields,     ///< run::serve writes its share of fields.vtkhdf
  build,      ///< run::serve makes the part
  kept,       ///< displacements before the event that the process keeps
  place,      ///< some of these, which the part needs
  start,      ///< begin at an equilibrium, its displacements given or placed before
  watch,      ///< look at probes
  memory,     ///< of the last contact update, from which slip is found
  advance,    ///< take steps
  tractions,  ///< near the part's ends, in contact updates of these steps
  energies,   ///< and works
  measures,   ///< see PartMeasures
  snapshot,   ///< own columns of a piece of it
  probed,     ///< displacements and velocities at the probes
  keep,       ///< the state, for a checkpoint
  restore,    ///< a piece of a state that was kept, and whether it is the last one
  release,    ///< the part is needed no more
  end,        ///< and neither is the process
};

/// Whether the command is the same for all parts, and what they tell of it can be joined: so it goes from
/// each process to those below it in the tree, and answers come back that way (processes/tree.hpp). Others go
/// from the leader to each process; they come before the first of these, with answers.
bool is_for_all(PartCommand command);

/// What a part has cost since it was started or restored.
struct PartCost {
  std::int64_t steps = 0;
  std::int64_t messages = 0, bytes = 0;  ///< that its process has sent
  double computing_s = 0;
  double exchange_s = 0;  ///< in exchanges with its neighbours
  double command_s = 0;   ///< waiting for commands, and for answers of others
};

/// Sums and maxima over what a part accounts for.
struct PartMeasures {
  double kinetic_J_per_m = 0;
  double mass_kg_per_m = 0, plate_mass_kg_per_m = 0;
  double largest_acceleration_m_per_s2 = 0;
  double node_updates_per_step = 0;
  PartCost cost;
};

/// Tractions of a part's nodes near its ends at the contact updates of a command: around onsets of its
/// neighbours' nodes they are recorded.
class TractionLog {
 public:
  TractionLog() = default;
  /// @param own    places of the part's nodes along its interface
  /// @param reach  nodes around an onset whose tractions are recorded
  TractionLog(solid::Span own, int reach);

  void clear() { values_.clear(); }
  /// Those of the next update, [interface nodes of the part]; first those before the command.
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

/// What is asked of a part's log.
struct TractionsWanted {
  std::int64_t update = 0;  ///< of the command, from 0
  solid::Span nodes;        ///< places along the part's interface
};

/// Most nodes of a piece of a snapshot, unless a single row has more.
inline constexpr int nodes_of_snapshot_piece = 1 << 19;

/// Some rows of nodes in a snapshot.
struct SnapshotPiece {
  MotionComponent component = MotionComponent::u_x;
  int body = 0;
  int first_row = 0, end_row = 0;
};

/// The part of an event's bodies that one process computes. All processes have one and are given the same
/// commands, by PartedStepper.
class Part {
 public:
  /// @param sources   the bodies' columns `division.all(processes.rank())`, with their PartOfBody
  /// @param contact   of the part's interface nodes
  /// @param lower     their places along the whole interface
  /// @param kept      displacements that this process has found, until the event starts
  Part(Processes& processes, const Division& division, std::span<const BodySource> sources,
       const interface::ContactModel& contact, const TimeStepping& time, const Execution& execution,
       const mesh::Subset& lower, statics::KeptDisplacements* kept = nullptr);

  /// Carries out a command between build and release.
  void carry_out(PartCommand command, Parcel& given, Parcel& answer);

  const Stepper& stepper() const { return *stepper_; }

 private:
  void place(Parcel& given);
  void start(Parcel& given);
  void advance(Parcel& given, Parcel& answer);
  void make_finder(Parcel& given);
  void begin_counting();
  PartCost cost() const;
  void put_snapshot(const SnapshotPiece& piece, Parcel& answer) const;

  Processes& processes_;
  PlaceInWhole place_;
  std::unique_ptr<Stepper> stepper_;
  std::unique_ptr<Halo> halo_;
  std::optional<SlipFinder> finder_;
  TractionLog log_;
  KeptMotion kept_;  ///< pieces of it, until the last one has come
  statics::KeptDisplacements* displacements_;
  /// u_m, u_per_shear of the bodies as unknowns, see Piece; empty unless they have been placed.
  std::array<std::array<solid::Field, 2>, 2> placed_;
  Processes::Counters counted_before_;
  std::int64_t first_counted_step_ = 0;
};

/// Carries out a command for all with a process's own part and those of the processes below it.
/// @param parcel  the command and its values, untouched
/// @return what the part tells, and what each of these processes has joined of its own and of those below
/// @throws what the part throws, and ProcessError for another one, after it has all answers
std::vector<Parcel> carry_out_with_others(Processes& processes, Part& part, const Parcel& parcel);
/// What such answers tell together.
Parcel joined(PartCommand command, std::span<Parcel> answers);

/// Carries out the leader's commands until the part is needed no more.
void serve(Processes& processes, Part& part);

}  // namespace slipfront::motion
