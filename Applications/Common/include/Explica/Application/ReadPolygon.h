// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/Application/Declaration.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Planar/Contour.h"

#include <optional>
#include <string>

namespace explica::app {

/// How closed curves are taken from files: polygons as they are, or contours of a label in a slice.
struct PolygonReading {
  io::VolumeReadOptions volume;
  std::optional<int> label;
  std::optional<int> slice;
  int contour = 0;
  std::optional<int> edges;
  planar::ContourOptions contours;
};

/// Declares --label, --slice, --contour, --edges, --smooth and how volumes are read.
void declarePolygonReading(Declaration& d, PolygonReading& reading);

/// Reads a polygon or, where --label was given, a contour of a label image: counter-clockwise, in
/// the slice's plane frame.  Slice, number of contours and plane go into the record under `name`.
/// @throws InvalidInput  label absent, no such contour, an unusable polygon
[[nodiscard]] planar::Curve readCurve(Context& context, const std::string& name,
                                      const std::string& path, const PolygonReading& reading);

/// True for a name by which a polygon is read as a table of vertices.
[[nodiscard]] bool isPolygonTable(const std::string& path);

/// Name of the n-th frame of an evolution: "frames/frame-0003.csv".
[[nodiscard]] std::string frameName(std::size_t number, const std::string& extension);

}  // namespace explica::app
