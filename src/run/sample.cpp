// SPDX-License-Identifier: BSD-3-Clause
#include "run/sample.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "boundary/boundary.hpp"
#include "setup/event_loads.hpp"

namespace slipfront::run {

using record::LoadingPhase;
using record::LoadingRow;

RelativeDisplacement relative(const InitialState& initial, const statics::Equilibrium& state) {
  RelativeDisplacement u;
  for (std::size_t k = 0; k < initial.mesh.interface_nodes.size(); ++k) {
    const auto n = initial.mesh.interface_nodes[k];
    u.x_m.push_back(state.u_m.x[n]);
    u.y_m.push_back(state.u_m.y[n]);
    if (!initial.base) continue;
    const auto below = initial.base->interface_nodes[k];  // described upside down
    u.x_m.back() -= state.below_u_m.x[below];
    u.y_m.back() += state.below_u_m.y[below];
  }
  return u;
}

namespace {

/// Adds the works between two equilibria to those of `sum`: by the mean of the forces at both, which is what
/// the strain energy changes by.
void add_works(const InitialState& initial, const statics::Equilibrium& from, const statics::Equilibrium& to,
               record::Energies& sum) {
  const auto u_from = relative(initial, from), u_to = relative(initial, to);
  double force_N_per_m = 0;
  for (std::size_t k = 0; k < initial.tributary_m.size(); ++k) {
    const double half_m = 0.5 * initial.tributary_m[k];
    const double t = half_m * (from.tractions.t_s_Pa[k] + to.tractions.t_s_Pa[k]);
    const double p = half_m * (from.tractions.p_s_Pa[k] + to.tractions.p_s_Pa[k]);
    force_N_per_m += t;
    sum.friction_work -= t * (u_to.x_m[k] - u_from.x_m[k]);
    sum.contact_work += p * (u_to.y_m[k] - u_from.y_m[k]);
  }
  sum.far_edge_work += force_N_per_m * (to.shear_m - from.shear_m);
}

}  // namespace

Sample::Sample(const Problem& given, const motion::Monitor& asked, const Processes& processes)
    : problem(given),
      path(problem.path()),
      initial(setup::unloaded_state(problem, processes)),
      statics(setup::statics_of(problem, initial, [asked] { return asked(0, 0); })),
      plate(solid::make_operator(initial.mesh, problem.above().material,
                                 boundary::make_boundary(initial.mesh, problem.above().machine).edge_sets())),
      monitor(asked) {
  if (initial.base) base = solid::make_operator(*initial.base, problem.below().material);
  setup::describe_solver(problem, statics, initial);
  at_rest = statics.tilted();
  if (problem.heals()) rest.rests_since_s.assign(initial.tributary_m.size(), 0);
  loading.push_back(row(LoadingPhase::tilted, 0, 0, at_rest.tractions));
  add_state(at_rest, loading.back());
  n_rows_at_rest = loading.size();
}

void Sample::add_state(const statics::Equilibrium& state, LoadingRow& row) const {
  row.energies.strain = solid::strain_energy_J_per_m(plate, state.u_m);
  if (base) row.energies.strain += solid::strain_energy_J_per_m(*base, state.below_u_m);
  row.energies.machine = statics.machine_energy_J_per_m(state);
  row.shear_height_m = statics.shear_height_m(state);
}

LoadingRow Sample::row(LoadingPhase phase, double time_s, double shear_m,
                       const record::StaticState& tractions) const {
  LoadingRow row = loading.empty() ? LoadingRow{} : loading.back();
  row.phase = phase;
  row.n_events =
      static_cast<std::int32_t>(events.size()) + (is_of_event(phase) ? 1 : 0);  // not yet among them
  row.shear_m = shear_m;
  row.time_s = time_s;
  row.energies.time_s = row.time_s;
  row.energies.kinetic = 0;
  row.fastest_slip_rate_m_per_s = 0;
  double normal = 0, shear = 0, moment = 0;
  for (std::size_t k = 0; k < initial.tributary_m.size(); ++k) {
    const double p = tractions.p_s_Pa[k] * initial.tributary_m[k];
    normal += p;
    shear += tractions.t_s_Pa[k] * initial.tributary_m[k];
    moment += p * tractions.x_m[k];
  }
  row.normal_force_N_per_m = normal;
  row.shear_force_N_per_m = shear;
  row.shear_over_normal = shear / normal;
  row.normal_force_x_m = moment / normal;
  row.pressure_moment_N = moment - normal * 0.5 * (tractions.x_m.front() + tractions.x_m.back());
  row.shear_height_m = nan;
  return row;
}

void Sample::require_stands(double time_s, double shear_m, const std::vector<double>& t_Pa,
                            const std::vector<double>& p_Pa) const {
  const auto& geometry = problem.above().plate;
  const auto& x_m = at_rest.tractions.x_m;
  const auto at = fmt::format("{:.6g} s after normal loading, at a shear of {:.6g} m", time_s, shear_m);
  double force = 0, shear_force = 0, moment = 0, from_m = nan, to_m = nan;
  for (std::size_t k = 0; k < x_m.size(); ++k) {
    const double p = p_Pa[k] * initial.tributary_m[k];
    force += p;
    shear_force += t_Pa[k] * initial.tributary_m[k];
    moment += p * x_m[k];
    if (!(p > 0)) continue;
    if (std::isnan(from_m)) from_m = x_m[k];
    to_m = x_m[k];
  }
  const double acts_m = moment / force;
  // A pressure above 0 acts further inside, unless a single node bears it.
  const bool stands = force > 0 && std::min(acts_m - from_m, to_m - acts_m) > 0.5 * geometry.element_size_m;
  if (!stands && geometry.sides != mesh::Sides::periodic)
    throw UserError(
        "{} the plate tips: its normal force acts at the end of the contact, x = {:.4g} m; choose a "
        "lower {} or a larger {}",
        at, acts_m, Key("plate.height_m"), Key("plate.width_m"));
  const double most_m = std::max(geometry.width_m, geometry.height_m);
  const double stiffness_Pa = problem.above().machine.shear_stiffness_Pa_per_m *
                              problem.above().machine.moved_length_m(geometry.width_m);
  const double edge_m = shear_m - rest.shear_m - rest.moved_m - shear_force / stiffness_Pa;
  if (std::isinf(path.end_s()) && !(edge_m <= most_m))
    throw UserError(
        "{} no event has begun, and the loaded edge has moved by more than the plate's size, {:g} m: "
        "nothing brings one about; give {}, or choose other loads or friction",
        at, most_m, Key("sequence.end_s"));
}

void Sample::load_to(LoadingPhase phase, const statics::Equilibrium& state) {
  const double time =
      phase == LoadingPhase::loaded ? std::max(path.end_s(), rest.time_s) : time_s(state.shear_m);
  require_stands(time, state.shear_m + rest.moved_m, state.tractions.t_s_Pa, state.tractions.p_s_Pa);
  auto loaded = row(phase, time, state.shear_m + rest.moved_m, state.tractions);
  add_works(initial, at_rest, state, loaded.energies);
  add_state(state, loaded);
  loading.push_back(loaded);
}

void Sample::heal_until(double time_s) {
  const auto& sequence = problem.sequence;
  initial.healed.clear();
  for (const double since_s : rest.rests_since_s)
    initial.healed.push_back(sequence.healing_per_e_fold *
                             std::log1p((time_s - since_s) / sequence.healing_time_s));
  const auto x_m = mesh::interface_x_m(initial.mesh);
  statics.set_mu_s(setup::strength_over_pressure(problem, x_m, initial.healed).at_all(x_m.size()),
                   "sequence.healing_per_e_fold");
}

void Sample::equilibrate() {
  if (problem.is_slow()) {
    at_rest = statics.slid_to(rest.contact, rest.u_x_m, {}, rest.shear_m);
    return;
  }
  if (problem.heals()) heal_until(rest.time_s);
  statics.hold(rest.contact, rest.u_x_m);
  at_rest = statics.shear_by(rest.shear_m);
}

}  // namespace slipfront::run
