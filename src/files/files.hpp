// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

/// Files that are written for good: every call to the system is checked, nothing that is there is followed or
/// replaced by accident. What writes, makes, renames or removes follows no link, at no part of a path: a name
/// that a user gave is to be resolved before. Every function throws WriteError, naming the file, where the
/// system refuses.
namespace slipfront::files {

/// Whether a number of errno says that there is no space: on the disk, in a quota, or below a limit of file
/// sizes.
bool is_full(int error);

/// Owner of a file descriptor.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor();
  Descriptor(Descriptor&& other) noexcept;
  Descriptor& operator=(Descriptor&& other) noexcept;

  int get() const { return fd_; }
  bool valid() const { return fd_ >= 0; }
  /// Closes and tells what close says: the last chance of some file systems to report a failed write.
  bool close();

 private:
  int fd_ = -1;
};

/// A file that is written from its beginning to its end.
class OutputFile {
 public:
  /// Makes a new file; one of this name must not be there, not even as a link.
  static OutputFile create(const std::filesystem::path& path);
  /// Makes a new file in place of what has its name.
  static OutputFile replace(const std::filesystem::path& path);
  /// Goes on at `length` in a file of this program's own; what it holds beyond is cut off.
  /// @throws UserError where it is missing or shorter
  static OutputFile resume(const std::filesystem::path& path, std::uint64_t length);

  void write(std::span<const std::byte> bytes);
  void write(std::string_view text) { write(std::as_bytes(std::span(text))); }
  std::uint64_t length() const { return length_; }
  /// Returns when all is on the device.
  void sync();
  void close();

 private:
  OutputFile(std::filesystem::path path, Descriptor file, std::uint64_t length)
      : path_(std::move(path)), file_(std::move(file)), length_(length) {}

  std::filesystem::path path_;
  Descriptor file_;
  std::uint64_t length_ = 0;
};

/// A file that is there, written to at any place, by several processes at a time.
class PlacedFile {
 public:
  explicit PlacedFile(const std::filesystem::path& path);
  /// Makes it so long, and takes space on the device for all of it, as far as the file system can.
  void reserve(std::uint64_t length);
  void write_at(std::uint64_t place, std::span<const std::byte> bytes);
  /// Returns when all is on the device.
  void sync();
  void close();

 private:
  std::filesystem::path path_;
  Descriptor file_;
};

/// Writes a text file that is there completely, or not at all, after a loss of power too: under another name
/// first.
void write_text(const std::filesystem::path& file, std::string_view text);
/// Writes a text piece by piece.
void write_text(const std::filesystem::path& file, const std::function<void(OutputFile&)>& write);

/// Returns when what a file or a folder holds is on the device.
void sync_file(const std::filesystem::path& file);

/// Renames within one file system, replacing what has the new name.
void move_file(const std::filesystem::path& from, const std::filesystem::path& to);

/// Removes a file or an empty folder; it may be gone already.
void remove_file(const std::filesystem::path& file);
/// Removes it without a message. @return whether it was removed
bool try_to_remove(const std::filesystem::path& path, bool is_folder = false);

/// Makes a folder whose parent is there.
void make_folder(const std::filesystem::path& dir);
/// Makes a folder, and its parents, where they are missing.
void make_folders(const std::filesystem::path& dir);

/// A path, or where it leads if there are links on it.
std::filesystem::path resolved(std::filesystem::path path);

/// Whether something of this name is there, be it a link to nowhere.
bool is_there(const std::filesystem::path& path);
/// Whether it is a folder, reached without any link.
bool is_folder(const std::filesystem::path& path);
/// Whether it is a file with an end, or a link to one: no device, no pipe.
bool is_file(const std::filesystem::path& path);

}  // namespace slipfront::files
