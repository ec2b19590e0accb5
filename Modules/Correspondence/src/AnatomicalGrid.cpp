// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/AnatomicalGrid.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Field.h"
#include "HalfwaySurface.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <vector>

namespace explica::correspondence {

namespace {

/// A corner's Jacobian over the product of its three edges' lengths (its two edges' in the plane),
/// at and below which a cell is flat: well above the round-off of coordinates in single precision.
constexpr double kLevel = 1e-4;

/// A polyline in box indices with arc lengths, mm.
struct BoxPath {
  std::vector<Vector> points;
  std::vector<double> lengths;
};

/// Points of a trajectory from a vertex to a boundary; false if it does not get there.
bool follow(const TrajectoryTracer::Field& field, const HalfwaySurface::Vertex& start, int uphill,
            BoxPath& path) {
  auto walk = field.begin(start.x, start.home, uphill);
  path.points.assign(1, walk.x);
  path.lengths.assign(1, 0.0);
  const double target = uphill > 0 ? 1 : 0;
  bool done = uphill * (walk.u - target) >= 0;
  for (int k = 0; !done && !walk.stuck && k < kMaxSteps; ++k) {
    done = field.advance(walk, target, uphill);
    path.points.push_back(walk.x);
    path.lengths.push_back(walk.length);
  }
  return done;
}

/// The two halves as one path from the inner to the outer boundary.
BoxPath joined(const BoxPath& down, const BoxPath& up) {
  BoxPath whole;
  for (std::size_t q = down.points.size(); q-- > 0;) {
    whole.points.push_back(down.points[q]);
    whole.lengths.push_back(down.lengths.back() - down.lengths[q]);
  }
  for (std::size_t q = 1; q < up.points.size(); ++q) {
    whole.points.push_back(up.points[q]);
    whole.lengths.push_back(down.lengths.back() + up.lengths[q]);
  }
  return whole;
}

/// The point at an arc length; `segment` is where the search begins and ends.
Vector pointAt(const BoxPath& path, double length, std::size_t& segment) {
  if (path.points.size() == 1) return path.points[0];
  while (segment + 2 < path.lengths.size() && path.lengths[segment + 1] < length) ++segment;
  const double span = path.lengths[segment + 1] - path.lengths[segment];
  const double t = span > 0 ? std::clamp((length - path.lengths[segment]) / span, 0.0, 1.0) : 0;
  return path.points[segment] + t * (path.points[segment + 1] - path.points[segment]);
}

/// Fills the points of all trajectories; 1 for those that reach both boundaries.
std::vector<std::uint8_t> followAll(const TrajectoryTracer::Field& field,
                                    const HalfwaySurface& surface, int levels,
                                    AnatomicalGrid& grid) {
  const int rows = levels + 1;
  grid.trajectories = surface.vertices.size();
  grid.points.resize(static_cast<Eigen::Index>(grid.trajectories) * rows, 3);
  grid.depth.resize(grid.points.rows());
  grid.thickness.resize(grid.points.rows());
  std::vector<std::uint8_t> whole(grid.trajectories, 0);
  parallelForBlocks(grid.trajectories, 256, [&](std::size_t begin, std::size_t end) {
    BoxPath down, up;
    for (std::size_t k = begin; k < end; ++k) {
      const bool inner = follow(field, surface.vertices[k], -1, down);
      const bool outer = follow(field, surface.vertices[k], 1, up);
      whole[k] = inner && outer;
      const BoxPath path = joined(down, up);
      std::size_t segment = 0;
      for (int row = 0; row < rows; ++row) {
        const auto at = static_cast<Eigen::Index>(k) * rows + row;
        const Vector x = pointAt(path, path.lengths.back() * row / levels, segment);
        grid.points.row(at) = field.toWorld(x).transpose();
        grid.depth[at] = static_cast<double>(row) / levels;
        grid.thickness[at] = path.lengths.back();
      }
    }
  });
  return whole;
}

/// True where cells made of faces and rows, in this order, have a positive volume in RAS.
bool rightHanded(const harmonic::Annulus& annulus) {
  const Eigen::Matrix3d& axes = annulus.grid.direction;
  if (!annulus.planar) return axes.determinant() > 0;
  const Vector normal = axes.col(0).cross(axes.col(1));
  Eigen::Index greatest = 0;
  normal.cwiseAbs().maxCoeff(&greatest);
  return normal[greatest] > 0;
}

/// Cells of all columns whose trajectories are whole.
void stackCells(const std::vector<std::array<std::int32_t, 4>>& faces, int corners, int levels,
                bool swap, AnatomicalGrid& grid) {
  grid.cells.resize(static_cast<Eigen::Index>(faces.size()) * levels, 2 * corners);
  const int rows = levels + 1;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    auto face = faces[f];
    if (swap) std::swap(face[0], face[corners == 4 ? 2 : 1]);
    for (int row = 0; row < levels; ++row) {
      const auto at = static_cast<Eigen::Index>(f) * levels + row;
      for (int c = 0; c < corners; ++c) {
        // A quadrilateral runs around, a hexahedron lists the upper face in the lower one's order.
        const int above = corners == 2 ? 3 - c : corners + c;
        grid.cells(at, c) = face[c] * rows + row;
        grid.cells(at, above) = face[c] * rows + row + 1;
      }
    }
  }
}

/// The lowest share of a right corner's volume over the corners of a cell and its middle.
double lowestCorner(const AnatomicalGrid& grid, Eigen::Index cell) {
  const auto at = [&](int c) -> Vector { return grid.points.row(grid.cells(cell, c)).transpose(); };
  double lowest = kInfinity;
  const auto add = [&](double volume, double lengths) {
    lowest = std::min(lowest, lengths > 0 ? volume / lengths : 0.0);
  };
  if (grid.cells.cols() == 4) {
    for (int c = 0; c < 4; ++c) {
      const Vector a = at((c + 1) % 4) - at(c), b = at((c + 3) % 4) - at(c);
      add(a.cross(b).dot(grid.normal), a.norm() * b.norm());
    }
    return lowest;
  }
  for (int c = 0; c < 8; ++c) {
    const int base = c & 4, k = c & 3;
    const Vector a = at(base + (k + 1) % 4) - at(c), b = at(base + (k + 3) % 4) - at(c);
    const Vector along = base == 0 ? Vector(at(c + 4) - at(c)) : Vector(at(c) - at(c - 4));
    add(a.cross(b).dot(along), a.norm() * b.norm() * along.norm());
  }
  // Right at its corners, a twisted cell may still be turned over in the middle.
  const Vector r = at(1) + at(2) + at(5) + at(6) - at(0) - at(3) - at(4) - at(7);
  const Vector s = at(2) + at(3) + at(6) + at(7) - at(0) - at(1) - at(4) - at(5);
  const Vector t = at(4) + at(5) + at(6) + at(7) - at(0) - at(1) - at(2) - at(3);
  add(r.cross(s).dot(t), r.norm() * s.norm() * t.norm());
  return lowest;
}

/// Six times the volume between the origin and a bilinear face: the mean of both its
/// triangulations.
double beneath(const Vector& a, const Vector& b, const Vector& c, const Vector& d) {
  const auto det = [](const Vector& p, const Vector& q, const Vector& r) {
    return p.dot(q.cross(r));
  };
  return 0.5 * (det(a, b, c) + det(a, c, d) + det(a, b, d) + det(b, c, d));
}

/// mm^3 of a hexahedron, mm^2 of a quadrilateral.
double volumeOf(const AnatomicalGrid& grid, Eigen::Index cell) {
  const Vector origin = grid.points.row(grid.cells(cell, 0)).transpose();
  const auto at = [&](int c) -> Vector {
    return grid.points.row(grid.cells(cell, c)).transpose() - origin;
  };
  if (grid.cells.cols() == 4) return 0.5 * at(2).cross(at(3) - at(1)).norm();
  constexpr std::array<std::array<int, 4>, 6> kFaces = {
      {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
  double sum = 0;
  for (const auto& f : kFaces) sum += beneath(at(f[0]), at(f[1]), at(f[2]), at(f[3]));
  return sum / 6;
}

/// Takes out the cells that are turned over or flat at a corner.
void leaveOutDegenerate(AnatomicalGrid& grid) {
  std::vector<std::uint8_t> good(static_cast<std::size_t>(grid.cells.rows()));
  parallelFor(good.size(), 1024, [&](std::size_t c) {
    good[c] = lowestCorner(grid, static_cast<Eigen::Index>(c)) > kLevel;
  });
  Eigen::Index kept = 0;
  for (std::size_t c = 0; c < good.size(); ++c) {
    if (!good[c]) continue;
    grid.cells.row(kept++) = grid.cells.row(static_cast<Eigen::Index>(c));
  }
  grid.degenerate = good.size() - static_cast<std::size_t>(kept);
  grid.cells.conservativeResize(kept, Eigen::NoChange);
}

}  // namespace

AnatomicalGrid anatomicalGrid(const harmonic::Annulus& annulus,
                              const harmonic::Interpolant& interpolant, int levels) {
  if (levels < 1) throw InvalidInput("the anatomical grid needs at least one layer of cells");
  const TrajectoryTracer tracer(annulus, interpolant);
  HalfwaySurface surface = halfwaySurface(annulus, interpolant.u);
  AnatomicalGrid grid;
  const std::vector<std::uint8_t> whole = followAll(tracer.field(), surface, levels, grid);
  for (const std::uint8_t w : whole) grid.lost += w == 0;
  const int corners = annulus.planar ? 2 : 4;
  std::erase_if(surface.faces, [&](const std::array<std::int32_t, 4>& face) {
    return !std::all_of(face.begin(), face.begin() + corners,
                        [&](std::int32_t v) { return whole[v] != 0; });
  });
  const bool right = rightHanded(annulus);
  if (annulus.planar) {
    grid.normal = annulus.grid.direction.col(0).cross(annulus.grid.direction.col(1));
    if (!right) grid.normal = -grid.normal;
  }
  stackCells(surface.faces, corners, levels, !right, grid);
  leaveOutDegenerate(grid);
  for (Eigen::Index c = 0; c < grid.cells.rows(); ++c) grid.volume += volumeOf(grid, c);
  return grid;
}

}  // namespace explica::correspondence
