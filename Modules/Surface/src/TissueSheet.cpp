// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Surface/TissueSheet.h"

#include "ColumnMeasures.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Stopwatch.h"
#include "Explica/Correspondence/Correspondence.h"
#include "Explica/Correspondence/ImageEdge.h"
#include "Explica/Correspondence/Ribbon.h"
#include "Explica/Geometry/IsoSurface.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Maps/Folding.h"
#include "Explica/Surface/GivenSurfaces.h"
#include "Explica/Surface/Measures.h"
#include "Explica/Surface/Regions.h"
#include "Explica/Surface/Remesh.h"
#include "Growth.h"
#include "KeepRoom.h"
#include "Masks.h"
#include "OntoLevel.h"
#include "Relaxation.h"
#include "RibbonPaths.h"
#include "SheetMesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

namespace explica::surface {
namespace {

using correspondence::Ribbon;
using correspondence::TrajectoryTracer;
using harmonic::Annulus;
using harmonic::Site;

/// Lengths beside the tissue's thickness t: patches without tissue and pieces of the sheet with
/// less area than that of a disc of this radius are small, and so are holes whose rim is shorter
/// than that of such a disc.
constexpr double kSmallPatch = 1, kSmallPiece = 2, kSmallHole = 0.75;
/// Largest pocket in the tissue, as a share of it, that is filled.
constexpr double kPocket = 0.02;
/// In which a sheet grows from the middle to either side.
constexpr int kSheetSteps = 3;

/// Pieces of one role that only tissue surrounds become tissue: vessels, specks, lost voxels.
std::int64_t fillPockets(Volume<Site>& roles) {
  const Grid& grid = roles.grid;
  const auto tissue = std::count(roles.data.begin(), roles.data.end(), Site::Tissue);
  const auto most = static_cast<std::size_t>(kPocket * static_cast<double>(tissue));
  std::vector<std::uint8_t> seen(roles.size(), 0);
  std::vector<std::size_t> piece;
  std::int64_t filled = 0;
  for (std::size_t start = 0; start < roles.size(); ++start) {
    if (seen[start] || roles[start] == Site::Tissue) continue;
    const Site role = roles[start];
    bool enclosed = true;
    piece.assign(1, start);
    seen[start] = 1;
    for (std::size_t head = 0; head < piece.size(); ++head) {
      for (const std::int64_t w : grid.neighbours(piece[head])) {
        enclosed = enclosed && w >= 0 && (roles[w] == role || roles[w] == Site::Tissue);
        if (w < 0 || roles[w] != role || std::exchange(seen[w], 1) != 0) continue;
        piece.push_back(static_cast<std::size_t>(w));
      }
    }
    if (!enclosed || piece.size() > most) continue;
    for (const std::size_t v : piece) roles[v] = Site::Tissue;
    ++filled;
  }
  return filled;
}

Volume<Site> sitesOf(const TissueMasks& masks) {
  Volume<Site> sites(masks.white.grid, Site::Outer);
  for (std::size_t v = 0; v < sites.size(); ++v) {
    if (masks.white[v]) {
      sites[v] = Site::Inner;
    } else if (masks.grey[v]) {
      sites[v] = Site::Tissue;
    } else if (masks.insulated[v]) {
      sites[v] = Site::Insulated;
    }
  }
  return sites;
}

Ribbon solve(const Volume<Site>& sites, const Monitor& monitor) {
  if (std::find(sites.data.begin(), sites.data.end(), Site::Outer) == sites.data.end()) {
    throw InvalidInput("labels: nothing lies outside of the tissue");
  }
  Monitor stoppable = monitor;
  stoppable.onProgress = nullptr;
  Ribbon ribbon = correspondence::solveRibbon(harmonic::annulusFromSites(sites, {}, stoppable),
                                              correspondence::SulcusOptions{}, {}, stoppable);
  checkpoint(monitor);
  return ribbon;
}

/// The interpolant on a box, as a level set whose zero is the sheet; positive inside of it.
struct SheetLevel {
  LevelSet level;
  Volume<std::uint8_t> known;   ///< 0 where tissue ends without boundary
  Volume<std::uint8_t> tissue;  ///< 1 in tissue
};

SheetLevel levelOf(const Ribbon& field) {
  const Annulus& annulus = field.annulus;
  const Grid grid = gridOf(annulus.grid, {annulus.first, annulus.size});
  SheetLevel sheet{LevelSet(grid), Volume<std::uint8_t>(grid, 1), Volume<std::uint8_t>(grid, 0)};
  parallelFor(sheet.level.size(), 1 << 15, [&](std::size_t p) {
    const std::int32_t n = annulus.numberAt[p];
    float value = 0;
    if (n >= 0) {
      value = static_cast<float>(1 - 2 * field.interpolant.u[n]);
      sheet.tissue[p] = 1;
    } else if (n == harmonic::kInsulated) {
      sheet.known[p] = 0;
    } else {
      value = n == harmonic::kInner ? 1.0F : -1.0F;
    }
    sheet.level[p] = offZero(value);
  });
  return sheet;
}

/// Where the level is not known it goes on as its neighbours have it, so that it can be sampled
/// beside rims.
void carryOn(SheetLevel& sheet) {
  constexpr int kRounds = 2;
  const Grid& grid = sheet.level.grid;
  Volume<std::uint8_t> has = sheet.known;
  for (int round = 0; round < kRounds; ++round) {
    const Volume<std::uint8_t> before = has;
    parallelFor(grid.size[2], 1, [&](std::size_t slice) {
      const int k = static_cast<int>(slice);
      for (int j = 0; j < grid.size[1]; ++j) {
        for (int i = 0; i < grid.size[0]; ++i) {
          if (before(i, j, k)) continue;
          float sum = 0;
          int count = 0;
          for (int n = 0; n < 27; ++n) {
            const int x = i + n % 3 - 1, y = j + n / 3 % 3 - 1, z = k + n / 9 - 1;
            if (!grid.contains(x, y, z) || !before(x, y, z)) continue;
            sum += sheet.level(x, y, z);
            ++count;
          }
          if (count == 0) continue;
          sheet.level(i, j, k) = sum / static_cast<float>(count);
          has(i, j, k) = 1;
        }
      }
    });
  }
}

/// Faces of cells without tissue: there the inner and the outer region touch.
std::vector<std::uint8_t> bareFaces(const TriangleMesh& mesh, const SheetLevel& sheet) {
  const Grid& grid = sheet.tissue.grid;
  std::vector<std::uint8_t> bare(mesh.faceCount());
  parallelFor(bare.size(), 1 << 12, [&](std::size_t f) {
    const auto face = static_cast<Eigen::Index>(f);
    const Point middle = (mesh.corner(face, 0) + mesh.corner(face, 1) + mesh.corner(face, 2)) / 3;
    const Vector index = grid.toIndex(middle);
    bool tissue = false;
    for (int c = 0; c < 8; ++c) {
      const int i = static_cast<int>(std::floor(index[0])) + (c & 1);
      const int j = static_cast<int>(std::floor(index[1])) + (c >> 1 & 1);
      const int k = static_cast<int>(std::floor(index[2])) + (c >> 2);
      tissue = tissue || (grid.contains(i, j, k) && sheet.tissue(i, j, k));
    }
    bare[f] = !tissue;
  });
  return bare;
}

/// True if a point lies on the edge of the image: among the centres of its outermost voxels.
bool onImageEdge(const Grid& image, const Point& point) {
  constexpr double kRounded = 0.3;  // voxels, as far as remeshing may have rounded a rim
  const Vector index = image.toIndex(point);
  for (int a = 0; a < 3; ++a) {
    if (index[a] < kRounded || index[a] > image.size[a] - 1 - kRounded) return true;
  }
  return false;
}

/// The sheet before it is remeshed.
TriangleMesh extractSheet(const Ribbon& field, const SheetLevel& sheet, SheetFacts& facts) {
  TriangleMesh mesh = geometry::extractIsoSurface(sheet.level, sheet.known);
  const double thickness = static_cast<double>(field.annulus.count()) *
                           field.annulus.grid.voxelVolume() / geometry::totalArea(mesh);
  const auto disc = [&](double radii) { return kPi * std::pow(radii * thickness, 2); };
  mesh = withoutFaces(mesh, largePatches(mesh, bareFaces(mesh, sheet), disc(kSmallPatch)));
  mesh = withoutPinches(mesh);
  if (mesh.faceCount() == 0) throw InvalidInput("labels: the tissue holds no sheet");
  Pieces pieces = largePieces(mesh, disc(kSmallPiece));
  facts.piecesLeftOut = pieces.leftOut;
  const Grid& image = field.annulus.grid;
  const auto reachesEdge = [&](const std::vector<std::int32_t>& rim) {
    return std::any_of(rim.begin(), rim.end(), [&](std::int32_t v) {
      return onImageEdge(image, pieces.mesh.positions.row(v));
    });
  };
  Closed closed = withHolesClosed(pieces.mesh, 2 * kPi * kSmallHole * thickness, reachesEdge);
  facts.holesClosed = closed.holes;
  return std::move(closed.mesh);
}

/// The ways from each vertex of the sheet to both boundaries.
struct Ways {
  std::vector<Trajectory> inward, outward;
};

Ways traceWays(const RibbonPaths& ribbon, const TriangleMesh& sheet) {
  Ways ways;
  ways.inward.resize(sheet.vertexCount());
  ways.outward.resize(sheet.vertexCount());
  parallelFor(ways.inward.size(), 256, [&](std::size_t v) {
    const Point start = sheet.positions.row(static_cast<Eigen::Index>(v));
    ways.inward[v] = ribbon.from(start, 0);
    ways.outward[v] = ribbon.from(start, 1);
    if (ways.inward[v].end == TrajectoryEnd::NoRibbon) ways.outward[v] = ways.inward[v];
    if (ways.outward[v].end == TrajectoryEnd::NoRibbon) ways.inward[v] = ways.outward[v];
  });
  return ways;
}

/// Straight ways, the mean of the neighbours', for vertices that have none.
std::int64_t interpolateWays(const TriangleMesh& sheet, Ways& ways,
                             std::vector<std::uint8_t>& own) {
  const auto topology = geometry::buildTopology(sheet.faces, sheet.vertexCount());
  own.assign(ways.inward.size(), 1);
  std::vector<std::int32_t> missing;
  for (std::size_t v = 0; v < own.size(); ++v) {
    if (ways.inward[v].end != TrajectoryEnd::NoRibbon) continue;
    own[v] = 0;
    missing.push_back(static_cast<std::int32_t>(v));
  }
  const auto count = static_cast<std::int64_t>(missing.size());
  std::vector<std::uint8_t> has = own;
  for (bool any = true; any && !missing.empty();) {
    any = false;
    const std::vector<std::uint8_t> before = has;
    for (const std::int32_t v : missing) {
      Vector in = Vector::Zero(), out = Vector::Zero();
      int neighbours = 0;
      for (const std::int32_t w : topology.vertexVertices[v]) {
        if (!before[w]) continue;
        in += ways.inward[w].points.back() - ways.inward[w].points.front();
        out += ways.outward[w].points.back() - ways.outward[w].points.front();
        ++neighbours;
      }
      if (neighbours == 0) continue;
      has[v] = 1;
      any = true;
      const auto straight = [&](Trajectory& path, const Vector& way) {
        path.points.push_back(path.points.front() + way / neighbours);
        path.along.push_back(static_cast<float>(way.norm() / neighbours));
        path.end = TrajectoryEnd::Outer;
      };
      straight(ways.inward[v], in);
      straight(ways.outward[v], out);
    }
    std::erase_if(missing, [&](std::int32_t v) { return has[v] != 0; });
  }
  return count;
}

/// The way to half depth.
std::vector<Trajectory> waysToMiddle(const Ways& ways) {
  std::vector<Trajectory> middle(ways.inward.size());
  for (std::size_t v = 0; v < middle.size(); ++v) {
    const double off = 0.5 * (ways.outward[v].length() - ways.inward[v].length());
    const Trajectory& along = off > 0 ? ways.outward[v] : ways.inward[v];
    middle[v].points = {along.points.front(), along.at(std::abs(off))};
    middle[v].along = {0, static_cast<float>(std::abs(off))};
    middle[v].end = TrajectoryEnd::Outer;
  }
  return middle;
}

struct Grown {
  TriangleMesh mesh;
  std::int64_t heldBack = 0;
  double missing = 0;  ///< mm, summed over those
  double most = 0;     ///< mm
};

/// How far a point is from where a sheet belongs, mm; infinite if that is not known.
using Shortfall = std::function<double(const Point&)>;

/// @param least  of what is counted as held back, mm
Grown grow(const TriangleMesh& sheet, const std::vector<Trajectory>& paths, double edge, int steps,
           double least, const Placement& place, const Shortfall& shortfall, const Room& room,
           const RelaxationOptions& relaxation) {
  std::vector<std::uint8_t> moves(paths.size());
  for (std::size_t v = 0; v < moves.size(); ++v) moves[v] = paths[v].length() > 0;
  Growth growth(sheet, paths);
  for (int step = 1; step <= steps; ++step) growth.goTo(static_cast<double>(step) / steps);
  Grown grown;
  grown.mesh = relaxed(growth.mesh(), edge, moves, place, relaxation);
  keepRoom(grown.mesh, room);
  for (std::size_t v = 0; v < paths.size(); ++v) {
    double missing = growth.missing(v);
    if (missing <= least) continue;
    // What has waited on its trajectory may have come to the border by sliding.
    missing = std::min(missing, shortfall(grown.mesh.positions.row(static_cast<Eigen::Index>(v))));
    if (missing <= least) continue;
    ++grown.heldBack;
    grown.missing += missing;
    grown.most = std::max(grown.most, missing);
  }
  return grown;
}

/// Marks vertices in whose column the image's edge may have changed a voxel's thickness.
void markCut(const Annulus& annulus, const std::vector<std::uint8_t>& nearEdge,
             CorticalSurfaces& made) {
  Volume<Label> marks(annulus.grid, 0);
  for (std::size_t n = 0; n < nearEdge.size(); ++n) {
    marks[annulus.linear(static_cast<std::int32_t>(n))] = nearEdge[n];
  }
  const VertexKeys cut = labelsWithin(marks, made.white.mesh.positions, made.pial.positions,
                                      [](Label) { return true; });
  for (Eigen::Index v = 0; v < cut.size(); ++v) {
    if (cut[v] == 0) continue;
    made.sheet.known[static_cast<std::size_t>(v)] = 0;
    ++made.sheet.cutByImage;
  }
}

/// Inner, middle and outer surface out of the sheet.
void growSheets(const TriangleMesh& sheet, const Ways& ways, const RibbonPaths& ribbon,
                CorticalSurfaces& made) {
  const TrajectoryTracer& tracer = ribbon.tracer();
  const double edge = made.white.edgeLength;
  const double voxel = voxelSize(tracer.annulus().grid);
  const auto backTo = [&](double target) {
    return [&ribbon, &tracer, target, voxel](std::int32_t, const Point& point, const Vector&) {
      const correspondence::Trace trace = tracer.trace(point, target);
      if (!trace.reached || (trace.point - point).norm() > kNearBorder * voxel) return point;
      if (target == 0 || !ribbon.isBank(trace.point)) return trace.point;
      const auto outward = tracer.direction(point);
      return outward ? Point(trace.point - middleGap(tracer.annulus().grid) * *outward) : point;
    };
  };
  const auto shortOf = [&](double target) -> Shortfall {
    return [&tracer, target](const Point& point) {
      const correspondence::Trace trace = tracer.trace(point, target);
      return trace.reached ? (trace.point - point).norm() : kInfinity;
    };
  };
  const Shortfall unknown = [](const Point&) { return kInfinity; };
  const Room room = roomFor(voxel, edge);
  const auto stay = [](std::int32_t, const Point& point, const Vector&) { return point; };
  RelaxationOptions relaxation;
  relaxation.most *= voxel;
  RelaxationOptions sliding = relaxation;
  sliding.bend = 0;
  sliding.sweeps = 4;
  const double least = kNoShortfall * voxel;
  Grown inner =
      grow(sheet, ways.inward, edge, kSheetSteps, least, backTo(0), shortOf(0), room, relaxation);
  std::vector<Trajectory> outward = ways.outward;
  keepFromMiddles(middleGap(tracer.annulus().grid), outward);
  Grown outer =
      grow(sheet, outward, edge, kSheetSteps, least, backTo(1), shortOf(1), room, relaxation);
  Grown middle = grow(sheet, waysToMiddle(ways), edge, 2, least, stay, unknown, room, sliding);
  made.white.mesh = std::move(inner.mesh);
  made.pial = std::move(outer.mesh);
  made.mid = std::move(middle.mesh);
  made.heldBackMid = middle.heldBack;
  made.heldBackPial = outer.heldBack + inner.heldBack;
  if (made.heldBackPial > 0) {
    made.heldBackMean = (outer.missing + inner.missing) / static_cast<double>(made.heldBackPial);
  }
  made.heldBackMost = std::max(outer.most, inner.most);
}

}  // namespace

CorticalSurfaces buildSheets(const TissueMasks& masks, const SurfaceOptions& options,
                             const Monitor& monitor) {
  if (masks.greyVoxels == 0) throw InvalidInput("grey: no voxel found; a sheet needs grey matter");
  CorticalSurfaces made;
  SheetFacts& facts = made.sheet;
  facts.open = true;
  Stopwatch watch;
  monitor.progress(0, "pockets in the tissue");
  Volume<Site> sites = sitesOf(masks);
  facts.pocketsFilled = fillPockets(sites);
  made.seconds.topology = watch.lap();
  monitor.progress(0.05, "harmonic interpolant");
  const Ribbon field = solve(sites, monitor);
  made.cutLinks = static_cast<std::int64_t>(field.sulcalVoxels.size());
  made.seconds.interpolant = watch.lap();

  monitor.progress(0.25, "extracting the sheet");
  SheetLevel level = levelOf(field);
  const TriangleMesh raw = extractSheet(field, level, facts);
  carryOn(level);
  made.seconds.extraction = watch.lap();
  monitor.progress(0.3, "remeshing");
  RemeshOptions remeshing;
  remeshing.faces = options.faces;
  remeshing.open = true;
  Monitor warnings = monitor;
  warnings.onProgress = nullptr;
  RemeshResult remeshed = remesh(raw, level.level, remeshing, warnings);
  const TriangleMesh sheet = std::move(remeshed.mesh);
  made.white.edgeLength = remeshed.edgeLength;
  made.seconds.remeshing = watch.lap();

  monitor.progress(0.6, "trajectories");
  const RibbonPaths ribbon(field);
  Ways ways = traceWays(ribbon, sheet);
  facts.interpolated = interpolateWays(sheet, ways, facts.known);
  made.thickness.resize(sheet.vertexCount());
  for (std::size_t v = 0; v < ways.inward.size(); ++v) {
    made.thickness[static_cast<Eigen::Index>(v)] =
        ways.inward[v].length() + ways.outward[v].length();
  }
  made.seconds.trajectories = watch.lap();
  monitor.progress(0.7, "growing the surfaces");
  growSheets(sheet, ways, ribbon, made);
  made.seconds.growing = watch.lap();

  monitor.progress(0.95, "curvature");
  made.curvature = maps::meanCurvature(made.white.mesh);
  made.nearestThickness = distanceThickness(made.white.mesh, made.pial);
  facts.rims =
      static_cast<std::int64_t>(geometry::boundaryLoops(sheet.faces, sheet.vertexCount()).size());
  const auto found = correspondence::findCorrespondences(field.annulus, field.interpolant);
  const Eigen::VectorXd ofVoxels = thicknessAtVertices(field.annulus, found, made.mid);
  made.thickness = ofVoxels.array().isNaN().select(made.thickness, ofVoxels);
  const auto nearEdge = correspondence::nearImageEdge(field.annulus, {true, true, true}, found);
  markCut(field.annulus, nearEdge, made);
  made.columns = columnsOf(field.annulus, found);
  const Columns known = columnsOf(field.annulus, found, nearEdge);
  facts.thicknessKnown = meanThickness(known.area, known.thickness);
  made.noRibbon = (made.thickness.array() == 0).count();
  made.seconds.measures = watch.lap();
  monitor.progress(1, "surfaces");
  return made;
}

}  // namespace explica::surface
