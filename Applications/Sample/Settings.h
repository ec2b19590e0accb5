// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/CortexFiles.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Sampling/Depth.h"
#include "Explica/Sampling/Sampler.h"
#include "Explica/Sampling/Statistics.h"

#include <optional>
#include <string>
#include <vector>

namespace explica::app {

/// What `explica sample` is asked for.
struct SampleSettings {
  std::vector<std::string> volumes;
  std::vector<std::string> labelVolumes;
  CortexFiles cortex;
  std::optional<std::string> thickness;
  std::optional<std::string> depths;
  sampling::DepthKind depthKind = sampling::DepthKind::Depth;
  sampling::Interpolation interpolate = sampling::Interpolation::Linear;
  sampling::Across across = sampling::Across::None;
  VolumePlace place;
  std::optional<std::string> mask;
  std::vector<std::string> labels;
  std::optional<std::string> points;
  io::VolumeReadOptions reading;
};

/// Places of surface points in a volume's world: through --to-volume, or as they are.
[[nodiscard]] Positions placesIn(Context& context, const Grid& volume, const SampleSettings& s,
                                 const Cortex* cortex, const Positions& points);

/// Voxels that count, if --mask is given.
/// @throws InvalidInput  it is not on the volume's grid
[[nodiscard]] std::optional<Volume<std::uint8_t>> maskFor(const Grid& volume,
                                                          const SampleSettings& s);

/// Reads what lies around the volumes' values, so that what cannot be used is refused before any
/// work: headers, --mask and --to-volume.
/// @throws InvalidInput  one of them cannot be read, or they do not fit each other
void requireUsable(Context& context, const SampleSettings& s, const Cortex* cortex);

/// Regions of --labels; without, all vertices are one.
[[nodiscard]] sampling::Regions regionsOf(const SampleSettings& s, Eigen::Index vertexCount);

void declareSample(Declaration& d, SampleSettings& s);

/// Samples at depths between surfaces into one map a volume and depth, and profiles of regions.
[[nodiscard]] Termination sampleSurfaces(Context& context, const SampleSettings& s);

/// Samples along the trajectories of `explica thickness` into one table a volume.
[[nodiscard]] Termination sampleLayers(Context& context, const SampleSettings& s);

}  // namespace explica::app
