// SPDX-License-Identifier: BSD-3-Clause
#include "motion/body.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/error.hpp"
#include "boundary/boundary.hpp"
#include "solid/kernels.hpp"

namespace slipfront::motion {

namespace {

/// Columns of the rows in which w rolls; a mesh without a grid has none.
int rolling_columns(const solid::Operator& op) {
  return op.blocks.empty() ? 0 : op.widest_row();
}

BodySteps steps_of(const BodySource& source, const boundary::Boundary& boundary, double omega,
                   const TimeStepping& time) {
  // The eigenvalues of two stiffnesses together are at most the sum of both largest ones.
  omega =
      std::hypot(omega, boundary::largest_spring_frequency_rad_per_s(source.mesh, source.material, boundary));
  const double stable_s = solid::stable_step_s(omega, source.material.stiffness_damping_s);
  return {stable_s, block_ratios(source.mesh, source.material, boundary, time, stable_s)};
}

BodyMotion motion_of(const BodySource& source) {
  auto boundary = boundary::make_boundary(source.mesh, source.machine);
  boundary::MachineSprings springs(source.mesh, source.material, boundary);
  BodyMotion motion{solid::make_operator(source.mesh, source.material, boundary.edge_sets()),
                    source.material.stiffness_damping_s,
                    solid::Field(source.mesh.n_nodes()),
                    solid::Field(source.mesh.n_nodes()),
                    {},
                    {},
                    {},
                    std::move(boundary),
                    std::move(springs)};
  if (source.part == nullptr) {
    motion.columns = mesh::NodeColumns(source.mesh);
    return motion;
  }
  const auto& part = *source.part;
  motion.columns = mesh::NodeColumns(source.mesh, part.columns, part.n_columns);
  motion.is_own.resize(source.mesh.n_nodes());
  for (int r = 0; r < motion.columns.n_rows(); ++r) {
    const auto nodes = motion.columns.nodes(r, part.own);
    const auto begin = static_cast<int>(nodes.first - motion.columns.row(r).first);
    motion.own.push_back({begin, begin + nodes.count});
    for (auto n = nodes.first; n < nodes.end(); ++n) motion.is_own[n] = true;
  }
  return motion;
}

}  // namespace

BodySteps body_steps(const BodySource& body, const TimeStepping& time) {
  const auto& [mesh, material, part, corners, machine] = body;
  const auto boundary = boundary::make_boundary(mesh, machine);
  const double omega = mesh.is_interface()
                           ? solid::frequency_bound_rad_per_s(mesh, material, corners)
                           : solid::largest_frequency_rad_per_s(
                                 mesh, material, solid::make_operator(mesh, material, boundary.edge_sets()));
  return steps_of(body, boundary, omega, time);
}

std::vector<BodySteps> body_steps(std::span<const BodySource> bodies, std::span<const BodyMotion> motions,
                                  const TimeStepping& time) {
  std::vector<BodySteps> steps;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto& [mesh, material, part, corners, machine] = bodies[b];
    const auto& motion = motions[b];
    steps.push_back(part != nullptr
                        ? part->steps
                        : steps_of(bodies[b], motion.boundary,
                                   solid::largest_frequency_rad_per_s(mesh, material, motion.op), time));
  }
  return steps;
}

std::vector<BodyMotion> motions_of(std::span<const BodySource> bodies) {
  std::vector<BodyMotion> motions;
  for (const auto& body : bodies) motions.push_back(motion_of(body));
  return motions;
}

Body::Body(const BodySource& source, BodyMotion motion, const StepPlan::OfBody& steps,
           const TimeStepping& time, bool lands)
    : motion_(std::move(motion)),
      steps_(steps),
      levels_(make_levels(source.mesh, source.material, motion_, time, steps,
                          source.part == nullptr ? MaxOverSubdomains{} : source.part->largest)),
      finer_w_(rolling_columns(motion_.op)),
      interface_(make_interface_side(source.mesh, motion_.op.mass_kg, motion_)) {
  if (source.part != nullptr) interface_.own = interface_nodes_in(source.part->own);
  interface_.dashpots = std::move(levels_.contact_dashpots);
  if (lands) interface_.landing = Landing(source.mesh, source.material, interface_.nodes, interface_.own);
  // Single precision needs stepping band by band.
  if (time.precision == Precision::single_precision && steps.has_common_step)
    single_ = make_single_rows(levels_.level.front(), motion_.op);
}

solid::Span Body::interface_nodes_in(solid::Span columns) const {
  const auto is_in = [&](mesh::Node n) {
    const int column = motion_.columns.column_of(n);
    return column >= columns.begin && column < columns.end;
  };
  const auto begin = std::ranges::find_if(interface_.nodes, is_in);
  const auto end = std::find_if_not(begin, interface_.nodes.end(), is_in);
  return {static_cast<int>(begin - interface_.nodes.begin()),
          static_cast<int>(end - interface_.nodes.begin())};
}

BodyStep Body::new_step() const {
  const int columns = rolling_columns(motion_.op);
  return {
      solid::RollingRows(columns), solid::RollingRowsOf<float>(has_single_precision() ? columns : 0), {}, {}};
}

void Body::begin(BodyStep& step) {
  step.products = {};
  step.works = {};
  begun_ = &step;
}

std::size_t Body::band_of(mesh::Node n) const {
  const auto& bands = levels_.level.front().bands;
  const auto band = std::ranges::lower_bound(bands, motion_.op.row_of(n), {}, &Band::last_row);
  SLIPFRONT_ASSERT(band != bands.end(), "a node's row is in a band");
  return static_cast<std::size_t>(band - bands.begin());
}

solid::Pair Body::u_in_flight_m(mesh::Node n) const {
  if (!single_.u_x_m.empty()) {
    const auto at = n - motion_.op.rows[single_.first_row].first;
    if (at >= 0 && at < std::ssize(single_.u_x_m)) return {single_.u_x_m[at], single_.u_y_m[at]};
  }
  return {motion_.u_m.x[n], motion_.u_m.y[n]};
}

double Body::step_s(mesh::Node n) const {
  return levels_.is_orphan[n] ? 0 : levels_.level[levels_.level_of_node[n]].step_s;
}

void Body::start(const solid::Field& u_m, const solid::Field& u_per_shear, double top_speed_m_per_s) {
  const bool is_strained = u_m.size() > 0;
  motion_.u_m = is_strained ? u_m : solid::Field(motion_.v_m_per_s.size());
  for (std::size_t n = 0; n < motion_.v_m_per_s.size(); ++n) {
    const double of_top = motion_.op.is_far_edge[n] ? 1 : 0;
    motion_.v_m_per_s.x[n] = top_speed_m_per_s * (is_strained ? u_per_shear.x[n] : of_top);
    motion_.v_m_per_s.y[n] = is_strained ? top_speed_m_per_s * u_per_shear.y[n] : 0;
  }
  for (auto& level : levels_.level)
    if (!level.shared.node.empty()) find_equilibrium_load(level);
  motion_.springs.start(motion_.u_m, top_speed_m_per_s);
  to_single(motion_, single_);
  works_ = {};
  if (motion_.damping_s > 0) begin_damping_work();
}

void Body::find_equilibrium_load(StepLevel& level) {
  // An impulse that is taken back: its kicks on the shared nodes are the level's force on them.
  auto& u = motion_.u_m;
  auto& v = motion_.v_m_per_s;
  auto& shared = level.shared;
  const auto& band = level.bands.front();
  const auto& last = motion_.op.rows[band.last_row];
  const std::size_t n = last.first + last.count;
  const auto first_nodes = [&](const std::vector<double>& field) {
    return std::vector<double>(field.begin(), field.begin() + static_cast<std::ptrdiff_t>(n));
  };
  const std::vector<double> before[] = {first_nodes(u.x), first_nodes(u.y), first_nodes(v.x),
                                        first_nodes(v.y)};
  const auto zero = solid::Field(shared.node.size());
  shared.equilibrium_load_m_per_s2 = shared.v_last_m_per_s = shared.v_mean_before_m_per_s = zero;
  shared.a_m_per_s2 = zero;
  set_motion_before(level, motion_);
  ImpulseProducts products;
  record::Energies works;
  begin_impulse(level, motion_, works);
  apply_band_impulse(level, band, motion_, finer_w_, products, works);
  end_impulse(level, motion_);
  for (std::size_t k = 0; k < shared.node.size(); ++k) {
    shared.equilibrium_load_m_per_s2.x[k] = shared.impulse_m_per_s.x[k] / level.step_s;
    shared.equilibrium_load_m_per_s2.y[k] = shared.impulse_m_per_s.y[k] / level.step_s;
  }
  std::ranges::copy(before[0], u.x.begin());
  std::ranges::copy(before[1], u.y.begin());
  std::ranges::copy(before[2], v.x.begin());
  std::ranges::copy(before[3], v.y.begin());
  shared.impulse_m_per_s = shared.a_m_per_s2 = zero;
  set_motion_before(level, motion_);
}

void Body::begin_damping_work() {
  interface_.landing.clear();
  for (auto& level : levels_.level)
    level.damping_work.begin(stiffness_product_before(level, motion_, level.step_s));
}

void Body::take_landing(const StepLevel& level, ImpulseProducts& products) {
  if (&level != &levels_.level.back()) return;
  interface_.landing.add_to(products);
  interface_.landing.clear();
}

void Body::kick(int k) {
  auto& works = begun_->works;
  for (auto& level : levels_.level) {
    if (k % level.period != 0) continue;
    const bool is_swept = has_common_step() && &level == &levels_.level.front();
    ImpulseProducts of_kick;
    auto& products = is_swept ? begun_->products : of_kick;
    auto& w = is_swept ? begun_->w : finer_w_;
    take_landing(level, products);
    begin_impulse(level, motion_, works);
    for (const auto& band : std::span(level.bands).first(is_swept ? 1 : level.bands.size()))
      apply_band_impulse(level, band, motion_, w, products, works);
    end_impulse(level, motion_);
    if (!is_swept && motion_.damping_s > 0) works.damping_work += level.damping_work.add(products);
  }
}

void Body::move(int k) {
  auto& levels = levels_.level;
  for (std::size_t l = 1; l < levels.size(); ++l)
    if (k % levels[l].period == 0) move_shared(levels[l - 1], motion_, levels[l].step_s, begun_->works);
}

void Body::apply_later_band_impulse(BodyStep& step, std::size_t band) {
  auto& coarsest = levels_.level.front();
  const auto& rows = coarsest.bands[band];
  if (static_cast<int>(band) >= single_.bands.begin && static_cast<int>(band) < single_.bands.end)
    apply_band_impulse(coarsest, rows, motion_, single_, step.w, step.w_single, step.products);
  else if (band > 0)
    apply_band_impulse(coarsest, rows, motion_, step.w, step.products, step.works);
  if (band + 1 == coarsest.bands.size() && motion_.damping_s > 0)
    step.works.damping_work += coarsest.damping_work.add(step.products);
}

void Body::add_to(StateView& state) {
  const auto b = state.bodies.size();
  state.bodies.push_back({&motion_.columns, &motion_.is_own, &levels_.is_orphan});
  const auto add = [&](std::size_t n, const mesh::Node* nodes, std::vector<StateArray> arrays) {
    state.lists.push_back({StateKey::node, b, n, nodes, std::move(arrays)});
  };
  auto& [u_x, u_y] = motion_.u_m;
  auto& [v_x, v_y] = motion_.v_m_per_s;
  add(u_x.size(), nullptr, {u_x, u_y, v_x, v_y});
  for (auto& level : levels_.level) {
    // General rows and own stencils, each ascending.
    const auto n_general = level.stiffness.general.size();
    add(n_general, level.irregular.data(), {level.a_x, level.a_y});
    add(level.irregular.size() - n_general, level.irregular.data() + n_general,
        {level.a_x.data() + n_general, level.a_y.data() + n_general});
    std::vector<StateArray> of_shared;
    for (const auto& [field, is_in_halos] : shared_fields)
      of_shared.insert(of_shared.end(), {(level.shared.*field).x, (level.shared.*field).y});
    add(level.shared.node.size(), level.shared.node.data(), std::move(of_shared));
    add(level.top_rows.size(), level.top_rows.node.data(), {level.top_force_N.x, level.top_force_N.y});
    add(level.edge_nodes.size(), level.edge_nodes.data(),
        {level.edge_kick_m_per_s.x, level.edge_kick_m_per_s.y});
    level.damping_work.add_to(state);
  }
  std::vector<StateArray> of_springs;
  for (auto* values : motion_.springs.arrays()) of_springs.emplace_back(*values);
  add(motion_.springs.nodes().size(), motion_.springs.nodes().data(), std::move(of_springs));
  interface_.landing.add_to(state);
  for (const auto& term : record::energy_terms) state.sums.push_back(&(works_.*term.member));
}

record::Energies Body::energies() {
  record::Energies e = works_;
  e.kinetic = kinetic_energy_J_per_m();
  for (const auto& level : levels_.level) {
    exchange_velocities(level, motion_);
    const auto [u_K_u, v_K_u] = stiffness_products(level, motion_);
    e.strain += 0.5 * (u_K_u - level.step_s * v_K_u);  // 1/2 u K u' between the level's last two places
    e.coupling_work += coupling_work(level, motion_);
    if (motion_.damping_s > 0) {
      ImpulseProducts since_last;
      for (const auto& band : level.bands)
        since_last.next_velocity_K_w += next_velocity_product(level, band, motion_);
      if (&level == &levels_.level.back()) interface_.landing.add_to(since_last);
      e.damping_work += level.damping_work.of_last_push(since_last, u_K_u, v_K_u);
    }
    restore_velocities(level, motion_);
  }
  return e;
}

void Body::reverse(const solid::Field& u_m, boundary::MachineSprings springs, double time_s) {
  motion_.u_m = u_m;
  motion_.springs = std::move(springs);
  motion_.springs.reverse();
  for (auto* values : {&motion_.v_m_per_s.x, &motion_.v_m_per_s.y})
    for (double& value : *values) value = -value;
  for (auto& level : levels_.level) {
    set_motion_before(level, motion_);
    level.shared.a_m_per_s2 = solid::Field(level.shared.node.size());
  }
  to_single(motion_, single_);
  works_ = {};
  works_.time_s = time_s;
  if (motion_.damping_s > 0) begin_damping_work();
}

solid::Field Body::mean_velocity_m_per_s() const {
  solid::Field v;
  for (auto component : {&solid::Field::x, &solid::Field::y})
    append_mean_velocity(component, 0, static_cast<mesh::Node>(motion_.v_m_per_s.size()), v.*component);
  return v;
}

void Body::append_mean_velocity(std::vector<double> solid::Field::*component, mesh::Node first,
                                mesh::Node end, std::vector<double>& to) const {
  const auto& u_m = motion_.u_m.*component;
  const auto& v_m_per_s = motion_.v_m_per_s.*component;
  const auto before = static_cast<std::ptrdiff_t>(to.size());
  to.insert(to.end(), v_m_per_s.begin() + first, v_m_per_s.begin() + end);
  const auto of_first = to.begin() + before;
  for (const auto& level : levels_.level) {
    const auto& s = level.shared;
    for (auto k = static_cast<std::size_t>(std::ranges::lower_bound(s.node, first) - s.node.begin());
         k < s.node.size() && s.node[k] < end; ++k) {
      const auto n = s.node[k];
      of_first[n - first] = (u_m[n] - (s.u_before_m.*component)[k]) / level.step_s;
    }
  }
}

double Body::kinetic_energy_J_per_m() const {
  if (motion_.own.empty()) return solid::kinetic_energy_J_per_m(motion_.op, motion_.v_m_per_s);
  const auto& v = motion_.v_m_per_s;
  double energy = 0;
  for_own_nodes([&](mesh::Node n) { energy += motion_.op.mass_kg[n] * (v.x[n] * v.x[n] + v.y[n] * v.y[n]); });
  return 0.5 * energy;
}

double Body::mass_kg_per_m() const {
  const auto& mass_kg = motion_.op.mass_kg;
  if (motion_.own.empty()) return std::reduce(mass_kg.begin(), mass_kg.end());
  double mass = 0;
  for_own_nodes([&](mesh::Node n) { mass += mass_kg[n]; });
  return mass;
}

double Body::strain_energy_J_per_m() const {
  return solid::strain_energy_J_per_m(motion_.op, motion_.u_m);
}

}  // namespace slipfront::motion
