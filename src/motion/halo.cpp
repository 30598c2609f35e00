// SPDX-License-Identifier: BSD-3-Clause
#include "motion/halo.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "base/clock.hpp"
#include "base/error.hpp"

namespace slipfront::motion {

namespace {

/// More stages leave more of a halo's way to the time in which steps are computed, and are more messages.
constexpr int max_stages = 8;
constexpr int attended_in_sweep = 16;
constexpr double bytes_of_node = 4 * sizeof(double);

int columns_in(solid::Span columns) {
  return columns.end - columns.begin;
}

}  // namespace

Halo::Halo(Processes& processes, const Partition& partition, Stepper& stepper, double stage_bytes)
    : processes_(processes),
      stepper_(stepper),
      columns_per_step_(partition.columns_per_step),
      steps_per_exchange_(partition.steps_per_exchange) {
  const int rank = processes.rank(), n_subdomains = partition.n_subdomains();
  SLIPFRONT_ASSERT(n_subdomains > 1, "a subdomain has a neighbour");
  const int below = partition.halo_below(rank), above = partition.halo_above(rank);
  const auto own = partition.own(rank);
  // Beyond the sides of a plate that repeats lie the columns of its other end.
  const auto beyond = [&](int first_column, int count) {
    const int n = partition.first.back(), begin = (first_column + n) % n;
    return solid::Span{begin, begin + count};
  };
  make_stages(partition.halo, stage_bytes);
  if (below > 0)
    add_neighbour((rank + n_subdomains - 1) % n_subdomains, true, {own.begin, own.begin + below},
                  beyond(own.begin - below, below));
  if (above > 0)
    add_neighbour((rank + 1) % n_subdomains, false, {own.end - above, own.end}, beyond(own.end, above));
  n_put_in_ = n_stages();
}

void Halo::make_stages(int columns, double stage_bytes) {
  // Equal for all subdomains: of rows alone, and of the halo's width. Bodies move row beside row, and are
  // cut at the same ones, a body that has less of them in fewer stages.
  const int n_bands = stepper_.n_bands();
  std::vector<int> n_rows, n_first;
  int max_above = 0;
  double nodes_above = 0;
  for (std::size_t b = 0; b < stepper_.bodies().size(); ++b) {
    n_rows.push_back(stepper_.bodies()[b].n_rows());
    n_first.push_back(stepper_.rows_moved(b, 0));
    max_above = std::max(max_above, n_rows[b] - n_first[b]);
    nodes_above += 1.0 * (n_rows[b] - n_first[b]) * columns;
  }
  const double suitable = std::ceil(nodes_above * bytes_of_node / stage_bytes);
  const int n = 1 + static_cast<int>(std::min({suitable, 1.0 * max_above, max_stages - 1.0}));
  for (int k = 0; k < n; ++k) {
    Stage stage;
    stage.has_interface = k == 0;
    for (std::size_t b = 0; b < n_rows.size(); ++b) {
      const auto end_of = [&](int number) {
        return n == 1 ? n_rows[b]
                      : std::min(n_rows[b],
                                 n_first[b] + static_cast<int>(std::int64_t{max_above} * number / (n - 1)));
      };
      stage.rows.push_back({k == 0 ? 0 : end_of(k - 1), end_of(k)});
    }
    stages_.push_back(std::move(stage));
  }
  for (int band = 0; band < n_bands; ++band) {
    const auto is_read = [&](const Stage& stage) {
      if (stage.has_interface) return true;
      for (std::size_t b = 0; b < stage.rows.size(); ++b)
        if (stage.rows[b].begin < stage.rows[b].end && stage.rows[b].begin <= stepper_.rows_moved(b, band))
          return true;
      return false;
    };
    const auto is_complete = [&](const Stage& stage) {
      for (std::size_t b = 0; b < stage.rows.size(); ++b)
        if (stage.rows[b].end > stepper_.rows_moved(b, band)) return false;
      return true;
    };
    const auto read = std::ranges::find_if_not(stages_, is_read);
    SLIPFRONT_ASSERT(std::none_of(read, stages_.end(), is_read), "stages are read in their order");
    read_.push_back(static_cast<int>(read - stages_.begin()));
    complete_.push_back(static_cast<int>(std::ranges::find_if_not(stages_, is_complete) - stages_.begin()));
  }
  SLIPFRONT_ASSERT(read_.back() == n && complete_.back() == n, "a step takes all rows");
}

void Halo::add_neighbour(int rank, bool is_below, solid::Span out, solid::Span in) {
  auto& neighbour = neighbours_.emplace_back(Neighbour{out, in, is_below});
  for (int k = 0; k < n_stages(); ++k) {
    const auto& stage = stages_[static_cast<std::size_t>(k)];
    const auto room_for = [&](solid::Span columns) {
      std::size_t bytes = 0;
      stepper_.visit_columns(columns, stage.rows, stage.has_interface,
                             [&](const auto* values, std::size_t n) { bytes += n * sizeof(*values); });
      if (bytes > Processes::max_transfer_bytes)
        throw UserError("a halo of {:.3g} bytes is too large for a message; use more ranks",
                        static_cast<double>(bytes));
      return std::vector<std::byte>(bytes);
    };
    // Two subdomains of a plate that repeats are neighbours on both sides.
    const int upwards = 2 * k, downwards = upwards + 1;
    for (auto& to : neighbour.to) {
      auto& message = to.emplace_back(Message{room_for(out), nullptr});
      message.transfer = processes_.transfer_to(rank, is_below ? downwards : upwards, message.bytes);
    }
    auto& message = neighbour.from.emplace_back(Message{room_for(in), nullptr});
    message.transfer = processes_.transfer_from(rank, is_below ? upwards : downwards, message.bytes);
  }
}

void Halo::begin_anew() {
  finish();
  steps_since_exchange_ = 0;
  computing_s_ = 0;
}

void Halo::renew() {
  begin_anew();
  begin_sends();
  for (int k = 0; k < n_stages(); ++k) pack(k);
  end_sends();
  put_in_rest();
}

void Halo::advance(StepObserver& observer, std::int64_t n_steps) {
  const auto begin = Clock::now();
  const double waited_before_s = processes_.counters().exchange_s;
  while (n_steps > 0) {
    const auto n = std::min(steps_per_exchange_ - steps_since_exchange_, n_steps);
    const bool exchanges = steps_since_exchange_ + n == steps_per_exchange_;
    take_steps(observer, n, exchanges);
    steps_since_exchange_ = exchanges ? 0 : steps_since_exchange_ + n;
    n_steps -= n;
  }
  computing_s_ += seconds_since(begin) - (processes_.counters().exchange_s - waited_before_s);
}

void Halo::take_steps(StepObserver& observer, std::int64_t n_steps, bool exchanges) {
#ifdef NDEBUG
  constexpr bool are_checked = false;
#else
  constexpr bool are_checked = true;
#endif
  const std::int64_t at_once = are_checked ? 1 : n_steps;
  for (std::int64_t done = 0; done < n_steps;) {
    done += at_once;
    const bool is_sent = exchanges && done == n_steps;
    if (is_sent) begin_sends();
    stepper_.advance(observer, at_once, band_callbacks(is_sent));
    if (is_sent) end_sends();
    if (are_checked) check(steps_since_exchange_ + done, is_sent);
  }
}

BandCallbacks Halo::band_callbacks(bool exchanges) {
  BandCallbacks band_callbacks;
  // Often enough for what is under way, seldom enough for what is computed.
  const int attended = std::max(1, stepper_.n_bands() / attended_in_sweep);
  band_callbacks.before = [this, attended](std::int64_t step, int band) {
    if (step == 0)
      while (n_put_in_ < read_[static_cast<std::size_t>(band)]) put_in(n_put_in_++);
    send_packed();
    // What has been sent in the call before may still be on its way in its first step.
    if (band % attended == 0 && (step == 0 || n_sent_ > 0)) processes_.make_progress();
  };
  if (exchanges)
    band_callbacks.after_last = [this](int band) {
      for (int k = n_packed_; k < complete_[static_cast<std::size_t>(band)]; ++k) pack(k);
    };
  return band_callbacks;
}

void Halo::begin_sends() {
  sends_ = true;
  n_packed_ = n_sent_ = 0;
  turn_ = 1 - turn_;
  for (auto& neighbour : neighbours_) {
    for (auto& message : neighbour.to[turn_]) message.transfer->finish();
    // What the last exchange has brought makes room as it is put in.
    for (int k = 0; k < n_put_in_; ++k) neighbour.from[static_cast<std::size_t>(k)].transfer->begin();
  }
}

void Halo::end_sends() {
  send_packed();
  SLIPFRONT_ASSERT(n_sent_ == n_stages() && n_put_in_ == n_stages(), "a step takes all rows");
  sends_ = false;
  n_put_in_ = 0;
}

void Halo::pack(int stage) {
  const auto k = static_cast<std::size_t>(stage);
  for (auto& neighbour : neighbours_) {
    auto* to = neighbour.to[turn_][k].bytes.data();
    stepper_.visit_columns(neighbour.out, stages_[k].rows, stages_[k].has_interface,
                           [&](const auto* values, std::size_t n) {
                             std::memcpy(to, values, n * sizeof(*values));
                             to += n * sizeof(*values);
                           });
  }
  n_packed_.store(stage + 1, std::memory_order_release);
}

void Halo::send_packed() {
  if (!sends_) return;
  for (const int n = n_packed_.load(std::memory_order_acquire); n_sent_ < n; ++n_sent_)
    for (auto& neighbour : neighbours_)
      neighbour.to[turn_][static_cast<std::size_t>(n_sent_)].transfer->begin();
}

void Halo::put_in(int stage) {
  const auto k = static_cast<std::size_t>(stage);
  for (auto& neighbour : neighbours_) {
    auto& message = neighbour.from[k];
    message.transfer->finish();
    const auto* from = message.bytes.data();
    stepper_.visit_columns(neighbour.in, stages_[k].rows, stages_[k].has_interface,
                           [&](auto* values, std::size_t n) {
                             std::memcpy(values, from, n * sizeof(*values));
                             from += n * sizeof(*values);
                           });
    if (sends_) message.transfer->begin();
  }
}

void Halo::finish() {
  if (n_put_in_ == n_stages()) return;
  put_in_rest();
  stepper_.sync_to_double();
}

void Halo::put_in_rest() {
  while (n_put_in_ < n_stages()) put_in(n_put_in_++);
}

void Halo::check(std::int64_t steps_since_exchange, bool is_sent) {
  const int n_wrong = static_cast<int>(steps_since_exchange) * columns_per_step_;
  const auto all_finite = [&](solid::Span columns) {
    bool finite = true;
    stepper_.visit_columns(columns, [&](const auto* values, std::size_t n) {
      for (std::size_t i = 0; i < n; ++i) finite &= std::isfinite(static_cast<double>(values[i]));
    });
    return finite;
  };
  for (const auto& neighbour : neighbours_) {
    const auto in = neighbour.in;
    const int end = neighbour.is_below ? in.begin + n_wrong : in.end - n_wrong;
    const auto wrong = neighbour.is_below ? solid::Span{in.begin, end} : solid::Span{end, in.end};
    const auto right = neighbour.is_below ? solid::Span{end, in.end} : solid::Span{in.begin, end};
    SLIPFRONT_ASSERT(columns_in(right) > 0, "a halo is wider than what becomes wrong");
    if (stepper_.slip_rates().finite)
      SLIPFRONT_ASSERT(all_finite(right) && all_finite(neighbour.out), "a step reads beyond its subdomain");
    // All of it is on its way where it is sent: no step may look at what is there.
    stepper_.visit_columns(is_sent ? in : wrong, []<class T>(T* values, std::size_t n) {
      if constexpr (std::is_floating_point_v<T>) std::fill_n(values, n, std::numeric_limits<T>::quiet_NaN());
    });
  }
}

}  // namespace slipfront::motion
