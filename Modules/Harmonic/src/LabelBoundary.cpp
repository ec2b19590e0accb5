// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Harmonic/LabelBoundary.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Core/Volume.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace explica::harmonic {

namespace {

constexpr std::int32_t kFewInRow = 64;  // links: counting those before is faster than halving
constexpr std::size_t kBoundaryGrain = 1 << 12;  // elements a task
// Nearest that the surface may come to a voxel's centre, in voxels.
constexpr float kNearest = 0.01F;
// Pull to the middle of a link where the net is smooth.  It only decides where no step is near:
// alone it would flatten waves longer than 2 pi / kWeakPull^(1/4), 35 voxels.
constexpr float kWeakPull = 1e-3F;
constexpr int kRoughnessSmoothings = 8;  // averages it over about three voxels
// Crossings of neighbouring links may coincide; their distance is not taken for less than this.
constexpr float kShortest = 0.5F;
// Normals of the staircase are those of its steps until averaged over a few neighbours; they are
// taken again once the steps are nearly gone.  A wave number q needs about 4 / q^2 iterations.
constexpr int kFirstSmoothings = 3, kFirstIterations = 10;
constexpr int kSecondSmoothings = 1, kSecondIterations = 28, kLastIterations = 12;
// Iterations times the root of the least eigenvalue that is damped fully, to 1 / cosh(2 kDamped).
constexpr double kDamped = 1.35;

using LinkPlace = std::array<std::int32_t, 4>;  // subscripts of the lower end, axis
using Quad = std::array<float, 4>;

float squareOf(const Quad& v) {
  return v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
}

}  // namespace

LabelBoundary::LabelBoundary(const std::vector<std::uint8_t>& side, const std::array<int, 3>& size,
                             int axes, const LabelTrust& trust)
    : size_(size), strides_{1, size[0], size[0] * size[1]}, axes_(axes) {
  collect(side);
  join(side);
  pull_.assign(low_.size(), kWeakPull);
  findNormals(side, kFirstSmoothings);
  findCurvatures();
  relax(Energy::Curvature, kFirstIterations);
  findNormals(side, kSecondSmoothings);
  findCurvatures();
  relax(Energy::Curvature, kSecondIterations);
  findNormals(side, kSecondSmoothings);
  findCurvatures();
  findPull(trust);
  relax(Energy::Variation, kLastIterations);
}

inline std::int32_t LabelBoundary::find(std::int32_t row, std::int32_t p, int axis) const {
  const std::int32_t end = rowStart_[row + 1];
  std::int32_t at = rowStart_[row];
  if (end - at > kFewInRow) {
    at = static_cast<std::int32_t>(std::lower_bound(low_.begin() + at, low_.begin() + end, p) -
                                   low_.begin());
  } else {
    std::int32_t before = 0;
    for (std::int32_t link = at; link < end; ++link) before += low_[link] < p;
    at += before;
  }
  for (; at < end && low_[at] == p; ++at) {
    if (axisAt(at) == axis) return at;
  }
  return -1;
}

double LabelBoundary::place(std::int32_t p, int axis) const {
  const std::int32_t link = find(p / size_[0], p, axis);
  return link < 0 ? 0.5 : theta_[link];
}

Eigen::Vector3f LabelBoundary::normal(std::int32_t p, int axis) const {
  const std::int32_t link = find(p / size_[0], p, axis);
  if (link < 0) return Eigen::Vector3f::Zero();
  return Eigen::Map<const Eigen::Vector3f>(normal_[link].data());
}

void LabelBoundary::collect(const std::vector<std::uint8_t>& side) {
  const int rows = size_[1] * size_[2];
  const auto forLinks = [&](int row, const auto& body) {
    const int j = row % size_[1], k = row / size_[1];
    bool more[3] = {true, j + 1 < size_[1], axes_ == 3 && k + 1 < size_[2]};
    const auto eightFrom = [&](std::int32_t p) {
      std::uint64_t eight;
      std::memcpy(&eight, side.data() + p, sizeof eight);
      return eight;
    };
    // Eight voxels that are as their neighbours along each axis have no link.
    const auto eightAlike = [&](std::int32_t p) {
      const std::uint64_t own = eightFrom(p);
      std::uint64_t change = own ^ eightFrom(p + 1);
      if (more[1]) change |= own ^ eightFrom(p + strides_[1]);
      if (more[2]) change |= own ^ eightFrom(p + strides_[2]);
      return change == 0;
    };
    const std::int32_t first = row * size_[0];
    for (int i = 0; i < size_[0];) {
      if (i + 8 < size_[0] && eightAlike(first + i)) {
        i += 8;
        continue;
      }
      for (const int end = std::min(i + 8, size_[0]); i < end; ++i) {
        const std::int32_t p = first + i;
        if (side[p] > 1) continue;
        more[0] = i + 1 < size_[0];
        for (int a = 0; a < 3; ++a) {
          if (more[a] && side[p] + side[p + strides_[a]] == 1) body(LinkPlace{i, j, k, a}, p);
        }
      }
    }
  };
  rowStart_.assign(rows + 1, 0);
  parallelFor(rows, 256, [&](std::size_t row) {
    std::int32_t count = 0;
    forLinks(static_cast<int>(row), [&](const LinkPlace&, std::int32_t) { ++count; });
    rowStart_[row + 1] = count;
  });
  for (int row = 0; row < rows; ++row) rowStart_[row + 1] += rowStart_[row];
  low_.resize(rowStart_[rows]);
  at_.resize(low_.size());
  parallelFor(rows, 256, [&](std::size_t row) {
    std::int32_t next = rowStart_[row];
    if (next == rowStart_[row + 1]) return;
    forLinks(static_cast<int>(row), [&](const LinkPlace& at, std::int32_t p) {
      low_[next] = p;
      at_[next++] = at;
    });
  });
  theta_.assign(low_.size(), 0.5F);
}

void LabelBoundary::join(const std::vector<std::uint8_t>& side) {
  back_.assign(low_.size(), {-1, -1, -1, -1});
  const auto secondAxis = [&](int a, int chain) {
    return axes_ == 2 ? 1 - a : (a + 1 + chain) % 3;
  };
  const std::array<std::int32_t, 3> rowStride = {0, 1, size_[1]};
  // Of two links whose chains meet in a face, the one with the lower axis writes for both, of equal
  // ones the lower.
  parallelFor(low_.size(), kBoundaryGrain, [&](std::size_t link) {
    const std::int32_t p = low_[link];
    const LinkPlace& at = at_[link];
    const int a = at[3];
    for (int chain = 0; chain < axes_ - 1; ++chain) {
      const int b = secondAxis(a, chain);
      for (int s = 0; s < 2; ++s) {
        const int step = s == 0 ? -1 : 1;
        const int to = at[b] + step;
        if (to < 0 || to >= size_[b]) continue;
        // The face p, p + a, q, q + a: the chain leaves it through one of the other three links.
        const std::int32_t q = p + step * strides_[b];
        const std::uint8_t here = side[p], near = side[q], far = side[q + strides_[a]];
        if (near > 1 || far > 1) continue;
        const bool straight = near != far && near == here;
        if (straight ? s == 0 : a > b) continue;
        // Around a corner along b from the lower or the upper ends of a; if all four links are
        // crossed, around the one that is inside.
        const bool upper = near == far ? near == here : here == 0;
        std::int32_t out = straight || s == 0 ? q : p, row = at[1] + size_[1] * at[2];
        if (straight || s == 0) row += step * rowStride[b];
        if (!straight && upper) {
          out += strides_[a];
          row += rowStride[a];
        }
        const int outAxis = straight ? a : b;
        const int outSide = straight || upper ? 0 : 1;
        // The neighbour's chain in the same plane of the grid.
        const int outChain = axes_ == 2 || secondAxis(outAxis, 0) == a + b - outAxis ? 0 : 1;
        const std::int32_t other = find(row, out, outAxis);
        back_[link][2 * chain + s] = 4 * other + 2 * outChain + outSide;
        back_[other][2 * outChain + outSide] = static_cast<std::int32_t>(4 * link) + 2 * chain + s;
      }
    }
  });
}

void LabelBoundary::findNormals(const std::vector<std::uint8_t>& side, int smoothings) {
  const std::size_t count = low_.size();
  step_.assign(count, {0, 0, 0, 0});
  normal_.resize(count);
  parallelFor(count, kBoundaryGrain,
              [&](std::size_t link) { step_[link][axisAt(link)] = theta_[link]; });
  parallelFor(count, kBoundaryGrain, [&](std::size_t link) {
    const int a = axisAt(link);
    Quad along[2] = {{0, 0, 0, 0}, {0, 0, axes_ == 2 ? 1.0F : 0.0F, 0}};
    for (int chain = 0; chain < axes_ - 1; ++chain) {
      for (int s = 0; s < 2; ++s) {
        const std::int32_t code = back_[link][2 * chain + s];
        if (code < 0) continue;
        const Quad way = between(link, code >> 2);
        for (int c = 0; c < 4; ++c) along[chain][c] += s == 0 ? -way[c] : way[c];
      }
    }
    Quad n = {along[0][1] * along[1][2] - along[0][2] * along[1][1],
              along[0][2] * along[1][0] - along[0][0] * along[1][2],
              along[0][0] * along[1][1] - along[0][1] * along[1][0], 0};
    float square = squareOf(n);
    if (!(square > 1e-6F)) {
      n = {0, 0, 0, 0};
      n[a] = square = 1;
    }
    // Outward: from the end that is inside to the other.
    const bool flip = (n[a] < 0) == (side[low_[link]] == 1);
    const float scale = (flip ? -1 : 1) / std::sqrt(square);
    for (int c = 0; c < 4; ++c) normal_[link][c] = scale * n[c];
  });
  std::vector<Quad> before(count);
  for (int pass = 0; pass < smoothings; ++pass) {
    before.swap(normal_);
    parallelFor(count, kBoundaryGrain, [&](std::size_t link) {
      Quad n = before[link];
      for (const std::int32_t code : back_[link]) {
        if (code < 0) continue;
        const Quad& other = before[code >> 2];
        for (int c = 0; c < 4; ++c) n[c] += other[c];
      }
      const float square = squareOf(n);
      if (!(square > 1e-12F)) n = before[link];
      const float scale = square > 1e-12F ? 1 / std::sqrt(square) : 1;
      for (int c = 0; c < 4; ++c) normal_[link][c] = scale * n[c];
    });
  }
}

void LabelBoundary::findCurvatures() {
  bend_.resize(low_.size());
  parallelFor(low_.size(), kBoundaryGrain, [&](std::size_t link) {
    const Quad& n = normal_[link];
    const float ownNormal = n[axisAt(link)];
    for (int chain = 0; chain < axes_ - 1; ++chain) {
      Bend& bend = bend_[link][chain];
      bend = {};
      const std::int32_t* code = &back_[link][2 * chain];
      if (code[0] < 0 || code[1] < 0) continue;
      float along[2], distance[2], fixed[2];
      for (int s = 0; s < 2; ++s) {
        const std::int32_t m = code[s] >> 2;
        const Quad way = between(link, m);
        distance[s] = std::max(kShortest, std::sqrt(squareOf(way)));
        along[s] = n[axisAt(m)];
        fixed[s] = 0;
        for (int c = 0; c < 4; ++c) fixed[s] += static_cast<float>(at_[m][c] - at_[link][c]) * n[c];
      }
      // Curvature 2 / (d0 + d1) (x0 . n / d0 + x1 . n / d1).
      bend.length = 0.5F * (distance[0] + distance[1]);
      const float inverse = 1 / bend.length;
      for (int s = 0; s < 2; ++s) {
        bend.nearer[s] = 1 / distance[s];
        const float weight = bend.nearer[s] * inverse;
        bend.beside[s] = weight * along[s];
        bend.own -= weight * ownNormal;
        bend.constant += weight * fixed[s];
      }
    }
  });
}

void LabelBoundary::findPull(const LabelTrust& trust) {
  std::vector<std::array<float, 2>> curvature(low_.size());
  parallelFor(low_.size(), kBoundaryGrain, [&](std::size_t link) {
    for (int chain = 0; chain < axes_ - 1; ++chain) {
      curvature[link][chain] = curvatureOf(link, chain);
    }
  });
  std::vector<float> roughness(low_.size()), before(low_.size());
  parallelFor(low_.size(), kBoundaryGrain, [&](std::size_t link) {
    float sum = 0;
    int found = 0;
    for (int slot = 0; slot < 2 * (axes_ - 1); ++slot) {
      const std::int32_t code = back_[link][slot];
      const Bend& own = bend_[link][slot >> 1];
      if (code < 0 || own.length == 0) continue;
      const int chain = code >> 1 & 1;
      if (bend_[code >> 2][chain].length == 0) continue;
      const float change = curvature[link][slot >> 1] - curvature[code >> 2][chain];
      sum += own.nearer[slot & 1] * change * change;
      ++found;
    }
    roughness[link] = found > 0 ? sum / static_cast<float>(found) : 0;
  });
  for (int pass = 0; pass < kRoughnessSmoothings; ++pass) {
    before.swap(roughness);
    parallelFor(low_.size(), kBoundaryGrain, [&](std::size_t link) {
      float sum = before[link], count = 1;
      for (const std::int32_t code : back_[link]) {
        if (code < 0) continue;
        sum += before[code >> 2];
        ++count;
      }
      roughness[link] = sum / count;
    });
  }
  parallelFor(low_.size(), kBoundaryGrain, [&](std::size_t link) {
    const float rough = (roughness[link] - trust.smooth) / (trust.rough - trust.smooth);
    pull_[link] = std::clamp(trust.pull * rough, kWeakPull, trust.pull);
  });
}

float LabelBoundary::curvatureOf(std::size_t link, int chain) const {
  const Bend& bend = bend_[link][chain];
  float sum = bend.constant + bend.own * theta_[link];
  for (int s = 0; s < 2; ++s) {
    const std::int32_t code = back_[link][2 * chain + s];
    if (code >= 0) sum += bend.beside[s] * theta_[code >> 2];
  }
  return sum;
}

/// What lies on one side of a link along a chain: up to three links, and the bends at the nearer
/// two.  Where the chain has ended, the link itself and bends of zero.
struct LabelBoundary::Strip {
  std::array<std::int32_t, 3> link;
  std::array<float, 2> own, constant, length;
  std::array<float, 2> inward, outward;  ///< derivative of the bend by the next link in, out
  std::array<float, 2> stiffness;        ///< between the link and the first bend; first and second
};

template <int kReach>
inline LabelBoundary::Strip LabelBoundary::stripFrom(std::size_t link, int chain, int side) const {
  static constexpr Bend kNone;
  Strip strip;
  float nearer = bend_[link][chain].nearer[side];
  std::int32_t code = back_[link][2 * chain + side];
  for (int k = 0; k + 1 < kReach; ++k) {
    strip.link[k] = code < 0 ? static_cast<std::int32_t>(link) : code >> 2;
    const Bend& bend = code < 0 ? kNone : bend_[code >> 2][code >> 1 & 1];
    const int inward = code & 1;
    strip.own[k] = bend.own;
    strip.constant[k] = bend.constant;
    strip.length[k] = bend.length;
    strip.inward[k] = bend.beside[inward];
    strip.outward[k] = bend.beside[1 - inward];
    strip.stiffness[k] = bend.length > 0 ? nearer : 0;
    nearer = bend.nearer[1 - inward];
    if (code >= 0) code = back_[code >> 2][(code & 3) ^ 1];
  }
  strip.link[kReach - 1] = code < 0 ? static_cast<std::int32_t>(link) : code >> 2;
  return strip;
}

/// Where a step of the gradient leads from the links' places x: by constant + own x(own link) + sum
/// over terms of weight x(link).
template <int kTerms>
struct LabelBoundary::Row {
  struct Term {
    float weight;
    std::int32_t link;
  };
  float constant, own;
  std::array<Term, kTerms> term;
};

/// A row of half the energy's gradient over minus a bound on the sum of the Hessian's row.
template <int kChains, int kReach>
LabelBoundary::Row<2 * kChains * kReach> LabelBoundary::rowOf(std::size_t link) const {
  const float across = normal_[link][axisAt(link)];
  const float pull = pull_[link] * std::max(across * across, 0.01F);
  Row<2 * kChains * kReach> row{-0.5F * pull, pull, {}};
  for (int chain = 0; chain < kChains; ++chain) {
    const Bend& bend = bend_[link][chain];
    const Strip strip[2] = {stripFrom<kReach>(link, chain, 0), stripFrom<kReach>(link, chain, 1)};
    // Half the energy's derivative by the bends, times theirs by the own place.
    float atOwn = 0, atFirst[2], atSecond[2] = {0, 0};
    for (int s = 0; s < 2; ++s) {
      const Strip& t = strip[s];
      if constexpr (kReach == 2) {
        atFirst[s] = t.length[0] * t.inward[0];
      } else {
        atOwn += t.stiffness[0] * (bend.own - t.inward[0]);
        atFirst[s] = t.stiffness[0] * (t.inward[0] - bend.own) + t.stiffness[1] * t.inward[0];
        atSecond[s] = -t.stiffness[1] * t.inward[0];
      }
    }
    if constexpr (kReach == 2) atOwn = bend.length * bend.own;
    row.constant += atOwn * bend.constant;
    row.own += atOwn * bend.own;
    for (int s = 0; s < 2; ++s) {
      const Strip& t = strip[s];
      row.constant += atFirst[s] * t.constant[0];
      row.own += atFirst[s] * t.inward[0];
      auto* term = &row.term[kReach * (2 * chain + s)];
      term[0] = {atOwn * bend.beside[s] + atFirst[s] * t.own[0], t.link[0]};
      term[1] = {atFirst[s] * t.outward[0], t.link[1]};
      if constexpr (kReach == 3) {
        row.constant += atSecond[s] * t.constant[1];
        term[0].weight += atSecond[s] * t.inward[1];
        term[1].weight += atSecond[s] * t.own[1];
        term[2] = {atSecond[s] * t.outward[1], t.link[2]};
      }
    }
  }
  float bound = row.own;
  for (const auto& term : row.term) bound += std::abs(term.weight);
  const float scale = -1 / bound;
  row.constant *= scale;
  row.own *= scale;
  for (auto& term : row.term) term.weight *= scale;
  return row;
}

/// Chebyshev's semi-iteration [GolubVarga1961] for eigenvalues up to 1, which the rows' bounds see
/// to; each step ends within the links.  A last step without momentum smooths what is shortest.
template <int kChains, int kReach>
void LabelBoundary::relaxRows(int iterations) {
  const std::size_t count = low_.size();
  constexpr int kTerms = 2 * kChains * kReach;
  std::vector<Row<kTerms>> rows(count);
  parallelFor(count, kBoundaryGrain,
              [&](std::size_t link) { rows[link] = rowOf<kChains, kReach>(link); });
  std::vector<float> before = theta_;
  const auto step = [&](float length, float momentum) {
    parallelFor(count, kBoundaryGrain, [&](std::size_t link) {
      const Row<kTerms>& row = rows[link];
      const float from = theta_[link];
      float way[2] = {row.constant, row.own * from};
      for (int k = 0; k < kTerms; ++k) {
        way[k & 1] += row.term[k].weight * theta_[row.term[k].link];
      }
      const float to = from + length * (way[0] + way[1]) + momentum * (from - before[link]);
      // Not std::clamp, which jumps, and no processor foresees where.
      before[link] = std::max(std::min(to, 1 - kNearest), kNearest);
    });
    theta_.swap(before);
  };
  const double least = std::pow(kDamped / iterations, 2);
  const double spread = (1 - least) / (1 + least);
  double omega = 1;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    if (iteration > 0) omega = 1 / (1 - (iteration == 1 ? 0.5 : 0.25 * omega) * spread * spread);
    step(static_cast<float>(2 * omega / (1 + least)), static_cast<float>(omega - 1));
  }
  step(1, 0);
}

void LabelBoundary::relax(Energy energy, int iterations) {
  if (axes_ == 3) {
    energy == Energy::Curvature ? relaxRows<2, 2>(iterations) : relaxRows<2, 3>(iterations);
  } else {
    energy == Energy::Curvature ? relaxRows<1, 2>(iterations) : relaxRows<1, 3>(iterations);
  }
}

}  // namespace explica::harmonic
