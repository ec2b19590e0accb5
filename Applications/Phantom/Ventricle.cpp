// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "AnnulusKind.h"

#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Phantom/BeatingVentricle.h"

namespace explica::app {
namespace {

struct PhantomVentricleSettings : AnnulusKindSettings {
  phantom::BeatOptions beat;
};

void declare(Declaration& d, PhantomVentricleSettings& s) {
  d.synopsis("a left ventricle between confocal spheroids, cut at its base, with exact answers")
      .description(
          R"(Focal distance 40 mm, sinh mu 0.6 and 0.9, the base 15 mm above the centre. Label 3 is a right ventricle, 4 what lies beyond the base: give it to --insulated. Near the base, which trajectories cross obliquely, the answers are not exact. With --frames the ventricle beats: its wall keeps its volume, its cavity ejects the share --ejection, slices may be thick and tilted as in cine MRI, labels are 1 cavity, 2 wall, 3 right ventricle, and the other outputs are tables.)")
      .example("explica phantom ventricle --size 120 --out ventricle", "120 voxels a side")
      .example(
          "explica phantom ventricle --size 90 --spacing 1.4 --slice 8 --frames 6 --tilt 10 --out "
          "beat",
          "Six frames of thick, tilted slices for 'explica heart beat/frame-*.nii.gz'")
      .options("Beat", s.beat)
      .output("frame-*.nii.gz", FileKind::LabelVolume, "with --frames: labels of each frame")
      .output("frames_exact.tsv", FileKind::Table, "with --frames: exact volumes (ml) and mass (g)")
      .output("segments_exact.tsv", FileKind::Table,
              "with --frames: exact mean thickness (mm) and thickening (%) of each segment");
  declareAnnulusKind(d, s);
}

std::string frameTable(const phantom::BeatingVentricle& beat) {
  std::string text = "frame\tcavity_volume_ml\twall_volume_ml\tmass_g\n";
  for (std::size_t f = 0; f < beat.frames.size(); ++f) {
    const auto& frame = beat.frames[f];
    text += printed("%zu\t%.4f\t%.4f\t%.4f\n", f, 1e-3 * frame.cavity, 1e-3 * frame.wall,
                    1.05e-3 * frame.wall);
  }
  return text;
}

std::string segmentTable(const phantom::BeatingVentricle& beat) {
  std::string text = "segment\tframe\tthickness\tthickening\n";
  const auto& first = beat.frames.front().thickness;
  for (std::size_t f = 0; f < beat.frames.size(); ++f) {
    for (int segment = 1; segment <= 16; ++segment) {
      const auto third = static_cast<std::size_t>((segment - 1) / 6);
      const double t = beat.frames[f].thickness[third];
      text += printed("%d\t%zu\t%.4f\t%.2f\n", segment, f, t, 100 * (t / first[third] - 1));
    }
  }
  return text;
}

Termination runBeat(Context& context, const PhantomVentricleSettings& s) {
  phantom::BeatingVentricle beat;
  {
    auto step = context.step("generate");
    beat = phantom::beatingVentricle(s.phantom, s.beat);
  }
  auto step = context.step("write");
  for (std::size_t f = 0; f < beat.frames.size(); ++f) {
    io::writeVolume(context.output(printed("frame-%04zu.nii.gz", f)), beat.frames[f].labels);
  }
  writeTextFile(context.output("frames_exact.tsv"), frameTable(beat));
  writeTextFile(context.output("segments_exact.tsv"), segmentTable(beat));
  context.result("labels", nlohmann::ordered_json{
                               {"outside", 0}, {"cavity", 1}, {"wall", 2}, {"right-ventricle", 3}});
  context.result("answers", nlohmann::ordered_json{{"frames", "frames_exact.tsv"},
                                                   {"segments", "segments_exact.tsv"}});
  const Point& p = beat.anteriorInsertion;
  context.result("rv_insertion", std::vector<double>{p[0], p[1], p[2]});
  context.result("tilt_deg", s.beat.tiltDeg);
  return Termination::Finished;
}

Termination run(Context& context, const PhantomVentricleSettings& s) {
  if (s.beat.frames) return runBeat(context, s);
  // A record that is replayed gives every option, at its default too.
  const phantom::BeatOptions none;
  const bool beats = s.beat.slice != none.slice || s.beat.tiltDeg != none.tiltDeg ||
                     s.beat.ejectionFraction != none.ejectionFraction;
  if (beats) {
    throw UsageError("--slice, --tilt and --ejection are for a beating ventricle: give --frames N");
  }
  return runAnnulusKind<harmonic::PhantomKind::Ventricle>(context, s);
}

}  // namespace

Command phantomVentricleCommand() {
  return makeCommand<PhantomVentricleSettings>("phantom ventricle", declare, run);
}

}  // namespace explica::app
