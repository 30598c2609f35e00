// SPDX-License-Identifier: BSD-3-Clause
#include "statics/statics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "boundary/boundary.hpp"
#include "statics/load_case.hpp"

namespace slipfront::statics {

bool is_possible(const Equilibrium& state, const std::vector<double>& x_m, std::size_t n_nodes,
                 std::size_t n_below) {
  const auto are_finite = [](const std::vector<double>& values) {
    return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
  };
  const auto is_field_of = [&](std::size_t n) {
    return [&are_finite, n](const solid::Field& u) {
      return (u.x.empty() || u.x.size() == n) && u.y.size() == u.x.size() && are_finite(u.x) &&
             are_finite(u.y);
    };
  };
  const auto is_of_plate = is_field_of(n_nodes), is_of_base = is_field_of(n_below);
  const auto& s = state.tractions;
  return state.contact.size() == x_m.size() && std::ranges::max(state.contact) <= Contact::open &&
         s.x_m == x_m && s.t_s_Pa.size() == x_m.size() && s.p_s_Pa.size() == x_m.size() &&
         are_finite(s.t_s_Pa) && are_finite(s.p_s_Pa) &&
         are_finite(
             {state.shear_m, state.peak_ratio, state.peak_x_m, state.inside_from_m, state.inside_to_m}) &&
         is_of_plate(state.u_m) && is_of_plate(state.u_per_shear) && is_of_base(state.below_u_m) &&
         is_of_base(state.below_u_per_shear);
}

bool is_nearer_to_slip(double ratio, double mu_s, double other_ratio, double other_mu_s) {
  if (mu_s == other_mu_s) return ratio > other_ratio;
  return ratio * other_mu_s > other_ratio * mu_s;
}

ContactForce contact_force(std::span<const double> p_Pa, std::span<const double> t_Pa,
                           std::span<const double> tributary_m) {
  ContactForce force;
  for (std::size_t k = 0; k < tributary_m.size(); ++k) {
    force.normal_N_per_m += p_Pa[k] * tributary_m[k];
    force.shear_N_per_m += t_Pa[k] * tributary_m[k];
  }
  return force;
}

ContactForce contact_force(const Equilibrium& state, std::span<const double> tributary_m) {
  return contact_force(state.tractions.p_s_Pa, state.tractions.t_s_Pa, tributary_m);
}

namespace {

/// The interface of one level of the solver. [nodes]
struct InterfaceNodes {
  std::vector<double> x_m, gap_m, tributary_m;
};

template <class T>
std::vector<T> at_places(const std::vector<T>& all, const std::vector<std::size_t>& places) {
  std::vector<T> some;
  for (const auto place : places) some.push_back(all[place]);
  return some;
}

InterfaceNodes interface_nodes(const mesh::Mesh& mesh, const mesh::Mesh* base,
                               const std::vector<std::size_t>& places) {
  InterfaceNodes nodes{
      {}, at_places(gaps_m(mesh, base), places), at_places(mesh::tributary_lengths_m(mesh), places)};
  for (const auto place : places) nodes.x_m.push_back(mesh.x_m[mesh.interface_nodes[place]]);
  return nodes;
}

ContactStates at_places(const ContactStates& all, const std::vector<std::size_t>& places) {
  const auto& s = all.support;
  SLIPFRONT_ASSERT(s.anchor_x_per_shear.empty(), "nodes that move on are solved for directly");
  return {{at_places(s.contact, places), at_places(s.slip_sign, places), at_places(s.anchor_x_m, places),
           at_places(s.mu_s, places)},
          at_places(all.has_touched, places)};
}

/// Gives each node the contact state of the coarse node nearest to it along the interface.
void take_nearest(const ContactStates& coarse, const std::vector<std::size_t>& coarse_places,
                  const std::vector<std::size_t>& places, ContactStates& states) {
  std::size_t c = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    while (c + 1 < coarse_places.size() && 2 * places[k] > coarse_places[c] + coarse_places[c + 1]) ++c;
    states.support.contact[k] = coarse.support.contact[c];
    states.support.slip_sign[k] = coarse.support.slip_sign[c];
    states.has_touched[k] |= coarse.support.contact[c] != Contact::open;
  }
}

/// Contact states of the interface, and the linear equilibrium they make. Displacements are those relative to
/// what the plate stands on.
class ContactProblem {
 public:
  ContactProblem(InterfaceNodes interface_nodes, LoadCase& plate, ContactStates start)
      : nodes(std::move(interface_nodes)),
        states(std::move(start)),
        contact(states.support.contact),
        plate_(plate),
        n_(nodes.x_m.size()) {}

  void solve(double accuracy) { plate_.solve(states.support, accuracy); }

  double gap_m(std::size_t k) const { return nodes.gap_m[k]; }
  double u_x_m(std::size_t k, double shear) const { return plate_.u0(2 * k) + shear * plate_.u1(2 * k); }
  double u_y_m(std::size_t k, double shear) const {
    return plate_.u0(2 * k + 1) + shear * plate_.u1(2 * k + 1);
  }
  double t_Pa(std::size_t k, double shear) const {
    return -(plate_.f0(2 * k) + shear * plate_.f1(2 * k)) / nodes.tributary_m[k];
  }
  double p_Pa(std::size_t k, double shear) const {
    return (plate_.f0(2 * k + 1) + shear * plate_.f1(2 * k + 1)) / nodes.tributary_m[k];
  }

  using Traction = double (ContactProblem::*)(std::size_t k, double shear) const;
  /// The shear at which a traction adds up to a force with the states as they are; infinite where the force
  /// does not grow with it.
  double shear_at(Traction traction, double force_N_per_m) const {
    double at_0 = 0, at_1 = 0;
    for (std::size_t k = 0; k < n_; ++k) {
      if (contact[k] == Contact::open) continue;
      at_0 += (this->*traction)(k, 0) * nodes.tributary_m[k];
      at_1 += (this->*traction)(k, 1) * nodes.tributary_m[k];
    }
    const double growth = at_1 - at_0;
    return growth > 0 ? (force_N_per_m - at_0) / growth : infinity;
  }

  /// Corrects the states that the solution at `shear` contradicts; `may_slip(k)`: whether node k may pass
  /// mu_s. With `one_only` just the worst contradiction is corrected, against cycles. Returns whether
  /// anything changed.
  template <class MaySlip>
  bool correct(double shear, bool one_only, double tolerance, MaySlip&& may_slip) {
    auto& slip_sign = states.support.slip_sign;
    const auto& anchor_x_m = states.support.anchor_x_m;
    const auto& mu_s = states.support.mu_s;
    auto& has_touched = states.has_touched;
    double p_max = 0;
    for (std::size_t k = 0; k < n_; ++k) p_max = std::max(p_max, std::abs(p_Pa(k, shear)));
    struct Change {
      std::size_t node;
      Contact to;
      double sign, severity;
    };
    std::vector<Change> changes;
    const double u_scale = std::max(plate_.u0.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
    for (std::size_t k = 0; k < n_; ++k) {
      const double t = t_Pa(k, shear), p = p_Pa(k, shear);
      if (contact[k] == Contact::open) {
        const double depth = -(gap_m(k) + u_y_m(k, shear));
        if (depth <= tolerance * u_scale) continue;
        // A node that was released comes back at another place than it left: it slips. A new one sticks.
        const double moved = u_x_m(k, shear) - anchor_x_m[k];
        if (has_touched[k] != 0)
          changes.push_back({k, Contact::slip, moved > 0 ? 1.0 : -1.0, depth / u_scale});
        if (has_touched[k] == 0) changes.push_back({k, Contact::stick, 0, depth / u_scale});
      } else if (p < -tolerance * p_max) {
        changes.push_back({k, Contact::open, 0, -p / p_max});
      } else if (contact[k] == Contact::stick) {
        const double excess = std::abs(t) - mu_s[k] * p;
        if (excess > tolerance * p_max && may_slip(k))
          changes.push_back({k, Contact::slip, t > 0 ? 1.0 : -1.0, excess / p_max});
      } else {
        const double backward = -slip_sign[k] * (u_x_m(k, shear) - anchor_x_m[k]);
        if (backward > tolerance * u_scale) changes.push_back({k, Contact::stick, 0, backward / u_scale});
      }
    }
    if (one_only && changes.size() > 1)
      changes = {*std::ranges::max_element(changes, {}, [](const Change& c) { return c.severity; })};
    for (const auto& change : changes) {
      contact[change.node] = change.to;
      has_touched[change.node] |= change.to != Contact::open;
      slip_sign[change.node] = change.sign;
    }
    return !changes.empty();
  }

  /// Lets nodes stick that slip where they may not, each once. Returns whether there were any.
  template <class MaySlip>
  bool stick_again(MaySlip&& may_slip) {
    bool any = false;
    stuck_again_.resize(n_);
    for (std::size_t k = 0; k < n_; ++k) {
      if (contact[k] != Contact::slip || may_slip(k) || stuck_again_[k]) continue;
      contact[k] = Contact::stick;
      states.support.slip_sign[k] = 0;
      any = stuck_again_[k] = true;
    }
    return any;
  }

  const InterfaceNodes nodes;
  ContactStates states;
  std::vector<Contact>& contact;

 private:
  std::vector<bool> stuck_again_;
  LoadCase& plate_;
  std::size_t n_;
};

constexpr int max_iterations = 400;
constexpr int iterations_at_once = 40;  ///< then one contradiction at a time

/// Error in the energy norm of the first iterative solution, its decrease from one change of contact to the
/// next, and the error with which the final contact states are confirmed.
constexpr double first_accuracy = 1e-3, accuracy_decrease = 0.5, final_accuracy = 1e-10;
/// Accuracy with which coarse levels end and the finest then begins.
constexpr double guess_accuracy = 2e-4;
/// Contradictions of a contact state that count, over the largest pressure or displacement.
constexpr double state_tolerance = 1e-9;

/// The keys that press the bodies together.
Message keys_of_tilt(const Loading& loading) {
  const Key difference("loading.tilt_difference_m");
  if (loading.mean_pressure_Pa) return Message("{} or {}", Key("loading.mean_pressure_Pa"), difference);
  if (loading.top_pressure.is_there()) return Message("{}", Key("loading.pressures_Pa"));
  if (loading.normal_force_N_per_m)
    return Message("{} or {}", Key("loading.normal_force_N_per_m"), difference);
  return Message("{} or {}", Key("loading.tilt_left_m"), Key("loading.tilt_right_m"));
}

[[noreturn]] void contact_does_not_settle(const Loading& loading) {
  throw UserError(
      "the static contact iteration does not converge: contact opens nearly everywhere, or a tall plate "
      "tips; "
      "change {}, {}, {}, or {}",
      keys_of_tilt(loading), Key("plate.height_m"), Key("loading.edge_margin_m"), Key("plate.corner"));
}

/// Solves and corrects the contact states until nothing changes; `find_shear()` is called after each
/// solution. An iterative solution is only made as accurate as the states at that point deserve.
/// @return the shear.
template <class FindShear, class MaySlip>
double settle(ContactProblem& problem, const Loading& loading, double accuracy, double final,
              FindShear&& find_shear, MaySlip&& may_slip, const Statics::MayContinue& may_continue) {
  for (int iteration = 1; iteration <= max_iterations; ++iteration) {
    if (!may_continue()) throw Interrupted(interrupted_in_statics);
    problem.solve(accuracy);
    const double shear = find_shear();
    const bool is_final = accuracy <= final;
    const bool changed = problem.correct(shear, iteration > iterations_at_once,
                                         accuracy > final_accuracy ? accuracy : state_tolerance, may_slip);
    if (!changed && is_final) return shear;
    if (!changed) {
      accuracy = final;
    } else {
      accuracy = is_final ? std::max(guess_accuracy, final) : std::max(accuracy_decrease * accuracy, final);
    }
  }
  contact_does_not_settle(loading);
}

/// First and last coordinate of the contact, less the margin at each end.
struct Inside {
  double from_m, to_m;
  bool contains(double x) const { return x >= from_m && x <= to_m; }
};

Inside inside_contact(const ContactProblem& problem, double margin_m) {
  double first = infinity, last = -first;
  for (std::size_t k = 0; k < problem.contact.size(); ++k) {
    if (problem.contact[k] == Contact::open) continue;
    first = std::min(first, problem.nodes.x_m[k]);
    last = std::max(last, problem.nodes.x_m[k]);
  }
  return {first + margin_m, last - margin_m};
}

/// Interface nodes' displacement along x, relative to that of a base. [interface nodes]
std::vector<double> relative_u_x_m(const mesh::Mesh& mesh, const mesh::Mesh* base, const Equilibrium& state) {
  std::vector<double> u_x_m;
  for (const auto n : mesh.interface_nodes) u_x_m.push_back(state.u_m.x[n]);
  for (std::size_t k = 0; base != nullptr && k < u_x_m.size(); ++k)
    u_x_m[k] -= state.below_u_m.x[base->interface_nodes[k]];
  return u_x_m;
}

Equilibrium make_equilibrium(const ContactProblem& problem, double shear, double margin_m) {
  Equilibrium e;
  e.shear_m = shear;
  e.contact = problem.contact;
  const Inside inside = inside_contact(problem, margin_m);
  e.inside_from_m = inside.from_m;
  e.inside_to_m = inside.to_m;
  const auto& mu_s = problem.states.support.mu_s;
  double mu_s_at_peak = mu_s.front();
  for (std::size_t k = 0; k < problem.nodes.x_m.size(); ++k) {
    const bool open = problem.contact[k] == Contact::open;
    const double x = problem.nodes.x_m[k];
    const double t = open ? 0 : problem.t_Pa(k, shear), p = open ? 0 : problem.p_Pa(k, shear);
    e.tractions.x_m.push_back(x);
    e.tractions.t_s_Pa.push_back(t);
    e.tractions.p_s_Pa.push_back(p);
    if (p > 0 && inside.contains(x) && is_nearer_to_slip(t / p, mu_s[k], e.peak_ratio, mu_s_at_peak)) {
      e.peak_ratio = t / p;
      e.peak_x_m = x;
      mu_s_at_peak = mu_s[k];
    }
  }
  return e;
}

/// The finest level's contact, settled at a shear.
struct Settled {
  std::unique_ptr<ContactProblem> problem;
  double shear = 0;
};

/// Finds contact states, and the shear. On the coarser levels of an iterative solver, each begins from the
/// next coarser one; the finest begins from the last of them and its displacement. `make_case(level)` makes
/// the load case of a level, settle(problem, accuracy, final) settles its states as the function above does.
template <class MakeCase, class Settle>
Settled settle_on_levels(const mesh::Mesh& mesh, const mesh::Mesh* base, const PlateSolver& solver,
                         const ContactStates& start, MakeCase&& make_case, Settle&& settle,
                         LoadCase& finest) {
  std::unique_ptr<LoadCase> coarser;
  ContactStates coarser_states;
  std::vector<std::size_t> coarser_places;
  const auto begin = [&](LoadCase& plate, int level) {
    const auto places = solver.interface_of(level);
    auto states = at_places(start, places);
    if (coarser) {
      plate.begin_from(*coarser);
      take_nearest(coarser_states, coarser_places, places, states);
    }
    return std::make_unique<ContactProblem>(interface_nodes(mesh, base, places), plate, std::move(states));
  };
  for (int level = solver.n_levels() - 1; level > 0; --level) {
    auto plate = make_case(level);
    const auto problem = begin(*plate, level);
    try {
      settle(*problem, first_accuracy, guess_accuracy);
    } catch (const UserError&) {  // what is impossible on a coarse level need not be so on the next
      coarser.reset();
      continue;
    }
    coarser = std::move(plate);
    coarser_states = problem->states;
    coarser_places = solver.interface_of(level);
  }
  Settled settled{begin(finest, 0)};
  const double accuracy = coarser ? guess_accuracy : solver.iterates() ? first_accuracy : final_accuracy;
  settled.shear = settle(*settled.problem, accuracy, final_accuracy);
  return settled;
}

TopDisplacement tilt_of(const mesh::Mesh& mesh, const Loading& loading) {
  const auto& loaded = mesh.far_edge_nodes;
  TopDisplacement tilt{std::vector<double>(loaded.size(), 0.0), {}};
  const double x0 = mesh.x_m[loaded.front()], width = mesh.x_m[loaded.back()] - x0;
  for (const auto n : loaded) {
    const double s = (mesh.x_m[n] - x0) / width;
    tilt.u_y_m.push_back(-((1 - s) * loading.tilt_left_m + s * loading.tilt_right_m));
  }
  return tilt;
}

/// An edge that bears a pressure.
TopDisplacement pressed_top(const mesh::Mesh& mesh, const TopPressure& pressure) {
  const auto& loaded = mesh.far_edge_nodes;
  std::vector<double> x_m;
  for (const auto n : loaded) x_m.push_back(mesh.x_m[n]);
  const auto forces = pressure.forces_N_per_m(x_m);
  const std::vector<double> in_place(loaded.size(), 0.0);
  TopDisplacement top{in_place, in_place, {}, solid::Field(mesh.n_nodes())};
  for (std::size_t k = 0; k < loaded.size(); ++k) top.tilt_force_N.y[loaded[k]] = -forces[k];
  return top;
}

double height_over_modulus(const ElasticBody& body) {
  double height_m = body.mesh.grid.rows * body.mesh.grid.spacing_m;
  for (const auto& grid : body.mesh.coarser) height_m += grid.rows * grid.spacing_m;
  return height_m / body.material.youngs_modulus_Pa;
}

DisplacementOfBodies displacement_of(const Equilibrium& e) {
  return {&e.u_m, &e.below_u_m};
}

/// Nodes in contact stick.
ContactStates sticking(std::vector<Contact> contact, std::vector<double> anchor_x_m,
                       const std::vector<double>& mu_s) {
  std::vector<std::uint8_t> has_touched;
  for (auto& state : contact) {
    if (state != Contact::open) state = Contact::stick;
    has_touched.push_back(state != Contact::open);
  }
  std::vector<double> slip_sign(contact.size(), 0.0);
  return {{std::move(contact), std::move(slip_sign), std::move(anchor_x_m), mu_s}, std::move(has_touched)};
}

}  // namespace

Statics::Statics(const mesh::Mesh& mesh, const solid::Material& material, const Loading& loading, double mu_s,
                 std::string mu_s_key, MayContinue may_continue)
    : Statics({mesh, material}, std::nullopt, loading, std::vector<double>(mesh.interface_nodes.size(), mu_s),
              std::move(mu_s_key), std::move(may_continue)) {}

Statics::Statics(const ElasticBody& plate_body, const std::optional<ElasticBody>& base,
                 const Loading& loading, std::vector<double> mu_s, std::string mu_s_key,
                 MayContinue may_continue)
    : mesh_(plate_body.mesh),
      boundary_(boundary::make_boundary(mesh_, plate_body.machine)),
      base_mesh_(base ? &base->mesh : nullptr),
      loading_(loading),
      mu_s_(std::move(mu_s)),
      mu_s_key_(std::move(mu_s_key)),
      may_continue_(std::move(may_continue)) {
  const auto& mesh = mesh_;
  SLIPFRONT_ASSERT(mu_s_.size() == mesh.interface_nodes.size(), "mu_s of another interface");
  solver_ = make_plate_solver(plate_body, loading.solver, base);
  press_down(plate_body, base);
  tilted_top_.tilt_force_N = tilt_force_N(plate_body.material);
  pushed_rows_ = solid::assemble_rows(mesh, plate_body.material, boundary_.pushed);
  const auto tilted_u = displacement_of(tilted_);
  sheared_ =
      solver_->load_case(constraint_under_shear(boundary_), tilted_top_, EdgeMotion::along_x, &tilted_u, 0);
}

void Statics::press_down(const ElasticBody& plate_body, const std::optional<ElasticBody>& base) {
  const auto& mesh = mesh_;
  const bool is_free = loading_.top_during_tilt == TopEdge::free || !boundary_.pushed.empty();
  const auto& loaded = mesh.far_edge_nodes;
  const double width_m = mesh.x_m[loaded.back()] - mesh.x_m[loaded.front()];
  // Jacks bear the edge without a machine: the pressing is over before that moves.
  std::unique_ptr<PlateSolver> under_jacks;
  if (loading_.top_pressure.is_there())
    under_jacks = make_plate_solver({mesh, plate_body.material, {is_free ? 0 : infinity, 0}},
                                    StaticSolver::direct, base);
  const auto force_N_per_m = under_jacks ? std::nullopt : normal_force_N_per_m(loading_, width_m);
  if (force_N_per_m) {
    const double compliance_m_per_Pa =
                     height_over_modulus(plate_body) + (base ? height_over_modulus(*base) : 0),
                 guess_m = *force_N_per_m / width_m * compliance_m_per_Pa;
    loading_.tilt_left_m = guess_m + 0.5 * loading_.tilt_difference_m;
    loading_.tilt_right_m = guess_m - 0.5 * loading_.tilt_difference_m;
  }

  auto tilt = under_jacks ? pressed_top(mesh, loading_.top_pressure) : tilt_of(mesh, loading_);
  const auto make_case = [&](int level) {
    if (under_jacks)
      return under_jacks->load_case(TopConstraint::machine, tilt, EdgeMotion::none, nullptr, level);
    return solver_->load_case(is_free ? TopConstraint::vertical : TopConstraint::both, tilt,
                              force_N_per_m ? EdgeMotion::down : EdgeMotion::none, nullptr, level);
  };
  auto plate = make_case(0);

  bool reached = true;
  const auto settle_problem = [&](ContactProblem& problem, double accuracy, double final) {
    const auto press_m = [&] {
      const double found = force_N_per_m ? problem.shear_at(&ContactProblem::p_Pa, *force_N_per_m) : 0.0;
      reached = std::isfinite(found);
      return reached ? found : 0.0;
    };
    return settle(
        problem, loading_, accuracy, final, press_m, [](std::size_t) { return true; }, may_continue_);
  };
  std::vector<Contact> contact;
  for (const double gap_m : gaps_m(mesh, base_mesh_))
    contact.push_back(gap_m > 0 ? Contact::open : Contact::stick);
  const std::vector<double> in_place(contact.size(), 0.0);
  const auto [problem, pressed_m] =
      settle_on_levels(mesh, base_mesh_, *solver_, sticking(std::move(contact), in_place, mu_s_), make_case,
                       settle_problem, *plate);
  tilted_ = make_equilibrium(*problem, pressed_m, loading_.edge_margin_m);
  tilted_.shear_m = 0;
  if (!reached)
    throw UserError("no displacement of the top edge gives the normal force; change {}",
                    keys_of_tilt(loading_));
  if (std::ranges::all_of(tilted_.tractions.p_s_Pa, [](double p) { return p <= 0; }))
    throw UserError("the tilt leaves the plate without contact; increase {}", keys_of_tilt(loading_));
  auto u = plate->displacement(pressed_m);
  plate.reset();
  tilted_.u_m = std::move(u.above);
  tilted_.below_u_m = std::move(u.below);
  held_contact_ = tilted_.contact;
  held_u_x_m_ = relative_u_x_m(mesh, base_mesh_, tilted_);
  tilted_.u_per_shear = solid::Field(tilted_.u_m.size());
  tilted_.below_u_per_shear = solid::Field(tilted_.below_u_m.size());

  for (std::size_t k = 0; k < loaded.size(); ++k) {
    tilt.u_x_m[k] = tilted_.u_m.x[loaded[k]];
    tilt.u_y_m[k] = tilted_.u_m.y[loaded[k]];
  }
  loading_.tilt_left_m = -tilt.u_y_m.front();
  loading_.tilt_right_m = -tilt.u_y_m.back();
  for (const auto n : boundary_.pushed) tilt.pushed_u_x_m.push_back(tilted_.u_m.x[n]);
  tilted_top_ = tilt;
}

solid::Field Statics::tilt_force_N(const solid::Material& material) const {
  std::vector<mesh::Node> nodes;
  solid::Field has_spring(mesh_.n_nodes());
  for (const auto& a : boundary_.nodes) {
    has_spring.x[a.node] = boundary::is_spring(a.spring_x_N_per_m);
    has_spring.y[a.node] = boundary::is_spring(a.spring_y_N_per_m);
    if (boundary::is_spring(a.spring_x_N_per_m) || boundary::is_spring(a.spring_y_N_per_m))
      nodes.push_back(a.node);
  }
  if (nodes.empty()) return {};
  solid::Field force_N(mesh_.n_nodes());
  const auto rows = solid::assemble_rows(mesh_, material, nodes);
  solid::for_each_row_product(rows, tilted_.u_m, [&](std::size_t r, double x, double y) {
    const auto n = rows.node[r];
    force_N.x[n] = has_spring.x[n] * x;
    force_N.y[n] = has_spring.y[n] * y;
  });
  return force_N;
}

double Statics::shear_height_m(const Equilibrium& state) const {
  if (boundary_.pushed.empty()) return mesh_.y_m[mesh_.far_edge_nodes.front()];
  if (state.shear_m == 0) return nan;
  double force_N = 0, moment_N_m = 0;
  solid::for_each_row_product(pushed_rows_, state.u_m, [&](std::size_t r, double x, double /*y*/) {
    force_N += x;
    moment_N_m += x * mesh_.y_m[pushed_rows_.node[r]];
  });
  return moment_N_m / force_N;
}

double Statics::machine_energy_J_per_m(const Equilibrium& state) const {
  double energy = 0;
  // By how much a spring is longer than in the tilted plate.
  const auto add = [&](const std::optional<double>& spring_N_per_m, double force_N, double stretch_m) {
    if (boundary::is_spring(spring_N_per_m))
      energy += (force_N + 0.5 * *spring_N_per_m * stretch_m) * stretch_m;
  };
  const auto &u = state.u_m, &u_tilted = tilted_.u_m, &force_N = tilted_top_.tilt_force_N;
  if (force_N.size() == 0) return 0;
  for (const auto& edge : boundary_.nodes) {
    const auto n = edge.node;
    add(edge.spring_x_N_per_m, force_N.x[n], state.shear_m - (u.x[n] - u_tilted.x[n]));
    add(edge.spring_y_N_per_m, force_N.y[n], -(u.y[n] - u_tilted.y[n]));
  }
  return energy;
}

Statics::~Statics() = default;

template <class Problem>
Equilibrium Statics::equilibrium(const Problem& problem, double shear_m) const {
  Equilibrium e = make_equilibrium(problem, shear_m, loading_.edge_margin_m);
  auto u = sheared_->displacement(shear_m), per_shear = sheared_->displacement_per_shear();
  e.u_m = std::move(u.above);
  e.below_u_m = std::move(u.below);
  e.u_per_shear = std::move(per_shear.above);
  e.below_u_per_shear = std::move(per_shear.below);
  return e;
}

template <class FindShear>
Equilibrium Statics::shear(FindShear&& find_shear, bool sticks_inside) const {
  Inside inside{};
  const auto settle_problem = [&](ContactProblem& problem, double accuracy, double final) {
    return settle(
        problem, loading_, accuracy, final,
        [&] {
          inside = inside_contact(problem, loading_.edge_margin_m);
          return find_shear(problem, inside);
        },
        [&](std::size_t k) { return !inside.contains(problem.nodes.x_m[k]); }, may_continue_);
  };
  const auto is_outside = [&](std::size_t k) {
    return !inside.contains(mesh_.x_m[mesh_.interface_nodes[k]]);
  };
  Settled settled;
  if (last_) {
    const auto all = solver_->interface_of(0);
    settled.problem =
        std::make_unique<ContactProblem>(interface_nodes(mesh_, base_mesh_, all), *sheared_, *last_);
    settled.shear = settle_problem(*settled.problem, final_accuracy, final_accuracy);
  } else {
    const auto tilted_u = displacement_of(tilted_);
    const auto make_case = [&](int level) {
      return solver_->load_case(constraint_under_shear(boundary_), tilted_top_, EdgeMotion::along_x,
                                &tilted_u, level);
    };
    settled = settle_on_levels(mesh_, base_mesh_, *solver_, sticking(held_contact_, held_u_x_m_, mu_s_),
                               make_case, settle_problem, *sheared_);
  }
  auto& [problem, shear] = settled;
  // A guess of the shear that was too large leaves slip where the edge of contact has moved away from. Where
  // such a node stays on neither side of the edge's margin, its slip counts.
  for (bool goes_on = sticks_inside; goes_on;) {
    const auto with_slip = problem->states;
    goes_on = problem->stick_again(is_outside);
    if (goes_on) try {
        shear = settle_problem(*problem, final_accuracy, final_accuracy);
      } catch (const UserError&) {
        problem->states = with_slip;
        shear = settle_problem(*problem, final_accuracy, final_accuracy);
        goes_on = false;
      }
  }
  if (solver_->iterates()) last_ = problem->states;

  return equilibrium(*problem, shear);
}

void Statics::hold(std::vector<Contact> contact, std::vector<double> u_x_m) {
  held_contact_ = std::move(contact);
  held_u_x_m_ = std::move(u_x_m);
  last_.reset();
  // What was solved before leaves no rounding behind.
  const auto tilted_u = displacement_of(tilted_);
  sheared_ =
      solver_->load_case(constraint_under_shear(boundary_), tilted_top_, EdgeMotion::along_x, &tilted_u, 0);
}

void Statics::set_mu_s(std::vector<double> mu_s, std::string key) {
  SLIPFRONT_ASSERT(mu_s.size() == mu_s_.size(), "mu_s of another interface");
  mu_s_ = std::move(mu_s);
  mu_s_key_ = std::move(key);
  last_.reset();
}

Equilibrium Statics::slid_to(std::vector<Contact> contact, std::vector<double> u_x_m,
                             std::vector<double> u_x_per_shear, double shear_m) const {
  for (std::size_t k = 0; k < u_x_per_shear.size(); ++k) u_x_m[k] -= shear_m * u_x_per_shear[k];
  ContactStates states{{std::move(contact), std::vector<double>(u_x_m.size()), std::move(u_x_m), mu_s_,
                        std::move(u_x_per_shear)},
                       std::vector<std::uint8_t>(held_contact_.size(), 1)};
  std::vector<std::size_t> all(states.has_touched.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  ContactProblem problem(interface_nodes(mesh_, base_mesh_, all), *sheared_, std::move(states));
  problem.solve(final_accuracy);
  return equilibrium(problem, shear_m);
}

std::unique_ptr<SlidingInterface> Statics::sliding(const std::vector<Contact>& contact) const {
  return solver_->sliding(tilted_top_, contact);
}

Equilibrium Statics::shear_by(double shear_m) const {
  return shear([shear_m](const ContactProblem&, const Inside&) { return shear_m; }, false);
}

Equilibrium Statics::shear_to_force(double force_N_per_m) const {
  const double of_tilt = contact_force(tilted_, mesh::tributary_lengths_m(mesh_)).shear_N_per_m;
  const auto key =
      Key(loading_.shear_over_critical ? "loading.shear_over_critical" : "loading.shear_force_N_per_m");
  if (of_tilt > force_N_per_m)
    throw UserError(
        "{}: the interface bears a shear force of {:.6g} N/m before any shear, more than {:.6g} N/m; raise "
        "it, or change {}, or {}",
        key, of_tilt, force_N_per_m, keys_of_tilt(loading_), Key("loading.top_during_tilt"));
  last_.reset();  // the way begins at the tilt: back from a larger shear contact ends in other states
  bool reached = true;
  Equilibrium e = shear(
      [&](const ContactProblem& problem, const Inside&) {
        const double found = problem.shear_at(&ContactProblem::t_Pa, force_N_per_m);
        reached = std::isfinite(found);
        return reached ? found : 0.0;
      },
      false);
  if (!reached)
    throw UserError("{}: no shear gives a force of {:.6g} N/m; reduce it, or raise {}", key, force_N_per_m,
                    Key(mu_s_key_));
  return e;
}

double Statics::share_of_strength(const Equilibrium& state) const {
  return state.peak_ratio / ratio_at_peak(state, 1);
}

double Statics::ratio_at_peak(const Equilibrium& state, double share) const {
  const auto at = std::ranges::find(state.tractions.x_m, state.peak_x_m) - state.tractions.x_m.begin();
  return share * (state.peak_ratio > 0 ? mu_s_[at] : mu_s_.front());
}

std::string Statics::name_of_ratio(double share) const {
  const bool uniform = std::ranges::count(mu_s_, mu_s_.front()) == std::ssize(mu_s_);
  return uniform ? fmt::format("{:.6g}", share * mu_s_.front()) : fmt::format("{:.6g} mu_s", share);
}

Equilibrium Statics::shear_to(double share) const {
  if (tilted_.peak_ratio > ratio_at_peak(tilted_, share))
    throw UserError(
        "the tilt alone brings t/p inside the interface to {:.6g} at x = {:.4g} m, not below {}; raise {}, "
        "lower {}, or change the tilt",
        tilted_.peak_ratio, tilted_.peak_x_m, name_of_ratio(share), Key(mu_s_key_),
        Key("loading.critical_margin"));
  bool reached = true;
  Equilibrium e = shear(
      [&](const ContactProblem& problem, const Inside& inside) {
        // With the contact states as they are, t - ratio p grows linearly with the shear at every node; a
        // state that does not last until then is corrected, and the shear found again.
        const auto& mu_s = problem.states.support.mu_s;
        double shear = infinity;
        for (std::size_t k = 0; k < problem.contact.size(); ++k) {
          if (problem.contact[k] != Contact::stick || !inside.contains(problem.nodes.x_m[k])) continue;
          const double ratio = share * mu_s[k];
          const double excess = problem.t_Pa(k, 0) - ratio * problem.p_Pa(k, 0);
          const double growth = problem.t_Pa(k, 1) - ratio * problem.p_Pa(k, 1) - excess;
          if (growth > 0 && excess <= 0 && problem.p_Pa(k, -excess / growth) > 0)
            shear = std::min(shear, -excess / growth);
        }
        reached = std::isfinite(shear);
        return reached ? shear : 0.0;
      },
      true);
  if (!reached)
    throw UserError(
        "no shear brings t/p inside the interface to {}, a tall plate tips before; reduce {} or {}, or "
        "change the tilt or {}",
        name_of_ratio(share), Key(mu_s_key_), Key("plate.height_m"), Key("loading.edge_margin_m"));
  // Slip at mu_s p that has spread from an edge past the margin would itself count as the peak.
  const double ratio = ratio_at_peak(e, share);
  if (std::abs(e.peak_ratio - ratio) > 1e-6 * ratio)
    throw UserError(
        "slip spreads from an edge of contact before t/p inside reaches {}; reduce {}, or change the tilt or "
        "{}",
        name_of_ratio(share), Key(mu_s_key_), Key("loading.edge_margin_m"));
  return e;
}

}  // namespace slipfront::statics
