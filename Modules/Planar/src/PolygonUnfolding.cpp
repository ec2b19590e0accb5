// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/PolygonUnfolding.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Stopwatch.h"
#include "Explica/Planar/PolygonKnotEnergy.h"
#include "Explica/Planar/PolygonVisibility.h"
#include "UnfoldingProblem.h"

#include <memory>
#include <optional>
#include <string>

namespace explica::planar {
namespace {

/// Visibility that rose by less than this in kStallWindow iterations will not rise any more.
constexpr double kStallGain = 1e-5;
constexpr int kStallWindow = 200;

void checkOptions(const PolygonUnfoldingOptions& options) {
  const auto refuse = [](bool bad, const char* sentence) {
    if (bad) throw InvalidInput(sentence);
  };
  refuse(!(options.targetVisibility <= 1), "target visibility: at most 1 can be reached");
  refuse(options.maxIterations < 0, "max-iterations must not be negative");
  refuse(options.collar < 1, "collar: at least one edge is needed");
  refuse(!(options.knotWeight >= 0), "knot-weight must not be negative");
  refuse(!(options.explicitStep > 0 && options.explicitStep <= 1),
         "explicit-step must lie between 0 and 1");
  refuse(!(options.visibilityGain > 0) || !(options.repulsionGain >= 0),
         "visibility-gain must be positive and repulsion-gain not negative");
}

void requireStateOf(const PolygonCheckpoint& state, const Curve& curve, const Region& region,
                    const Viewpoints& view, const PolygonUnfoldingOptions& options) {
  const auto refuse = [](bool bad, const char* what) {
    if (bad) {
      throw InvalidInput(std::string("resume: the state is of another ") + what +
                         "; give that of the first run, or start anew");
    }
  };
  refuse(state.input.rows() != curve.vertexCount() || state.input != curve.positions, "polygon");
  refuse(state.inputRegion != region, "region");
  refuse(state.view != view, "viewpoint");
  refuse(state.method != options.method, "method");
  refuse(state.history.empty() || state.history.size() != state.path.size() ||
             state.posed.positions.rows() != state.path.back().positions.rows(),
         "kind");
}

/// The region as an open chain of its own.
void isolate(Curve& curve, Region& region) {
  const std::vector<int> vertices = verticesOf(curve, region);
  Curve chain;
  chain.closed = curve.closed && region.edgeCount == curve.edgeCount();
  chain.positions.resize(static_cast<Eigen::Index>(vertices.size()), 2);
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    chain.positions.row(k) = curve.positions.row(vertices[k]);
  }
  curve = std::move(chain);
  region.firstEdge = 0;
}

/// @throws InvalidInput  edges cross although topology is to be kept
void requireNoCrossing(const std::vector<std::array<int, 2>>& pairs,
                       const PolygonUnfoldingOptions& options) {
  if (options.noTopology || pairs.empty()) return;
  throw InvalidInput("polygon: " + std::to_string(pairs.size()) +
                     " pairs of edges cross at the start, first " +
                     std::to_string(pairs.front()[0]) + " and " + std::to_string(pairs.front()[1]) +
                     "; mend it or use --no-topology");
}

/// @throws InvalidInput  nothing of the region is to be seen
double initialVisibility(const Curve& curve, const Region& region, const Viewpoints& view) {
  const double visibility = polygonVisibility(curve, region, view).average;
  if (visibility > 0) return visibility;
  throw InvalidInput("the region's average visibility is " + std::to_string(visibility) +
                     ", not positive: grow or shrink the region or move the viewpoint");
}

/// An unfolding under way: the method at work, and the account of what it did.
class PolygonRun {
 public:
  PolygonRun(PolygonUnfolding& result, const Viewpoints& view,
             const PolygonUnfoldingOptions& options, const PolygonCheckpoint* resume)
      : result_(result), view_(view), options_(options) {
    const double length = lengthOf(result.curve, result.region);
    sizes_ = {length / result.region.edgeCount, length};
    if (resume == nullptr) {
      pose(result.curve, result.region);
      record(0, 0);
      return;
    }
    secondsBefore_ = resume->history.back().seconds;
    pose({resume->posed.positions, result.curve.closed}, resume->posed.region);
    problem_->moveTo(resume->path.back().positions);
    method_->restore(resume->methodState);
    result.history = resume->history;
    result.path = resume->path;
    result.verticesMerged = resume->verticesMerged;
    result.firstCrossing = resume->firstCrossing;
  }

  /// Why no iteration of this number is to follow, if none is.
  [[nodiscard]] std::optional<Termination> reasonToEnd(int iteration,
                                                       const Monitor& monitor) const {
    const std::size_t last = result_.history.size() - 1;
    const double visibility = result_.history[last].visibility;
    if (visibility >= options_.targetVisibility) return Termination::TargetReached;
    if (last >= kStallWindow &&
        visibility - result_.history[last - kStallWindow].visibility < kStallGain) {
      return Termination::Stalled;
    }
    if (iteration > options_.maxIterations) return Termination::MaxIterations;
    if (monitor.shouldStop()) return Termination::Interrupted;
    return {};
  }

  /// One iteration, or none if the monitor asks for an end during it.
  /// @return whether anything moved
  bool advance(int iteration, const Monitor& monitor) {
    const PolygonMethodState before = method_->state();
    double step = 0;
    try {
      const StopScope abandoned(&monitor);
      step = method_->advance();
    } catch (const Interrupted&) {
      method_->restore(before);
      return false;
    }
    bool merges = false;
    while (const auto fewer = problem_->merged()) {
      pose(fewer->first, fewer->second);
      ++result_.verticesMerged;
      merges = true;
    }
    if (step == 0 && !merges) return false;
    record(iteration, step);
    if ((options_.noTopology || options_.noCollision) && result_.firstCrossing < 0 &&
        !intersectingEdges(problem_->curve()).empty()) {
      result_.firstCrossing = iteration;
    }
    return true;
  }

  /// Puts what was reached into the result, and what a later run needs into its checkpoint.
  void finish() {
    result_.curve = problem_->curve();
    result_.region = problem_->region();
    result_.seconds = secondsBefore_ + elapsed_();
    result_.secondsTopology += problem_->secondsTopology();
    result_.intersectionsFinal = intersectingEdges(result_.curve);
    PolygonCheckpoint& checkpoint = result_.checkpoint;
    checkpoint.methodState = method_->state();
    checkpoint.history = result_.history;
    checkpoint.path = result_.path;
    checkpoint.verticesMerged = result_.verticesMerged;
    checkpoint.firstCrossing = result_.firstCrossing;
  }

 private:
  /// Begins anew from a curve, whose vertices may be fewer.
  void pose(const Curve& curve, const Region& region) {
    if (problem_) result_.secondsTopology += problem_->secondsTopology();
    problem_.emplace(curve, region, view_, options_, sizes_);
    result_.checkpoint.posed = {curve.positions, region};
    method_ = options_.method == PolygonMethod::Implicit ? makeImplicitMethod(*problem_)
                                                         : makeExplicitMethod(*problem_);
  }

  void record(int iteration, double step) {
    PolygonIteration row = problem_->account();
    row.iteration = iteration;
    row.step = step;
    row.seconds = secondsBefore_ + elapsed_();
    result_.history.push_back(row);
    result_.path.push_back({problem_->curve().positions, problem_->region()});
  }

  PolygonUnfolding& result_;
  const Viewpoints& view_;
  const PolygonUnfoldingOptions& options_;
  Stopwatch elapsed_;
  double secondsBefore_ = 0;
  StartSizes sizes_{};
  std::optional<UnfoldingProblem> problem_;
  std::unique_ptr<UnfoldingMethod> method_;
};

}  // namespace

PolygonUnfolding unfoldPolygon(const Curve& input, const Region& inputRegion,
                               const Viewpoints& view, const PolygonUnfoldingOptions& options,
                               const Monitor& monitor, const PolygonCheckpoint* resume) {
  requireUsable(input);
  checkOptions(options);
  if (input.closed && signedArea(input.positions) <= 0) {
    throw InvalidInput("polygon: its vertices run clockwise; reverse their order");
  }
  PolygonUnfolding result;
  result.curve = input;
  result.region = inputRegion;
  if (options.surround == PolygonSurround::None) isolate(result.curve, result.region);
  result.intersectionsInitial = intersectingEdges(result.curve);
  requireNoCrossing(result.intersectionsInitial, options);
  const double initial = initialVisibility(result.curve, result.region, view);
  if (resume) requireStateOf(*resume, input, inputRegion, view, options);
  result.checkpoint.input = input.positions;
  result.checkpoint.inputRegion = inputRegion;
  result.checkpoint.view = view;
  result.checkpoint.method = options.method;

  const StopScope kept(nullptr);  // from here on there is a state to give back
  PolygonRun run(result, view, options, resume);
  for (int iteration = result.history.back().iteration + 1;; ++iteration) {
    const double visibility = result.history.back().visibility;
    if (const auto reason = run.reasonToEnd(iteration, monitor)) {
      result.termination = *reason;
      break;
    }
    if (!run.advance(iteration, monitor)) {
      result.termination = monitor.shouldStop() ? Termination::Interrupted : Termination::Stalled;
      break;
    }
    monitor.progress((visibility - initial) / (options.targetVisibility - initial), "unfolding");
  }
  run.finish();
  return result;
}

}  // namespace explica::planar
