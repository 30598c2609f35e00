// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <new>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "processes/message_buffer.hpp"

namespace slipfront {

/// Another rank has failed and says why; this one ends without a word.
struct FailedElsewhere {};

/// Failure of another rank, in one line that names it.
struct ProcessError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// MPI ranks that share one run, each with memory of its own. All run the same program. Rank 0 alone reads
/// options, writes files and prints.
///
/// Collective functions are called by all ranks, in the same order. What a rank throws between them would let
/// the others wait: see from_root, together and fail.
class Processes {
 public:
  /// What this rank has sent, and how long it has waited.
  struct Counters {
    std::int64_t messages = 0, bytes = 0;
    double exchange_s = 0;    ///< for transfers
    double collective_s = 0;  ///< in collective functions
  };
  /// Bytes that go to another rank, or come from it, whenever both ends begin it. They stay at the same
  /// place, and are left alone while they are under way.
  class Transfer {
   public:
    Transfer() = default;
    Transfer(const Transfer&) = delete;
    Transfer& operator=(const Transfer&) = delete;
    virtual ~Transfer() = default;
    virtual void begin() = 0;
    /// Waits until it is done; nothing where none is under way.
    virtual void finish() = 0;
  };

  Processes() = default;
  Processes(const Processes&) = delete;
  Processes& operator=(const Processes&) = delete;
  virtual ~Processes() = default;

  virtual int rank() const = 0;
  virtual int size() const = 0;
  bool is_root() const { return rank() == 0; }
  /// Ranks that share this one's machine and memory, this one included.
  virtual int on_this_machine() const { return size(); }

  virtual void send(int to, const MessageBuffer& buffer) = 0;
  virtual MessageBuffer receive(int from) = 0;
  static constexpr std::size_t max_transfer_bytes = std::size_t{1} << 30;
  /// Size of a transfer that sets out without an answer of the other end: below the 64 KiB of Open MPI's over
  /// TCP.
  static constexpr std::size_t eager_limit_bytes = std::size_t{48} << 10;
  /// @param channel  not negative, the same at both ends; no other transfer between the two goes that way
  virtual std::unique_ptr<Transfer> transfer_to(int rank, int channel, std::span<const std::byte> bytes) = 0;
  virtual std::unique_ptr<Transfer> transfer_from(int rank, int channel, std::span<std::byte> bytes) = 0;
  /// Lets transfers go on while this rank has something else to do.
  virtual void make_progress() {}

  // Collective

  /// Replaces each number by the largest that any rank has there.
  virtual void reduce_max(std::span<double> values) = 0;
  /// The buffer of rank 0, on all ranks.
  MessageBuffer broadcast(MessageBuffer buffer);
  /// The buffers of all ranks, in their order, on all ranks.
  std::vector<MessageBuffer> all_gather(const MessageBuffer& own);
  /// The values of all ranks, in their order, on all ranks.
  template <class T>
  std::vector<T> all_gather_value(const T& own) {
    std::vector<T> values;
    for (auto& buffer : all_gather(packed(own))) values.push_back(unpacked<T>(buffer));
    return values;
  }
  /// Shows rank 0 the buffers of all ranks, one after the other.
  void gather(MessageBuffer own, const std::function<void(int rank, MessageBuffer& buffer)>& take);
  /// Gives each rank the buffer that rank 0 makes for it.
  MessageBuffer scatter(const std::function<MessageBuffer(int rank)>& make);
  /// What rank 0 makes, on all ranks. @throws what it throws; FailedElsewhere on the others
  MessageBuffer from_root(const std::function<void(MessageBuffer& to)>& make);
  /// Work of all ranks, which may call collective functions as long as none has failed.
  /// @throws on rank 0 what it has thrown itself, or ProcessError with the reason of another one;
  ///         FailedElsewhere on the others
  void together(const std::function<void()>& work);

  /// Prints a line and ends all ranks at once, where this one cannot go on while others wait for it.
  [[noreturn]] virtual void fail(int exit_code, const std::string& line) = 0;

  /// Whether other ranks wait for collective calls that this one does not make if it ends now.
  bool is_awaited() const { return is_awaited_ && size() > 1; }
  void set_awaited(bool is_awaited) { is_awaited_ = is_awaited; }

  const Counters& counters() const { return counters_; }

 protected:
  Counters counters_;

 private:
  bool is_awaited_ = false;
};

/// One process alone: its collective functions wait for none.
class OneProcess final : public Processes {
 public:
  int rank() const override { return 0; }
  int size() const override { return 1; }
  void send(int, const MessageBuffer&) override { SLIPFRONT_ASSERT(false, "another rank"); }
  MessageBuffer receive(int) override {
    SLIPFRONT_ASSERT(false, "another rank");
    return {};
  }
  std::unique_ptr<Transfer> transfer_to(int, int, std::span<const std::byte>) override { return {}; }
  std::unique_ptr<Transfer> transfer_from(int, int, std::span<std::byte>) override { return {}; }
  void reduce_max(std::span<double>) override {}
  [[noreturn]] void fail(int, const std::string& line) override { throw std::runtime_error(line); }
};
OneProcess& one_process();

/// Reason of an exception, for other ranks.
inline std::string reason_of(const std::exception& error) {
  const bool is_memory = dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
  return is_memory ? "not enough memory; use larger elements, or fewer ranks on a machine" : error.what();
}

/// Joins the other ranks that mpirun, or another starter of MPI, has begun with this one.
/// @return OneProcess where this process is alone, or the program was built without MPI
std::unique_ptr<Processes> join_processes(int& argc, char**& argv);

}  // namespace slipfront
