// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "ContourFiles.h"

#include "Explica/Core/WholeFile.h"
#include "Explica/Correspondence/Contours.h"
#include "Explica/IO/VtkFile.h"

#include <array>
#include <filesystem>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace explica::app {
namespace {

std::string contourTable(const std::vector<correspondence::Contour>& contours) {
  std::ostringstream table;
  table << "slice\tcontour\tclosed\tpoint\tinner_x_mm\tinner_y_mm\tinner_z_mm\tmiddle_x_mm\t"
           "middle_y_mm\tmiddle_z_mm\touter_x_mm\touter_y_mm\touter_z_mm\tthickness_mm\n";
  for (std::size_t c = 0; c < contours.size(); ++c) {
    const correspondence::Contour& contour = contours[c];
    for (std::size_t k = 0; k < contour.inner.size(); ++k) {
      table << contour.slice << '\t' << c + 1 << '\t' << (contour.closed ? "yes" : "no") << '\t'
            << k + 1;
      for (const Point& p : {contour.inner[k], contour.middle[k], contour.outer[k]}) {
        table << '\t' << p.x() << '\t' << p.y() << '\t' << p.z();
      }
      table << '\t' << contour.thickness[k] << '\n';
    }
  }
  return table.str();
}

/// Three lines for each contour, at depth 0, 0.5 and 1.
void writeContourLines(const std::filesystem::path& path,
                       const std::vector<correspondence::Contour>& contours) {
  std::vector<Point> points;
  std::vector<double> depth, thickness;
  std::vector<std::array<std::int32_t, 2>> lines;
  for (const correspondence::Contour& contour : contours) {
    for (const auto& [line, at] :
         {std::pair{&contour.inner, 0.0}, {&contour.middle, 0.5}, {&contour.outer, 1.0}}) {
      const auto first = static_cast<std::int32_t>(points.size());
      for (std::size_t k = 0; k < line->size(); ++k) {
        const auto here = static_cast<std::int32_t>(points.size());
        if (k > 0) lines.push_back({here - 1, here});
        points.push_back((*line)[k]);
        depth.push_back(at);
        thickness.push_back(contour.thickness[k]);
      }
      if (contour.closed) lines.push_back({static_cast<std::int32_t>(points.size()) - 1, first});
    }
  }
  Positions positions(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t p = 0; p < points.size(); ++p) positions.row(p) = points[p];
  io::Cells cells{io::CellKind::Line, {}};
  cells.vertices.resize(static_cast<Eigen::Index>(lines.size()), 2);
  for (std::size_t l = 0; l < lines.size(); ++l) cells.vertices.row(l) << lines[l][0], lines[l][1];
  const auto column = [](const std::vector<double>& values) {
    return Eigen::VectorXd(Eigen::VectorXd::Map(values.data(), values.size()));
  };
  io::writeVtu(path, positions, {cells},
               {{"depth", "", column(depth)}, {"thickness", "mm", column(thickness)}});
}

}  // namespace

void writeContours(Context& context, const correspondence::Measurement& m) {
  auto step = context.step("contours");
  const auto contours = correspondence::contoursOf(m.annulus, m.interpolant);
  context.result("contours", contours.size());
  if (contours.empty()) return;
  writeTextFile(context.output("contours.tsv"), contourTable(contours));
  writeContourLines(context.output("contours.vtu"), contours);
}

}  // namespace explica::app
