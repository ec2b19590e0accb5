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
#include <map>
#include <set>
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

/// Loops of edges that only one of the listed faces has, joined at vertices.
int boundaryLoops(const TriangleMesh& mesh, const std::vector<std::int32_t>& faces) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> uses;
  for (const std::int32_t f : faces) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = mesh.faces(f, k), b = mesh.faces(f, (k + 1) % 3);
      ++uses[{std::min(a, b), std::max(a, b)}];
    }
  }
  DisjointSets loopOf(static_cast<std::size_t>(mesh.vertexCount()));
  std::set<std::int32_t> onBoundary;
  for (const auto& [edge, count] : uses) {
    if (count != 1) continue;
    loopOf.join(edge.first, edge.second);
    onBoundary.insert({edge.first, edge.second});
  }
  const auto loops = std::count_if(onBoundary.begin(), onBoundary.end(),
                                   [&](std::int32_t v) { return loopOf.root(v) == v; });
  return static_cast<int>(loops);
}

}  // namespace

Region regionOfMarked(const TriangleMesh& mesh, const std::vector<bool>& marked) {
  if (static_cast<Eigen::Index>(marked.size()) != mesh.vertexCount()) {
    throw InvalidInput("region: labels for " + std::to_string(marked.size()) +
                       " vertices, but the surface has " + std::to_string(mesh.vertexCount()) +
                       "; they belong to another surface");
  }
  Region region;
  std::vector<bool> used(marked.size(), false);
  for (std::int32_t f = 0; f < mesh.faceCount(); ++f) {
    if (marked[mesh.faces(f, 0)] && marked[mesh.faces(f, 1)] && marked[mesh.faces(f, 2)]) {
      region.faces.push_back(f);
      for (int k = 0; k < 3; ++k) used[mesh.faces(f, k)] = true;
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
  for (std::int32_t v = 0; v < mesh.vertexCount(); ++v) {
    if (used[v]) region.vertices.push_back(v);
  }
  const auto components = geometry::faceComponents(part.mesh.faces, part.mesh.vertexCount());
  region.pieces = 1 + *std::max_element(components.begin(), components.end());
  const int loops = boundaryLoops(mesh, region.faces);
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
  if (!options.center && !options.vertex) {
    throw InvalidInput("region: no centre; give a centre point, a vertex or a label file");
  }
  if (options.center && options.vertex) {
    throw InvalidInput("region: both a centre point and a vertex are given; give one");
  }
  std::int32_t centre = options.vertex.value_or(-1);
  if (options.vertex && (centre < 0 || centre >= mesh.vertexCount())) {
    throw InvalidInput("vertex: " + std::to_string(centre) +
                       " is none of the surface's vertices 0 to " +
                       std::to_string(mesh.vertexCount() - 1));
  }
  if (options.center && !options.center->allFinite()) {
    throw InvalidInput("center: not a finite point");
  }
  const geometry::MeshTopology topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
  if (options.vertex && topology.vertexFaces[centre].empty()) {
    throw InvalidInput("vertex: " + std::to_string(centre) + " belongs to no face");
  }
  for (std::int32_t v = 0; !options.vertex && v < mesh.vertexCount(); ++v) {
    if (topology.vertexFaces[v].empty()) continue;
    const auto squared = [&](std::int32_t w) {
      return (mesh.positions.row(w) - options.center->transpose()).squaredNorm();
    };
    if (centre < 0 || squared(v) < squared(centre)) centre = v;
  }
  const Point middle = mesh.positions.row(centre).transpose();
  if (options.center) requireNear(mesh, *options.center, centre);
  std::vector<bool> within(static_cast<std::size_t>(mesh.vertexCount()), false);
  if (options.cone) {
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
    for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
      const Vector ray = mesh.positions.row(v).transpose() - eye;
      // A narrow cone from afar pierces the whole surface; the radius keeps it on the near side.
      const double beyond = std::abs((mesh.positions.row(v).transpose() - middle).dot(axis));
      within[v] = ray.dot(axis) >= least * ray.norm() && !(beyond > options.radius);
    }
  } else {
    if (!(options.radius > 0) || !std::isfinite(options.radius)) {
      throw InvalidInput(printed("radius: %g mm is not a positive length", options.radius));
    }
    if (options.metric == RegionMetric::Geodesic) {
      const std::array<std::int32_t, 1> source = {centre};
      const Eigen::VectorXd distance =
          geometry::geodesicDistances(mesh, topology, source, options.radius);
      for (std::size_t v = 0; v < within.size(); ++v) within[v] = distance[v] <= options.radius;
    } else {
      for (std::size_t v = 0; v < within.size(); ++v) {
        within[v] =
            (mesh.positions.row(static_cast<Eigen::Index>(v)).transpose() - middle).norm() <=
            options.radius;
      }
    }
  }
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
