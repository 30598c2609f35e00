// SPDX-License-Identifier: BSD-3-Clause
#include "results/hdf5.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <numeric>
#include <string_view>

#include "base/error.hpp"
#include "base/version.hpp"
#include "files/files.hpp"

namespace slipfront::results::hdf5 {
namespace {

std::size_t count(const Shape& shape) {
  return static_cast<std::size_t>(
      std::accumulate(shape.begin(), shape.end(), hsize_t{1}, std::multiplies<>()));
}

[[noreturn]] void throw_read(const File& file, const std::string& name) {
  throw UserError("{}: data set {} cannot be read; the file may be incomplete", file.path.string(), name);
}

/// The number of values of a data set that was read of; refused beyond what any memory holds.
std::size_t count_read(const File& file, const std::string& name, const Shape& shape) {
  constexpr hsize_t most = std::numeric_limits<std::size_t>::max() / sizeof(double);
  hsize_t n = 1;
  for (const hsize_t length : shape) {
    if (length > 0 && n > most / length) throw_read(file, name);
    n *= length;
  }
  return n;
}

[[noreturn]] void throw_write(const std::filesystem::path& path, const std::string& name) {
  throw WriteError("{}: cannot write {}; check that the disk is not full", path.string(), name);
}

[[noreturn]] void throw_write(const File& file, const std::string& name) {
  throw_write(file.path, name);
}

/// Closes what was written to.
void finish(Handle object, const File& file, const std::string& name) {
  if (!object.close()) throw_write(file, name);
}

Handle open_object(const File& file, const std::string& name) {
  Handle object(H5Oopen(file.handle.get(), name.c_str(), H5P_DEFAULT), H5Oclose);
  if (!object.valid())
    throw UserError("{}: has no {}; check that it is the right file", file.path.string(), name);
  return object;
}

/// Properties of something new: no time of writing, so that equal data make equal files.
Handle new_properties(hid_t kind, const std::filesystem::path& path, const std::string& name) {
  Handle properties(H5Pcreate(kind), H5Pclose);
  if (!properties.valid() || H5Pset_obj_track_times(properties.get(), false) < 0) throw_write(path, name);
  return properties;
}

Handle dataset_properties(const File& file, const std::string& name) {
  return new_properties(H5P_DATASET_CREATE, file.path, name);
}

Handle new_dataset(const File& file, const std::string& name, hid_t type, const Handle& space,
                   const Handle& properties) {
  Handle dataset(H5Dcreate2(file.handle.get(), name.c_str(), type, space.get(), H5P_DEFAULT, properties.get(),
                            H5P_DEFAULT),
                 H5Dclose);
  if (!dataset.valid()) throw_write(file, name);
  return dataset;
}

Handle new_dataset(const File& file, const std::string& name, hid_t type, const Shape& shape,
                   const Handle& properties) {
  const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  return new_dataset(file, name, type, space, properties);
}

Handle new_dataset(const File& file, const std::string& name, hid_t type, const Shape& shape) {
  return new_dataset(file, name, type, shape, dataset_properties(file, name));
}

/// A data set that was made before, and its shape.
struct Dataset {
  Handle handle, space;
  Shape shape;
};

Dataset open_dataset(const File& file, const std::string& name) {
  Handle handle(H5Dopen2(file.handle.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
  Handle space(H5Dget_space(handle.get()), H5Sclose);
  if (!space.valid()) throw_write(file, name);
  Shape shape(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space.get())));
  H5Sget_simple_extent_dims(space.get(), shape.data(), nullptr);
  return {std::move(handle), std::move(space), std::move(shape)};
}

template <class T>
void write_rows_of(const File& file, const std::string& name, hid_t type, hsize_t first_row,
                   std::span<const T> values) {
  if (values.empty()) return;
  auto [dataset, space, shape] = open_dataset(file, name);
  Shape start(shape.size(), 0);
  start[0] = first_row;
  const hsize_t rows = shape[0];
  shape[0] = 1;
  SLIPFRONT_ASSERT(values.size() % count(shape) == 0, "rows of a data set are not whole");
  shape[0] = values.size() / count(shape);
  SLIPFRONT_ASSERT(first_row + shape[0] <= rows, "rows beyond the end of their data set");
  const Handle block(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  if (H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, shape.data(), nullptr) < 0 ||
      H5Dwrite(dataset.get(), type, block.get(), space.get(), H5P_DEFAULT, values.data()) < 0)
    throw_write(file, name);
  finish(std::move(dataset), file, name);
}

template <class T>
void write_values(const File& file, const std::string& name, hid_t type, std::span<const T> values,
                  const Shape& shape) {
  SLIPFRONT_ASSERT(values.size() == count(shape), "values do not fill the shape of their data set");
  Handle dataset = new_dataset(file, name, type, shape);
  if (!values.empty() && H5Dwrite(dataset.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    throw_write(file, name);
  finish(std::move(dataset), file, name);
}

void write_attribute(const File& file, const std::string& object, const std::string& name, hid_t type,
                     const Handle& space, const void* data) {
  Handle owner = open_object(file, object);
  Handle attribute(H5Acreate2(owner.get(), name.c_str(), type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                   H5Aclose);
  if (!attribute.valid() || H5Awrite(attribute.get(), type, data) < 0) throw_write(file, object + "." + name);
  finish(std::move(attribute), file, object + "." + name);
  finish(std::move(owner), file, object);
}

/// The format of HDF5 1.10: whatever says where the numbers are and what they mean carries a checksum. In
/// those before, HDF5 follows damage wherever it leads, beyond its own memory too.
constexpr int first_checked_version = 3;

/// The version that the head of a file tells; negative where it is no HDF5 file.
int format_version(const std::filesystem::path& path) {
  constexpr std::string_view signature = "\x89HDF\r\n\x1a\n";
  std::array<char, signature.size() + 1> head{};
  std::ifstream stream(path, std::ios::binary);
  if (!stream.read(head.data(), head.size()) ||
      !std::string_view(head.data(), head.size()).starts_with(signature))
    return -1;
  return static_cast<unsigned char>(head.back());
}

}  // namespace

void silence() {
  // Nor may HDF5 clean up at the program's end: every file is closed by its handle, and after a failed close,
  // as on a full disk, it would crash.
  [[maybe_unused]] static const herr_t once = H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

File create_file(const std::filesystem::path& path) {
  silence();
  files::OutputFile::replace(path).close();  // HDF5 would follow a link
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  if (!access.valid() || H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110) < 0)
    throw_write(path, "its head");
  const Handle properties = new_properties(H5P_FILE_CREATE, path, "its head");
  Handle handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, properties.get(), access.get()), H5Fclose);
  if (!handle.valid())
    throw WriteError("{}: cannot be created; check that its folder exists and can be written", path.string());
  return {path, std::move(handle)};
}

File open_file(const std::filesystem::path& path) {
  silence();
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    throw UserError("{}: does not exist; check the path", path.string());
  const int version = format_version(path);
  if (version >= 0 && version < first_checked_version)
    throw UserError("{}: is in a format of HDF5 before 1.10, in which damage goes unnoticed; convert it",
                    path.string());
  Handle handle(version < 0 ? -1 : H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!handle.valid())
    throw UserError("{}: cannot be read; check that it is a complete HDF5 file", path.string());
  return {path, std::move(handle)};
}

void close(File file) {
  const bool flushed = H5Fflush(file.handle.get(), H5F_SCOPE_GLOBAL) >= 0;
  if (!file.handle.close() || !flushed) throw_write(file, "its data");
}

void create_group(const File& file, const std::string& name) {
  const Handle properties = new_properties(H5P_GROUP_CREATE, file.path, name);
  Handle group(H5Gcreate2(file.handle.get(), name.c_str(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
               H5Gclose);
  if (!group.valid()) throw_write(file, name);
  finish(std::move(group), file, name);
}

void write(const File& file, const std::string& name, std::span<const double> values, const Shape& shape) {
  write_values(file, name, H5T_NATIVE_DOUBLE, values, shape);
}

void write(const File& file, const std::string& name, std::span<const std::int64_t> values,
           const Shape& shape) {
  write_values(file, name, H5T_NATIVE_INT64, values, shape);
}

void create(const File& file, const std::string& name, Type type, const Shape& shape) {
  const hid_t of_hdf5 = type == Type::float64 ? H5T_NATIVE_DOUBLE
                        : type == Type::int64 ? H5T_NATIVE_INT64
                                              : H5T_NATIVE_UINT8;
  const Handle properties = dataset_properties(file, name);
  if (H5Pset_alloc_time(properties.get(), H5D_ALLOC_TIME_EARLY) < 0 ||
      H5Pset_fill_time(properties.get(), H5D_FILL_TIME_NEVER) < 0)
    throw_write(file, name);
  finish(new_dataset(file, name, of_hdf5, shape, properties), file, name);
}

Place place_of(const File& file, const std::string& name) {
  const auto [dataset, space, shape] = open_dataset(file, name);
  const Handle type(H5Dget_type(dataset.get()), H5Tclose);
  const haddr_t offset = H5Dget_offset(dataset.get());
  const std::size_t bytes = H5Tget_size(type.get());
  SLIPFRONT_ASSERT(bytes > 0 && !shape.empty(), "a data set of numbers");
  Shape row = shape;
  row.front() = 1;
  // An empty one has no place.
  if (offset == HADDR_UNDEF && count(shape) > 0) throw_write(file, name);
  return {offset, bytes * count(row), shape.front()};
}

void create_growing(const File& file, const std::string& name, const Shape& row, hsize_t chunk_rows,
                    Chunks chunks) {
  Shape now = row, most = row, chunk = row;
  now.insert(now.begin(), 0);
  most.insert(most.begin(), H5S_UNLIMITED);
  chunk.insert(chunk.begin(), chunk_rows);
  const auto rank = static_cast<int>(now.size());
  const Handle space(H5Screate_simple(rank, now.data(), most.data()), H5Sclose);
  const Handle properties = dataset_properties(file, name);
  if (H5Pset_chunk(properties.get(), rank, chunk.data()) < 0 ||
      (chunks == Chunks::checked && H5Pset_fletcher32(properties.get()) < 0))
    throw_write(file, name);
  finish(new_dataset(file, name, H5T_NATIVE_DOUBLE, space, properties), file, name);
}

void add_rows(const File& file, const std::string& name, hsize_t rows) {
  auto [dataset, space, shape] = open_dataset(file, name);
  shape[0] += rows;
  if (H5Dset_extent(dataset.get(), shape.data()) < 0) throw_write(file, name);
  finish(std::move(dataset), file, name);
}

void write_rows(const File& file, const std::string& name, hsize_t first_row,
                std::span<const double> values) {
  write_rows_of(file, name, H5T_NATIVE_DOUBLE, first_row, values);
}

void set_attribute(const File& file, const std::string& object, const std::string& name,
                   const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), H5T_VARIABLE);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  const char* data = text.c_str();
  write_attribute(file, object, name, type.get(), Handle(H5Screate(H5S_SCALAR), H5Sclose), &data);
}

void set_ascii_attribute(const File& file, const std::string& object, const std::string& name,
                         const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), text.size());
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  write_attribute(file, object, name, type.get(), Handle(H5Screate(H5S_SCALAR), H5Sclose), text.c_str());
}

void set_attribute(const File& file, const std::string& object, const std::string& name,
                   std::span<const std::int64_t> values) {
  const hsize_t length = values.size();
  Handle space(H5Screate_simple(1, &length, nullptr), H5Sclose);
  if (length == 1) space = Handle(H5Screate(H5S_SCALAR), H5Sclose);
  write_attribute(file, object, name, H5T_NATIVE_INT64, space, values.data());
}

namespace {

std::vector<std::pair<const char*, std::string>> attributes_of(const Origin& origin) {
  std::vector<std::pair<const char*, std::string>> attributes = {
      {"program", "slipfront"},
      {"version", version()},
      {"units", "SI; names end with the unit, and data sets have it as the attribute unit"}};
  if (!origin.title.empty()) attributes.emplace_back("title", origin.title);
  if (!origin.case_text.empty()) attributes.emplace_back("case", origin.case_text);
  return attributes;
}

/// Fixed-length text that holds the longest of these, and their bytes.
struct FixedTexts {
  Handle type;
  std::string bytes;
};

FixedTexts fixed(const std::vector<std::string>& texts) {
  std::size_t longest = 1;
  for (const auto& text : texts) longest = std::max(longest, text.size());
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), longest);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  std::string bytes;
  for (const auto& text : texts) bytes += text + std::string(longest - text.size(), '\0');
  return {std::move(type), std::move(bytes)};
}

}  // namespace

void describe_root(const File& file, const Origin& origin) {
  for (const auto& [name, text] : attributes_of(origin)) set_attribute(file, "/", name, text);
}

void require_root_described(const File& file, const Origin& origin) {
  for (const auto& [name, text] : attributes_of(origin)) require_text(file, "/", name, text);
}

void write_texts(const File& file, const std::string& name, const std::vector<std::string>& texts) {
  const auto [type, bytes] = fixed(texts);
  Handle dataset = new_dataset(file, name, type.get(), {texts.size()});
  if (!texts.empty() && H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0)
    throw_write(file, name);
  finish(std::move(dataset), file, name);
}

void require_texts(const File& file, const std::string& name, const std::vector<std::string>& texts) {
  const auto [type, bytes] = fixed(texts);
  const Handle dataset(H5Dopen2(file.handle.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
  const Handle space(dataset.valid() ? H5Dget_space(dataset.get()) : -1, H5Sclose);
  if (!space.valid() || H5Sget_simple_extent_npoints(space.get()) != std::ssize(texts))
    throw_write(file, name);
  std::string written(bytes.size(), '\0');
  if (!texts.empty() &&
      (H5Dread(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, written.data()) < 0 ||
       written != bytes))
    throw_write(file, name);
}

std::string text_attribute(const File& file, const std::string& object, const std::string& name) {
  const Handle owner = open_object(file, object);
  const Handle attribute(H5Aopen(owner.get(), name.c_str(), H5P_DEFAULT), H5Aclose);
  const Handle type(attribute.valid() ? H5Aget_type(attribute.get()) : -1, H5Tclose);
  const Handle space(attribute.valid() ? H5Aget_space(attribute.get()) : -1, H5Sclose);
  const bool is_text =
      type.valid() && H5Tis_variable_str(type.get()) > 0 && H5Sget_simple_extent_npoints(space.get()) == 1;
  if (!is_text) throw UserError("{}: {} has no text attribute {}", file.path.string(), object, name);
  char* data = nullptr;
  if (H5Aread(attribute.get(), type.get(), &data) < 0 || data == nullptr)
    throw UserError("{}: cannot read the attribute {} of {}", file.path.string(), name, object);
  std::string text = data;
  H5free_memory(data);
  return text;
}

namespace {

/// A data set of numbers to be read.
Dataset numbers(const File& file, const std::string& name) {
  Handle dataset(H5Dopen2(file.handle.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!dataset.valid())
    throw UserError("{}: has no data set {}; check that it is the right file", file.path.string(), name);
  const Handle type(H5Dget_type(dataset.get()), H5Tclose);
  const H5T_class_t kind = H5Tget_class(type.get());
  if (kind != H5T_FLOAT && kind != H5T_INTEGER)
    throw UserError("{}: data set {} does not hold numbers", file.path.string(), name);
  Handle space(H5Dget_space(dataset.get()), H5Sclose);
  Shape shape(static_cast<std::size_t>(std::max(H5Sget_simple_extent_ndims(space.get()), 0)));
  H5Sget_simple_extent_dims(space.get(), shape.data(), nullptr);
  if (H5Sget_simple_extent_type(space.get()) == H5S_NULL) shape = {0};
  return {std::move(dataset), std::move(space), std::move(shape)};
}

/// Refuses a data set that claims more values than its file holds: before memory is taken for them.
void require_held(const File& file, const std::string& name, const Handle& dataset, std::size_t n) {
  constexpr hsize_t max_compression = 1100;  // of deflate, HDF5's own filter: 1032
  const Handle type(H5Dget_type(dataset.get()), H5Tclose);
  const Handle properties(H5Dget_create_plist(dataset.get()), H5Pclose);
  const hsize_t stored = H5Dget_storage_size(dataset.get()) / std::max<hsize_t>(H5Tget_size(type.get()), 1);
  const bool filtered = H5Pget_nfilters(properties.get()) > 0;
  if (n > stored && (!filtered || n / max_compression > stored)) throw_read(file, name);
}

/// Whether a file has these bytes somewhere.
bool holds(const std::filesystem::path& path, const std::string& bytes) {
  std::ifstream stream(path, std::ios::binary);
  std::string seen, piece(std::size_t{1} << 18U, '\0');
  while (stream.read(piece.data(), static_cast<std::streamsize>(piece.size())), stream.gcount() > 0) {
    seen.append(piece, 0, static_cast<std::size_t>(stream.gcount()));
    if (seen.find(bytes) != std::string::npos) return true;
    seen.erase(0, seen.size() - std::min(seen.size(), bytes.size() - 1));
  }
  return false;
}

}  // namespace

Shape shape_of(const File& file, const std::string& name) {
  return numbers(file, name).shape;
}

Array read(const File& file, const std::string& name) {
  const auto [dataset, space, shape] = numbers(file, name);
  const std::size_t n = count_read(file, name, shape);
  require_held(file, name, dataset, n);
  Array array{shape, std::vector<double>(n)};
  if (!array.values.empty() &&
      H5Dread(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, array.values.data()) < 0)
    throw_read(file, name);
  return array;
}

Array read_rows(const File& file, const std::string& name, hsize_t first_row, hsize_t n_rows) {
  auto [dataset, space, shape] = numbers(file, name);
  if (shape.empty() || n_rows > shape[0] || first_row > shape[0] - n_rows) throw_read(file, name);
  Shape start(shape.size(), 0);
  start[0] = first_row;
  shape[0] = n_rows;
  Array array{shape, std::vector<double>(count_read(file, name, shape))};
  if (array.values.empty()) return array;
  const Handle block(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  if (H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, shape.data(), nullptr) < 0 ||
      H5Dread(dataset.get(), H5T_NATIVE_DOUBLE, block.get(), space.get(), H5P_DEFAULT, array.values.data()) <
          0)
    throw_read(file, name);
  return array;
}

File open_written_file(const std::filesystem::path& path) {
  try {
    return open_file(path);
  } catch (const UserError&) {
    throw WriteError("{}: cannot be read after it was written; check that the disk is not full",
                     path.string());
  }
}

void require_length(const File& file, const std::string& name, hsize_t n_rows) {
  try {
    const auto shape = shape_of(file, name);
    if (!shape.empty() && shape[0] == n_rows) return;
  } catch (const UserError&) {
  }
  throw_write(file, name);
}

void require_text(const File& file, const std::string& object, const std::string& name,
                  const std::string& text) {
  // As an object of the heap: its length, 8 bytes from the least on, and the text.
  std::string bytes(sizeof(std::uint64_t), '\0');
  for (std::size_t k = 0; k < sizeof(std::uint64_t); ++k)
    bytes[k] = static_cast<char>(text.size() >> (8 * k) & 0xffU);
  const bool has_attribute =
      H5Aexists_by_name(file.handle.get(), object.c_str(), name.c_str(), H5P_DEFAULT) > 0;
  if (!has_attribute || !holds(file.path, bytes + text)) throw_write(file, object + "." + name);
}

void require_rows(const File& file, const std::string& name, hsize_t first_row,
                  std::span<const double> values) {
  if (values.empty()) return;
  try {
    auto shape = shape_of(file, name);
    if (shape.empty()) throw_write(file, name);
    shape[0] = 1;
    const auto per_row = std::max<std::size_t>(count_read(file, name, shape), 1);
    const auto written = read_rows(file, name, first_row, values.size() / per_row);
    if (written.values.size() != values.size() ||
        std::memcmp(written.values.data(), values.data(), values.size_bytes()) != 0)
      throw_write(file, name);
  } catch (const UserError&) {
    throw_write(file, name);
  }
}

}  // namespace slipfront::results::hdf5
