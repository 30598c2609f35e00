// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>

#include "base/error.hpp"

/// What the fuzzers share. A fuzzer makes up what a reader is given; the reader may use it or refuse it by a
/// UserError of one line, and nothing else.
namespace slipfront::fuzz {

/// Ends the fuzzer, which keeps what led here.
inline void require(bool condition, const std::string& what) {
  if (condition) return;
  std::fprintf(stderr, "slipfront: %s\n", what.c_str());
  std::abort();
}

/// Runs a reader. @return whether it took what it was given
template <class Read>
bool takes(Read&& read) {
  try {
    read();
    return true;
  } catch (const UserError& error) {
    const std::string_view message = error.what();
    require(!message.empty() && message.find('\n') == std::string_view::npos,
            "refused otherwise than in one line: " + std::string(message));
    return false;
  }
}

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// A folder for files that are made up, removed when the fuzzer ends by itself.
class Scratch {
 public:
  Scratch() {
    std::string name = (std::filesystem::temp_directory_path() / "slipfront-fuzz-XXXXXX").string();
    require(mkdtemp(name.data()) != nullptr, "no folder can be made for the files");
    dir_ = name;
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(dir_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  const std::filesystem::path& dir() const { return dir_; }

  /// Writes a file, replacing the one before.
  std::filesystem::path write(const std::string& name, std::string_view content) const {
    const auto file = dir_ / name;
    std::ofstream stream(file, std::ios::binary | std::ios::trunc);
    stream << content << std::flush;
    require(stream.good(), "the file cannot be written");
    return file;
  }

 private:
  std::filesystem::path dir_;
};

}  // namespace slipfront::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
