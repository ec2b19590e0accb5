// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "StatsFile.h"

#include "Explica/Core/Text.h"

#include <array>

namespace explica::app {
namespace {

/// One column of the table as its head describes it.
struct StatsColumn {
  const char *header, *field, *unit;
};
constexpr std::array<StatsColumn, 7> kStatsColumns = {
    {{"StructName", "Structure Name", "NA"},
     {"NumVert", "Number of Vertices", "unitless"},
     {"SurfArea", "Surface Area", "mm^2"},
     {"GrayVol", "Gray Matter Volume", "mm^3"},
     {"ThickAvg", "Average Thickness", "mm"},
     {"ThickStd", "Thickness StdDev", "mm"},
     {"MeanCurv", "Integrated Rectified Mean Curvature", "mm^-1"}}};

}  // namespace

std::string statsText(const StatsHead& head, const StatsRow& cortex,
                      const std::vector<StatsRow>& rows) {
  std::string text = "# Table of FreeSurfer cortical parcellation anatomical statistics \n#\n";
  text += "# generating_program explica regions\n# anatomy_type surface\n";
  text += "# subjectname " + head.subject + "\n# hemi " + head.hemisphere + "\n";
  text += "# AnnotationFile " + head.atlas + "\n";
  text += printed("# Measure Cortex, NumVert, Number of Vertices, %ld, unitless\n",
                  static_cast<long>(cortex.vertices));
  text +=
      printed("# Measure Cortex, WhiteSurfArea, White Surface Total Area, %g, mm^2\n", cortex.area);
  text +=
      printed("# Measure Cortex, MeanThickness, Mean Thickness, %g, mm\n", cortex.thicknessMean);
  text += printed("# Measure Cortex, CortexVol, Total cortical gray matter volume, %f, mm^3\n",
                  cortex.volume);
  text += printed("# NTableCols %zu\n", kStatsColumns.size());
  std::string headers = "# ColHeaders";
  for (std::size_t c = 0; c < kStatsColumns.size(); ++c) {
    const StatsColumn& column = kStatsColumns[c];
    text += printed("# TableCol %2zu ColHeader %s\n", c + 1, column.header);
    text += printed("# TableCol %2zu FieldName %s\n", c + 1, column.field);
    text += printed("# TableCol %2zu Units     %s\n", c + 1, column.unit);
    headers += std::string(" ") + column.header;
  }
  text += headers + "\n";
  for (const StatsRow& row : rows) {
    text += row.name + printed("%*s%5ld%7.0f%7.0f%7.3f%6.3f%10.3f\n",
                               row.name.size() < 40 ? static_cast<int>(40 - row.name.size()) : 1,
                               " ", static_cast<long>(row.vertices), row.area, row.volume,
                               row.thicknessMean, row.thicknessDeviation, row.meanCurvature);
  }
  return text;
}

}  // namespace explica::app
