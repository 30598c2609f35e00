// SPDX-License-Identifier: BSD-3-Clause
#include "setup/meshes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "boundary/pusher.hpp"
#include "mesh/plate.hpp"
#include "motion/level.hpp"
#include "problem/contact.hpp"
#include "setup/event_loads.hpp"
#include "setup/subdomains.hpp"
#include "statics/prestress.hpp"

namespace slipfront::setup {

namespace {

/// Statics of a tilted plate need edges that hold.
void require_edges_to_tilt(const Problem& problem) {
  if (problem.above().plate.sides == mesh::Sides::periodic)
    throw UserError(
        "{} = periodic has no equilibrium under a tilted top edge; choose free or absorbing, or {} = "
        "prestress",
        Key("plate.sides"), Key("loading.method"));
  if (problem.above().plate.top != mesh::Top::loaded)
    throw UserError(
        "{} = {} leaves no edge to tilt and shear; choose loaded, or {} = prestress", Key("plate.top"),
        problem.above().plate.top == mesh::Top::absorbing ? "absorbing" : "free", Key("loading.method"));
  if (problem.has_below() && problem.below().plate.top != mesh::Top::loaded)
    throw UserError("{} = {} does not hold the base under a tilted plate; choose held, or {} = prestress",
                    Key("base.bottom"),
                    problem.below().plate.top == mesh::Top::absorbing ? "absorbing" : "free",
                    Key("loading.method"));
}

void require_possible_by_plain_scheme(const Problem& problem, const Processes& processes) {
  if (!problem.is_plain()) return;
  const Key stepper("time.stepper");
  if (problem.time.precision == motion::Precision::single_precision)
    throw UserError("{} = plain computes in double precision; choose {} = double, or fast", stepper,
                    Key("time.precision"));
  if (problem.is_by_ramp())
    throw UserError("{} = plain computes no ramp; choose {} = direct, or fast", stepper,
                    Key("loading.method"));
  if (processes.size() > 1)
    throw UserError("{} = plain runs on one rank, not {}; start one, or choose fast", stepper,
                    processes.size());
}

void require_free_sides_for_single(const Problem& problem) {
  if (problem.time.precision != motion::Precision::single_precision) return;
  const auto require = [](const mesh::Plate& plate, const char* sides) {
    if (plate.sides != mesh::Sides::free)
      throw UserError("{} = single needs rows between free sides; choose {} = free or double",
                      Key("time.precision"), Key(sides));
  };
  require(problem.above().plate, "plate.sides");
  if (problem.has_below()) require(problem.below().plate, "base.sides");
}

/// Mesh of the body below, upside down.
mesh::Mesh make_base(const Problem& problem, bool only_interface) {
  const auto plate = problem.below().plate;
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
std::vector<motion::Probe> probes_among_columns(const Problem& problem, const mesh::Mesh& interface) {
  constexpr int beside = 4;
  const auto& grid = interface.grid;
  std::vector<motion::Probe> probes;
  for (const auto& place : problem.probes) {
    const double column = std::clamp(place.x_m / grid.spacing_m, 0.0, static_cast<double>(grid.columns));
    const int begin = std::max(static_cast<int>(column) - beside, 0);
    const int end = std::min(static_cast<int>(column) + beside + 2, grid.stride());
    std::vector<mesh::Span> ranges = {{begin, end}};
    if (interface.period_m > 0 && (begin == 0 || end == grid.stride()))
      ranges = {{0, 2 * beside}, {grid.stride() - 2 * beside, grid.stride()}};
    const mesh::Subset columns(ranges);
    const auto plate = mesh::make_columns(problem.above().plate, columns);
    std::optional<mesh::Mesh> base;
    if (problem.has_below()) base = mesh::make_columns(problem.below().plate, columns);
    auto probe =
        motion::locate_probes(std::span(&place, 1), GlobalBodies(problem, plate, base).bodies()).front();
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

std::vector<motion::Probe> probes_of(const Problem& problem, const mesh::Mesh& plate,
                                     const std::optional<mesh::Mesh>& base) {
  if (problem.probes.empty()) return {};
  if (plate.is_interface()) return probes_among_columns(problem, plate);
  return motion::locate_probes(problem.probes, GlobalBodies(problem, plate, base).bodies());
}

namespace {

/// Laws of all nodes, or the one law that they have.
std::vector<interface::FrictionLaw> laws_of(const Problem& problem, const mesh::Mesh& plate) {
  auto laws = friction_at(problem, mesh::interface_x_m(plate));
  if (laws.empty()) laws.push_back(problem.friction.law);
  return laws;
}

/// Steady sliding has to have friction at all rates of slow slip: no state belongs to less than none.
void require_steady_friction(const Problem& problem, const mesh::Mesh& plate) {
  constexpr int n_rates = 100;
  const double from = problem.friction.law.parameter("V_i_m_per_s"), to = tip_slip_rate_m_per_s(problem);
  for (const auto& law : laws_of(problem, plate))
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
void require_rate_of_events(const Problem& problem) {
  const Key key("sequence.inertia_slip_rate_m_per_s"), speed("loading.shear_speed_m_per_s");
  const double rate_m_per_s = inertia_slip_rate_m_per_s(problem);
  const double most_m_per_s = std::min(radiation_slip_rate_m_per_s(problem), tip_slip_rate_m_per_s(problem));
  const double load_m_per_s = std::max(problem.path().fastest_m_per_s(), problem.shear_speed_m_per_s);
  const Key first("friction.V_i_m_per_s");
  if (const double first_m_per_s = problem.friction.law.parameter("V_i_m_per_s");
      first_m_per_s > most_m_per_s)
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

void require_load_below_c_L(const Problem& problem) {
  const double speed_m_per_s = problem.path().fastest_m_per_s();
  const double c_L = solid::longitudinal_speed_m_per_s(problem.above().material);
  if (speed_m_per_s >= c_L)
    throw UserError("{} and {} move the load at {:.4g} m/s; it must be slower than c_L = {:.4g} m/s",
                    Key("sequence.times_s"), Key("sequence.shears_m"), speed_m_per_s, c_L);
}

/// Slip that strengthens with the slip rate everywhere stays slow, and no event ends it: at rates from rest
/// to those of the load, which slow slip comes to.
void require_end_of_slow_slip(const Problem& problem, const mesh::Mesh& plate) {
  const auto& sequence = problem.sequence;
  if (std::isfinite(sequence.end_s) || !sequence.path.times_s.empty()) return;
  const auto laws = laws_of(problem, plate);
  for (const double V_m_per_s : {0.0, problem.shear_speed_m_per_s}) {
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

Meshes checked_meshes(const Problem& problem, bool only_interface) {
  if (!problem.is_prestressed()) require_edges_to_tilt(problem);
  require_free_sides_for_single(problem);
  Meshes meshes{
      only_interface ? mesh::make_interface(problem.above().plate) : mesh::make_plate(problem.above().plate),
      {}};
  const auto& pusher = problem.above().machine.pusher;
  if (pusher.is_there() && !meshes.plate.is_interface() &&
      boundary::pushed_nodes(meshes.plate, pusher).empty())
    throw UserError(
        "no node lies between {} = {:g} m and {} = {:g} m, where elements are larger; choose others",
        Key("loading.pusher_from_m"), pusher.from_m, Key("loading.pusher_to_m"), pusher.to_m);
  motion::require_rows_fit(meshes.plate, problem.time);
  if (problem.has_below()) {
    meshes.base = make_base(problem, only_interface);
    motion::require_rows_fit(*meshes.base, problem.time, "base");
  }
  probes_of(problem, meshes.plate, meshes.base);  // refuses what lies outside
  if (problem.is_sequence()) require_load_below_c_L(problem);
  if (problem.is_slow()) {
    require_steady_friction(problem, meshes.plate);
    require_rate_of_events(problem);
    require_end_of_slow_slip(problem, meshes.plate);
  }
  strength_over_pressure(problem, mesh::interface_x_m(meshes.plate));  // refuses laws that no node can have
  if (!problem.is_prestressed()) return meshes;
  const auto state =
      statics::prestressed(meshes.plate, prescribed_tractions(problem, mesh::interface_x_m(meshes.plate)));
  event_loads(problem, state, meshes.plate);  // refuses what does nothing
  return meshes;
}

}  // namespace

Meshes check(const Problem& problem, const Processes& processes) {
  require_possible_by_plain_scheme(problem, processes);
  return checked_meshes(problem, root_has_interface_only(problem, processes.size()));
}

Meshes check_interfaces(const Problem& problem) {
  return checked_meshes(problem, true);
}

}  // namespace slipfront::setup
