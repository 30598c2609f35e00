// SPDX-License-Identifier: BSD-3-Clause
#include "statics/dissection.hpp"

#include <algorithm>
#include <cstdint>
#include <span>

#include "solid/cells_of_nodes.hpp"

namespace slipfront::statics {

namespace {

void append_block(NodeOrder& order, std::span<const mesh::Node> nodes) {
  order.nodes.insert(order.nodes.end(), nodes.begin(), nodes.end());
  order.block_ends.push_back(order.nodes.size());
}

class Dissection {
 public:
  explicit Dissection(const mesh::Mesh& mesh) : mesh_(mesh), around_(mesh), part_(mesh.n_nodes(), 0) {}

  /// Appends the nodes to `order`: one half, the other half, then the nodes of the first that touch the
  /// second.
  void order_nodes(std::span<mesh::Node> nodes, NodeOrder& order) {
    constexpr std::size_t leaf = 16;
    if (nodes.size() <= leaf) {
      append_block(order, nodes);
      return;
    }
    const auto& along = longer_extent(nodes);
    const auto middle = nodes.begin() + static_cast<std::ptrdiff_t>(nodes.size() / 2);
    // Ties are broken by the number, so that the cut is reproducible.
    std::nth_element(nodes.begin(), middle, nodes.end(), [&](mesh::Node a, mesh::Node b) {
      return along[a] != along[b] ? along[a] < along[b] : a < b;
    });
    const std::span<mesh::Node> low(nodes.begin(), middle), high(middle, nodes.end());
    const std::int32_t mark = ++marks_;
    for (const auto n : high) part_[n] = mark;
    const auto touches_high = [&](mesh::Node n) {
      return std::ranges::any_of(around_.of(n), [&](std::int32_t cell) {
        return std::ranges::any_of(mesh_.cells[cell], [&](mesh::Node other) { return part_[other] == mark; });
      });
    };
    const auto separator =
        std::stable_partition(low.begin(), low.end(), [&](mesh::Node n) { return !touches_high(n); });
    std::vector<mesh::Node> between(separator, low.end());
    order_nodes({low.begin(), separator}, order);
    order_nodes(high, order);
    append_block(order, between);
  }

 private:
  const std::vector<double>& longer_extent(std::span<const mesh::Node> nodes) const {
    const auto extent = [&](const std::vector<double>& c) {
      const auto [low, high] = std::ranges::minmax(nodes, {}, [&](mesh::Node n) { return c[n]; });
      return c[high] - c[low];
    };
    return extent(mesh_.x_m) >= extent(mesh_.y_m) ? mesh_.x_m : mesh_.y_m;
  }

  const mesh::Mesh& mesh_;
  solid::CellsOfNodes around_;
  std::vector<std::int32_t> part_;  ///< mark of the half a node was last put into
  std::int32_t marks_ = 0;
};

}  // namespace

NodeOrder dissect(const mesh::Mesh& mesh, const std::vector<mesh::Node>& last) {
  std::vector<bool> left_out = mesh::orphans(mesh);
  for (const auto n : last) left_out[n] = true;
  std::vector<mesh::Node> nodes;
  for (mesh::Node n = 0; n < mesh.n_nodes(); ++n)
    if (!left_out[n]) nodes.push_back(n);
  NodeOrder order;
  order.nodes.reserve(nodes.size() + last.size());
  Dissection(mesh).order_nodes(nodes, order);
  append_block(order, last);
  return order;
}

}  // namespace slipfront::statics
