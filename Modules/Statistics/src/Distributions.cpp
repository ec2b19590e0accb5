// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/Distributions.h"

#include "Explica/Core/Types.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/complement.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

#include <cmath>

namespace explica::statistics {
namespace {

using boost::math::complement;

bool usable(double value, double df) {
  return !std::isnan(value) && df > 0;
}

}  // namespace

double tTail(double t, double df) {
  if (!usable(t, df)) return kNaN;
  if (std::isinf(t)) return t > 0 ? 0 : 1;
  if (std::isinf(df)) return boost::math::cdf(complement(boost::math::normal(), t));
  return boost::math::cdf(complement(boost::math::students_t(df), t));
}

double tTwoSided(double t, double df) {
  return 2 * tTail(std::abs(t), df);
}

double tQuantile(double tail, double df) {
  if (!usable(tail, df)) return kNaN;
  if (std::isinf(df)) return boost::math::quantile(complement(boost::math::normal(), tail));
  return boost::math::quantile(complement(boost::math::students_t(df), tail));
}

double fTail(double f, double df1, double df2) {
  if (!usable(f, df1) || !usable(f, df2)) return kNaN;
  if (f <= 0) return 1;
  if (std::isinf(f)) return 0;
  if (std::isinf(df2)) return boost::math::cdf(complement(boost::math::chi_squared(df1), f * df1));
  return boost::math::cdf(complement(boost::math::fisher_f(df1, df2), f));
}

double fQuantile(double tail, double df1, double df2) {
  if (!usable(tail, df1) || !usable(tail, df2)) return kNaN;
  if (std::isinf(df2)) {
    return boost::math::quantile(complement(boost::math::chi_squared(df1), tail)) / df1;
  }
  return boost::math::quantile(complement(boost::math::fisher_f(df1, df2), tail));
}

}  // namespace explica::statistics
