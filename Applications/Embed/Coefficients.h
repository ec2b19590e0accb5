// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Shapes/HarmonicAnnulus.h"

#include <nlohmann/json.hpp>

#include <filesystem>

namespace explica::app {

/// A shape as coefficients.json has it: kind, centre, radii, order, inner and outer coefficients.
[[nodiscard]] nlohmann::ordered_json jsonOf(const shapes::HarmonicShape& shape);

/// @throws IOError  not a file of coefficients, or a member missing or of the wrong size
[[nodiscard]] shapes::HarmonicShape readCoefficients(const std::filesystem::path& path);

}  // namespace explica::app
