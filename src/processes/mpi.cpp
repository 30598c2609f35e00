// SPDX-License-Identifier: BSD-3-Clause
#include "processes/processes.hpp"

#ifdef SLIPFRONT_MPI
// Without the C++ bindings, which MPI no longer has: of Open MPI and of MPICH.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>
#include <utility>
#include <vector>

#include "base/clock.hpp"
#include "base/error.hpp"
#endif

namespace slipfront {

#ifdef SLIPFRONT_MPI

namespace {

/// MPI counts with int.
constexpr std::size_t max_bytes = Processes::max_transfer_bytes;

/// What starters of MPI set for each process: Open MPI, PMIx, PMI (MPICH, Slurm).
bool is_started_by_mpi() {
  constexpr std::array names = {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE"};
  return std::ranges::any_of(names, [](const char* name) { return std::getenv(name) != nullptr; });
}

/// Waits without keeping a processor from others: the library polls for as long as it waits, and where other
/// processes or threads have to compute on this processor it would wait for what it holds up itself.
class Patience {
 public:
  /// To poll for so long costs less than to fall asleep and to wake up.
  void polls_for_s(double poll_s) { poll_s_ = poll_s; }

  template <class F>
  void wait_until(F&& is_done) const {
    const auto begin = Clock::now();
    while (!is_done())
      if (const double waited_s = seconds_since(begin); waited_s > poll_s_) sleep(waited_s / 64);
  }
  void wait_all(std::span<MPI_Request> requests) const {
    wait_until([&] {
      int done = 0;
      MPI_Testall(static_cast<int>(requests.size()), requests.data(), &done, MPI_STATUSES_IGNORE);
      return done != 0;
    });
  }
  void wait(MPI_Request& request) const { wait_all({&request, 1}); }

 private:
  /// Each look takes the processor from whoever computes on it: the longer it has been in vain, the later the
  /// next one.
  static void sleep(double s) {
    constexpr double shortest_s = 10e-6, longest_s = 1e-3;
    std::this_thread::sleep_for(std::chrono::duration<double>(std::clamp(s, shortest_s, longest_s)));
  }

  double poll_s_ = 2e-3;
};

/// Adds the time until it goes out of scope.
class Waiting {
 public:
  explicit Waiting(double& waited_s) : waited_s_(waited_s) {}
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;
  ~Waiting() { waited_s_ += seconds_since(begin_); }

 private:
  double& waited_s_;
  Clock::time_point begin_ = Clock::now();
};

class MpiTransfer final : public Processes::Transfer {
 public:
  /// @param sent  bytes
  MpiTransfer(const Patience& patience, Processes::Counters& counters, std::size_t sent)
      : patience_(patience), counters_(counters), sent_(sent) {}
  MpiTransfer(const MpiTransfer&) = delete;
  MpiTransfer& operator=(const MpiTransfer&) = delete;
  ~MpiTransfer() override {
    finish();
    MPI_Request_free(&request);
  }

  void begin() override {
    MPI_Start(&request);
    is_under_way_ = true;
    if (sent_ == 0) return;
    ++counters_.messages;
    counters_.bytes += static_cast<std::int64_t>(sent_);
  }
  void finish() override {
    if (!is_under_way_) return;
    const Waiting waiting(counters_.exchange_s);
    patience_.wait(request);
    is_under_way_ = false;
  }

  MPI_Request request = MPI_REQUEST_NULL;  ///< persistent

 private:
  const Patience& patience_;
  Processes::Counters& counters_;
  std::size_t sent_;
  bool is_under_way_ = false;
};

/// Over MPI_COMM_WORLD, whose errors end the program.
class MpiProcesses final : public Processes {
 public:
  MpiProcesses(int& argc, char**& argv) {
    int provided = 0;
    // MPI's own files may be longer than a limit allows, which it can tell unless it is ended without a word.
    const auto on_limit = std::signal(SIGXFSZ, SIG_IGN);
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
    std::signal(SIGXFSZ, on_limit);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
    MPI_Comm machine = MPI_COMM_NULL;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &machine);
    MPI_Comm_size(machine, &on_machine_);
    MPI_Comm_free(&machine);
    if (size_ == 1) return;
    // Else the kernel adds 50 us to each sleep.
    ::prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
    share_processors_ = on_machine_ > static_cast<int>(std::thread::hardware_concurrency());
    if (share_processors_) patience_.polls_for_s(0);
  }
  MpiProcesses(const MpiProcesses&) = delete;
  MpiProcesses& operator=(const MpiProcesses&) = delete;
  ~MpiProcesses() override { MPI_Finalize(); }

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  int on_this_machine() const override { return on_machine_; }

  void send(int to, const MessageBuffer& buffer) override {
    const Waiting waiting(counters_.collective_s);
    const auto bytes = buffer.bytes();
    const auto n = static_cast<std::uint64_t>(bytes.size());
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Isend(&n, 1, MPI_UINT64_T, to, tag, MPI_COMM_WORLD, &request);
    patience_.wait(request);
    for (std::size_t at = 0; at < bytes.size(); at += max_bytes) {
      MPI_Isend(bytes.data() + at, static_cast<int>(std::min(max_bytes, bytes.size() - at)), MPI_BYTE, to,
                tag, MPI_COMM_WORLD, &request);
      patience_.wait(request);
    }
    count(bytes.size());
  }

  MessageBuffer receive(int from) override {
    const Waiting waiting(counters_.collective_s);
    std::uint64_t n = 0;
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Irecv(&n, 1, MPI_UINT64_T, from, tag, MPI_COMM_WORLD, &request);
    patience_.wait(request);
    std::vector<std::byte> bytes(n);
    for (std::size_t at = 0; at < bytes.size(); at += max_bytes) {
      MPI_Irecv(bytes.data() + at, static_cast<int>(std::min(max_bytes, bytes.size() - at)), MPI_BYTE, from,
                tag, MPI_COMM_WORLD, &request);
      patience_.wait(request);
    }
    return MessageBuffer(std::move(bytes));
  }

  std::unique_ptr<Transfer> transfer_to(int rank, int channel, std::span<const std::byte> bytes) override {
    auto transfer = std::make_unique<MpiTransfer>(patience_, counters_, bytes.size());
    MPI_Send_init(bytes.data(), as_count(bytes.size()), MPI_BYTE, rank, first_channel + channel,
                  MPI_COMM_WORLD, &transfer->request);
    return transfer;
  }
  std::unique_ptr<Transfer> transfer_from(int rank, int channel, std::span<std::byte> bytes) override {
    auto transfer = std::make_unique<MpiTransfer>(patience_, counters_, 0);
    MPI_Recv_init(bytes.data(), as_count(bytes.size()), MPI_BYTE, rank, first_channel + channel,
                  MPI_COMM_WORLD, &transfer->request);
    return transfer;
  }
  void make_progress() override {
    // The library may give the processor away in each call, and what was computed leaves its cache.
    if (share_processors_) return;
    int is_there = 0;
    MPI_Iprobe(MPI_ANY_SOURCE, no_tag, MPI_COMM_WORLD, &is_there, MPI_STATUS_IGNORE);
  }

  void reduce_max(std::span<double> values) override {
    const Waiting waiting(counters_.collective_s);
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Iallreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_MAX,
                   MPI_COMM_WORLD, &request);
    patience_.wait(request);
    count(values.size_bytes());
  }

  [[noreturn]] void fail(int exit_code, const std::string& line) override {
    const auto with_end = line + "\n";
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, with_end.data(), with_end.size());
    reserve_ = std::vector<std::byte>();
    MPI_Abort(MPI_COMM_WORLD, exit_code);
    std::abort();
  }

 private:
  /// Tags of buffers, and of nothing; those of channels come after them.
  static constexpr int tag = 0, no_tag = 1, first_channel = 2;

  static int as_count(std::size_t bytes) {
    SLIPFRONT_ASSERT(bytes <= max_bytes, "a halo is short");
    return static_cast<int>(bytes);
  }
  void count(std::size_t bytes) {
    ++counters_.messages;
    counters_.bytes += static_cast<std::int64_t>(bytes);
  }

  int rank_ = 0, size_ = 1, on_machine_ = 1;
  bool share_processors_ = false;  ///< there are fewer than processes on this machine
  Patience patience_;
  /// MPI_Abort takes memory, of which there may be none left.
  std::vector<std::byte> reserve_ = std::vector<std::byte>(std::size_t{1} << 20);
};

}  // namespace

std::unique_ptr<Processes> join_processes(int& argc, char**& argv) {
  if (!is_started_by_mpi()) return std::make_unique<OneProcess>();
  auto processes = std::make_unique<MpiProcesses>(argc, argv);
  if (processes->size() == 1) return std::make_unique<OneProcess>();
  return processes;
}

#else

std::unique_ptr<Processes> join_processes(int&, char**&) {
  return std::make_unique<OneProcess>();
}

#endif

}  // namespace slipfront
