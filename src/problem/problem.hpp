// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "boundary/machine.hpp"
#include "input/case.hpp"
#include "interface/interface.hpp"
#include "interface/start.hpp"
#include "mesh/plate.hpp"
#include "motion/settings.hpp"
#include "problem/loading_path.hpp"
#include "record/probes.hpp"
#include "record/record.hpp"
#include "solid/element.hpp"
#include "solid/material.hpp"
#include "stability/modes.hpp"
#include "statics/settings.hpp"

namespace slipfront::problem {

/// An elastic body and what holds its edges.
struct Body {
  mesh::Plate plate;  ///< its rectangle; a body below the interface is described upside down
  solid::Material material;
  boundary::Machine machine = {};  ///< at its far edge; rigid by default
};

/// Contact and friction of the interface.
struct Friction {
  interface::FrictionLaw law;     ///< of all nodes, or what `along_x` varies
  input::FrictionAlongX along_x;  ///< see friction_at
  interface::Regularisation regularisation;
  interface::ContactAlgorithm contact = interface::ContactAlgorithm::direct;
  std::optional<double> tip_slip_rate_m_per_s = {};  ///< given; else see problem::tip_slip_rate_m_per_s
};

/// The texts from which a problem was made: those of the case and of the tables that it names. All are empty
/// where a program put the problem together.
struct Source {
  std::string title;
  std::string case_text;  ///< each key with its value, the tables by the names that a run's folder has
  std::string prestress_table, friction_table;
  std::string state_key;  ///< the same for two cases if and only if they share their state before the event

  /// What tells cases apart.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(case_text, prestress_table, friction_table);
  }
};

/// All that is known of a run before anything is computed. Values, which make_problem takes from a case or a
/// program sets by itself.
struct Problem {
  Source source;
  std::vector<Body> bodies;  ///< above the interface; and below it, else a rigid plane
  statics::Loading loading;
  double shear_speed_m_per_s = 0;             ///< of the loaded edge, or of the pusher, to +x
  std::optional<input::Prestress> prestress;  ///< tractions before the event: no statics
  Friction friction;
  interface::Start start;
  input::Sequence sequence;
  motion::TimeStepping time;
  input::FrontSettings fronts;
  input::Output output;
  std::vector<record::ProbePlace> probes;
  double probe_interval_s = input::Probes{}.interval_s;

  const Body& above() const { return bodies.front(); }
  bool has_below() const { return bodies.size() > 1; }
  /// @pre has_below
  const Body& below() const {
    SLIPFRONT_ASSERT(has_below(), "there is no body below the interface");
    return bodies.back();
  }
  Body& above() { return bodies.front(); }
  Body& below() { return bodies.back(); }
  double element_size_m() const { return above().plate.element_size_m; }
  double width_m() const { return above().plate.width_m; }
  /// Length after which the interface repeats; 0 of one that does not.
  double period_m() const { return above().plate.sides == mesh::Sides::periodic ? width_m() : 0; }
  double greatest_height_m() const {
    return has_below() ? std::max(above().plate.height_m, below().plate.height_m) : above().plate.height_m;
  }

  bool is_prestressed() const { return prestress.has_value(); }
  bool is_by_ramp() const { return loading.method == statics::LoadingMethod::ramp; }
  bool is_sequence() const { return sequence.max_events > 1; }
  /// Whether slow slip lies between its events.
  bool is_slow() const { return is_sequence() && friction.law.never_sticks(); }
  /// Whether mu_s of nodes at rest grows between its events.
  bool heals() const { return is_sequence() && sequence.healing_per_e_fold > 0; }
  /// Whether prescribed tractions grow during the event.
  bool has_growing_tractions() const {
    return prestress && (prestress->t_rate_Pa_per_s != 0 || prestress->p_rate_Pa_per_s != 0);
  }
  /// Whether steps are computed as the scheme is written.
  bool is_plain() const { return time.stepper == motion::StepperKind::plain; }
  bool has_snapshots() const {
    return !output.snapshot_times_s.empty() || std::isfinite(output.snapshot_interval_s);
  }
  LoadingPath path() const { return LoadingPath(sequence, shear_speed_m_per_s); }
};

/// The problem of a case: nothing but its values, and the tables that it has read.
Problem make_problem(const input::Case& config);

/// The bodies of a case alone.
std::vector<Body> bodies_of(const input::Case& config);

/// The materials on both sides of the interface.
stability::Bodies materials_of(const std::vector<Body>& bodies);
inline stability::Bodies materials_of(const Problem& problem) {
  return materials_of(problem.bodies);
}
/// The largest that a slip rate can be by linear elasticity, see motion::Watch.
double fastest_speed_m_per_s(const Problem& problem);
/// Speed of the loaded edge during the event; a pusher stays where it is.
double shear_speed_in_event_m_per_s(const Problem& problem);
/// Mean pressure of the interface before the event: prescribed, of the normal force where the loading gives
/// it, else under the tilt, the bodies' sides free; a base takes its share of the compression.
double nominal_pressure_Pa(const Problem& problem);

/// Whether elements are neither coarser anywhere nor wrapped around a corner: then a mesh can be made in
/// rows, and in columns without the others.
bool has_equal_elements(const Problem& problem);
/// Whether ranks may each have some columns of the bodies while none has all, so that these may have more
/// nodes than can be numbered: nothing is strained before the event.
bool can_be_held_in_parts(const Problem& problem);
/// Whether rank 0 of several needs no more of the bodies than their interfaces (see mesh::make_interface) and
/// the cells at their corners: nothing is strained before the event, and all other cells are equal squares,
/// enough of them for the stable step to follow from their side.
bool root_has_interface_only(const Problem& problem, int n_processes);

/// Given tractions at interface nodes at x_m, from their table if there is one.
/// @pre is_prestressed  @throws UserError where the table does not reach all of them
record::StaticState prescribed_tractions(const Problem& problem, const std::vector<double>& x_m);
/// The state of the bulk that carries prescribed tractions, which displacements leave out. None of tractions
/// that vary along x: they do not determine it.
std::optional<solid::UniformStress> prescribed_stress(const Problem& problem);

}  // namespace slipfront::problem

namespace slipfront {
using problem::Problem;
}
