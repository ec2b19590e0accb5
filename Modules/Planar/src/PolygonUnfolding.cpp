// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/PolygonUnfolding.h"

#include "Explica/Core/Errors.h"
#include "Explica/Planar/PolygonCollision.h"
#include "Explica/Planar/PolygonKnotEnergy.h"
#include "Explica/Planar/PolygonVisibility.h"
#include "UnfoldingProblem.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

namespace explica::planar {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Visibility that rose by less than this in kStallWindow iterations will not rise any more.
constexpr double kStallGain = 1e-5;
constexpr int kStallWindow = 200;

void checkOptions(const PolygonUnfoldingOptions& options) {
  const auto refuse = [](bool bad, const char* sentence) {
    if (bad) throw InvalidInput(sentence);
  };
  refuse(!(options.targetVisibility <= 1), "target visibility: at most 1 can be reached");
  refuse(options.maxIterations < 0, "max-iterations must not be negative");
  refuse(!(options.maxTime > 0), "max-time must be positive");
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
    chain.positions.row(static_cast<Eigen::Index>(k)) = curve.positions.row(vertices[k]);
  }
  curve = std::move(chain);
  region.firstEdge = 0;
}

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
  if (!options.noTopology && !result.intersectionsInitial.empty()) {
    const auto& pair = result.intersectionsInitial.front();
    throw InvalidInput("polygon: " + std::to_string(result.intersectionsInitial.size()) +
                       " pairs of edges cross at the start, first " + std::to_string(pair[0]) +
                       " and " + std::to_string(pair[1]) + "; mend it or use --no-topology");
  }
  const double initial = polygonVisibility(result.curve, result.region, view).average;
  if (!(initial > 0)) {
    throw InvalidInput("the region's average visibility is " + std::to_string(initial) +
                       ", not positive: grow or shrink the region or move the viewpoint");
  }

  if (resume) requireStateOf(*resume, input, inputRegion, view, options);
  PolygonCheckpoint& checkpoint = result.checkpoint;
  checkpoint.input = input.positions;
  checkpoint.inputRegion = inputRegion;
  checkpoint.view = view;
  checkpoint.method = options.method;

  const auto start = Clock::now();
  const double secondsBefore = resume ? resume->history.back().seconds : 0;
  const double length = lengthOf(result.curve, result.region);
  const StartSizes sizes{length / result.region.edgeCount, length};
  std::optional<UnfoldingProblem> problem;
  std::unique_ptr<UnfoldingMethod> method;
  const auto pose = [&](const Curve& curve, const Region& region) {
    if (problem) result.secondsTopology += problem->secondsTopology();
    problem.emplace(curve, region, view, options, sizes);
    checkpoint.posed = {curve.positions, region};
    method = options.method == PolygonMethod::Implicit ? makeImplicitMethod(*problem)
                                                       : makeExplicitMethod(*problem);
  };
  const auto record = [&](int iteration, double step) {
    PolygonIteration row = problem->account();
    row.iteration = iteration;
    row.step = step;
    row.seconds = secondsBefore + secondsSince(start);
    result.history.push_back(row);
    result.path.push_back({problem->curve().positions, problem->region()});
  };
  if (resume) {
    pose({resume->posed.positions, result.curve.closed}, resume->posed.region);
    problem->moveTo(resume->path.back().positions);
    method->restore(resume->methodState);
    result.history = resume->history;
    result.path = resume->path;
    result.verticesMerged = resume->verticesMerged;
    result.firstCrossing = resume->firstCrossing;
  } else {
    pose(result.curve, result.region);
    record(0, 0);
  }
  result.termination = Termination::MaxIterations;
  for (int iteration = result.history.back().iteration + 1;; ++iteration) {
    const std::size_t last = result.history.size() - 1;
    const double visibility = result.history[last].visibility;
    if (visibility >= options.targetVisibility) {
      result.termination = Termination::TargetReached;
      break;
    }
    if (last >= kStallWindow &&
        visibility - result.history[last - kStallWindow].visibility < kStallGain) {
      result.termination = Termination::Stalled;
      break;
    }
    if (iteration > options.maxIterations) break;
    if (secondsSince(start) > options.maxTime) {
      result.termination = Termination::MaxTime;
      break;
    }
    if (monitor.shouldStop()) {
      result.termination = Termination::Interrupted;
      break;
    }
    const double step = method->advance();
    bool merges = false;
    while (const auto fewer = problem->merged()) {
      pose(fewer->first, fewer->second);
      ++result.verticesMerged;
      merges = true;
    }
    if (step == 0 && !merges) {
      result.termination = Termination::Stalled;
      break;
    }
    record(iteration, step);
    if ((options.noTopology || options.noCollision) && result.firstCrossing < 0 &&
        !intersectingEdges(problem->curve()).empty()) {
      result.firstCrossing = iteration;
    }
    monitor.progress((visibility - initial) / (options.targetVisibility - initial), "unfolding");
  }
  result.curve = problem->curve();
  result.region = problem->region();
  result.seconds = secondsBefore + secondsSince(start);
  result.secondsTopology += problem->secondsTopology();
  result.intersectionsFinal = intersectingEdges(result.curve);
  checkpoint.methodState = method->state();
  checkpoint.history = result.history;
  checkpoint.path = result.path;
  checkpoint.verticesMerged = result.verticesMerged;
  checkpoint.firstCrossing = result.firstCrossing;
  return result;
}

}  // namespace explica::planar
