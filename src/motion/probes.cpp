// SPDX-License-Identifier: BSD-3-Clause
#include "motion/probes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/error.hpp"
#include "motion/orientation.hpp"

namespace slipfront::motion {

namespace {

/// The range of heights of a cell's nodes, with an allowance for rounding.
struct Heights {
  double from_m = 0, to_m = 0;
};

Heights heights_of(const solid::CellCoordinates& c) {
  const auto [low, high] = std::minmax({c[1], c[3], c[5], c[7]});
  const double rounding_m = 1e-6 * (high - low);
  return {low - rounding_m, high + rounding_m};
}

/// Shape functions of a cell at a place; a periodic body is looked at on either side of its seam.
std::optional<solid::CellShape> shape_in(const mesh::Mesh& mesh, const solid::CellCoordinates& c, double x_m,
                                         double y_m) {
  const auto [left, right] = std::minmax({c[0], c[2], c[4], c[6]});
  const double rounding_m = 1e-6 * (right - left);
  for (const double shift_m : {0.0, -mesh.period_m, mesh.period_m}) {
    const double x = x_m + shift_m;
    if (x < left - rounding_m || x > right + rounding_m) continue;
    if (auto shape = solid::cell_shape_at(c, x, y_m)) return shape;
  }
  return std::nullopt;
}

/// Places within a body: their numbers, and their heights in the body's own axes, ascending.
struct PlacesInBody {
  std::vector<std::size_t> place;
  std::vector<double> y_m;
};

PlacesInBody places_in(std::span<const record::ProbePlace> places, bool below) {
  PlacesInBody in;
  for (std::size_t k = 0; k < places.size(); ++k)
    if ((places[k].y_m < 0) == below) in.place.push_back(k);
  std::ranges::stable_sort(in.place, {}, [&](std::size_t k) { return std::abs(places[k].y_m); });
  for (const auto k : in.place) in.y_m.push_back(std::abs(places[k].y_m));
  return in;
}

void locate_in(const BodySource& source, std::size_t body, std::span<const record::ProbePlace> places,
               std::vector<std::optional<Probe>>& found) {
  const auto in = places_in(places, sign_of_body(body) < 0);
  if (in.place.empty()) return;
  for (const auto& cell : source.mesh.cells) {
    const auto c = solid::cell_coordinates(source.mesh, cell);
    const auto [from_m, to_m] = heights_of(c);
    auto at = std::ranges::lower_bound(in.y_m, from_m) - in.y_m.begin();
    for (; at < std::ssize(in.y_m) && in.y_m[at] <= to_m; ++at) {
      const auto k = in.place[at];
      if (found[k]) continue;
      if (const auto shape = shape_in(source.mesh, c, places[k].x_m, in.y_m[at]))
        found[k] = Probe{body, {cell[0], cell[1], cell[2], cell[3]}, *shape, source.material};
    }
  }
}

}  // namespace

std::vector<Probe> locate_probes(std::span<const record::ProbePlace> places,
                                 std::span<const BodySource> bodies) {
  std::vector<std::optional<Probe>> found(places.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) locate_in(bodies[b], b, places, found);
  std::vector<Probe> probes;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto& [name, x_m, y_m] = places[k];
    if (!found[k])
      throw UserError("{}: the probe {} at ({}, {}) m lies outside the {}; move it inside", Key("probes.x_m"),
                      name, x_m, y_m, bodies.size() > 1 ? "two bodies" : "plate")
          .about("probes.y_m");
    probes.push_back(*found[k]);
  }
  return probes;
}

ProbeRecorder::ProbeRecorder(std::vector<Probe> probes, double step_s, double interval_s,
                             std::vector<double> before_m, std::vector<double> now_m,
                             const std::optional<solid::UniformStress>& further)
    : probes_(std::move(probes)),
      step_s_(step_s),
      every_(interval_s),
      further_(further),
      before_m_(std::move(before_m)),
      now_m_(std::move(now_m)) {
  SLIPFRONT_ASSERT(
      before_m_.size() == displacement_values(probes_) && now_m_.size() == displacement_values(probes_),
      "a displacement for each node of the probes");
}

void ProbeRecorder::expect(std::int64_t first, std::int64_t n) {
  first_ = first;
  place_.assign(static_cast<std::size_t>(n), -1);
  std::ptrdiff_t next = 0;
  for (std::int64_t step = first + 1; step <= first + n; ++step) {
    if (!is_sampled(step - 1) && !is_sampled(step) && !is_sampled(step + 1)) continue;
    place_[static_cast<std::size_t>(step - first - 1)] = next;
    next += std::ssize(now_m_);
  }
  kept_m_.resize(static_cast<std::size_t>(next));
}

double* ProbeRecorder::room_for(std::int64_t step) {
  const auto place = place_[static_cast<std::size_t>(step - first_ - 1)];
  return place < 0 ? nullptr : kept_m_.data() + place;
}

void ProbeRecorder::take_rows(std::int64_t last, record::ProbeRecord& rows) {
  last = std::min(last, first_ + std::ssize(place_));
  for (std::int64_t step = first_ + 1; step <= last; ++step) {
    const double* kept = room_for(step);
    if (kept == nullptr) continue;
    const std::span<const double> after_m(kept, now_m_.size());
    if (is_sampled(step - 1)) append_row(static_cast<double>(step - 1) * step_s_, after_m, rows);
    std::swap(before_m_, now_m_);
    now_m_.assign(after_m.begin(), after_m.end());
  }
  place_.clear();
}

void ProbeRecorder::append_row(double time_s, std::span<const double> after_m,
                               record::ProbeRecord& rows) const {
  rows.time_s.push_back(time_s);
  for (std::size_t p = 0; p < probes_.size(); ++p) {
    const Probe& probe = probes_[p];
    std::array<double, 8> u_m{};
    double u_x = 0, u_y = 0, v_x = 0, v_y = 0;
    for (std::size_t a = 0; a < 4; ++a) {
      const std::size_t at = 8 * p + 2 * a;
      const double weight = probe.shape.value[a];
      u_m[2 * a] = now_m_[at];
      u_m[2 * a + 1] = now_m_[at + 1];
      u_x += weight * now_m_[at];
      u_y += weight * now_m_[at + 1];
      v_x += weight * (after_m[at] - before_m_[at]) / (2 * step_s_);
      v_y += weight * (after_m[at + 1] - before_m_[at + 1]) / (2 * step_s_);
    }
    const double up = sign_of_body(probe.body);
    auto further = further_;
    if (further) further->xy_Pa *= up, further->xy_Pa_per_s *= up;
    const auto [e, s] = solid::strain_and_stress(probe.shape, u_m, probe.material, further, time_s);
    const std::array<double, record::probe_fields.size()> values = {
        u_x, up * u_y, v_x, up * v_y, e.xx, e.yy, e.zz, up * e.xy, s.xx, s.yy, s.zz, up * s.xy};
    for (std::size_t f = 0; f < values.size(); ++f)
      (rows.*record::probe_fields[f].member).push_back(values[f]);
  }
}

}  // namespace slipfront::motion
