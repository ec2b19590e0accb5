// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/TriangleMesh.h"
#include "Explica/Core/Volume.h"

namespace explica::phantom {

/// A folded ribbon of constant thickness, as labels and as a T1-weighted image.
struct CortexOptions {
  int size = 64;           ///< voxels along each axis, >= 32
  double spacing = 1.0;    ///< mm
  double thickness = 2.5;  ///< of the ribbon, mm
  double depth = 0.25;     ///< of the folds, share of the radius, in [0, 0.5]
  int waves = 5;           ///< folds along an axis
  double noise = 3;        ///< standard deviation in the image; grey and white matter differ by 30
  double bias = 0.1;     ///< how much the image brightens from the middle to the right side, share
  int seed = 1;          ///< of the noise
  double dura = 0;       ///< thickness of a sheet of the dura's brightness beyond the ribbon, mm
  double duraGap = 1.5;  ///< width of the fluid between ribbon and sheet, mm
  double ventricle = 0;  ///< radius of a ball of fluid in the middle, mm; 0 for none
};

template <class Visitor>
void describe(CortexOptions& options, Visitor&& visit) {
  visit(Field{"size", "", "voxels along each axis", 32, 1024}, options.size);
  visit(Field{"spacing", "mm", "voxel size"}, options.spacing);
  visit(Field{"thickness", "mm", "of the grey ribbon"}, options.thickness);
  visit(Field{"depth", "", "of the folds, share of the radius"}, options.depth);
  visit(Field{"waves", "", "folds along an axis", 1, 1000}, options.waves);
  visit(Field{"noise", "", "standard deviation in the image, where tissues differ by 30"},
        options.noise);
  visit(Field{"bias", "", "brightening from the middle to the right side, share"}, options.bias);
  visit(Field{"seed", "", "of the noise"}, options.seed);
  visit(Field{"dura", "mm", "thickness of a sheet as bright as dura beyond the ribbon; 0 for none"},
        options.dura);
  visit(Field{"dura-gap", "mm", "width of the fluid between the ribbon and that sheet"},
        options.duraGap);
  visit(Field{"ventricle", "mm",
              "radius of a ball of fluid in the middle of the white matter; 0 for none"},
        options.ventricle);
}

/// The ribbon and what is known of it exactly.
struct Cortex {
  static constexpr Label kOutside = 0, kCsf = 1, kGrey = 2, kWhite = 3;
  Volume<Label> labels;  ///< by the voxel centre's distance from the white surface
  Volume<float> level;   ///< signed distance to the white surface, mm, negative inside
  Volume<float> image;   ///< T1-weighted: fluid 35, dura 70, grey 85, white 115, mixed at borders;
                         ///< 0 outside
  TriangleMesh white;    ///< the exact white surface
  double thickness = 0;  ///< mm: distance of the pial surface from the white one, everywhere
};

/// Grey matter is what lies within `thickness` outside of a folded, star-shaped white surface,
/// fluid what lies within 3 mm beyond it, and in the ventricle.  A sheet of dura lies in the fluid
/// and is labelled so.
/// @throws InvalidInput  an option out of range
[[nodiscard]] Cortex makeCortex(const CortexOptions& options = {});

}  // namespace explica::phantom
