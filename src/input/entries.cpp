// SPDX-License-Identifier: BSD-3-Clause
#include "input/entries.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>
#include <variant>

#include "base/error.hpp"

namespace slipfront::input {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Range above(double min) {
  return {min, infinity, true, true};
}
Range above_or_infinite(double min) {
  return {min, infinity, true, false};
}
Range at_least(double min) {
  return {min, infinity, false, true};
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

/// Access to a member of a member of a case, const or not.
template <class Part, class Member>
auto at(Part Case::*part, Member Part::*member) {
  return [ part, member ](auto& config) -> auto& {
    return config.*part.*member;
  };
}
template <class Part, class Inner, class Member>
auto at(Part Case::*part, Inner Part::*inner, Member Inner::*member) {
  return [ part, inner, member ](auto& config) -> auto& {
    return config.*part.*inner.*member;
  };
}
template <class Member>
auto at(Member Case::*member) {
  return [member](auto& config) -> auto& {
    return config.*member;
  };
}

template <class Ref>
Entry number(std::string key, Ref ref, Range range, std::string help) {
  return {std::move(key),
          Kind::number,
          range,
          {},
          std::move(help),
          [ref](const Case& config) -> Value { return ref(config); },
          [ref](Case& config, const Value& value) { ref(config) = std::get<double>(value); }};
}

/// Of a member that is a std::optional<double>.
template <class Ref>
Entry optional_number(std::string key, Ref ref, Range range, double example, std::string help) {
  Entry entry{std::move(key),
              Kind::number,
              range,
              {},
              std::move(help),
              [ref, example](const Case& config) -> Value { return ref(config).value_or(example); },
              [ref](Case& config, const Value& value) { ref(config) = std::get<double>(value); }};
  entry.is_set = [ref](const Case& config) { return ref(config).has_value(); };
  return entry;
}

template <class Ref>
Entry integer(std::string key, Ref ref, Range range, std::string help) {
  return {std::move(key),
          Kind::integer,
          range,
          {},
          std::move(help),
          [ref](const Case& config) -> Value { return static_cast<std::int64_t>(ref(config)); },
          [ref](Case& config, const Value& value) {
            ref(config) = static_cast<int>(std::get<std::int64_t>(value));
          }};
}

template <class T, class Ref>
Entry plain(Kind kind, std::string key, Ref ref, Range range, std::string help) {
  return {std::move(key),
          kind,
          range,
          {},
          std::move(help),
          [ref](const Case& config) -> Value { return ref(config); },
          [ref](Case& config, const Value& value) { ref(config) = std::get<T>(value); }};
}

template <class Ref>
Entry flag(std::string key, Ref ref, std::string help) {
  return plain<bool>(Kind::flag, std::move(key), ref, any(), std::move(help));
}

template <class Ref>
Entry text(std::string key, Ref ref, std::string help) {
  return plain<std::string>(Kind::text, std::move(key), ref, any(), std::move(help));
}

template <class Ref>
Entry numbers(std::string key, Ref ref, Range range, std::string help) {
  return plain<std::vector<double>>(Kind::numbers, std::move(key), ref, range, std::move(help));
}

template <class Ref>
Entry texts(std::string key, Ref ref, std::string help) {
  return plain<std::vector<std::string>>(Kind::texts, std::move(key), ref, any(), std::move(help));
}

template <class Enum>
using Words = std::vector<std::pair<std::string, Enum>>;

template <class Enum, class Ref>
Entry word(std::string key, Ref ref, Words<Enum> words, std::string help) {
  std::vector<std::string> names;
  for (const auto& [name, value] : words) names.push_back(name);
  return {std::move(key),
          Kind::word,
          any(),
          std::move(names),
          std::move(help),
          [ref, words](const Case& config) -> Value {
            const auto found = std::find_if(words.begin(), words.end(),
                                            [&](const auto& word) { return word.second == ref(config); });
            SLIPFRONT_ASSERT(found != words.end(), "an enumerator has no word in the case file");
            return found->first;
          },
          [ref, words](Case& config, const Value& value) {
            const auto found = std::find_if(words.begin(), words.end(), [&](const auto& word) {
              return word.first == std::get<std::string>(value);
            });
            SLIPFRONT_ASSERT(found != words.end(), "a word was not checked");
            ref(config) = found->second;
          }};
}

LawEntries law_entries(const interface::LawDescription& law) {
  LawEntries entries{law.name, law.help, law.defaults, {}};
  const auto full_key = [](const char* key) { return std::string("friction.") + key; };
  for (const auto& [key, min, max, help] : law.parameters)
    entries.entries.push_back(number(
        full_key(key), [key = key](auto& config) -> decltype(auto) { return config.friction.parameter(key); },
        between(min, max), help));
  for (const auto& [key, min, max, help] : law.lists)
    entries.entries.push_back({full_key(key),
                               Kind::numbers,
                               between(min, max),
                               {},
                               help,
                               [key = key](const Case& config) -> Value { return config.friction.list(key); },
                               [key = key](Case& config, const Value& value) {
                                 config.friction.set_list(key, std::get<std::vector<double>>(value));
                               }});
  for (auto& entry : entries.entries) entry.stage = Stage::motion;
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

Entry random_key_entry() {
  auto entry = text("friction.random_key", at(&Case::friction_along_x, &FrictionAlongX::random_key),
                    "parameter of the law that is multiplied along x by 1 + random_share f(x), f a Gaussian "
                    "random field of mean 0 and variance 1, see friction-along-x.md");
  entry.kind = Kind::word;
  entry.words = parameter_keys();
  entry.words.insert(entry.words.begin(), "none");
  return entry;
}

Entry only_with(Condition condition, Entry entry) {
  entry.only_with = std::move(condition);
  return entry;
}

Entry to_be_set(Entry entry) {
  entry.has_to_be_set = true;
  return entry;
}

using fronts::SpeedInterval;
using interface::ContactAlgorithm;
using interface::EventKind;
using interface::Nucleation;
using interface::NucleationForm;
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

bool is_tilted(const Case& c) {
  return c.loading.method != LoadingMethod::prestress;
}
Condition tilted() {
  return {Message("{} = direct or ramp", Key("loading.method")), is_tilted};
}
bool is_pressed_by_force(const Case& c) {
  return c.loading.mean_pressure_Pa || c.loading.normal_force_N_per_m;
}
Condition pressed_by_force() {
  return {Message("{} or {:leaf}", Key("loading.normal_force_N_per_m"), Key("loading.mean_pressure_Pa")),
          [](const Case& c) { return is_tilted(c) && is_pressed_by_force(c); }};
}
Condition pressed_by_displacement() {
  return {Message("{} = direct or ramp and neither {} nor {:leaf}", Key("loading.method"),
                  Key("loading.normal_force_N_per_m"), Key("loading.mean_pressure_Pa")),
          [](const Case& c) { return is_tilted(c) && !is_pressed_by_force(c); }};
}
/// The other way to give one load.
Condition tilted_without(const char* key, std::optional<double> Loading::*other) {
  return {Message("{} = direct or ramp and no {}", Key("loading.method"), Key(key)),
          [other](const Case& c) { return is_tilted(c) && !(c.loading.*other); }};
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
          [](const Case& c) { return is_tilted(c) && !statics::is_sheared_by_force(c.loading); }};
}
Condition prestressed() {
  return {Message("{} = prestress", Key("loading.method")),
          [](const Case& c) { return c.loading.method == LoadingMethod::prestress; }};
}
Condition uniform() {
  return {
      Message("{} = prestress and no {}", Key("loading.method"), Key("prestress.file")),
      [](const Case& c) { return c.loading.method == LoadingMethod::prestress && c.prestress.file.empty(); }};
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
Condition nucleated() {
  return {Message("{} = nucleation", Key("event.kind")),
          [](const Case& c) { return c.event == EventKind::nucleation; }};
}
Condition pushed() {
  return {Message("{} = added or raised", Key("event.trigger_form")),
          [](const Case& c) { return c.trigger.form != TriggerForm::weakened; }};
}
Condition with_table() {
  return {Message("{}", Key("friction.file")),
          [](const Case& c) { return !c.friction_along_x.file.empty(); }};
}
Condition with_random_field() {
  return {Message("{} other than none", Key("friction.random_key")),
          [](const Case& c) { return c.friction_along_x.random_key != "none"; }};
}
Condition overstressed() {
  return {Message("{} = nucleation and {} = overstress", Key("event.kind"), Key("nucleation.form")),
          [](const Case& c) {
            return c.event == EventKind::nucleation && c.nucleation.form == NucleationForm::overstress;
          }};
}

/// The keys in the order of the case file.
struct EntryList {
  std::vector<Entry> entries;

  void add(Stage stage, std::vector<Entry> some) {
    for (auto& entry : some) {
      entry.stage = stage;
      entries.push_back(std::move(entry));
    }
  }
};

void add_title(EntryList& list) {
  list.add(Stage::evaluation, {
                                  text("title", at(&Case::title), "title of figures and reports"),
                              });
}

void add_plate(EntryList& list) {
  list.add(
      Stage::mesh,
      {
          number("plate.width_m", at(&Case::plate, &Plate::width_m), above(0), "along the interface"),
          number("plate.height_m", at(&Case::plate, &Plate::height_m), above(0), "away from the interface"),
          number("plate.element_size_m", at(&Case::plate, &Plate::element_size_m), above(0),
                 "side of the square elements; width and height are whole multiples of it"),
          integer("plate.coarsenings", at(&Case::plate, &Plate::coarsenings), between(0, 20),
                  "how often the element size doubles on the way up from the interface, see mesh.md"),
          only_with(graded(),
                    number("plate.fine_height_m", at(&Case::plate, &Plate::fine_height_m), above(0),
                           "least height of the elements of element_size_m, next to the interface")),
          word<Corner>("plate.corner", at(&Case::plate, &Plate::corner),
                       {{"none", Corner::none}, {"relief", Corner::relief}, {"fillet", Corner::fillet}},
                       "lower corners: right angles, a shallow arc tangent to the base, or a quarter circle"),
          number("plate.relief_length_m", at(&Case::plate, &Plate::relief_length_m), above(0),
                 "length of the relief's arc along the interface"),
          number("plate.relief_height_m", at(&Case::plate, &Plate::relief_height_m), above(0),
                 "rise of the relief's arc at the edge"),
          number("plate.relief_depth_m", at(&Case::plate, &Plate::relief_depth_m), above(0),
                 "height over which the relief's shift of the nodes fades out"),
          number("plate.fillet_radius_m", at(&Case::plate, &Plate::fillet_radius_m), above(0),
                 "radius of the fillet's quarter circle"),
          word<Sides>("plate.sides", at(&Case::plate, &Plate::sides),
                      {{"free", Sides::free}, {"periodic", Sides::periodic}, {"absorbing", Sides::absorbing}},
                      "vertical edges: free of traction, the right one identical to the left one, or with "
                      "dashpots that let waves out; other than free only with plate.corner = none"),
          word<Top>(
              "plate.top", at(&Case::plate, &Plate::top),
              {{"loaded", Top::loaded}, {"free", Top::free}, {"absorbing", Top::absorbing}},
              "upper edge: displacements prescribed, free of traction, or with dashpots that let waves out"),
      });
}

void add_material(EntryList& list) {
  list.add(Stage::statics,
           {
               number("material.youngs_modulus_Pa", at(&Case::material, &Material::youngs_modulus_Pa),
                      above(0), "Young's modulus E"),
               number("material.poissons_ratio", at(&Case::material, &Material::poissons_ratio),
                      strictly_between(-1, 0.5), "Poisson's ratio nu"),
           });
  list.add(Stage::motion,
           {
               number("material.density_kg_per_m3", at(&Case::material, &Material::density_kg_per_m3),
                      above(0), "density rho"),
           });
  list.add(Stage::statics, {
                               word<Plane>("material.plane", at(&Case::material, &Material::plane),
                                           {{"stress", Plane::stress}, {"strain", Plane::strain}},
                                           "plane stress (thin plate) or plane strain"),
                           });
  list.add(Stage::motion,
           {
               number("material.stiffness_damping_s", at(&Case::material, &Material::stiffness_damping_s),
                      at_least(0), "Rayleigh damping beta_R: the internal force is K (u + beta_R v)"),
           });
}

void add_base(EntryList& list) {
  list.add(
      Stage::mesh,
      {
          word<BaseKind>(
              "base.kind", at(&Case::base, &Base::kind),
              {{"rigid", BaseKind::rigid}, {"body", BaseKind::body}},
              "what the plate lies on: a rigid plane, or a second body of the plate's width and elements, "
              "see two-bodies.md"),
          only_with(on_body(), to_be_set(number(
                                   "base.height_m", at(&Case::base, &Base::plate, &Plate::height_m), above(0),
                                   "depth of the body below, a whole multiple of plate.element_size_m"))),
          only_with(
              on_body(),
              integer("base.coarsenings", at(&Case::base, &Base::plate, &Plate::coarsenings), between(0, 20),
                      "how often its element size doubles away from the interface, see mesh.md")),
          only_with(
              base_graded(),
              number("base.fine_height_m", at(&Case::base, &Base::plate, &Plate::fine_height_m), above(0),
                     "least height of its elements of plate.element_size_m, next to the interface")),
          only_with(on_body(), word<Sides>("base.sides", at(&Case::base, &Base::plate, &Plate::sides),
                                           {{"free", Sides::free},
                                            {"periodic", Sides::periodic},
                                            {"absorbing", Sides::absorbing}},
                                           "its vertical edges; periodic if and only if plate.sides is")),
          only_with(on_body(),
                    word<Top>("base.bottom", at(&Case::base, &Base::plate, &Plate::top),
                              {{"held", Top::loaded}, {"free", Top::free}, {"absorbing", Top::absorbing}},
                              "its lower edge: held still, free of traction, or with dashpots that let "
                              "waves out")),
      });
  list.add(
      Stage::statics,
      {
          only_with(on_body(),
                    to_be_set(number("base.youngs_modulus_Pa",
                                     at(&Case::base, &Base::material, &Material::youngs_modulus_Pa), above(0),
                                     "its Young's modulus; its plane is material.plane"))),
          only_with(on_body(), to_be_set(number("base.poissons_ratio",
                                                at(&Case::base, &Base::material, &Material::poissons_ratio),
                                                strictly_between(-1, 0.5), "its Poisson's ratio"))),
      });
  list.add(Stage::motion,
           {
               only_with(on_body(),
                         to_be_set(number("base.density_kg_per_m3",
                                          at(&Case::base, &Base::material, &Material::density_kg_per_m3),
                                          above(0), "its density"))),
               only_with(on_body(), number("base.stiffness_damping_s",
                                           at(&Case::base, &Base::material, &Material::stiffness_damping_s),
                                           at_least(0), "its Rayleigh damping")),
           });
}

void add_loading(EntryList& list) {
  list.add(
      Stage::statics,
      {
          only_with(pressed_by_displacement(),
                    number("loading.tilt_left_m", at(&Case::loading, &Loading::tilt_left_m), at_least(0),
                           "downward displacement of the top edge at its left end, linear between the ends")),
          only_with(pressed_by_displacement(),
                    number("loading.tilt_right_m", at(&Case::loading, &Loading::tilt_right_m), at_least(0),
                           "the same at its right end")),
          only_with(tilted_without("loading.mean_pressure_Pa", &Loading::mean_pressure_Pa),
                    optional_number("loading.normal_force_N_per_m",
                                    at(&Case::loading, &Loading::normal_force_N_per_m), above(0), 1e5,
                                    "force that presses the interface before any shear, per metre of "
                                    "thickness, instead of the two displacements, which are found")),
          only_with(tilted_without("loading.normal_force_N_per_m", &Loading::normal_force_N_per_m),
                    optional_number("loading.mean_pressure_Pa",
                                    at(&Case::loading, &Loading::mean_pressure_Pa), above(0), 1e6,
                                    "mean pressure of the interface before any shear, normal force over "
                                    "plate.width_m, instead of the two displacements, which are found")),
          only_with(
              pressed_by_force(),
              number("loading.tilt_difference_m", at(&Case::loading, &Loading::tilt_difference_m), any(),
                     "downward displacement of the top edge at its left end less that at its "
                     "right end")),
          only_with(tilted(),
                    word<TopEdge>("loading.top_during_tilt", at(&Case::loading, &Loading::top_during_tilt),
                                  {{"held", TopEdge::held}, {"free", TopEdge::free}},
                                  "whether the top edge may move along x while it is tilted")),
          word<LoadingMethod>(
              "loading.method", at(&Case::loading, &Loading::method),
              {{"direct", LoadingMethod::direct},
               {"ramp", LoadingMethod::ramp},
               {"prestress", LoadingMethod::prestress}},
              "state before the event: tilt and shear to the critical one by static equilibria, "
              "the same by explicit dynamics with the top moving, or given tractions of the "
              "interface with the plate undeformed at rest"),
          only_with(
              tilted(),
              word<StaticSolver>(
                  "loading.solver", at(&Case::loading, &Loading::solver),
                  {{"auto", StaticSolver::automatic},
                   {"direct", StaticSolver::direct},
                   {"iterative", StaticSolver::iterative}},
                  "static equilibria by a sparse factorisation, by conjugate gradients with a multigrid "
                  "preconditioner, or by the one of both that suits the number of elements")),
      });
  list.add(Stage::motion,
           {
               number("loading.shear_speed_over_c_L", at(&Case::loading, &Loading::shear_speed_over_c_L),
                      {0, 1, false, true},
                      "speed of the top edge to +x over the longitudinal wave speed, in a ramp and during "
                      "the event; 0 holds it still, which a ramp and event.kind = spontaneous do not allow"),
           });
  list.add(
      Stage::statics,
      {
          only_with(tilted(),
                    number("loading.edge_margin_m", at(&Case::loading, &Loading::edge_margin_m), at_least(0),
                           "length at each end of the contact that does not count for the critical shear")),
          only_with(
              sheared_to_margin(),
              number("loading.critical_margin", at(&Case::loading, &Loading::critical_margin),
                     strictly_between(0, 1),
                     "common state at t/p = (1 - margin) mu_s, spontaneous event at (1 + margin) mu_s")),
          only_with(sheared_without("loading.shear_over_critical", &Loading::shear_over_critical),
                    optional_number("loading.shear_force_N_per_m",
                                    at(&Case::loading, &Loading::shear_force_N_per_m), above(0), 1e5,
                                    "t summed over the interface in the common state, per metre of "
                                    "thickness, instead of the margin; at most the critical one")),
          only_with(
              sheared_without("loading.shear_force_N_per_m", &Loading::shear_force_N_per_m),
              optional_number("loading.shear_over_critical",
                              at(&Case::loading, &Loading::shear_over_critical), {0, 1, true, false}, 0.9,
                              "the same sum over the critical one, at which t/p first reaches mu_s "
                              "inside, instead of the margin")),
      });
}

void add_prestress(EntryList& list) {
  list.add(Stage::tractions,
           {
               only_with(uniform(),
                         number("prestress.t_Pa", at(&Case::prestress, &Prestress::t_Pa), any(),
                                "uniform tangential traction, positive where it drives the plate to +x")),
               only_with(uniform(), number("prestress.p_Pa", at(&Case::prestress, &Prestress::p_Pa), above(0),
                                           "uniform pressure")),
               only_with(
                   prestressed(),
                   text("prestress.file", at(&Case::prestress, &Prestress::file),
                        "CSV table x_m,t_Pa,p_Pa of both instead, linear between its rows, from the first to "
                        "the last node of the interface; its path is relative to the case file")),
           });
}

void add_friction(EntryList& list) {
  list.add(
      Stage::motion,
      {
          friction_law_entry(),
          word<Relaxed>(
              "friction.regularisation", at(&Case::regularisation, &Regularisation::relaxed),
              {{"none", Relaxed::none}, {"strength", Relaxed::strength}, {"pressure", Relaxed::pressure}},
              "what follows changes of pressure with a delay, at the rate (|v| + v*)/L + 1/t*"),
          number("friction.relaxation_length_m", at(&Case::regularisation, &Regularisation::length_m),
                 above_or_infinite(0), "L of that rate"),
          number("friction.relaxation_slip_rate_m_per_s",
                 at(&Case::regularisation, &Regularisation::slip_rate_m_per_s), at_least(0),
                 "v* of that rate"),
          number("friction.relaxation_time_s", at(&Case::regularisation, &Regularisation::time_s),
                 above_or_infinite(0), "t* of that rate"),
      });
}

void add_friction_along_x(EntryList& list) {
  list.add(
      Stage::motion,
      {
          text(
              "friction.file", at(&Case::friction_along_x, &FrictionAlongX::file),
              "CSV table x_m and any of the law's parameters along the interface, from its first to its last "
              "node, see friction-along-x.md; its path is relative to the case file"),
          only_with(with_table(),
                    word<BetweenRows>(
                        "friction.between_rows", at(&Case::friction_along_x, &FrictionAlongX::between_rows),
                        {{"linear", BetweenRows::linear}, {"stepwise", BetweenRows::stepwise}},
                        "values between the table's rows: linear, or those of the last row at or before x")),
          random_key_entry(),
          only_with(
              with_random_field(),
              number("friction.random_share", at(&Case::friction_along_x, &FrictionAlongX::random_share),
                     at_least(0), "standard deviation of the parameter over its value")),
          only_with(with_random_field(),
                    number("friction.random_correlation_length_m",
                           at(&Case::friction_along_x, &FrictionAlongX::random_correlation_length_m),
                           above(0), "l of the field's correlation exp(-x^2/(2 l^2))")),
          only_with(with_random_field(),
                    integer("friction.random_seed", at(&Case::friction_along_x, &FrictionAlongX::random_seed),
                            between(0, 1e9), "which field; another one for each seed")),
      });
}

void add_contact(EntryList& list) {
  list.add(
      Stage::motion,
      {
          word<ContactAlgorithm>("contact.algorithm", at(&Case::contact),
                                 {{"direct", ContactAlgorithm::direct},
                                  {"predictor_corrector", ContactAlgorithm::predictor_corrector}},
                                 "pressure that closes the gap within the step, or normal velocity locked in "
                                 "contact with friction on the predicted slip rate"),
      });
}

void add_event(EntryList& list) {
  list.add(
      Stage::event,
      {
          word<EventKind>(
              "event.kind", at(&Case::event),
              {{"none", EventKind::none},
               {"spontaneous", EventKind::spontaneous},
               {"left", EventKind::left},
               {"right", EventKind::right},
               {"nucleation", EventKind::nucleation}},
              "start of the event: nothing, shear just past the critical one, a trigger at an edge, or a "
              "nucleation patch"),
          word<TriggerForm>(
              "event.trigger_form", at(&Case::trigger, &Trigger::form),
              {{"added", TriggerForm::added},
               {"raised", TriggerForm::raised},
               {"weakened", TriggerForm::weakened}},
              "tangential traction added, or raised to a multiple of mu_s p_s, in the direction in "
              "which the zone is loaded, or mu = mu_k from the start"),
          number("event.trigger_zone_m", at(&Case::trigger, &Trigger::zone_m), above(0),
                 "length of the trigger zone, inward from the outermost node in contact"),
          only_with(pushed(),
                    number("event.trigger_amount", at(&Case::trigger, &Trigger::amount), at_least(0),
                           "added tangential traction over what is missing to mu_s p_s; raised: the "
                           "traction over mu_s p_s")),
          number("event.trigger_ramp_s", at(&Case::trigger, &Trigger::ramp_s), at_least(0),
                 "time over which the trigger rises linearly"),
          number("event.trigger_duration_s", at(&Case::trigger, &Trigger::duration_s), above_or_infinite(0),
                 "the trigger is taken away this long after its start"),
      });
}

void add_nucleation(EntryList& list) {
  list.add(
      Stage::event,
      {
          only_with(nucleated(),
                    word<NucleationForm>(
                        "nucleation.form", at(&Case::nucleation, &Nucleation::form),
                        {{"weakened", NucleationForm::weakened}, {"overstress", NucleationForm::overstress}},
                        "patch with a profile B(x): mu = mu_k + (1 - B) (mu of the law - mu_k), "
                        "or an added tangential traction, with the trigger's ramp and duration")),
          only_with(nucleated(), number("nucleation.x_m", at(&Case::nucleation, &Nucleation::x_m), any(),
                                        "centre of the patch, from the plate's left edge")),
          only_with(nucleated(),
                    number("nucleation.half_length_m", at(&Case::nucleation, &Nucleation::half_length_m),
                           at_least(0), "B = 1 within this distance of the centre")),
          only_with(nucleated(), number("nucleation.taper_m", at(&Case::nucleation, &Nucleation::taper_m),
                                        at_least(0), "B falls to 0 over this length, as half a cosine wave")),
          only_with(overstressed(),
                    number("nucleation.overstress_Pa", at(&Case::nucleation, &Nucleation::overstress_Pa),
                           any(), "added tangential traction where B = 1")),
      });
}

void add_time(EntryList& list) {
  list.add(
      Stage::motion,
      {
          number("time.step_factor", at(&Case::time, &TimeStepping::step_factor), above(0),
                 "time step over the largest stable one; above 1 only with time.allow_unstable"),
          flag("time.allow_unstable", at(&Case::time, &TimeStepping::allow_unstable),
               "accept a step_factor above 1"),
          word<StepperKind>(
              "time.stepper", at(&Case::time, &TimeStepping::stepper),
              {{"fast", StepperKind::fast}, {"plain", StepperKind::plain}},
              "how steps are computed; plain: cell by cell as the scheme is written down, for "
              "experiments with it, twenty to a hundred times slower, with loading.method not ramp"),
          word<Precision>("time.precision", at(&Case::time, &TimeStepping::precision),
                          {{"double", Precision::double_precision}, {"single", Precision::single_precision}},
                          "numbers for rows of the plate beyond those next to the interface; single with "
                          "plate.sides = free"),
          integer("time.interface_rows", at(&Case::time, &TimeStepping::interface_rows), between(1, 1e6),
                  "rows of cells next to the interface that are sub-cycled"),
          integer("time.interface_substeps", at(&Case::time, &TimeStepping::interface_substeps),
                  between(1, 1e6), "sub-steps per time step there; 1 for none"),
          only_with(graded(), flag("time.local_steps", at(&Case::time, &TimeStepping::local_steps),
                                   "larger elements take larger time steps")),
          number("time.end_s", at(&Case::time, &TimeStepping::end_s), above(0),
                 "the event ends, unless it has come to rest before"),
          number("time.quiet_s", at(&Case::time, &TimeStepping::quiet_s), above_or_infinite(0),
                 "the event ends earlier when no node has slipped for this long"),
      });
}

void add_fronts(EntryList& list) {
  list.add(
      Stage::evaluation,
      {
          number("fronts.l_star_m", at(&Case::fronts, &FrontSettings::l_star_m), above(0),
                 "length l* over which the front speed is taken; one element where that is longer"),
          word<SpeedInterval>(
              "fronts.speed_interval", at(&Case::fronts, &FrontSettings::speed_interval),
              {{"centred", SpeedInterval::centred}, {"approach", SpeedInterval::approach}},
              "where l* lies: centred at the node, or from where t_d, p_d are taken to the node"),
          number("fronts.arrest_time_s", at(&Case::fronts, &FrontSettings::arrest_time_s), above(0),
                 "a tip that waits longer than this for its next onset has arrested; where that is longer, "
                 "than 3 times what a front takes for min_length_m at the median speed"),
          number("fronts.min_length_m", at(&Case::fronts, &FrontSettings::min_length_m), at_least(0),
                 "a shorter path is not a front of its own"),
          number("fronts.crack_share", at(&Case::fronts, &FrontSettings::crack_share), between(0, 1),
                 "crack-like above this share of slipping length to distance run"),
          number("fronts.pulse_share", at(&Case::fronts, &FrontSettings::pulse_share), between(0, 1),
                 "pulse-like below it"),
          number("fronts.trigger_margin_m", at(&Case::fronts, &FrontSettings::trigger_margin_m), at_least(0),
                 "t_d and p_d are left out within the trigger zone or nucleation patch plus this"),
      });
}

void add_output(EntryList& list) {
  list.add(Stage::evaluation,
           {
               number("output.history_interval_s", at(&Case::output, &Output::history_interval_s), above(0),
                      "spacing of the rows of interface.h5"),
               numbers("output.snapshot_times_s", at(&Case::output, &Output::snapshot_times_s), at_least(0),
                       "ascending times of the whole-plate fields in fields.vtkhdf"),
               number("output.snapshot_interval_s", at(&Case::output, &Output::snapshot_interval_s),
                      above_or_infinite(0),
                      "further ones at its multiples, from time 0 on; one step where that is longer"),
               flag("output.snapshot_stress", at(&Case::output, &Output::snapshot_stress),
                    "strain and stress at the cells' centres with them, which doubles the file"),
               number("output.energy_interval_s", at(&Case::output, &Output::energy_interval_s), above(0),
                      "spacing of the rows of energy.csv; one step where that is longer"),
           });
}

void add_probes(EntryList& list) {
  list.add(Stage::evaluation,
           {
               numbers("probes.x_m", at(&Case::probes, &Probes::x_m), any(),
                       "places at which motion, strain and stress are recorded in probes.h5, see files.md: "
                       "along the interface, from the plate's left edge"),
               numbers("probes.y_m", at(&Case::probes, &Probes::y_m), any(),
                       "of the same places: above the interface, below 0 in the base"),
               texts("probes.names", at(&Case::probes, &Probes::names),
                     "of the same places, all different; without them their numbers, from 1"),
               number("probes.interval_s", at(&Case::probes, &Probes::interval_s), above(0),
                      "spacing of the rows of probes.h5, each at the step nearest after its time; one step "
                      "where that is longer"),
           });
}

std::vector<Entry> make_common_entries() {
  EntryList list;
  add_title(list);
  add_plate(list);
  add_material(list);
  add_base(list);
  add_loading(list);
  add_prestress(list);
  add_friction(list);
  add_friction_along_x(list);
  add_contact(list);
  add_event(list);
  add_nucleation(list);
  add_time(list);
  add_fronts(list);
  add_output(list);
  add_probes(list);
  return std::move(list.entries);
}

}  // namespace

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
      {"m", 1e-12, 1e6},   {"s", 1e-15, 1e6},      {"Pa", 1e-6, 1e15},   {"kg/m3", 1e-6, 1e6},
      {"m/s", 1e-12, 1e6}, {"m2/s2", 1e-12, 1e12}, {"N/m", 1e-12, 1e18}, {"", 1e-18, 1e9}};
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

std::vector<Entry> entries_of(const Case& config) {
  std::vector<Entry> entries;
  for (const Entry& entry : common_entries()) {
    if (entry.only_with && !entry.only_with->holds(config)) continue;
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
