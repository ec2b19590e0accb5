// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Report/Figure.h"
#include "ReportParts.h"

namespace explica::pipeline {
namespace {

/// An inflation's surfaces, from the first to the last.
ShownFrames readInflated(const StepFolder& step) {
  ShownFrames frames = framesOf(step);
  if (!frames.meshes.empty()) return frames;
  const TriangleMesh after = io::readSurface(step.folder / "inflated.surf.gii").mesh;
  const auto source = inputOf(step, "SURFACE");
  if (source && std::filesystem::exists(*source)) {
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

void addMaps(const StepFolder& step, report::Evolution& evolution) {
  for (const char* file : {"visibility.shape.gii", "distortion.shape.gii"}) {
    if (!step.has(file)) continue;
    for (const io::VertexMap& map :
         io::readVertexMaps(step.folder / file, evolution.mesh.vertexCount())) {
      evolution.maps.push_back({map.values, report::scaleFor(map.values, map.name, map.unit)});
    }
  }
}

/// Before and after from both sides.  What each place saw at the start colours both, so that what
/// was folded away shows dark on the open surface.
void drawBeforeAndAfter(ResultFolder& results, const StepFolder& step, const ShownFrames& frames) {
  const auto count = frames.meshes.front().vertexCount();
  const auto share = mapNamed(step.folder / "visibility.shape.gii", count, "visibility before");
  report::SurfacePaint paint;
  if (share) {
    paint.values = share->values;
    paint.scale = {report::ColourMap::Grey, 0, 1, "view that arrived", ""};
  }
  const std::vector<report::Colour> colours = report::coloursOf(paint, count);
  report::SurfacePictureOptions size{.width = 520, .height = 400};
  report::ReportViews views;
  views.id = kPatchViewsPlace;
  views.title = "The surface before and after";
  views.caption =
      "From the left and from the right, with the same colours: dark is what saw little of its "
      "surroundings before, as the banks and bottoms of folds do.";
  for (const bool first : {true, false}) {
    const TriangleMesh& shown = first ? frames.meshes.front() : frames.meshes.back();
    const report::SurfaceScene scene(shown);
    for (const report::ViewName side : {report::ViewName::Left, report::ViewName::Right}) {
      report::FigureView view;
      view.name = side;
      views.views.push_back({std::string(first ? "before" : "after") +
                                 (side == report::ViewName::Left ? ", left" : ", right"),
                             scene.render(report::cameraOf(shown, view, size.width, size.height),
                                          colours, report::Filling::Smooth, size)});
    }
  }
  if (share) views.scale = paint.scale;
  results.content().views.push_back(std::move(views));
}

}  // namespace

void showInflation(ResultFolder& results, const StepFolder& step) {
  const ShownFrames frames = readInflated(step);
  report::Evolution evolution = report::evolutionOf(frames.meshes);
  evolution.frameTitles = frames.titles;
  results.attempt("Maps of the inflation", [&] { addMaps(step, evolution); });
  results.attempt("Before and after", [&] { drawBeforeAndAfter(results, step, frames); });
  // One film a page: of several the first.
  evolution.title = titleOf(step.name);
  results.content().evolutions.push_back(std::move(evolution));
}

}  // namespace explica::pipeline
