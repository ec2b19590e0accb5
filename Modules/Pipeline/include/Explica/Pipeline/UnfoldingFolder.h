// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace explica::pipeline {

/// Frames that `explica unfold --frames` has left in a folder, in their order; none if it has not.
[[nodiscard]] std::vector<std::filesystem::path> frameFiles(const std::filesystem::path& folder);

/// Vertices of the region that was unfolded, ascending; none where the folder does not say.
/// @throws InvalidInput, IOError  the labels are not those of a surface of so many vertices
[[nodiscard]] std::vector<std::int32_t> unfoldedRegion(
    const std::filesystem::path& folder, std::optional<std::int64_t> vertexCount = {});

/// Average visibility of a frame, from the folder's summary; NaN where it is not there.
[[nodiscard]] double frameVisibility(const nlohmann::ordered_json& summary, std::size_t frame);

/// Three numbers under a key, RAS mm; of several points the first.
[[nodiscard]] std::optional<Point> pointIn(const nlohmann::ordered_json& json,
                                           const std::string& key);

}  // namespace explica::pipeline
