// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/Correspondence.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Field.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace explica::correspondence {

using harmonic::Annulus;
using harmonic::axisOf;
using harmonic::Interpolant;
using harmonic::kInner;
using harmonic::kOuter;
using harmonic::signOf;

namespace {

using Tracer = TrajectoryTracer::Field;
constexpr int kMaxSteps = 4000;
// Default lambda in voxels.  Corners of a grid face are up to sqrt(2) voxels apart, and so are
// their boundary points where trajectories run in parallel: beyond this they diverge.
constexpr double kLambda = 2;

/// Tissue voxels by ascending u (radix sort of 32-bit fixed point; equal values by number).
std::vector<std::int32_t> orderByValue(const std::vector<double>& u) {
  const std::size_t n = u.size();
  std::vector<std::uint32_t> key(n), otherKey(n);
  std::vector<std::int32_t> order(n), other(n);
  for (std::size_t k = 0; k < n; ++k) {
    key[k] = static_cast<std::uint32_t>(std::clamp(u[k], 0.0, 1.0) * 4294967295.0);
    order[k] = static_cast<std::int32_t>(k);
  }
  for (int shift = 0; shift < 33; shift += 11) {
    std::vector<std::size_t> start(2049, 0);
    for (std::size_t k = 0; k < n; ++k) ++start[(key[k] >> shift & 2047) + 1];
    for (int b = 0; b < 2048; ++b) start[b + 1] += start[b];
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t to = start[key[k] >> shift & 2047]++;
      otherKey[to] = key[k];
      other[to] = order[k];
    }
    key.swap(otherKey);
    order.swap(other);
  }
  return order;
}

/// One side's values while they are found: boundary points as box indices relative to the voxel,
/// in mm along the grid's axes.
struct SideValues {
  std::vector<double> length;
  std::vector<Eigen::Vector3f> offset;  ///< mm along the axes, from the voxel's centre
  std::size_t traced = 0;
};

class Sweep {
 public:
  Sweep(const Annulus& annulus, const Interpolant& interpolant, const Tracer& tracer,
        const CorrespondenceOptions& options, bool inner)
      : annulus_(annulus),
        interpolant_(interpolant),
        tracer_(tracer),
        options_(options),
        inner_(inner),
        uphill_(inner ? -1 : 1),
        target_(inner ? 0.0 : 1.0),
        wall_(inner ? kInner : kOuter),
        lambda_(options.lambda.value_or(kLambda * tracer.finest)) {
    values_.length.assign(annulus.count(), kNaN);
    values_.offset.assign(annulus.count(), Eigen::Vector3f::Zero());
  }

  void traceAll(const Monitor& monitor) {
    parallelForBlocks(annulus_.count(), 1024, [&](std::size_t begin, std::size_t end) {
      if (monitor.shouldStop()) return;
      for (std::size_t n = begin; n < end; ++n) traceToWall(static_cast<std::int32_t>(n));
    });
    values_.traced = annulus_.count();
  }

  void sweep(const std::vector<std::int32_t>& order, const Monitor& monitor) {
    const bool hybrid = options_.method == Method::Hybrid;
    solved_.assign(annulus_.count(), 0);
    if (hybrid) {
      std::vector<std::int32_t> beside;
      for (std::size_t n = 0; n < annulus_.count(); ++n) {
        for (int d = 0; d < 6; ++d) {
          if (annulus_.links[n][d] == wall_) {
            beside.push_back(static_cast<std::int32_t>(n));
            break;
          }
        }
      }
      parallelFor(beside.size(), 256, [&](std::size_t k) { traceToWall(beside[k]); });
      for (const std::int32_t n : beside) solved_[n] = !std::isnan(values_.length[n]);
      values_.traced += beside.size();
    }
    for (std::size_t k = 0; k < order.size(); ++k) {
      const std::int32_t n = order[inner_ ? k : order.size() - 1 - k];
      if (!solved_[n]) {
        // A finite lambda takes the value at the face that the trajectory pierces, which is (3.1)
        // without its numerical diffusion; an infinite one is (3.1) itself.
        const bool upwind = !hybrid || lambda_ == kInfinity;
        if (!upwind || !fromNeighbours(n, hybrid)) {
          if (hybrid) {
            traceToFace(n);
          } else {
            traceToWall(n);
            ++values_.traced;
          }
        }
        solved_[n] = !std::isnan(values_.length[n]);
      }
      if ((k & 0xffff) == 0 && monitor.shouldStop()) return;
    }
  }

  SideValues take() { return std::move(values_); }

 private:
  void store(std::int32_t n, const Vector& x, double length) {
    const auto s = annulus_.boxSubscripts(n);
    values_.offset[n] =
        (x - Vector(s[0], s[1], s[2])).cwiseProduct(annulus_.grid.spacing).cast<float>();
    values_.length[n] = length;
  }

  void traceToWall(std::int32_t n) {
    auto walk = tracer_.begin(n, uphill_);
    bool done = uphill_ * (walk.u - target_) >= 0;
    for (int k = 0; !done && !walk.stuck && k < kMaxSteps; ++k) {
      done = tracer_.advance(walk, target_, uphill_);
    }
    if (done) store(n, walk.x, walk.length);
  }

  /// Boundary point of a solved voxel, mm along the axes from the box's origin.
  [[nodiscard]] Vector wallPoint(std::int32_t n) const {
    const auto s = annulus_.boxSubscripts(n);
    return Vector(s[0], s[1], s[2]).cwiseProduct(annulus_.grid.spacing) +
           values_.offset[n].cast<double>();
  }

  /// (3.1), (3.2) with weights |T_a| / h_a.  False if there is nothing upwind, or if the hybrid
  /// finds its points further apart than lambda.
  bool fromNeighbours(std::int32_t n, bool hybrid) {
    const Vector g = interpolant_.gradient[n].cast<double>();
    const double norm = g.norm();
    if (!(norm > 0)) return false;
    const Vector& h = annulus_.grid.spacing;
    const auto s = annulus_.boxSubscripts(n);
    double sum = 0, length = 0;
    Vector point = Vector::Zero();
    Vector points[3];
    int count = 0;
    for (int a = 0; a < 3; ++a) {
      const double slope = g[a] / norm;
      if (slope == 0) continue;
      // Upwind is where u comes from: smaller for the inner side, larger for the outer one.
      const int d = 2 * a + ((slope > 0) == inner_ ? 0 : 1);
      const std::int32_t m = annulus_.links[n][d];
      const double weight = std::abs(slope) / h[a];
      if (m >= 0) {
        if (!solved_[m]) continue;
        points[count] = wallPoint(m);
        length += weight * values_.length[m];
      } else if (m == wall_ && !hybrid) {
        Vector x(s[0], s[1], s[2]);
        x[a] += signOf(d);
        points[count] = x.cwiseProduct(h);
      } else {
        continue;
      }
      point += weight * points[count];
      sum += weight;
      ++count;
    }
    if (count == 0) return false;
    if (hybrid) {
      for (int p = 0; p < count; ++p) {
        for (int q = p + 1; q < count; ++q) {
          if ((points[p] - points[q]).norm() >= lambda_) return false;
        }
      }
    }
    const Vector x = point / sum;
    values_.offset[n] = (x - Vector(s[0], s[1], s[2]).cwiseProduct(h)).cast<float>();
    values_.length[n] = (1 + length) / sum;
    return true;
  }

  /// Follows the trajectory to the boundary, or to the first grid face whose corners are solved and
  /// agree within lambda.
  void traceToFace(std::int32_t n) {
    disagreed_ = false;
    auto walk = tracer_.begin(n, uphill_);
    bool done = uphill_ * (walk.u - target_) >= 0;
    for (int k = 0; !done && !walk.stuck && k < kMaxSteps; ++k) {
      const Vector before = walk.x;
      const double lengthBefore = walk.length;
      done = tracer_.advance(walk, target_, uphill_);
      if (done) break;
      if (faceBetween(n, before, walk.x, lengthBefore, walk.length)) {
        values_.traced += disagreed_;
        return;
      }
    }
    ++values_.traced;
    if (done) store(n, walk.x, walk.length);
  }

  /// Adds the second-order term of interpolation along one axis of a face: -f (1 - f) / 2 times the
  /// second difference, from whichever voxels in line with the corners are solved.
  /// @param corner  pairs (0, 1) and (2, 3) lie along the axis
  void bendAlong(const std::int32_t* corner, std::int32_t stride, double f, int corners,
                 double across, Vector& point, double& length) const {
    const double factor = 0.5 * f * (1 - f);
    if (factor == 0) return;
    for (int pair = 0; pair < corners; pair += 2) {
      const double weight = corners == 2 ? 1 : pair == 0 ? 1 - across : across;
      const std::int32_t low = corner[pair], high = corner[pair + 1];
      Vector second = Vector::Zero();
      double secondLength = 0;
      int found = 0;
      const auto use = [&](std::int32_t middle, std::int32_t other, std::int32_t step) {
        const std::int32_t m = annulus_.numberAt[annulus_.place[middle] + step];
        if (m < 0 || !solved_[m] || (!tracer_.onCut.empty() && tracer_.onCut[m])) return;
        const Vector difference = wallPoint(m) - 2 * wallPoint(middle) + wallPoint(other);
        if (difference.norm() >= 2 * lambda_) return;
        second += difference;
        secondLength += values_.length[m] - 2 * values_.length[middle] + values_.length[other];
        ++found;
      };
      use(low, high, -stride);
      use(high, low, stride);
      if (found == 0) continue;
      point -= weight * factor / found * second;
      length -= weight * factor / found * secondLength;
    }
  }

  bool faceBetween(std::int32_t n, const Vector& from, const Vector& to, double lengthFrom,
                   double lengthTo) {
    const int axes = annulus_.planar ? 2 : 3;
    // Steps are at most a voxel: at most one plane of each axis lies between.
    struct Pierced {
      double t;
      int axis;
      int plane;
    };
    Pierced pierced[3];
    int count = 0;
    for (int a = 0; a < axes; ++a) {
      const double low = std::min(from[a], to[a]), high = std::max(from[a], to[a]);
      const double plane = std::ceil(low + 1e-12);
      if (plane > high || high - low < 1e-12) continue;
      pierced[count++] = {(plane - from[a]) / (to[a] - from[a]), a, static_cast<int>(plane)};
    }
    for (int k = 1; k < count; ++k) {
      for (int m = k; m > 0 && pierced[m].t < pierced[m - 1].t; --m) {
        std::swap(pierced[m], pierced[m - 1]);
      }
    }
    const auto strides = annulus_.strides();
    for (int k = 0; k < count; ++k) {
      const Vector x = from + pierced[k].t * (to - from);
      const int a = pierced[k].axis;
      int b = (a + 1) % 3, c = (a + 2) % 3;
      if (axes == 2) {
        b = 1 - a;
        c = 2;
      }
      std::array<int, 3> base{};
      base[a] = pierced[k].plane;
      base[b] = static_cast<int>(std::floor(x[b]));
      base[c] =
          axes == 2 ? static_cast<int>(std::lround(x[2])) : static_cast<int>(std::floor(x[c]));
      const double fb = x[b] - base[b], fc = axes == 2 ? 0 : x[c] - base[c];
      const std::int32_t p = base[0] + base[1] * strides[1] + base[2] * strides[2];
      const int corners = axes == 2 ? 2 : 4;
      std::int32_t corner[4];
      bool usable = true;
      for (int e = 0; usable && e < corners; ++e) {
        const std::int32_t q = p + (e & 1) * strides[b] + (e >> 1) * strides[c];
        corner[e] = annulus_.numberAt[q];
        usable = corner[e] >= 0 && corner[e] != n && solved_[corner[e]] &&
                 (tracer_.onCut.empty() || !tracer_.onCut[corner[e]]);
      }
      if (!usable) continue;
      Vector points[4];
      for (int e = 0; e < corners; ++e) points[e] = wallPoint(corner[e]);
      for (int e = 0; usable && e < corners; ++e) {
        for (int f = e + 1; f < corners; ++f) {
          if ((points[e] - points[f]).norm() >= lambda_) {
            usable = false;
            disagreed_ = true;
            break;
          }
        }
      }
      if (!usable) continue;
      Vector point = Vector::Zero();
      double length = 0;
      for (int e = 0; e < corners; ++e) {
        const double weight = ((e & 1) ? fb : 1 - fb) * (corners == 2 ? 1 : (e >> 1) ? fc : 1 - fc);
        point += weight * points[e];
        length += weight * values_.length[corner[e]];
      }
      if (lambda_ < kInfinity) {
        bendAlong(corner, strides[b], fb, corners, fc, point, length);
        if (corners == 4) {
          const std::int32_t swapped[4] = {corner[0], corner[2], corner[1], corner[3]};
          bendAlong(swapped, strides[c], fc, corners, fb, point, length);
        }
      }
      const auto s = annulus_.boxSubscripts(n);
      values_.offset[n] =
          (point - Vector(s[0], s[1], s[2]).cwiseProduct(annulus_.grid.spacing)).cast<float>();
      values_.length[n] = length + lengthFrom + pierced[k].t * (lengthTo - lengthFrom);
      return true;
    }
    return false;
  }

  const Annulus& annulus_;
  const Interpolant& interpolant_;
  const Tracer& tracer_;
  const CorrespondenceOptions& options_;
  bool inner_;
  int uphill_;
  double target_;
  std::int32_t wall_;
  double lambda_;
  bool disagreed_ = false;  ///< the walk passed a solved face whose corners differ by lambda
  SideValues values_;
  std::vector<std::uint8_t> solved_;
};

}  // namespace

Correspondence findCorrespondences(const Annulus& annulus, const Interpolant& interpolant,
                                   const CorrespondenceOptions& options, const Monitor& monitor) {
  if (options.lambda && !(*options.lambda >= 0))
    throw InvalidInput("lambda must be 0 or more millimetres");
  const TrajectoryTracer tracer(annulus, interpolant, options.trace);
  Sweep inner(annulus, interpolant, tracer.field(), options, true);
  Sweep outer(annulus, interpolant, tracer.field(), options, false);
  const bool all = options.method == Method::Lagrangian ||
                   (options.method == Method::Hybrid && options.lambda == 0.0);
  if (all) {
    inner.traceAll(monitor);
    monitor.progress(0.5, "correspondences");
    outer.traceAll(monitor);
  } else {
    const auto order = orderByValue(interpolant.u);
    parallelFor(2, 1, [&](std::size_t side) { (side == 0 ? inner : outer).sweep(order, monitor); });
  }
  monitor.progress(1, "correspondences");
  SideValues in = inner.take(), out = outer.take();
  Correspondence result;
  result.traced = in.traced + out.traced;
  result.innerDistance = std::move(in.length);
  result.outerDistance = std::move(out.length);
  result.innerPoint = std::move(in.offset);
  result.outerPoint = std::move(out.offset);
  const Eigen::Matrix3f toWorld = annulus.grid.direction.cast<float>();
  const auto nan = static_cast<float>(kNaN);
  parallelFor(annulus.count(), 1 << 13, [&](std::size_t n) {
    result.innerPoint[n] = std::isnan(result.innerDistance[n])
                               ? Eigen::Vector3f::Constant(nan)
                               : Eigen::Vector3f(toWorld * result.innerPoint[n]);
    result.outerPoint[n] = std::isnan(result.outerDistance[n])
                               ? Eigen::Vector3f::Constant(nan)
                               : Eigen::Vector3f(toWorld * result.outerPoint[n]);
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

std::vector<double> thicknessOf(const Correspondence& correspondence) {
  std::vector<double> thickness(correspondence.innerDistance.size());
  parallelFor(thickness.size(), 1 << 14,
              [&](std::size_t n) { thickness[n] = correspondence.thickness(n); });
  return thickness;
}

ThicknessSummary summaryOf(const Correspondence& correspondence) {
  std::vector<double> known = thicknessOf(correspondence);
  std::erase_if(known, [](double t) { return std::isnan(t); });
  ThicknessSummary summary;
  if (known.empty()) return summary;
  double sum = 0;
  for (const double t : known) sum += t;
  summary.mean = sum / static_cast<double>(known.size());
  const auto quantile = [&](double q) {
    const auto at = known.begin() +
                    static_cast<std::ptrdiff_t>(q * static_cast<double>(known.size() - 1) + 0.5);
    std::nth_element(known.begin(), at, known.end());
    return *at;
  };
  summary.median = quantile(0.5);
  summary.p05 = quantile(0.05);
  summary.p95 = quantile(0.95);
  return summary;
}

Volume<Eigen::Vector3f> spreadPoints(const Annulus& annulus,
                                     const std::vector<Eigen::Vector3f>& offsets) {
  Volume<Eigen::Vector3f> volume(annulus.grid, Eigen::Vector3f::Zero());
  parallelFor(annulus.count(), 1 << 13, [&](std::size_t n) {
    const auto number = static_cast<std::int32_t>(n);
    volume[annulus.linear(number)] =
        (annulus.world(number) + offsets[n].cast<double>()).cast<float>();
  });
  return volume;
}

}  // namespace explica::correspondence
