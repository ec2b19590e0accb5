// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Command.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Surface/CorticalSurface.h"
#include "Explica/Surface/CorticalTissue.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace explica {
namespace app {

/// What `thickness.shape.gii`, the means and FreeSurfer's files hold.
enum class ThicknessMeasure {
  Trajectory,  ///< length of the trajectory that joins the two surfaces
  Nearest      ///< FreeSurfer's: mean of the nearest distances, both ways
};
constexpr auto enumWords(ThicknessMeasure) {
  using enum ThicknessMeasure;
  return std::to_array<EnumWord<ThicknessMeasure>>(
      {{Trajectory, "trajectory"}, {Nearest, "nearest"}});
}

/// Whether the surfaces are a sheet that may end in rims.
enum class Sheet {
  Automatic,  ///< where grey matter runs out of the image, and in LayNii's rims
  Always,
  Never  ///< a closed surface, or a refusal
};
constexpr auto enumWords(Sheet) {
  using enum Sheet;
  return std::to_array<EnumWord<Sheet>>(
      {{Automatic, "auto"}, {Always, "always"}, {Never, "never"}});
}

}  // namespace app

namespace app {

/// What `explica surface` is asked for.
struct SurfaceSettings {
  std::optional<std::string> segmentation;
  std::optional<std::string> innerLevel;
  std::optional<std::string> outerLevel;
  std::optional<std::string> greyShare;
  std::optional<std::string> insulatedMask;
  std::optional<std::string> image, t2;
  std::optional<double> level;
  std::optional<std::string> whiteSurface, pialSurface, midSurface;
  io::SurfaceSpace surfaceSpace = io::SurfaceSpace::Stated;
  std::optional<std::string> atlas, atlasLegend, parcellation;
  std::optional<std::string> freeSurfer;
  std::optional<std::string> fsVolume;
  io::VolumeReadOptions reading;
  surface::TissueOptions tissue;
  surface::SurfaceOptions surface;
  std::vector<std::string> accept;
  Sheet sheet = Sheet::Automatic;
  double scale = 1;
  ThicknessMeasure thicknessMeasure = ThicknessMeasure::Trajectory;
};

/// Inputs, options, outputs and results of the command.
void declareSurface(Declaration& d, SurfaceSettings& s);

/// Whether surfaces of another program are to be taken over.
inline bool surfacesGiven(const SurfaceSettings& s) {
  return s.whiteSurface || s.pialSurface || s.midSurface;
}

/// Lengths of the header, multiplied.
template <class T>
Volume<T> scaled(Volume<T> volume, double scale) {
  volume.grid.spacing *= scale;
  volume.grid.origin *= scale;
  return volume;
}

}  // namespace app
}  // namespace explica
