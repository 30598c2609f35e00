// SPDX-License-Identifier: BSD-3-Clause
#include "results/hdf5.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>
#include <numeric>

#include "base/error.hpp"
#include "base/version.hpp"

namespace slipfront::results::hdf5 {
namespace {

constexpr const char* head = "its head";

std::size_t count(const Shape& shape) {
  return static_cast<std::size_t>(
      std::accumulate(shape.begin(), shape.end(), hsize_t{1}, std::multiplies<>()));
}

[[noreturn]] void throw_write(const std::filesystem::path& file, const std::string& name) {
  throw WriteError("{}: HDF5 cannot write {}; check memory and limits on the size of files", file.string(),
                   name);
}

[[noreturn]] void throw_write(const File& file, const std::string& name) {
  throw_write(file.name, name);
}

/// Closes what was written to.
void finish(Handle object, const File& file, const std::string& name) {
  if (!object.close()) throw_write(file, name);
}

Handle open_object(const File& file, const std::string& name) {
  Handle object(H5Oopen(file.handle.get(), name.c_str(), H5P_DEFAULT), H5Oclose);
  if (!object.valid()) throw_write(file, name);
  return object;
}

/// Properties of something new: no time of writing, so that equal data make equal files.
Handle new_properties(hid_t kind, const std::filesystem::path& file, const std::string& name) {
  Handle properties(H5Pcreate(kind), H5Pclose);
  if (!properties.valid() || H5Pset_obj_track_times(properties.get(), false) < 0) throw_write(file, name);
  return properties;
}

/// How a file is opened.
Handle access_properties(const std::filesystem::path& file, hsize_t alignment = 1) {
  // Nor may HDF5 clean up at the program's end: every file is closed by its handle, and after a failed close
  // it would crash.
  [[maybe_unused]] static const herr_t once = H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  // Its default driver looks where a name leads, which those of files in memory do not.
  if (!access.valid() || H5Pset_fapl_stdio(access.get()) < 0 ||
      H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110) < 0 ||
      H5Pset_alignment(access.get(), 1, alignment) < 0)
    throw_write(file, head);
  return access;
}

Handle new_space(const Shape& shape) {
  return Handle(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
}

/// Selects a block.
bool select(const Handle& space, const Shape& start, const Shape& lengths) {
  return H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, lengths.data(), nullptr) >=
         0;
}

Handle dataset_properties(const File& file, const std::string& name) {
  return new_properties(H5P_DATASET_CREATE, file.name, name);
}

Handle new_dataset(const File& file, const std::string& name, hid_t type, const Shape& shape,
                   const Handle& properties) {
  const Handle space = new_space(shape);
  Handle dataset(H5Dcreate2(file.handle.get(), name.c_str(), type, space.get(), H5P_DEFAULT, properties.get(),
                            H5P_DEFAULT),
                 H5Dclose);
  if (!dataset.valid()) throw_write(file, name);
  return dataset;
}

void write_values(const File& file, const std::string& name, hid_t type, const void* values,
                  const Shape& shape) {
  Handle dataset = new_dataset(file, name, type, shape, dataset_properties(file, name));
  if (count(shape) > 0 && H5Dwrite(dataset.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
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

}  // namespace

File create_file(const std::filesystem::path& path, const std::filesystem::path& name) {
  const Handle access = access_properties(name);
  const Handle properties = new_properties(H5P_FILE_CREATE, name, head);
  Handle handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, properties.get(), access.get()), H5Fclose);
  if (!handle.valid()) throw_write(name, head);
  return {name, std::move(handle)};
}

File open_file(const std::filesystem::path& path, const std::filesystem::path& name, hsize_t alignment) {
  const Handle access = access_properties(name, alignment);
  Handle handle(H5Fopen(path.c_str(), H5F_ACC_RDWR, access.get()), H5Fclose);
  if (!handle.valid()) throw_write(name, head);
  return {name, std::move(handle)};
}

void close(File file) {
  const bool flushed = H5Fflush(file.handle.get(), H5F_SCOPE_GLOBAL) >= 0;
  if (!file.handle.close() || !flushed) throw_write(file, "its data");
}

void create_group(const File& file, const std::string& name) {
  const Handle properties = new_properties(H5P_GROUP_CREATE, file.name, name);
  Handle group(H5Gcreate2(file.handle.get(), name.c_str(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
               H5Gclose);
  if (!group.valid()) throw_write(file, name);
  finish(std::move(group), file, name);
}

void write(const File& file, const std::string& name, std::span<const double> values, const Shape& shape) {
  SLIPFRONT_ASSERT(values.size() == count(shape), "values fill the shape of their data set");
  write_values(file, name, H5T_NATIVE_DOUBLE, values.data(), shape);
}

void write(const File& file, const std::string& name, std::span<const std::int64_t> values,
           const Shape& shape) {
  SLIPFRONT_ASSERT(values.size() == count(shape), "values fill the shape of their data set");
  write_values(file, name, H5T_NATIVE_INT64, values.data(), shape);
}

void create(const File& file, const std::string& name, Type type, const Shape& shape) {
  const hid_t of_hdf5 = type == Type::float64 ? H5T_NATIVE_DOUBLE
                        : type == Type::int64 ? H5T_NATIVE_INT64
                                              : H5T_NATIVE_UINT8;
  const Handle properties = dataset_properties(file, name);
  if (H5Pset_fill_time(properties.get(), H5D_FILL_TIME_NEVER) < 0) throw_write(file, name);
  finish(new_dataset(file, name, of_hdf5, shape, properties), file, name);
}

Place reserve(const File& file, const std::string& name) {
  Handle dataset(H5Dopen2(file.handle.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
  const Handle space(H5Dget_space(dataset.get()), H5Sclose), type(H5Dget_type(dataset.get()), H5Tclose);
  if (!space.valid() || !type.valid()) throw_write(file, name);
  Shape shape(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space.get())));
  H5Sget_simple_extent_dims(space.get(), shape.data(), nullptr);
  Place place{0, H5Tget_size(type.get()), shape.front()};
  for (auto length = shape.begin() + 1; length != shape.end(); ++length) place.row_bytes *= *length;
  if (count(shape) == 0) return place;
  // All of a data set gets its place with its first number.
  const Shape one(shape.size(), 1);
  constexpr double zero = 0;
  if (!select(space, Shape(shape.size(), 0), one) ||
      H5Dwrite(dataset.get(), type.get(), new_space(one).get(), space.get(), H5P_DEFAULT, &zero) < 0)
    throw_write(file, name);
  place.offset = H5Dget_offset(dataset.get());
  finish(std::move(dataset), file, name);
  return place;
}

void create_view(const File& file, const std::string& name, const Shape& shape, const Rows& rows,
                 const std::vector<Part>& parts) {
  if (count(shape) == 0) return create(file, name, Type::float64, shape);
  const Handle properties = dataset_properties(file, name);
  for (const auto& part : parts) {
    const Handle from = new_space({rows.n, rows.values}), to = new_space(shape);
    Shape start(shape.size(), 0), lengths = shape;
    if (part.column) {
      start.back() = *part.column;
      lengths.back() = 1;
    }
    if (!select(from, {0, part.first}, {rows.n, part.n}) || !select(to, start, lengths) ||
        H5Pset_virtual(properties.get(), to.get(), ".", rows.name.c_str(), from.get()) < 0)
      throw_write(file, name);
  }
  finish(new_dataset(file, name, H5T_NATIVE_DOUBLE, shape, properties), file, name);
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

static void make_scale(const File& file, const std::string& name, const std::string& label) {
  for (const auto& [key, text] : {std::pair("CLASS", std::string("DIMENSION_SCALE")), {"NAME", label}}) {
    const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type.get(), text.size() + 1);
    write_attribute(file, name, key, type.get(), Handle(H5Screate(H5S_SCALAR), H5Sclose), text.c_str());
  }
}

void make_scale(const File& file, const std::string& name) {
  make_scale(file, name, name);
}

void create_dimension(const File& file, const std::string& name, hsize_t length) {
  create(file, name, Type::float64, {length});
  make_scale(file, name, fmt::format("This is a netCDF dimension but not a netCDF variable.{:10}", length));
}

static hobj_ref_t reference_to(const File& file, const std::string& name) {
  hobj_ref_t reference = 0;
  if (H5Rcreate(&reference, file.handle.get(), name.c_str(), H5R_OBJECT, -1) < 0) throw_write(file, name);
  return reference;
}

void set_dimensions(const File& file, const std::vector<Dimensions>& of_all) {
  struct Use {
    hobj_ref_t data_set;
    std::int32_t dimension, fill;
  };
  std::map<std::string, std::vector<Use>> uses;
  const Handle list_type(H5Tvlen_create(H5T_STD_REF_OBJ), H5Tclose);
  for (const auto& [name, scales] : of_all) {
    std::vector<hobj_ref_t> references;
    for (const auto& scale : scales) references.push_back(reference_to(file, scale));
    std::vector<hvl_t> lists;
    for (std::size_t k = 0; k < scales.size(); ++k) {
      lists.push_back({1, &references[k]});
      uses[scales[k]].push_back({reference_to(file, name), static_cast<std::int32_t>(k), 0});
    }
    write_attribute(file, name, "DIMENSION_LIST", list_type.get(), new_space({lists.size()}), lists.data());
  }
  const Handle use_type(H5Tcreate(H5T_COMPOUND, sizeof(Use)), H5Tclose);
  H5Tinsert(use_type.get(), "dataset", offsetof(Use, data_set), H5T_STD_REF_OBJ);
  H5Tinsert(use_type.get(), "dimension", offsetof(Use, dimension), H5T_NATIVE_INT32);
  for (const auto& [scale, of_scale] : uses)
    write_attribute(file, scale, "REFERENCE_LIST", use_type.get(), new_space({of_scale.size()}),
                    of_scale.data());
}

void describe_root(const File& file, const Origin& origin) {
  set_attribute(file, "/", "program", std::string("slipfront"));
  set_attribute(file, "/", "version", version());
  set_attribute(file, "/", "units",
                std::string("SI; names end with the unit, and data sets have it as the attribute unit"));
  if (!origin.title.empty()) set_attribute(file, "/", "title", origin.title);
  if (!origin.case_text.empty()) set_attribute(file, "/", "case", origin.case_text);
}

void write_texts(const File& file, const std::string& name, const std::vector<std::string>& texts) {
  std::size_t longest = 1;
  for (const auto& text : texts) longest = std::max(longest, text.size());
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), longest);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  std::string bytes;
  for (const auto& text : texts) bytes += text + std::string(longest - text.size(), '\0');
  write_values(file, name, type.get(), bytes.data(), {texts.size()});
}

}  // namespace slipfront::results::hdf5
