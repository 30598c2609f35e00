// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/numbers.hpp"
#include "boundary/machine.hpp"
#include "fronts/front.hpp"
#include "interface/interface.hpp"
#include "interface/start.hpp"
#include "mesh/plate.hpp"
#include "motion/settings.hpp"
#include "record/record.hpp"
#include "solid/material.hpp"
#include "statics/settings.hpp"

namespace slipfront::input {

/// How fronts are found and measured; see fronts::FrontOptions.
struct FrontSettings {
  double l_star_m = 0.335e-3;
  fronts::SpeedInterval speed_interval = fronts::SpeedInterval::centred;
  double arrest_time_s = 10e-6;
  double min_length_m = 1e-3;
  double crack_share = 0.5;
  double pulse_share = 0.2;
  double trigger_margin_m =
      5e-3;  ///< t_d, p_d are left out within trigger zone or nucleation patch plus this
};

/// What the plate lies on.
enum class BaseKind {
  rigid,  ///< the plane y = 0
  body,   ///< a deformable body below it, as wide as the plate
};

/// PMMA, damped by 0.06 of the time in which a longitudinal wave crosses an element of the default case.
inline constexpr solid::Material default_material = {.stiffness_damping_s = 12.623e-9};

/// The body below the plate, where there is one; see base_plate and base_material.
struct Base {
  BaseKind kind = BaseKind::body;
  mesh::Plate plate;  ///< upside down: its top is the far edge, away from the interface
  solid::Material material = default_material;  ///< its plane is the plate's
};

/// A table of tractions along the interface as it was read, see input/prestress.hpp.
struct PrestressTable {
  std::string text;          ///< of the file
  record::StaticState rows;  ///< [rows]
};

/// Tractions of the interface before the event under loading.method = prestress: uniform, or from a table.
struct Prestress {
  /// Drives the plate to +x; none: that of the friction law, which has a state.
  std::optional<double> t_Pa = {};
  double p_Pa = 1e6;           ///< positive in compression
  std::string file;            ///< CSV table; empty for uniform tractions
  PrestressTable table = {};   ///< read from it by input::read_case
  double t_rate_Pa_per_s = 0;  ///< at which both grow during the event, everywhere alike
  double p_rate_Pa_per_s = 0;
};

/// A table of parameters of the friction law along the interface as it was read, see
/// input/friction_table.hpp
struct FrictionTable {
  std::string text;                         ///< of the file
  std::vector<double> x_m;                  ///< [rows]
  std::vector<std::string> keys;            ///< of the parameters, without "friction."
  std::vector<std::vector<double>> values;  ///< [keys][rows]
};

/// Values of a table at positions between its rows.
enum class BetweenRows {
  linear,
  stepwise,  ///< those of the last row at or before the position
};

/// How the parameters of the friction law vary along the interface: by a table, by a random field f, or by
/// both, which gives the table's value times 1 + random_share f(x).
struct FrictionAlongX {
  std::string file;          ///< CSV table; empty for none
  FrictionTable table = {};  ///< read from it by input::read_case
  BetweenRows between_rows = BetweenRows::linear;
  std::string random_key = "none";  ///< the parameter that the field multiplies, without "friction."
  double random_share = 0.1;        ///< standard deviation over the value
  double random_correlation_length_m = 5e-3;
  int random_seed = 1;

  bool varies() const { return !file.empty() || random_key != "none"; }
  bool is_stepwise() const { return between_rows == BetweenRows::stepwise; }
};

/// What a run writes besides its fronts.
struct Output {
  double history_interval_s = 0.25e-6;   ///< spacing of the rows of interface.h5
  std::vector<double> snapshot_times_s;  ///< whole-plate fields, written to fields.vtkhdf
  /// Further ones at its multiples, from time 0 on.
  double snapshot_interval_s = infinity;
  bool snapshot_stress = true;       ///< strain and stress of the cells with them
  double energy_interval_s = 10e-6;  ///< spacing of the rows of energy.csv
  bool moment_rate = false;          ///< whether there is a moment_rate.h5
};

/// Places at which motion, strain and stress are recorded in probes.h5.
struct Probes {
  std::vector<double> x_m, y_m;    ///< [probes] y < 0 lies in the base
  std::vector<std::string> names;  ///< [probes] or none: their numbers, from 1
  double interval_s = 0.5e-6;      ///< spacing of the rows
};

/// Loading that goes on after an event: by static equilibria to the next one, and so on.
struct Sequence {
  int max_events = 1;
  double end_s = infinity;  ///< of the loading, from the tilt on
  bool to_global_sliding = false;
  /// Where the loading is over time, linear between; none: at its constant speed.
  struct Path {
    std::vector<double> times_s, shears_m;
    bool operator==(const Path&) const = default;
  } path;
  /// Healing of laws that stick: mu_s grows by the first for each e-fold of 1 + (time at rest)/(the second).
  double healing_per_e_fold = 0, healing_time_s = 1;
  /// Under a law with a state; without it that of inertia_slip_rate_m_per_s.
  std::optional<double> inertia_slip_rate_m_per_s;
};

/// One run, completely. Every member is an entry of the schema (input/schema.hpp).
struct Case {
  std::string title;
  mesh::Plate plate;
  solid::Material material = default_material;
  boundary::Machine machine;  ///< that loads the plate
  Base base;
  statics::Loading loading;
  Prestress prestress;
  interface::FrictionLaw friction;
  FrictionAlongX friction_along_x;
  /// See interface::ContactModel; without it that of tip_slip_rate_m_per_s.
  std::optional<double> tip_slip_rate_m_per_s;
  interface::Regularisation regularisation;
  interface::ContactAlgorithm contact = interface::ContactAlgorithm::direct;
  interface::EventKind event = interface::EventKind::spontaneous;
  interface::Trigger trigger;
  interface::Nucleation nucleation;
  Sequence sequence;
  motion::TimeStepping time;
  FrontSettings fronts;
  Output output;
  Probes probes;
};

/// Whether the tractions of the interface before the event are given: no statics, no ramp.
inline bool is_prestressed(const Case& config) {
  return config.loading.method == statics::LoadingMethod::prestress;
}

/// Whether the case is a sequence of events.
inline bool is_sequence(const Case& config) {
  return config.sequence.max_events > 1;
}

/// Whether slow slip lies between its events.
inline bool is_slow(const Case& config) {
  return is_sequence(config) && config.friction.never_sticks();
}

/// How its event begins.
inline interface::Start start_of(const Case& config) {
  return {config.event, config.trigger, config.nucleation};
}

inline bool has_base_body(const Case& config) {
  return config.base.kind == BaseKind::body;
}

/// The rectangle of the body below, upside down. It has the plate's width and elements, so that the nodes of
/// the two face each other.
inline mesh::Plate base_plate(const Case& config) {
  auto plate = config.base.plate;
  plate.width_m = config.plate.width_m;
  plate.element_size_m = config.plate.element_size_m;
  plate.corner = mesh::Corner::none;
  return plate;
}

inline solid::Material base_material(const Case& config) {
  auto material = config.base.material;
  material.plane = config.material.plane;
  return material;
}

}  // namespace slipfront::input
