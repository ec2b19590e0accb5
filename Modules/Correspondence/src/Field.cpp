// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Field.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace explica::correspondence {

using harmonic::kInner;
using harmonic::kInsulated;
using harmonic::kOuter;

namespace {

// Slope (change of u per voxel) below which a trajectory's direction is round-off.
constexpr double kFlat = 1e-9;
// A walk may not be longer than this many voxels per step taken on average: it circles.
constexpr double kTinyStep = 1e-6;
// Nearer than this (in voxels) a wall's one-sided slope is round-off.
constexpr double kTooClose = 0.02;
// A step ends beyond the boundary by about this share of its length plus this many voxels.
constexpr double kPastTarget = 1.1, kBeyondTarget = 0.02;
// A step whose gain in u is below this share of |grad u| ds is inconsistent; the boundary is near
// within this many voxels; and a walk may have so many such steps.
constexpr double kEnough = 1e-5;  // voxels from the boundary at which a walk has arrived
constexpr double kPoorGain = 0.25;
constexpr double kNearEnd = 1.5;
constexpr int kStrikes = 8;
// Hops of a walk from voxel to voxel, and the least that u gains by one: less is round-off.
constexpr int kMostHops = 64;
constexpr double kLeastGain = 1e-7;

/// Where in (0, 1) the cubic with values and slopes f0 < 0, g0 and f1 > 0, g1 at 0 and 1 is zero,
/// by Newton steps from the chord's crossing; that crossing if they leave the interval.
double crossingOf(double f0, double g0, double f1, double g1) {
  const double chord = f0 / (f0 - f1);
  const double c = g0, d = 3 * (f1 - f0) - 2 * g0 - g1, e = 2 * (f0 - f1) + g0 + g1;
  double t = chord;
  for (int k = 0; k < 3; ++k) {
    t -= (f0 + t * (c + t * (d + t * e))) / (c + t * (2 * d + 3 * t * e));
    if (!(t > 0 && t < 1)) return chord;
  }
  return t;
}

Vector vectorOf(const Lanes& lanes, int lane) {
  return {lanes[0][lane], lanes[1][lane], lanes[2][lane]};
}

}  // namespace

TrajectoryTracer::Field::Field(const harmonic::Annulus& a, const harmonic::Interpolant& i,
                               const TraceOptions& o)
    : annulus(a), interpolant(i), options(o) {
  flat = annulus.planar;
  const Vector& h = annulus.grid.spacing;
  finest = flat ? std::min(h[0], h[1]) : h.minCoeff();
  inverseSpacing = h.cwiseInverse();
  options.maxStep = std::min(options.maxStep, 1.0);
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

Vector TrajectoryTracer::Field::toBox(const Point& world) const {
  const Vector index = annulus.grid.toIndex(world);
  return index - Vector(annulus.first[0], annulus.first[1], annulus.first[2]);
}

Point TrajectoryTracer::Field::toWorld(const Vector& x) const {
  return annulus.grid.toWorld(x + Vector(annulus.first[0], annulus.first[1], annulus.first[2]));
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

inline Vector TrajectoryTracer::Field::velocityOf(const Sample& sample, int uphill,
                                                  double* slope) const {
  // G per voxel is (per mm) * spacing; T = grad / |grad| in mm, then per voxel again.
  Vector perMm = sample.gradient.cwiseProduct(inverseSpacing);
  if (flat) perMm[2] = 0;
  const double norm = perMm.norm();
  if (slope != nullptr) *slope = norm;
  if (!(norm * finest > kFlat)) return Vector::Zero();
  return (uphill / norm) * perMm.cwiseProduct(inverseSpacing);
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

namespace {

/// Corners of a cell while they are extended from the ones that one side of it has: u, and its
/// gradient per voxel.
class CornerExtension {
 public:
  CornerExtension(const harmonic::Annulus& annulus, const harmonic::Interpolant& interpolant,
                  const std::int32_t* number, bool flat)
      : annulus_(annulus),
        interpolant_(interpolant),
        number_(number),
        axes_(flat ? 2 : 3),
        corners_(flat ? 4 : 8) {}

  void reachFrom(int seed);
  void extendAlongAxes();
  void extendAcrossFaces();
  void extendLinearly();
  /// u and gradient of each corner; the corners that the seed reaches, one bit each.
  std::uint8_t write(Eigen::Array4f* corner) const;

 private:
  enum State : std::uint8_t { kUnknown, kReached, kExtended };
  /// Estimates of one corner, added up.
  struct Estimates {
    double u = 0;
    Vector slope = Vector::Zero();
    int count = 0;
  };

  /// +1 if the corner lies at the upper end of the axis, else -1.
  static int sideOf(int corner, int axis) { return (corner >> axis & 1) != 0 ? 1 : -1; }
  /// The direction along an axis that leads from a corner to the one opposite.
  static int directionFrom(int corner, int axis) {
    return 2 * axis + (sideOf(corner, axis) > 0 ? 0 : 1);
  }
  [[nodiscard]] Vector gradientAt(std::int32_t voxel) const {
    return interpolant_.gradient[voxel].cast<double>().cwiseProduct(annulus_.grid.spacing);
  }
  void addAlong(int from, int axis, Estimates& sum) const;
  void addAcross(int corner, int a, int b, Estimates& sum) const;
  void take(int corner, const Estimates& sum);
  void settle();

  const harmonic::Annulus& annulus_;
  const harmonic::Interpolant& interpolant_;
  const std::int32_t* number_;
  int axes_, corners_;
  std::array<State, 8> state_{};
  std::array<double, 8> u_;
  std::array<Vector, 8> g_;
  std::array<int, 8> extended_;
  int extensions_ = 0;
};

void CornerExtension::reachFrom(int seed) {
  std::array<int, 8> stack;
  int depth = 0;
  const auto reach = [&](int c) {
    state_[c] = kReached;
    u_[c] = interpolant_.u[number_[c]];
    g_[c] = gradientAt(number_[c]);
    stack[depth++] = c;
  };
  reach(seed);
  while (depth > 0) {
    const int c = stack[--depth];
    for (int a = 0; a < axes_; ++a) {
      const int other = c ^ (1 << a);
      if (state_[other] == kUnknown && number_[other] >= 0 &&
          annulus_.links[number_[c]][directionFrom(c, a)] == number_[other]) {
        reach(other);
      }
    }
  }
}

void CornerExtension::take(int corner, const Estimates& sum) {
  if (sum.count == 0) return;
  u_[corner] = sum.u / sum.count;
  g_[corner] = sum.slope / sum.count;
  extended_[extensions_++] = corner;
}

/// What one pass has extended counts from the next pass on.
void CornerExtension::settle() {
  while (extensions_ > 0) state_[extended_[--extensions_]] = kExtended;
}

/// The parabola through the voxel, the boundary on this link and what is behind.
void CornerExtension::addAlong(int from, int axis, Estimates& sum) const {
  const std::int32_t n = number_[from];
  const int d = directionFrom(from, axis);
  const int back = harmonic::opposite(d);
  const auto& links = annulus_.links[n];
  Vector slope = g_[from];
  ++sum.count;
  if (links[d] == kInsulated) {
    slope[axis] = -slope[axis];
    sum.u += u_[from];
    sum.slope += slope;
    return;
  }
  const auto& fractions = annulus_.fractions[annulus_.irregular(n)];
  const double sign = harmonic::signOf(d);
  const double wall = links[d] == kInner ? 0.0 : 1.0;
  const double theta = fractions[d], behind = fractions[back];
  const double outward = sign * g_[from][axis];
  double backSlope = 0;  // an insulated voxel behind mirrors this one
  if (links[back] >= 0) {
    backSlope = u_[from] - interpolant_.u[links[back]];
  } else if (links[back] != kInsulated) {
    backSlope = (u_[from] - (links[back] == kInner ? 0.0 : 1.0)) / behind;
  }
  const double second = theta < kTooClose
                            ? 2 * (outward - backSlope) / behind
                            : 2 * ((wall - u_[from]) / theta - backSlope) / (theta + behind);
  sum.u += u_[from] + outward + 0.5 * second;
  if (links[back] >= 0) slope += g_[from] - gradientAt(links[back]);
  slope[axis] = sign * (outward + second);
  sum.slope += slope;
}

void CornerExtension::extendAlongAxes() {
  for (int c = 0; c < corners_; ++c) {
    if (state_[c] == kReached) continue;
    Estimates sum;
    for (int a = 0; a < axes_; ++a) {
      if (state_[c ^ (1 << a)] == kReached) addAlong(c ^ (1 << a), a, sum);
    }
    take(c, sum);
  }
  settle();
}

/// Gradients add up as in a parallelogram.
void CornerExtension::addAcross(int corner, int a, int b, Estimates& sum) const {
  const int p = corner ^ (1 << a), q = corner ^ (1 << b), r = p ^ (1 << b);
  if (state_[p] == kUnknown || state_[q] == kUnknown || state_[r] == kUnknown) return;
  const Vector slope = g_[p] + g_[q] - g_[r];
  const double sideA = sideOf(corner, a), sideB = sideOf(corner, b);
  sum.u += 0.5 * (u_[p] + sideA * 0.5 * (g_[p][a] + slope[a]) + u_[q] +
                  sideB * 0.5 * (g_[q][b] + slope[b]));
  sum.slope += slope;
  ++sum.count;
}

/// Across the cell's faces, then across the cell.
void CornerExtension::extendAcrossFaces() {
  for (int pass = 0; pass < 2; ++pass) {
    for (int c = 0; c < corners_; ++c) {
      if (state_[c] != kUnknown) continue;
      Estimates sum;
      for (int a = 0; a < axes_; ++a) {
        for (int b = a + 1; b < axes_; ++b) addAcross(c, a, b, sum);
      }
      take(c, sum);
    }
    settle();
  }
}

void CornerExtension::extendLinearly() {
  for (int pass = 0; pass < 3; ++pass) {
    for (int c = 0; c < corners_; ++c) {
      for (int a = 0; a < axes_ && state_[c] == kUnknown; ++a) {
        const int p = c ^ (1 << a);
        if (state_[p] == kUnknown) continue;
        g_[c] = g_[p];
        u_[c] = u_[p] + sideOf(c, a) * g_[p][a];
        state_[c] = kExtended;
      }
    }
  }
}

std::uint8_t CornerExtension::write(Eigen::Array4f* corner) const {
  std::uint8_t reached = 0;
  for (int c = 0; c < corners_; ++c) {
    corner[c].head<3>() = g_[c].cast<float>().array();
    corner[c][3] = static_cast<float>(u_[c]);
    if (state_[c] == kReached) reached |= static_cast<std::uint8_t>(1U << c);
  }
  return reached;
}

}  // namespace

std::uint8_t TrajectoryTracer::Field::extend(const std::int32_t* number, int seed,
                                             Corner* corner) const {
  CornerExtension extension(annulus, interpolant, number, flat);
  extension.reachFrom(seed);
  extension.extendAlongAxes();
  extension.extendAcrossFaces();
  extension.extendLinearly();
  return extension.write(corner);
}

TrajectoryTracer::Field::Walk TrajectoryTracer::Field::begin(const Vector& x, std::int32_t home,
                                                             int uphill) const {
  Walk walk;
  walk.x = x;
  const Sample here = sample(x, home);
  walk.home = here.home;
  walk.u = here.u;
  walk.velocity = velocityOf(here, uphill, &walk.slope);
  walk.divided = here.divided;
  walk.step = options.maxStep * finest;
  walk.stuck = here.home < 0 || walk.velocity.isZero(0);
  return walk;
}

TrajectoryTracer::Field::Walk TrajectoryTracer::Field::begin(std::int32_t place, int uphill) const {
  const std::int32_t row = place / annulus.size[0], slice = row / annulus.size[1];
  Walk walk;
  walk.x = Vector(place % annulus.size[0], row % annulus.size[1], slice);
  walk.home = annulus.numberAt[place];
  const Corner& here = node[rankAt[place]];
  walk.u = here[3];
  Sample sample;
  sample.gradient = here.head<3>().matrix().cast<double>();
  walk.velocity = velocityOf(sample, uphill, &walk.slope);
  walk.step = options.maxStep * finest;
  walk.stuck = walk.velocity.isZero(0);
  return walk;
}

std::int32_t TrajectoryTracer::Field::cellAhead(std::int32_t rank, int uphill) const {
  const auto strides = annulus.strides();
  std::int32_t cell = placeOf[rank];
  for (int a = 0; a < (flat ? 2 : 3); ++a) {
    cell -= static_cast<float>(uphill) * node[rank][a] < 0 ? strides[a] : 0;
  }
  return cell;
}

void TrajectoryTracer::Field::toPlane(const std::int32_t* ranks, Corner* steps, int count,
                                      int uphill) const {
  const std::int32_t row = annulus.size[0], rows = annulus.size[1];
  PlaneLanes lanes;
  lanes.count = count;
  lanes.uphill = uphill;
  lanes.longest = 2 * options.maxStep * finest;
  lanes.tolerance = options.tolerance;
  for (int w = 0; w < kBeside; ++w) {
    const std::int32_t rank = ranks[std::min(w, count - 1)];
    const std::int32_t place = placeOf[rank], line = place / row, slice = line / rows;
    lanes.start[0][w] = place - line * row;
    lanes.start[1][w] = line - slice * rows;
    lanes.start[2][w] = slice;
    for (int c = 0; c < 4; ++c) lanes.node[w][c] = node[rank][c];
    lanes.made[w] = cellAt_[cellAhead(rank, uphill)] > kDivided;
  }
  stepToPlane(view_, lanes);
  for (int w = 0; w < count; ++w) {
    const Vector way = vectorOf(lanes.way, w);
    steps[w] << way.cast<float>(), static_cast<float>(lanes.made[w] ? lanes.length[w] : kNaN);
  }
}

bool TrajectoryTracer::Field::goStraight(Walk& walk, double target, int uphill) const {
  const double rest = uphill * (target - walk.u) / walk.slope;
  walk.stuck = !(rest < kNearEnd * finest);
  if (walk.stuck) return false;
  walk.x += rest * walk.velocity;
  walk.length += rest;
  walk.u = target;
  return true;
}

double TrajectoryTracer::Field::stepAfter(double step, double error) const {
  constexpr double kSafety = 0.9, kLeast = 0.3, kMost = 4.0;
  const double longest = options.maxStep * finest, growth = longest / step;
  // The cubic root only where the longest step is not within reach.
  if (growth <= kMost &&
      error * growth * growth * growth <= kSafety * kSafety * kSafety * options.tolerance) {
    return longest;
  }
  const double factor = error > 0 ? kSafety * std::cbrt(options.tolerance / error) : kMost;
  return std::min(longest, step * std::clamp(factor, kLeast, kMost));
}

bool TrajectoryTracer::Field::hop(Walk& walk, double target, int uphill) const {
  walk.stuck = true;
  if (walk.home < 0 || ++walk.hops > kMostHops) return false;
  const auto s = annulus.boxSubscripts(walk.home);
  const Vector centre(s[0], s[1], s[2]);
  const std::int32_t wall = target > 0.5 ? kOuter : kInner;
  const auto& links = annulus.links[walk.home];
  const auto lengthTo = [&](const Vector& x) {
    return (x - walk.x).cwiseProduct(annulus.grid.spacing).norm();
  };
  Vector end = walk.x;
  double nearest = kInfinity;
  std::int32_t next = uphill * (interpolant.u[walk.home] - walk.u) > kLeastGain ? walk.home : -1;
  double steepest = 0;
  for (int d = 0; d < 6; ++d) {
    const int a = harmonic::axisOf(d);
    const Vector way = harmonic::signOf(d) * Vector::Unit(a);
    if (links[d] == wall) {
      const Vector x = centre + annulus.fractions[annulus.irregular(walk.home)][d] * way;
      if (lengthTo(x) < nearest) {
        nearest = lengthTo(x);
        end = x;
      }
    } else if (links[d] >= 0) {
      const double gain = uphill * (interpolant.u[links[d]] - walk.u);
      if (gain <= kLeastGain || gain <= steepest * annulus.grid.spacing[a]) continue;
      steepest = gain / annulus.grid.spacing[a];
      next = links[d];
    }
  }
  if (nearest < kInfinity) {
    walk.length += nearest;
    walk.x = end;
    walk.u = target;
    walk.stuck = false;
    return true;
  }
  if (next < 0) return false;
  Walk on = begin(annulus.place[next], uphill);
  on.length = walk.length + lengthTo(on.x);
  on.hops = walk.hops;
  walk = on;
  return false;
}

void TrajectoryTracer::Field::limitStep(Walk& walk, double target, int uphill) const {
  // Half a voxel at most where the side must be known: a step then never leaves its neighbourhood.
  const double longest = (walk.divided ? std::min(0.5, options.maxStep) : options.maxStep) * finest;
  // Not far past the target either, where what is extended beyond the boundary bends.
  const double rest = uphill * (target - walk.u) / walk.slope;
  walk.step = std::min({walk.step, longest, kPastTarget * rest + kBeyondTarget * finest});
}

void TrajectoryTracer::Field::attempt(const Walk* walks, StepLanes& tries, int count,
                                      int uphill) const {
  tries.count = count;
  tries.uphill = uphill;
  for (int w = 0; w < count; ++w) {
    for (int a = 0; a < 3; ++a) {
      tries.x[a][w] = walks[w].x[a];
      tries.velocity[a][w] = walks[w].velocity[a];
    }
    tries.step[w] = walks[w].step;
    tries.home[w] = walks[w].home;
  }
  tryStep(view_, tries);
}

std::int32_t TrajectoryTracer::Field::homeAtEnd(const StepLanes& tries, int lane) const {
  if (tries.endHome[lane] >= 0) return tries.endHome[lane];
  const auto strides = annulus.strides();
  const auto at = [&](int c) {
    return annulus
        .numberAt[tries.cell[lane] + (c & 1) + (c >> 1 & 1) * strides[1] + (c >> 2) * strides[2]];
  };
  std::int32_t home = at(tries.nearest[lane]);
  for (int c = 0; home < 0 && c < 8; ++c) home = at(c);
  return home;
}

TrajectoryTracer::Field::Outcome TrajectoryTracer::Field::conclude(Walk& walk,
                                                                   const StepLanes& tries, int lane,
                                                                   double target,
                                                                   int uphill) const {
  const double s = walk.step, error = tries.error[lane], u = tries.u[lane];
  const bool lost = tries.lost[lane] || !(tries.slope[lane] > view_.leastSlope);
  const auto straight = [&] {
    return goStraight(walk, target, uphill) ? Outcome::Arrived : Outcome::Advanced;
  };
  if (lost || error > options.tolerance) {
    // At the end of the cells that know the tissue: the boundary is there, or as near as the
    // extension beyond it is good.
    if (s < kTinyStep * finest) return straight();
    walk.step = lost ? 0.25 * s : s * std::max(0.2, 0.9 * std::cbrt(options.tolerance / error));
    return Outcome::Again;
  }
  if (uphill * (u - target) >= 0) {
    arrive(walk, tries, lane, target, uphill);
    return Outcome::Arrived;
  }
  // Where the tissue is thinner than the grid resolves, the extension beyond the boundary may
  // bend a trajectory along it.  Then u does not gain what its slope promises: if the boundary
  // is near, go straight to it.
  if (uphill * (u - walk.u) < kPoorGain * walk.slope * s) {
    if (goStraight(walk, target, uphill)) return Outcome::Arrived;
    walk.stuck = ++walk.strikes > kStrikes;
    if (walk.stuck) return Outcome::Advanced;
  }
  walk.x = vectorOf(tries.end, lane);
  walk.velocity = vectorOf(tries.k4, lane);
  walk.home = homeAtEnd(tries, lane);
  walk.divided = tries.divided[lane];
  walk.u = u;
  walk.slope = tries.slope[lane];
  walk.length += s;
  walk.step = stepAfter(s, error);
  return Outcome::Advanced;
}

void TrajectoryTracer::Field::arrive(Walk& walk, const StepLanes& tries, int lane, double target,
                                     int uphill) const {
  constexpr int kMostTries = 12;
  const double s = walk.step;
  const Vector end = vectorOf(tries.end, lane), k4 = vectorOf(tries.k4, lane);
  // On the step's cubic.
  const auto at = [&](double t) {
    const double t2 = t * t, t3 = t2 * t;
    return Vector((2 * t3 - 3 * t2 + 1) * walk.x + (t3 - 2 * t2 + t) * s * walk.velocity +
                  (-2 * t3 + 3 * t2) * end + (t3 - t2) * s * k4);
  };
  const auto along = [&](double t) {  // its derivative
    return Vector(6 * (t * t - t) * (walk.x - end) + (3 * t * t - 4 * t + 1) * s * walk.velocity +
                  (3 * t * t - 2 * t) * s * k4);
  };
  double low = 0, high = 1, t = 0;
  const double fLow = uphill * (walk.u - target), fHigh = uphill * (tries.u[lane] - target);
  if (fLow < 0) {
    // From where the cubic through both ends' u and slopes crosses, by Newton steps that stay
    // between places before and behind the target.
    t = crossingOf(fLow, s * walk.slope, fHigh, s * tries.slope[lane]);
    for (int k = 0; k < kMostTries; ++k) {
      const Sample here = sample(at(t), walk.home);
      const double value = uphill * (here.u - target);
      if (std::abs(value) < kEnough * walk.slope * finest) break;
      (value < 0 ? low : high) = t;
      t -= value / (uphill * here.gradient.dot(along(t)));
      if (!(t > low && t < high)) t = 0.5 * (low + high);
    }
  }
  walk.x = at(t);
  walk.u = target;
  walk.length += t * s;
}

bool TrajectoryTracer::Field::advance(Walk& walk, double target, int uphill) const {
  limitStep(walk, target, uphill);
  StepLanes tries;
  Outcome outcome = Outcome::Again;
  while (outcome == Outcome::Again) {
    attempt(&walk, tries, 1, uphill);
    outcome = conclude(walk, tries, 0, target, uphill);
  }
  return outcome == Outcome::Arrived || (walk.stuck && hop(walk, target, uphill));
}

Trace TrajectoryTracer::Field::run(Walk walk, double target, int uphill) const {
  Trace result;
  bool done = uphill * (walk.u - target) >= 0;
  for (int k = 0; !done && !walk.stuck && k < kMaxSteps; ++k) done = advance(walk, target, uphill);
  result.reached = done;
  result.point = toWorld(walk.x);
  result.length = walk.length;
  result.u = walk.u;
  return result;
}

std::int32_t TrajectoryTracer::Field::homeOf(const Vector& x) const {
  std::array<int, 3> centre{};
  for (int a = 0; a < 3; ++a) centre[a] = static_cast<int>(std::lround(x[a]));
  std::int32_t best = -1;
  double nearest = kInfinity;
  const auto strides = annulus.strides();
  const int depth = flat ? 0 : 2;
  for (int dk = -depth; dk <= depth; ++dk) {
    for (int dj = -2; dj <= 2; ++dj) {
      for (int di = -2; di <= 2; ++di) {
        const int i = centre[0] + di, j = centre[1] + dj, k = centre[2] + dk;
        if (i < 0 || j < 0 || k < 0 || i >= annulus.size[0] || j >= annulus.size[1] ||
            k >= annulus.size[2]) {
          continue;
        }
        const std::int32_t n = annulus.numberAt[i + j * strides[1] + k * strides[2]];
        if (n < 0) continue;
        const double distance =
            (Vector(i, j, k) - x).cwiseProduct(annulus.grid.spacing).squaredNorm();
        if (distance < nearest) {
          nearest = distance;
          best = n;
        }
      }
    }
  }
  return best;
}

TrajectoryTracer::TrajectoryTracer(const harmonic::Annulus& annulus,
                                   const harmonic::Interpolant& interpolant,
                                   const TraceOptions& options)
    : field_(std::make_unique<Field>(annulus, interpolant, options)) {}
TrajectoryTracer::~TrajectoryTracer() = default;
TrajectoryTracer::TrajectoryTracer(TrajectoryTracer&&) noexcept = default;

const harmonic::Annulus& TrajectoryTracer::annulus() const {
  return field_->annulus;
}

Trace TrajectoryTracer::trace(std::int32_t number, double target) const {
  const int uphill = field_->interpolant.u[number] < target ? 1 : -1;
  return field_->run(field_->begin(annulus().place[number], uphill), target, uphill);
}

std::optional<TrajectoryTracer::Field::Start> TrajectoryTracer::Field::startAt(
    const Point& point, double target) const {
  Vector x = toBox(point);
  if (flat) x[2] = std::round(x[2]);
  const std::int32_t home = homeOf(x);
  if (home < 0) return {};
  Sample here = sample(x, home);
  Start start;
  if (here.home < 0) {
    const auto s = annulus.boxSubscripts(home);
    const Vector goal(s[0], s[1], s[2]);
    const Vector origin = x;
    double t = 0;
    while (here.home < 0 && t < 1) {
      t = std::min(1.0, t + 0.125);
      x = origin + t * (goal - origin);
      here = sample(x, home);
    }
    start.lead = (x - origin).cwiseProduct(annulus.grid.spacing).norm();
  }
  start.uphill = here.u < target ? 1 : -1;
  start.walk = begin(x, here.home, start.uphill);
  return start;
}

Trace TrajectoryTracer::trace(const Point& start, double target) const {
  Trace result;
  result.point = start;
  const auto from = field_->startAt(start, target);
  if (!from) return result;
  result = field_->run(from->walk, target, from->uphill);
  result.length += from->lead;
  return result;
}

Point Path::at(double arc) const {
  if (points.size() == 1 || arc <= 0) return points.front();
  const auto next = std::upper_bound(along.begin(), along.end(), static_cast<float>(arc));
  if (next == along.end()) return points.back();
  const std::size_t k = next - along.begin();
  const double span = along[k] - along[k - 1];
  const double t = span > 0 ? (arc - along[k - 1]) / span : 0;
  return points[k - 1] + t * (points[k] - points[k - 1]);
}

std::optional<Path> TrajectoryTracer::path(const Point& start, double target) const {
  const auto from = field_->startAt(start, target);
  if (!from) return {};
  constexpr double kStep = 0.25;  // voxels, so that the polyline has the trajectory's bends
  Path path{{start}, {0}};
  Field::Walk walk = from->walk;
  bool done = from->uphill * (walk.u - target) >= 0;
  for (int k = 0; !done && !walk.stuck && k < kMaxSteps; ++k) {
    walk.step = std::min(walk.step, kStep * field_->finest);
    done = field_->advance(walk, target, from->uphill);
    path.points.push_back(field_->toWorld(walk.x));
    path.along.push_back(static_cast<float>(from->lead + walk.length));
  }
  if (!done) return {};
  return path;
}

std::optional<double> TrajectoryTracer::thickness(const Point& point) const {
  const Trace inward = trace(point, 0), outward = trace(point, 1);
  if (!inward.reached || !outward.reached) return {};
  return inward.length + outward.length;
}

std::optional<double> TrajectoryTracer::value(const Point& point) const {
  const Vector x = field_->toBox(point);
  const auto sample = field_->sample(x, field_->homeOf(x));
  if (sample.home < 0) return {};
  return sample.u;
}

std::optional<Vector> TrajectoryTracer::direction(const Point& point) const {
  const Vector x = field_->toBox(point);
  const auto sample = field_->sample(x, field_->homeOf(x));
  if (sample.home < 0) return {};
  const Vector perMm = sample.gradient.cwiseProduct(field_->inverseSpacing);
  const double norm = perMm.norm();
  if (!(norm > 0)) return {};
  return field_->annulus.grid.axesToWorld(perMm / norm);
}

}  // namespace explica::correspondence
