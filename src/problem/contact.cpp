// SPDX-License-Identifier: BSD-3-Clause
#include "problem/contact.hpp"

#include <algorithm>
#include <cstdint>
#include <string>

#include "base/error.hpp"
#include "input/friction_table.hpp"
#include "input/table_along_x.hpp"
#include "problem/random_field.hpp"

namespace slipfront::problem {

namespace {

using input::FrictionAlongX;
using interface::FrictionLaw;

/// Where a position lies among the rows of a table: between two, or at one.
struct AmongRows {
  std::size_t before, after;
  double part;  ///< of the way from the one before to the one after
  double value(const std::vector<double>& of_rows) const {
    return of_rows[before] + part * (of_rows[after] - of_rows[before]);
  }
};

AmongRows among_rows(const std::vector<double>& rows_x_m, double x_m, input::BetweenRows between,
                     double tolerance_m) {
  // The position is at the later one of two rows as near as rounding.
  const auto beyond = std::ranges::upper_bound(rows_x_m, x_m + tolerance_m) - rows_x_m.begin();
  const auto last = static_cast<std::size_t>(std::max<std::ptrdiff_t>(beyond - 1, 0));
  if (between == input::BetweenRows::stepwise || last + 1 == rows_x_m.size() || x_m <= rows_x_m[last])
    return {last, last, 0};
  return {last, last + 1, (x_m - rows_x_m[last]) / (rows_x_m[last + 1] - rows_x_m[last])};
}

/// Gives each node the table's values.
void apply_table(const FrictionAlongX& along_x, const std::vector<double>& x_m,
                 std::vector<FrictionLaw>& laws) {
  const input::FrictionTable& table = along_x.table;
  SLIPFRONT_ASSERT(!table.x_m.empty(), "the table of friction.file has not been read");
  input::require_covers(table.x_m, x_m, input::in_friction_file(along_x.file));
  const double tolerance_m = input::position_tolerance * (x_m.back() - x_m.front());
  for (std::size_t i = 0; i < x_m.size(); ++i) {
    const auto at = among_rows(table.x_m, x_m[i], along_x.between_rows, tolerance_m);
    for (std::size_t k = 0; k < table.keys.size(); ++k)
      laws[i].parameter(table.keys[k]) = at.value(table.values[k]);
  }
}

/// Multiplies a parameter of each node.
void apply_field(const Problem& problem, const std::vector<double>& x_m, std::vector<FrictionLaw>& laws) {
  const FrictionAlongX& along_x = problem.friction.along_x;
  const RandomField field(along_x.random_correlation_length_m, problem.period_m(),
                          static_cast<std::uint64_t>(along_x.random_seed));
  for (std::size_t i = 0; i < x_m.size(); ++i)
    laws[i].parameter(along_x.random_key) *= 1 + along_x.random_share * field(x_m[i]);
}

void require_allowed(const Problem& problem, const std::vector<double>& x_m,
                     const std::vector<FrictionLaw>& laws) {
  const FrictionAlongX& along_x = problem.friction.along_x;
  const bool random = along_x.random_key != "none";
  for (std::size_t i = 0; i < laws.size(); ++i) {
    auto fault = input::fault_of(laws[i]);
    if (fault.empty() && !problem.is_prestressed() && laws[i].cohesion_Pa() > 0)
      fault = "cohesion_Pa needs loading.method = prestress";
    if (fault.empty()) continue;
    if (random)
      throw UserError("{}: at x = {:.6g} m {}; choose a smaller share", Key("friction.random_share"), x_m[i],
                      fault)
          .about("friction.random_key");
    throw UserError("{}: at x = {:.6g} m {}", input::in_friction_file(along_x.file), x_m[i], fault);
  }
}

/// Two of t, V_i and theta_i decide the third, at all nodes the same.
void require_one_initial_state(const Problem& problem, const std::vector<FrictionLaw>& laws) {
  if (!problem.friction.law.has_parameter("theta_i_s")) return;
  const FrictionAlongX& along_x = problem.friction.along_x;
  const auto given =
      std::ranges::count_if(laws, [](const auto& law) { return law.parameter("theta_i_s") > 0; });
  if (given == 0) return;
  const auto place = input::in_friction_file(along_x.file);
  if (problem.is_sequence()) return;
  if (!problem.prestress || !problem.prestress->file.empty())
    throw UserError("{}: theta_i_s needs {} = prestress and {}, not a table; remove the column", place,
                    Key("loading.method"), Key("prestress.p_Pa"));
  if (given != std::ssize(laws))
    throw UserError("{}: theta_i_s is 0 at some nodes and not at others; give it everywhere, or nowhere",
                    place);
  const bool V_i_varies = std::ranges::find(along_x.table.keys, "V_i_m_per_s") != along_x.table.keys.end() ||
                          along_x.random_key == "V_i_m_per_s";
  if (V_i_varies && problem.prestress->t_Pa)
    throw UserError("{}: {} and {} decide on V_i, which cannot vary by itself; leave one of the three out",
                    along_x.random_key == "V_i_m_per_s" ? Message("{}", Key("friction.random_key")) : place,
                    Key("prestress.t_Pa"), Key("friction.theta_i_s"));
}

}  // namespace

std::vector<FrictionLaw> friction_at(const Problem& problem, const std::vector<double>& x_m,
                                     const std::vector<double>& healed) {
  const FrictionAlongX& along_x = problem.friction.along_x;
  if (!along_x.varies() && healed.empty()) return {};
  std::vector<FrictionLaw> laws(x_m.size(), problem.friction.law);
  if (!along_x.file.empty()) apply_table(along_x, x_m, laws);
  if (along_x.random_key != "none") apply_field(problem, x_m, laws);
  require_one_initial_state(problem, laws);
  if (const auto& prestress = problem.prestress; prestress && prestress->t_Pa)
    for (auto& law : laws) set_initial_slip_rate(law, *prestress->t_Pa, prestress->p_Pa);
  require_allowed(problem, x_m, laws);
  for (std::size_t i = 0; i < healed.size(); ++i) laws[i].parameter("mu_s") += healed[i];
  return laws;
}

double radiation_slip_rate_m_per_s(const Problem& problem) {
  double admittance = 0;
  for (const auto& body : problem.bodies) admittance += solid::shear_admittance_m_per_Pa_s(body.material);
  return admittance * direct_effect(problem.friction.law) * nominal_pressure_Pa(problem);
}

double default_tip_slip_rate_m_per_s(const Problem& problem) {
  return std::max(radiation_slip_rate_m_per_s(problem), 10 * problem.friction.law.parameter("V_i_m_per_s"));
}

double tip_slip_rate_m_per_s(const Problem& problem) {
  const auto& given = problem.friction.tip_slip_rate_m_per_s;
  return given ? *given : default_tip_slip_rate_m_per_s(problem);
}

double inertia_slip_rate_m_per_s(const Problem& problem) {
  constexpr double share = 0.1;
  if (const auto& given = problem.sequence.inertia_slip_rate_m_per_s) return *given;
  return share * std::min(radiation_slip_rate_m_per_s(problem), tip_slip_rate_m_per_s(problem));
}

double slow_slip_rate_m_per_s(const Problem& problem) {
  return 0.5 * inertia_slip_rate_m_per_s(problem);
}

interface::ContactModel contact_model(const Problem& problem, const std::vector<double>& x_m,
                                      const std::vector<double>& healed, const mesh::Subset& places) {
  const auto& friction = problem.friction;
  interface::ContactModel model {
    friction.law, friction.regularisation, friction.contact
  };
  if (friction.law.never_sticks()) model.tip_slip_rate_m_per_s = tip_slip_rate_m_per_s(problem);
  const auto laws = friction_at(problem, x_m, healed);
  if (!laws.empty())
    model.law_per_node = interface::NodeLaws(
        places.of(laws), std::ranges::any_of(laws, [](const FrictionLaw& law) { return strengthens(law); }));
  return model;
}

}  // namespace slipfront::problem
