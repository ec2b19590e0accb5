// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "View.h"

#include "Explica/Core/Errors.h"

namespace explica::app {

visibility::Viewpoints viewFrom(const ViewSettings& view, const std::optional<std::string>& surface,
                                const io::SurfaceReadOptions& reading, const Point& about) {
  const int given = view.viewpoint.has_value() + view.direction.has_value() + !view.line.empty() +
                    surface.has_value();
  if (given != 1) {
    throw InvalidInput(
        "viewpoint: give exactly one of --viewpoint, --direction, --view-line and --view-surface");
  }
  if (view.viewpoint) return visibility::viewpoint(*view.viewpoint);
  if (view.direction) {
    const double length = view.direction->norm();
    if (!(length > 0)) throw InvalidInput("direction: has no length");
    if (!(view.distance > 0)) throw InvalidInput("distance: must be positive");
    return visibility::viewpoint(about + view.distance / length * *view.direction);
  }
  if (!view.line.empty()) {
    if (view.line.size() != 6) throw InvalidInput("view-line: needs six numbers X,Y,Z,X,Y,Z");
    return visibility::viewLine(Point(view.line[0], view.line[1], view.line[2]),
                                Point(view.line[3], view.line[4], view.line[5]));
  }
  return visibility::viewSurface(io::readSurface(*surface, reading).mesh);
}

}  // namespace explica::app
