// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Collision/Repair.h"

#include "Explica/Application/Command.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Geometry/FaceCrossing.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"

#include <algorithm>
#include <set>

namespace explica::app {
namespace {

struct RepairSettings {
  std::vector<std::string> surfaces;
  collision::RepairOptions repair;
};

void declare(Declaration& d, RepairSettings& s) {
  d.synopsis("faces of a surface that cross each other parted, by moving few vertices a little")
      .description(
          R"(Finds every pair of faces that intersect, by an exact test, and parts them by small moves of the vertices about. Faces and the numbers of vertices stay, and vertices that do not move keep every bit. A group of crossings that would need a longer move than --max-move is left as it is and said; so the result never crosses more than the input. Several surfaces with the same faces (white, pial) are repaired each by itself and never come to meet each other where they did not. A run that is stopped writes what it has parted by then; repair the result again to go on. A FreeSurfer file is also written in its own format, to take its place between recon-all and what follows.)")
      .reference("Volino, Magnenat-Thalmann 2006, ACM Trans. Graphics 25(3):1154-1159")
      .example("explica repair lh.white lh.pial --out repaired",
               "Both surfaces of a hemisphere, as repaired/lh.white, repaired/lh.pial and GIFTI")
      .input("SURFACE", FileKind::Surface, "one surface, or several with the same faces",
             s.surfaces)
      .category("Repair")
      .option({"max-move", "mm", "how far a vertex may be moved"}, s.repair.maxMove)
      .output("*.surf.gii", FileKind::Surface, "NAME.surf.gii: each surface, scanner RAS")
      .output("?h.*", FileKind::Surface,
              "of FreeSurfer files: the same in their own format and frame")
      .output("intersections.tsv", FileKind::Table,
              "surface, the faces of each pair at the start, where, and whether it was parted")
      .output("moved.shape.gii", FileKind::VertexData,
              "how far each vertex was moved, mm, a map a surface")
      .results<collision::RepairSummary>();
}

struct CrossingSurfaces {
  std::vector<std::string> names;
  std::vector<io::LoadedSurface> loaded;
  std::vector<TriangleMesh> meshes;  ///< in the files' own coordinates
};

/// Surfaces in the coordinates of their files, so that what is written back is what was tested.
CrossingSurfaces readInputs(Context& context, const RepairSettings& s) {
  CrossingSurfaces inputs;
  std::set<std::string> names;
  for (const std::string& path : s.surfaces) {
    inputs.loaded.push_back(
        readSurface(context, "SURFACE", path, {.space = io::SurfaceSpace::Scanner}));
    inputs.meshes.push_back(inputs.loaded.back().mesh);
    geometry::requireManifold(inputs.meshes.back(), path);
    inputs.names.push_back(io::nameOfSurface(path));
    if (!names.insert(inputs.names.back()).second) {
      throw UsageError("two surfaces are called '" + inputs.names.back() +
                       "', and outputs follow their names; repair them into folders of their own");
    }
  }
  return inputs;
}

std::string rowsOf(const std::string& name, const TriangleMesh& mesh,
                   const collision::RepairedSurface& repaired) {
  std::string text;
  for (const geometry::FacePair& pair : repaired.before) {
    const Point place = geometry::placeOfCrossing(mesh, pair);
    const bool left = std::binary_search(repaired.after.begin(), repaired.after.end(), pair);
    text += name + printed("\t%d\t%d\t%.4f\t%.4f\t%.4f\t%s\n", pair[0], pair[1], place[0], place[1],
                           place[2], left ? "no" : "yes");
  }
  return text;
}

/// The surface as GIFTI in scanner RAS, and a FreeSurfer file in its own format.
void write(Context& context, const std::string& path, const std::string& name,
           const io::LoadedSurface& loaded, const collision::RepairedSurface& repaired) {
  io::LoadedSurface placed = io::readSurface(path);  // as every other command reads it
  const Eigen::Matrix3d linear = placed.origin.applied.topLeftCorner<3, 3>();
  for (const std::int32_t v : repaired.moved) {
    placed.mesh.positions.row(v) = (linear * repaired.positions.row(v).transpose() +
                                    placed.origin.applied.topRightCorner<3, 1>())
                                       .transpose();
  }
  io::writeGiftiSurface(context.output(name + ".surf.gii"), placed.mesh, placed.metadata);
  if (loaded.origin.format == "FreeSurfer") {
    io::rewriteFreeSurferSurface(context.output(name), path, repaired.positions, repaired.moved);
  }
}

/// Why crossings are left.
void warnOfRest(Context& context, const std::vector<collision::RepairedSurface>& repaired) {
  std::size_t before = 0, after = 0, far = 0, other = 0;
  for (const collision::RepairedSurface& surface : repaired) {
    before += surface.before.size();
    after += surface.after.size();
    far += surface.putBackFar;
    other += surface.putBackOther;
  }
  if (after == 0) return;
  std::string message = std::to_string(after) + " of " + std::to_string(before) +
                        " crossing pairs of faces could not be parted (intersections.tsv)";
  if (far > 0)
    message += "; " + std::to_string(far) + " groups would need a longer move than --max-move";
  if (other > 0)
    message += "; " + std::to_string(other) + " groups would meet another of the surfaces";
  context.warn(message);
}

Termination run(Context& context, const RepairSettings& s) {
  const StopScope kept(nullptr);  // what is reached is written
  const CrossingSurfaces inputs = readInputs(context, s);
  std::vector<collision::RepairedSurface> repaired;
  {
    auto step = context.step("repair");
    repaired = collision::repairSurfaces(inputs.meshes, s.repair, context.monitor());
  }
  auto step = context.step("write");
  std::string rows = "surface\tface\tother_face\tx\ty\tz\tparted\n";
  std::vector<io::VertexMap> moves;
  for (std::size_t n = 0; n < repaired.size(); ++n) {
    const TriangleMesh& mesh = inputs.meshes[n];
    rows += rowsOf(inputs.names[n], mesh, repaired[n]);
    moves.push_back(
        {inputs.names[n], "mm", (repaired[n].positions - mesh.positions).rowwise().norm()});
    write(context, s.surfaces[n], inputs.names[n], inputs.loaded[n], repaired[n]);
  }
  writeTextFile(context.output("intersections.tsv"), rows);
  io::writeGiftiShape(context.output("moved.shape.gii"), moves,
                      inputs.loaded.front().metadata.structure);
  const collision::RepairSummary summary = collision::summaryOf(repaired, inputs.names);
  context.results(summary);
  warnOfRest(context, repaired);
  if (summary.all.after == 0) return Termination::Converged;
  return context.monitor().shouldStop() ? Termination::Interrupted : Termination::Stalled;
}

}  // namespace

Command repairCommand() {
  return makeCommand<RepairSettings>("repair", declare, run);
}

}  // namespace explica::app
