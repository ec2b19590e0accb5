// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Ventricle/Beat.h"

#include "Explica/Core/Text.h"

#include <cmath>
#include <initializer_list>

namespace explica::ventricle {

namespace {

std::string number(double value, int digits = 3) {
  return std::isfinite(value) ? printed("%.*f", digits, value) : "n/a";
}

std::string line(std::initializer_list<std::string> cells) {
  return joined(cells, "\t") + "\n";
}

std::string phaseOf(const Beat& beat, std::size_t f) {
  if (f == beat.diastole) return "ED";
  return f == beat.systole ? "ES" : "n/a";
}

}  // namespace

std::string frameTable(const Beat& beat) {
  std::string text = line({"frame", "phase", "cavity_volume_ml", "wall_volume_ml", "mass_g",
                           "thickness_mean", "thickness_plain", "thickening"});
  for (std::size_t f = 0; f < beat.frames.size(); ++f) {
    const Frame& frame = beat.frames[f];
    text += line({std::to_string(frame.number), phaseOf(beat, f), number(frame.cavity),
                  number(frame.wall), number(frame.mass), number(frame.thickness),
                  number(frame.plain), number(frame.thickening, 1)});
  }
  return text;
}

std::string segmentTable(const Beat& beat) {
  std::string text =
      line({"segment", "name", "frame", "thickness", "sd", "thickening", "thickness_min",
            "thickness_max", "thickness_plain", "voxels", "left_out", "thickening_mm"});
  const auto& diastole = beat.atDiastole().segments->rows;
  for (const Frame& frame : beat.frames) {
    if (!frame.segments) continue;
    for (const Segment& row : frame.segments->rows) {
      text += line(
          {std::to_string(row.number), segmentName(row.number, beat.oriented()),
           std::to_string(frame.number), number(row.thickness), number(row.deviation),
           number(row.thickening, 1), number(row.lowest), number(row.highest), number(row.plain),
           std::to_string(row.voxels), std::to_string(row.leftOut),
           number(row.thickness - diastole[static_cast<std::size_t>(row.number - 1)].thickness)});
    }
  }
  return text;
}

std::string sliceTable(const Beat& beat) {
  std::string text =
      line({"frame", "slice", "kind", "cavity_mm2", "wall_mm2", "open_share", "area_equivalent",
            "thickness_plain", "thickness", "obliquity_deg", "voxels", "left_out"});
  for (const Frame& frame : beat.frames) {
    for (const SliceRow& row : sliceRows(frame)) {
      text += line({std::to_string(frame.number), std::to_string(row.slice),
                    std::string(nameOf(row.kind)), number(row.cavityArea, 1),
                    number(row.wallArea, 1), number(row.openShare), number(row.areaEquivalent),
                    number(row.plain), number(row.thickness), number(row.obliquityDeg, 1),
                    std::to_string(row.counted), std::to_string(row.leftOut)});
    }
  }
  return text;
}

}  // namespace explica::ventricle
