// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "papers/kammer2012/outcome.hpp"
#include "run/batch.hpp"

namespace slipfront::kammer2012 {

/// What the paper's plate is laid on.
struct BaseOption {
  std::string name;
  std::optional<solid::Material> material;  ///< none: the rigid plane
};

/// The plate's own material, aluminium, steel, and the rigid plane. Room temperature values of handbooks.
const std::vector<BaseOption>& base_options();

/// The paper's four events on a base: a body as high and wide as the plate, held at its bottom. The tilt is
/// larger by the share of compression that the base takes, so that the nominal pressure is the paper's.
std::vector<NamedCase> cases_on(const BaseOption& base, bool quick);

/// Change of pressure from the state before the event to the onset, over that before it: median over the
/// points of the main fronts of a direction; NaN without any.
struct PressureChange {
  double along = 0, against = 0;
};

/// The events on one base.
struct OnBase {
  BaseOption base;
  double tilt_factor = 1;  ///< by which the tilt is larger than the paper's
  std::vector<Outcome> events;
  /// V_tip against the shear over V_tip along it at equal t_d/p_d: main fronts of mu_k = 0.6.
  fronts::Ratio speed_ratio;
  PressureChange pressure_change;
  Collapse main_fronts;  ///< of all four events
};

struct BasesOptions {
  bool quick = false;  ///< elements of 2 mm
  int threads = 1;
  std::filesystem::path kept = {};  ///< folder of the runs that are done; empty for none
};

struct BasesResult {
  bool quick = false;
  std::vector<OnBase> bases;
  run::Counts counts;
  std::vector<std::string> warnings;  ///< runs that blew up
};

/// Told often how many runs are done; returns false to interrupt.
using BasesMonitor = std::function<bool(std::size_t done, std::size_t total)>;

/// What remains of the paper's directionality, which its rigid base explains, and of its energy criterion
/// when the base is deformable, down to a base of the plate's own material.
/// @throws UserError, Interrupted
BasesResult study_bases(const BasesOptions& options, const BasesMonitor& monitor);

/// bases.csv (a row per base), bases_points.csv (a row per point of the main fronts), bases.json.
void write_bases(const std::filesystem::path& dir, const BasesResult& result);

}  // namespace slipfront::kammer2012
