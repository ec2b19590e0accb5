// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/ReadPolygon.h"

#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"
#include "Explica/IO/PolygonFile.h"

#include <nlohmann/json.hpp>

namespace explica::app {

void declarePolygonReading(Declaration& d, PolygonReading& r) {
  d.options("Reading", r.volume)
      .category("Contour")
      .option("label-key", "take the contour of this label of an image", r.label)
      .option(
          {"slice", "", "slice along the third axis; default: where the label is largest", 0, 1e6},
          r.slice)
      .option({"contour", "", "which contour, by area, 0 the largest", 0, 1e6}, r.contour)
      .option({"edges", "", "resample the contour to this many equal edges", 0, 1e7}, r.edges)
      .option({"smooth", "voxels", "Gaussian that anti-aliases the label's mask"},
              r.contours.smoothing);
}

planar::Curve readCurve(Context& context, const std::string& name, const std::string& path,
                        const PolygonReading& reading) {
  planar::Curve curve;
  if (!reading.label) {
    curve.positions = io::readPolygon(path);
    planar::requireUsable(curve);
    return curve;
  }
  const Volume<Label> labels = readLabels(context, name, path, reading.volume);
  const int slice = reading.slice.value_or(planar::largestSlice(labels, *reading.label));
  if (slice < 0) {
    throw InvalidInput(path + ": label " + std::to_string(*reading.label) + " is absent");
  }
  const auto contours = planar::contoursOfLabel(labels, *reading.label, slice, reading.contours);
  if (reading.contour < 0 || reading.contour >= static_cast<int>(contours.size())) {
    throw InvalidInput("contour " + std::to_string(reading.contour) + " is not among the " +
                       std::to_string(contours.size()) + " contours of slice " +
                       std::to_string(slice));
  }
  curve = contours[reading.contour];
  if (planar::signedArea(curve.positions) < 0) {  // a hole's rim: a polygon of its own
    curve.positions = curve.positions.colwise().reverse().eval();
  }
  if (reading.edges) curve = planar::resampled(curve, *reading.edges);
  const planar::PlaneFrame frame = planar::frameOfSlice(labels.grid, slice);
  const auto array = [](const Eigen::Vector3d& v) {
    return std::vector<double>{v.x(), v.y(), v.z()};
  };
  context.result("slice", slice);
  context.result("contours", contours.size());
  context.result("plane_origin", array(frame.origin));
  context.result("plane_x", array(frame.axisX));
  context.result("plane_y", array(frame.axisY));
  return curve;
}

bool isPolygonTable(const std::string& path) {
  return path.ends_with(".csv") || path.ends_with(".txt") || path.ends_with(".tsv");
}

std::string frameName(std::size_t number, const std::string& extension) {
  return printed("frames/frame-%04zu", number) + extension;
}

}  // namespace explica::app
