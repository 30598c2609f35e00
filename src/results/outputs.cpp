// SPDX-License-Identifier: BSD-3-Clause
#include "results/outputs.hpp"

#include <algorithm>
#include <cmath>

namespace slipfront::results {

double rows_at(const OutputSetup& setup, double interval_s) {
  return std::floor(setup.end_s / std::max(interval_s, setup.step_s)) + 1;
}

std::vector<RowFormat> formats_of(const OutputSetup& setup) {
  std::vector<RowFormat> formats;
  for (const auto* output : outputs)
    if (output->forecast(setup).n_rows > 0) formats.push_back(output->format(setup));
  return formats;
}

motion::Observers observers_of(const OutputSetup& setup, motion::TimeStepper& stepper, const Sinks& sinks) {
  motion::Observers observers;
  for (const auto* output : outputs)
    if (output->forecast(setup).n_rows > 0)
      observers.push_back(output->observer(setup, stepper, sinks(*output)));
  return observers;
}

}  // namespace slipfront::results
