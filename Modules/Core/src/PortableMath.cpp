// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/PortableMath.h"

#include <Eigen/Core>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

namespace explica::portable {
namespace {

// A constant and what it lacks.  The first part of ln 2 ends in zeros: times a whole number of 11
// bits it is exact; so are two parts of pi / 2 times one of 20 bits.
constexpr double kLn2 = 0x1.62e42feep-1;
constexpr double kLn2Rest = 0x1.a39ef35793c76p-33;
constexpr std::array<double, 3> kHalfPiParts = {0x1.921fb544p+0, 0x1.0b4611a6p-34,
                                                0x1.3198a2e037073p-69};
constexpr double kPi = 0x1.921fb54442d18p+1;
constexpr double kPiRest = 0x1.1a62633145c07p-53;
// Arc tangents of 0, 1/4, 1/2, 3/4 and 1.
constexpr std::array<double, 5> kArc = {0, 0x1.f5b75f92c80ddp-3, 0x1.dac670561bb4fp-2,
                                        0x1.4978fa3269ee1p-1, 0x1.921fb54442d18p-1};
constexpr std::array<double, 5> kArcRest = {0, 0x1.8ab6e3cf7afbdp-57, 0x1.a2b7f222f65e2p-56,
                                            0x1.2419a87f2a458p-56, 0x1.1a62633145c07p-55};

/// c[0] + x c[1] + x^2 c[2] + ...
template <std::size_t Count>
double polynomial(const std::array<double, Count>& c, double x) {
  double sum = c[Count - 1];
  for (std::size_t n = Count - 1; n-- > 0;) sum = c[n] + x * sum;
  return sum;
}

/// The factors of Taylor's series: `first` and then each divided by (n + 1) (n + 2) ... of its
/// step.
template <std::size_t Count>
constexpr std::array<double, Count> inverseFactorials(int first, int step, bool alternating) {
  std::array<double, Count> c{};
  double factorial = 1;
  int reached = 1;
  for (std::size_t k = 0; k < Count; ++k) {
    for (; reached < first + step * static_cast<int>(k); ++reached) factorial *= reached + 1;
    c[k] = (alternating && k % 2 == 1 ? -1 : 1) / factorial;
  }
  return c;
}

/// +-1/3, 1/5, 1/7, ... times `factor`.
template <std::size_t Count>
constexpr std::array<double, Count> inverseOdds(double factor, bool alternating) {
  std::array<double, Count> c{};
  for (std::size_t k = 0; k < Count; ++k) {
    c[k] = (alternating && k % 2 == 0 ? -factor : factor) / (2.0 * static_cast<double>(k) + 3);
  }
  return c;
}

constexpr auto kExponential = inverseFactorials<13>(2, 1, false);  // of (e^r - 1 - r) / r^2
constexpr auto kSine = inverseFactorials<8>(3, 2, true);           // of (r - sin r) / r^3
constexpr auto kCosine = inverseFactorials<8>(4, 2, true);         // of (cos r - 1 + r^2/2) / r^4
constexpr auto kLogarithm = inverseOdds<11>(2, false);             // of (2 artanh s - 2 s) / s^3
constexpr auto kArcTangent = inverseOdds<9>(1, true);              // of (arctan q - q) / q^3

/// An angle less a whole number of quarter turns: what is left, what it lacks, and the number
/// mod 4.
struct Reduced {
  double rest;
  double lack;
  int quarter;
};

Reduced reduced(double x) {
  const double count = std::floor(x * (2 / kPi) + 0.5);
  const double first = x - count * kHalfPiParts[0];
  const double second = count * kHalfPiParts[1];
  const double sum = first - second;
  const double lack = ((first - sum) - second) - count * kHalfPiParts[2];
  const double rest = sum + lack;
  return {rest, (sum - rest) + lack, static_cast<int>(static_cast<std::int64_t>(count) & 3)};
}

double sineOf(const Reduced& a) {
  const double square = a.rest * a.rest;
  return a.rest - (a.rest * square * polynomial(kSine, square) - a.lack);
}

double cosineOf(const Reduced& a) {
  const double square = a.rest * a.rest;
  const double half = 0.5 * square;
  const double main = 1 - half;
  return main +
         (((1 - main) - half) + (square * square * polynomial(kCosine, square) - a.rest * a.lack));
}

}  // namespace

double log(double x) {
  if (!(x > 0) || x == std::numeric_limits<double>::infinity()) return std::log(x);
  int exponent = 0;
  if (x < std::numeric_limits<double>::min()) {
    x *= 0x1p54;
    exponent = -54;
  }
  const auto bits = std::bit_cast<std::uint64_t>(x);
  exponent += static_cast<int>(bits >> 52) - 1023;
  double mantissa = std::bit_cast<double>((bits & 0xFFFFFFFFFFFFFULL) | (1023ULL << 52));
  if (mantissa > std::numbers::sqrt2) {
    mantissa /= 2;
    ++exponent;
  }
  // log(1 + f) = 2 artanh s with s = f / (2 + f), written so that f, which is exact, comes last.
  const double f = mantissa - 1;
  const double s = f / (2 + f);
  const double square = s * s;
  const double half = 0.5 * f * f;
  const double k = exponent;
  return k * kLn2 -
         ((half - (s * (half + square * polynomial(kLogarithm, square)) + k * kLn2Rest)) - f);
}

double log1p(double x) {
  const double sum = 1 + x;
  if (!(sum > 0) || sum == std::numeric_limits<double>::infinity()) return std::log1p(x);
  if (sum == 1) return x;
  return log(sum) + (x - (sum - 1)) / sum;
}

double exp(double x) {
  constexpr double kLargest = 709.8;  // beyond it the value is infinite
  constexpr double kLeast = -745.2;   // beyond it the value is 0
  if (!(x < kLargest)) return x + std::numeric_limits<double>::infinity();
  if (x < kLeast) return 0;
  const double count = std::floor(x / std::numbers::ln2 + 0.5);
  const double high = x - count * kLn2;
  const double low = count * kLn2Rest;
  const double rest = high - low;
  const double lack = (high - rest) - low;
  const double value = 1 + (rest + (rest * rest * polynomial(kExponential, rest) + lack));
  return std::ldexp(value, static_cast<int>(count));
}

double expm1(double x) {
  constexpr double kNear = 0.35;  // of 0: the series needs no reduction
  return std::abs(x) < kNear ? x + x * x * polynomial(kExponential, x) : exp(x) - 1;
}

double sin(double x) {
  if (!std::isfinite(x)) return x - x;
  if (x == 0) return x;
  const Reduced a = reduced(x);
  const double value = a.quarter % 2 == 0 ? sineOf(a) : cosineOf(a);
  return a.quarter < 2 ? value : -value;
}

double cos(double x) {
  if (!std::isfinite(x)) return x - x;
  const Reduced a = reduced(x);
  const double value = a.quarter % 2 == 0 ? cosineOf(a) : sineOf(a);
  return a.quarter == 0 || a.quarter == 3 ? value : -value;
}

double atan2(double y, double x) {
  double along = std::abs(x);
  double across = std::abs(y);
  const bool computed =
      along + across > 0 && along + across < std::numeric_limits<double>::infinity();
  if (!computed) return std::atan2(y, x);
  const bool steep = across > along;
  if (steep) std::swap(along, across);
  // arctan t = arctan c + arctan q for the multiple c of 1/4 that is nearest to t.
  const double ratio = across / along;
  const auto nearest = static_cast<std::size_t>(4 * ratio + 0.5);
  const double c = 0.25 * static_cast<double>(nearest);
  const double q = nearest == 0 ? ratio : (across - c * along) / (along + c * across);
  const double square = q * q;
  double angle =
      kArc[nearest] + (q + (q * square * polynomial(kArcTangent, square) + kArcRest[nearest]));
  if (steep) angle = kPi / 2 - (angle - kPiRest / 2);
  if (std::signbit(x)) angle = kPi - (angle - kPiRest);
  return std::copysign(angle, y);
}

double acos(double x) {
  return atan2(std::sqrt((1 - x) * (1 + x)), x);
}

void fixBlocksOfProducts() {
  constexpr std::ptrdiff_t kNear = std::ptrdiff_t{32} << 10;  // bytes, as most processors have them
  constexpr std::ptrdiff_t kMiddle = std::ptrdiff_t{1} << 20;
  constexpr std::ptrdiff_t kFar = std::ptrdiff_t{8} << 20;
  Eigen::setCpuCacheSizes(kNear, kMiddle, kFar);
}

}  // namespace explica::portable
