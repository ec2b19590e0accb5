// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Folders.h"
#include "Explica/Core/Text.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Pipeline/UnfoldingFolder.h"
#include "Explica/Report/Figure.h"
#include "ReportParts.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace explica::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostFrames = 26;  // in the interactive view: a page stays below 15 MB
constexpr std::size_t kFewFrames = 16;   // where several patches share the page

/// An unfolding's surfaces: where it began, the states on the way, and the region.
struct Unfolded {
  std::optional<TriangleMesh> whole;  ///< the surface that the region is of, if it is still there
  ShownFrames frames;                 ///< from the start to the end
  std::vector<std::int32_t> region;   ///< vertices
  bool detached = false;              ///< the region was unfolded alone
  std::optional<Point> viewpoint;
};

/// Frames of an unfolding, evenly thinned to `most`, the first and last kept.
std::vector<fs::path> fewFrames(const fs::path& folder, std::size_t most) {
  const std::vector<fs::path> all = frameFiles(folder);
  if (all.size() <= most) return all;
  std::vector<fs::path> some;
  for (std::size_t f = 0; f < most; ++f) some.push_back(all[f * (all.size() - 1) / (most - 1)]);
  return some;
}

/// "frame 12, visibility 0.834".
std::string titleOf(const fs::path& frame, const Json& summary) {
  const std::string stem = frame.filename().string();
  std::size_t number = 0;
  try {
    number = std::stoul(stem.substr(6));
  } catch (const std::exception&) {
    return stem;
  }
  std::string title = "frame " + std::to_string(number);
  if (const double visibility = frameVisibility(summary, number); std::isfinite(visibility)) {
    title += printed(", visibility %.3f", visibility);
  }
  return title;
}

Point centreOf(const TriangleMesh& mesh, const std::vector<std::int32_t>& vertices) {
  Point middle = Point::Zero();
  for (const std::int32_t v : vertices) middle += mesh.positions.row(v).transpose();
  return middle / std::max<double>(1, static_cast<double>(vertices.size()));
}

/// As the run says; records of older versions give the direction alone.
std::optional<Point> viewpointOf(const StepFolder& step, const Unfolded& unfolded) {
  const Json options = step.record.value("options", Json::object());
  if (const auto used = pointIn(step.summary, "viewpoint")) return used;
  if (const auto given = pointIn(options, "viewpoint")) return given;
  const auto direction = pointIn(options, "direction");
  if (!direction || !(direction->norm() > 0)) return {};
  return centreOf(unfolded.frames.meshes.front(), unfolded.region) +
         options.value("distance", 1000.0) * direction->normalized();
}

Unfolded readUnfolded(const StepFolder& step, std::size_t mostFrames) {
  Unfolded unfolded;
  unfolded.frames = framesOf(step, "unfolded.surf.gii", mostFrames);
  const TriangleMesh& after = unfolded.frames.meshes.back();
  const auto source = inputOf(step, "SURFACE");
  if (source && isThere(*source)) unfolded.whole = io::readSurface(*source).mesh;
  if (unfolded.whole && unfolded.whole->vertexCount() != after.vertexCount())
    unfolded.whole.reset();
  unfolded.detached = unfolded.whole && unfolded.whole->faceCount() > after.faceCount();
  unfolded.region = unfoldedRegion(step.folder);
  unfolded.viewpoint = viewpointOf(step, unfolded);
  return unfolded;
}

/// The part's faces, and those of the whole that touch no vertex of the part.
Faces withSurroundings(const Faces& part, const TriangleMesh& whole) {
  std::vector<bool> inPart(static_cast<std::size_t>(whole.vertexCount()), false);
  for (const std::int32_t v : part.reshaped()) inPart[v] = true;
  Faces faces(part.rows() + whole.faceCount(), 3);
  faces.topRows(part.rows()) = part;
  Eigen::Index count = part.rows();
  for (Eigen::Index f = 0; f < whole.faceCount(); ++f) {
    if (inPart[whole.faces(f, 0)] || inPart[whole.faces(f, 1)] || inPart[whole.faces(f, 2)])
      continue;
    faces.row(count++) = whole.faces.row(f);
  }
  faces.conservativeResize(count, 3);
  return faces;
}

/// The patch opens on its hemisphere, where the page shows that; else it is shown by itself.
void joinTheBrain(std::vector<report::Evolution>& shown, const std::string& side,
                  report::Evolution patch) {
  const auto brain = std::ranges::find_if(shown, [&](const report::Evolution& one) {
    return !one.shapes.empty() && one.title == side && one.frames.empty() && !patch.detached &&
           one.mesh.faces.rows() == patch.mesh.faces.rows() &&
           one.mesh.vertexCount() == patch.mesh.vertexCount();
  });
  if (brain == shown.end()) {
    shown.push_back(std::move(patch));
    return;
  }
  brain->moved = std::move(patch.moved);
  brain->frames = std::move(patch.frames);
  brain->frameTitles = std::move(patch.frameTitles);
  brain->region = std::move(patch.region);
  brain->viewpoint = patch.viewpoint;
  for (report::EvolutionMap& map : patch.maps) {
    const bool known = std::ranges::any_of(
        brain->maps, [&](const auto& other) { return other.scale.title == map.scale.title; });
    if (!known) brain->maps.push_back(std::move(map));
  }
}

/// Sulci painted on the surface show on the opened patch what was folded; without a curvature the
/// patch itself is coloured.
report::SurfacePaint foldsOf(const Unfolded& unfolded, Eigen::Index vertexCount,
                             const StepFolder* surface) {
  report::SurfacePaint paint;
  paint.region.setZero(vertexCount);
  for (const std::int32_t v : unfolded.region) paint.region[v] = 1;
  const auto curvature = surface != nullptr
                             ? mapNamed(surface->folder / "curvature.shape.gii", vertexCount)
                             : std::nullopt;
  if (curvature) {
    paint.values = curvature->values;
    paint.scale = report::scaleFor(paint.values, curvature->name, curvature->unit,
                                   report::ColourMap::Diverging);
  } else {
    paint.labels = paint.region;
  }
  return paint;
}

/// From the viewpoint, before and after to one scale, filled by the region: beside the verdict.
void glanceAtPatch(ResultFolder& results, const Unfolded& unfolded, const StepFolder* surface,
                   const std::string& side) {
  const std::array meshes = {unfolded.whole ? &*unfolded.whole : &unfolded.frames.meshes.front(),
                             &unfolded.frames.meshes.back()};
  const report::SurfacePaint paint = foldsOf(unfolded, meshes[0]->vertexCount(), surface);
  const bool isSmooth = paint.values.size() > 0;
  report::FigureView front;
  front.towards = (centreOf(*meshes[0], unfolded.region) - *unfolded.viewpoint).normalized();
  front.focus = unfolded.region;
  report::ReportGlance glance{
      kPatchPlace, "Patch" + (side.empty() ? "" : " on the " + side) + " before and after",
      std::string("From the viewpoint, the patch's rim dark: ") +
          (isSmooth ? "gyri blue, sulci brown." : "the patch coloured, its surroundings pale.") +
          (unfolded.detached ? " It was unfolded alone, and is drawn apart from the surface."
                             : "") +
          " Right: the sulci's floors face the reader, the rim joins the surroundings. Wrong: "
          "sulci still folded, a torn or twisted rim. Then: more iterations or a smaller patch."};
  const report::SurfacePictureOptions size{.width = 360, .height = 280};
  std::array<report::Camera, 2> cameras;
  double half = 0;
  for (std::size_t n = 0; n < meshes.size(); ++n) {
    cameras[n] = report::cameraOf(meshes[n]->positions, front, size.width, size.height);
    half = std::max(half, cameras[n].halfHeight);
  }
  const auto colours = report::coloursOf(paint, meshes[0]->vertexCount());
  const std::vector<std::int32_t> rim(paint.region.begin(), paint.region.end());
  const auto filling = isSmooth ? report::Filling::Smooth : report::Filling::Discrete;
  for (std::size_t n = 0; n < meshes.size(); ++n) {
    cameras[n].halfHeight = half;
    glance.views.emplace_back(
        n == 0 ? "before" : "after",
        report::SurfaceScene(*meshes[n]).render(cameras[n], colours, filling, size, rim));
  }
  if (isSmooth) glance.scale = paint.scale;
  results.content().glance.push_back(std::move(glance));
}

}  // namespace

ShownFrames framesOf(const StepFolder& step, const std::string& end, std::size_t most) {
  ShownFrames frames;
  for (const fs::path& file : fewFrames(step.folder, most)) {
    frames.meshes.push_back(io::readSurface(file).mesh);
    frames.titles.push_back(titleOf(file, step.summary));
  }
  if (!frames.meshes.empty() || end.empty()) return frames;
  const TriangleMesh after = io::readSurface(step.folder / end).mesh;
  const auto source = inputOf(step, "SURFACE");
  if (source && isThere(*source)) {
    TriangleMesh before = io::readSurface(*source).mesh;
    if (before.vertexCount() == after.vertexCount()) {
      frames.meshes.push_back({std::move(before.positions), after.faces});
      frames.titles.emplace_back("before");
    }
  }
  frames.meshes.push_back(after);
  frames.titles.emplace_back("after");
  return frames;
}

void addMaps(report::Evolution& evolution, const fs::path& file,
             const std::vector<std::int32_t>& region) {
  if (!isThere(file)) return;
  for (const io::VertexMap& map : io::readVertexMaps(file, evolution.mesh.vertexCount())) {
    Eigen::VectorXd known = map.values;
    if (!region.empty()) known.setConstant(kNaN);
    for (const std::int32_t v : region) known[v] = map.values[v];
    evolution.maps.push_back({known, report::scaleFor(known, mapWords(map.name), map.unit)});
  }
}

void showUnfolding(ResultFolder& results, const StepFolder& step,
                   const std::vector<GivenMap>& maps) {
  const std::size_t patches = results.stepsOf("unfold").size();
  const Unfolded unfolded = readUnfolded(step, patches > 1 ? kFewFrames : kMostFrames);
  report::Evolution evolution = report::evolutionOf(unfolded.frames.meshes);
  evolution.frameTitles = unfolded.frames.titles;
  evolution.region = unfolded.region;
  evolution.detached = unfolded.detached;
  evolution.viewpoint = unfolded.viewpoint;
  if (unfolded.detached) {
    evolution.mesh.faces = withSurroundings(evolution.mesh.faces, *unfolded.whole);
    evolution.mesh.positions = unfolded.whole->positions;
  }
  results.attempt("Maps of the unfolding", [&] {
    addMaps(evolution, step.folder / "visibility.shape.gii", unfolded.region);
    addMaps(evolution, step.folder / "distortion.shape.gii", unfolded.region);
  });
  addGiven(evolution, step.side(), maps);
  if (!unfolded.region.empty() && unfolded.viewpoint) {
    results.attempt("Before and after", [&] {
      glanceAtPatch(results, unfolded, results.beside(step, "surface"), step.side());
    });
  }
  evolution.title = titleOf(step.name);
  joinTheBrain(results.content().evolutions, step.side(), std::move(evolution));
}

void showInflation(ResultFolder& results, const StepFolder& step) {
  const ShownFrames frames = framesOf(step, "inflated.surf.gii");
  report::Evolution evolution = report::evolutionOf(frames.meshes);
  evolution.title = titleOf(step.name);
  evolution.frameTitles = frames.titles;
  results.attempt("Maps of the inflation", [&] {
    addMaps(evolution, step.folder / "visibility.shape.gii");
    addMaps(evolution, step.folder / "distortion.shape.gii");
  });
  results.content().evolutions.push_back(std::move(evolution));
}

}  // namespace explica::pipeline
