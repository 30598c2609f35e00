// SPDX-License-Identifier: BSD-3-Clause
#include "problem/loading_path.hpp"

#include <algorithm>

#include "base/interpolation.hpp"
#include "base/numbers.hpp"

namespace slipfront::problem {

LoadingPath::LoadingPath(const input::Sequence& sequence, double shear_speed_m_per_s)
    : speed_m_per_s_(shear_speed_m_per_s), end_s_(sequence.end_s) {
  const auto& [times_s, shears_m] = sequence.path;
  if (times_s.empty()) return;
  times_s_ = {0};
  shears_m_ = {0};
  times_s_.insert(times_s_.end(), times_s.begin(), times_s.end());
  shears_m_.insert(shears_m_.end(), shears_m.begin(), shears_m.end());
  end_s_ = std::min(end_s_, times_s_.back());
}

double LoadingPath::shear_m(double time_s) const {
  if (times_s_.empty()) return speed_m_per_s_ * time_s;
  return interpolated(times_s_, shears_m_, time_s);
}

double LoadingPath::time_s(double shear_m, double after_s) const {
  if (times_s_.empty()) return std::max(shear_m / speed_m_per_s_, after_s);
  const auto next = std::ranges::lower_bound(shears_m_, shear_m) - shears_m_.begin();
  if (next == 0) return after_s;
  if (next == std::ssize(shears_m_)) return infinity;
  const double part = (shear_m - shears_m_[next - 1]) / (shears_m_[next] - shears_m_[next - 1]);
  return std::max(times_s_[next - 1] + part * (times_s_[next] - times_s_[next - 1]), after_s);
}

double LoadingPath::part_end_s(double time_s) const {
  const auto next = std::ranges::upper_bound(times_s_, time_s);
  return next == times_s_.end() ? end_s_ : std::min(*next, end_s_);
}

double LoadingPath::speed_m_per_s(double time_s, double shear_m) const {
  if (times_s_.empty()) return speed_m_per_s_;
  const double end_s = part_end_s(time_s);
  return (this->shear_m(end_s) - shear_m) / (end_s - time_s);
}

double LoadingPath::fastest_m_per_s() const {
  if (times_s_.empty()) return speed_m_per_s_;
  double fastest_m_per_s = 0;
  for (std::size_t k = 1; k < times_s_.size(); ++k)
    fastest_m_per_s =
        std::max(fastest_m_per_s, (shears_m_[k] - shears_m_[k - 1]) / (times_s_[k] - times_s_[k - 1]));
  return fastest_m_per_s;
}

}  // namespace slipfront::problem
