// SPDX-License-Identifier: BSD-3-Clause
#include "base/memory.hpp"

#include <fstream>
#include <string>

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

}  // namespace slipfront
