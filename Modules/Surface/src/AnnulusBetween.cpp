// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "AnnulusBetween.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>

namespace explica::surface {
namespace {

/// Grid lines pass by a mesh's vertices by such shares of a voxel, which no mesh knows of.
constexpr std::array kAside = {1e-5, 1.4142e-5, 1.7321e-5};

/// On which side of the line from a to b, in the plane of two coordinates, a point lies.  The sign
/// is the opposite one for b and a, to the last bit, so that a point beside a shared edge is in
/// one of its two faces.
double sideOf(const std::array<double, 2>& a, const std::array<double, 2>& b, double y, double z) {
  if (b < a) return -sideOf(b, a, y, z);
  const double side = (b[0] - a[0]) * (z - a[1]) - (b[1] - a[1]) * (y - a[0]);
  return side != 0 ? side : 1e-300;
}

/// Calls visit(y, z, x) wherever a line along the first of three axes meets a triangle.
template <class Visit>
void forLinesThrough(const std::array<Vector, 3>& corner, const std::array<int, 3>& axes,
                     const std::array<int, 3>& size, Visit visit) {
  std::array<std::array<double, 2>, 3> flat;
  for (int c = 0; c < 3; ++c) flat[c] = {corner[c][axes[1]], corner[c][axes[2]]};
  std::array<int, 2> low, high;
  for (int a = 0; a < 2; ++a) {
    const auto [least, most] = std::minmax({flat[0][a], flat[1][a], flat[2][a]});
    low[a] = std::max(0, static_cast<int>(std::ceil(least)));
    high[a] = std::min(size[axes[a + 1]] - 1, static_cast<int>(std::floor(most)));
  }
  for (int z = low[1]; z <= high[1]; ++z) {
    for (int y = low[0]; y <= high[0]; ++y) {
      const Vector side(sideOf(flat[1], flat[2], y, z), sideOf(flat[2], flat[0], y, z),
                        sideOf(flat[0], flat[1], y, z));
      if (!((side.array() > 0).all() || (side.array() < 0).all())) continue;
      const Vector share = side / side.sum();
      double x = 0;
      for (int c = 0; c < 3; ++c) x += share[c] * corner[c][axes[0]];
      visit(y, z, x);
    }
  }
}

}  // namespace

GridCrossings::GridCrossings(const TriangleMesh& mesh, const Grid& grid) : size_(grid.size) {
  Positions index(mesh.vertexCount(), 3);
  parallelFor(static_cast<std::size_t>(index.rows()), 4096, [&](std::size_t v) {
    const auto row = static_cast<Eigen::Index>(v);
    const Vector at = grid.toIndex(mesh.positions.row(row));
    index.row(row) = at + Vector(kAside[0], kAside[1], kAside[2]);
  });
  parallelFor(3, 1, [&](std::size_t axis) {
    lines_[axis] = along(index, mesh.faces, static_cast<int>(axis));
  });
}

std::size_t GridCrossings::lineOf(const std::array<int, 3>& voxel, int axis) const {
  const int b = (axis + 1) % 3, c = (axis + 2) % 3;
  return voxel[b] + static_cast<std::size_t>(size_[b]) * voxel[c];
}

GridCrossings::Lines GridCrossings::along(const Positions& index, const Faces& faces,
                                          int axis) const {
  const std::array<int, 3> axes = {axis, (axis + 1) % 3, (axis + 2) % 3};
  Lines lines;
  lines.first.assign(static_cast<std::size_t>(size_[axes[1]]) * size_[axes[2]] + 2, 0);
  const auto forAll = [&](auto visit) {
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
      const std::array<Vector, 3> corner = {index.row(faces(f, 0)), index.row(faces(f, 1)),
                                            index.row(faces(f, 2))};
      forLinesThrough(corner, axes, size_, [&](int y, int z, double x) {
        visit(y + static_cast<std::size_t>(size_[axes[1]]) * z, x);
      });
    }
  };
  forAll([&](std::size_t line, double) { ++lines.first[line + 2]; });
  for (std::size_t n = 1; n < lines.first.size(); ++n) lines.first[n] += lines.first[n - 1];
  lines.at.resize(static_cast<std::size_t>(lines.first.back()));
  forAll([&](std::size_t line, double x) {
    lines.at[lines.first[line + 1]++] = static_cast<float>(x);
  });
  lines.first.pop_back();
  for (std::size_t n = 0; n + 1 < lines.first.size(); ++n) {
    std::sort(lines.at.begin() + lines.first[n], lines.at.begin() + lines.first[n + 1]);
  }
  return lines;
}

bool GridCrossings::inside(const std::array<int, 3>& voxel) const {
  const Lines& lines = lines_[0];
  const std::size_t line = lineOf(voxel, 0);
  const auto begin = lines.at.begin() + lines.first[line];
  const auto end = lines.at.begin() + lines.first[line + 1];
  return (std::lower_bound(begin, end, static_cast<float>(voxel[0])) - begin) % 2 == 1;
}

std::optional<std::pair<double, double>> GridCrossings::between(const std::array<int, 3>& voxel,
                                                                int axis) const {
  const Lines& lines = lines_[axis];
  const std::size_t line = lineOf(voxel, axis);
  const auto begin = lines.at.begin() + lines.first[line];
  const auto end = lines.at.begin() + lines.first[line + 1];
  const auto here = static_cast<float>(voxel[axis]);
  const auto from = std::lower_bound(begin, end, here);
  const auto to = std::lower_bound(from, end, here + 1);
  if (from == to) return std::nullopt;
  return std::pair<double, double>(*from - here, *std::prev(to) - here);
}

namespace {

/// Of the first crossing on the link from a voxel to a neighbour, as a share of it.
double placeOf(const GridCrossings& crossings, const std::array<int, 3>& voxel, int direction) {
  const int axis = direction / 2;
  const bool down = direction % 2 == 0;
  std::array<int, 3> from = voxel;
  from[axis] -= down ? 1 : 0;
  const auto found = crossings.between(from, axis);
  return !found ? 0.5 : down ? 1 - found->second : found->first;
}

/// Where a closed surface and what bounds the tissue outside cross the links of a grid.
template <class Kind, class OuterPlace>
harmonic::Annulus annulusOn(const Grid& grid, const GridCrossings& white, const Kind& siteOutside,
                            const OuterPlace& outerPlace, const Monitor& monitor) {
  Volume<harmonic::Site> sites(grid);
  parallelFor(sites.size(), 1 << 14, [&](std::size_t v) {
    const auto voxel = grid.subscripts(v);
    sites[v] = white.inside(voxel) ? harmonic::Site::Inner : siteOutside(voxel);
  });
  const auto placeOnLink = [&](const std::array<int, 3>& voxel, int direction, bool inner) {
    return inner ? placeOf(white, voxel, direction) : outerPlace(voxel, direction);
  };
  return harmonic::annulusFromSites(sites, placeOnLink, {}, monitor);
}

/// Cuts where a surface passes twice between neighbouring tissue voxels.
void addCuts(const harmonic::Annulus& annulus, const GridCrossings& crossings, bool inner,
             std::vector<harmonic::Cut>& cuts) {
  for (std::size_t n = 0; n < annulus.count(); ++n) {
    const auto voxel = annulus.voxel(static_cast<std::int32_t>(n));
    for (int axis = 0; axis < 3; ++axis) {
      if (annulus.links[n][2 * axis + 1] < 0) continue;
      const auto sheet = crossings.between(voxel, axis);
      if (!sheet) continue;
      cuts.push_back({static_cast<std::int32_t>(n), axis, sheet->first, 1 - sheet->second, inner});
    }
  }
}

harmonic::Annulus cutBy(const std::vector<harmonic::Cut>& cuts, harmonic::Annulus annulus) {
  return cuts.empty() ? annulus : harmonic::withCuts(annulus, cuts);
}

/// How often each axis of a grid goes into voxels as short as the shortest.
Vector splitsOf(const Grid& grid) {
  return (grid.spacing / grid.spacing.minCoeff()).array().round();
}

Grid split(Grid grid, const Vector& times) {
  grid.origin = grid.toWorld(0.5 * (times.cwiseInverse() - Vector::Ones()));
  grid.spacing = grid.spacing.cwiseQuotient(times);
  for (int a = 0; a < 3; ++a) grid.size[a] *= static_cast<int>(times[a]);
  return grid;
}

}  // namespace

bool hasLongVoxels(const Grid& grid) {
  return splitsOf(grid) != Vector::Ones();
}

harmonic::Annulus annulusBetween(const TriangleMesh& white, const CorticalTissue& tissue,
                                 const Monitor& monitor) {
  using harmonic::Site;
  const LevelSet& outer = tissue.tissue;
  const Grid& grid = outer.grid;
  const GridCrossings crossings(white, grid);
  const auto kind = [&](const std::array<int, 3>& at) {
    const std::size_t v = grid.linear(at[0], at[1], at[2]);
    return tissue.insulated[v] ? Site::Insulated : outer[v] > 0 ? Site::Tissue : Site::Outer;
  };
  const auto outerPlace = [&](const std::array<int, 3>& voxel, int direction) {
    std::array<int, 3> next = voxel;
    next[direction / 2] += direction % 2 == 0 ? -1 : 1;
    const double here = outer(voxel[0], voxel[1], voxel[2]);
    const double there = outer(next[0], next[1], next[2]);
    return there < 0 ? here / (here - there) : 0.5;
  };
  harmonic::Annulus annulus = annulusOn(grid, crossings, kind, outerPlace, monitor);
  std::vector<harmonic::Cut> cuts;
  addCuts(annulus, crossings, true, cuts);
  return cutBy(cuts, std::move(annulus));
}

harmonic::Annulus annulusBetween(const TriangleMesh& white, const TriangleMesh& pial,
                                 const Volume<std::uint8_t>& insulated, const Monitor& monitor) {
  using harmonic::Site;
  const Vector times = splitsOf(insulated.grid);
  const Grid grid = split(insulated.grid, times);
  const GridCrossings inner(white, grid), outer(pial, grid);
  const auto kind = [&](const std::array<int, 3>& at) {
    std::array<int, 3> whole;
    for (int a = 0; a < 3; ++a) whole[a] = at[a] / static_cast<int>(times[a]);
    return insulated(whole[0], whole[1], whole[2]) != 0 ? Site::Insulated
           : outer.inside(at)                           ? Site::Tissue
                                                        : Site::Outer;
  };
  const auto outerPlace = [&](const std::array<int, 3>& voxel, int direction) {
    return placeOf(outer, voxel, direction);
  };
  harmonic::Annulus annulus = annulusOn(grid, inner, kind, outerPlace, monitor);
  std::vector<harmonic::Cut> cuts;
  addCuts(annulus, outer, false, cuts);
  addCuts(annulus, inner, true, cuts);
  return cutBy(cuts, std::move(annulus));
}

}  // namespace explica::surface
