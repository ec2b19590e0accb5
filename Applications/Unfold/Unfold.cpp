// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/Unfold.h"
#include "Explica/Application/Command.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Collision/Untangling.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VtkFile.h"
#include "Explica/Unfolding/Account.h"
#include "Explica/Unfolding/Distortion.h"
#include "Explica/Unfolding/Region.h"
#include "Explica/Visibility/AverageVisibility.h"
#include "Explica/Visibility/VisibleFraction.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>

namespace explica::app {
namespace {

constexpr char kStateFile[] = "unfolding.state";

struct ViewSettings {
  std::optional<Eigen::Vector3d> viewpoint;
  std::optional<Eigen::Vector3d> direction;
  double distance = 1000;
  std::vector<double> line;
};

template <class Visitor>
void describe(ViewSettings& view, Visitor&& visit) {
  visit(Field{"viewpoint", "mm", "point to look from"}, view.viewpoint);
  visit(Field{"direction", "", "look from the region's centroid plus --distance along this"},
        view.direction);
  visit(Field{"distance", "mm", "how far off a viewpoint given by --direction is"}, view.distance);
  visit(Field{"view-line", "mm", "look from a segment: X,Y,Z of its start and of its end"},
        view.line);
}

struct Settings {
  std::string surface;
  io::SurfaceReadOptions reading;
  ViewSettings view;
  std::optional<std::string> viewSurface;
  unfolding::RegionOptions region;
  std::optional<std::string> label;
  std::optional<int> labelKey;
  bool adjustRegion = false;
  bool repair = false;
  unfolding::UnfoldOptions unfold;
  bool resume = false;
};

void declare(Declaration& d, Settings& s) {
  d.synopsis("a region of a folded surface opened towards a viewpoint, areas kept")
      .description(
          "Maximises the average visibility of the region: the mean cosine under which its faces "
          "look at "
          "the viewpoint. Face areas are kept, edges keep their lengths as well as they can, and "
          "no "
          "step "
          "lets the surface pass through itself. A run can be stopped at any time and continued "
          "with "
          "--resume into the same --out.")
      .reference(
          "Lopez Perez 2010, Two- and three-dimensional annular tissues and unfolding, thesis")
      .example(
          "explica unfold pial.surf.gii --center -60,10,20 --radius 25 --direction -1,0.2,0.2 "
          "--out "
          "unfolded",
          "A patch of 25 mm about a point, seen from its side")
      .input("SURFACE", FileKind::Surface, "triangulated surface", s.surface)
      .options("Reading", s.reading)
      .options("View", s.view)
      .inputOption("view-surface", FileKind::Surface, "look from all points of this surface",
                   s.viewSurface, "View")
      .options("Region", s.region)
      .inputOption("label", FileKind::VertexLabel, "the region is where this label is not 0",
                   s.label, "Region")
      .option("Region", Field{"label-key", "", "the region is where --label has this key"},
              s.labelKey)
      .option(
          "Region",
          Field{"adjust-region", "", "grow or shrink the region until its visibility is positive"},
          s.adjustRegion)
      .option("Unfolding",
              Field{"repair", "",
                    "part faces that intersect at the start, by small moves where that goes; the "
                    "result is compared with the surface so repaired"},
              s.repair)
      .options("Unfolding", s.unfold)
      .option("Unfolding", Field{"resume", "", "continue the run whose outputs are in --out"},
              s.resume)
      .reuseOutputIf(s.resume)
      .output("unfolded.surf.gii", FileKind::Surface, "the surface with its region unfolded")
      .output("unfolded.vtp", FileKind::Surface, "the same with all values of vertices and faces")
      .output("region.label.gii", FileKind::VertexLabel, "1 in the region")
      .output("visibility.shape.gii", FileKind::VertexData,
              "flux before, flux after, seen before, seen after")
      .output("distortion.shape.gii", FileKind::VertexData,
              "area ratio, angle change in degrees, edge strain")
      .varyingOutput("evolution.tsv", FileKind::Table, "one row per iteration")
      .output("intersections.tsv", FileKind::Table,
              "pairs of faces that intersect at the start, where, and whether --repair parted them")
      .output("frames/frame-*.surf.gii", FileKind::Surface, "--frames states on the way")
      .varyingOutput(kStateFile, FileKind::Any, "what --resume needs");
}

visibility::Viewpoints viewOf(Context& context, const Settings& s, const Point& about) {
  const int given = s.view.viewpoint.has_value() + s.view.direction.has_value() +
                    !s.view.line.empty() + s.viewSurface.has_value();
  (void)context;
  if (given != 1) {
    throw InvalidInput(
        "viewpoint: give exactly one of --viewpoint, --direction, --view-line and --view-surface");
  }
  if (s.view.viewpoint) return visibility::viewpoint(*s.view.viewpoint);
  if (s.view.direction) {
    const double length = s.view.direction->norm();
    if (!(length > 0)) throw InvalidInput("direction: has no length");
    if (!(s.view.distance > 0)) throw InvalidInput("distance: must be positive");
    return visibility::viewpoint(about + s.view.distance / length * *s.view.direction);
  }
  if (!s.view.line.empty()) {
    if (s.view.line.size() != 6) throw InvalidInput("view-line: needs six numbers X,Y,Z,X,Y,Z");
    return visibility::viewLine(Point(s.view.line[0], s.view.line[1], s.view.line[2]),
                                Point(s.view.line[3], s.view.line[4], s.view.line[5]));
  }
  return visibility::viewSurface(io::readSurface(*s.viewSurface, s.reading).mesh);
}

unfolding::Region regionOf(const TriangleMesh& mesh, const Settings& s,
                           const visibility::Viewpoints* view) {
  if (!s.label) return unfolding::selectRegion(mesh, s.region, view);
  const auto labels = io::readVertexLabels(*s.label, mesh.vertexCount());
  std::vector<bool> marked(static_cast<std::size_t>(mesh.vertexCount()));
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    marked[v] = s.labelKey ? labels.keys[v] == *s.labelKey : labels.keys[v] != 0;
  }
  if (std::find(marked.begin(), marked.end(), true) == marked.end()) {
    throw InvalidInput(s.labelKey ? "label: no vertex has key " + std::to_string(*s.labelKey) +
                                        ", keys go from " + std::to_string(labels.keys.minCoeff()) +
                                        " to " + std::to_string(labels.keys.maxCoeff())
                                  : "label: it is 0 everywhere, so the region is empty");
  }
  return unfolding::regionOfMarked(mesh, marked);
}

/// Lists the start's intersections and parts them in `mesh` if that is asked for.
void checkStart(Context& context, const Settings& s, const unfolding::Region& region,
                TriangleMesh& mesh) {
  collision::Untangling repair;
  if (s.repair) {
    auto step = context.step("repair");
    repair = collision::untangle(mesh);
  } else {
    auto step = context.step("check");
    repair.before = repair.after = geometry::findSelfIntersections(mesh);
  }
  const auto list = unfolding::listCrossings(mesh, repair.before, repair.after, region);
  writeTextFile(context.output("intersections.tsv"), unfolding::crossingTable(mesh, list));
  std::size_t inRegion = 0;
  for (const unfolding::Crossing& c : list) inRegion += c.facesInRegion > 0;

  context.result("self_intersections_initial", list.size());
  context.result("self_intersections_initial_region", inRegion);
  context.result("self_intersections_file", "intersections.tsv");
  if (s.repair) {
    context.result("self_intersections_repaired", repair.before.size() - repair.after.size());
    context.result("repair_vertices_moved", repair.moved.size());
    context.result("repair_move_max", repair.moveMax);
    context.result("repair_move_mean", repair.moveMean);
  }
  if (list.empty()) return;
  const unfolding::Crossing& first = list.front();
  char text[320];
  std::snprintf(
      text, sizeof text,
      "%zu pairs of faces intersect at the start, %zu of them in the region (faces %d and "
      "%d near %.2f, %.2f, %.2f, ...; all in intersections.tsv)",
      list.size(), inRegion, first.faces[0], first.faces[1], first.place[0], first.place[1],
      first.place[2]);
  std::string message = text;
  if (!s.repair) {
    message += "; they stay as they are, or are parted first by --repair";
  } else {
    std::snprintf(text, sizeof text,
                  "; %zu were parted by moving %zu vertices by %.3f mm on average and %.3f mm at "
                  "most%s",
                  repair.before.size() - repair.after.size(), repair.moved.size(), repair.moveMean,
                  repair.moveMax, repair.after.empty() ? "" : ", the others stay as they are");
    message += text;
    mesh.positions = repair.positions;
  }
  context.warn(message);
}

Termination run(Context& context, const Settings& s) {
  const auto begin = std::chrono::steady_clock::now();
  const auto elapsed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  const io::LoadedSurface loaded = readSurface(context, "SURFACE", s.surface, s.reading);
  TriangleMesh mesh = loaded.mesh;
  const auto condition = geometry::requireManifold(mesh, s.surface);
  if (condition.coincidentVertices > 0) {
    context.warn(std::to_string(condition.coincidentVertices) +
                 " vertices lie exactly on others: the surface touches itself there");
  }

  visibility::Viewpoints view;
  unfolding::Region region;
  if (s.region.cone) {
    // A cone needs the view first: a direction then counts from the centre.
    unfolding::RegionOptions centre = s.region;
    centre.cone.reset();
    const unfolding::Region ball = unfolding::selectRegion(mesh, centre);
    view = viewOf(context, s, mesh.positions.row(ball.centre).transpose());
    region = regionOf(mesh, s, &view);
  } else {
    region = regionOf(mesh, s, nullptr);
    view = viewOf(context, s, unfolding::centroidOf(mesh, region));
  }
  unfolding::requireViewFromOutside(mesh, view);
  if (s.adjustRegion) {
    const std::size_t before = region.faces.size();
    region = unfolding::adjustRegion(mesh, region, s.region, view);
    if (region.faces.size() != before) {
      context.warn("the region was adjusted from " + std::to_string(before) + " to " +
                   std::to_string(region.faces.size()) + " faces");
    }
  }
  if (region.pieces > 1) {
    context.warn("the region has " + std::to_string(region.pieces) +
                 " pieces; each unfolds on its own");
  }
  if (region.holes > 0) {
    context.warn("the region has " + std::to_string(region.holes) + " holes; they stay open");
  }
  std::optional<unfolding::Checkpoint> checkpoint;
  if (s.resume) checkpoint = unfolding::readCheckpoint(context.outputFolder() / kStateFile);

  sayHowRead(context, loaded.origin);

  checkStart(context, s, region, mesh);
  const double started = elapsed();

  unfolding::UnfoldResult result;
  {
    auto step = context.step("unfold");
    result = unfolding::unfold(mesh, region, view, s.unfold, context.monitor(),
                               checkpoint ? &*checkpoint : nullptr);
    step.iterations(result.history.back().iteration);
    step.termination(result.termination);
  }

  const double unfolded = elapsed();
  auto step = context.step("measure and write");
  TriangleMesh& after = result.mesh;
  after.positions = unfolding::roundedToSingle(after.positions);
  const TriangleMesh before{mesh.positions, after.faces};
  const auto& faces = result.region.faces;
  const auto distortion = unfolding::measureDistortion(before, after.positions, faces);
  const auto seenBefore = visibility::visibleFraction(mesh, view);
  const auto seenAfter = visibility::visibleFraction(after, view);
  const auto crossingsAfter = geometry::findSelfIntersections(after);

  const std::string structure = loaded.metadata.structure;
  io::SurfaceMetadata metadata = loaded.metadata;
  metadata.topologicalType.clear();
  metadata.geometricType = "Inflated";  // Workbench's nearest word: no place in the head any more
  io::writeGiftiSurface(context.output("unfolded.surf.gii"), after, metadata);

  const std::vector<io::VertexMap> visibilityMaps = {
      {"flux before", "", visibility::vertexFlux(mesh, view)},
      {"flux after", "", visibility::vertexFlux(after, view)},
      {"seen before", "", seenBefore.vertex},
      {"seen after", "", seenAfter.vertex}};
  io::writeGiftiShape(context.output("visibility.shape.gii"), visibilityMaps, structure);
  const Eigen::VectorXd angleDeg = distortion.angleErrorRad * (180 / kPi);
  const std::vector<io::VertexMap> distortionMaps = {
      {"area ratio", "", unfolding::vertexMeans(before, faces, distortion.areaRatio, 1)},
      {"angle change", "degrees", unfolding::vertexMeans(before, faces, angleDeg, 0)},
      {"edge strain", "", unfolding::vertexStrains(before, after.positions, faces)}};
  io::writeGiftiShape(context.output("distortion.shape.gii"), distortionMaps, structure);

  io::LabelMap label{
      "region",
      {},
      {{0, "surroundings", {0.7F, 0.7F, 0.7F, 1}}, {1, "region", {0.3F, 0.5F, 0.9F, 1}}}};
  label.keys.setZero(mesh.vertexCount());
  for (const std::int32_t v : result.region.vertices) label.keys[v] = 1;
  io::writeGiftiLabel(context.output("region.label.gii"), label, structure);

  std::vector<io::VertexMap> allVertexMaps = visibilityMaps;
  allVertexMaps.insert(allVertexMaps.end(), distortionMaps.begin(), distortionMaps.end());
  allVertexMaps.push_back({"region", "", label.keys.cast<double>()});
  Eigen::VectorXd areaRatio = Eigen::VectorXd::Ones(after.faceCount());
  Eigen::VectorXd angleChange = Eigen::VectorXd::Zero(after.faceCount());
  Eigen::VectorXd faceSeenBefore = seenBefore.face;
  if (after.faceCount() != mesh.faceCount()) {  // the region alone
    faceSeenBefore.resize(after.faceCount());
    for (std::size_t n = 0; n < faces.size(); ++n) {
      faceSeenBefore[faces[n]] = seenBefore.face[region.faces[n]];
    }
  }
  for (std::size_t n = 0; n < faces.size(); ++n) {
    areaRatio[faces[n]] = distortion.areaRatio[static_cast<Eigen::Index>(n)];
    angleChange[faces[n]] = angleDeg[static_cast<Eigen::Index>(n)];
  }
  io::writeVtp(context.output("unfolded.vtp"), after, allVertexMaps,
               {{"area ratio", "", areaRatio},
                {"angle change", "degrees", angleChange},
                {"seen before", "", faceSeenBefore},
                {"seen after", "", seenAfter.face}});
  writeTextFile(context.output("evolution.tsv"), unfolding::evolutionTable(result.history));
  unfolding::writeCheckpoint(context.output(kStateFile), result.checkpoint);

  std::size_t worstFrame = 0;
  std::vector<double> frameVisibilities;
  for (std::size_t n = 0; n < result.frames.size(); ++n) {
    const TriangleMesh frame{unfolding::roundedToSingle(result.frames[n].positions), after.faces};
    worstFrame = std::max(worstFrame, geometry::findSelfIntersections(frame).size());
    frameVisibilities.push_back(result.frames[n].visibility);
    char name[64];
    std::snprintf(name, sizeof name, "frames/frame-%04zu.surf.gii", n);
    io::writeGiftiSurface(context.output(name), frame, metadata);
  }

  const auto& first = result.history.front();
  const auto& last = result.history.back();
  context.result("region_faces", faces.size());
  context.result("region_vertices", result.region.vertices.size());
  context.result("region_pieces", result.region.pieces);
  context.result("region_holes", result.region.holes);
  context.result("region_area", geometry::totalArea(geometry::extractFaces(before, faces).mesh));
  context.result("visibility_initial", first.visibility);
  context.result("visibility_final",
                 visibility::AverageVisibility(after.faces, faces, view).value(after.positions));
  context.result("seen_initial", seenBefore.of(mesh, region.faces));
  context.result("seen_final", seenAfter.of(after, faces));
  context.result("backfacing_initial", unfolding::backfacingShare(before, faces, view));
  context.result("backfacing_final", unfolding::backfacingShare(after, faces, view));
  context.result("area_error_mean", distortion.areaErrorMean);
  context.result("area_error_max", distortion.areaErrorMax);
  context.result("angle_error_mean_deg", distortion.angleErrorMeanRad * 180 / kPi);
  context.result("edge_strain_mean", distortion.edgeStrainMean);
  context.result("edge_strain_p95", distortion.edgeStrainP95);
  context.result("geodesic_error_mean", distortion.geodesicErrorMean);
  context.result("self_intersections_final", crossingsAfter.size());
  if (!result.frames.empty()) {
    context.result("frame_visibilities", frameVisibilities);
    context.result("self_intersections_frames_max", worstFrame);
  }
  context.result("iterations", last.iteration);
  unfolding::PhaseSeconds phases;
  for (const unfolding::IterationRecord& row : result.history) phases += row.phases;
  context.result("seconds", elapsed());
  context.result("seconds_start", started);
  context.result("seconds_visibility", phases.visibility);
  context.result("seconds_repulsion", phases.repulsion);
  context.result("seconds_collision", phases.collision);
  context.result("seconds_solve", phases.solve);
  context.result("seconds_output", elapsed() - unfolded);
  context.result("seconds_per_iteration", last.iteration > 0 ? last.seconds / last.iteration : 0);
  context.result("stop_reason", std::string(nameOf(result.termination)));
  return result.termination;
}

}  // namespace

Command unfoldCommand() {
  return makeCommand<Settings>("unfold", declare, run);
}

}  // namespace explica::app
