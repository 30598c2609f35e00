// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

namespace slipfront {

/// What a user should know of a case or its run that is not refused for it.
struct Diagnostic {
  enum class Kind {
    units,       ///< a number that looks as if it was in another unit than its key's
    resolution,  ///< mesh, step, damping or precision decide a part of the results
    physics,     ///< what the set-up decides unasked, or what keeps it from the event that is meant
    output       ///< what the results leave out
  };
  using enum Kind;
  Kind kind = physics;
  std::string text;  ///< one line

  bool is_refused_if_strict() const { return kind == units || kind == resolution; }
};

inline const char* name(Diagnostic::Kind kind) {
  constexpr const char* names[] = {"units", "resolution", "physics", "output"};
  return names[static_cast<int>(kind)];
}

/// In the order in which they are told.
class Diagnostics : public std::vector<Diagnostic> {
 public:
  template <class... Args>
  void add(Diagnostic::Kind kind, fmt::format_string<Args...> text, Args&&... args) {
    push_back({kind, fmt::format(text, std::forward<Args>(args)...)});
  }
  void add(const std::vector<Diagnostic>& more) { insert(end(), more.begin(), more.end()); }
};

}  // namespace slipfront
