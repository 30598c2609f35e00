// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "fracture/passage.hpp"
#include "fronts/front.hpp"
#include "record/breakdown.hpp"
#include "record/energies.hpp"
#include "record/record.hpp"
#include "record/sequence.hpp"
#include "results/rows.hpp"

/// Tables of a run. Each throws BlowUp where a number of a complete result is not finite, but for those that
/// may be missing, which are left empty.
namespace slipfront::results {

struct NamedColumn {
  std::string name;  ///< with its unit
  std::vector<double> values;
};

/// static.csv: x_m, t_s_Pa, p_s_Pa, and further columns of the same nodes.
void write_static(const std::filesystem::path& file, const record::StaticState& state,
                  std::span<const NamedColumn> further = {});

/// fronts.csv: front_id, x_m, onset_s, direction, v_tip_m_per_s, t_s_Pa, p_s_Pa, t_d_Pa, p_d_Pa, t_r_Pa,
/// p_r_Pa, U_s_J_per_m3, U_r_J_per_m3, speed_kind (fronts::SpeedKind), a row per front and node in the order
/// of travel; what is undefined is left empty.
void write_fronts(const std::filesystem::path& file, std::span<const fronts::Front> fronts,
                  Numbers numbers = Numbers::finite);

/// fracture.csv: front_id, x_m, onset_s, direction, v_tip_m_per_s, record::breakdown_fields of the node and
/// fracture::passage_fields, a row per front and node in the order of travel; what is undefined is left
/// empty.
/// @param passages  of each front
void write_fracture(const std::filesystem::path& file, std::span<const fronts::Front> fronts,
                    const record::Breakdown& breakdown,
                    std::span<const std::vector<fracture::Passage>> passages,
                    Numbers numbers = Numbers::finite);

/// energy.csv: time_s, the terms of record::Energies with their unit, and imbalance_J_per_m, a row per
/// instant; the first is the start.
void write_energies(const std::filesystem::path& file, std::span<const record::Energies> energies,
                    Numbers numbers = Numbers::finite);

/// loading.csv: event (the number of those that have begun), phase (record::LoadingPhase),
/// record::loading_fields, the terms of record::Energies, record::wave_loss, imbalance_J_per_m.
void write_loading(const std::filesystem::path& file, std::span<const record::LoadingRow> rows,
                   Numbers numbers = Numbers::finite);
/// events.csv: event (its number, from 1), record::sequence_event_fields; what is undefined is left empty.
void write_events(const std::filesystem::path& file, std::span<const record::SequenceEvent> events,
                  Numbers numbers = Numbers::finite);

}  // namespace slipfront::results
