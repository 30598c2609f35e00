// SPDX-License-Identifier: BSD-3-Clause
#include "fracture/static_crack.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "base/error.hpp"
#include "base/numbers.hpp"

namespace slipfront::fracture {

SlipResponse response_of_half_spaces(const Bodies& bodies, const std::vector<double>& x_m) {
  const auto n = std::ssize(x_m);
  // Response to exp(i k x): t = -Y |k| slip and p = i k N slip, whence the kernels Y/(pi x^2) and N d/dx.
  const double Y = stiffness_Pa(bodies, 0);
  const double N = moving_stiffness_Pa(bodies, 0, 1).imag();
  SlipResponse response{x_m, Eigen::MatrixXd(n, n), Eigen::MatrixXd::Zero(n, n)};
  const double h = response.spacing_m();
  for (Eigen::Index k = 0; k < n; ++k)
    for (Eigen::Index j = 0; j < n; ++j) {
      const double d = static_cast<double>(k - j);
      response.t_per_slip(k, j) = Y / (std::numbers::pi * h * (d * d - 0.25));
    }
  for (Eigen::Index k = 0; k < n; ++k) {
    // i k slip is d slip/dx.
    if (k + 1 < n) response.p_per_slip(k, k + 1) = N / (2 * h);
    if (k > 0) response.p_per_slip(k, k - 1) = -N / (2 * h);
  }
  return response;
}

SlipResponse response_of_sample(const Eigen::MatrixXd& S, std::vector<double> x_m,
                                const std::vector<double>& tributary_m) {
  const auto n = std::ssize(x_m);
  SlipResponse response{std::move(x_m), Eigen::MatrixXd(n, n), Eigen::MatrixXd(n, n)};
  for (Eigen::Index k = 0; k < n; ++k) {
    const double length_m = tributary_m[static_cast<std::size_t>(k)];
    for (Eigen::Index j = 0; j < n; ++j) {
      response.t_per_slip(k, j) = -S(2 * k, 2 * j) / length_m;
      response.p_per_slip(k, j) = S(2 * k + 1, 2 * j) / length_m;
    }
  }
  return response;
}

StaticCrack::StaticCrack(const SlipResponse& response, const CrackLoads& loads)
    : response_(response), loads_(loads) {
  const auto n = std::ssize(response.x_m);
  lower_.setZero(n, n);
  upper_.setZero(n, n);
  unbalanced_Pa_.setZero(n);
}

double StaticCrack::entry(std::size_t k, std::size_t j) const {
  const auto row = static_cast<Eigen::Index>(k), column = static_cast<Eigen::Index>(j);
  return -response_.t_per_slip(row, column) +
         loads_.residual_coefficient[k] * response_.p_per_slip(row, column);
}

StaticCrack::Candidate StaticCrack::candidate(std::ptrdiff_t node) const {
  Candidate c;
  c.node = node;
  if (!is_node(node)) return c;
  const auto at = static_cast<std::size_t>(node);
  const auto m = std::ssize(nodes_);
  c.row.resize(std::ssize(response_.x_m));
  c.column.resize(std::ssize(response_.x_m));
  for (Eigen::Index i = 0; i < m; ++i) {
    const auto j = nodes_[static_cast<std::size_t>(i)];
    c.row(i) = entry(at, j);
    c.column(i) = entry(j, at);
  }
  auto row = c.row.head(m), column = c.column.head(m);
  lower_.topLeftCorner(m, m).triangularView<Eigen::UnitLower>().solveInPlace(column);
  upper_.topLeftCorner(m, m).transpose().triangularView<Eigen::Lower>().solveInPlace(row);
  c.pivot = entry(at, at) - row.dot(column);
  const double drop_Pa =
      loads_.t_Pa[at] - loads_.cohesion_Pa[at] - loads_.residual_coefficient[at] * loads_.p_Pa[at];
  c.unbalanced_Pa = drop_Pa - row.dot(unbalanced_Pa_.head(m));
  return c;
}

void StaticCrack::extend(Candidate& c) const {
  if (!is_node(c.node)) return;
  const auto m = std::ssize(nodes_) - 1;
  const auto last = nodes_.back(), at = static_cast<std::size_t>(c.node);
  const double in_column = entry(last, at) - lower_.row(m).head(m).dot(c.column.head(m));
  const double in_row = (entry(at, last) - upper_.col(m).head(m).dot(c.row.head(m))) / upper_(m, m);
  c.row(m) = in_row;
  c.column(m) = in_column;
  c.pivot -= in_row * in_column;
  c.unbalanced_Pa -= in_row * unbalanced_Pa_(m);
}

void StaticCrack::add(const Candidate& c) {
  const auto m = std::ssize(nodes_);
  lower_.row(m).head(m) = c.row.head(m);
  upper_.col(m).head(m) = c.column.head(m);
  upper_(m, m) = c.pivot;
  unbalanced_Pa_(m) = c.unbalanced_Pa;
  nodes_.push_back(static_cast<std::size_t>(c.node));
}

void StaticCrack::begin(std::size_t node) {
  SLIPFRONT_ASSERT(nodes_.empty(), "a crack begins once");
  add(candidate(static_cast<std::ptrdiff_t>(node)));
  beside_ = {candidate(static_cast<std::ptrdiff_t>(node) - 1),
             candidate(static_cast<std::ptrdiff_t>(node) + 1)};
}

double StaticCrack::energy_release_rate_J_per_m2(int side) const {
  const auto& c = beside_[side > 0];
  if (!is_node(c.node)) return nan;
  return c.unbalanced_Pa > 0 ? 0.5 * c.unbalanced_Pa * c.unbalanced_Pa / c.pivot : 0;
}

void StaticCrack::release(int side) {
  auto &released = beside_[side > 0], &other = beside_[side < 0];
  SLIPFRONT_ASSERT(is_node(released.node), "a node beside the crack");
  add(released);
  extend(other);
  released = candidate(released.node + side);
}

double nucleation_length_m(SlipResponse response, const std::vector<double>& coefficient,
                           const std::vector<double>& weakening_Pa_per_m, std::size_t node) {
  const auto n = response.x_m.size();
  for (std::size_t k = 0; k < n; ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    response.t_per_slip(at, at) += weakening_Pa_per_m[k];
  }
  // A patch of nodes is half an element longer than they are, and unstable between one and the next.
  constexpr std::size_t fewest_nodes = 3;
  const std::vector<double> zero(n, 0.0);
  const CrackLoads loads{zero, zero, coefficient, zero};
  StaticCrack patch(response, loads);
  patch.begin(node);
  for (std::size_t nodes = 1; nodes < n; ++nodes) {
    const int side = !patch.has_next(-1) || (nodes % 2 == 1 && patch.has_next(1)) ? 1 : -1;
    if (!(patch.stiffness_Pa_per_m(side) > 0))
      return nodes < fewest_nodes ? nan : static_cast<double>(nodes + 1) * response.spacing_m();
    patch.release(side);
  }
  return nan;
}

}  // namespace slipfront::fracture
