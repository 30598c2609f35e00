// SPDX-License-Identifier: BSD-3-Clause
#include "processes/network.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "base/clock.hpp"

namespace slipfront {

namespace {

/// What the measuring process asks of the other one.
constexpr double nothing_more = 0, an_answer = 1, an_exchange = 2;

constexpr std::size_t large = std::size_t{256} << 10U;  // bytes, as of a halo

/// To the other process, or from it.
void tell(Processes& processes, int with, double number) {
  processes.exchange(std::array{Processes::Exchange{with, {&number, 1}, {}}});
}
double hear(Processes& processes, int with) {
  double number = 0;
  processes.exchange(std::array{Processes::Exchange{with, {}, {&number, 1}}});
  return number;
}

/// Both ways at once.
class LargeExchange {
 public:
  LargeExchange(Processes& processes, int with) : processes_(processes), with_(with) {}
  void operator()() { processes_.exchange(std::array{Processes::Exchange{with_, out_, in_}}); }

 private:
  Processes& processes_;
  int with_;
  std::vector<double> out_ = std::vector<double>(large / sizeof(double), 1.0);
  std::vector<double> in_ = std::vector<double>(large / sizeof(double));
};

/// Median of what some calls take, after one for warming up; at least three, and others until most_s is over.
template <class Call>
double median_s(int most_calls, double most_s, Call call) {
  call();
  std::vector<double> times_s;
  const auto begin = Clock::now();
  while (std::ssize(times_s) < 3 || (std::ssize(times_s) < most_calls && seconds_since(begin) < most_s)) {
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
  constexpr int at_once = 10;  // the clock takes as long as a message
  const double round_trips_s = median_s(1001, 1, [&] {
    for (int k = 0; k < at_once; ++k) {
      tell(processes, with, an_answer);
      hear(processes, with);
    }
  });
  link.latency_s = 0.5 * round_trips_s / at_once;
  LargeExchange exchange(processes, with);
  constexpr int in_turn = 4;  // the two do not begin the first one together
  const double exchanges_s = median_s(101, 2, [&] {
    for (int k = 0; k < in_turn; ++k) {
      tell(processes, with, an_exchange);
      exchange();
    }
  });
  // The word that precedes an exchange takes a latency, the exchange three: its message is announced, asked
  // for and sent. Where these take all of the time to within its scatter, the bandwidth is a lower bound.
  const double turn_s = exchanges_s / in_turn;
  const double transfer_s = std::max(turn_s - 4 * link.latency_s, 0.1 * turn_s);
  link.bandwidth_bytes_per_s = static_cast<double>(large) / transfer_s;
  tell(processes, with, nothing_more);
  return link;
}

void answer_link(Processes& processes, int with) {
  LargeExchange exchange(processes, with);
  for (;;) {
    const double wanted = hear(processes, with);
    if (wanted == an_exchange)
      exchange();
    else if (wanted == an_answer)
      tell(processes, with, an_answer);
    else
      return;
  }
}

}  // namespace slipfront
