// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "TemplateCuts.h"

#include "AutomaticCuts.h"
#include "Explica/Application/CortexTemplate.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Flattening/FoldDepth.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/IO/StatedHemisphere.h"
#include "Explica/Maps/Resampling.h"
#include "Subject.h"

#include <algorithm>
#include <filesystem>
#include <map>

namespace explica::app {
namespace {

namespace fs = std::filesystem;

TriangleMesh readSphere(Context& context, const std::string& file, const TriangleMesh& surface) {
  TriangleMesh sphere = readSurface(context, "sphere", context.input(file, "sphere").string(),
                                    {.space = io::SurfaceSpace::Scanner})
                            .mesh;
  maps::requireSphere(sphere, "'" + file + "'");
  requireSameVertices(sphere, surface, file);
  return sphere;
}

std::string registeredSphere(const FlattenSettings& s) {
  if (s.sphere) return *s.sphere;
  const fs::path folder = fs::path(s.surface).parent_path();
  const std::string side = io::statedStructure(s.surface) == "CortexRight" ? "rh." : "lh.";
  const auto found =
      findFile(withRegistration(folder.string()), {side + "sphere.reg", "sphere.reg.surf.gii"});
  if (found) return *found;
  throw InvalidInput("--cuts template: no " + side + "sphere.reg or sphere.reg.surf.gii beside '" +
                     s.surface + "'; name the sphere that explica register wrote by --sphere");
}

/// The cuts named by the region of their inner end; the second of a name gets a number.
void nameByRegion(std::vector<flattening::Cut>& cuts, const flattening::Disc& disc,
                  const std::string& atlas) {
  const io::LabelMap regions = io::readVertexLabels(atlas);
  std::map<Label, std::string> names;
  for (const io::LabelEntry& entry : regions.table) names[entry.key] = entry.name;
  std::map<std::string, int> times;
  for (flattening::Cut& cut : cuts) {
    cut.name = names[regions.keys[disc.vertexOrigin[cut.path.back()]]];
    if (const int n = ++times[cut.name]; n > 1) cut.name += " " + std::to_string(n);
  }
}

io::LabelMap foundOnTemplate(Context& context, const CortexTemplate& files,
                             const flattening::CutOptions& options) {
  auto step = context.step("cut the template");
  context.input(files.white, "white");
  const auto white =
      readSurface(context, "white", files.white, {.space = io::SurfaceSpace::Scanner});
  std::optional<std::string> cortex;
  if (!cortexBeside(files.white) && !files.atlas.empty()) cortex = files.atlas;
  const auto wall = cortexOf(context, files.white, white.mesh, cortex);
  const auto disc = flattening::discOf(white.mesh, flattening::facesWithoutWall(white.mesh, wall));
  const Eigen::VectorXd depth = flattening::foldDepth(white.mesh)(disc.vertexOrigin);
  auto cuts = flattening::findCuts(disc, depth, options, context.monitor()).cuts;
  if (!files.atlas.empty()) {
    context.input(files.atlas, "atlas");
    nameByRegion(cuts, disc, files.atlas);
  }
  return labelsOf(disc, cuts, white.mesh.vertexCount());
}

/// The names asked for, or all.
std::map<Label, std::string> chosenCuts(const FlattenSettings& s, const io::LabelMap& labels) {
  std::map<Label, std::string> all, chosen;
  std::string known;
  for (const io::LabelEntry& entry : labels.table) {
    if (entry.key < 2) continue;  // cortex and wall
    all[entry.key] = entry.name;
    known += (known.empty() ? "" : ", ") + entry.name;
  }
  if (s.cutNames.empty()) return all;
  for (const std::string& name : s.cutNames) {
    const auto at = std::find_if(all.begin(), all.end(),
                                 [&](const auto& entry) { return entry.second == name; });
    if (at == all.end()) {
      throw InvalidInput("--cut-name: the template has no cut '" + name + "'; it has " + known);
    }
    chosen.insert(*at);
  }
  return chosen;
}

}  // namespace

TemplateCuts readTemplateCuts(Context& context, const FlattenSettings& s,
                              const TriangleMesh& surface) {
  const std::string place = registeredSphere(s);
  const TriangleMesh sphere = readSphere(context, place, surface);
  std::string structure = io::statedStructure(place);
  if (structure.empty()) structure = io::statedStructure(s.surface);
  const std::string name = s.templateName.value_or(kDefaultTemplate);
  const CortexTemplate files = findTemplate(context, name, structure);
  if (files.cuts.empty() && files.white.empty()) {
    throw InvalidInput(
        "template '" + name +
        "': has neither cuts (?h.cuts.label.gii) nor a white surface to find them on");
  }
  const io::LabelMap labels = files.cuts.empty()
                                  ? foundOnTemplate(context, files, s.cut)
                                  : io::readVertexLabels(context.input(files.cuts, "cuts"));
  const TriangleMesh target =
      readSurface(context, "sphere", files.sphere, {.space = io::SurfaceSpace::Scanner}).mesh;
  if (target.vertexCount() != labels.keys.size()) {
    throw InvalidInput("template '" + name + "': its cuts have " +
                       std::to_string(labels.keys.size()) + " vertices, its sphere " +
                       std::to_string(target.vertexCount()));
  }
  TemplateCuts result;
  const auto weights =
      maps::resamplingWeights(target, sphere, maps::ResamplingMethod::Nearest,
                              geometry::vertexAreas(target), geometry::vertexAreas(sphere));
  for (const Label key : maps::resampleLabels(weights, labels.keys)) {
    result.cortex.push_back(key != 1);
  }
  result.places = sphere.positions.rowwise().normalized();
  const TriangleMesh unit{target.positions.rowwise().normalized(), target.faces};
  result.lines = flattening::cutLines(unit, labels.keys, chosenCuts(s, labels));
  return result;
}

}  // namespace explica::app
