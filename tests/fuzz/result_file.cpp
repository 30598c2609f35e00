// SPDX-License-Identifier: BSD-3-Clause
// Result files, damaged: with a list of checksums they are refused, without one refused or read. Whatever
// passes the comparison with what was to be written holds it.
#include "files/checksum.hpp"
#include "fuzz.hpp"
#include "results/history.hpp"

using namespace slipfront;

namespace {

constexpr const char* name = "interface.h5";

record::History small_history() {
  record::History history;
  for (int i = 0; i < 3; ++i) history.x_m.push_back(i);
  for (int k = 0; k < 2; ++k) history.time_s.push_back(k);
  int n = 0;
  for (auto* matrix : {&history.slip_m, &history.slip_rate_m_per_s, &history.t_Pa, &history.p_Pa})
    for (std::size_t k = 0; k < 6; ++k) matrix->push_back(++n);
  return history;
}

bool equal(const record::History& a, const record::History& b) {
  return a.time_s == b.time_s && a.x_m == b.x_m && a.slip_m == b.slip_m &&
         a.slip_rate_m_per_s == b.slip_rate_m_per_s && a.t_Pa == b.t_Pa && a.p_Pa == b.p_Pa;
}

/// Whether a file passes for one that was written just now.
bool passes(const std::filesystem::path& file, const record::History& history) {
  try {
    const results::WrittenHistory written(file);
    written.require(0, history);
    written.require_lengths(history.time_s.size(), history.x_m.size());
    return true;
  } catch (const WriteError&) {
    return false;
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::Scratch scratch, listed;
  static const auto expected = small_history();
  const auto content = fuzz::text_of(data, size);
  const auto file = scratch.write(name, content);
  record::History history;
  const bool taken = fuzz::takes([&] { history = results::read_history(file); });
  if (passes(file, expected)) fuzz::require(taken && equal(history, expected), "another history passes");
  static const auto sum_of_other = files::sha256("other");
  listed.write(files::checksum_list, sum_of_other + "  " + name + "\n");
  const auto listed_file = listed.write(name, content);
  fuzz::require(!fuzz::takes([&] { results::read_history(listed_file); }),
                "a file other than the listed one");
  return 0;
}
