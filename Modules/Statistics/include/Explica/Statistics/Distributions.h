// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace explica::statistics {

/// Upper tail P(T > t) of Student's t; infinite df is the normal distribution.  NaN of NaN, and of
/// df not above 0.
[[nodiscard]] double tTail(double t, double df);

/// P(|T| > |t|).
[[nodiscard]] double tTwoSided(double t, double df);

/// The t whose upper tail is `tail`, in (0, 1).
[[nodiscard]] double tQuantile(double tail, double df);

/// Upper tail of F with `df1` and `df2` degrees of freedom; infinite df2 is chi-squared over df1.
[[nodiscard]] double fTail(double f, double df1, double df2);

/// The F whose upper tail is `tail`, in (0, 1).
[[nodiscard]] double fQuantile(double tail, double df1, double df2);

}  // namespace explica::statistics
