// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Volume.h"
#include "Explica/Harmonic/Phantoms.h"

#include <array>
#include <optional>
#include <vector>

namespace explica::phantom {

/// A left ventricle that contracts, in short-axis slices.
struct BeatOptions {
  std::optional<int> frames =
      std::nullopt;  ///< of one beat, >= 1; unset: the phantom at rest, not sliced
  std::optional<double> slice =
      std::nullopt;               ///< spacing of the slices, mm; unset: as within a slice
  double tiltDeg = 0;             ///< of the long axis from the slices' normal, degrees, 0 to 40
  double ejectionFraction = 0.5;  ///< share of the cavity's volume that leaves it, in [0, 0.8]
};

template <class Visitor>
void describe(BeatOptions& options, Visitor&& visit) {
  visit(Field{"frames", "", "a beating ventricle with this many frames, frame-*.nii.gz", 1, 200},
        options.frames);
  visit(Field{"slice", "mm", "with --frames: spacing of the slices (default: the voxel size)"},
        options.slice);
  visit(Field{"tilt", "degrees", "with --frames: of the long axis from the slices' normal"},
        options.tiltDeg);
  visit(Field{"ejection", "", "with --frames: share of the cavity's volume that is ejected"},
        options.ejectionFraction);
}

/// A beat and its exact answers.  Labels: 0 outside, 1 cavity, 2 wall, 3 right ventricle.
struct BeatingVentricle {
  struct Frame {
    Volume<Label> labels;
    harmonic::ExactAnnulus exact;  ///< in the heart's own frame, apex down the third axis
    double cavity = 0;             ///< mm^3
    double wall = 0;               ///< mm^3
    /// Mean over the columns, mm, of the basal, middle and apical third of the cavity's length.
    std::array<double, 3> thickness = {kNaN, kNaN, kNaN};
  };
  std::vector<Frame> frames;
  Eigen::Matrix3d toWorld = Eigen::Matrix3d::Identity();  ///< from the heart's own frame, RAS
  Point anteriorInsertion = Point::Zero();  ///< of the right ventricle, at the equator, RAS mm
  double base = 0;                          ///< plane of the base in the heart's own frame, mm

  [[nodiscard]] Point toHeart(const Point& world) const { return toWorld.transpose() * world; }
};

/// Confocal prolate spheroids (focal distance 40 mm, sinh mu 0.6 and 0.9 at frame 0) cut at a fixed
/// base 15 mm above their centre.  The cavity's volume follows a raised cosine, and the outer
/// spheroid follows from it, so that the volume of the wall is the same in all frames
/// (incompressible).  Trajectories, thus thickness, are exact away from the base.  The right
/// ventricle touches the wall over 120 degrees about the heart's own -x axis.
/// @throws InvalidInput  an option out of range, or a field of view that is too small
[[nodiscard]] BeatingVentricle beatingVentricle(const harmonic::PhantomOptions& size,
                                                const BeatOptions& options);

}  // namespace explica::phantom
