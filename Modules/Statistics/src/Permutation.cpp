// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/Permutation.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Types.h"
#include "Explica/Statistics/Clusters.h"
#include "ProjectionKernel.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

namespace explica::statistics {
namespace {

using kernels::kPanelPlaces;
using kernels::kTileWeights;

constexpr double kInSpan = 1e-9;              // round-off of projections of unit vectors, in double
constexpr double kRoundOff = 1e-4;            // relative, of statistics in single precision
constexpr float kLeastRest = 1e-9F;           // of a unit vector's square that a model leaves
constexpr std::int64_t kWeightsAtOnce = 384;  // columns of a block of shuffles: 30 MB of sums
                                              // for 20,000 places

/// Orthonormal bases of the contrast's regressors and of the rest of the model's.
struct Regressors {
  Eigen::MatrixXd tested;    // N x r
  Eigen::MatrixXd nuisance;  // N x q
};

Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& columns) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(columns).householderQ() *
         Eigen::MatrixXd::Identity(columns.rows(), columns.cols());
}

/// The effect c^T b depends on y by X (X^T X)^-1 c alone, which is orthogonal to the model without
/// the effect.
Regressors regressorsOf(const Eigen::MatrixXd& x, const Eigen::MatrixXd& weights) {
  Regressors found;
  found.tested = orthonormal(x * (x.transpose() * x).ldlt().solve(weights));
  // The sign of the tested regressor is the effect's.
  if (weights.cols() == 1) {
    const Eigen::VectorXd direction = x * (x.transpose() * x).ldlt().solve(weights);
    if (found.tested.col(0).dot(direction) < 0) found.tested *= -1;
  }
  const Eigen::Index free = x.cols() - weights.cols();
  if (free == 0) {
    found.nuisance.resize(x.rows(), 0);
    return found;
  }
  const Eigen::MatrixXd full = Eigen::HouseholderQR<Eigen::MatrixXd>(weights).householderQ() *
                               Eigen::MatrixXd::Identity(x.cols(), x.cols());
  found.nuisance = orthonormal(x * full.rightCols(free));
  return found;
}

/// True if all columns are in the span of orthonormal ones.
bool inSpan(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& basis) {
  const Eigen::MatrixXd rest = columns - basis * (basis.transpose() * columns);
  return rest.norm() < kInSpan * std::max(columns.norm(), 1.0);
}

/// Columns of the design that a contrast has weights on: they, and not what is left of them without
/// the other columns, say how an effect varies.
Eigen::MatrixXd columnsOf(const Design& design, const Contrast& contrast) {
  std::vector<Eigen::Index> columns;
  for (Eigen::Index c = 0; c < contrast.weights.rows(); ++c) {
    if (!contrast.weights.row(c).isZero()) columns.push_back(c);
  }
  return design.matrix(Eigen::all, columns);
}

Exchange exchangeFor(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& nuisance,
                     const PermutationOptions& options) {
  if (options.exchange != Exchange::Auto) return options.exchange;
  const Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(columns.rows(), 1);
  if (!inSpan(ones, nuisance)) return Exchange::Signs;
  if (options.blocks.empty()) return Exchange::Within;
  const Shuffler within(columns.rows(), options.blocks, Exchange::Within, 1, 0);
  return inSpan(columns, within.invariant()) ? Exchange::Whole : Exchange::Within;
}

/// The part of an orthonormal basis that shuffles change: without its common span with what they
/// leave as it is.
Eigen::MatrixXd withoutInvariant(const Eigen::MatrixXd& basis, const Eigen::MatrixXd& invariant) {
  if (basis.cols() == 0 || invariant.cols() == 0) return basis;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(basis.transpose() * invariant, Eigen::ComputeFullU);
  Eigen::Index common = 0;
  while (common < svd.singularValues().size() && svd.singularValues()[common] > 1 - kInSpan) {
    ++common;
  }
  return basis * svd.matrixU().rightCols(basis.cols() - common);
}

/// Residuals of the model without the effect, of unit length, packed for the kernel; places left
/// out are 0.
class Panels {
 public:
  Panels(const Eigen::MatrixXd& values, const Eigen::MatrixXd& nuisance)
      : people_(values.rows()),
        places_(values.cols()),
        packed_(static_cast<std::size_t>(count() * kPanelPlaces * values.rows()), 0.0F) {
    parallelFor(static_cast<std::size_t>(count()), 4, [&](std::size_t p) {
      const auto first = static_cast<Eigen::Index>(p) * kPanelPlaces;
      for (Eigen::Index v = first; v < std::min(first + kPanelPlaces, places_); ++v) {
        pack(values.col(v), nuisance, v);
      }
    });
  }

  [[nodiscard]] std::ptrdiff_t count() const { return (places_ + kPanelPlaces - 1) / kPanelPlaces; }
  [[nodiscard]] std::ptrdiff_t stride() const { return count() * kPanelPlaces; }
  [[nodiscard]] const float* panel(std::ptrdiff_t p) const {
    return packed_.data() + p * kPanelPlaces * people_;
  }

 private:
  void pack(const Eigen::VectorXd& y, const Eigen::MatrixXd& nuisance, Eigen::Index v) {
    if (!y.allFinite()) return;
    const Eigen::VectorXd rest = y - nuisance * (nuisance.transpose() * y);
    const double length = rest.norm();
    if (!(length > kInSpan * y.norm())) return;
    float* place = packed_.data() + v / kPanelPlaces * kPanelPlaces * people_ + v % kPanelPlaces;
    for (Eigen::Index i = 0; i < people_; ++i) {
      place[i * kPanelPlaces] = static_cast<float>(rest[i] / length);
    }
  }

  Eigen::Index people_, places_;
  std::vector<float> packed_;
};

/// Largest values of one shuffle.
struct Maxima {
  float statistic = 0, extent = 0, mass = 0, tfce = 0;
};

/// Makes shuffles block by block.
class Test {
 public:
  Test(const Regressors& regressors, const Eigen::MatrixXd& values, const PlaceGraph* graph,
       const PermutationOptions& options, const Shuffler& shuffler)
      : shuffler_(shuffler),
        graph_(graph),
        options_(options),
        places_(values.cols()),
        df_(static_cast<float>(values.rows() - regressors.tested.cols() -
                               regressors.nuisance.cols())),
        tested_(regressors.tested.cols()),
        panels_(values, regressors.nuisance) {
    const Eigen::MatrixXd moved = withoutInvariant(regressors.nuisance, shuffler.invariant());
    basis_.resize(values.rows(), tested_ + moved.cols());
    basis_ << regressors.tested.cast<float>(), moved.cast<float>();
    atOnce_ = std::max<std::int64_t>(1, kWeightsAtOnce / basis_.cols());
  }

  [[nodiscard]] std::int64_t atOnce() const { return atOnce_; }

  /// Shuffles [begin, begin + maxima.size()); `first` gets the maps of number 0.
  void run(std::int64_t begin, std::span<Maxima> maxima, PermutationResult& first) {
    const auto columns = static_cast<std::int64_t>(maxima.size()) * basis_.cols();
    tiles_ = (columns + kTileWeights - 1) / kTileWeights;
    weights_.assign(static_cast<std::size_t>(tiles_ * kTileWeights * basis_.rows()), 0.0F);
    sums_.resize(static_cast<std::size_t>(tiles_ * kTileWeights * panels_.stride()));
    parallelFor(maxima.size(), 4, [&](std::size_t b) { fillWeights(begin, b); });
    parallelFor(static_cast<std::size_t>(panels_.count()), 4,
                [&](std::size_t p) { project(static_cast<std::ptrdiff_t>(p)); });
    parallelForBlocks(maxima.size(), 4, [&](std::size_t from, std::size_t to) {
      Measure measure(*this);
      for (std::size_t b = from; b < to; ++b) {
        maxima[b] = measure.of(b);
        if (begin + static_cast<std::int64_t>(b) == 0) measure.keep(first);
      }
    });
  }

 private:
  /// One shuffle's map and what is largest in it.
  class Measure {
   public:
    explicit Measure(const Test& test) : test_(test), map_(static_cast<std::size_t>(test.places_)) {
      if (test.graph_ == nullptr) return;
      clusters_.emplace(test.graph_->neighbours, test.graph_->areas);
      if (!test.options_.tfce) return;
      tfce_.emplace(test.graph_->neighbours, test.graph_->areas);
      enhanced_.resize(map_.size());
    }

    Maxima of(std::size_t shuffle) {
      test_.statistics(shuffle, map_);
      Maxima maxima{largest(map_)};
      if (clusters_ && test_.options_.clusterThreshold > 0) {
        const LargestCluster cluster =
            clusters_->find(map_, static_cast<float>(test_.options_.clusterThreshold));
        maxima.extent = cluster.extent;
        maxima.mass = cluster.mass;
      }
      if (tfce_) {
        tfce_->enhance(map_, enhanced_);
        maxima.tfce = largest(enhanced_);
      }
      return maxima;
    }

    void keep(PermutationResult& first) const {
      first.observed = Eigen::Map<const Eigen::VectorXf>(map_.data(), test_.places_).cast<double>();
      if (!tfce_) return;
      first.enhanced =
          Eigen::Map<const Eigen::VectorXf>(enhanced_.data(), test_.places_).cast<double>();
    }

   private:
    static float largest(const std::vector<float>& values) {
      float most = 0;
      for (const float v : values) most = std::max(most, std::abs(v));
      return most;
    }

    const Test& test_;
    std::vector<float> map_, enhanced_;
    std::optional<LargestClusterFinder> clusters_;
    std::optional<Tfce> tfce_;
  };

  /// Column c of block shuffle b is P^T times a column of the basis.
  void fillWeights(std::int64_t begin, std::size_t b) {
    const Eigen::Index n = basis_.rows();
    std::vector<std::int32_t> order(static_cast<std::size_t>(n));
    std::vector<float> signs(order.size());
    shuffler_.draw(begin + static_cast<std::int64_t>(b), order, signs);
    for (Eigen::Index k = 0; k < basis_.cols(); ++k) {
      const std::int64_t column = static_cast<std::int64_t>(b) * basis_.cols() + k;
      float* tile =
          weights_.data() + column / kTileWeights * kTileWeights * n + column % kTileWeights;
      for (Eigen::Index i = 0; i < n; ++i) {
        const auto at = static_cast<std::size_t>(i);
        tile[order[at] * kTileWeights] = basis_(i, k) * signs[at];
      }
    }
  }

  void project(std::ptrdiff_t panel) {
    for (std::int64_t t = 0; t < tiles_; ++t) {
      kernels::projectPanel(
          panels_.panel(panel), weights_.data() + t * kTileWeights * basis_.rows(), basis_.rows(),
          sums_.data() + t * kTileWeights * panels_.stride() + panel * kPanelPlaces,
          panels_.stride());
    }
  }

  /// t or F of each place from its projections; residuals have unit length.
  void statistics(std::size_t shuffle, std::vector<float>& map) const {
    const float* sums =
        sums_.data() + static_cast<std::ptrdiff_t>(shuffle) * basis_.cols() * panels_.stride();
    const auto places = static_cast<std::size_t>(places_);
    std::vector<float> explained(places, 0.0F), rest(places, 1.0F);
    for (Eigen::Index k = 0; k < basis_.cols(); ++k) {
      const float* sum = sums + k * panels_.stride();
      for (std::size_t v = 0; v < places; ++v) {
        const float square = sum[v] * sum[v];
        rest[v] -= square;
        if (k < tested_) explained[v] += square;
      }
    }
    for (std::size_t v = 0; v < places; ++v) {
      const float variance = std::max(rest[v], kLeastRest) / df_;
      map[v] = tested_ == 1 ? sums[v] / std::sqrt(variance)
                            : explained[v] / static_cast<float>(tested_) / variance;
    }
  }

  const Shuffler& shuffler_;
  const PlaceGraph* graph_;
  const PermutationOptions& options_;
  Eigen::Index places_;
  float df_;
  Eigen::Index tested_;
  Panels panels_;
  Eigen::MatrixXf basis_;  // N x (r + q): tested, then nuisance
  std::int64_t atOnce_ = 1, tiles_ = 0;
  std::vector<float> weights_, sums_;
};

void append(const std::vector<Maxima>& maxima, const PlaceGraph* graph, bool tfce,
            PermutationResult& result) {
  for (const Maxima& m : maxima) {
    result.statistic.push_back(m.statistic);
    if (graph == nullptr) continue;
    result.extent.push_back(m.extent);
    result.mass.push_back(m.mass);
    if (tfce) result.tfce.push_back(m.tfce);
  }
}

void requireChange(const Eigen::MatrixXd& columns, const Shuffler& shuffler,
                   const Contrast& contrast) {
  if (shuffler.count() > 1 && !inSpan(columns, shuffler.invariant())) return;
  throw InvalidInput("contrast '" + contrast.name +
                     "': no shuffle of people changes what it tests; choose another --exchange or "
                     "no permutations");
}

}  // namespace

PermutationResult permute(const Design& design, const Contrast& contrast,
                          const Eigen::MatrixXd& values, const PlaceGraph* graph,
                          const PermutationOptions& options, const Monitor& monitor) {
  const Regressors regressors = regressorsOf(design.matrix, contrast.weights);
  PermutationResult result;
  const Eigen::MatrixXd columns = columnsOf(design, contrast);
  result.exchange = exchangeFor(columns, regressors.nuisance, options);
  const Shuffler shuffler(values.rows(), options.blocks, result.exchange, options.count,
                          options.seed);
  requireChange(columns, shuffler, contrast);
  result.exhaustive = shuffler.exhaustive();
  try {
    const StopScope within(&monitor);
    Test test(regressors, values, graph, options, shuffler);
    std::vector<Maxima> maxima;
    for (std::int64_t begin = 0; begin < shuffler.count(); begin += test.atOnce()) {
      monitor.progress(static_cast<double>(begin) / static_cast<double>(shuffler.count()),
                       "permutations of " + contrast.name);
      maxima.resize(static_cast<std::size_t>(std::min(test.atOnce(), shuffler.count() - begin)));
      test.run(begin, maxima, result);
      append(maxima, graph, options.tfce, result);
    }
  } catch (const Interrupted&) {
    result.interrupted = true;
    result.exhaustive = false;
  }
  return result;
}

double familyWiseP(const std::vector<float>& maxima, double value) {
  const double limit = std::abs(value) * (1 - kRoundOff);
  const auto reached =
      std::count_if(maxima.begin(), maxima.end(), [&](float m) { return m >= limit; });
  return static_cast<double>(reached) / static_cast<double>(maxima.size());
}

Eigen::VectorXd familyWiseP(const std::vector<float>& maxima, const Eigen::VectorXd& values) {
  std::vector<float> ascending = maxima;
  std::sort(ascending.begin(), ascending.end());
  return values.unaryExpr([&](double value) {
    if (value == 0) return kNaN;
    const double limit = std::abs(value) * (1 - kRoundOff);
    const auto first = std::lower_bound(ascending.begin(), ascending.end(), limit,
                                        [](float m, double least) { return m < least; });
    return static_cast<double>(ascending.end() - first) / static_cast<double>(ascending.size());
  });
}

}  // namespace explica::statistics
