// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Field.h"

#include <algorithm>
#include <cmath>

namespace explica::correspondence {

Vector TrajectoryTracer::Field::toBox(const Point& world) const {
  const Vector index = annulus.grid.toIndex(world);
  return index - Vector(annulus.first[0], annulus.first[1], annulus.first[2]);
}

Point TrajectoryTracer::Field::toWorld(const Vector& x) const {
  return annulus.grid.toWorld(x + Vector(annulus.first[0], annulus.first[1], annulus.first[2]));
}

std::int32_t TrajectoryTracer::Field::homeOf(const Vector& x) const {
  std::array<int, 3> centre{};
  for (int a = 0; a < 3; ++a) centre[a] = static_cast<int>(std::lround(x[a]));
  std::int32_t best = -1;
  double nearest = kInfinity;
  const auto strides = annulus.strides();
  const int depth = flat ? 0 : 2;
  for (int dk = -depth; dk <= depth; ++dk) {
    for (int dj = -2; dj <= 2; ++dj) {
      for (int di = -2; di <= 2; ++di) {
        const int i = centre[0] + di, j = centre[1] + dj, k = centre[2] + dk;
        if (i < 0 || j < 0 || k < 0 || i >= annulus.size[0] || j >= annulus.size[1] ||
            k >= annulus.size[2]) {
          continue;
        }
        const std::int32_t n = annulus.numberAt[i + j * strides[1] + k * strides[2]];
        if (n < 0) continue;
        const double distance =
            (Vector(i, j, k) - x).cwiseProduct(annulus.grid.spacing).squaredNorm();
        if (distance < nearest) {
          nearest = distance;
          best = n;
        }
      }
    }
  }
  return best;
}

TrajectoryTracer::TrajectoryTracer(const harmonic::Annulus& annulus,
                                   const harmonic::Interpolant& interpolant,
                                   const TraceOptions& options)
    : field_(std::make_unique<Field>(annulus, interpolant, options)) {}
TrajectoryTracer::~TrajectoryTracer() = default;
TrajectoryTracer::TrajectoryTracer(TrajectoryTracer&&) noexcept = default;

const harmonic::Annulus& TrajectoryTracer::annulus() const {
  return field_->annulus;
}

Trace TrajectoryTracer::trace(std::int32_t number, double target) const {
  const int uphill = field_->interpolant.u[number] < target ? 1 : -1;
  return field_->run(field_->begin(annulus().place[number], uphill), target, uphill);
}

std::optional<TrajectoryTracer::Field::Start> TrajectoryTracer::Field::startAt(
    const Point& point, double target) const {
  Vector x = toBox(point);
  if (flat) x[2] = std::round(x[2]);
  const std::int32_t home = homeOf(x);
  if (home < 0) return {};
  Sample here = sample(x, home);
  Start start;
  if (here.home < 0) {
    const auto s = annulus.boxSubscripts(home);
    const Vector goal(s[0], s[1], s[2]);
    const Vector origin = x;
    double t = 0;
    while (here.home < 0 && t < 1) {
      t = std::min(1.0, t + 0.125);
      x = origin + t * (goal - origin);
      here = sample(x, home);
    }
    start.lead = (x - origin).cwiseProduct(annulus.grid.spacing).norm();
  }
  start.uphill = here.u < target ? 1 : -1;
  start.walk = begin(x, here.home, start.uphill);
  return start;
}

Trace TrajectoryTracer::trace(const Point& start, double target) const {
  Trace result;
  result.point = start;
  const auto from = field_->startAt(start, target);
  if (!from) return result;
  result = field_->run(from->walk, target, from->uphill);
  result.length += from->lead;
  return result;
}

Point Path::at(double arc) const {
  if (points.size() == 1 || arc <= 0) return points.front();
  const auto next = std::upper_bound(along.begin(), along.end(), static_cast<float>(arc));
  if (next == along.end()) return points.back();
  const std::size_t k = next - along.begin();
  const double span = along[k] - along[k - 1];
  const double t = span > 0 ? (arc - along[k - 1]) / span : 0;
  return points[k - 1] + t * (points[k] - points[k - 1]);
}

std::optional<Path> TrajectoryTracer::path(const Point& start, double target) const {
  const auto from = field_->startAt(start, target);
  if (!from) return {};
  constexpr double kStep = 0.25;  // voxels, so that the polyline has the trajectory's bends
  Path path{{start}, {0}};
  Field::Walk walk = from->walk;
  bool done = from->uphill * (walk.u - target) >= 0;
  for (int k = 0; !done && !walk.stuck && k < kMaxSteps; ++k) {
    walk.step = std::min(walk.step, kStep * field_->finest);
    done = field_->advance(walk, target, from->uphill);
    path.points.push_back(field_->toWorld(walk.x));
    path.along.push_back(static_cast<float>(from->lead + walk.length));
  }
  if (!done) return {};
  return path;
}

std::optional<double> TrajectoryTracer::thickness(const Point& point) const {
  const Trace inward = trace(point, 0), outward = trace(point, 1);
  if (!inward.reached || !outward.reached) return {};
  return inward.length + outward.length;
}

std::optional<double> TrajectoryTracer::value(const Point& point) const {
  const Vector x = field_->toBox(point);
  const auto sample = field_->sample(x, field_->homeOf(x));
  if (sample.home < 0) return {};
  return sample.u;
}

std::optional<Vector> TrajectoryTracer::direction(const Point& point) const {
  const Vector x = field_->toBox(point);
  const auto sample = field_->sample(x, field_->homeOf(x));
  if (sample.home < 0) return {};
  const Vector perMm = sample.gradient.cwiseProduct(field_->inverseSpacing);
  const double norm = perMm.norm();
  if (!(norm > 0)) return {};
  return field_->annulus.grid.axesToWorld(perMm / norm);
}

}  // namespace explica::correspondence
