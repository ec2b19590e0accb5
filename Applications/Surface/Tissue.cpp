// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Tissue.h"

#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Text.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Maps/Folding.h"
#include "Explica/Provenance/Doubts.h"
#include "Explica/Registration/AffineRegistration.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

namespace explica::app {
namespace {

/// Whether the tissue is a sheet; says so where nobody asked.
bool isSheet(Context& context, const SurfaceSettings& s, const surface::TissueMasks& masks) {
  if (s.sheet == Sheet::Never || s.tissue.closeEdges) return false;
  if (s.sheet == Sheet::Always) return true;
  if (!surface::isBlock(masks)) return false;
  context.info(surface::runsOutOfImage(masks)
                   ? "grey matter runs out of the image: the surfaces are sheets with a rim "
                     "(--sheet never refuses)"
                   : "a rim of tissue: the surfaces are sheets with a rim");
  return true;
}

}  // namespace

TissueInputs readTissue(Context& context, const SurfaceSettings& s) {
  io::VolumeReadOptions reading = s.reading;
  reading.dimension = 3;
  TissueInputs inputs;
  if (s.segmentation) {
    const Volume<Label> labels =
        scaled(readTissueLabels(context, "SEG", *s.segmentation, reading), s.scale);
    inputs.grid = labels.grid;
    auto step = context.step("tissue");
    surface::TissueMasks masks = surface::masksFromLabels(labels, s.tissue, context.monitor());
    if (isSheet(context, s, masks)) {
      static_cast<surface::TissueFacts&>(inputs.tissue) = masks;
      inputs.block = std::move(masks);
    } else {
      inputs.tissue = surface::tissueFromMasks(masks, s.tissue.closeEdges, context.monitor());
    }
    return inputs;
  }
  Volume<float> inner =
      scaled(readScalars(context, "inner-level", *s.innerLevel, reading), s.scale);
  inputs.grid = inner.grid;
  Volume<float> outer, grey;
  Volume<std::uint8_t> insulated;
  if (s.outerLevel) {
    outer = scaled(readScalars(context, "outer-level", *s.outerLevel, reading), s.scale);
  }
  if (s.greyShare) {
    grey = scaled(readScalars(context, "grey-share", *s.greyShare, reading), s.scale);
  }
  if (s.insulatedMask) {
    const Volume<Label> mask =
        scaled(readLabels(context, "insulated-mask", *s.insulatedMask, reading), s.scale);
    insulated = Volume<std::uint8_t>(mask.grid);
    std::transform(mask.data.begin(), mask.data.end(), insulated.data.begin(),
                   [](Label label) { return static_cast<std::uint8_t>(label != 0); });
  }
  auto step = context.step("tissue");
  const Volume<float> white = surface::sharesOf(std::move(inner), s.level, "inner-level");
  Volume<float> tissue;
  if (s.outerLevel) tissue = surface::sharesOf(std::move(outer), s.level, "outer-level");
  if (s.greyShare) {
    tissue = surface::addShares(white, surface::sharesOf(std::move(grey), s.level, "grey-share"));
  }
  inputs.tissue = surface::tissueFromShares(white, tissue, insulated, s.tissue, context.monitor());
  return inputs;
}

SurfaceImages readImages(Context& context, const SurfaceSettings& s) {
  SurfaceImages images;
  io::VolumeReadOptions reading = s.reading;
  reading.dimension = 3;
  reading.frame.reset();
  const auto read = [&](const char* name, const std::optional<std::string>& file) {
    std::optional<Volume<float>> image;
    if (file) image = scaled(readBrightness(context, name, *file, reading), s.scale);
    return image;
  };
  images.first = read("image", s.image);
  images.second = read("t2", s.t2);
  if (!images.second) return images;
  auto step = context.step("align");
  const Eigen::Isometry3d motion =
      registration::registerNearby(*images.first, *images.second, context.monitor());
  images.second->grid = registration::broughtBack(images.second->grid, motion);
  const Grid& grid = images.first->grid;
  images.secondMoved = 0;
  for (int c = 0; c < 8; ++c) {
    const Point corner = grid.toWorld(
        Vector((c & 1) * grid.size[0], (c >> 1 & 1) * grid.size[1], (c >> 2) * grid.size[2]));
    images.secondMoved = std::max(*images.secondMoved, (motion * corner - corner).norm());
  }
  return images;
}

surface::CorticalSurfaces makeSurfaces(Context& context, const SurfaceSettings& s,
                                       const TissueInputs& inputs, SurfaceImages& images) {
  auto step = context.step("surfaces");
  if (inputs.block) {
    return surface::buildSheets(*inputs.block, s.surface, context.monitor());
  }
  const surface::CorticalTissue& tissue = inputs.tissue;
  if (tissue.hasGrey && images.first) {
    return surface::buildSurfaces(tissue, {std::move(*images.first), std::move(images.second)},
                                  s.surface, context.monitor());
  }
  if (tissue.hasGrey) return surface::buildSurfaces(tissue, s.surface, context.monitor());
  context.warn("no grey matter given: only the white surface is made");
  surface::CorticalSurfaces made;
  made.white = surface::extractWhite(tissue, s.surface, context.monitor());
  made.seconds = made.white.seconds;
  made.curvature = maps::meanCurvature(made.white.mesh);
  made.sulcalDepth = maps::sulcalDepth(made.white.mesh);
  return made;
}

void doubtLabels(Context& context, const surface::TissueFacts& tissue, bool sheet) {
  const auto count = [](std::int64_t number) { return static_cast<std::size_t>(number); };
  context.doubt(provenance::kHemisphereCutByGuess, count(tissue.cutContact),
                "no label parts the hemispheres: white matter was cut at " +
                    std::to_string(tissue.cutContact) +
                    " voxel faces where waves from both sides meet; look at the cut");
  // A sheet is meant to end there, and says which vertices it concerns.
  context.doubt(provenance::kTissueAtImageBorder, count(tissue.atImageBorder),
                sheet ? ""
                      : std::to_string(tissue.atImageBorder) +
                            " voxels of white and grey matter lie in the image's outermost layer: "
                            "the surface ends where the image does");
  const std::string unknown =
      joined(tissue.unknownLabels, ", ", [](Label label) { return std::to_string(label); });
  context.doubt(provenance::kLabelsUnknown, tissue.unknownLabels.size(),
                "programs of preset '" + std::string(nameOf(tissue.preset)) + "' use no label " +
                    unknown + "; taken to lie outside the tissue");
}

void checkVolume(Context& context, const surface::CorticalSurfaces& made,
                 const surface::CorticalTissue& tissue, surface::SurfaceSummary& summary) {
  using surface::LabelPreset;
  const LabelPreset preset = tissue.preset;
  const bool human = preset == LabelPreset::Aseg || preset == LabelPreset::Ribbon ||
                     preset == LabelPreset::Dhcp || preset == LabelPreset::Dhcp87;
  if (!human || made.sheet.open || !tissue.hasGrey) return;
  const double sides = tissue.structure == "Cortex" ? 1 : 2;
  const double volume = sides * geometry::enclosedVolume(made.pial) / 1000;
  summary.cerebrumVolume = volume;
  if (volume >= surface::kLeastCerebrum && volume <= surface::kMostCerebrum) return;
  std::ostringstream text;
  text.precision(3);
  text << "the cerebrum holds " << volume << " ml" << (sides == 2 ? " (twice this hemisphere)" : "")
       << ", a human one 250 to 2000 ml: if the header's lengths were scaled, --scale V multiplies "
          "them ("
       << std::cbrt(1100 / volume) << " would make it a human's)";
  context.warn(text.str());
}

}  // namespace explica::app
