// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Planar/Curve.h"
#include "Explica/Shapes/HarmonicAnnulus.h"

#include <array>
#include <string>
#include <vector>

namespace explica::shapes {

/// Line segments in a plane, mm.
using Outline = std::vector<std::array<planar::Point2, 2>>;

[[nodiscard]] Outline outlineOf(const planar::Curve& curve);

/// Where a surface meets the plane of that z: one segment a face that crosses it.  A vertex on the
/// plane counts as above it.
[[nodiscard]] Outline sectionOf(const TriangleMesh& mesh, double z);

/// One state of a fit.
struct FitStage {
  std::string title;
  Outline outline;
  double symmetricDifference = 0;  ///< mm^2 or mm^3
  double distanceMax = 0;          ///< mm
};

/// Draws the evolution of a fit as SVG, as figures 3.4 and 3.5 of [Thesis]: in each panel the
/// annulus, the target (orange) and the shape (blue); of shapes in space the section at z.
/// @param z       of the section, mm; 0 in the plane
/// @param stages  at least one
/// @return the whole SVG document
[[nodiscard]] std::string drawFit(const HarmonicAnnulus& annulus, double z, const Outline& target,
                                  const std::vector<FitStage>& stages);

/// One shape of a series.
struct SeriesPanel {
  std::string title;
  Outline outline;
};

/// Draws shapes side by side in their annulus as SVG, as figure 3.7 of [Thesis]; of shapes in space
/// the section at z.
/// @param panels  at least one
/// @return the whole SVG document
[[nodiscard]] std::string drawSeries(const HarmonicAnnulus& annulus, double z,
                                     const std::vector<SeriesPanel>& panels);

}  // namespace explica::shapes
