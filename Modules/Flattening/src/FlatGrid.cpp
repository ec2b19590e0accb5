// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/FlatGrid.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/Predicates.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace explica::flattening {
namespace {

using Plane = Eigen::Vector2d;

const Eigen::Vector3f kUnknown = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());

double meanDistance(const FlatSheet& sheet) {
  double sum = 0;
  for (Eigen::Index f = 0; f < sheet.faces.rows(); ++f) {
    const std::int32_t v = sheet.faces(f, 0);
    sum += (sheet.outer.row(v) - sheet.inner.row(v)).norm();
  }
  return sum / static_cast<double>(sheet.faces.rows());
}

Grid gridOver(const FlatSheet& sheet, const FlatGridOptions& options) {
  Plane low = Plane::Constant(kInfinity), high = -low;
  for (Eigen::Index f = 0; f < sheet.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const Plane p = sheet.flat.row(sheet.faces(f, k)).head<2>().transpose();
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  Grid grid;
  double cells = options.depths;
  for (int axis = 0; axis < 2; ++axis) {
    const double count = std::ceil((high[axis] - low[axis]) / options.cell) + 1;
    cells *= count;
    if (cells > 0x1p30) throw InvalidInput("grid: cells of this size make more than 2^30 of them");
    grid.size[axis] = static_cast<int>(count);
    grid.origin[axis] = low[axis];
    grid.spacing[axis] = options.cell;
  }
  grid.size[2] = options.depths;
  grid.origin[2] = 0;
  const double thickness = meanDistance(sheet);
  const bool stack = options.depths > 1 && thickness > 0;
  grid.spacing[2] = stack ? thickness / (options.depths - 1) : options.cell;
  return grid;
}

/// Where a cell's centre lies in the map: a face and the weights of its corners.
struct MapPlace {
  std::int32_t face = -1;
  Vector weights = Vector::Zero();
};

Plane cornerOf(const FlatSheet& sheet, Eigen::Index f, int k) {
  return sheet.flat.row(sheet.faces(f, k)).head<2>().transpose();
}

/// Face of each cell's centre.  The sides of a face belong to it, and which points are on a side is
/// decided exactly, so that no centre falls between two faces.
std::vector<MapPlace> placesOf(const FlatSheet& sheet, const Grid& grid) {
  std::vector<MapPlace> places(static_cast<std::size_t>(grid.size[0]) * grid.size[1]);
  const auto cross = [](const Plane& a, const Plane& b) { return a.x() * b.y() - a.y() * b.x(); };
  for (Eigen::Index f = 0; f < sheet.faces.rows(); ++f) {
    const std::array<Plane, 3> p = {cornerOf(sheet, f, 0), cornerOf(sheet, f, 1),
                                    cornerOf(sheet, f, 2)};
    const Plane low = p[0].cwiseMin(p[1]).cwiseMin(p[2]), high = p[0].cwiseMax(p[1]).cwiseMax(p[2]);
    std::array<int, 2> first{}, last{};
    for (int axis = 0; axis < 2; ++axis) {
      const double step = grid.spacing[axis], origin = grid.origin[axis];
      first[axis] = std::max(0, static_cast<int>(std::floor((low[axis] - origin) / step)));
      last[axis] =
          std::min(grid.size[axis] - 1, static_cast<int>(std::ceil((high[axis] - origin) / step)));
    }
    const double area = cross(p[1] - p[0], p[2] - p[0]);
    for (int j = first[1]; j <= last[1]; ++j) {
      for (int i = first[0]; i <= last[0]; ++i) {
        const Plane at(grid.origin[0] + i * grid.spacing[0], grid.origin[1] + j * grid.spacing[1]);
        bool inside = true;
        for (int k = 0; k < 3 && inside; ++k) {
          inside = geometry::orientation(p[k], p[(k + 1) % 3], at) >= 0;
        }
        MapPlace& place = places[i + static_cast<std::size_t>(grid.size[0]) * j];
        if (!inside || place.face >= 0) continue;
        place.face = static_cast<std::int32_t>(f);
        for (int k = 0; k < 3; ++k) {
          place.weights[k] = cross(p[(k + 1) % 3] - at, p[(k + 2) % 3] - at) / area;
        }
      }
    }
  }
  return places;
}

/// Coefficients, by powers of depth, of the corners relative to x of a face between the surfaces.
struct Prism {
  std::array<Vector, 3> at0, way;
};

Prism prismOf(const FlatSheet& sheet, Eigen::Index f, const Point& x) {
  Prism prism;
  for (int k = 0; k < 3; ++k) {
    const std::int32_t v = sheet.faces(f, k);
    prism.at0[k] = sheet.inner.row(v).transpose() - x;
    prism.way[k] = (sheet.outer.row(v) - sheet.inner.row(v)).transpose();
  }
  return prism;
}

/// Six times the volume between x and the face at a depth: zero where the face holds x.
double height(const Prism& prism, double depth) {
  const Vector a = prism.at0[0] + depth * prism.way[0], b = prism.at0[1] + depth * prism.way[1];
  const Vector c = prism.at0[2] + depth * prism.way[2];
  return a.dot(b.cross(c));
}

/// Depths in [0, 1] where the face holds x, found between samples of a cubic.
std::vector<double> depthsOf(const Prism& prism) {
  constexpr int kPieces = 8;  // a cubic has three roots; two within an eighth are not told apart
  std::vector<double> depths;
  double before = height(prism, 0);
  for (int n = 1; n <= kPieces; ++n) {
    double low = (n - 1.0) / kPieces, high = static_cast<double>(n) / kPieces;
    const double after = height(prism, high);
    if (before == 0) depths.push_back(low);
    if ((before < 0 && after > 0) || (before > 0 && after < 0)) {
      for (int halving = 0; halving < 48; ++halving) {
        const double middle = (low + high) / 2;
        ((height(prism, middle) > 0) == (before > 0) ? low : high) = middle;
      }
      depths.push_back((low + high) / 2);
    }
    before = after;
  }
  if (before == 0) depths.push_back(1);
  return depths;
}

/// Weights of the corners of the face at a depth for x in its plane.
Vector weightsAt(const Prism& prism, double depth) {
  std::array<Vector, 3> p;
  for (int k = 0; k < 3; ++k) p[k] = prism.at0[k] + depth * prism.way[k];
  const Vector normal = (p[1] - p[0]).cross(p[2] - p[0]);
  Vector weights;
  for (int k = 0; k < 3; ++k) {
    weights[k] = normal.dot(p[(k + 1) % 3].cross(p[(k + 2) % 3])) / normal.squaredNorm();
  }
  return weights;
}

}  // namespace

double depthOfLayer(int k, int depths) {
  return depths == 1 ? 0.5 : static_cast<double>(k) / (depths - 1);
}

Volume<Eigen::Vector3f> flatGrid(const FlatSheet& sheet, const FlatGridOptions& options) {
  if (!(options.cell > 0) || !std::isfinite(options.cell)) {
    throw InvalidInput("grid: cells must be larger than 0 mm");
  }
  if (options.depths < 1) throw InvalidInput("depths: must be 1 or more");
  Volume<Eigen::Vector3f> points(gridOver(sheet, options), kUnknown);
  const Grid& grid = points.grid;
  const auto places = placesOf(sheet, grid);
  parallelFor(places.size(), [&](std::size_t n) {
    const MapPlace& place = places[n];
    if (place.face < 0) return;
    Point inner = Point::Zero(), outer = Point::Zero();
    for (int k = 0; k < 3; ++k) {
      const std::int32_t v = sheet.faces(place.face, k);
      inner += place.weights[k] * sheet.inner.row(v).transpose();
      outer += place.weights[k] * sheet.outer.row(v).transpose();
    }
    for (int k = 0; k < options.depths; ++k) {
      const double depth = depthOfLayer(k, options.depths);
      points[n + places.size() * static_cast<std::size_t>(k)] =
          (inner + depth * (outer - inner)).cast<float>();
    }
  });
  return points;
}

Volume<Eigen::Vector3f> flatCoordinates(const FlatSheet& sheet, const Grid& grid) {
  constexpr double kSlack = 1e-9;  // of a face: a voxel on the side of two faces belongs to both
  Volume<Eigen::Vector3f> coordinates(grid, kUnknown);
  for (Eigen::Index f = 0; f < sheet.faces.rows(); ++f) {
    Vector low = Vector::Constant(kInfinity), high = -low;
    for (int k = 0; k < 3; ++k) {
      for (const Positions* surface : {&sheet.inner, &sheet.outer}) {
        const Vector index = grid.toIndex(surface->row(sheet.faces(f, k)).transpose());
        low = low.cwiseMin(index);
        high = high.cwiseMax(index);
      }
    }
    std::array<int, 3> first{}, last{};
    for (int axis = 0; axis < 3; ++axis) {
      const double limit = grid.size[axis] - 1.0;
      first[axis] = static_cast<int>(std::clamp(std::ceil(low[axis]), 0.0, limit + 1));
      last[axis] = static_cast<int>(std::clamp(std::floor(high[axis]), -1.0, limit));
    }
    for (int k = first[2]; k <= last[2]; ++k) {
      for (int j = first[1]; j <= last[1]; ++j) {
        for (int i = first[0]; i <= last[0]; ++i) {
          Eigen::Vector3f& at = coordinates(i, j, k);
          if (at.allFinite()) continue;
          const Prism prism = prismOf(sheet, f, grid.toWorld(Vector(i, j, k)));
          for (const double depth : depthsOf(prism)) {
            const Vector weights = weightsAt(prism, depth);
            if (!(weights.minCoeff() >= -kSlack)) continue;
            Vector flat = Vector::Zero();
            for (int c = 0; c < 3; ++c) {
              flat += weights[c] * sheet.flat.row(sheet.faces(f, c)).transpose();
            }
            at = Vector(flat.x(), flat.y(), depth).cast<float>();
            break;
          }
        }
      }
    }
  }
  return coordinates;
}

Volume<float> resampled(const Volume<float>& volume, const Volume<Eigen::Vector3f>& points,
                        bool nearest) {
  Volume<float> values(points.grid, std::numeric_limits<float>::quiet_NaN());
  const Grid& grid = volume.grid;
  parallelFor(points.size(), [&](std::size_t n) {
    if (!points[n].allFinite()) return;
    const Vector index = grid.toIndex(points[n].cast<double>());
    std::array<int, 3> low{};
    Vector share;
    for (int axis = 0; axis < 3; ++axis) {
      constexpr double kRounding = 1e-4;  // voxels: a point on the last voxel's centre is inside
      const double last = grid.size[axis] - 1.0;
      if (!(index[axis] >= -kRounding && index[axis] <= last + kRounding)) return;
      const double at = std::clamp(nearest ? std::round(index[axis]) : index[axis], 0.0, last);
      low[axis] = std::min(static_cast<int>(at), std::max(0, grid.size[axis] - 2));
      share[axis] = at - low[axis];
    }
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      double weight = 1;
      std::array<int, 3> at = low;
      for (int axis = 0; axis < 3; ++axis) {
        const bool upper = corner >> axis & 1;
        weight *= upper ? share[axis] : 1 - share[axis];
        at[axis] += upper;
      }
      if (weight > 0) sum += weight * volume(at[0], at[1], at[2]);
    }
    values[n] = static_cast<float>(sum);
  });
  return values;
}

}  // namespace explica::flattening
