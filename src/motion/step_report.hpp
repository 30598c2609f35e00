// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "motion/step_observer.hpp"
#include "processes/processes.hpp"
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
  template <class Archive>
  void serialize(Archive& archive) {
    archive(time_s, moves, update, changes, around);
  }
};

/// Iterates over the updates.
class SlipUpdateIterator {
 public:
  SlipUpdateIterator(const SlipUpdates& all, std::size_t n_around) : all_(all), n_around_(n_around) {}
  /// Slip of the next update.
  const SlipUpdate& next();

 private:
  const SlipUpdates& all_;
  std::size_t n_around_;
  std::size_t update_ = 0, change_ = 0, around_ = 0;
  SlipUpdate seen_;
};

/// Report of a subdomain, or of all of them, on some steps. Nodes are the owned interface nodes, by their
/// numbers along the whole interface.
struct StepReport {
  SlipFinder::Memory memory;     ///< of the last update
  std::vector<SlipRates> rates;  ///< [steps]
  SlipUpdates seen;
  std::vector<std::vector<double>> samples;  ///< members_of the history but its time, each [rows x nodes]
  std::vector<double> displacements;         ///< [steps x displacement_values of their probes]
  bool is_interrupted = false;               ///< whether the rank is to end the run

  template <class Archive>
  void serialize(Archive& archive) {
    archive(memory, rates, seen, samples, displacements, is_interrupted);
  }
  /// Joins reports of subdomains side by side, in their order.
  static StepReport joined(std::vector<MessageBuffer> of_subdomains);
};

}  // namespace slipfront::motion
