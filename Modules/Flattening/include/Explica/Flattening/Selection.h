// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <optional>
#include <span>
#include <vector>

namespace explica::flattening {

using VertexKeys = Eigen::Matrix<Label, Eigen::Dynamic, 1>;  ///< V

/// The numbers of all rows of `faces`.
[[nodiscard]] std::vector<std::int32_t> everyFace(const Faces& faces);

/// Those of the listed rows of `faces` that `others` has, too: same three vertices in any order.
[[nodiscard]] std::vector<std::int32_t> facesAlsoIn(const Faces& faces,
                                                    std::span<const std::int32_t> listed,
                                                    const Faces& others);

/// Those of the listed rows of `faces` whose three vertices have the key, or without one any key
/// but 0.
/// @throws InvalidInput  none has
[[nodiscard]] std::vector<std::int32_t> facesWithin(const Faces& faces,
                                                    std::span<const std::int32_t> listed,
                                                    const VertexKeys& keys,
                                                    std::optional<Label> key = {});

}  // namespace explica::flattening
