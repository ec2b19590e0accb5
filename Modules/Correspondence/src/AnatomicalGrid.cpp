// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/AnatomicalGrid.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Field.h"

#include <algorithm>
#include <map>
#include <vector>

namespace explica::correspondence {

namespace {

constexpr int kMaxSteps = 4000;

struct Seed {
  Vector x;           ///< box index
  std::int32_t home;  ///< tissue voxel of its side
};

/// Points of a trajectory from its seed to a boundary.
bool follow(const TrajectoryTracer::Field& field, const Seed& seed, int uphill,
            std::vector<Vector>& points, std::vector<double>& lengths) {
  auto walk = field.begin(seed.x, seed.home, uphill);
  points.assign(1, walk.x);
  lengths.assign(1, 0.0);
  const double target = uphill > 0 ? 1 : 0;
  bool done = uphill * (walk.u - target) >= 0;
  for (int k = 0; !done && !walk.stuck && k < kMaxSteps; ++k) {
    done = field.advance(walk, target, uphill);
    points.push_back(walk.x);
    lengths.push_back(walk.length);
  }
  return done;
}

}  // namespace

AnatomicalGrid anatomicalGrid(const harmonic::Annulus& annulus,
                              const harmonic::Interpolant& interpolant, int levels) {
  if (levels < 1) throw InvalidInput("the anatomical grid needs at least one layer of cells");
  const TrajectoryTracer tracer(annulus, interpolant);
  const auto& field = tracer.field();
  const bool planar = annulus.planar;
  std::map<std::array<std::int32_t, 4>, std::int32_t> seedAt;  // corner (doubled index), in order
  std::vector<Seed> seeds;
  std::vector<std::array<std::int32_t, 4>> faces;
  const auto seedOf = [&](const std::array<std::int32_t, 3>& doubled, std::int32_t home) {
    const auto [at, isNew] = seedAt.try_emplace({doubled[0], doubled[1], doubled[2], 0},
                                                static_cast<std::int32_t>(seeds.size()));
    if (isNew) seeds.push_back({0.5 * Vector(doubled[0], doubled[1], doubled[2]), home});
    return at->second;
  };
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
    if (interpolant.u[n] >= 0.5) continue;
    const auto s = annulus.boxSubscripts(n);
    for (int d = 0; d < (planar ? 4 : 6); ++d) {
      const std::int32_t m = annulus.links[n][d];
      if (m < 0 || interpolant.u[m] < 0.5) continue;
      const int a = harmonic::axisOf(d), b = planar ? 1 - a : (a + 1) % 3, c = (a + 2) % 3;
      std::array<std::int32_t, 3> centre = {2 * s[0], 2 * s[1], 2 * s[2]};
      centre[a] += harmonic::signOf(d);
      std::array<std::int32_t, 4> face = {-1, -1, -1, -1};
      for (int corner = 0; corner < (planar ? 2 : 4); ++corner) {
        auto at = centre;
        at[b] += (corner == 1 || corner == 2) ? 1 : -1;
        if (!planar) at[c] += corner >= 2 ? 1 : -1;
        face[corner] = seedOf(at, n);
      }
      // Counter-clockwise seen from the outer side, as VTK wants the lower face of a cell.
      if (harmonic::signOf(d) < 0) std::swap(face[0], face[planar ? 1 : 2]);
      faces.push_back(face);
    }
  }

  AnatomicalGrid grid;
  const int rows = levels + 1;
  grid.trajectories = seeds.size();
  grid.points.resize(static_cast<Eigen::Index>(seeds.size()) * rows, 3);
  grid.depth.resize(grid.points.rows());
  grid.thickness.resize(grid.points.rows());
  std::vector<std::uint8_t> whole(seeds.size(), 0);
  parallelForBlocks(seeds.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<Vector> down, up;
    std::vector<double> downLength, upLength;
    for (std::size_t k = begin; k < end; ++k) {
      const bool inner = follow(field, seeds[k], -1, down, downLength);
      const bool outer = follow(field, seeds[k], 1, up, upLength);
      whole[k] = inner && outer;
      const double thickness = downLength.back() + upLength.back();
      std::reverse(down.begin(), down.end());
      std::vector<double> length;
      for (auto it = downLength.rbegin(); it != downLength.rend(); ++it) {
        length.push_back(downLength.back() - *it);
      }
      for (std::size_t q = 1; q < up.size(); ++q) {
        down.push_back(up[q]);
        length.push_back(downLength.back() + upLength[q]);
      }
      std::size_t segment = 0;
      for (int row = 0; row < rows; ++row) {
        const double wanted = thickness * row / levels;
        while (segment + 2 < length.size() && length[segment + 1] < wanted) ++segment;
        Vector x = down[segment];
        if (length.size() > 1) {
          const double span = length[segment + 1] - length[segment];
          const double t = span > 0 ? std::clamp((wanted - length[segment]) / span, 0.0, 1.0) : 0;
          x += t * (down[segment + 1] - down[segment]);
        }
        const auto at = static_cast<Eigen::Index>(k) * rows + row;
        grid.points.row(at) = field.toWorld(x).transpose();
        grid.depth[at] = static_cast<double>(row) / levels;
        grid.thickness[at] = thickness;
      }
    }
  });
  for (const std::uint8_t w : whole) grid.lost += w == 0;
  const int corners = planar ? 2 : 4;
  std::erase_if(faces, [&](const std::array<std::int32_t, 4>& face) {
    for (int c = 0; c < corners; ++c) {
      if (!whole[face[c]]) return true;
    }
    return false;
  });
  grid.cells.resize(static_cast<Eigen::Index>(faces.size()) * levels, 2 * corners);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int row = 0; row < levels; ++row) {
      const auto at = static_cast<Eigen::Index>(f) * levels + row;
      for (int c = 0; c < corners; ++c) {
        grid.cells(at, c) = faces[f][c] * rows + row;
        // A quadrilateral runs around, a hexahedron lists the upper face in the lower one's order.
        const int above = planar ? 2 * corners - 1 - c : corners + c;
        grid.cells(at, above) = faces[f][c] * rows + row + 1;
      }
    }
  }
  return grid;
}

}  // namespace explica::correspondence
