// SPDX-License-Identifier: BSD-3-Clause
#include "statics/condensed_interface.hpp"

#include <utility>

#include "statics/indefinite.hpp"

namespace slipfront::statics {

namespace {

/// D v: x reversed.
Eigen::VectorXd x_reversed(Eigen::VectorXd v) {
  for (Eigen::Index k = 0; k < v.size(); k += 2) v(k) = -v(k);
  return v;
}

/// D S D: the signs of the entries between x and y are reversed.
Eigen::MatrixXd mirrored(Eigen::MatrixXd S) {
  for (Eigen::Index c = 0; c < S.cols(); ++c)
    for (Eigen::Index r = 1 - c % 2; r < S.rows(); r += 2) S(r, c) = -S(r, c);
  return S;
}

}  // namespace

CondensedInterface::CondensedInterface(std::shared_ptr<const Factorisation> plate,
                                       std::shared_ptr<const Factorisation> base)
    : plate_(std::move(plate)), base_(std::move(base)) {
  if (!base_) return;
  const auto& S_a = plate_->condensed_stiffness();
  const Eigen::MatrixXd P = mirrored(base_->condensed_stiffness());
  M_.compute(S_a + P);
  if (M_.info() != Eigen::Success) throw Indefinite();
  const Eigen::MatrixXd product = S_a * M_.solve(P);
  S_ = 0.5 * (product + product.transpose());  // symmetric but for rounding
}

Eigen::VectorXd CondensedInterface::relative_load(const Factorisation::Load& load) const {
  if (!base_) return load.g_N;
  return x_reversed(base_->condensed_stiffness() * x_reversed(M_.solve(load.g_N)));
}

std::unique_ptr<SlidingInterface> CondensedInterface::sliding(const Factorisation::Load& load,
                                                              const Factorisation::Load& unit_shear,
                                                              const std::vector<double>& gap_m,
                                                              const std::vector<double>& tributary_m,
                                                              const std::vector<Contact>& contact) const {
  // Displacements of the interface: along x of nodes that stick, given; held in contact; and free ones.
  std::vector<Eigen::Index> given, held, free;
  SlidingInterface::Map t_Pa, u_x_m, p_Pa, of_gap_m;
  const auto sort = [](bool is_set, std::size_t node, Eigen::Index place, auto& set, auto& nodes_of_set,
                       auto& others, auto& nodes_of_others) {
    (is_set ? set : others).push_back(place);
    (is_set ? nodes_of_set : nodes_of_others).push_back(node);
  };
  for (std::size_t k = 0; k < contact.size(); ++k)
    sort(contact[k] == Contact::stick, k, static_cast<Eigen::Index>(2 * k), given, t_Pa.nodes, free,
         u_x_m.nodes);
  const auto n_free_x = std::ssize(free);
  for (std::size_t k = 0; k < contact.size(); ++k)
    sort(contact[k] != Contact::open, k, static_cast<Eigen::Index>(2 * k + 1), held, p_Pa.nodes, free,
         of_gap_m.nodes);
  const auto n_free_y = std::ssize(free) - n_free_x;
  const auto& S = stiffness();
  const Eigen::VectorXd g0_N = relative_load(load), g1_N = relative_load(unit_shear);
  Eigen::VectorXd u_held_m(std::ssize(held));
  for (Eigen::Index k = 0; k < u_held_m.size(); ++k) u_held_m(k) = -gap_m[p_Pa.nodes[k]];

  // No force on the free ones: S_ff u_f = g_f - S_fo u_o, with o the others.
  const Eigen::LLT<Eigen::MatrixXd> S_ff(S(free, free));
  const Eigen::MatrixXd per_u = -S_ff.solve(S(free, given));
  const Eigen::VectorXd at_0 = S_ff.solve(g0_N(free) - S(free, held) * u_held_m);
  const Eigen::VectorXd per_shear = S_ff.solve(g1_N(free));

  const auto put = [](SlidingInterface::Map& map, const Eigen::MatrixXd& matrix, const Eigen::VectorXd& from,
                      const Eigen::VectorXd& per_shear_of_map) {
    const auto list = [](const auto& values) {
      return std::vector<double>(values.data(), values.data() + values.size());
    };
    map.matrix = list(matrix);
    map.at_0 = list(from);
    map.per_shear = list(per_shear_of_map);
  };
  // t opposes the force on the plate, p is that force.
  const auto put_tractions = [&](SlidingInterface::Map& map, const std::vector<Eigen::Index>& rows,
                                 double sign) {
    Eigen::VectorXd scale(std::ssize(rows));
    for (Eigen::Index k = 0; k < scale.size(); ++k) scale(k) = sign / tributary_m[map.nodes[k]];
    const auto D = scale.asDiagonal();
    put(map, D * (S(rows, given) + S(rows, free) * per_u),
        D * (S(rows, held) * u_held_m + S(rows, free) * at_0 - g0_N(rows)),
        D * (S(rows, free) * per_shear - g1_N(rows)));
  };
  put_tractions(t_Pa, given, -1);
  put_tractions(p_Pa, held, 1);
  put(u_x_m, per_u.topRows(n_free_x), at_0.head(n_free_x), per_shear.head(n_free_x));
  Eigen::VectorXd gap_at_0 = at_0.tail(n_free_y);
  for (Eigen::Index k = 0; k < n_free_y; ++k) gap_at_0(k) += gap_m[of_gap_m.nodes[k]];
  put(of_gap_m, per_u.bottomRows(n_free_y), gap_at_0, per_shear.tail(n_free_y));
  return std::make_unique<SlidingInterface>(contact, std::move(t_Pa), std::move(u_x_m), std::move(p_Pa),
                                            std::move(of_gap_m));
}

Displacement CondensedInterface::displacement(const Factorisation::Load& load,
                                              const Eigen::VectorXd& relative_u_m) const {
  if (!base_) return {plate_->displacement(load, relative_u_m), {}};
  const Eigen::VectorXd P_u = x_reversed(base_->condensed_stiffness() * x_reversed(relative_u_m));
  const Eigen::VectorXd u_a = M_.solve(P_u + load.g_N);
  const Eigen::VectorXd f = S_ * relative_u_m - relative_load(load);
  return {plate_->displacement(load, u_a), base_->displacement(x_reversed(f))};
}

}  // namespace slipfront::statics
