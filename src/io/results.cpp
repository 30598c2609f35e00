// SPDX-License-Identifier: BSD-3-Clause
#include "io/results.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string_view>
#include <system_error>

#include "base/error.hpp"

namespace slipfront::io {
namespace {

/// What a run writes.
constexpr std::array<const char*, 7> result_files = {"case.resolved.toml", "run.json",   "interface.h5",
                                                     "fronts.csv",         "static.csv", "energy.csv",
                                                     "fields.vtkhdf"};

/// A field of a CSV file; empty where the value is undefined.
std::string field(double value) {
  return std::isnan(value) ? "" : fmt::format("{}", value);
}

}  // namespace

void write_text(const std::filesystem::path& file, std::string_view text) {
  errno = 0;
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream << text << std::flush;
  if (!stream)
    throw UserError("{}: cannot be written ({}); check that its folder exists and can be written",
                    file.string(), std::strerror(errno));
}

void prepare_output_folder(const std::filesystem::path& dir, bool overwrite) {
  claim_output_folder(dir, overwrite);
  remove_results(dir);
}

std::filesystem::path claim_output_folder(const std::filesystem::path& dir, bool overwrite) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(dir, error);
  if (fs::exists(status) && !fs::is_directory(status))
    throw UserError("output folder {}: is a file; choose another name", dir.string());
  fs::path made;
  for (fs::path p = dir; !p.empty() && !fs::exists(p, error); p = p.parent_path()) made = p;
  fs::create_directories(dir, error);
  if (error)
    throw UserError("output folder {}: cannot be made ({}); choose another place", dir.string(),
                    error.message());
  if (::access(dir.c_str(), W_OK | X_OK) != 0)
    throw UserError("output folder {}: cannot be written ({}); choose another place", dir.string(),
                    std::strerror(errno));
  const bool empty = fs::is_empty(dir, error);
  if (error)
    throw UserError("output folder {}: cannot be read ({}); choose another place", dir.string(),
                    error.message());
  if (!empty && !overwrite)
    throw UserError(
        "output folder {}: is not empty; choose another or pass --overwrite to replace a run's results",
        dir.string());
  for (const char* name : result_files)
    if (fs::is_directory(fs::symlink_status(dir / name, error)))
      throw UserError("{}: is a folder where a result file is to go; move it away", (dir / name).string());
  return made;
}

void remove_results(const std::filesystem::path& dir) {
  std::error_code error;
  for (const char* name : result_files) {
    const auto file = dir / name;
    std::filesystem::remove(file, error);
    if (error)
      throw UserError("{}: cannot be removed ({}); remove it by hand", file.string(), error.message());
  }
}

void write_static(const std::filesystem::path& file, const fronts::StaticState& state) {
  SLIPFRONT_ASSERT(state.t_s_Pa.size() == state.x_m.size() && state.p_s_Pa.size() == state.x_m.size(),
                   "columns of the static state differ in length");
  std::string text = "x_m,t_s_Pa,p_s_Pa\n";
  for (std::size_t i = 0; i < state.x_m.size(); ++i)
    text += fmt::format("{},{},{}\n", field(state.x_m[i]), field(state.t_s_Pa[i]), field(state.p_s_Pa[i]));
  write_text(file, text);
}

void write_energies(const std::filesystem::path& file, std::span<const solve::Energies> energies) {
  std::string text =
      "time_s,strain_J_per_m,kinetic_J_per_m,top_work_J_per_m,trigger_work_J_per_m,prestress_work_J_per_m,"
      "friction_work_J_per_m,contact_work_J_per_m,damping_work_J_per_m,boundary_work_J_per_m,"
      "coupling_work_J_per_m,imbalance_J_per_m\n";
  for (const auto& e : energies)
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", field(e.time_s), field(e.strain),
                        field(e.kinetic), field(e.top_work), field(e.trigger_work), field(e.prestress_work),
                        field(e.friction_work), field(e.contact_work), field(e.damping_work),
                        field(e.boundary_work), field(e.coupling_work),
                        field(solve::imbalance_J_per_m(e, energies.front())));
  write_text(file, text);
}

void write_fronts(const std::filesystem::path& file, std::span<const fronts::Front> fronts) {
  std::string text =
      "front_id,x_m,onset_s,direction,v_tip_m_per_s,t_s_Pa,p_s_Pa,t_d_Pa,p_d_Pa,t_r_Pa,p_r_Pa,"
      "U_s_J_per_m3,U_r_J_per_m3\n";
  for (const fronts::Front& front : fronts)
    for (const fronts::FrontPoint& point : front.points)
      text +=
          fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", front.id, field(point.x_m),
                      field(point.onset_s), front.direction, field(point.v_tip_m_per_s), field(point.t_s_Pa),
                      field(point.p_s_Pa), field(point.t_d_Pa), field(point.p_d_Pa), field(point.t_r_Pa),
                      field(point.p_r_Pa), field(point.U_s_J_per_m3), field(point.U_r_J_per_m3));
  write_text(file, text);
}

}  // namespace slipfront::io
