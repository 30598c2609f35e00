// SPDX-License-Identifier: BSD-3-Clause
#include "motion/step_report.hpp"

#include <algorithm>

#include "base/error.hpp"

namespace slipfront::motion {

namespace {

/// Rows of values, each of all subdomains one after the other.
template <class Of>
std::vector<double> joined_rows(std::span<const StepReport> parts, std::size_t n_rows, const Of& of) {
  std::size_t n_values = 0;
  for (const auto& subdomain : parts) n_values += of(subdomain).size();
  std::vector<double> all;
  all.reserve(n_values);
  for (std::size_t row = 0; row < n_rows; ++row)
    for (const auto& subdomain : parts) {
      const std::vector<double>& values = of(subdomain);
      const auto width = static_cast<std::ptrdiff_t>(values.size() / n_rows);
      const auto begin = values.begin() + static_cast<std::ptrdiff_t>(row) * width;
      all.insert(all.end(), begin, begin + width);
    }
  return all;
}

SlipUpdates joined_slips(std::span<const StepReport> parts) {
  SlipUpdates all{parts.front().seen.time_s, parts.front().seen.moves, {}, {}, {}};
  struct Change {
    std::int32_t update;
    const SlipChange* change;
    const record::Traction* around;
  };
  std::vector<Change> changes;
  std::size_t n_around = 0;
  for (const auto& subdomain : parts) {
    const auto& seen = subdomain.seen;
    for (std::size_t k = 0; k < all.moves.size(); ++k) all.moves[k] |= seen.moves[k];
    const auto beginnings = std::ranges::count_if(seen.changes, &SlipChange::begins);
    if (beginnings > 0) n_around = seen.around.size() / static_cast<std::size_t>(beginnings);
    const auto* around = seen.around.data();
    for (std::size_t k = 0; k < seen.changes.size(); ++k) {
      changes.push_back({seen.update[k], &seen.changes[k], around});
      if (seen.changes[k].begins) around += n_around;
    }
  }
  std::ranges::stable_sort(changes, {}, &Change::update);
  for (const auto& [update, change, around] : changes) {
    all.update.push_back(update);
    all.changes.push_back(*change);
    if (change->begins) all.around.insert(all.around.end(), around, around + n_around);
  }
  return all;
}

}  // namespace

void SlipUpdates::add(const SlipUpdate& seen) {
  update.insert(update.end(), seen.changes.size(), static_cast<std::int32_t>(time_s.size()));
  changes.insert(changes.end(), seen.changes.begin(), seen.changes.end());
  around.insert(around.end(), seen.around.begin(), seen.around.end());
  time_s.push_back(seen.time_s);
  moves.push_back(static_cast<std::uint8_t>(seen.moves));
}

const SlipUpdate& SlipUpdateIterator::next() {
  seen_.time_s = all_.time_s[update_];
  seen_.moves = all_.moves[update_] != 0;
  seen_.changes.clear();
  for (; change_ < all_.changes.size() && all_.update[change_] == static_cast<std::int32_t>(update_);
       ++change_)
    seen_.changes.push_back(all_.changes[change_]);
  const auto beginnings = std::ranges::count_if(seen_.changes, &SlipChange::begins);
  const auto n = n_around_ * static_cast<std::size_t>(beginnings);
  const auto some = std::span(all_.around).subspan(around_, n);
  seen_.around.assign(some.begin(), some.end());
  around_ += n;
  ++update_;
  return seen_;
}

StepReport StepReport::joined(std::vector<MessageBuffer> of_subdomains) {
  std::vector<StepReport> parts;
  for (auto& buffer : of_subdomains) {
    parts.push_back(unpacked<StepReport>(buffer));
    buffer = {};
  }
  const auto& first = parts.front();
  StepReport all;
  all.memory.time_s = first.memory.time_s;
  const auto append = []<class T>(std::vector<T>& to, const std::vector<T>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  for (const auto& subdomain : parts) {
    append(all.memory.t_Pa, subdomain.memory.t_Pa);
    append(all.memory.p_Pa, subdomain.memory.p_Pa);
    append(all.memory.strength_Pa, subdomain.memory.strength_Pa);
    append(all.memory.onset_ratio, subdomain.memory.onset_ratio);
    append(all.memory.slipping, subdomain.memory.slipping);
    all.is_interrupted = all.is_interrupted || subdomain.is_interrupted;
  }
  all.rates.resize(first.rates.size());
  for (const auto& subdomain : parts)
    for (std::size_t k = 0; k < all.rates.size(); ++k) all.rates[k].add(subdomain.rates[k]);
  all.seen = joined_slips(parts);
  const auto n_rows = first.samples.front().size() / first.memory.t_Pa.size();
  for (std::size_t f = 0; f < first.samples.size(); ++f)
    all.samples.push_back(joined_rows(
        parts, n_rows,
        [f](const StepReport& subdomain) -> const std::vector<double>& { return subdomain.samples[f]; }));
  all.displacements = joined_rows(
      parts, first.rates.size(),
      [](const StepReport& subdomain) -> const std::vector<double>& { return subdomain.displacements; });
  return all;
}

}  // namespace slipfront::motion
