// SPDX-License-Identifier: BSD-3-Clause
// A switch between tap devices, for scripts/network-trial.py: carries each Ethernet frame to the device of
// its address 02:00:00:00:00:K, or to all others, after a latency and in order. Until it is killed.
//
//     network-switch LATENCY_S FD...     as root; FD number K is that of device K, which does not block
#include <poll.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <optional>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;
using Frame = std::vector<std::byte>;

constexpr std::size_t most_bytes = 65536;

struct Waiting {
  Clock::time_point due;
  int to = 0;
  Frame frame;
};

/// Number of the device that a frame is for; none where it is for all.
std::optional<std::size_t> addressee(const Frame& frame, std::size_t n_devices) {
  constexpr std::array first = {std::byte{2}, std::byte{0}, std::byte{0}, std::byte{0}, std::byte{0}};
  if (frame.size() <= first.size() || !std::equal(first.begin(), first.end(), frame.begin()))
    return std::nullopt;
  const auto k = std::to_integer<std::size_t>(frame[first.size()]);
  if (k >= n_devices) return std::nullopt;
  return k;
}

void put(int device, const Frame& frame) {
  // A full device loses it, as a switch would.
  [[maybe_unused]] const auto written = ::write(device, frame.data(), frame.size());
}

[[noreturn]] void carry(const std::vector<int>& devices, Clock::duration latency) {
  std::vector<pollfd> polled;
  for (const int device : devices) polled.push_back({device, POLLIN, 0});
  std::deque<Waiting> waiting;  // the latency is one for all: in the order in which they are due
  Frame buffer(most_bytes);
  for (;;) {
    timespec timeout{};
    if (!waiting.empty()) {
      const auto left = std::max(Clock::duration::zero(), waiting.front().due - Clock::now());
      timeout.tv_nsec = std::chrono::duration_cast<std::chrono::nanoseconds>(left).count();
    }
    ::ppoll(polled.data(), polled.size(), waiting.empty() ? nullptr : &timeout, nullptr);
    for (std::size_t k = 0; k < devices.size(); ++k) {
      if ((polled[k].revents & POLLIN) == 0) continue;
      for (;;) {
        const auto n = ::read(devices[k], buffer.data(), buffer.size());
        if (n <= 0) break;
        const Frame frame(buffer.begin(), buffer.begin() + n);
        const auto due = Clock::now() + latency;
        const auto only = addressee(frame, devices.size());
        for (std::size_t to = 0; to < devices.size(); ++to)
          if (only ? to == *only : to != k) waiting.push_back({due, devices[to], frame});
      }
    }
    for (; !waiting.empty() && waiting.front().due <= Clock::now(); waiting.pop_front())
      put(waiting.front().to, waiting.front().frame);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const double latency_s = argc > 2 ? std::atof(argv[1]) : -1;
  if (!(latency_s >= 0 && latency_s < 1)) {
    std::fputs("network-switch: usage: network-switch LATENCY_S FD...\n", stderr);
    return 2;
  }
  const sched_param priority{10};
  if (::sched_setscheduler(0, SCHED_FIFO, &priority) != 0) {
    std::perror("network-switch: sched_setscheduler");
    return 2;
  }
  std::vector<int> devices;
  for (int k = 2; k < argc; ++k) devices.push_back(std::atoi(argv[k]));
  carry(devices, std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(latency_s)));
}
