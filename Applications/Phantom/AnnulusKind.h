// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Command.h"
#include "Explica/Harmonic/Phantoms.h"
#include "Explica/IO/VolumeFile.h"

#include <nlohmann/json.hpp>

namespace explica::app {

struct AnnulusKindSettings {
  harmonic::PhantomOptions phantom;
};

/// What is known of every annular tissue.
inline void declareAnswers(Declaration& d) {
  d.output("harmonic.nii.gz", FileKind::Volume, "exact harmonic function")
      .output("thickness.nii.gz", FileKind::Volume, "exact thickness, mm")
      .output("inner_distance.nii.gz", FileKind::Volume, "exact L0, mm")
      .output("outer_distance.nii.gz", FileKind::Volume, "exact L1, mm")
      .output("inner_point.nii.gz", FileKind::PointVolume, "exact phi0, RAS mm")
      .output("outer_point.nii.gz", FileKind::PointVolume, "exact phi1, RAS mm");
}

inline void writeAnswers(Context& context, const harmonic::PhantomAnswers& answers) {
  io::writeVolume(context.output("harmonic.nii.gz"), answers.u);
  io::writeVolume(context.output("thickness.nii.gz"), answers.thickness);
  io::writeVolume(context.output("inner_distance.nii.gz"), answers.innerDistance);
  io::writeVolume(context.output("outer_distance.nii.gz"), answers.outerDistance);
  io::writeVolume(context.output("inner_point.nii.gz"), answers.innerPoint);
  io::writeVolume(context.output("outer_point.nii.gz"), answers.outerPoint);
}

/// Names of labels, and the files of the answers.
inline void tellAnswers(Context& context, const harmonic::Phantom& phantom,
                        nlohmann::ordered_json answers = nlohmann::ordered_json::object()) {
  nlohmann::ordered_json labels;
  for (const auto& [name, value] : phantom.labelNames) labels[name] = value;
  context.result("labels", labels);
  for (const char* name : {"harmonic", "thickness", "inner_distance", "outer_distance",
                           "inner_point", "outer_point"}) {
    answers[name] = name + std::string(".nii.gz");
  }
  context.result("answers", answers);
}

/// What the kinds of fixed size have in common.
inline void declareAnnulusKind(Declaration& d, AnnulusKindSettings& s) {
  d.options("Phantom", s.phantom)
      .output("labels.nii.gz", FileKind::LabelVolume, "1 inner, 2 tissue, 0 outer")
      .output("inner_level.nii.gz", FileKind::Volume, "inner boundary at 0, mm, negative inside")
      .output("outer_level.nii.gz", FileKind::Volume, "outer boundary at 0, mm, negative inside");
  declareAnswers(d);
}

template <harmonic::PhantomKind Kind>
Termination runAnnulusKind(Context& context, const AnnulusKindSettings& s) {
  harmonic::Phantom phantom;
  harmonic::PhantomAnswers answers;
  {
    auto step = context.step("generate");
    phantom = harmonic::makePhantom(Kind, s.phantom);
    answers = harmonic::answersOf(phantom);
  }
  auto step = context.step("write");
  io::writeVolume(context.output("labels.nii.gz"), phantom.labels);
  io::writeVolume(context.output("inner_level.nii.gz"), phantom.innerLevel);
  io::writeVolume(context.output("outer_level.nii.gz"), phantom.outerLevel);
  writeAnswers(context, answers);
  tellAnswers(context, phantom);
  return Termination::NotRun;
}

}  // namespace explica::app
