// SPDX-License-Identifier: BSD-3-Clause
#include "statics/condensed_interface.hpp"

#include <utility>

#include "base/error.hpp"

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
  SLIPFRONT_ASSERT(M_.info() == Eigen::Success, "the stiffness of plate and base is not positive definite");
  const Eigen::MatrixXd product = S_a * M_.solve(P);
  S_ = 0.5 * (product + product.transpose());  // symmetric but for rounding
}

Eigen::VectorXd CondensedInterface::relative_load(const Factorisation::Load& load) const {
  if (!base_) return load.g_N;
  return x_reversed(base_->condensed_stiffness() * x_reversed(M_.solve(load.g_N)));
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
