// SPDX-License-Identifier: BSD-3-Clause
#include "statics/pieces.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "base/error.hpp"

namespace slipfront::statics {

void Piece::put(Parcel& to) const {
  to.put(first).put(count).put(n_pairs).put(static_cast<std::uint64_t>(bodies.size()));
  for (const auto& body : bodies) to.put(body.material).put(body.is_base).put(body.nodes).put(body.cells);
  to.put(lower).put(gap_m).put(top).put(held);
}

Piece Piece::take(Parcel& from) {
  Piece piece;
  piece.first = from.take<std::int32_t>();
  piece.count = from.take<std::int32_t>();
  piece.n_pairs = from.take<std::int32_t>();
  piece.bodies.resize(from.take<std::uint64_t>());
  for (auto& body : piece.bodies) {
    body.material = from.take<solid::Material>();
    body.is_base = from.take<bool>();
    body.nodes = from.take_all<Node>();
    body.cells = from.take_all<mesh::Cell>();
  }
  piece.lower = from.take_all<Place>();
  piece.gap_m = from.take_all<double>();
  piece.top = from.take_all<Place>();
  piece.held = from.take_all<std::int32_t>();
  return piece;
}

// With D = diag(-1, 1) the relative displacement is v = u_plate + D u_base; so u_plate = v - D u_base, or
// u_base = D v - D u_plate.
Terms terms_of(bool is_relative, bool is_base) {
  if (!is_relative) return {};
  return {{is_base ? -1.0 : 1.0, 1}, {1, -1}};
}

void make_absolute(solid::Field& plate, std::span<const mesh::Node> plate_lower, solid::Field& base,
                   std::span<const mesh::Node> base_lower, bool base_is_relative) {
  auto& relative = base_is_relative ? base : plate;
  const auto& other = base_is_relative ? plate : base;
  const auto lower = base_is_relative ? base_lower : plate_lower;
  const auto other_lower = base_is_relative ? plate_lower : base_lower;
  const auto [own, opposite] = terms_of(true, base_is_relative);
  for (std::size_t k = 0; k < lower.size(); ++k) {
    double &x = relative.x[lower[k]], &y = relative.y[lower[k]];
    x = own[0] * x + opposite[0] * other.x[other_lower[k]];
    y = own[1] * y + opposite[1] * other.y[other_lower[k]];
  }
}

namespace {

/// The first column of each piece, and the number of columns.
std::vector<int> first_columns(const std::vector<std::int64_t>& nodes_of_column, int n_pieces) {
  const auto n_nodes = std::reduce(nodes_of_column.begin(), nodes_of_column.end());
  SLIPFRONT_ASSERT(n_nodes < std::numeric_limits<std::int32_t>::max() / 2, "too many unknowns");
  std::vector<int> first = {0};
  std::int64_t before = 0;
  for (std::size_t column = 0; column < nodes_of_column.size(); ++column) {
    while (std::ssize(first) < n_pieces && before * n_pieces >= n_nodes * std::ssize(first))
      first.push_back(static_cast<int>(column));
    before += nodes_of_column[column];
  }
  first.resize(static_cast<std::size_t>(n_pieces) + 1, static_cast<int>(nodes_of_column.size()));
  return first;
}

}  // namespace

DividedBodies::DividedBodies(const ElasticBody& plate, const std::optional<ElasticBody>& base, int n_pieces) {
  Cut cut;
  bodies_.push_back({&plate.mesh, &plate.material, {}});
  if (base) {
    bodies_.push_back({&base->mesh, &base->material, {}});
    cut.base_is_relative = plate.material.youngs_modulus_Pa > base->material.youngs_modulus_Pa;
  }
  std::vector<mesh::NodeColumns> columns;
  for (const auto& body : bodies_) columns.emplace_back(*body.mesh);
  std::vector<std::int64_t> nodes_of_column(static_cast<std::size_t>(columns.front().n_columns()));
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    auto& orphans = cut.orphans.emplace_back();
    const auto is_orphan = mesh::orphans(*bodies_[b].mesh);
    for (mesh::Node n = 0; n < bodies_[b].mesh->n_nodes(); ++n)
      if (is_orphan[n])
        orphans.push_back(n);
      else
        ++nodes_of_column[columns[b].column_of(n)];
  }
  cut.first_column = first_columns(nodes_of_column, n_pieces);
  first_ = {0};
  for (auto& body : bodies_) body.pair.assign(static_cast<std::size_t>(body.mesh->n_nodes()), -1);
  for (int k = 0; k < n_pieces; ++k) {
    std::int32_t next = first_.back();
    const auto nodes = cut.nodes_of_piece(columns, k);
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      for (const auto n : nodes[b]) bodies_[b].pair[n] = next++;
    first_.push_back(next);
  }
  cut_ = std::make_shared<const Cut>(std::move(cut));
}

std::vector<std::int32_t> DividedBodies::opposites(std::size_t body) const {
  std::vector<std::int32_t> opposite(bodies_[body].pair.size(), -1);
  if (bodies_.size() == 1 || &bodies_[body] != &relative()) return opposite;
  const auto& lower = bodies_[body].mesh->lower;
  const auto& other = bodies_[1 - body];
  for (std::size_t k = 0; k < lower.size(); ++k) opposite[lower[k]] = other.pair[other.mesh->lower[k]];
  return opposite;
}

Piece DividedBodies::piece(int number) const {
  Piece piece;
  piece.first = first_[number];
  piece.count = first_[number + 1] - piece.first;
  piece.n_pairs = n_pairs();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const auto& pair = bodies_[b].pair;
    const auto& mesh = *bodies_[b].mesh;
    const auto opposite = opposites(b);
    auto& body = piece.bodies.emplace_back(Piece::Body{*bodies_[b].material, b > 0, {}, {}});
    std::vector<mesh::Node> local(pair.size(), -1);
    for (const auto& cell : mesh.cells) {
      const auto is_own = [&](mesh::Node n) { return piece.has(pair[n]) || piece.has(opposite[n]); };
      if (std::ranges::none_of(cell, is_own)) continue;
      auto& own = body.cells.emplace_back(cell);
      for (auto& n : own) {
        const auto whole = n;
        n = local[whole];
        if (n >= 0) continue;
        n = local[whole] = static_cast<mesh::Node>(body.nodes.size());
        body.nodes.push_back({mesh.x_m[whole], mesh.y_m[whole], pair[whole], opposite[whole]});
      }
    }
  }
  const auto& relative = this->relative();
  const auto gap_m = gaps_m(*bodies_.front().mesh, bodies_.size() > 1 ? bodies_.back().mesh : nullptr);
  for (std::size_t k = 0; k < relative.mesh->lower.size(); ++k) {
    const auto own = relative.pair[relative.mesh->lower[k]];
    if (!piece.has(own)) continue;
    piece.lower.push_back({own, static_cast<std::int32_t>(k)});
    piece.gap_m.push_back(gap_m[k]);
  }
  const auto& plate = bodies_.front();
  for (std::size_t k = 0; k < plate.mesh->top.size(); ++k)
    if (const auto pair = plate.pair[plate.mesh->top[k]]; piece.has(pair))
      piece.top.push_back({pair, static_cast<std::int32_t>(k)});
  if (bodies_.size() > 1)
    for (const auto n : bodies_.back().mesh->top)
      if (const auto pair = bodies_.back().pair[n]; piece.has(pair)) piece.held.push_back(pair);
  return piece;
}

Displacement DividedBodies::displacement(const std::vector<double>& unknowns) const {
  Displacement u;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    auto& field = b == 0 ? u.above : u.below;
    field = solid::Field(bodies_[b].pair.size());
    for (std::size_t n = 0; n < field.size(); ++n) {
      const auto pair = bodies_[b].pair[n];
      if (pair < 0) continue;
      field.x[n] = unknowns[2 * pair];
      field.y[n] = unknowns[2 * pair + 1];
    }
  }
  if (bodies_.size() > 1)
    make_absolute(u.above, bodies_[0].mesh->lower, u.below, bodies_[1].mesh->lower, cut_->base_is_relative);
  return u;
}

}  // namespace slipfront::statics
