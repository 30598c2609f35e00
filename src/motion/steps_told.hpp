// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "motion/recorder.hpp"
#include "motion/time_stepper.hpp"
#include "processes/parcel.hpp"
#include "record/record.hpp"

namespace slipfront::motion {

/// What several contact updates show of slip.
struct SlipsSeen {
  std::vector<double> time_s;            ///< [updates] to which their tractions belong
  std::vector<std::uint8_t> moves;       ///< [updates] whether a node slips faster than creep
  std::vector<std::int32_t> update;      ///< [changes] ascending
  std::vector<SlipChange> changes;       ///< nodes of an update ascending
  std::vector<record::Traction> around;  ///< at the beginnings among them, [beginnings x n_around]

  void add(const SlipSeen& seen);
};

/// Shows several updates one after the other.
class SlipsInTurn {
 public:
  SlipsInTurn(const SlipsSeen& all, std::size_t n_around) : all_(all), n_around_(n_around) {}
  /// Of the next update.
  const SlipSeen& next();

 private:
  const SlipsSeen& all_;
  std::size_t n_around_;
  std::size_t update_ = 0, change_ = 0, around_ = 0;
  SlipSeen seen_;
};

/// What a part, or several side by side, tell of the steps of a command. Nodes are those of the interface for
/// which they account, in the numbers of the whole interface.
struct StepsTold {
  SlipFinder::Memory memory;     ///< of the last update
  std::vector<SlipRates> rates;  ///< [steps]
  SlipsSeen seen;
  std::array<std::vector<double>, record::history_fields.size()> samples;  ///< each [rows x nodes]
  std::vector<double> displacements;  ///< [steps x displacement_values of their probes]

  void put(Parcel& to) const;
  static StepsTold take(Parcel& from);
  /// Of parts side by side, in their order.
  static StepsTold joined(std::span<const StepsTold> parts);
  static StepsTold take_joined(std::span<Parcel> from);
};

}  // namespace slipfront::motion
