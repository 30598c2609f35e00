// SPDX-License-Identifier: BSD-3-Clause
#include "run/initial_state.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/clock.hpp"
#include "base/error.hpp"
#include "boundary/pusher.hpp"
#include "fronts/front.hpp"
#include "input/entries.hpp"
#include "input/friction_along_x.hpp"
#include "interface/friction/coulomb.hpp"
#include "mesh/plate.hpp"
#include "motion/stepper.hpp"
#include "run/begin.hpp"
#include "run/choices.hpp"
#include "run/loading_path.hpp"
#include "run/needs.hpp"
#include "run/subdomains.hpp"
#include "statics/plate_solver.hpp"
#include "statics/prestress.hpp"

namespace slipfront::run {

namespace {

std::vector<double> at_all_nodes(const PerNode& values, const mesh::Mesh& mesh) {
  std::vector<double> all;
  for (std::size_t k = 0; k < mesh.interface_nodes.size(); ++k) all.push_back(values[k]);
  return all;
}

/// What an initial state without motion keeps of friction: the coefficients at rest.
std::string strengths_text(const input::Case& config) {
  auto at_rest = config;
  if (!config.friction_along_x.varies()) {
    at_rest.friction = interface::Coulomb { interface::static_coefficient(config.friction) };
    at_rest.friction.parameter(interface::FrictionLaw::cohesion_key) = config.friction.cohesion_Pa();
  }
  std::string text;
  for (const auto& entry : input::entries_of(at_rest))
    if (input::table_of(entry.key) == "friction") text += input::toml_text(entry.get(at_rest)) + "\n";
  return text + config.friction_along_x.table.text;
}

}  // namespace

void InitialState::release_displacements(const statics::Equilibrium* but) {
  std::vector<statics::Equilibrium*> states = {&subcritical, &supercritical};
  if (ramp) states.insert(states.end(), {&ramp->subcritical, &ramp->supercritical});
  for (auto* state : states)
    for (auto* field : state->displacements())
      if (state != but) *field = {};
}

std::string initial_state_key(const input::Case& config) {
  using input::Stage;
  if (is_prestressed(config)) {
    const bool t_follows =
        config.friction.has_state() && config.prestress.file.empty() && !config.prestress.t_Pa;
    return text_of_stages(config, {Stage::mesh, Stage::tractions}) +
           (t_follows ? text_of_stages(config, {Stage::motion}) : "") +
           (config.friction_along_x.varies() || config.friction.cohesion_Pa() > 0 ? strengths_text(config)
                                                                                  : "");
  }
  // Nodes at the edges slip during a ramp, by the law itself.
  if (config.loading.method == statics::LoadingMethod::ramp)
    return text_of_stages(config, {Stage::mesh, Stage::statics, Stage::motion});
  return text_of_stages(config, {Stage::mesh, Stage::statics}) + strengths_text(config);
}

namespace {

/// Statics of a tilted plate need edges that hold.
void require_edges_to_tilt(const input::Case& config) {
  if (config.plate.sides == mesh::Sides::periodic)
    throw UserError(
        "{} = periodic has no equilibrium under a tilted top edge; choose free or absorbing, or {} = "
        "prestress",
        Key("plate.sides"), Key("loading.method"));
  if (config.plate.top != mesh::Top::loaded)
    throw UserError("{} = {} leaves no edge to tilt and shear; choose loaded, or {} = prestress",
                    Key("plate.top"), config.plate.top == mesh::Top::absorbing ? "absorbing" : "free",
                    Key("loading.method"));
  if (input::has_base_body(config) && config.base.plate.top != mesh::Top::loaded)
    throw UserError("{} = {} does not hold the base under a tilted plate; choose held, or {} = prestress",
                    Key("base.bottom"), config.base.plate.top == mesh::Top::absorbing ? "absorbing" : "free",
                    Key("loading.method"));
}

void require_possible_by_plain_scheme(const input::Case& config, const Processes& processes) {
  if (!is_plain(config)) return;
  const Key stepper("time.stepper");
  if (config.time.precision == motion::Precision::single_precision)
    throw UserError("{} = plain computes in double precision; choose {} = double, or fast", stepper,
                    Key("time.precision"));
  if (config.loading.method == statics::LoadingMethod::ramp)
    throw UserError("{} = plain computes no ramp; choose {} = direct, or fast", stepper,
                    Key("loading.method"));
  if (processes.size() > 1)
    throw UserError("{} = plain runs on one rank, not {}; start one, or choose fast", stepper,
                    processes.size());
}

void require_free_sides_for_single(const input::Case& config) {
  if (config.time.precision != motion::Precision::single_precision) return;
  const auto require = [](const mesh::Plate& plate, const char* sides) {
    if (plate.sides != mesh::Sides::free)
      throw UserError("{} = single needs rows between free sides; choose {} = free or double",
                      Key("time.precision"), Key(sides));
  };
  require(config.plate, "plate.sides");
  if (input::has_base_body(config)) require(config.base.plate, "base.sides");
}

/// Mesh of the body below, upside down.
mesh::Mesh make_base(const input::Case& config, bool only_interface) {
  const auto plate = input::base_plate(config);
  const double rows = plate.height_m / plate.element_size_m;
  if (std::abs(rows - std::round(rows)) > 1e-6 * rows)
    throw UserError(
        "{} = {:.8g} is no whole multiple of {} = {:.8g}, with which the nodes of the two bodies face each "
        "other; the nearest that fit are {:.8g} and {:.8g}",
        Key("base.height_m"), plate.height_m, Key("plate.element_size_m"), plate.element_size_m,
        std::floor(rows) * plate.element_size_m, std::ceil(rows) * plate.element_size_m);
  return only_interface ? mesh::make_interface(plate, "base") : mesh::make_plate(plate, "base");
}

/// Found in those columns of the bodies that are next to each.
std::vector<motion::Probe> probes_among_columns(const input::Case& config, const mesh::Mesh& interface) {
  constexpr int beside = 4;
  const auto& grid = interface.grid;
  std::vector<motion::Probe> probes;
  for (const auto& place : input::probe_places(config)) {
    const double column = std::clamp(place.x_m / grid.spacing_m, 0.0, static_cast<double>(grid.columns));
    const int begin = std::max(static_cast<int>(column) - beside, 0);
    const int end = std::min(static_cast<int>(column) + beside + 2, grid.stride());
    std::vector<mesh::Span> ranges = {{begin, end}};
    if (interface.period_m > 0 && (begin == 0 || end == grid.stride()))
      ranges = {{0, 2 * beside}, {grid.stride() - 2 * beside, grid.stride()}};
    const mesh::Subset columns(ranges);
    const auto plate = mesh::make_columns(config.plate, columns);
    std::optional<mesh::Mesh> base;
    if (input::has_base_body(config)) base = mesh::make_columns(input::base_plate(config), columns);
    auto probe =
        motion::locate_probes(std::span(&place, 1), GlobalBodies(config, plate, base).bodies()).front();
    const mesh::NodeColumns of_subdomain(probe.body == 0 ? plate : *base, columns, grid.stride());
    for (auto& n : probe.node) n = of_subdomain.global_number(n);
    probes.push_back(probe);
  }
  return probes;
}

}  // namespace

std::int64_t n_nodes_of(const mesh::Mesh& mesh) {
  const auto& highest = mesh.coarser.empty() ? mesh.grid : mesh.coarser.back();
  return mesh.is_interface() ? highest.first + highest.n_nodes() : mesh.n_nodes();
}
std::int64_t n_cells_of(const mesh::Mesh& mesh) {
  return mesh.is_interface() ? std::int64_t{mesh.grid.columns} * mesh.grid.rows : std::ssize(mesh.cells);
}

std::vector<motion::Probe> probes_of(const input::Case& config, const mesh::Mesh& plate,
                                     const std::optional<mesh::Mesh>& base) {
  if (config.probes.x_m.empty()) return {};
  if (plate.is_interface()) return probes_among_columns(config, plate);
  return motion::locate_probes(input::probe_places(config), GlobalBodies(config, plate, base).bodies());
}

namespace {

/// Laws of all nodes, or the one law that they have.
std::vector<interface::FrictionLaw> laws_of(const input::Case& config, const mesh::Mesh& plate) {
  auto laws = input::friction_at(config, interface_x_m(plate));
  if (laws.empty()) laws.push_back(config.friction);
  return laws;
}

/// Steady sliding has to have friction at all rates of slow slip: no state belongs to less than none.
void require_steady_friction(const input::Case& config, const mesh::Mesh& plate) {
  constexpr int n_rates = 100;
  const double from = config.friction.parameter("V_i_m_per_s"), to = input::tip_slip_rate_m_per_s(config);
  for (const auto& law : laws_of(config, plate))
    for (int k = 0; k <= n_rates; ++k) {
      const double V_m_per_s = from * std::pow(to / from, static_cast<double>(k) / n_rates);
      const double coefficient = interface::friction_coefficient(law, V_m_per_s, 0);
      if (!(coefficient > 0))
        throw UserError(
            "the coefficient of steady sliding, by {} and {}, is {:.4g} at {:.3g} m/s; it must be above 0 "
            "up to the rate of a front's tip, {:.3g} m/s",
            Key("friction.f0"), Key("friction.b"), coefficient, V_m_per_s, to);
    }
}

/// An event begins above the rate at which the load lets the interface slide, and below that of its fronts.
void require_rate_of_events(const input::Case& config) {
  const Key key("sequence.inertia_slip_rate_m_per_s"), speed("loading.shear_speed_m_per_s");
  const double rate_m_per_s = input::inertia_slip_rate_m_per_s(config);
  const double most_m_per_s =
      std::min(input::radiation_slip_rate_m_per_s(config), input::tip_slip_rate_m_per_s(config));
  const double load_m_per_s = std::max(LoadingPath(config).fastest_m_per_s(), top_speed_m_per_s(config));
  const Key first("friction.V_i_m_per_s");
  if (const double first_m_per_s = config.friction.parameter("V_i_m_per_s"); first_m_per_s > most_m_per_s)
    throw UserError(
        "{} is {:.4g} m/s, beyond the rate at which inertia limits slip, {:.4g} m/s: no slow slip "
        "comes before an event; choose a smaller one, or press harder",
        first, first_m_per_s, most_m_per_s);
  if (load_m_per_s >= most_m_per_s)
    throw UserError(
        "the load moves at {:.4g} m/s, not below the rate at which inertia limits slip, {:.4g} m/s; choose a "
        "slower one ({}, {}), or press harder",
        load_m_per_s, most_m_per_s, speed, Key("sequence.times_s"));
  if (rate_m_per_s > most_m_per_s)
    throw UserError(
        "{} is {:.4g} m/s, beyond the rate of a front's tip or of radiation, {:.4g} m/s: fronts would "
        "be slow slip, and no event; choose a smaller one",
        key, rate_m_per_s, most_m_per_s);
  if (rate_m_per_s <= load_m_per_s)
    throw UserError(
        "{} is {:.4g} m/s, not above the speed of the load, {:.4g} m/s: steady sliding would be an event; "
        "choose a larger one, or a slower load ({}, {})",
        key, rate_m_per_s, load_m_per_s, speed, Key("sequence.times_s"));
}

void require_load_below_c_L(const input::Case& config) {
  const double speed_m_per_s = LoadingPath(config).fastest_m_per_s();
  const double c_L = solid::longitudinal_speed_m_per_s(config.material);
  if (speed_m_per_s >= c_L)
    throw UserError("{} and {} move the load at {:.4g} m/s; it must be slower than c_L = {:.4g} m/s",
                    Key("sequence.times_s"), Key("sequence.shears_m"), speed_m_per_s, c_L);
}

/// Slip that strengthens with the slip rate everywhere stays slow, and no event ends it: at rates from rest
/// to those of the load, which slow slip comes to.
void require_end_of_slow_slip(const input::Case& config, const mesh::Mesh& plate) {
  const auto& sequence = config.sequence;
  if (std::isfinite(sequence.end_s) || !sequence.path.times_s.empty()) return;
  const auto laws = laws_of(config, plate);
  for (const double V_m_per_s : {0.0, top_speed_m_per_s(config)}) {
    const auto weakens = [&](const auto& law) {
      const auto response = interface::state_response(law, V_m_per_s);
      return response->b > response->a;
    };
    if (std::ranges::any_of(laws, weakens)) return;
  }
  throw UserError(
      "friction does not weaken with the slip rate at any node (a >= b), at rest or at the load's speed: "
      "slip stays slow, and no event comes; choose {}, or a larger {}",
      Key("sequence.end_s"), Key("friction.b"));
}

Meshes checked_meshes(const input::Case& config, bool only_interface) {
  if (!is_prestressed(config)) require_edges_to_tilt(config);
  require_free_sides_for_single(config);
  Meshes meshes{only_interface ? mesh::make_interface(config.plate) : mesh::make_plate(config.plate), {}};
  const auto& pusher = config.machine.pusher;
  if (pusher.is_there() && !meshes.plate.is_interface() &&
      boundary::pushed_nodes(meshes.plate, pusher).empty())
    throw UserError(
        "no node lies between {} = {:g} m and {} = {:g} m, where elements are larger; choose others",
        Key("loading.pusher_from_m"), pusher.from_m, Key("loading.pusher_to_m"), pusher.to_m);
  motion::require_rows_fit(meshes.plate, config.time);
  if (input::has_base_body(config)) {
    meshes.base = make_base(config, only_interface);
    motion::require_rows_fit(*meshes.base, config.time, "base");
  }
  probes_of(config, meshes.plate, meshes.base);  // refuses what lies outside
  if (input::is_sequence(config)) require_load_below_c_L(config);
  if (input::is_slow(config)) {
    require_steady_friction(config, meshes.plate);
    require_rate_of_events(config);
    require_end_of_slow_slip(config, meshes.plate);
  }
  meshes.mu_s = ratios_at_rest(config, meshes.plate);
  if (!is_prestressed(config)) return meshes;
  const auto state = statics::prestressed(meshes.plate, prescribed_tractions(config, meshes.plate));
  starting_loads(config, state, meshes.plate, meshes.mu_s);  // refuses what does nothing
  return meshes;
}

}  // namespace

Meshes check(const input::Case& config, const Processes& processes) {
  require_possible_by_plain_scheme(config, processes);
  require_memory_fits(config, processes);
  return checked_meshes(config, root_has_interface_only(config, processes.size()));
}

Meshes check_interfaces(const input::Case& config) {
  return checked_meshes(config, true);
}

std::unique_ptr<motion::Stepper> new_stepper(const input::Case& config, const mesh::Mesh& plate,
                                             const std::optional<mesh::Mesh>& base,
                                             const motion::Execution& execution) {
  return std::make_unique<motion::Stepper>(GlobalBodies(config, plate, base).bodies(),
                                           input::contact_model(config, interface_x_m(plate)), config.time,
                                           execution);
}

std::unique_ptr<motion::TimeStepper> new_time_stepper(const input::Case& config, const mesh::Mesh& plate,
                                                      const std::optional<mesh::Mesh>& base,
                                                      const motion::Execution& execution) {
  if (!is_plain(config)) return new_stepper(config, plate, base, execution);
  return std::make_unique<motion::PlainStepper>(GlobalBodies(config, plate, base).bodies(),
                                                input::contact_model(config, interface_x_m(plate)),
                                                config.time);
}

InitialState unloaded_state(const input::Case& config, const Processes& processes) {
  InitialState initial;
  auto meshes = check(config, processes);
  initial.mesh = std::move(meshes.plate);
  initial.base = std::move(meshes.base);
  initial.n_nodes = n_nodes_of(initial.mesh) + (initial.base ? n_nodes_of(*initial.base) : 0);
  initial.n_cells = n_cells_of(initial.mesh) + (initial.base ? n_cells_of(*initial.base) : 0);
  initial.tributary_m = mesh::tributary_lengths_m(initial.mesh);
  initial.mu_s = std::move(meshes.mu_s);
  return initial;
}

namespace {

statics::Statics statics_of(const input::Case& config, const mesh::Mesh& plate,
                            const std::optional<mesh::Mesh>& base_mesh, const PerNode& mu_s,
                            statics::Statics::MayContinue may_continue) {
  const auto base_material = input::base_material(config);
  std::optional<statics::ElasticBody> base;
  if (base_mesh) base.emplace(statics::ElasticBody{*base_mesh, base_material});
  auto loading = config.loading;
  loading.solver = wanted_solver(config);
  return {{plate, config.material, config.machine},
          base,
          loading,
          at_all_nodes(mu_s, plate),
          interface::static_coefficient_key(config.friction),
          std::move(may_continue)};
}

}  // namespace

statics::Statics statics_of(const input::Case& config, const InitialState& initial,
                            statics::Statics::MayContinue may_continue) {
  return statics_of(config, initial.mesh, initial.base, ratios_at_rest(config, initial.mu_s),
                    std::move(may_continue));
}

void describe_solver(const input::Case& config, const statics::Statics& statics, InitialState& initial) {
  initial.n_unknowns = statics.solver().n_unknowns();
  initial.solver = statics::choose_solver(wanted_solver(config), 2.0 * static_cast<double>(initial.n_nodes));
  initial.solver_bytes = statics.solver().bytes();
}

InitialState make_initial_state(const input::Case& config, const motion::Monitor& monitor,
                                const motion::Execution& execution, const RampBegins& ramp_begins,
                                const Processes& processes) {
  const auto start = Clock::now();
  auto initial = unloaded_state(config, processes);
  const auto mu_s = ratios_at_rest(config, initial.mu_s);
  if (is_prestressed(config)) {
    initial.prescribed = true;
    initial.subcritical = statics::prestressed(initial.mesh, prescribed_tractions(config, initial.mesh),
                                               initial.base ? &*initial.base : nullptr);
    initial.supercritical = initial.subcritical;
    initial.critical_shear_m = nan;
    initial.wall_s = seconds_since(start);
    return initial;
  }
  const auto statics = statics_of(config, initial, [&] { return monitor(0, 0); });
  describe_solver(config, statics, initial);
  const auto critical = statics.shear_to(1);
  initial.critical_shear_m = critical.shear_m;
  if (config.loading.method == statics::LoadingMethod::direct) {
    initial.subcritical = common_state(config, statics, critical, initial.tributary_m);
    initial.supercritical = statics::is_sheared_by_force(config.loading)
                                ? initial.subcritical
                                : statics.shear_to(1 + config.loading.critical_margin);
  } else {
    auto of_ramp = config;
    of_ramp.time.interface_substeps = 1;
    const auto with_ramp = new_stepper(of_ramp, initial.mesh, initial.base, execution);
    auto& stepper = *with_ramp;
    const auto tilted = statics.shear_by(0);
    stepper.start(tilted, top_speed_m_per_s(config));
    motion::RampRun ramp(stepper,
                         {tilted, config.loading, mu_s, top_speed_m_per_s(config),
                          fastest_speed_m_per_s(config), initial.critical_shear_m},
                         monitor);
    if (ramp_begins) ramp_begins(stepper, ramp);
    initial.ramp = ramp.run();
    if (initial.ramp->interrupted) throw Interrupted("interrupted during the ramp, before the event");
    initial.subcritical = initial.ramp->subcritical;
    initial.supercritical = initial.ramp->supercritical;
  }
  if (has_forces(config))
    initial.loads = resolved_loads(config, statics, critical, initial.subcritical, initial.tributary_m);
  initial.wall_s = seconds_since(start);
  return initial;
}

std::optional<LoadedState> loaded_state(const input::Case& config, const Meshes& meshes) {
  if (!has_forces(config)) return {};
  const auto statics =
      statics_of(config, meshes.plate, meshes.base, ratios_at_rest(config, meshes.mu_s), [] { return true; });
  const auto tributary_m = mesh::tributary_lengths_m(meshes.plate);
  const auto critical = statics.shear_to(1);
  auto subcritical = common_state(config, statics, critical, tributary_m);
  const auto loads = resolved_loads(config, statics, critical, subcritical, tributary_m);
  return LoadedState{loads, std::move(subcritical)};
}

}  // namespace slipfront::run
