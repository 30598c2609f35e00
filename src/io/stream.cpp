// SPDX-License-Identifier: BSD-3-Clause
#include "io/stream.hpp"

#include <memory>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "io/results.hpp"

namespace slipfront::io {
namespace {

/// That may wait to be written; a snapshot of a large plate is more, and waits alone.
constexpr std::size_t most_bytes_waiting = 16U << 20U;

void append(std::vector<double>& to, const std::vector<double>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

ResultStream::Part::Part(const std::filesystem::path& final_name)
    : file(final_name), temporary(final_name.string() + ".part") {}

ResultStream::Part::~Part() {
  std::error_code ignored;
  std::filesystem::remove(temporary, ignored);
}

void ResultStream::Part::publish() const {
  std::error_code error;
  std::filesystem::rename(temporary, file, error);
  if (error)
    throw UserError("{}: cannot be put in its place ({}); check that its folder can be written",
                    file.string(), error.message());
}

ResultStream::ResultStream(std::filesystem::path dir, std::span<const double> x_m, const mesh::Mesh& mesh,
                           bool with_snapshots)
    : dir_(std::move(dir)),
      history_part_(dir_ / "interface.h5"),
      snapshot_part_(dir_ / "fields.vtkhdf"),
      block_rows_(history_block_rows(x_m.size())),
      writer_(most_bytes_waiting) {
  hdf5::silence();  // the files may be closed by this thread
  writer_.put(0, [&] {
    history_.emplace(history_part_.temporary, x_m, history_part_.file);
    if (with_snapshots) snapshots_.emplace(snapshot_part_.temporary, mesh, snapshot_part_.file);
  });
  writer_.finish();
}

void ResultStream::sample(const fronts::History& row) {
  append(block_.time_s, row.time_s);
  append(block_.slip_m, row.slip_m);
  append(block_.slip_rate_m_per_s, row.slip_rate_m_per_s);
  append(block_.t_Pa, row.t_Pa);
  append(block_.p_Pa, row.p_Pa);
  if (block_.time_s.size() >= block_rows_) hand_over();
}

void ResultStream::hand_over() {
  if (block_.time_s.empty()) return;
  const auto block = std::make_shared<const fronts::History>(std::exchange(block_, {}));
  const std::size_t bytes = sizeof(double) * (block->time_s.size() + 4 * block->slip_m.size());
  writer_.put(bytes, [this, block] { history_->append(*block); });
}

void ResultStream::snapshot(const solve::Stepper& stepper) {
  SLIPFRONT_ASSERT(snapshots_, "a snapshot where none was announced");
  const std::size_t bytes = 4 * sizeof(double) * stepper.u_m().size();
  writer_.wait_for_room(bytes);
  const auto taken = std::make_shared<const solve::Snapshot>(solve::take_snapshot(stepper));
  writer_.put(bytes, [this, taken] { snapshots_->append(*taken); });
}

void ResultStream::publish() {
  hand_over();
  bool any_snapshot = false;
  writer_.put(0, [&] {
    history_->close();
    any_snapshot = snapshots_ && snapshots_->n_snapshots() > 0;
    if (snapshots_) snapshots_->close();
    history_.reset();
    snapshots_.reset();
  });
  writer_.finish();
  remove_results(dir_);
  history_part_.publish();
  if (any_snapshot) snapshot_part_.publish();
}

}  // namespace slipfront::io
