// SPDX-License-Identifier: BSD-3-Clause
#include "results/stream.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "base/error.hpp"

namespace slipfront::results {
namespace {

/// Rows of the history are collected and handed to the writer in blocks of at least so many numbers.
constexpr std::size_t block_values = 32 * 1024;

void append(std::vector<double>& to, const std::vector<double>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// Names of the numbers in a row: the time and the fields.
std::vector<const char*> names_of(const Table& table) {
  std::vector names = {table.time.name};
  for (const auto& field : table.fields) names.push_back(field.name);
  return names;
}

/// @param names  of a row's time and fields, each of `n_places` numbers
void require_finite(const std::filesystem::path& file, const std::vector<const char*>& names,
                    std::size_t n_places, const Extent& extent) {
  if (extent.n_finite == extent.n_values) return;
  const auto in_row = extent.n_finite % (1 + (names.size() - 1) * n_places);
  throw_not_finite(file, names[(in_row + n_places - 1) / n_places]);
}

}  // namespace

ResultStream::ResultStream(std::filesystem::path dir, RunFiles files)
    : dir_(std::move(dir)), files_(std::move(files)), writer_(max_bytes_waiting) {
  for (const char* name : {history_file, snapshot_file, probe_file}) files::remove_file(dir_ / name);
  history_.emplace(dir_ / history_file, files_.history.head_bytes());
  if (files_.probes) probes_.emplace(dir_ / probe_file, files_.probes->head_bytes());
}

ResultStream::ResultStream(std::filesystem::path dir, RunFiles files, const Extents& extents)
    : dir_(std::move(dir)), files_(std::move(files)), writer_(max_bytes_waiting) {
  history_.emplace(dir_ / history_file, files_.history.head_bytes(), extents.history);
  if (files_.probes) probes_.emplace(dir_ / probe_file, files_.probes->head_bytes(), extents.probes);
  if (extents.snapshots.bytes > 0)
    snapshots_.emplace(dir_ / snapshot_file, files_.snapshots.head_bytes(), extents.snapshots);
  else
    files::remove_file(dir_ / snapshot_file);
}

void ResultStream::sample(const record::History& rows) {
  append(block_, rows_of(members_of(rows)));
  if (block_.size() >= block_values) hand_over();
}

void ResultStream::probe(const record::ProbeRecord& rows) {
  SLIPFRONT_ASSERT(probes_, "rows of probes in a stream without them");
  append(probe_block_, rows_of(members_of(rows, record::probe_fields)));
  if (probe_block_.size() >= block_values) hand_over();
}

void ResultStream::hand_over() {
  const auto put = [this](std::vector<double>& rows, std::optional<RowFile>& file) {
    if (rows.empty()) return;
    const auto block = std::make_shared<const std::vector<double>>(std::exchange(rows, {}));
    writer_.put(sizeof(double) * block->size(), [&file, block] { file->write(*block); });
  };
  put(block_, history_);
  put(probe_block_, probes_);
}

void ResultStream::begin_snapshot(double time_s) {
  if (!snapshots_) snapshots_.emplace(dir_ / snapshot_file, files_.snapshots.head_bytes());
  writer_.put(sizeof(double), [this, time_s] { snapshots_->write(std::span(&time_s, 1)); });
}

void ResultStream::put_motion(std::vector<double> values, std::size_t place) {
  const auto& [origin, n_snapshots, n_nodes, seam] = files_.snapshots;
  for (std::size_t first = 0; first < motion::n_motion_components * n_nodes; first += n_nodes) {
    auto pair = std::ranges::lower_bound(seam, place - std::min(place, first), {},
                                         &std::pair<std::size_t, std::size_t>::second);
    for (; pair != seam.end() && first + pair->second < place + values.size(); ++pair) {
      const auto right = first + pair->second - place;
      values[right] = values[right - (pair->second - pair->first)];
    }
  }
  const auto piece = std::make_shared<const std::vector<double>>(std::move(values));
  writer_.put(sizeof(double) * piece->size(), [this, piece] { snapshots_->write(*piece); });
}

void ResultStream::snapshot(motion::TimeStepper& stepper) {
  begin_snapshot(stepper.time_s());
  const auto max_bytes = stepper.snapshot_chunk_bytes();
  std::size_t place = 0;
  for (int k = 0; k < stepper.n_snapshot_chunks(); ++k) {
    writer_.wait_for_room(max_bytes);
    auto values = stepper.snapshot_chunk(k);
    const auto n = values.size();
    put_motion(std::move(values), std::exchange(place, place + n));
  }
}

void ResultStream::snapshot(const motion::Snapshot& snapshot) {
  begin_snapshot(snapshot.time_s);
  std::vector<double> values;
  for (const auto* field : {&snapshot.u_m, &snapshot.v_m_per_s})
    for (const auto* component : {&field->x, &field->y}) append(values, *component);
  put_motion(std::move(values), 0);
}

ResultStream::Extents ResultStream::keep() {
  hand_over();
  Extents extents;
  writer_.put(0, [&] {
    extents.history = history_->sync();
    if (snapshots_) extents.snapshots = snapshots_->sync();
    if (probes_) extents.probes = probes_->sync();
  });
  writer_.finish();
  return extents;
}

void ResultStream::finish(Numbers numbers) {
  const auto extents = keep();
  require_unchanged(dir_ / history_file, files_.history.head_bytes(), extents.history);
  if (snapshots_) require_unchanged(dir_ / snapshot_file, files_.snapshots.head_bytes(), extents.snapshots);
  if (probes_) require_unchanged(dir_ / probe_file, files_.probes->head_bytes(), extents.probes);
  results::finish(dir_ / history_file, files_.history);
  if (probes_) results::finish(dir_ / probe_file, *files_.probes);
  if (numbers == Numbers::any) return;
  require_finite(dir_ / history_file, names_of(files_.history), files_.history.n_places(), extents.history);
  if (probes_)
    require_finite(dir_ / probe_file, names_of(*files_.probes), files_.probes->n_places(), extents.probes);
  if (snapshots_)
    require_finite(dir_ / snapshot_file, {"time", "u_x_m", "u_y_m", "v_x_m_per_s", "v_y_m_per_s"},
                   files_.snapshots.n_nodes, extents.snapshots);
}

}  // namespace slipfront::results
