// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Registration/AffineRegistration.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/OrderStatistics.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/StopScope.h"
#include "Filters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace explica::registration {
namespace {

constexpr int kBins = 32;             // of brightness, along each axis of the joint histogram
constexpr std::size_t kGrain = 4096;  // elements a task
constexpr int kParameters = 12;       // of an affine map
constexpr double kImageShare = 0.75;  // the image's voxels, of the template's points' distance

/// Translation mm, rotation rad, logarithm of scale, shear, about the region's centre.
using Parameters = Eigen::Matrix<double, kParameters, 1>;

// A step along each parameter moves the brain's surface by a few millimetres.
Parameters firstSteps() {
  Parameters steps;
  steps << 6, 6, 6, 0.08, 0.08, 0.08, 0.06, 0.06, 0.06, 0.04, 0.04, 0.04;
  return steps;
}

/// @param turn  rotation that the parameters' own comes before
Eigen::Affine3d mapOf(const Parameters& p, const Eigen::Matrix3d& turn, const Point& from,
                      const Point& to) {
  const Eigen::Matrix3d rotation =
      turn * (Eigen::AngleAxisd(p[3], Vector::UnitX()) * Eigen::AngleAxisd(p[4], Vector::UnitY()) *
              Eigen::AngleAxisd(p[5], Vector::UnitZ()))
                 .toRotationMatrix();
  Eigen::Matrix3d scale = Eigen::Matrix3d::Zero();
  for (int a = 0; a < 3; ++a) scale(a, a) = std::exp(p[6 + a]);
  Eigen::Matrix3d shear = Eigen::Matrix3d::Identity();
  shear(0, 1) = p[9];
  shear(0, 2) = p[10];
  shear(1, 2) = p[11];
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  map.linear() = rotation * shear * scale;
  map.translation() = to + p.head<3>() - map.linear() * from;
  return map;
}

/// From low to high in kBins steps; what lies beyond counts as the last.
struct Binning {
  float low = 0;
  float scale = 1;
  [[nodiscard]] float operator()(float value) const {
    return std::clamp((value - low) * scale, 0.0f, kBins - 1.001f);
  }
};

Binning binningOf(std::vector<float> values) {
  const float low = *std::ranges::min_element(values);
  const float high = quantileOf(std::move(values), 0.995);
  return {low, high > low ? (kBins - 1) / (high - low) : 0.0f};
}

/// What one resolution needs: the image, and the template's points with their bins.
struct Level {
  Volume<float> image;
  Binning binning;
  std::vector<Eigen::Vector3d> point;
  std::vector<std::uint8_t> bin;
};

struct Counts {
  std::array<double, kBins * kBins> n{};
  Counts& operator+=(const Counts& other) {
    for (std::size_t b = 0; b < n.size(); ++b) n[b] += other.n[b];
    return *this;
  }
};

double entropy(const double* n, std::size_t count, double total) {
  double sum = 0;
  for (std::size_t b = 0; b < count; ++b) {
    if (n[b] > 0) sum -= n[b] / total * std::log(n[b] / total);
  }
  return sum;
}

double information(const Level& level, const Eigen::Affine3d& map) {
  // World point to index of the image, in one product.
  const Grid& grid = level.image.grid;
  Eigen::Affine3d toIndex = Eigen::Affine3d::Identity();
  toIndex.linear() = grid.spacing.cwiseInverse().asDiagonal() * grid.direction.transpose();
  toIndex.translation() = -(toIndex.linear() * grid.origin);
  const Eigen::Affine3d whole = toIndex * map;
  const Counts counts =
      parallelSum(level.point.size(), kGrain, Counts{}, [&](std::size_t begin, std::size_t end) {
        Counts part;
        for (std::size_t s = begin; s < end; ++s) {
          const float x = level.binning(valueAt(level.image, whole * level.point[s]));
          const int cell = static_cast<int>(x);
          const double share = x - static_cast<float>(cell);
          double* row = part.n.data() + static_cast<std::size_t>(level.bin[s]) * kBins;
          row[cell] += 1 - share;
          row[cell + 1] += share;
        }
        return part;
      });
  std::array<double, kBins> ofTemplate{}, ofImage{};
  double total = 0;
  for (int t = 0; t < kBins; ++t) {
    for (int i = 0; i < kBins; ++i) {
      const double n = counts.n[t * kBins + i];
      ofTemplate[t] += n;
      ofImage[i] += n;
      total += n;
    }
  }
  const double joint = entropy(counts.n.data(), counts.n.size(), total);
  if (!(joint > 0)) return 1;
  return (entropy(ofTemplate.data(), kBins, total) + entropy(ofImage.data(), kBins, total)) / joint;
}

Level makeLevel(const Volume<float>& image, const Volume<float>& inTemplate,
                const Volume<float>& region, double spacing) {
  Level level;
  level.image = inCubes(image, kImageShare * spacing);
  const Volume<float> coarse = inCubes(inTemplate, spacing);
  std::vector<float> values;
  for (std::size_t v = 0; v < coarse.size(); ++v) {
    const auto [i, j, k] = coarse.grid.subscripts(v);
    const Point at = coarse.grid.toWorld(Vector(i, j, k));
    if (valueAt(region, region.grid.toIndex(at)) <= 0.5f) continue;
    level.point.push_back(at);
    values.push_back(coarse[v]);
  }
  if (level.point.size() < 100) throw InvalidInput("template: its brain mask is empty");
  const Binning binning = binningOf(values);
  for (const float value : values) {
    level.bin.push_back(static_cast<std::uint8_t>(std::lround(binning(value))));
  }
  level.binning = binningOf(level.image.data);
  if (level.binning.scale == 0) throw InvalidInput("T1: holds one value only");
  return level;
}

/// The best step along a direction, by doubling and parabolas [Powell1964]; `best` becomes the
/// value there.
template <class Function>
double searchLine(const Function& value, double step, double& best) {
  double at = 0;
  double ahead = value(step);
  if (ahead <= best) {
    step = -step;
    ahead = value(step);
  }
  double behind = best;
  double behindAt = 0;
  if (ahead <= best) {  // the summit lies between -step and step
    behindAt = -step;
    behind = value(-step);
  } else {
    double aheadAt = step;
    do {
      behindAt = at;
      behind = best;
      at = aheadAt;
      best = ahead;
      step *= 1.6;
      aheadAt = at + step;
      ahead = value(aheadAt);
    } while (ahead > best && std::abs(at) < 40 * std::abs(step));
    step = aheadAt - at;
  }
  double aheadAt = at + step;
  for (int n = 0; n < 2; ++n) {
    const double p = (at - behindAt) * (best - ahead);
    const double q = (at - aheadAt) * (best - behind);
    if (std::abs(p - q) < 1e-15) break;
    const double next = at - 0.5 * ((at - behindAt) * p - (at - aheadAt) * q) / (p - q);
    if (!std::isfinite(next) || std::abs(next - at) < 1e-3 * std::abs(step)) break;
    const double there = value(next);
    const bool towardsAhead = (next - at) * (aheadAt - at) > 0;
    if (there > best) {
      (towardsAhead ? behindAt : aheadAt) = at;
      (towardsAhead ? behind : ahead) = best;
      at = next;
      best = there;
    } else {
      (towardsAhead ? aheadAt : behindAt) = next;
      (towardsAhead ? ahead : behind) = there;
    }
  }
  return at;
}

struct Found {
  Parameters parameters = Parameters::Zero();
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  double value = 0;
};

/// Climbs along the columns of `directions`, which turn towards where it has gone.
Found climb(const Level& level, const Point& from, const Point& to, Found found,
            std::vector<Parameters> directions, int sweeps, double tolerance) {
  const auto at = [&](const Parameters& p) {
    return information(level, mapOf(p, found.turn, from, to));
  };
  found.value = at(found.parameters);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    const Found before = found;
    double most = 0;
    std::size_t mostIn = 0;
    for (std::size_t d = 0; d < directions.size(); ++d) {
      const Parameters start = found.parameters;
      const double earlier = found.value;
      const double step =
          searchLine([&](double t) { return at(start + t * directions[d]); }, 1.0, found.value);
      found.parameters = start + step * directions[d];
      if (found.value - earlier > most) {
        most = found.value - earlier;
        mostIn = d;
      }
      directions[d] *= std::clamp(std::abs(step), 0.35, 1.2);
    }
    if (found.value - before.value < tolerance) break;
    const Parameters along = found.parameters - before.parameters;
    const Parameters start = found.parameters;
    const double step =
        searchLine([&](double t) { return at(start + t * along); }, 0.5, found.value);
    found.parameters = start + step * along;
    directions[mostIn] = 0.5 * along;
  }
  return found;
}

std::vector<Parameters> rigidAndScale(double size) {
  std::vector<Parameters> directions;
  const Parameters steps = size * firstSteps();
  for (int d = 0; d < 6; ++d) directions.push_back(steps[d] * Parameters::Unit(d));
  Parameters scale = Parameters::Zero();
  scale.segment<3>(6).setConstant(steps[6]);
  directions.push_back(scale);
  return directions;
}

std::vector<Parameters> allDirections(double size) {
  std::vector<Parameters> directions;
  const Parameters steps = size * firstSteps();
  for (int d = 0; d < kParameters; ++d) directions.push_back(steps[d] * Parameters::Unit(d));
  return directions;
}

/// Where the voxels of headOf() are.
std::vector<Point> brightOf(const Volume<float>& image) {
  const Volume<float> head = headOf(image);
  std::vector<Point> bright;
  for (std::size_t v = 0; v < head.size(); ++v) {
    if (!(head[v] > 0)) continue;
    const auto [i, j, k] = head.grid.subscripts(v);
    bright.push_back(head.grid.toWorld(Vector(i, j, k)));
  }
  if (bright.empty()) throw InvalidInput("T1: holds one value only");
  return bright;
}

/// Places where the brain's centre may lie: the centre of what is bright, and that of a head's
/// upper part only, for images with a neck.
std::array<Point, 2> centresOf(const std::vector<Point>& bright, const Vector& up, double reach) {
  std::vector<double> heights;
  for (const Point& at : bright) heights.push_back(up.dot(at));
  const double lowest = quantileOf(heights, 0.995) - reach;
  std::array<Point, 2> sums = {Point::Zero(), Point::Zero()};
  double high = 0;
  for (std::size_t v = 0; v < bright.size(); ++v) {
    sums[0] += bright[v];
    if (heights[v] < lowest) continue;
    sums[1] += bright[v];
    ++high;
  }
  return {sums[0] / static_cast<double>(bright.size()), sums[1] / std::max(high, 1.0)};
}

/// Rotations by 45 to 90 degrees, 45 degrees apart; climbing finds the way from 30 and more.
std::vector<Eigen::Matrix3d> turns() {
  constexpr double kTurn = kPi / 4;
  constexpr int kMost = 2;
  std::vector<Eigen::Matrix3d> found;
  for (int i = -kMost; i <= kMost; ++i) {
    for (int j = -kMost; j <= kMost; ++j) {
      for (int k = -kMost; k <= kMost; ++k) {
        const Vector v(i, j, k);
        if (v.norm() < 1 || v.norm() > kMost) continue;
        found.push_back(Eigen::AngleAxisd(kTurn * v.norm(), v.normalized()).toRotationMatrix());
      }
    }
  }
  return found;
}

/// A ball with the centre and the volume of a region.
struct Ball {
  Point centre = Point::Zero();
  double radius = 0;
};

Ball ballOf(const Volume<float>& region) {
  Ball ball;
  double count = 0;
  for (std::size_t v = 0; v < region.size(); ++v) {
    if (!(region[v] > 0.5f)) continue;
    const auto [i, j, k] = region.grid.subscripts(v);
    ball.centre += region.grid.toWorld(Vector(i, j, k));
    count += 1;
  }
  if (count == 0) throw InvalidInput("template: its brain mask is empty");
  ball.centre /= count;
  ball.radius = std::cbrt(0.75 / kPi * count * region.grid.voxelVolume());
  return ball;
}

/// Finds the affine map of a template onto an image from many starts.  Lengths follow from the
/// region's size.
class AffineSearch {
 public:
  AffineSearch(const Volume<float>& image, const Volume<float>& inTemplate,
               const Volume<float>& region)
      : region_(region),
        ball_(ballOf(region)),
        unit_(ball_.radius / 80),  // of a human brain with its surroundings
        fine_(inCubes(image, kImageShare * 4 * unit_)),
        fineTemplate_(inCubes(inTemplate, 4 * unit_)),
        level_(levelAt(8)),
        bright_(brightOf(level_.image)) {}

  /// The best from starts that are not turned.
  [[nodiscard]] Found upright() const {
    return bestOf(startsAt(level_, Eigen::Matrix3d::Identity()));
  }

  /// The best from starts that are turned.
  [[nodiscard]] Found turned() const {
    const Level coarse = levelAt(12);
    const std::vector<Eigen::Matrix3d> all = turns();
    std::vector<Found> found(all.size());
    parallelFor(all.size(), 1, [&](std::size_t t) {
      const std::vector<Found> here = startsAt(coarse, all[t]);
      found[t] = climbed(coarse, *std::ranges::max_element(here, {}, &Found::value));
    });
    return bestOf(std::move(found));
  }

  /// The best by all parameters near what was found, at finer levels.
  [[nodiscard]] Found refined(Found found, const Monitor& monitor) const {
    found = climbed(level_, found, allDirections(0.7), 5, 1e-5);
    for (const double spacing : {6.0, 4.0}) {
      monitor.progress(spacing > 5 ? 0.6 : 0.8, "affine registration");
      found = climbed(levelAt(spacing), found, allDirections(0.25), 5, 1e-5);
    }
    return found;
  }

  [[nodiscard]] Eigen::Affine3d affineOf(const Found& found) const {
    return mapOf(found.parameters, found.turn, ball_.centre, Point::Zero());
  }

 private:
  [[nodiscard]] Level levelAt(double spacing) const {
    return makeLevel(fine_, fineTemplate_, region_, spacing * unit_);
  }

  /// Starts about each place where the brain's centre may lie, for a head that is turned so.
  [[nodiscard]] std::vector<Found> startsAt(const Level& level, const Eigen::Matrix3d& turn) const {
    std::vector<Found> starts;
    for (const Point& centre : centresOf(bright_, turn.col(2), 2 * ball_.radius)) {
      for (const double up : {-24.0, 0.0, 24.0}) {
        for (const double front : {-16.0, 0.0, 16.0}) {
          for (const double tilt : {-0.3, 0.0, 0.3}) {
            Found start;
            start.turn = turn;
            start.parameters.head<3>() = centre + turn * Vector(0, front * unit_, up * unit_);
            start.parameters[3] = tilt;
            start.value = information(level, affineOf(start));
            starts.push_back(start);
          }
        }
      }
    }
    return starts;
  }

  [[nodiscard]] Found climbed(const Level& level, const Found& start,
                              std::vector<Parameters> directions = rigidAndScale(1), int sweeps = 4,
                              double tolerance = 1e-4) const {
    Parameters scale = Parameters::Ones();
    scale.head<3>().setConstant(unit_);
    for (Parameters& d : directions) d = d.cwiseProduct(scale);
    return climb(level, ball_.centre, Point::Zero(), start, std::move(directions), sweeps,
                 tolerance);
  }

  /// The best of some starts, climbed from the most promising ones.
  [[nodiscard]] Found bestOf(std::vector<Found> starts) const {
    constexpr std::size_t kTried = 6;
    std::ranges::stable_sort(starts, std::ranges::greater{}, &Found::value);
    starts.resize(std::min(starts.size(), kTried));
    for (Found& start : starts) start = climbed(level_, start);
    return *std::ranges::max_element(starts, {}, &Found::value);
  }

  const Volume<float>& region_;
  Ball ball_;
  double unit_;  ///< for 1 mm of a human head
  // The finest that any level needs, so that the volumes are smoothed at full size once only.
  Volume<float> fine_, fineTemplate_;
  Level level_;
  std::vector<Point> bright_;
};

/// Refuses an image that shows too little of a head for both to be brought together.
void requireSeen(const Volume<float>& head, const Grid& grid) {
  constexpr double kLeast = 0.5;  // of the head's voxels
  std::size_t all = 0, seen = 0;
  for (std::size_t v = 0; v < head.size(); ++v) {
    if (head[v] <= 0) continue;
    const auto [i, j, k] = head.grid.subscripts(v);
    const Vector at = grid.toIndex(head.grid.toWorld(Vector(i, j, k)));
    const Vector last(grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1);
    ++all;
    seen += (at.array() >= 0).all() && (at.array() <= last.array()).all();
  }
  const double share =
      static_cast<double>(seen) / static_cast<double>(std::max<std::size_t>(all, 1));
  if (share >= kLeast) return;
  throw InvalidInput("second image: by the headers it shows " +
                     std::to_string(std::lround(100 * share)) +
                     " % of the head in the image; half is needed to bring it there");
}

}  // namespace

AffineRegistration registerAffine(const Volume<float>& image, const Volume<float>& inTemplate,
                                  const Volume<float>& region, Pose pose, const Monitor& monitor) {
  monitor.progress(0, "affine registration");
  const AffineSearch search(image, inTemplate, region);
  const Found start = pose == Pose::Turned ? search.turned() : search.upright();
  monitor.progress(0.4, "affine registration");
  const Found best = search.refined(start, monitor);
  return {search.affineOf(best), best.value};
}

Eigen::Isometry3d registerNearby(const Volume<float>& image, const Volume<float>& second,
                                 const Monitor& monitor) {
  const Volume<float> head = headOf(image);
  const Point centre = centreOf(head);
  requireSeen(head, second.grid);
  Found found;
  for (const double spacing : {4.0, 2.0}) {
    checkpoint(monitor);
    const Level level = makeLevel(second, image, head, spacing);
    std::vector<Parameters> directions = rigidAndScale(spacing / 8);
    directions.pop_back();  // the scale
    found = climb(level, centre, centre, found, std::move(directions), 12, 1e-7);
  }
  // Of the same head 1.13 and more (noise of 6 %), of another one or of noise 1.03 and less.
  constexpr double kLeastInformation = 1.06;
  if (!(found.value >= kLeastInformation)) {
    throw InvalidInput(
        "t2: it does not look like the image, wherever it is moved: is it of the same head?");
  }
  const Eigen::Affine3d map = mapOf(found.parameters, found.turn, centre, centre);
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = map.linear();
  motion.translation() = map.translation();
  return motion;
}

Grid broughtBack(Grid grid, const Eigen::Isometry3d& motion) {
  grid.origin = motion.inverse() * grid.origin;
  grid.direction = motion.linear().transpose() * grid.direction;
  return grid;
}

}  // namespace explica::registration
