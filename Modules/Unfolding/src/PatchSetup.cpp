// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "PatchSetup.h"

#include "Guide.h"
#include "Room.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Geodesic.h"
#include "Explica/Geometry/MeshMeasures.h"

#include <algorithm>
#include <cmath>

namespace explica::unfolding {
namespace {

// Of the mean face: relative area errors of a face far smaller than the rest must not rule them.
constexpr double kNeedleShare = 0.02;
// Of the mean face: what a face of the collar counts at least where it stretches far, so that small
// faces do not stretch in place of large ones.
constexpr double kHoldShare = 0.25;
// Of the region's area: faces of the collar may be degenerate, and need an area to be compared
// with.
constexpr double kLeastArea = 1e-12;
// Of the mean edge: edges far shorter must not rule the rest.
constexpr double kShortShare = 0.1;
// Of the radius of a disc of the region's area, or of how far the region has to rise if that is
// more: how wide a collar is by default.
constexpr double kCollarShare = 0.6;

void requireUsable(const UnfolderOptions& options, const Region& region) {
  if (!(options.contactRange > 0)) throw InvalidInput("contactRange: must be positive");
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

/// Distance from the region along the surface, mm, of vertices that move: 0 in the region, below
/// the collar's width in an elastic collar; infinity of those that stay.
Eigen::VectorXd reachOf(const PatchSetup& s, Surround surround) {
  Eigen::VectorXd reach = Eigen::VectorXd::Constant(s.mesh.vertexCount(), kInfinity);
  if (surround == Surround::Elastic) {
    reach = geometry::geodesicDistances(s.mesh, s.topology, s.region.vertices, s.collarWidth);
    reach = (reach.array() < s.collarWidth).select(reach, kInfinity);
  }
  for (const std::int32_t v : s.region.vertices) reach[v] = 0;
  return reach;
}

/// Faces outside the region that have a vertex that moves.
std::vector<std::int32_t> collarFaces(const PatchSetup& s) {
  std::vector<std::int32_t> faces;
  const std::vector<bool> inRegion = markedOf(s.mesh.faceCount(), s.region.faces);
  for (std::int32_t f = 0; f < s.mesh.faceCount(); ++f) {
    bool moves = false;
    for (int k = 0; k < 3; ++k) moves = moves || s.unknown[s.mesh.faces(f, k)] >= 0;
    if (moves && !inRegion[f]) faces.push_back(f);
  }
  return faces;
}

/// The region's area and mean edge.
void measureRegion(PatchSetup& s) {
  const Eigen::VectorXd areas = geometry::faceAreas(s.mesh);
  double edgeSum = 0;
  for (const std::int32_t f : s.region.faces) {
    if (!(areas[f] > 0)) {
      throw InvalidInput("region: face " + std::to_string(f) +
                         " has zero area, so its area cannot be kept; remesh the surface there");
    }
    s.area += areas[f];
    for (int k = 0; k < 3; ++k) {
      edgeSum += (s.mesh.corner(f, k) - s.mesh.corner(f, (k + 1) % 3)).norm();
    }
  }
  s.edge = edgeSum / (3 * static_cast<double>(s.region.faces.size()));
}

/// What moves, by the way that it has to go.
void chooseMoving(PatchSetup& s, const visibility::Viewpoints& viewpoints,
                  const UnfolderOptions& options) {
  s.patch.room = findRoom(s.mesh, s.region, viewpoints);
  if (options.surround == Surround::Elastic) {
    s.collarWidth = options.collarWidth.value_or(kCollarShare *
                                                 std::max(s.patch.room.radius, s.patch.room.depth));
  }
  const Eigen::VectorXd reach = reachOf(s, options.surround);
  for (std::int32_t v = 0; v < reach.size(); ++v) {
    if (std::isfinite(reach[v])) s.moving.push_back(v);
  }
  s.unknown.assign(static_cast<std::size_t>(reach.size()), -1);
  for (std::size_t i = 0; i < s.moving.size(); ++i) {
    s.unknown[s.moving[i]] = static_cast<std::int32_t>(i);
  }
  s.collar = collarFaces(s);
}

/// What moves, of which nothing is listed yet.
PatchSetup begin(TriangleMesh mesh, Region region, const visibility::Viewpoints& viewpoints,
                 const UnfolderOptions& options) {
  PatchSetup s;
  s.mesh = std::move(mesh);
  s.region = std::move(region);
  if (options.surround == Surround::None) isolate(s.mesh, s.region);
  s.topology = geometry::buildTopology(s.mesh.faces, s.mesh.vertexCount());
  measureRegion(s);
  chooseMoving(s, viewpoints, options);
  return s;
}

/// Faces of an elastic collar hold back when they stretch far; a single ring beside fixed
/// surroundings has no other way to follow.
void listFaces(PatchSetup& s) {
  const Eigen::VectorXd areas = geometry::faceAreas(s.mesh);
  const double mean = s.area / static_cast<double>(s.region.faces.size());
  const double needle = kNeedleShare * mean;
  const auto list = [&](std::int32_t f) {
    PatchFace face;
    face.vertices = {s.mesh.faces(f, 0), s.mesh.faces(f, 1), s.mesh.faces(f, 2)};
    face.restArea = std::max(areas[f], kLeastArea * s.area);
    face.weight = face.restArea * face.restArea / (face.restArea + needle);
    s.patch.faces.push_back(face);
  };
  for (const std::int32_t f : s.region.faces) list(f);
  s.patch.regionFaces = s.region.faces.size();
  for (const std::int32_t f : s.collar) {
    list(f);
    PatchFace& face = s.patch.faces.back();
    if (s.collarWidth > 0) face.holdWeight = face.restArea + kHoldShare * mean;
  }
}

/// All edges count alike, as in the mean strain: by area, small faces would pay for large ones.
void listSprings(PatchSetup& s) {
  const double full = 2 * s.area / (3 * static_cast<double>(s.region.faces.size()));
  const double tooShort = kShortShare * kShortShare * s.edge * s.edge;
  const std::vector<bool> inRegion = markedOf(s.mesh.faceCount(), s.region.faces);
  const std::vector<bool> inCollar = markedOf(s.mesh.faceCount(), s.collar);
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
}

/// A large region alone finds no way of its own past the parts of its rim that come to lie over one
/// another.
bool isGuided(const PatchSetup& s, const UnfolderOptions& options) {
  return options.method == Method::Implicit && options.surround == Surround::None &&
         options.weights[Term::Guide] > 0 &&
         static_cast<std::int64_t>(s.region.faces.size()) >= options.guideFaces;
}

}  // namespace

std::vector<bool> movingFaces(const TriangleMesh& mesh, const Region& region,
                              const visibility::Viewpoints& viewpoints,
                              const UnfolderOptions& options) {
  requireUsable(options, region);
  if (options.surround == Surround::None) return markedOf(mesh.faceCount(), region.faces);
  const PatchSetup s = begin(mesh, region, viewpoints, options);
  std::vector<bool> moves = markedOf(mesh.faceCount(), region.faces);
  for (const std::int32_t f : s.collar) moves[f] = true;
  return moves;
}

PatchSetup setUpPatch(TriangleMesh mesh, Region region, const visibility::Viewpoints& viewpoints,
                      const UnfolderOptions& options) {
  requireUsable(options, region);
  PatchSetup s = begin(std::move(mesh), std::move(region), viewpoints, options);
  listFaces(s);
  listSprings(s);
  if (isGuided(s, options)) s.patch.guide = makeGuide(s.mesh, s.region, s.patch.room);
  s.patch.yieldStrain = options.yieldStrain;
  listCouplings(s);
  listAround(s.patch, s.unknown);
  return s;
}

}  // namespace explica::unfolding
