// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Ventricle/Summary.h"

#include "Explica/Ventricle/Reference.h"

#include <algorithm>
#include <cmath>

namespace explica::ventricle {
namespace {

/// A number, or nothing where it is not known.
std::optional<double> known(double value) {
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::int64_t countOf(const Frame& frame, LeftOut why) {
  if (!frame.measures) return 0;
  const auto& reasons = frame.measures->reasons.data;
  return std::count(reasons.begin(), reasons.end(), static_cast<std::uint8_t>(why));
}

/// What healthy women and men have, two standard deviations to either side.
void besideHealthy(Result& result, Quantity quantity) {
  const Reference& healthy = referenceOf(quantity);
  result.inHead().usual(std::min(healthy.women.low(), healthy.men.low()),
                        std::max(healthy.women.high(), healthy.men.high()),
                        "healthy " + rangeText(healthy) + ", " + healthy.source);
}

void describeVolumes(Results& t, const Frame& ed, const Frame& es, double ejection, bool beats) {
  const auto later = [&](double value) { return beats ? known(value) : std::nullopt; };
  besideHealthy(t.number("cavity_volume_ed_ml", "Cavity at end-diastole", "ml",
                         "Voxels of the left ventricle's cavity in the frame where they are most.",
                         known(ed.cavity)),
                Quantity::DiastolicVolume);
  besideHealthy(
      t.number("cavity_volume_es_ml", "Cavity at end-systole", "ml", "", later(es.cavity)),
      Quantity::SystolicVolume);
  t.number("stroke_volume_ml", "Stroke volume", "ml", "", later(ed.cavity - es.cavity));
  besideHealthy(
      t.number("ejection_fraction_percent", "Ejection fraction", "%",
               "Share of the end-diastolic volume that leaves the cavity.", later(ejection)),
      Quantity::Ejection);
  t.number("wall_volume_ed_ml", "Volume of the wall", "ml", "At end-diastole.", known(ed.wall));
  besideHealthy(
      t.number("mass_ed_g", "Mass of the wall", "g",
               "Volume of the wall at end-diastole times 1.05 g/ml; papillary muscles belong to "
               "whatever label they have, in healthy people here to the wall.",
               known(ed.mass)),
      Quantity::Mass);
}

void describeThickness(Results& t, const Frame& ed, const Frame& es, bool beats) {
  const auto later = [&](double value) { return beats ? known(value) : std::nullopt; };
  t.number("thickness_mean_ed", "Mean wall thickness at end-diastole", "mm",
           "Over the part of the wall included in the mean.", known(ed.thickness))
      .inHead();
  t.number("thickness_mean_es", "Mean wall thickness at end-systole", "mm", "",
           later(es.thickness));
  t.number("thickening_percent", "Mean thickening", "%",
           "Of that mean, from end-diastole to end-systole.", later(es.thickening))
      .inHead();
  t.number("thickness_plain_ed", "Mean wall thickness within slices", "mm",
           "At end-diastole, before the wall's slope to the slices is taken into account.",
           known(ed.plain));
  constexpr std::array kLeftOut = {std::pair{LeftOut::Opening, "voxels_left_out_opening_ed"},
                                   std::pair{LeftOut::Valve, "voxels_left_out_valve_ed"},
                                   std::pair{LeftOut::Cap, "voxels_left_out_cap_ed"},
                                   std::pair{LeftOut::Unreached, "voxels_left_out_unreached_ed"}};
  t.count("voxels_counted_ed", "Voxels of the wall included in the mean", "At end-diastole.",
          countOf(ed, LeftOut::None));
  for (const auto& [why, key] : kLeftOut) {
    t.count(key, "Voxels of the wall left out: " + std::string(nameOf(why)), "At end-diastole.",
            countOf(ed, why));
  }
}

}  // namespace

void describe(Results& t, const HeartSummary& s) {
  static const Beat none = [] {
    Beat beat;
    beat.frames.resize(1);
    return beat;
  }();
  const Beat& beat = s.beat ? *s.beat : none;
  const Frame &ed = beat.atDiastole(), &es = beat.atSystole();
  const bool beats = beat.systole != beat.diastole;
  t.text("labels", "Labels", "The convention that they follow.", s.labels);
  t.share("open_share_ed", "Open at the base",
          "Share of the cavity's surface at end-diastole that has no wall.", s.openShare);
  t.count("frames", "Frames", "", beat.frames.size());
  t.count("frames_with_wall", "Frames with a wall", "",
          std::count_if(beat.frames.begin(), beat.frames.end(),
                        [](const Frame& f) { return f.segments.has_value(); }));
  std::int64_t missing = 0, enclosed = 0;
  for (const Frame& frame : beat.frames) {
    missing += missingSlices(frame.heart);
    enclosed += enclosedVoxels(frame.heart);
  }
  t.count("slices_missing", "Slices without labels between others",
          "Of all frames: without cavity or wall between slices that have both.", missing)
      .atMost(0, Judgement::Look, "volumes and mass are too small then");
  t.count("voxels_enclosed", "Voxels without a label within the ventricle",
          "Of all frames: enclosed in their slice, as papillary muscles may be.", enclosed)
      .atMost(0, Judgement::Look, "the ring counts as open there: give them the cavity's label");
  t.count("voxels_apart", "Voxels apart from the ventricle",
          "Of all frames: pieces without cavity or without wall, which are left out.", s.islands)
      .atMost(0, Judgement::Look, "a label is wrong there");
  t.count("frame_ed", "Frame at end-diastole", "", ed.number);
  t.count("frame_es", "Frame at end-systole", "",
          beats ? std::optional<std::int64_t>(es.number) : std::nullopt);
  describeVolumes(t, ed, es, beat.ejectionFraction.value_or(kNaN), beats);
  describeThickness(t, ed, es, beats);
  t.number("axis_angle_deg", "Tilt of the heart's axis", "degrees", "",
           known(ed.axis.stackAngleDeg))
      .inHead();
  t.number("axis_spread_mm", "Spread of the slices' centres about the axis", "mm", "",
           known(ed.axis.spreadMm));
  t.number("slice_shift_rms_mm", "Shift of slices, root mean square", "mm",
           "By which slices were aligned within their planes.", known(beat.alignment.rms));
  t.number("slice_shift_max_mm", "Shift of slices, largest", "mm", "",
           known(beat.alignment.largest));
  t.number("slope_error_deg", "Uncertainty of the wall's slope", "degrees",
           "From what the alignment leaves.", known(beat.alignment.slopeErrorDeg));
  t.text("orientation", "Orientation of the segments", "What it is known by.",
         beat.orientation.source);
  t.number("septum_deg", "Direction of the septum", "degrees", "",
           known(beat.orientation.septumDeg));
  t.text("measured", "Thickness measured", "By slice or in space.",
         std::string(ed.measures && ed.measures->bySlice ? "by slice" : "in space"));
  t.text("papillary_muscles", "Papillary muscles", "",
         std::string("belong to whatever label they have"));
}

}  // namespace explica::ventricle
