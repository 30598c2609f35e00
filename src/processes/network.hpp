// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "processes/processes.hpp"

namespace slipfront {

/// What lies between two processes, medians of repeated measurements.
struct Link {
  int from = 0, to = 0;
  double latency_s = 0;              ///< half a round trip of one number
  double bandwidth_bytes_per_s = 0;  ///< each way, of several messages both ways at once
};

/// Measures while the other process is in answer_link; within a few seconds where latency is small.
Link measure_link(Processes& processes, int with);
void answer_link(Processes& processes, int with);

}  // namespace slipfront
