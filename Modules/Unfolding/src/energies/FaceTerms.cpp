// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../Room.h"
#include "FaceSum.h"

#include <algorithm>

namespace explica::unfolding {
namespace {

/// strength * sum over the region's faces of w (1 - n . d).
///
/// With areas kept this is the area times one less the average visibility [Thesis, Eq. 5.26]; off
/// that constraint it differs: every face feels a torque towards the viewpoint, where the flux
/// itself pulls at the rim only, and no face gains by growing.
struct VisibilityOfFace {
  static constexpr bool kOfCollar = false;

  struct MeanDirection {
    Vector direction = Vector::Zero();                     ///< at most 1 long
    Eigen::Matrix3d derivative = Eigen::Matrix3d::Zero();  ///< by the place looked at, symmetric
  };

  /// Where a face is to look: along a direction of its own, or towards the viewpoints.
  static MeanDirection directionOf(const Configuration& now, std::size_t f) {
    MeanDirection mean;
    if (now.directions != nullptr) {
      mean.direction = now.directions->row(static_cast<Eigen::Index>(f)).transpose();
      return mean;
    }
    const Point place = centroidOf(now.patch.faces[f], now.x);
    for (std::size_t k = 0; k < now.viewpoints.points.size(); ++k) {
      const Vector towards = now.viewpoints.points[k] - place;
      const double distance = towards.norm();
      const Vector unit = towards / distance;
      mean.direction += now.viewpoints.weights[k] * unit;
      mean.derivative += now.viewpoints.weights[k] / distance *
                         (unit * unit.transpose() - Eigen::Matrix3d::Identity());
    }
    return mean;
  }

  static double value(const Configuration& now, std::size_t f, double strength) {
    return strength * now.patch.faces[f].weight *
           (1 - now.shapes[f].normal.dot(directionOf(now, f).direction));
  }
  static CornerForces forces(const Configuration& now, std::size_t f, double strength) {
    const FaceShape& shape = now.shapes[f];
    const MeanDirection look = directionOf(now, f);
    const double scale = strength * now.patch.faces[f].weight;
    const Vector shift = scale / 3 * (look.derivative * shape.normal);
    CornerForces forces;
    for (int k = 0; k < 3; ++k) {
      forces[k] = scale * shape.hat[k].dot(look.direction) * shape.normal - shift;
    }
    return forces;
  }
  /// The stiffness of tension across the surface.
  static FaceStiffness stiffness(const Configuration& now, std::size_t f, double strength) {
    return {0, strength * now.patch.faces[f].weight};
  }
};

/// sum over the region's faces of w (lambda c + strength/2 c^2) with c = A / A0 - 1.
struct AreaOfFace {
  static constexpr bool kOfCollar = false;

  static double value(const Configuration& now, std::size_t f, double strength) {
    const PatchFace& face = now.patch.faces[f];
    const double c = now.shapes[f].area / face.restArea - 1;
    return face.weight * c * (now.multipliers[f] + 0.5 * strength * c);
  }
  static CornerForces forces(const Configuration& now, std::size_t f, double strength) {
    return inPlaneForces(now.shapes[f], tensionOf(now, f, strength));
  }
  /// Gauss-Newton, and the stiffness of tension across the surface.
  static FaceStiffness stiffness(const Configuration& now, std::size_t f, double strength) {
    const PatchFace& face = now.patch.faces[f];
    const double ratio = now.shapes[f].area / face.restArea;
    return {face.weight * strength * ratio * ratio, std::max(0.0, tensionOf(now, f, strength))};
  }

  static double tensionOf(const Configuration& now, std::size_t f, double strength) {
    const PatchFace& face = now.patch.faces[f];
    const double ratio = now.shapes[f].area / face.restArea;
    return face.weight * (now.multipliers[f] + strength * (ratio - 1)) * ratio;
  }
};

/// strength * sum over the region's faces of w h(deficit / radius): h is half the square, on a
/// straight line from kFirm on, so that a deep region is not dragged through a narrow opening
/// before the folds above have made way.
struct LiftOfFace {
  static constexpr bool kOfCollar = false;

  static double shareOf(const Configuration& now, std::size_t f) {
    return deficitOf(now.patch.room, centroidOf(now.patch.faces[f], now.x)) / now.patch.room.radius;
  }

  static double value(const Configuration& now, std::size_t f, double strength) {
    const double share = shareOf(now, f), slope = std::min(share, kFirm);
    return strength * now.patch.faces[f].weight * slope * (share - 0.5 * slope);
  }
  static CornerForces forces(const Configuration& now, std::size_t f, double strength) {
    const PatchRoom& room = now.patch.room;
    const Vector pull = -(strength * now.patch.faces[f].weight / room.radius *
                          std::min(shareOf(now, f), kFirm) / 3) *
                        room.axis;
    return {pull, pull, pull};
  }
  /// Of the parabola that touches there from above: the same for any two corners.
  static Eigen::Matrix3d stiffness(const Configuration& now, std::size_t f, double strength) {
    const PatchRoom& room = now.patch.room;
    const double share = shareOf(now, f);
    const double curvature = share > 0 ? std::min(1.0, kFirm / share) : 0;
    const double scale =
        strength * now.patch.faces[f].weight / (9 * room.radius * room.radius) * curvature;
    return scale * room.axis * room.axis.transpose();
  }
};

/// strength * sum over the collar's faces of o max(0, -n . a)^2, a the room's axis.
///
/// A fold of the collar that stands over the region hides as much of it as its underside is wide
/// across the view, o |n . a|.  One that lies over the region costs what as much area turned away
/// does, one that stands upright nothing.
struct OverhangOfFace {
  static constexpr bool kOfCollar = true;

  /// How far a face looks away, -n . a; 0 where it hides nothing.
  static double awayOf(const Configuration& now, std::size_t f) {
    if (!(now.patch.faces[f].overWeight > 0)) return 0;
    return std::max(0.0, -now.shapes[f].normal.dot(now.patch.room.axis));
  }
  static double slopeOf(const Configuration& now, std::size_t f, double strength) {
    return 2 * strength * now.patch.faces[f].overWeight * awayOf(now, f);
  }

  static double value(const Configuration& now, std::size_t f, double strength) {
    const double away = awayOf(now, f);
    return strength * now.patch.faces[f].overWeight * away * away;
  }
  static CornerForces forces(const Configuration& now, std::size_t f, double strength) {
    CornerForces forces = {Vector::Zero(), Vector::Zero(), Vector::Zero()};
    const double slope = slopeOf(now, f, strength);
    if (!(slope > 0)) return forces;  // of a face without area the normal is not a number
    const FaceShape& shape = now.shapes[f];
    for (int k = 0; k < 3; ++k) {
      forces[k] = slope * shape.hat[k].dot(now.patch.room.axis) * shape.normal;
    }
    return forces;
  }
  /// The stiffness of tension across the surface.
  static FaceStiffness stiffness(const Configuration& now, std::size_t f, double strength) {
    return {0, slopeOf(now, f, strength)};
  }
};

constexpr double kCollarArea = 20;     // as the region's by default, so that the weight compares
constexpr double kCollarSpring = 2.4;  // the collar with the region
constexpr double kHold =
    2;  // strength of what holds it back at kCollarMost, beside the visibility's

/// What a face's area ratio costs: m(r) = strength k/2 (r - 1)^2 for each mm^2 of its weight, and
/// b(r) = kHold t^5, t = max(0, (r - kCollarMean) / (kCollarMost - kCollarMean)), of its hold
/// weight, beyond t = 1 the parabola that goes on there: as stiff as it gets, so that a needle
/// which has given way, and turns, stops no step of all others.
struct StretchOfFace {
  static constexpr bool kOfCollar = true;

  struct Stretching {
    double ratio = 0;
    double value = 0;      ///< mm^2
    double slope = 0;      ///< by the ratio
    double curvature = 0;  ///< by the ratio, >= 0
  };
  static Stretching stretching(const Configuration& now, std::size_t f, double strength) {
    constexpr double kRate = 1 / (kCollarMost - kCollarMean);
    const PatchFace& face = now.patch.faces[f];
    const double ratio = now.shapes[f].area / face.restArea;
    const double membrane = strength * kCollarArea * face.weight;
    const double hold = kHold * face.holdWeight;
    const double t = std::max(0.0, (ratio - kCollarMean) * kRate), u = std::min(t, 1.0);
    const double beyond = t - u, u3 = u * u * u;
    return {ratio,
            0.5 * membrane * (ratio - 1) * (ratio - 1) + hold * u3 * u * u +
                hold * beyond * (5 + 10 * beyond),
            membrane * (ratio - 1) + 5 * hold * u3 * u * kRate + 20 * hold * beyond * kRate,
            membrane + 20 * hold * u3 * kRate * kRate};
  }

  static double value(const Configuration& now, std::size_t f, double strength) {
    return stretching(now, f, strength).value;
  }
  static CornerForces forces(const Configuration& now, std::size_t f, double strength) {
    const Stretching s = stretching(now, f, strength);
    return inPlaneForces(now.shapes[f], s.slope * s.ratio);
  }
  static FaceStiffness stiffness(const Configuration& now, std::size_t f, double strength) {
    const Stretching s = stretching(now, f, strength);
    return {s.curvature * s.ratio * s.ratio, std::max(0.0, s.slope * s.ratio)};
  }
};

/// strength * (sum over the collar's faces of w k/2 c^2 + s sum over its edges of e r(l / l0 - 1))
/// + sum over the collar's faces of h b(A / A0), with c = A / A0 - 1, k = kCollarArea,
/// s = kCollarSpring, r of springValue(), b of StretchOfFace.
class CollarEnergy final : public FaceSum<StretchOfFace> {
 public:
  [[nodiscard]] double value(const Configuration& now, double strength) const override {
    return FaceSum::value(now, strength) + springValue(now.patch.collarEdges(),
                                                       now.patch.yieldStrain, now.x,
                                                       strength * kCollarSpring);
  }
  void addGradient(const Configuration& now, double strength, Positions& gradient) const override {
    FaceSum::addGradient(now, strength, gradient);
    addSpringGradient(now.patch.collarEdges(), now.patch.yieldStrain, now.x,
                      strength * kCollarSpring, gradient);
  }
  void addStiffness(const Configuration& now, double strength,
                    const std::vector<std::int32_t>& unknown, BlockSystem& system) const override {
    FaceSum::addStiffness(now, strength, unknown, system);
    addSpringStiffness(now.patch, now.patch.regionSprings, now.patch.collarEdges().size(), now.x,
                       strength * kCollarSpring, unknown, system);
  }
};

}  // namespace

void makeFaceTerms(Terms& terms) {
  terms[static_cast<std::size_t>(Term::Visibility)] = std::make_unique<FaceSum<VisibilityOfFace>>();
  terms[static_cast<std::size_t>(Term::Area)] = std::make_unique<FaceSum<AreaOfFace>>();
  terms[static_cast<std::size_t>(Term::Lift)] = std::make_unique<FaceSum<LiftOfFace>>();
  terms[static_cast<std::size_t>(Term::Overhang)] = std::make_unique<FaceSum<OverhangOfFace>>();
  terms[static_cast<std::size_t>(Term::Collar)] = std::make_unique<CollarEnergy>();
}

}  // namespace explica::unfolding
