// SPDX-License-Identifier: BSD-3-Clause
#include "stability/roots.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace slipfront::stability {
namespace {

using Function = std::function<Complex(Complex)>;

/// A rectangle in z = log p.
struct Cell {
  double low_re, high_re, low_im, high_im;
  Complex middle() const { return {0.5 * (low_re + high_re), 0.5 * (low_im + high_im)}; }
  bool holds(Complex z) const {
    return z.real() >= low_re && z.real() <= high_re && z.imag() >= low_im && z.imag() <= high_im;
  }
};

Cell whole(const Sector& sector) {
  const double angle = std::acos(sector.min_growth);
  return {std::log(sector.min_modulus), std::log(sector.max_modulus), -angle, angle};
}

class Finder {
 public:
  Finder(const Function& f, const Sector& sector) : f_(f), sector_(sector) {}

  /// Zeros within a cell; empty where a zero lies on its contour.
  std::optional<int> count(const Cell& c) const {
    const Complex corner[] = {
        {c.low_re, c.low_im}, {c.high_re, c.low_im}, {c.high_re, c.high_im}, {c.low_re, c.high_im}};
    double turn = 0;
    for (int k = 0; k < 4; ++k) {
      const auto edge = turn_along(corner[k], corner[(k + 1) % 4]);
      if (!edge) return std::nullopt;
      turn += *edge;
    }
    return static_cast<int>(std::lround(turn / (2 * std::numbers::pi)));
  }

  void find(const Cell& cell, int n, std::vector<Complex>& zeros) const {
    if (n == 0) return;
    const double width = cell.high_re - cell.low_re;
    const double height = cell.high_im - cell.low_im;
    if (n == 1 && width < 2) {
      const auto z = newton(cell.middle());
      if (z && cell.holds(*z)) {
        zeros.push_back(std::exp(*z));
        return;
      }
    }
    if (std::max(width, height) < 1e-9) {
      zeros.insert(zeros.end(), static_cast<std::size_t>(n), std::exp(cell.middle()));
      return;
    }
    // A cut through a zero, or through a point where rounding hides the sign, is moved aside.
    for (const double share : {0.5, 0.46, 0.55, 0.41, 0.6, 0.35, 0.67}) {
      Cell first = cell, second = cell;
      if (width > height)
        first.high_re = second.low_re = cell.low_re + share * width;
      else
        first.high_im = second.low_im = cell.low_im + share * height;
      const auto n_first = count(first);
      if (!n_first || *n_first < 0 || *n_first > n) continue;
      find(first, *n_first, zeros);
      find(second, n - *n_first, zeros);
      return;
    }
    throw Inseparable();
  }

  std::optional<Complex> newton(Complex z) const {
    for (int k = 0; k < 60; ++k) {
      // The difference must not reach over the imaginary axis, where branch points are.
      const double to_axis = std::numbers::pi / 2 - std::abs(z.imag());
      if (to_axis <= 0) return std::nullopt;
      const double step = std::min(1e-5, 0.1 * to_axis);
      const Complex slope = (at(z + step) - at(z - step)) / (2 * step);
      Complex move = -at(z) / slope;
      if (!std::isfinite(std::abs(move))) return std::nullopt;
      if (std::abs(move) > 0.5) move *= 0.5 / std::abs(move);
      z += move;
      if (std::abs(z) > 60) return std::nullopt;
      if (std::abs(move) < 1e-12) return z;
    }
    return std::nullopt;
  }

 private:
  Complex at(Complex z) const { return f_(std::exp(z)); }

  static constexpr int max_halvings = 40;

  /// Change of arg f from a to b along a straight line.
  std::optional<double> turn_along(Complex a, Complex b) const {
    const double length = std::abs(b - a);
    const Complex way = (b - a) / length;
    double turn = 0;
    double done = 0;
    Complex f_here = at(a);
    while (done < length) {
      const double modulus = std::exp((a + done * way).real());
      double advance = std::min(0.1, 0.25 / (1 + sector_.phase_rate * modulus));
      if (done + 1.01 * advance >= length) advance = length - done;
      const double next = done + advance >= length ? length : done + advance;
      const Complex f_next = at(a + next * way);
      const auto part = refined(a + done * way, f_here, a + next * way, f_next, 0);
      if (!part) return std::nullopt;
      turn += *part;
      done = next;
      f_here = f_next;
    }
    return turn;
  }

  std::optional<double> refined(Complex a, Complex f_a, Complex b, Complex f_b, int depth) const {
    const Complex middle = 0.5 * (a + b);
    const Complex f_middle = at(middle);
    // The arguments of the quotients, without dividing.
    const double first = std::arg(f_middle * std::conj(f_a));
    const double second = std::arg(f_b * std::conj(f_middle));
    // Neither half may turn far, and both must agree: a contour that passes close to a zero fails this.
    if (std::abs(first) < 0.7 && std::abs(second) < 0.7 && std::abs(first - second) < 0.35)
      return first + second;
    if (depth == max_halvings) return std::nullopt;
    const auto left = refined(a, f_a, middle, f_middle, depth + 1);
    if (!left) return std::nullopt;
    const auto right = refined(middle, f_middle, b, f_b, depth + 1);
    if (!right) return std::nullopt;
    return *left + *right;
  }

  const Function& f_;
  const Sector& sector_;
};

}  // namespace

std::vector<Complex> zeros_by_argument_principle(const Function& f, const Sector& sector,
                                                 std::span<const Complex> expected) {
  const Finder finder(f, sector);
  // A neutral zero can lie on the border itself; a slightly narrower sector leaves it out.
  Sector tried = sector;
  std::optional<int> n;
  for (int k = 0; k < 4 && !n; ++k, tried.min_growth *= 1.3, tried.max_modulus *= 0.99) {
    n = finder.count(whole(tried));
    if (n) break;
  }
  if (!n || *n < 0) throw Inseparable();
  const Cell cell = whole(tried);
  std::vector<Complex> zeros;
  for (const Complex p : expected)
    if (const auto z = finder.newton(std::log(p)); z && cell.holds(*z)) {
      const Complex zero = std::exp(*z);
      const auto is_near = [&](Complex other) { return std::abs(zero - other) < 1e-7 * std::abs(zero); };
      if (std::ranges::none_of(zeros, is_near)) zeros.push_back(zero);
    }
  if (zeros.size() != static_cast<std::size_t>(*n)) {
    zeros.clear();
    finder.find(cell, *n, zeros);
  }
  std::ranges::sort(zeros, [](Complex a, Complex b) { return a.real() > b.real(); });
  return zeros;
}

}  // namespace slipfront::stability
