// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Harmonic/LabelBoundary.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Core/Volume.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace explica::harmonic {

namespace {

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
// taken again once the steps are nearly gone.  A wave number q needs about 8 / q^2 iterations.
constexpr int kFirstSmoothings = 3, kFirstIterations = 20;
constexpr int kSecondSmoothings = 1, kSecondIterations = 60, kLastIterations = 30;

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

double LabelBoundary::place(std::int32_t p, int axis) const {
  const std::int32_t link = find(p, axis);
  return link < 0 ? 0.5 : theta_[link];
}

Eigen::Vector3f LabelBoundary::normal(std::int32_t p, int axis) const {
  const std::int32_t link = find(p, axis);
  if (link < 0) return Eigen::Vector3f::Zero();
  return Eigen::Map<const Eigen::Vector3f>(normal_[link].data());
}

std::int32_t LabelBoundary::find(std::int32_t p, int axis) const {
  const std::int32_t row = p / size_[0];
  const auto begin = low_.begin() + rowStart_[row], end = low_.begin() + rowStart_[row + 1];
  for (auto at = std::lower_bound(begin, end, p); at != end && *at == p; ++at) {
    if (axis_[at - low_.begin()] == axis) return static_cast<std::int32_t>(at - low_.begin());
  }
  return -1;
}

Eigen::Vector3f LabelBoundary::offset(std::size_t link, std::size_t other) const {
  const auto &from = at_[link], &to = at_[other];
  return {static_cast<float>(to[0] - from[0]), static_cast<float>(to[1] - from[1]),
          static_cast<float>(to[2] - from[2])};
}

void LabelBoundary::collect(const std::vector<std::uint8_t>& side) {
  const int rows = size_[1] * size_[2];
  const auto forLinks = [&](int row, const auto& body) {
    const int j = row % size_[1], k = row / size_[1];
    bool more[3] = {true, j + 1 < size_[1], axes_ == 3 && k + 1 < size_[2]};
    std::int32_t p = row * size_[0];
    for (int i = 0; i < size_[0]; ++i, ++p) {
      if (side[p] > 1) continue;
      more[0] = i + 1 < size_[0];
      for (int a = 0; a < 3; ++a) {
        if (more[a] && side[p] + side[p + strides_[a]] == 1) body({i, j, k}, p, a);
      }
    }
  };
  rowStart_.assign(rows + 1, 0);
  parallelFor(rows, 256, [&](std::size_t row) {
    forLinks(static_cast<int>(row),
             [&](const std::array<std::int32_t, 3>&, std::int32_t, int) { ++rowStart_[row + 1]; });
  });
  for (int row = 0; row < rows; ++row) rowStart_[row + 1] += rowStart_[row];
  low_.resize(rowStart_[rows]);
  at_.resize(low_.size());
  axis_.resize(low_.size());
  parallelFor(rows, 256, [&](std::size_t row) {
    std::int32_t next = rowStart_[row];
    forLinks(static_cast<int>(row),
             [&](const std::array<std::int32_t, 3>& at, std::int32_t p, int a) {
               low_[next] = p;
               at_[next] = at;
               axis_[next++] = static_cast<std::uint8_t>(a);
             });
  });
  theta_.assign(low_.size(), 0.5F);
}

void LabelBoundary::join(const std::vector<std::uint8_t>& side) {
  back_.resize(low_.size());
  const auto secondAxis = [&](int a, int chain) {
    return axes_ == 2 ? 1 - a : (a + 1 + chain) % 3;
  };
  parallelFor(low_.size(), kBoundaryGrain, [&](std::size_t link) {
    const std::int32_t p = low_[link];
    const int a = axis_[link];
    const std::array<std::int32_t, 3>& at = at_[link];
    back_[link] = {-1, -1, -1, -1};
    for (int chain = 0; chain < axes_ - 1; ++chain) {
      const int b = secondAxis(a, chain);
      for (int s = 0; s < 2; ++s) {
        const int to = at[b] + (s == 0 ? -1 : 1);
        if (to < 0 || to >= size_[b]) continue;
        // The face p, p + a, q, q + a: the chain leaves it through one of the other three links.
        const std::int32_t q = p + (s == 0 ? -1 : 1) * strides_[b];
        const std::uint8_t here = side[p], near = side[q], far = side[q + strides_[a]];
        if (near > 1 || far > 1) continue;
        const std::int32_t lower = s == 0 ? q : p;
        std::int32_t out = 0;
        int outAxis = b;
        if (near != far && near == here) {
          out = q;
          outAxis = a;
        } else if (near == far) {
          out = near != here ? lower : lower + strides_[a];
        } else {  // all four are crossed: around the corner that is inside
          out = here == 1 ? lower : lower + strides_[a];
        }
        // The neighbour's chain in the same plane of the grid.
        const int outChain = axes_ == 2 ? 0 : (secondAxis(outAxis, 0) == a + b - outAxis ? 0 : 1);
        back_[link][2 * chain + s] = 4 * find(out, outAxis) + 2 * outChain;
      }
    }
  });
  // Which side of the neighbour points back; only the lowest bit of own slots is written, and only
  // the others are read.
  const auto made = back_;
  parallelFor(low_.size(), kBoundaryGrain, [&](std::size_t link) {
    for (int slot = 0; slot < 4; ++slot) {
      const std::int32_t code = made[link][slot];
      if (code < 0) continue;
      const auto own = static_cast<std::int32_t>(4 * link + (slot & 2));
      back_[link][slot] = code + (made[code >> 2][code & 2] == own ? 0 : 1);
    }
  });
}

void LabelBoundary::findNormals(const std::vector<std::uint8_t>& side, int smoothings) {
  normal_.resize(low_.size());
  // Position of a neighbour relative to a link's own crossing.
  const auto towards = [&](std::size_t link, std::int32_t code) {
    const std::int32_t m = code >> 2;
    Eigen::Vector3f d = offset(link, m);
    d[axis_[m]] += theta_[m];
    d[axis_[link]] -= theta_[link];
    return d;
  };
  parallelFor(low_.size(), kBoundaryGrain, [&](std::size_t link) {
    Eigen::Vector3f along[2] = {Eigen::Vector3f::Zero(), Eigen::Vector3f::Unit(2)};
    const int a = axis_[link];
    for (int chain = 0; chain < axes_ - 1; ++chain) {
      along[chain].setZero();
      for (int s = 0; s < 2; ++s) {
        const std::int32_t code = back_[link][2 * chain + s];
        if (code >= 0) along[chain] += (s == 0 ? -1.0F : 1.0F) * towards(link, code);
      }
    }
    Eigen::Vector3f n = along[0].cross(along[1]);
    if (!(n.squaredNorm() > 1e-6F)) n = Eigen::Vector3f::Unit(a);
    n.normalize();
    // Outward: from the end that is inside to the other.
    const bool flip = (n[a] < 0) == (side[low_[link]] == 1);
    for (int c = 0; c < 3; ++c) normal_[link][c] = flip ? -n[c] : n[c];
  });
  for (int pass = 0; pass < smoothings; ++pass) {
    const auto before = normal_;
    parallelFor(low_.size(), kBoundaryGrain, [&](std::size_t link) {
      Eigen::Vector3f n = Eigen::Map<const Eigen::Vector3f>(before[link].data());
      for (const std::int32_t code : back_[link]) {
        if (code >= 0) n += Eigen::Map<const Eigen::Vector3f>(before[code >> 2].data());
      }
      const float norm = n.norm();
      if (!(norm > 1e-6F)) return;
      for (int c = 0; c < 3; ++c) normal_[link][c] = n[c] / norm;
    });
  }
}

void LabelBoundary::findCurvatures() {
  own_.assign(low_.size(), {0, 0});
  constant_.assign(low_.size(), {0, 0});
  beside_.assign(low_.size(), {0, 0, 0, 0});
  length_.assign(low_.size(), {0, 0});
  stiffness_.assign(low_.size(), {0, 0, 0, 0});
  parallelFor(low_.size(), kBoundaryGrain, [&](std::size_t link) {
    const auto& n = normal_[link];
    const float ownNormal = n[axis_[link]];
    for (int chain = 0; chain < axes_ - 1; ++chain) {
      if (back_[link][2 * chain] < 0 || back_[link][2 * chain + 1] < 0) continue;
      float along[2], distance[2], fixed[2];
      for (int s = 0; s < 2; ++s) {
        const std::int32_t m = back_[link][2 * chain + s] >> 2;
        Eigen::Vector3f d = offset(link, m);
        fixed[s] = d[0] * n[0] + d[1] * n[1] + d[2] * n[2];
        along[s] = n[axis_[m]];
        d[axis_[m]] += theta_[m];
        d[axis_[link]] -= theta_[link];
        distance[s] = std::max(kShortest, std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
      }
      // Curvature 2 / (d0 + d1) (x0 . n / d0 + x1 . n / d1).
      length_[link][chain] = 0.5F * (distance[0] + distance[1]);
      const float scale = 1 / length_[link][chain];
      const float w0 = scale / distance[0], w1 = scale / distance[1];
      beside_[link][2 * chain] = w0 * along[0];
      beside_[link][2 * chain + 1] = w1 * along[1];
      own_[link][chain] = -(w0 + w1) * ownNormal;
      constant_[link][chain] = w0 * fixed[0] + w1 * fixed[1];
      for (int s = 0; s < 2; ++s) {
        const std::int32_t code = back_[link][2 * chain + s];
        const auto& other = back_[code >> 2];
        if (other[code & 2] >= 0 && other[(code & 2) + 1] >= 0) {
          stiffness_[link][2 * chain + s] = 1 / distance[s];
        }
      }
    }
  });
}

void LabelBoundary::findPull(const LabelTrust& trust) {
  std::vector<std::array<float, 2>> curvature(low_.size());
  parallelFor(low_.size(), kBoundaryGrain, [&](std::size_t link) {
    for (int chain = 0; chain < axes_ - 1; ++chain) {
      curvature[link][chain] = curvatureOf(link, chain, theta_);
    }
  });
  std::vector<float> roughness(low_.size()), before;
  parallelFor(low_.size(), kBoundaryGrain, [&](std::size_t link) {
    float sum = 0;
    int found = 0;
    for (int slot = 0; slot < 4; ++slot) {
      const float stiffness = stiffness_[link][slot];
      if (stiffness == 0) continue;
      const std::int32_t code = back_[link][slot];
      const float change = curvature[link][slot >> 1] - curvature[code >> 2][code >> 1 & 1];
      sum += stiffness * change * change;
      ++found;
    }
    roughness[link] = found > 0 ? sum / static_cast<float>(found) : 0;
  });
  for (int pass = 0; pass < kRoughnessSmoothings; ++pass) {
    before = roughness;
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

float LabelBoundary::curvatureOf(std::size_t link, int chain,
                                 const std::vector<float>& theta) const {
  float sum = constant_[link][chain] + own_[link][chain] * theta[link];
  for (int slot = 2 * chain; slot < 2 * chain + 2; ++slot) {
    const std::int32_t code = back_[link][slot];
    if (code >= 0) sum += beside_[link][slot] * theta[code >> 2];
  }
  return sum;
}

/// Accelerated projected gradients with restart [BeckTeboulle2009; ODonoghueCandes2015], each
/// unknown with a bound of its own on the row sums of the Hessian.
template <int kChains>
void LabelBoundary::relaxChains(Energy energy, int iterations) {
  const std::size_t count = low_.size();
  // Per slot, twice the neighbour plus its chain, and the weight of the own theta in that chain's
  // curvature; where a chain ends the link itself without weight, so that loops need not ask.
  std::vector<std::array<std::int32_t, 4>> near(count);
  std::vector<std::array<float, 4>> weight(count);
  parallelFor(count, kBoundaryGrain, [&](std::size_t link) {
    for (int slot = 0; slot < 4; ++slot) {
      const std::int32_t code = back_[link][slot];
      near[link][slot] = code < 0 ? static_cast<std::int32_t>(2 * link) : code >> 1;
      weight[link][slot] = code < 0 ? 0 : beside_[code >> 2][code & 3];
    }
  });
  std::vector<float> curvature(2 * count), bending(2 * count);
  std::vector<float> bound(count), pull(count);
  // Derivative of half the energy by the curvatures, or with sign 1 a bound on its row sums.
  const auto bend = [&](float sign, const auto& curvatureAt) {
    if (energy == Energy::Curvature) {
      parallelFor(count, kBoundaryGrain, [&](std::size_t link) {
        for (int chain = 0; chain < kChains; ++chain) {
          bending[2 * link + chain] = length_[link][chain] * curvatureAt(link, chain);
        }
      });
      return;
    }
    parallelFor(count, kBoundaryGrain, [&](std::size_t link) {
      for (int chain = 0; chain < kChains; ++chain) {
        curvature[2 * link + chain] = curvatureAt(link, chain);
      }
    });
    parallelFor(count, kBoundaryGrain, [&](std::size_t link) {
      for (int chain = 0; chain < kChains; ++chain) {
        const float own = curvature[2 * link + chain];
        bending[2 * link + chain] =
            stiffness_[link][2 * chain] * (own + sign * curvature[near[link][2 * chain]]) +
            stiffness_[link][2 * chain + 1] * (own + sign * curvature[near[link][2 * chain + 1]]);
      }
    });
  };
  bend(1, [&](std::size_t link, int chain) {
    return std::abs(own_[link][chain]) + std::abs(beside_[link][2 * chain]) +
           std::abs(beside_[link][2 * chain + 1]);
  });
  parallelFor(count, kBoundaryGrain, [&](std::size_t link) {
    const float across = normal_[link][axis_[link]];
    pull[link] = pull_[link] * std::max(across * across, 0.01F);
    float sum = pull[link];
    for (int chain = 0; chain < kChains; ++chain) {
      sum += std::abs(own_[link][chain]) * bending[2 * link + chain];
    }
    for (int slot = 0; slot < 2 * kChains; ++slot) {
      sum += std::abs(weight[link][slot]) * bending[near[link][slot]];
    }
    bound[link] = sum;
  });
  std::vector<float> ahead = theta_, next(count);
  double momentum = 1;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    bend(-1, [&](std::size_t link, int chain) {
      const auto& beside = beside_[link];
      return constant_[link][chain] + own_[link][chain] * ahead[link] +
             beside[2 * chain] * ahead[near[link][2 * chain] >> 1] +
             beside[2 * chain + 1] * ahead[near[link][2 * chain + 1] >> 1];
    });
    // As if the last step had gone downhill, which it nearly always has.
    const double later = 0.5 * (1 + std::sqrt(1 + 4 * momentum * momentum));
    const auto share = static_cast<float>((momentum - 1) / later);
    momentum = later;
    const double uphill =
        parallelSum(count, kBoundaryGrain, 0.0, [&](std::size_t begin, std::size_t end) {
          double sum = 0;
          for (std::size_t link = begin; link < end; ++link) {
            float slope = pull[link] * (ahead[link] - 0.5F);
            for (int chain = 0; chain < kChains; ++chain) {
              slope += own_[link][chain] * bending[2 * link + chain];
            }
            for (int slot = 0; slot < 2 * kChains; ++slot) {
              slope += weight[link][slot] * bending[near[link][slot]];
            }
            // Not std::clamp, which jumps, and no processor foresees where.
            const float below = std::min(ahead[link] - slope / bound[link], 1 - kNearest);
            next[link] = std::max(below, kNearest);
            sum += static_cast<double>((ahead[link] - next[link]) * bound[link] *
                                       (next[link] - theta_[link]));
            ahead[link] = next[link] + share * (next[link] - theta_[link]);
          }
          return sum;
        });
    if (uphill > 0) {
      momentum = 0.5 * (1 + std::sqrt(5.0));  // what follows 1
      ahead = next;
    }
    theta_.swap(next);
  }
}

void LabelBoundary::relax(Energy energy, int iterations) {
  if (axes_ == 3) {
    relaxChains<2>(energy, iterations);
  } else {
    relaxChains<1>(energy, iterations);
  }
}

}  // namespace explica::harmonic
