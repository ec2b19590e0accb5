// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Frames.h"

#include "Explica/Application/Command.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Ventricle/Pictures.h"
#include "Explica/Ventricle/Reference.h"
#include "Explica/Ventricle/Slices.h"
#include "Explica/Ventricle/Stack.h"
#include "Explica/Ventricle/Summary.h"

#include <nlohmann/json.hpp>

namespace explica::app {
namespace {

constexpr double kLowSeptum = 60, kHighSeptum = 200;  // degrees

struct HeartSettings {
  std::vector<std::string> segmentations, images;
  io::VolumeReadOptions reading;
  ventricle::HeartLabelOptions labels;
  ventricle::HeartOptions heart;
  std::string frames = "all";
};

void declare(Declaration& d, HeartSettings& s) {
  d.synopsis("the left ventricle's wall over time: thickness, 17 segments, volumes, pictures")
      .description(
          R"(Reads short-axis label volumes, one file with all frames or a file a frame, and measures the wall of each. Slices may be stacked along any axis of the file. Where they are much thicker than pixels, thickness is measured slice by slice and corrected for how obliquely each slice cuts the wall, by the neighbouring slices; in isotropic volumes, in space. Places where the ring is open (outflow tract), slices that the valve plane cuts and the apical cap are found, drawn and left out of the means, with a count. The right ventricle's label tells where the 17 segments begin. Papillary muscles belong to whatever label they have.)")
      .reference("Cerqueira et al. 2002, Circulation 105(4):539-542 (17 segments)")
      .reference("Kawel et al. 2012, Circ Cardiovasc Imaging 5(4):500-508 (normal thickness)")
      .reference(
          "Hudsmith et al. 2005, Petersen et al. 2017, Ubachs et al. 2009, Kawel-Boehm et al. "
          "2015, J Cardiovasc Magn Reson 7:775, 19:18, 11(Suppl 1):P61, 17:29 (other ranges)")
      .reference("Jones, Buchbinder, Aharon 2000, Human Brain Mapping 11:12-32")
      .example("explica heart patient001_4d_gt.nii.gz --out heart",
               "All frames of a file; which label is what is found from their values and places")
      .example(
          "explica heart ED_label.nii.gz ES_label.nii.gz --cavity 1 --wall 2 "
          "--rv-insertion-image-axis i- --out heart",
          "Two frames without a label of the right ventricle")
      .input("SEG", FileKind::LabelVolume, "label volume, 3-D or 4-D; several are frames in order",
             s.segmentations)
      .inputOption("image", FileKind::Volume,
                   "images of the same frames, 3-D or 4-D: the pictures of slices show both "
                   "boundaries on them, and slices.gif the heart's beat",
                   s.images)
      .severalWords("image")
      .options("Labels", s.labels)
      .category("Frames")
      .option("phases",
              "all; ED,ES: only these two, found as greatest and smallest cavity; or two "
              "numbers counted from 0, as 0,9, which are taken for ED and ES",
              s.frames)
      .options("Orientation", s.heart.orientation)
      .options("Thickness", s.heart.wall)
      .options("Reading", s.reading)
      .without("frame")
      .output("frames.tsv", FileKind::Table,
              "per frame: volumes (ml), mass (g, 1.05 g/ml), mean thickness (mm), thickening (%)")
      .output("segments.tsv", FileKind::Table,
              "per segment and frame: thickness (mm), its spread, thickening (%, mm)")
      .output("slices.tsv", FileKind::Table,
              "per slice and frame: areas, wall of circles of equal areas, thickness plain and "
              "corrected")
      .output("reference.tsv", FileKind::Table,
              "numbers of this heart beside those of healthy adults, with sources")
      .output("bullseye.svg", FileKind::Picture, "thickness at ED and ES, thickening")
      .output("bullseye.png", FileKind::Picture, "the same in pixels")
      .output("slices_ed.svg", FileKind::Picture, "slices with boundaries and trajectories")
      .output("slices_ed.png", FileKind::Picture, "the same in pixels")
      .output("slices_es.svg", FileKind::Picture, "slices at end-systole")
      .output("slices_es.png", FileKind::Picture, "the same in pixels")
      .output("slices.gif", FileKind::Picture, "with --image: slices over time")
      .output("segments.nii.gz", FileKind::LabelVolume, "segment of each wall voxel at ED")
      .output("left_out.nii.gz", FileKind::LabelVolume,
              "wall voxels at ED that do not count: 1 opening, 2 valve plane, 3 apical cap, 4 "
              "trajectory does not arrive")
      .output("thickness_frame-*.nii.gz", FileKind::Volume,
              "thickness per voxel and frame, mm; 0 off the wall and where it does not count")
      .results<ventricle::HeartSummary>();
}

std::string degrees(double value) {
  return printed("%.0f degrees", value);
}

/// A wall without an opening encloses no ventricle: a flag.
/// @return the share of the cavity's surface that is open
double judgeOpening(Context& context, const ventricle::Beat& beat) {
  constexpr double kLeastOpening = 0.01;  // of the cavity's area; a base alone takes a tenth
  const double open = ventricle::openShareOf(beat.atDiastole().heart);
  context.judged();
  if (!(open < kLeastOpening)) return open;
  context.flag({{"name", "closed-wall"},
                {"value", open},
                {"low", kLeastOpening},
                {"high", nullptr},
                {"accepted", false},
                {"message",
                 printed("the wall encloses the cavity on all sides (%.1f %% of its area is open; "
                         "a ventricle is open at its base): this is no ventricle, or labels are "
                         "wrong",
                         100 * open)}});
  return open;
}

/// What a reader must know before trusting the numbers.
void sayWhatIsOdd(Context& context, const ventricle::Beat& beat) {
  for (const ventricle::Frame& frame : beat.frames) {
    if (frame.segments) continue;
    context.warn("frame " + std::to_string(frame.number) +
                 " is left out of thickness and mass: " + frame.why);
  }
  const ventricle::LongAxis& axis = beat.atDiastole().axis;
  if (axis.stackAngleDeg > 30 && ventricle::hasThickSlices(beat.atDiastole().heart.grid)) {
    context.warn("the long axis is tilted by " + degrees(axis.stackAngleDeg) +
                 " from the normal of the slices: these are no short-axis slices, or a label is "
                 "wrong");
  }
  if (!beat.oriented()) {
    context.warn(
        "no label of the right ventricle, no --rv-insertion and no "
        "--rv-insertion-image-axis: segments are counted from the front of the image and "
        "have no anatomical names");
  }
  const double septum = beat.orientation.septumDeg;
  if (septum < kLowSeptum || septum > kHighSeptum) {
    context.warn("the right ventricle touches the wall over " + degrees(septum) +
                 " around the axis; 90 to 150 are usual: check segments.nii.gz");
  }
}

/// Both forms of a picture.
void writePicture(Context& context, const std::string& name, const ventricle::Drawn& drawn) {
  writeTextFile(context.output(name + ".svg"), drawn.svg);
  report::writePng(context.output(name + ".png"), drawn.pixels);
}

std::string thicknessFile(int number) {
  return printed("thickness_frame-%04d.nii.gz", number);
}

/// @param stack  the axis along which the input's slices are stacked
void writeVolumes(Context& context, const ventricle::Beat& beat, int stack) {
  const auto write = [&](const std::string& name, auto volume) {
    io::writeVolume(context.output(name), ventricle::withAxesBack(std::move(volume), stack));
  };
  for (const ventricle::Frame& frame : beat.frames) {
    if (!frame.measures) continue;
    const ventricle::WallThickness& wall = *frame.measures;
    std::vector<double> shown = wall.thickness;
    for (std::size_t n = 0; n < shown.size(); ++n) {
      if (!wall.counts(n)) shown[n] = 0;
    }
    write(thicknessFile(frame.number), volumeOf(harmonic::spread(wall.annulus, shown)));
  }
  write("segments.nii.gz", beat.atDiastole().segments->segmentOf);
  Volume<std::uint8_t> leftOut = beat.atDiastole().measures->reasons;
  for (std::uint8_t& why : leftOut.data) why = why == 255 ? 0 : why;
  write("left_out.nii.gz", std::move(leftOut));
}

/// @param images  one a frame of the beat, or none
void writeSlices(Context& context, const ventricle::Beat& beat,
                 const std::vector<Volume<float>>& images) {
  const auto write = [&](const std::string& name, std::size_t f) {
    writePicture(context, name,
                 ventricle::slicePicture(beat, f, images.empty() ? nullptr : &images[f]));
  };
  write("slices_ed", beat.diastole);
  if (beat.systole != beat.diastole && beat.atSystole().measures) write("slices_es", beat.systole);
  if (images.size() > 1) {
    writeTextFile(context.output("slices.gif"), ventricle::slicesOverTime(beat, images));
  }
}

void writeOutputs(Context& context, const ventricle::Beat& beat,
                  const std::vector<Volume<float>>& images, int stack) {
  writeTextFile(context.output("frames.tsv"), ventricle::frameTable(beat));
  writeTextFile(context.output("segments.tsv"), ventricle::segmentTable(beat));
  writeTextFile(context.output("slices.tsv"), ventricle::sliceTable(beat));
  writeTextFile(context.output("reference.tsv"), ventricle::referenceTable(beat));
  writePicture(context, "bullseye", ventricle::bullseye(beat));
  writeSlices(context, beat, images);
  writeVolumes(context, beat, stack);
}

/// What follows takes slices to lie along the last axis.
/// @return the axis along which they are stacked in the files
int stackSlicesLast(const HeartSettings& s, std::vector<Volume<Label>>& frames,
                    std::vector<Volume<float>>& images) {
  const int stack = ventricle::sliceAxis(frames.front().grid);
  if (stack != 2 && s.heart.orientation.imageAxis) {
    throw InvalidInput(
        "--rv-insertion-image-axis is for slices stacked along the last axis, and these are along "
        "another; give --rv-insertion");
  }
  for (auto& frame : frames) frame = ventricle::withLastAxis(std::move(frame), stack);
  for (auto& image : images) image = ventricle::withLastAxis(std::move(image), stack);
  return stack;
}

Termination run(Context& context, const HeartSettings& s) {
  std::vector<Volume<Label>> frames = readFrames(context, s.segmentations, s.reading);
  std::vector<Volume<float>> images =
      readImages(s.images, s.reading, frames.front().grid, frames.size());
  const int stack = stackSlicesLast(s, frames, images);
  const ventricle::HeartRoles roles = ventricle::findRoles(frames, s.labels);
  std::int64_t islands = 0;
  for (Volume<Label>& frame : frames) {
    frame = ventricle::relabelled(frame, roles);
    islands += ventricle::takeOutIslands(frame);
  }
  const Chosen chosen = chooseFrames(s.frames, frames);
  std::vector<Volume<Label>> hearts;
  std::vector<Volume<float>> shown;
  for (const int n : chosen.numbers) {
    hearts.push_back(std::move(frames[static_cast<std::size_t>(n)]));
    if (!images.empty()) shown.push_back(std::move(images[static_cast<std::size_t>(n)]));
  }
  ventricle::Beat beat;
  {
    auto step = context.step("measure");
    beat = ventricle::measureBeat(std::move(hearts), chosen.numbers, s.heart, chosen.phases,
                                  context.monitor());
  }
  sayWhatIsOdd(context, beat);
  context.results(ventricle::HeartSummary{roles.how, &beat, judgeOpening(context, beat), islands});
  auto step = context.step("write");
  writeOutputs(context, beat, shown, stack);
  return Termination::Finished;
}

}  // namespace

Command heartCommand() {
  return makeCommand<HeartSettings>("heart", declare, run);
}

}  // namespace explica::app
