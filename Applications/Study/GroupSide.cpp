// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/CortexTemplate.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Text.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Maps/Folding.h"
#include "Explica/Maps/Icosphere.h"
#include "Explica/Maps/Resampling.h"
#include "Explica/Provenance/Json.h"
#include "Explica/Provenance/Record.h"
#include "Explica/Report/Figure.h"
#include "GroupParts.h"

#include <algorithm>

namespace explica::app {
namespace {

using provenance::Json;
using statistics::GroupMaps;

/// The template's middle surface and regions at the maps' vertices; none where it has none.
void readTemplate(Context& context, const Member& member, GroupSide& side) {
  int level = 0;
  while (level < 7 && 10 * (Eigen::Index{1} << (2 * level)) + 2 < side.vertices) ++level;
  const TriangleMesh sphere = maps::fsaverageSphere(level);
  if (sphere.vertexCount() != side.vertices) return;
  const Json name = member.maps.together
                        ? provenance::readJson(member.run / study::kKeptName)["template"]
                        : provenance::readRecord(member.run / "register" /
                                                 provenance::kRecordName)["options"]["template"];
  const CortexTemplate known =
      findTemplate(context, name.is_string() ? name.get<std::string>() : kDefaultTemplate,
                   structureOf(side.hemisphere));
  const auto read = [&](const std::string& file) {
    return io::readSurface(context.input(file, "template"), {.space = io::SurfaceSpace::Scanner})
        .mesh;
  };
  const TriangleMesh from = read(known.sphere);
  const Eigen::VectorXd fromAreas = geometry::vertexAreas(from),
                        toAreas = geometry::vertexAreas(sphere);
  const auto weightsBy = [&](maps::ResamplingMethod method) {
    return maps::resamplingWeights(from, sphere, method, fromAreas, toAreas);
  };
  if (!known.white.empty() && !known.pial.empty()) {
    const Positions middle = 0.5 * (read(known.white).positions + read(known.pial).positions);
    side.surface = TriangleMesh{
        maps::resampleMaps(weightsBy(maps::ResamplingMethod::Barycentric), middle), sphere.faces};
  }
  if (!known.atlas.empty()) {
    side.regions = io::readVertexLabels(context.input(known.atlas, "template"), from.vertexCount());
    side.regions->keys =
        maps::resampleLabels(weightsBy(maps::ResamplingMethod::Adaptive), side.regions->keys);
  }
}

}  // namespace

Eigen::VectorXd readMap(const Member& member, std::size_t measure,
                        std::optional<Eigen::Index> count) {
  const std::string ending = member.maps.entity + ".shape.gii";
  const std::filesystem::path file =
      member.maps.together
          ? member.run / ("maps_" + ending)
          : member.run / "resample" / (std::string(kMeasures[measure]) + "_" + ending);
  Eigen::VectorXd values =
      io::readVertexMaps(file, count).at(member.maps.together ? measure : 0).values;
  // A thickness of 0 was not measured, as on the medial wall.
  if (measure == kThickness) values = (values.array() > 0).select(values, kNaN);
  return values;
}

GroupSide gather(Context& context, const std::vector<Member>& members,
                 const std::string& hemisphere) {
  GroupSide side;
  side.hemisphere = hemisphere;
  const Member* first = nullptr;
  for (const Member& member : members) {
    if (member.row->hemisphere != hemisphere || !member.reason.empty()) continue;
    checkpoint(context.monitor());
    for (std::size_t m = 0; m < kMeasures.size(); ++m) {
      const Eigen::VectorXd map = readMap(member, m, {});
      if (first == nullptr) {
        first = &member;
        side.vertices = map.size();
      }
      if (map.size() != side.vertices) {
        throw InvalidInput(member.label() + ": " + kMeasures[m] + " has " +
                           std::to_string(map.size()) + " vertices, that of " + first->label() +
                           " " + std::to_string(side.vertices));
      }
      if (side.groups.size() == m) side.groups.emplace_back(side.vertices);
      side.groups[m].add(map);
    }
    ++side.people;
  }
  if (first != nullptr) readTemplate(context, *first, side);
  return side;
}

void writeSide(Context& context, const GroupSide& side, const std::string& entity) {
  const std::string stem = "group/hemi-" + side.hemisphere + "_" + entity + "_";
  for (std::size_t m = 0; m < kMeasures.size(); ++m) {
    const GroupMaps& group = side.groups[m];
    io::writeGiftiShape(context.output(stem + kMeasures[m] + ".shape.gii"),
                        {{"mean", kUnits[m], group.mean()},
                         {"standard deviation", kUnits[m], group.deviation()},
                         {"coefficient of variation", "", group.variation()},
                         {"people", "", group.people()}},
                        structureOf(side.hemisphere));
  }
  if (side.regions) {
    io::writeGiftiLabel(context.output(stem + "regions.label.gii"), *side.regions,
                        structureOf(side.hemisphere));
  }
  if (!side.surface) return;
  io::SurfaceMetadata metadata;
  metadata.structure = structureOf(side.hemisphere);
  io::writeGiftiSurface(context.output(stem + "midthickness.surf.gii"), *side.surface, metadata);
}

void compare(Context& context, const Member& member, const GroupSide& side) {
  std::vector<io::VertexMap> maps;
  for (std::size_t m = 0; m < kMeasures.size(); ++m) {
    const bool inGroup = member.reason.empty();
    const Eigen::VectorXd map = readMap(member, m, side.vertices);
    const Eigen::VectorXd z = side.groups[m].distance(map, inGroup);
    member.row->values[std::string("group.distance_") + kMeasures[m]] =
        cellText(statistics::typicalDistance(z, side.people - (inGroup ? 1 : 0)), "%.4g");
    maps.push_back({std::string("z of ") + kMeasures[m], "", z});
  }
  io::writeGiftiShape(context.output("group/" + member.stem() + "_desc-z.shape.gii"), maps,
                      structureOf(side.hemisphere));
}

void drawGroup(Context& context, const std::vector<GroupSide>& sides) {
  for (const GroupSide& side : sides) {
    if (!side.surface) continue;
    using report::ViewName;
    const bool left = side.hemisphere == "L";
    const std::vector<report::FigureView> views = {
        {left ? ViewName::Left : ViewName::Right, {}, {}, {}},
        {left ? ViewName::Right : ViewName::Left, {}, {}, {}}};
    const TriangleMesh inflated = maps::inflated(*side.surface);
    const GroupMaps& thickness = side.groups.front();
    for (const bool mean : {true, false}) {
      report::SurfacePaint paint;
      paint.values = mean ? thickness.mean() : thickness.deviation();
      if (!(paint.values.array().isFinite().any())) continue;
      paint.scale = report::scaleFor(paint.values, mean ? "mean" : "standard deviation", "mm");
      report::SurfacePictureOptions size{.width = 480, .height = 360};
      report::writePng(context.output("group/hemi-" + side.hemisphere +
                                      (mean ? "_mean" : "_deviation") + ".png"),
                       report::surfaceFigure(inflated, paint, views, 2, size));
    }
  }
}

}  // namespace explica::app
