// SPDX-License-Identifier: BSD-3-Clause
#include "input/relations.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "input/default_rules.hpp"
#include "input/entries.hpp"
#include "solid/operator.hpp"
#include "statics/plate_solver.hpp"

namespace slipfront::input {
namespace {

using interface::EventKind;
using mesh::Sides;
using statics::StaticSolver;

void check_friction(const Case& config) {
  const Message problem = interface::inconsistency(config.friction);
  if (problem.text.empty()) return;
  std::string values;
  for (const Entry& entry : law_of(config).entries)
    if (entry.kind == Kind::number)
      values += fmt::format("{}{} = {}", values.empty() ? "" : ", ", leaf_of(entry.key),
                            toml_text(entry.get(config)));
  throw UserError("friction: {} ({})", problem, values).about("friction.law");
}

/// What a law that never sticks cannot be combined with.
void check_state(const Case& config) {
  if (!config.friction.never_sticks()) return;
  const Key law("friction.law");
  const auto refuse = [&](const Key& key, const char* value, const char* instead) {
    throw UserError("{} = {} asks whether nodes stick, which they never do under {} = {}; choose {}", key,
                    value, law, config.friction.name(), instead)
        .about(law.name);
  };
  if (config.contact == interface::ContactAlgorithm::predictor_corrector)
    refuse(Key("contact.algorithm"), "predictor_corrector", "direct");
  if (config.loading.method == statics::LoadingMethod::ramp)
    refuse(Key("loading.method"), "ramp", "direct or prestress");
  if (const auto start = start_of(config); start.weakens_patch())
    refuse(Key("nucleation.form"), start.weakening_form(), "overstress");
  if (interface::is_at_edge(config.event) && config.trigger.form == interface::TriggerForm::weakened)
    refuse(Key("event.trigger_form"), "weakened", "added or raised");
  if (config.regularisation.relaxed == interface::Relaxed::strength)
    throw UserError(
        "{} = strength acts as pressure under {} = {}, whose coefficient has its own delay; choose pressure "
        "or none",
        Key("friction.regularisation"), law, config.friction.name())
        .about(law.name);
}

/// Two of theta_i, V_i and t decide the third.
void check_initial_state(const Case& config) {
  const auto& law = config.friction;
  const Key theta("friction.theta_i_s"), V("friction.V_i_m_per_s"), t("prestress.t_Pa");
  if (!law.has_parameter(leaf_of(theta.name)) || law.parameter(leaf_of(theta.name)) == 0) return;
  if (is_sequence(config)) return;  // V follows
  if (!is_prestressed(config) || !config.prestress.file.empty())
    throw UserError(
        "{} needs {} = prestress and {}, not a table: elsewhere it follows from t and {}; remove it", theta,
        Key("loading.method"), Key("prestress.p_Pa"), V);
  if (!config.prestress.t_Pa) return;
  const double V_i = law.parameter(leaf_of(V.name));
  auto settled = law;
  set_initial_slip_rate(settled, *config.prestress.t_Pa, config.prestress.p_Pa);
  const double follows = settled.parameter(leaf_of(V.name));
  constexpr double rounding = 1e-6;
  const Range& allowed = find_entry(law_of(config).entries, V.name)->range;
  if (!contains(allowed, follows))
    throw UserError("{} and {} give {} = {:.6g} m/s; it must be {}", theta, t, V, follows,
                    describe(allowed, "m/s"));
  if (std::abs(V_i - follows) > rounding * follows)
    throw UserError("{} and {} give {} = {:.6g} m/s, not {:.6g} m/s; leave one of the three out", theta, t, V,
                    follows, V_i);
}

/// Whether ranks may each have some columns of the bodies while none has all.
bool can_be_held_in_parts(const Case& config) {
  return is_prestressed(config) && mesh::has_equal_elements(config.plate) &&
         (!has_base_body(config) || mesh::has_equal_elements(base_plate(config)));
}

/// How many nodes processes can number that have some of them each follows when they are known.
void check_element_size(const Case& config) {
  constexpr double max_nodes = std::numeric_limits<mesh::Node>::max();
  const auto& plate = config.plate;
  const Key element_size("plate.element_size_m");
  const double h = plate.element_size_m, columns = plate.width_m / h + 1, rows = plate.height_m / h + 1;
  const bool in_parts = can_be_held_in_parts(config);
  if ((in_parts ? std::max(columns, rows) : columns * rows) > max_nodes)
    throw UserError(
        "{} is {:.12g} m; that makes more than {:.3g} nodes{}, choose a larger one{}", element_size, h,
        max_nodes, in_parts ? " in a row or a column" : "",
        is_prestressed(config) ? "" : "; under prescribed tractions several MPI ranks can share more")
        .about("plate.width_m", "plate.height_m");
  const double shorter_m = std::min(plate.width_m, plate.height_m);
  if (h > shorter_m)
    throw UserError("{} is {:.12g} m; it must be at most the plate's shorter side, {:.12g} m", element_size,
                    h, shorter_m)
        .about("plate.width_m", "plate.height_m");
}

void check_shear_speed(const Case& config) {
  const double v = config.loading.shear_speed_m_per_s,
               c_L = solid::longitudinal_speed_m_per_s(config.material);
  if (v >= c_L)
    throw UserError("{} is {:.12g} m/s; it must be less than c_L, {:.4g} m/s",
                    Key("loading.shear_speed_m_per_s"), v, c_L)
        .about("material.youngs_modulus_Pa", "material.density_kg_per_m3");
}

/// What a prescribed state, or the lack of one, asks of the other keys.
void check_prestress(const Case& config, const Document& document) {
  const Key method("loading.method"), kind("event.kind");
  if (!is_prestressed(config)) {
    const bool is_driven = config.loading.method == statics::LoadingMethod::ramp ||
                           config.event == interface::EventKind::spontaneous;
    if (config.loading.shear_speed_m_per_s > 0 || !is_driven) return;
    throw UserError(
        "{} is 0; that holds the top edge still, which a ramp or {} = spontaneous needs to move; choose a "
        "speed greater than 0",
        Key("loading.shear_speed_m_per_s"), kind)
        .about(method.name);
  }
  const Key t("prestress.t_Pa"), p("prestress.p_Pa");
  const bool t_follows = config.friction.has_states();
  const bool uniform = (document.find(t.name) || t_follows) && document.find(p.name);
  if (!uniform && config.prestress.file.empty())
    throw UserError("{} = prestress needs {}, or {}", method,
                    t_follows ? Message("{}", p) : Message("{} and {}", t, p), Key("prestress.file"));
  if (config.plate.corner != mesh::Corner::none)
    throw UserError("{1} = prestress needs {0} = none: the whole lower edge starts in contact",
                    Key("plate.corner"), method);
  if (config.event == EventKind::spontaneous)
    throw UserError(
        "{} = spontaneous raises the shear past the critical one, which {} = prestress does not have; choose "
        "nucleation, left, right or none",
        kind, method);
  if (interface::is_at_edge(config.event) && config.plate.sides == Sides::periodic)
    throw UserError("{} = left and right need an edge, which {} = periodic does not have; choose nucleation",
                    kind, Key("plate.sides"));
}

/// Refuses lists of another length than their places', and places that do not rise.
void check_along(const Key& places_key, const std::vector<double>& places, const char* unit,
                 const Key& values_key, const std::vector<double>& values, const char* one_each) {
  if (places.size() != values.size())
    throw UserError("{} has {} values and {} has {}; give one {}", places_key, places.size(), values_key,
                    values.size(), one_each);
  const auto stop = std::ranges::adjacent_find(places, std::greater_equal<>());
  if (stop != places.end())
    throw UserError("{} must rise: {:.12g} {} comes before {:.12g} {}", places_key, *stop, unit, *(stop + 1),
                    unit);
}

void check_top_pressure(const statics::TopPressure& pressure, double width_m) {
  const auto& [x_m, p_Pa] = pressure;
  const Key places("loading.pressures_x_m"), pressures("loading.pressures_Pa");
  check_along(places, x_m, "m", pressures, p_Pa, "pressure per place");
  if (p_Pa.empty()) return;
  if (x_m.back() > width_m)
    throw UserError("{} reaches {} m, beyond {} = {} m", places, x_m.back(), Key("plate.width_m"), width_m);
  if (pressure.force_N_per_m(width_m) <= 0)
    throw UserError("{} press nothing down; give at least one above 0", pressures);
}

void check_tilt(const Case& config) {
  if (is_prestressed(config)) return;
  const auto& loading = config.loading;
  const auto& plate = config.plate;
  check_top_pressure(loading.top_pressure, plate.width_m);
  const bool by_force = statics::normal_force_N_per_m(loading, plate.width_m).has_value();
  const double tilt_m =
      by_force ? std::abs(loading.tilt_difference_m) : std::max(loading.tilt_left_m, loading.tilt_right_m);
  if (by_force && tilt_m >= plate.height_m)
    throw UserError("{} is {:.12g} m; its magnitude must be less than {}, {:.12g} m",
                    Key("loading.tilt_difference_m"), loading.tilt_difference_m, Key("plate.height_m"),
                    plate.height_m);
  if (tilt_m == 0 && !by_force)
    throw UserError(
        "{} and {:leaf} are both 0: that leaves the plate without contact; increase one of them, or set {} "
        "= prestress",
        Key("loading.tilt_left_m"), Key("loading.tilt_right_m"), Key("loading.method"));
  if (tilt_m >= plate.height_m)
    throw UserError("{} and {:leaf} go up to {:.12g} m; they must be less than {}, {:.12g} m",
                    Key("loading.tilt_left_m"), Key("loading.tilt_right_m"), tilt_m, Key("plate.height_m"),
                    plate.height_m);
  if (loading.edge_margin_m >= 0.5 * plate.width_m)
    throw UserError("{} is {:.12g} m; it must be less than half of {}, {:.12g} m",
                    Key("loading.edge_margin_m"), loading.edge_margin_m, Key("plate.width_m"),
                    0.5 * plate.width_m);
}

void check_trigger_zone(const Case& config) {
  if (interface::is_at_edge(config.event) && config.trigger.zone_m > config.plate.width_m)
    throw UserError("{} is {:.12g} m; it must be at most {}, {:.12g} m", Key("event.trigger_zone_m"),
                    config.trigger.zone_m, Key("plate.width_m"), config.plate.width_m);
}

void check_solver(const Case& config) {
  if (config.loading.solver != StaticSolver::iterative) return;
  const Key solver("loading.solver");
  const auto& plate = config.plate;
  if (plate.coarsenings > 0)
    throw UserError("{} = iterative does not support graded meshes; choose auto or direct, or {} = 0", solver,
                    Key("plate.coarsenings"));
  const bool has_base = has_base_body(config);
  if (has_base && config.base.plate.coarsenings > 0)
    throw UserError("{} = iterative does not support a graded base; choose auto or direct, or {} = 0", solver,
                    Key("base.coarsenings"));
  const double height_m = plate.height_m + (has_base ? config.base.plate.height_m : 0);
  if (!is_prestressed(config) && height_m > 2 * statics::max_iterative_slenderness * plate.width_m)
    throw UserError(
        "{} = iterative does not converge on a plate so much higher than wide; choose auto or direct", solver)
        .about("plate.height_m", "plate.width_m");
}

void check_step(const motion::TimeStepping& time) {
  if (time.step_factor > 1 && !time.allow_unstable)
    throw UserError("{} is {}, beyond the stable step; use at most 1, or set {} = true",
                    Key("time.step_factor"), time.step_factor, Key("time.allow_unstable"));
}

void check_base(const Case& config) {
  if (!has_base_body(config)) return;
  const Key kind("base.kind");
  if ((config.base.plate.sides == Sides::periodic) != (config.plate.sides == Sides::periodic))
    throw UserError("{} and {} must both be periodic, or neither of them", Key("base.sides"),
                    Key("plate.sides"));
  if (config.plate.corner == mesh::Corner::fillet)
    throw UserError("{} = fillet leaves nodes that face none of {} = body; choose none or relief",
                    Key("plate.corner"), kind);
}

/// No default suits them.
void check_keys_to_be_set(const Case& config, const Document& document) {
  for (const Entry& entry : common_entries())
    if (entry.has_to_be_set && entry.only_with->holds(config) && !document.find(entry.key))
      throw UserError("{} needs {}; set it", entry.only_with->setting, Key(entry.key));
}

/// Whether a weakened patch can do nothing, whatever the place; where friction varies, the nodes decide.
bool never_weakens(const Case& config) {
  return !config.friction_along_x.varies() &&
         interface::kinetic_coefficient(config.friction) >= interface::static_coefficient(config.friction);
}

void check_trigger(const Case& config) {
  if (!interface::is_at_edge(config.event)) return;
  if (config.trigger.form == interface::TriggerForm::weakened && never_weakens(config))
    throw UserError(
        "{} = weakened does nothing where the friction law does not weaken, mu_k at least mu_s; choose "
        "added or raised",
        Key("event.trigger_form"))
        .about("event.kind", "friction.law");
}

void check_nucleation(const Case& config) {
  if (config.event != EventKind::nucleation) return;
  const auto& n = config.nucleation;
  const double width_m = config.plate.width_m, reach_m = n.reach_m();
  const Key half_length("nucleation.half_length_m"), taper("nucleation.taper_m"), width("plate.width_m");
  if (n.x_m < 0 || n.x_m > width_m)
    throw UserError("{} is {:.12g} m; it must be on the interface, at 0 to {:.12g} m", Key("nucleation.x_m"),
                    n.x_m, width_m)
        .about(width);
  const bool is_smooth = n.profile == interface::NucleationProfile::smooth;
  if (reach_m <= 0)
    throw UserError("{} 0; give the patch a length", is_smooth
                                                         ? Message("{} is", half_length)
                                                         : Message("{} and {} are both", half_length, taper));
  if (config.plate.sides == Sides::periodic && 2 * reach_m > width_m)
    throw UserError("{} is {:.12g} m; with {} = periodic it must be at most half of {}, {:.12g} m",
                    is_smooth ? Message("{}", half_length) : Message("{} + {:leaf}", half_length, taper),
                    reach_m, Key("plate.sides"), width, 0.5 * width_m);
  if (start_of(config).weakens_patch() && never_weakens(config))
    throw UserError(
        "{} = {} does nothing where the friction law does not weaken, mu_k at least mu_s; choose "
        "overstress",
        Key("nucleation.form"), start_of(config).weakening_form())
        .about("event.kind", "friction.law");
}

void check_friction_along_x(const Case& config) {
  const std::string& chosen = config.friction_along_x.random_key;
  if (chosen == "none") return;
  std::vector<std::string> parameters;
  for (const Entry& entry : law_of(config).entries)
    if (entry.kind == Kind::number) parameters.push_back(leaf_of(entry.key));
  if (std::ranges::find(parameters, chosen) == parameters.end())
    throw UserError("{} is {}; the friction law {} has {}", Key("friction.random_key"), chosen,
                    law_of(config).name, fmt::join(parameters, ", "))
        .about("friction.law");
}

void check_fronts(const FrontSettings& fronts, const mesh::Plate& plate) {
  if (fronts.l_star_m >= plate.width_m)
    throw UserError("{} is {:.12g} m; it must be less than {}, {:.12g} m", Key("fronts.l_star_m"),
                    fronts.l_star_m, Key("plate.width_m"), plate.width_m);
  if (fronts.pulse_share > fronts.crack_share)
    throw UserError("{} is {}; it must be at most {}, {}", Key("fronts.pulse_share"), fronts.pulse_share,
                    Key("fronts.crack_share"), fronts.crack_share);
}

/// The critical shear is that at which t/p reaches mu_s.
void check_cohesion(const Case& config) {
  const Key key("friction.cohesion_Pa");
  if (!is_prestressed(config) && config.friction.cohesion_Pa() > 0)
    throw UserError("{} needs {} = prestress: statics find the shear at which t/p reaches mu_s; remove it",
                    key, Key("loading.method"));
}

void check_regularisation(const interface::Regularisation& relaxation) {
  if (!has_rate(relaxation)) return;
  const Key length("friction.relaxation_length_m");
  if (!std::isfinite(relaxation.length_m) && !std::isfinite(relaxation.time_s))
    throw UserError("{} needs a finite {} or {:leaf}; set one", Key("friction.regularisation"), length,
                    Key("friction.relaxation_time_s"));
  if (relaxation.slip_rate_m_per_s != 0 && !std::isfinite(relaxation.length_m))
    throw UserError("{} does nothing without a finite {}; set that, or remove it",
                    Key("friction.relaxation_slip_rate_m_per_s"), length);
}

void check_snapshot_times(const std::vector<double>& times_s) {
  const auto fall = std::adjacent_find(times_s.begin(), times_s.end(), std::greater_equal<>());
  if (fall != times_s.end())
    throw UserError("{} has {} s before {} s; write the times in ascending order",
                    Key("output.snapshot_times_s"), *fall, *std::next(fall));
}

/// Rounded corners and the like are checked where there is a mesh.
void check_probes(const Case& config) {
  const auto& [x_m, y_m, names, interval_s] = config.probes;
  const Key x("probes.x_m"), y("probes.y_m"), name("probes.names");
  if (x_m.size() != y_m.size())
    throw UserError("{} has {} places and {} has {}; give both the same number of values", x, x_m.size(), y,
                    y_m.size());
  if (!names.empty() && names.size() != x_m.size())
    throw UserError("{} has {} names for {} places; give one name per place, or none", name, names.size(),
                    x_m.size());
  for (auto at = names.begin(); at != names.end(); ++at)
    if (at->empty() || std::find(names.begin(), at, *at) != at)
      throw UserError("{} has the name \"{}\" {}; give each place a name of its own", name, *at,
                      at->empty() ? "" : "twice");
  const double from_m = has_base_body(config) ? -config.base.plate.height_m : 0;
  for (std::size_t k = 0; k < x_m.size(); ++k) {
    if (x_m[k] < 0 || x_m[k] > config.plate.width_m)
      throw UserError("{} has {:.12g} m; it must be in the plate, at 0 to {:.12g} m", x, x_m[k],
                      config.plate.width_m)
          .about("plate.width_m");
    if (y_m[k] < from_m || y_m[k] > config.plate.height_m)
      throw UserError("{} has {:.12g} m; it must be in the {}, at {} to {:.12g} m", y, y_m[k],
                      from_m < 0 ? "two bodies" : "plate", from_m, config.plate.height_m)
          .about("plate.height_m", "base.height_m");
  }
}

/// The values of a number or a list of them.
std::vector<double> numbers_of(const Value& value) {
  if (const auto* number = std::get_if<double>(&value)) return {*number};
  if (const auto* list = std::get_if<std::vector<double>>(&value)) return *list;
  return {};
}

void check_magnitude(const std::string& key, double number) {
  const std::string unit = unit_of(key);
  const Magnitudes& magnitudes = magnitudes_of(unit);
  const double size = std::abs(number);
  if (size == 0 || std::isinf(size) || (size >= magnitudes.least && size <= magnitudes.most)) return;
  throw UserError("{} is {}; its magnitude must be at least {:g} and at most {}", Key(key),
                  with_unit(fmt::format("{}", number), unit), magnitudes.least,
                  with_unit(fmt::format("{:g}", magnitudes.most), unit));
}

/// Refuses numbers of which products or quotients could leave the range of doubles; defaults that follow from
/// others after these.
void check_magnitudes(const Case& config) {
  const auto check = [&](const Entry& entry) {
    for (const double number : numbers_of(entry.get(config))) check_magnitude(entry.key, number);
  };
  for (const Entry& entry : entries_of(config))
    if (default_rule_of(entry.key) == nullptr) check(entry);
  for (const auto& rule : default_rules())
    if (const Entry& entry = entry_of(rule.key); applies(entry, config)) check(entry);
}

/// Refuses more steps than can be taken or counted. The time in which a wave crosses an element tells the
/// step well enough without a mesh; motion::step_plan has the true one.
void check_duration(const Case& config) {
  constexpr double max_steps = 1e12;
  const auto stable_step_s = [&](const solid::Material& material) {
    const double crossing_s = config.plate.element_size_m / solid::longitudinal_speed_m_per_s(material);
    return solid::stable_step_s(2 / crossing_s, material.stiffness_damping_s);
  };
  double step_s = config.time.step_factor * stable_step_s(config.material);
  if (has_base_body(config))
    step_s = std::min(step_s, config.time.step_factor * stable_step_s(base_material(config)));
  const double steps = config.time.end_s / step_s;
  if (steps > max_steps)
    throw UserError("{} = {:g} s takes about {:.3g} steps of {:.3g} s, more than {:g}; choose an earlier end",
                    Key("time.end_s"), config.time.end_s, steps, step_s, max_steps);
}

}  // namespace

void check_pusher(const Case& config) {
  const auto& [from_m, to_m] = config.machine.pusher;
  if (from_m == 0 && to_m == 0) return;
  const Key from("loading.pusher_from_m"), to("loading.pusher_to_m");
  const double h_m = config.plate.element_size_m;
  if (!(from_m >= h_m && to_m >= from_m + h_m && to_m <= config.plate.height_m * (1 + 1e-9)))
    throw UserError(
        "{} = {:g} m and {} = {:g} m must lie an element or more apart, between {:g} m, an element above the "
        "interface, and {} = {:g} m",
        from, from_m, to, to_m, h_m, Key("plate.height_m"), config.plate.height_m);
  if (config.plate.sides != Sides::free)
    throw UserError("{} > 0 pushes at a side, which needs {} = free", to, Key("plate.sides"));
  if (config.plate.corner == mesh::Corner::fillet)
    throw UserError("{} > 0 needs {} other than fillet", to, Key("plate.corner"));
  if (config.loading.solver == statics::StaticSolver::iterative)
    throw UserError("{} > 0 is solved by a factorisation; choose {} = direct or auto", to,
                    Key("loading.solver"));
  if (config.time.precision == motion::Precision::single_precision)
    throw UserError("{} > 0 needs {} = double", to, Key("time.precision"));
}

void check_machine(const Case& config) {
  const auto& machine = config.machine;
  if (machine.mass_kg_per_m2 > 0 && machine.shear_stiffness_Pa_per_m == infinity)
    throw UserError("{} moves behind a spring; set {} as well", Key("loading.mass_kg_per_m2"),
                    Key("loading.shear_stiffness_Pa_per_m"));
  if (machine.is_rigid()) return;
  // Beyond this a spring would set the time step: its frequency on a node of the edge that of the elements.
  const double h_m = config.plate.element_size_m * std::pow(2, config.plate.coarsenings);
  const double most_Pa_per_m = 2 * solid::longitudinal_modulus_Pa(config.material) / h_m;
  const char* const shear = "loading.shear_stiffness_Pa_per_m";
  const char* const normal = "loading.normal_stiffness_Pa_per_m";
  for (const auto& [key, Pa_per_m] :
       {std::pair(shear, machine.shear_stiffness_Pa_per_m), {normal, machine.normal_stiffness_Pa_per_m}})
    if (Pa_per_m != infinity && Pa_per_m > most_Pa_per_m)
      throw UserError(
          "{} = {:g} Pa/m is stiffer than the elements that it moves, {:.3g} Pa/m; leave the key out for "
          "a rigid machine",
          Key(key), Pa_per_m, most_Pa_per_m);
  const Key key(machine.shear_stiffness_Pa_per_m != infinity ? shear : normal);
  if (config.loading.solver == statics::StaticSolver::iterative)
    throw UserError("{} is solved by a factorisation; choose {} = direct or auto", key,
                    Key("loading.solver"));
  if (config.time.precision == motion::Precision::single_precision)
    throw UserError("{} needs {} = double", key, Key("time.precision"));
}

void check_path(const Sequence::Path& path) {
  const auto& [times_s, shears_m] = path;
  const Key times("sequence.times_s"), shears("sequence.shears_m");
  check_along(times, times_s, "s", shears, shears_m, "displacement per time");
  const auto fall = std::ranges::adjacent_find(shears_m, std::greater<>());
  if (fall != shears_m.end())
    throw UserError("{} must not fall: {:.12g} m comes before {:.12g} m", shears, *fall, *(fall + 1));
}

/// What makes the end of an event known, and the places at which its nodes have come to rest.
void check_sequence(const Case& config) {
  if (!is_sequence(config)) return;
  const Key quiet("time.quiet_s"), events("sequence.max_events");
  if (is_slow(config) && config.loading.solver == StaticSolver::iterative)
    throw UserError(
        "{} = iterative does not condense the interface for slow slip between events; choose direct or auto",
        Key("loading.solver"));
  if (is_slow(config) && interface::static_coefficient(config.friction) <= 0)
    throw UserError("{}: the coefficient of steady sliding at {} is {:.4g}; it must be above 0",
                    Key("friction.f0"), Key("friction.V_i_m_per_s"),
                    interface::static_coefficient(config.friction));
  if (is_slow(config) && !interface::follows_pressure(config.regularisation))
    throw UserError(
        "{} = initial_pressure leaves no pressure to slow slip between events; choose none or pressure",
        Key("friction.regularisation"));
  if (config.time.precision == motion::Precision::single_precision)
    throw UserError(
        "{} = single rounds more than the small events of a sequence change; choose double, or {} = 1",
        Key("time.precision"), events);
  check_path(config.sequence.path);
  const double quiet_s = config.time.quiet_s;
  if (!(quiet_s < config.time.end_s))
    throw UserError("{} is {:g} s; with {} > 1 it must be less than {} = {:g} s: each event comes to rest",
                    quiet, quiet_s, events, Key("time.end_s"), config.time.end_s);
  if (const double interval_s = config.output.history_interval_s; interval_s > 0.5 * quiet_s)
    throw UserError(
        "{} is {:g} s; with {} > 1 it must be at most half of {} = {:g} s, so that a row shows each event at "
        "rest",
        Key("output.history_interval_s"), interval_s, events, quiet, quiet_s);
}

void check_each_table(const Case& config) {
  check_friction(config);
  check_element_size(config);
  check_step(config.time);
  check_friction_along_x(config);
  check_regularisation(config.regularisation);
  check_magnitudes(config);
}

void check_relations(const Case& config, const Document& document) {
  check_initial_state(config);
  check_each_table(config);
  check_shear_speed(config);
  check_prestress(config, document);
  check_tilt(config);
  check_trigger_zone(config);
  check_solver(config);
  check_base(config);
  check_keys_to_be_set(config, document);
  check_state(config);
  check_cohesion(config);
  check_trigger(config);
  check_sequence(config);
  check_pusher(config);
  check_machine(config);
  check_nucleation(config);
  check_fronts(config.fronts, config.plate);
  check_snapshot_times(config.output.snapshot_times_s);
  check_probes(config);
  check_duration(config);
}

}  // namespace slipfront::input
