// SPDX-License-Identifier: BSD-3-Clause
#include "advice/notes.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "advice/needs.hpp"
#include "problem/contact.hpp"
#include "setup/meshes.hpp"
#include "setup/snapshot_plan.hpp"
#include "stability/verdict.hpp"

namespace slipfront::advice {
namespace {

/// A table that reaches beyond the plate may have its positions in another unit.
void add_table(const char* key, const std::vector<double>& x_m, double width_m, Diagnostics& notes) {
  const double tolerance_m = 1e-6 * width_m;
  const auto is_beyond = [&](double x) { return x < -tolerance_m || x > width_m + tolerance_m; };
  const auto n_beyond = std::ranges::count_if(x_m, is_beyond);
  if (n_beyond == 0) return;
  notes.add(Diagnostic::units,
            "the table of {} reaches from x = {:.6g} to {:.6g} m, the plate from 0 to {:.6g} m: {} of its {} "
            "rows lie beyond it; are its positions in m?",
            key, x_m.front(), x_m.back(), width_m, n_beyond, x_m.size());
}

void add_note(const std::string& key, double value, const char* question, Diagnostics& notes,
              Diagnostic::Kind kind = Diagnostic::units) {
  notes.add(kind, "{} = {:g}: {}", key, value, question);
}

/// Numbers of a body that may be in another unit than the key's. @param table  of its keys
void add_odd_units(const std::string& table, const solid::Material& m, double width_m, Diagnostics& notes) {
  if (m.youngs_modulus_Pa < 1e4 || m.youngs_modulus_Pa > 2e12)
    add_note(table + ".youngs_modulus_Pa", m.youngs_modulus_Pa, "no solid has this stiffness; is it in Pa?",
             notes);
  if (m.density_kg_per_m3 < 10 || m.density_kg_per_m3 > 3e4)
    add_note(table + ".density_kg_per_m3", m.density_kg_per_m3, "no solid has this density; is it in kg/m3?",
             notes);
  if (m.poissons_ratio < -0.99)
    add_note(table + ".poissons_ratio", m.poissons_ratio,
             "near -1 the body hardly resists a change of volume beside one of shape, and rounding grows",
             notes, Diagnostic::resolution);
  if (m.poissons_ratio > 0.49 && m.plane == solid::Plane::strain)
    add_note(
        table + ".poissons_ratio", m.poissons_ratio,
        "near 0.5 in plane strain elements of four nodes are too stiff (volumetric locking), the more the "
        "coarser",
        notes, Diagnostic::resolution);
  const double damping_length_m = m.stiffness_damping_s * solid::longitudinal_speed_m_per_s(m);
  if (damping_length_m > 0.1 * width_m)
    notes.add(Diagnostic::units,
              "{}.stiffness_damping_s = {:g}: damps all waves shorter than {:.3g} m, the plate's width "
              "is {:g} m; is it beta_R in s, no loss factor?",
              table, m.stiffness_damping_s, damping_length_m, width_m);
}

/// Sizes that no laboratory sample has, and no fault.
void add_odd_sizes(const Problem& problem, Diagnostics& notes) {
  constexpr double largest_sample_m = 20, smallest_fault_m = 1000;
  const auto add = [&](const char* key, double size_m) {
    if (size_m > largest_sample_m && size_m < smallest_fault_m)
      add_note(key, size_m, "beyond samples of a laboratory, below faults; is it in m?", notes);
  };
  add("plate.width_m", problem.width_m());
  add("plate.height_m", problem.above().plate.height_m);
  if (problem.has_below()) add("base.height_m", problem.below().plate.height_m);
}

/// Numbers of the interface that may be in another unit than the key's.
void add_odd_units_of_friction(const Problem& problem, Diagnostics& notes) {
  for (const auto& parameter : description_of(problem.friction.law).parameters) {
    const std::string key = std::string("friction.") + parameter.key;
    const double value = problem.friction.law.parameter(parameter.key);
    if (key.starts_with("friction.mu") && value > 5)
      add_note(key, value, "hardly any pair of solids has such friction; is it in per cent?", notes);
    if (key.starts_with("friction.d_c") && value > 1e-3 * problem.width_m())
      add_note(key, value, "more than a thousandth of plate.width_m; is it in m?", notes);
    if (key == "friction.V_i_m_per_s" && value > 0.01)
      add_note(key, value, "as fast as slip in an event, which is to begin from it; is it in m/s?", notes);
  }
}

/// Pressures in another unit than Pa, by what they strain the plate.
void add_odd_pressures(const Problem& problem, Diagnostics& notes) {
  constexpr double max_strain = 0.03;  // of linear elasticity
  constexpr double min_strain = 1e-7;  // a rock pressed by its own weight over some centimetres
  double E_Pa = problem.above().material.youngs_modulus_Pa;
  if (problem.has_below()) E_Pa = std::min(E_Pa, problem.below().material.youngs_modulus_Pa);
  if (!problem.is_prestressed()) {
    const double strain = nominal_pressure_Pa(problem) / E_Pa;
    if (strain > max_strain || strain < min_strain)
      notes.add(Diagnostic::units, "the {} the plate by {:.3g} of Young's modulus{}, {}: {}?",
                statics::normal_force_N_per_m(problem.loading, problem.width_m()) ? "normal force presses"
                                                                                  : "tilt presses",
                strain, E_Pa < problem.above().material.youngs_modulus_Pa ? " of the base" : "",
                strain > max_strain ? "beyond small strains" : "less than in any experiment",
                problem.loading.mean_pressure_Pa ? "is loading.mean_pressure_Pa in Pa"
                : problem.loading.normal_force_N_per_m
                    ? "is loading.normal_force_N_per_m in N per m of thickness"
                : problem.loading.top_pressure.is_there()
                    ? "is loading.pressures_Pa in Pa"
                    : "are loading.tilt_left_m and loading.tilt_right_m in m");
    return;
  }
  const auto& prestress = *problem.prestress;
  const auto& rows = prestress.table.rows;
  const bool is_uniform = prestress.file.empty();
  const double p_Pa = is_uniform ? prestress.p_Pa : *std::ranges::max_element(rows.p_s_Pa);
  const auto key = is_uniform ? "prestress.p_Pa" : "p_Pa of prestress.file up to";
  if (p_Pa > max_strain * E_Pa) add_note(key, p_Pa, "beyond small strains of the plate; is it in Pa?", notes);
  if (p_Pa < min_strain * E_Pa)
    add_note(key, p_Pa, "less than 1e-7 of Young's modulus; is it in Pa, 1 MPa = 1e6 Pa?", notes);
}

/// Lengths that do not suit the plate or its elements.
void add_lengths(const Problem& problem, Diagnostics& notes) {
  constexpr double fewest_elements = 2;
  const double min_m = fewest_elements * problem.element_size_m();
  const auto add_short = [&](const char* key, double length_m) {
    if (length_m < (1 - 1e-9) * min_m)
      notes.add(Diagnostic::resolution,
                "{} = {:.4g} m is less than two elements, {:.4g} m: the mesh does not resolve it", key,
                length_m, min_m);
  };
  if (interface::is_at_edge(problem.start.kind))
    add_short("event.trigger_zone_m", problem.start.trigger.zone_m);
  if (problem.start.kind == interface::EventKind::nucleation)
    add_short(problem.start.nucleation.profile == interface::NucleationProfile::smooth
                  ? "2 nucleation.half_length_m"
                  : "2 nucleation.half_length_m + taper_m",
              problem.start.nucleation.half_length_m + problem.start.nucleation.reach_m());
  if (problem.start.kind == interface::EventKind::nucleation &&
      2 * problem.start.nucleation.half_length_m > problem.width_m())
    notes.add(Diagnostic::units,
              "nucleation.half_length_m = {:g}: the patch is longer than the interface, {:g} m; is it in m?",
              problem.start.nucleation.half_length_m, problem.width_m());
  const double zone_m = interface::is_at_edge(problem.start.kind) ? problem.start.trigger.zone_m : 0;
  if (zone_m + problem.fronts.trigger_margin_m > 0.5 * problem.width_m())
    notes.add(Diagnostic::output,
              "fronts.trigger_margin_m = {:.4g} m leaves less than half of the interface to t_d and p_d",
              problem.fronts.trigger_margin_m);
  // Beside the interface displacements bend within an element.
  const auto probes = problem.probes;
  const auto is_beside = [&](const record::ProbePlace& place) {
    return place.y_m != 0 && std::abs(place.y_m) < (1 - 1e-9) * min_m;
  };
  if (const auto n = std::ranges::count_if(probes, is_beside); n > 0)
    notes.add(Diagnostic::resolution,
              "probes: {} of {} are less than two elements, {:.4g} m, from the interface: strains and "
              "stresses there are those of the mesh; choose a smaller plate.element_size_m",
              n, probes.size(), min_m);
}

/// Rows of a table that end where a node is, but for rounding: the node has the later row's values.
void add_rows_beside_nodes(const Problem& problem, Diagnostics& notes) {
  const auto& along_x = problem.friction.along_x;
  if (along_x.file.empty() || !along_x.is_stepwise()) return;
  const double h_m = problem.element_size_m();
  for (const double x_m : along_x.table.x_m) {
    const double node_x_m = h_m * std::round(x_m / h_m);
    const double off_m = x_m - node_x_m;
    if (off_m > 1e-9 * h_m && off_m <= problem::position_tolerance * problem.width_m())
      notes.add(Diagnostic::resolution,
                "friction.file: the row at x = {} m counts for the node at {:g} m, {:.2g} m before it, "
                "as well; put rows of a stepwise table between nodes",
                x_m, node_x_m, off_m);
  }
}

/// What goes on between events and ends them.
void add_sequence(const Problem& problem, Diagnostics& notes) {
  if (!problem.is_sequence()) return;
  constexpr double few = 0.1, most_healing = 0.1;
  double c_S = infinity;
  for (const auto& body : problem.bodies) c_S = std::min(c_S, solid::shear_speed_m_per_s(body.material));
  const double period_s = 4 * problem.greatest_height_m() / c_S;
  if (problem.time.quiet_s < few * period_s)
    notes.add(Diagnostic::physics,
              "time.quiet_s = {:g} s is far below 4 H/c_S = {:.3g} s: waves of an event that come back "
              "later count for nothing, or begin the next event",
              problem.time.quiet_s, period_s);
  if (const auto& shears_m = problem.sequence.path.shears_m;
      !shears_m.empty() && std::ranges::max(shears_m) > problem.width_m())
    add_note("sequence.shears_m up to", std::ranges::max(shears_m), "farther than plate.width_m; is it in m?",
             notes);
  if (problem.sequence.healing_per_e_fold > most_healing)
    add_note("sequence.healing_per_e_fold", problem.sequence.healing_per_e_fold,
             "surfaces gain some 0.01 in mu_s an e-fold of time at rest; is it in per cent?", notes);
}

/// A load that moves so fast that its waves matter.
void add_fast_load(const Problem& problem, Diagnostics& notes) {
  constexpr double most_of_strength = 0.01;
  const bool has_path = !problem.sequence.path.times_s.empty();
  const double load_m_per_s = problem.is_sequence()
                                  ? std::max(problem.path().fastest_m_per_s(), problem.shear_speed_m_per_s)
                                  : shear_speed_in_event_m_per_s(problem);
  const double wave_Pa = load_m_per_s * solid::shear_modulus_Pa(problem.above().material) /
                         solid::shear_speed_m_per_s(problem.above().material);
  const double strength_Pa =
      interface::static_coefficient(problem.friction.law) * nominal_pressure_Pa(problem);
  if (strength_Pa > 0 && wave_Pa > most_of_strength * strength_Pa)
    notes.add(
        Diagnostic::physics,
        "the load moves at up to {:.3g} m/s, whose waves carry {:.2g} of the strength: {}; {} slow enough?",
        load_m_per_s, wave_Pa / strength_Pa,
        problem.is_sequence() ? "between events it is taken for static, and in them it works"
                              : "it drives the event on",
        has_path ? "are sequence.times_s and loading.shear_speed_m_per_s" : "is loading.shear_speed_m_per_s");
}

/// A pusher that leaves nothing of the side.
void add_pusher(const Problem& problem, Diagnostics& notes) {
  const auto& pusher = problem.above().machine.pusher;
  constexpr double most = 0.9;
  const double share = (pusher.to_m - pusher.from_m) / problem.above().plate.height_m;
  if (pusher.is_there() && share > most)
    notes.add(Diagnostic::physics,
              "the pusher covers {:.3g} % of the side (loading.pusher_from_m, pusher_to_m): the side "
              "stays straight",
              100 * share);
}

/// A tip that may be that of a wave.
void add_tip_rate(const Problem& problem, Diagnostics& notes) {
  constexpr double few = 0.1;
  if (!problem.friction.law.never_sticks() || !problem.friction.tip_slip_rate_m_per_s) return;
  const double usual_m_per_s = default_tip_slip_rate_m_per_s(problem);
  if (*problem.friction.tip_slip_rate_m_per_s < few * usual_m_per_s)
    notes.add(Diagnostic::physics,
              "friction.tip_slip_rate_m_per_s = {:g}: far below {:.3g} m/s, where radiation takes over: a "
              "tip may be the shear wave that runs ahead of the rupture",
              *problem.friction.tip_slip_rate_m_per_s, usual_m_per_s);
}

/// What damping decides.
void add_damping(const Problem& problem, Diagnostics& notes) {
  const auto bodies = materials_of(problem);
  const double of_plate_s = bodies.above.stiffness_damping_s;
  if (bodies.below && stability::are_alike(bodies) && of_plate_s != bodies.below->stiffness_damping_s)
    notes.add(Diagnostic::physics,
              "the two bodies are of one material, but material.stiffness_damping_s is {:g} and "
              "base.stiffness_damping_s {:g}: waves and slip are not symmetric",
              of_plate_s, bodies.below->stiffness_damping_s);
  const double advised_s = advised_damping_s(problem);
  const double least_s = std::min(of_plate_s, bodies.below ? bodies.below->stiffness_damping_s : of_plate_s);
  constexpr double about = 0.99;  // elements divide the width, and may differ a little from the size given
  if (least_s < about * advised_s)
    notes.add(
        Diagnostic::resolution,
        "friction follows the pressure at once between bodies that differ, with damping of {:g} s: waves of "
        "3 to 4 elements can grow on the mesh alone, and arrivals be wrong; {} = {:.3g} damps them (or use "
        "[friction] regularisation)",
        least_s, bodies.below ? "stiffness_damping_s of both bodies" : "material.stiffness_damping_s",
        advised_s);
}

/// Stiffness of block and machine under uniform slip over the critical one of steady sliding (Ruina 1983).
void add_stiff_machine(const Problem& problem, Diagnostics& notes) {
  const auto& machine = problem.above().machine;
  if (!problem.is_slow() || problem.above().machine.pusher.is_there()) return;
  const auto response = *interface::state_response(problem.friction.law, 0);
  const double critical_Pa_per_m = (response.b - response.a) * nominal_pressure_Pa(problem) / response.d_c_m;
  double yields_m_per_Pa = problem.above().plate.height_m / solid::shear_modulus_Pa(problem.above().material);
  if (problem.has_below())
    yields_m_per_Pa += problem.below().plate.height_m / solid::shear_modulus_Pa(problem.below().material);
  yields_m_per_Pa += 1 / machine.shear_stiffness_Pa_per_m;
  const double ratio = 1 / (yields_m_per_Pa * critical_Pa_per_m);
  if (critical_Pa_per_m > 0 && ratio > 1)
    notes.add(Diagnostic::physics,
              "block and machine have {:.3g} times the critical stiffness (b - a) p/d_c = {:.3g} Pa/m: "
              "slip may stay slow without an event, until sequence.end_s or the end of a path",
              ratio, critical_Pa_per_m);
}

/// A free side bears no shear.
void add_free_sides(const Problem& problem, Diagnostics& notes) {
  if (!problem.is_prestressed()) return;
  const bool is_free = problem.above().plate.sides == mesh::Sides::free ||
                       (problem.has_below() && problem.below().plate.sides == mesh::Sides::free);
  const auto& t_Pa = problem.prestress->table.rows.t_s_Pa;
  const bool is_sheared = problem.prestress->file.empty() ? problem.prestress->t_Pa != 0.0
                                                          : t_Pa.front() != 0 || t_Pa.back() != 0;
  if (is_free && is_sheared)
    notes.add(
        Diagnostic::physics,
        "sides are free, but t is prescribed up to the corners: free sides bear no shear, so that this is no "
        "state of equilibrium, and pressures at the corners are not those of a block; use absorbing sides, "
        "or loading.method = direct");
}

/// Times that do not suit the plate.
void add_times(const Problem& problem, double step_s, Diagnostics& notes) {
  // From a patch to the end of the interface that is farther off; where else an event begins only its run
  // tells.
  const double width_m = problem.width_m(), x_m = problem.start.nucleation.x_m;
  const double way_m =
      problem.start.kind == interface::EventKind::nucleation ? std::max(x_m, width_m - x_m) : width_m;
  const double arrival_s = way_m / solid::shear_speed_m_per_s(problem.above().material);
  if (problem.time.end_s < arrival_s)
    notes.add(
        Diagnostic::physics, "time.end_s = {:.4g} s is before a shear wave {}, at {:.4g} s",
        problem.time.end_s,
        way_m < width_m ? "from the patch has reached both ends of the interface" : "has crossed the plate",
        arrival_s);
  constexpr double most_steps = 1e8;
  if (problem.time.end_s > 1e3 * width_m / solid::shear_speed_m_per_s(problem.above().material) ||
      problem.time.end_s > most_steps * step_s)
    notes.add(Diagnostic::units,
              "time.end_s = {:g} s is {:.2g} steps, and {:.2g} times what a shear wave takes to cross "
              "the plate; is it in s?",
              problem.time.end_s, problem.time.end_s / step_s,
              problem.time.end_s * solid::shear_speed_m_per_s(problem.above().material) / width_m);
  if (problem.output.history_interval_s > arrival_s)
    add_note("output.history_interval_s", problem.output.history_interval_s,
             "a shear wave crosses the plate between two rows; is it in s?", notes);
  if (const double p_Pa = nominal_pressure_Pa(problem),
      rate = problem.prestress ? -problem.prestress->p_rate_Pa_per_s : 0;
      rate * problem.time.end_s > p_Pa)
    notes.add(Diagnostic::physics,
              "prestress.p_rate_Pa_per_s takes the mean pressure to 0 at {:.4g} s: from there on the "
              "interface opens, and what moves without contact does not count as slip",
              p_Pa / rate);
  if (problem.start.is_by_force() && problem.start.trigger.ramp_s > problem.time.end_s)
    notes.add(Diagnostic::physics, "event.trigger_ramp_s = {:.4g} s is longer than the event, {:.4g} s",
              problem.start.trigger.ramp_s, problem.time.end_s);
}

}  // namespace

std::string no_static_state(const UserError& error) {
  return fmt::format("no static state to predict from: {}. A run finds by slow slip where its events begin",
                     error.what());
}

Diagnostics notes_of_case(const Problem& problem, const RuptureOutlook& rupture, double step_s) {
  Diagnostics notes;
  if (problem.prestress)
    add_table("prestress.file", problem.prestress->table.rows.x_m, problem.width_m(), notes);
  add_table("friction.file", problem.friction.along_x.table.x_m, problem.width_m(), notes);
  add_rows_beside_nodes(problem, notes);
  const auto& along_x = problem.friction.along_x;
  if (along_x.random_key != "none" && along_x.random_correlation_length_m < problem.element_size_m())
    notes.add(Diagnostic::resolution,
              "friction.random_correlation_length_m = {:.4g} m is below the element size: the mesh "
              "does not resolve the field",
              along_x.random_correlation_length_m);
  if (problem.fronts.l_star_m < 0.99 * problem.element_size_m())
    notes.add(Diagnostic::resolution,
              "fronts.l_star_m = {:.4g} m is below the element size: one element is used",
              problem.fronts.l_star_m);
  for (const auto& body : problem.bodies)
    add_odd_units(&body == &problem.above() ? "material" : "base", body.material, problem.width_m(), notes);
  add_odd_sizes(problem, notes);
  add_odd_units_of_friction(problem, notes);
  add_odd_pressures(problem, notes);
  add_lengths(problem, notes);
  add_times(problem, step_s, notes);
  add_free_sides(problem, notes);
  add_stiff_machine(problem, notes);
  add_damping(problem, notes);
  add_sequence(problem, notes);
  add_fast_load(problem, notes);
  add_pusher(problem, notes);
  add_tip_rate(problem, notes);
  if (problem.time.step_factor > 1)
    notes.add(Diagnostic::resolution, "the step is above the largest stable one (time.allow_unstable)");
  for (const auto& doubt : rupture.doubts) notes.add(Diagnostic::physics, "{}", doubt);
  notes.add(rupture.notes);
  notes.add(setup::snapshot_plan(problem, step_s).notes);
  return notes;
}

Diagnostics notes_of_case(const Problem& problem, const Processes& processes) {
  require_memory_fits(problem, processes);
  return notes_of_case(problem, rupture_outlook(problem, setup::check(problem)),
                       estimated_size(problem).step_s);
}

}  // namespace slipfront::advice
