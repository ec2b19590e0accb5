// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Planar/PolygonUnfolding.h"

#include <filesystem>
#include <string>

namespace explica::app {

/// A run's state as JSON text, which gives back every double.
[[nodiscard]] std::string textOf(const planar::PolygonCheckpoint& state);

/// @throws IOError  missing, damaged, or of another kind
[[nodiscard]] planar::PolygonCheckpoint readState(const std::filesystem::path& path);

}  // namespace explica::app
