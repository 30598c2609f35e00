// SPDX-License-Identifier: BSD-3-Clause
// Files that are not as they were written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "files/checksum.hpp"
#include "histories.hpp"
#include "results/archive.hpp"
#include "support/files.hpp"
#include "support/results.hpp"

namespace slipfront::results {
namespace {

using test::error_of;
using ::testing::HasSubstr;
using ::testing::StartsWith;

using DamagedFiles = test::InFolder;

TEST_F(DamagedFiles, AreToldByTheirFoldersList) {
  const auto file = folder_ / "interface.h5";
  test::write_history(file, made_history(20, 30));
  files::write_checksums(folder_.path(), {{"interface.h5", files::sha256_of_file(file)}});
  files::require_listed(file);
  const auto bytes = test::read_file(file);
  for (const std::size_t place : {std::size_t{3}, bytes.size() - 1000}) {  // of the head, of a row
    auto damaged = bytes;
    damaged[place] = static_cast<char>(damaged[place] ^ 0x10);
    test::write_file(file, damaged);
    EXPECT_EQ(
        error_of([&] { files::require_listed(file); }),
        file.string() + ": does not match checksums.sha256: it was changed or damaged; run the case again");
  }
  files::write_checksums(folder_.path(), {{"run.json", files::sha256("")}});
  EXPECT_THAT(error_of([&] { files::require_listed(file); }),
              StartsWith(file.string() + ": is not in checksums.sha256"));
}

TEST_F(DamagedFiles, StatesWithMoreThanIsReadAreRefused) {
  const auto path = folder_ / "longer.bin";
  OutputArchive written(path);
  double number = 1;
  written(number, number);
  written.close();
  InputArchive archive(path);
  archive(number);
  EXPECT_THAT(error_of([&] { archive.close(); }), HasSubstr("is damaged or of another version"));
}

TEST_F(DamagedFiles, FlagsHoldNothingButTrueAndFalse) {
  const auto path = folder_ / "flags.bin";
  const auto read = [&](std::uint8_t byte) {
    {
      OutputArchive archive(path);
      archive(byte);
      archive.close();
    }
    InputArchive archive(path);
    bool flag = false;
    archive(flag);
    return flag;
  };
  EXPECT_FALSE(read(0));
  EXPECT_TRUE(read(1));
  EXPECT_EQ(error_of([&] { read(2); }), "the saved state has flags of another case, or was changed");
}

}  // namespace
}  // namespace slipfront::results
