// SPDX-License-Identifier: BSD-3-Clause
#include "interface/quasi_dynamic.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "interface/friction/registry.hpp"
#include "interface/state_node.hpp"

namespace slipfront::interface {

/// Evaluators of all nodes, for the law that they have.
struct QuasiDynamicFriction::Evaluators {
  Evaluators() = default;
  Evaluators(const Evaluators&) = delete;
  Evaluators& operator=(const Evaluators&) = delete;
  virtual ~Evaluators() = default;
  virtual void balance(double radiation_damping, std::span<const double> t_Pa, std::span<const double> p_Pa,
                       std::span<const double> psi, std::span<double> slip_rate_m_per_s,
                       std::span<double> psi_per_s) const = 0;
};

template <class Law>
struct QuasiDynamicFriction::EvaluatorsOf final : Evaluators {
  std::vector<typename Law::template Evaluator<double>> nodes;

  void balance(double radiation_damping, std::span<const double> t_Pa, std::span<const double> p_Pa,
               std::span<const double> psi, std::span<double> slip_rate_m_per_s,
               std::span<double> psi_per_s) const override {
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const auto& law = nodes[k];
      double V = 0;
      if (const double size_Pa = std::abs(t_Pa[k]); p_Pa[k] > 0 && size_Pa > 0) {
        const double per_a_p = law.per_a / p_Pa[k], V0 = law.V0_m_per_s;
        const double s = std::max(psi[k] * law.per_a, least_state);
        const double y = root_of_traction(size_Pa * per_a_p, radiation_damping * V0 * per_a_p, s,
                                          std::log(size_Pa / (radiation_damping * V0)));
        V = V0 * std::exp(y - s) * -std::expm1(-2 * y);
      }
      slip_rate_m_per_s[k] = std::copysign(V, t_Pa[k]);
      psi_per_s[k] = law.state_rate_per_s(psi[k], V);
    }
  }
};

QuasiDynamicFriction::QuasiDynamicFriction(const ContactModel& model, std::size_t n_nodes,
                                           double radiation_damping_Pa_s_per_m)
    : radiation_damping_(radiation_damping_Pa_s_per_m) {
  laws_ = visit(model.law, [&]<class Law>(const Law&) -> std::shared_ptr<const Evaluators> {
    if constexpr (HasStates<Law>) {
      auto of_law = std::make_shared<EvaluatorsOf<Law>>();
      for (std::size_t k = 0; k < n_nodes; ++k) {
        const auto law = model.law_at(k).as<Law>();
        const auto evaluator = law.evaluator();
        of_law->nodes.push_back(evaluator);
        initial_states_.push_back(law.theta_i_s > 0 ? law.given_state()
                                                    : evaluator.steady_state(law.V_i_m_per_s));
        a_.push_back(law.a);
        d_c_m_.push_back(law.d_c_m);
      }
      return of_law;
    }
    return nullptr;
  });
  SLIPFRONT_ASSERT(laws_ != nullptr, "a law without a state has no slip rate at rest");
}

void QuasiDynamicFriction::balance(std::span<const double> t_Pa, std::span<const double> p_Pa,
                                   std::span<const double> psi, std::span<double> slip_rate_m_per_s,
                                   std::span<double> psi_per_s) const {
  laws_->balance(radiation_damping_, t_Pa, p_Pa, psi, slip_rate_m_per_s, psi_per_s);
}

std::vector<double> QuasiDynamicFriction::initial_states() const {
  return initial_states_;
}

}  // namespace slipfront::interface
