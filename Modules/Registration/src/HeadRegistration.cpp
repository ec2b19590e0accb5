// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Registration/HeadRegistration.h"

#include "Explica/Core/Errors.h"
#include "Explica/Registration/AffineRegistration.h"
#include "Filters.h"

#include <algorithm>
#include <cmath>

namespace explica::registration {
namespace {

constexpr double kHumanBrain = 1.7e6;   // mm^3, with fluid, as Colin27 has it
constexpr double kAround = 12;          // mm of head around a human brain that affine maps look at
constexpr double kNearby = 5;           // mm around it that the deformation looks at
constexpr double kMostOfABrain = 1.55;  // times the template's brain: above, there is a skull

Volume<float> maskOf(const Volume<float>& brain) {
  Volume<float> mask(brain.grid);
  std::transform(brain.data.begin(), brain.data.end(), mask.data.begin(),
                 [](float value) { return value > 0 ? 1.0f : 0.0f; });
  return mask;
}

/// The mask grown by about so many mm, with a soft border.
Volume<float> grown(const Volume<float>& mask, double by) {
  // A blurred step has 2.3 % left two standard deviations outside.
  Volume<float> wide = smoothed(mask, 0.5 * by);
  for (float& value : wide.data) value = std::clamp(value / 0.046f, 0.0f, 1.0f);
  return wide;
}

double volumeAboveZero(const Volume<float>& image) {
  const auto inside =
      std::count_if(image.data.begin(), image.data.end(), [](float value) { return value > 0; });
  return static_cast<double>(inside) * image.grid.voxelVolume();
}

}  // namespace

double brainVolumeOf(const Template& head) {
  return volumeAboveZero(head.brain);
}

bool looksStripped(const Volume<float>& image, const Template& head) {
  return volumeAboveZero(image) < kMostOfABrain * brainVolumeOf(head);
}

HeadRegistration registerHead(const Volume<float>& image, const Template& head, bool stripped,
                              const DeformationOptions& options, const Monitor& monitor) {
  if (!stripped && head.head.size() == 0) {
    throw InvalidInput(
        "template: has no T1 with skull, as the image needs; give a skull-stripped image, or say "
        "--stripped yes if it is one");
  }
  const Volume<float>& like = stripped ? head.brain : head.head;
  const Volume<float> mask = maskOf(head.brain);
  const double size = std::cbrt(brainVolumeOf(head) / kHumanBrain);
  HeadRegistration found;
  const AffineRegistration affine =
      registerAffine(image, like, grown(mask, kAround * size), monitor);
  found.information = affine.information;
  DeformationOptions scaled = options;
  scaled.spacing *= size;
  DeformationResult deformed = registerDeformation(
      image, like, grown(mask, kNearby * size), affine.templateToImage.inverse(), scaled, monitor);
  found.transform = std::move(deformed.transform);
  found.agreement = deformed.agreement;
  found.brain = pulled(mask, found.transform, image.grid);
  return found;
}

}  // namespace explica::registration
