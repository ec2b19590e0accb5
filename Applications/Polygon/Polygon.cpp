// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/ReadPolygon.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/IO/PolygonFile.h"
#include "Explica/Planar/AngularSweep.h"
#include "Explica/Planar/EvolutionFigure.h"
#include "Explica/Planar/PolygonMeasures.h"
#include "Explica/Planar/PolygonPhantoms.h"
#include "Explica/Planar/PolygonUnfolding.h"
#include "Explica/Planar/PolygonVisibility.h"
#include "Explica/Visibility/Viewpoints.h"
#include "State.h"

#include <nlohmann/json.hpp>

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
  std::optional<Eigen::Vector2d> viewpoint;
  std::optional<Eigen::Vector2d> direction;
  double distance = 1000;
  std::vector<double> line;
  planar::PolygonUnfoldingOptions unfolding;
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
      .example("explica polygon ED_label.nii.gz --label 2 --slice 4 --out contour",
               "Outer contour of a label, RAS mm")
      .input("FILE", FileKind::Any, "polygon (CSV, VTK polydata), or label image", s.file)
      .option("Contour",
              Field{"phantom", "", "instead of FILE: a phantom with its region and viewpoint"},
              s.phantom);
  declarePolygonReading(d, s.reading);
  d.option("Region", Field{"region", "", "first and last vertex, I:J; default: the whole polygon"},
           s.region)
      .option("Viewpoint", Field{"viewpoint", "mm", "point to look from"}, s.viewpoint)
      .option("Viewpoint",
              Field{"direction", "", "look from the region's centroid plus --distance along this"},
              s.direction)
      .option("Viewpoint",
              Field{"distance", "mm", "how far off a viewpoint given by --direction is"},
              s.distance)
      .option("Viewpoint",
              Field{"view-line", "mm", "look from all points of the line X,Y,X,Y between two"},
              s.line)
      .options("Unfolding", s.unfolding)
      .option("Unfolding", Field{"resume", "", "continue the run whose outputs are in --out"},
              s.resume)
      .reuseOutputIf(s.resume)
      .option("Output", Field{"frames", "", "write this many states on the way"}, s.frames)
      .option("Output", Field{"stages", "", "panels of evolution.svg"}, s.stages)
      .output("polygon.csv", FileKind::Polygon, "the polygon as it was understood")
      .output("unfolded.csv", FileKind::Polygon, "the unfolded polygon")
      .output("unfolded.vtp", FileKind::Polygon, "the same with flux and seen share of each edge")
      .varyingOutput("evolution.tsv", FileKind::Table, "one row an iteration")
      .output("evolution.svg", FileKind::Picture,
              "start, stages and end, with the direction of view")
      .output("frames/frame-*.csv", FileKind::Polygon, "states on the way")
      .varyingOutput(kStateFile, FileKind::Any, "what --resume needs");
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

/// From where to look, if anything was said of it.
std::optional<planar::Viewpoints> viewOf(const Settings& s, const planar::Curve& curve,
                                         const planar::Region& region) {
  const int given =
      int{s.viewpoint.has_value()} + int{s.direction.has_value()} + int{!s.line.empty()};
  if (given == 0) return std::nullopt;
  if (given > 1) throw UsageError("give one of --viewpoint, --direction and --view-line");
  if (s.viewpoint) return *s.viewpoint;
  if (!s.line.empty()) {
    if (s.line.size() != 4) throw UsageError("--view-line needs four numbers X,Y,X,Y");
    const auto rule =
        visibility::viewLine(Point(s.line[0], s.line[1], 0), Point(s.line[2], s.line[3], 0));
    planar::Viewpoints view{{}, rule.weights};
    for (const Point& point : rule.points) view.points.emplace_back(point.head<2>());
    return view;
  }
  if (!(s.direction->norm() > 0)) throw UsageError("--direction has no length");
  return planar::Point2(planar::centroidOf(curve, region) + s.distance * s.direction->normalized());
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

  std::vector<double> visibilities;
  for (const auto& row : result.history) visibilities.push_back(row.visibility);
  std::vector<planar::EvolutionStage> stages;
  for (std::size_t k : planar::evenStages(visibilities, static_cast<std::size_t>(s.stages))) {
    const planar::PolygonIteration& row = result.history[k];
    const std::string title =
        row.iteration == 0 ? "start" : "iteration " + std::to_string(row.iteration);
    stages.push_back({title, result.path[k].positions, result.path[k].region, row.visibility,
                      row.variance, row.length});
  }
  writeTextFile(context.output("evolution.svg"),
                planar::drawEvolution(result.curve.closed, view, stages));
  std::size_t number = 0;
  for (std::size_t k : planar::evenStages(visibilities, static_cast<std::size_t>(s.frames))) {
    io::writePolygonCsv(context.output(frameName(number++, ".csv")), result.path[k].positions);
  }
}

Termination run(Context& context, const Settings& s) {
  if (s.frames < 0 || s.stages < 1) throw UsageError("--frames and --stages count states");
  const auto& [curve, region, view] = taskOf(context, s);
  std::optional<planar::PolygonCheckpoint> state;
  if (s.resume) {
    if (!view) throw UsageError("--resume needs the viewpoint of the first run");
    state = readState(context.outputFolder() / kStateFile);
  }

  context.result("region_edges", region.edgeCount);
  context.result("length_initial", planar::lengthOf(curve, region));
  context.result("area", planar::signedArea(curve.positions));
  context.result("self_occlusion", planar::selfOcclusion(curve));
  context.result("self_intersections_initial", planar::intersectingEdges(curve).size());
  {
    auto step = context.step("polygon");
    io::writePolygonCsv(context.output("polygon.csv"), curve.positions);
  }
  if (!view) return Termination::NotRun;

  auto step = context.step("unfold");
  if (view->points.size() == 1) {
    const planar::Point2& point = view->points.front();
    context.result("viewpoint", std::vector<double>{point.x(), point.y()});
  }
  const planar::PolygonUnfolding result = planar::unfoldPolygon(
      curve, region, *view, s.unfolding, context.monitor(), state ? &*state : nullptr);
  const planar::PolygonIteration& start = result.history.front();
  const planar::PolygonIteration& end = result.history.back();
  step.iterations(end.iteration);
  step.termination(result.termination);
  writeUnfolding(context, s, result, *view);

  context.result("length_final", end.length);
  context.result("length_error_max", s.unfolding.noLength ? kNaN : end.lengthError);
  context.result("visibility_initial", start.visibility);
  context.result("visibility_final", end.visibility);
  context.result("flux_variance_initial", start.variance);
  context.result("flux_variance_final", end.variance);
  context.result("seen_initial", planar::visiblePart(curve, region, *view).fraction);
  context.result("seen_final", planar::visiblePart(result.curve, result.region, *view).fraction);
  context.result("self_intersections_final", result.intersectionsFinal.size());
  context.result("first_crossing", result.firstCrossing);
  context.result("vertices_merged", result.verticesMerged);
  context.result("iterations", end.iteration);
  context.result("seconds", result.seconds);
  context.result("seconds_topology", result.secondsTopology);
  context.result("stop_reason", std::string(nameOf(result.termination)));
  return result.termination;
}

}  // namespace

Command polygonCommand() {
  return makeCommand<Settings>("polygon", declare, run);
}

}  // namespace explica::app
