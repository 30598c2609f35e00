// SPDX-License-Identifier: BSD-3-Clause
// Prints the tables of docs/processes-cost.md that are on paper: what the model predicts for plates that no
// machine at hand holds.
#include <fmt/core.h>

#include <cmath>
#include <string>
#include <vector>

#include "run/process_cost.hpp"
#include "run/run.hpp"

using namespace slipfront;

namespace {

constexpr run::Network network = {2e-6, 10e9};
constexpr double rate_per_s = 450e6;
constexpr double steps = 10'000;

/// A plate twice as wide as high of so many nodes, the plain scheme, a row of history every ten steps.
run::SharedWork work(double n_nodes) {
  run::SharedWork work;
  work.n_columns = std::round(std::sqrt(2 * n_nodes));
  work.n_nodes = work.n_cells = n_nodes;
  work.node_updates_per_step = n_nodes;
  work.node_updates_per_s = rate_per_s;
  const double rows = n_nodes / work.n_columns, rows_with_interface = 2;
  work.bytes_per_column = 8 * (4 * rows + 20);
  work.interface_bytes_per_column = 8 * (4 * rows_with_interface + 20);
  work.interface_share = rows_with_interface / rows;
  work.steps = steps;
  work.advances = steps / 50;
  work.energies = steps / 100;
  work.history_rows = steps / 10;
  work.values_per_row = 4 * work.n_columns;
  work.bytes_per_interface_node = run::bytes_per_interface_node(input::Case{});
  work.program_bytes = run::program_bytes;
  work.leads_by_interface = true;
  return work;
}

void print_row(double n_nodes, int n_processes) {
  const auto w = work(n_nodes);
  constexpr int columns_per_step = 1, reach = 1;
  try {
    mesh::Mesh plate;
    plate.grid.columns = static_cast<int>(w.n_columns) - 1;
    const auto division = motion::divide_columns(plate, n_processes, columns_per_step, reach);
    const auto c = run::process_cost(w, division, n_processes, network);
    const auto ms = [&](double s) { return fmt::format("{:.3g}", 1e3 * s / steps); };
    const double efficiency = n_nodes / rate_per_s / n_processes / (c.event_s() / steps);
    fmt::print("| {:.0e} | {} | {} | {} + {} | {} | {} | {} | {} | {} | {} | {:.0f} % | {:.3g} | {:.3g} |\n",
               n_nodes, n_processes, division.steps_per_exchange, division.own(1).end - division.own(1).begin,
               2 * division.halo, ms(c.own_s), ms(c.halo_s), ms(c.exchange_s), ms(c.command_s),
               ms(c.gathering_s), ms(c.event_s()), 100 * efficiency, c.memory_bytes * 1e-9,
               c.leader_memory_bytes * 1e-9);
  } catch (const std::exception& error) {
    fmt::print("| {:.0e} | {} | {} |\n", n_nodes, n_processes, error.what());
  }
}

void print_head(const char* title) {
  fmt::print("{}\n\n", title);
  fmt::print(
      "| nodes | processes | steps per exchange | columns + halo | own | halo | exchange | commands | "
      "gathering | "
      "a step | efficiency | GB of each | GB of the leader "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
}

}  // namespace

int main() {
  print_head("strong growth");
  for (const double n : {1e9, 1e11})
    for (const int p : {10, 100, 1000, 10'000}) print_row(n, p);
  print_head("\nweak growth");
  for (const int p : {10, 100, 1000, 10'000}) print_row(1e7 * p, p);
}
