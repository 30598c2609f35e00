// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/version.hpp"
#include "cli/commands.hpp"
#include "fronts/fit.hpp"
#include "mesh/plate.hpp"
#include "solve/statics.hpp"
#include "solve/stepper.hpp"

namespace slipfront::cli {
namespace {

using Clock = std::chrono::steady_clock;

/// Arrays that a step reads and writes for every node: u_x, u_y, v_x, v_y, each once in and once out.
constexpr double bytes_per_node_update = 8 * sizeof(double);

/// Median over repetitions of units of work per second; each repetition runs for at least 0.1 s.
double rate(double units_per_call, const std::function<void()>& call) {
  std::vector<double> rates;
  call();
  for (int repetition = 0; repetition < 5; ++repetition) {
    const auto start = Clock::now();
    double seconds = 0;
    std::int64_t calls = 0;
    do {
      call();
      ++calls;
      seconds = std::chrono::duration<double>(Clock::now() - start).count();
    } while (seconds < 0.1);
    rates.push_back(static_cast<double>(calls) * units_per_call / seconds);
  }
  return fronts::median(rates);
}

/// Bytes/s of a loop that streams through the same arrays as a step, without its arithmetic.
double streaming_bandwidth(std::size_t n) {
  std::vector<double> u_x(n, 1.0), u_y(n, 1.0), v_x(n, 1.0), v_y(n, 1.0);
  return rate(bytes_per_node_update * static_cast<double>(n), [&] {
    double* __restrict a = u_x.data();
    double* __restrict b = u_y.data();
    double* __restrict c = v_x.data();
    double* __restrict d = v_y.data();
    for (std::size_t i = 0; i < n; ++i) {
      c[i] *= 0.999999;
      d[i] *= 0.999999;
      a[i] += 1e-9 * c[i];
      b[i] += 1e-9 * d[i];
    }
  });
}

struct Row {
  std::string path;
  int columns, rows;
  double updates_per_s, bound_per_s;
};

/// A plate above the plane, in free vibration: the contact update is done but nothing touches.
Row measure(const std::string& path, int columns, const solve::TimeStepping& time) {
  mesh::Plate plate;
  plate.element_size_m = plate.width_m / columns;
  const auto mesh = mesh::make_plate(plate);
  solve::Stepper stepper(mesh, {}, {interface::VelocityWeakening{}}, time);
  solve::Equilibrium state;
  state.u_m = state.u_per_shear = solid::Field(static_cast<std::size_t>(mesh.n_nodes()));
  state.contact.assign(mesh.lower.size(), solve::Contact::stick);
  for (const auto n : mesh.lower) state.tractions.x_m.push_back(mesh.x_m[n]);
  state.tractions.t_s_Pa.assign(mesh.lower.size(), 0.0);
  state.tractions.p_s_Pa = state.tractions.t_s_Pa;
  stepper.start(state, 1e-3);
  solve::Recorder recorder(state, 1, 1);
  const double updates = rate(stepper.node_updates_per_step(), [&] { stepper.advance(recorder); });
  const double bandwidth = streaming_bandwidth(static_cast<std::size_t>(mesh.n_nodes()));
  return {path, columns, columns / 2, updates, bandwidth / bytes_per_node_update};
}

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown processor";
}

/// The paper's plate, tilted and sheared to the three states that its events need.
void bench_statics(int columns, solve::StaticSolver solver) {
  mesh::Plate plate;
  plate.element_size_m = plate.width_m / columns;
  const double mu_s = interface::VelocityWeakening {
  }.mu_s;
  const auto mesh = mesh::make_plate(plate);
  const auto start = Clock::now();
  const auto cpu_start = std::clock();
  solve::Loading loading;
  loading.solver = solver;
  const solve::Statics statics(mesh, {}, loading, mu_s);
  const double critical_shear_m = statics.shear_to(mu_s).shear_m;
  const auto common = statics.shear_to((1 - loading.critical_margin) * mu_s);
  const auto spontaneous = statics.shear_to((1 + loading.critical_margin) * mu_s);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  const double cpu_seconds = static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const double n_unknowns = 2.0 * mesh.n_nodes();
  fmt::print(
      "{} x {}, {}, {:.3g} unknowns: {:.2f} s ({:.2f} s of processor), {} cycles, peak memory {:.2f} GB, "
      "estimated {:.2f} GB, critical shear {:.12g} m\n",
      mesh.grid.columns, mesh.grid.rows, solve::name_of(solve::choose_solver(solver, n_unknowns)), n_unknowns,
      seconds, cpu_seconds, statics.solver().n_cycles(), 1024e-9 * static_cast<double>(usage.ru_maxrss),
      1e-9 * solve::statics_bytes(solver, n_unknowns), critical_shear_m);
}

void bench(bool json) {
  const solve::TimeStepping plain{.interface_substeps = 1};
  const std::vector<Row> rows = {
      measure("plain scheme", 300, plain), measure("interface sub-cycled", 300, {}),
      measure("plain scheme", 3000, plain), measure("interface sub-cycled", 3000, {})};
  if (json) {
    nlohmann::ordered_json list;
    for (const auto& r : rows)
      list.push_back({{"path", r.path},
                      {"columns", r.columns},
                      {"rows", r.rows},
                      {"node_updates_per_s", r.updates_per_s},
                      {"streaming_bound_per_s", r.bound_per_s},
                      {"fraction_of_bound", r.updates_per_s / r.bound_per_s}});
    const nlohmann::ordered_json all = {{"version", version()},
                                        {"commit", commit()},
                                        {"processor", processor()},
                                        {"compiler", std::string("g++ ") + __VERSION__},
                                        {"threads", 1},
                                        {"rows", list}};
    fmt::print("{}\n", all.dump(2));
    return;
  }
  fmt::print("{}, {}, g++ {}, 1 thread\n\n", version_line(), processor(), __VERSION__);
  fmt::print("{:<24}{:>12}{:>22}{:>22}{:>10}\n", "path", "mesh", "node updates (M/s)",
             "streaming bound (M/s)", "fraction");
  for (const auto& r : rows)
    fmt::print("{:<24}{:>12}{:>22.0f}{:>22.0f}{:>10.2f}\n", r.path, fmt::format("{} x {}", r.columns, r.rows),
               r.updates_per_s * 1e-6, r.bound_per_s * 1e-6, r.updates_per_s / r.bound_per_s);
  fmt::print(
      "\nBound: one sweep of the arrays u, v in and out ({:.0f} bytes a node), at the bandwidth that a loop "
      "without the step's\n"
      "arithmetic reaches on arrays of the same size in this run. Medians of 5.\n",
      bytes_per_node_update);
}

}  // namespace

void add_bench(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("bench", "Measure node updates per second against the machine's bandwidth");
  auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "Print JSON, for comparison between versions");
  auto columns = std::make_shared<int>(0);
  auto solver = std::make_shared<std::string>("iterative");
  command->add_option("--statics", *columns, "Measure the statics of a plate of so many columns instead");
  command->add_option("--solver", *solver, "... by this solver: auto, direct or iterative")
      ->check(CLI::IsMember({"auto", "direct", "iterative"}));
  command->callback([json, columns, solver] {
    if (*columns == 0) return bench(*json);
    for (const auto s :
         {solve::StaticSolver::automatic, solve::StaticSolver::direct, solve::StaticSolver::iterative})
      if (solve::name_of(s) == *solver) bench_statics(*columns, s);
  });
}

}  // namespace slipfront::cli
