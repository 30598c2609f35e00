// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/message.hpp"
#include "motion/observer.hpp"
#include "record/probes.hpp"
#include "results/contents.hpp"
#include "solid/element.hpp"

namespace slipfront::results {

struct Table;

/// What the outputs of an event are made of.
struct OutputSetup {
  Origin origin = {};
  double step_s = 0, end_s = 0;
  double n_interface = 0, n_nodes = 0;  ///< of the interface, of the bodies; of forecasts about so many
  std::vector<double> x_m = {};         ///< of the interface nodes
  std::vector<Description> law_states = {};
  double history_interval_s = 1;
  std::vector<record::ProbePlace> probes = {};
  double probe_interval_s = 1;
  std::vector<double> snapshot_times_s = {};  ///< ascending
  bool snapshot_stress = false;
  Seam seam = {};
  bool moment_rate = false;
  std::vector<double> tributary_m = {};  ///< of the interface nodes
  double shear_modulus_Pa = 0, c_S_m_per_s = 0;
  std::optional<solid::UniformStress> further_stress = {};  ///< of the probes, that displacements leave out
};

/// What an output comes to, at most.
struct Forecast {
  double n_rows = 0;  ///< 0 of one that is not wanted
  double bytes = 0;   ///< on the disk
};

/// An output of an event: a file of rows, and the observer that puts them.
struct Output {
  const char* file;
  const char* name;     ///< in messages
  Message (*remedy)();  ///< what to choose for less of it
  Forecast (*forecast)(const OutputSetup& setup);
  RowFormat (*format)(const OutputSetup& setup);
  /// @param stepper  about to begin, or to go on
  /// @param rows     outlives the observer
  std::unique_ptr<motion::Observer> (*observer)(const OutputSetup& setup, motion::TimeStepper& stepper,
                                                RowSink& rows);
};

extern const Output history_output, probe_output, snapshot_output, moment_rate_output;
/// All of them.
inline constexpr std::array outputs = {&history_output, &probe_output, &snapshot_output, &moment_rate_output};

/// Rows at an interval, from time 0 to the end.
double rows_at(const OutputSetup& setup, double interval_s);

/// Where each output puts its rows.
using Sinks = std::function<RowSink&(const Output& output)>;
/// Of the outputs that are wanted.
std::vector<RowFormat> formats_of(const OutputSetup& setup);
motion::Observers observers_of(const OutputSetup& setup, motion::TimeStepper& stepper, const Sinks& sinks);

/// Rows in memory, by their files.
struct KeptRows final : RowSink {
  std::vector<double> values;
  void put(std::vector<double> more) override { values.insert(values.end(), more.begin(), more.end()); }
};
using KeptOutputs = std::map<std::string, KeptRows>;

/// interface.h5: time_s [times], x_m [nodes], record::history_fields and the law's states [times, nodes].
Table history_table(std::span<const double> x_m, const Origin& origin = {},
                    std::span<const Description> law_states = {});
/// probes.h5: name, x_m and y_m of the probes, time_s and record::probe_fields [times, probes].
Table probe_table(std::span<const record::ProbePlace> places, const Origin& origin = {});

}  // namespace slipfront::results
