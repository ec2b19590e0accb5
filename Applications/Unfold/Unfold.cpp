// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/Summary.h"

#include "Outputs.h"
#include "Settings.h"

#include "Explica/Application/ReadInputs.h"
#include "Explica/Application/TimeKept.h"
#include "Explica/Collision/Untangling.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Stopwatch.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/IO/RegionFiles.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Repulsion/KnotEnergy.h"
#include "Explica/Unfolding/Account.h"

#include <charconv>
#include <cmath>
#include <sstream>

namespace explica::app {
namespace {

visibility::Viewpoints viewOf(const UnfoldSettings& s, const TriangleMesh& mesh,
                              const unfolding::Region& region, const Point& about) {
  return viewFrom(s.view, s.viewSurface, s.reading, mesh, about,
                  unfolding::meanNormal(mesh, region));
}

/// Vertices at which the map is above the value.
std::vector<bool> markedByMap(const TriangleMesh& mesh, const UnfoldSettings& s) {
  if (s.labels.size() != 1) throw UsageError("--above belongs to a single map (--label)");
  const Eigen::VectorXd values =
      io::readVertexMaps(s.labels.front(), mesh.vertexCount()).front().values;
  std::vector<bool> marked(static_cast<std::size_t>(mesh.vertexCount()));
  double largest = -kInfinity;
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    marked[v] = values[v] > *s.above;
    if (values[v] > largest) largest = values[v];
  }
  if (!(largest > *s.above)) {
    throw InvalidInput(
        printed("label: no vertex is above %g; its largest value is %g", *s.above, largest));
  }
  return marked;
}

/// Vertices of the keys, or names, in the label files.
std::vector<bool> markedByKeys(const TriangleMesh& mesh, const UnfoldSettings& s) {
  std::vector<std::string> keys;
  std::vector<int> numbers;
  for (const std::string& list : s.labelKeys) {
    std::istringstream rest(list);
    for (std::string key; std::getline(rest, key, ',');) {
      int number = 0;
      const char* end = key.data() + key.size();
      const auto [after, error] = std::from_chars(key.data(), end, number);
      if (error == std::errc() && after == end) numbers.push_back(number);
      keys.push_back(key);
    }
  }
  if (numbers.size() == keys.size()) {
    return io::markedByLabels({s.labels.begin(), s.labels.end()}, numbers, mesh.vertexCount());
  }
  if (!numbers.empty() || s.labels.size() != 1) {
    throw UsageError("--label-key: give keys, or names of the regions of one annotation (--label)");
  }
  return io::markedByNames(s.labels.front(), keys, mesh.vertexCount());
}

unfolding::Region regionOf(const TriangleMesh& mesh, const UnfoldSettings& s,
                           const visibility::Viewpoints* view) {
  if (s.labels.empty()) return unfolding::selectRegion(mesh, s.region, view);
  return unfolding::regionOfMarked(mesh, s.above ? markedByMap(mesh, s) : markedByKeys(mesh, s));
}

std::string crossingsInWords(const std::vector<unfolding::Crossing>& list, std::size_t inRegion,
                             const collision::Untangling& repair) {
  const unfolding::Crossing& first = list.front();
  const std::string message = printed(
      "%zu pairs of faces intersect at the start, %zu of them in the region (faces %d and "
      "%d near %.2f, %.2f, %.2f, ...; all in intersections.tsv)",
      list.size(), inRegion, first.faces[0], first.faces[1], first.place[0], first.place[1],
      first.place[2]);
  if (repair.moved.empty()) return message + "; they stay as they are";
  return message +
         printed(
             "; %zu were parted by moving %zu vertices by %.3f mm on average and %.3f mm at most%s",
             repair.before.size() - repair.after.size(), repair.moved.size(), repair.moveMean,
             repair.moveMax, repair.after.empty() ? "" : ", the others stay as they are");
}

/// Lists the start's intersections and parts in `mesh` those that stand in the way.
/// @return the pairs that are left
std::vector<geometry::FacePair> checkStart(Context& context, const UnfoldSettings& s,
                                           const unfolding::Region& region,
                                           const visibility::Viewpoints& view, TriangleMesh& mesh) {
  collision::Untangling repair;
  if (s.repair) {
    auto step = context.step("repair");
    collision::UntangleOptions options;
    if (!context.given("repair")) {
      options.concerned = unfolding::movingFaces(mesh, region, view, s.unfold.unfolder);
    }
    repair = collision::untangle(mesh, options);
    mesh.positions = repair.positions;
  } else {
    auto step = context.step("check");
    repair.before = repair.after = geometry::findSelfIntersections(mesh);
  }
  const auto list = unfolding::listCrossings(mesh, repair.before, repair.after, region);
  writeTextFile(context.output("intersections.tsv"), unfolding::crossingTable(mesh, list));
  std::size_t inRegion = 0;
  for (const unfolding::Crossing& c : list) inRegion += c.facesInRegion > 0;
  context.results(unfolding::StartSummary{list.size(), inRegion,
                                          repair.before.size() - repair.after.size(),
                                          repair.moved.size(), repair.moveMax, repair.moveMean});
  if (!list.empty()) context.warn(crossingsInWords(list, inRegion, repair));
  return repair.after;
}

/// Region and view hang on each other: a direction counts from the region's centroid, a cone needs
/// the view.
struct Aim {
  visibility::Viewpoints view;
  unfolding::Region region;
};

Aim chooseAim(Context& context, const TriangleMesh& mesh, const UnfoldSettings& s) {
  Aim aim;
  if (s.region.cone) {
    unfolding::RegionOptions centre = s.region;
    centre.cone.reset();
    const unfolding::Region ball = unfolding::selectRegion(mesh, centre);
    aim.view = viewOf(s, mesh, ball, mesh.positions.row(ball.centre).transpose());
    aim.region = regionOf(mesh, s, &aim.view);
  } else {
    aim.region = regionOf(mesh, s, nullptr);
    aim.view = viewOf(s, mesh, aim.region, unfolding::centroidOf(mesh, aim.region));
  }
  unfolding::requireViewFromOutside(mesh, aim.view);
  if (aim.region.pieces > 1) {
    context.warn("the region has " + std::to_string(aim.region.pieces) +
                 " pieces; each unfolds on its own");
  }
  if (aim.region.holes > 0) {
    context.warn("the region has " + std::to_string(aim.region.holes) +
                 (aim.region.holes == 1 ? " hole; it stays open" : " holes; they stay open"));
  }
  return aim;
}

TriangleMesh readUsable(Context& context, const UnfoldSettings& s, io::SurfaceMetadata& metadata) {
  const io::LoadedSurface loaded = readSurface(context, "SURFACE", s.surface, s.reading);
  const auto condition = geometry::requireManifold(loaded.mesh, s.surface);
  unfolding::requireFitsSingle(loaded.mesh, s.surface);
  if (condition.coincidentVertices > 0) {
    context.warn(std::to_string(condition.coincidentVertices) +
                 " vertices lie exactly on others: the surface touches itself there");
  }
  sayHowRead(context, loaded.origin);
  if (s.region.center) {
    const std::string mixUp =
        io::frameMixUp(*s.region.center, loaded.mesh.positions, surfaceFromTkr(loaded, s.reading));
    if (!mixUp.empty()) throw InvalidInput("center: " + mixUp);
  }
  metadata = loaded.metadata;
  // What is written is no anatomy any more: viewers keep it out of volumes and their slices.
  metadata.geometricType = "Inflated";
  metadata.secondary.clear();
  metadata.name = "unfolded";
  TriangleMesh mesh = loaded.mesh;
  if (condition.closedManifold() && geometry::turnOutward(mesh)) {
    context.info("faces run clockwise seen from outside: they are turned");
  }
  return mesh;
}

/// Says beforehand how long the exact knot energy takes, which grows with the square of the
/// surface.
void sayHowLong(Context& context, const UnfoldSettings& s, const Unfolded& u) {
  if (s.unfold.unfolder.knot != repulsion::KnotMethod::AllPairs) return;
  constexpr double kPairsPerSecond = 1.4e5;  // an iteration sums several times along its step
  const double pairs = static_cast<double>(u.chosen.faces.size()) * u.before.faceCount();
  context.info(
      printed("knot energy, each iteration: %.2g pairs of faces, about %.0f s on one processor; "
              "--knot tree sums it in n log n",
              pairs, std::ceil(pairs / kPairsPerSecond)));
}

Termination run(Context& context, const UnfoldSettings& s) {
  const Stopwatch seconds;
  Unfolded u;
  u.before = readUsable(context, s, u.metadata);
  const Aim aim = chooseAim(context, u.before, s);
  u.chosen = aim.region;
  u.view = aim.view;
  u.surround = s.unfold.unfolder.surround;
  u.goal = s.unfold.targetVisibility.value_or(1.0);
  std::optional<unfolding::Checkpoint> from;
  if (s.resume) from = unfolding::readCheckpoint(context.outputFolder() / kUnfoldingState);
  const Positions read = u.before.positions;
  u.crossings = checkStart(context, s, u.chosen, u.view, u.before);
  if (u.before.positions != read) {  // the result is compared with what a file holds
    u.reference = kReferenceFile;
    u.before.positions = unfolding::roundedToSingle(u.before.positions);
  }
  u.seenBefore = visibility::visibleFraction(u.before, u.view);
  u.secondsStart = seconds();
  sayHowLong(context, s, u);
  {
    auto step = context.step("unfold");
    // What comes after the iterations, in times of the start: it tests, measures and writes, too.
    constexpr double kRest = 1.5, kEachFrame = 0.2;
    const TimeKept rest(u.secondsStart * (kRest + kEachFrame * s.unfold.frames));
    u.result = unfolding::unfold(u.before, u.chosen, u.view, s.unfold, context.monitor(),
                                 from ? &*from : nullptr);
    const bool asItStood = u.result.history.back().iteration == 0;
    if (asItStood && u.result.termination == Termination::Interrupted) throw Interrupted{};
    u.result.termination = causeOf(u.result.termination);
    step.iterations(u.result.history.back().iteration);
    step.termination(u.result.termination);
  }
  const StopScope kept(nullptr);  // what is reached is written
  const double unfolded = seconds();
  auto step = context.step("measure and write");
  const Termination end = writeUnfolded(context, u);
  context.result("seconds_start", u.secondsStart);
  context.result("seconds_output", seconds() - unfolded);
  return end;
}

}  // namespace

Command unfoldCommand() {
  return makeCommand<UnfoldSettings>("unfold", declareUnfold, run);
}

}  // namespace explica::app
