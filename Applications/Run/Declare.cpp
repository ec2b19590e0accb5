// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Settings.h"

#include "Explica/Pipeline/RunState.h"
#include "Explica/Study/Derivatives.h"

namespace explica::app {

void declareRun(Declaration& d, RunSettings& s) {
  d.synopsis(
       "from a T1, label volume or FreeSurfer subject to an unfolded patch of cortex and a report")
      .description(
          R"(Both hemispheres, where the input tells them apart. Finds what there is to start from and says so: a FreeSurfer subject's ribbon or aseg, its white and pial surfaces and its regions; the same of fMRIPrep's and sMRIPrep's anat folders; a T1, with or without skull, or a label volume. Surfaces that are there are taken over (unless --given-surfaces remake), others are made, from a FreeSurfer subject's labels with its brain.mgz to place their borders. Runs segment, thickness, surface, sphere, register (with resample, to the template's 10,242 vertices; --resample.to fsaverage6 for more), parcellate (with regions, their table) and unfold in order, each into its own folder with its own summary and record, and writes a report on all of them. Both hemispheres are done side by side (one after the other with --max-memory, for they take more memory together). A run that fails leaves nothing; with --resume the steps that were done stay, and so does the account of the failure. Every option of a step can be given with the step's name before it: --unfold.radius 30. With --resume, steps whose inputs, options and outputs are what their records say are not done again.)")
      .example("explica run T1.nii.gz --out subject",
               "Both hemispheres of a head as it comes from the scanner, all the way")
      .example("explica run ch2bet.nii.gz --atlas aal.nii.gz --hemisphere L --out colin",
               "Left hemisphere of a skull-stripped T1 with an atlas in its space")
      .example("explica run derivatives/sub-01/anat --hemisphere L --out sub-01-left",
               "What fMRIPrep has left of a subject")
      .example("explica run bert --hemisphere R --out bert-right",
               "A FreeSurfer subject's right hemisphere")
      .input("INPUT", FileKind::Any,
             "T1, label volume, FreeSurfer subject directory, or BIDS anat folder", s.input)
      .inputOption(
          "atlas", FileKind::LabelVolume,
          "labels in the input's space, as AAL's: tell a T1's hemispheres apart instead of "
          "a template's, and are the regions of regions.tsv",
          s.atlas)
      .inputOption("t2", FileKind::Volume,
                   "T2 or FLAIR of the same head: the outer border of cortex is placed by both",
                   s.t2)
      .options("Run", s.plan)
      .category("Run")
      .option("resume", "keep steps of an earlier run into --out that are still true", s.resume)
      .option("accept", "go on although this number is implausible, in whichever step; see segment",
              s.accept)
      .reuseOutputIf(s.resume)
      .inPlace()
      .varyingOutput("report.html", FileKind::Report, "everything to look at")
      .output("thumbnail.png", FileKind::Picture, "a small picture, for tables of many runs")
      .varyingOutput(pipeline::kRunStateName, FileKind::Any, "how each step went")
      .output("segment", FileKind::Folder, "tissues and hemisphere")
      .output("thickness*", FileKind::Folder,
              "harmonic interpolant, correspondences, thickness; -L and -R where both hemispheres "
              "are done, as in the next two")
      .output("surface*", FileKind::Folder, "white, middle and pial surface")
      .output("sphere*", FileKind::Folder, "the white surface on a sphere")
      .output("register*", FileKind::Folder, "that sphere in the template's frame")
      .output("resample*", FileKind::Folder, "thickness, sulcal depth and areas on the template")
      .output("parcellate*", FileKind::Folder, "the template's regions on the surface")
      .output("regions*", FileKind::Folder, "area, volume, thickness and curvature by region")
      .output("unfold*", FileKind::Folder, "the unfolded patch and its evolution")
      .output("asymmetry.tsv", FileKind::Table,
              "of both hemispheres: thickness and area of each region, left and right");
  for (const char* name : study::kRunSteps) {
    const Command* command = findCommand(name);
    if (command == nullptr) continue;
    s.steps.push_back(command->begin());
    d.include(s.steps.back().declaration, std::string(name) + ".");
  }
}

}  // namespace explica::app
