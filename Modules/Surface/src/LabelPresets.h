// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Volume.h"
#include "Explica/Surface/CorticalTissue.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace explica::surface {

using Labels = std::vector<Label>;

/// How often each label occurs.
using Histogram = std::map<Label, std::int64_t>;

[[nodiscard]] Histogram histogramOf(const Volume<Label>& labels);

/// The labels that are there, as a message names them.
[[nodiscard]] std::string listOf(const Histogram& histogram);

/// Voxels with one of these labels.
[[nodiscard]] std::int64_t countOf(const Histogram& histogram, const Labels& labels);

/// What a preset's labels mean in one volume.
struct PresetLabels {
  struct Hemisphere {
    Labels white, grey, fill;
  };
  Hemisphere left;           ///< of both sides, if they have no labels of their own
  Hemisphere right;          ///< empty, if they have none
  Labels unsided;            ///< joined to the white matter of the nearer side
  Labels insulated;          ///< neither inside nor outside
  bool sided = false;        ///< hemispheres have labels of their own
  bool borderLines = false;  ///< labels draw the borders as lines, one voxel thick
  [[nodiscard]] const Hemisphere& of(Side side) const {
    return side == Side::Left || !sided ? left : right;
  }
};

/// A preset's labels as far as the volume holds them; of white and grey matter without any the
/// first that the preset has, so that a message can name it.
[[nodiscard]] PresetLabels labelsOf(LabelPreset preset, const Histogram& histogram);

/// Labels of a volume that the preset's programs do not use; of no preset none.
[[nodiscard]] Labels unknownTo(LabelPreset preset, const Histogram& histogram);

/// Tells by the values that are there, and where they leave it open by what lies beside what, which
/// program wrote a label volume.
/// @throws InvalidInput  no preset fits; lists the labels found
[[nodiscard]] LabelPreset guessPreset(const Volume<Label>& labels, const Histogram& histogram);

}  // namespace explica::surface
