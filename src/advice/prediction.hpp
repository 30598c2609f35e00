// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.hpp"
#include "base/numbers.hpp"
#include "fracture/prediction.hpp"
#include "problem/problem.hpp"
#include "record/record.hpp"
#include "setup/initial_state.hpp"

namespace slipfront::fracture {
struct SlipResponse;
}

namespace slipfront::advice {

/// What friction does behind a tip, where it is known otherwise than by the law: from a run, or from
/// measurements.
struct TipFriction {
  std::vector<double> x_m;  ///< ascending; values between are interpolated, beyond the ends constant
  std::vector<double> fracture_energy_J_per_m2, residual_coefficient;  ///< [places], or empty: of the law
};

/// What a case lets expect of its fronts as cracks.
struct FracturePrediction {
  fracture::Prediction of_fronts;
  std::size_t n_nodes = 0;  ///< on the interface
  bool covers_all = false;  ///< the first crack is the whole interface
  /// Length of a patch where the fronts begin over which slow slip runs away; not a number where none does,
  /// or where friction does not weaken over a slip.
  double nucleation_length_m = nan;
  std::string bodies;  ///< whose static response it is, in words
  Diagnostics notes;   ///< what it leaves out
  /// Why fronts may run on where they arrest by it; then no arrest is predicted.
  std::vector<std::string> doubts_of_arrest;
  bool predicts_arrest(const fracture::PredictedFront& front) const {
    return front.arrests() && doubts_of_arrest.empty();
  }
};

/// Where these take no statics and the law has a fracture energy: of prescribed tractions, the far edge not
/// held.
std::optional<FracturePrediction> quick_prediction(const Problem& problem);

/// Whether the law has a fracture energy of its own.
bool has_fracture_energy(const Problem& problem);

/// Predicts fronts of one sample. Its statics are solved once, with elements large enough for some hundreds
/// of nodes on the interface.
class FrontPredictor {
 public:
  /// @throws UserError as the statics of the case
  explicit FrontPredictor(const Problem& problem);

  /// @param friction  instead of the law's
  /// @param x_m       where the crack begins, instead of at the case's trigger
  /// @param before    tractions before the event at any places, instead of the case's
  /// @throws UserError where the law has no fracture energy of its own and none is given
  FracturePrediction predict(const TipFriction& friction = {}, const std::optional<double>& x_m = {},
                             const record::StaticState* before = nullptr) const;
  /// From here on with mu_s that has grown at rest by `healed` at places, linear between; empty where it has
  /// not.
  void set_healed(const std::vector<double>& x_m, const std::vector<double>& healed);

 private:
  Problem given_, problem_;
  InitialState initial_;
  std::shared_ptr<const fracture::SlipResponse> response_;
};

/// Prediction of one event.
FracturePrediction predict_fronts(const Problem& problem, const TipFriction& friction = {},
                                  const std::optional<double>& x_m = {});

}  // namespace slipfront::advice
