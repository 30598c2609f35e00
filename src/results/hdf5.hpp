// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#define H5_USE_110_API  // which later versions keep
#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "results/contents.hpp"

/// The little of HDF5 that the results need. Every function throws WriteError, naming the file, where HDF5
/// fails; HDF5's own error print is silenced. Objects are named by their path in the file, e.g.
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
  std::filesystem::path name;  ///< for messages
  Handle handle;
};

/// Makes an HDF5 file of a file that is there. HDF5 1.10 and later read it.
File create_file(const std::filesystem::path& path, const std::filesystem::path& name);
/// Opens one to `reserve`.
/// @param alignment  what gets a place lies at a multiple of it
File open_file(const std::filesystem::path& path, const std::filesystem::path& name, hsize_t alignment = 1);
/// Writes out what HDF5 still holds back and closes.
void close(File file);

void create_group(const File& file, const std::string& name);

using Shape = std::vector<hsize_t>;

/// Writes a whole data set; the values are row-major and fill the shape.
void write(const File& file, const std::string& name, std::span<const double> values, const Shape& shape);
void write(const File& file, const std::string& name, std::span<const std::int64_t> values,
           const Shape& shape);
/// Writes texts, each filled up to the longest one by zeros.
void write_texts(const File& file, const std::string& name, const std::vector<std::string>& texts);

/// Makes a data set whose numbers others write. It has no place in the file before it is reserved.
enum class Type { float64, int64, uint8 };
void create(const File& file, const std::string& name, Type type, const Shape& shape);
/// Where such a data set lies in its file, row after row in the order of memory; an empty one has no place.
struct Place {
  std::uint64_t offset = 0, row_bytes = 0;
  std::uint64_t n_rows = 0;
};
/// Gives it a place at the file's end.
Place reserve(const File& file, const std::string& name);

/// A data set of doubles, [n, values].
struct Rows {
  std::string name;
  hsize_t n = 0, values = 0;
};
/// Values [first, first + n) of each row, row after row: a column of a view, or all of it.
struct Part {
  hsize_t first = 0, n = 1;
  std::optional<hsize_t> column = {};
};
/// Makes a data set of doubles that shows numbers of another one; what no part fills is 0.
void create_view(const File& file, const std::string& name, const Shape& shape, const Rows& rows,
                 const std::vector<Part>& parts);

/// Sets an attribute of a group or data set: text, fixed-length ASCII text (VTKHDF asks for it), integers.
void set_attribute(const File& file, const std::string& object, const std::string& name,
                   const std::string& text);
void set_ascii_attribute(const File& file, const std::string& object, const std::string& name,
                         const std::string& text);
void set_attribute(const File& file, const std::string& object, const std::string& name,
                   std::span<const std::int64_t> values);

/// Dimension scales as HDF5's own functions (H5DS) and netCDF make them, by which xarray opens a file.
/// @param name  a data set, which becomes the scale of a dimension
void make_scale(const File& file, const std::string& name);
/// Makes a dimension without numbers of its own.
void create_dimension(const File& file, const std::string& name, hsize_t length);
/// Names the scales of the dimensions of data sets.
struct Dimensions {
  std::string data_set;
  std::vector<std::string> scales;
};
void set_dimensions(const File& file, const std::vector<Dimensions>& of_all);

/// Sets the attributes `program`, `version` and `units` of the root and, unless they are empty, `title` and
/// `case`.
void describe_root(const File& file, const Origin& origin);

}  // namespace slipfront::results::hdf5
