// SPDX-License-Identifier: BSD-3-Clause
#include "run/run.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#ifdef __GLIBC__  // known from the headers above
#include <malloc.h>
#endif

#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/memory.hpp"
#include "base/per_node.hpp"
#include "input/friction_along_x.hpp"
#include "input/prestress.hpp"
#include "input/schema.hpp"
#include "interface/nucleation.hpp"
#include "mesh/plate.hpp"
#include "motion/stepper.hpp"
#include "run/choices.hpp"
#include "run/needs.hpp"
#include "run/warnings.hpp"
#include "statics/plate_solver.hpp"
#include "statics/prestress.hpp"

namespace slipfront::run {

namespace {

using interface::is_at_edge;

/// B at the nodes of the interface. [lower]
std::vector<double> patch(const interface::Nucleation& nucleation, const mesh::Mesh& mesh) {
  std::vector<double> B;
  for (const auto n : mesh.lower)
    B.push_back(interface::nucleation_profile(nucleation, mesh.x_m[n], mesh.period_m));
  return B;
}

const statics::Equilibrium& event_state(const input::Case& config, const InitialState& initial) {
  return config.event == interface::EventKind::spontaneous ? initial.spontaneous : initial.common;
}

PerNode static_coefficients(const input::Case& config, const std::vector<double>& of_nodes) {
  return of_nodes.empty() ? PerNode(interface::static_coefficient(config.friction)) : PerNode(of_nodes);
}

/// Those of the nodes' laws; empty where they all have the case's.
std::vector<double> static_coefficients(const std::vector<interface::FrictionLaw>& laws) {
  std::vector<double> mu_s;
  for (const auto& law : laws) mu_s.push_back(interface::static_coefficient(law));
  return mu_s;
}

std::vector<double> at_all_nodes(const PerNode& values, const mesh::Mesh& mesh) {
  std::vector<double> all;
  for (std::size_t k = 0; k < mesh.lower.size(); ++k) all.push_back(values[k]);
  return all;
}

/// Prescribed tractions beyond the static strength, said in one line; empty where there are none.
std::string prestress_warning(const statics::Equilibrium& state, const PerNode& mu_s) {
  const auto& s = state.tractions;
  std::int64_t n = 0;
  for (std::size_t k = 0; k < s.x_m.size(); ++k) n += std::abs(s.t_s_Pa[k]) > mu_s[k] * s.p_s_Pa[k] ? 1 : 0;
  if (n == 0) return {};
  return fmt::format("the prestress is beyond mu_s p at {} of {} interface nodes: they slip at once", n,
                     s.x_m.size());
}

/// Nodes in contact that slip or are open at rest, said in one line; empty where all stick.
std::string contact_warning(const statics::Equilibrium& state) {
  const auto n_slip = std::ranges::count(state.contact, statics::Contact::slip);
  const auto n_open = std::ranges::count(state.contact, statics::Contact::open);
  if (n_slip + n_open == 0) return {};
  return fmt::format(
      "before the event {} interface nodes are open and {} slip at mu_s p, all outside {:.4g} to {:.4g} m",
      n_open, n_slip, state.inside_from_m, state.inside_to_m);
}

/// Why a trigger at an edge adds nothing, and which amount does.
std::string idle_trigger(const input::Case& config, const statics::Equilibrium& state, const PerNode& mu_s,
                         std::span<const double> tributary_m) {
  const auto& trigger = config.trigger;
  const auto zone = motion::trigger_zone(state, config.event, trigger.zone_m);
  const double direction = motion::load_direction(state, tributary_m, zone);
  double least = std::numeric_limits<double>::infinity();
  for (const auto k : zone)
    least = std::min(least, direction * state.tractions.t_s_Pa[k] / state.tractions.p_s_Pa[k] / mu_s[k]);
  const bool added = trigger.form == interface::TriggerForm::added;
  return fmt::format(
      "event.trigger_amount = {:g} adds no traction in the trigger zone, where t is at least {:.4g} mu_s p "
      "before the event; choose more than {}",
      trigger.amount, least,
      !added      ? fmt::format("{:.4g}", least)
      : least < 1 ? "0"
                  : fmt::format("{:.4g} with event.trigger_form = raised", least));
}

/// Forces of a trigger at an edge, none for other events.
/// @throws UserError  where the trigger adds nothing
std::vector<double> trigger_forces(const input::Case& config, const statics::Equilibrium& state,
                                   const PerNode& mu_s, std::span<const double> tributary_m) {
  auto forces = motion::trigger_forces(state, tributary_m, config.event, config.trigger, mu_s);
  const bool pushes = is_at_edge(config.event) && config.trigger.form != interface::TriggerForm::weakened;
  if (pushes && std::ranges::all_of(forces, [](double force) { return force == 0; }))
    throw UserError("{}", idle_trigger(config, state, mu_s, tributary_m));
  return forces;
}

/// Interface::intact of an event that begins with a weakened patch or zone; empty for others.
std::vector<double> intact_shares(const input::Case& config, const statics::Equilibrium& state,
                                  const mesh::Mesh& mesh) {
  const bool patched = config.event == interface::EventKind::nucleation &&
                       config.nucleation.form == interface::NucleationForm::weakened;
  if (patched) {
    auto shares = patch(config.nucleation, mesh);
    for (double& share : shares) share = 1 - share;
    return shares;
  }
  if (!is_at_edge(config.event) || config.trigger.form != interface::TriggerForm::weakened) return {};
  std::vector<double> shares(mesh.lower.size(), 1.0);
  for (const auto k : motion::trigger_zone(state, config.event, config.trigger.zone_m)) shares[k] = 0;
  return shares;
}

/// Refuses an event that begins with weakening at nodes whose friction does not weaken.
void require_weakening(const input::Case& config, const std::vector<double>& intact,
                       const std::vector<interface::FrictionLaw>& laws) {
  if (intact.empty() || laws.empty()) return;
  for (std::size_t i = 0; i < laws.size(); ++i)
    if (intact[i] < 1 && interface::kinetic_coefficient(laws[i]) < interface::static_coefficient(laws[i]))
      return;
  throw UserError(
      "{} = weakened does nothing where friction does not weaken at any node; choose another form",
      is_at_edge(config.event) ? "event.trigger_form" : "nucleation.form");
}

/// The ramp knows one coefficient for all nodes.
void require_one_static_coefficient_of_ramp(const input::Case& config, const std::vector<double>& mu_s) {
  if (config.loading.method == statics::LoadingMethod::ramp &&
      std::ranges::adjacent_find(mu_s, std::not_equal_to<>()) != mu_s.end())
    throw UserError(
        "{} makes {} vary along x, which loading.method = ramp does not know; choose direct or prestress",
        config.friction_along_x.file.empty() ? "friction.random_key" : "friction.file",
        interface::static_coefficient_key(config.friction));
}

}  // namespace

namespace {

double approximate_unknowns_of(const mesh::Plate& plate) {
  double unknowns = 0, h = plate.element_size_m, height_m = plate.fine_height_m, rest_m = plate.height_m;
  for (int k = 0; k <= std::max(0, plate.coarsenings) && rest_m > 0; ++k) {
    const double of_block_m = k == plate.coarsenings ? rest_m : std::min(height_m, rest_m);
    unknowns += 2 * (plate.width_m / h + 1) * (of_block_m / h + 1);
    rest_m -= of_block_m;
    height_m = plate.height_m - rest_m;  // a block is as high as everything below it
    h *= 2;
  }
  return unknowns;
}

}  // namespace

double approximate_unknowns(const input::Case& config) {
  const double of_plate = approximate_unknowns_of(config.plate);
  return input::has_base_body(config) ? of_plate + approximate_unknowns_of(input::base_plate(config))
                                      : of_plate;
}

void require_plate_fits(const input::Case& config) {
  const double n_nodes = 0.5 * approximate_unknowns(config);
  require_memory(
      motion::event_bytes(n_nodes, n_nodes, !config.output.snapshot_times_s.empty(), config.time.precision),
      fmt::format("{} of {:.4g} nodes", input::has_base_body(config) ? "a plate and its base" : "a plate",
                  n_nodes),
      "choose a larger plate.element_size_m");
}

double top_speed_m_per_s(const input::Case& config) {
  return config.loading.shear_speed_over_c_L * solid::longitudinal_speed_m_per_s(config.material);
}

statics::StaticSolver wanted_solver(const input::Case& config) {
  if (input::has_base_body(config)) return statics::StaticSolver::direct;  // the iterative one knows no base
  const auto& plate = config.plate;
  return statics::solver_for_shape(config.loading.solver, plate.coarsenings > 0,
                                   std::round(plate.width_m / plate.element_size_m),
                                   std::round(plate.height_m / plate.element_size_m));
}

double nominal_pressure_Pa(const input::Case& config) {
  const double compression_m = 0.5 * (config.loading.tilt_left_m + config.loading.tilt_right_m);
  double per_compression = stability::nominal_pressure_Pa(config.material, 1, config.plate.height_m);
  if (input::has_base_body(config)) {
    const double of_base =
        stability::nominal_pressure_Pa(input::base_material(config), 1, config.base.plate.height_m);
    per_compression *= of_base / (per_compression + of_base);
  }
  return compression_m * per_compression;
}

bool is_prestressed(const input::Case& config) {
  return config.loading.method == statics::LoadingMethod::prestress;
}

record::StaticState prescribed_tractions(const input::Prestress& prestress, const mesh::Mesh& mesh) {
  record::StaticState state;
  state.x_m = interface_x_m(mesh);
  if (!prestress.file.empty()) return input::prestress_at(prestress, state.x_m);
  state.t_s_Pa.assign(state.x_m.size(), prestress.t_Pa);
  state.p_s_Pa.assign(state.x_m.size(), prestress.p_Pa);
  return state;
}

std::vector<double> interface_x_m(const mesh::Mesh& mesh) {
  std::vector<double> x_m;
  for (const auto n : mesh.lower) x_m.push_back(mesh.x_m[n]);
  return x_m;
}

WaveSpeeds wave_speeds(const solid::Material& m) {
  return {solid::longitudinal_speed_m_per_s(m), solid::shear_speed_m_per_s(m),
          solid::rayleigh_speed_m_per_s(m)};
}

void require_statics_fit(const input::Case& config) {
  const double n_plate = approximate_unknowns_of(config.plate);
  if (input::has_base_body(config))
    statics::require_statics_memory_of_pair(n_plate, approximate_unknowns_of(input::base_plate(config)));
  else
    statics::require_statics_memory(wanted_solver(config), n_plate);
}

namespace {

/// Empty where friction does not vary.
std::string key_of_friction_along_x(const input::Case& config) {
  if (!config.friction_along_x.varies()) return {};
  input::Case relevant;
  relevant.friction = config.friction;
  relevant.friction_along_x = config.friction_along_x;
  return input::to_toml(relevant) + config.friction_along_x.table.text;
}

}  // namespace

std::string initial_state_key(const input::Case& config) {
  input::Case relevant;
  relevant.plate = config.plate;
  relevant.base = config.base;
  if (is_prestressed(config)) {
    relevant.loading.method = config.loading.method;
    relevant.prestress = config.prestress;
    relevant.base.material = {};
    return input::to_toml(relevant) + config.prestress.table.text + key_of_friction_along_x(config);
  }
  relevant.material = config.material;
  relevant.loading = config.loading;
  relevant.friction = interface::Coulomb { interface::static_coefficient(config.friction) };
  if (config.loading.method == statics::LoadingMethod::ramp) {
    // Nodes at the edges slip during the ramp, by the law itself.
    relevant.friction = config.friction;
    relevant.regularisation = config.regularisation;
    relevant.contact = config.contact;
    relevant.time = config.time;
  } else {
    relevant.material.density_kg_per_m3 = input::Case{}.material.density_kg_per_m3;
    relevant.material.stiffness_damping_s = input::Case{}.material.stiffness_damping_s;
    relevant.base.material.density_kg_per_m3 = relevant.material.density_kg_per_m3;
    relevant.base.material.stiffness_damping_s = relevant.material.stiffness_damping_s;
  }
  return input::to_toml(relevant) + key_of_friction_along_x(config);
}

namespace {

/// Statics of a tilted plate need edges that hold.
void require_edges_to_tilt(const input::Case& config) {
  if (config.plate.sides == mesh::Sides::periodic)
    throw UserError(
        "plate.sides = periodic has no equilibrium under a tilted top edge; choose free or absorbing, or "
        "loading.method = prestress");
  if (config.plate.top != mesh::Top::loaded)
    throw UserError(
        "plate.top = {} leaves no edge to tilt and shear; choose loaded, or loading.method = prestress",
        config.plate.top == mesh::Top::absorbing ? "absorbing" : "free");
  if (input::has_base_body(config) && config.base.plate.top != mesh::Top::loaded)
    throw UserError(
        "base.bottom = {} does not hold the base under a tilted plate; choose held, or loading.method = "
        "prestress",
        config.base.plate.top == mesh::Top::absorbing ? "absorbing" : "free");
}

void require_free_sides_for_single(const input::Case& config) {
  if (config.time.precision != motion::Precision::single_precision) return;
  const auto require = [](const mesh::Plate& plate, const char* table) {
    if (plate.sides != mesh::Sides::free)
      throw UserError(
          "time.precision = single needs rows between free sides; choose {}.sides = free or double", table);
  };
  require(config.plate, "plate");
  if (input::has_base_body(config)) require(config.base.plate, "base");
}

/// Of the body below, upside down.
mesh::Mesh make_base(const input::Case& config) {
  const auto plate = input::base_plate(config);
  const double rows = plate.height_m / plate.element_size_m;
  if (std::abs(rows - std::round(rows)) > 1e-6 * rows)
    throw UserError(
        "base.height_m = {:.8g} is no whole multiple of plate.element_size_m = {:.8g}, with which the nodes "
        "of "
        "the two bodies face each other; the nearest that fit are {:.8g} and {:.8g}",
        plate.height_m, plate.element_size_m, std::floor(rows) * plate.element_size_m,
        std::ceil(rows) * plate.element_size_m);
  return mesh::make_plate(plate, "base");
}

}  // namespace

Meshes check(const input::Case& config) {
  require_plate_fits(config);
  if (!is_prestressed(config)) {
    require_edges_to_tilt(config);
    require_statics_fit(config);
  }
  require_free_sides_for_single(config);
  Meshes meshes{mesh::make_plate(config.plate), {}};
  motion::require_rows_fit(meshes.plate, config.time);
  if (input::has_base_body(config)) {
    meshes.base = make_base(config);
    motion::require_rows_fit(*meshes.base, config.time);
  }
  const auto laws = input::friction_at(config, interface_x_m(meshes.plate));
  const auto mu_s = static_coefficients(laws);
  if (!is_prestressed(config)) {
    require_one_static_coefficient_of_ramp(config, mu_s);
    return meshes;
  }
  const auto state = statics::prestressed(meshes.plate, prescribed_tractions(config.prestress, meshes.plate));
  trigger_forces(config, state, static_coefficients(config, mu_s), mesh::tributary_lengths_m(meshes.plate));
  require_weakening(config, intact_shares(config, state, meshes.plate), laws);
  return meshes;
}

mesh::Mesh joined(Meshes meshes) {
  auto mesh = std::move(meshes.plate);
  if (!meshes.base) return mesh;
  const auto& base = *meshes.base;
  const auto first = mesh.n_nodes();
  for (auto grid : mesh::blocks(base)) {
    grid.first += first;
    mesh.coarser.push_back(grid);
  }
  mesh.x_m.insert(mesh.x_m.end(), base.x_m.begin(), base.x_m.end());
  for (const double y : base.y_m) mesh.y_m.push_back(-y);
  for (const auto& [a, b, c, d] : base.cells)  // counterclockwise again
    mesh.cells.push_back({first + d, first + c, first + b, first + a});
  return mesh;
}

std::unique_ptr<motion::Stepper> new_stepper(const input::Case& config, const mesh::Mesh& plate,
                                             const std::optional<mesh::Mesh>& base,
                                             const motion::Execution& execution) {
  const auto contact = input::contact_model(config, interface_x_m(plate));
  if (!base)
    return std::make_unique<motion::Stepper>(plate, config.material, contact, config.time, execution);
  const auto material = input::base_material(config);
  return std::make_unique<motion::Stepper>(motion::BodySource{plate, config.material},
                                           motion::BodySource{*base, material}, contact, config.time,
                                           execution);
}

namespace {

/// The largest that a slip rate can be by linear elasticity, see motion::Watch.
double fastest_speed_m_per_s(const input::Case& config) {
  const double of_plate = solid::longitudinal_speed_m_per_s(config.material);
  if (!input::has_base_body(config)) return of_plate;
  return std::max(of_plate, solid::longitudinal_speed_m_per_s(input::base_material(config)));
}

}  // namespace

InitialState make_initial_state(const input::Case& config, const motion::Monitor& monitor,
                                const motion::Execution& execution, const RampBegins& ramp_begins) {
  const auto start = Clock::now();
  const double margin = config.loading.critical_margin;
  InitialState initial;
  auto meshes = check(config);
  initial.mesh = std::move(meshes.plate);
  initial.base = std::move(meshes.base);
  initial.n_nodes = initial.mesh.n_nodes() + (initial.base ? initial.base->n_nodes() : 0);
  initial.n_cells = std::ssize(initial.mesh.cells) + (initial.base ? std::ssize(initial.base->cells) : 0);
  initial.tributary_m = mesh::tributary_lengths_m(initial.mesh);
  initial.mu_s = static_coefficients(input::friction_at(config, interface_x_m(initial.mesh)));
  const double mu_s = static_coefficients(config, initial.mu_s)[0];
  if (is_prestressed(config)) {
    initial.prescribed = true;
    initial.common = statics::prestressed(initial.mesh, prescribed_tractions(config.prestress, initial.mesh),
                                          initial.base ? &*initial.base : nullptr);
    initial.spontaneous = initial.common;
    initial.critical_shear_m = fronts::undefined;
    initial.wall_s = seconds_since(start);
    return initial;
  }
  const auto base_material = input::base_material(config);
  std::optional<statics::ElasticBody> base;
  if (initial.base) base.emplace(*initial.base, base_material);
  const statics::Statics statics({initial.mesh, config.material}, base, config.loading,
                                 at_all_nodes(static_coefficients(config, initial.mu_s), initial.mesh),
                                 interface::static_coefficient_key(config.friction),
                                 [&] { return monitor(0, 0); });
  initial.n_unknowns = statics.solver().n_unknowns();
  initial.solver = statics::choose_solver(wanted_solver(config), 2.0 * static_cast<double>(initial.n_nodes));
  initial.solver_bytes = statics.solver().bytes();
  initial.critical_shear_m = statics.shear_to(1).shear_m;
  if (config.loading.method == statics::LoadingMethod::direct) {
    initial.common = statics.shear_to(1 - margin);
    initial.spontaneous = statics.shear_to(1 + margin);
  } else {
    auto of_ramp = config;
    of_ramp.time.interface_substeps = 1;
    const auto with_ramp = new_stepper(of_ramp, initial.mesh, initial.base, execution);
    auto& stepper = *with_ramp;
    const auto tilted = statics.shear_by(0);
    stepper.start(tilted, top_speed_m_per_s(config));
    motion::RampRun ramp(stepper, tilted, config.loading, mu_s, top_speed_m_per_s(config),
                         fastest_speed_m_per_s(config), initial.critical_shear_m);
    if (ramp_begins) ramp_begins(stepper, ramp);
    initial.ramp = ramp.run(monitor);
    if (initial.ramp->interrupted) throw Interrupted("interrupted during the ramp, before the event");
    initial.common = initial.ramp->common;
    initial.spontaneous = initial.ramp->spontaneous;
  }
  initial.wall_s = seconds_since(start);
  return initial;
}

fronts::FrontOptions front_options(const input::Case& config, const InitialState& initial) {
  fronts::FrontOptions o;
  o.l_star_m = config.fronts.l_star_m;
  o.speed_interval = config.fronts.speed_interval;
  o.arrest_time_s = config.fronts.arrest_time_s;
  o.min_length_m = config.fronts.min_length_m;
  o.crack_share = config.fronts.crack_share;
  o.pulse_share = config.fronts.pulse_share;
  o.mu_s = static_coefficients(config, initial.mu_s);
  o.elasticity = {config.material.youngs_modulus_Pa, config.material.poissons_ratio,
                  config.material.plane == solid::Plane::strain};
  const double margin = config.trigger.zone_m + config.fronts.trigger_margin_m;
  const double edge = initial.prescribed ? 0 : config.loading.edge_margin_m;
  const double contact_from = initial.common.inside_from_m - edge;
  const double contact_to = initial.common.inside_to_m + edge;
  if (config.event == interface::EventKind::left) {
    o.exclude_left_m = contact_from + margin;
    o.driven = {{contact_from, contact_from + config.trigger.zone_m}};
  }
  if (config.event == interface::EventKind::right) {
    o.exclude_right_m = contact_to - margin;
    o.driven = {{contact_to - config.trigger.zone_m, contact_to}};
  }
  if (config.event == interface::EventKind::nucleation) {
    const auto& n = config.nucleation;
    const double patch_reach = n.half_length_m + n.taper_m;
    const double reach = patch_reach + config.fronts.trigger_margin_m;
    o.exclude_from_m = n.x_m - reach;
    o.exclude_to_m = n.x_m + reach;
    // A patch that passes an edge of a periodic plate goes on at the other one.
    const double period = initial.mesh.period_m;
    for (const double shift : {0.0, -period, period})
      o.driven.push_back({n.x_m - patch_reach + shift, n.x_m + patch_reach + shift});
    if (period > 0 && o.exclude_from_m < 0) o.exclude_right_m = o.exclude_from_m + period;
    if (period > 0 && o.exclude_to_m > period) o.exclude_left_m = o.exclude_to_m - period;
  }
  return o;
}

namespace {

std::unique_ptr<motion::Stepper> started_stepper(const input::Case& config, const InitialState& initial,
                                                 const motion::Execution& execution) {
  const auto& state = event_state(config, initial);
  auto forces = trigger_forces(config, state, static_coefficients(config, initial.mu_s), initial.tributary_m);
  auto intact = intact_shares(config, state, initial.mesh);
  if (!intact.empty())
    require_weakening(config, intact, input::friction_at(config, interface_x_m(initial.mesh)));
  auto stepper = new_stepper(config, initial.mesh, initial.base, execution);
  stepper->start(state, top_speed_m_per_s(config));
  if (initial.prescribed) stepper->set_prestress(state.tractions.t_s_Pa, state.tractions.p_s_Pa);
  if (!intact.empty()) stepper->set_intact(std::move(intact));
  if (config.event == interface::EventKind::nucleation &&
      config.nucleation.form == interface::NucleationForm::overstress) {
    const auto B = patch(config.nucleation, initial.mesh);
    for (std::size_t k = 0; k < B.size(); ++k)
      if (state.contact[k] != statics::Contact::open)
        forces[k] = config.nucleation.overstress_Pa * B[k] * initial.tributary_m[k];
  }
  stepper->set_trigger(config.trigger, std::move(forces));
  return stepper;
}

void release_displacements(statics::Equilibrium& state) {
  state.u_m = {};
  state.u_per_shear = {};
  state.below_u_m = {};
  state.below_u_per_shear = {};
}

/// What only the stepper needed.
void release_nodes(mesh::Mesh& mesh) {
  mesh.x_m = std::vector<double>();
  mesh.y_m = std::vector<double>();
  mesh.cells = std::vector<mesh::Cell>();
#ifdef __GLIBC__
  malloc_trim(0);  // what was freed may lie between what was not
#endif
}

}  // namespace

std::unique_ptr<motion::Stepper> start_event(const input::Case& config, InitialState& initial,
                                             const motion::Execution& execution) {
  const auto* from = &event_state(config, initial);
  if (from != &initial.common) release_displacements(initial.common);
  if (from != &initial.spontaneous) release_displacements(initial.spontaneous);
  if (initial.ramp) {
    release_displacements(initial.ramp->common);
    release_displacements(initial.ramp->spontaneous);
  }
  auto stepper = started_stepper(config, initial, execution);
  release_displacements(initial.common);
  release_displacements(initial.spontaneous);
  release_nodes(initial.mesh);
  if (initial.base) release_nodes(*initial.base);
  return stepper;
}

std::unique_ptr<motion::Stepper> make_stepper(const input::Case& config, InitialState& initial,
                                              const motion::Execution& execution) {
  auto stepper = new_stepper(config, initial.mesh, initial.base, execution);
  release_nodes(initial.mesh);
  if (initial.base) release_nodes(*initial.base);
  return stepper;
}

motion::EventRun begin_event(const input::Case& config, const InitialState& initial,
                             motion::Stepper& stepper) {
  const bool triggered =
      (is_at_edge(config.event) && config.trigger.form != interface::TriggerForm::weakened) ||
      (config.event == interface::EventKind::nucleation &&
       config.nucleation.form == interface::NucleationForm::overstress);
  return {stepper,
          event_state(config, initial),
          static_coefficients(config, initial.mu_s),
          fastest_speed_m_per_s(config),
          triggered ? config.trigger : interface::Trigger{.ramp_s = 0},
          config.time,
          {config.output.history_interval_s, config.output.energy_interval_s,
           snapshot_plan(config, stepper.step_s()).times_s},
          motion::halo_for(initial.mesh, config.fronts.l_star_m)};
}

Result run_event(const input::Case& config, const InitialState& initial, const motion::Monitor& monitor,
                 const motion::Execution& execution) {
  const auto stepper = started_stepper(config, initial, execution);
  return run_event(config, initial, *stepper, monitor);
}

Result run_event(const input::Case& config, const InitialState& initial, motion::Stepper& stepper,
                 const motion::Monitor& monitor, motion::Sink* sink) {
  const auto start = Clock::now();
  auto result = unmeasured(config, stepper, begin_event(config, initial, stepper).run(monitor, sink));
  result.stepping_wall_s = seconds_since(start);
  measure(result, initial);
  return result;
}

Result unmeasured(const input::Case& config, const motion::Stepper& stepper, motion::Event event) {
  Result result;
  result.config = config;
  result.speeds = wave_speeds(config.material);
  result.stable_step_s = stepper.stable_step_s();
  result.step_s = stepper.step_s();
  result.substep_s = stepper.substep_s();
  result.node_updates_per_step = stepper.node_updates_per_step();
  result.event = std::move(event);
  return result;
}

void measure(Result& result, const InitialState& initial) {
  const auto& config = result.config;
  const auto& state = event_state(config, initial);
  result.fronts =
      fronts::find_fronts(result.event.record, initial.common.tractions, front_options(config, initial));
  result.warnings = warnings_of_case(config);
  if (auto warning = contact_warning(initial.common); !warning.empty()) result.warnings.push_back(warning);
  if (initial.prescribed)
    if (auto warning = prestress_warning(state, static_coefficients(config, initial.mu_s)); !warning.empty())
      result.warnings.push_back(warning);
  const auto& before = result.event.energies.front();
  const auto& after = result.event.energies.back();
  if (!initial.prescribed && after.trigger_work > 0.1 * before.strain)
    result.warnings.push_back(
        fmt::format("the trigger has done {:.4g} J/m of work, {:.0f} % of the energy stored before: what "
                    "happens behind the front is its doing",
                    after.trigger_work, 100 * after.trigger_work / before.strain));
  const auto snapshots = snapshot_plan(config, result.step_s);
  for (const auto& note : snapshots.notes) result.warnings.push_back(note);
  const auto n_after =
      std::ranges::count_if(snapshots.times_s, [&](double time_s) { return time_s > result.event.time_s; });
  if (result.event.end == motion::EventEnd::quiet && n_after > 0)
    result.warnings.push_back(fmt::format(
        "{} of {} output.snapshot_times_s are after the end of the event at t = {:.4g} s, where no node had "
        "slipped for time.quiet_s = {:g}",
        n_after, config.output.snapshot_times_s.size(), result.event.time_s, config.time.quiet_s));
  if (result.event.record.onsets.empty()) result.warnings.push_back("no node slipped");
}

}  // namespace slipfront::run
