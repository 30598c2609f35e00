// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "advice/info.hpp"
#include "advice/needs.hpp"
#include "advice/outlook.hpp"
#include "base/error.hpp"
#include "base/numbers.hpp"
#include "fracture/tip.hpp"
#include "input/schema.hpp"
#include "interface/friction.hpp"
#include "problem/source.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/laws.hpp"
#include "python/observers.hpp"
#include "python/watcher.hpp"
#include "results/folder.hpp"
#include "run/session.hpp"
#include "setup/meshes.hpp"
#include "solid/operator.hpp"
#include "stability/rupture.hpp"
#include "stability/verdict.hpp"

namespace slipfront::python {
namespace {

using namespace nb::literals;
namespace fs = std::filesystem;

/// A folder that a run of this process works in: the lock of the folder keeps out other processes alone.
class FolderInUse {
 public:
  explicit FolderInUse(const fs::path& dir) : dir_(fs::weakly_canonical(dir)) {
    const std::lock_guard held(mutex);
    if (!all.insert(dir_).second)
      throw UserError(
          "output folder {}: is in use by another run of this process; wait for it or choose another folder",
          dir.string());
  }
  ~FolderInUse() {
    const std::lock_guard held(mutex);
    all.erase(dir_);
  }
  FolderInUse(const FolderInUse&) = delete;
  FolderInUse& operator=(const FolderInUse&) = delete;

 private:
  inline static std::mutex mutex;
  inline static std::set<fs::path> all;
  fs::path dir_;
};

/// Runs into a folder, or goes on in it.
struct Session {
  FolderInUse in_use;
  results::ResultFolder folder;
  run::SessionOptions options;
  Watcher watcher;

  /// @param within  of whose unfinished work it is a part, or null
  Session(const fs::path& dir, std::optional<int> threads, double checkpoint_every_s, nb::object progress,
          const Functions& observers, const results::ResultFolder* within = nullptr)
      : in_use(dir), folder(dir, run::run_work, within), watcher(std::move(progress)) {
    if (threads && *threads < 1) throw UserError("threads is {}; it must be at least 1", *threads);
    options.threads = threads;
    options.keep_every_wall_s = checkpoint_every_s;
    options.observers = observers_of(observers, watcher);
  }

  template <class Work>
  void complete(const Work& work) {
    try {
      const nb::gil_scoped_release unlocked;
      const run::Finished finished = work(watcher.hooks());
      watcher.rethrow();
      run::require_came_to_end(finished.last.result, folder);
    } catch (const Interrupted&) {
      watcher.rethrow();
      throw;
    } catch (const WriteError& error) {
      if (!folder.has_unfinished()) throw;
      throw WriteError("{}; {}", error.what(), run::how_to_resume(folder));
    }
  }
};

/// @param problem  of the case that was given, or with another friction law
void run_problem(const input::CaseFile& given, const Problem& problem, const fs::path& dir, bool overwrite,
                 std::optional<int> threads, double checkpoint_every_s, nb::object progress,
                 const Functions& observers = {}, const results::ResultFolder* within = nullptr) {
  Session session(dir, threads, checkpoint_every_s, std::move(progress), observers, within);
  session.folder.require_empty(overwrite);
  session.complete([&](const run::SessionHooks& hooks) {
    return given.placing_errors([&] {
      advice::require_fit(problem, session.folder.dir());
      return run::run_into(session.folder, problem, session.options, hooks);
    });
  });
}

void run_case(const input::CaseFile& given, const fs::path& dir, bool overwrite, std::optional<int> threads,
              double checkpoint_every_s, nb::object progress, const Functions& observers,
              const results::ResultFolder* within) {
  run_problem(given, problem::make_problem(given.config()), dir, overwrite, threads, checkpoint_every_s,
              std::move(progress), observers, within);
}

/// An array of Python's own: who is called may keep it.
nb::object copied(std::span<const double> values) {
  const std::size_t shape[] = {values.size()};
  return nb::cast(nb::ndarray<nb::numpy, const double, nb::ndim<1>>(values.data(), 1, shape),
                  nb::rv_policy::copy);
}

void fill(std::span<double> to, const nb::object& given, const char* name) {
  const auto values = nb::cast<Values>(given);
  require_length(values, to.size(), name);
  std::copy_n(values.data(), to.size(), to.begin());
}

nb::list list_of(const interface::LawStates& states) {
  nb::list list;
  for (const auto& values : states) list.append(copied(values));
  return list;
}
void fill(interface::LawStates& states, const nb::list& given, const char* name) {
  for (std::size_t k = 0; k < states.size(); ++k) fill(states[k], given[k], name);
}

/// Functions of Python as a law with states.
/// @param initial  with `states`, names and units of states of its own
interface::StateArrayLaw state_law_of(const nb::callable& mu_of, const nb::callable& evolve,
                                      const std::optional<nb::callable>& initial,
                                      const std::vector<std::pair<std::string, std::string>>& states) {
  using interface::LawStates;
  interface::StateArrayLaw law;
  law.coefficient = [&mu_of](std::span<const double> speed_m_per_s, const LawStates& now,
                             std::span<double> mu) {
    const nb::gil_scoped_acquire locked;
    fill(mu, mu_of(copied(speed_m_per_s), *list_of(now)), "mu");
  };
  law.evolve = [&evolve](std::span<const double> speed_m_per_s, double dt_s, LawStates& now) {
    const nb::gil_scoped_acquire locked;
    fill(now, nb::cast<nb::list>(evolve(dt_s, copied(speed_m_per_s), *list_of(now))), "evolve");
  };
  if (!initial) return law;
  law.initial = [&initial](std::span<const double> t_Pa, std::span<const double> p_Pa, LawStates& first) {
    const nb::gil_scoped_acquire locked;
    fill(first, nb::cast<nb::list>((*initial)(copied(t_Pa), copied(p_Pa))), "initial");
  };
  for (const auto& [name, unit] : states)
    law.states.push_back({name.c_str(), unit.c_str(), "state of the law"});
  return law;
}

}  // namespace

interface::ArrayLaw law_of(const nb::callable& mu_of) {
  return
      [&mu_of](std::span<const double> speed_m_per_s, std::span<const double> slip_m, std::span<double> mu) {
        const nb::gil_scoped_acquire locked;
        fill(mu, mu_of(copied(speed_m_per_s), copied(slip_m)), "mu");
      };
}

namespace {

/// By a law in Python. One thread: all of them would wait for Python's lock.
void run_by_law(const input::CaseFile& given, const fs::path& dir, const nb::callable& mu_of,
                const std::optional<nb::callable>& evolve, const std::optional<nb::callable>& initial,
                const std::vector<std::pair<std::string, std::string>>& states, nb::object progress) {
  Problem problem = problem::make_problem(given.config());
  const Key key("friction.law");
  if (evolve) {
    if (!problem.friction.law.has_states())
      throw UserError("evolve: {} = {} has no state variable; choose rate_and_state_*", key,
                      problem.friction.law.name());
    problem.friction.law.set_function(state_law_of(mu_of, *evolve, initial, states));
  } else {
    if (problem.friction.law.has_states())
      throw UserError("{} = {} has a state, which mu alone does not change; give evolve", key,
                      problem.friction.law.name());
    if (problem.heals())
      throw UserError("{} changes mu_s, which a law in Python does not see; remove it",
                      Key("sequence.healing_per_e_fold"));
    problem.friction.law.set_function(law_of(mu_of));
  }
  run_problem(given, problem, dir, false, 1, infinity, std::move(progress));
}

void resume(const fs::path& dir, const input::CaseFile* given, std::optional<int> threads,
            double checkpoint_every_s, nb::object progress, const Functions& observers) {
  Session session(dir, threads, checkpoint_every_s, std::move(progress), observers);
  std::optional<Problem> expected;
  if (given != nullptr) expected = problem::make_problem(given->config());
  const auto* problem = expected ? &*expected : nullptr;
  if (run::is_done(session.folder, problem)) return;
  session.complete([&](const run::SessionHooks& hooks) {
    return run::resume(session.folder, problem, session.options, hooks);
  });
}

stability::WellPosedness well_posedness(const input::CaseFile& given, double pressure_Pa,
                                        double element_size_m, double longest_wavelength_m) {
  const auto& config = given.config();
  return stability::well_posedness(materials_of(problem::bodies_of(config)), config.friction, pressure_Pa,
                                   element_size_m, longest_wavelength_m, config.regularisation);
}

/// Stable step of the case's material in squares, without its geometry.
double stable_step_s(const input::CaseFile& given, double element_size_m) {
  const auto& material = given.config().material;
  return solid::stable_step_s(solid::frequency_of_squares_rad_per_s(element_size_m, material),
                              material.stiffness_damping_s);
}

nb::list notes_of(const Diagnostics& diagnostics) {
  const auto note = nb::module_::import_("slipfront.notes").attr("Note");
  nb::list notes;
  for (const auto& [kind, text] : diagnostics) notes.append(note(name(kind), text));
  return notes;
}

void bind_speeds(nb::module_& module) {
  nb::class_<solid::WaveSpeeds>(module, "WaveSpeeds", "Wave speeds of a material.")
      .def_ro("c_L_m_per_s", &solid::WaveSpeeds::c_L, "longitudinal, in the plane chosen")
      .def_ro("c_S_m_per_s", &solid::WaveSpeeds::c_S, "shear")
      .def_ro("c_R_m_per_s", &solid::WaveSpeeds::c_R, "Rayleigh, on a free surface");
}

void bind_verdict(nb::module_& module) {
  using W = stability::WellPosedness;
  nb::class_<W>(module, "WellPosedness", "Growth of small waves on uniform sliding: docs/stability.md.")
      .def_ro("statement", &W::statement, "the verdict, one plain line")
      .def_ro("unbounded", &W::unbounded, "growth has no bound as the wavelength goes to zero: ill-posed")
      .def_ro("grid_wavelength_m", &W::grid_wavelength_m, "2 h, the shortest that the mesh carries")
      .def_ro("growth_at_grid_per_s", &W::growth_at_grid_per_s,
              "of the fastest mode there, 0 where none grows")
      .def_ro("weakening_over_radiation", &W::weakening_over_radiation,
              "-mu'(0) p over the radiation damping; above 1 strength drops at once on slip")
      .def_ro("fastest_growth_per_s", &W::fastest_growth_per_s,
              "infinite where unbounded, 0 where none grows, not a number where nothing tells")
      .def_ro("fastest_wavelength_m", &W::fastest_wavelength_m, "0 where growth rises at ever shorter waves")
      .def_ro("longest_wavelength_m", &W::longest_wavelength_m, "of the search")
      .def_ro("growth_in_crossing", &W::growth_in_crossing,
              "fastest growth times h/c_L; above 1 no step follows it")
      .def_ro("damping_length_m", &W::damping_length_m, "beta_R c_L: much shorter waves are overdamped")
      .def_ro("damping_length_over_h", &W::damping_length_over_h);
}

/// What run.json has under `rupture`, by the same names.
void bind_rupture(nb::module_& module) {
  using R = advice::RuptureOutlook;
  using S = stability::Spread;
  nb::class_<S>(module, "NodeSpread", "Over the nodes; NaN where there are none.")
      .def_ro("min", &S::least)
      .def_ro("median", &S::median)
      .def_ro("max", &S::largest);
  nb::class_<R>(module, "Rupture", "What is to be expected of a case's rupture: docs/stability.md.")
      .def_ro("nominal", &R::nominal,
              "whether tractions are not known yet: one node at t = mu_s p under the nominal pressure")
      .def_prop_ro("nodes_inside", [](const R& r) { return r.of_nodes.n_nodes; })
      .def_prop_ro("nodes_that_weaken", [](const R& r) { return r.of_nodes.n_weakening; })
      .def_prop_ro("nodes_above_residual_strength", [](const R& r) { return r.of_nodes.n_driven; })
      .def_prop_ro("nodes_of_S_above_10", [](const R& r) { return r.of_nodes.n_barriers; })
      .def_prop_ro(
          "strength_excess_S", [](const R& r) { return r.of_nodes.S; }, "(mu_s p - t)/(t - mu_k p)")
      .def_prop_ro(
          "seismic_ratio", [](const R& r) { return r.of_nodes.drop_ratio; }, "1/(1 + S)")
      .def_prop_ro(
          "nucleation_length_m", [](const R& r) { return r.of_nodes.nucleation_length_m; },
          "Uenishi, Rice 2003; None where friction does not weaken over a slip")
      .def_prop_ro(
          "griffith_half_length_m", [](const R& r) { return r.of_nodes.griffith_half_length_m; },
          "half the critical crack length, Andrews 1976")
      .def_prop_ro(
          "supershear_half_length_m", [](const R& r) { return r.of_nodes.supershear_half_length_m; },
          "half the crack from which on fronts above c_S can form, Andrews 1985")
      .def_prop_ro(
          "process_zone_m", [](const R& r) { return r.of_nodes.process_zone_m; },
          "at rest, Palmer, Rice 1973")
      .def_ro("process_zone_elements", &R::process_zone_elements)
      .def_prop_ro(
          "unstable_wavelength_m", [](const R& r) { return r.of_nodes.unstable_wavelength_m; },
          "of a law with a state: longer waves of uniform sliding grow")
      .def_ro("tip_slip_rate_m_per_s", &R::tip_slip_rate_m_per_s,
              "of a law with a state: beyond it a node counts as slipping")
      .def_ro("trigger_length_m", &R::trigger_length_m, "of the zone at an edge, or of the patch")
      .def_prop_ro("regime", [](const R& r) { return r.of_nodes.regime; })
      .def_ro("doubts", &R::doubts, "why nothing may rupture, a line each");
}

void bind_info(nb::module_& module) {
  using I = advice::Info;
  using L = setup::ResolvedLoads;
  using M = advice::MeshChoice;
  nb::class_<M>(module, "MeshChoice", "A mesh for a case's process zone.")
      .def_ro("element_size_m", &M::element_size_m)
      .def_ro("coarsenings", &M::coarsenings, "of the plate, and of a base")
      .def_ro("process_zone_elements", &M::process_zone_elements)
      .def_ro("n_nodes", &M::n_nodes);
  nb::class_<L>(module, "Loads",
                "Forces of the interface per metre of thickness, and the displacements that give them.")
      .def_ro("normal_force_N_per_m", &L::normal_force_N_per_m, "before any shear")
      .def_ro("mean_pressure_Pa", &L::mean_pressure_Pa, "the same over plate.width_m")
      .def_ro("tilt_left_m", &L::tilt_left_m, "downward displacement of the top edge at its left end")
      .def_ro("tilt_right_m", &L::tilt_right_m, "the same at its right end")
      .def_ro("shear_force_N_per_m", &L::shear_force_N_per_m, "before triggered events")
      .def_ro("shear_m", &L::shear_m, "displacement of the top edge to +x that gives it")
      .def_ro("critical_shear_force_N_per_m", &L::critical_shear_force_N_per_m,
              "at which t/p first reaches mu_s inside")
      .def_ro("critical_shear_m", &L::critical_shear_m);
  nb::class_<I>(module, "Info", "What a case needs and what is to be expected of it, before it runs.")
      .def_ro("speeds", &I::speeds, "of the plate")
      .def_ro("base_speeds", &I::base_speeds, "of the body below; None on the rigid plane")
      .def_ro("generalised_rayleigh_speed_m_per_s", &I::generalised_rayleigh_speed_m_per_s,
              "of the two bodies, where it exists")
      .def_ro("n_nodes", &I::n_nodes)
      .def_ro("n_cells", &I::n_cells)
      .def_ro("n_interface", &I::n_interface)
      .def_ro("stable_step_s", &I::stable_step_s)
      .def_ro("step_s", &I::step_s)
      .def_ro("substep_s", &I::substep_s)
      .def_ro("n_steps", &I::n_steps, "of the event, to time.end_s")
      .def_ro("node_updates", &I::node_updates, "of the event and of the ramp")
      .def_ro("memory_bytes", &I::memory_bytes, "the larger of statics and event")
      .def_prop_ro("disk_bytes", [](const I& info) { return info.needs.disk_bytes(); })
      .def_ro("expected_s", &I::expected_s, "wall time, at the rate measured on the spot")
      .def_ro("node_updates_per_s", &I::node_updates_per_s, "measured on the spot")
      .def_ro("rupture", &I::rupture, "what is to be expected of it")
      .def_ro("cheapest_mesh", &I::cheapest_mesh,
              "for arrivals to about 1 %, docs/mesh.md; None without a process zone")
      .def_ro("well_posedness", &I::well_posedness, "of slow uniform sliding at the plate's nominal pressure")
      .def_ro("loads", &I::loads, "of a case that gives forces, by its statics; else None")
      .def_prop_ro(
          "notes", [](const I& info) { return notes_of(info.notes); },
          "what is hardly meant, decides physics unasked, or keeps it from a rupture");
}

}  // namespace

void bind_cases(nb::module_& module) {
  using C = input::CaseFile;
  using Overrides = std::vector<input::Override>;
  bind_speeds(module);
  bind_verdict(module);
  bind_rupture(module);
  bind_info(module);
  nb::class_<C>(module, "Case", "A case with its changes, checked.")
      .def(nb::init<const fs::path&, const Overrides&>(), "file"_a, "changes"_a,
           "Of a case file; changes are pairs of dotted key and TOML text.")
      .def_static(
          "from_text",
          [](const std::string& text, const std::string& name, const fs::path& folder,
             const Overrides& changes) {
            return C(input::CaseText{text, name, folder}, changes);
          },
          "text"_a, "name"_a, "folder"_a, "changes"_a,
          "Of a text, which `name` stands for in messages; paths of its tables count from `folder`.")
      .def_prop_ro(
          "toml", [](const C& c) { return problem::source_of(c.config()).case_text; },
          "every key with its value, as case.resolved.toml has it")
      .def_prop_ro(
          "wave_speeds", [](const C& c) { return solid::wave_speeds(c.config().material); }, "of the plate")
      .def_prop_ro(
          "limiting_speed_m_per_s",
          [](const C& c) {
            return fracture::limiting_speed_m_per_s(materials_of(problem::bodies_of(c.config())));
          },
          "at which a front that releases energy ends to be possible below the shear speeds")
      .def_prop_ro("static_coefficient",
                   [](const C& c) { return interface::static_coefficient(c.config().friction); })
      .def(
          "info",
          [](const C& c) {
            return c.placing_errors([&] { return advice::info(problem::make_problem(c.config())); });
          },
          nb::call_guard<nb::gil_scoped_release>(),
          "What follows from the case; only loads that are forces take its statics.")
      .def("stable_step_s", &stable_step_s, "element_size_m"_a,
           "Largest stable step of the case's material in square elements, s.")
      .def("well_posedness", &well_posedness, "pressure_Pa"_a, "element_size_m"_a, "longest_wavelength_m"_a,
           nb::call_guard<nb::gil_scoped_release>(),
           "Of slow uniform sliding of the case's materials under its friction.")
      .def("run", &run_case, "dir"_a, "overwrite"_a, "threads"_a.none(), "checkpoint_every_s"_a,
           "progress"_a.none(), "observers"_a, "within"_a.none() = nb::none(),
           "Runs the case into a folder; progress(part, step, total) is called at times, each of the "
           "observers with an InterfaceState at its interval, s. within: the ResultFolder of whose work the "
           "folder is a part.")
      .def(
          "check",
          [](const C& c) {
            c.placing_errors([&] {
              const auto problem = problem::make_problem(c.config());
              advice::require_memory_fits(problem);
              setup::check(problem);
            });
          },
          "What can be checked without solving anything: memory, geometry; raises CaseError.");
  module.def(
      "run_by_law", &run_by_law, "case"_a, "dir"_a, "mu_of"_a, "evolve"_a.none(), "initial"_a.none(),
      "states"_a, "progress"_a.none(),
      "Runs a case whose coefficient is mu_of(slip_rate_m_per_s, slip_m), arrays [nodes]; or, under a "
      "law with states, mu_of(slip_rate_m_per_s, *states), and evolve(dt_s, slip_rate_m_per_s, *states) "
      "the list of states after a time. states: names and units of states of its own, of which "
      "initial(t_Pa, p_Pa) gives the list.");
  module.def("resume", &resume, "dir"_a, "case"_a.none(), "threads"_a.none(), "checkpoint_every_s"_a,
             "progress"_a.none(), "observers"_a,
             "Goes on with the unfinished run or sequence of a folder, or with a sequence that is complete "
             "and that the case continues; does nothing where it is complete.");
}

}  // namespace slipfront::python
