// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/Correspondence.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/OrderStatistics.h"
#include "Explica/Core/Parallel.h"
#include "Field.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
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

/// Tissue in steps of u: those of one step do not depend on each other.
struct Steps {
  std::size_t count = 0;
  std::vector<std::uint16_t> of;  ///< per rank
};

/// Steps so small that nearly everywhere the first grid face upwind lies in an earlier one: its
/// corners differ from the voxel by 1/sqrt(3) voxel of the slope or more.
Steps stepsOf(const Tracer& tracer) {
  constexpr std::size_t kSamples = 4096;
  constexpr double kSmallSlopes = 0.05;  // share of voxels that may have smaller slopes
  constexpr double kStepsPerVoxel = 4;
  constexpr double kFewest = 64, kMost = 2048;
  const std::size_t n = tracer.node.size();
  std::vector<double> slope;
  for (std::size_t r = 0; r < n; r += 1 + n / kSamples) {
    slope.push_back(tracer.node[r]
                        .head<3>()
                        .matrix()
                        .cast<double>()
                        .cwiseProduct(tracer.inverseSpacing)
                        .norm() *
                    tracer.finest);
  }
  const auto small = nthSmallest(
      slope, static_cast<std::size_t>(kSmallSlopes * static_cast<double>(slope.size())));
  const auto count = static_cast<int>(
      small > 0 ? std::clamp(std::ceil(kStepsPerVoxel / small), kFewest, kMost) : kMost);
  Steps steps;
  steps.count = count;
  steps.of.resize(n);
  parallelFor(n, kBlock, [&](std::size_t r) {
    const float u = std::clamp(tracer.node[r][3], 0.0F, 1.0F);
    const int step = std::min(static_cast<int>(u * static_cast<float>(count)), count - 1);
    steps.of[r] = static_cast<std::uint16_t>(step);
  });
  return steps;
}

/// Tissue in blocks of space, the blocks and the ranks of each in the order of steps.  What a
/// trajectory reads on its way to the first grid face lies in its block or beside it: a block's
/// share of every array fits into a processor's own cache.
struct Blocks {
  struct Range {
    std::int32_t begin = 0, end = 0;  ///< in `rank`
  };
  std::vector<std::int32_t> rank;  ///< of one block after the other in space
  std::vector<Range> ranges;       ///< per block

  [[nodiscard]] std::span<const std::int32_t> of(std::size_t block) const {
    const Range& range = ranges[block];
    return {rank.data() + range.begin, rank.data() + range.end};
  }
};

/// Sorts ranks by a key below `keys`, equal ones as they were; returns where each key begins.
template <class KeyOf>
std::vector<std::int32_t> sortBy(std::span<std::int32_t> ranks, std::size_t keys,
                                 const KeyOf& keyOf) {
  std::vector<std::int32_t> start(keys + 1, 0);
  for (const std::int32_t r : ranks) ++start[keyOf(r) + 1];
  for (std::size_t k = 0; k < keys; ++k) start[k + 1] += start[k];
  const std::vector<std::int32_t> before(ranks.begin(), ranks.end());
  std::vector<std::int32_t> cursor(start.begin(), start.end() - 1);
  for (const std::int32_t r : before) ranks[cursor[keyOf(r)]++] = r;
  return start;
}

Blocks blocksOf(const Tracer& tracer, const Steps& steps) {
  constexpr std::array<int, 3> kSize = {32, 16, 16};  // voxels
  const std::array<int, 3>& size = tracer.annulus.size;
  const int wide = (size[0] + kSize[0] - 1) / kSize[0], high = (size[1] + kSize[1] - 1) / kSize[1];
  const int slabs = (size[2] + kSize[2] - 1) / kSize[2];
  const auto columnOf = [&](std::int32_t r) {
    const std::int32_t row = tracer.placeOf[r] / size[0];
    const std::int32_t i = tracer.placeOf[r] - row * size[0], j = row % size[1];
    return i / kSize[0] + wide * (j / kSize[1]);
  };
  // Ranks are in storage order, so that those of a slab follow each other.
  const auto rankAtSlice = [&](int k) {
    const auto place = static_cast<std::int64_t>(k) * size[0] * size[1];
    const auto& places = tracer.placeOf;
    return std::lower_bound(places.begin(), places.end(), place) - places.begin();
  };
  Blocks blocks;
  blocks.rank.resize(tracer.placeOf.size());
  std::vector<std::vector<Blocks::Range>> bySlab(slabs);
  parallelFor(slabs, 1, [&](std::size_t slab) {
    const int slice = static_cast<int>(slab) * kSize[2];
    const auto begin = static_cast<std::int32_t>(rankAtSlice(slice));
    const auto end = static_cast<std::int32_t>(rankAtSlice(std::min(slice + kSize[2], size[2])));
    const std::span ranks(blocks.rank.data() + begin, blocks.rank.data() + end);
    std::iota(ranks.begin(), ranks.end(), begin);
    sortBy(ranks, steps.count, [&](std::int32_t r) { return steps.of[r]; });
    const std::vector<std::int32_t> start =
        sortBy(ranks, static_cast<std::size_t>(wide) * high, columnOf);
    for (std::size_t column = 0; column + 1 < start.size(); ++column) {
      if (start[column] == start[column + 1]) continue;
      bySlab[slab].push_back({begin + start[column], begin + start[column + 1]});
    }
  });
  for (const auto& ranges : bySlab) {
    blocks.ranges.insert(blocks.ranges.end(), ranges.begin(), ranges.end());
  }
  std::stable_sort(blocks.ranges.begin(), blocks.ranges.end(),
                   [&](const Blocks::Range& one, const Blocks::Range& two) {
                     const auto middleStep = [&](const Blocks::Range& range) {
                       return steps.of[blocks.rank[std::midpoint(range.begin, range.end)]];
                     };
                     return middleStep(one) < middleStep(two);
                   });
  return blocks;
}

/// Ranks by ascending u (radix sort of 32-bit fixed point; equal values by rank).
std::vector<std::int32_t> orderByValue(const Tracer& tracer, const std::vector<double>& u) {
  const std::size_t n = u.size();
  std::vector<std::uint32_t> key(n), otherKey(n);
  std::vector<std::int32_t> order(n), other(n);
  for (std::size_t k = 0; k < n; ++k) {
    const double value = u[tracer.annulus.numberAt[tracer.placeOf[k]]];
    key[k] = static_cast<std::uint32_t>(std::clamp(value, 0.0, 1.0) * 4294967295.0);
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
    const std::optional<Face> face = faceAt(axisOf(way), endOf(r, way));
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
      return atFaceBetween(from, walk.x, lengthFrom, walk.length,
                           [&](int axis, const Vector& x, double length) {
                             const std::optional<Face> face = faceAt(axis, x);
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
      const std::optional<Face> face = faceAt(axisOf(first), endOf(r, first));
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
        const std::optional<Face> face = faceAt(axis, x);
        return face && fromFace(r, *face, turn, length, disagreed);
      };
      if (atFaceBetween(before, walk.x, lengthBefore, walk.length, interpolate)) return disagreed;
    }
    if (done) store(r, walk);
    return true;
  }

  /// Calls at(axis, x, length) for the grid planes between two points at most a voxel apart, in the
  /// order in which they are met, until it returns true: whether it did.
  template <class At>
  bool atFaceBetween(const Vector& from, const Vector& to, double lengthFrom, double lengthTo,
                     const At& at) const {
    const Vector step = to - from;
    struct Pierced {
      double t;
      int axis;
      int plane;
    };
    Pierced pierced[3];
    int count = 0;
    for (int a = 0; a < (annulus_.planar ? 2 : 3); ++a) {
      if (std::abs(step[a]) < 1e-12) continue;
      // The next plane strictly ahead.
      const int below = static_cast<int>(from[a]);
      const int ahead = step[a] > 0 ? below + 1 : below - (from[a] == below ? 1 : 0);
      const double t = (ahead - from[a]) / step[a];
      if (t > 1) continue;
      int n = count++;
      for (; n > 0 && pierced[n - 1].t > t; --n) pierced[n] = pierced[n - 1];
      pierced[n] = {t, a, ahead};
    }
    for (int k = 0; k < count; ++k) {
      const double t = pierced[k].t;
      Vector x = from + t * step;
      x[pierced[k].axis] = pierced[k].plane;
      if (at(pierced[k].axis, x, lengthFrom + t * (lengthTo - lengthFrom))) return true;
    }
    return false;
  }

  /// A face of the grid between voxel centres, with a place in it.
  struct Face {
    int b, c;                 ///< its axes, ascending, so that pairs lie in memory's order
    std::array<int, 3> base;  ///< first corner
    std::int32_t place[4];    ///< of its corners, two if planar
    float fb, fc;             ///< the place, from the first corner
  };

  /// The face that contains x; nothing beyond the image, which a trajectory may leave.
  [[nodiscard]] std::optional<Face> faceAt(int axis, const Vector& x) const {
    Face face;
    const int b = face.b = axis == 0 ? 1 : 0, c = face.c = axis == 2 ? 1 : 2;
    face.base[axis] = static_cast<int>(x[axis]);
    face.base[b] = static_cast<int>(x[b]);
    face.base[c] = annulus_.planar ? static_cast<int>(std::lround(x[2])) : static_cast<int>(x[c]);
    if (!inBox(face.base, axis)) return {};
    face.fb = static_cast<float>(x[b] - face.base[b]);
    face.fc = annulus_.planar ? 0.0F : static_cast<float>(x[c] - face.base[c]);
    const auto strides = annulus_.strides();
    const std::int32_t p = face.base[0] + face.base[1] * strides[1] + face.base[2] * strides[2];
    for (int e = 0; e < corners(); ++e) {
      face.place[e] = p + (e & 1) * strides[b] + (e >> 1) * strides[c];
    }
    return face;
  }
  [[nodiscard]] int corners() const { return annulus_.planar ? 2 : 4; }

  [[nodiscard]] bool haveEarlierTurns(const Face& face, std::uint16_t turn) const {
    return std::all_of(face.place, face.place + corners(), [&](std::int32_t place) {
      const std::int32_t m = tracer_.rankAt[place];
      return m >= 0 && turn_[m] < turn;
    });
  }

  /// Interpolates on a grid face, if its corners have earlier turns and agree.
  bool fromFace(std::int32_t r, const Face& face, std::uint16_t turn, double length,
                bool& disagreed) {
    const auto& [b, c, base, place, fb, fc] = face;
    const int corners = this->corners();
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

  /// Whether the grid face at a voxel lies in the box: a trajectory that leaves the image may meet
  /// faces beyond it.
  [[nodiscard]] bool inBox(const std::array<int, 3>& base, int axis) const {
    for (int a = 0; a < 3; ++a) {
      const int reach = a == axis || (annulus_.planar && a == 2) ? 0 : 1;
      if (base[a] < 0 || base[a] + reach >= annulus_.size[a]) return false;
    }
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

std::vector<double> thicknessOf(const Correspondence& correspondence) {
  std::vector<double> thickness(correspondence.innerDistance.size());
  parallelFor(thickness.size(), 1 << 14,
              [&](std::size_t n) { thickness[n] = correspondence.thickness(n); });
  return thickness;
}

std::optional<double> thicknessAt(const Annulus& annulus, const Correspondence& correspondence,
                                  const Point& point) {
  constexpr double kEnough = 0.25;  // of the weight
  const Vector index = annulus.grid.toIndex(point);
  const auto strides = annulus.strides();
  double sum = 0, weights = 0;
  for (int c = 0; c < 8; ++c) {
    double weight = 1;
    std::ptrdiff_t place = 0;
    bool within = true;
    for (int a = 0; a < 3; ++a) {
      const double low = std::floor(index[a]), upper = index[a] - low;
      const int at = static_cast<int>(low) + (c >> a & 1) - annulus.first[a];
      within = within && at >= 0 && at < annulus.size[a];
      weight *= (c >> a & 1) ? upper : 1 - upper;
      place += static_cast<std::ptrdiff_t>(at) * strides[a];
    }
    const std::int32_t n = within ? annulus.numberAt[place] : -1;
    if (n < 0 || std::isnan(correspondence.thickness(n))) continue;
    sum += weight * correspondence.thickness(n);
    weights += weight;
  }
  if (!(weights > kEnough)) return {};
  return sum / weights;
}

double columnWeight(const Correspondence& correspondence, std::size_t n) {
  const double thickness = correspondence.thickness(n);
  if (!(thickness > 0)) return 0;
  return 4 * std::min(correspondence.innerDistance[n], correspondence.outerDistance[n]) /
         (thickness * thickness);
}

ThicknessSummary summaryOf(const Correspondence& correspondence) {
  std::vector<double> known = thicknessOf(correspondence);
  double sum = 0, weighted = 0, weights = 0;
  for (std::size_t n = 0; n < known.size(); ++n) {
    if (!(known[n] > 0)) continue;
    const double weight = columnWeight(correspondence, n);
    sum += known[n];
    weighted += weight * known[n];
    weights += weight;
  }
  std::erase_if(known, [](double t) { return !(t > 0); });
  ThicknessSummary summary;
  if (known.empty()) return summary;
  summary.meanOfVoxels = sum / static_cast<double>(known.size());
  summary.mean = weights > 0 ? weighted / weights : kNaN;
  const auto quantile = [&](double q) {
    return nthSmallest(
        known, static_cast<std::size_t>(std::lround(q * static_cast<double>(known.size() - 1))));
  };
  summary.median = quantile(0.5);
  summary.p05 = quantile(0.05);
  summary.p95 = quantile(0.95);
  return summary;
}

}  // namespace explica::correspondence
