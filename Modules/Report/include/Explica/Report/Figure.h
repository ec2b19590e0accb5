// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/EigenViews.h"
#include "Explica/Core/TriangleMesh.h"
#include "Explica/Core/Volume.h"
#include "Explica/Report/ColourMap.h"
#include "Explica/Report/SlicePicture.h"
#include "Explica/Report/SurfacePicture.h"

#include <map>
#include <optional>
#include <vector>

namespace explica::report {

/// What colours a surface: values or labels of its vertices, or nothing.
struct SurfacePaint {
  Eigen::VectorXd values;                          ///< V, or empty
  ColourScale scale;                               ///< of the values
  Eigen::Matrix<Label, Eigen::Dynamic, 1> labels;  ///< V, or empty; used where there are no values
  std::map<Label, Colour> labelColours;            ///< of their table; others get colourOfLabel
  Eigen::Matrix<Label, Eigen::Dynamic, 1> region;  ///< V, or empty: what is 0 here is shown paler
  /// V, or empty: mean curvature or sulcal depth, positive in sulci, which are drawn darker; where
  /// a value is not known, this alone is seen.
  Eigen::VectorXd folding;
};

/// Colours of a surface's vertices; empty if the paint is.
[[nodiscard]] std::vector<Colour> coloursOf(const SurfacePaint& paint, Eigen::Index vertexCount);

/// Where to look from and at what.
struct FigureView {
  std::optional<ViewName> name;      ///< a standard view of the whole surface
  Vector towards = Vector(1, 0, 0);  ///< direction of sight where there is no name
  Vector up = Vector(0, 0, 1);
  std::vector<std::int32_t> focus;  ///< vertices to fill the picture with; empty for all
};

/// A picture of each view, without a colour bar.
[[nodiscard]] std::vector<Picture> surfaceViews(const TriangleMesh& mesh, const SurfacePaint& paint,
                                                const std::vector<FigureView>& views,
                                                const SurfacePictureOptions& options = {});

/// A picture with the paint's colour bar at its right, if it has values.
[[nodiscard]] Picture withColourBar(Picture picture, const SurfacePaint& paint);

/// The views side by side in rows of `columns`, with one colour bar at the right if there are
/// values.
[[nodiscard]] Picture surfaceFigure(const TriangleMesh& mesh, const SurfacePaint& paint,
                                    const std::vector<FigureView>& views, int columns,
                                    const SurfacePictureOptions& options = {});

[[nodiscard]] Camera cameraOf(const Positions& places, const FigureView& view, int width,
                              int height);

/// Slices through a volume with cut lines: one row for each direction, `count` evenly spaced ones
/// in each, over the box of the contours' meshes or else of the voxels above 0.
[[nodiscard]] Picture sliceFigure(const Volume<float>& image, const std::vector<Contour>& contours,
                                  int count, int height);

/// The box of the centres of voxels above `threshold`, RAS mm.
[[nodiscard]] Eigen::AlignedBox3d boxAbove(const Volume<float>& image, double threshold);

}  // namespace explica::report
