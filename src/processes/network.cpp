// SPDX-License-Identifier: BSD-3-Clause
#include "processes/network.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "base/clock.hpp"

namespace slipfront {

namespace {

/// What the measuring process asks of the other one.
constexpr double nothing_more = 0, an_answer = 1, an_exchange = 2;

/// As a halo goes, in stages.
constexpr int n_stages = 8;
constexpr std::size_t stage_bytes = Processes::eager_limit_bytes;

/// What two processes tell each other, and exchange both ways at once.
class Talk {
 public:
  Talk(Processes& processes, int with)
      : tell_(processes.transfer_to(with, 0, std::as_bytes(std::span(&told_, 1)))),
        hear_(processes.transfer_from(with, 0, std::as_writable_bytes(std::span(&heard_, 1)))) {
    for (int k = 0; k < n_stages; ++k) {
      const auto stage = [k](std::vector<std::byte>& bytes) {
        return std::span(bytes).subspan(k * stage_bytes, stage_bytes);
      };
      exchanged_.push_back(processes.transfer_from(with, 1 + k, stage(in_)));
      exchanged_.push_back(processes.transfer_to(with, 1 + k, stage(out_)));
    }
  }
  Talk(const Talk&) = delete;
  Talk& operator=(const Talk&) = delete;
  ~Talk() = default;

  void tell(double number) {
    told_ = number;
    tell_->begin();
    tell_->finish();
  }
  double hear() {
    hear_->begin();
    hear_->finish();
    return heard_;
  }
  void exchange() {
    for (const auto& stage : exchanged_) stage->begin();
    for (const auto& stage : exchanged_) stage->finish();
  }

 private:
  double told_ = 0, heard_ = 0;
  std::vector<std::byte> out_ = std::vector<std::byte>(n_stages * stage_bytes, std::byte{1});
  std::vector<std::byte> in_ = std::vector<std::byte>(n_stages * stage_bytes);
  std::unique_ptr<Processes::Transfer> tell_, hear_;
  std::vector<std::unique_ptr<Processes::Transfer>> exchanged_;
};

/// Median of what some calls take, after one for warming up; at least three, and others until max_s is over.
template <class Call>
double median_s(int max_calls, double max_s, Call call) {
  call();
  std::vector<double> times_s;
  const auto begin = Clock::now();
  while (std::ssize(times_s) < 3 || (std::ssize(times_s) < max_calls && seconds_since(begin) < max_s)) {
    const auto call_begin = Clock::now();
    call();
    times_s.push_back(seconds_since(call_begin));
  }
  const auto middle = times_s.begin() + std::ssize(times_s) / 2;
  std::ranges::nth_element(times_s, middle);
  return *middle;
}

}  // namespace

Link measure_link(Processes& processes, int with) {
  Link link{processes.rank(), with};
  Talk talk(processes, with);
  constexpr int at_once = 10;  // the clock takes as long as a message
  const double round_trips_s = median_s(1001, 1, [&] {
    for (int k = 0; k < at_once; ++k) {
      talk.tell(an_answer);
      talk.hear();
    }
  });
  link.latency_s = 0.5 * round_trips_s / at_once;
  constexpr int in_turn = 4;  // the two do not begin the first one together
  const double exchanges_s = median_s(101, 2, [&] {
    for (int k = 0; k < in_turn; ++k) {
      talk.tell(an_exchange);
      talk.exchange();
    }
  });
  // The word that precedes an exchange takes a latency, and the exchange as well. Where these take all of the
  // time to within its scatter, the bandwidth is a lower bound.
  const double turn_s = exchanges_s / in_turn;
  const double transfer_s = std::max(turn_s - 2 * link.latency_s, 0.1 * turn_s);
  link.bandwidth_bytes_per_s = static_cast<double>(n_stages * stage_bytes) / transfer_s;
  talk.tell(nothing_more);
  return link;
}

void answer_link(Processes& processes, int with) {
  Talk talk(processes, with);
  for (;;) {
    const double wanted = talk.hear();
    if (wanted == an_exchange)
      talk.exchange();
    else if (wanted == an_answer)
      talk.tell(an_answer);
    else
      return;
  }
}

}  // namespace slipfront
