// SPDX-License-Identifier: BSD-3-Clause
#include "statics/sliding_interface.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <utility>

namespace slipfront::statics {

SlidingInterface::SlidingInterface(std::vector<Contact> contact, Map t_Pa, Map u_x_m, Map p_Pa, Map gap_m)
    : contact_(std::move(contact)),
      t_Pa_(std::move(t_Pa)),
      u_x_m_(std::move(u_x_m)),
      p_Pa_(std::move(p_Pa)),
      gap_m_(std::move(gap_m)) {}

void SlidingInterface::equilibrate(double shear_m, std::span<double> u_x_m, std::span<double> t_Pa,
                                   std::span<double> p_Pa, std::span<double> gap_m) const {
  u_stuck_m_.clear();
  for (const auto k : t_Pa_.nodes) u_stuck_m_.push_back(u_x_m[k]);
  const auto put = [&](const Map& map, std::span<double> values) {
    const auto rows = std::ssize(map.nodes), columns = std::ssize(u_stuck_m_);
    if (rows == 0) return;
    using Vector = Eigen::Map<const Eigen::VectorXd>;
    values_.resize(map.nodes.size());
    Eigen::Map<Eigen::VectorXd>(values_.data(), rows).noalias() =
        Vector(map.at_0.data(), rows) + shear_m * Vector(map.per_shear.data(), rows) +
        Eigen::Map<const Eigen::MatrixXd>(map.matrix.data(), rows, columns) *
            Vector(u_stuck_m_.data(), columns);
    for (std::size_t k = 0; k < map.nodes.size(); ++k) values[map.nodes[k]] = values_[k];
  };
  for (const auto values : {t_Pa, p_Pa, gap_m}) std::ranges::fill(values, 0.0);
  put(t_Pa_, t_Pa);
  put(p_Pa_, p_Pa);
  put(u_x_m_, u_x_m);
  put(gap_m_, gap_m);
}

}  // namespace slipfront::statics
