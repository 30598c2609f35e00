// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <new>
#include <span>
#include <stdexcept>
#include <string>

#include "processes/message_buffer.hpp"

namespace slipfront {

/// Processes that share one run, each with memory of its own. Number 0 leads: it alone reads options, writes
/// files and prints.
///
/// A call that another process does not answer ends the program: see fail.
class Processes {
 public:
  /// What this process has sent, and how long it has waited.
  struct Counters {
    std::int64_t messages = 0, bytes = 0;
    double exchange_s = 0;  ///< for transfers
    double command_s = 0;   ///< in other calls
  };
  /// Bytes that go to another process, or come from it, whenever both ends begin it. They stay at the same
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
  /// Ranks that share this one's machine and memory, this one included.
  virtual int on_this_machine() const { return size(); }

  virtual void send(int to, const MessageBuffer& buffer) = 0;
  virtual MessageBuffer receive(int from) = 0;
  /// From whichever process sends one.
  virtual MessageBuffer receive_any() = 0;
  static constexpr std::size_t max_transfer_bytes = std::size_t{1} << 30;
  /// Of a transfer that sets out without an answer of the other end: below the 64 KiB of Open MPI's over TCP.
  static constexpr std::size_t eager_limit_bytes = std::size_t{48} << 10;
  /// @param channel  not negative, the same at both ends; no other transfer between the two goes that way
  virtual std::unique_ptr<Transfer> transfer_to(int rank, int channel, std::span<const std::byte> bytes) = 0;
  virtual std::unique_ptr<Transfer> transfer_from(int rank, int channel, std::span<std::byte> bytes) = 0;
  /// Lets transfers go on while this process has something else to do.
  virtual void make_progress() {}
  /// Replaces each number by the largest that any process has there; called by all.
  virtual void reduce_max(std::span<double> values) = 0;

  /// Ends all processes at once, with exit code 1, where this one cannot go on while others wait for it.
  [[noreturn]] virtual void fail(const std::string& message) = 0;

  const Counters& counters() const { return counters_; }

 protected:
  Counters counters_;
};

/// Failure of a rank, in one line that names it.
class ProcessError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reason of an exception, for other ranks.
inline std::string reason_of(const std::exception& error) {
  const bool is_memory = dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
  return is_memory ? "not enough memory; use larger elements, or fewer processes on a machine" : error.what();
}

/// Joins the other processes that mpirun, or another starter of MPI, has begun with this one.
/// @return null where this process is alone, or the program was built without MPI
std::unique_ptr<Processes> join_processes(int& argc, char**& argv);
/// What a starter of MPI has begun alone leaves it before it becomes another program.
void leave_processes();

}  // namespace slipfront
