// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench.hpp"

#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <numeric>
#include <random>
#include <thread>

#include "advice/needs.hpp"
#include "base/budget.hpp"
#include "base/clock.hpp"
#include "fronts/fit.hpp"
#include "input/case.hpp"
#include "interface/friction/velocity_weakening.hpp"
#include "mesh/plate.hpp"
#include "mesh/reorder.hpp"
#include "motion/observers/onsets.hpp"
#include "motion/stepper.hpp"
#include "problem/problem.hpp"
#include "run/run.hpp"
#include "setup/initial_state.hpp"
#include "solid/kernels.hpp"
#include "statics/prestress.hpp"
#include "statics/statics.hpp"

namespace slipfront::bench {

namespace {

/// Median over repetitions of units of work per second; each repetition runs for at least 0.1 s.
double rate(double units_per_call, const std::function<void()>& call) {
  std::vector<double> rates;
  call();
  for (int repetition = 0; repetition < 5; ++repetition) {
    const auto start = Clock::now();
    double seconds = 0;
    int calls = 0;
    do {
      call();
      ++calls;
      seconds = seconds_since(start);
    } while (seconds < 0.1);
    rates.push_back(calls * units_per_call / seconds);
  }
  return fronts::median(rates);
}

/// Calls work(thread) in so many threads.
template <class Work>
void in_threads(int threads, Work work) {
  std::vector<std::jthread> others;
  for (int thread = 1; thread < threads; ++thread) others.emplace_back(work, thread);
  work(0);
}

/// Bytes/s of a loop that streams through the same arrays as a step, without its arithmetic.
double streaming_bandwidth(int threads) {
  constexpr std::size_t n = 4'000'000;  // per thread and array: 128 MB together
  struct Arrays {
    std::vector<double> u_x, u_y, v_x, v_y;
  };
  std::vector<Arrays> arrays(static_cast<std::size_t>(threads));
  const auto fill = [&](int thread) {
    const std::vector<double> ones(n, 1.0);
    arrays[static_cast<std::size_t>(thread)] = {ones, ones, ones, ones};
  };
  in_threads(threads, fill);
  const auto stream = [&](int thread) {
    auto& a = arrays[static_cast<std::size_t>(thread)];
    double* __restrict u_x = a.u_x.data();
    double* __restrict u_y = a.u_y.data();
    double* __restrict v_x = a.v_x.data();
    double* __restrict v_y = a.v_y.data();
    for (std::size_t i = 0; i < n; ++i) {
      v_x[i] *= 0.999999;
      v_y[i] *= 0.999999;
      u_x[i] += 1e-9 * v_x[i];
      u_y[i] += 1e-9 * v_y[i];
    }
  };
  return rate(threads * bytes_per_node_update * static_cast<double>(n), [&] { in_threads(threads, stream); });
}

/// Node updates/s of the interior stencil with the ledger's sums, w = u + beta_R v included, over a few rows
/// in the nearest cache.
double stencil_alone() {
  constexpr int stride = 96, rows = 4;
  const solid::InteriorStencil stencil{-1e-3, 1e-4, 2e-4, 3e-4, 1e-4};
  solid::Field u(stride * rows), v(stride * rows);
  for (std::size_t n = 0; n < u.size(); ++n) u.x[n] = 1e-6 * static_cast<double>(n % 7), v.y[n] = 1e-3;
  solid::RollingRows w(stride);
  solid::KickSums sums;
  const double updates = (stride - 2) * (rows - 2);
  constexpr int sweeps_per_call = 1000;
  return rate(sweeps_per_call * updates, [&] {
    for (int sweep = 0; sweep < sweeps_per_call; ++sweep) {
      const auto fill = [&](int j) {
        const int o = j * stride;
        solid::combine_row(stride, 1e-7, &u.x[o], &u.y[o], &v.x[o], &v.y[o], w.x(j), w.y(j));
      };
      fill(0);
      fill(1);
      for (int j = 1; j + 1 < rows; ++j) {
        fill(j + 1);
        const int o = j * stride;
        solid::push_interior_row<true>(stencil, {1, stride - 1}, 1e-9, {w.x(j + 2), w.y(j + 2)},
                                       {w.x(j), w.y(j)}, {w.x(j + 1), w.y(j + 1)}, &v.x[o], &v.y[o], &u.x[o],
                                       &u.y[o], sums);
      }
    }
  });
}

/// Bytes that the process occupies.
double resident_bytes() {
  std::ifstream file("/proc/self/statm");
  double pages = 0, resident = 0;
  file >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// The plate of Kammer et al. (2012).
mesh::Plate plate_of(int columns) {
  constexpr double width_m = 0.2, height_m = 0.1;
  return {.width_m = width_m,
          .height_m = height_m,
          .element_size_m = width_m / columns,
          .corner = mesh::Corner::relief,
          .relief_length_m = 5e-3,
          .relief_height_m = 0.5e-3,
          .relief_depth_m = 10e-3};
}

/// The plate pressed on the plane, that begins to slip on its left half.
class SlippingPlate {
 public:
  SlippingPlate(const mesh::Mesh& mesh, const motion::TimeStepping& time, const motion::Execution& execution)
      : stepper_(mesh, {}, {interface::VelocityWeakening{}}, time, execution), recorder_(start(mesh)) {}

  motion::Stepper& stepper() { return stepper_; }
  motion::Recorder& recorder() { return recorder_; }

 private:
  motion::Recorder start(const mesh::Mesh& mesh) {
    record::StaticState tractions;
    for (const auto n : mesh.interface_nodes) tractions.x_m.push_back(mesh.x_m[n]);
    tractions.p_s_Pa.assign(mesh.interface_nodes.size(), 1e6);
    tractions.t_s_Pa.assign(mesh.interface_nodes.size(), 0.7e6);
    std::fill_n(tractions.t_s_Pa.begin(), mesh.interface_nodes.size() / 2, 1.4e6);
    const auto state = statics::prestressed(mesh, tractions);
    stepper_.start(state, 0, motion::prescribed_loads(state));
    return {state, interface::VelocityWeakening{}.mu_s, 1};
  }

  motion::Stepper stepper_;
  motion::Recorder recorder_;
};

/// @param make_mesh  called when there is memory for so many columns of squares
Rate measure_path(const std::string& path, int columns, const motion::TimeStepping& time,
                  const motion::Execution& execution, const std::function<mesh::Mesh()>& make_mesh) {
  const int rows = columns / 2;
  const double nodes = (columns + 1.0) * (rows + 1.0);
  require_memory({{"its motion", advice::motion_bytes(nodes), "a machine with more"}},
                 fmt::format("a plate of {:.4g} nodes", nodes));
  const double before = resident_bytes();
  SlippingPlate plate(make_mesh(), time, execution);
  auto& stepper = plate.stepper();
  constexpr double updates_per_call = 2e7;
  const auto min_steps = std::int64_t{2} * execution.threads * stepper.steps_per_sweep();
  const auto steps =
      std::max(min_steps, static_cast<std::int64_t>(updates_per_call / stepper.node_updates_per_step()));
  const double updates = static_cast<double>(steps) * stepper.node_updates_per_step();
  Rate result{path, columns, columns / 2, execution.threads, stepper.steps_per_sweep()};
  result.node_updates_per_s = rate(updates, [&] { stepper.advance(plate.recorder(), steps); });
  constexpr double enough_nodes = 1e6;
  if (nodes > enough_nodes) result.bytes_per_node = (resident_bytes() - before) / nodes;
  return result;
}

/// The plate's nodes numbered at random, and then as the program numbers a mesh that knows no grid; inner
/// nodes moved at random by up to `moved` sides of a cell, so that no two cells are alike.
mesh::Mesh general_mesh(int columns, double moved) {
  auto plate = plate_of(columns);
  plate.corner = mesh::Corner::none;
  auto mesh = mesh::make_plate(plate);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> shift(-moved * plate.element_size_m, moved * plate.element_size_m);
  for (int j = 1; j < mesh.grid.rows; ++j)
    for (int i = 1; i < mesh.grid.columns; ++i) {
      mesh.x_m[mesh.grid.node(i, j)] += shift(random);
      mesh.y_m[mesh.grid.node(i, j)] += shift(random);
    }
  std::vector<mesh::Node> number(mesh.x_m.size());
  std::iota(number.begin(), number.end(), 0);
  std::shuffle(number.begin(), number.end(), random);
  mesh::renumber(mesh, number);
  mesh::renumber(mesh, mesh::near_numbers(mesh));
  return mesh;
}

EventRun measure_event(int columns, int threads) {
  input::Case config;
  config.plate.element_size_m = config.plate.width_m / columns;
  EventRun result{columns, columns / 2, threads};
  const auto monitor = [](std::int64_t, std::int64_t) { return true; };
  auto start = Clock::now();
  const auto problem = problem::make_problem(config);
  const auto initial = setup::make_initial_state(problem, monitor);
  result.statics_s = seconds_since(start);
  start = Clock::now();
  const auto event = run::run_from(problem, initial, monitor, {.threads = threads});
  result.event_s = seconds_since(start);
  result.node_updates_per_s =
      static_cast<double>(event.event.steps) * event.node_updates_per_step / event.stepping_wall_s;
  return result;
}

}  // namespace

StaticsRun measure_statics(int columns, statics::StaticSolver solver) {
  const auto plate = plate_of(columns);
  const int rows = columns / 2;
  const double n_unknowns = 2 * (columns + 1.0) * (rows + 1.0);
  const auto chosen = statics::choose_solver(solver, n_unknowns);
  require_memory({{"the statics", advice::statics_bytes(chosen, n_unknowns, columns + 1.0),
                   "fewer columns, or a machine with more"}},
                 fmt::format("a plate of {:.4g} static unknowns", n_unknowns));
  const auto mesh = mesh::make_plate(plate);
  const auto start = Clock::now();
  const auto processor_start = std::clock();
  const statics::Loading loading{.tilt_left_m = 0.37e-3, .tilt_right_m = 0.037e-3, .solver = solver};
  const double mu_s = interface::VelocityWeakening {
  }.mu_s;
  const solid::Material material;
  const statics::Statics statics(mesh, material, loading, mu_s);
  StaticsRun result{columns, mesh.grid.rows, std::string(statics::name_of(chosen)), n_unknowns};
  result.critical_shear_m = statics.shear_to(1).shear_m;
  const auto subcritical = statics.shear_to(1 - loading.critical_margin);
  const auto spontaneous = statics.shear_to(1 + loading.critical_margin);
  result.wall_s = seconds_since(start);
  result.processor_s = static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  result.peak_bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);
  result.cycles = statics.solver().n_cycles();
  return result;
}

Results measure(const Options& options, const std::function<void(const std::string&)>& progress) {
  Results results;
  progress("bandwidth");
  results.bandwidth_bytes_per_s = streaming_bandwidth(1);
  results.bandwidth_all_threads_bytes_per_s = streaming_bandwidth(options.threads);
  progress("stencil alone");
  results.stencil_alone_per_s = stencil_alone();
  std::vector<int> threads{1};
  if (options.threads > 1) threads.push_back(options.threads);
  std::vector<int> columns{300, 3000};
  if (options.large) columns.push_back(10'000);
  const motion::TimeStepping plain{.interface_substeps = 1}, sub_cycled;
  const motion::TimeStepping single{.precision = motion::Precision::single_precision,
                                    .interface_substeps = 1};
  for (const int n : columns)
    for (const int t : threads) {
      const double bandwidth =
          t == 1 ? results.bandwidth_bytes_per_s : results.bandwidth_all_threads_bytes_per_s;
      const auto add = [&](const std::string& path, const motion::TimeStepping& time,
                           const motion::Execution& execution) {
        progress(fmt::format("{}, {} x {}, threads: {}", path, n, n / 2, t));
        auto row = measure_path(path, n, time, execution, [n] { return mesh::make_plate(plate_of(n)); });
        const bool streams = n > 1000 && row.steps_per_sweep == 1;
        row.bound_per_s = streams ? bandwidth / bytes_per_node_update : t * results.stencil_alone_per_s;
        results.rates.push_back(row);
      };
      if (n > 1000) add("plain scheme, one step a sweep", plain, {t, 1});
      add("plain scheme", plain, {t, 0});
      add("plain scheme, single precision", single, {t, 0});
      add("interface sub-cycled", sub_cycled, {t, 0});
    }
  const auto add_mesh = [&](const std::string& path, const std::function<mesh::Mesh()>& make_mesh) {
    progress(path);
    auto row = measure_path(path, 300, plain, {.threads = 1}, make_mesh);
    row.bound_per_s = results.stencil_alone_per_s;
    results.rates.push_back(row);
  };
  add_mesh("squares without a grid", [] { return general_mesh(300, 0); });
  add_mesh("all cells different", [] { return general_mesh(300, 0.2); });
  for (const int t : threads) {
    progress(fmt::format("an event, threads: {}", t));
    results.events.push_back(measure_event(300, t));
  }
  return results;
}

}  // namespace slipfront::bench
