// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/Plausible.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/IO/TransformFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Provenance/Doubts.h"
#include "Explica/Registration/HeadRegistration.h"
#include "Explica/Registration/SkullStripping.h"
#include "Explica/Registration/Summary.h"
#include "Explica/Segmentation/Disagreement.h"
#include "Explica/Segmentation/HeadContrast.h"
#include "Explica/Segmentation/Hemisphere.h"
#include "Explica/Segmentation/Plausibility.h"
#include "Explica/Segmentation/Summary.h"
#include "Explica/Segmentation/Tissue.h"
#include "Explica/Segmentation/VoxelBox.h"
#include "TemplateFiles.h"

#include <filesystem>
#include <iomanip>
#include <sstream>

namespace explica::app {

/// Whether a T1 has its skull.
enum class Stripped { Yes, No, Auto };

}  // namespace explica::app

template <>
struct explica::EnumNames<explica::app::Stripped> {
  static constexpr std::array table{std::pair{app::Stripped::Yes, "yes"},
                                    std::pair{app::Stripped::No, "no"},
                                    std::pair{app::Stripped::Auto, "auto"}};
};

namespace explica::app {
namespace {

using segmentation::Side;

constexpr int kMargin = 4;  // voxels around what is looked at

struct Settings {
  std::string image;
  std::optional<std::string> mask;
  std::optional<std::string> atlas;
  std::optional<std::string> legend;
  std::optional<std::string> headTemplate;
  std::optional<std::string> templateTransform;
  Stripped stripped = Stripped::Auto;
  io::VolumeReadOptions reading;
  segmentation::TissueOptions tissue;
  segmentation::HemisphereOptions hemisphere{.side = Side::Both};
  std::vector<std::string> accept;
};

constexpr const char* kDescription =
    "Brings a template (Colin27) into the image's space: an affine map by mutual information, then "
    "a deformation. From its brain mask the border of the brain is sought in the image, up to the "
    "skull; its "
    "atlas says which voxels make a hemisphere. Three tissues are found by "
    "expectation-maximisation of a mixture of pure and mixed voxels with a Markov prior, while a "
    "smooth bias field is estimated and divided out. Each hemisphere's white matter is filled with "
    "deep structures and ventricles, without cerebellum and brain stem; label 4 marks tissue cut "
    "off at the midline and the stem. No template is needed for a skull-stripped image with an "
    "atlas in its space. What cannot be a T1 is refused; numbers beyond what heads have are "
    "flagged, exit code 3.";

void declareOutputs(Declaration& d) {
  d.output("seg.nii.gz", FileKind::LabelVolume, "1 fluid, 2 grey, 3 white, 0 outside")
      .output("csf.nii.gz", FileKind::Volume, "share of fluid in each voxel")
      .output("gm.nii.gz", FileKind::Volume, "share of grey matter in each voxel")
      .output("wm.nii.gz", FileKind::Volume, "share of white matter in each voxel")
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

void declare(Declaration& d, Settings& s) {
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
      .option("Head",
              Field{"template", "",
                    "colin27 (default) or inia19 (a macaque without skull), both of the package "
                    "mricron-data, a folder with T1.nii.gz, brain.nii.gz and atlas.nii.gz, or "
                    "none"},
              s.headTemplate)
      .option("Head", Field{"stripped", "", "whether the skull is off already"}, s.stripped)
      .options("Reading", s.reading)
      .options("Tissues", s.tissue)
      .options("Hemisphere", s.hemisphere);
  declareAccept(d, s.accept);
  declareOutputs(d);
  d.results<registration::HeadSummary>().results<segmentation::TissueSummary>();
}

/// Labels in the image's space, and what they mean.
struct Atlas {
  Volume<Label> labels;
  segmentation::AtlasLegend legend;
};

Atlas readAtlas(Context& context, const Settings& s, const io::VolumeReadOptions& reading,
                const Grid& grid) {
  Atlas atlas;
  atlas.labels = readLabels(context, "atlas", *s.atlas, reading);
  if (!s.legend && segmentation::isFreeSurferAtlas(atlas.labels)) {
    context.info("atlas: FreeSurfer's labels");
    atlas.legend = segmentation::freeSurferLegend();
    segmentation::keepNamed(atlas.labels, atlas.legend);
  } else {
    atlas.legend = readAtlasLegend(context, *s.atlas, s.legend);
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
  const segmentation::HeadContrast contrast = segmentation::measureContrast(image);
  judge.require("thick-slices", contrast.thickest);
  if (contrast.spread == 0) return;
  // Fluid is many voxels in any head, vessels are few.
  constexpr double kFluid = 0.05;
  if (contrast.brightShare < kFluid) judge.require("bright-vessels", contrast.brightest);
  judge.require("bright-fluid", contrast.skewness);
}

/// The image where the mask is not 0.
Volume<float> within(Volume<float> image, const Volume<Label>& mask) {
  if (!sameGrid(mask.grid, image.grid)) {
    throw InvalidInput("mask: lies on another grid than the T1; resample it to the T1's grid");
  }
  for (std::size_t v = 0; v < image.size(); ++v) {
    if (mask[v] == 0) image[v] = 0;
  }
  return image;
}

/// The brain and its structures in the image's space.
struct Head {
  Volume<Label> mask;          ///< empty: the brain is where the image is above 0
  std::optional<Atlas> atlas;  ///< nothing: hemispheres cannot be told
  Volume<float> expected;      ///< the template's T1 without skull, brought affinely; empty
                               ///< without a template
  double brainShare = 1;       ///< volume of the template's brain over that of a human one
};

/// Volume of the brain's left half over that of the right one, by the template's midplane.
double halvesOf(const Volume<Label>& mask, const registration::HeadTransform& transform) {
  double left = 0;
  double right = 0;
  for (std::size_t v = 0; v < mask.size(); ++v) {
    if (mask[v] == 0) continue;
    const auto [i, j, k] = mask.grid.subscripts(v);
    const Point at = transform.affine * mask.grid.toWorld(Vector(i, j, k));
    (at.x() < 0 ? left : right) += 1;
  }
  return right > 0 ? left / right : kInfinity;
}

/// Boxes of voxels within each other, the outermost first.
using Boxes = std::vector<segmentation::VoxelBox>;

/// Writes a volume of the innermost box on the grid of the image.
template <class T>
void writeWhole(Context& context, const std::string& name, const Boxes& boxes, Volume<T> volume,
                T outside = T{0}) {
  for (auto box = boxes.rbegin(); box != boxes.rend(); ++box) {
    volume = box->putBack(volume, outside);
  }
  io::writeVolume(context.output(name), volume);
}

void writeTemplate(Context& context, const Boxes& boxes, const Atlas& atlas, Label stem,
                   const registration::HeadTransform& transform) {
  Volume<Label> labels = atlas.labels;
  std::ostringstream legend;
  legend << "index\tname\n";
  for (const auto& [label, structure] : atlas.legend) {
    if (label != stem) legend << label << '\t' << structure.name << '\n';
  }
  for (Label& label : labels.data) label = label == stem ? 0 : label;
  writeWhole(context, "atlas.nii.gz", boxes, std::move(labels));
  writeTextFile(context.output("atlas.tsv"), legend.str());
  io::writeTransform(context.output("to_template.h5"), transform.affine, transform.displacement);
}

/// The template brought onto the image, or as an earlier run has brought it.
registration::HeadRegistration registered(Context& context, const Settings& s,
                                          const Volume<float>& image,
                                          const registration::Template& head, bool stripped) {
  if (!s.templateTransform) {
    return registration::registerHead(image, head, stripped, {}, context.monitor());
  }
  io::StoredTransform stored = io::readTransform(*s.templateTransform);
  return registration::reuseRegistration(image, head, stripped,
                                         {stored.affine, std::move(stored.displacement)});
}

/// Where the brain of an image without skull is.
Volume<Label> aboveZero(const Volume<float>& image) {
  Volume<Label> brain(image.grid, 0);
  for (std::size_t v = 0; v < image.size(); ++v) brain[v] = image[v] > 0 ? 1 : 0;
  return brain;
}

/// The brain of a head with skull, and what its border leaves in doubt.
Volume<Label> takeOutOfSkull(Context& context, Judge& judge, const Boxes& boxes,
                             const Volume<float>& image, const Volume<float>& carried,
                             registration::HeadSummary& summary) {
  registration::BrainMask brain = registration::stripSkull(image, carried);
  summary.borderOffset = brain.meanOffset;
  summary.borderDeviation = brain.deviation;
  summary.borderOpenShare = brain.openShare;
  judge.flag("brain-border", brain.openShare);
  writeWhole(context, "brain_doubt.nii.gz", boxes, std::move(brain.doubt));
  return std::move(brain.mask);
}

/// The template in the image's space: mask, atlas, and how well it fits.
Head fitTemplate(Context& context, Judge& judge, const Settings& s, const LoadedTemplate& loaded,
                 const Boxes& boxes, const Volume<float>& image, Volume<Label> mask) {
  const bool stripped =
      s.stripped == Stripped::Yes || mask.size() != 0 ||
      (s.stripped == Stripped::Auto && registration::looksStripped(image, loaded.volumes));
  registration::HeadSummary summary;
  summary.stripped = stripped;
  context.info(stripped ? "T1: without skull" : "T1: with skull, which is taken off");
  auto step = context.step("template");
  const auto found = registered(context, s, mask.size() != 0 ? within(image, mask) : image,
                                loaded.volumes, stripped);
  if (!s.templateTransform) summary.information = found.information;
  summary.correlation = found.agreement.correlation;
  summary.leastJacobian = found.agreement.leastJacobian;
  judge.flag("registration", found.agreement.correlation);
  const double stretch = registration::stretchOf(found.transform.affine);
  summary.stretch = stretch;
  judge.flag("stretch", stretch);
  Head head;
  head.mask = std::move(mask);
  if (!stripped) head.mask = takeOutOfSkull(context, judge, boxes, image, found.brain, summary);
  const double halves =
      halvesOf(head.mask.size() != 0 ? head.mask : aboveZero(image), found.transform);
  summary.leftOverRight = halves;
  context.results(summary);
  judge.flag("half-head", halves);
  head.atlas =
      Atlas{registration::pulled(loaded.volumes.atlas, found.transform, image.grid), loaded.legend};
  registration::HeadTransform placed;
  placed.affine = found.transform.affine;
  head.expected = registration::pulled(loaded.volumes.brain, placed, image.grid);
  writeTemplate(context, boxes, *head.atlas, loaded.stem, found.transform);
  return head;
}

/// Finds out what is needed to know brain and hemispheres, and gets it.
Head readHead(Context& context, Judge& judge, const Settings& s,
              const io::VolumeReadOptions& reading, const Boxes& boxes,
              const Volume<float>& image) {
  Volume<Label> mask;
  if (s.mask) {
    mask = readLabels(context, "mask", *s.mask, reading);
    if (!sameGrid(mask.grid, boxes.front().whole())) {
      throw InvalidInput("mask: lies on another grid than the T1; resample it to the T1's grid");
    }
    mask = boxes.front().of(mask);
  }
  std::optional<Atlas> atlas;
  if (s.atlas) atlas = readAtlas(context, s, reading, image.grid);
  const std::string name = s.headTemplate.value_or("colin27");
  if (name == "none" && s.templateTransform) {
    throw UsageError("--template-transform is for a template, and --template is none");
  }
  // With an atlas in its space, an image is taken to be stripped unless it is said not to be.
  const bool known =
      s.atlas && s.stripped != Stripped::No && !s.headTemplate && !s.templateTransform;
  if (name == "none" || known) return {std::move(mask), std::move(atlas), {}, 1};
  const auto loaded = readTemplate(context, name);
  if (!loaded) {
    if (s.headTemplate || s.templateTransform || s.stripped == Stripped::No) {
      throw InvalidInput(
          "template: colin27 is not installed; install the package mricron-data, or give a folder");
    }
    context.warn(
        "no template: the package mricron-data is not installed; the image is taken to be without "
        "skull, and its hemispheres cannot be told");
    return {std::move(mask), std::move(atlas), {}, 1};
  }
  Head head = fitTemplate(context, judge, s, *loaded, boxes, image, std::move(mask));
  if (atlas) head.atlas = std::move(atlas);
  // A template of another species brings its own size.
  if (s.headTemplate) head.brainShare = registration::brainVolumeOf(loaded->volumes) / 1.7e6;
  return head;
}

/// What a segmentation of a T1 cannot be.
void judgeTissue(Judge& judge, const segmentation::TissueSegmentation& tissue, double brainShare,
                 segmentation::TissueSummary& summary) {
  summary.rimContrast = segmentation::rimContrast(tissue.labels);
  judge.require("contrast", *summary.rimContrast);
  summary.greyAtMaskEdge = segmentation::greyAtMaskEdge(tissue.labels);
  const double volume =
      static_cast<double>(tissue.brainVoxels) * tissue.labels.grid.voxelVolume() / 1000;
  judge.flag("brain-volume", volume / std::min(1.0, brainShare));
  judge.flag("grey-share", tissue.classes[1].share);
  judge.flag("white-share", tissue.classes[2].share);
}

/// Where template and image show different tissues, the image is believed, and the reader told.
void compareWithTemplate(Context& context, const segmentation::TissueSegmentation& tissue,
                         const Head& head, segmentation::TissueSummary& summary) {
  if (head.expected.size() == 0) return;
  const auto found = segmentation::whiteDisagreement(tissue.labels, head.expected);
  summary.template_ = found;
  std::ostringstream sentence;
  sentence << std::fixed << std::setprecision(0) << found.voxels << " voxels around "
           << found.middle.x() << ", " << found.middle.y() << ", " << found.middle.z()
           << " mm are deep white matter in the template and other tissue in the image, which is "
              "believed: a lesion, wide ventricles, or a template in the wrong place; look at "
              "seg.nii.gz there";
  context.doubt(provenance::kWhiteUnlikeTemplate, static_cast<std::size_t>(found.voxels),
                sentence.str());
}

segmentation::TissueSegmentation findTissue(Context& context, const Settings& s,
                                            const Volume<float>& image, const Volume<Label>& mask) {
  auto step = context.step("tissue");
  auto tissue = segmentation::segmentTissue(image, mask, s.tissue, context.monitor());
  step.iterations(tissue.iterations);
  step.termination(tissue.termination);
  return tissue;
}

void writeHemisphere(Context& context, const Boxes& boxes, const std::string& folder,
                     const segmentation::Hemisphere& hemisphere) {
  const auto write = [&](const char* name, const auto& volume) {
    writeWhole(context, folder + name, boxes, volume);
  };
  write("hemisphere.nii.gz", hemisphere.labels);
  write("white_share.nii.gz", hemisphere.whiteShare);
  write("tissue_share.nii.gz", hemisphere.tissueShare);
  write("cut.nii.gz", segmentation::maskOf(hemisphere.labels, segmentation::kCut));
}

/// Both sides in one volume, with the numbers of FreeSurfer's ribbon.
void addSide(Volume<Label>& both, const segmentation::Hemisphere& hemisphere, Side side) {
  const Label shift = side == Side::Left ? 0 : 39;
  for (std::size_t v = 0; v < both.size(); ++v) {
    if (hemisphere.labels[v] == segmentation::kWhite) both[v] = 2 + shift;
    if (hemisphere.labels[v] == segmentation::kGrey) both[v] = 3 + shift;
  }
}

void makeHemispheres(Context& context, const Settings& s, const Boxes& boxes,
                     const segmentation::TissueSegmentation& tissue, const Atlas& atlas,
                     segmentation::TissueSummary& summary) {
  auto step = context.step("hemisphere");
  const bool both = s.hemisphere.side == Side::Both;
  summary.side = s.hemisphere.side;
  Volume<Label> merged;
  if (both) merged = Volume<Label>(tissue.labels.grid, 0);
  for (const Side side : {Side::Left, Side::Right}) {
    if (!both && side != s.hemisphere.side) continue;
    segmentation::HemisphereOptions options = s.hemisphere;
    options.side = side;
    const auto hemisphere = segmentation::extractHemisphere(tissue, atlas.labels, atlas.legend,
                                                            options, context.monitor());
    const std::string folder = side == Side::Left ? "left/" : "right/";
    (!both                ? summary.one
     : side == Side::Left ? summary.left
                          : summary.right) = segmentation::countsOf(hemisphere);
    writeHemisphere(context, boxes, both ? folder : "", hemisphere);
    if (both) addSide(merged, hemisphere, side);
  }
  if (both) writeWhole(context, "hemisphere.nii.gz", boxes, std::move(merged));
}

void writeTissue(Context& context, const Boxes& boxes,
                 const segmentation::TissueSegmentation& tissue) {
  auto step = context.step("write");
  writeWhole(context, "seg.nii.gz", boxes, tissue.labels);
  writeWhole(context, "csf.nii.gz", boxes, tissue.probability[0]);
  writeWhole(context, "gm.nii.gz", boxes, tissue.probability[1]);
  writeWhole(context, "wm.nii.gz", boxes, tissue.probability[2]);
  writeWhole(context, "bias.nii.gz", boxes, tissue.bias, 1.0f);
  Volume<Label> mask(tissue.labels.grid, 0);
  for (std::size_t v = 0; v < mask.size(); ++v) mask[v] = tissue.labels[v] != 0 ? 1 : 0;
  writeWhole(context, "brain_mask.nii.gz", boxes, std::move(mask));
}

/// The image without the empty space around it.
Volume<float> readImage(Context& context, Judge& judge, const Settings& s,
                        const io::VolumeReadOptions& reading, Boxes& boxes) {
  const Volume<float> image = readScalars(context, "T1", s.image, reading);
  refuseOtherImages(judge, image);
  boxes.push_back(segmentation::VoxelBox::around(image, kMargin));
  return boxes.back().of(image);
}

Termination run(Context& context, const Settings& s) {
  Judge judge(context, s.accept);
  io::VolumeReadOptions reading = s.reading;
  reading.dimension = 3;
  Boxes boxes;
  Volume<float> image = readImage(context, judge, s, reading, boxes);
  Head head = readHead(context, judge, s, reading, boxes, image);
  if (head.mask.size() != 0) {
    boxes.push_back(segmentation::VoxelBox::around(head.mask, kMargin));
    image = boxes.back().of(image);
    head.mask = boxes.back().of(head.mask);
    if (head.atlas) head.atlas->labels = boxes.back().of(head.atlas->labels);
    if (head.expected.size() != 0) head.expected = boxes.back().of(head.expected);
  }
  const segmentation::TissueSegmentation tissue = findTissue(context, s, image, head.mask);
  image = {};
  segmentation::TissueSummary summary;
  summary.tissue = &tissue;
  judgeTissue(judge, tissue, head.brainShare, summary);
  compareWithTemplate(context, tissue, head, summary);
  writeTissue(context, boxes, tissue);
  if (head.atlas) makeHemispheres(context, s, boxes, tissue, *head.atlas, summary);
  context.results(summary);
  return tissue.termination;
}

}  // namespace

Command segmentCommand() {
  return makeCommand<Settings>("segment", declare, run);
}

}  // namespace explica::app
