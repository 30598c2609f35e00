// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "base/numbers.hpp"
#include "fracture/tip.hpp"
#include "record/column.hpp"

namespace slipfront::fracture {

struct SlipResponse;
struct CrackLoads;

/// The inverse of speed_factor, by a table.
class SpeedLaw {
 public:
  explicit SpeedLaw(const Bodies& bodies);
  /// At which a long crack runs that has Gamma/G_static = `share`; 0 from 1 on.
  double speed_m_per_s(double share) const;

 private:
  double limit_m_per_s_;
  std::vector<double> factor_;  ///< g at equal steps of speed from 0 to the limit, descending
};

/// A front at a node, as it is predicted.
struct PredictedPoint {
  double x_m = 0;
  double length_m = 0;  ///< of the crack
  double G_static_J_per_m2 = 0;
  double fracture_energy_J_per_m2 = 0;
  double v_tip_m_per_s = 0;
  double time_s = nan;  ///< since the fronts began; not a number of a node that none breaks
  std::size_t node = 0;
};

inline constexpr std::array<record::Column<PredictedPoint, double>, 6> predicted_fields = {{
    {"x_m", "m", "position along the interface", &PredictedPoint::x_m},
    {"length_m", "m", "length of the crack whose tip is there", &PredictedPoint::length_m},
    {"G_static_J_per_m2", "J/m2", "energy release rate of that crack at rest",
     &PredictedPoint::G_static_J_per_m2},
    {"fracture_energy_J_per_m2", "J/m2", "fracture energy", &PredictedPoint::fracture_energy_J_per_m2},
    {"v_tip_m_per_s", "m/s", "speed by G_static g(v) = fracture energy", &PredictedPoint::v_tip_m_per_s},
    {"time_s", "s", "time since the fronts began", &PredictedPoint::time_s},
}};

enum class PredictedEnd { arrest, contact_end };

/// A front in one direction.
struct PredictedFront {
  int direction = 0;
  std::vector<PredictedPoint> points;  ///< in the order of travel; the last one of a front that arrests is
                                       ///< the node that it does not break
  PredictedEnd end = PredictedEnd::arrest;

  bool arrests() const { return end == PredictedEnd::arrest; }
};

struct Prediction {
  bool starts = false;        ///< whether the first crack has energy to run
  double first_length_m = 0;  ///< of the first crack
  /// Least length from which a crack runs that grows from the first one slowly, at the tip that is nearer to
  /// it; not a number where none does.
  double critical_length_m = nan;
  std::vector<PredictedFront> fronts;  ///< from the first crack, or the critical one where that is longer
};

/// Fronts from a first crack by the equation of motion G_static g(v) = fracture energy, G_static of the crack
/// between both tips as it is at the time.
/// @param fracture_energy_J_per_m2  [nodes]
/// @param first, last               nodes of the first crack
Prediction predict(const SlipResponse& response, const CrackLoads& loads,
                   const std::vector<double>& fracture_energy_J_per_m2, std::size_t first, std::size_t last,
                   const SpeedLaw& law);

}  // namespace slipfront::fracture
