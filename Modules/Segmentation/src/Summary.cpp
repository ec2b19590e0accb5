// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Segmentation/Summary.h"

namespace explica::segmentation {

HemisphereCounts countsOf(const Hemisphere& hemisphere) {
  return {hemisphere.whiteVoxels,     hemisphere.greyVoxels,   hemisphere.deepVoxels,
          hemisphere.ventricleVoxels, hemisphere.cavityVoxels, hemisphere.strayVoxels};
}

namespace {

void describeClasses(Results& t, const TissueSegmentation* tissue) {
  struct Class {
    std::string key, title;
  };
  const std::array<Class, 3> classes = {
      {{"csf", "Fluid"}, {"grey", "Grey matter"}, {"white", "White matter"}}};
  for (std::size_t k = 0; k < classes.size(); ++k) {
    const auto& [key, title] = classes[k];
    const auto of = [&](double TissueClass::*value) {
      return tissue ? std::optional(tissue->classes[k].*value) : std::nullopt;
    };
    t.number(key + "_mean", title + ", mean brightness", "",
             "In the image's units, bias field divided out.", of(&TissueClass::mean));
    t.number(key + "_deviation", title + ", standard deviation of brightness", "", "",
             of(&TissueClass::deviation));
    t.share(key + "_share", title + " in the brain", "Of the voxels inside the brain mask.",
            of(&TissueClass::share))
        .inHead();
  }
}

void describeDisagreement(Results& t, const std::optional<Disagreement>& found) {
  const auto of = [&](double value) { return found ? std::optional(value) : std::nullopt; };
  const Disagreement d = found.value_or(Disagreement{});
  t.share("template_white_not_white_share", "Template's deep white matter that is not white here",
          "The image is believed.", of(d.share));
  t.number("template_white_not_white_ml", "Largest piece of it", "ml", "", of(d.largest / 1000));
  t.number("template_white_not_white_radius", "Radius of the largest ball in it", "mm", "",
           of(d.deepest));
  std::optional<std::vector<double>> middle;
  if (d.voxels > 0) middle = {d.middle.x(), d.middle.y(), d.middle.z()};
  t.list("template_white_not_white_at", "Centre of that ball", "mm", "RAS.", middle);
}

void describeHemisphere(Results& t, const std::string& side, const std::string& title,
                        const std::optional<HemisphereCounts>& counts) {
  const auto count = [&](const char* key, const char* what, const char* meaning,
                         std::int64_t HemisphereCounts::*value) {
    t.count(key + side, what + title, meaning,
            counts ? std::optional((*counts).*value) : std::nullopt);
  };
  count("white_voxels", "White voxels", "With what was filled.", &HemisphereCounts::white);
  count("grey_voxels", "Grey voxels", "", &HemisphereCounts::grey);
  count("deep_voxels_filled", "Deep grey voxels filled", "", &HemisphereCounts::deep);
  count("ventricle_voxels_filled", "Ventricle's voxels filled", "", &HemisphereCounts::ventricle);
  count("cavity_voxels_filled", "Other enclosed voxels filled", "", &HemisphereCounts::cavity);
  count("stray_voxels_dropped", "Voxels left out",
        "Not connected to the hemisphere, or farther from its white matter than cortex is thick.",
        &HemisphereCounts::stray);
}

}  // namespace

void describe(Results& t, const TissueSummary& r) {
  const TissueSegmentation* tissue = r.tissue;
  const auto of = [&](auto value) { return tissue ? std::optional(value) : std::nullopt; };
  const TissueSegmentation none;
  const TissueSegmentation& found = tissue ? *tissue : none;
  t.count("brain_voxels", "Voxels of the brain", "", of(found.brainVoxels));
  t.number(
       "brain_volume_ml", "Brain volume", "ml", "Everything inside the brain mask.",
       of(tissue ? static_cast<double>(found.brainVoxels) * found.labels.grid.voxelVolume() / 1000
                 : kNaN))
      .inHead();
  t.count("iterations", "Iterations", "Of expectation-maximisation.",
          of(std::int64_t{found.iterations}));
  describeClasses(t, tissue);
  t.number("fluid_of_white", "Deep fluid over white matter", "", "Ratio of brightness.",
           of(found.deepFluid / found.classes[2].mean));
  t.number("noise_of_contrast", "Noise over the contrast of fluid and white matter", "",
           "Standard deviation over the difference of means.", of(noiseOfContrast(found)));
  t.number("rim_contrast", "Contrast at the white border", "",
           "Share of the border's voxels where white is brighter than grey.", r.rimContrast);
  t.share("grey_at_mask_edge", "Cortex at the edge of the mask",
          "Share of its outer border that meets the mask's edge and no fluid.", r.greyAtMaskEdge)
      .atMost(0.5, Judgement::Look,
              "beyond one half the pial surface rests on the mask more than on the image");
  describeDisagreement(t, r.template_);
  t.text("hemisphere", "Hemispheres", "",
         r.side ? std::optional(std::string(nameOf(*r.side))) : std::nullopt);
  describeHemisphere(t, "", "", r.one);
  describeHemisphere(t, "_left", ", left", r.left);
  describeHemisphere(t, "_right", ", right", r.right);
}

}  // namespace explica::segmentation
