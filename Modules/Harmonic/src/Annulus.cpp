// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Harmonic/Annulus.h"

#include "AnnulusAssembly.h"

#include <algorithm>
#include <sstream>

namespace explica::harmonic {

Annulus withCuts(const Annulus& annulus, const std::vector<Cut>& cuts) {
  const auto strides = annulus.strides();
  std::vector<Code> sites(annulus.numberAt.size(), kTissueCode);
  parallelFor(sites.size(), 1 << 16, [&](std::size_t p) {
    switch (annulus.numberAt[p]) {
      case kInner:
        sites[p] = codeOf(Site::Inner);
        break;
      case kOuter:
        sites[p] = codeOf(Site::Outer);
        break;
      case kInsulated:
        sites[p] = codeOf(Site::Insulated);
        break;
      default:
        break;
    }
  });
  std::vector<std::uint8_t> cutBits(sites.size(), 0), innerBits(sites.size(), 0);
  // Cuts that the annulus has already.
  parallelFor(annulus.count(), 1 << 14, [&](std::size_t n) {
    const std::int32_t p = annulus.place[n];
    for (int d = 0; d < (annulus.planar ? 4 : 6); ++d) {
      const std::int32_t q = p + signOf(d) * strides[axisOf(d)], link = annulus.links[n][d];
      if (sites[q] != kTissueCode || (link != kOuter && link != kInner)) continue;
      cutBits[p] |= 1U << d;
      if (link == kInner) innerBits[p] |= 1U << d;
    }
  });
  const auto ends = [&](const Cut& cut) {
    const std::int32_t p = annulus.place[cut.number];
    return std::array<std::int32_t, 2>{p, p + strides[cut.axis]};
  };
  for (const Cut& cut : cuts) {
    const auto [p, q] = ends(cut);
    if (sites[q] != kTissueCode) continue;
    const unsigned up = 1U << (2 * cut.axis + 1), down = 1U << (2 * cut.axis);
    cutBits[p] |= up;
    cutBits[q] |= down;
    innerBits[p] = cut.inner ? innerBits[p] | up : innerBits[p] & ~up;
    innerBits[q] = cut.inner ? innerBits[q] | down : innerBits[q] & ~down;
  }
  Annulus result = annulus;
  number(result, sites, cutBits, innerBits);
  parallelFor(annulus.count(), 1 << 14, [&](std::size_t n) {
    const std::int32_t old = annulus.irregular(static_cast<std::int32_t>(n));
    if (old < 0) return;
    result.fractions[result.irregular(result.numberAt[annulus.place[n]])] = annulus.fractions[old];
  });
  for (const Cut& cut : cuts) {
    const auto [p, q] = ends(cut);
    if (sites[q] != kTissueCode) continue;
    const auto put = [&](std::int32_t voxel, int direction, double fraction) {
      result.fractions[result.irregular(result.numberAt[voxel])][direction] =
          annulus.model == BoundaryModel::Staircase
              ? 1.0F
              : static_cast<float>(std::clamp(fraction, kSmallestFraction, 1 - kSmallestFraction));
    };
    put(p, 2 * cut.axis + 1, cut.fraction);
    put(q, 2 * cut.axis, cut.rest);
  }
  return result;
}

std::string voxelText(const std::array<int, 3>& voxel) {
  std::ostringstream text;
  text << '(' << voxel[0] << ", " << voxel[1] << ", " << voxel[2] << ')';
  return text.str();
}

std::size_t countAtImageBorder(const Annulus& annulus) {
  const int axes = annulus.planar ? 2 : 3;
  const auto isAtBorder = [&](std::int32_t n) {
    const std::array<int, 3> s = annulus.boxSubscripts(n);
    for (int a = 0; a < axes; ++a) {
      const int at = s[a] + annulus.first[a], last = annulus.grid.size[a] - 1;
      if (last > 0 && (at == 0 || at == last)) return true;
    }
    return false;
  };
  return parallelSum(annulus.count(), 1 << 14, std::size_t{0},
                     [&](std::size_t begin, std::size_t end) {
                       std::size_t count = 0;
                       for (std::size_t n = begin; n < end; ++n) {
                         count += isAtBorder(static_cast<std::int32_t>(n));
                       }
                       return count;
                     });
}

}  // namespace explica::harmonic
