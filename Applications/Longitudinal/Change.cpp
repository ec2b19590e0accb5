// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Change.h"

#include "Explica/Application/Command.h"
#include "Explica/Application/Execute.h"
#include "Explica/Core/Folders.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Maps/Resampling.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

namespace explica::app {
namespace {

namespace fs = std::filesystem;

TriangleMesh readMid(Context& context, const fs::path& folder) {
  return io::readSurface(context.input(folder / "mid.surf.gii", "middle surface")).mesh;
}

/// A session's thickness at the template's vertices; NaN where there is none.
Eigen::VectorXd thicknessAt(Context& context, const fs::path& folder, const Positions& points,
                            double farthest) {
  const TriangleMesh mid = readMid(context, folder);
  const Eigen::VectorXd own =
      io::readVertexMaps(context.input(folder / "thickness.shape.gii", "thickness"),
                         mid.vertexCount())
          .front()
          .values;
  return maps::mapNear(mid, (own.array() > 0).select(own, kNaN), points, farthest);
}

void writeMaps(const fs::path& path, const std::vector<Eigen::VectorXd>& thickness,
               const MeasuredSide& side) {
  io::GiftiMapsWriter writer(path, side.structure(), 2 * thickness.size() - 1);
  const auto add = [&](const std::string& name, const Eigen::VectorXd& values) {
    const Eigen::VectorXf single = values.cast<float>();
    writer.add(name, "mm", {single.data(), static_cast<std::size_t>(single.size())});
  };
  for (std::size_t n = 0; n < thickness.size(); ++n) {
    add(numbered("thickness_session-", n), thickness[n]);
  }
  for (std::size_t n = 1; n < thickness.size(); ++n) {
    add(numbered("change_session-", n), thickness[n] - thickness[0]);
  }
  writer.finish();
}

}  // namespace

void describe(Results& t, const Change& r) {
  t.count("sessions", "Sessions", "Images of the same person.", r.sessions).inHead();
  t.number("session_voxels", "Voxel sizes of the sessions, largest ratio", "",
           "Of shortest, middle or longest edge between any two.", r.voxels)
      .atMost(
          1.1, Judgement::Look,
          "coarser voxels move the borders of thin tissue: 1 x 1 x 1.5 mm after 1 mm of the same "
          "image is -0.07 mm");
  t.number("session_correlation", "Correlation of a session with the first", "",
           "Of brightness within the head, both resampled halfway; the least.", r.correlation)
      .atLeast(0.8, Judgement::Doubt,
               "a head resampled twice has 0.99 and more, different people's brains have 0.56")
      .inHead();
  t.number("session_rotation", "Rotation from the template to a session", "degrees", "The largest.",
           r.turn);
  t.number("thickness_change_mean", "Mean change of thickness", "mm",
           "Last session less the first, at the same places, mean over the middle surface's area.",
           r.mean)
      .inHead();
  t.number("thickness_change_sd", "Standard deviation of the change of thickness", "mm",
           "Over the same area.", r.deviation);
  t.share("thickness_change_known", "Cortex with a change",
          "Area of the middle surface where all sessions have a thickness.", r.known);
}

void Sums::add(const Eigen::VectorXd& areas, const Eigen::VectorXd& change) {
  all += areas.sum();
  for (Eigen::Index v = 0; v < change.size(); ++v) {
    if (!std::isfinite(change[v])) continue;
    known += areas[v];
    first += areas[v] * change[v];
    second += areas[v] * change[v] * change[v];
  }
}

void Sums::settle(Change& change) const {
  change.known = all > 0 ? known / all : kNaN;
  change.mean = first / known;
  change.deviation = std::sqrt(std::max(0.0, second / known - change.mean * change.mean));
}

void measureChange(Context& context, std::size_t sessions, const MeasuredSide& side,
                   const std::string& person, double voxel, Sums& sums) {
  const fs::path out = context.outputFolder(), surface = out / ("template/surface" + side.ending);
  const TriangleMesh mid = readMid(context, surface);
  // What is farther from the mean's surface is another bank, or cortex that one of them lacks.
  const double farthest = 2 * voxel;
  std::vector<Eigen::VectorXd> thickness;
  for (std::size_t n = 0; n < sessions; ++n) {
    thickness.push_back(thicknessAt(context,
                                    out / numbered("session-", n) / ("surface" + side.ending),
                                    mid.positions, farthest));
  }
  Eigen::Array<bool, Eigen::Dynamic, 1> inAll = thickness.front().array().isFinite();
  for (const Eigen::VectorXd& one : thickness) inAll = inAll && one.array().isFinite();
  for (Eigen::VectorXd& one : thickness) one = inAll.select(one, kNaN).eval();
  const fs::path maps = context.output("hemi-" + side.letter + "_thickness.shape.gii");
  writeMaps(maps, thickness, side);
  sums.add(geometry::vertexAreas(mid), thickness.back() - thickness.front());

  const fs::path parcellated = out / ("template/parcellate" + side.ending) / "regions.label.gii";
  const fs::path regions = isThere(parcellated) ? parcellated : surface / "regions.label.gii";
  context.runCommand(*findCommand("regions"), "regions" + side.ending,
                     {{"SURFACES", surface.string()},
                      {"atlas", {regions.string()}},
                      {"map", {maps.string()}},
                      {"hemisphere", side.letter},
                      {"person", person}});
}

}  // namespace explica::app
