// SPDX-License-Identifier: BSD-3-Clause
// interface.h5: the history of the interface.
#include "motion/observers/history_rows.hpp"
#include "results/outputs.hpp"
#include "results/rows.hpp"
#include "results/table.hpp"

namespace slipfront::results {

Table history_table(std::span<const double> x_m, const Origin& origin,
                    std::span<const Description> law_states) {
  Table table{origin,
              {{description_of(record::history_place), {x_m.begin(), x_m.end()}}},
              {},
              description_of(record::history_time),
              descriptions_of(record::history_fields)};
  table.fields.insert(table.fields.end(), law_states.begin(), law_states.end());
  return table;
}

const Output history_output = {
    .file = "interface.h5",
    .name = "the history",
    .remedy = [] { return Message("a larger {}", Key("output.history_interval_s")); },
    .forecast =
        [](const OutputSetup& setup) {
          const auto row_values = record::history_row_values(static_cast<std::size_t>(setup.n_interface),
                                                             setup.law_states.size());
          const double n_rows = rows_at(setup, setup.history_interval_s);
          return Forecast{n_rows, n_rows * sizeof(double) * static_cast<double>(row_values)};
        },
    .format =
        [](const OutputSetup& setup) {
          return row_format(history_output.file, history_table(setup.x_m, setup.origin, setup.law_states));
        },
    .observer = [](const OutputSetup& setup, motion::TimeStepper& /*stepper*/,
                   RowSink& rows) -> std::unique_ptr<motion::Observer> {
      return std::make_unique<motion::HistoryRows>(
          setup.history_interval_s,
          [&rows](const record::History& row) { rows.put(rows_of(members_of(row))); });
    }};

}  // namespace slipfront::results
