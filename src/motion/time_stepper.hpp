// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/interruption.hpp"
#include "motion/every.hpp"
#include "motion/probes.hpp"
#include "motion/state_by_node.hpp"
#include "motion/step_observer.hpp"
#include "record/breakdown.hpp"
#include "record/energies.hpp"
#include "record/record.hpp"
#include "solid/operator.hpp"

namespace slipfront::motion {

struct Loads;

/// Motion of all nodes at one instant, those of a body below after those of the plate, with u_y and v_y up.
/// The velocity belongs to half a step (half a sub-step in the interface layer) earlier.
struct Snapshot {
  double time_s = 0;
  solid::Field u_m, v_m_per_s;
};

/// Components of a snapshot, in its order.
enum class MotionComponent : int { u_x, u_y, v_x, v_y };
inline constexpr int n_motion_components = 4;

/// Interface of the steppers of an event's bodies: on one rank, or on several.
class TimeStepper {
 public:
  virtual ~TimeStepper() = default;

  /// Puts the bodies into an equilibrium, moving with the shear at top_speed_m_per_s, under loads, at time 0.
  virtual void start(const statics::Equilibrium& equilibrium, double top_speed_m_per_s, Loads loads) = 0;
  /// Looks at the nodes of these probes from now on.
  virtual void set_probes(std::vector<Probe> probes) = 0;

  virtual double stable_step_s() const = 0;
  virtual double step_s() const = 0;
  /// time.step_factor of the stable step: that of the lowest block, or of the faster body's.
  virtual double lowest_step_s() const = 0;
  virtual double substep_s() const = 0;
  /// Nodes moved in one step, sub-steps counted, and nodes of the bodies that move at all.
  virtual double node_updates_per_step() const = 0;
  /// Nodes of all bodies.
  virtual std::int64_t n_nodes() const = 0;

  /// Time of the displacements. The velocities belong to half a step, or half a sub-step in the layer,
  /// earlier.
  double time_s() const { return now().time_s(); }
  Now now() const { return {step(), step_s()}; }
  virtual std::int64_t step() const = 0;

  virtual const std::vector<Probe>& probes() const = 0;
  /// Displacements and velocities of the probes' nodes between two steps, see displacement_values.
  virtual std::vector<double> probed_u_m() const = 0;
  virtual std::vector<double> probed_v_m_per_s() const = 0;

  /// Takes at most `max_steps` steps, several of them in one sweep through memory.
  /// @return the number of steps taken
  /// @throws what the observer throws; after that only start may follow.
  virtual std::int64_t advance(SlipObserver& observer, std::int64_t max_steps) = 0;
  /// Whether the run is to be interrupted or kept in a checkpoint; on all ranks the same.
  virtual bool is_interrupted() const { return is_pause_wanted(); }

  /// Energies and works up to the last half (sub-)step.
  virtual record::Energies energies() = 0;
  virtual double kinetic_energy_J_per_m() const = 0;
  /// How friction has broken down so far, at all interface nodes.
  virtual record::Breakdown breakdown() const = 0;
  /// State of all interface nodes between two steps, one row without places: slip and the law's states of
  /// now, slip rates and tractions of the last contact update.
  virtual record::History interface_row() const = 0;
  virtual double mass_kg_per_m() const = 0;
  /// Kinetic energy of bodies that move as fast as an interface node would after one step in which its
  /// tractions are not balanced. With h/c_L for the step it is near sigma^2/(2E) times the bodies' area.
  virtual double energy_of_tractions_J_per_m() const = 0;

  /// A snapshot is written in chunks, so that no rank holds all of it: u_x, u_y, v_x, v_y [nodes], one after
  /// the other. On several ranks rank 0 gets the values, the others get none.
  virtual int n_snapshot_chunks() const = 0;
  /// Bytes of the largest of them.
  virtual std::size_t snapshot_chunk_bytes() const = 0;
  virtual std::vector<double> snapshot_chunk(int k) const = 0;
  /// All of it.
  Snapshot snapshot() const;

  /// Shows all that changes between two calls of advance, in chunks, so that no rank holds all of it.
  virtual void keep(const std::function<void(const StateByNode& chunk)>& take) = 0;
  /// Restores such chunks of any number of ranks, in their order; start need not have been called. A stepper
  /// of the same bodies and stepping then goes on as that one would, to the last bit; by another number of
  /// ranks but for the order of summation.
  /// @param loads  with which the motion began
  /// @throws StateError where the state is of other bodies or loads; on several ranks see Processes::together
  virtual void restore(const Loads& loads, const std::function<StateByNode()>& next) = 0;

 protected:
  TimeStepper() = default;
  TimeStepper(const TimeStepper&) = default;
  TimeStepper(TimeStepper&&) = default;
  TimeStepper& operator=(const TimeStepper&) = default;
  TimeStepper& operator=(TimeStepper&&) = default;
};

}  // namespace slipfront::motion
