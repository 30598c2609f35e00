// SPDX-License-Identifier: BSD-3-Clause
// Files that are not as they were written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "files/checksum.hpp"
#include "histories.hpp"
#include "results/archive.hpp"
#include "results/hdf5.hpp"
#include "results/history.hpp"
#include "support/files.hpp"

namespace slipfront::results {
namespace {

using test::error_of;
using ::testing::HasSubstr;
using ::testing::StartsWith;

using DamagedFiles = test::InFolder;

class DamagedHistory : public test::InFolder {
 protected:
  DamagedHistory() { write_history(file_, history_); }

  std::filesystem::path file_ = folder_ / "interface.h5";
  record::History history_ = made_history(100, 40);
};

TEST_F(DamagedHistory, IsRefusedWhereverItMatters) {
  const auto bytes = test::read_file(file_);
  int refused = 0;
  // All over the file, and closely what names its parts and says where they are.
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < bytes.size(); k += 1499) places.push_back(k);
  for (std::size_t k = 0; k < 2048; k += 13) places.push_back(k);
  for (const auto place : places) {
    auto damaged = bytes;
    damaged[place] = static_cast<char>(damaged[place] ^ 0x10);
    test::write_file(file_, damaged);
    try {
      EXPECT_TRUE(equal(read_history(file_), history_)) << "byte " << place;
    } catch (const UserError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 50);
}

TEST_F(DamagedHistory, IsComparedWithItsFoldersList) {
  files::write_checksums(folder_.path(), {{"interface.h5", files::sha256_of_file(file_)}});
  EXPECT_EQ(read_history(file_).p_Pa, history_.p_Pa);
  files::write_checksums(folder_.path(), {{"interface.h5", files::sha256("")}});
  EXPECT_THAT(error_of([&] { read_history(file_); }),
              StartsWith(file_.string() + ": does not match checksums.sha256"));
  files::write_checksums(folder_.path(), {{"run.json", files::sha256("")}});
  EXPECT_THAT(error_of([&] { read_history(file_); }),
              StartsWith(file_.string() + ": is not in checksums.sha256"));
}

TEST_F(DamagedHistory, DoesNotPassForOneThatWasWritten) {
  using hdf5::Handle;
  {  // a file with the data sets alone
    const auto file = hdf5::create_file(file_);
    for (const char* name : {"time_s", "x_m", "slip_m", "slip_rate_m_per_s", "t_Pa", "p_Pa"})
      hdf5::write(file, name, std::vector<double>{1}, {1});
  }
  EXPECT_THROW(WrittenHistory{file_}, WriteError);
  write_history(file_, history_);
  EXPECT_THROW(WrittenHistory(file_).require_lengths(100, 39), WriteError);
  EXPECT_THROW(WrittenHistory(file_).require_lengths(99, 40), WriteError);
  EXPECT_THROW(WrittenHistory(file_).require(1, history_), WriteError);
}

TEST_F(DamagedHistory, WithTheEndOfItsTextsLostDoesNotPass) {
  // HDF5 itself would not come back from this heap.
  const auto bytes = test::read_file(file_);
  const auto heap = bytes.find("GCOL");
  ASSERT_NE(heap, std::string::npos);
  const auto last_text = bytes.find("contact pressure", heap);
  ASSERT_NE(last_text, std::string::npos);
  constexpr std::size_t heap_bytes = 4096;
  for (std::size_t from = 0; heap + from < last_text; from += 40) {
    auto damaged = bytes;
    std::fill_n(damaged.begin() + static_cast<std::ptrdiff_t>(heap + from), heap_bytes - from, '\0');
    test::write_file(file_, damaged);
    EXPECT_THROW(WrittenHistory{file_}, WriteError) << from;
  }
  test::write_file(file_, bytes);
  EXPECT_NO_THROW(WrittenHistory{file_});
}

TEST_F(DamagedHistory, InAnEarlierFormatIsRefused) {
  { const hdf5::Handle earlier(H5Fcreate(file_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose); }
  EXPECT_EQ(
      error_of([&] { read_history(file_); }),
      file_.string() + ": is in a format of HDF5 before 1.10, in which damage goes unnoticed; convert it");
}

TEST_F(DamagedFiles, DataSetsWithoutTheValuesTheyClaimAreRefused) {
  for (const hsize_t rows : {hsize_t{2}, hsize_t{1} << 33U, hsize_t{1} << 61U}) {
    const auto path = folder_ / "claims.h5";
    auto file = hdf5::create_file(path);
    hdf5::create_growing(file, "values", {8}, 1);
    hdf5::add_rows(file, "values", rows);
    hdf5::close(std::move(file));
    EXPECT_EQ(error_of([&] { hdf5::read(hdf5::open_file(path), "values"); }),
              path.string() + ": data set values cannot be read; the file may be incomplete");
  }
}

TEST_F(DamagedFiles, DataSetsRowsBeyondTheEndAreRefused) {
  const auto path = folder_ / "rows.h5";
  hdf5::write(hdf5::create_file(path), "values", std::vector<double>{1, 2, 3, 4}, {2, 2});
  const auto file = hdf5::open_file(path);
  EXPECT_EQ(hdf5::read_rows(file, "values", 1, 1).values, (std::vector<double>{3, 4}));
  constexpr hsize_t far = ~hsize_t{0};
  for (const auto& rows : {std::pair{hsize_t{1}, hsize_t{2}}, {far, hsize_t{2}}, {hsize_t{1}, far}})
    EXPECT_THAT(error_of([&] { hdf5::read_rows(file, "values", rows.first, rows.second); }),
                HasSubstr("cannot be read"));
}

TEST_F(DamagedFiles, TextAttributesOfAnotherKindAreRefused) {
  using hdf5::Handle;
  const auto file = hdf5::create_file(folder_ / "texts.h5");
  hdf5::create_group(file, "group");
  hdf5::set_attribute(file, "group", "unit", std::string("m/s"));
  EXPECT_EQ(hdf5::text_attribute(file, "group", "unit"), "m/s");
  const Handle group(H5Gopen2(file.handle.get(), "group", H5P_DEFAULT), H5Gclose);
  const auto add = [&](const char* name, hid_t type, hsize_t n) {
    const Handle space(H5Screate_simple(1, &n, nullptr), H5Sclose);
    const Handle attribute(H5Acreate2(group.get(), name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                           H5Aclose);
  };
  const Handle variable(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(variable.get(), H5T_VARIABLE);
  add("several", variable.get(), 3);
  add("fixed", H5T_C_S1, 1);
  add("number", H5T_NATIVE_DOUBLE, 1);
  for (const char* name : {"fixed", "several", "number", "missing"})
    EXPECT_THAT(error_of([&] { hdf5::text_attribute(file, "group", name); }),
                HasSubstr(": group has no text attribute " + std::string(name)));
}

TEST_F(DamagedFiles, GroupsCarryNoTime) {
  const auto file = hdf5::create_file(folder_ / "groups.h5");
  hdf5::create_group(file, "/group");
  for (const char* name : {"/", "/group"}) {
    const hdf5::Handle group(H5Gopen2(file.handle.get(), name, H5P_DEFAULT), H5Gclose);
    H5O_info_t info{};
    ASSERT_GE(H5Oget_info2(group.get(), &info, H5O_INFO_TIME), 0);
    EXPECT_EQ(info.ctime, 0) << name;
  }
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
