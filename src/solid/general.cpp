// SPDX-License-Identifier: BSD-3-Clause
#include "solid/general.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

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
  SimdVector x, y;
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
  const SimdVector even = gather_pairs<lanes>(w, at, 0), odd = gather_pairs<lanes>(w, at, 1);
  return {component_of_pairs<0>(even, odd), component_of_pairs<1>(even, odd)};
}

/// Room for x and y of a number in each lane, in turn: lane k's are at place_of_lane(k) and the one after it.
constexpr int pairs = 2 * lanes;
constexpr int place_of_lane(int lane) {
  return lane % 2 * lanes + lane / 2 * 2;
}
inline void store_pairs(double* to, SimdVector x, SimdVector y) {
  store(to, component_of_pairs<0>(x, y));
  store(to + lanes, component_of_pairs<1>(x, y));
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

/// A cell that stands for itself and all that are similar to it.
struct Shape {
  CellCoordinates corners{};
  /// Whether its corners lie, to rounding, on a coarse lattice in units of its largest extent, as those of
  /// squares and of the cells between blocks of squares do. There they are taken to lie exactly.
  bool is_regular = false;
};
Shape shape_of(const CellCoordinates& c) {
  constexpr double steps = 8, tolerance = 1e-11;
  Shape shape{c, true};
  double extent = 0;
  for (int k = 2; k < 8; ++k) extent = std::max(extent, std::abs(c[k] - c[k % 2]));
  CellCoordinates exact{};
  for (int k = 2; k < 8; ++k) {
    const double x = (c[k] - c[k % 2]) / extent;
    exact[k] = std::round(steps * x) / steps + 0.0;  // no -0
    shape.is_regular = shape.is_regular && std::abs(x - exact[k]) <= tolerance;
  }
  if (shape.is_regular) shape.corners = exact;
  return shape;
}

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

/// Puts the forces on the corners of a batch's cells into `force`; `stiffness(k)` is the k-th entry of the
/// triangle.
template <class Stiffness>
void compute_batch(const Corners& corners, Stiffness&& stiffness, const double* w, double* force) {
  const LanePairs origin = gather(w, corners[0]);
  std::array<SimdVector, 6> d;
  for (int a = 1; a < 4; ++a) {
    const LanePairs at = gather(w, corners[a]);
    d[2 * a - 2] = at.x - origin.x;
    d[2 * a - 1] = at.y - origin.y;
  }
  std::array<SimdVector, 6> f{};
  int k = 0;
  // Not unrolled, d and f would stay in memory.
#pragma GCC unroll 6
  for (int r = 0; r < 6; ++r)
#pragma GCC unroll 6
    for (int c = r; c < 6; ++c, ++k) {
      const auto entry = stiffness(k);
      f[r] += entry * d[c];
      if (c > r) f[c] += entry * d[r];
    }
  store_pairs(force, -(f[0] + f[2] + f[4]), -(f[1] + f[3] + f[5]));
  for (int a = 1; a < 4; ++a) store_pairs(force + a * pairs, f[2 * a - 2], f[2 * a - 1]);
}
constexpr std::size_t forces_of_batch = 4 * pairs;

}  // namespace

/// Nodes have places here: those of the rows first, then the others at the cells.
struct GeneralRows::Cells {
  std::size_t n_places = 0;
  std::vector<Run> runs;
  std::vector<double> per_mass;  ///< [rows] 1/kg
  std::vector<SharedStiffness> shared;
  std::vector<Corners> shared_corners, own_corners;  ///< [batches]
  std::vector<LaneTriangles> own;                    ///< [batches]
  /// Places of the forces of each row's cells: those of the shared batches, then those of the others.
  std::vector<std::int32_t> first_force, force;
  std::size_t n_batches() const { return shared_corners.size() + own_corners.size(); }
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
    find_forces();
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
      cells_.push_back({in_order(mesh_, mesh_.cells[c]), c});
      for (const auto n : mesh_.cells[c])
        if (place_[n] < 0) others.push_back(n);
    }
    std::ranges::sort(others);
    others.erase(std::unique(others.begin(), others.end()), others.end());
    for (const auto n : others) append(n);
    // In the order of their nodes, so that successive cells find them in cache.
    std::ranges::sort(cells_, {}, [&](const Numbered& cell) {
      std::array<std::int32_t, 4> at;
      for (int a = 0; a < 4; ++a) at[a] = place_[cell.nodes[a]];
      std::ranges::sort(at);
      return at;
    });
  }

  Corners corners_of(std::span<const std::size_t> batch) const {
    Corners corners{};
    for (std::size_t lane = 0; lane < batch.size(); ++lane)
      for (int a = 0; a < 4; ++a) corners[a][lane] = 2 * place_[cells_[batch[lane]].nodes[a]];
    return corners;
  }

  /// Full batches of one regular shape share its stiffness; in the others each lane has its own.
  void add_batches() {
    std::vector<CellCoordinates> shape;
    std::map<CellCoordinates, std::vector<std::size_t>> of_shape;
    std::vector<std::size_t> single;
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      const auto [corners, is_regular] = shape_of(cell_coordinates(mesh_, cells_[c].nodes));
      shape.push_back(corners);
      if (is_regular)
        of_shape[corners].push_back(c);
      else
        single.push_back(c);
    }
    batch_of_.resize(cells_.size());
    for (const auto& [corners, list] : of_shape) {
      const std::size_t n_batches = list.size() / lanes;
      if (n_batches > 0) {
        const std::size_t begin = result_->shared_corners.size();
        for (std::size_t b = 0; b < n_batches; ++b) {
          const auto batch = std::span(list).subspan(b * lanes, lanes);
          note_batch(batch, begin + b);
          result_->shared_corners.push_back(corners_of(batch));
        }
        const auto K = triangle(cell_stiffness(corners, material_));
        result_->shared.push_back({K, begin, result_->shared_corners.size()});
      }
      single.insert(single.end(), list.begin() + static_cast<std::ptrdiff_t>(n_batches * lanes), list.end());
    }
    std::ranges::sort(single);
    for (std::size_t first = 0; first < single.size(); first += lanes)
      add_batch_of_own(std::span(single).subspan(first, std::min<std::size_t>(lanes, single.size() - first)),
                       shape);
  }

  /// SimdVector without a cell have no stiffness.
  void add_batch_of_own(std::span<const std::size_t> batch, std::span<const CellCoordinates> shape) {
    note_batch(batch, result_->n_batches());
    result_->own_corners.push_back(corners_of(batch));
    LaneTriangles own{};
    for (std::size_t lane = 0; lane < batch.size(); ++lane) {
      const auto K = triangle(cell_stiffness(shape[batch[lane]], material_));
      for (int k = 0; k < n_entries; ++k) own.entry[k][lane] = K[k];
    }
    result_->own.push_back(own);
  }
  void note_batch(std::span<const std::size_t> batch, std::size_t number) {
    for (std::size_t lane = 0; lane < batch.size(); ++lane) batch_of_[batch[lane]] = {number, lane};
  }

  /// Rows add their cells' forces in the order that the cells have in the mesh.
  void find_forces() {
    const auto n_rows = result_->per_mass.size();
    std::vector<std::vector<std::int32_t>> of_row(n_rows);
    std::vector<std::size_t> in_mesh(cells_.size());
    std::iota(in_mesh.begin(), in_mesh.end(), std::size_t{0});
    std::ranges::sort(in_mesh, {}, [&](std::size_t c) { return cells_[c].number; });
    for (const auto c : in_mesh)
      for (std::size_t a = 0; a < 4; ++a) {
        const auto row = static_cast<std::size_t>(place_[cells_[c].nodes[a]]);
        if (row >= n_rows) continue;
        const auto [batch, lane] = batch_of_[c];
        of_row[row].push_back(static_cast<std::int32_t>(batch * forces_of_batch + a * pairs) +
                              place_of_lane(static_cast<int>(lane)));
      }
    result_->first_force.push_back(0);
    for (const auto& forces : of_row) {
      result_->force.insert(result_->force.end(), forces.begin(), forces.end());
      result_->first_force.push_back(static_cast<std::int32_t>(result_->force.size()));
    }
  }

  const mesh::Mesh& mesh_;
  const Material& material_;
  std::vector<std::int32_t> place_;  ///< [nodes], -1 where they are not needed
  struct Numbered {
    mesh::Cell nodes{};
    std::size_t number = 0;  ///< in the mesh
  };
  std::vector<Numbered> cells_;
  struct InBatch {
    std::size_t batch = 0, lane = 0;
  };
  std::vector<InBatch> batch_of_;  ///< [cells]
  std::shared_ptr<Cells> result_ = std::make_shared<Cells>();
};

GeneralRows::GeneralRows(const mesh::Mesh& mesh, const Material& material, std::vector<mesh::Node> nodes,
                         std::span<const double> mass_kg, const std::vector<bool>& in_part)
    : node_(std::move(nodes)) {
  if (!node_.empty()) cells_ = Builder(mesh, material).build(node_, mass_kg, in_part);
}

std::size_t GeneralRows::n_shared_stiffnesses() const {
  return cells_ ? cells_->shared.size() : 0;
}

GeneralRows::Workspace GeneralRows::workspace() const {
  if (!cells_) return {};
  return {std::vector<double>(2 * cells_->n_places),
          std::vector<double>(forces_of_batch * cells_->n_batches())};
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
  double* of_batch = force;
  for (const auto& shared : cells_->shared) {
    const auto stiffness = shared.stiffness;
    for (std::size_t b = shared.begin; b < shared.end; ++b, of_batch += forces_of_batch)
      compute_batch(
          cells_->shared_corners[b], [&](int k) { return stiffness[k]; }, w, of_batch);
  }
  for (std::size_t b = 0; b < cells_->own.size(); ++b, of_batch += forces_of_batch)
    compute_batch(
        cells_->own_corners[b], [&](int k) { return load(cells_->own[b].entry[k].data()); }, w, of_batch);
  const auto* first = cells_->first_force.data();
  const auto* at = cells_->force.data();
  for (std::size_t r = 0; r < node_.size(); ++r) {
    Vector<double, 2> sum{};
    for (auto k = first[r]; k < first[r + 1]; ++k) sum += load_as<Vector<double, 2>>(force + at[k]);
    a_x[r] = cells_->per_mass[r] * sum[0];
    a_y[r] = cells_->per_mass[r] * sum[1];
  }
}

}  // namespace slipfront::solid
