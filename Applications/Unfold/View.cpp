// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "View.h"

#include "Explica/Core/Errors.h"
#include "Explica/Unfolding/Region.h"

namespace explica::app {

visibility::Viewpoints viewFrom(const ViewSettings& view, const std::optional<std::string>& surface,
                                const io::SurfaceReadOptions& reading, const TriangleMesh& mesh,
                                const Point& about, const Vector& normal) {
  const int given =
      !view.viewpoint.empty() + !view.direction.empty() + !view.line.empty() + surface.has_value();
  if (given > 1) {
    throw InvalidInput(
        "viewpoint: give one of --viewpoint, --direction, --view-line and --view-surface; "
        "--viewpoint and --direction may be repeated");
  }
  if (!view.viewpoint.empty()) return visibility::viewpoints(view.viewpoint);
  if (!view.line.empty()) {
    if (view.line.size() != 6) throw InvalidInput("view-line: needs six numbers X,Y,Z,X,Y,Z");
    return visibility::viewLine(Point(view.line[0], view.line[1], view.line[2]),
                                Point(view.line[3], view.line[4], view.line[5]));
  }
  if (surface) return visibility::viewSurface(io::readSurface(*surface, reading).mesh);
  const double distance = view.distance ? *view.distance : unfolding::usualDistance(mesh);
  std::vector<Vector> directions(view.direction.begin(), view.direction.end());
  if (directions.empty()) {
    constexpr double kCancelled = 1e-6;  // of the mean normal of a flat region
    if (!(normal.norm() > kCancelled)) {
      throw InvalidInput(
          "the region's normals cancel out, so that it has no mean normal to be seen along; give "
          "--direction or --viewpoint");
    }
    directions.push_back(normal);
  }
  std::vector<Point> points;
  for (const Vector& direction : directions) {
    const double length = direction.norm();
    if (!(length > 0)) throw InvalidInput("direction: has no length");
    points.emplace_back(about + distance / length * direction);
  }
  return visibility::viewpoints(points);
}

}  // namespace explica::app
