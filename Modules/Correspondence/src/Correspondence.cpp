// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/Correspondence.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Field.h"
#include "GridFaces.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace explica::correspondence {

using harmonic::Annulus;
using harmonic::Interpolant;
using harmonic::kInner;
using harmonic::kOuter;
using harmonic::signOf;

namespace {

using Tracer = TrajectoryTracer::Field;
constexpr std::size_t kBlock = 1 << 13;  // voxels a task
// Default lambda over the longest diagonal of a grid face: so far apart are the boundary points of
// its corners where trajectories run in parallel.  Beyond it they diverge.
const double kLambda = std::sqrt(2);

/// What one side has found at a voxel: boundary point minus the voxel's centre along the grid's
/// axes, then the length, mm; NaN where the trajectory did not arrive.
using Arrival = Eigen::Array4f;

/// mm between the corners of a grid face that are farthest apart, times kLambda.
double defaultLambda(const Annulus& annulus) {
  std::array<double, 3> h;
  std::ranges::copy(annulus.grid.spacing, h.begin());
  const auto end = annulus.planar ? h.end() - 1 : h.end();
  std::sort(h.begin(), end);
  return kLambda * std::hypot(end[-1], end[-2]);
}

/// Finds one side's arrivals.
class Sweep {
 public:
  Sweep(const Tracer& tracer, const CorrespondenceOptions& options, bool inner)
      : tracer_(tracer),
        annulus_(tracer.annulus),
        method_(options.method),
        inner_(inner),
        uphill_(inner ? -1 : 1),
        target_(inner ? 0.0 : 1.0),
        wall_(inner ? kInner : kOuter),
        lambda_(static_cast<float>(options.lambda.value_or(defaultLambda(annulus_)))),
        spacing_(annulus_.grid.spacing.cast<float>()),
        arrivals_(annulus_.count(), Arrival::Constant(static_cast<float>(kNaN))) {}

  /// Follows every trajectory to the boundary.
  void traceAll(const Monitor& monitor) {
    parallelForBlocks(arrivals_.size(), 1024, [&](std::size_t begin, std::size_t end) {
      if (monitor.shouldStop()) return;
      traceToWall([&] { return begin < end ? static_cast<std::int32_t>(begin++) : -1; });
    });
    traced_ = arrivals_.size();
  }

  /// Voxel by voxel in the order of u, each out of those before it.
  void sweep(const std::vector<std::int32_t>& order, const Monitor& monitor) {
    isSource_.assign(arrivals_.size(), 0);
    if (method_ != Method::Eulerian) traceBesideWall();
    for (std::size_t k = 0; k < order.size(); ++k) {
      const std::int32_t r = order[inner_ ? k : order.size() - 1 - k];
      if (!found(r)) find(r);
      isSource_[r] = found(r) && !onCut(r);
      if ((k & 0xffff) == 0 && monitor.shouldStop()) return;
    }
  }

  [[nodiscard]] const Arrival& at(std::size_t rank) const { return arrivals_[rank]; }
  [[nodiscard]] std::size_t traced() const { return traced_; }

 private:
  /// (3.1) and (3.2) where they may be taken, else along the trajectory.
  void find(std::int32_t r) {
    if (method_ != Method::Hybrid && fromNeighbours(r)) return;
    if (method_ != Method::Eulerian) {
      traced_ += traceToFace(r);
    } else {
      traceToWall(r);
      ++traced_;
    }
  }

  [[nodiscard]] bool found(std::int32_t r) const { return !std::isnan(arrivals_[r][3]); }
  [[nodiscard]] bool onCut(std::int32_t r) const {
    return !tracer_.onCut.empty() && tracer_.onCut[annulus_.numberAt[tracer_.placeOf[r]]] != 0;
  }
  [[nodiscard]] std::array<int, 3> subscripts(std::int32_t place) const {
    const std::int32_t row = place / annulus_.size[0];
    return {place % annulus_.size[0], row % annulus_.size[1], row / annulus_.size[1]};
  }

  void traceBesideWall() {
    traced_ += parallelSum(arrivals_.size(), 1 << 12, std::size_t{0},
                           [&](std::size_t begin, std::size_t end) {
                             std::size_t sum = 0;
                             traceToWall([&] {
                               while (begin < end && !isBesideWall(begin)) ++begin;
                               if (begin == end) return -1;
                               ++sum;
                               return static_cast<std::int32_t>(begin++);
                             });
                             return sum;
                           });
    for (std::size_t r = 0; r < arrivals_.size(); ++r) {
      const auto rank = static_cast<std::int32_t>(r);
      isSource_[r] = found(rank) && !onCut(rank);
    }
  }

  [[nodiscard]] Vector centreOf(std::int32_t r) const {
    const auto s = subscripts(tracer_.placeOf[r]);
    return {static_cast<double>(s[0]), static_cast<double>(s[1]), static_cast<double>(s[2])};
  }
  [[nodiscard]] bool isBesideWall(std::size_t r) const {
    const std::int32_t n = annulus_.numberAt[tracer_.placeOf[r]];
    if (annulus_.irregular(n) < 0) return false;
    const auto& links = annulus_.links[n];
    return std::find(links.begin(), links.end(), wall_) != links.end();
  }

  /// Follows the trajectories of all ranks that next() gives until it gives -1.
  template <class Next>
  void traceToWall(const Next& next) {
    const auto begin = [&](Tracer::Walk& walk) {
      const std::int32_t r = next();
      if (r >= 0) walk = tracer_.begin(tracer_.placeOf[r], uphill_);
      return r;
    };
    tracer_.followEach(target_, uphill_, begin,
                       [&](std::int32_t r, const Tracer::Walk& walk, bool done) {
                         if (done) store(r, walk);
                       });
  }

  void traceToWall(std::int32_t r) {
    traceToWall([&] { return std::exchange(r, -1); });
  }

  void store(std::int32_t r, const Tracer::Walk& walk) {
    const Vector way = (walk.x - centreOf(r)).cwiseProduct(annulus_.grid.spacing);
    arrivals_[r] << way.cast<float>(), static_cast<float>(walk.length);
  }

  /// (3.1), (3.2) with weights |T_a| / h_a.  False if there is nothing upwind, or if appendix A
  /// finds its points lambda or more apart.
  bool fromNeighbours(std::int32_t r) {
    const Vector g =
        tracer_.node[r].head<3>().matrix().cast<double>().cwiseProduct(tracer_.inverseSpacing);
    const double norm = g.norm();
    if (!(norm > 0)) return false;
    const Vector& h = annulus_.grid.spacing;
    const std::int32_t place = tracer_.placeOf[r];
    const auto strides = annulus_.strides();
    const auto& links = annulus_.links[annulus_.numberAt[place]];
    double sum = 0;
    Eigen::Array4d value = Eigen::Array4d::Zero();
    Eigen::Array4d points[3];  // relative to this voxel, and length
    int count = 0;
    for (int a = 0; a < 3; ++a) {
      const double slope = g[a] / norm;
      if (slope == 0) continue;
      // Upwind is where u comes from: smaller for the inner side, larger for the outer one.
      const int d = 2 * a + ((slope > 0) == inner_ ? 0 : 1);
      const double weight = std::abs(slope) / h[a];
      Eigen::Array4d there = Eigen::Array4d::Zero();
      if (links[d] >= 0) {
        const std::int32_t m = tracer_.rankAt[place + signOf(d) * strides[a]];
        if (!found(m) && isAppendixA_) return false;  // half of the upwind points test nothing
        if (!found(m)) continue;
        there = arrivals_[m].cast<double>();
      } else if (links[d] != wall_ || isAppendixA_) {
        continue;
      }
      there[a] += signOf(d) * h[a];
      points[count++] = there;
      value += weight * there;
      sum += weight;
    }
    if (count == 0) return false;
    if (isAppendixA_) {
      for (int p = 0; p < count; ++p) {
        for (int q = p + 1; q < count; ++q) {
          if ((points[p] - points[q]).head<3>().matrix().norm() >= lambda_) return false;
        }
      }
    }
    value[3] += 1;
    arrivals_[r] = (value / sum).cast<float>();
    return true;
  }

  /// Follows the trajectory to the first grid face whose corners are sources and agree within
  /// lambda, else to the boundary.
  /// @return  whether it went past a face whose corners disagree, or to the boundary
  bool traceToFace(std::int32_t r) {
    bool disagreed = false;
    Tracer::Walk walk = tracer_.begin(tracer_.placeOf[r], uphill_);
    bool done = uphill_ * (walk.u - target_) >= 0;
    for (int k = 0; !done && !walk.stuck && k < kMaxSteps; ++k) {
      const Tracer::Walk before = walk;
      done = tracer_.advance(walk, target_, uphill_);
      if (done || walk.stuck) break;
      const auto interpolate = [&](int axis, const Vector& x, double length) {
        const std::optional<Face> face = faces_.at(axis, x);
        return face && fromFace(r, *face, length, disagreed);
      };
      if (faces_.between(before, walk, interpolate)) return disagreed;
    }
    if (done) store(r, walk);
    return true;
  }

  /// Interpolates on a grid face, if its corners are sources and agree.
  bool fromFace(std::int32_t r, const Face& face, double length, bool& disagreed) {
    const auto& [b, c, base, place, fb, fc] = face;
    const int corners = faces_.corners();
    const auto strides = annulus_.strides();
    const Arrival* arrival[4];
    for (int e = 0; e < corners; ++e) {
      arrival[e] = source(place[e]);
      if (arrival[e] == nullptr) return false;
    }
    // Boundary points relative to the first corner's centre.
    Arrival value[4];
    for (int e = 0; e < corners; ++e) {
      value[e] = *arrival[e];
      if (e & 1) value[e][b] += spacing_[b];
      if (e & 2) value[e][c] += spacing_[c];
    }
    for (int e = 0; e < corners; ++e) {
      for (int f = e + 1; f < corners; ++f) {
        if (!(apart(value[e] - value[f]) < lambda_ * lambda_)) {
          disagreed = true;
          return false;
        }
      }
    }
    Arrival sum = value[0] + fb * (value[1] - value[0]);
    if (corners == 4) sum += fc * (value[2] + fb * (value[3] - value[2]) - sum);
    if (!isAppendixA_) {
      // Second order: -f (1 - f) / 2 times the second difference along each axis.
      for (int e = 0; e < corners; e += 2) {
        const float across = corners == 2 ? 1 : e == 0 ? 1 - fc : fc;
        sum -= across * bend(place[e] - strides[b], *arrival[e], *arrival[e + 1],
                             place[e + 1] + strides[b], fb);
      }
      if (corners == 4) {
        for (int e = 0; e < 2; ++e) {
          sum -= (e == 0 ? 1 - fb : fb) * bend(place[e] - strides[c], *arrival[e], *arrival[e + 2],
                                               place[e + 2] + strides[c], fc);
        }
      }
    }
    const auto s = subscripts(tracer_.placeOf[r]);
    for (int a = 0; a < 3; ++a) sum[a] += static_cast<float>(base[a] - s[a]) * spacing_[a];
    sum[3] += static_cast<float>(length);
    arrivals_[r] = sum;
    return true;
  }

  /// Arrival at a box voxel that others may interpolate in; null otherwise.
  [[nodiscard]] const Arrival* source(std::int32_t place) const {
    const std::int32_t m = tracer_.rankAt[place];
    return m >= 0 && isSource_[m] != 0 ? &arrivals_[m] : nullptr;
  }

  static float apart(const Arrival& difference) {
    return difference[0] * difference[0] + difference[1] * difference[1] +
           difference[2] * difference[2];
  }

  /// f (1 - f) / 2 times the second difference along four voxels in line: `low` and `high` at the
  /// face, and beyond them whichever are sources.
  [[nodiscard]] Arrival bend(std::int32_t beyondLow, const Arrival& low, const Arrival& high,
                             std::int32_t beyondHigh, float f) const {
    Arrival second = Arrival::Zero();
    int found = 0;
    const auto add = [&](const Arrival* outside, const Arrival& middle, const Arrival& other) {
      if (outside == nullptr) return;
      // The centres' own second difference is zero.
      const Arrival difference = *outside - 2 * middle + other;
      if (apart(difference) >= 4 * lambda_ * lambda_) return;
      second += difference;
      ++found;
    };
    add(source(beyondLow), low, high);
    add(source(beyondHigh), high, low);
    if (found == 0) return second;
    return (0.5F * f * (1 - f) / static_cast<float>(found)) * second;
  }

  const Tracer& tracer_;
  const Annulus& annulus_;
  GridFaces faces_{annulus_};
  Method method_;
  bool isAppendixA_ = method_ == Method::AppendixA;
  bool inner_;
  int uphill_;
  double target_;
  std::int32_t wall_;
  float lambda_;
  Eigen::Array3f spacing_;
  std::size_t traced_ = 0;
  std::vector<Arrival> arrivals_;       ///< per rank
  std::vector<std::uint8_t> isSource_;  ///< per rank: others may interpolate in it
};

/// Ranks by ascending u; equal values by rank.
std::vector<std::int32_t> orderByValue(const Tracer& tracer, const std::vector<double>& u) {
  std::vector<std::int32_t> order(u.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(
      order, {}, [&](std::int32_t r) { return u[tracer.annulus.numberAt[tracer.placeOf[r]]]; });
  return order;
}

}  // namespace

Correspondence findCorrespondences(const Annulus& annulus, const Interpolant& interpolant,
                                   const CorrespondenceOptions& given, const Monitor& monitor) {
  if (given.lambda && !(*given.lambda >= 0))
    throw InvalidInput("lambda must be 0 or more millimetres");
  CorrespondenceOptions options = given;
  if (options.lambda && options.method == Method::Lagrangian) options.method = Method::Hybrid;
  const bool isDialled = options.method == Method::Hybrid || options.method == Method::AppendixA;
  const bool followAll =
      options.method == Method::Lagrangian || (isDialled && options.lambda == 0.0);
  double& longest = options.trace.maxStep;
  if (!followAll) longest = std::min(longest, 1.0);  // from one grid face to the next
  const TrajectoryTracer tracer(annulus, interpolant, options.trace);
  const Tracer& field = tracer.field();
  Sweep inner(field, options, true);
  Sweep outer(field, options, false);
  if (followAll) {
    inner.traceAll(monitor);
    monitor.progress(0.5, "correspondences");
    outer.traceAll(monitor);
  } else {
    const auto order = orderByValue(field, interpolant.u);
    parallelFor(2, 1, [&](std::size_t side) { (side == 0 ? inner : outer).sweep(order, monitor); });
  }
  monitor.progress(1, "correspondences");

  Correspondence result;
  result.traced = inner.traced() + outer.traced();
  result.innerDistance.resize(annulus.count());
  result.outerDistance.resize(annulus.count());
  result.innerPoint.resize(annulus.count());
  result.outerPoint.resize(annulus.count());
  const Eigen::Matrix3f toWorld = annulus.grid.direction.cast<float>();
  parallelFor(annulus.count(), kBlock, [&](std::size_t r) {
    const std::int32_t n = annulus.numberAt[field.placeOf[r]];
    const auto take = [&](const Arrival& arrival, double& distance, Eigen::Vector3f& point) {
      distance = arrival[3];
      point = toWorld * arrival.head<3>().matrix();
    };
    take(inner.at(r), result.innerDistance[n], result.innerPoint[n]);
    take(outer.at(r), result.outerDistance[n], result.outerPoint[n]);
  });
  result.missing = parallelSum(annulus.count(), 1 << 13, std::size_t{0},
                               [&](std::size_t begin, std::size_t end) {
                                 std::size_t sum = 0;
                                 for (std::size_t n = begin; n < end; ++n) {
                                   sum += std::isnan(result.thickness(n));
                                 }
                                 return sum;
                               });
  return result;
}

}  // namespace explica::correspondence
