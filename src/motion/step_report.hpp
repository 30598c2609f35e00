// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "motion/slip_finder.hpp"
#include "motion/time_stepper.hpp"
#include "processes/message_buffer.hpp"
#include "record/record.hpp"

namespace slipfront::motion {

/// Changes of slip in several contact updates.
struct SlipUpdates {
  std::vector<double> time_s;            ///< [updates] to which their tractions belong
  std::vector<std::uint8_t> moves;       ///< [updates] whether a node slips faster than creep
  std::vector<std::int32_t> update;      ///< [changes] ascending
  std::vector<SlipChange> changes;       ///< nodes of an update ascending
  std::vector<record::Traction> around;  ///< at the beginnings among them, [beginnings x n_around]

  void add(const SlipUpdate& seen);
};

/// Iterates over the updates.
class SlipUpdateIterator {
 public:
  SlipUpdateIterator(const SlipUpdates& all, std::size_t n_around) : all_(all), n_around_(n_around) {}
  /// Of the next update.
  const SlipUpdate& next();

 private:
  const SlipUpdates& all_;
  std::size_t n_around_;
  std::size_t update_ = 0, change_ = 0, around_ = 0;
  SlipUpdate seen_;
};

/// Report of a subdomain, or of neighbouring ones, on the steps of a command. Nodes are the owned interface
/// nodes, by their global numbers.
struct StepReport {
  SlipFinder::Memory memory;     ///< of the last update
  std::vector<SlipRates> rates;  ///< [steps]
  SlipUpdates seen;
  std::array<std::vector<double>, record::history_fields.size()> samples;  ///< each [rows x nodes]
  std::vector<double> displacements;  ///< [steps x displacement_values of their probes]

  void put(MessageBuffer& to) const;
  static StepReport take(MessageBuffer& from);
  /// Of subdomains side by side, in their order.
  static StepReport joined(std::span<const StepReport> parts);
  static StepReport take_joined(std::span<MessageBuffer> from);
};

}  // namespace slipfront::motion
