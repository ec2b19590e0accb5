// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Energy.h"

#include "Explica/Core/Parallel.h"

namespace explica::unfolding {
namespace {

constexpr std::size_t kGuideGrain = 1024;  // elements a task

// Of the guide's radius: nearer to its place a vertex is at home, where lengths and areas say how
// it lies; from the second on the pull grows no more, so that nothing is dragged through the rest.
constexpr double kHome = 0.02, kGuideFirm = 0.05;

struct Pull {
  Vector towards = Vector::Zero();  ///< unit, normal to the axis; 0 at home
  double value = 0;                 ///< h
  double slope = 0;                 ///< h'
  double curvature = 0;             ///< of the parabola that touches there from above
};

/// h(s) = (s - kHome)^2 / 2, 0 below, on a straight line from kGuideFirm on; s = |p - x| / R across
/// the axis.
Pull pullOn(const PatchGuide& guide, std::size_t n, const Positions& x) {
  Vector way =
      (guide.places.row(static_cast<Eigen::Index>(n)) - x.row(guide.vertices[n])).transpose();
  way -= guide.axis.dot(way) * guide.axis;
  const double s = way.norm() / guide.radius;
  if (!(s > kHome)) return {};
  constexpr double kMost = kGuideFirm - kHome;
  const double slope = std::min(s - kHome, kMost);
  return {way.normalized(), slope * (s - kHome - 0.5 * slope), slope, slope / s};
}

/// strength * sum over the guide's vertices of a h(|p - x| / R), |p - x| across the axis.
class GuideEnergy final : public Energy {
 public:
  [[nodiscard]] double value(const Configuration& now, double strength) const override {
    if (!(strength > 0)) return 0;
    const PatchGuide& guide = now.patch.guide;
    const auto sum = [&](std::size_t begin, std::size_t end) {
      double block = 0;
      for (std::size_t n = begin; n < end; ++n) {
        block += guide.weights[n] * pullOn(guide, n, now.x).value;
      }
      return block;
    };
    return strength * parallelSum(guide.vertices.size(), kGuideGrain, 0.0, sum);
  }

  void addGradient(const Configuration& now, double strength, Positions& gradient) const override {
    if (!(strength > 0)) return;
    const PatchGuide& guide = now.patch.guide;
    parallelFor(guide.vertices.size(), kGuideGrain, [&](std::size_t n) {
      const Pull pull = pullOn(guide, n, now.x);
      gradient.row(guide.vertices[n]) -=
          strength * guide.weights[n] / guide.radius * pull.slope * pull.towards.transpose();
    });
  }

  void addStiffness(const Configuration& now, double strength,
                    const std::vector<std::int32_t>& unknown, BlockSystem& system) const override {
    if (!(strength > 0)) return;
    const PatchGuide& guide = now.patch.guide;
    const double scale = strength / (guide.radius * guide.radius);
    const Eigen::Matrix3d across =
        Eigen::Matrix3d::Identity() - guide.axis * guide.axis.transpose();
    parallelFor(guide.vertices.size(), kGuideGrain, [&](std::size_t n) {
      const std::int32_t i = unknown[guide.vertices[n]];
      const double curvature = pullOn(guide, n, now.x).curvature;
      if (i >= 0 && curvature > 0) {
        system.add(i, i, scale * guide.weights[n] * curvature * across);
      }
    });
  }
};

}  // namespace

std::unique_ptr<Energy> makeGuideEnergy() {
  return std::make_unique<GuideEnergy>();
}

}  // namespace explica::unfolding
