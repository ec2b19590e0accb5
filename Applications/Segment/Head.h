// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Plausible.h"
#include "Explica/Segmentation/VoxelBox.h"
#include "Settings.h"

namespace explica::app {

/// Boxes of voxels within each other, the outermost first.
using Boxes = std::vector<segmentation::VoxelBox>;

/// Writes a volume of the innermost box on the grid of the image.
template <class T>
void writeWhole(Context& context, const std::string& name, const Boxes& boxes, Volume<T> volume,
                T outside = T{0}) {
  for (auto box = boxes.rbegin(); box != boxes.rend(); ++box) {
    volume = box->putBack(volume, outside);
  }
  io::writeVolume(context.output(name), volume);
}

/// Labels in the image's space, and what they mean.
struct Atlas {
  Volume<Label> labels;
  segmentation::AtlasLegend legend;
};

/// The brain and its structures in the image's space.
struct Head {
  Volume<Label> mask;          ///< empty: the brain is where the image is above 0
  std::optional<Atlas> atlas;  ///< nothing: hemispheres cannot be told
  Volume<float> expected;      ///< the template's T1 without skull, brought affinely; empty
                               ///< without a template
  double brainShare = 1;       ///< volume of the template's brain over that of a human one
};

/// Finds out what is needed to know brain and hemispheres, and gets it; with a template, writes its
/// atlas and its transform.
/// @param image  of the outermost box
Head readHead(Context& context, Judge& judge, const SegmentSettings& s,
              const io::VolumeReadOptions& reading, const Boxes& boxes, const Volume<float>& image);

}  // namespace explica::app
