// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/ReadPolygon.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/IO/PolygonFile.h"
#include "Explica/Planar/AngularSweep.h"
#include "Explica/Planar/EvolutionFigure.h"
#include "Explica/Planar/GlobalFlow.h"
#include "Explica/Planar/PolygonMeasures.h"
#include "Explica/Planar/PolygonPhantoms.h"
#include "Explica/Planar/PolygonUnfolding.h"
#include "Explica/Planar/PolygonVisibility.h"
#include "Explica/Planar/Summary.h"
#include "Explica/Visibility/Viewpoints.h"
#include "State.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace explica::app {

/// A polygon that brings its region and viewpoint along.
enum class PhantomPolygon { Polygon19, Polygon34 };

}  // namespace explica::app

template <>
struct explica::EnumNames<explica::app::PhantomPolygon> {
  using Kind = explica::app::PhantomPolygon;
  static constexpr std::array table = {std::pair{Kind::Polygon19, "polygon19"},
                                       std::pair{Kind::Polygon34, "polygon34"}};
};

namespace explica::app {
namespace {

constexpr char kStateFile[] = "polygon.state";

struct Settings {
  std::optional<std::string> file;
  std::optional<PhantomPolygon> phantom;
  PolygonReading reading;
  std::optional<std::string> region;
  std::vector<Eigen::Vector2d> viewpoint;
  std::vector<Eigen::Vector2d> direction;
  double distance = 1000;
  std::vector<double> weights;
  std::vector<double> line;
  planar::PolygonUnfoldingOptions unfolding;
  std::optional<planar::GlobalMeasure> flow;
  std::optional<double> viewingRadius;
  int frames = 0;
  int stages = 6;
  bool resume = false;
};

void declare(Declaration& d, Settings& s) {
  d.synopsis("a region of a polygon opened towards a viewpoint, lengths kept")
      .description(
          "Moves the region's vertices until every edge faces the viewpoint. Edges of the region "
          "keep their lengths and never cross. The polygon comes from a file, or is the sub-pixel "
          "contour of a label in a slice of an image; without a viewpoint it is only measured and "
          "written. A run can be stopped at any time and continued with --resume into the same "
          "--out.")
      .reference("Rocha, Yezzi, Tannenbaum 2007, IEEE Int. Conf. Image Processing")
      .example("explica polygon --phantom polygon34 --out flat",
               "Unfold a polygon of 34 edges from its viewpoint; evolution.svg shows the stages")
      .example("explica polygon contour.csv --region 10:60 --direction 0,1 --resume --out open",
               "Go on with a run on edges 10 to 60 that was stopped")
      .example("explica polygon ED_label.nii.gz --label-key 2 --slice 4 --out contour",
               "Outer contour of a label, RAS mm")
      .input("FILE", FileKind::Any, "polygon (CSV, VTK polydata), or label image", s.file)
      .option("Contour",
              Field{"phantom", "", "instead of FILE: a phantom with its region and viewpoint"},
              s.phantom);
  declarePolygonReading(d, s.reading);
  d.option("Region", Field{"region", "", "first and last vertex, I:J; default: the whole polygon"},
           s.region)
      .option("Viewpoint",
              Field{"viewpoint", "mm", "point to look from; of several the weighted mean counts"},
              s.viewpoint)
      .option("Viewpoint",
              Field{"direction", "", "look from the region's centroid plus --distance along this"},
              s.direction)
      .option("Viewpoint",
              Field{"distance", "mm", "how far off a viewpoint given by --direction is"},
              s.distance)
      .option("Viewpoint",
              Field{"view-weights", "",
                    "weights of several viewpoints or directions, one each, in their order "
                    "(default: equal)",
                    kAboveZero},
              s.weights)
      .option("Viewpoint",
              Field{"view-line", "mm", "look from all points of the line X,Y,X,Y between two"},
              s.line)
      .options("Unfolding", s.unfolding)
      .option("Unfolding",
              Field{"global-flow", "",
                    "instead of unfolding towards a viewpoint: descend on how much of a viewing "
                    "circle is hidden, or on how much the polygon hides itself; all vertices move, "
                    "lengths are free"},
              s.flow)
      .option("Unfolding",
              Field{"viewing-radius", "mm",
                    "of the viewing circle about the polygon's middle (default: ten times its "
                    "farthest vertex)",
                    kAboveZero},
              s.viewingRadius)
      .option("Unfolding", Field{"resume", "", "continue the run whose outputs are in --out"},
              s.resume)
      .reuseOutputIf(s.resume)
      .option("Output", Field{"frames", "", "write this many states on the way", 0, 100000},
              s.frames)
      .option("Output", Field{"stages", "", "panels of evolution.svg", 1, 1000}, s.stages)
      .needs({"distance"}, {"direction"})
      .output("polygon.csv", FileKind::Polygon, "the polygon as it was understood")
      .output("unfolded.csv", FileKind::Polygon, "the unfolded polygon")
      .output("unfolded.vtp", FileKind::Polygon, "the same with flux and seen share of each edge")
      .varyingOutput("evolution.tsv", FileKind::Table, "one row an iteration")
      .output("evolution.svg", FileKind::Picture,
              "start, stages and end, with the direction of view")
      .output("frames/frame-*.csv", FileKind::Polygon, "states on the way")
      .varyingOutput(kStateFile, FileKind::Any, "what --resume needs")
      .results<planar::PolygonSummary>()
      .results<planar::PolygonUnfoldSummary>()
      .results<planar::GlobalFlowSummary>();
}

/// What is asked for: from FILE and options, or from a phantom where options do not say otherwise.
struct Task {
  planar::Curve curve;
  planar::Region region;
  std::optional<planar::Viewpoints> view;
};

planar::Region regionOf(const planar::Curve& curve, const std::optional<std::string>& text) {
  if (!text) return planar::wholeRegion(curve);
  int first = 0;
  int last = 0;
  int used = 0;
  if (std::sscanf(text->c_str(), "%d:%d%n", &first, &last, &used) != 2 ||
      used != static_cast<int>(text->size())) {
    throw UsageError("--region '" + *text + "': expected I:J, first and last vertex");
  }
  return planar::regionBetween(curve, first, last);
}

planar::Viewpoints inPlane(const visibility::Viewpoints& view) {
  planar::Viewpoints plane{{}, view.weights};
  for (const Point& point : view.points) plane.points.emplace_back(point.head<2>());
  return plane;
}

/// From where to look, if anything was said of it.
std::optional<planar::Viewpoints> viewOf(const Settings& s, const planar::Curve& curve,
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

Task taskOf(Context& context, const Settings& s) {
  if (s.file.has_value() == s.phantom.has_value()) {
    throw UsageError("give FILE or --phantom, one of them");
  }
  Task task;
  if (s.file) {
    task.curve = readCurve(context, "FILE", *s.file, s.reading).curve;
    task.region = regionOf(task.curve, s.region);
    task.view = viewOf(s, task.curve, task.region);
    return task;
  }
  const planar::PolygonPhantom phantom =
      *s.phantom == PhantomPolygon::Polygon19 ? planar::makePolygon19() : planar::makePolygon34();
  task.curve = phantom.curve;
  task.region = s.region ? regionOf(task.curve, s.region)
                         : planar::regionBetween(task.curve, phantom.first, phantom.last);
  task.view = viewOf(s, task.curve, task.region);
  if (!task.view) task.view = phantom.viewpoint;
  return task;
}

std::string tableOf(const std::vector<planar::PolygonIteration>& history) {
  std::string table =
      "iteration\tvisibility\tflux_variance\tlength\tlength_error\tleast_distance\tknot_energy\t"
      "step\tseconds\n";
  for (const planar::PolygonIteration& row : history) {
    char line[320];
    std::snprintf(line, sizeof line, "%d\t%.9g\t%.9g\t%.9g\t%.3g\t%.6g\t%.9g\t%.6g\t%.6f\n",
                  row.iteration, row.visibility, row.variance, row.length, row.lengthError,
                  row.leastDistance, row.knotEnergy, row.step, row.seconds);
    table += line;
  }
  return table;
}

/// The figure of some stages, and the states on the way.
/// @param history  rows with iteration, visibility, variance and length, one a state of `path`
template <class Row>
void writeStages(Context& context, const Settings& s, const std::vector<Row>& history,
                 const std::vector<planar::PolygonState>& path, bool closed,
                 const planar::Viewpoints& view) {
  // Evenly spread in what the run is after: its visibility, or else its length.
  std::vector<double> progress;
  for (const Row& row : history) progress.push_back(s.flow ? row.length : row.visibility);
  std::vector<planar::EvolutionStage> stages;
  for (std::size_t k : planar::evenStages(progress, static_cast<std::size_t>(s.stages))) {
    const Row& row = history[k];
    const std::string title =
        row.iteration == 0 ? "start" : "iteration " + std::to_string(row.iteration);
    stages.push_back(
        {title, path[k].positions, path[k].region, row.visibility, row.variance, row.length});
  }
  writeTextFile(context.output("evolution.svg"), planar::drawEvolution(closed, view, stages));
  std::size_t number = 0;
  for (std::size_t k : planar::evenStages(progress, static_cast<std::size_t>(s.frames))) {
    io::writePolygonCsv(context.output(frameName(number++, ".csv")), path[k].positions);
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

void writeUnfolding(Context& context, const Settings& s, const planar::PolygonUnfolding& result,
                    const planar::Viewpoints& view) {
  io::writePolygonCsv(context.output("unfolded.csv"), result.curve.positions);
  std::vector<io::VertexMap> edgeMaps;
  if (result.curve.closed) {
    edgeMaps = {edgeMap(result.curve, result.region, "flux",
                        planar::polygonVisibility(result.curve, result.region, view).edgeFlux),
                edgeMap(result.curve, result.region, "seen",
                        planar::visiblePart(result.curve, result.region, view).edgeSeen)};
  }
  io::writePolygonVtp(context.output("unfolded.vtp"), result.curve.positions, {}, edgeMaps);
  writeTextFile(context.output("evolution.tsv"), tableOf(result.history));
  writeTextFile(context.output(kStateFile), textOf(result.checkpoint));

  writeStages(context, s, result.history, result.path, result.curve.closed, view);
}

std::string tableOf(const std::vector<planar::GlobalFlowStep>& history) {
  std::string table = "iteration\tmeasure\tvisibility\tflux_variance\tlength\tcrossings\n";
  for (const planar::GlobalFlowStep& row : history) {
    char line[200];
    std::snprintf(line, sizeof line, "%d\t%.9g\t%.9g\t%.9g\t%.9g\t%d\n", row.iteration, row.measure,
                  row.visibility, row.variance, row.length, row.crossings);
    table += line;
  }
  return table;
}

std::vector<double> coordinatesOf(const planar::Viewpoints& view) {
  std::vector<double> all;
  for (const planar::Point2& point : view.points) all.insert(all.end(), point.begin(), point.end());
  return all;
}

/// The flow of a global measure, and what became of the region on the way.
Termination runGlobalFlow(Context& context, const Settings& s, const Task& task) {
  auto step = context.step("descend");
  const StopScope kept(nullptr);  // what is reached is written
  planar::GlobalFlowOptions options;
  options.measure = *s.flow;
  options.viewingRadius = s.viewingRadius;
  if (context.given("max-iterations")) options.maxIterations = s.unfolding.maxIterations;
  const planar::GlobalFlow flow =
      planar::descendGlobalMeasure(task.curve, task.region, *task.view, options, context.monitor());
  const planar::GlobalFlowStep& start = flow.history.front();
  const planar::GlobalFlowStep& end = flow.history.back();
  step.iterations(end.iteration);
  step.termination(flow.termination);
  io::writePolygonCsv(context.output("unfolded.csv"), flow.curve.positions);
  io::writePolygonVtp(context.output("unfolded.vtp"), flow.curve.positions, {}, {});
  writeTextFile(context.output("evolution.tsv"), tableOf(flow.history));
  writeStages(context, s, flow.history, flow.path, true, *task.view);
  context.results(planar::GlobalFlowSummary{coordinatesOf(*task.view), task.view->weights, start,
                                            end, flow.termination});
  return flow.termination;
}

/// Says beforehand how long the exact knot energy takes, which grows with the square of the size.
void sayHowLongUnfoldingIs(Context& context, const Settings& s, const Task& task) {
  constexpr double kSumsPerIteration = 2.5, kPairsPerSecond = 1.2e7;
  if (s.unfolding.noTopology || s.unfolding.knot != planar::PolygonKnot::AllPairs) return;
  const double pairs = kSumsPerIteration * task.region.edgeCount * task.curve.edgeCount();
  if (pairs < kPairsPerSecond) return;
  char text[160];
  std::snprintf(text, sizeof text,
                "knot energy, each iteration: %.2g pairs of edges, about %.0f s on one processor; "
                "--knot auto or tree sums it in n log n",
                pairs, std::ceil(pairs / kPairsPerSecond));
  context.info(text);
}

/// The measures of the whole polygon, whatever the viewpoint.
void reportPolygon(Context& context, const Settings& s, const Task& task) {
  const planar::Curve& curve = task.curve;
  const planar::ViewingCircle circle = planar::viewingCircle(curve, s.viewingRadius);
  context.results(
      planar::PolygonSummary{task.region.edgeCount, planar::lengthOf(curve, task.region),
                             planar::signedArea(curve.positions), planar::selfOcclusion(curve),
                             planar::hiddenViewingArc(curve, circle.centre, circle.radius),
                             circle.radius, planar::intersectingEdges(curve).size()});
}

Termination run(Context& context, const Settings& s) {
  if (s.frames < 0 || s.stages < 1) throw UsageError("--frames and --stages count states");
  const Task task = taskOf(context, s);
  const auto& [curve, region, view] = task;
  std::optional<planar::PolygonCheckpoint> state;
  if (s.resume) {
    if (!view) throw UsageError("--resume needs the viewpoint of the first run");
    state = readState(context.outputFolder() / kStateFile);
  }

  reportPolygon(context, s, task);
  {
    auto step = context.step("polygon");
    io::writePolygonCsv(context.output("polygon.csv"), curve.positions);
  }
  if (s.flow && !view) throw UsageError("--global-flow needs a viewpoint, from which it is judged");
  if (!view) return Termination::NotRun;

  if (s.flow) return runGlobalFlow(context, s, task);
  sayHowLongUnfoldingIs(context, s, task);
  auto step = context.step("unfold");
  const StopScope kept(nullptr);  // what is reached is written
  const planar::PolygonUnfolding result = planar::unfoldPolygon(
      curve, region, *view, s.unfolding, context.monitor(), state ? &*state : nullptr);
  step.iterations(result.history.back().iteration);
  step.termination(result.termination);
  writeUnfolding(context, s, result, *view);

  context.results(planar::PolygonUnfoldSummary{
      coordinatesOf(*view), view->weights, s.unfolding.targetVisibility, !s.unfolding.noLength,
      result.history.front(), result.history.back(), planar::visiblePart(curve, region, *view),
      planar::visiblePart(result.curve, result.region, *view), result.intersectionsFinal.size(),
      result.firstCrossing, result.verticesMerged, result.seconds, result.secondsTopology,
      result.termination});
  return result.termination;
}

}  // namespace

Command polygonCommand() {
  return makeCommand<Settings>("polygon", declare, run);
}

}  // namespace explica::app
