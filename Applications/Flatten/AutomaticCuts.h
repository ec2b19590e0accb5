// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/Flattening/Cuts.h"
#include "Explica/Flattening/Disc.h"
#include "Explica/Flattening/State.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "TemplateCuts.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace explica::app {

/// Where there is cortex, one a vertex: by `cortex` (FreeSurfer label or annot, GIFTI label, or a
/// map that is 0 elsewhere, such as thickness), else by what lies beside the surface
/// (../label/lh.cortex.label, valid.shape.gii), else everywhere but in the flattest place.  Says
/// which, and notes the file.
/// @throws InvalidInput  a file that is none of these, or of another surface
[[nodiscard]] std::vector<bool> cortexOf(Context& context, const std::string& surface,
                                         const TriangleMesh& mesh,
                                         const std::optional<std::string>& cortex);

/// What FreeSurfer or `explica surface` leave beside a surface to say where its cortex is.
[[nodiscard]] std::optional<std::filesystem::path> cortexBeside(
    const std::filesystem::path& surface);

/// Key 1 off the disc, 2 and on along the cuts, which are named or numbered, 0 elsewhere.
[[nodiscard]] io::LabelMap labelsOf(const flattening::Disc& disc,
                                    const std::vector<flattening::Cut>& cuts,
                                    Eigen::Index vertexCount);

/// Writes cuts.tsv and cuts.label.gii, and opens the disc along the cuts.
[[nodiscard]] flattening::Disc openedAlong(Context& context, const io::LoadedSurface& reference,
                                           const flattening::Disc& disc,
                                           const std::vector<flattening::Cut>& cuts);

/// The same along a template's cuts; says and records which.
[[nodiscard]] flattening::Disc openedAlongTemplate(Context& context,
                                                   const io::LoadedSurface& reference,
                                                   const flattening::Disc& disc,
                                                   const TemplateCuts& cuts);

/// A disc opened along cuts that the program found.
struct Opened {
  flattening::CutPlan plan;
  flattening::Disc disc;
};
/// Finds relief cuts, writes them (cuts.tsv, cuts.label.gii) and opens the disc along them.
/// @param resume  what an earlier run has found; nothing is sought if that was all
/// @throws InvalidInput  a state of another surface
[[nodiscard]] Opened openedByItself(Context& context, const Monitor& monitor,
                                    const io::LoadedSurface& reference,
                                    const flattening::Disc& disc,
                                    const flattening::CutOptions& options,
                                    const flattening::Checkpoint* resume);

}  // namespace explica::app
