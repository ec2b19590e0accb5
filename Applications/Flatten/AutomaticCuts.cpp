// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "AutomaticCuts.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Flattening/FoldDepth.h"
#include "Explica/IO/RegionFiles.h"
#include "Explica/IO/VertexDataFile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>

namespace explica::app {
namespace {

std::vector<bool> cortexOfLabels(const io::LabelMap& labels) {
  std::set<Label> regions;
  for (const io::LabelEntry& entry : labels.table) {
    const bool isCortex = !io::meansNoRegion(entry.name) && entry.name != "corpuscallosum";
    if (isCortex) regions.insert(entry.key);
  }
  std::vector<bool> cortex;
  for (const Label key : labels.keys) {
    cortex.push_back(labels.table.empty() ? key != 0 : regions.contains(key));
  }
  return cortex;
}

std::vector<bool> cortexOfFile(const std::filesystem::path& path, Eigen::Index vertexCount) {
  std::optional<io::LabelMap> labels;
  try {
    labels = io::readVertexLabels(path, vertexCount);
  } catch (const Error&) {
    // No labels: a map.
  }
  if (labels) return cortexOfLabels(*labels);
  const std::vector<io::VertexMap> maps = io::readVertexMaps(path, vertexCount);
  std::vector<bool> cortex;
  for (const double value : maps.front().values) {
    cortex.push_back(std::isfinite(value) && value != 0);
  }
  return cortex;
}

std::string cutName(const std::vector<flattening::Cut>& cuts, std::size_t n) {
  return cuts[n].name.empty() ? "cut " + std::to_string(n + 1) : cuts[n].name;
}

std::string tableOf(const flattening::Disc& disc, const std::vector<flattening::Cut>& cuts) {
  std::string text = "cut\tname\tfrom\tto\tvertices\tlength\tdepth\tx\ty\tz\n";
  for (std::size_t n = 0; n < cuts.size(); ++n) {
    const flattening::Cut& cut = cuts[n];
    const Point end = disc.mesh.positions.row(cut.path.back());
    text += printed("%zu\t%s\t%d\t%d\t%zu\t%.2f\t%.3f\t%.2f\t%.2f\t%.2f\n", n + 1,
                    cutName(cuts, n).c_str(), disc.vertexOrigin[cut.path.front()],
                    disc.vertexOrigin[cut.path.back()], cut.path.size(), cut.length, cut.depth,
                    end.x(), end.y(), end.z());
  }
  return text;
}

void report(Context& context, const flattening::CutPlan& plan,
            const flattening::CutOptions& options) {
  const double length = plan.length();
  context.results(plan);
  if (plan.termination == Termination::Interrupted) {
    context.info(printed(
        "stopped while cuts were sought: %zu so far, %.0f mm in all; --resume goes on from them",
        plan.cuts.size(), length));
    return;
  }
  context.info(printed("%zu cuts, %.0f mm in all; edge strain %.3f without, %.3f with",
                       plan.cuts.size(), length, plan.strainBefore, plan.edgeStrain));
  if (plan.edgeStrain > options.edgeStrain) {
    context.warn(printed("the cuts reach an edge strain of %.3f, not the %.3f of --cut.strain; %s",
                         plan.edgeStrain, options.edgeStrain,
                         plan.termination == Termination::Stalled
                             ? "no further cut was found that relieves"
                             : "more would need --cut.most"));
  }
}

}  // namespace

std::optional<std::filesystem::path> cortexBeside(const std::filesystem::path& surface) {
  const std::filesystem::path folder = surface.parent_path();
  const std::string name = surface.filename().string();
  std::vector<std::filesystem::path> places = {folder / "valid.shape.gii"};
  for (const std::string side : {"lh", "rh"}) {
    if (name.starts_with(side + ".")) {
      places.push_back(folder / ".." / "label" / (side + ".cortex.label"));
    }
  }
  for (const auto& place : places) {
    if (isThere(place)) return place.lexically_normal();
  }
  return {};
}

io::LabelMap labelsOf(const flattening::Disc& disc, const std::vector<flattening::Cut>& cuts,
                      Eigen::Index vertexCount) {
  constexpr std::array<std::array<float, 4>, 6> kColours = {{{0.90F, 0.10F, 0.10F, 1},
                                                             {0.10F, 0.35F, 0.90F, 1},
                                                             {0.10F, 0.65F, 0.20F, 1},
                                                             {0.95F, 0.60F, 0.05F, 1},
                                                             {0.60F, 0.20F, 0.75F, 1},
                                                             {0.05F, 0.70F, 0.75F, 1}}};
  io::LabelMap labels;
  labels.name = "cuts";
  labels.keys.setConstant(vertexCount, 1);
  for (const std::int32_t v : disc.vertexOrigin) labels.keys[v] = 0;
  labels.table = {{0, "cortex", {0, 0, 0, 0}}, {1, "medial wall", {0.5F, 0.5F, 0.5F, 1}}};
  for (std::size_t n = 0; n < cuts.size(); ++n) {
    const auto key = static_cast<Label>(n + 2);
    labels.table.push_back({key, cutName(cuts, n), kColours[n % kColours.size()]});
    for (const std::int32_t v : cuts[n].path) {
      Label& at = labels.keys[disc.vertexOrigin[v]];
      if (at == 0) at = key;
    }
  }
  return labels;
}

std::vector<bool> cortexOf(Context& context, const std::string& surface, const TriangleMesh& mesh,
                           const std::optional<std::string>& cortex) {
  if (cortex) {
    context.note("cortex", *cortex);
    return cortexOfFile(*cortex, mesh.vertexCount());
  }
  if (const auto beside = cortexBeside(surface)) {
    context.info("cortex: by '" + beside->string() + "' beside the surface");
    context.note("cortex", beside->filename().string());
    return cortexOfFile(context.input(*beside, "cortex"), mesh.vertexCount());
  }
  const auto wall = flattening::flattestPlace(mesh);
  Point middle = Point::Zero();
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    if (wall[v]) middle += mesh.positions.row(v).transpose();
  }
  middle /= static_cast<double>(std::count(wall.begin(), wall.end(), true));
  context.info(
      printed("medial wall: taken to be the flattest fortieth of the surface, about %.0f, %.0f, "
              "%.0f mm; --cortex would say",
              middle.x(), middle.y(), middle.z()));
  context.note("cortex", "all but the flattest fortieth");
  std::vector<bool> inCortex(wall.size());
  for (std::size_t v = 0; v < wall.size(); ++v) inCortex[v] = !wall[v];
  return inCortex;
}

flattening::Disc openedAlong(Context& context, const io::LoadedSurface& reference,
                             const flattening::Disc& disc,
                             const std::vector<flattening::Cut>& cuts) {
  writeTextFile(context.output("cuts.tsv"), tableOf(disc, cuts));
  io::writeGiftiLabel(context.output("cuts.label.gii"),
                      labelsOf(disc, cuts, reference.mesh.vertexCount()),
                      reference.metadata.structure);
  std::vector<flattening::CutPath> paths;
  for (const flattening::Cut& cut : cuts) paths.push_back(cut.path);
  return flattening::openedAlong(disc, paths);
}

flattening::Disc openedAlongTemplate(Context& context, const io::LoadedSurface& reference,
                                     const flattening::Disc& disc, const TemplateCuts& cuts) {
  const Eigen::VectorXd depth = flattening::foldDepth(reference.mesh)(disc.vertexOrigin);
  const Positions places = cuts.places(disc.vertexOrigin, Eigen::all);
  const auto plan = flattening::cutsAlong(disc, places, cuts.lines, depth);
  std::string names;
  for (const flattening::Cut& cut : plan.cuts) names += (names.empty() ? "" : ", ") + cut.name;
  context.results(plan);
  context.info(
      printed("%zu cuts of the template, %.0f mm in all: ", plan.cuts.size(), plan.length()) +
      names);
  if (plan.cuts.size() < cuts.lines.size()) {
    context.warn(std::to_string(cuts.lines.size() - plan.cuts.size()) +
                 " cuts of the template have no way of their own here and are left out");
  }
  return openedAlong(context, reference, disc, plan.cuts);
}

Opened openedByItself(Context& context, const Monitor& monitor, const io::LoadedSurface& reference,
                      const flattening::Disc& disc, const flattening::CutOptions& options,
                      const flattening::Checkpoint* resume) {
  const bool known = resume != nullptr && resume->cuts;
  if (known && resume->uncut != flattening::sumOver(disc)) {
    throw InvalidInput("resume: the cuts that lie in --out belong to another surface");
  }
  Opened opened;
  if (known) opened.plan = *resume->cuts;
  const bool wanted = !known || opened.plan.termination == Termination::Interrupted;
  Eigen::VectorXd depth = Eigen::VectorXd::Zero(disc.mesh.vertexCount());
  if (wanted && !monitor.shouldStop()) {
    depth = flattening::foldDepth(reference.mesh)(disc.vertexOrigin);
  }
  const StopScope kept(nullptr);  // the cuts found so far
  if (wanted) {
    opened.plan =
        flattening::findCuts(disc, depth, options, monitor, known ? &*resume->cuts : nullptr);
  }
  const auto& cuts = opened.plan.cuts;
  report(context, opened.plan, options);
  opened.disc = openedAlong(context, reference, disc, cuts);
  return opened;
}

}  // namespace explica::app
