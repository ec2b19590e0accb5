// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/Plausible.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/IO/LabelNames.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Segmentation/Hemisphere.h"
#include "Explica/Segmentation/Plausibility.h"
#include "Explica/Segmentation/Tissue.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace explica::app {
namespace {

struct Settings {
  std::string image;
  std::optional<std::string> mask;
  std::optional<std::string> atlas;
  std::optional<std::string> legend;
  io::VolumeReadOptions reading;
  segmentation::TissueOptions tissue;
  segmentation::HemisphereOptions hemisphere;
  std::vector<std::string> accept;
};

void declare(Declaration& d, Settings& s) {
  d.synopsis("fluid, grey and white matter of a skull-stripped T1, and one hemisphere by an atlas")
      .description(
          "Finds three tissues by expectation-maximisation of a mixture of pure and mixed voxels "
          "with a "
          "Markov prior, while a smooth bias field is estimated and divided out. With an atlas in "
          "the "
          "image's space, such as AAL, one hemisphere is taken out, too: its white matter filled "
          "with deep "
          "structures and ventricles, without cerebellum and brain stem, and its grey ribbon; "
          "label 4 "
          "marks tissue cut off at the midline and the stem.")
      .reference(
          "Van Leemput, Maes, Vandermeulen, Suetens 1999, IEEE Trans. Med. Imaging 18(10):897-908")
      .reference("Santago, Gage 1993, IEEE Trans. Med. Imaging 12(3):566-574")
      .example("explica segment ch2bet.nii.gz --out tissue", "Tissues of a skull-stripped head")
      .example("explica segment ch2bet.nii.gz --atlas aal.nii.gz --hemisphere L --out tissue",
               "The same, and the left hemisphere")
      .input("T1", FileKind::Volume,
             "skull-stripped T1-weighted image: the brain is where it is above 0", s.image)
      .inputOption("mask", FileKind::LabelVolume, "the brain is where this is not 0", s.mask)
      .inputOption("atlas", FileKind::LabelVolume, "labels in the space of the T1, as AAL's",
                   s.atlas)
      .inputOption(
          "atlas-legend", FileKind::Any,
          "what the atlas's labels mean, one 'value name' a line (default: the .tsv or .nii.txt "
          "beside it; FreeSurfer's are known)",
          s.legend)
      .options("Reading", s.reading)
      .options("Tissues", s.tissue)
      .options("Hemisphere", s.hemisphere);
  declareAccept(d, s.accept);
  d.output("seg.nii.gz", FileKind::LabelVolume, "1 fluid, 2 grey, 3 white, 0 outside")
      .output("csf.nii.gz", FileKind::Volume, "share of fluid in each voxel")
      .output("gm.nii.gz", FileKind::Volume, "share of grey matter in each voxel")
      .output("wm.nii.gz", FileKind::Volume, "share of white matter in each voxel")
      .output("bias.nii.gz", FileKind::Volume, "multiplicative bias field")
      .output(
          "hemisphere.nii.gz", FileKind::LabelVolume,
          "with --atlas: 3 white matter, filled; 2 grey ribbon; 1 fluid; 4 cut tissue; 0 outside")
      .output("white_share.nii.gz", FileKind::Volume, "with --atlas: 0.5 is the white surface")
      .output("cut.nii.gz", FileKind::LabelVolume, "with --atlas: 1 in cut tissue")
      .output("tissue_share.nii.gz", FileKind::Volume, "with --atlas: 0.5 is the pial surface");
}

std::filesystem::path legendBeside(const std::filesystem::path& atlas) {
  if (const auto legend = io::findLegend(atlas)) return *legend;
  throw InvalidInput(atlas.string() +
                     ": no legend (.tsv or .nii.txt) beside it; name one with --atlas-legend");
}

segmentation::AtlasLegend readLegend(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw IOError(path.string() +
                  ": cannot be opened; name the atlas's legend with --atlas-legend");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  return segmentation::parseAtlasLegend(text, path.string());
}

struct Atlas {
  Volume<Label> labels;
  segmentation::AtlasLegend legend;
};

Atlas readAtlas(Context& context, const Settings& s, const io::VolumeReadOptions& reading,
                const Grid& grid) {
  Atlas atlas;
  atlas.labels = readLabels(context, "atlas", *s.atlas, reading);
  if (s.legend) {
    atlas.legend = readLegend(*s.legend);
  } else if (segmentation::isFreeSurferAtlas(atlas.labels)) {
    context.info("atlas: FreeSurfer's labels");
    atlas.legend = segmentation::freeSurferLegend();
    segmentation::keepNamed(atlas.labels, atlas.legend);
  } else {
    atlas.legend = readLegend(context.input(legendBeside(*s.atlas), "atlas-legend"));
  }
  if (!sameGrid(atlas.labels.grid, grid)) {
    context.info("atlas: on another grid than the T1; each voxel takes the nearest label");
    atlas.labels = segmentation::resampleLabels(atlas.labels, grid);
  }
  return atlas;
}

/// What can be no T1, before any work.
void refuseOtherImages(Judge& judge, const Volume<float>& image) {
  judge.require("hounsfield", segmentation::airInHounsfieldUnits(image));
  judge.require("labels",
                segmentation::looksLikeLabels(image) ? segmentation::equalNeighbours(image) : 0.0);
}

/// What a segmentation of a T1 cannot be.
void judgeTissue(Context& context, Judge& judge, const segmentation::TissueSegmentation& tissue) {
  const double contrast = segmentation::rimContrast(tissue.labels);
  context.result("rim_contrast", contrast);
  judge.require("contrast", contrast);
  const double volume =
      static_cast<double>(tissue.brainVoxels) * tissue.labels.grid.voxelVolume() / 1000;
  context.result("brain_volume_ml", volume);
  judge.flag("brain-volume", volume);
  judge.flag("grey-share", tissue.classes[1].share);
  judge.flag("white-share", tissue.classes[2].share);
}

Termination run(Context& context, const Settings& s) {
  Judge judge(context, s.accept);
  io::VolumeReadOptions reading = s.reading;
  reading.dimension = 3;
  const Volume<float> image = readScalars(context, "T1", s.image, reading);
  refuseOtherImages(judge, image);
  Volume<Label> mask;
  if (s.mask) mask = readLabels(context, "mask", *s.mask, reading);
  Atlas atlas;
  if (s.atlas) atlas = readAtlas(context, s, reading, image.grid);

  segmentation::TissueSegmentation tissue;
  {
    auto step = context.step("tissue");
    tissue = segmentation::segmentTissue(image, mask, s.tissue, context.monitor());
    step.iterations(tissue.iterations);
    step.termination(tissue.termination);
  }
  context.result("brain_voxels", tissue.brainVoxels);
  context.result("iterations", tissue.iterations);
  constexpr std::array<const char*, 3> kNames = {"csf", "grey", "white"};
  for (int k = 0; k < 3; ++k) {
    context.result(std::string(kNames[k]) + "_mean", tissue.classes[k].mean);
    context.result(std::string(kNames[k]) + "_deviation", tissue.classes[k].deviation);
    context.result(std::string(kNames[k]) + "_share", tissue.classes[k].share);
  }

  judgeTissue(context, judge, tissue);

  segmentation::Hemisphere hemisphere;
  if (s.atlas) {
    auto step = context.step("hemisphere");
    hemisphere = segmentation::extractHemisphere(tissue, atlas.labels, atlas.legend, s.hemisphere,
                                                 context.monitor());
    context.result("hemisphere", std::string(nameOf(s.hemisphere.side)));
    context.result("white_voxels", hemisphere.whiteVoxels);
    context.result("grey_voxels", hemisphere.greyVoxels);
    context.result("deep_voxels_filled", hemisphere.deepVoxels);
    context.result("ventricle_voxels_filled", hemisphere.ventricleVoxels);
    context.result("cavity_voxels_filled", hemisphere.cavityVoxels);
    context.result("stray_voxels_dropped", hemisphere.strayVoxels);
  }

  auto step = context.step("write");
  io::writeVolume(context.output("seg.nii.gz"), tissue.labels);
  io::writeVolume(context.output("csf.nii.gz"), tissue.probability[0]);
  io::writeVolume(context.output("gm.nii.gz"), tissue.probability[1]);
  io::writeVolume(context.output("wm.nii.gz"), tissue.probability[2]);
  io::writeVolume(context.output("bias.nii.gz"), tissue.bias);
  if (s.atlas) {
    io::writeVolume(context.output("hemisphere.nii.gz"), hemisphere.labels);
    io::writeVolume(context.output("white_share.nii.gz"), hemisphere.whiteShare);
    io::writeVolume(context.output("tissue_share.nii.gz"), hemisphere.tissueShare);
    io::writeVolume(context.output("cut.nii.gz"),
                    segmentation::maskOf(hemisphere.labels, segmentation::kCut));
  }
  return tissue.termination;
}

}  // namespace

Command segmentCommand() {
  return makeCommand<Settings>("segment", declare, run);
}

}  // namespace explica::app
