// SPDX-License-Identifier: BSD-3-Clause
// Case files, with overrides in comments of the form "#set key=value". What is taken must come back from its
// resolved form to the last bit.
#include <sstream>
#include <vector>

#include "fuzz.hpp"
#include "input/schema.hpp"

using namespace slipfront;

namespace {

std::vector<input::Override> overrides_in(const std::string& text) {
  constexpr std::string_view mark = "#set ";
  std::vector<input::Override> overrides;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(mark)) overrides.push_back(input::parse_override(line.substr(mark.size())));
  return overrides;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(fuzz::text_of(data, size));
  std::string resolved;
  if (!fuzz::takes(
          [&] { resolved = input::to_toml(input::parse_case(text, "case.toml", overrides_in(text))); }))
    return 0;
  std::string again;
  fuzz::require(fuzz::takes([&] { again = input::to_toml(input::parse_case(resolved, "resolved.toml")); }),
                "the resolved case is refused:\n" + resolved);
  fuzz::require(again == resolved, "the resolved case is read back as another:\n" + resolved + again);
  return 0;
}
