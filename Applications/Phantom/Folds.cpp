// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Phantom/FoldedSheet.h"

#include <nlohmann/json.hpp>

namespace explica::app {
namespace {

struct PhantomFoldsSettings {
  phantom::FoldedSheetOptions sheet;
};

void declare(Declaration& d, PhantomFoldsSettings& s) {
  d.synopsis("sheet in overhanging folds that hide each other, with a region to unfold")
      .description(
          R"(A sheet whose folds overhang and wind to and fro. Seen along --direction 0,0,1 of 'explica unfold' a fifth of its area is visible on average, and unfolded nearly all of it: without winding it can be laid flat with every length kept.)")
      .example("explica phantom folds --out folds",
               "Then: explica unfold folds/folds.surf.gii --label folds/region.label.gii "
               "--direction 0,0,1 --out open")
      .options("Sheet", s.sheet)
      .output("folds.surf.gii", FileKind::Surface, "the sheet")
      .output("region.label.gii", FileKind::VertexLabel, "1 where it is to be unfolded");
}

Termination run(Context& context, const PhantomFoldsSettings& s) {
  auto step = context.step("generate");
  const phantom::FoldedSheet sheet = phantom::makeFoldedSheet(s.sheet);
  io::writeGiftiSurface(context.output("folds.surf.gii"), sheet.mesh);
  io::LabelMap label{
      "region",
      {},
      {{0, "surroundings", {0.7F, 0.7F, 0.7F, 1}}, {1, "region", {0.3F, 0.5F, 0.9F, 1}}}};
  label.keys.setZero(sheet.mesh.vertexCount());
  for (const std::int32_t v : sheet.region) label.keys[v] = 1;
  io::writeGiftiLabel(context.output("region.label.gii"), label, {});
  context.result("faces", static_cast<std::size_t>(sheet.mesh.faceCount()));
  context.result("region_vertices", sheet.region.size());
  context.result("direction", std::vector<double>{0, 0, 1});
  context.result("labels", nlohmann::ordered_json{{"region", 1}});
  return Termination::NotRun;
}

}  // namespace

Command phantomFoldsCommand() {
  return makeCommand<PhantomFoldsSettings>("phantom folds", declare, run);
}

}  // namespace explica::app
