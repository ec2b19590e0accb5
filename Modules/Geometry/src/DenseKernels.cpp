// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "DenseKernels.h"

#include <algorithm>
#include <cmath>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "DenseKernels.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#ifndef EXPLICA_GEOMETRY_DENSE_SIZES
#define EXPLICA_GEOMETRY_DENSE_SIZES
namespace explica::geometry::kernels {

constexpr std::ptrdiff_t kTileRows = 16;    // of a tile whose entries are summed in registers
constexpr std::ptrdiff_t kTileColumns = 6;  // such that most instruction sets have enough of them
constexpr std::ptrdiff_t kMostDepth = 96;   // products of an entry between two of its loads
constexpr std::ptrdiff_t kMostRight = 192;  // columns of a target that are packed at a time

/// Columns of a target and depths that are worked on at a time.
struct Slab {
  std::ptrdiff_t firstDepth, depth, firstColumn, columns;
};

}  // namespace explica::geometry::kernels
#endif

HWY_BEFORE_NAMESPACE();
namespace explica::geometry::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, 8>;
using V = hn::Vec<Tag>;

/// target (kTileRows x kTileColumns) -= left * right^T, both packed depth by depth.
template <std::ptrdiff_t kVectors>
HWY_INLINE void SubtractTile(const double* HWY_RESTRICT left, const double* HWY_RESTRICT right,
                             std::ptrdiff_t depth, double* HWY_RESTRICT target,
                             std::ptrdiff_t stride) {
  const Tag d;
  const auto width = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  V sum[kTileColumns][kVectors];
  for (std::ptrdiff_t j = 0; j < kTileColumns; ++j) {
    for (std::ptrdiff_t v = 0; v < kVectors; ++v) {
      sum[j][v] = hn::LoadU(d, target + j * stride + v * width);
    }
  }
  for (std::ptrdiff_t k = 0; k < depth; ++k) {
    V a[kVectors];
    for (std::ptrdiff_t v = 0; v < kVectors; ++v) {
      a[v] = hn::Load(d, left + k * kTileRows + v * width);
    }
    for (std::ptrdiff_t j = 0; j < kTileColumns; ++j) {
      const V b = hn::Set(d, right[k * kTileColumns + j]);
      for (std::ptrdiff_t v = 0; v < kVectors; ++v) {
        sum[j][v] = hn::Sub(sum[j][v], hn::Mul(a[v], b));
      }
    }
  }
  for (std::ptrdiff_t j = 0; j < kTileColumns; ++j) {
    for (std::ptrdiff_t v = 0; v < kVectors; ++v) {
      hn::StoreU(sum[j][v], d, target + j * stride + v * width);
    }
  }
}

/// The tile in strips of as many rows as registers allow.
HWY_INLINE void SubtractStrips(const double* HWY_RESTRICT left, const double* HWY_RESTRICT right,
                               std::ptrdiff_t depth, double* HWY_RESTRICT target,
                               std::ptrdiff_t stride) {
  const Tag d;
  const auto width = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  for (std::ptrdiff_t row = 0; row < kTileRows; row += 2 * width) {
    SubtractTile<2>(left + row, right, depth, target + row, stride);
  }
}

void SubtractSlab(const DenseBlock& left, const DenseBlock& right, const DenseBlock& target,
                  std::ptrdiff_t below, const Slab& slab, double* packedRight) {
  const auto [firstDepth, depth, firstColumn, columns] = slab;
  HWY_ALIGN double packedLeft[kTileRows * kMostDepth];
  HWY_ALIGN double tile[kTileRows * kTileColumns];
  for (std::ptrdiff_t j = 0; j < columns; j += kTileColumns) {
    const std::ptrdiff_t count = std::min(kTileColumns, columns - j);
    for (std::ptrdiff_t k = 0; k < depth; ++k) {
      const double* from = right.at(firstColumn + j, firstDepth + k);
      double* to = packedRight + j * depth + k * kTileColumns;
      for (std::ptrdiff_t n = 0; n < kTileColumns; ++n) to[n] = n < count ? from[n] : 0;
    }
  }
  for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(0, firstColumn - below); i < target.rows;
       i += kTileRows) {
    const std::ptrdiff_t rows = std::min(kTileRows, target.rows - i);
    for (std::ptrdiff_t k = 0; k < depth; ++k) {
      const double* from = left.at(i, firstDepth + k);
      double* to = packedLeft + k * kTileRows;
      if (rows == kTileRows) {
        std::copy_n(from, kTileRows, to);
      } else {
        for (std::ptrdiff_t n = 0; n < kTileRows; ++n) to[n] = n < rows ? from[n] : 0;
      }
    }
    const std::ptrdiff_t end = std::min(columns, i + rows + below - firstColumn);
    for (std::ptrdiff_t j = 0; j < end; j += kTileColumns) {
      const std::ptrdiff_t count = std::min(kTileColumns, columns - j);
      double* to = target.at(i, firstColumn + j);
      const double* packed = packedRight + j * depth;
      if (rows == kTileRows && count == kTileColumns) {
        SubtractStrips(packedLeft, packed, depth, to, target.stride);
        continue;
      }
      for (std::ptrdiff_t n = 0; n < count; ++n) {
        std::copy_n(to + n * target.stride, rows, tile + n * kTileRows);
      }
      SubtractStrips(packedLeft, packed, depth, tile, kTileRows);
      for (std::ptrdiff_t n = 0; n < count; ++n) {
        std::copy_n(tile + n * kTileRows, rows, to + n * target.stride);
      }
    }
  }
}

void SubtractProduct(const DenseBlock& left, const DenseBlock& right, const DenseBlock& target,
                     std::ptrdiff_t below, double* packedRight) {
  for (std::ptrdiff_t k = 0; k < left.columns; k += kMostDepth) {
    for (std::ptrdiff_t j = 0; j < target.columns; j += kMostRight) {
      SubtractSlab(
          left, right, target, below,
          {k, std::min(kMostDepth, left.columns - k), j, std::min(kMostRight, target.columns - j)},
          packedRight);
    }
  }
}

void SolveBelow(const DenseBlock& corner, const DenseBlock& below) {
  const Tag d;
  const auto width = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  HWY_ALIGN double strip[8];
  const auto solveStrip = [&](std::ptrdiff_t row, std::ptrdiff_t count) HWY_ATTR {
    V x[kMostColumns];
    for (std::ptrdiff_t c = 0; c < corner.columns; ++c) {
      double* at = below.at(row, c);
      if (count == width) {
        x[c] = hn::LoadU(d, at);
      } else {
        for (std::ptrdiff_t n = 0; n < width; ++n) strip[n] = n < count ? at[n] : 0;
        x[c] = hn::Load(d, strip);
      }
      for (std::ptrdiff_t k = 0; k < c; ++k) {
        x[c] = hn::Sub(x[c], hn::Mul(x[k], hn::Set(d, *corner.at(c, k))));
      }
      x[c] = hn::Div(x[c], hn::Set(d, *corner.at(c, c)));
      if (count == width) {
        hn::StoreU(x[c], d, at);
      } else {
        hn::Store(x[c], d, strip);
        std::copy_n(strip, count, at);
      }
    }
  };
  for (std::ptrdiff_t row = 0; row < below.rows; row += width) {
    solveStrip(row, std::min(width, below.rows - row));
  }
}

}  // namespace explica::geometry::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace explica::geometry::kernels {

HWY_EXPORT(SubtractProduct);
HWY_EXPORT(SolveBelow);

bool factoriseCorner(const DenseBlock& corner) {
  for (std::ptrdiff_t c = 0; c < corner.columns; ++c) {
    const double pivot = *corner.at(c, c);
    if (!(pivot > 0) || !std::isfinite(pivot)) return false;
    const double diagonal = std::sqrt(pivot);
    *corner.at(c, c) = diagonal;
    for (std::ptrdiff_t i = c + 1; i < corner.columns; ++i) *corner.at(i, c) /= diagonal;
    for (std::ptrdiff_t j = c + 1; j < corner.columns; ++j) {
      const double factor = *corner.at(j, c);
      for (std::ptrdiff_t i = j; i < corner.columns; ++i) {
        *corner.at(i, j) -= factor * *corner.at(i, c);
      }
    }
  }
  return true;
}

void solveBelow(const DenseBlock& corner, const DenseBlock& below) {
  HWY_DYNAMIC_DISPATCH(SolveBelow)(corner, below);
}

void subtractProduct(const DenseBlock& left, const DenseBlock& right, const DenseBlock& target,
                     std::ptrdiff_t below) {
  thread_local std::vector<double> packedRight(kMostRight * kMostDepth);
  HWY_DYNAMIC_DISPATCH(SubtractProduct)(left, right, target, below, packedRight.data());
}

}  // namespace explica::geometry::kernels
#endif  // HWY_ONCE
