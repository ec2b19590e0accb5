// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Shapes/ShapeLevel.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/FaceTree.h"
#include "Explica/Geometry/IsoSurface.h"
#include "Explica/Planar/Contour.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <vector>

namespace explica::shapes {
namespace {

/// Steps along the gradient onto u = 1/2, at most half a voxel in all.  The gradient is that of the
/// start: three such steps end nearer to the level than two of Newton's, for less.
void moveOntoLevel(const HarmonicShape& shape, double voxel, Positions& points) {
  const int axes = shape.annulus.dimension;
  const Positions start = points;
  const double h = 1e-3 * voxel;
  Positions gradient = Positions::Zero(points.rows(), 3);
  for (int axis = 0; axis < axes; ++axis) {
    Positions moved = points;
    moved.col(axis).array() += h;
    gradient.col(axis) = valuesAt(shape, moved);
    moved.col(axis).array() -= 2 * h;
    gradient.col(axis) = (gradient.col(axis) - valuesAt(shape, moved)) / (2 * h);
  }
  for (int k = 0; k < 3; ++k) {
    const Eigen::VectorXd excess = (valuesAt(shape, points).array() - 0.5).matrix();
    for (Eigen::Index p = 0; p < points.rows(); ++p) {
      const double slope = gradient.row(p).squaredNorm();
      if (!(slope > 0)) continue;
      const Eigen::RowVector3d target = points.row(p) - excess[p] / slope * gradient.row(p);
      if ((target - start.row(p)).norm() < 0.5 * voxel) points.row(p) = target;
    }
  }
}

Grid gridOf(const HarmonicAnnulus& annulus, int voxels) {
  if (voxels < 8) throw InvalidInput("grid: at least 8 voxels per side are needed");
  Grid grid;
  grid.size = {voxels, voxels, annulus.dimension == 2 ? 1 : voxels};
  grid.spacing = Vector::Constant(2 * annulus.outerRadius / (voxels - 1));
  grid.origin = annulus.centre - Vector::Constant(annulus.outerRadius);
  if (annulus.dimension == 2) grid.origin.z() = 0;
  return grid;
}

[[noreturn]] void refuseThinShape(int voxels) {
  throw InvalidInput("the shape is so thin that it falls between the points of a grid of " +
                     std::to_string(voxels) + " a side; a finer grid or a wider shape is needed");
}

}  // namespace

Volume<float> fieldOf(const HarmonicShape& shape, int voxels) {
  requireUsable(shape.annulus);
  Volume<float> field(gridOf(shape.annulus, voxels));
  const Grid& grid = field.grid;
  const std::size_t row = static_cast<std::size_t>(grid.size[0]);
  for (std::size_t first = 0; first < field.size(); first += 64 * row) {
    const std::size_t end = std::min(field.size(), first + 64 * row);
    std::vector<std::size_t> within;
    std::vector<Point> places;
    for (std::size_t v = first; v < end; ++v) {
      const auto [i, j, k] = grid.subscripts(v);
      const Point place = grid.toWorld({double(i), double(j), double(k)});
      const AnnulusSide side = sideOf(shape.annulus, place);
      if (side == AnnulusSide::Inside) {
        within.push_back(v);
        places.push_back(place);
      } else {
        field[v] = side == AnnulusSide::Enclosed ? 0.0F : 1.0F;
      }
    }
    Positions points(static_cast<Eigen::Index>(places.size()), 3);
    for (std::size_t p = 0; p < places.size(); ++p) {
      points.row(p) = places[p].transpose();
    }
    const Eigen::VectorXd values = valuesAt(shape, points);
    for (std::size_t p = 0; p < within.size(); ++p) {
      field[within[p]] = static_cast<float>(values[p]);
    }
  }
  return field;
}

std::vector<planar::Curve> levelCurves(const HarmonicShape& shape, int voxels) {
  if (shape.annulus.dimension != 2) throw InvalidInput("level curves: the shape is in space");
  Volume<float> field = fieldOf(shape, voxels);
  for (float& value : field.data) value = 1 - value;  // contours run around high values
  std::vector<planar::Curve> curves = planar::contoursOfSlice(field, 0, 0.5);
  if (curves.empty()) refuseThinShape(voxels);
  for (planar::Curve& curve : curves) {
    Positions points = Positions::Zero(curve.vertexCount(), 3);
    points.leftCols(2) = curve.positions;
    moveOntoLevel(shape, field.grid.spacing.x(), points);
    curve.positions = points.leftCols(2);
  }
  return curves;
}

TriangleMesh levelSurface(const HarmonicShape& shape, int voxels) {
  if (shape.annulus.dimension != 3) throw InvalidInput("level surface: the shape is in the plane");
  Volume<float> field = fieldOf(shape, voxels);
  for (float& value : field.data) value = 0.5F - value;  // the surface runs around high values
  TriangleMesh mesh = geometry::extractIsoSurface(field);
  if (mesh.faceCount() == 0) refuseThinShape(voxels);
  moveOntoLevel(shape, field.grid.spacing.x(), mesh.positions);
  return mesh;
}

TargetSamples samplesOf(const planar::Curve& target, int count) {
  const planar::Curve fine = planar::resampled(target, count);
  TargetSamples samples{Positions::Zero(count, 3), planar::edgeLengths(fine)};
  samples.points.leftCols(2) = fine.positions;
  return samples;
}

TargetSamples samplesOf(const TriangleMesh& target, int count) {
  const Eigen::Index stride = std::max<Eigen::Index>(1, target.faceCount() / std::max(1, count));
  const Eigen::Index taken = (target.faceCount() + stride - 1) / stride;
  TargetSamples samples{Positions(taken, 3), Eigen::VectorXd(taken)};
  for (Eigen::Index s = 0; s < taken; ++s) {
    const Eigen::Index f = s * stride;
    const Point a = target.corner(f, 0);
    const Point b = target.corner(f, 1);
    const Point c = target.corner(f, 2);
    samples.points.row(s) = ((a + b + c) / 3).transpose();
    samples.weights[s] = static_cast<double>(stride) * (b - a).cross(c - a).norm() / 2;
  }
  return samples;
}

LevelDistance distanceBetween(const planar::Curve& shape, const planar::Curve& target) {
  LevelDistance result;
  for (int v = 0; v < shape.vertexCount(); ++v) {
    const double least = planar::distanceTo(target, shape.point(v));
    result.max = std::max(result.max, least);
    result.mean += least / shape.vertexCount();
  }
  return result;
}

LevelDistance distanceBetween(const TriangleMesh& shape, const TriangleMesh& target) {
  const geometry::FaceTree tree(target);
  std::vector<double> distances(static_cast<std::size_t>(shape.vertexCount()));
  parallelFor(distances.size(), 256, [&](std::size_t v) {
    const Point q = shape.positions.row(v).transpose();
    distances[v] = std::sqrt(tree.closestPoint(q).squaredDistance);
  });
  LevelDistance result;
  for (double d : distances) {
    result.max = std::max(result.max, d);
    result.mean += d / static_cast<double>(distances.size());
  }
  return result;
}

}  // namespace explica::shapes
