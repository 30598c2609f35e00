// SPDX-License-Identifier: BSD-3-Clause
#include "run/fracture.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "base/caller.hpp"
#include "base/error.hpp"
#include "base/numbers.hpp"
#include "fracture/static_crack.hpp"
#include "input/friction_along_x.hpp"
#include "interface/nucleation.hpp"
#include "motion/trigger_zone.hpp"
#include "run/choices.hpp"
#include "run/outlook.hpp"
#include "run/run.hpp"
#include "statics/condensed_interface.hpp"

namespace slipfront::run {

namespace {

/// Most elements along the interface: with a dense stiffness of the sample, and with kernels.
constexpr double most_of_sample = 500, most_of_half_spaces = 2000;
/// Elements over the height of half-spaces, whose bodies do not matter.
constexpr double rows_of_half_spaces = 32;

/// Whether the sample's edges enter: where its far edges are held.
bool is_held(const input::Case& config) {
  return config.plate.top == mesh::Top::loaded &&
         (!input::has_base_body(config) || config.base.plate.top == mesh::Top::loaded);
}

/// The case in larger elements where it has more than `most` along the interface. Heights become whole
/// multiples.
input::Case in_fewer_elements(input::Case config, double most) {
  auto& plate = config.plate;
  const double columns = std::round(plate.width_m / plate.element_size_m);
  const double h = plate.width_m / std::min(columns, most);
  const auto fit = [&](mesh::Plate& body) {
    const double rows = is_held(config) ? std::max(1.0, std::round(body.height_m / h)) : rows_of_half_spaces;
    body.height_m = rows * h;
    body.coarsenings = 0;
  };
  if (columns <= most && is_held(config)) return config;
  plate.element_size_m = h;
  fit(plate);
  if (input::has_base_body(config)) fit(config.base.plate);
  if (plate.corner != mesh::Corner::none && columns > most) plate.corner = mesh::Corner::none;
  config.time.interface_rows = 1;
  return config;
}

/// Of the sample with its far edges held.
fracture::SlipResponse response_of_sample(const input::Case& config, const InitialState& initial) {
  using statics::Factorisation;
  const auto plate = std::make_shared<const Factorisation>(initial.mesh, config.material,
                                                           statics::constraint_under_shear(initial.mesh));
  std::shared_ptr<const Factorisation> base;
  if (initial.base)
    base = std::make_shared<const Factorisation>(*initial.base, input::base_material(config),
                                                 statics::TopConstraint::both);
  const statics::CondensedInterface interface(plate, base);
  return fracture::response_of_sample(interface.stiffness(), interface_x_m(initial.mesh),
                                      initial.tributary_m);
}

double at(const std::vector<double>& x_m, const std::vector<double>& values, double x) {
  const auto above = std::ranges::upper_bound(x_m, x);
  if (above == x_m.begin()) return values.front();
  if (above == x_m.end()) return values.back();
  const auto k = static_cast<std::size_t>(above - x_m.begin());
  return record::between(values[k - 1], values[k], (x - x_m[k - 1]) / (x_m[k] - x_m[k - 1]));
}

/// At which laws with a state weaken behind a tip.
constexpr double slip_rate_at_tip_m_per_s = 1;

/// Infinite of friction that does not weaken.
double fracture_energy_J_per_m2(const interface::FrictionLaw& law,
                                const std::optional<interface::StateBreakdown>& of_state, double p_Pa) {
  double over_pressure_m = 0;
  if (of_state) {
    over_pressure_m = of_state->energy_over_pressure_m;
  } else {
    const auto slip_m = interface::weakening_slip_m(law);
    if (!slip_m)
      throw UserError("{} = \"{}\" has no fracture energy of its own; give it by {}", Key("friction.law"),
                      law.name(), for_caller("--fracture-energy", "fracture_energy_J_per_m2"));
    over_pressure_m =
        0.5 * *slip_m * (interface::static_coefficient(law) - interface::kinetic_coefficient(law));
  }
  return over_pressure_m > 0 ? over_pressure_m * p_Pa : infinity;
}

/// The friction law of each node.
struct Laws {
  std::vector<interface::FrictionLaw> of_nodes;  ///< empty where all have that of the case
  const interface::FrictionLaw& of_case;

  Laws(const input::Case& config, const std::vector<double>& x_m)
      : of_nodes(input::friction_at(config, x_m)), of_case(config.friction) {}
  const interface::FrictionLaw& operator[](std::size_t k) const {
    return of_nodes.empty() ? of_case : of_nodes[k];
  }
};

/// Fills in what friction does behind a tip.
/// @return the fracture energy, J/m2 [nodes]
std::vector<double> add_friction(const input::Case& config, const Laws& laws, const TipFriction& given,
                                 const record::StaticState& before, fracture::CrackLoads& loads) {
  for (const double c : given.residual_coefficient)
    if (!(c >= 0 && c <= 100))
      throw UserError("{} is {:g}; it must be from 0 to 100",
                      for_caller("--residual-coefficient", "residual_coefficient"), c);
  const bool follows_pressure = interface::follows_pressure(config.regularisation);
  std::vector<double> energies;
  for (std::size_t k = 0; k < before.x_m.size(); ++k) {
    const auto& law = laws[k];
    const double x_m = before.x_m[k], p_Pa = before.p_s_Pa[k];
    const auto of_state = interface::state_breakdown(law, before.t_s_Pa[k], p_Pa, slip_rate_at_tip_m_per_s);
    energies.push_back(given.fracture_energy_J_per_m2.empty()
                           ? fracture_energy_J_per_m2(law, of_state, p_Pa)
                           : at(given.x_m, given.fracture_energy_J_per_m2, x_m));
    const double residual = !given.residual_coefficient.empty()
                                ? at(given.x_m, given.residual_coefficient, x_m)
                            : of_state ? of_state->residual_coefficient
                                       : interface::kinetic_coefficient(law);
    loads.residual_coefficient.push_back(follows_pressure ? residual : 0);
    loads.cohesion_Pa.push_back(law.cohesion_Pa() + (follows_pressure ? 0 : residual * p_Pa));
  }
  return energies;
}

/// Adds the trigger's tractions, where they stay.
void add_trigger(const input::Case& config, const InitialState& initial, std::vector<double>& t_Pa) {
  if (std::isfinite(config.trigger.duration_s)) return;
  const auto loads = loads_of_event(config, initial);
  for (std::size_t k = 0; k < loads.trigger_force_N_per_m.size(); ++k)
    t_Pa[k] += loads.trigger_force_N_per_m[k] / initial.tributary_m[k];
}

struct Patch {
  std::size_t first = 0, last = 0;
};

/// That of the sample, by the linear fall of friction that has its fracture energy.
double nucleation_length_m(const Laws& laws, const fracture::SlipResponse& response,
                           const record::StaticState& before, bool follows_pressure, std::size_t node) {
  std::vector<double> coefficient, weakening_Pa_per_m;
  for (std::size_t k = 0; k < before.x_m.size(); ++k) {
    const auto slip_m = interface::weakening_slip_m(laws[k]);
    if (!slip_m) return nan;
    const double mu_s = interface::static_coefficient(laws[k]);
    coefficient.push_back(follows_pressure ? mu_s : 0);
    weakening_Pa_per_m.push_back((mu_s - interface::kinetic_coefficient(laws[k])) * before.p_s_Pa[k] /
                                 *slip_m);
  }
  return fracture::nucleation_length_m(response, coefficient, weakening_Pa_per_m, node);
}

/// Nodes of the first crack: at a place, the trigger's, or the node that is nearest to its strength.
Patch first_crack(const input::Case& config, const InitialState& initial, const std::optional<double>& x_m) {
  const auto& nodes_x_m = initial.common.tractions.x_m;
  const auto nearest = [&](double x) {
    const auto away = [&](double node_x) { return std::abs(node_x - x); };
    return static_cast<std::size_t>(std::ranges::min_element(nodes_x_m, {}, away) - nodes_x_m.begin());
  };
  if (x_m && !(*x_m >= nodes_x_m.front() && *x_m <= nodes_x_m.back()))
    throw UserError("{} is {:g} m; the interface goes from {:g} to {:g} m", for_caller("--x", "at_x_m"), *x_m,
                    nodes_x_m.front(), nodes_x_m.back());
  if (x_m) return {nearest(*x_m), nearest(*x_m)};
  if (interface::is_at_edge(config.event)) {
    const auto zone = motion::trigger_zone(initial.common, config.event, config.trigger.zone_m);
    if (!zone.empty()) return {zone.front(), zone.back()};
  }
  if (config.event == interface::EventKind::nucleation) {
    const auto& n = config.nucleation;
    if (config.plate.sides == mesh::Sides::periodic &&
        std::abs(n.x_m - 0.5 * config.plate.width_m) + 0.5 * n.length_m() > 0.5 * config.plate.width_m)
      throw UserError(
          "{} = {:g} m puts the patch across the seam of a periodic plate, which counts as its ends; "
          "move it to the middle",
          Key("nucleation.x_m"), n.x_m);
    return {nearest(n.x_m - 0.5 * n.length_m()), nearest(n.x_m + 0.5 * n.length_m())};
  }
  const double peak_x_m = initial.common.peak_x_m;
  return {nearest(peak_x_m), nearest(peak_x_m)};
}

/// What the prediction leaves out.
void add_notes(const input::Case& given, const input::Case& config, const fracture::Bodies& bodies,
               bool by_law, bool has_state_before, FracturePrediction& p) {
  const auto absorbs = [](const mesh::Plate& plate) {
    return plate.sides != mesh::Sides::free && plate.top == mesh::Top::absorbing;
  };
  if (!is_held(config) &&
      !(absorbs(config.plate) && (!input::has_base_body(config) || absorbs(config.base.plate))))
    p.notes.emplace_back(
        "edges are left out, the crack is one between half-spaces: of samples with both far edges held alone "
        "they are taken in");
  if (is_held(config) && config.plate.sides == mesh::Sides::absorbing)
    p.notes.emplace_back("absorbing sides count as free ones");
  if (interface::follows_pressure(config.regularisation) && !stability::are_alike(bodies))
    p.notes.emplace_back("slip changes the pressure, which speeds leave out");
  if (const double factor = config.plate.element_size_m / given.plate.element_size_m; factor > 1.01)
    p.notes.push_back(
        fmt::format("elements are {:.3g} times those of the case, {:.3g} m: what is shorter is smeared",
                    factor, config.plate.element_size_m));
  if (config.plate.sides == mesh::Sides::periodic)
    p.notes.emplace_back("periodic sides count as ends of the contact");
  if (config.friction.has_state() && by_law)
    p.notes.push_back(fmt::format(
        "fracture energy and residual friction are those of slip at {:g} m/s from the state before "
        "the event on",
        slip_rate_at_tip_m_per_s));
  if (input::is_sequence(given) && !has_state_before)
    p.notes.emplace_back("of the first event of the sequence");
  if (given.loading.method == statics::LoadingMethod::ramp)
    p.notes.emplace_back("the state before the event is that of loading.method = direct");
  if (input::has_growing_tractions(config)) p.notes.emplace_back("tractions that grow count as at the start");
}

}  // namespace

bool has_fracture_energy(const input::Case& config) {
  return config.friction.has_state() || interface::weakening_slip_m(config.friction);
}

FrontPredictor::FrontPredictor(const input::Case& given)
    : given_(given),
      config_(in_fewer_elements(given, is_held(given) ? most_of_sample : most_of_half_spaces)) {
  if (config_.loading.method == statics::LoadingMethod::ramp)
    config_.loading.method = statics::LoadingMethod::direct;
  initial_ = make_initial_state(config_, [](auto, auto) { return true; });
  response_ = std::make_shared<const fracture::SlipResponse>(
      is_held(config_)
          ? response_of_sample(config_, initial_)
          : fracture::response_of_half_spaces(bodies_of(config_), initial_.common.tractions.x_m));
}

FracturePrediction FrontPredictor::predict(const TipFriction& friction, const std::optional<double>& x_m,
                                           const record::StaticState* given_before) const {
  const auto bodies = bodies_of(config_);
  auto before = initial_.common.tractions;
  for (std::size_t k = 0; given_before != nullptr && k < before.x_m.size(); ++k) {
    before.t_s_Pa[k] = at(given_before->x_m, given_before->t_s_Pa, before.x_m[k]);
    before.p_s_Pa[k] = at(given_before->x_m, given_before->p_s_Pa, before.x_m[k]);
  }
  const Laws laws(config_, before.x_m);
  FracturePrediction p;
  p.n_nodes = before.x_m.size();
  fracture::CrackLoads loads;
  loads.t_Pa = before.t_s_Pa;
  loads.p_Pa = before.p_s_Pa;
  const auto energies = add_friction(config_, laws, friction, before, loads);
  add_trigger(config_, initial_, loads.t_Pa);
  p.bodies = is_held(config_) ? "the sample, its far edges held" : "half-spaces";
  // To the side to which the load drives the plate.
  double force = 0;
  for (const double t_Pa : loads.t_Pa) force += t_Pa;
  std::optional<fracture::SlipResponse> turned;
  if (force < 0) {
    for (double& t_Pa : loads.t_Pa) t_Pa = -t_Pa;
    turned = *response_;
    turned->p_per_slip *= -1;
  }
  const auto& response = turned ? *turned : *response_;
  const auto patch = first_crack(config_, initial_, x_m);
  p.covers_all = patch.first == 0 && patch.last + 1 == p.n_nodes;
  p.nucleation_length_m =
      nucleation_length_m(laws, response, before, interface::follows_pressure(config_.regularisation),
                          (patch.first + patch.last) / 2);
  p.of_fronts =
      fracture::predict(response, loads, energies, patch.first, patch.last, fracture::SpeedLaw(bodies));
  add_notes(given_, config_, bodies, friction.fracture_energy_J_per_m2.empty(), given_before != nullptr, p);
  if (auto doubt = doubt_of_beginning(config_, initial_.common); given_before == nullptr && !doubt.empty())
    p.notes.push_back(std::move(doubt));
  return p;
}

FracturePrediction predict_fronts(const input::Case& config, const TipFriction& friction,
                                  const std::optional<double>& x_m) {
  return FrontPredictor(config).predict(friction, x_m);
}

std::optional<FracturePrediction> quick_prediction(const input::Case& config) {
  if (!input::is_prestressed(config) || is_held(config) || config.event == interface::EventKind::none ||
      config.plate.sides == mesh::Sides::periodic || !has_fracture_energy(config))
    return {};
  return predict_fronts(config);
}

}  // namespace slipfront::run
