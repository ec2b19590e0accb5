// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Surface/CorticalSurface.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Surface/IsoSurface.h"
#include "Explica/Surface/Measures.h"
#include "Explica/Surface/Remesh.h"
#include "GuardedMesh.h"
#include "RibbonField.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace explica::surface {
namespace {

/// Maps a part's progress to a stretch of the whole's.
Monitor partOf(const Monitor& monitor, double from, double to) {
  Monitor part = monitor;
  if (monitor.onProgress) {
    part.onProgress = [report = monitor.onProgress, from, to](double fraction,
                                                              std::string_view activity) {
      report(from + (to - from) * fraction, activity);
    };
  }
  return part;
}

/// Time since the last look, s.
class Stopwatch {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// Vertices on their trajectories, advancing together and never through each other.
class Advance {
 public:
  Advance(const TriangleMesh& white, const std::vector<Trajectory>& paths, double edge)
      : mesh_(white, edge), paths_(paths), reached_(paths.size(), 0.0) {}

  /// Takes every vertex as near to a share of its way as its faces allow.
  void goTo(double share) {
    constexpr int kSweeps = 3;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      const auto waiting = mesh_.sweep([&](std::int32_t v, GuardedMesh::Scratch& scratch) {
        const double target = share * paths_[v].length();
        if (reached_[v] >= target || tryReach(v, target, scratch)) return true;
        tryReach(v, 0.5 * (reached_[v] + target), scratch);
        return false;
      });
      if (waiting == 0) return;
    }
  }

  [[nodiscard]] TriangleMesh mesh() const { return mesh_.toMesh(); }
  [[nodiscard]] double reached(std::size_t v) const { return reached_[v]; }

 private:
  bool tryReach(std::int32_t v, double arc, GuardedMesh::Scratch& scratch) {
    if (!mesh_.move(v, paths_[v].at(arc), scratch)) return false;
    reached_[v] = arc;
    return true;
  }

  GuardedMesh mesh_;
  const std::vector<Trajectory>& paths_;
  std::vector<double> reached_;
};

/// Less than this is no shortfall, mm: rounding of arc lengths.
constexpr double kNoShortfall = 1e-4;

std::int64_t countShort(const Advance& advance, const std::vector<Trajectory>& paths,
                        double share) {
  std::int64_t count = 0;
  for (std::size_t v = 0; v < paths.size(); ++v) {
    count += share * paths[v].length() - advance.reached(v) > kNoShortfall;
  }
  return count;
}

}  // namespace

WhiteSurface extractWhite(const CorticalTissue& tissue, const SurfaceOptions& options,
                          const Monitor& monitor) {
  WhiteSurface white;
  Stopwatch watch;
  TopologyResult topology = correctTopology(tissue.white, options.genus, partOf(monitor, 0, 0.1));
  white.level = std::move(topology.level);
  white.defects = std::move(topology.defects);
  white.voxelsChanged = topology.voxelsChanged;
  white.genus = topology.handlesLeft;
  white.seconds.topology = watch.lap();
  const TriangleMesh raw = extractIsoSurface(white.level);
  white.seconds.extraction = watch.lap();
  RemeshOptions remeshing;
  remeshing.faces = options.faces;
  RemeshResult result = remesh(raw, white.level, remeshing, partOf(monitor, 0.1, 1));
  white.seconds.remeshing = watch.lap();
  white.mesh = std::move(result.mesh);
  white.edgeLength = result.edgeLength;
  return white;
}

double meanThickness(const CorticalSurfaces& surfaces) {
  const Eigen::VectorXd areas = geometry::vertexAreas(surfaces.white.mesh);
  double sum = 0, weight = 0;
  for (Eigen::Index v = 0; v < areas.size(); ++v) {
    if (surfaces.thickness[v] <= 0) continue;
    sum += areas[v] * surfaces.thickness[v];
    weight += areas[v];
  }
  return weight > 0 ? sum / weight : 0;
}

CorticalSurfaces buildSurfaces(const CorticalTissue& tissue, const SurfaceOptions& options,
                               const Monitor& monitor) {
  if (!tissue.hasGrey) {
    throw InvalidInput("grey: no voxel found; middle and outer surface need grey matter");
  }
  if (options.steps < 2 || options.steps % 2 != 0) {
    throw InvalidInput("steps: " + std::to_string(options.steps) + " given; an even number >= 2");
  }
  CorticalSurfaces result;
  result.white = extractWhite(tissue, options, partOf(monitor, 0, 0.5));
  const TriangleMesh& white = result.white.mesh;
  result.seconds = result.white.seconds;
  Stopwatch watch;

  CorticalTissue corrected = tissue;
  corrected.white = result.white.level;
  for (std::size_t v = 0; v < corrected.white.size(); ++v) {
    corrected.tissue[v] = std::max(corrected.tissue[v], corrected.white[v]);
  }
  const RibbonField field(corrected, white, partOf(monitor, 0.5, 0.65));
  result.cutLinks = field.cutLinks();
  result.seconds.interpolant = watch.lap();

  monitor.progress(0.65, "trajectories");
  const Positions normals = geometry::vertexNormals(white);
  std::vector<Trajectory> paths(white.vertexCount());
  parallelFor(paths.size(), 256, [&](std::size_t v) {
    paths[v] = field.trace(white.positions.row(v), normals.row(v));
  });
  result.thickness.resize(white.vertexCount());
  for (std::size_t v = 0; v < paths.size(); ++v) {
    result.thickness[v] = paths[v].length();
    result.noRibbon += paths[v].end == TrajectoryEnd::NoRibbon;
    result.endedAtBank += paths[v].end == TrajectoryEnd::Bank;
  }
  result.seconds.trajectories = watch.lap();

  Advance advance(white, paths, result.white.edgeLength);
  for (int step = 1; step <= options.steps; ++step) {
    monitor.progress(0.7 + 0.25 * step / options.steps, "growing the outer surface");
    const double share = static_cast<double>(step) / options.steps;
    advance.goTo(share);
    if (2 * step == options.steps) {
      result.mid = advance.mesh();
      result.heldBackMid = countShort(advance, paths, share);
    }
  }
  result.pial = advance.mesh();
  result.heldBackPial = countShort(advance, paths, 1);
  for (std::size_t v = 0; v < paths.size(); ++v) {
    const double shortfall = paths[v].length() - advance.reached(v);
    if (shortfall <= kNoShortfall) continue;
    result.heldBackMean += shortfall / static_cast<double>(result.heldBackPial);
    result.heldBackMost = std::max(result.heldBackMost, shortfall);
  }
  result.seconds.growing = watch.lap();

  monitor.progress(0.96, "curvature and depth");
  result.curvature = meanCurvature(white);
  result.sulcalDepth = depthBelowHull(corrected.tissue, result.mid.positions);
  result.seconds.measures = watch.lap();
  monitor.progress(1.0, "surfaces");
  return result;
}

}  // namespace explica::surface
