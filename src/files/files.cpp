// SPDX-License-Identifier: BSD-3-Clause
#include "files/files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "base/error.hpp"

namespace slipfront::files {

bool is_full(int error) {
  return error == ENOSPC || error == EDQUOT || error == EFBIG;
}

namespace {

/// Largest piece handed to the system at once; Linux takes no more than 2 GiB.
constexpr std::size_t max_bytes_at_once = std::size_t{1} << 30U;

[[noreturn]] void throw_write(const std::filesystem::path& file, const char* what) {
  const int error = errno;
  throw WriteError("{}: cannot be {} ({}); {}", file.string(), what, std::strerror(error),
                   error == EFBIG   ? "allow larger files, as by ulimit -f"
                   : is_full(error) ? "free space there"
                                    : "check that its folder can be written");
}

/// The folder of a path; invalid, with errno, where it is not there or a link leads to it.
Descriptor folder_of(const std::filesystem::path& path) {
  constexpr int flags = O_PATH | O_DIRECTORY | O_CLOEXEC;
  Descriptor folder(::open(path.is_absolute() ? "/" : ".", flags));
  for (const auto& part : path.relative_path().parent_path())
    if (folder.valid()) folder = Descriptor(::openat(folder.get(), part.c_str(), flags | O_NOFOLLOW));
  return folder;
}

/// Calls call(folder, name) of the system.
template <class F>
int at(const std::filesystem::path& path, F&& call) {
  const Descriptor folder = folder_of(path);
  return folder.valid() ? call(folder.get(), path.filename().c_str()) : -1;
}

Descriptor open(const std::filesystem::path& path, int flags) {
  return Descriptor(at(path, [&](int folder, const char* name) {
    return ::openat(folder, name, flags | O_CLOEXEC | O_NOFOLLOW, 0666);
  }));
}

/// Writes piece by piece. @param write  as the system's, of data and their number
template <class F>
void write_all(const std::filesystem::path& path, std::span<const std::byte> bytes, F&& write) {
  while (!bytes.empty()) {
    const ssize_t n = write(bytes.data(), std::min(bytes.size(), max_bytes_at_once));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      if (n == 0) errno = ENOSPC;
      throw_write(path, "written");
    }
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
}

}  // namespace

Descriptor::~Descriptor() {
  close();
}

Descriptor::Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  if (this != &other) {
    close();
    fd_ = std::exchange(other.fd_, -1);
  }
  return *this;
}

bool Descriptor::close() {
  // Not again after EINTR: Linux has released the number by then.
  return fd_ < 0 || ::close(std::exchange(fd_, -1)) == 0;
}

OutputFile OutputFile::create(const std::filesystem::path& path) {
  Descriptor file = open(path, O_WRONLY | O_CREAT | O_EXCL);
  if (!file.valid()) throw_write(path, "created");
  return {path, std::move(file), 0};
}

OutputFile OutputFile::replace(const std::filesystem::path& path) {
  remove_file(path);
  return create(path);
}

OutputFile OutputFile::resume(const std::filesystem::path& path, std::uint64_t length) {
  Descriptor file = open(path, O_WRONLY);
  struct stat now {};
  if (!file.valid() && errno == ENOENT) throw UserError("{}: is missing; start the run again", path.string());
  if (!file.valid() || ::fstat(file.get(), &now) != 0) throw_write(path, "continued");
  if (!S_ISREG(now.st_mode) || static_cast<std::uint64_t>(now.st_size) < length)
    throw UserError("{}: is shorter than at the last checkpoint; start the run again", path.string());
  if (::ftruncate(file.get(), static_cast<off_t>(length)) != 0 ||
      ::lseek(file.get(), static_cast<off_t>(length), SEEK_SET) < 0)
    throw_write(path, "continued");
  return {path, std::move(file), length};
}

void OutputFile::write(std::span<const std::byte> bytes) {
  write_all(path_, bytes, [&](const void* data, std::size_t n) { return ::write(file_.get(), data, n); });
  length_ += bytes.size();
}

void OutputFile::sync() {
  if (::fsync(file_.get()) != 0) throw_write(path_, "written");
}

void OutputFile::close() {
  if (!file_.close()) throw_write(path_, "written");
}

PlacedFile::PlacedFile(const std::filesystem::path& path) : path_(path), file_(open(path, O_WRONLY)) {
  if (!file_.valid()) throw_write(path_, "written");
}

void PlacedFile::reserve(std::uint64_t length) {
  const auto n = static_cast<off_t>(length);
  if (::ftruncate(file_.get(), n) != 0) throw_write(path_, "written");
  if (n == 0) return;
  int result = 0;
  do {
    result = ::fallocate(file_.get(), 0, 0, n);
  } while (result != 0 && errno == EINTR);
  if (result != 0 && errno != EOPNOTSUPP && errno != ENOSYS) throw_write(path_, "written");
}

void PlacedFile::write_at(std::uint64_t place, std::span<const std::byte> bytes) {
  write_all(path_, bytes, [&](const void* data, std::size_t n) {
    const ssize_t written = ::pwrite(file_.get(), data, n, static_cast<off_t>(place));
    if (written > 0) place += static_cast<std::uint64_t>(written);
    return written;
  });
}

void PlacedFile::sync() {
  if (::fsync(file_.get()) != 0) throw_write(path_, "written");
}

void PlacedFile::close() {
  if (!file_.close()) throw_write(path_, "written");
}

void write_text(const std::filesystem::path& file, std::string_view text) {
  write_text(file, [&](OutputFile& output) { output.write(text); });
}

void write_text(const std::filesystem::path& file, const std::function<void(OutputFile&)>& write) {
  const std::filesystem::path fresh = file.string() + ".new";
  try {
    OutputFile output = OutputFile::replace(fresh);
    write(output);
    output.sync();
    output.close();
    move_file(fresh, file);
  } catch (const WriteError&) {
    try_to_remove(fresh);
    throw;
  }
}

void sync_file(const std::filesystem::path& file) {
  Descriptor opened = open(file, O_RDONLY);
  if (!opened.valid() || ::fsync(opened.get()) != 0 || !opened.close()) throw_write(file, "written");
}

void move_file(const std::filesystem::path& from, const std::filesystem::path& to) {
  const auto rename = [&](int folder, const char* name) {
    return at(from, [&](int old, const char* old_name) { return ::renameat(old, old_name, folder, name); });
  };
  if (at(to, rename) != 0) throw_write(to, "put in its place");
}

void remove_file(const std::filesystem::path& file) {
  if (!try_to_remove(file, is_folder(file)) && errno != ENOENT) throw_write(file, "removed");
}

bool try_to_remove(const std::filesystem::path& path, bool is_folder) {
  const int flags = is_folder ? AT_REMOVEDIR : 0;
  return at(path, [&](int folder, const char* name) { return ::unlinkat(folder, name, flags); }) == 0;
}

void make_folder(const std::filesystem::path& dir) {
  if (at(dir, [](int folder, const char* name) { return ::mkdirat(folder, name, 0777); }) != 0)
    throw_write(dir, "created");
}

void make_folders(const std::filesystem::path& dir) {
  if (is_folder(dir)) return;
  if (dir.has_parent_path()) make_folders(dir.parent_path());
  make_folder(dir);
}

std::filesystem::path resolved(std::filesystem::path path) {
  if (!path.has_filename()) path = path.parent_path();
  std::error_code error;
  std::filesystem::path begin;
  for (const auto& part : path) {
    if (!std::filesystem::is_symlink(begin /= part, error)) continue;
    auto real = std::filesystem::weakly_canonical(path, error);
    return error ? path : real;  // links that lead nowhere: whoever uses the path says so
  }
  return path;
}

bool is_there(const std::filesystem::path& path) {
  struct stat status {};
  return ::lstat(path.c_str(), &status) == 0 || errno != ENOENT;
}

bool is_folder(const std::filesystem::path& path) {
  struct stat status {};
  const auto look = [&](int folder, const char* name) {
    return ::fstatat(folder, name, &status, AT_SYMLINK_NOFOLLOW);
  };
  return at(path, look) == 0 && S_ISDIR(status.st_mode);
}

bool is_file(const std::filesystem::path& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode);
}

}  // namespace slipfront::files
