// SPDX-License-Identifier: BSD-3-Clause
#include "motion/stepper.hpp"

#include <algorithm>
#include <utility>

#include "base/error.hpp"
#include "base/interruption.hpp"
#include "motion/orientation.hpp"
#include "motion/step.hpp"

namespace slipfront::motion {

namespace {

/// Bytes of the last cache that may be counted on.
constexpr double cache_bytes = 16e6;
constexpr int max_steps_per_sweep = 16;
/// Steps of so many sub-steps are not waited for where the run is to end.
constexpr int substeps_between_looks = 1000;

/// A mesh that fits into the cache itself gains nothing from several steps in one sweep, but what is on its
/// way from one call to the next has most time in a single sweep.
int suitable_steps_per_sweep(const mesh::Grid& grid, const Execution& execution) {
  const double motion = 4 * sizeof(double), rolling_rows = 6 * sizeof(double);
  const double rows = grid.rows + 1, columns = grid.stride();
  if (execution.max_steps == 0 && motion * rows * columns < 0.5 * cache_bytes) return 1;
  const double sweep = cache_bytes / ((2 * motion + rolling_rows) * columns * execution.threads);
  return std::clamp(static_cast<int>(sweep), 1, max_steps_per_sweep);
}

/// Threads that can be at work at a time: each has a group of steps that are a band apart.
int useful_threads(int wanted, std::size_t n_bands, int steps_per_sweep) {
  return std::clamp(static_cast<int>(n_bands) / (steps_per_sweep + 1), 1, wanted);
}

std::vector<Body> make_bodies(std::span<const BodySource> sources, std::vector<BodyMotion> motions,
                              const StepPlan& plan, const TimeStepping& time, bool lands) {
  std::vector<Body> bodies;
  for (std::size_t b = 0; b < sources.size(); ++b)
    bodies.emplace_back(sources[b], std::move(motions[b]), plan.bodies[b], time, lands);
  return bodies;
}

}  // namespace

Stepper::Stepper(const mesh::Mesh& mesh, const solid::Material& material,
                 const interface::ContactModel& contact, const TimeStepping& time, const Execution& execution)
    : Stepper(std::vector<BodySource>{{mesh, material}}, contact, time, execution) {}

Stepper::Stepper(const BodySource& above, const BodySource& below, const interface::ContactModel& contact,
                 const TimeStepping& time, const Execution& execution)
    : Stepper(std::vector<BodySource>{above, below}, contact, time, execution) {}

Stepper::Stepper(std::span<const BodySource> sources, const interface::ContactModel& contact,
                 const TimeStepping& time, const Execution& execution)
    : Stepper(sources, contact, time, execution, motions_of(sources)) {}

Stepper::Stepper(std::span<const BodySource> sources, const interface::ContactModel& contact,
                 const TimeStepping& time, const Execution& execution, std::vector<BodyMotion> motions)
    : plan_(step_plan(body_steps(sources, motions, time), time)),
      bodies_(make_bodies(sources, std::move(motions), plan_, time,
                          contact.algorithm == interface::ContactAlgorithm::predictor_corrector)),
      coupling_(contact, contacts_of(bodies_)) {
  for (const auto& body : bodies_)
    if (body.has_common_step()) n_bands_ = std::max(n_bands_, static_cast<int>(body.n_bands()));
  int steps_per_sweep = execution.steps_per_sweep > 0
                            ? execution.steps_per_sweep
                            : suitable_steps_per_sweep(mesh::blocks(sources.front().mesh).back(), execution);
  if (execution.max_steps > 0)
    steps_per_sweep =
        std::min(steps_per_sweep, (execution.max_steps + execution.threads - 1) / execution.threads);
  wavefront_ = std::make_unique<threads::Wavefront>(
      useful_threads(execution.threads, static_cast<std::size_t>(n_bands_), steps_per_sweep),
      steps_per_sweep);
  for (int k = 0; k < wavefront_->max_steps(); ++k)
    for (auto& of_bodies = steps_in_flight_.emplace_back(); const auto& body : bodies_)
      of_bodies.push_back(body.new_step());
}

double Stepper::node_updates_per_step() const {
  double sum = 0;
  for (const auto& body : bodies_) {
    const int steps = plan_.period / body.period();
    sum += body.levels().node_updates_per_step * steps;
  }
  return sum;
}

void Stepper::start(const statics::Equilibrium& equilibrium, double top_speed_m_per_s, Loads loads) {
  bodies_.front().start(equilibrium.u_m, equilibrium.u_per_shear, top_speed_m_per_s);
  if (bodies_.size() > 1)
    bodies_.back().start(equilibrium.below_u_m, equilibrium.below_u_per_shear,
                         equilibrium.below_u_m.size() > 0 ? top_speed_m_per_s : 0);
  coupling_.start(equilibrium, std::move(loads));
  step_ = 0;
}

void Stepper::advance_interface(std::int64_t step, int n_substeps, StepObserver& observer,
                                record::History* sample) {
  auto& of_bodies = in_flight(step);
  for (std::size_t b = 0; b < bodies_.size(); ++b) bodies_[b].begin(of_bodies[b]);
  take_step(std::span(bodies_), n_substeps, [&](int k) {
    if ((k + 1) % substeps_between_looks == 0) require_no_interruption("interrupted within a step");
    coupling_.update(time_s() + k * substep_s(), substep_s(), observer, k == 0 ? sample : nullptr,
                     of_bodies.front().works);
  });
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    if (!bodies_[b].has_common_step()) bodies_[b].complete(of_bodies[b]);
}

void Stepper::advance_band(std::int64_t step, std::size_t band) {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    auto& body = bodies_[b];
    auto& of_body = in_flight(step)[b];
    if (!body.has_common_step() || band >= body.n_bands()) continue;
    body.apply_later_band_impulse(of_body, band);
    if (band + 1 == body.n_bands()) body.complete(of_body);
  }
}

StateView Stepper::state(const mesh::Subset& interface_nodes) {
  StateView state;
  state.interface_nodes = interface_nodes;
  for (auto& body : bodies_) body.add_to(state);
  coupling_.add_to(state);
  return state;
}

void Stepper::set_probes(std::vector<Probe> probes) {
  probes_ = std::move(probes);
  probed_nodes_.clear();
  if (probes_.empty()) return;
  probed_nodes_.resize(static_cast<std::size_t>(n_bands_));
  for (std::size_t p = 0; p < probes_.size(); ++p)
    for (std::size_t a = 0; a < 4; ++a) {
      const auto b = probes_[p].body;
      const auto node = static_cast<mesh::Node>(probes_[p].node[a]);
      probed_nodes_[bodies_[b].has_common_step() ? bodies_[b].band_of(node) : 0].push_back(
          {b, node, 8 * p + 2 * a});
    }
}

void Stepper::store_probed(std::int64_t step, std::size_t band, StepObserver& observer) const {
  if (probed_nodes_[band].empty()) return;
  double* to = observer.displacements(step);
  if (to == nullptr) return;
  for (const auto& [body, node, at] : probed_nodes_[band]) {
    const auto u_m = bodies_[body].u_in_flight_m(node);
    to[at] = u_m.x;
    to[at + 1] = u_m.y;
  }
}

std::vector<double> Stepper::probed_u_m() const {
  return values_at(probes_, [&](std::size_t b) -> const solid::Field& { return bodies_[b].u_m(); });
}

std::vector<double> Stepper::probed_v_m_per_s() const {
  return values_at(probes_, [&](std::size_t b) -> const solid::Field& { return bodies_[b].v_m_per_s(); });
}

std::int64_t Stepper::advance(SlipObserver& observer, std::int64_t max_steps) {
  return advance(static_cast<StepObserver&>(observer), max_steps);
}

std::int64_t Stepper::advance(StepObserver& observer, std::int64_t max_steps,
                              const BandCallbacks& band_callbacks) {
  const auto first = step_, last = first + max_steps - 1;
  const auto is_in_calling_thread = [&](std::int64_t number) {
    return (number - first) / wavefront_->steps_per_sweep() % wavefront_->threads() == 0;
  };
  const auto unit = [&](std::int64_t number, int band) {
    if (band_callbacks.before && is_in_calling_thread(number)) band_callbacks.before(number - first, band);
    if (band == 0) advance_interface(number, plan_.period, observer, observer.row());
    advance_band(number, static_cast<std::size_t>(band));
    if (!probed_nodes_.empty()) store_probed(number + 1, static_cast<std::size_t>(band), observer);
    if (number == last && band_callbacks.after_last) band_callbacks.after_last(band);
    if (band > 0) return true;
    ++step_;
    return observer.after_step(coupling_.slip_rates()) && !observer.is_interrupted();
  };
  const auto taken = wavefront_->run(step_, max_steps, n_bands_, unit);
  SLIPFRONT_ASSERT(!band_callbacks.after_last || taken == max_steps, "all steps are taken");
  sync_to_double();
  return taken;
}

void Stepper::reverse(StepObserver& observer) {
  // All cells kick at the beginning of a step: the motion back begins with the velocities after these
  // impulses, at the places before them. It keeps the steady forces on shared nodes, without which it would
  // be another.
  std::vector<solid::Field> u;
  std::vector<boundary::MachineSprings> springs;
  for (const auto& body : bodies_) {
    u.push_back(body.u_m());
    springs.push_back(body.springs());
  }
  advance_interface(step_, 1, observer, nullptr);
  for (int band = 0; band < n_bands_; ++band) advance_band(step_, static_cast<std::size_t>(band));
  coupling_.reverse();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    bodies_[b].sync_to_double();
    bodies_[b].reverse(u[b], springs[b], time_s());
  }
}

std::int64_t Stepper::n_nodes() const {
  std::int64_t n = 0;
  for (const auto& body : bodies_) n += std::ssize(body.u_m().x);
  return n;
}

double Stepper::mass_kg_per_m() const {
  double mass = 0;
  for (const auto& body : bodies_) mass += body.mass_kg_per_m();
  return mass;
}

double Stepper::energy_of_tractions_J_per_m() const {
  const double v = plan_.stable_step_s * coupling_.largest_acceleration_m_per_s2();
  return 0.5 * bodies_.front().mass_kg_per_m() * v * v;
}

std::size_t Stepper::snapshot_chunk_bytes() const {
  return n_motion_components * sizeof(double) * static_cast<std::size_t>(n_nodes());
}

std::vector<double> Stepper::snapshot_chunk(int /*k*/) const {
  std::vector<double> all;
  all.reserve(snapshot_chunk_bytes() / sizeof(double));
  for (int component = 0; component < n_motion_components; ++component)
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      append(MotionComponent{component}, b, 0, static_cast<mesh::Node>(bodies_[b].u_m().size()), all);
  return all;
}

void Stepper::append(MotionComponent component, std::size_t body, mesh::Node first, mesh::Node end,
                     std::vector<double>& to) const {
  using enum MotionComponent;
  const auto& of_body = bodies_[body];
  const bool is_y = component == u_y || component == v_y;
  const auto along = is_y ? &solid::Field::y : &solid::Field::x;
  const auto before = static_cast<std::ptrdiff_t>(to.size());
  if (component == u_x || component == u_y) {
    const auto& u_m = of_body.u_m().*along;
    to.insert(to.end(), u_m.begin() + first, u_m.begin() + end);
  } else {
    of_body.append_mean_velocity(along, first, end, to);
  }
  if (is_y) std::for_each(to.begin() + before, to.end(), [&](double& value) { value *= sign_of_body(body); });
}

record::Energies Stepper::energies() {
  auto sum = bodies_.front().energies();
  for (auto& body : std::span(bodies_).subspan(1)) add_terms(sum, body.energies());
  sum.time_s = time_s();
  return sum;
}

double Stepper::kinetic_energy_J_per_m() const {
  double sum = 0;
  for (const auto& body : bodies_) sum += body.kinetic_energy_J_per_m();
  return sum;
}

double Stepper::energy_J_per_m() const {
  double strain = 0;
  for (const auto& body : bodies_) strain += body.strain_energy_J_per_m();
  return strain + kinetic_energy_J_per_m();
}

}  // namespace slipfront::motion
