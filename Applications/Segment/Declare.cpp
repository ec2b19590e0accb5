// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Plausible.h"
#include "Explica/Registration/Summary.h"
#include "Explica/Segmentation/Summary.h"
#include "Settings.h"

namespace explica::app {
namespace {

constexpr const char* kDescription =
    "Brings a template (Colin27) into the image's space: an affine map by mutual information, then "
    "a deformation. From its brain mask the border of the brain is sought in the image, up to the "
    "skull; its atlas says which voxels make a hemisphere. Three tissues are found by "
    "expectation-maximisation of a mixture of pure and mixed voxels with a Markov prior, while a "
    "smooth bias field is estimated and divided out. Each hemisphere's white matter is filled with "
    "deep structures and ventricles, without cerebellum and brain stem; label 4 marks tissue cut "
    "off at the midline and the stem. No template is needed for a skull-stripped image with an "
    "atlas in its space. What cannot be a T1 is refused; numbers beyond what heads have are "
    "flagged, exit code 3.";

void declareTissueOutputs(Declaration& d) {
  d.output("seg.nii.gz", FileKind::LabelVolume, "1 fluid, 2 grey, 3 white, 0 outside")
      .output("csf.nii.gz", FileKind::Volume, "probability of fluid in each voxel")
      .output("gm.nii.gz", FileKind::Volume, "probability of grey matter in each voxel")
      .output("wm.nii.gz", FileKind::Volume, "probability of white matter in each voxel")
      .output("bias.nii.gz", FileKind::Volume, "multiplicative bias field")
      .output("brain_mask.nii.gz", FileKind::LabelVolume, "1 in the brain")
      .output("brain_doubt.nii.gz", FileKind::Volume,
              "of an image with skull: standard deviation of the border of the brain, mm, near it")
      .output("atlas.nii.gz", FileKind::LabelVolume,
              "with a template: its labels in the image's space")
      .output("atlas.tsv", FileKind::Table, "with a template: what they are called")
      .varyingOutput("to_template.h5", FileKind::Any,
                     "with a template: ITK transform from the image's points to the template's")
      .output("hemisphere.nii.gz", FileKind::LabelVolume,
              "3 white matter, filled; 2 grey ribbon; 1 fluid; 4 cut tissue; 0 outside; of both "
              "sides: 2, 3 left white and grey, 41, 42 right, as FreeSurfer's ribbon")
      .output("white_share.nii.gz", FileKind::Volume, "0.5 is the white surface")
      .output("tissue_share.nii.gz", FileKind::Volume, "0.5 is the pial surface")
      .output("cut.nii.gz", FileKind::LabelVolume, "1 in cut tissue")
      .output("left/*.nii.gz", FileKind::Volume, "the same four of the left side, if of both")
      .output("right/*.nii.gz", FileKind::Volume, "and of the right side");
}

}  // namespace

void declareSegment(Declaration& d, SegmentSettings& s) {
  d.synopsis("fluid, grey and white matter of a T1, with or without skull, and its hemispheres")
      .description(kDescription)
      .reference(
          "Van Leemput, Maes, Vandermeulen, Suetens 1999, IEEE Trans. Med. Imaging 18(10):897-908")
      .reference("Santago, Gage 1993, IEEE Trans. Med. Imaging 12(3):566-574")
      .reference("Studholme, Hill, Hawkes 1999, Pattern Recognition 32(1):71-86")
      .reference("Avants, Epstein, Grossman, Gee 2008, Med. Image Anal. 12(1):26-41")
      .example("explica segment T1.nii.gz --out tissue", "A head as it comes from the scanner")
      .example("explica segment ch2bet.nii.gz --atlas aal.nii.gz --hemisphere L --out tissue",
               "Left hemisphere of a skull-stripped image, by an atlas in its space")
      .input("T1", FileKind::Volume, "T1-weighted image of a head", s.image)
      .inputOption("mask", FileKind::LabelVolume, "the brain is where this is not 0", s.mask)
      .inputOption("atlas", FileKind::LabelVolume, "labels in the space of the T1, as AAL's",
                   s.atlas)
      .inputOption(
          "atlas-legend", FileKind::Any,
          "what the atlas's labels mean, one 'value name' a line (default: the .tsv or .nii.txt "
          "beside it; FreeSurfer's are known)",
          s.legend)
      .inputOption("template-transform", FileKind::Any,
                   "to_template.h5 of an earlier run on this T1 with the same template, taken "
                   "instead of registering again; how it fits is checked as ever",
                   s.templateTransform, "Head")
      .category("Head")
      .option("template",
              "colin27 (default) or inia19 (a macaque without skull), both of the package "
              "mricron-data, a folder with T1.nii.gz, brain.nii.gz and atlas.nii.gz, or "
              "none",
              s.headTemplate)
      .option("stripped", "whether the skull is off already", s.stripped)
      .options("Reading", s.reading)
      .options("Tissues", s.tissue)
      .options("Hemisphere", s.hemisphere);
  declareAccept(d, s.accept);
  declareTissueOutputs(d);
  d.results<registration::HeadSummary>().results<segmentation::TissueSummary>();
}

}  // namespace explica::app
