// SPDX-License-Identifier: BSD-3-Clause
#include "motion/observed_run.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace slipfront::motion {

End ObservedRun::run() {
  for (;;) {
    Pause pause(*stepper_);
    for (const auto& observer : observers_) observer->at_pause(pause);
    if (auto ended = end(pause)) {
      for (const auto& observer : observers_) observer->at_end(pause);
      return *std::move(ended);
    }
    auto n = many_steps;
    for (const auto& observer : observers_) n = std::min(n, observer->steps_to_pause(pause.now()));
    for (const auto& observer : observers_) observer->expect(pause.now(), n);
    stepper_->advance(*this, n);
  }
}

std::optional<End> ObservedRun::end(Pause& pause) {
  for (const auto& observer : observers_)
    if (auto ended = observer->end(pause)) return ended;
  return {};
}

record::History* ObservedRun::row() {
  const Now now = stepper_->now();
  const auto wants = [&](const auto& observer) { return observer->wants_row(now); };
  return std::ranges::any_of(observers_, wants) ? &row_ : nullptr;
}

double* ObservedRun::displacements(std::int64_t step) {
  for (const auto& observer : observers_)
    if (double* to = observer->displacements(step); to != nullptr) return to;
  return nullptr;
}

std::int64_t ObservedRun::guaranteed_steps() {
  auto n = many_steps;
  for (const auto& observer : observers_) n = std::min(n, observer->guaranteed_steps(stepper_->now()));
  return n;
}

bool ObservedRun::after_step(const SlipRates& rates) {
  const Now now = stepper_->now(), before{now.step - 1, now.step_s};
  if (!row_.time_s.empty()) {
    for (const auto& observer : observers_)
      if (observer->wants_row(before)) observer->take_row(row_);
    for (auto* values : members_of(row_)) values->clear();
  }
  bool goes_on = true;
  for (const auto& observer : observers_) goes_on = observer->after_step(now, rates) && goes_on;
  return goes_on;
}

void ObservedRun::archive(StateArchive& archive) {
  const auto n_kept =
      std::ranges::count_if(observers_, [](const auto& observer) { return observer->name() != nullptr; });
  auto n = static_cast<std::uint64_t>(n_kept);
  archive(n);
  require_possible(n == static_cast<std::uint64_t>(n_kept), "observers");
  finder().archive(archive);
  for (const auto& observer : observers_) {
    if (observer->name() == nullptr) continue;
    const std::string expected = observer->name();
    std::string name = expected;
    archive(name);
    require_possible(name == expected, "observers");
    observer->archive(archive);
  }
}

void ObservedRun::require_restored() {
  Pause pause(*stepper_);
  require_possible(finder().memory().time_s <= (1 + 1e-12) * pause.now().time_s(), "times of motion");
  for (const auto& observer : observers_) observer->restored(pause);
}

}  // namespace slipfront::motion
