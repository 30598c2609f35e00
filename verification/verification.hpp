// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

namespace slipfront::verification {

/// How much to compute: `quick` for the daily tests, `full` for the documented figures.
enum class Effort { quick, full };

/// A number of the program's against what theory asks for.
struct Check {
  std::string quantity;
  std::string unit = {};  ///< empty for a pure number
  double measured = 0;
  double expected = 0;
  double tolerance = 0;     ///< |measured - expected| may be this
  std::string reason = {};  ///< where the tolerance comes from

  bool holds() const;  ///< false for what is not a number

  template <class Archive>
  void serialize(Archive& archive) {
    archive(quantity, unit, measured, expected, tolerance, reason);
  }
};

struct Curve {
  enum class Kind { theory, program };
  std::string label;
  Kind kind = Kind::program;  ///< drawn as a line, or as points
  std::vector<double> x = {}, y = {};

  void add(double at, double value) {
    x.push_back(at);
    y.push_back(value);
  }
  /// Between its points, x ascending, linear.
  double value_at(double at) const;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(label, kind, x, y);
  }
};

/// A picture: curves over a common abscissa.
struct Chart {
  std::string x_label, y_label;  ///< with their units
  bool log_x = false, log_y = false;
  std::vector<Curve> curves = {};

  template <class Archive>
  void serialize(Archive& archive) {
    archive(x_label, y_label, log_x, log_y, curves);
  }
};

struct Outcome {
  std::vector<Check> checks;
  std::vector<Chart> charts;

  void check(const std::string& quantity, double measured, double expected, double tolerance,
             const std::string& reason, const std::string& unit = {}) {
    checks.push_back({quantity, unit, measured, expected, tolerance, reason});
  }
  bool holds() const;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(checks, charts);
  }
};

/// A problem with a known answer that the program itself is made to solve. Theory:
/// verification/<name>.md.
struct Verification {
  std::string name;   ///< of its file, page and results
  std::string title;  ///< one line
  Outcome (*run)(Effort effort);
};

/// All of them, in the order of the docs.
std::span<const Verification> verifications();

}  // namespace slipfront::verification
