// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/PortableMath.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace explica::portable {
namespace {

constexpr int kPlaces = 20000;

/// Numbers of either sign, evenly spread over the orders of magnitude up to a largest one.
class Places {
 public:
  explicit Places(double largest) : largest_(largest) {}
  double next() {
    const double share = static_cast<double>(random_() >> 11) * 0x1p-53;
    const double sign = random_() % 2 == 0 ? 1 : -1;
    return sign * std::ldexp(largest_ * (0.5 + 0.5 * share), -static_cast<int>(random_() % 24));
  }

 private:
  std::mt19937_64 random_{20261122};
  double largest_;
};

/// The distance of a value from the truth in units of the truth's last place.
double unitsOff(double value, long double truth) {
  const double place = std::abs(static_cast<double>(truth));
  const double unit = std::nextafter(place, std::numeric_limits<double>::infinity()) - place;
  return static_cast<double>(std::abs(static_cast<long double>(value) - truth)) / unit;
}

template <class Function, class Truth>
double mostUnitsOff(double largest, const Function& function, const Truth& truth) {
  Places places(largest);
  double most = 0;
  for (int n = 0; n < kPlaces; ++n) {
    const double x = places.next();
    most = std::max(most, unitsOff(function(x), truth(static_cast<long double>(x))));
  }
  return most;
}

TEST(PortableMath, IsTheTruthButForItsLastPlace) {
  using Long = long double;
  EXPECT_LT(mostUnitsOff(
                1e6, [](double x) { return log(std::abs(x)); },
                [](Long x) { return std::log(std::abs(x)); }),
            1);
  EXPECT_LT(mostUnitsOff(
                1e4, [](double x) { return log1p(std::abs(x)); },
                [](Long x) { return std::log1p(std::abs(x)); }),
            2);
  EXPECT_LT(mostUnitsOff(
                700, [](double x) { return exp(x); }, [](Long x) { return std::exp(x); }),
            1);
  EXPECT_LT(mostUnitsOff(
                30, [](double x) { return expm1(x); }, [](Long x) { return std::expm1(x); }),
            3);
  EXPECT_LT(mostUnitsOff(
                1e6, [](double x) { return sin(x); }, [](Long x) { return std::sin(x); }),
            1);
  EXPECT_LT(mostUnitsOff(
                1e6, [](double x) { return cos(x); }, [](Long x) { return std::cos(x); }),
            1);
  EXPECT_LT(mostUnitsOff(
                100, [](double x) { return atan2(x, -1.5); },
                [](Long x) { return std::atan2(x, Long(-1.5)); }),
            2);
  EXPECT_LT(mostUnitsOff(
                100, [](double x) { return atan2(x, 2.25); },
                [](Long x) { return std::atan2(x, Long(2.25)); }),
            2);
  EXPECT_LT(mostUnitsOff(
                1, [](double x) { return acos(x); }, [](Long x) { return std::acos(x); }),
            2);
}

TEST(PortableMath, OfSpecialValuesIsThatOfTheCLibrary) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(log(1), 0);
  EXPECT_EQ(log(0), -kInfinite);
  EXPECT_EQ(log(kInfinite), kInfinite);
  EXPECT_TRUE(std::isnan(log(-1)));
  EXPECT_NEAR(log(5e-324), std::log(5e-324), 1e-12);
  EXPECT_EQ(log1p(0), 0);
  EXPECT_EQ(log1p(1e-20), 1e-20);
  EXPECT_EQ(log1p(kInfinite), kInfinite);
  EXPECT_EQ(exp(0), 1);
  EXPECT_EQ(exp(kInfinite), kInfinite);
  EXPECT_EQ(exp(-kInfinite), 0);
  EXPECT_EQ(exp(710), kInfinite);
  EXPECT_TRUE(std::isnan(exp(std::nan(""))));
  EXPECT_NEAR(exp(-740) / std::exp(-740.0), 1, 1e-2);  // of few digits, so far down
  EXPECT_EQ(expm1(0), 0);
  EXPECT_EQ(cos(0), 1);
  EXPECT_TRUE(std::signbit(sin(-0.0)));
  EXPECT_TRUE(std::isnan(sin(kInfinite)));
  for (const double y : {0.0, -0.0, 1.0, -2.0, kInfinite}) {
    for (const double x : {0.0, -0.0, 3.0, -1.0, -kInfinite}) {
      EXPECT_NEAR(atan2(y, x), std::atan2(y, x), 1e-15) << y << " " << x;
      EXPECT_EQ(std::signbit(atan2(y, x)), std::signbit(std::atan2(y, x))) << y << " " << x;
    }
  }
}

/// A number that any other bit of any value changes.
template <class Function>
std::uint64_t digestOf(double largest, const Function& function) {
  Places places(largest);
  std::uint64_t digest = 14695981039346656037ULL;  // FNV-1a
  for (int n = 0; n < kPlaces; ++n) {
    digest = (digest ^ std::bit_cast<std::uint64_t>(function(places.next()))) * 1099511628211ULL;
  }
  return digest;
}

TEST(PortableMath, HasTheseBitsOnEveryProcessor) {
  const auto positive = [](double x) { return std::abs(x); };
  EXPECT_EQ(digestOf(1e6, [&](double x) { return log(positive(x)); }), 2876698664777266697ULL);
  EXPECT_EQ(digestOf(1e6, [&](double x) { return log1p(positive(x)); }), 5608451807861435386ULL);
  EXPECT_EQ(digestOf(700, [](double x) { return exp(x); }), 2418907574008387575ULL);
  EXPECT_EQ(digestOf(30, [](double x) { return expm1(x); }), 6456507876381459468ULL);
  EXPECT_EQ(digestOf(1e6, [](double x) { return sin(x); }), 8839481482581793196ULL);
  EXPECT_EQ(digestOf(1e6, [](double x) { return cos(x); }), 6063973483607750485ULL);
  EXPECT_EQ(digestOf(100, [](double x) { return atan2(x, -1.5); }), 6400930113151757045ULL);
  EXPECT_EQ(digestOf(1, [](double x) { return acos(x); }), 17935166273556800142ULL);
}

}  // namespace
}  // namespace explica::portable
