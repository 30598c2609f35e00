// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "input/schema.hpp"
#include "mesh/plate.hpp"
#include "motion/observed_run.hpp"
#include "motion/observers/blow_up_monitor.hpp"
#include "motion/stepper.hpp"
#include "problem/contact.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/laws.hpp"
#include "python/watcher.hpp"
#include "setup/loads.hpp"
#include "statics/prestress.hpp"
#include "statics/statics.hpp"

// The library's objects, to be put together in Python. What describes them are tables of the case file.
namespace slipfront::python {
namespace {

using namespace nb::literals;
using Keys = std::vector<input::Override>;

/// Keys of a table, given by keyword, behind others.
Keys with_table(Keys keys, const char* table, const nb::kwargs& given) {
  nb::dict tables;
  if (!given.empty()) tables[table] = given;
  for (const nb::handle pair : nb::module_::import_("slipfront.running").attr("flattened")(tables))
    keys.push_back(nb::cast<input::Override>(pair));
  return keys;
}

Keys joined(Keys keys, const Keys& more) {
  keys.insert(keys.end(), more.begin(), more.end());
  return keys;
}

/// What an object was made of.
std::string shown(std::string what, const Keys& keys) {
  for (const auto& [key, text] : keys)
    what += fmt::format("{}{} = {}", &key == &keys.front().first ? ": " : ", ", key, text);
  return "<" + what + ">";
}

/// A number, or one for each interface node.
std::vector<double> at_nodes(const nb::object& given, std::size_t n, const char* name) {
  const auto array = nb::module_::import_("slipfront.given").attr("array");
  const auto values = nb::cast<Values>(array(given, name, "finite"_a = true));
  if (values.size() == 1) return std::vector<double>(n, values(0));
  if (values.size() != n)
    throw UserError("{} has {} values; give a number, or one for each of {} interface nodes", name,
                    values.size(), n);
  return to_vector(values);
}

struct PlateMesh {
  Keys keys;
  mesh::Mesh mesh;
  explicit PlateMesh(const nb::kwargs& plate)
      : keys(with_table({}, "plate", plate)), mesh(mesh::make_plate(input::parse_tables(keys).plate)) {}
};

struct Body {
  Keys keys;
  const mesh::Mesh& mesh;
  solid::Material material;
  Body(const PlateMesh& of, const nb::kwargs& given)
      : keys(with_table(of.keys, "material", given)),
        mesh(of.mesh),
        material(input::parse_tables(keys).material) {}
};

struct Friction {
  Keys keys;
  std::optional<nb::callable> mu_of;  ///< a law in Python; slip_weakening stands for it in the keys
  Friction(const std::string& contact, const nb::kwargs& friction) {
    nb::dict given;
    given.update(friction);
    const nb::object law = given.contains("law") ? given["law"] : nb::none();
    if (PyCallable_Check(law.ptr()) != 0) {
      if (given.contains("mu_s")) throw UserError("mu_s follows from the law, as mu(0, 0); remove it");
      const auto checked = nb::module_::import_("slipfront.running").attr("checked_law")(law);
      mu_of = nb::cast<nb::callable>(checked[0]);
      given["law"] = "slip_weakening";
      given["mu_s"] = checked[1];
      if (!given.contains("mu_k")) given["mu_k"] = checked[1];
    }
    keys = with_table({{"contact.algorithm", contact}}, "friction", nb::borrow<nb::kwargs>(given));
    input::parse_tables(keys);
  }
};

input::Case case_of(const Keys& keys, const Friction& friction) {
  auto config = input::parse_tables(keys);
  if (friction.mu_of) config.friction.set_function(law_of(*friction.mu_of));
  return config;
}

/// Ends a run at a given step, or where it is interrupted.
class Until final : public motion::Observer {
 public:
  std::int64_t step = 0;
  std::int64_t steps_to_pause(const motion::Now& now) const override { return step - now.step; }
  std::optional<motion::End> end(motion::Pause& pause) override {
    if (pause.now().step >= step) return motion::End{motion::EventEnd::end_time};
    if (pause.stepper().is_interrupted()) return motion::End{motion::EventEnd::interrupted};
    return {};
  }
};

/// A stepper that starts once, so that its arrays stay where they are.
class Stepper {
 public:
  Stepper(const Body& above, const Friction& friction, const Body* below, int threads, const nb::kwargs& time)
      : keys_(with_table(joined(above.keys, friction.keys), "time", time)),
        problem_(problem::make_problem(case_of(keys_, friction))),
        above_(above),
        below_(below),
        x_m_(mesh::interface_x_m(above.mesh)),
        contact_(contact_model(problem_, x_m_)),
        stepper_(sources(threads), contact_, problem_.time, {.threads = threads}) {}

  void start(const nb::object& t_Pa, const nb::object& p_Pa, const nb::object& strength_fraction,
             double shear_speed_m_per_s) {
    const auto n = x_m_.size();
    const record::StaticState before{x_m_, at_nodes(t_Pa, n, "t_Pa"), at_nodes(p_Pa, n, "p_Pa")};
    auto shares = at_nodes(strength_fraction, n, "strength_fraction");
    if (!std::ranges::all_of(before.p_s_Pa, [](double p) { return p > 0; }))
      throw UserError("p_Pa must be above 0 at all nodes: the whole interface starts in contact");
    if (!std::ranges::all_of(shares, [](double share) { return share >= 0 && share <= 1; }))
      throw UserError("strength_fraction must be between 0 and 1");
    if (has_gaps(above_))
      throw UserError("start needs a mesh with corner = none: the whole interface starts in contact");
    const auto state = statics::prestressed(above_.mesh, before, below_ ? &below_->mesh : nullptr);
    auto loads = motion::prescribed_loads(state);
    loads.strength_fraction = std::move(shares);
    begin(state, shear_speed_m_per_s, std::move(loads));
  }

  void start_from_statics(std::optional<double> share, const nb::kwargs& loading) {
    // Of the case only the loading counts.
    const auto keys =
        with_table(joined(keys_, {{"event.kind", "none"}, {"base.kind", "rigid"}}), "loading", loading);
    const auto problem =
        problem::make_problem(input::CaseFile(input::CaseText{"", "case", {}}, keys).config());
    if (problem.loading.method != statics::LoadingMethod::direct)
      throw UserError("{} must be direct here; remove it", Key("loading.method"));
    for (const Body* body : {&above_, below_})
      if (body && (body->mesh.far_edge_nodes.empty() || body->mesh.period_m > 0))
        throw UserError("statics hold the far edges: give meshes with top = loaded, and sides not periodic");
    std::optional<statics::ElasticBody> base;
    if (below_) base.emplace(statics::ElasticBody{below_->mesh, below_->material});
    Watcher watcher{nb::none()};
    const auto equilibrium = [&] {
      const nb::gil_scoped_release unlocked;
      const statics::Statics statics({above_.mesh, above_.material}, base, problem.loading, mu_s(),
                                     interface::static_coefficient_key(problem.friction.law),
                                     [&] { return !watcher.is_stopped(); });
      if (share) return statics.shear_to(*share);
      return setup::common_state(problem, statics, statics.shear_to(1),
                                 mesh::tributary_lengths_m(above_.mesh));
    }();
    begin(equilibrium, problem.shear_speed_m_per_s, {});
  }

  void set_tractions(const nb::object& t_Pa, const nb::object& p_Pa) {
    require_ready();
    auto t = at_nodes(t_Pa, x_m_.size(), "t_Pa");
    stepper_.set_prestress(std::move(t), at_nodes(p_Pa, x_m_.size(), "p_Pa"));
  }

  std::int64_t advance(std::int64_t n_steps) { return take(static_cast<double>(n_steps)); }
  std::int64_t run_until(double time_s) {
    constexpr double rounding = 1e-9;
    const double step = std::ceil(time_s / stepper_.step_s() - rounding);
    return take(std::fdim(step, static_cast<double>(stepper_.step())));
  }

  nb::typed<nb::dict, std::string, double> energies() {
    require_ready();
    const auto now = stepper_.energies();
    nb::dict terms;
    for (const auto& term : record::energy_terms) terms[term.name] = now.*term.member;
    terms[record::imbalance_name] = record::imbalance_J_per_m(now, energies_at_start_);
    return nb::borrow<nb::typed<nb::dict, std::string, double>>(terms);
  }

  std::string text() const { return shown(fmt::format("stepper at step {}", stepper_.step()), keys_); }
  const motion::Stepper& motion() const { return stepper_; }
  /// @throws UserError before the start, which puts the arrays where they stay
  const motion::Stepper& started() const {
    if (!run_) throw UserError("the stepper has not started; call start or start_from_statics");
    return stepper_;
  }
  const motion::Body& body(std::size_t number) const {
    const auto bodies = started().bodies();
    if (number < bodies.size()) return bodies[number];
    throw nb::index_error("body is 0, the one above, or 1, the one below where there is one");
  }
  const std::vector<double>& x_m() const { return x_m_; }
  const std::vector<double>& slip_m() const { return slip_m_; }

 private:
  enum class State { ready, in_use, failed };

  static bool has_gaps(const Body& body) {
    return std::ranges::any_of(body.mesh.interface_nodes, [&](auto n) { return body.mesh.y_m[n] > 0; });
  }
  /// Checked, with what comes before.
  std::vector<motion::BodySource> sources(int threads) const {
    for (const char* key : {"time.end_s", "time.quiet_s", "time.stepper", "time.precision"})
      if (std::ranges::find(keys_, key, &input::Override::first) != keys_.end())
        throw UserError("{} does nothing here: a stepper goes as far as it is told; remove it", Key(key));
    const Key tip("friction.tip_slip_rate_m_per_s");
    if (problem_.friction.law.never_sticks() && !problem_.friction.tip_slip_rate_m_per_s)
      throw UserError("{} has no default here, where the pressure is not known yet; set it", tip);
    if (threads < 1) throw UserError("threads is {}; it must be at least 1", threads);
    if (threads > 1 && problem_.friction.law.function() != nullptr)
      throw UserError("threads is {}; with a law in Python it must be 1", threads);
    std::vector<motion::BodySource> bodies = {{above_.mesh, above_.material}};
    if (!below_) return bodies;
    bodies.push_back({below_->mesh, below_->material});
    const auto x_below_m = mesh::interface_x_m(below_->mesh);
    const double least_m = 1e-6 * mesh::min_side_m(above_.mesh);
    const auto faces = [&](double a, double b) { return std::abs(a - b) < least_m; };
    if (above_.mesh.period_m != below_->mesh.period_m || !std::ranges::equal(x_m_, x_below_m, faces) ||
        has_gaps(*below_))
      throw UserError(
          "the interface nodes of the two bodies do not face each other; give both meshes the same width_m, "
          "element_size_m and sides periodic or not, no fillets, and the one below corner = none");
    return bodies;
  }
  std::vector<double> mu_s() const {
    std::vector<double> mu_s;
    for (std::size_t i = 0; i < x_m_.size(); ++i)
      mu_s.push_back(interface::static_coefficient(contact_.law_at(i)));
    return mu_s;
  }
  std::int64_t take(double n_steps) {
    constexpr double most = 1e12;  // as of a case
    if (!(n_steps >= 0 && n_steps <= most))
      throw UserError("{:g} steps are asked for; give 0 to {:g}", n_steps, most);
    require_ready();
    const auto first = stepper_.step();
    until_->step = first + static_cast<std::int64_t>(n_steps);
    Watcher watcher{nb::none()};
    state_ = State::in_use;
    motion::End end;
    try {
      const nb::gil_scoped_release unlocked;
      end = run_->run();
      update_slip();
    } catch (...) {
      state_ = State::failed;
      throw;
    }
    state_ = end.why == motion::EventEnd::blow_up ? State::failed : State::ready;
    if (state_ == State::failed) throw BlowUp(end.reason);
    watcher.rethrow();
    if (end.why == motion::EventEnd::interrupted)
      throw Interrupted(fmt::format("interrupted after step {}", stepper_.step()));
    return stepper_.step() - first;
  }
  void require_ready() const {
    started();
    if (state_ == State::in_use)
      throw UserError(
          "the stepper is already advancing: do not call it from its friction law or from another thread");
    if (state_ == State::failed) throw UserError("the stepper has failed; make another one");
  }
  void begin(const statics::Equilibrium& state, double top_speed_m_per_s, motion::Loads loads) {
    if (run_) throw UserError("the stepper has started already; make another one");
    stepper_.start(state, top_speed_m_per_s, std::move(loads));
    slip_m_.resize(x_m_.size());
    energies_at_start_ = stepper_.energies();
    double fastest = solid::longitudinal_speed_m_per_s(above_.material);
    if (below_) fastest = std::max(fastest, solid::longitudinal_speed_m_per_s(below_->material));
    motion::Observers observers;
    observers.push_back(std::make_unique<motion::BlowUpMonitor>(stepper_, fastest, problem_.time.precision,
                                                                energies_at_start_));
    auto until = std::make_unique<Until>();
    until_ = until.get();
    observers.push_back(std::move(until));
    run_.emplace(stepper_, motion::SlipFinder(state, mu_s(), 0, 0), x_m_, std::move(observers));
  }
  void update_slip() {
    for (std::size_t i = 0; i < slip_m_.size(); ++i) slip_m_[i] = stepper_.slip_m(i);
  }

  Keys keys_;
  Problem problem_;
  const Body& above_;
  const Body* below_;  ///< null on the rigid plane
  std::vector<double> x_m_;
  interface::ContactModel contact_;
  motion::Stepper stepper_;
  std::optional<motion::ObservedRun> run_;
  Until* until_ = nullptr;
  State state_ = State::ready;
  std::vector<double> slip_m_;
  record::Energies energies_at_start_;
};

nb::typed<nb::tuple, Array, Array> components_of(const solid::Field& field, const Stepper& owner) {
  return nb::borrow<nb::typed<nb::tuple, Array, Array>>(
      nb::make_tuple(view_of(field.x, owner), view_of(field.y, owner)));
}

void bind_bodies(nb::module_& module) {
  using Nodes = nb::ndarray<nb::numpy, const mesh::Node, nb::ndim<1>>;
  using Cells = nb::ndarray<nb::numpy, const mesh::Node, nb::shape<-1, 4>>;
  using M = PlateMesh;
  nb::class_<M>(
      module, "Mesh",
      "Nodes and four-node cells of a plate, its lower edge the interface.\n\n"
      "plate: keys of [plate] of a case file, such as width_m=0.1, height_m=0.05, element_size_m=1e-3, "
      "corner=\"none\", sides=\"absorbing\", top=\"free\". Raises CaseError. Arrays are views that cannot be "
      "written to.")
      .def(nb::init<nb::kwargs>(), "plate"_a, nb::sig("def __init__(self, **plate: object) -> None"))
      .def("__repr__", [](const M& m) { return shown("mesh", m.keys); })
      .def_prop_ro(
          "x_m", [](const M& m) { return view_of(m.mesh.x_m, m); },
          "[nodes] along the interface, from the left edge")
      .def_prop_ro(
          "y_m", [](const M& m) { return view_of(m.mesh.y_m, m); },
          "[nodes] away from the interface; of a body below downwards")
      .def_prop_ro(
          "cells",
          [](const M& m) {
            return Cells(m.mesh.cells.data(), {m.mesh.cells.size(), 4}, nb::find(m));
          },
          "[cells, 4] numbers of their nodes, counterclockwise")
      .def_prop_ro(
          "interface_nodes",
          [](const M& m) {
            const auto& nodes = m.mesh.interface_nodes;
            return Nodes(nodes.data(), {nodes.size()}, nb::find(m));
          },
          "[interface nodes] their numbers, x ascending");
  nb::class_<Body>(module, "Body",
                   "An elastic body with stiffness damping.\n\n"
                   "material: keys of [material], such as youngs_modulus_Pa=2.6e9, poissons_ratio=0.37, "
                   "density_kg_per_m3=1200, plane=\"strain\". Raises CaseError.")
      .def(nb::init<const M&, nb::kwargs>(), "mesh"_a, "material"_a, nb::keep_alive<1, 2>(),
           nb::sig("def __init__(self, mesh: Mesh, **material: object) -> None"))
      .def("__repr__", [](const Body& b) { return shown("body", b.keys); });
  nb::class_<Friction>(
      module, "Interface",
      "Contact and friction of an interface.\n\n"
      "friction: keys of [friction], such as law=\"slip_weakening\" and its parameters. law may be a "
      "function "
      "mu(slip_rate_m_per_s, slip_m), as that of run_with_law: its mu(0, 0) is mu_s, and mu_k that of nodes "
      "weakened by strength_fraction, by default mu_s. contact: contact.algorithm, \"direct\" or "
      "\"predictor_corrector\". Raises CaseError.")
      .def(nb::init<const std::string&, nb::kwargs>(), nb::kw_only(), "contact"_a = "direct", "friction"_a,
           nb::sig("def __init__(self, *, contact: object = 'direct', **friction: object) -> None"))
      .def("__repr__", [](const Friction& f) { return shown("interface", f.keys); });
}

}  // namespace

void bind_compose(nb::module_& module) {
  using S = Stepper;
  bind_bodies(module);
  const auto of_interface = [](std::vector<double> interface::Interface::*field) {
    return [field](const S& s) { return view_of(s.started().interface_state().*field, s); };
  };
  nb::class_<S>(
      module, "Stepper",
      "Explicit steps of a body on the rigid plane, or of two bodies on each other.\n\n"
      "below: another body instead of the plane, described upside down: y, u_y and v_y point away from the "
      "interface. Its interface nodes face those above. time: keys of [time] that say how steps are taken, "
      "such as interface_substeps=1. Results do not depend on threads. Arrays are views of the state between "
      "two steps: they change with it and cannot be written to; copy what is to be kept. Raises CaseError, "
      "also before the start, after a failure, and where another thread is advancing it.")
      .def(nb::init<const Body&, const Friction&, const Body*, int, nb::kwargs>(), "above"_a, "interface"_a,
           "below"_a.none() = nb::none(), nb::kw_only(), "threads"_a = 1, "time"_a,
           nb::sig("def __init__(self, above: Body, interface: Interface, below: Body | None = None, *, "
                   "threads: int = 1, **time: object) -> None"),
           nb::keep_alive<1, 2>(), nb::keep_alive<1, 3>(), nb::keep_alive<1, 4>())
      .def("__repr__", &S::text)
      .def("start", &S::start, "t_Pa"_a, "p_Pa"_a, nb::kw_only(), "strength_fraction"_a = 1.0,
           "shear_speed_m_per_s"_a = 0.0,
           "Starts at rest, undeformed, under tractions on the interface: each a number or [interface "
           "nodes]. t_Pa drives the body above to +x, p_Pa > 0 presses it down, the opposite acts on a body "
           "below. strength_fraction: 1, or less down to 0 for nodes weakened for good, mu = mu_k + "
           "strength_fraction "
           "(mu - mu_k). "
           "shear_speed_m_per_s: of a loaded upper edge. Raises CaseError.")
      .def("start_from_statics", &S::start_from_statics, "share"_a.none() = nb::none(), "loading"_a,
           nb::sig("def start_from_statics(self, share: float | None = None, **loading: object) -> None"),
           "Starts from the equilibrium under tilt and shear of the upper edge. share: largest t/(mu_s p) "
           "inside, above 1 for an event that begins by itself; by default what `loading` says, keys of "
           "[loading], as before a triggered event. Raises CaseError, KeyboardInterrupt.")
      .def("set_tractions", &S::set_tractions, "t_Pa"_a, "p_Pa"_a,
           "Tractions on the interface from the next step on, instead of those before, as for start.")
      .def("advance", &S::advance, "n_steps"_a,
           "Takes steps; other Python threads go on meanwhile. Returns their number. Raises BlowUpError, "
           "after which the stepper cannot be used, and KeyboardInterrupt, after which it goes on.")
      .def("run_until", &S::run_until, "time_s"_a,
           "The same up to the first step at or after a time, s since the start.")
      .def("energies", &S::energies,
           "Terms of the energy balance up to the last half (sub-)step, J per metre of thickness, named as "
           "in energy.csv: what is stored, works since the start, and what they leave open.")
      .def_prop_ro(
          "step", [](const S& s) { return s.motion().step(); }, "steps taken")
      .def_prop_ro(
          "time_s", [](const S& s) { return s.motion().time_s(); }, "since the start")
      .def_prop_ro("step_s", [](const S& s) { return s.motion().step_s(); })
      .def_prop_ro(
          "stable_step_s", [](const S& s) { return s.motion().stable_step_s(); },
          "the largest stable step of the smallest cells")
      .def_prop_ro(
          "x_m", [](const S& s) { return view_of(s.x_m(), s); },
          "[interface nodes] position along the interface from the left edge")
      .def_prop_ro(
          "slip_m", [](const S& s) { return s.started(), view_of(s.slip_m(), s); },
          "[interface nodes] displacement along x of the body above relative to what it lies on, since the "
          "start")
      .def_prop_ro("slip_rate_m_per_s", of_interface(&interface::Interface::slip_rate_m_per_s),
                   "[interface nodes] its velocity in the last (sub-)step")
      .def_prop_ro("t_Pa", of_interface(&interface::Interface::t_Pa),
                   "[interface nodes] tangential traction in the last (sub-)step, positive against sliding "
                   "to +x")
      .def_prop_ro("p_Pa", of_interface(&interface::Interface::p_Pa),
                   "[interface nodes] contact pressure, positive in compression")
      .def_prop_ro(
          "law_states", [](const S& s) { return views_of(s.started().interface_state().law_states, s); },
          "of the state variables of the friction law, in its order, [interface nodes] each, at time_s")
      .def(
          "displacement_m", [](const S& s, std::size_t body) { return components_of(s.body(body).u_m(), s); },
          "body"_a = 0, "Of all nodes of a body, 0 above or 1 below: arrays u_x and u_y.")
      .def(
          "velocity_m_per_s",
          [](const S& s, std::size_t body) { return components_of(s.body(body).v_m_per_s(), s); },
          "body"_a = 0,
          "The same of the velocity half a step before, half a sub-step next to the interface.");
}

}  // namespace slipfront::python
