// SPDX-License-Identifier: BSD-3-Clause
#include "solid/general.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "base/error.hpp"
#include "base/lanes.hpp"
#include "solid/element.hpp"
#include "solid/operator.hpp"

namespace slipfront::solid {

namespace {

/// Two vectors in one.
template <class V, int... k>
inline auto joined(const V& first, const V& second, std::integer_sequence<int, k...>) {
  return __builtin_shufflevector(first, second, k...);
}
/// The numbers of a vector from `from` on, half as many as it has.
template <int from, class V, int... k>
inline auto half_of(const V& whole, std::integer_sequence<int, k...>) {
  return __builtin_shufflevector(whole, whole, (from + k)...);
}
/// even[c], odd[c], even[2 + c], odd[2 + c] ...
template <int c, class V, int... k>
inline V component_of_pairs(const V& even, const V& odd, std::integer_sequence<int, k...>) {
  return __builtin_shufflevector(even, odd, (k - k % 2 + c + (k % 2) * length<V>)...);
}
template <int c, class V>
inline V component_of_pairs(const V& even, const V& odd) {
  return component_of_pairs<c>(even, odd, std::make_integer_sequence<int, length<V>>{});
}

/// Twice the places of one corner of each cell of a batch, and x and y there.
using Places = std::array<std::int32_t, lanes>;
struct LanePairs {
  Lanes x, y;
};

/// x and y in turn at every second place from `lane` on.
template <int n>
inline Vector<double, n> gather_pairs(const double* w, const Places& at, int lane) {
  if constexpr (n == 2) {
    return load_as<Vector<double, 2>>(w + at[lane]);
  } else {
    return joined(gather_pairs<n / 2>(w, at, lane), gather_pairs<n / 2>(w, at, lane + n / 2),
                  std::make_integer_sequence<int, n>{});
  }
}
inline LanePairs gather(const double* w, const Places& at) {
  const Lanes even = gather_pairs<lanes>(w, at, 0), odd = gather_pairs<lanes>(w, at, 1);
  return {component_of_pairs<0>(even, odd), component_of_pairs<1>(even, odd)};
}

template <class V>
inline void scatter_add_pairs(double* force, const Places& at, int lane, const V& even, const V& odd) {
  constexpr int n = length<V>;
  if constexpr (n == 2) {
    store(force + at[lane], load_as<V>(force + at[lane]) + even);
    store(force + at[lane + 1], load_as<V>(force + at[lane + 1]) + odd);
  } else {
    constexpr auto half = std::make_integer_sequence<int, n / 2>{};
    scatter_add_pairs(force, at, lane, half_of<0>(even, half), half_of<0>(odd, half));
    scatter_add_pairs(force, at, lane + n / 2, half_of<n / 2>(even, half), half_of<n / 2>(odd, half));
  }
}
inline void scatter_add(double* force, const Places& at, Lanes x, Lanes y) {
  scatter_add_pairs(force, at, 0, component_of_pairs<0>(x, y), component_of_pairs<1>(x, y));
}

/// The cell's nodes, beginning with the lower left one, so that cells equal in shape are so in order.
mesh::Cell in_order(const mesh::Mesh& mesh, const mesh::Cell& cell) {
  const auto c = cell_coordinates(mesh, cell);
  const double size = std::max(std::abs(c[4] - c[0]) + std::abs(c[5] - c[1]), 1e-300);
  int best = 0;
  for (int a = 1; a < 4; ++a) {
    const double sum = (c[2 * a] + c[2 * a + 1]) - (c[2 * best] + c[2 * best + 1]);
    const bool equal = std::abs(sum) < 1e-6 * size;
    if ((!equal && sum < 0) || (equal && c[2 * a + 1] < c[2 * best + 1])) best = a;
  }
  mesh::Cell ordered = cell;
  std::rotate(ordered.begin(), ordered.begin() + best, ordered.end());
  return ordered;
}

/// Places of the nodes 1, 2, 3 relative to node 0, in units of the cell's size.
using Shape = std::array<double, 6>;
Shape shape_of(const CellCoordinates& c) {
  const double area = 0.5 * ((c[4] - c[0]) * (c[7] - c[3]) - (c[6] - c[2]) * (c[5] - c[1]));
  SLIPFRONT_ASSERT(area > 0, "cell is not convex and counterclockwise");
  Shape shape;
  for (int k = 0; k < 6; ++k) shape[k] = (c[k + 2] - c[k % 2]) / std::sqrt(area);
  return shape;
}

/// Numbers of the classes of similar cells. The tolerance is that of rounding in the nodes' coordinates.
class Shapes {
 public:
  std::size_t class_of(const Shape& shape) {
    auto& candidates = classes_[key(shape)];
    for (const auto k : candidates)
      if (is_same(shapes_[k], shape)) return k;
    candidates.push_back(shapes_.size());
    shapes_.push_back(shape);
    return shapes_.size() - 1;
  }
  std::size_t size() const { return shapes_.size(); }

 private:
  /// Of coordinates rounded far more coarsely than the tolerance. Equal shapes on two sides of a rounding
  /// limit become two classes, which does no harm.
  static std::uint64_t key(const Shape& shape) {
    std::uint64_t hash = 0;
    for (const double x : shape)
      hash = (hash ^ static_cast<std::uint64_t>(std::llround(1e6 * x + 0.25))) * 0x9e3779b97f4a7c15ULL;
    return hash;
  }
  static bool is_same(const Shape& a, const Shape& b) {
    for (std::size_t k = 0; k < a.size(); ++k)
      if (std::abs(a[k] - b[k]) > 1e-11) return false;
    return true;
  }
  std::vector<Shape> shapes_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> classes_;
};

/// Upper triangle, row by row, of the stiffness of nodes 1, 2, 3, both components of each in turn.
constexpr int n_entries = 21;
using Triangle = std::array<double, n_entries>;
Triangle triangle(const CellStiffness& K) {
  Triangle upper{};
  int k = 0;
  for (int r = 2; r < 8; ++r)
    for (int c = r; c < 8; ++c) upper[k++] = K[8 * r + c];
  return upper;
}
struct alignas(64) LaneTriangles {
  std::array<std::array<double, lanes>, n_entries> entry;
};

/// Those of the cells' nodes 0, 1, 2, 3.
using Corners = std::array<Places, 4>;

/// Batches [begin, end) of similar cells.
struct SharedStiffness {
  Triangle stiffness{};
  std::size_t begin = 0, end = 0;
};

/// Nodes with consecutive numbers and places.
struct Run {
  mesh::Node node = 0;
  std::int32_t place = 0, count = 0;
};

/// Adds the forces of a batch of cells; `stiffness(k)` is the k-th entry of the triangle.
template <class Stiffness>
void add_batch(const Corners& corners, Stiffness&& stiffness, const double* w, double* force) {
  const LanePairs origin = gather(w, corners[0]);
  std::array<Lanes, 6> d;
  for (int a = 1; a < 4; ++a) {
    const LanePairs at = gather(w, corners[a]);
    d[2 * a - 2] = at.x - origin.x;
    d[2 * a - 1] = at.y - origin.y;
  }
  std::array<Lanes, 6> f{};
  int k = 0;
  for (int r = 0; r < 6; ++r)
    for (int c = r; c < 6; ++c, ++k) {
      const auto entry = stiffness(k);
      f[r] += entry * d[c];
      if (c > r) f[c] += entry * d[r];
    }
  scatter_add(force, corners[0], -(f[0] + f[2] + f[4]), -(f[1] + f[3] + f[5]));
  for (int a = 1; a < 4; ++a) scatter_add(force, corners[a], f[2 * a - 2], f[2 * a - 1]);
}

}  // namespace

/// Nodes have places here: those of the rows first, then the others at the cells.
struct GeneralRows::Cells {
  std::size_t n_places = 0, n_cells = 0;
  std::vector<Run> runs;
  std::vector<double> per_mass;  ///< [rows] 1/kg
  std::vector<SharedStiffness> shared;
  std::vector<Corners> shared_corners, own_corners;  ///< [batches]
  std::vector<LaneTriangles> own;                    ///< [batches]
};

/// Makes Cells.
class GeneralRows::Builder {
 public:
  Builder(const mesh::Mesh& mesh, const Material& material)
      : mesh_(mesh), material_(material), place_(mesh.n_nodes(), -1) {}

  std::shared_ptr<Cells> build(std::span<const mesh::Node> rows, std::span<const double> mass_kg,
                               const std::vector<bool>& in_part) {
    for (const auto n : rows) {
      append(n);
      result_->per_mass.push_back(1 / mass_kg[n]);
    }
    find_cells(in_part);
    add_batches();
    return std::move(result_);
  }

 private:
  void append(mesh::Node n) {
    place_[n] = static_cast<std::int32_t>(result_->n_places++);
    auto& runs = result_->runs;
    if (!runs.empty() && runs.back().node + runs.back().count == n) {
      ++runs.back().count;
    } else {
      runs.push_back({n, place_[n], 1});
    }
  }

  /// Those marked that have a node among the rows.
  void find_cells(const std::vector<bool>& in_part) {
    const auto n_rows = static_cast<std::int32_t>(result_->n_places);
    const auto has_row = [&](mesh::Node n) { return place_[n] >= 0 && place_[n] < n_rows; };
    std::vector<mesh::Node> others;
    for (std::size_t c = 0; c < mesh_.cells.size(); ++c) {
      if (!in_part[c] || std::ranges::none_of(mesh_.cells[c], has_row)) continue;
      cells_.push_back(in_order(mesh_, mesh_.cells[c]));
      for (const auto n : mesh_.cells[c])
        if (place_[n] < 0) others.push_back(n);
    }
    result_->n_cells = cells_.size();
    std::ranges::sort(others);
    others.erase(std::unique(others.begin(), others.end()), others.end());
    for (const auto n : others) append(n);
    // In the order of their nodes, so that successive cells find them in cache.
    std::ranges::sort(cells_, {}, [&](const mesh::Cell& cell) {
      std::array<std::int32_t, 4> at;
      for (int a = 0; a < 4; ++a) at[a] = place_[cell[a]];
      std::ranges::sort(at);
      return at;
    });
  }

  std::vector<std::vector<std::size_t>> cells_by_shape() const {
    Shapes shapes;
    std::vector<std::size_t> shape(cells_.size());
    for (std::size_t c = 0; c < cells_.size(); ++c)
      shape[c] = shapes.class_of(shape_of(cell_coordinates(mesh_, cells_[c])));
    std::vector<std::vector<std::size_t>> of_shape(shapes.size());
    for (std::size_t c = 0; c < cells_.size(); ++c) of_shape[shape[c]].push_back(c);
    return of_shape;
  }

  Corners corners_of(std::span<const std::size_t> batch) const {
    Corners corners{};
    for (std::size_t lane = 0; lane < batch.size(); ++lane)
      for (int a = 0; a < 4; ++a) corners[a][lane] = 2 * place_[cells_[batch[lane]][a]];
    return corners;
  }

  auto stiffness_of(std::size_t c) const {
    return triangle(cell_stiffness(cell_coordinates(mesh_, cells_[c]), material_));
  }

  /// Full batches of one shape share its stiffness; in the others each lane has its own.
  void add_batches() {
    std::vector<std::size_t> single;
    for (const auto& list : cells_by_shape()) {
      const std::size_t n_batches = list.size() / lanes;
      if (n_batches > 0) {
        const std::size_t begin = result_->shared_corners.size();
        for (std::size_t b = 0; b < n_batches; ++b)
          result_->shared_corners.push_back(corners_of(std::span(list).subspan(b * lanes, lanes)));
        result_->shared.push_back({stiffness_of(list.front()), begin, result_->shared_corners.size()});
      }
      single.insert(single.end(), list.begin() + static_cast<std::ptrdiff_t>(n_batches * lanes), list.end());
    }
    std::ranges::sort(single);
    for (std::size_t first = 0; first < single.size(); first += lanes)
      add_batch_of_own(std::span(single).subspan(first, std::min<std::size_t>(lanes, single.size() - first)));
  }

  /// Lanes without a cell have no stiffness.
  void add_batch_of_own(std::span<const std::size_t> batch) {
    result_->own_corners.push_back(corners_of(batch));
    LaneTriangles own{};
    for (std::size_t lane = 0; lane < batch.size(); ++lane) {
      const auto K = stiffness_of(batch[lane]);
      for (int k = 0; k < n_entries; ++k) own.entry[k][lane] = K[k];
    }
    result_->own.push_back(own);
  }

  const mesh::Mesh& mesh_;
  const Material& material_;
  std::vector<std::int32_t> place_;  ///< [nodes], -1 where they are not needed
  std::vector<mesh::Cell> cells_;
  std::shared_ptr<Cells> result_ = std::make_shared<Cells>();
};

GeneralRows::GeneralRows(const mesh::Mesh& mesh, const Material& material, std::vector<mesh::Node> nodes,
                         std::span<const double> mass_kg, const std::vector<bool>& in_part)
    : node_(std::move(nodes)) {
  if (!node_.empty()) cells_ = Builder(mesh, material).build(node_, mass_kg, in_part);
}

std::size_t GeneralRows::n_cells() const {
  return cells_ ? cells_->n_cells : 0;
}

std::size_t GeneralRows::n_shared_stiffnesses() const {
  return cells_ ? cells_->shared.size() : 0;
}

GeneralRows::Workspace GeneralRows::workspace() const {
  if (!cells_) return {};
  return {std::vector<double>(2 * cells_->n_places), std::vector<double>(2 * cells_->n_places)};
}

void GeneralRows::multiply(const Field& u, double factor, const Field& v, Workspace& space, double* a_x,
                           double* a_y) const {
  if (!cells_) return;
  double* __restrict w = space.w.data();
  double* __restrict force = space.force.data();
  for (const auto& run : cells_->runs) {
    const double* u_x = &u.x[run.node];
    const double* u_y = &u.y[run.node];
    const double* v_x = &v.x[run.node];
    const double* v_y = &v.y[run.node];
    double* to = w + 2 * static_cast<std::ptrdiff_t>(run.place);
    for (int i = 0; i < run.count; ++i) {
      to[2 * i] = u_x[i] + factor * v_x[i];
      to[2 * i + 1] = u_y[i] + factor * v_y[i];
    }
  }
  std::fill_n(force, 2 * cells_->n_places, 0.0);
  for (const auto& shared : cells_->shared) {
    const auto stiffness = shared.stiffness;
    for (std::size_t b = shared.begin; b < shared.end; ++b)
      add_batch(
          cells_->shared_corners[b], [&](int k) { return stiffness[k]; }, w, force);
  }
  for (std::size_t b = 0; b < cells_->own.size(); ++b)
    add_batch(
        cells_->own_corners[b], [&](int k) { return load(cells_->own[b].entry[k].data()); }, w, force);
  for (std::size_t r = 0; r < node_.size(); ++r) {
    a_x[r] = cells_->per_mass[r] * force[2 * r];
    a_y[r] = cells_->per_mass[r] * force[2 * r + 1];
  }
}

}  // namespace slipfront::solid
