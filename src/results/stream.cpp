// SPDX-License-Identifier: BSD-3-Clause
#include "results/stream.hpp"

#include <algorithm>
#include <utility>

#include "base/error.hpp"
#include "base/state.hpp"

namespace slipfront::results {

/// A file of the stream.
class ResultStream::File final : public RowSink {
 public:
  File(const std::filesystem::path& dir, RowFormat format, threads::Writer& writer)
      : format_(std::move(format)), path_(dir / format_.file), writer_(writer) {}

  /// In place of an earlier one. One that others finish is there with its first row.
  void begin() {
    files::remove_file(path_);
    if (format_.finish) rows_.emplace(path_, format_.head_bytes);
  }
  void go_on(const Extent& extent) {
    if (extent.bytes == 0) return begin();
    rows_.emplace(path_, format_.head_bytes, extent);
  }

  void put(std::vector<double> values) override {
    // Rows are handed over in blocks of at least so many numbers, larger pieces as they are.
    constexpr std::size_t block_values = 32 * 1024;
    if (values.size() >= block_values) hand_over();
    if (block_.empty())
      block_ = std::move(values);
    else
      block_.insert(block_.end(), values.begin(), values.end());
    if (block_.size() >= block_values) hand_over();
  }
  void wait_for_room(std::size_t bytes) override { writer_.wait_for_room(bytes); }
  void hand_over() {
    if (block_.empty()) return;
    if (!rows_) rows_.emplace(path_, format_.head_bytes);
    const auto block = std::make_shared<const std::vector<double>>(std::exchange(block_, {}));
    writer_.put(sizeof(double) * block->size(), [this, block] { rows_->write(*block); });
  }

  const RowFormat& format() const { return format_; }
  /// By the writer.
  Extent sync() { return rows_ ? rows_->sync() : Extent{}; }
  void finish(const Extent& extent) const {
    if (extent.bytes == 0) return;
    require_unchanged(path_, format_.head_bytes, extent);
    if (format_.finish) format_.finish(path_);
  }
  void require_finite(const Extent& extent) const {
    if (extent.n_finite == extent.n_values) return;
    const auto in_row = extent.n_finite % format_.row_values(), n = format_.n_places;
    throw_not_finite(path_, format_.names[(in_row + n - 1) / n]);
  }

 private:
  RowFormat format_;
  std::filesystem::path path_;
  threads::Writer& writer_;
  std::optional<RowFile> rows_;  ///< the writer's
  std::vector<double> block_;    ///< rows that the writer does not have yet
};

ResultStream::ResultStream(std::filesystem::path dir, const std::vector<RowFormat>& formats)
    : ResultStream(std::move(dir), formats, Extents(formats.size())) {}

ResultStream::ResultStream(std::filesystem::path dir, std::vector<RowFormat> formats, const Extents& extents)
    : dir_(std::move(dir)), writer_(max_bytes_waiting) {
  require_possible(extents.size() == formats.size(), "files of rows");
  for (std::size_t k = 0; k < formats.size(); ++k) {
    files_.push_back(std::make_unique<File>(dir_, std::move(formats[k]), writer_));
    files_.back()->go_on(extents[k]);
  }
}

ResultStream::~ResultStream() = default;

RowSink& ResultStream::sink(const std::string& file) {
  const auto found = std::ranges::find_if(files_, [&](const auto& f) { return f->format().file == file; });
  SLIPFRONT_ASSERT(found != files_.end(), "a file of the stream");
  return **found;
}

void ResultStream::hand_over() {
  for (const auto& file : files_) file->hand_over();
}

ResultStream::Extents ResultStream::keep() {
  hand_over();
  Extents extents;
  writer_.put(0, [&] {
    for (const auto& file : files_) extents.push_back(file->sync());
  });
  writer_.finish();
  return extents;
}

void ResultStream::finish(Numbers numbers) {
  const auto extents = keep();
  for (std::size_t k = 0; k < files_.size(); ++k) files_[k]->finish(extents[k]);
  for (std::size_t k = 0; k < files_.size() && numbers == Numbers::finite; ++k)
    files_[k]->require_finite(extents[k]);
}

}  // namespace slipfront::results
