// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "UnfoldingProblem.h"

#include "Explica/Core/PhaseClock.h"
#include "Explica/Planar/PolygonKnotEnergy.h"
#include "Explica/Planar/PolygonVisibility.h"

#include <algorithm>

namespace explica::planar {
namespace {

constexpr double kBarrierShare = 0.25;  // of the mean edge: the barrier's range
constexpr double kMergeShare = 0.25;    // of the mean edge: a shorter one is merged, if it may be
constexpr int kLeastEdges = 3;          // of a region whose edges are merged

}  // namespace

UnfoldingProblem::UnfoldingProblem(const Curve& curve, const Region& region, const Viewpoints& view,
                                   const PolygonUnfoldingOptions& options, const StartSizes& start)
    : curve_(curve),
      region_(region),
      view_(view),
      options_(options),
      moving_(curve.vertexCount(), false),
      slots_(curve.vertexCount(), -1),
      restLengths_(edgeLengths(curve)),
      start_(start) {
  Region movingRegion = region;
  if (options.surround == PolygonSurround::Elastic) {
    const int room = curve.edgeCount() - region.edgeCount;
    const int before = std::min(options.collar, room / 2);
    const int after = std::min(options.collar, room - before);
    movingRegion.firstEdge = (region.firstEdge - before + curve.edgeCount()) % curve.edgeCount();
    movingRegion.edgeCount = std::min(region.edgeCount + before + after, curve.edgeCount());
  }
  movers_ = verticesOf(curve, movingRegion);
  if (options.surround == PolygonSurround::Elastic && movers_.size() > 2 &&
      movingRegion.edgeCount < curve.edgeCount()) {
    movers_ = {movers_.begin() + 1, movers_.end() - 1};  // the collar's ends hold
  }
  for (std::size_t k = 0; k < movers_.size(); ++k) {
    moving_[movers_[k]] = true;
    slots_[movers_[k]] = static_cast<int>(k);
  }
  const std::vector<int> regionEdges = edgesOf(curve, region);
  if (!options.noLength) keptEdges_ = regionEdges;
  std::vector<bool> inRegion(curve.edgeCount(), false);
  for (const int e : regionEdges) inRegion[e] = true;
  for (const int e : edgesOf(curve, movingRegion)) {
    if (!inRegion[e]) softEdges_.push_back(e);
  }
  knot_.emplace(options.noTopology ? PolygonKnot::Off : options.knot, curve, moving_);
}

PolygonKnotValue UnfoldingProblem::knot(const Curve& curve) {
  const PhaseClock watch(secondsTopology_);
  PolygonKnotValue value = knot_->evaluate(curve.positions);
  lastKnot_ = value.value;
  return value;
}

std::vector<VertexEdgePair> UnfoldingProblem::pairsWithin(double reach) {
  if (options_.noTopology || options_.noCollision) return {};
  const PhaseClock watch(secondsTopology_);
  std::vector<VertexEdgePair> pairs =
      nearbyPairs(curve_, moving_, restLengths_, barrierRange(), reach);
  lastLeastDistance_ = leastDistance(curve_, pairs);
  return pairs;
}

double UnfoldingProblem::safeStep(const Positions2& target,
                                  const std::vector<VertexEdgePair>& pairs) {
  const PhaseClock watch(secondsTopology_);
  return largestSafeStep(curve_, target, pairs);
}

double UnfoldingProblem::barrierRange() const {
  return kBarrierShare * start_.meanEdge;
}

std::optional<std::pair<Curve, Region>> UnfoldingProblem::merged() {
  if (!options_.noLength || region_.edgeCount <= kLeastEdges) return std::nullopt;
  const int n = curve_.vertexCount();
  for (int e : edgesOf(curve_, region_)) {
    const int f = curve_.next(e);
    if ((curve_.point(f) - curve_.point(e)).norm() > kMergeShare * start_.meanEdge) continue;
    Curve target = curve_;
    target.positions.row(e) = (curve_.positions.row(e) + curve_.positions.row(f)) / 2;
    target.positions.row(f) = target.positions.row(e);
    std::vector<VertexEdgePair> pairs = pairsWithin(2 * kMergeShare * start_.meanEdge);
    std::erase_if(pairs, [&](const VertexEdgePair& pair) {
      const int end = curve_.next(pair.edge);
      const bool hasE = pair.vertex == e || pair.edge == e || end == e;
      const bool hasF = pair.vertex == f || pair.edge == f || end == f;
      return hasE && hasF;
    });
    if (safeStep(target.positions, pairs) < 1) continue;
    Curve fewer = curve_;
    fewer.positions.resize(n - 1, 2);
    for (int v = 0, row = 0; v < n; ++v) {
      if (v != f) fewer.positions.row(row++) = target.positions.row(v);
    }
    const bool mayCross = options_.noTopology || options_.noCollision;
    if (!mayCross && !intersectingEdges(fewer).empty()) continue;
    Region region = region_;
    --region.edgeCount;
    // Vertex f is gone: a region that starts behind it starts one earlier.
    if (f <= region.firstEdge) --region.firstEdge;
    if (region.firstEdge < 0) region.firstEdge += n - 1;
    return std::pair{std::move(fewer), region};
  }
  return std::nullopt;
}

PolygonIteration UnfoldingProblem::account() {
  const PolygonVisibility visibility = polygonVisibility(curve_, region_, view_);
  PolygonIteration row{.visibility = visibility.average,
                       .variance = visibility.variance,
                       .length = visibility.length};
  for (int e : edgesOf(curve_, region_)) {
    const double length = (curve_.point(curve_.next(e)) - curve_.point(e)).norm();
    row.lengthError = std::max(row.lengthError, std::abs(length / restLengths_[e] - 1));
  }
  row.leastDistance = lastLeastDistance_;
  row.knotEnergy = lastKnot_;
  return row;
}

}  // namespace explica::planar
