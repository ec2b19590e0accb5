// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sphere/Register.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "FoldingPyramid.h"
#include "RotationSearch.h"
#include "SphereSolver.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <string>

namespace explica::sphere {
namespace {

constexpr int kCoarsestLevel = 3;       // 642 vertices, 8 degrees apart
constexpr int kMeeting = 4;             // level after which maps of both directions go on as one's
constexpr int kIterations = 30;         // of a level
constexpr std::size_t kFewer = 4;       // times as many starts on a level as on the next finer
constexpr double kTolerance = 1e-4;     // of the energy, of which most is what no map goes below
constexpr double kBarrier = 1e-2;       // b of MapWeights: felt near the bound only
constexpr double kMarginALevel = 0.05;  // of the bound, kept on coarser levels for the finer

/// Squared differences of the moving maps at the vertices' places and the target's at the vertices,
/// each with the mean of its shares of both spheres, so that of the inverse map it is the same.
class FoldingEnergy final : public VertexEnergy {
 public:
  FoldingEnergy(const FoldingLevel& moving, const FoldingLevel& target)
      : moving_(moving),
        target_(target),
        faces_(target.grid->mesh().faces),
        share_(geometry::faceAreas(target.grid->mesh())),
        near_(static_cast<std::size_t>(target.grid->mesh().vertexCount()), 0) {
    share_ /= share_.sum();
  }

  [[nodiscard]] double value(const Positions& sphere) const override {
    std::vector<double> values(static_cast<std::size_t>(sphere.rows()));
    parallelFor(values.size(), [&](std::size_t v) { values[v] = at(sphere, v).value; });
    double sum = 0;
    for (Eigen::Index f = 0; f < faces_.rows(); ++f)
      sum += bothShares(sphere, f) * meanOf(values, f);
    return sum;
  }

  /// The Hessian is that of Gauss and Newton at fixed shares.
  void add(const Positions& sphere, const std::vector<TangentFrame>& frames,
           geometry::FaceSystem& system) const override {
    std::vector<double> values(static_cast<std::size_t>(sphere.rows()));
    Eigen::VectorXd share = Eigen::VectorXd::Zero(sphere.rows());
    for (Eigen::Index f = 0; f < faces_.rows(); ++f)
      for (int k = 0; k < 3; ++k) share[faces_(f, k)] += bothShares(sphere, f) / 3;
    parallelFor(values.size(), [&](std::size_t v) {
      const Terms terms = at(sphere, v);
      const auto vertex = static_cast<std::int32_t>(v);
      values[v] = terms.value;
      for (std::size_t m = 0; m < 2; ++m) {
        const Eigen::Vector2d slope = frames[v].transpose() * terms.slope[m];
        const double weight = 2 * share[vertex] * terms.weight[m];
        system.gradientAt(vertex) += weight * terms.residual[m] * slope;
        system.diagonalAt(vertex) += weight * slope * slope.transpose();
      }
    });
    for (Eigen::Index f = 0; f < faces_.rows(); ++f) {
      for (int k = 0; k < 3; ++k) {
        const Vector a = sphere.row(faces_(f, (k + 1) % 3)), b = sphere.row(faces_(f, (k + 2) % 3));
        const std::int32_t v = faces_(f, k);
        system.gradientAt(v) += meanOf(values, f) / (16 * kPi) * frames[v].transpose() * a.cross(b);
      }
    }
  }

 private:
  struct Terms {
    double value = 0;
    std::array<double, 2> residual{}, weight{};
    std::array<Vector, 2> slope;
  };

  /// Mean of a face's shares of the areas of the target's and of the moving unit sphere.
  [[nodiscard]] double bothShares(const Positions& y, Eigen::Index f) const {
    const Vector a = y.row(faces_(f, 0)), b = y.row(faces_(f, 1)), c = y.row(faces_(f, 2));
    return (share_[f] + a.dot((b - a).cross(c - a)) / (8 * kPi)) / 2;
  }
  [[nodiscard]] double meanOf(const std::vector<double>& values, Eigen::Index f) const {
    return (values[faces_(f, 0)] + values[faces_(f, 1)] + values[faces_(f, 2)]) / 3;
  }

  /// A map that is linear on a face is s = (n . y) / (m . y) of directions y.
  [[nodiscard]] Terms at(const Positions& sphere, std::size_t v) const {
    const auto vertex = static_cast<Eigen::Index>(v);
    const Point y = sphere.row(vertex).transpose();
    const auto place = moving_.grid->locate(y, near_[v]);
    near_[v] = place.face;
    const TriangleMesh& mesh = moving_.grid->mesh();
    std::array<Vector, 3> normals;
    for (int k = 0; k < 3; ++k)
      normals[k] = mesh.corner(place.face, (k + 1) % 3).cross(mesh.corner(place.face, (k + 2) % 3));
    const Vector sum = normals[0] + normals[1] + normals[2];
    Terms terms;
    for (std::size_t m = 0; m < 2; ++m) {
      Vector n = Vector::Zero();
      for (int k = 0; k < 3; ++k) n += moving_.maps[m][mesh.faces(place.face, k)] * normals[k];
      const double s = n.dot(y) / sum.dot(y);
      terms.slope[m] = (n - s * sum) / sum.dot(y);
      terms.residual[m] = s - target_.maps[m][vertex];
      terms.weight[m] = target_.weights[m][vertex];
      terms.value += terms.weight[m] * terms.residual[m] * terms.residual[m];
    }
    return terms;
  }

  const FoldingLevel& moving_;
  const FoldingLevel& target_;
  const Faces& faces_;
  Eigen::VectorXd share_;                   ///< of each face
  mutable std::vector<std::int32_t> near_;  ///< where each vertex was last; its own only
};

/// Rest shapes of an icosphere's faces on the unit sphere, with a weight on their energy.
SphereEnergy regularity(const TriangleMesh& grid, double smoothness, double maxAreal) {
  auto rest = restOnUnitSphere(flattening::intrinsicOf(grid));
  return {grid.faces, std::move(rest), {1, maxAreal, kBarrier, smoothness, true}};
}

/// The map on the next finer icosphere: new vertices amid the ends of their edges.
Positions refined(const TriangleMesh& coarse, const TriangleMesh& fine, const Positions& places) {
  Positions result(fine.vertexCount(), 3);
  result.topRows(coarse.vertexCount()) = places;
  // A new vertex has two old neighbours; they are the ends of its edge.
  std::vector<std::array<std::int32_t, 2>> ends(static_cast<std::size_t>(fine.vertexCount()),
                                                {-1, -1});
  for (Eigen::Index f = 0; f < fine.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t v = fine.faces(f, k), u = fine.faces(f, (k + 1) % 3);
      for (const auto& [a, b] : {std::pair{v, u}, std::pair{u, v}}) {
        if (a < coarse.vertexCount() || b >= coarse.vertexCount()) continue;
        auto& pair = ends[a];
        if (pair[0] < 0 || pair[0] == b) {
          pair[0] = b;
        } else {
          pair[1] = b;
        }
      }
    }
  }
  for (Eigen::Index v = coarse.vertexCount(); v < fine.vertexCount(); ++v) {
    const auto& [a, b] = ends[v];
    result.row(v) = (places.row(a) + places.row(b)).normalized();
  }
  return result;
}

/// Where the vertices have come to from one of the rotations.
struct Start {
  Positions places;
  double energy = kInfinity;
  int iterations = 0;
};

void keepBest(std::vector<Start>& starts, std::size_t count) {
  std::ranges::stable_sort(starts, {}, &Start::energy);
  starts.resize(count);
}

/// Maps between two pyramids on their way from coarse to fine.
struct Direction {
  const std::vector<FoldingLevel>& moving;
  const std::vector<FoldingLevel>& target;
  std::vector<Start> starts = {};

  [[nodiscard]] const TriangleMesh& grid(int level) const { return target[level].grid->mesh(); }

  /// Lowers all starts on a level and keeps those of least energy.
  Termination lower(int level, const RegisterOptions& options, const Monitor& monitor) {
    const double bound = options.maxAreal * (1 - kMarginALevel * (options.level - level));
    const SphereEnergy energy = regularity(grid(level), options.smoothness, bound);
    const FoldingEnergy folding(moving[level], target[level]);
    SphereSolver solver(energy, grid(level).vertexCount(), &folding);
    Termination termination = Termination::NotRun;
    for (Start& start : starts) {
      start.energy = solver.value(start.places);
      if (!std::isfinite(start.energy)) continue;  // an inverse with a face turned over
      const auto run = solver.lower(start.places, kIterations, kTolerance, monitor);
      start.energy = run.energy;
      start.iterations += run.iterations;
      termination = run.termination;
    }
    keepBest(starts, level == options.level ? 1 : (starts.size() + kFewer - 1) / kFewer);
    return termination;
  }

  void refine(int level) {
    for (Start& start : starts) start.places = refined(grid(level), grid(level + 1), start.places);
  }

  /// The inverses of the other direction's maps go on beside the own ones.
  void join(const Direction& other, int level) {
    for (const Start& start : other.starts) {
      const geometry::SphereLocator deformed(TriangleMesh{start.places, grid(level).faces});
      Positions places(grid(level).vertexCount(), 3);
      parallelFor(static_cast<std::size_t>(places.rows()), [&](std::size_t v) {
        const auto place = deformed.locate(grid(level).positions.row(v).transpose());
        Point sum = Point::Zero();
        for (int k = 0; k < 3; ++k) sum += place.weights[k] * grid(level).corner(place.face, k);
        places.row(v) = sum.normalized().transpose();
      });
      starts.push_back({std::move(places), kInfinity, start.iterations});
    }
  }
};

double correlation(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const Eigen::ArrayXd x = a.array() - a.mean(), y = b.array() - b.mean();
  return (x * y).sum() / std::sqrt(x.square().sum() * y.square().sum());
}

/// Over the vertices of the target's finest icosphere, which are even.
FoldingCorrelation correlationAt(const FoldingSphere& moving,
                                 const geometry::SphereLocator& onMoving,
                                 const FoldingLevel& target, const Positions& places) {
  return {correlation(valuesAt(onMoving, moving.sulc, places), target.maps[0]),
          correlation(valuesAt(onMoving, moving.curvature, places), target.maps[1])};
}

void requireFolding(const FoldingSphere& folding, const char* name) {
  const Eigen::Index count = folding.sphere.vertexCount();
  if (folding.sulc.size() != count || folding.curvature.size() != count) {
    throw InvalidInput(std::string(name) + ": folding maps of " +
                       std::to_string(folding.sulc.size()) + " and " +
                       std::to_string(folding.curvature.size()) + " values, but the sphere has " +
                       std::to_string(count) + " vertices");
  }
}

/// Where the moving sphere's vertices come to: x at the place y of the same weights.
void carry(const FoldingSphere& moving, const TriangleMesh& grid, const Positions& places,
           SphereRegistration& result) {
  const geometry::SphereLocator deformed(TriangleMesh{places, grid.faces});
  const Eigen::VectorXd areas = geometry::faceAreas(grid);
  const Eigen::VectorXd deformedAreas = geometry::faceAreas(deformed.mesh());
  TriangleMesh sphere = moving.sphere;
  result.arealLog2.resize(sphere.vertexCount());
  parallelFor(static_cast<std::size_t>(sphere.vertexCount()), [&](std::size_t n) {
    const auto v = static_cast<Eigen::Index>(n);
    const auto place = deformed.locate(moving.sphere.positions.row(v).transpose());
    Point sum = Point::Zero();
    for (int k = 0; k < 3; ++k) sum += place.weights[k] * grid.corner(place.face, k);
    sphere.positions.row(v) = sum.transpose();
    result.arealLog2[v] = std::log2(areas[place.face] / deformedAreas[place.face]);
  });
  result.rounding = makeOneToOne(sphere);
  result.positions = sphere.positions;
}

}  // namespace

TriangleMesh mirrored(TriangleMesh sphere) {
  sphere.positions.col(0) *= -1;
  sphere.faces.col(1).swap(sphere.faces.col(2));
  return sphere;
}

SphereRegistration registerSphere(const FoldingSphere& moving, const FoldingSphere& target,
                                  const RegisterOptions& options, const Monitor& monitor) {
  requireFolding(moving, "sphere");
  requireFolding(target, "template");
  const auto movingMaps = foldingPyramid(moving, options.level);
  const auto targetMaps = foldingPyramid(target, options.level);
  SphereRegistration result;
  Direction there{movingMaps, targetMaps}, back{targetMaps, movingMaps};
  const auto rotations = options.rotate ? searchRotations(movingMaps, targetMaps, monitor)
                                        : std::vector{result.rotation};

  const geometry::SphereLocator onMoving(moving.sphere);
  const FoldingLevel& finest = targetMaps.back();
  result.before = correlationAt(moving, onMoving, finest, finest.grid->mesh().positions);
  int level = std::min(kCoarsestLevel, options.level);
  const int meeting = std::min(kMeeting, options.level - 1);
  for (const Eigen::Matrix3d& rotation : rotations) {
    there.starts.push_back({there.grid(level).positions * rotation});  // y = R^T x
    back.starts.push_back({back.grid(level).positions * rotation.transpose()});
  }
  for (;; ++level) {
    monitor.progress(0.2 + 0.7 * level / (options.level + 1),
                     std::to_string(there.grid(level).vertexCount()) + " vertices");
    result.termination = there.lower(level, options, monitor);
    if (level <= meeting) back.lower(level, options, monitor);
    if (level == options.level) break;
    there.refine(level);
    if (level <= meeting) back.refine(level);
    if (level == meeting) there.join(back, level + 1);
  }
  if (result.termination != Termination::Interrupted) result.termination = Termination::Finished;
  const TriangleMesh& grid = there.grid(level);
  const Positions& places = there.starts.front().places;
  result.rotation =
      Eigen::umeyama(places.transpose(), grid.positions.transpose(), false).topLeftCorner<3, 3>();
  result.iterations = there.starts.front().iterations;
  result.after = correlationAt(moving, onMoving, finest, places);
  carry(moving, grid, places, result);
  const geometry::SphereLocator onTarget(target.sphere);
  result.sulc = valuesAt(onTarget, target.sulc, result.positions);
  result.curvature = valuesAt(onTarget, target.curvature, result.positions);
  return result;
}

}  // namespace explica::sphere
