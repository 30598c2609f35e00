// SPDX-License-Identifier: BSD-3-Clause
#include "statics/pieces.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

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
  piece.top = from.take_all<std::int32_t>();
  piece.held = from.take_all<std::int32_t>();
  return piece;
}

// With D = diag(-1, 1) the relative displacement is v = u_plate + D u_base; so u_plate = v - D u_base, or
// u_base = D v - D u_plate.
Terms terms_of(bool is_relative, bool is_base) {
  if (!is_relative) return {};
  return {{is_base ? -1.0 : 1.0, 1}, {1, -1}};
}

DividedBodies::DividedBodies(const ElasticBody& plate, const std::optional<ElasticBody>& base, int n_pieces) {
  bodies_.push_back({&plate.mesh, &plate.material, {}});
  if (base) {
    bodies_.push_back({&base->mesh, &base->material, {}});
    softer_ = plate.material.youngs_modulus_Pa > base->material.youngs_modulus_Pa ? 1 : 0;
  }
  std::vector<std::vector<bool>> is_orphan;
  std::vector<double> x_m;
  for (const auto& body : bodies_) {
    is_orphan.push_back(mesh::orphans(*body.mesh));
    for (mesh::Node n = 0; n < body.mesh->n_nodes(); ++n)
      if (!is_orphan.back()[n]) x_m.push_back(body.mesh->x_m[n]);
  }
  SLIPFRONT_ASSERT(x_m.size() < std::numeric_limits<std::int32_t>::max() / 2, "too many unknowns");
  // From where along x each further piece has the nodes.
  std::vector<double> from_m;
  for (int k = 1; k < n_pieces; ++k) {
    const auto middle =
        x_m.begin() + static_cast<std::ptrdiff_t>(x_m.size() * static_cast<std::size_t>(k) / n_pieces);
    std::ranges::nth_element(x_m, middle);
    from_m.push_back(*middle);
  }
  const auto piece_at = [&](double x) {
    return static_cast<std::size_t>(std::ranges::upper_bound(from_m, x) - from_m.begin());
  };
  std::vector<std::int32_t> count(static_cast<std::size_t>(n_pieces));
  for (const double x : x_m) ++count[piece_at(x)];
  first_.resize(count.size() + 1);
  std::partial_sum(count.begin(), count.end(), first_.begin() + 1);
  auto next = first_;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    auto& body = bodies_[b];
    body.pair.assign(is_orphan[b].size(), -1);
    for (std::size_t n = 0; n < body.pair.size(); ++n)
      if (!is_orphan[b][n]) body.pair[n] = next[piece_at(body.mesh->x_m[n])]++;
  }
}

std::vector<std::int32_t> DividedBodies::opposites(std::size_t body) const {
  std::vector<std::int32_t> opposite(bodies_[body].pair.size(), -1);
  if (!is_relative_body(body)) return opposite;
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
  const auto& relative = bodies_[softer_];
  const auto gap_m = gaps_m(*bodies_.front().mesh, bodies_.size() > 1 ? bodies_.back().mesh : nullptr);
  for (std::size_t k = 0; k < relative.mesh->lower.size(); ++k) {
    const auto own = relative.pair[relative.mesh->lower[k]];
    if (!piece.has(own)) continue;
    piece.lower.push_back({own, static_cast<std::int32_t>(k)});
    piece.gap_m.push_back(gap_m[k]);
  }
  const auto take_top = [&](const Body& body, std::vector<std::int32_t>& to) {
    for (const auto n : body.mesh->top)
      if (piece.has(body.pair[n])) to.push_back(body.pair[n]);
  };
  take_top(bodies_.front(), piece.top);
  if (bodies_.size() > 1) take_top(bodies_.back(), piece.held);
  return piece;
}

std::vector<double> DividedBodies::unknowns(const DisplacementOfBodies& u) const {
  std::vector<double> unknowns(2 * static_cast<std::size_t>(n_pairs()));
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const auto& field = b == 0 ? *u.above : *u.below;
    for (std::size_t n = 0; n < bodies_[b].pair.size(); ++n) {
      const auto pair = bodies_[b].pair[n];
      if (pair < 0) continue;
      unknowns[2 * pair] = field.x[n];
      unknowns[2 * pair + 1] = field.y[n];
    }
  }
  if (bodies_.size() == 1) return unknowns;
  const auto &plate = bodies_[0].mesh->lower, &base = bodies_[1].mesh->lower;
  const auto& relative = bodies_[softer_];
  for (std::size_t k = 0; k < plate.size(); ++k) {
    const auto pair = relative.pair[relative.mesh->lower[k]];
    unknowns[2 * pair] = u.above->x[plate[k]] - u.below->x[base[k]];
    unknowns[2 * pair + 1] = u.above->y[plate[k]] + u.below->y[base[k]];
  }
  return unknowns;
}

Displacement DividedBodies::displacement(const std::vector<double>& unknowns) const {
  Displacement u;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    auto& field = b == 0 ? u.above : u.below;
    field = solid::Field(bodies_[b].pair.size());
    const auto opposite = opposites(b);
    for (std::size_t n = 0; n < field.size(); ++n) {
      const auto pair = bodies_[b].pair[n];
      if (pair < 0) continue;
      const auto terms = terms_of(opposite[n] >= 0, b > 0);
      field.x[n] = terms.own[0] * unknowns[2 * pair];
      field.y[n] = terms.own[1] * unknowns[2 * pair + 1];
      if (opposite[n] < 0) continue;
      field.x[n] += terms.opposite[0] * unknowns[2 * opposite[n]];
      field.y[n] += terms.opposite[1] * unknowns[2 * opposite[n] + 1];
    }
  }
  return u;
}

std::vector<double> DividedBodies::of_piece(const std::vector<double>& unknowns, int number) const {
  return {unknowns.begin() + 2 * std::ptrdiff_t{first_[number]},
          unknowns.begin() + 2 * std::ptrdiff_t{first_[number + 1]}};
}

}  // namespace slipfront::statics
