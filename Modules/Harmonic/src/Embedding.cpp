// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Embedding.h"

#include "Explica/Core/Parallel.h"
#include "LinearSolve.h"
#include "Stencil.h"

#include <algorithm>
#include <cmath>

namespace explica::harmonic {

namespace {

constexpr std::size_t kEmbeddingGrain = 1 << 13;  // elements a task
// A Laplace solve's error must stay below what the iteration still gains.
constexpr double kSolveTolerance = 1e-10;
constexpr int kSolveIterations = 60;
// The fit ends when an iteration lowers the misfit's root mean square by less than this share.
constexpr double kGain = 1e-3;
constexpr int kFitIterations = 60;

/// A crossing of the boundary with a link: u there is quadratic in the link's two ends and the
/// vertex behind, each a tissue voxel or a boundary vertex.
struct Crossing {
  std::array<std::int32_t, 3> vertex{};  ///< >= 0 tissue number, else -1 - boundary vertex
  std::array<double, 3> weight{};
  double target = 0;
};

class Embedding {
 public:
  explicit Embedding(const Annulus& annulus)
      : staircase_(withoutFractions(annulus)), stencil_(staircase_), multigrid_(staircase_) {
    numberBoundary(annulus);
    collectCrossings(annulus);
    findScale();
  }

  /// About one over the norm of each vertex's column, which conditions the fit.
  [[nodiscard]] const std::vector<double>& scale() const { return scale_; }

  [[nodiscard]] std::size_t vertices() const { return target_.size(); }
  [[nodiscard]] const std::vector<double>& target() const { return target_; }
  [[nodiscard]] std::size_t crossings() const { return crossings_.size(); }
  [[nodiscard]] double targetAt(std::size_t s) const { return crossings_[s].target; }

  /// The harmonic function with the given values on the boundary's vertices.
  LinearOutcome extend(const std::vector<double>& alpha, std::vector<double>& u,
                       const Monitor& monitor) {
    std::vector<double> rhs(staircase_.count(), 0);
    forBoundaryLinks([&](std::int32_t n, std::int32_t row, int d, std::int32_t vertex) {
      rhs[n] += static_cast<double>(stencil_.weights[row][d]) * alpha[vertex];
    });
    u.assign(staircase_.count(), 0);
    return solveLinear(staircase_, stencil_, multigrid_, rhs, u, kSolveTolerance, kSolveIterations,
                       monitor);
  }

  /// Central differences of u, 1/mm along the grid's axes; an insulated voxel mirrors its
  /// neighbour.
  [[nodiscard]] std::vector<Eigen::Vector3f> gradient(const std::vector<double>& alpha,
                                                      const std::vector<double>& u) const {
    std::vector<Eigen::Vector3f> gradient(u.size());
    parallelFor(u.size(), kEmbeddingGrain, [&](std::size_t index) {
      const auto n = static_cast<std::int32_t>(index);
      const std::int32_t row = staircase_.irregular(n);
      const auto at = [&](int d) {
        const std::int32_t m = staircase_.links[n][d];
        return m >= 0 ? u[m] : vertexOf_[row][d] >= 0 ? alpha[vertexOf_[row][d]] : u[n];
      };
      for (int a = 0; a < 3; ++a) {
        gradient[n][a] =
            static_cast<float>(0.5 * (at(2 * a + 1) - at(2 * a)) / staircase_.grid.spacing[a]);
      }
    });
    return gradient;
  }

  /// u on the crossings.
  [[nodiscard]] std::vector<double> sample(const std::vector<double>& alpha,
                                           const std::vector<double>& u) const {
    std::vector<double> values(crossings_.size());
    parallelFor(crossings_.size(), kEmbeddingGrain, [&](std::size_t s) {
      double sum = 0;
      for (int k = 0; k < 3; ++k) {
        const std::int32_t v = crossings_[s].vertex[k];
        sum += crossings_[s].weight[k] * (v >= 0 ? u[v] : alpha[-1 - v]);
      }
      values[s] = sum;
    });
    return values;
  }

  /// Derivative by alpha of the dot product of `values` with sample(extend(alpha)).
  std::vector<double> adjoint(const std::vector<double>& values, const Monitor& monitor) {
    std::vector<double> rhs(staircase_.count(), 0), direct(vertices(), 0);
    for (std::size_t s = 0; s < crossings_.size(); ++s) {
      for (int k = 0; k < 3; ++k) {
        const std::int32_t v = crossings_[s].vertex[k];
        (v >= 0 ? rhs[v] : direct[-1 - v]) += crossings_[s].weight[k] * values[s];
      }
    }
    // u = A^-1 B alpha with A = D^-1 L, L symmetric: the adjoint is (D B)^T A^-1 D^-1.
    for (std::int32_t n = 0; n < static_cast<std::int32_t>(rhs.size()); ++n) rhs[n] /= diagonal(n);
    std::vector<double> z(rhs.size(), 0);
    solveLinear(staircase_, stencil_, multigrid_, rhs, z, kSolveTolerance, kSolveIterations,
                monitor);
    forBoundaryLinks([&](std::int32_t n, std::int32_t row, int d, std::int32_t vertex) {
      direct[vertex] += diagonal(n) * static_cast<double>(stencil_.weights[row][d]) * z[n];
    });
    return direct;
  }

 private:
  static Annulus withoutFractions(Annulus annulus) {
    for (auto& row : annulus.fractions) row = {1, 1, 1, 1, 1, 1};
    return annulus;
  }

  [[nodiscard]] double diagonal(std::int32_t n) const {
    const std::int32_t row = staircase_.irregular(n);
    return row < 0 ? stencil_.regularDiagonal : stencil_.diagonal[row];
  }

  template <class Body>
  void forBoundaryLinks(const Body& body) const {
    for (std::int32_t n = 0; n < static_cast<std::int32_t>(staircase_.count()); ++n) {
      const std::int32_t row = staircase_.irregular(n);
      if (row < 0) continue;
      for (int d = 0; d < 6; ++d) {
        if (vertexOf_[row][d] >= 0) body(n, row, d, vertexOf_[row][d]);
      }
    }
  }

  /// Boundary vertices are the voxels of the inner and outer region beside the tissue; behind a
  /// sheet without thickness each bank has its own.
  void numberBoundary(const Annulus& annulus) {
    const auto strides = annulus.strides();
    vertexOf_.assign(annulus.fractions.size(), {-1, -1, -1, -1, -1, -1});
    std::vector<std::int32_t> at(annulus.numberAt.size(), -1);
    for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
      const std::int32_t row = annulus.irregular(n);
      if (row < 0) continue;
      for (int d = 0; d < 6; ++d) {
        const std::int32_t link = annulus.links[n][d];
        if (link != kInner && link != kOuter) continue;
        const std::int32_t q = annulus.place[n] + signOf(d) * strides[axisOf(d)];
        const bool sheet = annulus.numberAt[q] >= 0;
        if (sheet || at[q] < 0) {
          vertexOf_[row][d] = static_cast<std::int32_t>(target_.size());
          if (!sheet) at[q] = vertexOf_[row][d];
          target_.push_back(link == kOuter ? 1 : 0);
        } else {
          vertexOf_[row][d] = at[q];
        }
      }
    }
  }

  void collectCrossings(const Annulus& annulus) {
    for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
      const std::int32_t row = annulus.irregular(n);
      if (row < 0) continue;
      for (int d = 0; d < 6; ++d) {
        if (vertexOf_[row][d] < 0) continue;
        const double theta = annulus.fractions[row][d];
        const int back = opposite(d);
        Crossing c;
        c.target = annulus.links[n][d] == kOuter ? 1 : 0;
        const std::int32_t behind = annulus.links[n][back];
        // The parabola through -1 (behind), 0 (the voxel) and 1; an insulated voxel mirrors it.
        c.vertex = {behind >= 0                 ? behind
                    : vertexOf_[row][back] >= 0 ? -1 - vertexOf_[row][back]
                                                : n,
                    n, -1 - vertexOf_[row][d]};
        c.weight = {0.5 * theta * (theta - 1), 1 - theta * theta, 0.5 * theta * (theta + 1)};
        crossings_.push_back(c);
      }
    }
  }

  void findScale() {
    scale_.assign(vertices(), 0);
    std::size_t s = 0;
    forBoundaryLinks([&](std::int32_t, std::int32_t row, int d, std::int32_t vertex) {
      // What the vertex gives to the crossing itself, and through the voxel next to it.
      const auto& weight = crossings_[s++].weight;
      const double sum = weight[2] + weight[1] * static_cast<double>(stencil_.weights[row][d]);
      scale_[vertex] += sum * sum;
    });
    for (double& value : scale_) value = 1 / std::sqrt(value);
  }

  Annulus staircase_;
  Stencil stencil_;
  Multigrid multigrid_;
  std::vector<std::array<std::int32_t, 6>> vertexOf_;  ///< per irregular voxel and link
  std::vector<double> target_;                         ///< per boundary vertex: 0 or 1
  std::vector<Crossing> crossings_;                    ///< in the order of forBoundaryLinks
  std::vector<double> scale_;                          ///< per boundary vertex
};

double squared(const std::vector<double>& values) {
  return parallelSum(values.size(), kEmbeddingGrain, 0.0, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t k = begin; k < end; ++k) sum += values[k] * values[k];
    return sum;
  });
}

}  // namespace

Interpolant solveByEmbedding(const Annulus& annulus, const InterpolantOptions& options,
                             const Monitor& monitor) {
  Embedding embedding(annulus);
  Interpolant result;
  std::vector<double> alpha = embedding.target();
  LinearOutcome outcome = embedding.extend(alpha, result.u, monitor);
  std::vector<double> misfit = embedding.sample(alpha, result.u);
  for (std::size_t s = 0; s < misfit.size(); ++s) misfit[s] = embedding.targetAt(s) - misfit[s];

  // CGLS for the scaled values alpha / scale; `misfit` is kept up to date, u is solved for at the
  // end.
  const std::vector<double>& scale = embedding.scale();
  const auto slopeOf = [&] {
    std::vector<double> slope = embedding.adjoint(misfit, monitor);
    for (std::size_t j = 0; j < slope.size(); ++j) slope[j] *= scale[j];
    return slope;
  };
  std::vector<double> slope = slopeOf(), direction = slope, step(alpha.size()), u;
  double steepness = squared(slope), error = squared(misfit);
  const int most = std::min(options.maxIterations, kFitIterations);
  for (; result.iterations < most && steepness > 0; ++result.iterations) {
    if (monitor.shouldStop()) break;
    monitor.progress(static_cast<double>(result.iterations) / most, "harmonic embedding");
    for (std::size_t j = 0; j < step.size(); ++j) step[j] = scale[j] * direction[j];
    embedding.extend(step, u, monitor);
    const std::vector<double> change = embedding.sample(step, u);
    const double changed = squared(change);
    if (!(changed > 0)) break;
    const double length = steepness / changed;
    for (std::size_t j = 0; j < alpha.size(); ++j) alpha[j] += length * step[j];
    for (std::size_t s = 0; s < misfit.size(); ++s) misfit[s] -= length * change[s];
    const double before = error;
    error = squared(misfit);
    if (std::sqrt(error) > (1 - kGain) * std::sqrt(before)) {
      ++result.iterations;
      result.termination = Termination::Converged;
      break;
    }
    slope = slopeOf();
    const double next = squared(slope), share = next / steepness;
    steepness = next;
    for (std::size_t j = 0; j < direction.size(); ++j) {
      direction[j] = slope[j] + share * direction[j];
    }
  }
  outcome = embedding.extend(alpha, result.u, monitor);
  if (monitor.shouldStop()) {
    result.termination = Termination::Interrupted;
  } else if (result.termination != Termination::Converged ||
             outcome.termination != Termination::Converged) {
    result.termination = Termination::MaxIterations;
  }
  result.relativeResidual = outcome.relativeResidual;
  result.misfit = std::sqrt(error / static_cast<double>(embedding.crossings()));
  result.gradient = embedding.gradient(alpha, result.u);
  for (double& value : result.u) {
    const double kept = std::clamp(value, 0.0, 1.0);
    result.corrected += kept != value;
    value = kept;
  }
  return result;
}

}  // namespace explica::harmonic
