// SPDX-License-Identifier: BSD-3-Clause
#include "solve/statics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"

namespace slipfront::solve {

namespace {

/// The interface on the rigid plane: contact states, and the linear equilibrium they make on the condensed
/// stiffness.
class ContactProblem {
 public:
  ContactProblem(const mesh::Mesh& mesh, const std::vector<double>& tributary_m,
                 const Eigen::MatrixXd& stiffness, Eigen::VectorXd load, Eigen::VectorXd load_per_shear,
                 double mu_s)
      : mesh_(mesh),
        tributary_m_(tributary_m),
        S_(stiffness),
        g0_(std::move(load)),
        g1_(std::move(load_per_shear)),
        mu_s_(mu_s),
        n_(mesh.lower.size()),
        contact(n_, Contact::stick),
        has_touched(n_, 0),
        slip_sign(n_, 0.0),
        anchor_x_m(n_, 0.0) {}

  /// Displacements and forces of the interface, affine in the shear: u0 + shear u1, f0 + shear f1.
  void solve() {
    std::vector<Eigen::Index> unknown;  // degrees of freedom that are not held
    u0 = Eigen::VectorXd::Zero(S_.rows());
    u1 = Eigen::VectorXd::Zero(S_.rows());
    for (std::size_t k = 0; k < n_; ++k) {
      const auto x = static_cast<Eigen::Index>(2 * k);
      if (contact[k] == Contact::stick) u0(x) = anchor_x_m[k];
      if (contact[k] != Contact::stick) unknown.push_back(x);
      if (contact[k] != Contact::open) u0(x + 1) = -gap_m(k);
      if (contact[k] == Contact::open) unknown.push_back(x + 1);
    }
    if (!unknown.empty()) {
      const auto size = static_cast<Eigen::Index>(unknown.size());
      Eigen::MatrixXd A(size, size);
      Eigen::MatrixXd rhs(size, 2);
      for (Eigen::Index r = 0; r < size; ++r) {
        // An open node carries no force; a slipping one obeys f_x = -sign mu_s f_y.
        const auto d = unknown[r];
        const double mu = d % 2 == 0 ? slip_sign[d / 2] * mu_s_ : 0.0;
        Eigen::RowVectorXd row = S_.row(d);
        double g0 = g0_(d), g1 = g1_(d);
        if (contact[d / 2] == Contact::slip) {
          row += mu * S_.row(d + 1);
          g0 += mu * g0_(d + 1);
          g1 += mu * g1_(d + 1);
        }
        for (Eigen::Index c = 0; c < size; ++c) A(r, c) = row(unknown[c]);
        rhs(r, 0) = g0 - row.dot(u0);
        rhs(r, 1) = g1;
      }
      const Eigen::MatrixXd solution = A.partialPivLu().solve(rhs);
      for (Eigen::Index r = 0; r < size; ++r) {
        u0(unknown[r]) = solution(r, 0);
        u1(unknown[r]) = solution(r, 1);
      }
    }
    f0 = S_ * u0 - g0_;
    f1 = S_ * u1 - g1_;
  }

  double gap_m(std::size_t k) const { return mesh_.y_m[mesh_.lower[k]]; }
  double u_x_m(std::size_t k, double shear) const { return u0(2 * k) + shear * u1(2 * k); }
  double u_y_m(std::size_t k, double shear) const { return u0(2 * k + 1) + shear * u1(2 * k + 1); }
  double t_Pa(std::size_t k, double shear) const {
    return -(f0(2 * k) + shear * f1(2 * k)) / tributary_m_[k];
  }
  double p_Pa(std::size_t k, double shear) const {
    return (f0(2 * k + 1) + shear * f1(2 * k + 1)) / tributary_m_[k];
  }

  /// Corrects the states that the solution at `shear` contradicts; `may_slip(k)`: whether node k may pass
  /// mu_s. With `one_only` just the worst contradiction is corrected, against cycles. Returns whether
  /// anything changed.
  template <class MaySlip>
  bool correct(double shear, bool one_only, MaySlip&& may_slip) {
    double p_max = 0;
    for (std::size_t k = 0; k < n_; ++k) p_max = std::max(p_max, std::abs(p_Pa(k, shear)));
    const double tolerance = 1e-9;
    struct Change {
      std::size_t node;
      Contact to;
      double sign, severity;
    };
    std::vector<Change> changes;
    const double u_scale = std::max(u0.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
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
        const double excess = std::abs(t) - mu_s_ * p;
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

 private:
  const mesh::Mesh& mesh_;
  const std::vector<double>& tributary_m_;
  const Eigen::MatrixXd& S_;
  Eigen::VectorXd g0_, g1_;
  double mu_s_;
  std::size_t n_;

 public:
  std::vector<Contact> contact;
  std::vector<std::uint8_t> has_touched;  ///< whether the node has been in contact
  std::vector<double> slip_sign;          ///< of t where the node slips
  std::vector<double> anchor_x_m;         ///< u_x where the node sticks, or began to slip
  Eigen::VectorXd u0, u1, f0, f1;
};

constexpr int max_iterations = 400;
constexpr int iterations_at_once = 40;  ///< then one contradiction at a time

[[noreturn]] void contact_does_not_settle() {
  throw UserError(
      "the static contact states do not settle; change loading.tilt_left_m, loading.tilt_right_m or "
      "plate.corner");
}

/// First and last coordinate of the contact, less the margin at each end.
struct Inside {
  double from_m, to_m;
  bool contains(double x) const { return x >= from_m && x <= to_m; }
};

Inside inside_contact(const mesh::Mesh& mesh, const std::vector<Contact>& contact, double margin_m) {
  double first = std::numeric_limits<double>::infinity(), last = -first;
  for (std::size_t k = 0; k < contact.size(); ++k) {
    if (contact[k] == Contact::open) continue;
    first = std::min(first, mesh.x_m[mesh.lower[k]]);
    last = std::max(last, mesh.x_m[mesh.lower[k]]);
  }
  return {first + margin_m, last - margin_m};
}

Equilibrium make_equilibrium(const mesh::Mesh& mesh, const ContactProblem& problem, double shear,
                             double margin_m) {
  Equilibrium e;
  e.shear_m = shear;
  e.contact = problem.contact;
  const Inside inside = inside_contact(mesh, problem.contact, margin_m);
  e.inside_from_m = inside.from_m;
  e.inside_to_m = inside.to_m;
  for (std::size_t k = 0; k < mesh.lower.size(); ++k) {
    const bool open = problem.contact[k] == Contact::open;
    const double x = mesh.x_m[mesh.lower[k]];
    const double t = open ? 0 : problem.t_Pa(k, shear), p = open ? 0 : problem.p_Pa(k, shear);
    e.tractions.x_m.push_back(x);
    e.tractions.t_s_Pa.push_back(t);
    e.tractions.p_s_Pa.push_back(p);
    if (p > 0 && inside.contains(x) && t / p > e.peak_ratio) {
      e.peak_ratio = t / p;
      e.peak_x_m = x;
    }
  }
  return e;
}

}  // namespace

Statics::Statics(const mesh::Mesh& mesh, const solid::Material& material, const Loading& loading, double mu_s,
                 std::string mu_s_key)
    : mesh_(mesh),
      loading_(loading),
      mu_s_(mu_s),
      mu_s_key_(std::move(mu_s_key)),
      tributary_m_(mesh::tributary_lengths_m(mesh)) {
  held_ = std::make_unique<Factorisation>(mesh, material, TopConstraint::both);

  Factorisation::Top tilt{std::vector<double>(mesh.top.size(), 0.0), {}};
  const double x0 = mesh.x_m[mesh.top.front()], width = mesh.x_m[mesh.top.back()] - x0;
  for (const auto n : mesh.top) {
    const double s = (mesh.x_m[n] - x0) / width;
    tilt.u_y_m.push_back(-((1 - s) * loading.tilt_left_m + s * loading.tilt_right_m));
  }
  std::unique_ptr<Factorisation> vertical;
  if (loading.top_during_tilt == TopEdge::free)
    vertical = std::make_unique<Factorisation>(mesh, material, TopConstraint::vertical);
  const Factorisation& during_tilt = vertical ? *vertical : *held_;
  const auto load = during_tilt.load(tilt);

  ContactProblem problem(mesh, tributary_m_, during_tilt.condensed_stiffness(), load.g_N,
                         Eigen::VectorXd::Zero(load.g_N.size()), mu_s);
  for (std::size_t k = 0; k < mesh.lower.size(); ++k) {
    problem.contact[k] = problem.gap_m(k) > 0 ? Contact::open : Contact::stick;
    problem.has_touched[k] = problem.contact[k] == Contact::stick;
  }
  int iteration = 0;
  do {
    if (++iteration > max_iterations) contact_does_not_settle();
    problem.solve();
  } while (problem.correct(0, iteration > iterations_at_once, [](std::size_t) { return true; }));
  tilted_ = make_equilibrium(mesh, problem, 0, loading.edge_margin_m);
  if (std::ranges::all_of(tilted_.tractions.p_s_Pa, [](double p) { return p <= 0; }))
    throw UserError(
        "the tilt leaves the plate without contact; increase loading.tilt_left_m or loading.tilt_right_m");
  tilted_.u_m = during_tilt.displacement(load, problem.u0);
  tilted_.u_per_shear = solid::Field(mesh.n_nodes());

  if (vertical) {
    for (std::size_t k = 0; k < mesh.top.size(); ++k) tilt.u_x_m[k] = tilted_.u_m.x[mesh.top[k]];
    tilt_ = held_->load(tilt);
  } else {
    tilt_ = load;
  }
  unit_shear_ =
      held_->load({std::vector<double>(mesh.top.size(), 1.0), std::vector<double>(mesh.top.size(), 0.0)});
}

template <class FindShear>
Equilibrium Statics::shear(FindShear&& find_shear) const {
  ContactProblem problem(mesh_, tributary_m_, held_->condensed_stiffness(), tilt_.g_N, unit_shear_.g_N,
                         mu_s_);
  for (std::size_t k = 0; k < mesh_.lower.size(); ++k) {
    problem.contact[k] = tilted_.contact[k] == Contact::open ? Contact::open : Contact::stick;
    problem.has_touched[k] = problem.contact[k] == Contact::stick;
    problem.anchor_x_m[k] = tilted_.u_m.x[mesh_.lower[k]];
  }
  double shear = 0;
  int iteration = 0;
  Inside inside{};
  do {
    if (++iteration > max_iterations) contact_does_not_settle();
    problem.solve();
    inside = inside_contact(mesh_, problem.contact, loading_.edge_margin_m);
    shear = find_shear(problem, inside);
  } while (problem.correct(shear, iteration > iterations_at_once,
                           [&](std::size_t k) { return !inside.contains(mesh_.x_m[mesh_.lower[k]]); }));

  Equilibrium e = make_equilibrium(mesh_, problem, shear, loading_.edge_margin_m);
  auto load = tilt_;
  for (double& u : load.top.u_x_m) u += shear;
  load.g_N += shear * unit_shear_.g_N;
  e.u_m = held_->displacement(load, problem.u0 + shear * problem.u1);
  e.u_per_shear = held_->displacement(unit_shear_, problem.u1);
  return e;
}

Equilibrium Statics::shear_by(double shear_m) const {
  return shear([shear_m](const ContactProblem&, const Inside&) { return shear_m; });
}

Equilibrium Statics::shear_to(double ratio) const {
  if (tilted_.peak_ratio > ratio)
    throw UserError(
        "the tilt alone brings t/p inside the interface to {:.4g}, not below {:.4g}; raise {} or change the "
        "tilt",
        tilted_.peak_ratio, ratio, mu_s_key_);
  bool reached = true;
  Equilibrium e = shear([&](const ContactProblem& problem, const Inside& inside) {
    // With the contact states as they are, t - ratio p grows linearly with the shear at every node; a state
    // that does not last until then is corrected, and the shear found again.
    double shear = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < mesh_.lower.size(); ++k) {
      if (problem.contact[k] != Contact::stick || !inside.contains(mesh_.x_m[mesh_.lower[k]])) continue;
      const double excess = problem.t_Pa(k, 0) - ratio * problem.p_Pa(k, 0);
      const double growth = problem.t_Pa(k, 1) - ratio * problem.p_Pa(k, 1) - excess;
      if (growth > 0 && excess <= 0 && problem.p_Pa(k, -excess / growth) > 0)
        shear = std::min(shear, -excess / growth);
    }
    reached = std::isfinite(shear);
    return reached ? shear : 0.0;
  });
  if (!reached)
    throw UserError(
        "no shear brings t/p inside the interface to {:.4g}; reduce {}, or change the tilt or "
        "loading.edge_margin_m",
        ratio, mu_s_key_);
  // Slip at mu_s p that has spread from an edge past the margin would itself count as the peak.
  if (std::abs(e.peak_ratio - ratio) > 1e-6 * ratio)
    throw UserError(
        "slip spreads from an edge of contact before t/p inside reaches {:.4g}; reduce {}, or change the "
        "tilt or "
        "loading.edge_margin_m",
        ratio, mu_s_key_);
  return e;
}

}  // namespace slipfront::solve
