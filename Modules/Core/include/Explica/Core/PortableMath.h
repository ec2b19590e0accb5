// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Elementary functions with the same last digit on every processor.  The C library computes its
/// own with fused multiply-add where there is one, and rounds otherwise on older processors: a
/// descent of thousands of steps carries that to all digits of its path.  These are sums and
/// products of IEEE arithmetic in one order, within 2 units in the last place of the truth
/// (expm1: 3), sine and cosine of angles up to 1e6.  Infinities, not-a-number and zeros are as in
/// the C library.
namespace explica::portable {

[[nodiscard]] double log(double x);
[[nodiscard]] double log1p(double x);
[[nodiscard]] double exp(double x);
[[nodiscard]] double expm1(double x);
[[nodiscard]] double sin(double x);
[[nodiscard]] double cos(double x);
[[nodiscard]] double atan2(double y, double x);
[[nodiscard]] double acos(double x);

/// Eigen cuts products of matrices into blocks that suit the processor's caches and adds up block
/// by block, so that their last digits hang on it; after this call they suit caches of one size, in
/// the whole program.
void fixBlocksOfProducts();

}  // namespace explica::portable
