// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "PlaceByImage.h"

#include "Explica/Geometry/IsoSurface.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Sampling/Transfer.h"
#include "Explica/Surface/Remesh.h"
#include "GuardedMesh.h"
#include "ImageBorder.h"
#include "KeepRoom.h"
#include "LevelOfEnds.h"
#include "PathProfile.h"
#include "Relaxation.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace explica::surface {
namespace {

/// The image makes no face of the white surface less high than this, edges.
constexpr double kLeastHeight = 0.1;
const std::int64_t kUsualFaces = SurfaceOptions().faces;
/// By which share the edges of a mesh that serves may be longer or shorter.
constexpr double kAboutAsFine = 0.1;

/// Height of a triangle over its longest edge.
double heightOf(const Point& a, const Point& b, const Point& c) {
  const double longest = std::max({(a - b).norm(), (b - c).norm(), (c - a).norm()});
  return longest > 0 ? (b - a).cross(c - a).norm() / longest : 0;
}

/// True if a move would make a face lower than `least` mm, and lower than it is.
bool flattens(const GuardedMesh& mesh, std::int32_t v, const Point& to, double least) {
  const auto& ring = mesh.facesOf(v);
  return std::any_of(ring.begin(), ring.end(), [&](std::int32_t f) {
    const auto& c = mesh.face(f);
    std::array<Point, 3> now = {mesh.at(c[0]), mesh.at(c[1]), mesh.at(c[2])}, then = now;
    then[std::find(c.begin(), c.end(), v) - c.begin()] = to;
    const double height = heightOf(then[0], then[1], then[2]);
    return height < least && height < heightOf(now[0], now[1], now[2]);
  });
}

/// Takes vertices along their trajectories, in steps, so that neighbours make way for each other.
/// @param ways  wanted, mm outward
/// @return how far each went
Eigen::VectorXd moveAlong(const std::vector<Trajectory>& paths, const Eigen::VectorXd& ways,
                          WhiteSurface& white) {
  const double voxel = voxelSize(white.level.grid);
  GuardedMesh mesh(white.mesh, white.edgeLength);
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(ways.size());
  const double least = kLeastHeight * white.edgeLength;
  for (const double share : {0.25, 0.5, 0.75, 1.0, 1.0}) {
    mesh.sweep([&](std::int32_t v, GuardedMesh::Scratch& scratch) {
      const double wanted = share * ways[v];
      if (moved[v] == wanted) return true;
      const Point to = between(paths[v], wanted, wanted + voxel).points[0];
      if (flattens(mesh, v, to, least) || !mesh.move(v, to, scratch)) return false;
      moved[v] = wanted;
      return true;
    });
  }
  RelaxationOptions mending;
  mending.sweeps = 0;
  const auto stayThere = [](std::int32_t, const Point& point, const Vector&) { return point; };
  white.mesh = relaxed(mesh.toMesh(), white.edgeLength, {}, stayThere, mending);
  keepRoom(white.mesh, roomFor(voxel, white.edgeLength));
  return moved;
}

/// Borders found at the vertices of a surface, at other points upon it.
ImageBorders at(const Positions& points, const TriangleMesh& surface, const ImageBorders& borders) {
  const sampling::NearestOnSurface near = sampling::nearestOn(surface, points);
  const auto lookUp = [&](const Eigen::MatrixXd& values) {
    Eigen::MatrixXd found(points.rows(), values.cols());
    for (Eigen::Index p = 0; p < points.rows(); ++p) {
      found.row(p) = near.weights.row(p) * values(near.corners.row(p), Eigen::all);
    }
    return found;
  };
  return {lookUp(borders.white).col(0), lookUp(borders.outer).col(0), lookUp(borders.doubt),
          lookUp(borders.missing)};
}

}  // namespace

std::optional<WhiteSurface> whereImageIsAsked(const WhiteSurface& white) {
  const double voxel = voxelSize(white.level.grid);
  const double area = geometry::totalArea(white.mesh), usual = edgeFor(area, kUsualFaces);
  const double own = edgeFor(area, white.mesh.faceCount());
  if (std::abs(own / std::max(voxel, usual) - 1) <= kAboutAsFine) return {};
  const TriangleMesh raw = geometry::extractIsoSurface(white.level);
  const double voxels = geometry::totalArea(raw) / (voxel * voxel);
  const double shortest = 4 / std::sqrt(3.0) * voxels;  // faces whose edges are a voxel
  RemeshOptions remeshing;
  remeshing.faces = std::clamp(static_cast<std::int64_t>(shortest), kFewestFaces, kUsualFaces);
  RemeshResult made = remesh(raw, white.level, remeshing);
  WhiteSurface other;
  other.level.grid = white.level.grid;
  other.mesh = std::move(made.mesh);
  other.edgeLength = made.edgeLength;
  keepRoom(other.mesh, roomFor(voxel, other.edgeLength));
  return other;
}

TriangleMesh placeByImage(const BorderImages& images, double fluid, const RibbonPaths& along,
                          std::optional<WhiteSurface> other, GrowingColumns& columns,
                          CorticalSurfaces& result) {
  WhiteSurface& seen = other ? *other : result.white;
  takePaths(seen.mesh, along, columns);
  CorticalTissue& tissue = columns.tissue;
  ImageBorderOptions options;
  options.fluid = fluid;
  options.search = tissue.byBrightness;
  const double voxel = voxelSize(tissue.white.grid);
  const LevelSet inner = distanceLevelOf(tissue.white);
  ImageBorders borders = findBorders(columns.paths, seen.mesh, inner, images, voxel, options);
  const TriangleMesh before = seen.mesh;
  Eigen::VectorXd moved = moveAlong(columns.paths, borders.white, seen);
  LevelSet outer =
      levelOfEnds(distanceLevelOf(tissue.tissue), columns.paths, PathBorder::Outer, borders.outer);
  const LevelSet moving = levelOfEnds(inner, columns.paths, PathBorder::Inner, moved);
  if (other) {
    borders = at(result.white.mesh.positions, before, borders);
    takePaths(result.white.mesh, along, columns);
    moved = moveAlong(columns.paths, borders.white, result.white);
  }
  tissue.tissue = std::move(outer);
  tissue = corrected(std::move(tissue), moving);
  tissue.ofLabels = false;  // the levels say more than the labels
  ImagePlacement& image = result.image;
  image.missingWhite = std::llround(borders.missing.col(0).sum());
  image.missingOuter = std::llround(borders.missing.col(1).sum());
  image.movedWhite = moved.cwiseAbs().mean();
  image.movedOuter = borders.outer.cwiseAbs().mean();
  image.voxel = voxel;
  image.doubt = std::move(borders.doubt);
  return seen.mesh;
}

}  // namespace explica::surface
