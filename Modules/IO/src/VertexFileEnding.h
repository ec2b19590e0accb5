// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace explica::io {

/// How the name of a file of surfaces, maps or labels ends (".shape.gii", ".mgh.gz"); empty for a
/// name such as lh.thickness.
[[nodiscard]] std::string vertexFileEnding(const std::string& name);

}  // namespace explica::io
