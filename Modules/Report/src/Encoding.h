// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Base64.h"
#include "Explica/Core/TriangleMesh.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace explica::report {

/// zlib stream of bytes.
[[nodiscard]] std::string deflated(std::string_view bytes);

/// Integers for the page's script: differences to the value `stride` before (0: the values
/// themselves), signs folded into the lowest bit, bytes of equal weight together, deflated, base64:
/// {"n": count, "s": stride, "p": planes, "d": "..."}.
[[nodiscard]] nlohmann::ordered_json packIntegers(const std::vector<std::int32_t>& values,
                                                  int stride);

/// Corners of the faces, each face turned to begin with its least and all in ascending order, which
/// deflates a quarter better.
[[nodiscard]] std::vector<std::int32_t> facesInOrder(const Faces& faces);

}  // namespace explica::report
