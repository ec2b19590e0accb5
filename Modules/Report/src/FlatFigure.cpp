// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Report/FlatFigure.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <cmath>

namespace explica::report {
namespace {

constexpr Colour kInk = {0.01f, 0.01f, 0.01f};
constexpr double kBarShare = 0.25;  // of the picture's width that the scale bar takes at most

void drawScaleBar(Picture& picture, double pixelsPerMillimetre, int width, int height) {
  const double length = roundLength(kBarShare * width / pixelsPerMillimetre);
  const double letters = std::clamp(height / 60.0, 9.0, 16.0);
  const Eigen::Vector2d from(letters, height - 1.2 * letters);
  const Eigen::Vector2d to = from + Eigen::Vector2d(length * pixelsPerMillimetre, 0);
  drawSegments(picture, {{from, to}}, kInk, letters / 4);
  drawText(picture, tickText(length, length) + " mm",
           (from + to) / 2 - Eigen::Vector2d(0, 0.6 * letters), letters, kInk, TextAnchor::Middle);
}

}  // namespace

double roundLength(double length) {
  if (!(length > 0)) throw InvalidInput("length: must be above 0");
  const double power = std::pow(10.0, std::floor(std::log10(length)));
  for (const double step : {5.0, 2.0}) {
    if (step * power <= length) return step * power;
  }
  return power;
}

Picture flatFigure(const TriangleMesh& mesh, const SurfacePaint& paint, const FlatMarks& marks,
                   int height) {
  FigureView above;
  above.towards = Vector(0, 0, -1);
  above.up = Vector(0, 1, 0);
  const Vector size =
      (mesh.positions.colwise().maxCoeff() - mesh.positions.colwise().minCoeff()).transpose();
  SurfacePictureOptions options;
  options.height = height;
  options.width = static_cast<int>(
      std::clamp(height * size.x() / std::max(size.y(), 1e-9), height / 2.0, 2.0 * height));
  options.occlusion = 0;
  Picture picture = surfaceFigure(mesh, paint, {above}, 1, options);
  const Camera camera = cameraOf(mesh, above, options.width, options.height);
  const double scale = options.height / (2 * camera.halfHeight);  // pixels a millimetre
  const auto pixelOf = [&](const Point& p) {
    return Eigen::Vector2d(options.width / 2.0 + scale * (p.x() - camera.target.x()),
                           options.height / 2.0 - scale * (p.y() - camera.target.y()));
  };
  std::vector<Segment2> segments;
  for (const auto& [from, to] : marks.lines) segments.push_back({pixelOf(from), pixelOf(to)});
  drawSegments(picture, segments, kInk, height / 450.0);
  const double letters = std::clamp(height / 75.0, 8.0, 14.0);
  for (const auto& [place, name] : marks.names) {
    drawText(picture, name, pixelOf(place), letters, kInk, TextAnchor::Middle);
  }
  drawScaleBar(picture, scale, options.width, options.height);
  return picture;
}

}  // namespace explica::report
