// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Command.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Ventricle/Beat.h"

#include <optional>
#include <string>
#include <vector>

namespace explica::app {

/// Frames of all files in order; each file is gone through once, whatever its number of frames.
[[nodiscard]] std::vector<Volume<Label>> readFrames(Context& context,
                                                    const std::vector<std::string>& paths,
                                                    const io::VolumeReadOptions& reading);

/// Images of the same frames, from one file or a file a frame.
/// @param grid   that of the labels
/// @param count  frames of labels
/// @throws InvalidInput  another grid, or another number of frames
[[nodiscard]] std::vector<Volume<float>> readImages(const std::vector<std::string>& paths,
                                                    const io::VolumeReadOptions& reading,
                                                    const Grid& grid, std::size_t count);

/// Which frames are measured, and which of them are ED and ES.
struct Chosen {
  std::vector<int> numbers;
  std::optional<ventricle::Phases> phases;
};

/// @param wanted  "all", "ED,ES" or two numbers, "0,9"
/// @throws UsageError  another text, or a number of no frame
[[nodiscard]] Chosen chooseFrames(const std::string& wanted,
                                  const std::vector<Volume<Label>>& hearts);

}  // namespace explica::app
