// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <span>
#include <string_view>

namespace slipfront::study {

inline constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

/// How a quantity behaves as a step size goes to 0, by three values.
enum class Trend {
  monotone,     ///< differences shrink with one sign
  alternating,  ///< differences shrink with changing sign
  growing,      ///< the last difference is not smaller than the steps let it be: no limit to be seen
  unknown,      ///< a value is missing
};

struct Limit {
  Trend trend = Trend::unknown;
  double order = undefined;  ///< observed p in f = f_0 + C q^p; defined where monotone
  double value = undefined;  ///< extrapolated to q = 0; undefined where growing
};

/// The scheme is of second order: a higher observed order is an accident of three values, and extrapolation
/// with it would claim too small an error.
inline constexpr double highest_order = 2;

/// Richardson extrapolation to q = 0 from three values f at step sizes q1 > q2 > q3 > 0 in any ratio. The
/// observed order p solves (f1 - f2)/(f2 - f3) = (q1^p - q2^p)/(q2^p - q3^p); extrapolated with
/// min(p, highest_order). As p goes to 0 the right side goes to ln(q1/q2)/ln(q2/q3), so that a smaller ratio
/// of differences has no order: growing. Alternating values enclose their limit: it is put midway between the
/// last two. Equal values have the highest order. (Roache, Annu. Rev. Fluid Mech. 29, 123-160, 1997)
Limit extrapolate(std::span<const double, 3> q, std::span<const double, 3> f);

/// Error of a value of the sequence against its limit. Monotone: the distance from the extrapolated value;
/// alternating: that plus half the last difference; growing: the largest distance from the other two values,
/// a lower bound.
double error_of(double value, const Limit& limit, std::span<const double, 3> f);

/// What is found at one station. Errors and differences are relative to the case's own value.
struct StationSummary {
  double relative_error = undefined;
  double order = undefined;
  double first_difference = undefined;  ///< |f1 - f2| / ln(q1/q2)
  double last_difference = undefined;   ///< |f2 - f3| / ln(q2/q3)
};

enum class Verdict { converged, not_converged, no_limit, too_few_stations };
std::string_view name(Verdict verdict);

/// A sequence over its stations; medians, so that single stations do not decide.
struct Summary {
  Verdict verdict = Verdict::too_few_stations;
  double median_relative_error = undefined;
  double median_order = undefined;  ///< of the stations that have one
  double growth = undefined;        ///< median last difference over median first one, per ln q
  int n_stations = 0;               ///< with all values
  int n_wanted = 0;                 ///< stations of the case itself
};

/// Fewer stations, or less than half of the case's, do not make a verdict.
inline constexpr int fewest_stations = 5;

/// Converged: median error at most `tolerance`. Otherwise no limit where the last differences are not smaller
/// than the first ones (growth >= 1), else not converged.
Summary summarise(std::span<const StationSummary> stations, int n_wanted, double tolerance);

}  // namespace slipfront::study
