// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "fronts/front.hpp"
#include "fronts/record.hpp"
#include "solve/energies.hpp"

namespace slipfront::io {

/// Makes `dir` ready for a run's results. An existing folder that holds anything is refused unless
/// `overwrite` is given; then the files of an earlier run (and no others) are removed.
/// @throws UserError where that is refused or the folder cannot be written.
void prepare_output_folder(const std::filesystem::path& dir, bool overwrite);

/// The first half of it: makes sure that `dir` can take a run's results and makes it where it is missing, but
/// removes nothing.
/// @return the outermost folder that was made; empty where none was.
std::filesystem::path claim_output_folder(const std::filesystem::path& dir, bool overwrite);
/// The second half: removes the files of an earlier run.
void remove_results(const std::filesystem::path& dir);

/// Writes a text file, replacing what it held. @throws UserError where it cannot be written.
void write_text(const std::filesystem::path& file, std::string_view text);

/// static.csv: x_m, t_s_Pa, p_s_Pa.
void write_static(const std::filesystem::path& file, const fronts::StaticState& state);

/// fronts.csv: front_id, x_m, onset_s, direction, v_tip_m_per_s, t_s_Pa, p_s_Pa, t_d_Pa, p_d_Pa, t_r_Pa,
/// p_r_Pa, U_s_J_per_m3, U_r_J_per_m3, a row per front and node in the order of travel; what is undefined is
/// left empty.
void write_fronts(const std::filesystem::path& file, std::span<const fronts::Front> fronts);

/// energy.csv: time_s, the terms of solve::Energies with their unit, and imbalance_J_per_m, a row per
/// instant; the first is the start.
void write_energies(const std::filesystem::path& file, std::span<const solve::Energies> energies);

}  // namespace slipfront::io
