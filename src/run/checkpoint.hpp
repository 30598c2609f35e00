// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "base/error.hpp"
#include "base/state.hpp"
#include "results/archive.hpp"
#include "run/run.hpp"

namespace slipfront::run {

/// Tells this very program from every other one: version, commit, and a checksum of what is executed.
const std::string& program_identity();

/// What a checkpoint says of itself before all else.
struct CheckpointHead {
  std::string program = program_identity();
  problem::Source source;
  bool in_event = false;  ///< an event is under way; else a ramp, or none of a sequence
  int sessions = 1;       ///< see Status

  template <class Archive>
  void serialize(Archive& archive) {
    archive(program, source, in_event, sessions);
  }
};

/// Reads what was kept of a case's initial state, and makes its mesh.
/// @param processes  the ranks that share the run
/// @throws UserError where it is of another plate
InitialState read_initial_state(results::InputArchive& archive, const Problem& problem,
                                const Processes& processes = one_process());

/// The motion of a ramp or an event, see TimeStepper::keep.
void write_motion(results::OutputArchive& archive, motion::TimeStepper& stepper);
/// Whatever the number of ranks that kept it, and of those that go on.
/// @param archive  null on other ranks than 0
/// @param loads    with which it began
/// @throws as TimeStepper::restore
void read_motion(results::InputArchive* archive, motion::TimeStepper& stepper, const motion::Loads& loads);

/// Reads from an archive, which is rank 0's and null elsewhere. @throws UserError naming its file
template <class Read>
void read_from(const results::InputArchive* kept, Read&& read) {
  try {
    read();
  } catch (const StateError& error) {
    if (kept == nullptr) throw;
    throw UserError("{}: {}; start a new run", kept->path().string(), error.what());
  }
}

/// The checkpoints in a folder: the last two are kept, numbered as they come.
class Checkpoints {
 public:
  explicit Checkpoints(std::filesystem::path dir) : dir_(std::move(dir)) {}

  /// Keeps what a run was begun with, before its first checkpoint.
  void begin(const CheckpointHead& head);
  /// What `begin` has kept; none where the run has not come so far. @throws UserError where it is damaged
  std::optional<CheckpointHead> begun() const;

  /// Writes a checkpoint by `write`, and when that is on the device removes the last but two.
  /// @throws WriteError, the earlier ones being left.
  void keep(const CheckpointHead& head, const std::function<void(results::OutputArchive&)>& write);

  struct Checkpoint {
    explicit Checkpoint(const std::filesystem::path& file) : body(file) {}
    CheckpointHead head;
    results::InputArchive body;
  };
  /// The last one that is intact, null where there is none; `note` receives a message for each damaged one.
  std::unique_ptr<Checkpoint> last(const std::function<void(const std::string&)>& note) const;

 private:
  std::filesystem::path dir_;
};

}  // namespace slipfront::run
