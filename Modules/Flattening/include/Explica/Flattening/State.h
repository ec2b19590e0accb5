// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Flattening/Cuts.h"
#include "Explica/Flattening/Flatten.h"

#include <filesystem>
#include <optional>

namespace explica::flattening {

/// A surface on its way to a flat map: what going on needs.
struct Checkpoint {
  std::uint64_t uncut = 0;      ///< sumOver() the disc before it is cut
  std::optional<CutPlan> cuts;  ///< if the program looks for them; Interrupted: it still does
  FlattenState map;
};

/// Writes a checkpoint: little-endian numbers and a check sum.
/// @throws EnvironmentError  the file cannot be written
void writeCheckpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// @throws IOError  missing, truncated or no checkpoint
[[nodiscard]] Checkpoint readCheckpoint(const std::filesystem::path& path);

}  // namespace explica::flattening
