// SPDX-License-Identifier: BSD-3-Clause
#include "boundary/pusher.hpp"

#include <algorithm>

namespace slipfront::boundary {

std::vector<mesh::Node> pushed_nodes(const mesh::Mesh& mesh, const Pusher& pusher) {
  std::vector<mesh::Node> pushed;
  if (!pusher.is_there()) return pushed;
  const double slack_m = 1e-9 * pusher.to_m;
  for (const auto n : mesh.left_nodes)
    if (mesh.y_m[n] >= pusher.from_m - slack_m && mesh.y_m[n] <= pusher.to_m + slack_m) pushed.push_back(n);
  return pushed;
}

std::vector<double> shares_of_pushed(const mesh::Mesh& mesh, const std::vector<mesh::Node>& pushed) {
  if (pushed.size() == 1) return {1};
  std::vector<double> shares;
  for (std::size_t k = 0; k < pushed.size(); ++k) {
    const auto y_m = [&](std::size_t j) { return mesh.y_m[pushed[std::min(j, pushed.size() - 1)]]; };
    const double length_m = y_m(k + 1) - y_m(k == 0 ? 0 : k - 1), all_m = y_m(pushed.size()) - y_m(0);
    shares.push_back(0.5 * length_m / all_m);
  }
  return shares;
}

}  // namespace slipfront::boundary
