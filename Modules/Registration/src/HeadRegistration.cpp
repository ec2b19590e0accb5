// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Registration/HeadRegistration.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/OrderStatistics.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Registration/AffineRegistration.h"
#include "Filters.h"

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

namespace explica::registration {
namespace {

constexpr double kHumanBrain = 1.7e6;   // mm^3, with fluid, as Colin27 has it
constexpr double kAround = 12;          // mm of head around a human brain that affine maps look at
constexpr double kNearby = 5;           // mm around it that the deformation looks at
constexpr double kMostTurn = 120;       // degrees: 90, and as templates' heads are held
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

constexpr Label kPureFluid = 1, kPureWhite = 2;

/// Voxels of pure fluid and pure white matter: whose neighbours are such, too.
Volume<Label> pureTissues(const Volume<float>& brain) {
  constexpr double kWhitest = 0.95, kDarkerThan = 0.4, kBrighterThan = 0.9;
  std::vector<float> inside;
  std::ranges::copy_if(brain.data, std::back_inserter(inside), [](float x) { return x > 0; });
  const float white = inside.empty() ? 0 : quantileOf(std::move(inside), kWhitest);
  const auto tissueOf = [&](float value) -> Label {
    if (value > kBrighterThan * white) return kPureWhite;
    return value > 0 && value < kDarkerThan * white ? kPureFluid : 0;
  };
  Volume<Label> pure(brain.grid, 0);
  parallelFor(brain.size(), 4096, [&](std::size_t v) {
    const Label tissue = tissueOf(brain[v]);
    const bool isPure = std::ranges::all_of(brain.grid.neighbours(v), [&](std::int64_t w) {
      return w >= 0 && tissueOf(brain[w]) == tissue;
    });
    if (isPure) pure[v] = tissue;
  });
  return pure;
}

/// See HeadRegistration::fluidOfWhite.
double fluidOfWhite(const Volume<float>& image, const Volume<float>& brain,
                    const HeadTransform& transform) {
  constexpr double kDarkerQuarter = 0.25;  // what the template has as fluid may be other tissue
  const Volume<Label> tissue = pulled(pureTissues(brain), transform, image.grid);
  std::vector<float> fluid, white;
  for (std::size_t v = 0; v < image.size(); ++v) {
    if (!(image[v] > 0)) continue;
    if (tissue[v] == kPureFluid) fluid.push_back(image[v]);
    if (tissue[v] == kPureWhite) white.push_back(image[v]);
  }
  if (fluid.empty() || white.empty()) return kNaN;
  return quantileOf(std::move(fluid), kDarkerQuarter) / upperMedian(std::move(white));
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
                              double enough, const DeformationOptions& options,
                              const Monitor& monitor) {
  const Pattern pattern(head, stripped);
  const auto affine = [&](Pose pose) {
    return registerAffine(image, pattern.like, pattern.around(kAround), pose, monitor);
  };
  const auto deformed = [&](const AffineRegistration& start) {
    return registerDeformation(image, pattern.like, pattern.around(kNearby),
                               start.templateToImage.inverse(), pattern.scaled(options), monitor);
  };
  AffineRegistration start = affine(Pose::Upright);
  DeformationResult result = deformed(start);
  if (result.agreement.correlation < enough) {
    const AffineRegistration turned = affine(Pose::Turned);
    const bool isUpsideDown = turnOf(turned.templateToImage) > kMostTurn;
    if (!isUpsideDown && turned.information > start.information) {
      DeformationResult other = deformed(turned);
      if (other.agreement.correlation >= enough) {
        start = turned;
        result = std::move(other);
      }
    }
  }
  HeadRegistration found;
  found.information = start.information;
  found.transform = std::move(result.transform);
  found.agreement = result.agreement;
  found.brain = pulled(pattern.mask, found.transform, image.grid);
  found.fluidOfWhite = fluidOfWhite(image, head.brain, found.transform);
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
  found.fluidOfWhite = fluidOfWhite(image, head.brain, found.transform);
  return found;
}

}  // namespace explica::registration
