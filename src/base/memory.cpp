// SPDX-License-Identifier: BSD-3-Clause
#include "base/memory.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <string>

#ifdef __GLIBC__  // known from the headers above
#include <malloc.h>

#include "base/numbers.hpp"
#endif

namespace slipfront {

namespace {

/// What a limit on a part of the process's memory leaves. @param column  of /proc/self/statm, which has the
/// part
double left_by_limit_bytes(int resource, int column) {
  constexpr double without_limit = infinity;
  rlimit limit{};
  if (getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return without_limit;
  std::ifstream file("/proc/self/statm");
  double pages = 0;
  for (int k = 0; k <= column; ++k)
    if (!(file >> pages)) return without_limit;
  const double taken = pages * static_cast<double>(sysconf(_SC_PAGESIZE));
  return std::max(static_cast<double>(limit.rlim_cur) - taken, 0.0);
}

double free_memory_bytes() {
  std::ifstream file("/proc/meminfo");
  std::string key, unit;
  double kilobytes = 0;
  while (file >> key >> kilobytes) {
    std::getline(file, unit);
    if (key == "MemAvailable:") return 1024 * kilobytes;
  }
  return 8e9;  // not Linux: a modest machine
}

}  // namespace

double available_memory_bytes() {
  constexpr int addresses = 0, data = 5;  // `ulimit -v`, `ulimit -d`
  return std::min({free_memory_bytes(), left_by_limit_bytes(RLIMIT_AS, addresses),
                   left_by_limit_bytes(RLIMIT_DATA, data)});
}

// Sanitizers have their own allocator, beside which the C library's is not set up.
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SLIPFRONT_OTHER_ALLOCATOR
#endif
#endif

void return_freed_memory() {
#if defined(__GLIBC__) && !defined(SLIPFRONT_OTHER_ALLOCATOR) && !defined(__SANITIZE_ADDRESS__)
  malloc_trim(0);
#endif
}

}  // namespace slipfront
