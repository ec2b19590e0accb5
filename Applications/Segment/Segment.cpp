// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/OutermostLayer.h"
#include "Explica/Provenance/Doubts.h"
#include "Explica/Segmentation/Disagreement.h"
#include "Explica/Segmentation/HeadContrast.h"
#include "Explica/Segmentation/Plausibility.h"
#include "Explica/Segmentation/Summary.h"
#include "Head.h"

#include <iomanip>
#include <sstream>

namespace explica::app {
namespace {

using segmentation::Side;

constexpr int kMargin = 4;  // voxels around what is looked at

/// What can be no T1, before any work.
void refuseOtherImages(Judge& judge, const Volume<float>& image) {
  judge.require("hounsfield", segmentation::airInHounsfieldUnits(image));
  judge.require("labels",
                segmentation::looksLikeLabels(image) ? segmentation::equalNeighbours(image) : 0.0);
  const segmentation::HeadContrast contrast = segmentation::measureContrast(image);
  judge.require("thick-slices", contrast.thickest);
  if (contrast.spread == 0) return;
  // Fluid is many voxels in any head, vessels are few.
  if (contrast.brightShare < 0.05) judge.require("bright-vessels", contrast.brightest);
  judge.require("bright-fluid", contrast.skewness);
}

/// What a segmentation of a T1 cannot be.
void judgeTissue(Judge& judge, const Volume<float>& image,
                 const segmentation::TissueSegmentation& tissue, double brainShare,
                 segmentation::TissueSummary& summary) {
  summary.rimContrast = segmentation::rimContrast(tissue.labels);
  judge.require("contrast", *summary.rimContrast);
  summary.greyAtMaskEdge = segmentation::greyAtMaskEdge(tissue.labels);
  const double volume =
      static_cast<double>(tissue.brainVoxels) * tissue.labels.grid.voxelVolume() / 1000;
  judge.flag("brain-volume", volume / std::min(1.0, brainShare));
  judge.flag("grey-share", tissue.classes[1].share);
  judge.flag("white-share", tissue.classes[2].share);
  judge.flag("noise", segmentation::noiseOfContrast(tissue));
  judge.flag("bright-in-brain", segmentation::brighterThanWhite(image, tissue));
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

/// Boxes leave room around the brain but where the image ends.
void doubtCutBrain(Context& context, const Volume<Label>& tissues) {
  std::size_t cut = 0;
  forOutermost(tissues.grid,
               [&](int i, int j, int k) { cut += tissues(i, j, k) > segmentation::kCsf; });
  context.doubt(provenance::kTissueAtImageBorder, cut,
                std::to_string(cut) +
                    " voxels of grey and white matter lie in the image's outermost layer, which "
                    "may cut the brain");
}

segmentation::TissueSegmentation findTissue(Context& context, const SegmentSettings& s,
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

void makeHemispheres(Context& context, const SegmentSettings& s, const Boxes& boxes,
                     const segmentation::TissueSegmentation& tissue, const Atlas& atlas,
                     segmentation::TissueSummary& summary) {
  auto step = context.step("hemisphere");
  summary.side = s.hemisphere.side;
  if (s.hemisphere.side != Side::Both) {
    const auto hemisphere = segmentation::extractHemisphere(tissue, atlas.labels, atlas.legend,
                                                            s.hemisphere, context.monitor());
    summary.one = segmentation::countsOf(hemisphere);
    writeHemisphere(context, boxes, "", hemisphere);
    return;
  }
  const auto [left, right] = segmentation::extractHemispheres(tissue, atlas.labels, atlas.legend,
                                                              s.hemisphere, context.monitor());
  summary.left = segmentation::countsOf(left);
  summary.right = segmentation::countsOf(right);
  writeHemisphere(context, boxes, "left/", left);
  writeHemisphere(context, boxes, "right/", right);
  Volume<Label> merged(tissue.labels.grid, 0);
  addSide(merged, left, Side::Left);
  addSide(merged, right, Side::Right);
  writeWhole(context, "hemisphere.nii.gz", boxes, std::move(merged));
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
Volume<float> readImage(Context& context, Judge& judge, const SegmentSettings& s,
                        const io::VolumeReadOptions& reading, Boxes& boxes) {
  const Volume<float> image = readBrightness(context, "T1", s.image, reading);
  refuseOtherImages(judge, image);
  boxes.push_back(segmentation::VoxelBox::around(image, kMargin));
  return boxes.back().of(image);
}

Termination run(Context& context, const SegmentSettings& s) {
  if (s.legend && !s.atlas) {
    throw UsageError("--atlas-legend says what labels of --atlas mean: give both, or neither");
  }
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
  segmentation::TissueSummary summary;
  summary.tissue = &tissue;
  judgeTissue(judge, image, tissue, head.brainShare, summary);
  image = {};
  compareWithTemplate(context, tissue, head, summary);
  doubtCutBrain(context, tissue.labels);
  writeTissue(context, boxes, tissue);
  if (head.atlas) makeHemispheres(context, s, boxes, tissue, *head.atlas, summary);
  context.results(summary);
  return tissue.termination;
}

}  // namespace

Command segmentCommand() {
  return makeCommand<SegmentSettings>("segment", declareSegment, run);
}

}  // namespace explica::app
