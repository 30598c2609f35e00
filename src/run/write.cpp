// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/version.hpp"
#include "files/files.hpp"
#include "problem/contact.hpp"
#include "problem/source.hpp"
#include "results/folder.hpp"
#include "results/results.hpp"
#include "results/snapshots.hpp"
#include "results/stream.hpp"
#include "run/run.hpp"
#include "setup/outputs.hpp"
#include "setup/snapshot_mesh.hpp"
#include "setup/snapshot_plan.hpp"

namespace slipfront::run {

namespace {

using Json = nlohmann::ordered_json;

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

const char* name(motion::EventEnd end) {
  switch (end) {
    case motion::EventEnd::end_time:
      return "end_time";
    case motion::EventEnd::quiet:
      return "quiet";
    case motion::EventEnd::interrupted:
      return "interrupted";
    case motion::EventEnd::blow_up:
      return "blow_up";
    case motion::EventEnd::observer:
      return "observer";
  }
  return "";
}

Json energy_json(const record::Energies& e) {
  Json json;
  for (const auto& term : record::energy_terms) json[term.name] = e.*term.member;
  return json;
}

/// What friction takes: the breakdown at tips, and heat at the residual traction.
Json friction_work_json(const Result& result, const InitialState& initial) {
  const double breakdown = result.event.breakdown.total_work_J_per_m(initial.tributary_m);
  const double all = -result.event.energies.back().friction_work;
  const bool weakens = !std::isnan(breakdown);
  return {{"breakdown_J_per_m", weakens ? Json(breakdown) : Json()},
          {"residual_J_per_m", weakens ? all - breakdown : all}};
}

Json loads_json(const setup::ResolvedLoads& loads) {
  return {{"normal_force_N_per_m", loads.normal_force_N_per_m},
          {"mean_pressure_Pa", loads.mean_pressure_Pa},
          {"tilt_left_m", loads.tilt_left_m},
          {"tilt_right_m", loads.tilt_right_m},
          {"shear_force_N_per_m", loads.shear_force_N_per_m},
          {"shear_m", loads.shear_m},
          {"critical_shear_force_N_per_m", loads.critical_shear_force_N_per_m},
          {"critical_shear_m", loads.critical_shear_m}};
}

Json statics_json(const Problem& problem, const InitialState& initial) {
  if (problem.is_prestressed())
    return {{"common_peak_t_over_p", initial.subcritical.peak_ratio},
            {"peak_x_m", initial.subcritical.peak_x_m},
            {"inside_from_m", initial.subcritical.inside_from_m},
            {"inside_to_m", initial.subcritical.inside_to_m}};
  Json json = {{"critical_shear_m", initial.critical_shear_m},
               {"common_shear_m", initial.subcritical.shear_m},
               {"common_peak_t_over_p", initial.subcritical.peak_ratio},
               {"peak_x_m", initial.subcritical.peak_x_m},
               {"inside_from_m", initial.subcritical.inside_from_m},
               {"inside_to_m", initial.subcritical.inside_to_m},
               {"unknowns", initial.cost.n_unknowns},
               {"solver", statics::name_of(initial.cost.solver)},
               {"solver_bytes", std::llround(initial.cost.solver_bytes)},
               {"wall_s", initial.cost.wall_s}};
  if (initial.loads) json["loads"] = loads_json(*initial.loads);
  if (initial.ramp) {
    const auto& ramp = *initial.ramp;
    Json slip = Json::object();
    if (!ramp.record.onsets.empty()) {
      double from = ramp.record.x_m.back(), to = ramp.record.x_m.front();
      for (const auto& onset : ramp.record.onsets) {
        from = std::min(from, ramp.record.x_m[onset.node]);
        to = std::max(to, ramp.record.x_m[onset.node]);
      }
      slip = {{"from_x_m", from}, {"to_x_m", to}, {"first_s", ramp.record.onsets.front().time_s}};
    }
    json["ramp"] = {{"critical_shear_m", ramp.supercritical.shear_m},
                    {"relative_to_direct", ramp.supercritical.shear_m / initial.critical_shear_m - 1},
                    {"steps", ramp.steps},
                    {"onsets_before_critical", ramp.record.n_onsets()},
                    {"onsets_inside", ramp.n_onsets_inside()},
                    {"slip_before_critical", slip}};
  }
  return json;
}

Json speeds_json(const solid::WaveSpeeds& speeds) {
  return {{"c_L_m_per_s", speeds.c_L}, {"c_S_m_per_s", speeds.c_S}, {"c_R_m_per_s", speeds.c_R}};
}

Json optional_json(const std::optional<double>& value) {
  return value ? Json(*value) : Json();
}

Json fronts_json(const std::vector<fronts::Front>& fronts) {
  Json list = Json::array();
  for (const auto& front : fronts) {
    list.push_back({{"id", front.id},
                    {"direction", front.direction},
                    {"start_x_m", front.points.front().x_m},
                    {"start_s", front.points.front().onset_s},
                    {"end_x_m", front.points.back().x_m},
                    {"end_s", front.points.back().onset_s},
                    {"end", fronts::name(front.end)},
                    {"mode", fronts::name(front.mode)}});
  }
  return list;
}

Json spread_json(const stability::Spread& spread) {
  return {{"min", spread.least}, {"median", spread.median}, {"max", spread.largest}};
}

/// What the tractions before the event let expect; infinite numbers become null.
Json rupture_json(const advice::RuptureOutlook& rupture) {
  const auto& o = rupture.of_nodes;
  return {{"nodes_inside", o.n_nodes},
          {"nodes_that_weaken", o.n_weakening},
          {"nodes_above_residual_strength", o.n_driven},
          {"nodes_of_S_above_10", o.n_barriers},
          {"strength_excess_S", spread_json(o.S)},
          {"seismic_ratio", spread_json(o.drop_ratio)},
          {"nucleation_length_m", optional_json(o.nucleation_length_m)},
          {"griffith_half_length_m", optional_json(o.griffith_half_length_m)},
          {"supershear_half_length_m", optional_json(o.supershear_half_length_m)},
          {"process_zone_m", optional_json(o.process_zone_m)},
          {"unstable_wavelength_m", optional_json(o.unstable_wavelength_m)},
          {"process_zone_elements", optional_json(rupture.process_zone_elements)},
          {"trigger_length_m", optional_json(rupture.trigger_length_m)},
          {"tip_slip_rate_m_per_s", optional_json(rupture.tip_slip_rate_m_per_s)},
          {"regime", o.regime},
          {"doubts", rupture.doubts}};
}

/// The uniform state of the bulk that carries prescribed tractions, null where they do not determine it, and
/// whether recorded strain and stress hold it; else they are the change from it.
Json prestress_json(const Problem& problem) {
  const auto& prestress = *problem.prestress;
  const bool is_uniform = prestress.file.empty();
  return {{"recorded", prescribed_stress(problem).has_value()},
          {"stress_xx_Pa", Json()},
          {"stress_yy_Pa", is_uniform ? Json(-prestress.p_Pa) : Json()},
          {"stress_xy_Pa", is_uniform ? optional_json(prestress.t_Pa) : Json()}};
}

/// Columns are of nodes; what a rank has sent counts as its messages and bytes.
Json processes_json(const SharedCost& shared) {
  const auto& partition = shared.partition;
  Json own = Json::array(), halo = Json::array(), computing_s = Json::array();
  Json exchange_s = Json::array(), collective_s = Json::array();
  double messages = 0, bytes = 0, max_messages = 0, max_bytes = 0, sum_s = 0, largest_s = 0;
  for (int part = 0; part < partition.n_subdomains(); ++part) {
    const auto columns = partition.own(part);
    own.push_back(columns.end - columns.begin);
    halo.push_back(partition.halo_below(part) + partition.halo_above(part));
    const auto& cost = shared.of_subdomains[static_cast<std::size_t>(part)];
    computing_s.push_back(cost.computing_s);
    exchange_s.push_back(cost.exchange_s);
    collective_s.push_back(cost.collective_s);
    messages += static_cast<double>(cost.messages);
    bytes += static_cast<double>(cost.bytes);
    max_messages = std::max(max_messages, static_cast<double>(cost.messages));
    max_bytes = std::max(max_bytes, static_cast<double>(cost.bytes));
    sum_s += cost.computing_s;
    largest_s = std::max(largest_s, cost.computing_s);
  }
  const auto steps = shared.of_subdomains.front().steps;
  const auto per_step = [&](double n) { return steps > 0 ? Json(n / static_cast<double>(steps)) : Json(); };
  const double mean_s = sum_s / partition.n_subdomains();
  return {{"count", partition.n_subdomains()},
          {"own_columns", own},
          {"halo_columns", halo},
          {"steps_per_exchange", partition.steps_per_exchange},
          {"steps", steps},
          {"messages_per_step", per_step(messages)},
          {"messages_per_step_of_busiest", per_step(max_messages)},
          {"bytes_per_step", per_step(bytes)},
          {"bytes_per_step_of_busiest", per_step(max_bytes)},
          {"computing_s", computing_s},
          {"waiting_in_exchanges_s", exchange_s},
          {"waiting_in_collectives_s", collective_s},
          {"imbalance_largest_over_mean", mean_s > 0 ? Json(largest_s / mean_s) : Json()}};
}

Json notes_json(const Diagnostics& notes) {
  Json json = Json::array();
  for (const auto& note : notes) json.push_back({{"kind", name(note.kind)}, {"text", note.text}});
  return json;
}

/// What every run.json begins with.
Json about(const Problem& problem, const Status& status) {
  Json json = {{"version", version()},     {"commit", commit()},      {"compiler", compiler()},
               {"processor", processor()}, {"host", host_name()},     {"title", problem.source.title},
               {"status", status.name},    {"reason", status.reason}, {"sessions", status.sessions}};
  if (status.name == "running") json["process"] = getpid();
  for (const auto& state : problem.friction.law.states()) json["law_states"].push_back(state.name);
  return json;
}

Json run_json(const Result& result, const InitialState& initial, const Status& status) {
  const auto& event = result.event;
  Json json = about(result.problem, status);
  const bool ended = status.name != "running";
  json["end"] = ended ? Json(name(event.end)) : Json();
  json["end_reason"] = ended ? Json(end_of_event(result)) : Json();
  json.update(
      {{"mesh",
        {{"columns", initial.mesh.grid.columns},
         {"rows", initial.mesh.grid.rows},
         {"nodes", initial.n_nodes},
         {"cells", initial.n_cells}}},
       {"wave_speeds", speeds_json(result.speeds)},
       {"stable_dt_s", result.stable_step_s},
       {"dt_s", result.step_s},
       {"interface_dt_s", result.substep_s},
       {"steps", event.steps},
       {"time_s", event.time_s},
       {"wall_s", result.stepping_wall_s},
       {"node_updates_per_s",
        static_cast<double>(event.steps) * result.node_updates_per_step / result.stepping_wall_s},
       {"statics", statics_json(result.problem, initial)},
       {"rupture", rupture_json(result.rupture)},
       {"energy_at_start", energy_json(event.energies.front())},
       {"energy_at_end", energy_json(event.energies.back())},
       {"onsets", event.record.n_onsets()},
       {"snapshot_times_after_the_event_s",
        status.name == "running" ? Json() : Json(setup::snapshots_after(result.problem, event.time_s))},
       {"fronts", fronts_json(result.fronts)},
       {"notes", notes_json(result.notes)}});
  json["friction_work"] = friction_work_json(result, initial);
  if (result.problem.is_prestressed()) json["prestress"] = prestress_json(result.problem);
  if (result.shared) json["processes"] = processes_json(*result.shared);
  if (const auto& bodies = result.problem; bodies.has_below()) {
    const auto& grid = initial.base->grid;
    const auto &above = bodies.above().material, &below = bodies.below().material;
    json["mesh"]["base_rows"] = grid.rows;
    json["base"] = {{"columns", grid.columns},
                    {"rows", grid.rows},
                    {"wave_speeds", speeds_json(solid::wave_speeds(below))},
                    {"generalised_rayleigh_speed_m_per_s",
                     optional_json(stability::generalised_rayleigh_speed_m_per_s(above, below))}};
  }
  return json;
}

void write_json(const std::filesystem::path& dir, const Json& json) {
  files::write_text(dir / run_file, json.dump(2) + "\n");
}

}  // namespace

int sessions_of(const std::filesystem::path& file) {
  if (!files::is_file(file)) return 0;
  std::ifstream stream(file);
  const auto json = Json::parse(stream, nullptr, false);
  const auto at = json.find("sessions");
  const auto n = json.is_object() && at != json.end() && at->is_number() ? at->get<double>() : 0;
  constexpr double most = 1e6;
  return n >= 1 && n <= most ? static_cast<int>(n) : 0;
}

Status status_of(const Result& result) {
  const auto& event = result.event;
  if (event.end == motion::EventEnd::blow_up) return {"blew_up", event.reason};
  if (event.end == motion::EventEnd::interrupted)
    return {"interrupted", fmt::format("interrupted at t = {:.4g} s", event.time_s)};
  return {};
}

results::Numbers numbers_of(const Status& status) {
  return status.name == "complete" ? results::Numbers::finite : results::Numbers::any;
}

results::SnapshotContents snapshot_contents(const Problem& problem, const setup::SnapshotMesh& mesh) {
  results::SnapshotContents contents{{}, setup::origin_of(problem), prescribed_stress(problem)};
  if (!problem.output.snapshot_stress) return contents;
  contents.bodies.push_back({mesh.n_plate_cells, problem.above().material});
  if (problem.has_below()) contents.bodies.push_back({mesh.slabs.n_cells, problem.below().material});
  return contents;
}

void write_static(const std::filesystem::path& dir, const Problem& problem, const InitialState& initial) {
  const auto& tractions = initial.subcritical.tractions;
  std::vector<results::NamedColumn> columns;
  const auto& parameters = description_of(problem.friction.law).parameters;
  if (problem.friction.along_x.varies() || !initial.healed.empty()) columns.resize(parameters.size());
  for (const auto& law : friction_at(problem, tractions.x_m, initial.healed))
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      columns[k].name = parameters[k].key;
      columns[k].values.push_back(law.parameter(parameters[k].key));
    }
  results::write_static(dir / "static.csv", tractions, columns);
}

void write_status(const std::filesystem::path& dir, const Problem& problem, const Status& status) {
  write_json(dir, about(problem, status));
}

namespace {

/// How far the energies of a sequence are from balance, over the largest of their terms.
double largest_imbalance(std::span<const record::LoadingRow> loading) {
  double imbalance = 0, largest = 0;
  for (const auto& row : loading) {
    imbalance = std::max(imbalance, std::abs(record::imbalance_J_per_m(row, loading.front())));
    for (const auto& term : record::energy_terms)
      largest = std::max(largest, std::abs(row.energies.*term.member));
  }
  return imbalance / largest;
}

Json loads_json(const record::LoadingRow& row) {
  Json json = {{"event", row.n_events}, {"phase", record::name(row.phase)}};
  for (const auto& field : record::loading_fields) json[field.name] = row.*field.member;
  return json;
}

}  // namespace

void write_sequence(const std::filesystem::path& dir, const Problem& problem, const Diagnostics& notes,
                    std::span<const record::SequenceEvent> events,
                    std::span<const record::LoadingRow> loading, const std::string& end,
                    const Status& status) {
  const bool goes_on = status.name == "running" || status.name == "complete";
  const auto numbers = goes_on ? results::Numbers::finite : results::Numbers::any;
  results::write_events(dir / "events.csv", events, numbers);
  results::write_loading(dir / "loading.csv", loading, numbers);
  auto json = about(problem, status);
  json["end"] = end.empty() ? Json() : Json(end);
  json["wave_speeds"] = speeds_json(solid::wave_speeds(problem.above().material));
  json["events"] = events.size();
  json["notes"] = notes_json(notes);
  if (!loading.empty()) {
    json["largest_friction"] = loads_json(record::strongest(loading));
    json["last"] = loads_json(loading.back());
    json["imbalance_over_largest_energy"] = largest_imbalance(loading);
  }
  files::write_text(dir / sequence_file, json.dump(2) + "\n");
}

void write_so_far(const std::filesystem::path& dir, const Result& result,
                  std::span<const record::Energies> energies, const InitialState& initial,
                  const Status& status) {
  const auto numbers = numbers_of(status);
  results::write_fronts(dir / "fronts.csv", result.fronts, numbers);
  results::write_fracture(dir / "fracture.csv", result.fronts, result.event.breakdown, result.passages,
                          numbers);
  results::write_energies(dir / "energy.csv", energies, numbers);
  write_json(dir, run_json(result, initial, status));
}

void write(const std::filesystem::path& dir, const Result& result, const InitialState& initial) {
  const auto& event = result.event;
  problem::write_case(dir, result.problem.source);
  write_static(dir, result.problem, initial);
  results::ResultStream stream(dir, formats_of(setup::output_setup(result.problem, initial, result.step_s)));
  for (const auto& [file, rows] : result.rows) stream.sink(file).put(rows.values);
  stream.finish(numbers_of(status_of(result)));
  if (const auto file = dir / results::snapshot_output.file; files::is_there(file)) {
    const auto mesh = setup::whole_snapshot_mesh({initial.mesh, initial.base});
    results::finish_snapshots(file, mesh.slabs, snapshot_contents(result.problem, mesh));
  }
  write_so_far(dir, result, event.energies, initial, status_of(result));
  results::seal(dir);
}

}  // namespace slipfront::run
