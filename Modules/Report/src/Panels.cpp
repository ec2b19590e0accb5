// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Panels.h"

#include "Explica/Core/EigenViews.h"
#include "Explica/Core/Errors.h"

#include <algorithm>
#include <map>

namespace explica::report {
namespace {

constexpr double kLegendShare = 0.13;   // of the width that the colour bar takes
constexpr double kSurfaceShape = 0.75;  // height over width of a panel
constexpr double kFlatShare = 0.6;      // of the width that a flat map is high at most

/// Half the height that every surface's picture shows, mm.
double commonHalfHeight(const std::vector<std::vector<Panel>>& rows, int width, int height) {
  double half = 0;
  for (const auto& row : rows) {
    for (const Panel& panel : row) {
      if (panel.marks) continue;
      half = std::max(half, cameraFor(panel.mesh->positions, panel.view, width, height).halfHeight);
    }
  }
  return half;
}

/// Height of a row of panels, pixels.
int heightOf(const std::vector<Panel>& row, int cell, int width) {
  double height = 0;
  for (const Panel& panel : row) {
    if (!panel.marks) {
      height = std::max(height, kSurfaceShape * cell);
      continue;
    }
    const Vector size = boundingBox(panel.mesh->positions).sizes();
    const double shape = std::clamp(size.x() / std::max(size.y(), 1e-9), 0.5, 2.0);
    height = std::max(height, std::min(kFlatShare * width, cell / shape));
  }
  return static_cast<int>(height);
}

using Scenes = std::map<const TriangleMesh*, SurfaceScene>;

/// Where a panel goes, pixels.
struct Cell {
  int left = 0, top = 0, width = 0, height = 0;
};

void drawPanel(Canvas& canvas, Scenes& scenes, const Panel& panel, const Cell& cell,
               double halfHeight, double letters) {
  Point2 corner(cell.left, cell.top);
  if (panel.marks) {
    const Canvas flat = flatPanel(*panel.mesh, panel.paint, *panel.marks, cell.height);
    corner.x() += std::max(0, (cell.width - flat.width()) / 2);
    canvas.add(flat, corner);
  } else {
    SurfacePictureOptions size{.width = cell.width, .height = cell.height};
    Camera camera = cameraFor(panel.mesh->positions, panel.view, cell.width, cell.height);
    camera.halfHeight = halfHeight;
    const SurfaceScene& scene = scenes.try_emplace(panel.mesh, *panel.mesh).first->second;
    const bool discrete = panel.paint.values.size() == 0 && panel.paint.labels.size() != 0;
    canvas.layer("surfaces");
    canvas.image(corner, {cell.width, cell.height},
                 scene.render(camera, coloursOf(panel.paint, panel.mesh->vertexCount()),
                              discrete ? Filling::Discrete : Filling::Smooth, size));
  }
  if (panel.title.empty()) return;
  canvas.layer("titles");
  canvas.text(corner + Point2(letters, 1.5 * letters), panel.title, letters, kInk,
              TextAnchor::Left);
}

}  // namespace

Canvas panelFigure(const std::vector<std::vector<Panel>>& rows,
                   const std::optional<ColourScale>& scale, int width) {
  if (rows.empty()) throw InvalidInput("figure: no panel");
  const int content = scale ? static_cast<int>((1 - kLegendShare) * width) : width;
  std::vector<int> heights;
  int height = 0;
  for (const auto& row : rows) {
    if (row.empty()) throw InvalidInput("figure: a row without panels");
    heights.push_back(heightOf(row, content / static_cast<int>(row.size()), content));
    height += heights.back();
  }
  Canvas canvas(width, height);
  const double letters = std::clamp(width / 140.0, 8.0, 30.0);
  Scenes scenes;
  Cell cell;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    cell.width = content / static_cast<int>(rows[r].size());
    cell.height = heights[r];
    cell.left = 0;
    const double half = commonHalfHeight(rows, cell.width, cell.height);
    for (const Panel& panel : rows[r]) {
      drawPanel(canvas, scenes, panel, cell, half, letters);
      cell.left += cell.width;
    }
    cell.top += cell.height;
  }
  if (!scale) return canvas;
  const double tall = std::min(0.6 * height, 0.3 * width);
  canvas.layer("colour-bar");
  drawColourBar(canvas, *scale, {content, (height - tall) / 2}, {1.2 * letters, tall}, letters);
  return canvas;
}

}  // namespace explica::report
