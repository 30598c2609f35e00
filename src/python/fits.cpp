// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "fronts/fit.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"

namespace slipfront::python {
namespace {

using namespace nb::literals;

/// (x, y) of each front.
using GivenSeries = std::vector<std::pair<Values, Values>>;

std::vector<fronts::Series> series_of(const GivenSeries& given) {
  std::vector<fronts::Series> all;
  for (const auto& [x, y] : given) {
    require_length(y, x.size(), "y");
    all.push_back({to_vector(x), to_vector(y)});
  }
  return all;
}

fronts::ExponentialFit fit_exponential(const GivenSeries& given, int resamples, int block_points,
                                       double confidence, std::uint32_t seed) {
  require(resamples >= 0, "resamples must be at least 0");
  require(block_points >= 1, "block_points must be at least 1");
  require(confidence > 0 && confidence < 1, "confidence must be between 0 and 1");
  const auto series = series_of(given);
  const nb::gil_scoped_release unlocked;
  return fronts::fit_exponential(series, {resamples, block_points, confidence, seed});
}

fronts::Spread spread_at_equal_x(const GivenSeries& given, int bins) {
  require(bins > 0, "bins must be above 0");
  return fronts::spread_at_equal_x(series_of(given), bins);
}

fronts::Ratio ratio_at_equal_x(const GivenSeries& given, int bins) {
  require(bins > 0, "bins must be above 0");
  require(given.size() == 2, "two series");
  const auto series = series_of(given);
  return fronts::ratio_at_equal_x(series[0], series[1], bins);
}

double rank_correlation(const Values& x, const Values& y) {
  require_length(y, x.size(), "y");
  return fronts::rank_correlation(view(x), view(y));
}

Array evaluate(const fronts::ExponentialFit& fit, const Values& x) {
  std::vector<double> y;
  y.reserve(x.size());
  for (const double each : view(x)) y.push_back(fit(each));
  return to_array(std::move(y));
}

std::tuple<Array, Array, Array, Array> curve(const fronts::ExponentialFit& fit) {
  std::vector<double> x, y, low, high;
  for (const auto& point : fit.curve) {
    x.push_back(point.x);
    y.push_back(point.y.value);
    low.push_back(point.y.low);
    high.push_back(point.y.high);
  }
  return {to_array(std::move(x)), to_array(std::move(y)), to_array(std::move(low)),
          to_array(std::move(high))};
}

void bind_results(nb::module_& module) {
  using fronts::CurvePoint, fronts::Estimate, fronts::ExponentialFit, fronts::Ratio, fronts::Spread;
  nb::class_<Estimate>(module, "Estimate", "A value with a two-sided confidence interval.")
      .def_ro("value", &Estimate::value)
      .def_ro("low", &Estimate::low)
      .def_ro("high", &Estimate::high);
  nb::class_<ExponentialFit>(module, "ExponentialFit",
                             "y = a + b exp(-c sqrt(x)), Kammer et al. 2012, Eq. 3.")
      .def_ro("a", &ExponentialFit::a)
      .def_ro("b", &ExponentialFit::b)
      .def_ro("c", &ExponentialFit::c)
      .def_ro("rms", &ExponentialFit::rms, "of the residuals")
      .def_ro("n_points", &ExponentialFit::n_points)
      .def("curve", &curve, "The fitted curve: x, y and its interval low and high, [points].")
      .def("__call__", &evaluate, "x"_a, "y at x [points]");
  nb::class_<Spread>(module, "Spread", "Spread of y over the series at equal x.")
      .def_ro("median_relative", &Spread::median_relative,
              "median over the bins; NaN where no bin has two series")
      .def_ro("rms_relative", &Spread::rms_relative, "of all points of a bin about their mean")
      .def_ro("n_bins", &Spread::n_bins, "bins with at least two series");
  nb::class_<Ratio>(module, "Ratio", "Ratio of the medians of y of two series at equal x.")
      .def_ro("median", &Ratio::median, "over the bins; NaN where no bin has both series")
      .def_ro("low", &Ratio::low, "the smallest of a bin")
      .def_ro("high", &Ratio::high, "the largest")
      .def_ro("n_bins", &Ratio::n_bins, "bins that both series reach");
}

}  // namespace

void bind_fits(nb::module_& module) {
  bind_results(module);
  module.def("fit_exponential", &fit_exponential, "series"_a, "resamples"_a, "block_points"_a, "confidence"_a,
             "seed"_a, "Least squares over all points of all series (x, y).");
  module.def("spread_at_equal_x", &spread_at_equal_x, "series"_a, "bins"_a);
  module.def("ratio_at_equal_x", &ratio_at_equal_x, "series"_a, "bins"_a);
  module.def("rank_correlation", &rank_correlation, "x"_a, "y"_a, "Spearman's.");
}

}  // namespace slipfront::python
