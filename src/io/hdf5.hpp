// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

/// The little of HDF5 that the results need. Every function throws UserError, naming the file, where HDF5
/// fails; HDF5's own error print is silenced. Objects are named by their path in the file, e.g.
/// "/VTKHDF/Points".
namespace slipfront::io::hdf5 {

/// Owner of an HDF5 identifier.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);

  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  ~Handle() { reset(); }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      reset();
      id_ = std::exchange(other.id_, -1);
      close_ = other.close_;
    }
    return *this;
  }

  hid_t get() const { return id_; }
  bool valid() const { return id_ >= 0; }

 private:
  void reset() {
    if (id_ >= 0) close_(id_);
    id_ = -1;
  }
  hid_t id_;
  Close close_;
};

struct File {
  std::filesystem::path path;  ///< for messages
  Handle handle;
};

/// Silences HDF5 in the calling thread; creating and opening files does it as well.
void silence();

/// Creates a file, replacing one that is there.
/// @param shown  the name for messages, where it is to be another
File create_file(const std::filesystem::path& path, const std::filesystem::path& shown = {});
File open_file(const std::filesystem::path& path);

/// Writes out what HDF5 still holds back and closes; without it a full disk would go unnoticed.
void close(File file);

/// Hands all that was written so far to the system. @throws UserError where the disk is full.
void flush(const File& file);

void create_group(const File& file, const std::string& name);

using Shape = std::vector<hsize_t>;

/// Writes a whole data set; the values are row-major and fill the shape.
void write(const File& file, const std::string& name, std::span<const double> values, const Shape& shape);
void write(const File& file, const std::string& name, std::span<const std::int64_t> values,
           const Shape& shape);
void write(const File& file, const std::string& name, std::span<const std::uint8_t> values,
           const Shape& shape);

/// Makes a data set that write_rows fills.
enum class Type { float64, int64 };
void create(const File& file, const std::string& name, Type type, const Shape& shape);
/// Makes a data set of doubles without rows that append_rows lengthens, stored in chunks of `chunk_rows`
/// rows.
/// @param row  the lengths after the first
/// @param whole_chunks  nothing shorter than a chunk will be left over: saves filling chunks in advance
void create_growing(const File& file, const std::string& name, const Shape& row, hsize_t chunk_rows,
                    bool whole_chunks = false);
/// Writes values.size() / (product of the other lengths) rows from `first_row` on.
void write_rows(const File& file, const std::string& name, hsize_t first_row, std::span<const double> values);
void write_rows(const File& file, const std::string& name, hsize_t first_row,
                std::span<const std::int64_t> values);
/// Lengthens a data set by `rows` rows, for write_rows.
void add_rows(const File& file, const std::string& name, hsize_t rows);

/// Sets an attribute of a group or data set: text, fixed-length ASCII text (VTKHDF asks for it), integers.
void set_attribute(const File& file, const std::string& object, const std::string& name,
                   const std::string& text);
void set_ascii_attribute(const File& file, const std::string& object, const std::string& name,
                         const std::string& text);
void set_attribute(const File& file, const std::string& object, const std::string& name,
                   std::span<const std::int64_t> values);

/// Text attribute of variable length.
std::string text_attribute(const File& file, const std::string& object, const std::string& name);

struct Array {
  Shape shape;
  std::vector<double> values;  ///< row-major
};
/// Reads a data set of any numeric type.
Array read(const File& file, const std::string& name);

}  // namespace slipfront::io::hdf5
