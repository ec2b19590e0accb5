// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Head.h"

#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/IO/TransformFile.h"
#include "Explica/Registration/HeadRegistration.h"
#include "Explica/Registration/SkullStripping.h"
#include "Explica/Registration/Summary.h"
#include "Explica/Segmentation/Plausibility.h"
#include "TemplateFiles.h"

#include <cmath>
#include <sstream>

namespace explica::app {
namespace {

Atlas readAtlas(Context& context, const SegmentSettings& s, const io::VolumeReadOptions& reading,
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
registration::HeadRegistration registered(Context& context, const SegmentSettings& s,
                                          const Volume<float>& image,
                                          const registration::Template& head, bool stripped) {
  if (!s.templateTransform) {
    return registration::registerHead(
        image, head, stripped, segmentation::limitNamed("registration").low, {}, context.monitor());
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
Head fitTemplate(Context& context, Judge& judge, const SegmentSettings& s,
                 const LoadedTemplate& loaded, const Boxes& boxes, const Volume<float>& image,
                 Volume<Label> mask) {
  const bool stripped =
      s.stripped == Stripped::Yes || mask.size() != 0 ||
      (s.stripped == Stripped::Auto && registration::looksStripped(image, loaded.volumes));
  registration::HeadSummary summary;
  summary.stripped = stripped;
  context.info(stripped ? "T1: without skull" : "T1: with skull, which is taken off");
  auto step = context.step("template");
  const auto found = registered(context, s, mask.size() != 0 ? within(image, mask) : image,
                                loaded.volumes, stripped);
  summary.fluidOfWhite = found.fluidOfWhite;
  if (!s.templateTransform) summary.information = found.information;
  summary.correlation = found.agreement.correlation;
  summary.leastJacobian = found.agreement.leastJacobian;
  // Of a T1 the template has its tissues right wherever it agrees.
  const bool agrees = !segmentation::judge("registration", found.agreement.correlation);
  if (!agrees && std::isfinite(found.fluidOfWhite)) {
    judge.require("fluid-of-white", found.fluidOfWhite);
  }
  judge.flag("registration", found.agreement.correlation);
  const double stretch = registration::stretchOf(found.transform.affine);
  summary.stretch = stretch;
  summary.turn = registration::turnOf(found.transform.affine);
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

}  // namespace

Head readHead(Context& context, Judge& judge, const SegmentSettings& s,
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

}  // namespace explica::app
