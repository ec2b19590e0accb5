// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Registration/HeadRegistration.h"

#include "Explica/Core/Errors.h"
#include "Explica/Registration/AffineRegistration.h"
#include "Filters.h"

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

namespace explica::registration {
namespace {

constexpr double kHumanBrain = 1.7e6;   // mm^3, with fluid, as Colin27 has it
constexpr double kAround = 12;          // mm of head around a human brain that affine maps look at
constexpr double kNearby = 5;           // mm around it that the deformation looks at
constexpr double kMostStretch = 10;     // of a transform that may bring a head onto another
constexpr double kMostOfABrain = 1.55;  // times the template's brain: above, there is a skull

Volume<float> maskOf(const Volume<float>& brain) {
  Volume<float> mask(brain.grid);
  std::ranges::transform(brain.data, mask.data.begin(),
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
  const auto inside = std::ranges::count_if(image.data, [](float value) { return value > 0; });
  return static_cast<double>(inside) * image.grid.voxelVolume();
}

/// What of a template an image is compared with.
struct Pattern {
  const Volume<float>& like;
  Volume<float> mask;
  double size;  ///< of the template's brain, beside a human one

  /// @throws InvalidInput  a head with skull for a template without
  Pattern(const Template& head, bool stripped)
      : like(stripped ? head.brain : head.head),
        mask(maskOf(head.brain)),
        size(std::cbrt(brainVolumeOf(head) / kHumanBrain)) {
    if (like.size() == 0) {
      throw InvalidInput(
          "template: has no T1 with skull, as the image needs; give a skull-stripped image, or say "
          "--stripped yes if it is one");
    }
  }

  /// The brain and so many mm about it, of a human one.
  [[nodiscard]] Volume<float> around(double by) const { return grown(mask, by * size); }

  [[nodiscard]] DeformationOptions scaled(DeformationOptions options) const {
    options.spacing *= size;
    return options;
  }
};

}  // namespace

double brainVolumeOf(const Template& head) {
  return volumeAboveZero(head.brain);
}

bool looksStripped(const Volume<float>& image, const Template& head) {
  return volumeAboveZero(image) < kMostOfABrain * brainVolumeOf(head);
}

HeadRegistration registerHead(const Volume<float>& image, const Template& head, bool stripped,
                              const DeformationOptions& options, const Monitor& monitor) {
  const Pattern pattern(head, stripped);
  HeadRegistration found;
  const AffineRegistration affine =
      registerAffine(image, pattern.like, pattern.around(kAround), monitor);
  found.information = affine.information;
  DeformationResult deformed =
      registerDeformation(image, pattern.like, pattern.around(kNearby),
                          affine.templateToImage.inverse(), pattern.scaled(options), monitor);
  found.transform = std::move(deformed.transform);
  found.agreement = deformed.agreement;
  found.brain = pulled(pattern.mask, found.transform, image.grid);
  return found;
}

HeadRegistration reuseRegistration(const Volume<float>& image, const Template& head, bool stripped,
                                   HeadTransform transform, const DeformationOptions& options) {
  const Eigen::Vector3d stretches =
      Eigen::JacobiSVD<Eigen::Matrix3d>(transform.affine.linear()).singularValues();
  if (!(stretches[0] < kMostStretch && stretches[2] > 1 / kMostStretch)) {
    throw InvalidInput(
        "template transform: brings no head onto the template: it stretches some direction more "
        "than ten times; give the to_template.h5 of an earlier run on this T1");
  }
  const Pattern pattern(head, stripped);
  HeadRegistration found;
  found.agreement =
      agreementOf(image, pattern.like, pattern.around(kNearby), transform, pattern.scaled(options));
  found.transform = std::move(transform);
  found.brain = pulled(pattern.mask, found.transform, image.grid);
  return found;
}

}  // namespace explica::registration
