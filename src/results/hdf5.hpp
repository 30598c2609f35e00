// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#define H5_USE_110_API  // which later versions keep
#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "results/contents.hpp"

/// The little of HDF5 that the results need. Every function that writes throws WriteError, every one that
/// reads UserError, naming the file, where HDF5 fails; HDF5's own error print is silenced. Objects are named
/// by their path in the file, e.g.
/// "/VTKHDF/Points".
namespace slipfront::results::hdf5 {

/// Owner of an HDF5 identifier.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);

  Handle(hid_t id, Close by) : id_(id), close_(by) {}
  ~Handle() { close(); }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      close();
      id_ = std::exchange(other.id_, -1);
      close_ = other.close_;
    }
    return *this;
  }

  hid_t get() const { return id_; }
  bool valid() const { return id_ >= 0; }
  /// @return whether HDF5 could: it may write only now what was given to it before.
  bool close() { return id_ < 0 || close_(std::exchange(id_, -1)) >= 0; }

 private:
  hid_t id_;
  Close close_;
};

struct File {
  std::filesystem::path path;  ///< for messages
  Handle handle;
};

/// Silences HDF5 in the calling thread; creating and opening files does it as well.
void silence();

/// Creates a file, replacing one that is there. HDF5 1.10 and later read it.
File create_file(const std::filesystem::path& path);
/// Files in formats before that of create_file are refused.
File open_file(const std::filesystem::path& path);

/// Writes out what HDF5 still holds back and closes; without it a full disk would go unnoticed.
void close(File file);

void create_group(const File& file, const std::string& name);

using Shape = std::vector<hsize_t>;

/// Writes a whole data set; the values are row-major and fill the shape.
void write(const File& file, const std::string& name, std::span<const double> values, const Shape& shape);
void write(const File& file, const std::string& name, std::span<const std::int64_t> values,
           const Shape& shape);

/// Makes a data set whose numbers others write: its place in the file is taken, and nothing is put there.
enum class Type { float64, int64, uint8 };
void create(const File& file, const std::string& name, Type type, const Shape& shape);
/// Where such a data set lies in its file, row after row in the order of memory.
struct Place {
  std::uint64_t offset = 0, row_bytes = 0;
  std::uint64_t n_rows = 0;
};
Place place_of(const File& file, const std::string& name);
enum class Chunks {
  any,
  checked,  ///< each with a checksum of its numbers, compared when it is read; for those written at once
};
/// Makes a data set of doubles without rows that add_rows lengthens, stored in chunks of `chunk_rows` rows.
/// @param row  the lengths after the first
void create_growing(const File& file, const std::string& name, const Shape& row, hsize_t chunk_rows,
                    Chunks chunks = Chunks::any);
/// Writes values.size() / (product of the other lengths) rows from `first_row` on.
void write_rows(const File& file, const std::string& name, hsize_t first_row, std::span<const double> values);
/// Lengthens a data set by `rows` rows, for write_rows.
void add_rows(const File& file, const std::string& name, hsize_t rows);

/// Sets an attribute of a group or data set: text, fixed-length ASCII text (VTKHDF asks for it), integers.
void set_attribute(const File& file, const std::string& object, const std::string& name,
                   const std::string& text);
void set_ascii_attribute(const File& file, const std::string& object, const std::string& name,
                         const std::string& text);
void set_attribute(const File& file, const std::string& object, const std::string& name,
                   std::span<const std::int64_t> values);

/// Sets the attributes `program`, `version` and `units` of the root and, unless they are empty, `title` and
/// `case`.
void describe_root(const File& file, const Origin& origin);
/// Looks for them in a file that was written just now.
void require_root_described(const File& file, const Origin& origin);

/// Writes texts, each filled up to the longest one by zeros.
void write_texts(const File& file, const std::string& name, const std::vector<std::string>& texts);
/// Compares them. @throws WriteError
void require_texts(const File& file, const std::string& name, const std::vector<std::string>& texts);

/// Text attribute of variable length, of a file that is known to be whole: HDF5 keeps these texts in a heap
/// without checksums, and does not come back from some damage of it.
std::string text_attribute(const File& file, const std::string& object, const std::string& name);

struct Array {
  Shape shape;
  std::vector<double> values;  ///< row-major
};
/// Reads a data set of any numeric type.
Array read(const File& file, const std::string& name);
/// Reads rows [first_row, first_row + n_rows) of one, and tells the shape of all of it.
Array read_rows(const File& file, const std::string& name, hsize_t first_row, hsize_t n_rows);
Shape shape_of(const File& file, const std::string& name);

// For files that were written just now. @throws WriteError where the first length, an attribute or the rows
// from first_row on, to the last bit, are others.
File open_written_file(const std::filesystem::path& path);
void require_length(const File& file, const std::string& name, hsize_t n_rows);
/// The text is looked for in the file's bytes, see text_attribute.
void require_text(const File& file, const std::string& object, const std::string& name,
                  const std::string& text);
void require_rows(const File& file, const std::string& name, hsize_t first_row,
                  std::span<const double> values);

}  // namespace slipfront::results::hdf5
