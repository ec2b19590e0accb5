// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Inflation/Inflate.h"

#include "Outputs.h"

#include "Explica/Application/Command.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Application/TimeKept.h"
#include "Explica/Collision/Untangling.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Stopwatch.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Inflation/Summary.h"
#include "Explica/Unfolding/Account.h"

#include <optional>

namespace explica::app {
namespace {

struct InflateSettings {
  std::string surface;
  io::SurfaceReadOptions reading;
  bool repair = true;
  inflation::InflateOptions inflate;
  bool resume = false;
};

void declare(Declaration& d, InflateSettings& s) {
  d.synopsis("a closed surface opened as a whole until its folds are seen, areas kept")
      .description(
          R"(Looks at the surface from a sphere around it and turns every face towards the mean direction in which its place sees that sphere, until the global visibility reaches --target-seen: the share of the view that arrives, each place weighing the viewpoints before it by the cosine. It is 1 for convex surfaces and for no others; the share of the area that is seen from somewhere is larger. Face areas are kept, edges keep their lengths as well as they can, and no step lets the surface pass through itself; faces that intersect at the start are parted first.

What is written is tested once more: faces that cross in it and did not at the start, a surface that stays far from its goal, and a run that never got better than its start end with a warning, a 'flag' in the summary and exit code 3. A run can be stopped at any time and continued with --resume into the same --out.)")
      .reference(
          "Lopez Perez 2010, Two- and three-dimensional annular tissues and unfolding, thesis")
      .example("explica inflate lh.white --out inflated", "A hemisphere's folds, all in view")
      .input("SURFACE", FileKind::Surface, "closed triangulated surface", s.surface)
      .options("Reading", s.reading)
      .category("Inflation")
      .option("repair",
              "remove self-intersections first; distortion is measured against the repaired "
              "surface",
              s.repair)
      .options("Inflation", s.inflate)
      .option("resume", "continue the run whose outputs are in --out", s.resume)
      .reuseOutputIf(s.resume)
      .output("inflated.surf.gii", FileKind::Surface, "the inflated surface")
      .output("*.inflated", FileKind::Surface, "the same as FreeSurfer writes it")
      .output(
          "visibility.shape.gii", FileKind::VertexData,
          "share of the view that arrives before and after, seen from somewhere before and after")
      .output("distortion.shape.gii", FileKind::VertexData,
              "area ratio, angle change in degrees, edge strain")
      .varyingOutput("evolution.tsv", FileKind::Table, "one row per iteration")
      .output("intersections.tsv", FileKind::Table,
              "pairs of faces that intersect at the start, where, and whether they were parted")
      .output("frames/frame-*.surf.gii", FileKind::Surface, "--frames states on the way")
      .varyingOutput(kInflationState, FileKind::Any, "what --resume needs")
      .results<unfolding::StartSummary>()
      .results<inflation::InflateSummary>();
}

TriangleMesh readUsable(Context& context, const InflateSettings& s, io::SurfaceMetadata& metadata) {
  const io::LoadedSurface loaded = readSurface(context, "SURFACE", s.surface, s.reading);
  const auto condition = geometry::requireClosedManifold(loaded.mesh, s.surface);
  unfolding::requireFitsSingle(loaded.mesh, s.surface);
  sayHowRead(context, loaded.origin);
  if (condition.components == 1 && condition.eulerCharacteristic != 2) {
    context.warn("the surface has " + std::to_string((2 - condition.eulerCharacteristic) / 2) +
                 " handles; they stay, and what lies behind them cannot be seen from all around");
  }
  metadata = loaded.metadata;
  return loaded.mesh;
}

/// Lists the start's intersections and parts them in `mesh`.
/// @return the pairs that are left
std::vector<geometry::FacePair> checkStart(Context& context, const InflateSettings& s,
                                           TriangleMesh& mesh) {
  collision::Untangling repair;
  if (s.repair) {
    auto step = context.step("repair");
    repair = collision::untangle(mesh);
    mesh.positions = repair.positions;
  } else {
    auto step = context.step("check");
    repair.before = repair.after = geometry::findSelfIntersections(mesh);
  }
  const auto list = unfolding::listCrossings(mesh, repair.before, repair.after, {});
  writeTextFile(context.output("intersections.tsv"), unfolding::crossingTable(mesh, list));
  const std::size_t parted = repair.before.size() - repair.after.size();
  context.results(unfolding::StartSummary{list.size(), std::nullopt, parted, repair.moved.size(),
                                          repair.moveMax, repair.moveMean});
  if (!list.empty()) {
    context.warn(
        printed("%zu pairs of faces intersect at the start (intersections.tsv); %zu were parted by "
                "moving %zu vertices by %.3f mm at most, the others stay as they are",
                list.size(), parted, repair.moved.size(), repair.moveMax));
  }
  return repair.after;
}

Termination run(Context& context, const InflateSettings& s) {
  const Stopwatch seconds;
  Inflated u;
  u.before = readUsable(context, s, u.metadata);
  std::optional<unfolding::Checkpoint> checkpoint;
  if (s.resume) checkpoint = unfolding::readCheckpoint(context.outputFolder() / kInflationState);
  u.crossings = checkStart(context, s, u.before);
  const double started = seconds();
  const StopScope kept(nullptr);  // what is reached is written
  {
    auto step = context.step("inflate");
    // What comes after the iterations, in times of the start, which reads and tests one surface.
    constexpr double kRest = 1, kEachFrame = 0.5;
    const TimeKept rest(started * (kRest + kEachFrame * s.inflate.frames));
    u.result = inflation::inflate(u.before, s.inflate, context.monitor(),
                                  checkpoint ? &*checkpoint : nullptr);
    u.result.termination = causeOf(u.result.termination);
    step.iterations(u.result.history.back().step.iteration);
    step.termination(u.result.termination);
  }
  const double inflated = seconds();
  auto step = context.step("measure and write");
  const Termination end = writeInflated(context, u, s.inflate);
  context.result("seconds_start", started);
  context.result("seconds_inflate", inflated - started);
  context.result("seconds_output", seconds() - inflated);
  return end;
}

}  // namespace

Command inflateCommand() {
  return makeCommand<InflateSettings>("inflate", declare, run);
}

}  // namespace explica::app
