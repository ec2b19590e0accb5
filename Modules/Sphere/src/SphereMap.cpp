// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sphere/SphereMap.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Stopwatch.h"
#include "Explica/Flattening/Coarsening.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SphereLocator.h"
#include "SphereSolver.h"
#include "Star.h"

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <string>

namespace explica::sphere {
namespace {

using flattening::CoarseningLevel;

constexpr Eigen::Index kCoarsest = 4;  // vertices: a tetrahedron
constexpr double kCorner = 0.1;        // e of MapWeights: areas within a tenth count as kept
constexpr int kCoarseIterations = 60;  // at most: finer levels go on

/// The last four vertices as a regular tetrahedron, faces outwards.
void placeTetrahedron(const Faces& faces, Positions& sphere) {
  constexpr std::array<std::array<double, 3>, 4> kCorners = {
      {{1, 1, 1}, {-1, -1, 1}, {1, -1, -1}, {-1, 1, -1}}};
  std::vector<std::int32_t> vertices(faces.data(), faces.data() + faces.size());
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (std::size_t n = 0; n < vertices.size(); ++n) {
    sphere.row(vertices[n]) = Eigen::RowVector3d(kCorners[n].data()).normalized();
  }
  const Point a = sphere.row(faces(0, 0)), b = sphere.row(faces(0, 1)), c = sphere.row(faces(0, 2));
  if (geometry::sphericalOrientation(a, b, c) < 0) {
    sphere.row(vertices[0]).swap(sphere.row(vertices[1]));
  }
}

double areaOf(const flattening::IntrinsicMesh& mesh) {
  double area = 0;
  for (const RestFace& face : flattening::restFaces(mesh, 1e-3 * mesh.lengths.mean()))
    area += face.area;
  return area;
}

/// Positions relative to the surface's centre of area.
Positions aboutCentre(const TriangleMesh& surface, const Eigen::VectorXd& areas) {
  const Eigen::RowVector3d centre = areas.transpose() * surface.positions / areas.sum();
  return surface.positions.rowwise() - centre;
}

class Ascent {
 public:
  Ascent(const SphereMapOptions& options, Eigen::Index vertexCount, const Monitor& monitor)
      : options_(options),
        weights_{.balance = options.balance, .corner = kCorner},
        monitor_(monitor) {
    map_.positions = Positions::Zero(vertexCount, 3);
  }

  void begin(const CoarseningLevel& level) { placeTetrahedron(level.mesh.faces, map_.positions); }

  /// Puts back what was removed below `level` and lowers its energy.
  void raise(const CoarseningLevel& level, bool finest) {
    const Stopwatch seconds;
    const double scale = std::sqrt(4 * kPi / areaOf(level.mesh));
    for (auto removal = level.removals.rbegin(); removal != level.removals.rend(); ++removal) {
      if (!insert(*removal, scale, weights_, map_.positions)) {
        throw InvalidInput("surface: no room on the sphere for vertex " +
                           std::to_string(removal->vertex) + " in double precision");
      }
    }
    const SphereEnergy energy(level.mesh.faces, restOnUnitSphere(level.mesh), weights_);
    SphereSolver solver(energy, map_.positions.rows());
    const int most = finest ? options_.maxIterations : kCoarseIterations;
    const auto run = solver.lower(map_.positions, most, options_.tolerance, monitor_);
    // What Newton's step cannot lower any more has come to rest.
    map_.termination =
        run.termination == Termination::Stalled ? Termination::Finished : run.termination;
    map_.iterations += run.iterations;
    map_.levels.push_back({level.mesh.faces.rows() / 2 + 2, run.iterations, run.energy, seconds()});
  }

  [[nodiscard]] SphereMap take() { return std::move(map_); }

 private:
  SphereMap map_;
  SphereMapOptions options_;
  MapWeights weights_;
  const Monitor& monitor_;
};

struct Weighed {
  double value, weight;
};

/// The value below which this share of the weight is.
double quantile(std::vector<Weighed> values, double share) {
  std::ranges::sort(values, {}, &Weighed::value);
  double total = 0, sum = 0;
  for (const Weighed& v : values) total += v.weight;
  for (const Weighed& v : values) {
    sum += v.weight;
    if (sum >= share * total) return v.value;
  }
  return values.empty() ? kNaN : values.back().value;
}

}  // namespace

void requireSphere(const TriangleMesh& mesh, std::string_view name) {
  const auto condition = geometry::requireClosedManifold(mesh, name);
  if (condition.components != 1) {
    throw InvalidInput("'" + std::string(name) + "': " + std::to_string(condition.components) +
                       " pieces, where a sphere is one; keep the largest");
  }
  if (condition.eulerCharacteristic != 2) {
    throw InvalidInput("'" + std::string(name) +
                       "': " + std::to_string((2 - condition.eulerCharacteristic) / 2) +
                       " handles (genus), where a sphere has none; correct its topology first");
  }
}

SphereMap mapToSphere(const TriangleMesh& mesh, const SphereMapOptions& options,
                      const Monitor& monitor) {
  requireSphere(mesh, "surface");
  monitor.progress(0, "coarsening");
  const auto levels = flattening::coarsen(flattening::intrinsicOf(mesh), {}, kCoarsest, true);
  Ascent ascent(options, mesh.vertexCount(), monitor);
  ascent.begin(levels.back());
  for (std::size_t n = levels.size() - 1; n-- > 0;) {
    monitor.progress(1 - static_cast<double>(n + 1) / static_cast<double>(levels.size()),
                     std::to_string(levels[n].mesh.faces.rows() / 2 + 2) + " vertices");
    ascent.raise(levels[n], n == 0);
  }
  SphereMap map = ascent.take();
  const Eigen::VectorXd areas = geometry::vertexAreas(mesh);
  map.positions *= bestRotation(map.positions, aboutCentre(mesh, areas), areas).transpose();
  TriangleMesh written{std::move(map.positions), mesh.faces};
  map.rounding = makeOneToOne(written);
  map.positions = std::move(written.positions);
  return map;
}

SphereDistortion sphereDistortion(const TriangleMesh& surface, const Positions& sphere) {
  const auto rest = flattening::restFaces(flattening::intrinsicOf(surface), 0);
  const TriangleMesh image{sphere, surface.faces};
  const Eigen::VectorXd areas = geometry::faceAreas(surface), onSphere = geometry::faceAreas(image);
  SphereDistortion result;
  result.arealLog2.setConstant(surface.faceCount(), kNaN);
  result.stretch.setConstant(surface.faceCount(), kNaN);
  result.turnedOver = static_cast<std::int64_t>(geometry::turnedOver(image).size());
  const double scale = areas.sum() / onSphere.sum();
  std::vector<Weighed> areal, stretch;
  double sum = 0;
  for (Eigen::Index f = 0; f < surface.faceCount(); ++f) {
    if (!(areas[f] > 0) || !(onSphere[f] > 0)) continue;
    const Vector u = image.corner(f, 1) - image.corner(f, 0);
    const Vector v = image.corner(f, 2) - image.corner(f, 0);
    const auto& g = rest[f].gradient;
    const double s = (g[1].real() * u + g[2].real() * v).squaredNorm() +
                     (g[1].imag() * u + g[2].imag() * v).squaredNorm();
    const double k = s * areas[f] / (2 * onSphere[f]);  // (stretch + 1 / stretch) / 2
    result.stretch[f] = k + std::sqrt(std::max(0.0, k * k - 1));
    result.arealLog2[f] = std::log2(scale * onSphere[f] / areas[f]);
    areal.push_back({std::abs(result.arealLog2[f]), areas[f]});
    stretch.push_back({result.stretch[f], areas[f]});
    sum += areal.back().value * areas[f];
  }
  result.arealMean = sum / areas.sum();
  result.arealMax = quantile(areal, 1);
  result.stretchMedian = quantile(stretch, 0.5);
  result.stretchP95 = quantile(stretch, 0.95);
  return result;
}

Eigen::VectorXd meansAtVertices(const TriangleMesh& mesh, const Eigen::VectorXd& ofFaces) {
  const Eigen::VectorXd areas = geometry::faceAreas(mesh);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(mesh.vertexCount()), weight = sum;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    if (!std::isfinite(ofFaces[f])) continue;
    for (int k = 0; k < 3; ++k) {
      sum[mesh.faces(f, k)] += areas[f] * ofFaces[f];
      weight[mesh.faces(f, k)] += areas[f];
    }
  }
  return sum.cwiseQuotient(weight);
}

Eigen::Matrix3d bestRotation(const Positions& moving, const Positions& fixed,
                             const Eigen::VectorXd& weights) {
  const Eigen::Matrix3d moments = fixed.transpose() * weights.asDiagonal() * moving;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(moments, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d signs(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant());
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

}  // namespace explica::sphere
