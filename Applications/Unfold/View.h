// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Visibility/Viewpoints.h"

#include <optional>
#include <string>
#include <vector>

namespace explica::app {

/// Where to look from.
struct ViewSettings {
  std::vector<Eigen::Vector3d> viewpoint;
  std::vector<Eigen::Vector3d> direction;
  std::optional<double> distance;
  std::vector<double> line;
};

template <class Visitor>
void describe(ViewSettings& view, Visitor&& visit) {
  visit(Field{"viewpoint", "mm", "point to look from; of several the mean counts"}, view.viewpoint);
  visit(Field{"direction", "",
              "look from the region's centroid plus --distance along this (default the region's "
              "mean normal)"},
        view.direction);
  visit(Field{"distance", "mm",
              "how far off a viewpoint given by its direction is (default 1000, or three times the "
              "surface's extent if that is more)",
              kAboveZero},
        view.distance);
  visit(Field{"view-line", "mm", "look from a segment: X,Y,Z of its start and of its end"},
        view.line);
}

/// The viewpoints that the options name, or one that faces the region.
/// @param mesh    the surface that is looked at
/// @param about   what a direction counts from, RAS mm
/// @param normal  the direction where none is given: the mean of unit normals
/// @throws InvalidInput  several ways of naming them; a direction without length; no direction, and
///                       normals that cancel
[[nodiscard]] visibility::Viewpoints viewFrom(const ViewSettings& view,
                                              const std::optional<std::string>& surface,
                                              const io::SurfaceReadOptions& reading,
                                              const TriangleMesh& mesh, const Point& about,
                                              const Vector& normal);

}  // namespace explica::app
