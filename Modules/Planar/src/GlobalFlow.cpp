// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/GlobalFlow.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/GlobalFlow.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Planar/PolygonMeasures.h"

#include <algorithm>
#include <cmath>

namespace explica::planar {
namespace {

MeasureValue valueOf(const Curve& curve, GlobalMeasure measure, const ViewingCircle& circle) {
  return measure == GlobalMeasure::HiddenArc
             ? hiddenViewingArcGradient(curve, circle.centre, circle.radius)
             : selfOcclusionGradient(curve);
}

GlobalFlowStep accountOf(const Curve& curve, const Region& region, const Viewpoints& view,
                         int iteration, double measure) {
  const PolygonVisibility visibility = polygonVisibility(curve, region, view);
  return {iteration,          measure,
          visibility.average, visibility.variance,
          visibility.length,  static_cast<int>(intersectingEdges(curve).size())};
}

}  // namespace

ViewingCircle viewingCircle(const Curve& curve, std::optional<double> radius) {
  ViewingCircle circle{curve.positions.colwise().mean().transpose(), 0};
  const double farthest =
      (curve.positions.rowwise() - circle.centre.transpose()).rowwise().norm().maxCoeff();
  circle.radius = radius.value_or(kFarAway * farthest);
  if (!(circle.radius > farthest)) {
    throw InvalidInput("viewing-radius: the polygon reaches " + std::to_string(farthest) +
                       " mm from its middle; take a larger one");
  }
  return circle;
}

GlobalFlow descendGlobalMeasure(const Curve& curve, const Region& region, const Viewpoints& view,
                                const GlobalFlowOptions& options, const Monitor& monitor) {
  requireUsable(curve);
  if (options.maxIterations < 0) throw InvalidInput("max-iterations must not be negative");
  if (!(options.step > 0 && options.step <= 1)) throw InvalidInput("step must lie between 0 and 1");
  const ViewingCircle circle = viewingCircle(curve, options.viewingRadius);
  const double meanEdge = edgeLengths(curve).mean();
  GlobalFlow flow;
  flow.curve = curve;
  flow.termination = Termination::MaxIterations;
  const StopScope abandoned(&monitor);
  MeasureValue now = valueOf(curve, options.measure, circle);
  const double start = now.value;
  const auto record = [&](int iteration) {
    flow.history.push_back(accountOf(flow.curve, region, view, iteration, now.value));
    flow.path.push_back({flow.curve.positions, region});
  };
  record(0);
  for (int iteration = 1; iteration <= options.maxIterations; ++iteration) {
    if (monitor.shouldStop()) {
      flow.termination = Termination::Interrupted;
      break;
    }
    const double steepest = now.gradient.rowwise().norm().maxCoeff();
    if (!(steepest > 0) || now.value <= kNothingLeft * start) {
      flow.termination = Termination::Converged;
      break;
    }
    // Steps shrink to nothing: the second measure has kinks, at which a search along the gradient
    // would end.
    const double left = 1 - (iteration - 1.0) / options.maxIterations;
    const Positions2 last = flow.curve.positions;
    flow.curve.positions -= options.step * meanEdge * left / steepest * now.gradient;
    try {
      now = valueOf(flow.curve, options.measure, circle);
      record(iteration);
    } catch (const Interrupted&) {
      flow.curve.positions = last;
      flow.termination = Termination::Interrupted;
      break;
    }
    if (edgeLengths(flow.curve).minCoeff() < kGone * meanEdge) {
      flow.termination = Termination::Stalled;
      break;
    }
    monitor.progress(static_cast<double>(iteration) / options.maxIterations, "descending");
  }
  return flow;
}

}  // namespace explica::planar
