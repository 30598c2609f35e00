// SPDX-License-Identifier: BSD-3-Clause
#include "input/entries.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <functional>
#include <type_traits>
#include <utility>
#include <variant>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "boundary/machine.hpp"

namespace slipfront::input {
namespace {

Range above(double min) {
  return {min, infinity, true, true};
}
Range above_or_infinite(double min) {
  return {min, infinity, true, false};
}
Range at_least(double min) {
  return {min, infinity, false, true};
}
Range at_least_or_infinite(double min) {
  return {min, infinity, false, false};
}
Range between(double min, double max) {
  return {min, max, false, false};
}
Range strictly_between(double min, double max) {
  return {min, max, true, true};
}
Range any() {
  return {};
}

using Entries = std::vector<Entry>;

template <class Enum>
using Words = std::vector<std::pair<std::string, Enum>>;

Kind kind_of(double) {
  return Kind::number;
}
Kind kind_of(int) {
  return Kind::integer;
}
Kind kind_of(bool) {
  return Kind::flag;
}
Kind kind_of(const std::string&) {
  return Kind::text;
}
Kind kind_of(const std::vector<double>&) {
  return Kind::numbers;
}
Kind kind_of(const std::vector<std::string>&) {
  return Kind::texts;
}

/// Keys of a table of the case file, in their order, that stand for members of a part of a case.
template <class Part>
class Table {
 public:
  /// @param part  a member of Case, or a function from a case, const or not, to the part
  Table(Entries& entries, std::string name, Part part, Stage of_keys)
      : stage(of_keys), entries_(entries), name_(std::move(name)), part_(part) {}

  /// Stage and condition of the keys that follow.
  Stage stage;
  std::optional<Condition> only_with = {};

  /// @param member  of the part, or a function from it to what the key stands for
  template <class Member>
  Entry& add(const char* leaf, Member member, Range range, std::string help) {
    const auto ref = access(member);
    using Held = Type<decltype(ref)>;
    using Read = std::conditional_t<std::is_same_v<Held, int>, std::int64_t, Held>;
    return push({full_key(leaf),
                 kind_of(Held()),
                 range,
                 {},
                 std::move(help),
                 [ref](const Case& config) -> Value { return static_cast<Read>(ref(config)); },
                 [ref](Case& config, const Value& value) {
                   ref(config) = static_cast<Held>(std::get<Read>(value));
                 }});
  }
  template <class Member>
  Entry& add(const char* leaf, Member member, std::string help) {
    return add(leaf, member, any(), std::move(help));
  }

  /// Adds the key of a member that is a std::optional<double>.
  template <class Member>
  Entry& optional(const char* leaf, Member member, Range range, double example, std::string help) {
    const auto ref = access(member);
    auto& entry = push({full_key(leaf),
                        Kind::number,
                        range,
                        {},
                        std::move(help),
                        [ref, example](const Case& config) -> Value { return ref(config).value_or(example); },
                        [ref](Case& config, const Value& value) { ref(config) = std::get<double>(value); }});
    entry.is_set = [ref](const Case& config) { return ref(config).has_value(); };
    return entry;
  }

  /// Adds the key of an enumerator.
  template <class Enum, class Of>
  Entry& word(const char* leaf, Enum Of::*member, std::type_identity_t<Words<Enum>> words, std::string help) {
    const auto ref = access(member);
    std::vector<std::string> names;
    for (const auto& [name, value] : words) names.push_back(name);
    return push({full_key(leaf), Kind::word, any(), std::move(names), std::move(help),
                 [ref, words](const Case& config) -> Value {
                   const auto found = std::ranges::find(words, ref(config), &Words<Enum>::value_type::second);
                   SLIPFRONT_ASSERT(found != words.end(), "an enumerator has no word in the case file");
                   return found->first;
                 },
                 [ref, words](Case& config, const Value& value) {
                   const auto found = std::ranges::find(words, std::get<std::string>(value),
                                                        &Words<Enum>::value_type::first);
                   SLIPFRONT_ASSERT(found != words.end(), "a word was not checked");
                   ref(config) = found->second;
                 }});
  }

  Entry& push(Entry entry) {
    entry.stage = stage;
    entry.only_with = only_with;
    return entries_.emplace_back(std::move(entry));
  }

  std::string full_key(const char* leaf) const { return name_.empty() ? leaf : name_ + "." + leaf; }

 private:
  template <class Ref>
  using Type = std::remove_cvref_t<std::invoke_result_t<Ref, Case&>>;

  template <class Member>
  auto access(Member member) const {
    return [part = part_, member](auto& config) -> decltype(auto) {
      return std::invoke(member, std::invoke(part, config));
    };
  }

  Entries& entries_;
  std::string name_;
  Part part_;
};

LawEntries law_entries(const interface::LawDescription& law) {
  LawEntries entries{law.name, law.help, law.defaults, {}};
  Table table(entries.entries, "friction", &Case::friction, Stage::motion);
  for (const auto& [key, min, max, help] : law.parameters)
    table.add(
        key, [key = key](auto& of) -> decltype(auto) { return of.parameter(key); }, between(min, max), help);
  for (const auto& [key, min, max, help] : law.lists)
    table.push({table.full_key(key),
                Kind::numbers,
                between(min, max),
                {},
                help,
                [key = key](const Case& config) -> Value { return config.friction.list(key); },
                [key = key](Case& config, const Value& value) {
                  config.friction.set_list(key, std::get<std::vector<double>>(value));
                }});
  return entries;
}

Entry friction_law_entry() {
  std::vector<std::string> names;
  std::string help = "friction law";
  for (const LawEntries& law : friction_laws()) {
    names.push_back(law.name);
    help += fmt::format("{} {}: {}", names.size() == 1 ? ";" : ",", law.name, law.help);
  }
  return {"friction.law",
          Kind::word,
          any(),
          names,
          help,
          [](const Case& config) -> Value { return law_of(config).name; },
          [](Case& config, const Value& value) {
            for (const LawEntries& law : friction_laws())
              if (law.name == std::get<std::string>(value)) config.friction = law.defaults;
          }};
}

/// Keys of all laws' parameters, each once.
std::vector<std::string> parameter_keys() {
  std::vector<std::string> keys;
  for (const LawEntries& law : friction_laws())
    for (const Entry& entry : law.entries)
      if (std::ranges::find(keys, leaf_of(entry.key)) == keys.end()) keys.push_back(leaf_of(entry.key));
  return keys;
}

using fronts::SpeedInterval;
using interface::ContactAlgorithm;
using interface::EventKind;
using interface::Nucleation;
using interface::NucleationForm;
using interface::NucleationProfile;
using interface::Ramp;
using interface::Regularisation;
using interface::Relaxed;
using interface::Trigger;
using interface::TriggerForm;
using mesh::Corner;
using mesh::Plate;
using mesh::Sides;
using mesh::Top;
using motion::Precision;
using motion::StepperKind;
using motion::TimeStepping;
using solid::Material;
using solid::Plane;
using statics::Loading;
using statics::LoadingMethod;
using statics::StaticSolver;
using statics::TopEdge;

// Settings on which keys depend.

Condition tilted() {
  return {Message("{} = direct or ramp", Key("loading.method")),
          [](const Case& c) { return !is_prestressed(c); }};
}
bool is_pressed_by_force(const Case& c) {
  return c.loading.mean_pressure_Pa || c.loading.normal_force_N_per_m;
}
Condition pressed_by_force() {
  return {Message("{} or {:leaf}", Key("loading.normal_force_N_per_m"), Key("loading.mean_pressure_Pa")),
          [](const Case& c) { return !is_prestressed(c) && is_pressed_by_force(c); }};
}
Condition pressed_by_displacement() {
  return {Message("{} = direct or ramp and none of {}, {:leaf} and {:leaf}", Key("loading.method"),
                  Key("loading.normal_force_N_per_m"), Key("loading.mean_pressure_Pa"),
                  Key("loading.pressures_Pa")),
          [](const Case& c) {
            return !is_prestressed(c) && !is_pressed_by_force(c) && !c.loading.top_pressure.is_there();
          }};
}
Condition pressed_under_dead_load() {
  return {Message("{} = direct, {} = 0 and neither {} nor {:leaf}", Key("loading.method"),
                  Key("loading.normal_stiffness_Pa_per_m"), Key("loading.normal_force_N_per_m"),
                  Key("loading.mean_pressure_Pa")),
          [](const Case& c) {
            return c.loading.method == LoadingMethod::direct && c.machine.normal_stiffness_Pa_per_m == 0 &&
                   !is_pressed_by_force(c);
          }};
}
/// The other way to give one load.
Condition tilted_without(const char* key, std::optional<double> Loading::*other) {
  return {Message("{} = direct or ramp and neither {} nor {}", Key("loading.method"), Key(key),
                  Key("loading.pressures_Pa")),
          [other](const Case& c) {
            return !is_prestressed(c) && !(c.loading.*other) && !c.loading.top_pressure.is_there();
          }};
}
Condition sheared_without(const char* key, std::optional<double> Loading::*other) {
  return {Message("{} = direct, {} other than spontaneous and no {}", Key("loading.method"),
                  Key("event.kind"), Key(key)),
          [other](const Case& c) {
            return c.loading.method == LoadingMethod::direct && c.event != EventKind::spontaneous &&
                   !(c.loading.*other);
          }};
}
Condition sheared_to_margin() {
  return {Message("{} = direct or ramp and neither {} nor {:leaf}", Key("loading.method"),
                  Key("loading.shear_force_N_per_m"), Key("loading.shear_over_critical")),
          [](const Case& c) { return !is_prestressed(c) && !statics::is_sheared_by_force(c.loading); }};
}
Condition prestressed() {
  return {Message("{} = prestress", Key("loading.method")), is_prestressed};
}
Condition uniform() {
  return {Message("{} = prestress and no {}", Key("loading.method"), Key("prestress.file")),
          [](const Case& c) { return is_prestressed(c) && c.prestress.file.empty(); }};
}
Condition on_body() {
  return {Message("{} = body", Key("base.kind")), [](const Case& c) { return has_base_body(c); }};
}
Condition base_graded() {
  return {Message("{} = body and {} > 0", Key("base.kind"), Key("base.coarsenings")),
          [](const Case& c) { return has_base_body(c) && c.base.plate.coarsenings > 0; }};
}
Condition graded() {
  return {Message("{} > 0", Key("plate.coarsenings")), [](const Case& c) { return c.plate.coarsenings > 0; }};
}
Condition a_body_graded() {
  return {Message("{} > 0 or {} > 0", Key("plate.coarsenings"), Key("base.coarsenings")),
          [](const Case& c) { return graded().holds(c) || base_graded().holds(c); }};
}
Condition nucleated() {
  return {Message("{} = nucleation", Key("event.kind")),
          [](const Case& c) { return c.event == EventKind::nucleation; }};
}
Condition tapered() {
  return {Message("{} = nucleation and {} = tapered", Key("event.kind"), Key("nucleation.profile")),
          [](const Case& c) {
            return c.event == EventKind::nucleation && c.nucleation.profile == NucleationProfile::tapered;
          }};
}
Condition forced() {
  return {Message("{} = nucleation and {} = forced", Key("event.kind"), Key("nucleation.form")),
          [](const Case& c) { return start_of(c).is_forced(); }};
}
Condition overstressed() {
  return {Message("{} = nucleation and {} = overstress", Key("event.kind"), Key("nucleation.form")),
          [](const Case& c) { return start_of(c).overstresses(); }};
}
Condition unloaded_patch() {
  return {Message("{} = nucleation and {} = unloaded", Key("event.kind"), Key("nucleation.form")),
          [](const Case& c) { return start_of(c).unloads_patch(); }};
}
Condition direct() {
  return {Message("{} = direct", Key("loading.method")),
          [](const Case& c) { return c.loading.method == LoadingMethod::direct; }};
}
Condition loaded_on() {
  return {Message("{} = direct and {} = spontaneous", Key("loading.method"), Key("event.kind")),
          [](const Case& c) {
            return c.loading.method == LoadingMethod::direct && c.event == EventKind::spontaneous;
          }};
}
Condition in_sequence() {
  return {Message("{} > 1", Key("sequence.max_events")), is_sequence};
}
Condition in_slow_sequence() {
  return {Message("{} > 1 and a {} with a state", Key("sequence.max_events"), Key("friction.law")), is_slow};
}
Condition in_sticking_sequence() {
  return {Message("{} > 1 and a {} with mu_s", Key("sequence.max_events"), Key("friction.law")),
          [](const Case& c) { return is_sequence(c) && has_static_coefficient(c.friction); }};
}
Condition rounded_by(Corner corner, const char* word) {
  return {Message("{} = {}", Key("plate.corner"), word),
          [corner](const Case& c) { return c.plate.corner == corner; }};
}
Condition relaxed() {
  return {Message("{} = strength or pressure", Key("friction.regularisation")),
          [](const Case& c) { return interface::has_rate(c.regularisation); }};
}
Condition at_edge() {
  return {Message("{} = left or right", Key("event.kind")),
          [](const Case& c) { return is_at_edge(c.event); }};
}
Condition pushed_in_form(TriggerForm form, const char* word) {
  return {Message("{} = left or right and {} = {}", Key("event.kind"), Key("event.trigger_form"), word),
          [form](const Case& c) { return is_at_edge(c.event) && c.trigger.form == form; }};
}
Condition started_by_force() {
  return {Message("{} = left or right and {} other than weakened, or {} = nucleation and {} = overstress or "
                  "unloaded",
                  Key("event.kind"), Key("event.trigger_form"), Key("event.kind"), Key("nucleation.form")),
          [](const Case& c) { return start_of(c).is_by_force(); }};
}
Condition with_table() {
  return {Message("{}", Key("friction.file")),
          [](const Case& c) { return !c.friction_along_x.file.empty(); }};
}
Condition with_random_field() {
  return {Message("{} other than none", Key("friction.random_key")),
          [](const Case& c) { return c.friction_along_x.random_key != "none"; }};
}
Condition with_state() {
  return {Message("{} with a state", Key("friction.law")),
          [](const Case& c) { return c.friction.never_sticks(); }};
}

void add_title(Entries& all) {
  Table root(all, "", std::identity(), Stage::evaluation);
  root.add("title", &Case::title, "title of figures and reports");
}

void add_plate(Entries& all) {
  Table plate(all, "plate", &Case::plate, Stage::mesh);
  plate.add("width_m", &Plate::width_m, above(0), "along the interface");
  plate.add("height_m", &Plate::height_m, above(0), "away from the interface");
  plate.add("element_size_m", &Plate::element_size_m, above(0),
            "side of the square elements; width and height are whole multiples of it");
  plate.add("coarsenings", &Plate::coarsenings, between(0, 20),
            "how often the element size doubles on the way up from the interface, see mesh.md");
  plate.only_with = graded();
  plate.add("fine_height_m", &Plate::fine_height_m, above(0),
            "least height of the elements of element_size_m, next to the interface");
  plate.only_with = {};
  plate.word("corner", &Plate::corner,
             {{"none", Corner::none}, {"relief", Corner::relief}, {"fillet", Corner::fillet}},
             "lower corners: right angles, a shallow arc tangent to the base, or a quarter circle");
  plate.only_with = rounded_by(Corner::relief, "relief");
  plate.add("relief_length_m", &Plate::relief_length_m, above(0),
            "length of the relief's arc along the interface");
  plate.add("relief_height_m", &Plate::relief_height_m, above(0), "rise of the relief's arc at the edge");
  plate.add("relief_depth_m", &Plate::relief_depth_m, above(0),
            "height over which the relief's shift of the nodes fades out");
  plate.only_with = rounded_by(Corner::fillet, "fillet");
  plate.add("fillet_radius_m", &Plate::fillet_radius_m, above(0), "radius of the fillet's quarter circle");
  plate.only_with = {};
  plate.word("sides", &Plate::sides,
             {{"free", Sides::free}, {"periodic", Sides::periodic}, {"absorbing", Sides::absorbing}},
             "vertical edges: free of traction, the right one identical to the left one, or with dashpots "
             "that let waves out; other than free only with plate.corner = none");
  plate.word("top", &Plate::top,
             {{"loaded", Top::loaded}, {"free", Top::free}, {"absorbing", Top::absorbing}},
             "upper edge: displacements prescribed, free of traction, or with dashpots that let waves out");
}

void add_material(Entries& all) {
  Table material(all, "material", &Case::material, Stage::statics);
  material.add("youngs_modulus_Pa", &Material::youngs_modulus_Pa, above(0), "Young's modulus E");
  material.add("poissons_ratio", &Material::poissons_ratio, strictly_between(-1, 0.5), "Poisson's ratio nu");
  material.stage = Stage::motion;
  material.add("density_kg_per_m3", &Material::density_kg_per_m3, above(0), "density rho");
  material.stage = Stage::statics;
  material.word("plane", &Material::plane, {{"stress", Plane::stress}, {"strain", Plane::strain}},
                "plane stress (thin plate) or plane strain");
  material.stage = Stage::motion;
  material.add("stiffness_damping_s", &Material::stiffness_damping_s, at_least(0),
               "Rayleigh damping beta_R: the internal force is K (u + beta_R v)");
}

void add_base(Entries& all) {
  Table base(all, "base", &Case::base, Stage::mesh);
  base.word("kind", &Base::kind, {{"rigid", BaseKind::rigid}, {"body", BaseKind::body}},
            "what the plate lies on: a rigid plane, or a second body of the plate's width and elements, see "
            "two-bodies.md");
  Table body(
      all, "base", [](auto& config) -> auto& { return config.base.plate; }, Stage::mesh);
  body.only_with = on_body();
  body.add("height_m", &Plate::height_m, above(0),
           "depth of the body below, a whole multiple of plate.element_size_m");
  body.add("coarsenings", &Plate::coarsenings, between(0, 20),
           "how often its element size doubles away from the interface, see mesh.md");
  body.only_with = base_graded();
  body.add("fine_height_m", &Plate::fine_height_m, above(0),
           "least height of its elements of plate.element_size_m, next to the interface");
  body.only_with = on_body();
  body.word("sides", &Plate::sides,
            {{"free", Sides::free}, {"periodic", Sides::periodic}, {"absorbing", Sides::absorbing}},
            "its vertical edges; periodic if and only if plate.sides is");
  body.word("bottom", &Plate::top,
            {{"held", Top::loaded}, {"free", Top::free}, {"absorbing", Top::absorbing}},
            "its lower edge: held still, free of traction, or with dashpots that let waves out");
  Table material(
      all, "base", [](auto& config) -> auto& { return config.base.material; }, Stage::statics);
  material.only_with = on_body();
  material.add("youngs_modulus_Pa", &Material::youngs_modulus_Pa, above(0),
               "its Young's modulus; its plane is material.plane");
  material.add("poissons_ratio", &Material::poissons_ratio, strictly_between(-1, 0.5), "its Poisson's ratio");
  material.stage = Stage::motion;
  material.add("density_kg_per_m3", &Material::density_kg_per_m3, above(0), "its density");
  material.add("stiffness_damping_s", &Material::stiffness_damping_s, at_least(0), "its Rayleigh damping");
}

void add_loading(Entries& all) {
  Table loading(all, "loading", &Case::loading, Stage::statics);
  loading.only_with = pressed_by_displacement();
  loading.add("tilt_left_m", &Loading::tilt_left_m, at_least(0),
              "downward displacement of the top edge at its left end, linear between the ends");
  loading.add("tilt_right_m", &Loading::tilt_right_m, at_least(0), "the same at its right end");
  loading.only_with = tilted_without("loading.mean_pressure_Pa", &Loading::mean_pressure_Pa);
  loading.optional("normal_force_N_per_m", &Loading::normal_force_N_per_m, above(0), 1e5,
                   "force that presses the interface before any shear, per metre of thickness, instead of "
                   "the two displacements, which are found");
  loading.only_with = tilted_without("loading.normal_force_N_per_m", &Loading::normal_force_N_per_m);
  loading.optional("mean_pressure_Pa", &Loading::mean_pressure_Pa, above(0), 1e6,
                   "mean pressure of the interface before any shear, normal force over plate.width_m, "
                   "instead of the two displacements, which are found");
  loading.only_with = pressed_under_dead_load();
  loading.add(
      "pressures_x_m", [](auto& l) -> auto& { return l.top_pressure.x_m; }, at_least(0),
      "places along the top edge, ascending, of pressures_Pa");
  auto& pressures = loading.add(
      "pressures_Pa", [](auto& l) -> auto& { return l.top_pressure.p_Pa; }, at_least(0),
      "pressure on the top edge there, which stays, instead of the two displacements, linear between, "
      "constant beyond the first and the last");
  pressures.is_set = [](const Case& c) { return c.loading.top_pressure.is_there(); };
  pressures.is_never_left_out = true;
  loading.only_with = pressed_by_force();
  loading.add("tilt_difference_m", &Loading::tilt_difference_m, any(),
              "downward displacement of the top edge at its left end less that at its right end");
  loading.only_with = tilted();
  loading.word("top_during_tilt", &Loading::top_during_tilt,
               {{"held", TopEdge::held}, {"free", TopEdge::free}},
               "whether the top edge may move along x while it is tilted");
  loading.only_with = {};
  loading.word(
      "method", &Loading::method,
      {{"direct", LoadingMethod::direct},
       {"ramp", LoadingMethod::ramp},
       {"prestress", LoadingMethod::prestress}},
      "state before the event: tilt and shear to the critical one by static equilibria, the same by explicit "
      "dynamics with the top moving, or given tractions of the interface with the plate undeformed at rest");
  loading.only_with = tilted();
  loading.word("solver", &Loading::solver,
               {{"auto", StaticSolver::automatic},
                {"direct", StaticSolver::direct},
                {"iterative", StaticSolver::iterative}},
               "static equilibria by a sparse factorisation, by conjugate gradients with a multigrid "
               "preconditioner, or by the one of both that suits the number of elements");
  loading.stage = Stage::motion;
  loading.only_with = {};
  loading.add(
      "shear_speed_m_per_s", &Loading::shear_speed_m_per_s, at_least(0),
      "speed of the top edge to +x in a ramp and during the event, or of a pusher between events; below c_L; "
      "0 holds it still, which a ramp and event.kind = spontaneous do not allow");
  loading.stage = Stage::statics;
  loading.only_with = tilted();
  loading.add("edge_margin_m", &Loading::edge_margin_m, at_least(0),
              "length at each end of the contact that does not count for the critical shear");
  loading.only_with = sheared_to_margin();
  loading.add("critical_margin", &Loading::critical_margin, strictly_between(0, 1),
              "subcritical state, in which forced events begin, at t/p = (1 - margin) mu_s; "
              "supercritical state of a spontaneous event at (1 + margin) mu_s");
  loading.only_with = sheared_without("loading.shear_over_critical", &Loading::shear_over_critical);
  loading.optional(
      "shear_force_N_per_m", &Loading::shear_force_N_per_m, above(0), 1e5,
      "t summed over the interface in the subcritical state, per metre of thickness, instead of the "
      "margin; at most the critical one");
  loading.only_with = sheared_without("loading.shear_force_N_per_m", &Loading::shear_force_N_per_m);
  loading.optional(
      "shear_over_critical", &Loading::shear_over_critical, {0, 1, true, false}, 0.9,
      "the same sum over the critical one, at which t/p first reaches mu_s inside, instead of the margin");
}

void add_pusher(Entries& all) {
  Table loading(
      all, "loading", [](auto& config) -> auto& { return config.machine.pusher; }, Stage::statics);
  loading.only_with = direct();
  loading.add("pusher_from_m", &boundary::Pusher::from_m, at_least(0),
              "with pusher_to_m: the height from which");
  loading.add(
      "pusher_to_m", &boundary::Pusher::to_m, at_least(0),
      "and to which the left side is pushed to +x instead of the top edge, which then moves freely along "
      "x; nodes there do not move along x by themselves, and the pusher stays during an event; 0: none");
}

void add_machine(Entries& all) {
  Table loading(
      all, "loading", [](auto& config) -> auto& { return config.machine; }, Stage::statics);
  loading.only_with = direct();
  loading.add("shear_stiffness_Pa_per_m", &boundary::Machine::shear_stiffness_Pa_per_m, above_or_infinite(0),
              "stiffness of the loading machine along x, in series with the top edge or the pusher: mean "
              "stress on that edge, or under the pusher, per metre of the machine's motion; inf: rigid");
  loading.add(
      "mass_kg_per_m2", &boundary::Machine::mass_kg_per_m2, at_least(0),
      "mass of the machine that moves along x with the top edge or the pusher, behind the spring, over "
      "the same area; it counts in events alone");
  loading.add(
      "normal_stiffness_Pa_per_m", &boundary::Machine::normal_stiffness_Pa_per_m, at_least_or_infinite(0),
      "the same downwards, mean stress on the top edge, once that is tilted; 0: a dead load, inf: the "
      "edge stays at its height");
}

void add_prestress(Entries& all) {
  Table prestress(all, "prestress", &Case::prestress, Stage::tractions);
  prestress.only_with = uniform();
  prestress.optional(
      "t_Pa", &Prestress::t_Pa, any(), 1e6,
      "uniform tangential traction, positive where it drives the plate to +x; under a friction "
      "law with a state it may follow, see friction/rate_and_state.md");
  prestress.add("p_Pa", &Prestress::p_Pa, above(0), "uniform pressure");
  prestress.only_with = prestressed();
  prestress.add("t_rate_Pa_per_s", &Prestress::t_rate_Pa_per_s, any(),
                "t grows at this rate during the event, everywhere alike");
  prestress.add("p_rate_Pa_per_s", &Prestress::p_rate_Pa_per_s, any(), "p grows at this rate");
  prestress.add("file", &Prestress::file,
                "CSV table x_m,t_Pa,p_Pa of both instead, linear between its rows, from the first to the "
                "last node of the interface; its path is relative to the case file");
}

void add_friction(Entries& all) {
  Table friction(all, "friction", &Case::regularisation, Stage::motion);
  friction.push(friction_law_entry());
  friction.word(
      "regularisation", &Regularisation::relaxed,
      {{"none", Relaxed::none},
       {"strength", Relaxed::strength},
       {"pressure", Relaxed::pressure},
       {"initial_pressure", Relaxed::initial_pressure}},
      "what follows changes of pressure with a delay, at the rate (|v| + v*)/L + 1/t*; "
      "initial_pressure: nothing follows, the coefficient multiplies the pressure before the event");
  friction.only_with = relaxed();
  friction.add("relaxation_length_m", &Regularisation::length_m, above_or_infinite(0), "L of that rate");
  friction.add("relaxation_slip_rate_m_per_s", &Regularisation::slip_rate_m_per_s, at_least(0),
               "v* of that rate");
  friction.add("relaxation_time_s", &Regularisation::time_s, above_or_infinite(0), "t* of that rate");
  Table tip(all, "friction", std::identity(), Stage::motion);
  tip.only_with = with_state();
  tip.optional(
      "tip_slip_rate_m_per_s", &Case::tip_slip_rate_m_per_s, above(0), 0.1,
      "slip rate beyond which a node counts as slipping: a front's tip. Without it that at which the "
      "direct effect is as steep as the radiation damping, 2 c_S a p/G between equal bodies, at least "
      "10 V_i");
  Table along_x(all, "friction", &Case::friction_along_x, Stage::motion);
  along_x.add("file", &FrictionAlongX::file,
              "CSV table x_m and any of the law's parameters along the interface, from its first to its last "
              "node, see friction-along-x.md; its path is relative to the case file");
  along_x.only_with = with_table();
  along_x.word("between_rows", &FrictionAlongX::between_rows,
               {{"linear", BetweenRows::linear}, {"stepwise", BetweenRows::stepwise}},
               "values between the table's rows: linear, or those of the last row at or before x");
  along_x.only_with = {};
  auto& random_key =
      along_x.add("random_key", &FrictionAlongX::random_key,
                  "parameter of the law that is multiplied along x by 1 + random_share f(x), f a Gaussian "
                  "random field of mean 0 and variance 1, see friction-along-x.md");
  random_key.kind = Kind::word;
  random_key.words = parameter_keys();
  random_key.words.insert(random_key.words.begin(), "none");
  along_x.only_with = with_random_field();
  along_x.add("random_share", &FrictionAlongX::random_share, at_least(0),
              "standard deviation of the parameter over its value");
  along_x.add("random_correlation_length_m", &FrictionAlongX::random_correlation_length_m, above(0),
              "l of the field's correlation exp(-x^2/(2 l^2))");
  along_x.add("random_seed", &FrictionAlongX::random_seed, between(0, 1e9),
              "which field; another one for each seed");
}

void add_event(Entries& all) {
  Table contact(all, "contact", std::identity(), Stage::motion);
  contact.word(
      "algorithm", &Case::contact,
      {{"direct", ContactAlgorithm::direct}, {"predictor_corrector", ContactAlgorithm::predictor_corrector}},
      "pressure that closes the gap within the step, or normal velocity locked in contact with friction on "
      "the predicted slip rate");
  Table event(all, "event", std::identity(), Stage::event);
  event.word("kind", &Case::event,
             {{"none", EventKind::none},
              {"spontaneous", EventKind::spontaneous},
              {"left", EventKind::left},
              {"right", EventKind::right},
              {"nucleation", EventKind::nucleation}},
             "start of the event: nothing, shear just past the critical one, a trigger at an edge, or a "
             "nucleation patch");
  Table trigger(all, "event", &Case::trigger, Stage::event);
  trigger.only_with = at_edge();
  trigger.word(
      "trigger_form", &Trigger::form,
      {{"added", TriggerForm::added},
       {"raised", TriggerForm::raised},
       {"weakened", TriggerForm::weakened},
       {"unloaded", TriggerForm::unloaded}},
      "tangential traction added, a multiple of what is missing to the strength, or raised to a multiple of "
      "the strength, both in the direction in which the zone is loaded; or mu = mu_k from the start; or "
      "pressure taken "
      "away");
  trigger.add("trigger_zone_m", &Trigger::zone_m, above(0),
              "length of the trigger zone, inward from the outermost node in contact");
  trigger.only_with = pushed_in_form(TriggerForm::added, "added");
  trigger.add("trigger_over_missing", &Trigger::amount, at_least(0),
              "the added traction over what is missing to the strength, mu_s p_s - t_s: 1 just reaches it");
  trigger.only_with = pushed_in_form(TriggerForm::raised, "raised");
  trigger.add("trigger_over_strength", &Trigger::amount, at_least(0),
              "the traction to which t_s is raised over the strength, mu_s p_s: 1 just reaches it");
  trigger.only_with = pushed_in_form(TriggerForm::unloaded, "unloaded");
  trigger
      .add("trigger_unloading", &Trigger::amount, {0, 1, true, false},
           "the pressure that is taken away over p_s; 1: all of it")
      .has_to_be_set = true;
  trigger.only_with = started_by_force();
  trigger.add("trigger_ramp_s", &Trigger::ramp_s, at_least(0), "time over which the trigger rises");
  trigger.word(
      "trigger_ramp", &Trigger::ramp, {{"linear", Ramp::linear}, {"smooth", Ramp::smooth}},
      "how it rises: linearly, or as exp[(t - T)^2/(t (t - 2 T))], whose derivatives are continuous");
  trigger.add("trigger_duration_s", &Trigger::duration_s, above_or_infinite(0),
              "the trigger is taken away this long after its start");
  Table nucleation(all, "nucleation", &Case::nucleation, Stage::event);
  nucleation.only_with = nucleated();
  nucleation.word(
      "form", &Nucleation::form,
      {{"weakened", NucleationForm::weakened},
       {"forced", NucleationForm::forced},
       {"overstress", NucleationForm::overstress},
       {"unloaded", NucleationForm::unloaded}},
      "patch with a profile B: mu = mu_k + (1 - B) (mu of the law - mu_k); the same in time from its "
      "centre, mu of the law but at most mu_s - f B (mu_s - mu_k), f from 0 to 1; or an added "
      "tangential traction, with the trigger's ramp and duration; or pressure taken away, as by a wire that "
      "bursts, with the same");
  nucleation.add("x_m", &Nucleation::x_m, any(), "centre of the patch, from the plate's left edge");
  nucleation.word("profile", &Nucleation::profile,
                  {{"tapered", NucleationProfile::tapered}, {"smooth", NucleationProfile::smooth}},
                  "B(r) over the distance from the centre: 1 up to half_length_m and then down over taper_m, "
                  "or exp[r^2/(r^2 - R^2)] up to R = half_length_m, whose derivatives are continuous");
  nucleation.add("half_length_m", &Nucleation::half_length_m, at_least(0),
                 "B = 1 within this distance of the centre; smooth: R");
  nucleation.only_with = tapered();
  nucleation.add("taper_m", &Nucleation::taper_m, at_least(0),
                 "B falls to 0 over this length, as half a cosine wave");
  nucleation.only_with = forced();
  nucleation
      .add("front_speed_m_per_s", &Nucleation::front_speed_m_per_s, above(0),
           "speed at which the patch grows from its centre")
      .has_to_be_set = true;
  nucleation
      .add("weakening_time_s", &Nucleation::weakening_time_s, at_least(0),
           "time over which friction falls at a node that the patch has reached, linearly")
      .has_to_be_set = true;
  nucleation.only_with = overstressed();
  nucleation.add("overstress_Pa", &Nucleation::overstress_Pa, any(), "added tangential traction where B = 1");
  nucleation.only_with = unloaded_patch();
  nucleation.add("unloading_Pa", &Nucleation::unloading_Pa, above(0),
                 "pressure that is taken away where B = 1; where it is more than there is, contact opens");
}

void add_sequence(Entries& all) {
  Table sequence(all, "sequence", &Case::sequence, Stage::motion);
  sequence.only_with = loaded_on();
  sequence.add("max_events", &Sequence::max_events, between(1, 1e6),
               "events at most: after each the top edge moves on, through static equilibria, until the next "
               "begins; 1 for a single event");
  sequence.only_with = in_sequence();
  sequence.add(
      "end_s", &Sequence::end_s, above_or_infinite(0),
      "time from the tilt on at which the loading ends: the top edge moves at loading.shear_speed_m_per_s");
  sequence.add("to_global_sliding", &Sequence::to_global_sliding,
               "end with the first event in which all nodes slip but those within loading.edge_margin_m");
  sequence.add(
      "times_s", [](auto& s) -> auto& { return s.path.times_s; }, above(0),
      "times since normal loading, ascending, at which the loading has reached shears_m; none: it moves at "
      "loading.shear_speed_m_per_s, as during each event in any case. It ends with the last one");
  sequence.add(
      "shears_m", [](auto& s) -> auto& { return s.path.shears_m; }, at_least(0),
      "displacements along x of the top edge, the pusher or the machine then, none less than the one before; "
      "linear between, from 0");
  sequence.only_with = in_sticking_sequence();
  sequence.add("healing_per_e_fold", &Sequence::healing_per_e_fold, at_least(0),
               "B of mu_s + B ln(1 + t/t_0), the coefficient of a node that has rested for t; 0: it has "
               "healed at once");
  sequence.add("healing_time_s", &Sequence::healing_time_s, above(0), "t_0 of it");
  sequence.only_with = in_slow_sequence();
  sequence.optional(
      "inertia_slip_rate_m_per_s", &Sequence::inertia_slip_rate_m_per_s, above(0), 1e-3,
      "slip rate of the fastest node at which an event begins; it ends when for time.quiet_s "
      "none is faster than half of it. Without it a tenth of friction.tip_slip_rate_m_per_s, and of "
      "no more than where radiation takes over");
}

void add_time(Entries& all) {
  Table time(all, "time", &Case::time, Stage::motion);
  time.add("step_factor", &TimeStepping::step_factor, above(0),
           "time step over the largest stable one; above 1 only with time.allow_unstable");
  time.add("allow_unstable", &TimeStepping::allow_unstable, "accept a step_factor above 1");
  time.word("stepper", &TimeStepping::stepper, {{"fast", StepperKind::fast}, {"plain", StepperKind::plain}},
            "how steps are computed; plain: cell by cell as the scheme is written down, for experiments with "
            "it, twenty to a hundred times slower, with loading.method not ramp");
  time.word(
      "precision", &TimeStepping::precision,
      {{"double", Precision::double_precision}, {"single", Precision::single_precision}},
      "numbers for rows of the plate beyond those next to the interface; single with plate.sides = free");
  time.add("interface_rows", &TimeStepping::interface_rows, between(1, 1e6),
           "rows of cells next to the interface that are sub-cycled");
  time.add("interface_substeps", &TimeStepping::interface_substeps, between(1, 1e6),
           "sub-steps per time step there; 1 for none");
  time.only_with = a_body_graded();
  time.add("local_steps", &TimeStepping::local_steps, "larger elements take larger time steps");
  time.only_with = {};
  time.add("end_s", &TimeStepping::end_s, above(0), "the event ends, unless it has come to rest before");
  time.add("quiet_s", &TimeStepping::quiet_s, above_or_infinite(0),
           "the event ends earlier when no node has slipped for this long; in a sequence it has to");
}

void add_evaluation(Entries& all) {
  Table fronts(all, "fronts", &Case::fronts, Stage::evaluation);
  fronts.add("l_star_m", &FrontSettings::l_star_m, above(0),
             "length l* over which the front speed is taken; one element where that is longer");
  fronts.word("speed_interval", &FrontSettings::speed_interval,
              {{"centred", SpeedInterval::centred}, {"approach", SpeedInterval::approach}},
              "where l* lies: centred at the node, or from where t_d, p_d are taken to the node");
  fronts.add("arrest_time_s", &FrontSettings::arrest_time_s, above(0),
             "a tip that waits longer than this for its next onset has arrested; where that is longer, than "
             "3 times what a front takes for min_length_m at the median speed");
  fronts.add("min_length_m", &FrontSettings::min_length_m, at_least(0),
             "a shorter path is not a front of its own");
  fronts.add("crack_share", &FrontSettings::crack_share, between(0, 1),
             "crack-like above this share of slipping length to distance run");
  fronts.add("pulse_share", &FrontSettings::pulse_share, between(0, 1), "pulse-like below it");
  fronts.add("trigger_margin_m", &FrontSettings::trigger_margin_m, at_least(0),
             "t_d and p_d are left out within the trigger zone or nucleation patch plus this");
  Table output(all, "output", &Case::output, Stage::evaluation);
  output.add("history_interval_s", &Output::history_interval_s, above(0),
             "spacing of the rows of interface.h5");
  output.add("snapshot_times_s", &Output::snapshot_times_s, at_least(0),
             "ascending times of the whole-plate fields in fields.vtkhdf");
  output.add("snapshot_interval_s", &Output::snapshot_interval_s, above_or_infinite(0),
             "further ones at its multiples, from time 0 on; one step where that is longer");
  output.add("snapshot_stress", &Output::snapshot_stress,
             "strain and stress at the cells' centres with them, which doubles the file");
  output.add("energy_interval_s", &Output::energy_interval_s, above(0),
             "spacing of the rows of energy.csv; one step where that is longer");
  output.add("moment_rate", &Output::moment_rate,
             "potency and moment rate in moment_rate.h5, at the interval of the history, see files.md");
  Table probes(all, "probes", &Case::probes, Stage::evaluation);
  probes.add("x_m", &Probes::x_m, any(),
             "places at which motion, strain and stress are recorded in probes.h5, see files.md: along the "
             "interface, from the plate's left edge");
  probes.add("y_m", &Probes::y_m, any(), "of the same places: above the interface, below 0 in the base");
  probes.add("names", &Probes::names,
             "of the same places, all different; without them their numbers, from 1");
  probes.add("interval_s", &Probes::interval_s, above(0),
             "spacing of the rows of probes.h5, each at the step nearest after its time; one step where that "
             "is longer");
}

/// In the order of the case file.
Entries make_common_entries() {
  Entries all;
  add_title(all);
  add_plate(all);
  add_material(all);
  add_base(all);
  add_loading(all);
  add_pusher(all);
  add_machine(all);
  add_prestress(all);
  add_friction(all);
  add_event(all);
  add_sequence(all);
  add_time(all);
  add_evaluation(all);
  return all;
}

}  // namespace

bool applies(const Entry& entry, const Case& config) {
  return !entry.only_with || entry.only_with->holds(config);
}

bool has_value(const Entry& entry, const Case& config) {
  return !entry.is_set || entry.is_set(config);
}

bool contains(const Range& range, double value) {
  const bool above_min = range.min_open ? value > range.min : value >= range.min;
  const bool below_max = range.max_open ? value < range.max : value <= range.max;
  return above_min && below_max;
}

std::string describe(const Range& range, const std::string& unit) {
  const std::string suffix = unit.empty() ? "" : " " + unit;
  std::string lower, upper;
  if (range.min > -infinity)
    lower = fmt::format("{} {}{}", range.min_open ? "greater than" : "at least", range.min, suffix);
  if (range.max < infinity)
    upper = fmt::format("{} {}{}", range.max_open ? "less than" : "at most", range.max, suffix);
  else if (!range.max_open)
    upper = "may be inf";
  return lower + (lower.empty() || upper.empty() ? "" : " and ") + upper;
}

const std::vector<Magnitudes>& all_magnitudes() {
  static const std::vector<Magnitudes> all = {
      {"m", 1e-12, 1e6},     {"s", 1e-15, 1e12},    {"Pa", 1e-6, 1e15},  {"kg/m3", 1e-6, 1e6},
      {"kg/m2", 1e-9, 1e12}, {"Pa/s", 1e-12, 1e18}, {"m/s", 1e-30, 1e6}, {"m2/s2", 1e-12, 1e12},
      {"N/m", 1e-12, 1e18},  {"Pa/m", 1e-6, 1e24},  {"", 1e-18, 1e9}};
  return all;
}

const Magnitudes& magnitudes_of(std::string_view unit) {
  const auto& all = all_magnitudes();
  const auto found = std::ranges::find(all, unit, &Magnitudes::unit);
  return found == all.end() ? all.back() : *found;
}

NameAndUnit parts_of(std::string_view key) {
  static constexpr std::array<std::string_view, 9> units = {"m", "m2", "m3", "s", "s2", "Pa", "kg", "N", "J"};
  NameAndUnit parts{leaf_of(std::string(key)), ""};
  auto& [name, unit] = parts;
  if (name.rfind("mu_", 0) == 0) return parts;
  bool after_unit = false;  // of the part to the right
  while (true) {
    const std::size_t bar = name.rfind('_');
    if (bar == std::string::npos) break;
    const std::string part = name.substr(bar + 1);
    if (part == "per" && after_unit) {
      unit = "/" + unit;
      after_unit = false;
    } else if (!after_unit && std::find(units.begin(), units.end(), part) != units.end()) {
      unit = part + unit;
      after_unit = true;
    } else {
      break;
    }
    name.resize(bar);
  }
  if (unit.rfind('/', 0) == 0) unit = "1" + unit;
  return parts;
}

std::string unit_of(std::string_view key) {
  return parts_of(key).unit;
}

const std::vector<LawEntries>& friction_laws() {
  static const std::vector<LawEntries> laws = [] {
    std::vector<LawEntries> all;
    for (const auto& law : interface::law_descriptions()) all.push_back(law_entries(law));
    return all;
  }();
  return laws;
}

const LawEntries& law_of(const Case& config) {
  return *std::ranges::find(friction_laws(), config.friction.name(), &LawEntries::name);
}

const std::vector<Entry>& common_entries() {
  static const std::vector<Entry> entries = make_common_entries();
  return entries;
}

const Entry* find_entry(const std::vector<Entry>& entries, const std::string& key) {
  const auto found = std::ranges::find(entries, key, &Entry::key);
  return found == entries.end() ? nullptr : &*found;
}

const Entry& entry_of(const std::string& key) {
  const Entry* entry = find_entry(common_entries(), key);
  SLIPFRONT_ASSERT(entry != nullptr, "no such key");
  return *entry;
}

std::vector<Entry> entries_of(const Case& config) {
  std::vector<Entry> entries;
  for (const Entry& entry : common_entries()) {
    if (!applies(entry, config)) continue;
    entries.push_back(entry);
    if (entry.key != "friction.law") continue;
    const auto& parameters = law_of(config).entries;
    entries.insert(entries.end(), parameters.begin(), parameters.end());
  }
  return entries;
}

std::string text_of_stages(const Case& config, const std::vector<Stage>& stages) {
  const auto counts = [&](Stage stage) { return std::ranges::count(stages, stage) > 0; };
  std::string text;
  for (const Entry& entry : entries_of(config))
    if (counts(entry.stage) && has_value(entry, config))
      text += fmt::format("{} = {}\n", entry.key, toml_text(entry.get(config)));
  if (counts(Stage::tractions)) text += config.prestress.table.text;
  if (counts(Stage::motion)) text += config.friction_along_x.table.text;
  return text;
}

std::string with_unit(const std::string& number, const std::string& unit) {
  return unit.empty() ? number : number + " " + unit;
}

std::string table_of(const std::string& key) {
  const std::size_t dot = key.rfind('.');
  return dot == std::string::npos ? "" : key.substr(0, dot);
}

std::string leaf_of(const std::string& key) {
  const std::size_t dot = key.rfind('.');
  return dot == std::string::npos ? key : key.substr(dot + 1);
}

}  // namespace slipfront::input
