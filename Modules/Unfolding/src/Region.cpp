// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/Region.h"

#include "Explica/Core/DisjointSets.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"
#include "Explica/Geometry/FaceTree.h"
#include "Explica/Geometry/Geodesic.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Visibility/Viewpoints.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace explica::unfolding {
namespace {

/// Diagonal of the surface's box, mm.
double extentOf(const TriangleMesh& mesh) {
  return (mesh.positions.colwise().maxCoeff() - mesh.positions.colwise().minCoeff()).norm();
}

/// A point farther off than this is a slip: another frame, a sign, a digit.  5 mm, and 2 % to an
/// eighth of the extent of surfaces far larger or smaller than a brain, or in another unit.
double farthestCentre(double extent) {
  return std::clamp(5.0, 0.02 * extent, 0.125 * extent);
}

void requireNear(const TriangleMesh& mesh, const Point& wanted, std::int32_t vertex) {
  const Point nearest = mesh.positions.row(vertex);
  const double distance = (wanted - nearest).norm(), most = farthestCentre(extentOf(mesh));
  if (distance <= most) return;
  throw InvalidInput(printed(
      "center: is %.1f mm from the surface (limit %g mm); nearest vertex %d at %.1f,%.1f,%.1f",
      distance, most, vertex, nearest[0], nearest[1], nearest[2]));
}

std::vector<bool> connectedWithin(const geometry::IndexLists& neighbours, std::int32_t centre,
                                  std::vector<bool> allowed) {
  allowed[centre] = true;
  DisjointSets pieces(allowed.size());
  for (std::int32_t v = 0; v < static_cast<std::int32_t>(allowed.size()); ++v) {
    for (const std::int32_t w : neighbours[v]) {
      if (allowed[v] && allowed[w]) pieces.join(v, w);
    }
  }
  for (std::int32_t v = 0; v < static_cast<std::int32_t>(allowed.size()); ++v) {
    allowed[v] = allowed[v] && pieces.root(v) == pieces.root(centre);
  }
  return allowed;
}

/// Loops of edges that only one face has, joined at vertices.
int boundaryLoops(const TriangleMesh& mesh) {
  const geometry::MeshTopology topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
  DisjointSets loopOf(static_cast<std::size_t>(mesh.vertexCount()));
  std::vector<bool> onBoundary(static_cast<std::size_t>(mesh.vertexCount()), false);
  for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
    if (topology.edgeFaces(e, 1) >= 0) continue;
    const std::int32_t a = topology.edges(e, 0), b = topology.edges(e, 1);
    loopOf.join(a, b);
    onBoundary[a] = onBoundary[b] = true;
  }
  int loops = 0;
  for (std::int32_t v = 0; v < mesh.vertexCount(); ++v)
    loops += onBoundary[v] && loopOf.root(v) == v;
  return loops;
}

/// The vertex that is asked for, or the nearest one of a face to the point.
std::int32_t centreOf(const TriangleMesh& mesh, const geometry::MeshTopology& topology,
                      const RegionOptions& options) {
  if (!options.center && !options.vertex) {
    throw InvalidInput("region: no centre; give a centre point, a vertex or a label file");
  }
  if (options.center && options.vertex) {
    throw InvalidInput("region: both a centre point and a vertex are given; give one");
  }
  if (options.vertex) {
    const std::int32_t vertex = *options.vertex;
    if (vertex < 0 || vertex >= mesh.vertexCount()) {
      throw InvalidInput("vertex: " + std::to_string(vertex) +
                         " is none of the surface's vertices 0 to " +
                         std::to_string(mesh.vertexCount() - 1));
    }
    if (topology.vertexFaces[vertex].empty()) {
      throw InvalidInput("vertex: " + std::to_string(vertex) + " belongs to no face");
    }
    return vertex;
  }
  if (!options.center->allFinite()) throw InvalidInput("center: not a finite point");
  std::int32_t centre = -1;
  double nearest = kInfinity;
  for (std::int32_t v = 0; v < mesh.vertexCount(); ++v) {
    if (topology.vertexFaces[v].empty()) continue;
    const double squared = (mesh.positions.row(v) - options.center->transpose()).squaredNorm();
    if (squared < nearest) {
      nearest = squared;
      centre = v;
    }
  }
  requireNear(mesh, *options.center, centre);
  return centre;
}

/// Flags of the vertices within the cone about the way from the viewpoints to the middle.
std::vector<bool> withinCone(const TriangleMesh& mesh, const RegionOptions& options,
                             const Point& middle, const visibility::Viewpoints* viewpoints) {
  if (!(*options.cone > 0 && *options.cone < 90)) {
    throw InvalidInput(printed("cone: %g degrees is not between 0 and 90", *options.cone));
  }
  if (viewpoints == nullptr || viewpoints->points.empty()) {
    throw InvalidInput("cone: needs a viewpoint");
  }
  Point eye = Point::Zero();
  for (std::size_t k = 0; k < viewpoints->points.size(); ++k) {
    eye += viewpoints->weights[k] * viewpoints->points[k];
  }
  const Vector axis = (middle - eye).normalized();
  const double least = std::cos(*options.cone * kPi / 180);
  std::vector<bool> within(static_cast<std::size_t>(mesh.vertexCount()));
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    const Vector ray = mesh.positions.row(v).transpose() - eye;
    // A narrow cone from afar pierces the whole surface; the radius keeps it on the near side.
    const double beyond = std::abs((mesh.positions.row(v).transpose() - middle).dot(axis));
    within[v] = ray.dot(axis) >= least * ray.norm() && !(beyond > options.radius);
  }
  return within;
}

/// Flags of the vertices within the radius of the centre.
std::vector<bool> withinRadius(const TriangleMesh& mesh, const geometry::MeshTopology& topology,
                               const RegionOptions& options, std::int32_t centre) {
  if (!(options.radius > 0) || !std::isfinite(options.radius)) {
    throw InvalidInput(printed("radius: %g mm is not a positive length", options.radius));
  }
  const std::array<std::int32_t, 1> source = {centre};
  const Eigen::VectorXd distance =
      options.metric == RegionMetric::Geodesic
          ? geometry::geodesicDistances(mesh, topology, source, options.radius)
          : (mesh.positions.rowwise() - mesh.positions.row(centre)).rowwise().norm();
  std::vector<bool> within(static_cast<std::size_t>(mesh.vertexCount()));
  for (std::size_t v = 0; v < within.size(); ++v) within[v] = distance[v] <= options.radius;
  return within;
}

}  // namespace

Region regionOfMarked(const TriangleMesh& mesh, const std::vector<bool>& marked) {
  if (static_cast<Eigen::Index>(marked.size()) != mesh.vertexCount()) {
    throw InvalidInput("region: labels for " + std::to_string(marked.size()) +
                       " vertices, but the surface has " + std::to_string(mesh.vertexCount()) +
                       "; they belong to another surface");
  }
  Region region;
  for (std::int32_t f = 0; f < mesh.faceCount(); ++f) {
    if (marked[mesh.faces(f, 0)] && marked[mesh.faces(f, 1)] && marked[mesh.faces(f, 2)]) {
      region.faces.push_back(f);
    }
  }
  if (region.faces.empty()) {
    throw InvalidInput("region: no face has all three vertices in it; enlarge it");
  }
  const geometry::SubMesh part = geometry::extractFaces(mesh, region.faces);
  const Eigen::VectorXd areas = geometry::faceAreas(part.mesh);
  for (Eigen::Index f = 0; f < areas.size(); ++f) {
    if (areas[f] > 0) continue;
    throw InvalidInput("region: face " + std::to_string(part.faceOrigin[f]) +
                       " has zero area, so its area cannot be kept; remesh the surface there");
  }
  region.vertices = part.vertexOrigin;
  const auto components = geometry::faceComponents(part.mesh.faces, part.mesh.vertexCount());
  region.pieces = 1 + *std::max_element(components.begin(), components.end());
  const int loops = boundaryLoops(part.mesh);
  if (loops == 0) {
    throw InvalidInput(
        "region: it is a whole closed surface, whose average visibility is zero from any "
        "viewpoint; choose a part of it");
  }
  region.holes = std::max(0, loops - region.pieces);
  return region;
}

Region selectRegion(const TriangleMesh& mesh, const RegionOptions& options,
                    const visibility::Viewpoints* viewpoints) {
  const geometry::MeshTopology topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
  const std::int32_t centre = centreOf(mesh, topology, options);
  std::vector<bool> within =
      options.cone ? withinCone(mesh, options, mesh.positions.row(centre).transpose(), viewpoints)
                   : withinRadius(mesh, topology, options, centre);
  within[centre] = true;
  Region region = regionOfMarked(mesh, connectedWithin(topology.vertexVertices, centre, within));
  region.centre = centre;
  region.radius = options.radius;
  return region;
}

double usualDistance(const TriangleMesh& mesh) {
  constexpr double kFromAHead = 1000;  // mm: from there rays to a patch are parallel to 2 degrees
  constexpr double kFromAnything = 3;  // extents: beyond what stands about a region
  return std::max(kFromAHead, kFromAnything * extentOf(mesh));
}

void requireViewFromOutside(const TriangleMesh& mesh, const visibility::Viewpoints& viewpoints,
                            double clearance) {
  const geometry::Box box(mesh.positions.colwise().minCoeff().transpose(),
                          mesh.positions.colwise().maxCoeff().transpose());
  const auto beyond = [&](const Point& eye) { return box.exteriorDistance(eye) > clearance; };
  const auto& eyes = viewpoints.points;
  if (!eyes.empty() && std::all_of(eyes.begin(), eyes.end(), beyond)) return;
  const bool closed = geometry::inspectMesh(mesh).closedManifold();
  const geometry::FaceTree tree(mesh);
  for (const Point& eye : eyes) {
    if (!eye.allFinite()) throw InvalidInput("viewpoint: not a finite point");
    const std::string name = printed("viewpoint: (%g, %g, %g) lies ", eye[0], eye[1], eye[2]);
    if (std::sqrt(tree.closestPoint(eye).squaredDistance) < clearance) {
      throw InvalidInput(name + "on the surface; move it away");
    }
    if (closed && visibility::windingNumber(mesh, eye) > 0.5) {
      throw InvalidInput(name +
                         "inside the surface, whose outer side it cannot see; move it outside");
    }
  }
}

Point centroidOf(const TriangleMesh& mesh, const Region& region) {
  Point sum = Point::Zero();
  for (const std::int32_t v : region.vertices) sum += mesh.positions.row(v).transpose();
  return sum / static_cast<double>(region.vertices.size());
}

Vector meanNormal(const TriangleMesh& mesh, const Region& region) {
  Vector sum = Vector::Zero();
  double size = 0;
  const Positions normals = geometry::faceNormalVectors(mesh);
  for (const std::int32_t f : region.faces) {
    sum += normals.row(f).transpose();
    size += normals.row(f).norm();
  }
  return sum / size;
}

}  // namespace explica::unfolding
