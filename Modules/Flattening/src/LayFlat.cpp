// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "LayFlat.h"

#include "Coarsening.h"
#include "Explica/Core/Errors.h"
#include "MapSolver.h"

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <string>

namespace explica::flattening {
namespace {

constexpr Eigen::Index kCoarsest = 250;  // vertices: Tutte's map is well scaled, a step is cheap
constexpr int kCoarseIterations = 200;
constexpr int kMiddleIterations = 40;
constexpr double kRough = 1e-3;  // tolerance of what is not the last word
constexpr double kFirstAreaWeight = 0.25, kLastAreaWeight = 100;
constexpr double kLeastRise = 1.15, kMostRise = 3;  // of the area weight at a time
constexpr double kAim = 0.97;  // of the area tolerance: the last steps and rounding take some of it
constexpr double kHoleWeight = 1e-3;  // of a fan across a hole against a face of the surface

/// Edges shorter than a thousandth of the mean, such as those of vertices in one place, get that
/// length: lengths divide.
void lengthenShortEdges(IntrinsicMesh& mesh) {
  const double least = kNeedleHeight * mesh.lengths.mean();
  mesh.lengths = mesh.lengths.cwiseMax(least);
}

/// Closes holes by fans about a new vertex each; the new faces come last.
IntrinsicMesh withoutHoles(const Disc& disc) {
  IntrinsicMesh mesh = intrinsicOf(disc.mesh);
  Eigen::Index added = 0;
  for (const Loop& hole : disc.holes) added += static_cast<Eigen::Index>(hole.size());
  Eigen::Index next = mesh.faces.rows();
  mesh.faces.conservativeResize(next + added, 3);
  mesh.lengths.conservativeResize(next + added, 3);
  for (const Loop& hole : disc.holes) {
    const auto edge = [&](std::size_t n) {
      return (disc.mesh.positions.row(hole[n]) -
              disc.mesh.positions.row(hole[(n + 1) % hole.size()]))
          .norm();
    };
    double around = 0, longest = 0;
    for (std::size_t n = 0; n < hole.size(); ++n) {
      around += edge(n);
      longest = std::max(longest, edge(n));
    }
    const double spoke = std::max(around / (2 * kPi), 0.6 * longest);
    const auto centre = static_cast<std::int32_t>(mesh.vertexCount++);
    for (std::size_t n = 0; n < hole.size(); ++n, ++next) {
      // The loop runs as the surface's faces do; a face beyond it runs the other way.
      mesh.faces.row(next) << centre, hole[(n + 1) % hole.size()], hole[n];
      mesh.lengths.row(next) << spoke, edge(n), spoke;
    }
  }
  return mesh;
}

/// Map into a circle: rim vertices at equal angles, others in the mean of their neighbours, the
/// nearer ones counting more [Tutte1963, Floater2003].
FlatPositions circleMap(const IntrinsicMesh& mesh, const Loop& rim, double area) {
  const Eigen::Index count = mesh.vertexCount;
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<char> fixed(static_cast<std::size_t>(count), 1);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) fixed[mesh.faces(f, k)] = 0;
  }
  for (std::size_t n = 0; n < rim.size(); ++n) fixed[rim[n]] = 1;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = mesh.faces(f, k), b = mesh.faces(f, (k + 1) % 3);
      const double w = 1 / mesh.lengths(f, k);
      for (const auto& [i, j] : {std::pair{a, b}, std::pair{b, a}}) {
        if (fixed[i]) continue;
        entries.emplace_back(i, i, w);
        entries.emplace_back(i, j, -w);
      }
    }
  }
  FlatPositions flat = FlatPositions::Zero(count, 2);
  const double radius = std::sqrt(area / kPi);
  for (std::size_t n = 0; n < rim.size(); ++n) {
    const double angle = 2 * kPi * static_cast<double>(n) / static_cast<double>(rim.size());
    flat.row(rim[n]) << radius * std::cos(angle), radius * std::sin(angle);
  }
  for (Eigen::Index v = 0; v < count; ++v) {
    if (fixed[v]) entries.emplace_back(v, v, 1.0);
  }
  // Known columns go to the right side, so that the matrix is symmetric.
  Eigen::MatrixXd right = flat;
  std::vector<Eigen::Triplet<double>> kept;
  for (const auto& entry : entries) {
    const bool known = entry.row() != entry.col() && fixed[entry.col()];
    if (known) {
      right.row(entry.row()) -= entry.value() * flat.row(entry.col());
    } else {
      kept.push_back(entry);
    }
  }
  Eigen::SparseMatrix<double> system(count, count);
  system.setFromTriplets(kept.begin(), kept.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(system);
  flat = solver.solve(right);
  return flat;
}

double areaOf(const IntrinsicMesh& mesh) {
  double sum = 0;
  for (const RestFace& face : restFaces(mesh, 0)) sum += face.area;
  return sum;
}

/// Lowers the energy at full resolution, areas counting more and more until they are kept.
void lowerFinest(const IntrinsicDisc& disc,
                 const std::function<double(const FlatPositions&)>& areaError,
                 const FlattenOptions& options, const Monitor& monitor, Laid& map) {
  FlatPositions& flat = map.positions;
  std::vector<double> weights;
  if (disc.surfaceFaces < disc.mesh.faces.rows()) {
    weights.assign(static_cast<std::size_t>(disc.mesh.faces.rows()), kHoleWeight);
    std::fill_n(weights.begin(), disc.surfaceFaces, 1.0);
  }
  map.areaWeight = kFirstAreaWeight;
  MapSolver solver(disc.mesh, disc.rim, map.areaWeight, options.contactRange, weights);
  const auto lower = [&](double tolerance) {
    const auto run = solver.lower(flat, options.maxIterations - map.iterations, tolerance, monitor);
    map.iterations += run.iterations;
    map.energy = run.energy;
    map.termination = run.termination;
    return run.termination != Termination::Interrupted && map.iterations < options.maxIterations;
  };
  while (lower(kRough)) {
    const double error = areaError(flat);
    monitor.progress(std::min(0.9, options.areaTolerance / error), "areas");
    if (error <= kAim * options.areaTolerance || map.areaWeight >= kLastAreaWeight) {
      (void)lower(options.tolerance);
      return;
    }
    map.areaWeight *=
        std::clamp(std::pow(error / (kAim * options.areaTolerance), 1.5), kLeastRise, kMostRise);
    solver.setAreaWeight(map.areaWeight);
  }
}

/// Puts back what was removed after a level.
void insertAll(const CoarseningLevel& level, const Loop& coarserRim, double areaWeight,
               FlatPositions& flat) {
  Insertion insertion(coarserRim, flat.rows(), areaWeight);
  for (std::size_t n = level.removals.size(); n-- > 0;) {
    if (!insertion.insert(level.removals[n], flat)) {
      throw Error("flatten: rounding leaves no room for vertex " +
                  std::to_string(level.removals[n].vertex) + " in the map");
    }
  }
}

}  // namespace

IntrinsicDisc intrinsicDisc(const Disc& disc) {
  IntrinsicDisc result{withoutHoles(disc), disc.rim, disc.mesh.faceCount()};
  lengthenShortEdges(result.mesh);
  return result;
}

CoarseDisc coarseDisc(const IntrinsicDisc& fine, Eigen::Index vertices) {
  const auto levels = coarsen(fine.mesh, fine.rim, vertices);
  const CoarseningLevel& level = levels.back();
  CoarseDisc coarse;
  std::vector<std::int32_t> number(static_cast<std::size_t>(level.mesh.vertexCount), -1);
  IntrinsicMesh& mesh = coarse.disc.mesh;
  mesh = level.mesh;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      std::int32_t& v = mesh.faces(f, k);
      if (number[v] < 0) {
        number[v] = static_cast<std::int32_t>(coarse.vertexOrigin.size());
        coarse.vertexOrigin.push_back(v);
      }
      v = number[v];
    }
  }
  mesh.vertexCount = static_cast<Eigen::Index>(coarse.vertexOrigin.size());
  for (const std::int32_t v : level.rim) coarse.disc.rim.push_back(number[v]);
  coarse.disc.surfaceFaces = mesh.faces.rows();
  return coarse;
}

Laid layFlat(const IntrinsicDisc& disc,
             const std::function<double(const FlatPositions&)>& areaError,
             const FlattenOptions& options, const Monitor& monitor) {
  monitor.progress(0, "coarsening");
  const auto levels = coarsen(disc.mesh, disc.rim, kCoarsest);
  Laid laid;
  FlatPositions& flat = laid.positions;
  flat = circleMap(levels.back().mesh, levels.back().rim, areaOf(levels.back().mesh));
  for (std::size_t n = levels.size(); n-- > 1;) {
    const CoarseningLevel& level = levels[n];
    MapSolver solver(level.mesh, level.rim, kFirstAreaWeight, options.contactRange);
    const bool coarsest = n + 1 == levels.size();
    (void)solver.lower(flat, coarsest ? kCoarseIterations : kMiddleIterations, kRough, monitor);
    insertAll(levels[n - 1], level.rim, kFirstAreaWeight, flat);
  }
  lowerFinest(disc, areaError, options, monitor, laid);
  return laid;
}

}  // namespace explica::flattening
