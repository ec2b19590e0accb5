// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "LayFlat.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/IndicesWhere.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Flattening/Coarsening.h"
#include "Explica/Geometry/SparseCholesky.h"
#include "MapSolver.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace explica::flattening {
namespace {

constexpr Eigen::Index kCoarsest = 250;  // vertices: Tutte's map is well scaled, a step is cheap
constexpr Eigen::Index kAtOnce = 3000;   // vertices: levels so coarse are lowered at any rate
constexpr Eigen::Index kFewest = 12;     // where it is not, fewer are tried, down to these
constexpr double kThinnest = 1e-13;      // area of a face of that map over the mean: rounding's
constexpr int kCoarseIterations = 200;   // at most
constexpr int kMiddleIterations = 40;    // at most: finer levels go on
constexpr double kRough = 1e-3;          // tolerance of what is not the last word
// Against angles: soft, then as good as firm.
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
  const geometry::SparseCholesky solver(system);
  flat = solver.solve(right);
  return flat;
}

double areaOf(const IntrinsicMesh& mesh) {
  double sum = 0;
  for (const RestFace& face : restFaces(mesh, 0)) sum += face.area;
  return sum;
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

/// True if every face is positive and none is so small that rounding could turn it over.
bool isSound(const IntrinsicMesh& mesh, const FlatPositions& flat) {
  double least = kInfinity, sum = 0;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const auto a = flat.row(mesh.faces(f, 0));
    const Eigen::RowVector2d u = flat.row(mesh.faces(f, 1)) - a;
    const Eigen::RowVector2d v = flat.row(mesh.faces(f, 2)) - a;
    const double area = u[0] * v[1] - u[1] * v[0];
    least = std::min(least, area);
    sum += area;
  }
  return least > kThinnest * sum / static_cast<double>(mesh.faces.rows());
}

/// A disc on ever fewer vertices, and the coarsest one's map into a circle.
struct Coarsened {
  std::vector<CoarseningLevel> levels;
  FlatPositions circle;
};

/// What is joined to the rest by a thin neck lands in a few faces of the circle, a neck behind a
/// neck in a face of these, and so on until rounding turns faces over: such a disc is coarsened
/// until it has no such necks any more.
Coarsened coarsened(const IntrinsicDisc& disc) {
  Coarsened result;
  for (Eigen::Index smallest = kCoarsest; smallest >= kFewest; smallest /= 2) {
    result.levels = coarsen(disc.mesh, disc.rim, smallest, smallest < kCoarsest);
    const CoarseningLevel& coarsest = result.levels.back();
    result.circle = circleMap(coarsest.mesh, coarsest.rim, areaOf(coarsest.mesh));
    if (isSound(coarsest.mesh, result.circle)) break;
  }
  return result;
}

/// Vertices of a level, ascending.
std::vector<std::int32_t> verticesOf(const IntrinsicMesh& mesh) {
  std::vector<bool> used(static_cast<std::size_t>(mesh.vertexCount), false);
  for (const std::int32_t v : mesh.faces.reshaped()) used[v] = true;
  return indicesWhere(used.size(), [&](std::size_t v) { return used[v]; });
}

/// A map on its way from few vertices to all.
class Descent {
 public:
  Descent(const IntrinsicDisc& disc, const std::function<double(const FlatPositions&)>& areaError,
          const FlattenOptions& options, const Monitor& monitor)
      : disc_(disc),
        areaError_(areaError),
        options_(options),
        monitor_(monitor),
        coarsened_(coarsened(disc)),
        levels_(coarsened_.levels) {
    for (const CoarseningLevel& level : levels_) vertices_.push_back(verticesOf(level.mesh));
  }

  void begin() {
    flat_ = coarsened_.circle;
    state_.level = static_cast<int>(levels_.size()) - 1;
    state_.areaTolerance = options_.areaTolerance;
    keepPath();
  }

  void resume(const FlattenState& from) {
    const auto fits = [&](const FlatStage& stage) {
      return stage.level >= 0 && stage.level < static_cast<int>(levels_.size()) &&
             stage.positions.rows() == static_cast<Eigen::Index>(vertices_[stage.level].size());
    };
    if (!fits({from.level, from.positions}) || !std::ranges::all_of(from.path, fits)) {
      throw InvalidInput("state: it belongs to another surface, or to other cuts");
    }
    state_ = from;
    flat_ = FlatPositions::Zero(disc_.mesh.vertexCount, 2);
    flat_(vertices_[state_.level], Eigen::all) = from.positions;
    // Who asks for better areas than the run so far had in mind has its weight rise further.
    if (options_.areaTolerance < state_.areaTolerance) state_.settled = false;
    state_.areaTolerance = options_.areaTolerance;
    if (state_.path.empty()) keepPath();
  }

  void run() {
    while (state_.level > 0) {
      if (lowerCoarse() == Termination::Interrupted) {
        termination_ = Termination::Interrupted;
        return;
      }
      insertAll(levels_[state_.level - 1], levels_[state_.level].rim, kFirstAreaWeight, flat_);
      --state_.level;
      state_.iterations = 0;
    }
    lowerFinest();
  }

  [[nodiscard]] Laid laid() const {
    Laid result;
    result.positions = wholeMap(state_.level, flat_);
    result.state = state_;
    result.state.positions = flat_(vertices_[state_.level], Eigen::all);
    result.iterations = state_.level == 0 ? state_.iterations : 0;
    result.energy = energy_;
    result.termination = termination_;
    result.frames = frames();
    return result;
  }

 private:
  /// The map of a level with all finer vertices put back.
  [[nodiscard]] FlatPositions wholeMap(int level, FlatPositions flat) const {
    for (; level > 0; --level) {
      insertAll(levels_[level - 1], levels_[level].rim, kFirstAreaWeight, flat);
    }
    return flat;
  }

  void keepPath() {
    if (options_.frames == 0) return;
    state_.path.push_back({state_.level, flat_(vertices_[state_.level], Eigen::all)});
  }

  /// Lowers the map of one level, some of whose iterations may have been made before.
  Termination lower(MapSolver& solver, int iterations, double tolerance, const Monitor& monitor) {
    const int before = state_.iterations;
    const auto run = solver.lower(flat_, iterations - before, tolerance, monitor, [&](int made) {
      state_.iterations = before + made;
      keepPath();
      tellProgress();
    });
    state_.iterations = before + run.iterations;
    energy_ = run.energy;
    return run.termination;
  }

  /// A level of few vertices takes a moment and is always finished: all others can be put back into
  /// what it gives with room to spare, so that a run that is stopped at once has a map to show.
  Termination lowerCoarse() {
    const CoarseningLevel& level = levels_[state_.level];
    MapSolver solver(level.mesh, level.rim, kFirstAreaWeight, options_.contactRange);
    const auto size = static_cast<Eigen::Index>(vertices_[state_.level].size());
    return lower(solver, size <= kCoarsest ? kCoarseIterations : kMiddleIterations, kRough,
                 size <= kAtOnce ? Monitor{} : monitor_);
  }

  /// Lowers the energy at full resolution, areas counting more and more until they are kept.
  void lowerFinest() {
    std::vector<double> weights;
    if (disc_.surfaceFaces < disc_.mesh.faces.rows()) {
      weights.assign(static_cast<std::size_t>(disc_.mesh.faces.rows()), kHoleWeight);
      std::fill_n(weights.begin(), disc_.surfaceFaces, 1.0);
    }
    double& weight = state_.areaWeight;
    if (!std::isfinite(weight)) weight = kFirstAreaWeight;
    MapSolver solver(disc_.mesh, disc_.rim, weight, options_.contactRange, weights);
    const double aim = kAim * options_.areaTolerance;
    while (true) {
      const double tolerance = state_.settled ? options_.tolerance : kRough;
      termination_ = lower(solver, options_.maxIterations, tolerance, monitor_);
      if (termination_ == Termination::Interrupted || state_.settled ||
          state_.iterations >= options_.maxIterations) {
        return;
      }
      const double error = areaError_(flat_);
      areaShare_ = std::max(areaShare_, std::min(1.0, options_.areaTolerance / error));
      state_.settled = error <= aim || weight >= kLastAreaWeight;
      if (state_.settled) continue;
      weight *= std::clamp(std::pow(error / aim, 1.5), kLeastRise, kMostRise);
      solver.setAreaWeight(weight);
    }
  }

  void tellProgress() const {
    constexpr double kCoarseShare = 0.3, kFineShare = 0.6;  // of the whole
    const double coarser = 1 - (state_.level + 1.0) / static_cast<double>(levels_.size());
    monitor_.progress(kCoarseShare * coarser + (state_.level == 0 ? kFineShare * areaShare_ : 0),
                      "iteration " + std::to_string(state_.iterations) + " on " +
                          std::to_string(vertices_[state_.level].size()) + " vertices");
  }

  /// How far the coarsest level's vertices had come at each state of the path, mm.
  [[nodiscard]] std::vector<double> wayAlongPath() const {
    const std::vector<std::int32_t>& few = vertices_.back();
    const auto places = [&](const FlatStage& stage) {
      FlatPositions all = FlatPositions::Zero(disc_.mesh.vertexCount, 2);
      all(vertices_[stage.level], Eigen::all) = stage.positions;
      return FlatPositions(all(few, Eigen::all));
    };
    std::vector<double> way = {0};
    FlatPositions before = places(state_.path.front());
    for (std::size_t n = 1; n < state_.path.size(); ++n) {
      FlatPositions now = places(state_.path[n]);
      const double step = std::sqrt((now - before).rowwise().squaredNorm().mean());
      way.push_back(way.back() + step);
      before = std::move(now);
    }
    return way;
  }

  /// A state between two of the path, with all vertices.  Where the level changes the coarser
  /// vertices stay, so that the finer state says where the others were.
  [[nodiscard]] FlatPositions stateAt(std::size_t n, double share) const {
    FlatPositions flat = FlatPositions::Zero(disc_.mesh.vertexCount, 2);
    const FlatStage& here = state_.path[n];
    int level = here.level;
    flat(vertices_[level], Eigen::all) = here.positions;
    if (share > 0 && n + 1 < state_.path.size()) {
      const FlatStage& next = state_.path[n + 1];
      for (; level > next.level; --level) {
        insertAll(levels_[level - 1], levels_[level].rim, kFirstAreaWeight, flat);
      }
      const FlatPositions from = flat(vertices_[level], Eigen::all);
      flat(vertices_[level], Eigen::all) = from + share * (next.positions - from);
    }
    return wholeMap(level, std::move(flat));
  }

  /// States evenly spaced along the way.  They lie on the straight pieces between iterations, on
  /// which no face vanishes and no two rim edges meet.
  [[nodiscard]] std::vector<FlatPositions> frames() const {
    std::vector<FlatPositions> result;
    if (options_.frames <= 0 || state_.path.empty()) return result;
    const std::vector<double> way = wayAlongPath();
    for (int k = 0; k < options_.frames; ++k) {
      if (k + 1 == options_.frames) {
        result.push_back(wholeMap(state_.level, flat_));
        break;
      }
      const double wanted = way.back() * k / (options_.frames - 1);
      const auto next = std::ranges::upper_bound(way, wanted);
      const auto n = static_cast<std::size_t>(next - way.begin()) - 1;
      const double step = next == way.end() ? 0 : *next - way[n];
      result.push_back(stateAt(n, step > 0 ? (wanted - way[n]) / step : 0));
    }
    return result;
  }

  const IntrinsicDisc& disc_;
  const std::function<double(const FlatPositions&)>& areaError_;
  const FlattenOptions& options_;
  const Monitor& monitor_;
  const Coarsened coarsened_;
  const std::vector<CoarseningLevel>& levels_;       ///< of it, the finest first
  std::vector<std::vector<std::int32_t>> vertices_;  ///< of each level
  FlatPositions flat_;                               ///< rows of this level's vertices count
  FlattenState state_;                               ///< without its positions
  double energy_ = kNaN;
  double areaShare_ = 0;  ///< of the way to the area tolerance
  Termination termination_ = Termination::NotRun;
};

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
             const FlattenOptions& options, const Monitor& monitor, const FlattenState* resume) {
  monitor.progress(0, "coarsening");
  Descent descent(disc, areaError, options, monitor);
  const StopScope kept(nullptr);  // from here on the map is whole at any moment
  if (resume != nullptr && resume->level >= 0) {
    descent.resume(*resume);
  } else {
    descent.begin();
  }
  descent.run();
  return descent.laid();
}

}  // namespace explica::flattening
