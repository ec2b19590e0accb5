// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace explica::geometry {

/// A real number held exactly as a sum of doubles that do not overlap, smallest first
/// [Shewchuk1997]. Exact while no product underflows or overflows: coordinates between 1e-90 and
/// 1e90 are safe.
template <std::size_t Capacity>
class Expansion {
 public:
  Expansion() = default;

  void add(double value) {
    std::size_t kept = 0;
    double sum = value;
    for (std::size_t i = 0; i < size_; ++i) {
      double error;
      sum = twoSum(sum, terms_[i], error);
      if (error != 0) terms_[kept++] = error;
    }
    if (sum != 0) terms_[kept++] = sum;
    size_ = kept;
  }

  template <std::size_t Other>
  void add(const Expansion<Other>& other) {
    for (std::size_t i = 0; i < other.size(); ++i) add(other[i]);
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] double operator[](std::size_t i) const { return terms_[i]; }

  /// The largest term carries the sign of the whole.
  [[nodiscard]] int sign() const {
    if (size_ == 0) return 0;
    return terms_[size_ - 1] > 0 ? 1 : -1;
  }

  static double twoSum(double a, double b, double& error) {
    const double sum = a + b;
    const double bVirtual = sum - a;
    error = (a - (sum - bVirtual)) + (b - bVirtual);
    return sum;
  }

  static double twoProduct(double a, double b, double& error) {
    const double product = a * b;
    const auto [aHigh, aLow] = split(a);
    const auto [bHigh, bLow] = split(b);
    error = aLow * bLow - (((product - aHigh * bHigh) - aLow * bHigh) - aHigh * bLow);
    return product;
  }

 private:
  struct Halves {
    double high;
    double low;
  };
  static Halves split(double a) {
    constexpr double kSplitter = 134217729.0;  // 2^27 + 1: halves a 53-bit mantissa
    const double c = kSplitter * a;
    const double high = c - (c - a);
    return {high, a - high};
  }

  std::array<double, Capacity> terms_;
  std::size_t size_ = 0;
};

inline Expansion<2> exactDifference(double a, double b) {
  Expansion<2> result;
  result.add(a);
  result.add(-b);
  return result;
}

template <std::size_t A, std::size_t B>
Expansion<2 * A * B> exactProduct(const Expansion<A>& a, const Expansion<B>& b) {
  Expansion<2 * A * B> result;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      double error;
      const double product = Expansion<1>::twoProduct(a[i], b[j], error);
      result.add(error);
      result.add(product);
    }
  }
  return result;
}

template <std::size_t A>
Expansion<A> negated(const Expansion<A>& a) {
  Expansion<A> result;
  for (std::size_t i = 0; i < a.size(); ++i) result.add(-a[i]);
  return result;
}

template <std::size_t A, std::size_t B>
Expansion<A + B> exactSum(const Expansion<A>& a, const Expansion<B>& b) {
  Expansion<A + B> result;
  result.add(a);
  result.add(b);
  return result;
}

}  // namespace explica::geometry
