// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sphere/OneToOne.h"

#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SphereLocator.h"
#include "Star.h"

#include <algorithm>
#include <map>
#include <set>

namespace explica::sphere {
namespace {

constexpr int kMostRings = 20;  // about what is turned over: wider, a tangle is no rounding
constexpr int kSweeps = 40;     // of each width, and as many again for each ring

Eigen::RowVector3d asWritten(const Point& place) {
  Eigen::RowVector3d written = kSphereRadius * place.normalized().transpose();
  for (double& x : written) {
    const volatile float single =
        static_cast<float>(x);  // GCC 12 leaves pairs of doubles unrounded
    x = single;
  }
  return written;
}

/// Neighbours of a vertex, counter-clockwise.
Ring ringOf(const TriangleMesh& mesh, const geometry::MeshTopology& topology, std::int32_t v) {
  std::map<std::int32_t, std::int32_t> next;
  for (const std::int32_t f : topology.vertexFaces[v]) {
    for (int k = 0; k < 3; ++k) {
      if (mesh.faces(f, k) == v) next[mesh.faces(f, (k + 1) % 3)] = mesh.faces(f, (k + 2) % 3);
    }
  }
  Ring ring;
  std::int32_t at = next.begin()->first;
  for (std::size_t n = 0; n < next.size(); ++n) {
    ring.push_back(mesh.positions.row(at).normalized().transpose());
    at = next.at(at);
  }
  return ring;
}

Point meanOf(const Ring& ring) {
  Point mean = Point::Zero();
  for (const Point& p : ring) mean += p;
  return mean;
}

std::set<std::int32_t> verticesOf(const TriangleMesh& mesh, const geometry::MeshTopology& topology,
                                  const std::vector<std::int32_t>& faces, int rings) {
  std::set<std::int32_t> vertices;
  for (const std::int32_t f : faces) {
    for (int k = 0; k < 3; ++k) vertices.insert(mesh.faces(f, k));
  }
  for (int n = 0; n < rings; ++n) {
    std::set<std::int32_t> wider = vertices;
    for (const std::int32_t v : vertices) {
      const auto around = topology.vertexVertices[v];
      wider.insert(around.begin(), around.end());
    }
    vertices.swap(wider);
  }
  return vertices;
}

}  // namespace

OneToOne makeOneToOne(TriangleMesh& sphere) {
  for (Eigen::Index v = 0; v < sphere.vertexCount(); ++v) {
    sphere.positions.row(v) = asWritten(sphere.positions.row(v).transpose());
  }
  OneToOne result;
  const std::vector<std::int32_t> given = geometry::turnedOver(sphere);
  result.turnedBefore = static_cast<std::int64_t>(given.size());
  if (given.empty()) return result;
  const auto topology = geometry::buildTopology(sphere.faces, sphere.vertexCount());
  const Positions start = sphere.positions;
  std::vector<std::int32_t> turned = given;
  std::set<std::int32_t> moved;
  for (int rings = 0; rings <= kMostRings && !turned.empty(); ++rings) {
    // Anew: what a narrower try has moved may be worse than what was given.
    sphere.positions = start;
    moved = verticesOf(sphere, topology, given, rings);
    for (int sweep = 0; sweep < kSweeps * (1 + rings) && !turned.empty(); ++sweep) {
      for (const std::int32_t v : moved) {
        const Ring ring = ringOf(sphere, topology, v);
        const auto inside = rings == 0 ? placeInside(ring) : std::nullopt;
        sphere.positions.row(v) = asWritten(inside.value_or(meanOf(ring)));
      }
      turned = geometry::turnedOver(sphere);
    }
  }
  result.turnedAfter = static_cast<std::int64_t>(turned.size());
  result.moved.assign(moved.begin(), moved.end());
  return result;
}

}  // namespace explica::sphere
