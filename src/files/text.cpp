// SPDX-License-Identifier: BSD-3-Clause
#include "files/text.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "base/error.hpp"
#include "files/files.hpp"

namespace slipfront::files {
namespace {

[[noreturn]] void throw_unreadable(const Message& shown, std::string_view what) {
  if (errno == EISDIR) throw UserError("{}: is a folder; name the {} in it", shown, what);
  throw UserError("{}: cannot be read ({}); check the path", shown, std::strerror(errno));
}

bool is_control(unsigned char c) {
  return c < 0x20 || c == 0x7f;
}

/// Bytes of the character that begins the text; 0 where that is no UTF-8 (RFC 3629).
std::size_t bytes_of_character(std::string_view text) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t size = first >= 0xc2 && first < 0xe0   ? 2
                           : first >= 0xe0 && first < 0xf0 ? 3
                           : first >= 0xf0 && first < 0xf5 ? 4
                                                           : 0;
  if (size == 0 || text.size() < size) return 0;
  for (std::size_t k = 1; k < size; ++k)
    if ((byte(k) & 0xc0) != 0x80) return 0;
  const unsigned char second = byte(1);
  const bool overlong = (first == 0xe0 && second < 0xa0) || (first == 0xf0 && second < 0x90);
  const bool surrogate = first == 0xed && second >= 0xa0;
  const bool beyond = first == 0xf4 && second >= 0x90;
  return overlong || surrogate || beyond ? 0 : size;
}

}  // namespace

std::string read_text(const std::filesystem::path& file, const Message& shown, std::string_view what,
                      std::size_t max_bytes) {
  const Descriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (!opened.valid()) throw_unreadable(shown, what);
  std::string text;
  std::array<char, 1 << 16> part{};
  for (;;) {
    const ssize_t count = ::read(opened.get(), part.data(), part.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw_unreadable(shown, what);
    if (count == 0) break;
    text.append(part.data(), static_cast<std::size_t>(count));
    if (text.size() > max_bytes)
      throw UserError("{}: is larger than {} MB; check that it is the {} that is meant", shown,
                      max_bytes >> 20U, what);
  }
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
  if (text.starts_with(byte_order_mark)) text.erase(0, byte_order_mark.size());
  return text;
}

int line_outside_utf8(std::string_view text) {
  int line = 1;
  while (!text.empty()) {
    const std::size_t size = bytes_of_character(text);
    if (size == 0) return line;
    if (text.front() == '\n') ++line;
    text.remove_prefix(size);
  }
  return 0;
}

std::string one_line(std::string_view text) {
  std::string line;
  while (!text.empty()) {
    const std::size_t size = bytes_of_character(text);
    if (size == 0)
      line += '?';
    else if (is_control(static_cast<unsigned char>(text.front())))
      line += ' ';
    else
      line += text.substr(0, size);
    text.remove_prefix(std::max<std::size_t>(size, 1));
  }
  return line;
}

std::string shortened(std::string_view text) {
  constexpr std::size_t most = 160;
  if (text.size() <= most) return one_line(text);
  // A character that is cut in two goes with the rest.
  std::size_t end = most;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;
  return one_line(text.substr(0, end)) + "...";
}

}  // namespace slipfront::files
