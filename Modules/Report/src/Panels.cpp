// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Panels.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Html.h"
#include "Explica/Core/Text.h"

#include <algorithm>
#include <map>

namespace explica::report {
namespace {

constexpr double kLegendShare = 0.13;   // of the width that the colour bar takes
constexpr double kSurfaceShape = 0.75;  // height over width of a panel
constexpr double kFlatShare = 0.6;      // of the width that a flat map is high at most

std::string svgText(double x, double y, double size, const std::string& text) {
  return printed("<text x='%.1f' y='%.1f' font-size='%.1f'>", x, y, size) + escapeHtml(text) +
         "</text>\n";
}

std::string layer(const char* name, const std::string& content) {
  return printed("<g id='%s' inkscape:groupmode='layer' inkscape:label='%s'>\n", name, name) +
         content + "</g>\n";
}

/// Half the height that every surface's picture shows, mm.
double commonHalfHeight(const std::vector<std::vector<Panel>>& rows, int width, int height) {
  double half = 0;
  for (const auto& row : rows) {
    for (const Panel& panel : row) {
      if (panel.marks) continue;
      half = std::max(half, cameraFor(*panel.mesh, panel.view, width, height).halfHeight);
    }
  }
  return half;
}

/// Where pictures go, and what the SVG has of them.
struct Sheet {
  Picture picture;
  std::string images, titles;
  double letters = 10;

  void add(const Picture& part, int x, int y, const std::string& title) {
    pastePicture(picture, part, x, y);
    images += svgImage(part, {x, y}, {part.width, part.height});
    if (title.empty()) return;
    drawText(picture, title, {x + letters, y + 1.5 * letters}, letters, kInk);
    titles += svgText(x + letters, y + 1.5 * letters, 1.4 * letters, title);
  }
};

std::string svgBar(const ColourScale& scale, double x, double top, double height, double letters) {
  constexpr int kStops = 33;
  std::string svg = "<defs><linearGradient id='colours' x1='0' y1='1' x2='0' y2='0'>";
  for (int n = 0; n < kStops; ++n) {
    const double t = static_cast<double>(n) / (kStops - 1);
    svg += printed("<stop offset='%.4f' stop-color='%s'/>", t,
                   hexText(colourAt(scale.map, t)).c_str());
  }
  svg += "</linearGradient></defs>\n";
  svg += printed("<rect x='%.1f' y='%.1f' width='%.1f' height='%.1f' fill='url(#colours)'/>\n", x,
                 top, 1.2 * letters, height);
  const double range = scale.high - scale.low;
  for (const double value : roundTicks(scale.low, scale.high)) {
    svg += svgText(x + 1.8 * letters, top + (scale.high - value) / range * height + 0.5 * letters,
                   1.4 * letters, tickText(value, range));
  }
  const std::string unit = scale.unit.empty() ? "" : " (" + unitText(scale.unit) + ")";
  return svg + svgText(x, top - letters, 1.4 * letters, scale.title + unit);
}

/// Height of a row of panels, pixels.
int heightOf(const std::vector<Panel>& row, int cell, int width) {
  double height = 0;
  for (const Panel& panel : row) {
    if (!panel.marks) {
      height = std::max(height, kSurfaceShape * cell);
      continue;
    }
    const Vector size =
        (panel.mesh->positions.colwise().maxCoeff() - panel.mesh->positions.colwise().minCoeff())
            .transpose();
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

void drawPanel(Sheet& sheet, Scenes& scenes, const Panel& panel, const Cell& cell,
               double halfHeight) {
  if (panel.marks) {
    const Picture flat = flatPanel(*panel.mesh, panel.paint, *panel.marks, cell.height);
    sheet.add(flat, cell.left + std::max(0, (cell.width - flat.width) / 2), cell.top, panel.title);
    return;
  }
  SurfacePictureOptions size{.width = cell.width, .height = cell.height};
  Camera camera = cameraFor(*panel.mesh, panel.view, cell.width, cell.height);
  camera.halfHeight = halfHeight;
  const SurfaceScene& scene = scenes.try_emplace(panel.mesh, *panel.mesh).first->second;
  const bool discrete = panel.paint.values.size() == 0 && panel.paint.labels.size() != 0;
  sheet.add(scene.render(camera, coloursOf(panel.paint, panel.mesh->vertexCount()),
                         discrete ? Filling::Discrete : Filling::Smooth, size),
            cell.left, cell.top, panel.title);
}

/// The colour bar right of the panels, in the picture and as SVG.
std::string drawBar(Sheet& sheet, const ColourScale& scale, int left) {
  const double width = sheet.picture.width, height = sheet.picture.height;
  const double tall = std::min(0.6 * height, 0.3 * width), top = (height - tall) / 2;
  drawColourBar(sheet.picture, scale, left, static_cast<int>(top - 3 * sheet.letters),
                sheet.picture.width - left, static_cast<int>(tall + 4 * sheet.letters));
  return svgBar(scale, left, top, tall, sheet.letters);
}

}  // namespace

PanelFigure panelFigure(const std::vector<std::vector<Panel>>& rows,
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
  Sheet sheet{Picture(width, height), "", "", std::clamp(width / 140.0, 8.0, 30.0)};
  Scenes scenes;
  Cell cell;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    cell.width = content / static_cast<int>(rows[r].size());
    cell.height = heights[r];
    cell.left = 0;
    const double half = commonHalfHeight(rows, cell.width, cell.height);
    for (const Panel& panel : rows[r]) {
      drawPanel(sheet, scenes, panel, cell, half);
      cell.left += cell.width;
    }
    cell.top += cell.height;
  }
  const std::string bar = scale ? drawBar(sheet, *scale, content) : "";
  const std::string head = printed(
      "<svg xmlns='http://www.w3.org/2000/svg' "
      "xmlns:inkscape='http://www.inkscape.org/namespaces/inkscape' width='%d' height='%d' "
      "viewBox='0 0 %d %d' font-family='Helvetica, Arial, sans-serif'>\n",
      width, height, width, height);
  return {std::move(sheet.picture), head + "<rect width='100%' height='100%' fill='white'/>\n" +
                                        layer("surfaces", sheet.images) +
                                        layer("titles", sheet.titles) + layer("colour-bar", bar) +
                                        "</svg>\n"};
}

}  // namespace explica::report
