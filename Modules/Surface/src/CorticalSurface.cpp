// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Surface/CorticalSurface.h"

#include "AnnulusBetween.h"
#include "AstrayPaths.h"
#include "ColumnMeasures.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Correspondence/Correspondence.h"
#include "Explica/Geometry/FaceTree.h"
#include "Explica/Geometry/IsoSurface.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Maps/Folding.h"
#include "Explica/Surface/GivenSurfaces.h"
#include "Explica/Surface/Measures.h"
#include "Explica/Surface/Remesh.h"
#include "Growth.h"
#include "GuardedMesh.h"
#include "ImageBorder.h"
#include "KeepRoom.h"
#include "LevelOfEnds.h"
#include "MendTogether.h"
#include "OntoLevel.h"
#include "PathProfile.h"
#include "Relaxation.h"
#include "RibbonPaths.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace explica::surface {
namespace {

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

/// The image makes no face of the white surface less high than this, edges.
constexpr double kLeastHeight = 0.1;
/// Longest edge that is left, in mean ones: 4 mm where these are 1.29 mm.
constexpr double kLongestEdge = 3.1;
/// Farthest that smoothing may take a vertex across its surface in one sweep, voxels.
constexpr double kRoughness = 0.2;
/// In which the outer surface grows, even: 2 or 20 move the pial area of bert by 0.01 %.
constexpr int kGrowthSteps = 6;
/// Sweeps of each relaxation of the outer surface, which then grows again: a relaxation shrinks
/// crowns and opens closed sulci where it slides vertices far.
constexpr std::array kRelaxations = {16, 4, 4};

Point stayThere(std::int32_t, const Point& point, const Vector&) {
  return point;
}

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

/// Columns of tissue upon the white surface.
struct GrowingColumns {
  CorticalTissue tissue;  ///< corrected
  std::vector<Trajectory> paths;
};

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

/// Where a path no longer leaves white matter behind: from there surfaces that grew along it would
/// crowd on the floor of a sulcus, or pass into the other bank's columns.
/// @param face   of the white surface near the path's start
/// @param first  least arc length, mm
/// @return arc length; the path's own if it leaves white matter behind everywhere
double stallOf(const geometry::FaceTree& white, std::int32_t face, double voxel, double first,
               const Trajectory& path) {
  // Along the middle between fronts that meet at 120 degrees, distance grows at half the rate of
  // the way.
  constexpr double kRate = 0.5;
  constexpr double kWindow = 0.5;  // voxels
  const auto distanceAt = [&](double arc) {
    const auto nearest = white.closestPoint(path.at(arc), face);
    face = nearest.face;
    return std::sqrt(nearest.squaredDistance);
  };
  const double window = kWindow * voxel, length = path.length();
  if (length - first < 0.5 * window) return length;
  const double last = distanceAt(length), gained = last - distanceAt(0);
  if (length - gained < 0.5 * (1 - kRate) * window) return length;  // what it need not look at
  // Window k goes from place k to place k + 2.
  std::vector<double> places = {first, std::min(first + 0.5 * window, length)};
  for (double from = first; from < length; from += 0.5 * window) {
    places.push_back(std::min(from + window, length));
  }
  std::vector<double> distances(places.size(), kNaN);
  const auto at = [&](std::size_t k) {
    if (std::isnan(distances[k])) distances[k] = places[k] < length ? distanceAt(places[k]) : last;
    return distances[k];
  };
  // The first of some windows along which distance grows too little, or the number of all.  It
  // grows no more than the way: what is missing of it is no more in one of them than in all.
  const std::size_t windows = places.size() - 2;
  const auto firstSlow = [&](const auto& self, std::size_t begin, std::size_t end) -> std::size_t {
    const double shortest = std::max(0.5 * window, places[end + 1] - places[end - 1]);
    const double way = places[end + 1] - places[begin];
    if (way - (at(end + 1) - at(begin)) <= (1 - kRate) * shortest) return windows;
    if (end - begin == 1) return way >= 0.5 * window ? begin : windows;
    const std::size_t middle = (begin + end) / 2, found = self(self, begin, middle);
    return found < windows ? found : self(self, middle, end);
  };
  const std::size_t slow = windows > 0 ? firstSlow(firstSlow, 0, windows) : 0;
  return slow < windows ? places[slow] : length;
}

/// Trajectories from the white vertices that have tissue upon them.
void takePaths(const TriangleMesh& white, const RibbonPaths& ribbon, GrowingColumns& columns) {
  const LevelSet& tissue = columns.tissue.tissue;
  constexpr double kOff = 0.125;  // voxels: so far outward tissue begins, or there is none
  const double voxel = voxelSize(tissue.grid), off = kOff * voxel;
  const Positions normals = geometry::vertexNormals(white);
  const std::vector<std::int32_t> faceAt = geometry::faceOfEachVertex(white);
  const geometry::FaceTree tree(white);
  std::vector<Trajectory>& paths = columns.paths;
  paths.resize(white.vertexCount());
  parallelFor(paths.size(), 256, [&](std::size_t v) {
    const auto row = static_cast<Eigen::Index>(v);
    const Point start = white.positions.row(row);
    const Vector normal = normals.row(row);
    Trajectory& path = paths[v];
    path = sample(tissue, start + off * normal).value > 0 ? ribbon.outwardFrom(start, normal)
                                                          : ribbon.none(start);
    if (path.end == TrajectoryEnd::NoRibbon) return;
    // Beside a bank's sheet there may be fluid, too.
    if (sample(tissue, along(path, path.length() + 4 * off)).value <= 0) {
      path.end = TrajectoryEnd::Outer;
    }
    const double stall = stallOf(tree, faceAt[v], voxel, 0.25 * voxel, path);
    if (stall < path.length()) {
      cut(path, stall);
      path.end = TrajectoryEnd::Bank;
    }
  });
  keepFromMiddles(middleGap(tissue.grid), paths);
}

/// The tissue with its white matter's topology corrected.
CorticalTissue corrected(CorticalTissue tissue, const LevelSet& white) {
  tissue.white = white;
  for (std::size_t v = 0; v < white.size(); ++v) {
    tissue.tissue[v] = std::max(tissue.tissue[v], white[v]);
  }
  return tissue;
}

/// What the surfaces keep clear of themselves.
Room roomOf(const WhiteSurface& white) {
  return roomFor(voxelSize(white.level.grid), white.edgeLength);
}

/// Height of a triangle over its longest edge.
double heightOf(const Point& a, const Point& b, const Point& c) {
  const double longest = std::max({(a - b).norm(), (b - c).norm(), (c - a).norm()});
  return longest > 0 ? (b - a).cross(c - a).norm() / longest : 0;
}

/// True if a move would make a face lower than `least` mm, and lower than it is.
bool flattens(const GuardedMesh& mesh, std::int32_t v, const Point& to, double least) {
  const auto& ring = mesh.facesOf(v);
  return std::any_of(ring.begin(), ring.end(), [&](std::int32_t f) {
    const auto& c = mesh.face(f);
    std::array<Point, 3> now = {mesh.at(c[0]), mesh.at(c[1]), mesh.at(c[2])}, then = now;
    then[std::find(c.begin(), c.end(), v) - c.begin()] = to;
    const double height = heightOf(then[0], then[1], then[2]);
    return height < least && height < heightOf(now[0], now[1], now[2]);
  });
}

/// Moves the white surface and the tissue's outer border to where an image changes most steeply.
void placeByImage(const BorderImages& images, double fluid, GrowingColumns& ribbon,
                  CorticalSurfaces& result) {
  const double voxel = voxelSize(ribbon.tissue.white.grid);
  TriangleMesh& white = result.white.mesh;
  ImageBorderOptions options;
  options.fluid = fluid;
  options.search = ribbon.tissue.byBrightness;
  const LevelSet inner = distanceLevelOf(ribbon.tissue.white);
  const ImageBorders borders = findBorders(ribbon.paths, white, inner, images, voxel, options);
  result.image.missingWhite = borders.missingWhite;
  result.image.missingOuter = borders.missingOuter;
  result.image.voxel = voxel;
  result.image.doubt = borders.doubt;

  GuardedMesh mesh(white, result.white.edgeLength);
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(white.vertexCount());
  const double least = kLeastHeight * result.white.edgeLength;
  // In steps, so that neighbours make way for each other.
  for (const double share : {0.25, 0.5, 0.75, 1.0, 1.0}) {
    mesh.sweep([&](std::int32_t v, GuardedMesh::Scratch& scratch) {
      const double wanted = share * borders.white[v];
      if (moved[v] == wanted) return true;
      const Point to = between(ribbon.paths[v], wanted, wanted + voxel).points[0];
      if (flattens(mesh, v, to, least) || !mesh.move(v, to, scratch)) return false;
      moved[v] = wanted;
      return true;
    });
  }
  RelaxationOptions mending;
  mending.sweeps = 0;
  white = relaxed(mesh.toMesh(), result.white.edgeLength, {}, stayThere, mending);
  keepRoom(white, roomOf(result.white));
  CorticalTissue& tissue = ribbon.tissue;
  tissue.tissue =
      levelOfEnds(distanceLevelOf(tissue.tissue), ribbon.paths, PathBorder::Outer, borders.outer);
  const LevelSet moving = levelOfEnds(inner, ribbon.paths, PathBorder::Inner, moved);
  tissue = corrected(std::move(tissue), moving);
  tissue.ofLabels = false;  // the levels say more than the labels
  result.image.movedWhite = moved.cwiseAbs().mean();
  result.image.movedOuter = borders.outer.cwiseAbs().mean();
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

  Growth growth(result.white.mesh, ribbon.paths);
  for (int step = 1; step <= kGrowthSteps; ++step) {
    monitor.progress(static_cast<double>(step) / (kGrowthSteps + 1), "growing the outer surface");
    growth.goTo(static_cast<double>(step) / kGrowthSteps);
    if (2 * step == kGrowthSteps) {
      for (std::size_t v = 0; v < moves.size(); ++v) {
        result.heldBackMid += growth.missing(v) > kNoShortfall * voxel;
      }
      result.mid = relaxed(growth.mesh(), edge, moves, stayThere, sliding);
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
  // A mesh whose edges are longer cuts off what the grid shows.
  constexpr double kFineEdge = 1.5;  // voxels
  const bool isFine = result.white.edgeLength <= kFineEdge * voxelSize(tissue.white.grid);
  const bool byMesh = images && isFine;
  if (images) {
    const correspondence::Ribbon ofLabels =
        solve(annulusOf(ribbon.tissue, silent(monitor)), monitor.part(0.5, 0.6));
    takePaths(result.white.mesh, RibbonPaths(ofLabels), ribbon);
    placeByImage(*images, options.fluid, ribbon, result);
    images.reset();
    result.seconds.image = watch.lap();
  }
  const correspondence::Ribbon first =
      solve(byMesh ? annulusBetween(result.white.mesh, ribbon.tissue, silent(monitor))
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
  if (byMesh && hasLongVoxels(ribbon.tissue.insulated.grid)) {
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
