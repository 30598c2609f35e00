// SPDX-License-Identifier: BSD-3-Clause
// The only file that sees OpenSSL.
#include "files/checksum.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <openssl/evp.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <vector>

#include "base/error.hpp"
#include "files/files.hpp"

namespace slipfront::files {
namespace {

constexpr std::size_t digits = 64;
constexpr std::size_t bytes_at_once = std::size_t{1} << 18U;

[[noreturn]] void throw_changed(const std::filesystem::path& file, const char* what) {
  throw UserError("{}: {}; run the case again", file.string(), what);
}

void require_sum(const std::filesystem::path& file, const std::string& sum) {
  if (!is_there(file)) throw_changed(file, "is missing");
  if (sha256_of_file(file) != sum)
    throw_changed(file, "does not match checksums.sha256: it was changed or damaged");
}

/// A name within the folder, or within one of its folders, that can be shown in a message.
bool is_inside(const std::filesystem::path& name) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  if (name.empty() || name.is_absolute() || std::ranges::any_of(name.native(), is_control)) return false;
  for (const auto& part : name)
    if (part == ".." || part == "." || part.empty()) return false;
  return true;
}

}  // namespace

struct Sha256::State {
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context{EVP_MD_CTX_new(), &EVP_MD_CTX_free};
};

Sha256::Sha256() : state_(std::make_unique<State>()) {
  if (!state_->context || EVP_DigestInit_ex(state_->context.get(), EVP_sha256(), nullptr) != 1)
    throw std::bad_alloc();
}

Sha256::~Sha256() = default;

void Sha256::add(std::span<const std::byte> bytes) {
  SLIPFRONT_ASSERT(EVP_DigestUpdate(state_->context.get(), bytes.data(), bytes.size()) == 1,
                   "a digest takes all bytes");
}

std::string Sha256::digest() const {
  std::array<unsigned char, EVP_MAX_MD_SIZE> value{};
  unsigned length = 0;
  State end;
  if (!end.context || EVP_MD_CTX_copy_ex(end.context.get(), state_->context.get()) != 1)
    throw std::bad_alloc();
  SLIPFRONT_ASSERT(EVP_DigestFinal_ex(end.context.get(), value.data(), &length) == 1,
                   "a copied digest can be ended");
  std::string text;
  for (unsigned k = 0; k < length; ++k) text += fmt::format("{:02x}", value[k]);
  return text;
}

std::string sha256(std::string_view text) {
  Sha256 sum;
  sum.add(std::as_bytes(std::span(text)));
  return sum.digest();
}

std::string sha256_of_file(const std::filesystem::path& file) {
  const Descriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  const auto refuse = [&] {
    throw UserError("{}: cannot be read ({}); check that it is there", file.string(), std::strerror(errno));
  };
  if (!opened.valid()) refuse();
  if (!is_file(file))
    throw UserError("{}: is not a regular file; restore it from the original results", file.string());
  Sha256 sum;
  std::vector<std::byte> piece(bytes_at_once);
  for (;;) {
    const ssize_t n = ::read(opened.get(), piece.data(), piece.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) refuse();
    if (n == 0) return sum.digest();
    sum.add(std::span(piece).first(static_cast<std::size_t>(n)));
  }
}

void write_checksums(const std::filesystem::path& dir, const Checksums& checksums) {
  std::string text;
  for (const auto& [name, sum] : checksums) text += fmt::format("{}  {}\n", sum, name);
  write_text(dir / checksum_list, text);
}

Checksums read_checksums(const std::filesystem::path& dir) {
  const auto file = dir / checksum_list;
  if (!is_there(file)) return {};
  if (!is_file(file)) throw_changed(file, "is not a list of checksums");
  std::ifstream stream(file, std::ios::binary);
  Checksums checksums;
  for (std::string line; std::getline(stream, line);) {
    const bool well_formed = line.size() > digits + 2 && line.substr(digits, 2) == "  " &&
                             line.find_first_not_of("0123456789abcdef") == digits;
    const std::string name = well_formed ? line.substr(digits + 2) : "";
    if (!well_formed || !is_inside(name)) throw_changed(file, "is not a list of checksums");
    checksums[name] = line.substr(0, digits);
  }
  if (!stream.eof() || checksums.empty()) throw_changed(file, "is not a list of checksums");
  return checksums;
}

void require_intact(const std::filesystem::path& dir) {
  for (const auto& [name, sum] : read_checksums(dir)) require_sum(dir / name, sum);
}

void require_listed(const std::filesystem::path& file) {
  const auto sums = read_checksums(file.parent_path());
  if (sums.empty()) return;
  const auto listed = sums.find(file.filename().string());
  if (listed == sums.end())
    throw_changed(file, "is not in checksums.sha256: it belongs to no set of results");
  require_sum(file, listed->second);
}

}  // namespace slipfront::files
