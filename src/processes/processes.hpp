// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <exception>
#include <memory>
#include <new>
#include <span>
#include <stdexcept>
#include <string>

#include "processes/parcel.hpp"

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
    double exchange_s = 0;  ///< in exchange
    double command_s = 0;   ///< in the other calls
  };
  /// Numbers that go to and come from another process at the same time; either may be none.
  struct Exchange {
    int with = 0;
    std::span<const double> out;
    std::span<double> in;
  };

  Processes() = default;
  Processes(const Processes&) = delete;
  Processes& operator=(const Processes&) = delete;
  virtual ~Processes() = default;

  virtual int rank() const = 0;
  virtual int size() const = 0;
  /// How many of them share this one's machine and its memory, this one included.
  virtual int on_this_machine() const { return size(); }

  virtual void send(int to, const Parcel& parcel) = 0;
  virtual Parcel receive(int from) = 0;
  /// All of them at once; their partners call it for the other ends.
  virtual void exchange(std::span<const Exchange> exchanges) = 0;
  /// Replaces each number by the largest that any process has there; called by all.
  virtual void take_largest(std::span<double> values) = 0;

  /// Ends all processes at once, with exit code 1, where this one cannot go on while others wait for it.
  [[noreturn]] virtual void fail(const std::string& message) = 0;

  const Counters& counters() const { return counters_; }

 protected:
  Counters counters_;
};

/// What another process could not do, told in one line.
class ProcessError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What to tell other processes of an exception.
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
