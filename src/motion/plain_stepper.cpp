// SPDX-License-Identifier: BSD-3-Clause
#include "motion/plain_stepper.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/error.hpp"
#include "boundary/boundary.hpp"
#include "mesh/plate.hpp"
#include "motion/body.hpp"
#include "motion/orientation.hpp"

namespace slipfront::motion {

namespace {

/// Sum of a.b over the nodes.
double dot(const solid::Field& a, const solid::Field& b) {
  return std::inner_product(a.x.begin(), a.x.end(), b.x.begin(), 0.0) +
         std::inner_product(a.y.begin(), a.y.end(), b.y.begin(), 0.0);
}

PlainBody make_body(const BodySource& source, const TimeStepping& time, std::span<const int> block_periods,
                    double substep_s) {
  const auto& mesh = source.mesh;
  const auto& material = source.material;
  require_rows_fit(mesh, time);
  const auto n = static_cast<std::size_t>(mesh.n_nodes());
  PlainBody body;
  body.cells = mesh.cells;
  for (const auto& cell : mesh.cells)
    body.stiffness_N_per_m.push_back(solid::cell_stiffness(solid::cell_coordinates(mesh, cell), material));
  body.mass_kg = solid::lumped_mass(mesh, material);
  body.damping_s = material.stiffness_damping_s;
  body.is_in_contact = mesh::marked(mesh, mesh.interface_nodes);
  const auto boundary = boundary::make_boundary(mesh, source.machine);
  body.is_loaded = mesh::marked(mesh, boundary.driven);
  body.side = make_interface_side(mesh, body.mass_kg, BodyMotion{});
  body.side.landing = Landing(mesh, material, body.side.nodes);
  const auto levels = cell_levels(mesh, time, block_periods);
  for (std::size_t l = 0; l < levels.periods.size(); ++l) {
    PlainLevel level;
    level.period = levels.periods[l];
    level.step_s = substep_s * level.period;
    level.is_shared.resize(n);
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
      if (levels.of_cell[c] != l) continue;
      level.cells.push_back(static_cast<std::int32_t>(c));
      for (const auto a : mesh.cells[c])
        if (levels.of_node[a] > l && !body.is_loaded[a]) level.is_shared[a] = true;
    }
    for (std::size_t a = 0; a < n; ++a)
      if (levels.of_node[a] == l && body.mass_kg[a] > 0) level.nodes.push_back(static_cast<mesh::Node>(a));
    level.u_before_m = level.v_seen_m_per_s = level.force_N = level.damping_force_N = solid::Field(n);
    body.levels.push_back(std::move(level));
  }
  body.u_m = body.v_m_per_s = body.load_m_per_s2 = body.impulse_m_per_s = body.v_last_m_per_s =
      solid::Field(n);
  body.dashpots.resize(n);
  body.springs = boundary::MachineSprings(mesh, material, boundary);
  for (const auto& edge : boundary.nodes) {
    const auto a = edge.node;
    auto dashpot =
        boundary::make_dashpot(edge, material, body.mass_kg[a], body.levels[levels.of_node[a]].step_s);
    dashpot.spring = body.springs.place(a);
    if (!body.is_in_contact[a]) {
      body.dashpots[a] = dashpot;
      continue;
    }
    dashpot.at = static_cast<std::size_t>(std::ranges::find(body.side.nodes, a) - body.side.nodes.begin());
    body.side.dashpots.push_back(dashpot);
  }
  return body;
}

StepPlan plan_of(std::span<const BodySource> sources, const TimeStepping& time) {
  std::vector<BodySteps> steps;
  for (const auto& source : sources) steps.push_back(body_steps(source, time));
  return step_plan(steps, time);
}

std::vector<PlainBody> make_bodies(std::span<const BodySource> sources, const TimeStepping& time,
                                   const StepPlan& plan) {
  std::vector<PlainBody> bodies;
  for (std::size_t b = 0; b < sources.size(); ++b)
    bodies.push_back(make_body(sources[b], time, plan.bodies[b].block_periods,
                               plan.lowest_step_s / time.interface_substeps));
  return bodies;
}

}  // namespace

solid::Field stiffness_product(const PlainBody& body, const PlainLevel& level, const solid::Field& w) {
  solid::Field product(w.size());
  for (const auto c : level.cells) {
    const auto& cell = body.cells[c];
    const auto& K = body.stiffness_N_per_m[c];
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b) {
        const double x = w.x[cell[b]], y = w.y[cell[b]];
        product.x[cell[a]] += K[16 * a + 2 * b] * x + K[16 * a + 2 * b + 1] * y;
        product.y[cell[a]] += K[16 * a + 8 + 2 * b] * x + K[16 * a + 8 + 2 * b + 1] * y;
      }
  }
  return product;
}

namespace {

/// Sets a level's shared nodes to their mean velocity since its last kick.
void set_mean_velocities(const PlainBody& body, const PlainLevel& level, solid::Field& v) {
  for (const auto component : components)
    for (std::size_t n = 0; n < v.size(); ++n)
      if (level.is_shared[n])
        (v.*component)[n] = ((body.u_m.*component)[n] - (level.u_before_m.*component)[n]) / level.step_s;
}

}  // namespace

solid::Field velocities_seen(const PlainBody& body, const PlainLevel& level) {
  auto v = body.v_m_per_s;
  set_mean_velocities(body, level, v);
  return v;
}

void add_works(const PlainBody& body, const PlainLevel& level, const solid::Field& v_seen_m_per_s,
               record::Energies& works) {
  const double half_step_s = 0.5 * level.step_s;
  works.damping_work -= half_step_s * (dot(level.damping_force_N, level.v_seen_m_per_s) +
                                       dot(level.damping_force_N, v_seen_m_per_s));
  // The level's force on shared nodes does its work through the finer velocities, see move: not here.
  for (const auto component : components)
    for (std::size_t n = 0; n < body.mass_kg.size(); ++n)
      if (level.is_shared[n])
        works.coupling_work += half_step_s * (level.force_N.*component)[n] *
                               ((level.v_seen_m_per_s.*component)[n] + (v_seen_m_per_s.*component)[n]);
}

PlainStepper::PlainStepper(std::span<const BodySource> sources, const interface::ContactModel& contact,
                           const TimeStepping& time)
    : plan_(plan_of(sources, time)),
      bodies_(make_bodies(sources, time, plan_)),
      coupling_(contact, contacts_of(bodies_)) {}

void PlainStepper::start(const statics::Equilibrium& equilibrium, double top_speed_m_per_s, Loads loads) {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    auto& body = bodies_[b];
    const auto n = body.mass_kg.size();
    const auto& u = b == 0 ? equilibrium.u_m : equilibrium.below_u_m;
    const auto& per_shear = b == 0 ? equilibrium.u_per_shear : equilibrium.below_u_per_shear;
    const bool is_strained = u.size() > 0;
    const double speed = b == 0 || is_strained ? top_speed_m_per_s : 0;
    body.u_m = is_strained ? u : solid::Field(n);
    body.v_m_per_s = is_strained ? per_shear : solid::Field(n);
    for (std::size_t a = 0; a < n; ++a)
      if (!is_strained && body.is_loaded[a]) body.v_m_per_s.x[a] = 1;
    for (const auto component : components)
      for (double& value : body.v_m_per_s.*component) value *= speed;
    body.v_last_m_per_s = body.v_m_per_s;
    body.load_m_per_s2 = body.impulse_m_per_s = solid::Field(n);
    body.works = {};
    body.springs.start(body.u_m, speed);
    for (auto& level : body.levels) {
      level.force_N = level.damping_force_N = level.v_seen_m_per_s = solid::Field(n);
      level.u_before_m = body.u_m;
      auto w = body.u_m;
      for (const auto component : components)
        for (std::size_t a = 0; a < n; ++a) {
          (level.u_before_m.*component)[a] -= level.step_s * (body.v_m_per_s.*component)[a];
          (w.*component)[a] += body.damping_s * (body.v_m_per_s.*component)[a];
        }
      const auto force_N = stiffness_product(body, level, w);
      for (const auto component : components)
        for (std::size_t a = 0; a < n; ++a)
          if (level.is_shared[a])
            (body.load_m_per_s2.*component)[a] = -(force_N.*component)[a] / body.mass_kg[a];
    }
  }
  coupling_.start(equilibrium, std::move(loads));
  step_ = 0;
}

StateView PlainStepper::state() {
  StateView state;
  for (auto& body : bodies_) {
    std::vector<solid::Field*> fields = {&body.u_m, &body.v_m_per_s, &body.load_m_per_s2,
                                         &body.impulse_m_per_s, &body.v_last_m_per_s};
    for (auto& level : body.levels)
      fields.insert(fields.end(),
                    {&level.u_before_m, &level.v_seen_m_per_s, &level.force_N, &level.damping_force_N});
    std::vector<StateArray> arrays;
    for (auto* field : fields) arrays.insert(arrays.end(), {field->x, field->y});
    state.lists.push_back(
        {StateKey::node, state.bodies.size(), body.mass_kg.size(), nullptr, std::move(arrays)});
    std::vector<StateArray> of_springs;
    for (auto* values : body.springs.arrays()) of_springs.emplace_back(*values);
    state.lists.push_back({StateKey::node, state.bodies.size(), body.springs.nodes().size(),
                           body.springs.nodes().data(), std::move(of_springs)});
    state.bodies.emplace_back();
    body.side.landing.add_to(state);
    for (const auto& term : record::energy_terms) state.sums.push_back(&(body.works.*term.member));
  }
  coupling_.add_to(state);
  return state;
}

std::int64_t PlainStepper::advance(SlipObserver& observer, std::int64_t max_steps) {
  for (std::int64_t taken = 0; taken < max_steps;) {
    record::History* sample = observer.row();
    take_step(std::span(bodies_), plan_.period, [&](int k) {
      coupling_.update(time_s() + k * substep_s(), substep_s(), observer, k == 0 ? sample : nullptr,
                       bodies_.front().works);
    });
    if (double* to = probes_.empty() ? nullptr : observer.displacements(step_ + 1); to != nullptr)
      std::ranges::copy(probed_u_m(), to);
    ++step_;
    ++taken;
    if (!observer.after_step(coupling_.slip_rates()) || observer.is_interrupted()) return taken;
  }
  return max_steps;
}

record::Energies PlainStepper::energies() {
  record::Energies sum;
  for (const auto& body : bodies_) {
    add_terms(sum, body.works);
    for (const auto& level : body.levels) {
      const auto v = velocities_seen(body, level);
      add_works(body, level, v, sum);
      // 1/2 u K u' between the level's last two places.
      const auto K_u = stiffness_product(body, level, body.u_m);
      sum.strain += 0.5 * (dot(body.u_m, K_u) - level.step_s * dot(v, K_u));
    }
  }
  sum.kinetic = kinetic_energy_J_per_m();
  sum.time_s = time_s();
  return sum;
}

double PlainStepper::kinetic_energy_J_per_m() const {
  double energy = 0;
  for (const auto& body : bodies_) {
    const auto& [x, y] = body.v_m_per_s;
    for (std::size_t n = 0; n < x.size(); ++n) energy += 0.5 * body.mass_kg[n] * (x[n] * x[n] + y[n] * y[n]);
  }
  return energy;
}

double PlainStepper::mass_kg_per_m() const {
  double mass = 0;
  for (const auto& body : bodies_) mass += std::reduce(body.mass_kg.begin(), body.mass_kg.end());
  return mass;
}

double PlainStepper::energy_of_tractions_J_per_m() const {
  const auto& mass_kg = bodies_.front().mass_kg;
  const double v = plan_.stable_step_s * coupling_.largest_acceleration_m_per_s2();
  return 0.5 * std::reduce(mass_kg.begin(), mass_kg.end()) * v * v;
}

std::int64_t PlainStepper::n_nodes() const {
  std::int64_t n = 0;
  for (const auto& body : bodies_) n += std::ssize(body.mass_kg);
  return n;
}

double PlainStepper::node_updates_per_step() const {
  double updates = 0;
  for (const auto& body : bodies_)
    for (const auto& level : body.levels) {
      const int steps = plan_.period / level.period;
      for (const auto n : level.nodes)
        if (!body.is_loaded[n]) updates += steps;
    }
  return updates;
}

std::vector<double> PlainStepper::probed_u_m() const {
  return values_at(probes_, [&](std::size_t b) -> const solid::Field& { return bodies_[b].u_m; });
}

std::vector<double> PlainStepper::probed_v_m_per_s() const {
  return values_at(probes_, [&](std::size_t b) -> const solid::Field& { return bodies_[b].v_m_per_s; });
}

std::size_t PlainStepper::snapshot_chunk_bytes() const {
  return n_motion_components * sizeof(double) * static_cast<std::size_t>(n_nodes());
}

std::vector<double> PlainStepper::snapshot_chunk(int /*k*/) const {
  std::vector<double> all;
  for (const bool is_velocity : {false, true})
    for (const auto component : components)
      for (std::size_t b = 0; b < bodies_.size(); ++b) {
        const auto& body = bodies_[b];
        auto field = is_velocity ? body.v_m_per_s : body.u_m;
        for (const auto& level : body.levels)
          if (is_velocity) set_mean_velocities(body, level, field);
        const double sign = component == &solid::Field::y ? sign_of_body(b) : 1;
        for (const double value : field.*component) all.push_back(sign * value);
      }
  return all;
}

}  // namespace slipfront::motion
