// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/IO/LabelNames.h"
#include "Explica/IO/VertexDataFile.h"

#include <span>
#include <string>

namespace explica::app {

/// What the labels of a volume are called and coloured: by the legend beside it, else as FreeSurfer
/// does where the file's name is FreeSurfer's.
class LabelVolumeNames {
 public:
  explicit LabelVolumeNames(const std::string& path);

  /// The labels of a surface's vertices with a table of those that occur; sampling::kNoLabel is
  /// "not known".
  [[nodiscard]] io::LabelMap mapOf(const std::string& name, std::span<const Label> keys) const;

 private:
  io::LabelNames names_;
  io::LabelColours colours_;
  bool freeSurfer_;
};

}  // namespace explica::app
