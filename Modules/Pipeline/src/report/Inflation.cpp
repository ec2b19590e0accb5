// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Folders.h"
#include "Explica/IO/SurfaceFile.h"
#include "ReportParts.h"

namespace explica::pipeline {
namespace {

/// An inflation's surfaces, from the first to the last.
ShownFrames readInflated(const StepFolder& step) {
  ShownFrames frames = framesOf(step);
  if (!frames.meshes.empty()) return frames;
  const TriangleMesh after = io::readSurface(step.folder / "inflated.surf.gii").mesh;
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

void addMaps(const StepFolder& step, report::Evolution& evolution) {
  for (const char* file : {"visibility.shape.gii", "distortion.shape.gii"}) {
    if (!step.has(file)) continue;
    for (const io::VertexMap& map :
         io::readVertexMaps(step.folder / file, evolution.mesh.vertexCount())) {
      evolution.maps.push_back({map.values, report::scaleFor(map.values, map.name, map.unit)});
    }
  }
}

}  // namespace

void showInflation(ResultFolder& results, const StepFolder& step) {
  const ShownFrames frames = readInflated(step);
  report::Evolution evolution = report::evolutionOf(frames.meshes);
  evolution.frameTitles = frames.titles;
  results.attempt("Maps of the inflation", [&] { addMaps(step, evolution); });
  // One film a page: of several the first.
  evolution.title = titleOf(step.name);
  results.content().evolutions.push_back(std::move(evolution));
}

}  // namespace explica::pipeline
