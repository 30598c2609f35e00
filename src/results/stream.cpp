// SPDX-License-Identifier: BSD-3-Clause
#include "results/stream.hpp"

#include <algorithm>
#include <fstream>
#include <memory>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "results/history.hpp"
#include "results/probes.hpp"
#include "results/snapshots.hpp"

namespace slipfront::results {
namespace {

/// Rows of the history are collected and handed to the writer in blocks of at least so many numbers.
constexpr std::size_t block_values = 32 * 1024;
/// Files that a run goes on in are read in pieces of this size for their checksum.
constexpr std::size_t piece_bytes = std::size_t{1} << 18U;

void append(std::vector<double>& to, const std::vector<double>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// Reads a file of the stream, a sequence of records of the same number of values.
class Records {
 public:
  Records(const std::filesystem::path& file, std::size_t values)
      : path_(file), stream_(file, std::ios::binary), values_(values) {
    std::error_code error;
    const auto bytes = std::filesystem::file_size(file, error);
    if (!stream_ || error) throw UserError("{}: cannot be read; start the run again", path_.string());
    count_ = bytes / (sizeof(double) * values);
  }
  std::size_t count() const { return count_; }

  /// The next `n` records, value by value.
  std::vector<double> read(std::size_t n) { return next_values(n * values_); }
  /// Some values of a record.
  std::vector<double> read_values(std::size_t record, std::size_t first, std::size_t n) {
    stream_.seekg(static_cast<std::streamoff>(sizeof(double) * (record * values_ + first)));
    return next_values(n);
  }
  void rewind() { stream_.seekg(0); }

 private:
  std::vector<double> next_values(std::size_t n) {
    std::vector<double> values(n);
    if (!stream_.read(reinterpret_cast<char*>(values.data()),
                      static_cast<std::streamsize>(sizeof(double) * values.size())))
      throw UserError("{}: cannot be read; start the run again", path_.string());
    return values;
  }

  std::filesystem::path path_;
  std::ifstream stream_;
  std::size_t values_, count_ = 0;
};

/// The next n rows of a history.
record::History read_rows(Records& records, std::size_t n, std::span<const double> x_m) {
  const std::size_t nx = x_m.size();
  const auto values = records.read(n);
  record::History rows;
  rows.x_m.assign(x_m.begin(), x_m.end());
  for (std::size_t k = 0; k < n; ++k) {
    auto from = values.begin() + static_cast<std::ptrdiff_t>(k * record::history_row_values(nx));
    rows.time_s.push_back(*from++);
    for (const auto& field : record::history_fields) {
      auto& column = rows.*field.member;
      column.insert(column.end(), from, from + static_cast<std::ptrdiff_t>(nx));
      from += static_cast<std::ptrdiff_t>(nx);
    }
  }
  return rows;
}

/// The next n rows of what probes record.
record::ProbeRecord read_probe_rows(Records& records, std::size_t n, std::size_t n_probes) {
  const auto values = records.read(n);
  record::ProbeRecord rows;
  auto from = values.begin();
  for (std::size_t k = 0; k < n; ++k) {
    rows.time_s.push_back(*from++);
    for (const auto& field : record::probe_fields) {
      auto& column = rows.*field.member;
      column.insert(column.end(), from, from + static_cast<std::ptrdiff_t>(n_probes));
      from += static_cast<std::ptrdiff_t>(n_probes);
    }
  }
  return rows;
}

}  // namespace

std::filesystem::path ResultStream::history_file(const std::filesystem::path& dir) {
  return dir / "history.raw";
}

std::filesystem::path ResultStream::snapshot_file(const std::filesystem::path& dir) {
  return dir / "snapshots.raw";
}

std::filesystem::path ResultStream::probe_file(const std::filesystem::path& dir) {
  return dir / "probes.raw";
}

ResultStream::Summed::Summed(const std::filesystem::path& path, const Extent& extent)
    : file(files::OutputFile::resume(path, extent.bytes)) {
  std::ifstream stream(path, std::ios::binary);
  std::vector<char> piece(piece_bytes);
  for (auto rest = extent.bytes; rest > 0;) {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(rest, piece.size()));
    if (!stream.read(piece.data(), static_cast<std::streamsize>(n))) break;
    sum.add(std::as_bytes(std::span(piece).first(n)));
    rest -= n;
  }
  if (sum.digest() != extent.checksum)
    throw UserError("{}: was changed or damaged since the last checkpoint; start the run again",
                    path.string());
}

void ResultStream::Summed::write(std::span<const double> values) {
  file.write(std::as_bytes(values));
  sum.add(std::as_bytes(values));
}

ResultStream::Extent ResultStream::Summed::sync() {
  file.sync();
  return {file.length(), sum.digest()};
}

ResultStream::ResultStream(const std::filesystem::path& dir, bool with_probes)
    : history_(history_file(dir)), snapshots_(snapshot_file(dir)), writer_(max_bytes_waiting) {
  if (with_probes) probes_.emplace(probe_file(dir));
}

ResultStream::ResultStream(const std::filesystem::path& dir, const Extents& extents, bool with_probes)
    : history_(history_file(dir), extents.history),
      snapshots_(snapshot_file(dir), extents.snapshots),
      writer_(max_bytes_waiting) {
  if (with_probes) probes_.emplace(probe_file(dir), extents.probes);
}

void ResultStream::require_unchanged(const std::filesystem::path& dir, const Extents& extents) {
  std::vector<std::pair<std::filesystem::path, const Extent*>> expected = {
      {history_file(dir), &extents.history}, {snapshot_file(dir), &extents.snapshots}};
  if (!extents.probes.checksum.empty()) expected.emplace_back(probe_file(dir), &extents.probes);
  for (const auto& [file, extent] : expected)
    if (!files::is_there(file) || files::sha256_of_file(file) != extent->checksum)
      throw WriteError("{}: is not what was written: it was changed, damaged or removed meanwhile",
                       file.string());
}

void ResultStream::sample(const record::History& row) {
  append(block_, row.time_s);
  for (const auto& field : record::history_fields) append(block_, row.*field.member);
  if (block_.size() >= block_values) hand_over();
}

void ResultStream::probe(const record::ProbeRecord& rows) {
  SLIPFRONT_ASSERT(probes_, "rows of probes in a stream without them");
  const std::size_t n_probes = rows.u_x_m.size() / rows.time_s.size();
  for (std::size_t k = 0; k < rows.time_s.size(); ++k) {
    probe_block_.push_back(rows.time_s[k]);
    for (const auto& field : record::probe_fields) {
      const auto first = (rows.*field.member).begin() + static_cast<std::ptrdiff_t>(k * n_probes);
      probe_block_.insert(probe_block_.end(), first, first + static_cast<std::ptrdiff_t>(n_probes));
    }
  }
  if (probe_block_.size() >= block_values) hand_over();
}

void ResultStream::hand_over() {
  const auto put = [this](std::vector<double>& rows, Summed& file) {
    if (rows.empty()) return;
    const auto block = std::make_shared<const std::vector<double>>(std::exchange(rows, {}));
    writer_.put(sizeof(double) * block->size(), [&file, block] { file.write(*block); });
  };
  put(block_, history_);
  if (probes_) put(probe_block_, *probes_);
}

void ResultStream::snapshot(motion::TimeStepper& stepper) {
  const double time_s = stepper.time_s();
  writer_.put(sizeof(double), [this, time_s] { snapshots_.write(std::span(&time_s, 1)); });
  const auto max_bytes = stepper.snapshot_chunk_bytes();
  for (int k = 0; k < stepper.n_snapshot_chunks(); ++k) {
    writer_.wait_for_room(max_bytes);
    const auto piece = std::make_shared<const std::vector<double>>(stepper.snapshot_chunk(k));
    writer_.put(sizeof(double) * piece->size(), [this, piece] { snapshots_.write(*piece); });
  }
}

ResultStream::Extents ResultStream::keep() {
  hand_over();
  Extents extents;
  writer_.put(0, [&] {
    extents = {history_.sync(), snapshots_.sync(), {}};
    if (probes_) extents.probes = probes_->sync();
  });
  writer_.finish();
  return extents;
}

void write_history(const std::filesystem::path& file, const std::filesystem::path& raw,
                   std::span<const double> x_m, const Origin& origin) {
  Records records(raw, record::history_row_values(x_m.size()));
  const std::size_t block = history_block_rows(x_m.size());
  const auto for_each_block = [&](auto&& f) {
    records.rewind();
    for (std::size_t row = 0; row < records.count(); row += block)
      f(row, read_rows(records, std::min(block, records.count() - row), x_m));
  };
  HistoryFile output(file, x_m, origin);
  for_each_block([&](std::size_t, const record::History& rows) { output.append(rows); });
  output.close();
  const WrittenHistory written(file, origin);
  for_each_block([&](std::size_t row, const record::History& rows) { written.require(row, rows); });
  written.require_lengths(records.count(), x_m.size());
}

void write_probes(const std::filesystem::path& file, const std::filesystem::path& raw,
                  std::span<const record::ProbePlace> places, const Origin& origin) {
  Records records(raw, record::probe_row_values(places.size()));
  const std::size_t block = probe_block_rows(places.size());
  const auto for_each_block = [&](auto&& f) {
    records.rewind();
    for (std::size_t row = 0; row < records.count(); row += block)
      f(row, read_probe_rows(records, std::min(block, records.count() - row), places.size()));
  };
  ProbeFile output(file, places, origin);
  for_each_block([&](std::size_t, const record::ProbeRecord& rows) { output.append(rows); });
  output.close();
  const WrittenProbes written(file, places, origin);
  for_each_block([&](std::size_t row, const record::ProbeRecord& rows) { written.require(row, rows); });
  written.require_length(records.count());
}

SnapshotSeries read_snapshots(const std::filesystem::path& raw, std::size_t n_nodes) {
  const auto records = std::make_shared<Records>(raw, 1 + 4 * n_nodes);
  const auto field = [&](std::size_t component) {
    return [records, n_nodes, component](std::size_t k, std::size_t first, std::size_t n) {
      solid::Field some;
      some.x = records->read_values(k, 1 + component * n_nodes + first, n);
      some.y = records->read_values(k, 1 + (component + 1) * n_nodes + first, n);
      return some;
    };
  };
  SnapshotSeries series{{}, field(0), field(2)};
  for (std::size_t k = 0; k < records->count(); ++k)
    series.time_s.push_back(records->read_values(k, 0, 1).front());
  return series;
}

}  // namespace slipfront::results
