// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "fronts/record.hpp"
#include "interface/trigger.hpp"
#include "mesh/mesh.hpp"
#include "solve/statics.hpp"
#include "solve/stepper.hpp"

namespace slipfront::solve {

/// Asked once in a while during long work with the steps done and their total; returns false to interrupt it.
using Monitor = std::function<bool(std::int64_t step, std::int64_t total)>;

/// What to keep of an event besides its onsets.
struct Sampling {
  double history_interval_s = 0.5e-6;
  double energy_interval_s = 20e-6;
  std::vector<double> snapshot_times_s;  ///< ascending
};

/// Motion of the whole plate at one instant. The velocity belongs to half a step (half a sub-step in the
/// interface layer) earlier.
struct Snapshot {
  double time_s = 0;
  solid::Field u_m, v_m_per_s;
};

Snapshot take_snapshot(const Stepper& stepper);

/// Takes what an event is to keep of its motion, while it goes.
class Sink {
 public:
  virtual ~Sink() = default;
  /// One row of the history; x_m is empty.
  virtual void sample(const fronts::History& row) = 0;
  /// It is time for a snapshot.
  virtual void snapshot(const Stepper& stepper) = 0;
};

/// Bytes of a plate in motion: the larger of what its stepper takes while it is built, the mesh and the state
/// before the event beside it, and of the event itself with the snapshot that waits to be written. But for
/// the interface, the irregular nodes and the program itself.
double event_bytes(double n_nodes, double n_cells, bool with_snapshots,
                   Precision precision = Precision::double_precision);

/// Why an event ended.
enum class EventEnd { end_time, quiet, interrupted, blow_up };

/// A slip event as it was computed.
struct Event {
  EventEnd end = EventEnd::end_time;
  std::string blow_up;  ///< which step, and why
  std::int64_t steps = 0;
  double time_s = 0;
  fronts::SlipRecord record;
  fronts::History history;          ///< without a sink
  std::vector<Snapshot> snapshots;  ///< without a sink
  std::vector<Energies> energies;   ///< at the start, at the given interval, and at the end
};

/// Trigger forces on the interface nodes: amount (mu_s p_s - t_s) over the zone next to an edge of contact, N
/// per unit thickness. [lower]
std::vector<double> trigger_forces(const Equilibrium& state, std::span<const double> tributary_m,
                                   interface::EventKind kind, const interface::Trigger& trigger, double mu_s);

/// Halo of the slip record that t_d, p_d at a distance l_star_m ahead of the tip need.
int halo_for(const mesh::Mesh& mesh, double l_star_m);

/// Steps a started stepper until the end time, or until no node has slipped for time.quiet_s after the
/// trigger's ramp. The motion is checked: in every step numbers finite and slip rates below c_L, with each of
/// the energies and at least every 100 steps energy not above what there was at the start plus what the
/// loaded edge and the trigger have added, by more than 1 %.
/// @param state  tractions and contact before the event; its displacements are not needed
/// @param sink   takes samples and snapshots; without one the event keeps them all
Event run_event(Stepper& stepper, const Equilibrium& state, double mu_s, double c_L_m_per_s,
                const interface::Trigger& trigger, const TimeStepping& time, const Sampling& sampling,
                int halo, const Monitor& monitor, Sink* sink = nullptr);

/// States that the explicit ramp reaches, and what happened on the way.
struct Ramp {
  Equilibrium common;         ///< at (1 - critical_margin) mu_s inside
  Equilibrium spontaneous;    ///< just before mu_s is reached inside
  fronts::SlipRecord record;  ///< of all slip during the ramp
  std::int64_t steps = 0;
  bool interrupted = false;
};

/// Relative distance to mu_s at which the ramp hands over to the spontaneous event.
inline constexpr double ramp_handover = 1e-5;

/// Moves the loaded edge of the tilted plate at top_speed_m_per_s by explicit steps until t/p inside the
/// interface reaches mu_s.
/// @throws BlowUp, and UserError where mu_s is not reached within twice the shear `expected_shear_m`.
Ramp run_ramp(Stepper& stepper, const Equilibrium& tilted, const Loading& loading, double mu_s,
              double top_speed_m_per_s, double c_L_m_per_s, double expected_shear_m, const Monitor& monitor);

}  // namespace slipfront::solve
