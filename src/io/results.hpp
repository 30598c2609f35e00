// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "fronts/front.hpp"
#include "fronts/record.hpp"
#include "mesh/mesh.hpp"
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

/// Writes interface.h5: time_s [nt], x_m [nx], slip_m, slip_rate_m_per_s, t_Pa, p_Pa [nt, nx], each with the
/// attributes `unit` and `description`. @throws UserError where the file cannot be written.
void write_history(const std::filesystem::path& file, const fronts::History& history);

/// Reads a file that write_history wrote, or another program with the same names and units.
/// @throws UserError naming the file and the missing or misshaped data set.
fronts::History read_history(const std::filesystem::path& file);

/// static.csv: x_m, t_s_Pa, p_s_Pa.
void write_static(const std::filesystem::path& file, const fronts::StaticState& state);

/// fronts.csv: front_id, x_m, onset_s, direction, v_tip_m_per_s, t_s_Pa, p_s_Pa, t_d_Pa, p_d_Pa, t_r_Pa,
/// p_r_Pa, U_s_J_per_m3, U_r_J_per_m3, a row per front and node in the order of travel; what is undefined is
/// left empty.
void write_fronts(const std::filesystem::path& file, std::span<const fronts::Front> fronts);

/// energy.csv: time_s, the terms of solve::Energies with their unit, and imbalance_J_per_m, a row per
/// instant; the first is the start.
void write_energies(const std::filesystem::path& file, std::span<const solve::Energies> energies);

/// Whole-plate fields at one instant. [nodes]
struct Snapshot {
  double time_s = 0;
  std::vector<double> u_x_m, u_y_m;              ///< displacement
  std::vector<double> v_x_m_per_s, v_y_m_per_s;  ///< velocity
};

/// fields.vtkhdf: VTKHDF (version 2.0) unstructured grid, mesh written once, a step per snapshot, point data
/// `displacement_m` and `velocity_m_per_s`; ParaView 5.12 and h5py read it. Without snapshots: the mesh
/// alone.
/// @throws UserError where the file cannot be written.
void write_snapshots(const std::filesystem::path& file, const mesh::Mesh& mesh,
                     std::span<const Snapshot> snapshots);

}  // namespace slipfront::io
