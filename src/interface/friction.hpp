// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/message.hpp"
#include "interface/friction/parameter.hpp"

// Friction laws as the rest of the program sees them. What each of them is, interface/friction/registry.hpp
// alone knows, so that a further law leaves what includes this file as it is.
namespace slipfront::interface {

/// mu as a function over all nodes at once, to try laws without compiling them: fills in mu for slip rates
/// |v| and slip paths. Several times slower than a law of the registry. [nodes]
using ArrayLaw = std::function<void(std::span<const double> speed_m_per_s, std::span<const double> slip_m,
                                    std::span<double> mu)>;

/// Values of a law's states. [states][nodes]
using LawStates = std::vector<std::vector<double>>;

/// A law of one's own with states, which never sticks: as those of the registry (friction/state_law.hpp),
/// over all nodes at once. [nodes]
struct StateArrayLaw {
  std::function<void(std::span<const double> speed_m_per_s, const LawStates& states, std::span<double> mu)>
      coefficient;
  std::function<void(std::span<const double> speed_m_per_s, double dt_s, LawStates& states)> evolve;
  /// Fills in the states with which a node begins that has t and p. Null: those of the law of the registry in
  /// whose place it is.
  std::function<void(std::span<const double> t_Pa, std::span<const double> p_Pa, LawStates& states)> initial =
      nullptr;
  std::vector<LawState> states = {};  ///< with `initial`; their names must live as long as the law
};

/// A law of the registry: its name in the case file, its parameters, its lists of numbers and its states. One
/// without a state has a cohesion besides its own parameters.
class FrictionLaw {
 public:
  static constexpr std::size_t max_parameters = 9;
  static constexpr const char* cohesion_key = "cohesion_Pa";
  using Lists = std::vector<std::vector<double>>;

  /// The registry's first law with its defaults.
  FrictionLaw();
  /// A law's struct, such as VelocityWeakening.
  template <class Law>
  requires requires { Law::parameters(); }
  FrictionLaw(const Law& law) : name_(Law::name) {
    static_assert(Law::parameters().size() <= max_parameters);
    auto value = values_.begin();
    for (const auto& p : Law::parameters()) *value++ = law.*p.member;
    if constexpr (requires { Law::lists(); }) {
      Lists lists;
      for (const auto& list : Law::lists())
        lists.emplace_back((law.*list.member).begin(), (law.*list.member).end());
      lists_ = std::make_shared<const Lists>(std::move(lists));
    }
    if constexpr (requires { Law::states; }) states_ = Law::states;
  }

  std::string_view name() const { return name_; }
  /// Those of the law's struct or function; arrays Interface::law_states are theirs.
  std::span<const LawState> states() const { return states_; }
  bool has_states() const { return !states_.empty(); }
  /// Whether nodes slip under any traction, so that none begins or ceases to: laws with states.
  bool never_sticks() const { return has_states(); }

  /// The struct again; its lists are those of this law, which must outlive it.
  /// @pre it is this law's
  template <class Law>
  Law as() const {
    SLIPFRONT_ASSERT(name_ == Law::name, "the struct of another friction law");
    Law law;
    auto value = values_.begin();
    for (const auto& p : Law::parameters()) law.*p.member = *value++;
    if constexpr (requires { Law::lists(); }) {
      auto numbers = lists_->begin();
      for (const auto& list : Law::lists()) law.*list.member = *numbers++;
    }
    return law;
  }

  /// Strength in contact besides mu p; 0 of a law with a state, which has no such parameter.
  double cohesion_Pa() const { return cohesion_Pa_; }

  bool has_parameter(std::string_view key) const;
  /// @pre the law has this parameter, named as in the table [friction]
  double& parameter(std::string_view key);
  double parameter(std::string_view key) const;
  const std::vector<double>& list(std::string_view key) const;
  void set_list(std::string_view key, std::vector<double> numbers);

  /// Contact updates take mu from the function instead; the initial state and weakened nodes keep the
  /// coefficients at rest and in motion of this law.
  void set_function(ArrayLaw function) { function_ = std::make_shared<const ArrayLaw>(std::move(function)); }
  /// Null where there is none.
  const ArrayLaw* function() const { return function_.get(); }
  /// Sets a law with states in place of this one, which has states, too. Thresholds and accuracies, statics
  /// and what is said of a case still follow from this law.
  void set_function(StateArrayLaw law) {
    state_function_ = std::make_shared<const StateArrayLaw>(std::move(law));
    if (state_function_->initial) states_ = state_function_->states;
  }
  const std::shared_ptr<const StateArrayLaw>& state_function() const { return state_function_; }

 private:
  std::string_view name_;
  std::array<double, max_parameters> values_{};  ///< in the order of the law's parameters
  double cohesion_Pa_ = 0;
  std::shared_ptr<const Lists> lists_;  ///< in the order of the law's lists; null where it has none
  std::span<const LawState> states_;
  std::shared_ptr<const ArrayLaw> function_;
  std::shared_ptr<const StateArrayLaw> state_function_;
};

/// What a law is to the case file.
struct LawDescription {
  /// A parameter, or a list of numbers.
  struct Key {
    const char* key;  ///< in the table [friction], with its unit
    double min, max;  ///< allowed
    const char* help;
  };
  const char* name;
  const char* help;
  FrictionLaw defaults;
  std::vector<Key> parameters;  ///< the coefficient at rest, or what it is proportional to, first
  std::vector<Key> lists;
};
/// Those of all laws, in the order of the registry.
const std::vector<LawDescription>& law_descriptions();
const LawDescription& description_of(const FrictionLaw& law);

double static_coefficient(const FrictionLaw& law);
/// Whether it is a parameter, mu_s.
bool has_static_coefficient(const FrictionLaw& law);
/// Traction that an interface at rest bears under a pressure p > 0, cohesion included.
double static_strength_Pa(const FrictionLaw& law, double p_Pa);
/// The coefficient that a weakening law falls to.
double kinetic_coefficient(const FrictionLaw& law);
/// mu after a slip path and at a slip rate |v|; of a law with a state that of steady sliding.
double friction_coefficient(const FrictionLaw& law, double speed_m_per_s, double slip_m);
/// d mu / d|v| there; negative where friction weakens with the slip rate.
double friction_slope_s_per_m(const FrictionLaw& law, double speed_m_per_s, double slip_m);
/// Whether mu rises with the slip rate somewhere, of a law without a state.
bool strengthens(const FrictionLaw& law);
/// What a law with states does to small changes of steady sliding: mu answers the slip rate at once, and by
/// the states with a delay.
struct StateResponse {
  double a, b;   ///< d mu/d ln V at once, and what the states take back of it
  double d_c_m;  ///< slip over which they follow: 1 - 1/e of b has come by then
  double V_m_per_s;
  double breakdown_per_m;  ///< fall of mu with slip behind a fast tip
};
/// At a slip rate, at V_i where that is faster; none for laws without a state.
std::optional<StateResponse> state_response(const FrictionLaw& law, double speed_m_per_s);
/// Its a, of steady sliding at V_i. @pre the law has states
double direct_effect(const FrictionLaw& law);
/// What friction of a law with states does behind a tip that slips at a constant rate: it falls from what the
/// states before the event make of it to that of steady sliding.
struct StateBreakdown {
  double energy_over_pressure_m;  ///< int (mu - residual coefficient) d slip
  double residual_coefficient;    ///< of steady sliding
};
/// None for laws without states.
std::optional<StateBreakdown> state_breakdown(const FrictionLaw& law, double t_Pa, double p_Pa,
                                              double speed_m_per_s);
/// t before the event under p, of a law with a state, where it is not given.
double traction_before_Pa(const FrictionLaw& law, double p_Pa);
/// Gives a law with a state whose theta_i is given the V_i that follows from t and p; leaves others as they
/// are.
void set_initial_slip_rate(FrictionLaw& law, double t_Pa, double p_Pa);
/// d_c of the linear slip weakening with the coefficients and fracture energy of a law that weakens with
/// slip.
std::optional<double> weakening_slip_m(const FrictionLaw& law);
/// Empty, or what is wrong with the parameters together.
Message inconsistency(const FrictionLaw& law);
/// The key in the case file of the parameter that decides on the coefficient at rest.
std::string static_coefficient_key(const FrictionLaw& law);

}  // namespace slipfront::interface
