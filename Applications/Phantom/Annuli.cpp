// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Harmonic/Phantoms.h"
#include "Explica/IO/VolumeFile.h"

#include <nlohmann/json.hpp>

namespace explica::app {
namespace {

using Settings = harmonic::PhantomOptions;

/// What the kinds of annular tissue have in common.
void declareTissue(Declaration& d, Settings& s) {
  d.options("Phantom", s)
      .output("labels.nii.gz", FileKind::LabelVolume, "1 inner, 2 tissue, 0 outer")
      .output("inner_level.nii.gz", FileKind::Volume, "inner boundary at 0, mm, negative inside")
      .output("outer_level.nii.gz", FileKind::Volume, "outer boundary at 0, mm, negative inside")
      .output("harmonic.nii.gz", FileKind::Volume, "exact harmonic function")
      .output("thickness.nii.gz", FileKind::Volume, "exact thickness, mm")
      .output("inner_distance.nii.gz", FileKind::Volume, "exact L0, mm")
      .output("outer_distance.nii.gz", FileKind::Volume, "exact L1, mm")
      .output("inner_point.nii.gz", FileKind::PointVolume, "exact phi0, RAS mm")
      .output("outer_point.nii.gz", FileKind::PointVolume, "exact phi1, RAS mm");
}

template <harmonic::PhantomKind Kind>
Termination run(Context& context, const Settings& s) {
  harmonic::Phantom phantom;
  harmonic::PhantomAnswers answers;
  {
    auto step = context.step("generate");
    phantom = harmonic::makePhantom(Kind, s);
    answers = harmonic::answersOf(phantom);
  }
  auto step = context.step("write");
  io::writeVolume(context.output("labels.nii.gz"), phantom.labels);
  io::writeVolume(context.output("inner_level.nii.gz"), phantom.innerLevel);
  io::writeVolume(context.output("outer_level.nii.gz"), phantom.outerLevel);
  io::writeVolume(context.output("harmonic.nii.gz"), answers.u);
  io::writeVolume(context.output("thickness.nii.gz"), answers.thickness);
  io::writeVolume(context.output("inner_distance.nii.gz"), answers.innerDistance);
  io::writeVolume(context.output("outer_distance.nii.gz"), answers.outerDistance);
  io::writeVolume(context.output("inner_point.nii.gz"), answers.innerPoint);
  io::writeVolume(context.output("outer_point.nii.gz"), answers.outerPoint);
  nlohmann::ordered_json labels;
  for (const auto& [name, value] : phantom.labelNames) labels[name] = value;
  context.result("labels", labels);
  context.result("answers", nlohmann::ordered_json{{"harmonic", "harmonic.nii.gz"},
                                                   {"thickness", "thickness.nii.gz"},
                                                   {"inner_distance", "inner_distance.nii.gz"},
                                                   {"outer_distance", "outer_distance.nii.gz"},
                                                   {"inner_point", "inner_point.nii.gz"},
                                                   {"outer_point", "outer_point.nii.gz"}});
  return Termination::NotRun;
}

}  // namespace

Command phantomEccentricCommand() {
  const auto declare = [](Declaration& d, Settings& s) {
    d.synopsis("two eccentric circles with their exact answers (bipolar coordinates)")
        .description(
            "One slice: circles of 10 and 25 mm whose centres are 5 mm apart. Trajectories "
            "are circles, so that thickness varies and boundary points are known.")
        .example("explica phantom eccentric --size 120 --out eccentric", "120 voxels a side");
    declareTissue(d, s);
  };
  return makeCommand<Settings>("phantom eccentric", declare, run<harmonic::PhantomKind::Eccentric>);
}

Command phantomSpheroidCommand() {
  const auto declare = [](Declaration& d, Settings& s) {
    d.synopsis("confocal spheroids with their exact answers")
        .description(
            "Prolate spheroids of focal distance 30 mm, sinh mu 0.5 and 1. Trajectories are "
            "hyperbolas.")
        .example("explica phantom spheroid --size 120 --out spheroid", "120 voxels a side");
    declareTissue(d, s);
  };
  return makeCommand<Settings>("phantom spheroid", declare, run<harmonic::PhantomKind::Spheroid>);
}

}  // namespace explica::app
