// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/Correspondence.h"

#include "Blocks.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Field.h"
#include "GridFaces.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <span>
#include <thread>
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
        appendixA_(options.method == Method::AppendixA),
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

  /// (3.1) and (3.2), voxel by voxel in the order of u: the Eulerian method and appendix A.
  void sweep(const std::vector<std::int32_t>& order, const Monitor& monitor) {
    turn_.assign(arrivals_.size(), kNever);
    if (appendixA_) traceBesideWall();
    for (std::size_t k = 0; k < order.size(); ++k) {
      const std::int32_t r = order[inner_ ? k : order.size() - 1 - k];
      if (!found(r) && !fromNeighbours(r)) {
        if (appendixA_) {
          traced_ += traceToFace(r, 1);
        } else {
          traceToWall(r);
          ++traced_;
        }
      }
      if (found(r) && !onCut(r)) turn_[r] = 0;
      if ((k & 0xffff) == 0 && monitor.shouldStop()) return;
    }
  }

  /// The hybrid: follows each trajectory to the first grid face whose corners belong to earlier
  /// steps and agree.  What is beside the wall first; then followBlock() of every block.
  void begin(const Steps& steps) {
    turn_.resize(arrivals_.size());
    state_ = std::vector<std::atomic<State>>(arrivals_.size());
    ownTurn_.resize(arrivals_.size());
    parallelFor(arrivals_.size(), kBlock, [&](std::size_t r) {
      const std::size_t step = steps.of[r];
      ownTurn_[r] = static_cast<std::uint16_t>(1 + (inner_ ? step : steps.count - 1 - step));
      turn_[r] = onCut(static_cast<std::int32_t>(r)) ? kNever : ownTurn_[r];
    });
    traceBesideWall();
    followToFaces();
  }

  /// Follows the trajectories of a block's voxels, each after those at the corners that it meets.
  /// Blocks may be followed beside each other and in any order.
  void followBlock(std::span<const std::int32_t> ranks) {
    for (std::size_t v = 0; v < ranks.size(); ++v) {
      const std::int32_t r = inner_ ? ranks[v] : ranks[ranks.size() - 1 - v];
      if (take(r)) settle(r, arrivals_[r]);
    }
  }

  void end() {
    traced_ +=
        parallelSum(state_.size(), kBlock, std::size_t{0}, [&](std::size_t begin, std::size_t end) {
          return static_cast<std::size_t>(
              std::count(state_.begin() + static_cast<std::ptrdiff_t>(begin),
                         state_.begin() + static_cast<std::ptrdiff_t>(end), State::Followed));
        });
  }

  [[nodiscard]] const Arrival& at(std::size_t rank) const { return arrivals_[rank]; }
  [[nodiscard]] std::size_t traced() const { return traced_; }

 private:
  static constexpr std::uint16_t kNever = 0xffff;

  /// How far a voxel is: its arrival may be read from `Interpolated` on.
  enum class State : std::uint8_t {
    Open,
    Taken,         ///< a thread is at it
    Interpolated,  ///< at the first grid face
    Followed       ///< further than that
  };

  /// True for one thread only: it is to settle the voxel.
  [[nodiscard]] bool take(std::int32_t r) {
    State open = State::Open;
    if (state_[r].load(std::memory_order_relaxed) != open) return false;
    return state_[r].compare_exchange_strong(open, State::Taken, std::memory_order_relaxed);
  }

  /// @param first  way to the first grid plane, which is no longer in `arrivals_` then
  void settle(std::int32_t r, const Arrival first) {
    arrivals_[r][3] = static_cast<float>(kNaN);
    const bool onward = traceToFace(r, first, ownTurn_[r]);
    state_[r].store(onward ? State::Followed : State::Interpolated, std::memory_order_release);
  }

  /// Settles a voxel unless it is, or waits until the thread that has taken it is done.  Threads
  /// cannot wait for each other in a ring: whoever waits has taken voxels of later turns only.
  void settle(std::int32_t r) {
    const auto isSettled = [&] {
      return state_[r].load(std::memory_order_acquire) >= State::Interpolated;
    };
    if (isSettled()) return;
    if (take(r)) settle(r, arrivals_[r]);
    while (!isSettled()) std::this_thread::yield();
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
    const auto ended = [&](std::int32_t r, const Tracer::Walk& walk, bool done) {
      if (!done) return;
      store(r, walk);
      if (!onCut(r)) turn_[r] = 0;
      if (!state_.empty()) state_[r].store(State::Interpolated, std::memory_order_relaxed);
    };
    traced_ += parallelSum(arrivals_.size(), 1 << 12, std::size_t{0},
                           [&](std::size_t begin, std::size_t end) {
                             std::size_t sum = 0;
                             const auto next = [&](Tracer::Walk& walk) {
                               while (begin < end && !isBesideWall(begin)) ++begin;
                               if (begin == end) return -1;
                               ++sum;
                               walk = tracer_.begin(tracer_.placeOf[begin], uphill_);
                               return static_cast<std::int32_t>(begin++);
                             };
                             tracer_.followEach(target_, uphill_, next, atNoFace, ended);
                             return sum;
                           });
  }

  static bool atNoFace(std::int32_t, const Vector&, double, const Tracer::Walk&) { return false; }

  /// Puts the ways to the first grid faces whose corners have earlier turns where the arrivals of
  /// what is still open will be; what meets none is settled.
  void followToFaces() {
    parallelForBlocks(arrivals_.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
      std::vector<std::int32_t> beyond;  // ranks that go on after their first planes
      while (begin < end) {
        std::int32_t open[kBeside];
        Arrival first[kBeside];
        int count = 0;
        for (; begin < end && count < kBeside; ++begin) {
          if (state_[begin].load(std::memory_order_relaxed) != State::Open) continue;
          open[count++] = static_cast<std::int32_t>(begin);
        }
        if (count == 0) break;
        tracer_.toPlane(open, first, count, uphill_);
        for (int w = 0; w < count; ++w) {
          arrivals_[open[w]] = first[w];
          if (!isUsable(open[w], first[w])) beyond.push_back(open[w]);
        }
      }
      followToFaces(beyond);
    });
  }

  /// Whether a way leads to a grid face whose corners have earlier turns.
  [[nodiscard]] bool isUsable(std::int32_t r, const Arrival& way) const {
    if (std::isnan(way[3])) return false;
    const std::optional<Face> face = faces_.at(axisOf(way), endOf(r, way));
    return face && haveEarlierTurns(*face, ownTurn_[r]);
  }

  void followToFaces(const std::vector<std::int32_t>& ranks) {
    std::size_t at = 0;
    const auto next = [&](Tracer::Walk& walk) {
      if (at == ranks.size()) return -1;
      const std::int32_t r = ranks[at++];
      walk = onwardFrom(r, arrivals_[r], annulus_.numberAt[tracer_.placeOf[r]]);
      return r;
    };
    const auto passed = [&](std::int32_t r, const Vector& from, double lengthFrom,
                            const Tracer::Walk& walk) {
      return faces_.between(from, walk.x, lengthFrom, walk.length,
                            [&](int axis, const Vector& x, double length) {
                              const std::optional<Face> face = faces_.at(axis, x);
                              if (!face || !haveEarlierTurns(*face, ownTurn_[r])) return false;
                              const Vector way = x - centreOf(r);
                              arrivals_[r] << way.cast<float>().array(), static_cast<float>(length);
                              return true;
                            });
    };
    const auto ended = [&](std::int32_t r, const Tracer::Walk& walk, bool done) {
      arrivals_[r][3] = static_cast<float>(kNaN);
      if (done) store(r, walk);
      state_[r].store(State::Followed, std::memory_order_relaxed);
    };
    tracer_.followEach(target_, uphill_, next, passed, ended);
  }

  /// The axis of the grid plane at the end of a way from a voxel's centre: the way along it is a
  /// whole number of voxels.
  [[nodiscard]] static int axisOf(const Arrival& way) {
    int axis = 0;
    while (axis < 2 && (way[axis] == 0 || way[axis] != std::round(way[axis]))) ++axis;
    return axis;
  }
  [[nodiscard]] Vector centreOf(std::int32_t r) const {
    const auto s = subscripts(tracer_.placeOf[r]);
    return {static_cast<double>(s[0]), static_cast<double>(s[1]), static_cast<double>(s[2])};
  }
  [[nodiscard]] Vector endOf(std::int32_t r, const Arrival& way) const {
    return centreOf(r) + way.head<3>().matrix().cast<double>();
  }

  /// A walk that goes on where a way ends; from the centre if that is NaN, does not get there or
  /// gets beyond the boundary.
  [[nodiscard]] Tracer::Walk onwardFrom(std::int32_t r, const Arrival& way,
                                        std::int32_t home) const {
    if (!std::isnan(way[3])) {
      Tracer::Walk walk = tracer_.begin(endOf(r, way), home, uphill_);
      walk.length = way[3];
      if (!walk.stuck && uphill_ * (walk.u - target_) < 0) return walk;
    }
    return tracer_.begin(tracer_.placeOf[r], uphill_);
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
    tracer_.followEach(target_, uphill_, begin, atNoFace,
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
        if (!found(m) && appendixA_) return false;  // half of the upwind points test nothing
        if (!found(m)) continue;
        there = arrivals_[m].cast<double>();
      } else if (links[d] != wall_ || appendixA_) {
        continue;
      }
      there[a] += signOf(d) * h[a];
      points[count++] = there;
      value += weight * there;
      sum += weight;
    }
    if (count == 0) return false;
    if (appendixA_) {
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

  bool traceToFace(std::int32_t r, std::uint16_t turn) {
    Arrival first;
    tracer_.toPlane(&r, &first, 1, uphill_);
    return traceToFace(r, first, turn);
  }

  /// Follows the trajectory to the first grid face whose corners have earlier turns and agree
  /// within lambda, else to the boundary.
  /// @param first  way to a grid face, if one is known
  /// @return  whether it went past a face whose corners disagree, or to the boundary
  bool traceToFace(std::int32_t r, const Arrival& first, std::uint16_t turn) {
    bool disagreed = false;
    std::int32_t home = annulus_.numberAt[tracer_.placeOf[r]];
    if (!std::isnan(first[3])) {
      const std::optional<Face> face = faces_.at(axisOf(first), endOf(r, first));
      if (face && fromFace(r, *face, turn, first[3], disagreed)) return false;
      // Corners that have their turns are not cut off from each other: each tells the side.
      if (face && haveEarlierTurns(*face, turn)) home = annulus_.numberAt[face->place[0]];
    }
    Tracer::Walk walk = onwardFrom(r, first, home);
    bool done = uphill_ * (walk.u - target_) >= 0;
    for (int k = 0; !done && !walk.stuck && k < kMaxSteps; ++k) {
      const Vector before = walk.x;
      const double lengthBefore = walk.length;
      done = tracer_.advance(walk, target_, uphill_);
      if (done || walk.stuck) break;
      const auto interpolate = [&](int axis, const Vector& x, double length) {
        const std::optional<Face> face = faces_.at(axis, x);
        return face && fromFace(r, *face, turn, length, disagreed);
      };
      if (faces_.between(before, walk.x, lengthBefore, walk.length, interpolate)) return disagreed;
    }
    if (done) store(r, walk);
    return true;
  }

  [[nodiscard]] bool haveEarlierTurns(const Face& face, std::uint16_t turn) const {
    return std::all_of(face.place, face.place + faces_.corners(), [&](std::int32_t place) {
      const std::int32_t m = tracer_.rankAt[place];
      return m >= 0 && turn_[m] < turn;
    });
  }

  /// Interpolates on a grid face, if its corners have earlier turns and agree.
  bool fromFace(std::int32_t r, const Face& face, std::uint16_t turn, double length,
                bool& disagreed) {
    const auto& [b, c, base, place, fb, fc] = face;
    const int corners = faces_.corners();
    const auto strides = annulus_.strides();
    const Arrival* arrival[4];
    for (int e = 0; e < corners; ++e) {
      arrival[e] = earlier(place[e], turn);
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
    if (!appendixA_) {
      // Second order: -f (1 - f) / 2 times the second difference along each axis.
      for (int e = 0; e < corners; e += 2) {
        const float across = corners == 2 ? 1 : e == 0 ? 1 - fc : fc;
        sum -= across * bend(place[e] - strides[b], *arrival[e], *arrival[e + 1],
                             place[e + 1] + strides[b], fb, turn);
      }
      if (corners == 4) {
        for (int e = 0; e < 2; ++e) {
          sum -= (e == 0 ? 1 - fb : fb) * bend(place[e] - strides[c], *arrival[e], *arrival[e + 2],
                                               place[e + 2] + strides[c], fc, turn);
        }
      }
    }
    const auto s = subscripts(tracer_.placeOf[r]);
    for (int a = 0; a < 3; ++a) sum[a] += static_cast<float>(base[a] - s[a]) * spacing_[a];
    sum[3] += static_cast<float>(length);
    arrivals_[r] = sum;
    return true;
  }

  /// Arrival at a box voxel with an earlier turn; null otherwise.
  [[nodiscard]] const Arrival* earlier(std::int32_t place, std::uint16_t turn) {
    const std::int32_t m = tracer_.rankAt[place];
    if (m < 0 || turn_[m] >= turn) return nullptr;
    if (turn_[m] > 0) settle(m);
    return found(m) ? &arrivals_[m] : nullptr;
  }

  static float apart(const Arrival& difference) {
    return difference[0] * difference[0] + difference[1] * difference[1] +
           difference[2] * difference[2];
  }

  /// f (1 - f) / 2 times the second difference along four voxels in line: `low` and `high` at the
  /// face, and beyond them whichever have had their turn.
  [[nodiscard]] Arrival bend(std::int32_t beyondLow, const Arrival& low, const Arrival& high,
                             std::int32_t beyondHigh, float f, std::uint16_t turn) {
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
    add(earlier(beyondLow, turn), low, high);
    add(earlier(beyondHigh, turn), high, low);
    if (found == 0) return second;
    return (0.5F * f * (1 - f) / static_cast<float>(found)) * second;
  }

  const Tracer& tracer_;
  const Annulus& annulus_;
  GridFaces faces_{annulus_};
  bool appendixA_, inner_;
  int uphill_;
  double target_;
  std::int32_t wall_;
  float lambda_;
  Eigen::Array3f spacing_;
  std::size_t traced_ = 0;
  std::vector<Arrival> arrivals_;          ///< per rank
  std::vector<std::uint16_t> turn_;        ///< per rank: only arrivals with smaller turns are read
  std::vector<std::uint16_t> ownTurn_;     ///< per rank: as what it reads
  std::vector<std::atomic<State>> state_;  ///< per rank
};

/// The hybrid from both sides: blocks are taken in the order of u, so that most of what one reads
/// is there.
void sweepBlocks(const Tracer& tracer, Sweep& inner, Sweep& outer, const Monitor& monitor) {
  const Steps steps = stepsOf(tracer);
  const Blocks blocks = blocksOf(tracer, steps);
  const std::size_t count = blocks.ranges.size();
  parallelFor(2, 1, [&](std::size_t side) { (side == 0 ? inner : outer).begin(steps); });
  std::atomic<std::size_t> next = 0;
  parallelFor(2 * count, 1, [&](std::size_t) {
    if (monitor.shouldStop()) return;
    const std::size_t turn = next++, block = turn / 2;
    if (turn % 2 == 0) {
      inner.followBlock(blocks.of(block));
    } else {
      outer.followBlock(blocks.of(count - 1 - block));
    }
  });
  inner.end();
  outer.end();
}

/// Share of tissue voxels beside a boundary from which on all trajectories are followed: tissue is
/// then so thin that looking for faces to stop at costs more than the rest of the way.
constexpr double kThin = 0.4;

bool isThin(const Annulus& annulus) {
  const auto& end = annulus.runEnd;
  const double beside = end[1] - end[0] + (end[3] - end[2]);
  return beside > kThin * static_cast<double>(annulus.count());
}

}  // namespace

Correspondence findCorrespondences(const Annulus& annulus, const Interpolant& interpolant,
                                   const CorrespondenceOptions& options, const Monitor& monitor) {
  if (options.lambda && !(*options.lambda >= 0))
    throw InvalidInput("lambda must be 0 or more millimetres");
  const TrajectoryTracer tracer(annulus, interpolant, options.trace);
  const Tracer& field = tracer.field();
  Sweep inner(field, options, true);
  Sweep outer(field, options, false);
  const bool hybrid = options.method == Method::Hybrid;
  const bool dialled = hybrid || options.method == Method::AppendixA;
  const bool followAll = options.method == Method::Lagrangian ||
                         (dialled && options.lambda == 0.0) ||
                         (hybrid && !options.lambda && isThin(annulus));
  if (followAll) {
    inner.traceAll(monitor);
    monitor.progress(0.5, "correspondences");
    outer.traceAll(monitor);
  } else if (hybrid) {
    sweepBlocks(field, inner, outer, monitor);
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
