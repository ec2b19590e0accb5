// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "ReportParts.h"

#include <algorithm>
#include <array>

namespace explica::pipeline {
namespace {

/// How a number of a summary is shown.
enum class Shown { Plain, Percent, SquareCentimetres, Range };

/// A row of the table: where its number is found, and what it means.
struct Finding {
  const char* command;
  const char* key;
  const char* start;  ///< key of the value at the start, shown before it; or empty
  const char* what;
  const char* unit;
  Shown shown;
  const char* meaning;
};

// What the head of a page shows, in this order.
constexpr std::array kFindings = {
    Finding{"segment", "brain_volume_ml", "", "Brain volume", "ml", Shown::Plain,
            "Everything inside the brain mask."},
    Finding{"segment", "white_share", "", "White matter in it", "", Shown::Percent,
            "Shares of the brain's volume."},
    Finding{"segment", "grey_share", "", "Grey matter in it", "", Shown::Percent, ""},
    Finding{"segment", "csf_share", "", "Fluid in it", "", Shown::Percent, ""},
    Finding{
        "surface", "thickness_mean", "", "Cortical thickness, mean", "mm", Shown::Plain,
        "Length of the paths from the white to the pial surface that follow the gradient of "
        "the harmonic function between them, averaged over the surface's area. The mean over the "
        "tissue's voxels is greater: a thick column holds more voxels."},
    Finding{"surface", "thickness_sd", "", "Cortical thickness, standard deviation", "mm",
            Shown::Plain, ""},
    Finding{"thickness", "thickness_mean_columns", "", "Thickness, mean over columns", "mm",
            Shown::Plain,
            "n / sum(1/t) over the tissue's voxels: each column counts once, however thick. The "
            "plain mean is greater: a thick column holds more voxels."},
    Finding{"thickness", "thickness_p95", "thickness_p05", "Thickness, 5th to 95th percentile",
            "mm", Shown::Range, "Over voxels."},
    Finding{"thickness", "voxels", "", "Voxels of tissue", "", Shown::Plain, ""},
    Finding{"thickness", "voxels_without_thickness", "", "Voxels without thickness", "",
            Shown::Plain, "No path leads from them to both boundaries."},
    Finding{"thickness", "sulcal_voxels_recovered", "", "Voxels of hidden sulci recovered", "",
            Shown::Plain, "Tissue where banks touch, taken for what lies between them."},
    Finding{"surface", "area_white", "", "Area of the white surface", "cm\u00b2",
            Shown::SquareCentimetres, ""},
    Finding{"surface", "area_pial", "", "Area of the pial surface", "cm\u00b2",
            Shown::SquareCentimetres, ""},
    Finding{"surface", "defects_corrected", "", "Topological defects corrected", "", Shown::Plain,
            "Handles that were cut and tunnels that were filled before the surface was made."},
    Finding{
        "heart", "cavity_volume_ed_ml", "", "Cavity at end-diastole", "ml", Shown::Plain,
        "Voxels of the left ventricle's cavity in the frame where they are most; healthy women "
        "135 \u00b1 26, men 160 \u00b1 29 (Hudsmith et al. 2005, J Cardiovasc Magn Reson 7:775)."},
    Finding{"heart", "cavity_volume_es_ml", "", "Cavity at end-systole", "ml", Shown::Plain,
            "Healthy women 42 \u00b1 12, men 50 \u00b1 16 (the same)."},
    Finding{"heart", "ejection_fraction_percent", "", "Ejection fraction", "%", Shown::Plain,
            "Share of the end-diastolic volume that leaves the cavity; healthy women 61 \u00b1 5, "
            "men 58 \u00b1 5 (Petersen et al. 2017, J Cardiovasc Magn Reson 19:18)."},
    Finding{"heart", "mass_ed_g", "", "Mass of the wall", "g", Shown::Plain,
            "Volume of the wall at end-diastole times 1.05 g/ml; papillary muscles belong to "
            "whatever label they have; healthy women 98 \u00b1 21, men 134 \u00b1 21 where they "
            "are part of "
            "the wall (Kawel-Boehm et al. 2015, J Cardiovasc Magn Reson 17:29)."},
    Finding{"heart", "thickness_mean_ed", "", "Wall thickness at end-diastole, mean", "mm",
            Shown::Plain, "Over the columns of the wall that count (see the slices below)."},
    Finding{"heart", "thickening_percent", "", "Thickening, mean", "%", Shown::Plain,
            "Of that mean, from end-diastole to end-systole."},
    Finding{"heart", "axis_angle_deg", "", "Long axis to the slices' normal", "\u00b0",
            Shown::Plain, ""},
    Finding{"unfold", "region_area", "", "Area of the patch", "cm\u00b2", Shown::SquareCentimetres,
            ""},
    Finding{"unfold", "visibility_final", "visibility_initial", "Average visibility", "",
            Shown::Plain,
            "Mean cosine under which the patch's faces look at the viewpoint, before and after."},
    Finding{"unfold", "seen_final", "seen_initial", "Seen from the viewpoint", "", Shown::Percent,
            "Share of the patch's area that nothing hides, before and after."},
    Finding{"unfold", "area_error_mean", "", "Error of areas, mean", "", Shown::Percent,
            "Of the patch's faces."},
    Finding{"unfold", "edge_strain_mean", "", "Change of lengths, mean", "", Shown::Percent,
            "Of the patch's edges."},
    Finding{"flatten", "area", "", "Area of the patch", "cm\u00b2", Shown::SquareCentimetres,
            "On the surface where areas and lengths count."},
    Finding{"flatten", "area_error_mean", "", "Error of areas in the flat map, mean", "",
            Shown::Percent, "Of the patch's faces."},
    Finding{"flatten", "edge_strain_mean", "", "Change of lengths, mean", "", Shown::Percent,
            "Of the patch's edges."},
    Finding{"flatten", "geodesic_error_local", "", "Error of distances up to 30 mm, mean", "",
            Shown::Percent,
            "Straight on the map against along the surface, at the scale that suits all best."},
    Finding{"flatten", "geodesic_error_all", "", "Error of all distances, mean", "", Shown::Percent,
            ""},
    Finding{"flatten", "cuts", "", "Relief cuts", "", Shown::Plain,
            "Found by the program, along sulci where that is not much longer."},
    Finding{"flatten", "cut_length", "", "Length of the cuts", "mm", Shown::Plain, ""},
    Finding{"repair", "pairs_after", "pairs_before", "Pairs of faces that cross", "", Shown::Plain,
            "Before and after, by an exact test."},
    Finding{"repair", "vertices_moved", "", "Vertices moved", "", Shown::Plain,
            "All others keep every bit."},
    Finding{"repair", "move_mean", "", "Their move, mean", "mm", Shown::Plain, ""},
    Finding{"repair", "move_max", "", "Their move, largest", "mm", Shown::Plain, ""},
    Finding{"sample", "vertices", "", "Vertices", "", Shown::Plain, ""},
    Finding{"sample", "layers", "", "Layers", "", Shown::Plain, ""},
    Finding{"sample", "points", "", "Points", "", Shown::Plain, ""},
    Finding{"sample", "points_distance_max", "", "Farthest point from the cortex", "mm",
            Shown::Plain, "Of its nearest column from white to pial."},
    Finding{"polygon", "visibility_final", "visibility_initial", "Average visibility", "",
            Shown::Plain,
            "Mean cosine under which the region's edges look at the viewpoint, before and after."},
    Finding{"polygon", "seen_final", "seen_initial", "Seen from the viewpoint", "", Shown::Percent,
            "Share of the region's length that nothing hides, before and after."},
    Finding{"polygon", "region_edges", "", "Edges of the region", "", Shown::Plain, ""},
    Finding{"polygon", "length_final", "length_initial", "Length of the region", "", Shown::Plain,
            "In the units of the file, before and after."},
    Finding{"polygon", "length_error_max", "", "Error of an edge's length, largest", "",
            Shown::Percent, ""},
    Finding{"polygon", "iterations", "", "Iterations", "", Shown::Plain, ""},
    Finding{"embed", "distance_mean", "", "Distance from the target, mean", "mm", Shown::Plain, ""},
    Finding{"embed", "distance_max", "", "Distance from the target, largest", "mm", Shown::Plain,
            ""},
    Finding{"embed", "symmetric_difference_final", "symmetric_difference_initial",
            "Symmetric difference", "", Shown::Plain,
            "What one of shape and target holds and the other does not, before and after the fit: "
            "mm\u00b2 of a plane, mm\u00b3 of space."},
    Finding{"embed", "targets", "", "Targets", "", Shown::Plain, ""},
    Finding{"embed", "order", "", "Highest angular frequency", "", Shown::Plain, ""},
    Finding{"embed", "inner_radius", "", "Inner radius of the annulus", "mm", Shown::Plain, ""},
    Finding{"embed", "outer_radius", "", "Outer radius of the annulus", "mm", Shown::Plain, ""},
    Finding{"inflate", "visibility_final", "visibility_initial", "Global visibility", "",
            Shown::Plain,
            "Share of the view from all around that reaches the surface, each place weighing the "
            "viewpoints before it by the cosine, before and after; 1 for convex surfaces only."},
    Finding{"inflate", "seen_final", "seen_initial", "Seen from somewhere", "", Shown::Percent,
            "Share of the area that any viewpoint of the enclosing sphere sees, before and after."},
    Finding{"inflate", "area_error_mean", "", "Error of areas, mean", "", Shown::Percent,
            "Of the surface's faces."},
    Finding{"inflate", "edge_strain_mean", "", "Change of lengths, mean", "", Shown::Percent,
            "Of the surface's edges."},
    Finding{"inflate", "angle_error_mean_deg", "", "Change of angles, mean", "\u00b0", Shown::Plain,
            "Largest of each face."},
    Finding{"inflate", "geodesic_error_local", "", "Error of distances within 30 mm", "",
            Shown::Percent, "Along the surface, at the scale that suits it best."},
    Finding{"sphere", "turned_over", "", "Faces turned over", "", Shown::Plain, ""},
    Finding{"sphere", "areal_log2_mean", "", "Change of areas, mean of |log2|", "", Shown::Plain,
            "Over the surface's area."},
    Finding{"sphere", "stretch_median", "", "Largest over smallest stretch, median", "",
            Shown::Plain, "Over the surface's area; 1 where angles are kept."},
    Finding{"sphere", "stretch_p95", "", "Largest over smallest stretch, 95th percentile", "",
            Shown::Plain, ""},
};

std::string shownAs(Shown shown, double value) {
  switch (shown) {
    case Shown::Percent:
      return percent(value);
    case Shown::SquareCentimetres:
      return readable(value / 100);
    default:
      return readable(value);
  }
}

std::string valueIn(const StepFolder& step, const Finding& finding) {
  const auto value = step.number(finding.key);
  if (!value) return "";
  const auto start = *finding.start != '\0' ? step.number(finding.start) : std::nullopt;
  const char* between = finding.shown == Shown::Range ? " to " : " \u2192 ";
  return (start ? shownAs(finding.shown, *start) + between : "") + shownAs(finding.shown, *value);
}

/// Numbers of a command that has no rows of its own in the table.
void listOwnNumbers(const StepFolder& step, report::ReportFindings& findings) {
  constexpr std::size_t kMost = 12;  // rows
  for (const auto& [key, value] : step.summary.items()) {
    if (findings.rows.size() >= kMost) return;
    if (!value.is_number() || key.rfind("seconds", 0) == 0 || key == "peak_memory_bytes") continue;
    findings.rows.push_back({inWords(key), "", {readable(value)}});
  }
}

}  // namespace

void findNumbers(ResultFolder& results) {
  report::ReportFindings& findings = results.content().findings;
  std::vector<std::string> sides;
  for (const StepFolder& step : results.steps()) {
    if (!step.side().empty() && std::find(sides.begin(), sides.end(), step.side()) == sides.end()) {
      sides.push_back(step.side());
    }
  }
  std::sort(sides.begin(), sides.end());
  if (sides.size() < 2) sides = {""};
  findings.columns = sides;
  for (const Finding& finding : kFindings) {
    report::ReportFindings::Row row{finding.what, finding.unit, {}, finding.meaning};
    for (const std::string& side : sides) {
      std::string value;
      for (const StepFolder* step : results.stepsOf(finding.command)) {
        if (side.empty() || step->side() == side || step->side().empty()) {
          value = valueIn(*step, finding);
        }
      }
      row.values.push_back(value);
    }
    // The thickness is stated once: that of the surfaces where there are any.
    if (finding.command == std::string_view("thickness") && !results.stepsOf("surface").empty()) {
      continue;
    }
    const bool known =
        std::any_of(row.values.begin(), row.values.end(), [](const auto& v) { return !v.empty(); });
    if (known) findings.rows.push_back(std::move(row));
  }
  if (findings.rows.empty() && results.steps().size() == 1) {
    listOwnNumbers(results.steps().front(), findings);
  }
}

}  // namespace explica::pipeline
