// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "base/numbers.hpp"
#include "record/column.hpp"
#include "record/energies.hpp"

namespace slipfront::record {

/// Where the loading of a sequence stands.
enum class LoadingPhase : std::uint8_t {
  tilted,        ///< before any shear
  event_begins,  ///< static equilibrium in which slip begins
  slip_ends,     ///< the motion with which an event ends
  at_rest,       ///< static equilibrium with the interface where that has left it
  loaded,        ///< static equilibrium at the end of the loading, before a next event
  creep,         ///< slow slip between events, under a law with a state
};
inline constexpr const char* name(LoadingPhase phase) {
  constexpr std::array names = {"tilted", "event_begins", "slip_ends", "at_rest", "loaded", "creeps"};
  return names[static_cast<std::size_t>(phase)];
}

/// Whether it begins, ends or follows an event, or else lies before the next one.
inline constexpr bool is_of_event(LoadingPhase phase) {
  return phase == LoadingPhase::event_begins || phase == LoadingPhase::slip_ends ||
         phase == LoadingPhase::at_rest;
}

/// Loads of a sequence at one instant, per unit thickness. Forces are those of the interface on the plate.
struct LoadingRow {
  LoadingPhase phase = LoadingPhase::tilted;
  std::int32_t n_events = 0;  ///< that have begun
  double time_s = 0;
  double shear_m = 0;
  double normal_force_N_per_m = 0, shear_force_N_per_m = 0;
  double shear_over_normal = 0;
  double normal_force_x_m = 0;
  double fastest_slip_rate_m_per_s = 0;
  double pressure_moment_N = 0;
  double shear_height_m = nan;
  /// What is stored, and works since normal loading; between static equilibria those of the mean forces.
  Energies energies;
  double wave_loss_J_per_m = 0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(phase, n_events, time_s, shear_m, normal_force_N_per_m, shear_force_N_per_m, shear_over_normal,
            normal_force_x_m, fastest_slip_rate_m_per_s, pressure_moment_N, shear_height_m, energies,
            wave_loss_J_per_m);
  }
};

/// The columns of a row but for its phase, its events and the terms of its energies, which come before the
/// last one.
inline constexpr std::array<Column<LoadingRow, double>, 9> loading_fields = {{
    {"time_s", "s", "time since normal loading, in which the top edge moves at its speed",
     &LoadingRow::time_s},
    {"shear_m", "m", "displacement of the top edge or the pusher to +x since normal loading",
     &LoadingRow::shear_m},
    {"normal_force_N_per_m", "N/m", "sum of the pressure over the interface",
     &LoadingRow::normal_force_N_per_m},
    {"shear_force_N_per_m", "N/m", "sum of the tangential traction", &LoadingRow::shear_force_N_per_m},
    {"shear_over_normal", "1", "the ratio of the two: the coefficient of friction of the whole interface",
     &LoadingRow::shear_over_normal},
    {"normal_force_x_m", "m", "where along the interface the normal force acts",
     &LoadingRow::normal_force_x_m},
    {"fastest_slip_rate_m_per_s", "m/s", "slip rate of the fastest node, of a law with a state; else 0",
     &LoadingRow::fastest_slip_rate_m_per_s},
    {"pressure_moment_N", "N", "moment of the pressure about the middle of the interface, N m per m",
     &LoadingRow::pressure_moment_N},
    {"shear_height_m", "m", "height at which the shear force acts on the plate; of equilibria under load",
     &LoadingRow::shear_height_m},
}};
inline constexpr Column<LoadingRow, double> wave_loss = {
    "wave_loss_J_per_m", "J/m",
    "energy of the waves that were left at the ends of the events so far, and that slow slip has radiated",
    &LoadingRow::wave_loss_J_per_m};

/// What the terms leave open, see imbalance_J_per_m of energies.
inline double imbalance_J_per_m(const LoadingRow& now, const LoadingRow& start) {
  return imbalance_J_per_m(now.energies, start.energies) + now.wave_loss_J_per_m;
}

/// The row of the largest ratio of shear to normal force. @pre there are rows
inline const LoadingRow& strongest(std::span<const LoadingRow> rows) {
  return *std::ranges::max_element(rows, {}, &LoadingRow::shear_over_normal);
}

/// Slow slip before an event has a row every so many steps; from so many rows on only where it has changed.
inline constexpr std::int64_t steps_per_slow_row = 4;
inline constexpr std::size_t all_slow_rows = 4096;

/// An event of a sequence, in numbers.
struct SequenceEvent {
  double begin_s = 0;  ///< since normal loading
  double shear_m = 0;
  double begin_x_m = nan, from_x_m = nan, to_x_m = nan;
  double length_m = 0, longest_patch_m = 0, nucleation_length_m = nan;
  double is_global = 0;
  double potency_m2 = 0, mean_slip_m = 0, max_slip_m = 0;
  double normal_force_N_per_m = 0, shear_force_N_per_m = 0, friction_before = 0, friction_after = 0;
  double stress_drop_Pa = nan;
  double released_J_per_m = 0, friction_work_J_per_m = 0, wave_loss_J_per_m = 0;
  double breakdown_work_J_per_m = nan;
  double predicted_from_x_m = nan, predicted_to_x_m = nan;
  double slip_s = nan;
  double n_fronts = 0, median_speed_m_per_s = nan;

  template <class Archive>
  void serialize(Archive& archive);
};

inline constexpr std::array<Column<SequenceEvent, double>, 26> sequence_event_fields = {{
    {"begin_s", "s", "time since normal loading at which it begins", &SequenceEvent::begin_s},
    {"shear_m", "m", "displacement of the top edge or the pusher then", &SequenceEvent::shear_m},
    {"begin_x_m", "m", "where slip begins inside; the middle of nodes that begin together",
     &SequenceEvent::begin_x_m},
    {"from_x_m", "m", "left end of what slips", &SequenceEvent::from_x_m},
    {"to_x_m", "m", "right end", &SequenceEvent::to_x_m},
    {"length_m", "m", "length of the interface that slips", &SequenceEvent::length_m},
    {"longest_patch_m", "m", "length of the longest stretch of it without a gap",
     &SequenceEvent::longest_patch_m},
    {"nucleation_length_m", "m", "nucleation length before it: what slips over less stops by itself",
     &SequenceEvent::nucleation_length_m},
    {"is_global", "1", "1 where all nodes inside slip", &SequenceEvent::is_global},
    {"potency_m2", "m2", "slip at rest, summed over the interface", &SequenceEvent::potency_m2},
    {"mean_slip_m", "m", "potency over the length", &SequenceEvent::mean_slip_m},
    {"max_slip_m", "m", "largest slip at rest", &SequenceEvent::max_slip_m},
    {"normal_force_N_per_m", "N/m", "normal force where it begins", &SequenceEvent::normal_force_N_per_m},
    {"shear_force_N_per_m", "N/m", "shear force where it begins", &SequenceEvent::shear_force_N_per_m},
    {"friction_before", "1", "their ratio", &SequenceEvent::friction_before},
    {"friction_after", "1", "that at rest", &SequenceEvent::friction_after},
    {"stress_drop_Pa", "Pa", "tangential traction before less that at rest, mean over what slips",
     &SequenceEvent::stress_drop_Pa},
    {"released_J_per_m", "J/m", "energy stored in bodies and machine before less that at rest",
     &SequenceEvent::released_J_per_m},
    {"friction_work_J_per_m", "J/m", "energy that friction takes", &SequenceEvent::friction_work_J_per_m},
    {"breakdown_work_J_per_m", "J/m",
     "that above the residual traction, over the nodes where friction has fallen: fracture energy times area",
     &SequenceEvent::breakdown_work_J_per_m},
    {"wave_loss_J_per_m", "J/m", "energy of the waves left at its end", &SequenceEvent::wave_loss_J_per_m},
    {"predicted_from_x_m", "m",
     "left end by the equation of motion of a crack in the tractions before, of laws with a fracture energy",
     &SequenceEvent::predicted_from_x_m},
    {"predicted_to_x_m", "m", "right end by it", &SequenceEvent::predicted_to_x_m},
    {"slip_s", "s", "from the first beginning of slip to the last end", &SequenceEvent::slip_s},
    {"n_fronts", "1", "fronts found", &SequenceEvent::n_fronts},
    {"median_speed_m_per_s", "m/s", "median speed of the longest front",
     &SequenceEvent::median_speed_m_per_s},
}};

/// Whether an event has grown beyond its nucleation length. Where all slips, the length may be that of a
/// stiffer block: on a soft machine the whole block slips as one.
inline bool has_nucleated(const SequenceEvent& event) {
  return event.is_global != 0 || event.longest_patch_m > event.nucleation_length_m;
}

template <class Archive>
void SequenceEvent::serialize(Archive& archive) {
  for (const auto& field : sequence_event_fields) archive(this->*field.member);
}

}  // namespace slipfront::record
