// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Options.h"
#include "Watch.h"

#include "Explica/Ventricle/Pictures.h"

#include <pybind11/stl.h>

namespace explica::python {
namespace {

using namespace py::literals;

/// Every option of `explica heart` that is neither a file nor a choice of frames.
struct HeartSettings {
  ventricle::HeartLabelOptions labels;
  ventricle::HeartOptions heart;
};

template <class Visitor>
void describe(HeartSettings& s, Visitor&& visit) {
  describe(s.labels, visit);
  describe(s.heart.orientation, visit);
  describe(s.heart.wall, visit);
}

py::list rowsOf(const ventricle::Beat& beat) {
  py::list rows;
  for (const ventricle::Frame& frame : beat.frames) {
    if (!frame.segments) continue;
    for (const ventricle::Segment& r : frame.segments->rows) {
      rows.append(py::dict(
          "segment"_a = r.number, "name"_a = ventricle::segmentName(r.number, beat.oriented()),
          "frame"_a = frame.number, "thickness"_a = r.thickness, "sd"_a = r.deviation,
          "thickening"_a = r.thickening, "thickness_plain"_a = r.plain, "voxels"_a = r.voxels,
          "left_out"_a = r.leftOut));
    }
  }
  return rows;
}

py::list framesOf(const ventricle::Beat& beat) {
  py::list rows;
  for (const ventricle::Frame& f : beat.frames) {
    rows.append(py::dict("frame"_a = f.number, "cavity_volume_ml"_a = f.cavity,
                         "wall_volume_ml"_a = f.wall, "mass_g"_a = f.mass,
                         "thickness_mean"_a = f.thickness, "thickness_plain"_a = f.plain,
                         "thickening"_a = f.thickening));
  }
  return rows;
}

/// Thickness of each frame, 0 where it does not count; None where a frame has no wall.
py::list thicknessOf(const ventricle::Beat& beat) {
  py::list volumes;
  for (const ventricle::Frame& frame : beat.frames) {
    if (!frame.measures) {
      volumes.append(py::none());
      continue;
    }
    std::vector<double> shown = frame.measures->thickness;
    for (std::size_t n = 0; n < shown.size(); ++n) {
      if (!frame.measures->counts(n)) shown[n] = 0;
    }
    volumes.append(arrayOf(volumeOf(harmonic::spread(frame.measures->annulus, shown))));
  }
  return volumes;
}

Volume<Label> widened(const Volume<std::uint8_t>& values) {
  Volume<Label> labels(values.grid);
  labels.data.assign(values.data.begin(), values.data.end());
  return labels;
}

py::dict dictOf(const ventricle::Beat& beat) {
  py::object ejection = py::none();
  if (beat.ejectionFraction) ejection = py::float_(*beat.ejectionFraction);
  return py::dict(
      "segments"_a = rowsOf(beat), "frames"_a = framesOf(beat),
      "frame_ed"_a = beat.atDiastole().number, "frame_es"_a = beat.atSystole().number,
      "ejection_fraction_percent"_a = ejection, "axis"_a = beat.atDiastole().axis.direction,
      "axis_angle_deg"_a = beat.atDiastole().axis.stackAngleDeg, "oriented"_a = beat.oriented(),
      "segment_of"_a = arrayOf(widened(beat.atDiastole().segments->segmentOf)),
      "thickness"_a = thicknessOf(beat), "table"_a = ventricle::segmentTable(beat),
      "bullseye"_a = ventricle::bullseye(beat).svg);
}

}  // namespace

void bindHeart(py::module_& m) {
  defWithOptions<HeartSettings>(
      m, "heart",
      [](const std::vector<py::array>& frames, const Eigen::Matrix4d& affine,
         const py::object& progress, const py::kwargs& keywords) {
        const auto settings = optionsOf<HeartSettings>(keywords);
        std::vector<Volume<Label>> hearts;
        for (const py::array& frame : frames) hearts.push_back(labelVolume(frame, affine));
        return dictOf(Watch(progress).run([&](const Monitor& monitor) {
          const ventricle::HeartRoles roles = ventricle::findRoles(hearts, settings.labels);
          std::vector<int> numbers;
          for (Volume<Label>& heart : hearts) {
            heart = ventricle::relabelled(heart, roles);
            numbers.push_back(static_cast<int>(numbers.size()));
          }
          return ventricle::measureBeat(std::move(hearts), numbers, settings.heart, {}, monitor);
        }));
      },
      "The left ventricle's wall over time, as `explica heart` measures it: frames, a list of\n"
      "label volumes (I, J, K) of one grid, with short-axis slices along the third axis.\n\n"
      "Returns segments and frames, lists of dicts as the rows of segments.tsv and frames.tsv;\n"
      "frame_ed, frame_es; ejection_fraction_percent; axis (3,), RAS, towards the apex, and\n"
      "axis_angle_deg from the slices' normal; oriented; segment_of (I, J, K), 1 to 17, at\n"
      "end-diastole; thickness, an array a frame, mm; table and bullseye, as TSV and SVG.",
      "frames"_a, "affine"_a, "progress"_a = py::none());
}

}  // namespace explica::python
