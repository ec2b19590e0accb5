// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "AnnulusAssembly.h"
#include "Explica/Core/Errors.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace explica::harmonic {
namespace {

/// Position of the zero between a (inside the tissue) and b, from four values in a row, in (0, 1].
/// The second difference is the smaller of both ends', so that a ridge beside the edge does no
/// harm.
double crossing(double before, double a, double b, double after) {
  const double linear = a / (a - b);
  const double atA = before - 2 * a + b, atB = a - 2 * b + after;
  double second = 0;
  if (atA * atB > 0) second = std::abs(atA) < std::abs(atB) ? atA : atB;
  double s = linear;
  for (int k = 0; k < 4; ++k) {
    const double value = a + (b - a) * s - 0.5 * second * s * (1 - s);
    const double slope = (b - a) - 0.5 * second * (1 - 2 * s);
    if (slope * (b - a) <= 0) return linear;
    s -= value / slope;
    if (!(s > 0 && s < 1)) return linear;
  }
  return s;
}

}  // namespace

Annulus annulusFromSites(const Volume<Site>& sites, const Volume<float>& innerLevel,
                         const Volume<float>& outerLevel, const AnnulusOptions& options,
                         const Monitor& monitor) {
  if (!sameGrid(sites.grid, innerLevel.grid) || !sameGrid(sites.grid, outerLevel.grid)) {
    throw InvalidInput("the sites and the two level sets lie on different grids");
  }
  constexpr int kMargin = 2;
  BoxOfSites found = boxOf(sites, kMargin);
  const Grid& grid = found.grid;
  const Box& box = found.box;
  std::vector<float> inner(box.count(), 0), outer(box.count(), 0);
  forVoxels(box, [&](std::size_t p, int i, int j, int k) {
    // Beyond the volume its nearest voxel, so that the crossing's curvature sees no jump.
    const std::size_t v =
        grid.linear(std::clamp(i, 0, grid.size[0] - 1), std::clamp(j, 0, grid.size[1] - 1),
                    std::clamp(k, 0, grid.size[2] - 1));
    inner[p] = innerLevel[v];
    outer[p] = outerLevel[v];
  });
  const std::array<int, 3> strides = {1, box.size[0], box.size[0] * box.size[1]};
  const auto placeOnLink = [&](std::int32_t p, const std::array<int, 3>& s, int d, bool isInner) {
    const std::vector<float>& level = isInner ? inner : outer;
    const float outward = isInner ? 1.0F : -1.0F;  // makes the tissue's side positive
    const int a = axisOf(d), step = signOf(d) * strides[a];
    const double here = outward * level[p], there = outward * level[p + step];
    if (!(here > 0 && there <= 0)) return 0.5;
    const int twoOn = s[a] + 2 * signOf(d), oneBack = s[a] - signOf(d);
    const double linearBack = 2 * here - there, linearOn = 2 * there - here;
    const bool on = twoOn >= 0 && twoOn < box.size[a];
    const bool back = oneBack >= 0 && oneBack < box.size[a];
    return crossing(back ? outward * level[p - step] : linearBack, here, there,
                    on ? outward * level[p + 2 * step] : linearOn);
  };
  return assemble(grid, box, std::move(found.sites), placeOnLink, options, monitor);
}

Annulus annulusFromSites(const Volume<Site>& sites, const PlaceOnLink& placeOnLink,
                         const AnnulusOptions& options, const Monitor& monitor) {
  BoxOfSites found = boxOf(sites, 1);
  const auto inGrid = [&placeOnLink, first = found.box.first](
                          std::int32_t, const std::array<int, 3>& s, int d, bool inner) {
    return placeOnLink({s[0] + first[0], s[1] + first[1], s[2] + first[2]}, d, inner);
  };
  return assemble(found.grid, found.box, std::move(found.sites), inGrid, options, monitor);
}

Annulus annulusFromLevels(const Volume<float>& inner, const Volume<float>& outer,
                          const LevelOptions& levels, const AnnulusOptions& options,
                          const Volume<std::uint8_t>& insulated, const Monitor& monitor) {
  checkGrid(inner.grid);
  if (!sameGrid(inner.grid, outer.grid)) {
    throw InvalidInput("the inner and the outer level set lie on different grids");
  }
  const Grid& grid = inner.grid;
  const bool haveInsulated = insulated.size() > 0;
  if (haveInsulated && !sameGrid(grid, insulated.grid)) {
    throw InvalidInput("the insulated region lies on another grid than the level sets");
  }
  // Sign that makes a level set negative inside.
  const auto signOfInside = [&](const Volume<float>& volume, const char* name) {
    std::size_t above = 0, borderAbove = 0, border = 0;
    for (std::size_t v = 0; v < volume.size(); ++v) {
      if (!std::isfinite(volume[v])) {
        throw InvalidInput(std::string("the ") + name +
                           " level set holds a value that is not finite");
      }
      const bool isAbove = volume[v] > levels.level;
      above += isAbove;
      const auto s = grid.subscripts(v);
      const bool onBorder =
          s[0] == 0 || s[1] == 0 || s[0] + 1 == grid.size[0] || s[1] + 1 == grid.size[1];
      border += onBorder;
      borderAbove += onBorder && isAbove;
    }
    if (above == 0 || above == volume.size()) {
      throw InvalidInput(std::string("the ") + name + " level set is nowhere equal to " +
                         std::to_string(levels.level) + "; all its values are on one side");
    }
    if (levels.inside == LevelInside::Above) return -1.0F;
    if (levels.inside == LevelInside::Below) return 1.0F;
    return 2 * borderAbove >= border ? 1.0F : -1.0F;
  };
  const float innerSign = signOfInside(inner, "inner");
  const float outerSign = signOfInside(outer, "outer");
  Volume<float> innerLevel(grid), outerLevel(grid);
  Volume<Site> sites(grid, Site::Outer);
  parallelFor(grid.voxelCount(), 1 << 16, [&](std::size_t v) {
    innerLevel[v] = innerSign * (inner[v] - static_cast<float>(levels.level));
    outerLevel[v] = outerSign * (outer[v] - static_cast<float>(levels.level));
    if (haveInsulated && insulated[v]) {
      sites[v] = Site::Insulated;
    } else if (innerLevel[v] <= 0) {
      sites[v] = Site::Inner;
    } else if (outerLevel[v] < 0) {
      sites[v] = Site::Tissue;
    }
  });
  return annulusFromSites(sites, innerLevel, outerLevel, options, monitor);
}

}  // namespace explica::harmonic
