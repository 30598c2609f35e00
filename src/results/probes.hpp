// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "record/probes.hpp"
#include "results/contents.hpp"
#include "results/hdf5.hpp"

namespace slipfront::results {

/// A probes.h5 that grows: `name`, `x_m` and `y_m` of the probes, the times and record::probe_fields [times,
/// probes], each with the attributes `unit` and `description`. It can be read once it is closed. Every
/// function throws WriteError where the file cannot be written.
class ProbeFile {
 public:
  ProbeFile(const std::filesystem::path& path, std::span<const record::ProbePlace> places,
            const Origin& origin);
  void append(const record::ProbeRecord& rows);
  void close();

 private:
  hdf5::File file_;
  std::size_t n_probes_, n_rows_ = 0;
};

/// A probes.h5 that was written just now, to be compared with what it should hold; see WrittenHistory.
class WrittenProbes {
 public:
  WrittenProbes(const std::filesystem::path& path, std::span<const record::ProbePlace> places,
                const Origin& origin);
  void require(std::size_t row, const record::ProbeRecord& rows) const;
  void require_length(std::size_t n_rows) const;

 private:
  hdf5::File file_;
};

/// Rows that make whole chunks of the file.
std::size_t probe_block_rows(std::size_t n_probes);

/// Writes a whole file and compares it. @throws WriteError
void write_probes(const std::filesystem::path& file, std::span<const record::ProbePlace> places,
                  const record::ProbeRecord& record, const Origin& origin);

}  // namespace slipfront::results
