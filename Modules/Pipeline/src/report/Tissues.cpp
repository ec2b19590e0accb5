// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Folders.h"
#include "Explica/IO/VolumeFile.h"
#include "MaskBorder.h"
#include "ReportParts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

namespace explica::pipeline {
namespace {

/// The template's structures on the T1, where one was brought there.
void showTemplate(ResultFolder& results, const StepFolder& step,
                  const report::MosaicOptions& options) {
  const auto image = inputOf(step, "T1");
  if (!step.has("atlas.nii.gz") || !image || !isThere(*image)) return;
  const Volume<float> head = io::readScalars(*image, {.dimension = 3}).volume;
  const auto found = brainOf(step, head.grid);
  report::MosaicOptions drawing = options;
  drawing.subject = found ? &*found : nullptr;
  const TriangleMesh atlas = borderOf(step.folder / "atlas.nii.gz");
  const TriangleMesh brain = borderOf(step.folder / "brain_mask.nii.gz");
  results.content().mosaics.push_back(
      {kTissuePlace, "Template on " + image->filename().string(),
       "Structures of the template's atlas and the brain as it was found, in steps of 2 mm. Cortex "
       "and deep structures must lie where the image has them.",
       report::makeMosaic(head, {{&brain, "brain", "#ff9f0a"}, {&atlas, "template", "#32d7ff"}},
                          drawing)});
}

/// The image before and after each thing that was done to it, to change to and fro between them:
/// the bias field divided out, all but the brain taken away.
void showPreparation(ResultFolder& results, const StepFolder& step,
                     const report::MosaicOptions& options) {
  const auto file = inputOf(step, "T1");
  if (!file || !isThere(*file)) return;
  io::VolumeReadOptions reading{.dimension = 3};
  const Volume<float> image = io::readScalars(*file, reading).volume;
  report::MosaicOptions small = options;
  small.tileHeight = 150;
  const auto brain = brainOf(step, image.grid);
  small.subject = brain ? &*brain : nullptr;
  const auto compare = [&](const char* with, const std::string& title, const std::string& caption,
                           const std::array<std::string, 2>& states, const auto& changed) {
    if (!step.has(with)) return;
    const Volume<float> by = io::readScalars(step.folder / with, reading).volume;
    if (by.size() != image.size()) return;
    Volume<float> after = image;
    double most = 0;
    for (std::size_t v = 0; v < after.size(); ++v) {
      after[v] = changed(image[v], by[v]);
      most = std::max(most, static_cast<double>(std::abs(after[v] - image[v])));
    }
    if (most == 0) return;
    auto slices = report::makeMosaics(image, after, small);
    results.content().mosaics.push_back(
        {"", title, caption, std::move(slices[0]), std::move(slices[1]), states});
  };
  compare("bias.nii.gz", "Bias field",
          "The image as it came, and with the estimated field divided out: one tissue must be "
          "equally bright everywhere.",
          {"the image as it came", "field divided out"},
          [](float value, float bias) { return bias > 0 ? value / bias : value; });
  compare(
      "brain_mask.nii.gz", "Brain mask",
      "The image as it came, and what was taken for brain: no cortex may be lost, no skull left.",
      {"the whole image", "the brain"},
      [](float value, float inside) { return inside > 0 ? value : 0.0F; });
}

}  // namespace

void showTissues(ResultFolder& results, const FolderReportOptions& options) {
  report::MosaicOptions mosaic{.perRow = options.slices, .convention = options.convention};
  for (const StepFolder* step : results.stepsOf("segment")) {
    showTemplate(results, *step, mosaic);
    results.attempt("Preparation of the image",
                    [&, step = step] { showPreparation(results, *step, mosaic); });
    const bool half = step->has("hemisphere.nii.gz") && !step->has("left");
    const auto labels =
        io::readLabels(step->folder / (half ? "hemisphere.nii.gz" : "seg.nii.gz")).volume;
    results.content().mosaics.push_back(
        {kTissuePlace, "Tissues" + step->sideWords(),
         half ? "Green: white matter, filled. Blue: grey ribbon. Orange: fluid. Yellow: tissue cut "
                "off at the midline and stem."
              : "Orange: fluid. Blue: grey matter. Green: white matter.",
         report::makeMosaic(labels, mosaic)});
  }
}

}  // namespace explica::pipeline
