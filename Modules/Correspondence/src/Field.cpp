// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Field.h"

#include "CornerExtension.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace explica::correspondence {
namespace {

// Slope (change of u per voxel) below which a trajectory's direction is round-off.
constexpr double kFlat = 1e-9;

}  // namespace

TrajectoryTracer::Field::Field(const harmonic::Annulus& a, const harmonic::Interpolant& i,
                               const TraceOptions& o)
    : annulus(a), interpolant(i), options(o) {
  flat = annulus.planar;
  const Vector& h = annulus.grid.spacing;
  finest = flat ? std::min(h[0], h[1]) : h.minCoeff();
  inverseSpacing = h.cwiseInverse();
  std::vector<std::uint8_t> cut(annulus.count(), 0);
  const auto strides = annulus.strides();
  parallelFor(annulus.count(), 1 << 14, [&](std::size_t n) {
    if (annulus.irregular(static_cast<std::int32_t>(n)) < 0) return;
    for (int d = 0; d < 6; ++d) {
      const std::int32_t q = annulus.place[n] + harmonic::signOf(d) * strides[harmonic::axisOf(d)];
      if (annulus.links[n][d] < 0 && annulus.numberAt[q] >= 0) cut[n] = 1;
    }
  });
  if (std::find(cut.begin(), cut.end(), 1) != cut.end()) onCut = std::move(cut);
  rankTissue();
  prepareCells();
  view_.cellAt = cellAt_.data();
  view_.rankAt = rankAt.data();
  view_.node = node.data()->data();
  view_.cells = cells_.data()->corner.data()->data();
  view_.size = annulus.size;
  view_.inverseSpacing = {inverseSpacing[0], inverseSpacing[1], flat ? 0 : inverseSpacing[2]};
  view_.leastSlope = kFlat / finest;
  view_.planar = flat;
  view_.field = this;
  view_.odd = [](const void* field, const double* x, std::int32_t home) {
    const Sample sample = static_cast<const Field*>(field)->sample(Vector(x[0], x[1], x[2]), home);
    FieldView::Odd odd;
    for (int c = 0; c < 3; ++c) odd.value[c] = static_cast<float>(sample.gradient[c]);
    odd.u = sample.u;
    odd.home = sample.home;
    odd.divided = sample.divided;
    return odd;
  };
}

void TrajectoryTracer::Field::rankTissue() {
  const std::size_t sliceSize = annulus.strides()[2];
  const std::size_t slices = annulus.size[2];
  std::vector<std::int32_t> start(slices + 1, 0);
  parallelFor(slices, 1, [&](std::size_t k) {
    for (std::size_t p = k * sliceSize; p < (k + 1) * sliceSize; ++p) {
      start[k + 1] += annulus.numberAt[p] >= 0;
    }
  });
  for (std::size_t k = 0; k < slices; ++k) start[k + 1] += start[k];
  rankAt.resize(annulus.numberAt.size());
  placeOf.resize(annulus.count());
  node.resize(annulus.count());
  const Eigen::Array3f h = annulus.grid.spacing.cast<float>();
  parallelFor(slices, 1, [&](std::size_t k) {
    std::int32_t rank = start[k];
    for (std::size_t p = k * sliceSize; p < (k + 1) * sliceSize; ++p) {
      const std::int32_t n = annulus.numberAt[p];
      rankAt[p] = n >= 0 ? rank : -1;
      if (n < 0) continue;
      placeOf[rank] = static_cast<std::int32_t>(p);
      node[rank].head<3>() = interpolant.gradient[n].array() * h;
      node[rank][3] = static_cast<float>(interpolant.u[n]);
      ++rank;
    }
  });
}

namespace {

/// For each set of a cell's corners, a bit each: whether its edges join them all.
constexpr std::array<bool, 256> kHangTogether = [] {
  constexpr std::array<unsigned, 3> kLower = {0x55, 0x33, 0x0f};  // corners at an axis' lower end
  std::array<bool, 256> together{};
  for (unsigned corners = 1; corners < 256; ++corners) {
    unsigned reached = corners & (~corners + 1);
    for (unsigned before = 0; before != reached;) {
      before = reached;
      for (int a = 0; a < 3; ++a) {
        reached |=
            ((reached & kLower[a]) << (1 << a) | (reached >> (1 << a) & kLower[a])) & corners;
      }
    }
    together[corners] = reached == corners;
  }
  return together;
}();

/// Whether uncut links along a cell's edges join all its corners that are tissue.
bool hangTogether(const harmonic::Annulus& annulus, const std::int32_t* number, int corners) {
  const int axes = corners == 4 ? 2 : 3;
  unsigned tissue = 0;
  for (int c = 0; c < corners; ++c) tissue |= static_cast<unsigned>(number[c] >= 0) << c;
  unsigned reached = tissue & (~tissue + 1);
  for (unsigned before = 0; before != reached;) {
    before = reached;
    for (int c = 0; c < corners; ++c) {
      if (!(reached >> c & 1)) continue;
      for (int a = 0; a < axes; ++a) {
        const int other = c ^ (1 << a), d = 2 * a + ((c >> a & 1) ? 0 : 1);
        const bool joined = number[other] >= 0 && annulus.links[number[c]][d] == number[other];
        reached |= static_cast<unsigned>(joined) << other;
      }
    }
  }
  return reached == tissue;
}

}  // namespace

void TrajectoryTracer::Field::prepareCells() {
  const auto strides = annulus.strides();
  const int corners = flat ? 4 : 8;
  const std::size_t sliceSize = strides[2];
  const int slices = annulus.size[2];
  cellAt_.assign(annulus.numberAt.size(), kEmpty);
  std::vector<std::int32_t> start(slices + 1, 0);
  const auto numbersOf = [&](std::size_t p, std::int32_t* number) {
    for (int c = 0; c < corners; ++c) {
      number[c] = annulus.numberAt[p + (c & 1) + (c >> 1 & 1) * strides[1] + (c >> 2) * strides[2]];
    }
  };
  // Which corners of the cells with this voxel as a lower one are tissue, of those at the first
  // axis' lower end: a bit each.
  const auto lowerEnd = [&](std::size_t p) {
    unsigned tissue = 0;
    for (int c = 0; c < corners; c += 2) {
      const std::size_t q = p + (c >> 1 & 1) * strides[1] + (c >> 2) * strides[2];
      tissue |= static_cast<unsigned>(annulus.numberAt[q] >= 0) << c;
    }
    return tissue;
  };
  const auto forCells = [&](int k, const auto& body) {
    if (!flat && k + 1 >= slices) return;
    for (int j = 0; j + 1 < annulus.size[1]; ++j) {
      std::size_t p = static_cast<std::size_t>(j) * strides[1] + k * sliceSize;
      unsigned here = lowerEnd(p);
      for (int i = 0; i + 1 < annulus.size[0]; ++i, ++p) {
        const unsigned next = lowerEnd(p + 1);
        if ((here | next) != 0) body(p, here | next << 1);
        here = next;
      }
    }
  };
  const auto kindOf = [&](std::size_t p, unsigned tissue, std::int32_t& count) -> std::int32_t {
    std::int32_t number[8];
    bool cut = false;
    if (!onCut.empty()) {
      numbersOf(p, number);
      for (int c = 0; c < corners; ++c) cut = cut || (number[c] >= 0 && onCut[number[c]]);
    }
    if (!cut && tissue == (1U << corners) - 1) return kWhole;
    const bool one = cut ? hangTogether(annulus, number, corners) : kHangTogether[tissue];
    return one ? count++ : static_cast<std::int32_t>(kDivided);
  };
  parallelFor(slices, 1, [&](std::size_t k) {
    forCells(static_cast<int>(k),
             [&](std::size_t p, unsigned tissue) { cellAt_[p] = kindOf(p, tissue, start[k + 1]); });
  });
  for (int k = 0; k < slices; ++k) start[k + 1] += start[k];
  cells_.resize(start[slices]);
  parallelFor(slices, 1, [&](std::size_t k) {
    forCells(static_cast<int>(k), [&](std::size_t p, unsigned tissue) {
      if (cellAt_[p] < 0) return;
      cellAt_[p] += start[k];
      std::int32_t number[8] = {};
      numbersOf(p, number);
      extend(number, std::countr_zero(tissue), cells_[cellAt_[p]].corner.data());
    });
  });
  prepareSides();
}

void TrajectoryTracer::Field::prepareSides() {
  const auto strides = annulus.strides();
  const int corners = flat ? 4 : 8;
  std::vector<std::int32_t> divided;
  for (std::size_t p = 0; p < cellAt_.size(); ++p) {
    if (cellAt_[p] != kDivided) continue;
    cellAt_[p] = kDivided - static_cast<std::int32_t>(divided.size());
    divided.push_back(static_cast<std::int32_t>(p));
  }
  std::vector<std::vector<Side>> sidesOf(divided.size());
  parallelFor(divided.size(), 256, [&](std::size_t n) {
    std::int32_t number[8] = {};
    unsigned left = 0;
    for (int c = 0; c < corners; ++c) {
      number[c] =
          annulus
              .numberAt[divided[n] + (c & 1) + (c >> 1 & 1) * strides[1] + (c >> 2) * strides[2]];
      left |= number[c] >= 0 ? 1U << c : 0U;
    }
    while (left != 0) {
      Side& side = sidesOf[n].emplace_back();
      side.corners = extend(number, std::countr_zero(left), side.cell.corner.data());
      left &= ~static_cast<unsigned>(side.corners);
    }
  });
  firstSide_.assign(1, 0);
  for (const std::vector<Side>& ofCell : sidesOf) {
    sides_.insert(sides_.end(), ofCell.begin(), ofCell.end());
    firstSide_.push_back(static_cast<std::int32_t>(sides_.size()));
  }
}

TrajectoryTracer::Field::Sample TrajectoryTracer::Field::sample(const Vector& x,
                                                                std::int32_t home) const {
  std::array<int, 3> base{};
  float f[3];
  for (int a = 0; a < 3; ++a) {
    base[a] = std::clamp(static_cast<int>(x[a]), 0, annulus.size[a] - 2);
    f[a] = static_cast<float>(x[a] - base[a]);
  }
  const auto strides = annulus.strides();
  std::int32_t upper = strides[2];
  if (flat) {
    base[2] = static_cast<int>(std::lround(x[2]));
    f[2] = 0;
    upper = 0;
  }
  const std::int32_t p = base[0] + base[1] * strides[1] + base[2] * strides[2];
  const auto offset = [&](int c) { return (c & 1) + (c >> 1 & 1) * strides[1] + (c >> 2) * upper; };
  const std::int32_t cell = cellAt_[p];
  Sample result;
  if (cell == kEmpty) return result;

  const Corner* corner[8];
  const int nearest = (f[0] > 0.5F ? 1 : 0) + (f[1] > 0.5F ? 2 : 0) + (f[2] > 0.5F ? 4 : 0);
  if (cell == kWhole) {
    for (int c = 0; c < 8; c += 2) {
      corner[c] = &node[rankAt[p + offset(c)]];
      corner[c + 1] = corner[c] + 1;  // ranks follow each other along a row
    }
    result.home = annulus.numberAt[p + offset(nearest)];
  } else if (cell >= 0) {
    for (int c = 0; c < 8; ++c) corner[c] = &cells_[cell].corner[flat ? c & 3 : c];
    result.home = annulus.numberAt[p + offset(nearest)];
    for (int c = 0; result.home < 0; ++c) result.home = annulus.numberAt[p + offset(c)];
  } else {
    std::int32_t number[8];
    float weight[8];
    int seed = -1;
    const int corners = flat ? 4 : 8;
    for (int c = 0; c < corners; ++c) {
      number[c] = annulus.numberAt[p + offset(c)];
      weight[c] = 1;
      for (int a = 0; a < 3; ++a) weight[c] *= (c >> a & 1) ? f[a] : 1 - f[a];
      if (number[c] >= 0 && number[c] == home) seed = c;
    }
    for (int c = 0; seed < 0 && c < corners; ++c) {
      if (number[c] >= 0) seed = c;
    }
    if (number[seed] != home) {
      for (int c = 0; c < corners; ++c) {
        if (number[c] >= 0 && weight[c] > weight[seed]) seed = c;
      }
    }
    std::int32_t side = firstSide_[kDivided - cell];
    while (!(sides_[side].corners >> seed & 1)) ++side;
    float best = -1;
    for (int c = 0; c < 8; ++c) {
      corner[c] = &sides_[side].cell.corner[flat ? c & 3 : c];
      if (c < corners && (sides_[side].corners >> c & 1) && weight[c] > best) {
        best = weight[c];
        result.home = number[c];
      }
    }
    result.divided = true;
  }

  // Trilinear in gradient and u; then u's half-Taylor term, which turns each axis' linear error
  // f (1 - f) / 2 times the difference of slopes into one of third order.
  Corner edge[4], bendX[4];
  for (int j = 0; j < 4; ++j) {
    bendX[j] = *corner[2 * j + 1] - *corner[2 * j];
    edge[j] = *corner[2 * j] + f[0] * bendX[j];
  }
  const Corner bendY[2] = {edge[1] - edge[0], edge[3] - edge[2]};
  const Corner face[2] = {edge[0] + f[1] * bendY[0], edge[2] + f[1] * bendY[1]};
  const Corner bendZ = face[1] - face[0];
  const Corner value = face[0] + f[2] * bendZ;
  result.gradient = value.head<3>().matrix().cast<double>();
  const float lowX = bendX[0][0] + f[1] * (bendX[1][0] - bendX[0][0]);
  const float highX = bendX[2][0] + f[1] * (bendX[3][0] - bendX[2][0]);
  const float bend = f[0] * (1 - f[0]) * (lowX + f[2] * (highX - lowX)) +
                     f[1] * (1 - f[1]) * (bendY[0][1] + f[2] * (bendY[1][1] - bendY[0][1])) +
                     f[2] * (1 - f[2]) * bendZ[2];
  result.u = static_cast<double>(value[3]) - 0.5 * static_cast<double>(bend);
  return result;
}

std::uint8_t TrajectoryTracer::Field::extend(const std::int32_t* number, int seed,
                                             Corner* corner) const {
  CornerExtension extension(annulus, interpolant, number, flat);
  extension.reachFrom(seed);
  extension.extendAlongAxes();
  extension.extendAcrossFaces();
  extension.extendLinearly();
  return extension.write(corner);
}

}  // namespace explica::correspondence
