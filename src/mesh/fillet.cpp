// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/fillet.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "base/error.hpp"
#include "base/numbers.hpp"

namespace slipfront::mesh {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double min_radius_in_cells = 0.75;
constexpr int min_margin_in_cells = 3;  // regular cells kept between the arc's end and the patch's

using Point = RoundedCorners::Point;

/// One corner of a cell and the corners after and before it, counterclockwise.
struct CellCorner {
  int here = 0;
  int next = 0;
  int last = 0;
};

/// The nodes of the patch at a left corner and, for each free node, the cell corners that move with it.
struct Patch {
  std::vector<Point> at;
  std::vector<int> free;
  std::vector<std::vector<CellCorner>> around;
};

/// Node `a` of the smooth side, counted from the middle of the arc along the bottom edge.
Point on_smooth_side(const Fold& fold, int a) {
  const double radius = fold.radius_m;
  if (a < fold.half_arc) {
    const double angle = pi / 4 * (fold.half_arc - a) / fold.half_arc;
    return {radius - radius * std::sin(angle), radius - radius * std::cos(angle)};
  }
  const int straight = fold.side - fold.cut - fold.half_arc;
  return {radius + (fold.side * fold.spacing_m - radius) * (a - fold.half_arc) / straight, 0};
}

/// The patch with its boundary in place and its free nodes still at their grid positions.
Patch make_patch(const Fold& fold) {
  Patch patch;
  patch.at.resize(fold.n_nodes());
  patch.around.resize(fold.n_nodes());
  for (int j = 0; j <= fold.side; ++j)
    for (int i = 0; i <= fold.side; ++i) {
      if (!fold.has_node(i, j)) continue;
      const int n = fold.node(i, j);
      patch.at[n] = {i * fold.spacing_m, j * fold.spacing_m};
      if (i > 0 && i < fold.side && j > 0 && j < fold.side) patch.free.push_back(n);
    }
  for (int a = 0; fold.cut + a < fold.side; ++a) {
    const Point p = on_smooth_side(fold, a);
    patch.at[fold.node(0, fold.cut + a)] = {p.y, p.x};
    patch.at[fold.node(fold.cut + a, 0)] = p;
  }
  for (int j = 0; j < fold.side; ++j)
    for (int i = 0; i < fold.side; ++i) {
      if (!fold.has_cell(i, j)) continue;
      const int cell[4] = {fold.node(i, j), fold.node(i + 1, j), fold.node(i + 1, j + 1),
                           fold.node(i, j + 1)};
      for (int c = 0; c < 4; ++c) {
        const CellCorner corner{cell[c], cell[(c + 1) % 4], cell[(c + 3) % 4]};
        for (const int n : {corner.here, corner.next, corner.last}) patch.around[n].push_back(corner);
      }
    }
  return patch;
}

/// Moves each free node into the mean of its neighbours (successive over-relaxation). The patch being convex,
/// this leaves no cell folded over (Tutte's embedding theorem), but the cells near the arc are too small.
void spread(Patch& patch, const Fold& fold) {
  const double relaxation = 2 / (1 + std::sin(pi / fold.side));
  for (int sweep = 0; sweep < 4 * fold.side + 40; ++sweep)
    for (const int n : patch.free) {
      Point sum;
      int count = 0;  // each neighbour counts twice, once for each cell beside the edge to it
      for (const CellCorner& corner : patch.around[n]) {
        if (corner.here != n) continue;
        sum.x += patch.at[corner.next].x + patch.at[corner.last].x;
        sum.y += patch.at[corner.next].y + patch.at[corner.last].y;
        count += 2;
      }
      patch.at[n].x += relaxation * (sum.x / count - patch.at[n].x);
      patch.at[n].y += relaxation * (sum.y / count - patch.at[n].y);
    }
}

/// Sum over the cell corners at node n of (spacing^2 |J^-1|^2/2)^8, J being the corner's edges; infinite if
/// folded. |J^-1|^2 follows the square of the cell's highest frequency, and the high power lets the worst
/// cells decide.
double distortion(const Patch& patch, const Fold& fold, int n) {
  double sum = 0;
  for (const CellCorner& corner : patch.around[n]) {
    const Point o = patch.at[corner.here];
    const Point a{patch.at[corner.next].x - o.x, patch.at[corner.next].y - o.y};
    const Point b{patch.at[corner.last].x - o.x, patch.at[corner.last].y - o.y};
    const double area = a.x * b.y - a.y * b.x;
    if (!(area > 0)) return infinity;
    const double square = 0.5 * fold.spacing_m * fold.spacing_m *
                          (a.x * a.x + a.y * a.y + b.x * b.x + b.y * b.y) / (area * area);
    const double power2 = square * square;
    const double power4 = power2 * power2;
    sum += power4 * power4;
  }
  return sum;
}

/// Improves the place of node n by one over-relaxed Newton step on its distortion, derivatives by finite
/// differences.
void improve(Patch& patch, const Fold& fold, int n, double relaxation) {
  const Point start = patch.at[n];
  const auto value = [&](double dx, double dy) {
    patch.at[n] = {start.x + dx, start.y + dy};
    return distortion(patch, fold, n);
  };
  const double e = 1e-4 * fold.spacing_m;
  const double f = value(0, 0);
  const double right = value(e, 0), left = value(-e, 0), up = value(0, e), down = value(0, -e);
  const double gx = (right - left) / (2 * e);
  const double gy = (up - down) / (2 * e);
  const double hxx = (right - 2 * f + left) / (e * e);
  const double hyy = (up - 2 * f + down) / (e * e);
  const double hxy = (value(e, e) - right - up + f) / (e * e);
  const double determinant = hxx * hyy - hxy * hxy;
  Point step;
  if (hxx > 0 && determinant > 0) {
    step = {(hxy * gy - hyy * gx) / determinant, (hxy * gx - hxx * gy) / determinant};
  } else {  // no minimum near: a short step downhill
    const double scale =
        0.1 * fold.spacing_m / std::max(std::hypot(gx, gy), std::numeric_limits<double>::min());
    step = {-scale * gx, -scale * gy};
  }
  for (double share = relaxation; share > 0.01; share *= 0.5)
    if (value(share * step.x, share * step.y) < f) return;
  patch.at[n] = start;
}

/// Over-relaxation lets the shape travel across the patch in a number of sweeps proportional to its side.
void optimise(Patch& patch, const Fold& fold) {
  const double relaxation = 2 / (1 + std::sin(pi / fold.side));
  for (int sweep = 0; sweep < 2 * fold.side + 20; ++sweep)
    for (const int n : patch.free) improve(patch, fold, n, relaxation);
}

}  // namespace

RoundedCorners::RoundedCorners(const Grid& grid, bool is_graded, double radius_m)
    : columns_(grid.columns), fold_{.radius_m = radius_m, .spacing_m = grid.spacing_m} {
  const double h = grid.spacing_m;
  const double smallest = min_radius_in_cells * h;
  const int room = std::min(grid.columns / 2, grid.rows);
  const double largest = (room - min_margin_in_cells) * h;
  if (largest < smallest)
    throw UserError("{} = {:g} is too large to round the corners of this plate; use a smaller size",
                    Key("plate.element_size_m"), h);
  // The slack admits the limits as printed.
  if (!(radius_m >= (1 - 1e-6) * smallest))
    throw UserError("{} = {:g} is too small for these elements; make it at least {:.8g}",
                    Key("plate.fillet_radius_m"), radius_m, smallest)
        .about("plate.element_size_m");
  if (radius_m > (1 + 1e-6) * largest)
    throw UserError("{} = {:g} does not fit into the plate{}; make it at most {:.8g}",
                    Key("plate.fillet_radius_m"), radius_m,
                    is_graded ? Message("'s smallest elements ({})", Key("plate.fine_height_m")) : Message(),
                    largest)
        .about("plate.width_m", "plate.height_m");
  fold_.cut = std::max(1, static_cast<int>(std::lround((1 - pi / 4) * radius_m / h)));
  fold_.side = std::min(room, static_cast<int>(std::ceil(1.25 * radius_m / h)) + 4);
  const int segments = fold_.side - fold_.cut;
  const double arc_m = pi / 4 * radius_m;
  const double segment_m = (fold_.side * h - radius_m + arc_m) / segments;
  fold_.half_arc = std::clamp(static_cast<int>(std::lround(arc_m / segment_m)), 1, segments - 1);
}

bool RoundedCorners::is_cut(int i, int j) const {
  return j < cut() && (i < cut() || i >= columns_ - cut());
}

RoundedCorners::Place RoundedCorners::glued(Place node) const {
  const auto [i, j] = node;
  if (j != cut()) return node;
  if (i < cut()) return {cut(), i};
  if (columns_ - i < cut()) return {columns_ - cut(), columns_ - i};
  return node;
}

std::vector<RoundedCorners::Point> RoundedCorners::places() const {
  Patch patch = make_patch(fold_);
  spread(patch, fold_);
  optimise(patch, fold_);
  const Point arc_middle = on_smooth_side(fold_, 0);
  std::vector<Point> places;
  for (int j = 0; j < side(); ++j)
    for (int i = 0; i < side(); ++i)
      places.push_back(fold_.has_node(i, j) ? patch.at[fold_.node(i, j)] : arc_middle);
  return places;
}

std::vector<RoundedCorners::Place> RoundedCorners::lower() const {
  std::vector<Place> lower;
  for (int a = fold_.half_arc; a > 0; --a) lower.push_back({0, cut() + a});
  for (int i = cut(); i <= columns_ - cut(); ++i) lower.push_back({i, 0});
  for (int a = 1; a <= fold_.half_arc; ++a) lower.push_back({columns_, cut() + a});
  return lower;
}

}  // namespace slipfront::mesh
