// SPDX-License-Identifier: BSD-3-Clause
// Lists of checksums: no name leads out of the folder, and what is taken comes back from what is written.
#include "files/checksum.hpp"
#include "fuzz.hpp"

using namespace slipfront;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::Scratch scratch;
  scratch.write(files::checksum_list, fuzz::text_of(data, size));
  files::Checksums sums;
  if (!fuzz::takes([&] { sums = files::read_checksums(scratch.dir()); })) return 0;
  fuzz::require(!sums.empty(), "a list without a name");
  const auto dir = scratch.dir().string() + "/";
  for (const auto& [name, sum] : sums)
    fuzz::require((scratch.dir() / name).lexically_normal().string().starts_with(dir),
                  "outside the folder: " + name);
  // None of the files is there, and the list cannot hold its own checksum.
  fuzz::require(!fuzz::takes([&] { files::require_intact(scratch.dir()); }), "files that are not there");
  files::write_checksums(scratch.dir(), sums);
  fuzz::require(files::read_checksums(scratch.dir()) == sums, "the list is read back as another");
  return 0;
}
