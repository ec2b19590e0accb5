// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Monitor.h"
#include "Explica/Core/TriangleMesh.h"
#include "Explica/Visibility/Viewpoints.h"

#include <array>
#include <optional>
#include <vector>

namespace explica::unfolding {

/// How a region's radius is measured.
enum class RegionMetric {
  Euclidean,  ///< straight, connected to the centre through vertices within the radius
  Geodesic    ///< along the surface
};
constexpr auto enumWords(RegionMetric) {
  using enum RegionMetric;
  return std::to_array<EnumWord<RegionMetric>>({{Euclidean, "euclidean"}, {Geodesic, "geodesic"}});
}

/// Which part of a surface is to be unfolded.  Without a label, `center`, `vertex` or `cone` says
/// where it is.
struct RegionOptions {
  std::optional<Eigen::Vector3d> center;  ///< the surface's nearest vertex becomes the centre
  std::optional<int> vertex;
  double radius = 25;  ///< mm, > 0
  RegionMetric metric = RegionMetric::Euclidean;
  std::optional<double> cone;  ///< half angle, degrees
};

template <class Visitor>
void describe(RegionOptions& options, Visitor&& visit) {
  visit(Field{"center", "mm", "the vertex nearest to this point is the region's centre"},
        options.center);
  visit(Field{"vertex", "", "vertex that is the region's centre, from 0"}, options.vertex);
  visit(Field{"radius", "mm", "how far the region reaches from its centre", kAboveZero},
        options.radius);
  visit(Field{"metric", "", "how the radius is measured"}, options.metric);
  visit(Field{"cone", "degrees",
              "region of what lies within this angle of the line from viewpoint to centre, on the "
              "near side and connected to the centre"},
        options.cone);
}

/// Part of a surface: its faces and exactly their vertices.
struct Region {
  std::vector<std::int32_t> vertices;  ///< ascending
  std::vector<std::int32_t> faces;     ///< ascending
  std::int32_t centre = -1;            ///< vertex; -1 for a region given by labels
  double radius = kNaN;                ///< mm; NaN for a region without one
  int pieces = 0;                      ///< components of faces that share vertices
  int holes = 0;                       ///< boundary loops beyond one per piece
};

/// Faces whose three vertices lie within the radius of the centre vertex, or within the cone.
/// @throws InvalidInput  no centre, one more than 5 mm off a surface like a brain's, radius or
///                       cone out of range, or as regionOfMarked()
[[nodiscard]] Region selectRegion(const TriangleMesh& mesh, const RegionOptions& options,
                                  const visibility::Viewpoints* viewpoints = nullptr);

/// Faces whose three vertices are marked.
/// @throws InvalidInput  `marked` is not as long as the mesh has vertices; no face, a whole closed
///                       surface, or a face of zero area
[[nodiscard]] Region regionOfMarked(const TriangleMesh& mesh, const std::vector<bool>& marked);

/// The mean of a region's vertices, RAS mm: what a viewpoint that is given by its direction is
/// counted from.
[[nodiscard]] Point centroidOf(const TriangleMesh& mesh, const Region& region);

/// The region's outward unit normals averaged over its area: of length 1 where it is flat, 0 where
/// they cancel.
[[nodiscard]] Vector meanNormal(const TriangleMesh& mesh, const Region& region);

/// How far off a viewpoint is of which only the direction is given: 1000 mm, or three times the
/// extent of a surface that is larger, such as one in micrometres.
[[nodiscard]] double usualDistance(const TriangleMesh& mesh);

/// Demands that viewpoints look at the surface from outside and not from on it.
/// @throws InvalidInput  a viewpoint inside the closed surface or within `clearance` mm of it
void requireViewFromOutside(const TriangleMesh& mesh, const visibility::Viewpoints& viewpoints,
                            double clearance = 1e-3);

}  // namespace explica::unfolding
