// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "GlobalFlow.h"

#include "Explica/Core/WholeFile.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/Unfolding/Account.h"
#include "Explica/Visibility/SphereView.h"

#include <cstdio>
#include <string>

namespace explica::app {
namespace {

std::string tableOf(const visibility::GlobalFlow& flow) {
  std::string table = "iteration\tmeasure\tarea\tvolume\n";
  for (const visibility::GlobalFlowStep& row : flow.history) {
    char line[160];
    std::snprintf(line, sizeof line, "%d\t%.9g\t%.9g\t%.9g\n", row.iteration, row.measure, row.area,
                  row.volume);
    table += line;
  }
  return table;
}

}  // namespace

Termination runGlobalFlow(Context& context, TriangleMesh mesh, io::SurfaceMetadata metadata,
                          const visibility::GlobalFlowOptions& options, int viewpoints) {
  const bool inward = geometry::enclosedVolume(mesh) < 0;
  if (inward) mesh.faces.col(1).swap(mesh.faces.col(2));
  visibility::GlobalFlow flow;
  {
    auto step = context.step("descend");
    flow = visibility::descendGlobalMeasure(mesh, options, context.monitor());
    step.iterations(flow.history.back().iteration);
    step.termination(flow.termination);
  }
  auto step = context.step("measure and write");
  flow.mesh.positions = unfolding::roundedToSingle(flow.mesh.positions);
  TriangleMesh written = flow.mesh;
  if (inward) written.faces.col(1).swap(written.faces.col(2));
  metadata.topologicalType = "Closed";
  io::writeGiftiSurface(context.output("inflated.surf.gii"), written, metadata);
  writeTextFile(context.output("evolution.tsv"), tableOf(flow));
  const auto before =
      visibility::lookFromSphere(mesh, visibility::enclosingSphere(mesh, viewpoints));
  const auto after =
      visibility::lookFromSphere(flow.mesh, visibility::enclosingSphere(flow.mesh, viewpoints));
  context.results(visibility::GlobalFlowSummary{flow.radius,
                                                flow.history.front(),
                                                flow.history.back(),
                                                {before.visibility, after.visibility},
                                                {before.seenShare, after.seenShare},
                                                geometry::findSelfIntersections(flow.mesh).size(),
                                                flow.termination});
  return flow.termination;
}

}  // namespace explica::app
