// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sphere/OneToOne.h"

#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SphereLocator.h"
#include "Star.h"

#include <map>
#include <set>

namespace explica::sphere {
namespace {

constexpr int kRounds = 400;       // at most: twenty rings wide, a tangle is no rounding
constexpr int kRoundsAWidth = 20;  // before one more ring of neighbours takes part

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

Point betterPlace(const Ring& ring) {
  if (const auto inside = placeInside(ring)) return *inside;
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
  std::vector<std::int32_t> turned = geometry::turnedOver(sphere);
  result.turnedBefore = static_cast<std::int64_t>(turned.size());
  if (turned.empty()) return result;
  const auto topology = geometry::buildTopology(sphere.faces, sphere.vertexCount());
  std::set<std::int32_t> moved;
  for (int round = 0; round < kRounds && !turned.empty(); ++round) {
    for (const std::int32_t v : verticesOf(sphere, topology, turned, round / kRoundsAWidth)) {
      sphere.positions.row(v) = asWritten(betterPlace(ringOf(sphere, topology, v)));
      moved.insert(v);
    }
    turned = geometry::turnedOver(sphere);
  }
  result.turnedAfter = static_cast<std::int64_t>(turned.size());
  result.moved.assign(moved.begin(), moved.end());
  return result;
}

}  // namespace explica::sphere
