// SPDX-License-Identifier: BSD-3-Clause
#include "base/memory.hpp"

#include <fstream>
#include <string>

#include "base/error.hpp"

namespace slipfront {

double available_memory_bytes() {
  std::ifstream file("/proc/meminfo");
  std::string key, unit;
  double kilobytes = 0;
  while (file >> key >> kilobytes) {
    std::getline(file, unit);
    if (key == "MemAvailable:") return 1024 * kilobytes;
  }
  return 8e9;  // not Linux: a modest machine
}

void require_memory(double bytes, std::string_view what, const Message& remedy) {
  const double available = available_memory_bytes();
  if (bytes > 0.9 * available)
    throw UserError("{} needs about {:.3g} GB of memory, {:.3g} GB are available; {}", what, bytes * 1e-9,
                    available * 1e-9, remedy);
}

}  // namespace slipfront
