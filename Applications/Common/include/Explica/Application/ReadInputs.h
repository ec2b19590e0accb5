// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VolumeFile.h"

#include <string>

namespace explica::app {

/// Reads as Explica/IO does, and puts into the record, under `name` (the parameter: "SEG",
/// "inner-level"), how the file was understood: format, stored type and size, which placement or
/// frame its header states and which was used.
[[nodiscard]] Volume<float> readScalars(Context& context, const std::string& name,
                                        const std::string& path,
                                        const io::VolumeReadOptions& options);
/// As readScalars, for an image of a head: its brightness counts from that of air.
[[nodiscard]] Volume<float> readBrightness(Context& context, const std::string& name,
                                           const std::string& path,
                                           const io::VolumeReadOptions& options);
[[nodiscard]] Volume<Label> readLabels(Context& context, const std::string& name,
                                       const std::string& path,
                                       const io::VolumeReadOptions& options);
/// As readLabels, for labels of tissue.
/// @throws InvalidInput  what was read looks like an image with grey values
[[nodiscard]] Volume<Label> readTissueLabels(Context& context, const std::string& name,
                                             const std::string& path,
                                             const io::VolumeReadOptions& options);
[[nodiscard]] io::LoadedSurface readSurface(Context& context, const std::string& name,
                                            const std::string& path,
                                            const io::SurfaceReadOptions& options);

/// From FreeSurfer's surface RAS (tkregister) to the frame of a surface as it was read, as its own
/// file, `fsVolume`, or the record of `explica surface` beside it tell; identity where nothing
/// does.
[[nodiscard]] Eigen::Matrix4d surfaceFromTkr(const io::LoadedSurface& surface,
                                             const io::SurfaceReadOptions& options);

/// Tells the user what the file left open and how it was taken (a frame that it does not state,
/// polygons split); to be called once all inputs are found good.
void sayHowRead(Context& context, const io::SurfaceOrigin& origin);

}  // namespace explica::app
