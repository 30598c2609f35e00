// SPDX-License-Identifier: BSD-3-Clause
#include "advice/info.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <string_view>

#include "base/error.hpp"
#include "cli/command.hpp"
#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "cli/words.hpp"
#include "files/text.hpp"
#include "fracture/prediction.hpp"
#include "problem/problem.hpp"

namespace slipfront::cli {
namespace {

std::string fastest_wavelength(const stability::WellPosedness& w) {
  if (w.fastest_wavelength_m == 0) return "ever shorter waves";
  const bool longest = w.fastest_wavelength_m > 0.999 * w.longest_wavelength_m;
  return fmt::format("a wavelength of {:.3g} m{}", w.fastest_wavelength_m,
                     longest ? ", the longest on the interface" : "");
}

/// Lines of output, each a name and a value.
struct Listing {
  std::string text;
  void add(const char* what, const std::string& value) { text += fmt::format("{:<32}{}\n", what, value); }
};

void add_wave_speeds(const advice::Info& info, Listing& list) {
  list.add("longitudinal wave speed c_L", fmt::format("{:.1f} m/s", info.speeds.c_L));
  list.add("shear wave speed c_S", fmt::format("{:.1f} m/s", info.speeds.c_S));
  list.add("Rayleigh wave speed c_R", fmt::format("{:.1f} m/s", info.speeds.c_R));
  const auto is_same = [&](const solid::WaveSpeeds& s) {
    return s.c_L == info.speeds.c_L && s.c_S == info.speeds.c_S && s.c_R == info.speeds.c_R;
  };
  if (!info.base_speeds || is_same(*info.base_speeds)) return;
  list.add("base: c_L, c_S, c_R", fmt::format("{:.1f}, {:.1f}, {:.1f} m/s", info.base_speeds->c_L,
                                              info.base_speeds->c_S, info.base_speeds->c_R));
  list.add("generalised Rayleigh speed",
           info.generalised_rayleigh_speed_m_per_s
               ? fmt::format("{:.1f} m/s", *info.generalised_rayleigh_speed_m_per_s)
               : "none: the two bodies differ too much");
}

void add_size(const advice::Info& info, Listing& list) {
  const auto irregular = info.n_irregular ? fmt::format(", {} off the regular grid", *info.n_irregular) : "";
  list.add("nodes", fmt::format("{} ({} on the interface{})", info.n_nodes, info.n_interface, irregular));
  list.add("cells", fmt::format("{}", info.n_cells));
}

void add_steps(const Problem& problem, const advice::Info& info, Listing& list) {
  list.add("largest stable step", fmt::format("{:.4g} s{}", info.stable_step_s,
                                              info.base_speeds ? ", the smaller one of the bodies" : ""));
  list.add("step", fmt::format("{:.4g} s ({:.4g} s at the interface, {} rows)", info.step_s, info.substep_s,
                               problem.time.interface_rows));
  if (info.base_speeds)
    list.add("sub-steps in a step",
             fmt::format("of the plate {}, of the base {}, in the step above {}",
                         info.substeps_of_bodies.front(), info.substeps_of_bodies.back(),
                         std::lcm(info.substeps_of_bodies.front(), info.substeps_of_bodies.back())));
  list.add("steps to the end", fmt::format("{}", info.n_steps));
  if (problem.is_sequence())
    list.add("sequence", fmt::format("at most {} events; steps, disk and time are those of one to time.end_s",
                                     problem.sequence.max_events));
  if (info.needs.slow_steps > 0)
    list.add("slow slip",
             fmt::format("about {:.2g} steps to {}, {:.3g} GB; time and disk have them once",
                         info.needs.slow_steps,
                         std::isfinite(problem.sequence.end_s) || !problem.sequence.path.times_s.empty()
                             ? "the end of the loading"
                             : "the first event",
                         info.needs.slow_bytes * 1e-9));
  const auto& machine = problem.above().machine;
  if (std::isfinite(machine.shear_stiffness_Pa_per_m))
    list.add("machine along x",
             fmt::format("{:g} Pa/m", machine.shear_stiffness_Pa_per_m) +
                 (machine.mass_kg_per_m2 > 0 ? fmt::format(", {:g} kg/m2", machine.mass_kg_per_m2) : ""));
  if (std::isfinite(machine.normal_stiffness_Pa_per_m))
    list.add("machine downwards", machine.normal_stiffness_Pa_per_m > 0
                                      ? fmt::format("{:g} Pa/m", machine.normal_stiffness_Pa_per_m)
                                      : std::string("dead load"));
  if (const auto& path = problem.sequence.path; !path.times_s.empty())
    list.add("path of the loading", fmt::format("{} points, to {:g} m at {:g} s", path.times_s.size(),
                                                path.shears_m.back(), path.times_s.back()));
  if (info.needs.ramp_steps > 0)
    list.add("steps of the ramp before",
             fmt::format("about {:.3g}", static_cast<double>(info.needs.ramp_steps)));
}

void add_costs(const advice::Info& info, Listing& list) {
  const auto statics = info.solver_bytes > 0 ? fmt::format(" ({})", statics::name_of(info.solver)) : "";
  list.add("memory", fmt::format("{:.3g} GB, of it {:.3g} GB for the statics{}", info.memory_bytes * 1e-9,
                                 info.solver_bytes * 1e-9, statics));
  const auto& n = info.needs;
  const auto &history = n.of(results::history_output), &snapshots = n.of(results::snapshot_output);
  list.add("disk",
           fmt::format(
               "{:.3g} GB while it runs: {} rows of history {:.3g}, {} snapshots {:.3g}, checkpoints {:.3g}",
               n.disk_bytes() * 1e-9, history.n_rows, history.bytes * 1e-9, snapshots.n_rows,
               snapshots.bytes * 1e-9, n.checkpoint_bytes * 1e-9));
  list.add("node updates",
           fmt::format("{:.4g} at {:.3g} million/s here", info.node_updates, info.node_updates_per_s * 1e-6));
  list.add("expected time", fmt::format("{:.2g} s", info.expected_s));
}

/// The forces and the displacements that give them.
void add_loads(const setup::ResolvedLoads& loads, const problem::Problem& problem, Listing& list) {
  list.add("normal force", fmt::format("{:.6g} N/m, a mean pressure of {:.6g} Pa", loads.normal_force_N_per_m,
                                       loads.mean_pressure_Pa));
  list.add("  upper edge pressed down", fmt::format("{:.6g} m at its left end, {:.6g} m at its right one",
                                                    loads.tilt_left_m, loads.tilt_right_m));
  list.add("shear force",
           fmt::format("{:.6g} N/m, {:.6g} of the critical one, {:.6g} N/m", loads.shear_force_N_per_m,
                       loads.shear_force_N_per_m / loads.critical_shear_force_N_per_m,
                       loads.critical_shear_force_N_per_m));
  list.add(problem.above().machine.pusher.is_there() ? "  left side then pushed to +x"
                                                     : "  upper edge then moved to +x",
           fmt::format("{:.6g} m, critical {:.6g} m", loads.shear_m, loads.critical_shear_m));
  if (problem.friction.law.never_sticks())
    list.add("  friction with state",
             "critical: t/p is that of steady sliding at V_i; events may begin elsewhere");
  if (problem.heals())
    list.add("  healing", "raises the critical ones until the first event: run tells by how much");
}

std::string text_of(double number) {
  return std::isfinite(number) ? fmt::format("{:.3g}", number) : "unbounded";
}

std::string text_of(const stability::Spread& spread) {
  return fmt::format("{}, {}, {}", text_of(spread.least), text_of(spread.median), text_of(spread.largest));
}

/// What a law that weakens over a slip lets expect.
void add_lengths(const advice::RuptureOutlook& rupture, Listing& list) {
  const auto& o = rupture.of_nodes;
  const bool never_sticks = rupture.tip_slip_rate_m_per_s.has_value();
  const auto add_zone = [&] {
    if (o.process_zone_m)
      list.add("process zone at rest", fmt::format("{:.3g} m, {:.3g} elements (Palmer, Rice 1973)",
                                                   *o.process_zone_m, *rupture.process_zone_elements));
  };
  if (!o.nucleation_length_m) {
    list.add("nucleation length", never_sticks
                                      ? "none: friction does not weaken with the slip rate before the event"
                                      : "none: friction does not weaken over a slip, the mesh decides");
    add_zone();
    return;
  }
  const auto trigger = rupture.trigger_length_m
                           ? fmt::format("; the trigger has {:.3g} m", *rupture.trigger_length_m)
                           : std::string();
  list.add("nucleation length",
           std::isnan(*o.nucleation_length_m)
               ? std::string("unknown: that of the aging law with one state holds for no other")
               : fmt::format("{:.3g} m ({}): slow slip over it runs away", *o.nucleation_length_m,
                             never_sticks ? "Rubin, Ampuero 2005, aging law" : "Uenishi, Rice 2003"));
  if (o.unstable_wavelength_m)
    list.add("unstable wavelengths",
             fmt::format("from {:.3g} m on, under the slip rate before the event (Rice, Ruina 1983)",
                         *o.unstable_wavelength_m));
  if (o.griffith_half_length_m)
    list.add("critical crack length",
             fmt::format("{:.3g} m (Griffith; Andrews 1976): under uniform t cracks as long run on{}",
                         2 * *o.griffith_half_length_m, trigger));
  add_zone();
}

/// In short what `slipfront fracture` tells.
void add_cracks(const advice::FracturePrediction& p, Listing& list) {
  const auto& of = p.of_fronts;
  auto text = p.covers_all ? "the first crack is the whole interface"
              : of.starts  ? fmt::format("the first crack, {:.3g} m, runs", of.first_length_m)
              : std::isfinite(of.critical_length_m)
                  ? fmt::format("the first crack, {:.3g} m, does not run; from {:.3g} m on it would",
                                of.first_length_m, of.critical_length_m)
                  : "none runs from there, however long";
  for (const auto& front : of.fronts)
    if (p.predicts_arrest(front))
      text += fmt::format("; to {}x it arrests at {:.4g} m", front.direction > 0 ? '+' : '-',
                          front.points.back().x_m);
  if (!p.doubts_of_arrest.empty()) text += "; no arrest is predicted, see slipfront fracture";
  list.add("fronts as cracks", text);
}

void add_rupture(const advice::RuptureOutlook& rupture, Listing& list) {
  if (rupture.tip_slip_rate_m_per_s) {
    list.add("a front's tip",
             fmt::format("where the slip rate passes {:.3g} m/s", *rupture.tip_slip_rate_m_per_s));
    list.add("steady sliding", rupture.steady_sliding);
  } else if (rupture.nominal) {
    list.add("lengths below",
             "at t = mu_s p under the nominal pressure; `run` gives S and what follows from it");
  } else {
    list.add("strength excess S", text_of(rupture.of_nodes.S) + " (least, median, largest)");
    list.add("seismic ratio 1/(1 + S)", text_of(rupture.of_nodes.drop_ratio));
    list.add("expected regime", rupture.of_nodes.regime);
  }
  add_lengths(rupture, list);
}

void add_mesh_choice(const Problem& problem, const advice::MeshChoice& mesh, Listing& list) {
  const bool is_own = mesh.coarsenings == problem.above().plate.coarsenings &&
                      std::abs(mesh.element_size_m / problem.above().plate.element_size_m - 1) < 1e-6;
  if (is_own) {
    list.add("cheapest mesh for this zone", "this one");
    return;
  }
  list.add(
      "cheapest mesh for this zone",
      fmt::format("plate.element_size_m = {:.8g}, plate.coarsenings = {}{}: {:.3g} elements in the zone, "
                  "{} nodes",
                  mesh.element_size_m, mesh.coarsenings,
                  problem.has_below() ? fmt::format(", base.coarsenings = {}", mesh.coarsenings) : "",
                  mesh.process_zone_elements, mesh.n_nodes));
}

void add_stability_of_sliding(const advice::Info& info, Listing& list) {
  const auto& w = info.well_posedness;
  if (!w.has_verdict()) {
    list.add("uniform sliding", w.statement);
    return;
  }
  list.add("nominal pressure", fmt::format("{:.4g} Pa", w.sliding.pressure_Pa));
  list.add("weakening / radiation damping", fmt::format("{:.3g}", w.weakening_over_radiation));
  list.add("growth at two elements",
           fmt::format("{:.3g} /s at a wavelength of {:.3g} m", w.growth_at_grid_per_s, w.grid_wavelength_m));
  if (w.fastest_growth_per_s > 0 && !w.unbounded)
    list.add("fastest growth", fmt::format("{:.3g} /s at {}", w.fastest_growth_per_s, fastest_wavelength(w)));
  list.add("damping length beta_R c_L",
           fmt::format("{:.3g} m, {:.3g} elements", w.damping_length_m, w.damping_length_over_h));
  list.add("uniform sliding", w.statement);
  if (!std::isnan(info.well_posedness_x_m))
    list.add("  with the friction at", fmt::format("x = {:.4g} m, the worst node", info.well_posedness_x_m));
}

std::string columns_text(const motion::Partition& partition) {
  int least = std::numeric_limits<int>::max(), most = 0;
  for (int part = 0; part < partition.n_subdomains(); ++part) {
    const auto own = partition.own(part);
    least = std::min(least, own.end - own.begin);
    most = std::max(most, own.end - own.begin);
  }
  return least == most ? fmt::format("{}", most) : fmt::format("{} to {}", least, most);
}

void add_shared(const advice::Info::Shared& shared, Listing& list) {
  const auto& partition = shared.partition;
  list.add("shared by", fmt::format("{} ranks, each with a processor", partition.n_subdomains()));
  list.add("  columns of nodes of each",
           fmt::format("{}, and {} beside them on either side", columns_text(partition),
                       partition.n_subdomains() > 1 ? partition.halo : 0));
  auto memory = fmt::format("{:.3g} GB of rank 0", shared.root_memory_bytes * 1e-9);
  if (partition.n_subdomains() > 1) {
    list.add("  exchange every", fmt::format("{} steps", partition.steps_per_exchange));
    list.add("  bytes sent per step",
             fmt::format("{:.4g} by the rank that sends most", shared.bytes_per_step));
    memory += fmt::format(", {:.3g} GB of each other rank", shared.memory_bytes * 1e-9);
  }
  list.add("  memory", memory);
  list.add("  expected time", fmt::format("{:.2g} s, without that of messages", shared.expected_s));
  list.add("  own columns, of the event", fmt::format("{:.0f} %", 100 * shared.efficiency));
}

void print_info(const CaseArguments& arguments, const std::optional<int>& n_processes) {
  const auto given = arguments.read();
  const auto problem = problem::make_problem(given.config());
  const auto info = given.placing_errors([&] { return advice::info(problem, n_processes); });
  arguments.require_none_refused(info.notes);
  Listing list;
  if (!problem.source.title.empty()) list.add("title", files::one_line(problem.source.title));
  list.add("set-up", set_up(problem));
  add_wave_speeds(info, list);
  add_size(info, list);
  add_steps(problem, info, list);
  add_costs(info, list);
  if (info.shared) add_shared(*info.shared, list);
  if (info.loads) add_loads(*info.loads, problem, list);
  if (const double speed_m_per_s = shear_speed_in_event_m_per_s(problem); speed_m_per_s > 0)
    list.add("upper edge during the event",
             fmt::format("moves to +x at {} (loading.shear_speed_m_per_s), {} by time.end_s",
                         engineering(speed_m_per_s, "m/s", 3),
                         engineering(speed_m_per_s * problem.time.end_s, "m", 3)));
  add_stability_of_sliding(info, list);
  add_rupture(info.rupture, list);
  if (info.rupture.cracks) add_cracks(*info.rupture.cracks, list);
  if (info.cheapest_mesh) add_mesh_choice(problem, *info.cheapest_mesh, list);
  print_output(list.text + lines_of(given, info.notes));
}

}  // namespace

void add_info(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "info",
      "Print what follows from a case: wave speeds, step, size, memory, expected time, stability of sliding");
  command->group("Cases");
  const auto arguments = add_case_arguments(*command);
  add_strict(*command, *arguments);
  auto n_processes = std::make_shared<std::optional<int>>();
  command->add_option("--processes", *n_processes, "Also predict time and memory of a run on N MPI ranks")
      ->check(CLI::Range(1, 10'000'000));
  command->callback([arguments, n_processes] { print_info(*arguments, *n_processes); });
}

}  // namespace slipfront::cli
