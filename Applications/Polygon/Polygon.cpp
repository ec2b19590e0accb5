// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/ReadPolygon.h"
#include "Explica/Application/TimeKept.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/IO/PolygonFile.h"
#include "Explica/Planar/AngularSweep.h"
#include "Explica/Planar/EvolutionFigure.h"
#include "Explica/Planar/PolygonPhantoms.h"
#include "Explica/Planar/PolygonUnfolding.h"
#include "Explica/Planar/PolygonVisibility.h"
#include "Explica/Planar/Summary.h"
#include "Explica/Visibility/Viewpoints.h"
#include "Settings.h"

#include <cmath>

namespace explica::app {

namespace {

/// What is asked for: from FILE and options, or from a phantom where options do not say otherwise.
struct Task {
  planar::Curve curve;
  planar::Region region;
  std::optional<planar::Viewpoints> view;
};

const std::string kSeen = "seen";

planar::Region regionOf(const planar::Curve& curve, const std::optional<std::string>& text) {
  if (!text || *text == kSeen) return planar::wholeRegion(curve);
  int first = 0;
  int last = 0;
  int used = 0;
  if (std::sscanf(text->c_str(), "%d:%d%n", &first, &last, &used) != 2 ||
      used != static_cast<int>(text->size())) {
    throw UsageError("--region '" + *text + "': expected I:J, first and last vertex, or " + kSeen);
  }
  return planar::regionBetween(curve, first, last);
}

planar::Viewpoints inPlane(const visibility::Viewpoints& view) {
  planar::Viewpoints plane{{}, view.weights};
  for (const Point& point : view.points) plane.points.emplace_back(point.head<2>());
  return plane;
}

/// From where to look, if anything was said of it.
std::optional<planar::Viewpoints> viewOf(const PolygonSettings& s, const planar::Curve& curve,
                                         const planar::Region& region) {
  const int given = int{!s.viewpoint.empty()} + int{!s.direction.empty()} + int{!s.line.empty()};
  if (given == 0) return std::nullopt;
  if (given > 1) throw UsageError("give one of --viewpoint, --direction and --view-line");
  if (!s.line.empty()) {
    if (s.line.size() != 4) throw UsageError("--view-line needs four numbers X,Y,X,Y");
    if (!s.weights.empty()) throw UsageError("--view-weights belong to --viewpoint or --direction");
    return inPlane(
        visibility::viewLine(Point(s.line[0], s.line[1], 0), Point(s.line[2], s.line[3], 0)));
  }
  std::vector<Point> points;
  for (const Eigen::Vector2d& point : s.viewpoint) points.emplace_back(point.x(), point.y(), 0);
  for (const Eigen::Vector2d& direction : s.direction) {
    if (!(direction.norm() > 0)) throw UsageError("--direction has no length");
    const planar::Point2 point =
        planar::centroidOf(curve, region) + s.distance * direction.normalized();
    points.emplace_back(point.x(), point.y(), 0);
  }
  return inPlane(visibility::viewpoints(points, s.weights));
}

planar::Region regionSeen(const Task& task) {
  if (!task.view || task.view->points.size() != 1) {
    throw UsageError("--region " + kSeen + " needs one --viewpoint or --direction");
  }
  return planar::regionFacing(task.curve, task.view->points.front());
}

Task taskOf(Context& context, const PolygonSettings& s) {
  if (s.file.has_value() == s.phantom.has_value()) {
    throw UsageError("give FILE or --phantom, one of them");
  }
  Task task;
  if (s.file) {
    task.curve = readCurve(context, "FILE", *s.file, s.reading);
    task.region = regionOf(task.curve, s.region);
    task.view = viewOf(s, task.curve, task.region);
    if (s.region == kSeen) task.region = regionSeen(task);
    return task;
  }
  const planar::PolygonPhantom phantom =
      *s.phantom == PhantomPolygon::Polygon19 ? planar::makePolygon19() : planar::makePolygon34();
  task.curve = phantom.curve;
  task.region = s.region ? regionOf(task.curve, s.region)
                         : planar::regionBetween(task.curve, phantom.first, phantom.last);
  task.view = viewOf(s, task.curve, task.region);
  if (!task.view) task.view = phantom.viewpoint;
  if (s.region == kSeen) task.region = regionSeen(task);
  return task;
}

std::string tableOf(const std::vector<planar::PolygonIteration>& history) {
  std::string table =
      "iteration\tvisibility\tflux_variance\tlength\tlength_error\tleast_distance\tknot_"
      "energy\tstep\tseconds\n";
  for (const planar::PolygonIteration& row : history) {
    table += printed("%d\t%.9g\t%.9g\t%.9g\t%.3g\t%.6g\t%.9g\t%.6g\t%.6f\n", row.iteration,
                     row.visibility, row.variance, row.length, row.lengthError, row.leastDistance,
                     row.knotEnergy, row.step, row.seconds);
  }
  return table;
}

/// The figure of some stages, and the states on the way, evenly spread in visibility.
void writeStages(Context& context, const PolygonSettings& s, const planar::PolygonUnfolding& result,
                 const planar::Viewpoints& view) {
  std::vector<double> progress;
  for (const planar::PolygonIteration& row : result.history) progress.push_back(row.visibility);
  const bool mayCross = !result.intersectionsInitial.empty() || result.firstCrossing >= 0;
  std::vector<planar::EvolutionStage> stages;
  for (std::size_t k : planar::evenStages(progress, static_cast<std::size_t>(s.stages))) {
    const planar::PolygonIteration& row = result.history[k];
    const std::string title =
        row.iteration == 0 ? "start" : "iteration " + std::to_string(row.iteration);
    const planar::PolygonState& state = result.path[k];
    planar::EvolutionStage stage{
        title, state.positions, state.region, row.visibility, row.variance, row.length, {}};
    if (mayCross)
      stage.crossings = planar::intersectingEdges({state.positions, result.curve.closed});
    stages.push_back(std::move(stage));
  }
  writeTextFile(context.output("evolution.svg"),
                planar::drawEvolution(result.curve.closed, view, stages));
  std::size_t number = 0;
  for (std::size_t k : planar::evenStages(progress, static_cast<std::size_t>(s.frames))) {
    io::writePolygonCsv(context.output(frameName(number++, ".csv")), result.path[k].positions);
  }
}

/// One value an edge of the curve, NaN off the region.
io::VertexMap edgeMap(const planar::Curve& curve, const planar::Region& region, std::string name,
                      const Eigen::VectorXd& values) {
  io::VertexMap map{std::move(name), "", Eigen::VectorXd::Constant(curve.edgeCount(), kNaN)};
  const std::vector<int> edges = planar::edgesOf(curve, region);
  for (std::size_t k = 0; k < edges.size(); ++k) {
    map.values[edges[k]] = values[static_cast<Eigen::Index>(k)];
  }
  return map;
}

void writeUnfolding(Context& context, const PolygonSettings& s,
                    const planar::PolygonUnfolding& result, const planar::Viewpoints& view,
                    const planar::VisiblePart& seen) {
  io::writePolygonCsv(context.output("unfolded.csv"), result.curve.positions);
  std::vector<io::VertexMap> edgeMaps;
  if (result.curve.closed) {
    edgeMaps = {edgeMap(result.curve, result.region, "flux",
                        planar::polygonVisibility(result.curve, result.region, view).edgeFlux),
                edgeMap(result.curve, result.region, "seen", seen.edgeSeen)};
  }
  io::writePolygonVtp(context.output("unfolded.vtp"), result.curve.positions, {}, edgeMaps);
  writeTextFile(context.output("evolution.tsv"), tableOf(result.history));
  planar::writeCheckpoint(context.output(kPolygonState), result.checkpoint);
  writeStages(context, s, result, view);
}

std::vector<double> coordinatesOf(const planar::Viewpoints& view) {
  std::vector<double> all;
  for (const planar::Point2& point : view.points) all.insert(all.end(), point.begin(), point.end());
  return all;
}

/// Says beforehand how long the exact knot energy takes, which grows with the square of the size.
void sayHowLongUnfoldingIs(Context& context, const PolygonSettings& s, const Task& task) {
  constexpr double kSumsPerIteration = 2.5, kPairsPerSecond = 1.2e7;
  if (s.unfolding.noTopology || s.unfolding.knot != planar::PolygonKnot::AllPairs) return;
  const double pairs = kSumsPerIteration * task.region.edgeCount * task.curve.edgeCount();
  if (pairs < kPairsPerSecond) return;
  context.info(
      printed("knot energy, each iteration: %.2g pairs of edges, about %.0f s on one processor; "
              "--knot auto or tree sums it in n log n",
              pairs, std::ceil(pairs / kPairsPerSecond)));
}

/// The measures of the whole polygon, whatever the viewpoint.
void reportPolygon(Context& context, const Task& task) {
  const planar::Curve& curve = task.curve;
  context.results(planar::PolygonSummary{
      task.region.edgeCount, planar::lengthOf(curve, task.region),
      planar::signedArea(curve.positions), planar::intersectingEdges(curve).size()});
}

Termination run(Context& context, const PolygonSettings& s) {
  if (s.frames < 0 || s.stages < 1) throw UsageError("--frames and --stages count states");
  const Task task = taskOf(context, s);
  const auto& [curve, region, view] = task;
  std::optional<planar::PolygonCheckpoint> state;
  if (s.resume) {
    if (!view) throw UsageError("--resume needs the viewpoint of the first run");
    state = planar::readCheckpoint(context.outputFolder() / kPolygonState);
  }

  reportPolygon(context, task);
  {
    auto step = context.step("polygon");
    io::writePolygonCsv(context.output("polygon.csv"), curve.positions);
  }
  if (!view) return Termination::NotRun;

  sayHowLongUnfoldingIs(context, s, task);
  auto step = context.step("unfold");
  const auto seenBefore = planar::visiblePart(curve, region, *view);
  planar::PolygonUnfolding result = planar::unfoldPolygon(
      curve, region, *view, s.unfolding, context.monitor(), state ? &*state : nullptr);
  if (result.history.back().iteration == 0) checkpoint(context.monitor());
  const StopScope kept(nullptr);  // what is reached is written
  result.termination = causeOf(result.termination);
  step.iterations(result.history.back().iteration);
  step.termination(result.termination);
  const auto seen = planar::visiblePart(result.curve, result.region, *view);
  writeUnfolding(context, s, result, *view, seen);

  context.results(planar::PolygonUnfoldSummary{
      coordinatesOf(*view), view->weights, s.unfolding.targetVisibility, !s.unfolding.noLength,
      result.history.front(), result.history.back(), seenBefore, seen,
      result.intersectionsFinal.size(), result.firstCrossing, result.verticesMerged, result.seconds,
      result.secondsTopology, result.termination});
  return result.termination;
}

}  // namespace

Command polygonCommand() {
  return makeCommand<PolygonSettings>("polygon", declarePolygon, run);
}

}  // namespace explica::app
