// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "PatchEnergy.h"

#include "Explica/Core/Parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace explica::unfolding {
namespace {

constexpr std::size_t kGrain = 256;

/// Normal, area and gradients of the corner functions of a triangle in its plane.
struct FaceShape {
  Vector normal;  ///< outward, unit
  double area;
  std::array<Vector, 3> hat;  ///< mm^-1; the area's gradient is area * hat, the normal's
                              ///< differential -sum_i hat_i (normal . dx_i)
};

FaceShape shapeOf(const PatchFace& face, const Positions& x) {
  const Point a = x.row(face.vertices[0]).transpose(), b = x.row(face.vertices[1]).transpose(),
              c = x.row(face.vertices[2]).transpose();
  const Vector twice = (b - a).cross(c - a);
  const double length = twice.norm();
  FaceShape shape;
  shape.normal = twice / length;
  shape.area = 0.5 * length;
  shape.hat = {shape.normal.cross(c - b) / length, shape.normal.cross(a - c) / length,
               shape.normal.cross(b - a) / length};
  return shape;
}

struct MeanDirection {
  Vector direction = Vector::Zero();                     ///< at most 1 long
  Eigen::Matrix3d derivative = Eigen::Matrix3d::Zero();  ///< by the place looked at, symmetric
};

MeanDirection directionFrom(const Point& place, const visibility::Viewpoints& viewpoints) {
  MeanDirection mean;
  for (std::size_t k = 0; k < viewpoints.points.size(); ++k) {
    const Vector towards = viewpoints.points[k] - place;
    const double distance = towards.norm();
    const Vector unit = towards / distance;
    mean.direction += viewpoints.weights[k] * unit;
    mean.derivative +=
        viewpoints.weights[k] / distance * (unit * unit.transpose() - Eigen::Matrix3d::Identity());
  }
  return mean;
}

Point centroidOf(const PatchFace& face, const Positions& x) {
  return (x.row(face.vertices[0]) + x.row(face.vertices[1]) + x.row(face.vertices[2])).transpose() /
         3;
}

/// How far below the room for the flat patch a point is, mm.
double deficit(const PatchRoom& room, const Point& place) {
  return std::max(0.0, room.height - room.axis.dot(place));
}

}  // namespace

PatchValue PatchEnergy::value(const Positions& x, const visibility::Viewpoints& viewpoints,
                              const PatchStrengths& strengths,
                              const Eigen::VectorXd& multipliers) const {
  PatchValue sum;
  sum.visibility = parallelSum(faces_.size(), kGrain, 0.0, [&](std::size_t begin, std::size_t end) {
    double block = 0;
    for (std::size_t f = begin; f < end; ++f) {
      if (!faces_[f].looked) continue;
      const FaceShape shape = shapeOf(faces_[f], x);
      const Vector d = directionFrom(centroidOf(faces_[f], x), viewpoints).direction;
      block += faces_[f].weight * (1 - shape.normal.dot(d));
    }
    return strengths.visibility * block;
  });
  sum.area = parallelSum(faces_.size(), kGrain, 0.0, [&](std::size_t begin, std::size_t end) {
    double block = 0;
    for (std::size_t f = begin; f < end; ++f) {
      const double c = shapeOf(faces_[f], x).area / faces_[f].restArea - 1;
      block += faces_[f].weight * c * (multipliers[f] + 0.5 * strengths.area * c);
    }
    return block;
  });
  sum.spring = parallelSum(springs_.size(), kGrain, 0.0, [&](std::size_t begin, std::size_t end) {
    double block = 0;
    for (std::size_t s = begin; s < end; ++s) {
      const PatchSpring& spring = springs_[s];
      const double strain =
          (x.row(spring.vertices[1]) - x.row(spring.vertices[0])).norm() / spring.restLength - 1;
      block += strengths.spring * spring.weight * strain * strain;
    }
    return block;
  });
  if (strengths.lift > 0) {
    sum.lift = parallelSum(faces_.size(), kGrain, 0.0, [&](std::size_t begin, std::size_t end) {
      double block = 0;
      for (std::size_t f = begin; f < end; ++f) {
        if (!faces_[f].looked) continue;
        const double share = deficit(room_, centroidOf(faces_[f], x)) / room_.radius;
        block += 0.5 * strengths.lift * faces_[f].weight * share * share;
      }
      return block;
    });
  }
  return sum;
}

void PatchEnergy::addGradient(const Positions& x, const visibility::Viewpoints& viewpoints,
                              const PatchStrengths& strengths, const Eigen::VectorXd& multipliers,
                              Positions& gradient) const {
  std::vector<std::array<Vector, 3>> byCorner(faces_.size());
  parallelFor(faces_.size(), kGrain, [&](std::size_t f) {
    const PatchFace& face = faces_[f];
    const FaceShape shape = shapeOf(face, x);
    const double c = shape.area / face.restArea - 1;
    const double tension =
        face.weight * (multipliers[f] + strengths.area * c) * shape.area / face.restArea;
    for (int k = 0; k < 3; ++k) byCorner[f][k] = tension * shape.hat[k];
    if (!face.looked) return;
    const MeanDirection look = directionFrom(centroidOf(face, x), viewpoints);
    const double strength = strengths.visibility * face.weight;
    const double pull = strengths.lift * face.weight / (room_.radius * room_.radius) *
                        deficit(room_, centroidOf(face, x));
    const Vector shift = strength / 3 * (look.derivative * shape.normal) + pull / 3 * room_.axis;
    for (int k = 0; k < 3; ++k) {
      byCorner[f][k] += strength * shape.hat[k].dot(look.direction) * shape.normal - shift;
    }
  });
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    for (int k = 0; k < 3; ++k) gradient.row(faces_[f].vertices[k]) += byCorner[f][k].transpose();
  }
  for (const PatchSpring& spring : springs_) {
    const Eigen::RowVector3d along = x.row(spring.vertices[1]) - x.row(spring.vertices[0]);
    const double length = along.norm();
    const Eigen::RowVector3d pull = 2 * strengths.spring * spring.weight *
                                    (length / spring.restLength - 1) / spring.restLength / length *
                                    along;
    gradient.row(spring.vertices[0]) -= pull;
    gradient.row(spring.vertices[1]) += pull;
  }
}

void PatchEnergy::addStiffness(const Positions& x, const PatchStrengths& strengths,
                               const Eigen::VectorXd& multipliers,
                               const std::vector<std::int32_t>& unknown,
                               BlockSystem& system) const {
  using Blocks = std::array<Eigen::Matrix3d, 6>;
  std::vector<Blocks> blocks(faces_.size());
  parallelFor(faces_.size(), kGrain, [&](std::size_t f) {
    const PatchFace& face = faces_[f];
    const FaceShape shape = shapeOf(face, x);
    const double ratio = shape.area / face.restArea;
    const double tension = face.weight * (multipliers[f] + strengths.area * (ratio - 1)) * ratio;
    const double inPlane = face.weight * strengths.area * ratio * ratio;
    const double across =
        std::max(0.0, tension) + (face.looked ? strengths.visibility * face.weight : 0);
    const Eigen::Matrix3d normal = across * shape.normal * shape.normal.transpose();
    const bool lifted =
        face.looked && strengths.lift > 0 && deficit(room_, centroidOf(face, x)) > 0;
    const Eigen::Matrix3d lift =
        lifted ? Eigen::Matrix3d(strengths.lift * face.weight / (9 * room_.radius * room_.radius) *
                                 room_.axis * room_.axis.transpose())
               : Eigen::Matrix3d(Eigen::Matrix3d::Zero());
    int n = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) {
        blocks[f][n++] = lift + inPlane * shape.hat[i] * shape.hat[j].transpose() +
                         shape.hat[i].dot(shape.hat[j]) * normal;
      }
    }
  });
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    int n = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j, ++n) {
        const std::int32_t row = unknown[faces_[f].vertices[i]];
        const std::int32_t column = unknown[faces_[f].vertices[j]];
        if (row >= 0 && column >= 0) system.add(row, column, blocks[f][n]);
      }
    }
  }
  for (const PatchSpring& spring : springs_) {
    const Vector along = (x.row(spring.vertices[1]) - x.row(spring.vertices[0])).transpose();
    const double length = along.norm();
    const Vector unit = along / length;
    const double stiffness =
        2 * strengths.spring * spring.weight / (spring.restLength * spring.restLength);
    const double lateral = stiffness * std::max(0.0, 1 - spring.restLength / length);
    const Eigen::Matrix3d block =
        (stiffness - lateral) * unit * unit.transpose() + lateral * Eigen::Matrix3d::Identity();
    const std::int32_t i = unknown[spring.vertices[0]], j = unknown[spring.vertices[1]];
    if (i >= 0) system.add(i, i, block);
    if (j >= 0) system.add(j, j, block);
    if (i >= 0 && j >= 0) system.add(i, j, -block);
  }
}

}  // namespace explica::unfolding
