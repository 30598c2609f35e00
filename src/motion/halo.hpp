// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "motion/partition.hpp"
#include "motion/stepper.hpp"
#include "processes/processes.hpp"

namespace slipfront::motion {

/// Ghost columns of a subdomain, see Partition, and the steps between two exchanges of them.
///
/// They are exchanged in stages: first what moves with the interface, then the rows above it, some at a time.
/// A stage is sent once the last step before the exchange has moved its rows, and put in when the first step
/// after it is about to read them: it is on its way while other rows move. Between the two only steps may be
/// taken; finish puts in all that is on its way.
class Halo {
 public:
  /// @param stepper      of the subdomain
  /// @param stage_bytes  of a stage above the first one, as far as there are not too many of them
  Halo(Processes& processes, const Partition& partition, Stepper& stepper, double stage_bytes);
  Halo(const Halo&) = delete;
  Halo& operator=(const Halo&) = delete;
  ~Halo() = default;

  /// Exchanges it, and begins to count steps to the next exchange. Displacements and velocities in double
  /// precision stay as they are until a step is taken.
  void renew();
  /// Begins anew without an exchange, where the halo is right.
  void begin_anew();
  /// Takes steps, all of them, and exchanges the halo where it is due.
  void advance(StepObserver& observer, std::int64_t n_steps);
  void finish();

  /// Time of the steps since the last begin_anew or renew, without that of waiting.
  double computing_s() const { return computing_s_; }

 private:
  struct Stage {
    std::vector<solid::Span> rows;  ///< of each body
    bool has_interface = false;
  };
  struct Message {
    std::vector<std::byte> bytes;
    std::unique_ptr<Processes::Transfer> transfer;
  };
  /// What goes to a neighbour and comes from it, by stages. While one exchange is still on its way to a
  /// neighbour that is late, the next one is packed.
  struct Neighbour {
    solid::Span out, in;  ///< columns
    bool is_below = false;
    std::array<std::vector<Message>, 2> to = {};  ///< of every other exchange
    std::vector<Message> from = {};
  };

  int n_stages() const { return static_cast<int>(stages_.size()); }
  void make_stages(int columns, double stage_bytes);
  void add_neighbour(int rank, bool is_below, solid::Span out, solid::Span in);
  /// Steps between two exchanges, or fewer.
  void take_steps(StepObserver& observer, std::int64_t n_steps, bool exchanges);
  /// What is done beside steps. @param exchanges  whether the halo is sent with the last one of them
  BandCallbacks band_callbacks(bool exchanges);
  void begin_sends();
  void end_sends();
  void pack(int stage);
  void send_packed();
  void put_in(int stage);
  void put_in_rest();
  /// In debug builds what is wrong after a step is set to no number, and nothing else may have become so.
  void check(std::int64_t steps_since_exchange, bool is_sent);

  Processes& processes_;
  Stepper& stepper_;
  int columns_per_step_;
  std::int64_t steps_per_exchange_;
  std::vector<Stage> stages_;
  /// By bands: stages that the band reads of the step before, and that are complete when it has moved.
  std::vector<int> read_, complete_;
  std::vector<Neighbour> neighbours_;
  int n_put_in_ = 0;  ///< stages of the last exchange that are
  bool sends_ = false;
  std::size_t turn_ = 0;  ///< of Neighbour::to
  std::atomic<int> n_packed_ = 0;
  int n_sent_ = 0;
  std::int64_t steps_since_exchange_ = 0;
  double computing_s_ = 0;
};

}  // namespace slipfront::motion
