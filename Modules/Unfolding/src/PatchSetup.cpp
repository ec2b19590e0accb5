// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "PatchSetup.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/MeshMeasures.h"

#include <algorithm>
#include <cmath>

namespace explica::unfolding {
namespace {

// Of the mean face: relative area errors of a face far smaller than the rest must not rule them.
constexpr double kNeedleShare = 0.02;
// Of the region's area: faces of the collar may be degenerate, and need an area to be compared
// with.
constexpr double kLeastArea = 1e-12;
// Of the mean edge: edges far shorter must not rule the rest.
constexpr double kShortShare = 0.1;

void requireUsable(const UnfolderOptions& options, const Region& region) {
  if (!(options.contactRange > 0)) throw InvalidInput("contactRange: must be positive");
  if (!(options.largestMove > 0)) throw InvalidInput("largestMove: must be positive");
  if (options.timeStep && !(*options.timeStep > 0)) {
    throw InvalidInput("time-step: must be positive");
  }
  if (options.collarRings <= 0) throw InvalidInput("collarRings: must be positive");
  if (region.faces.empty()) throw InvalidInput("region: has no face");
}

/// Leaves the region's faces only.
void isolate(TriangleMesh& mesh, Region& region) {
  Faces own(static_cast<Eigen::Index>(region.faces.size()), 3);
  for (std::size_t f = 0; f < region.faces.size(); ++f) {
    own.row(static_cast<Eigen::Index>(f)) = mesh.faces.row(region.faces[f]);
    region.faces[f] = static_cast<std::int32_t>(f);
  }
  mesh.faces = own;
}

std::vector<bool> flags(Eigen::Index count, const std::vector<std::int32_t>& marked) {
  std::vector<bool> result(static_cast<std::size_t>(count), false);
  for (const std::int32_t i : marked) result[i] = true;
  return result;
}

/// Vertices that move: the region's and, of an elastic collar, all but the outermost.
std::vector<bool> movingVertices(const PatchSetup& s, const UnfolderOptions& options) {
  std::vector<bool> moves = flags(s.mesh.vertexCount(), s.region.vertices);
  if (options.surround != Surround::Elastic) return moves;
  for (int ring = 0; ring + 1 < options.collarRings; ++ring) {
    std::vector<bool> grown = moves;
    for (std::size_t v = 0; v < moves.size(); ++v) {
      if (!moves[v]) continue;
      for (const std::int32_t w : s.topology.vertexVertices[v]) grown[w] = true;
    }
    moves = std::move(grown);
  }
  return moves;
}

void numberUnknowns(PatchSetup& s, const std::vector<bool>& moves) {
  s.unknown.assign(moves.size(), -1);
  for (std::size_t v = 0; v < moves.size(); ++v) {
    if (!moves[v]) continue;
    s.unknown[v] = static_cast<std::int32_t>(s.moving.size());
    s.moving.push_back(static_cast<std::int32_t>(v));
  }
}

/// Faces outside the region that keep their areas elastically.
std::vector<std::int32_t> collarFaces(const PatchSetup& s, const UnfolderOptions& options) {
  std::vector<std::int32_t> faces;
  if (options.surround != Surround::Elastic) return faces;
  const std::vector<bool> inRegion = flags(s.mesh.faceCount(), s.region.faces);
  for (std::int32_t f = 0; f < s.mesh.faceCount(); ++f) {
    bool moves = false;
    for (int k = 0; k < 3; ++k) moves = moves || s.unknown[s.mesh.faces(f, k)] >= 0;
    if (moves && !inRegion[f]) faces.push_back(f);
  }
  return faces;
}

/// @return the region's area, mm^2
double measureRegion(PatchSetup& s, const Eigen::VectorXd& areas) {
  double regionArea = 0, edgeSum = 0;
  for (const std::int32_t f : s.region.faces) {
    if (!(areas[f] > 0)) {
      throw InvalidInput("region: face " + std::to_string(f) +
                         " has zero area, so its area cannot be kept; remesh the surface there");
    }
    regionArea += areas[f];
    for (int k = 0; k < 3; ++k) {
      edgeSum += (s.mesh.corner(f, k) - s.mesh.corner(f, (k + 1) % 3)).norm();
    }
  }
  s.edge = edgeSum / (3 * static_cast<double>(s.region.faces.size()));
  return regionArea;
}

void listFaces(PatchSetup& s, const std::vector<std::int32_t>& collar, const Eigen::VectorXd& areas,
               double regionArea) {
  const double needle = kNeedleShare * regionArea / static_cast<double>(s.region.faces.size());
  const auto list = [&](std::int32_t f) {
    const double area = std::max(areas[f], kLeastArea * regionArea);
    s.patch.faces.push_back({{s.mesh.faces(f, 0), s.mesh.faces(f, 1), s.mesh.faces(f, 2)},
                             area,
                             area * area / (area + needle)});
  };
  for (const std::int32_t f : s.region.faces) list(f);
  s.patch.regionFaces = s.region.faces.size();
  for (const std::int32_t f : collar) list(f);
}

/// All edges count alike, as in the mean strain: by area, small faces would pay for large ones.
void listSprings(PatchSetup& s, const std::vector<std::int32_t>& collar, double regionArea) {
  const double full = 2 * regionArea / (3 * static_cast<double>(s.region.faces.size()));
  const double tooShort = kShortShare * kShortShare * s.edge * s.edge;
  const std::vector<bool> inRegion = flags(s.mesh.faceCount(), s.region.faces);
  const std::vector<bool> inCollar = flags(s.mesh.faceCount(), collar);
  std::vector<PatchSpring> ofCollar;
  for (Eigen::Index e = 0; e < s.topology.edges.rows(); ++e) {
    bool region = false, beside = false;
    for (int side = 0; side < 2; ++side) {
      const std::int32_t f = s.topology.edgeFaces(e, side);
      region = region || (f >= 0 && inRegion[f]);
      beside = beside || (f >= 0 && inCollar[f]);
    }
    if (!region && !beside) continue;
    const std::int32_t a = s.topology.edges(e, 0), b = s.topology.edges(e, 1);
    const double length = (s.mesh.positions.row(a) - s.mesh.positions.row(b)).norm();
    const double squared = length * length;
    const PatchSpring spring = {{a, b}, length, full * squared / (squared + tooShort)};
    (region ? s.patch.springs : ofCollar).push_back(spring);
  }
  s.patch.regionSprings = s.patch.springs.size();
  s.patch.springs.insert(s.patch.springs.end(), ofCollar.begin(), ofCollar.end());
}

void listCouplings(PatchSetup& s) {
  for (const PatchSpring& spring : s.patch.springs) {
    const std::int32_t a = s.unknown[spring.vertices[0]], b = s.unknown[spring.vertices[1]];
    if (a >= 0 && b >= 0) s.couplings.emplace_back(std::max(a, b), std::min(a, b));
  }
  std::sort(s.couplings.begin(), s.couplings.end());
}

}  // namespace

PatchSetup setUpPatch(TriangleMesh mesh, Region region, const visibility::Viewpoints& viewpoints,
                      const UnfolderOptions& options) {
  requireUsable(options, region);
  PatchSetup s;
  s.mesh = std::move(mesh);
  s.region = std::move(region);
  if (options.surround == Surround::None) isolate(s.mesh, s.region);
  s.topology = geometry::buildTopology(s.mesh.faces, s.mesh.vertexCount());
  numberUnknowns(s, movingVertices(s, options));
  const Eigen::VectorXd areas = geometry::faceAreas(s.mesh);
  const double regionArea = measureRegion(s, areas);
  const std::vector<std::int32_t> collar = collarFaces(s, options);
  listFaces(s, collar, areas, regionArea);
  listSprings(s, collar, regionArea);
  listCouplings(s);
  s.patch.room = findRoom(s, viewpoints);
  return s;
}

PatchRoom findRoom(const PatchSetup& s, const visibility::Viewpoints& viewpoints) {
  PatchRoom room;
  Point middle = Point::Zero();
  for (const std::int32_t v : s.region.vertices) middle += s.mesh.positions.row(v).transpose();
  middle /= static_cast<double>(s.region.vertices.size());
  Vector towards = Vector::Zero();
  for (std::size_t k = 0; k < viewpoints.points.size(); ++k) {
    towards += viewpoints.weights[k] * (viewpoints.points[k] - middle).normalized();
  }
  double area = 0;
  for (const PatchFace& face : s.patch.ofRegion()) area += face.restArea;
  room.radius = std::sqrt(area / kPi);
  constexpr double kOneSide = 0.1;  // of unit length: below it they look from all sides, and no way
                                    // leads towards them
  if (towards.norm() <= kOneSide) return room;
  room.axis = towards.normalized();
  for (Eigen::Index v = 0; v < s.mesh.vertexCount(); ++v) {
    const Vector from = s.mesh.positions.row(v).transpose() - middle;
    const double height = room.axis.dot(from);
    if ((from - height * room.axis).norm() < room.radius) {
      room.height = std::max(room.height, room.axis.dot(s.mesh.positions.row(v).transpose()));
    }
  }
  return room;
}

}  // namespace explica::unfolding
