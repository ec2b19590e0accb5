// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/IO/SurfaceFile.h"
#include "Settings.h"
#include "TemplateCuts.h"

#include <optional>
#include <vector>

namespace explica::app {

/// What is laid flat: the surface that counts, and which of its faces.
struct Subject {
  io::LoadedSurface reference;
  std::vector<std::int32_t> faces;
  std::optional<TemplateCuts> cuts;  ///< of --cuts template
};

/// Reads the surface, the one whose areas and lengths count, and what is laid flat of it.
/// @throws InvalidInput  files of different vertices, or no face left
[[nodiscard]] Subject subjectOf(Context& context, const FlattenSettings& s);

/// @throws InvalidInput  vertices differ in number
void requireSameVertices(const TriangleMesh& a, const TriangleMesh& b, const std::string& name);

}  // namespace explica::app
