// SPDX-License-Identifier: BSD-3-Clause
#include "motion/stepper.hpp"

#include <algorithm>
#include <utility>

#include "base/error.hpp"
#include "solid/kernels.hpp"

namespace slipfront::motion {

namespace {

/// Bytes of the last cache that may be counted on.
constexpr double cache_bytes = 16e6;
constexpr int most_steps_per_sweep = 16;

/// A mesh that fits into the cache itself gains nothing from several steps in one sweep.
int suitable_steps_per_sweep(const mesh::Grid& grid, int threads) {
  const double motion = 4 * sizeof(double), rolling_rows = 6 * sizeof(double);
  const double rows = grid.rows + 1, columns = grid.stride();
  if (motion * rows * columns < 0.5 * cache_bytes) return 1;
  return std::clamp(static_cast<int>(cache_bytes / ((2 * motion + rolling_rows) * columns * threads)), 1,
                    most_steps_per_sweep);
}

/// Threads that can be at work at a time: each has a group of steps that are a band apart.
int useful_threads(int wanted, std::size_t n_bands, int steps_per_sweep) {
  return std::clamp(static_cast<int>(n_bands) / (steps_per_sweep + 1), 1, wanted);
}

/// Columns of the rows in which w rolls; a mesh without a grid has none.
int rolling_columns(const solid::Operator& op) {
  return op.blocks.empty() ? 0 : op.widest_row();
}

}  // namespace

Stepper::Stepper(const mesh::Mesh& mesh, const solid::Material& material,
                 const interface::ContactModel& contact, const TimeStepping& time, const Execution& execution)
    : plate_{solid::make_operator(mesh, material), material.stiffness_damping_s, solid::Field(mesh.n_nodes()),
             solid::Field(mesh.n_nodes())},
      contact_(contact),
      substeps_(time.interface_substeps),
      finer_w_(rolling_columns(plate_.op)),
      lower_(mesh.lower),
      lower_runs_(runs_of(mesh.lower)),
      tributary_m_(mesh::tributary_lengths_m(mesh)),
      v_x_before_(mesh.lower.size()),
      v_y_before_(mesh.lower.size()),
      v_y_trial_(mesh.lower.size()),
      interface_(mesh.lower.size()),
      trigger_force_N_(mesh.lower.size(), 0.0),
      start_u_(mesh.lower.size()) {
  stable_step_s_ = solid::stable_step_s(solid::largest_frequency_rad_per_s(mesh, material, plate_.op),
                                        material.stiffness_damping_s);
  const auto multiples = step_multiples(mesh, material, time, stable_step_s_);
  multiple_ = multiples.back();
  substeps_ *= multiple_;
  step_s_ = time.step_factor * stable_step_s_ * multiple_;
  levels_ = make_levels(mesh, material, plate_, time, step_s_, multiples);
  if (time.precision == Precision::single_precision)
    single_ = make_single_rows(levels_.level.front(), plate_.op);
  const int depth = execution.steps_per_sweep > 0
                        ? execution.steps_per_sweep
                        : suitable_steps_per_sweep(mesh::blocks(mesh).back(), execution.threads);
  wavefront_ = std::make_unique<threads::Wavefront>(
      useful_threads(execution.threads, levels_.level.front().bands.size(), depth), depth);
  const int columns = rolling_columns(plate_.op);
  const bool has_single = single_.bands.begin < single_.bands.end;
  for (int k = 0; k < wavefront_->most_steps(); ++k)
    under_way_.push_back(
        {solid::RollingRows(columns), solid::RollingRowsOf<float>(has_single ? columns : 0), {}, {}});
  for (std::size_t k = 0; k < lower_.size(); ++k) {
    interface_.initial_gap_m[k] = mesh.y_m[lower_[k]];
    interface_.mass_per_length_kg_m2[k] = plate_.op.mass_kg[lower_[k]] / tributary_m_[k];
    lower_mass_kg_.push_back(plate_.op.mass_kg[lower_[k]]);
  }
  contact_mass_kg_ = lower_mass_kg_;
  for (const auto& dashpot : levels_.contact_dashpots) {
    const auto i = dashpot.at;
    contact_mass_kg_[i] *= 1 + dashpot.d_y;
    interface_.mass_per_length_kg_m2[i] *= 1 + dashpot.d_y;
    interface_.tangential_mass_ratio[i] = (1 + dashpot.d_x) / (1 + dashpot.d_y);
  }
  if (contact.algorithm == interface::ContactAlgorithm::predictor_corrector) {
    lower_rows_ = solid::assemble_rows(mesh, material, lower_);
    landing_shift_m_.assign(mesh.n_nodes(), 0.0);
  }
}

void Stepper::start(const statics::Equilibrium& equilibrium, double top_speed_m_per_s) {
  plate_.u_m = equilibrium.u_m;
  top_speed_ = top_speed_m_per_s;
  for (std::size_t n = 0; n < plate_.v_m_per_s.size(); ++n) {
    plate_.v_m_per_s.x[n] = top_speed_ * equilibrium.u_per_shear.x[n];
    plate_.v_m_per_s.y[n] = top_speed_ * equilibrium.u_per_shear.y[n];
  }
  for (std::size_t k = 0; k < lower_.size(); ++k) {
    start_u_.x[k] = plate_.u_m.x[lower_[k]];
    interface_.slip_rate_m_per_s[k] = plate_.v_m_per_s.x[lower_[k]];
    interface_.v_x_m_per_s[k] = plate_.v_m_per_s.x[lower_[k]];
    interface_.v_y_m_per_s[k] = plate_.v_m_per_s.y[lower_[k]];
    interface_.t_Pa[k] = equilibrium.tractions.t_s_Pa[k];
    interface_.p_Pa[k] = equilibrium.tractions.p_s_Pa[k];
    interface_.slipping[k] = equilibrium.contact[k] == statics::Contact::slip;
  }
  auto& u = plate_.u_m;
  auto& v = plate_.v_m_per_s;
  for (auto& level : levels_.level) {
    // The first look at the forces gives their steady part; it must not move anything.
    auto& shared = level.shared;
    if (shared.node.empty()) continue;
    const auto& band = level.bands.front();
    const auto& last = plate_.op.rows[band.last_row];
    const std::size_t n = last.first + last.count;
    const auto first_nodes = [&](const std::vector<double>& field) {
      return std::vector<double>(field.begin(), field.begin() + static_cast<std::ptrdiff_t>(n));
    };
    const std::vector<double> before[] = {first_nodes(u.x), first_nodes(u.y), first_nodes(v.x),
                                          first_nodes(v.y)};
    const auto zero = solid::Field(shared.node.size());
    shared.steady_m_per_s2 = shared.v_last_m_per_s = shared.v_mean_before_m_per_s = zero;
    shared.a_m_per_s2 = zero;
    set_motion_before(level, plate_);
    PushProducts products;
    record::Energies works;
    begin_push(level, plate_, works);
    push_band(level, band, plate_, finer_w_, products, works);
    end_push(level, plate_);
    for (std::size_t k = 0; k < shared.node.size(); ++k) {
      shared.steady_m_per_s2.x[k] = shared.push_m_per_s.x[k] / level.step_s;
      shared.steady_m_per_s2.y[k] = shared.push_m_per_s.y[k] / level.step_s;
    }
    std::ranges::copy(before[0], u.x.begin());
    std::ranges::copy(before[1], u.y.begin());
    std::ranges::copy(before[2], v.x.begin());
    std::ranges::copy(before[3], v.y.begin());
    shared.push_m_per_s = shared.a_m_per_s2 = zero;
    set_motion_before(level, plate_);
  }
  std::ranges::fill(interface_.intact, 1.0);
  start_contact(contact_, interface_);
  set_trigger({}, std::vector<double>(lower_.size(), 0.0));
  prestress_t_Pa_.clear();
  prestress_p_Pa_.clear();
  to_single(plate_, single_);
  works_ = {};
  step_ = 0;
  if (plate_.damping_s > 0) begin_damping_work();
}

void Stepper::begin_damping_work() {
  landing_K_v_ = landing_K_u_ = 0;
  for (auto& level : levels_.level)
    level.damping_work.begin(stiffness_product_before(level, plate_, level.step_s));
}

void Stepper::set_trigger(const interface::Trigger& trigger, std::vector<double> force_N_per_m) {
  trigger_ = trigger;
  trigger_force_N_ = std::move(force_N_per_m);
  trigger_nodes_.clear();
  for (std::size_t i = 0; i < trigger_force_N_.size(); ++i)
    if (trigger_force_N_[i] != 0) trigger_nodes_.push_back(i);
}

void Stepper::set_prestress(std::vector<double> t0_Pa, std::vector<double> p0_Pa) {
  SLIPFRONT_ASSERT(t0_Pa.size() == lower_.size() && p0_Pa.size() == lower_.size(),
                   "prestress of other nodes");
  prestress_t_Pa_ = std::move(t0_Pa);
  prestress_p_Pa_ = std::move(p0_Pa);
}

void Stepper::set_intact(std::vector<double> intact) {
  SLIPFRONT_ASSERT(intact.size() == lower_.size(), "intact of other nodes");
  interface_.intact = std::move(intact);
}

void Stepper::add_landing(PushProducts& products) const {
  products.shift_K_v = landing_K_v_;
  products.shift_K_u = landing_K_u_;
}

void Stepper::take_landing(const Level& level, PushProducts& products) {
  if (&level != &levels_.level.back()) return;
  add_landing(products);
  landing_K_v_ = landing_K_u_ = 0;
}

void Stepper::push(Level& level, record::Energies& works) {
  PushProducts products;
  take_landing(level, products);
  begin_push(level, plate_, works);
  for (const auto& band : level.bands) push_band(level, band, plate_, finer_w_, products, works);
  end_push(level, plate_);
  if (plate_.damping_s > 0) works.damping_work += level.damping_work.add(products);
}

void Stepper::advance_interface(StepUnderWay& step, int n_substeps, Recorder& recorder,
                                record::History* sample) {
  auto& levels = levels_.level;
  auto& coarsest = levels.front();
  step.products = {};
  step.works = {};
  for (int k = 0; k < n_substeps; ++k) {
    const auto is_due = [&](const Level& level) { return k % level.period == 0; };
    // All forces are those of the places and velocities before the sub-step.
    if (k == 0) {
      take_landing(coarsest, step.products);
      begin_push(coarsest, plate_, step.works);
      push_band(coarsest, coarsest.bands.front(), plate_, step.w, step.products, step.works);
      end_push(coarsest, plate_);
    }
    for (std::size_t l = 1; l < levels.size(); ++l)
      if (is_due(levels[l])) push(levels[l], step.works);
    for (std::size_t l = 1; l < levels.size(); ++l)
      if (is_due(levels[l])) move_shared(levels[l - 1], plate_, levels[l].step_s, step.works);
    take_contact(time_s() + k * substep_s(), recorder, k == 0 ? sample : nullptr, step.works);
  }
}

void Stepper::advance_band(StepUnderWay& step, std::size_t band) {
  auto& coarsest = levels_.level.front();
  const auto& rows = coarsest.bands[band];
  if (static_cast<int>(band) >= single_.bands.begin && static_cast<int>(band) < single_.bands.end)
    push_band(coarsest, rows, plate_, single_, step.w, step.w_single, step.products);
  else if (band > 0)
    push_band(coarsest, rows, plate_, step.w, step.products, step.works);
  if (band + 1 < coarsest.bands.size()) return;
  if (plate_.damping_s > 0) step.works.damping_work += coarsest.damping_work.add(step.products);
  record::add_works(works_, step.works);
}

std::int64_t Stepper::advance(Recorder& recorder, std::int64_t most_steps, const Between& between) {
  const auto n_bands = static_cast<int>(levels_.level.front().bands.size());
  const auto unit = [&](std::int64_t number, int band) {
    auto& step = under_way(number);
    if (band == 0) advance_interface(step, substeps_, recorder, between.sample());
    advance_band(step, static_cast<std::size_t>(band));
    if (band > 0) return true;
    ++step_;
    return between.go_on();
  };
  const auto taken = wavefront_->run(step_, most_steps, n_bands, unit);
  to_double(single_, plate_);
  return taken;
}

void Stepper::advance(Recorder& recorder, record::History* sample) {
  advance(recorder, 1, {.sample = [sample] { return sample; }});
}

record::Energies Stepper::energies() {
  record::Energies e = works_;
  e.time_s = time_s();
  e.kinetic = kinetic_energy_J_per_m();
  for (const auto& level : levels_.level) {
    exchange_velocities(level, plate_);
    const auto [u_K_u, v_K_u] = stiffness_products(level, plate_);
    e.strain += 0.5 * (u_K_u - level.step_s * v_K_u);  // 1/2 u K u' between the level's last two places
    e.coupling_work += coupling_work(level, plate_);
    if (plate_.damping_s > 0) {
      PushProducts since_last;
      for (const auto& band : level.bands) since_last.late_K_w += late_product(level, band, plate_);
      if (&level == &levels_.level.back()) add_landing(since_last);
      e.damping_work += level.damping_work.of_last_push(since_last, u_K_u, v_K_u);
    }
    restore_velocities(level, plate_);
  }
  return e;
}

void Stepper::reverse(Recorder& recorder) {
  // All cells push at the beginning of a step: the motion back begins with the velocities after these pushes,
  // at the places before them. It keeps the steady forces on shared nodes, without which it would be another.
  const auto u = plate_.u_m;
  auto& step = under_way(step_);
  advance_interface(step, 1, recorder, nullptr);
  for (std::size_t band = 0; band < levels_.level.front().bands.size(); ++band) advance_band(step, band);
  to_double(single_, plate_);
  plate_.u_m = u;
  const auto negate = [](std::vector<double>& values) {
    for (double& value : values) value = -value;
  };
  for (auto* v : {&plate_.v_m_per_s.x, &plate_.v_m_per_s.y, &interface_.v_x_m_per_s, &interface_.v_y_m_per_s,
                  &interface_.slip_rate_m_per_s, &interface_.acceleration_m_per_s2})
    negate(*v);
  for (auto& level : levels_.level) {
    set_motion_before(level, plate_);
    level.shared.a_m_per_s2 = solid::Field(level.shared.node.size());
  }
  to_single(plate_, single_);
  works_ = {};
  works_.time_s = time_s();
  if (plate_.damping_s > 0) begin_damping_work();
}

void Stepper::gather_trial(double impulse_s) {
  auto& face = interface_;
  const double dt = substep_s();
  std::swap(face.v_x_m_per_s, v_x_before_);
  std::swap(face.v_y_m_per_s, v_y_before_);
  for (const auto& [at, first, count] : lower_runs_) {
    std::copy_n(&plate_.v_m_per_s.x[first], count, &face.v_x_m_per_s[at]);
    std::copy_n(&plate_.v_m_per_s.y[first], count, &face.v_y_m_per_s[at]);
    std::copy_n(&plate_.u_m.y[first], count, &face.u_y_m[at]);
  }
  for (const auto i : trigger_nodes_)
    face.v_x_m_per_s[i] += impulse_s * trigger_force_N_[i] / lower_mass_kg_[i];
  for (std::size_t i = 0; i < prestress_t_Pa_.size(); ++i) {
    const double per_pressure = dt * tributary_m_[i] / lower_mass_kg_[i];
    face.v_x_m_per_s[i] += per_pressure * prestress_t_Pa_[i];
    face.v_y_m_per_s[i] -= per_pressure * prestress_p_Pa_[i];
  }
  for (const auto& [i, n, d_x, d_y] : levels_.contact_dashpots) {
    // The contact's tractions act on the effective mass m (1 + d).
    face.v_x_m_per_s[i] = (face.v_x_m_per_s[i] - d_x * v_x_before_[i]) / (1 + d_x);
    face.v_y_m_per_s[i] = (face.v_y_m_per_s[i] - d_y * v_y_before_[i]) / (1 + d_y);
  }
  std::ranges::copy(face.v_y_m_per_s, v_y_trial_.begin());
}

void Stepper::move_interface(record::Energies& works) {
  const double dt = substep_s();
  if (contact_.algorithm == interface::ContactAlgorithm::predictor_corrector) {
    for (std::size_t i = 0; i < lower_.size(); ++i) {
      const double shift_m = interface_.u_y_m[i] - plate_.u_m.y[lower_[i]];
      if (shift_m == 0) continue;
      landing_shift_m_[lower_[i]] = shift_m;
      landing_nodes_.push_back(i);
    }
  }
  double contact_work = 0, friction_work = 0;
  for (const auto& run : lower_runs_) {
    const auto at = run.at, count = run.count;
    const auto first = run.first;
    const double* v_x_now = &interface_.v_x_m_per_s[at];
    const double* v_y_now = &interface_.v_y_m_per_s[at];
    const double* u_y_now = &interface_.u_y_m[at];
    const double* t = &interface_.t_Pa[at];
    const double* v_x_before = &v_x_before_[at];
    const double* v_y_before = &v_y_before_[at];
    const double* v_y_trial = &v_y_trial_[at];
    const double* contact_mass = &contact_mass_kg_[at];
    const double* tributary = &tributary_m_[at];
    double* __restrict v_x = &plate_.v_m_per_s.x[first];
    double* __restrict v_y = &plate_.v_m_per_s.y[first];
    double* __restrict u_x = &plate_.u_m.x[first];
    double* __restrict u_y = &plate_.u_m.y[first];
#pragma omp simd reduction(+ : contact_work, friction_work)
    for (std::size_t k = 0; k < count; ++k) {
      // The impulse from the velocities: a landing by projection has no pressure.
      contact_work += 0.5 * contact_mass[k] * (v_y_now[k] - v_y_trial[k]) * (v_y_now[k] + v_y_before[k]);
      friction_work -= 0.5 * dt * tributary[k] * t[k] * (v_x_now[k] + v_x_before[k]);
      v_x[k] = v_x_now[k];
      v_y[k] = v_y_now[k];
      u_x[k] += dt * v_x_now[k];
      u_y[k] = u_y_now[k] + dt * v_y_now[k];
    }
  }
  if (!landing_nodes_.empty()) contact_work += landing_work(dt);
  works.contact_work += contact_work;
  works.friction_work += friction_work;
}

void Stepper::take_contact(double time, Recorder& recorder, record::History* sample,
                           record::Energies& works) {
  const double dt = substep_s();
  const double impulse_s = dt * trigger_factor(trigger_, time);
  gather_trial(impulse_s);
  const bool changed = interface::update_contact(contact_, dt, interface_);
  recorder.observe(time, interface_, changed);
  if (sample != nullptr) append_sample(*sample);
  move_interface(works);
  for (const auto& [i, n, d_x, d_y] : levels_.contact_dashpots) {
    const double mean_x = 0.5 * (interface_.v_x_m_per_s[i] + v_x_before_[i]);
    const double mean_y = 0.5 * (interface_.v_y_m_per_s[i] + v_y_before_[i]);
    works.boundary_work -= 2 * lower_mass_kg_[i] * (d_x * mean_x * mean_x + d_y * mean_y * mean_y);
  }
  for (std::size_t i = 0; i < prestress_t_Pa_.size(); ++i)
    works.prestress_work += 0.5 * dt * tributary_m_[i] *
                            (prestress_t_Pa_[i] * (interface_.v_x_m_per_s[i] + v_x_before_[i]) -
                             prestress_p_Pa_[i] * (interface_.v_y_m_per_s[i] + v_y_before_[i]));
  for (const auto i : trigger_nodes_)
    works.trigger_work +=
        0.5 * impulse_s * trigger_force_N_[i] * (interface_.v_x_m_per_s[i] + v_x_before_[i]);
}

double Stepper::landing_work(double dt_s) {
  // A shift s between the places u, at which this sub-step's forces were taken, and u + s, from which it
  // moves to u'': of the strain energies 1/2 u K u' before and 1/2 u'' K (u + s) after, the kicks' works
  // leave open 1/2 s K (u + u''). All neighbours of the interface have moved by dt v.
  double s_K_u = 0, s_K_v = 0, s_K_s = 0;
  for (const auto i : landing_nodes_) {
    double u = 0, v = 0, s = 0;
    for (auto k = lower_rows_.first[i]; k < lower_rows_.first[i + 1]; ++k) {
      const auto n = lower_rows_.neighbour[k];
      const auto& b = lower_rows_.block[k];
      u += b[2] * plate_.u_m.x[n] + b[3] * plate_.u_m.y[n];
      v += b[2] * plate_.v_m_per_s.x[n] + b[3] * plate_.v_m_per_s.y[n];
      s += b[3] * landing_shift_m_[n];
    }
    const double shift_m = landing_shift_m_[lower_[i]];
    s_K_u += shift_m * u;
    s_K_v += shift_m * v;
    s_K_s += shift_m * s;
  }
  for (const auto i : landing_nodes_) landing_shift_m_[lower_[i]] = 0;
  landing_nodes_.clear();
  landing_K_v_ = s_K_v;
  landing_K_u_ = 2 * s_K_u - s_K_s;
  return 0.5 * (2 * s_K_u - dt_s * s_K_v - s_K_s);
}

void Stepper::append_sample(record::History& history) const {
  history.time_s.push_back(time_s());
  for (std::size_t i = 0; i < lower_.size(); ++i)
    history.slip_m.push_back(plate_.u_m.x[lower_[i]] - start_u_.x[i]);
  const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  append(history.slip_rate_m_per_s, interface_.slip_rate_m_per_s);
  append(history.t_Pa, interface_.t_Pa);
  append(history.p_Pa, interface_.p_Pa);
}

solid::Field Stepper::mean_velocity_m_per_s() const {
  solid::Field v = plate_.v_m_per_s;
  for (const auto& level : levels_.level) {
    const auto& s = level.shared;
    for (std::size_t k = 0; k < s.node.size(); ++k) {
      const auto n = s.node[k];
      v.x[n] = (plate_.u_m.x[n] - s.u_before_m.x[k]) / level.step_s;
      v.y[n] = (plate_.u_m.y[n] - s.u_before_m.y[k]) / level.step_s;
    }
  }
  return v;
}

double Stepper::kinetic_energy_J_per_m() const {
  return solid::kinetic_energy_J_per_m(plate_.op, plate_.v_m_per_s);
}

double Stepper::energy_J_per_m() const {
  return solid::strain_energy_J_per_m(plate_.op, plate_.u_m) + kinetic_energy_J_per_m();
}

}  // namespace slipfront::motion
