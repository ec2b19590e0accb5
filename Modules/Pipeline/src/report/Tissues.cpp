// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/IO/VolumeFile.h"
#include "ReportParts.h"

namespace explica::pipeline {

void showTissues(ResultFolder& results, const FolderReportOptions& options) {
  report::MosaicOptions mosaic;
  mosaic.perRow = options.slices;
  mosaic.convention = options.convention;
  for (const StepFolder* step : results.stepsOf("segment")) {
    const bool half = step->has("hemisphere.nii.gz") && !step->has("left");
    const auto labels =
        io::readLabels(step->folder / (half ? "hemisphere.nii.gz" : "seg.nii.gz")).volume;
    results.content().mosaics.push_back(
        {kTissuePlace, "Tissues" + (step->side().empty() ? "" : ", " + step->side()),
         half ? "Green: white matter, filled. Blue: grey ribbon. Orange: fluid. Yellow: tissue cut "
                "off at the midline and stem."
              : "Orange: fluid. Blue: grey matter. Green: white matter.",
         report::makeMosaic(labels, mosaic)});
  }
}

}  // namespace explica::pipeline
