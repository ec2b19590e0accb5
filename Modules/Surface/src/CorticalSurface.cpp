// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Surface/CorticalSurface.h"

#include "AnnulusBetween.h"
#include "AstrayPaths.h"
#include "ColumnMeasures.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Stopwatch.h"
#include "Explica/Correspondence/Correspondence.h"
#include "Explica/Geometry/FaceTree.h"
#include "Explica/Geometry/IsoSurface.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Maps/Folding.h"
#include "Explica/Surface/GivenSurfaces.h"
#include "Explica/Surface/Measures.h"
#include "Explica/Surface/Remesh.h"
#include "GrowingColumns.h"
#include "Growth.h"
#include "KeepRoom.h"
#include "MendTogether.h"
#include "OntoLevel.h"
#include "PlaceByImage.h"
#include "Relaxation.h"
#include "RibbonPaths.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace explica::surface {
namespace {

/// Longest edge that is left, in mean ones: 4 mm where these are 1.29 mm.
constexpr double kLongestEdge = 3.1;
/// Farthest that smoothing may take a vertex across its surface in one sweep, voxels.
constexpr double kRoughness = 0.2;
/// In which the outer surface grows, even: 2 or 20 move the pial area of bert by 0.01 %.
constexpr int kGrowthSteps = 6;
/// Sweeps of each relaxation of the outer surface, which then grows again: a relaxation shrinks
/// crowns and opens closed sulci where it slides vertices far.
constexpr std::array kRelaxations = {16, 4, 4};

/// From a point towards the zero of a level set along its gradient, as far as `most`, mm; nowhere
/// if the level does not fall outward.
Point towardsBorder(const LevelSet& level, const Point& from, const Vector& normal, double most) {
  const double voxel = voxelSize(level.grid);
  Point p = from;
  for (int step = 0; step < 2; ++step) {
    const LevelSample s = sample(level, p);
    const double squared = s.gradient.squaredNorm();
    if (squared * voxel * voxel < kFlatLevel || s.gradient.dot(normal) > 0) return from;
    p -= s.value / squared * s.gradient;
    const double way = (p - from).norm();
    if (way > most) return from + most / way * (p - from);
  }
  return p;
}

/// Refuses places where float32 numbers, which files hold, are too coarse for the voxels.
void requirePrecision(const Grid& grid) {
  constexpr double kShare = 1e-3;  // of a voxel
  double farthest = 0;
  for (int c = 0; c < 8; ++c) {
    const Vector corner((c & 1) * grid.size[0], (c >> 1 & 1) * grid.size[1],
                        (c >> 2) * grid.size[2]);
    farthest = std::max(farthest, grid.toWorld(corner).cwiseAbs().maxCoeff());
  }
  const double step = farthest * std::numeric_limits<float>::epsilon();
  const double voxel = voxelSize(grid);
  if (step <= kShare * voxel) return;
  throw InvalidInput("volume: it lies " + std::to_string(farthest) +
                     " mm from the origin, where the 32-bit numbers of surface files are " +
                     std::to_string(step) + " mm apart, more than a thousandth of a voxel (" +
                     std::to_string(voxel) + " mm); move its origin nearer");
}

/// The tissue between white matter, as its topology was corrected, and what lies outside.  Its
/// boundaries are those of the labels, or where shares are one half.
harmonic::Annulus annulusOf(const CorticalTissue& tissue, const Monitor& monitor) {
  using harmonic::Site;
  const Grid& grid = tissue.white.grid;
  Volume<Site> sites(grid);
  parallelFor(sites.size(), 1 << 16, [&](std::size_t v) {
    sites[v] = tissue.white[v] > 0    ? Site::Inner
               : tissue.insulated[v]  ? Site::Insulated
               : tissue.tissue[v] > 0 ? Site::Tissue
                                      : Site::Outer;
  });
  if (tissue.ofLabels) return harmonic::annulusFromSites(sites, {}, monitor);
  LevelSet inner = tissue.white, outer = tissue.tissue;  // negative inside, as an annulus has them
  for (LevelSet* level : {&inner, &outer}) {
    for (float& value : level->data) value = -value;
  }
  return harmonic::annulusFromSites(sites, inner, outer, {}, monitor);
}

Monitor silent(Monitor monitor) {
  monitor.onProgress = nullptr;
  return monitor;
}

correspondence::Ribbon solve(harmonic::Annulus annulus, const Monitor& monitor) {
  monitor.progress(0, "harmonic interpolant");
  correspondence::Ribbon ribbon = correspondence::solveRibbon(
      std::move(annulus), correspondence::SulcusOptions{}, {}, silent(monitor));
  checkpoint(monitor);
  return ribbon;
}

/// A ribbon, and the thickness of its voxels.
struct RibbonVoxels {
  explicit RibbonVoxels(const correspondence::Ribbon& ribbon)
      : annulus(ribbon.annulus),
        found(correspondence::findCorrespondences(annulus, ribbon.interpolant)) {}
  const harmonic::Annulus& annulus;
  correspondence::Correspondence found;
};

/// What the surfaces keep clear of themselves.
Room roomOf(const WhiteSurface& white) {
  return roomFor(voxelSize(white.level.grid), white.edgeLength);
}

/// That of the ribbon's voxels around the middle vertices.
void takeThickness(const GrowingColumns& columns, const RibbonVoxels& voxels,
                   CorticalSurfaces& result) {
  result.thickness = thicknessAtVertices(voxels.annulus, voxels.found, result.mid);
  for (Eigen::Index v = 0; v < result.thickness.size(); ++v) {
    const bool none = columns.paths[v].end == TrajectoryEnd::NoRibbon;
    if (none || !(result.thickness[v] > 0)) result.thickness[v] = 0;
  }
  result.noRibbon = (result.thickness.array() == 0).count();
  for (const Trajectory& path : columns.paths) {
    result.endedAtBank += path.end == TrajectoryEnd::Bank;
  }
}

/// Vertices that waited on their trajectory and have not come to the outer border by sliding.
void noteHeldBack(const GrowingColumns& ribbon, const LevelSet& outer, const Growth& growth,
                  double least, CorticalSurfaces& result) {
  double sum = 0;
  for (std::size_t v = 0; v < ribbon.paths.size(); ++v) {
    double missing = growth.missing(v);
    if (missing <= least) continue;
    const Point at = result.pial.positions.row(static_cast<Eigen::Index>(v));
    const Trajectory& path = ribbon.paths[v];
    if (path.end == TrajectoryEnd::Outer) {
      const LevelSample border = sample(outer, at);
      missing = std::min(missing, border.value / std::max(border.gradient.norm(), 1e-300));
    } else {
      const Vector way = path.points.back() - path.points[path.points.size() - 2];
      missing = std::min(missing, (path.points.back() - at).dot(way.normalized()));
    }
    if (missing <= least) continue;
    ++result.heldBackPial;
    sum += missing;
    result.heldBackMost = std::max(result.heldBackMost, missing);
  }
  if (result.heldBackPial > 0) {
    result.heldBackMean = sum / static_cast<double>(result.heldBackPial);
  }
}

/// Takes vertices that slid along their surface, and with it off the outer boundary, towards it
/// again, a voxel at most.
/// @param rest  the ways from where each vertex was the last time: nothing is new on one that it
///              is still at the start of
void growAgain(const GrowingColumns& ribbon, const RibbonPaths& along,
               const geometry::FaceTree& white, std::vector<Trajectory>& rest, TriangleMesh& pial) {
  const std::vector<std::int32_t> faceAt = geometry::faceOfEachVertex(white.mesh());
  const double gap = middleGap(ribbon.tissue.white.grid);
  const double voxel = voxelSize(ribbon.tissue.white.grid);
  rest.resize(ribbon.paths.size());
  parallelFor(rest.size(), 256, [&](std::size_t v) {
    const auto row = static_cast<Eigen::Index>(v);
    const Point start = pial.positions.row(row);
    if (!rest[v].points.empty() && rest[v].points.front() == start) return;
    rest[v] = RibbonPaths::none(start);
    if (ribbon.paths[v].end == TrajectoryEnd::NoRibbon) return;
    const Trajectory path = along.from(start, 1);
    if (path.end == TrajectoryEnd::NoRibbon) return;
    const double end = path.length() - (path.end == TrajectoryEnd::Bank ? gap : 0);
    const double length = std::min(end, stallOf(white, faceAt[v], voxel, 0, path));
    if (length > 0) rest[v] = between(path, 0, std::min(length, voxel));
  });
  Growth growth(pial, rest);
  growth.goTo(1);
  pial = growth.mesh();
}

/// Middle and outer surface out of the white one.
void growSurfaces(const GrowingColumns& ribbon, const RibbonPaths& along, CorticalSurfaces& result,
                  const Monitor& monitor) {
  const double voxel = voxelSize(ribbon.tissue.white.grid);
  const double edge = result.white.edgeLength;
  std::vector<std::uint8_t> moves(ribbon.paths.size());
  for (std::size_t v = 0; v < moves.size(); ++v) moves[v] = ribbon.paths[v].length() > 0;
  RelaxationOptions sliding;
  sliding.bend = 0;
  sliding.sweeps = 4;
  RelaxationOptions relaxation;
  relaxation.most = kRoughness * voxel;

  // Coarse triangles slide out of folds of the ribbon: what does goes back to its trajectory.
  const auto inRibbon = [&](std::int32_t v, const Point& point, const Vector&) {
    const Point middle = ribbon.paths[v].at(0.5 * ribbon.paths[v].length());
    for (const double back : {0.0, 0.5}) {
      const Point place = point + back * (middle - point);
      if (along.isTissue(place)) return place;
    }
    return middle;
  };
  Growth growth(result.white.mesh, ribbon.paths);
  for (int step = 1; step <= kGrowthSteps; ++step) {
    monitor.progress(static_cast<double>(step) / (kGrowthSteps + 1), "growing the outer surface");
    growth.goTo(static_cast<double>(step) / kGrowthSteps);
    if (2 * step == kGrowthSteps) {
      for (std::size_t v = 0; v < moves.size(); ++v) {
        result.heldBackMid += growth.missing(v) > kNoShortfall * voxel;
      }
      result.mid = relaxed(growth.mesh(), edge, moves, inRibbon, sliding);
      keepRoom(result.mid, roomOf(result.white));
    }
  }
  const LevelSet& border = ribbon.tissue.tissue;
  const auto ontoBorder = [&](std::int32_t v, const Point& point, const Vector& normal) {
    return ribbon.paths[v].end == TrajectoryEnd::Outer
               ? towardsBorder(border, point, normal, kNearBorder * voxel)
               : point;
  };
  const geometry::FaceTree white(result.white.mesh);
  result.pial = growth.mesh();
  std::vector<Trajectory> rest;
  for (const int sweeps : kRelaxations) {
    relaxation.sweeps = sweeps;
    result.pial = relaxed(result.pial, edge, moves, ontoBorder, relaxation);
    growAgain(ribbon, along, white, rest, result.pial);
    relaxation.bend = 0;  // what has been evened only slides
  }
  RelaxationOptions mending;
  mending.sweeps = 0;
  result.pial = relaxed(result.pial, edge, moves, ontoBorder, mending);
  keepRoom(result.pial, roomOf(result.white));
  noteHeldBack(ribbon, border, growth, kNoShortfall * voxel, result);
}

/// Takes what is too small or too long out of all three surfaces together.
void mendTriangles(CorticalSurfaces& result) {
  constexpr int kRounds = 3;  // keeping a gap may make a face small again
  const double edge = result.white.edgeLength;
  const Room room = roomOf(result.white);
  const MendingLimits limits{room.leastArea, kLongestEdge * edge};
  const std::array<TriangleMesh*, 3> surfaces = {&result.white.mesh, &result.mid, &result.pial};
  Eigen::MatrixXd values(result.thickness.size(), 1 + result.image.doubt.cols());
  values.col(0) = result.thickness;
  if (result.image.doubt.size() > 0) values.rightCols(2) = result.image.doubt;
  for (int round = 0; round < kRounds; ++round) {
    const Mending mending = mendTogether(surfaces, values, limits, edge);
    if (mending.removed + mending.inserted == 0) return;
    for (TriangleMesh* surface : surfaces) keepRoom(*surface, room);
    result.thickness = values.col(0);
    if (result.image.doubt.size() > 0) result.image.doubt = values.rightCols(2).eval();
    result.noRibbon = (result.thickness.array() == 0).count();
  }
}

}  // namespace

WhiteSurface extractWhite(const CorticalTissue& tissue, const SurfaceOptions& options,
                          const Monitor& monitor) {
  requirePrecision(tissue.white.grid);
  WhiteSurface white;
  Stopwatch watch;
  TopologyResult topology = correctTopology(tissue.white, options.genus, monitor.part(0, 0.1));
  white.level = std::move(topology.level);
  white.defects = std::move(topology.defects);
  white.voxelsChanged = topology.voxelsChanged;
  white.genus = topology.handlesLeft;
  white.seconds.topology = watch.lap();
  const TriangleMesh raw = geometry::extractIsoSurface(white.level);
  white.seconds.extraction = watch.lap();
  RemeshOptions remeshing;
  remeshing.faces = options.faces;
  RemeshResult result = remesh(raw, white.level, remeshing, monitor.part(0.1, 1));
  white.seconds.remeshing = watch.lap();
  white.mesh = std::move(result.mesh);
  white.edgeLength = result.edgeLength;
  keepRoom(white.mesh, roomOf(white));
  white.correctedShare = correctedShare(tissue.white, white.level, white.mesh);
  return white;
}

double meanThickness(const Eigen::VectorXd& areas, const Eigen::VectorXd& thickness) {
  const Eigen::VectorXd counted = (thickness.array() > 0).select(areas, 0.0);
  const double weight = counted.sum();
  return weight > 0 ? counted.dot(thickness) / weight : 0;
}

double thicknessDeviation(const Eigen::VectorXd& areas, const Eigen::VectorXd& thickness) {
  const Eigen::VectorXd counted = (thickness.array() > 0).select(areas, 0.0);
  const double weight = counted.sum(), mean = meanThickness(areas, thickness);
  const Eigen::ArrayXd off = thickness.array() - mean;
  return weight > 0 ? std::sqrt(counted.dot((off * off).matrix()) / weight) : 0;
}

namespace {

constexpr double kBrightestFluid = 10;  // over white matter, of any contrast

/// Borders, middle and outer surface, thickness and columns, with the ribbon between the borders.
void growInRibbon(const CorticalTissue& tissue, std::optional<BorderImages> images,
                  const SurfaceOptions& options, const Monitor& monitor, CorticalSurfaces& result) {
  Stopwatch watch;
  GrowingColumns ribbon;
  ribbon.tissue = corrected(tissue, result.white.level);
  std::optional<TriangleMesh> placed;
  if (images) {
    std::optional<WhiteSurface> other = whereImageIsAsked(result.white);
    const correspondence::Ribbon ofLabels =
        solve(annulusOf(ribbon.tissue, silent(monitor)), monitor.part(0.5, 0.6));
    placed = placeByImage(*images, options.fluid, RibbonPaths(ofLabels), std::move(other), ribbon,
                          result);
    images.reset();
    result.seconds.image = watch.lap();
  }
  const correspondence::Ribbon first =
      solve(placed ? annulusBetween(*placed, ribbon.tissue, silent(monitor))
                   : annulusOf(ribbon.tissue, silent(monitor)),
            monitor.part(0.6, 0.7));
  result.cutLinks = static_cast<std::int64_t>(first.sulcalVoxels.size());
  result.seconds.interpolant = watch.lap();
  const RibbonPaths trajectories(first);
  takePaths(result.white.mesh, trajectories, ribbon);
  result.seconds.trajectories = watch.lap();
  result.shortened = shortenAstray(result.white.mesh, voxelSize(tissue.white.grid), ribbon.paths);
  growSurfaces(ribbon, trajectories, result, monitor.part(0.7, 0.96));
  // Levels on long voxels join banks that the surfaces part; on cubes they know crowns and floors
  // better than a mesh.
  std::optional<correspondence::Ribbon> between;
  constexpr double kFineEdge = 1.5;  // voxels
  const bool isFine = result.white.edgeLength <= kFineEdge * voxelSize(tissue.white.grid);
  if (placed && isFine && hasLongVoxels(ribbon.tissue.insulated.grid)) {
    between = solve(
        annulusBetween(result.white.mesh, result.pial, ribbon.tissue.insulated, silent(monitor)),
        silent(monitor));
  }
  const RibbonVoxels voxels(between ? *between : first);
  takeThickness(ribbon, voxels, result);
  result.columns = columnsOf(voxels.annulus, voxels.found);
  result.seconds.growing = watch.lap();
}

CorticalSurfaces build(const CorticalTissue& given, std::optional<BorderImages> images,
                       const SurfaceOptions& options, const Monitor& monitor) {
  if (!given.hasGrey) {
    throw InvalidInput("grey: no voxel found; middle and outer surface need grey matter");
  }
  if (!(options.fluid >= 0 && options.fluid <= kBrightestFluid)) {
    throw InvalidInput("fluid: " + std::to_string(options.fluid) +
                       " given; 0, or the brightness of fluid over that of white matter, at most " +
                       std::to_string(static_cast<int>(kBrightestFluid)));
  }
  // An image tells where white matter ends in cortex that was taken for it.
  const bool isSearched = images && given.byBrightness;
  const CorticalTissue tissue = isSearched ? withCortexAllAround(given) : given;
  CorticalSurfaces result;
  result.white = extractWhite(tissue, options, monitor.part(0, 0.5));
  result.seconds = result.white.seconds;
  growInRibbon(tissue, std::move(images), options, monitor, result);
  Stopwatch watch;
  mendTriangles(result);
  result.seconds.growing += watch.lap();

  monitor.progress(0.96, "curvature and depth");
  const std::array<std::function<void()>, 3> measures = {
      [&] { result.curvature = maps::meanCurvature(result.white.mesh); },
      [&] { result.nearestThickness = distanceThickness(result.white.mesh, result.pial); },
      [&] { result.sulcalDepth = maps::sulcalDepth(result.white.mesh); }};
  parallelFor(measures.size(), 1, [&](std::size_t n) { measures[n](); });
  result.nearestThickness = (result.thickness.array() > 0).select(result.nearestThickness, 0.0);
  result.seconds.measures = watch.lap();
  monitor.progress(1.0, "surfaces");
  return result;
}

}  // namespace

CorticalSurfaces buildSurfaces(const CorticalTissue& tissue, const SurfaceOptions& options,
                               const Monitor& monitor) {
  return build(tissue, std::nullopt, options, monitor);
}

CorticalSurfaces buildSurfaces(const CorticalTissue& tissue, BorderImages images,
                               const SurfaceOptions& options, const Monitor& monitor) {
  return build(tissue, std::move(images), options, monitor);
}

}  // namespace explica::surface
