// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Grid.h"

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace explica::io {

/// Which way a file's transform is taken.
enum class TransformSense {
  Auto,     ///< as the format's programs use it to bring the volume to the surface's space
  Forward,  ///< the file maps the surface's space to the volume's
  Inverse   ///< the file maps the volume's space to the surface's, so it is inverted
};
constexpr auto enumWords(TransformSense) {
  using enum TransformSense;
  return std::to_array<EnumWord<TransformSense>>(
      {{Auto, "auto"}, {Forward, "forward"}, {Inverse, "inverse"}});
}

/// What is known about both sides of a transform.
struct TransformSides {
  Grid volume;  ///< whose places are wanted
  /// From the coordinates in the surface's file to scanner RAS: SurfaceOrigin::applied.
  Eigen::Matrix4d scannerFromFile = Eigen::Matrix4d::Identity();
  /// FreeSurfer's surface RAS of the surface's volume to scanner RAS, if that is known.
  std::optional<Eigen::Matrix4d> scannerFromTkr;
  TransformSense sense = TransformSense::Auto;
};

/// A map from scanner RAS of a surface to the world of a volume, both mm.
struct PointTransform {
  std::string format;                      ///< "matrix", "ITK", "LTA", "register.dat", "pycortex"
  std::string sense;                       ///< a clause that says what was taken to what
  std::optional<Eigen::Matrix4d> matrix;   ///< where it is affine
  std::function<Point(const Point&)> map;  ///< may be called from several threads

  /// All points, P x 3.
  [[nodiscard]] Positions operator()(const Positions& points) const;
};

/// Reads the transform by which a volume lies on a surface.  By content:
///
/// - 16 numbers as text: the matrix from surface to volume, RAS mm to RAS mm.  '#' starts a
/// comment.
/// - ITK's text, `.mat` and HDF5 files (affine, displacement fields, composites), LPS: ITK maps
///   points of the fixed image to the moving one, so that the transform that resamples the volume
///   (moving) into the space of the surface's image (fixed), as ANTs and fMRIPrep's
///   `from-boldref_to-T1w` have it, is taken as it stands.
/// - FreeSurfer LTA, voxel to voxel or RAS to RAS: the side whose geometry is the volume's is
/// recognised by
///   the file; inverted if that is its source (`bbregister --lta`).
/// - FreeSurfer register.dat: surface RAS of the anatomy to that of the volume, as it stands.
/// - pycortex's `matrices.xfm` (JSON): `coord` maps the surface file's coordinates to voxels.
///
/// @throws IOError       missing, damaged or of no known format
/// @throws InvalidInput  a matrix that cannot be inverted or is not affine, an LTA of which both or
///                       no sides are the volume while the sense is Auto, a transform without
///                       inverse where one is wanted, register.dat without `scannerFromTkr`
[[nodiscard]] PointTransform readPointTransform(const std::filesystem::path& path,
                                                const TransformSides& sides);

}  // namespace explica::io
