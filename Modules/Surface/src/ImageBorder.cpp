// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "ImageBorder.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/MeshTopology.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace explica::surface {
namespace {

/// Places that are looked at on each side of the labels' border.
constexpr int kSide = 10;
constexpr int kPlaces = 2 * kSide + 1;
/// Of a short trajectory each border takes this share at most, so that they do not pass each other.
constexpr double kShortShare = 0.35;

/// White matter is looked at this far inside its border, the outside this far beyond the tissue,
/// voxels; grey matter in the middle.
constexpr std::array kWhiteDepths = {1.5, 2.0, 2.5};
constexpr std::array kGreyShares = {0.4, 0.5, 0.6};
constexpr double kOutsideReach = 2;
constexpr int kOutsideSamples = 9;

/// An edge is there if brightness comes so near to its level, in contrasts.
constexpr float kNear = 0.3F;

/// Brightness at each place, per vertex; NaN off the image.
using Profile = std::array<float, kPlaces>;

/// Point of a trajectory at any arc length, straight beyond its ends.
Point along(const Trajectory& path, double arc) {
  const std::size_t n = path.points.size();
  if (n > 1 && arc < 0) {
    return path.points[0] - arc * (path.points[0] - path.points[1]).normalized();
  }
  if (n > 1 && arc > path.length()) {
    const Vector way = (path.points[n - 1] - path.points[n - 2]).normalized();
    return path.points[n - 1] + (arc - path.length()) * way;
  }
  return path.at(arc);
}

/// Trilinear value; NaN off the image.
double valueAt(const Volume<float>& image, const Point& p) {
  const Grid& grid = image.grid;
  const Vector index = grid.toIndex(p);
  std::array<int, 3> base;
  Vector t;
  for (int a = 0; a < 3; ++a) {
    if (!(index[a] >= 0 && index[a] <= grid.size[a] - 1)) return kNaN;
    base[a] = std::min(static_cast<int>(index[a]), std::max(0, grid.size[a] - 2));
    t[a] = index[a] - base[a];
  }
  double sum = 0;
  for (int c = 0; c < 8; ++c) {
    const int i = c & 1, j = c >> 1 & 1, k = c >> 2;
    const double weight = (i ? t[0] : 1 - t[0]) * (j ? t[1] : 1 - t[1]) * (k ? t[2] : 1 - t[2]);
    if (weight > 0) sum += weight * image(base[0] + i, base[1] + j, base[2] + k);
  }
  return sum;
}

/// Brightness of the tissues along each trajectory, averaged over neighbours; NaN where there is no
/// ribbon or no image.
struct Tissues {
  Eigen::VectorXd white, grey, outside;
  double sign = 1;  ///< 1 if white matter is brighter than grey matter
};

double median(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return kNaN;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Means over neighbours, `times` over; what is not known takes no part.
Eigen::VectorXd averaged(Eigen::VectorXd values, const geometry::MeshTopology& topology,
                         int times) {
  for (int pass = 0; pass < times; ++pass) {
    Eigen::VectorXd next = values;
    parallelFor(topology.vertexVertices.size(), 1024, [&](std::size_t v) {
      const auto row = static_cast<Eigen::Index>(v);
      if (!std::isfinite(values[row])) return;
      double sum = values[row];
      int count = 1;
      for (const std::int32_t w : topology.vertexVertices[v]) {
        if (!std::isfinite(values[w])) continue;
        sum += values[w];
        ++count;
      }
      next[row] = sum / count;
    });
    values = std::move(next);
  }
  return values;
}

Tissues brightnessOf(const std::vector<Trajectory>& paths, const Volume<float>& image,
                     double voxel) {
  const auto n = static_cast<Eigen::Index>(paths.size());
  Tissues found;
  found.white = found.grey = found.outside = Eigen::VectorXd::Constant(n, kNaN);
  parallelFor(paths.size(), 256, [&](std::size_t v) {
    const Trajectory& path = paths[v];
    if (path.end == TrajectoryEnd::NoRibbon) return;
    double white = 0, grey = 0;
    for (const double depth : kWhiteDepths) white += valueAt(image, along(path, -depth * voxel));
    for (const double share : kGreyShares)
      grey += valueAt(image, along(path, share * path.length()));
    found.white[static_cast<Eigen::Index>(v)] = white / kWhiteDepths.size();
    found.grey[static_cast<Eigen::Index>(v)] = grey / kGreyShares.size();
  });
  std::vector<double> contrast(paths.size());
  for (Eigen::Index v = 0; v < n; ++v) contrast[v] = found.white[v] - found.grey[v];
  found.sign = median(contrast) < 0 ? -1 : 1;
  parallelFor(paths.size(), 256, [&](std::size_t v) {
    const Trajectory& path = paths[v];
    if (path.end == TrajectoryEnd::NoRibbon) return;
    double least = kInfinity;  // vessels and meninges beside fluid must not hide it
    for (int k = 0; k < kOutsideSamples; ++k) {
      const double beyond = kOutsideReach * voxel * k / (kOutsideSamples - 1);
      const double value = found.sign * valueAt(image, along(path, path.length() + beyond));
      if (value < least) least = value;
    }
    found.outside[static_cast<Eigen::Index>(v)] = least < kInfinity ? found.sign * least : kNaN;
  });
  return found;
}

/// What a vertex may choose between, first and last place.
struct Choice {
  int first = kSide, last = kSide;
};

/// How far a border may go outward and inward on a trajectory, in places.
Choice choiceOn(const Trajectory& path, bool outer, double step) {
  if (path.end == TrajectoryEnd::NoRibbon) return {};
  const int inside =
      std::min(kSide, static_cast<int>(std::floor(kShortShare * path.length() / step)));
  if (!outer) return {0, kSide + inside};
  return {kSide - inside, path.end == TrajectoryEnd::Bank ? kSide : kPlaces - 1};
}

/// How far brightness is from the border's level at each place, in contrasts: positive inside.
std::vector<Profile> missesOf(const std::vector<Trajectory>& paths, bool outer,
                              const Volume<float>& image, double step, double sign,
                              const Eigen::VectorXd& inside, const Eigen::VectorXd& outside,
                              const EdgeOptions& options, double flat) {
  std::vector<double> contrast(paths.size());
  for (std::size_t v = 0; v < paths.size(); ++v) {
    const auto row = static_cast<Eigen::Index>(v);
    contrast[v] = sign * (inside[row] - outside[row]);
  }
  const double least = flat * median(contrast);
  std::vector<Profile> profiles(paths.size());
  parallelFor(paths.size(), 256, [&](std::size_t v) {
    profiles[v].fill(static_cast<float>(kNaN));
    if (!(contrast[v] > least)) return;
    const auto row = static_cast<Eigen::Index>(v);
    const double level = outside[row] + options.level * (inside[row] - outside[row]);
    const double border = outer ? paths[v].length() : 0;
    for (int k = 0; k < kPlaces; ++k) {
      const double value = valueAt(image, along(paths[v], border + (k - kSide) * step));
      profiles[v][k] = static_cast<float>(sign * (value - level) / contrast[v]);
    }
  });
  return profiles;
}

/// Each vertex's best place given its neighbours', over and over; mm.
class Chooser {
 public:
  Chooser(std::vector<Profile> misses, std::vector<Choice> choices,
          const geometry::MeshTopology& topology, double step, double voxel,
          const EdgeOptions& options)
      : misses_(std::move(misses)),
        choices_(std::move(choices)),
        topology_(topology),
        options_(options),
        step_(step),
        voxel_(voxel),
        has_(misses_.size()) {
    for (std::size_t v = 0; v < has_.size(); ++v) has_[v] = comesNear(v);
  }

  [[nodiscard]] Eigen::VectorXd choose(int rounds) const {
    Eigen::VectorXd chosen = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(misses_.size()));
    for (int round = 0; round < rounds; ++round) {
      Eigen::VectorXd next(chosen.size());
      parallelFor(misses_.size(), 512, [&](std::size_t v) {
        double mean = 0;
        const auto& ring = topology_.vertexVertices[v];
        for (const std::int32_t w : ring) mean += chosen[w] / static_cast<double>(ring.size());
        next[static_cast<Eigen::Index>(v)] = has_[v] ? bestOf(v, mean) : 0.0;
      });
      chosen = std::move(next);
    }
    return chosen;
  }

  [[nodiscard]] std::int64_t missing() const {
    return std::count(has_.begin(), has_.end(), std::uint8_t{0});
  }

 private:
  /// True if brightness comes near the level at one of the places.
  [[nodiscard]] bool comesNear(std::size_t v) const {
    for (int k = choices_[v].first; k <= choices_[v].last; ++k) {
      if (std::abs(misses_[v][k]) < kNear) return true;
    }
    return false;
  }

  [[nodiscard]] double costOf(std::size_t v, int place, double mean) const {
    const double way = (place - kSide) * step_ / voxel_, off = way - mean / voxel_;
    const double miss = std::min(1.0F, misses_[v][place] * misses_[v][place]);
    return miss + options_.centring * way * way + options_.smoothness * off * off;
  }

  [[nodiscard]] double bestOf(std::size_t v, double mean) const {
    const Choice& choice = choices_[v];
    int best = -1;
    double least = kInfinity;
    for (int place = choice.first; place <= choice.last; ++place) {
      const double cost = costOf(v, place, mean);
      if (!(cost < least)) continue;
      least = cost;
      best = place;
    }
    if (best < 0) return 0;
    double shift = 0;  // of the parabola through the best place and its neighbours
    if (best > choice.first && best < choice.last) {
      const double before = costOf(v, best - 1, mean), after = costOf(v, best + 1, mean);
      const double bend = before - 2 * least + after;
      if (bend > 0) shift = std::clamp(0.5 * (before - after) / bend, -0.5, 0.5);
    }
    return (best + shift - kSide) * step_;
  }

  std::vector<Profile> misses_;
  std::vector<Choice> choices_;
  const geometry::MeshTopology& topology_;
  const EdgeOptions& options_;
  double step_, voxel_;
  std::vector<std::uint8_t> has_;
};

}  // namespace

ImageBorders findBorders(const std::vector<Trajectory>& paths, const TriangleMesh& white,
                         const Volume<float>& image, double voxel,
                         const ImageBorderOptions& options) {
  const auto topology = geometry::buildTopology(white.faces, white.vertexCount());
  const double step = options.reach * voxel / kSide;
  const Tissues tissues = brightnessOf(paths, image, voxel);
  ImageBorders borders;
  for (const bool outer : {false, true}) {
    const EdgeOptions& edge = outer ? options.outer : options.white;
    const auto inside = averaged(outer ? tissues.grey : tissues.white, topology, edge.spread);
    const auto outside = averaged(outer ? tissues.outside : tissues.grey, topology, edge.spread);
    std::vector<Choice> choices(paths.size());
    for (std::size_t v = 0; v < paths.size(); ++v) choices[v] = choiceOn(paths[v], outer, step);
    const Chooser chooser(
        missesOf(paths, outer, image, step, tissues.sign, inside, outside, edge, options.flat),
        std::move(choices), topology, step, voxel, edge);
    (outer ? borders.outer : borders.white) = chooser.choose(options.rounds);
    (outer ? borders.missingOuter : borders.missingWhite) = chooser.missing();
  }
  return borders;
}

Trajectory between(const Trajectory& path, double from, double to) {
  Trajectory part;
  part.end = path.end;
  const auto add = [&](double arc) {
    part.points.push_back(along(path, arc));
    part.along.push_back(static_cast<float>(arc - from));
  };
  add(from);
  for (const float arc : path.along) {
    const double rest = 1e-3 * (to - from);  // closer points would leave a direction to rounding
    if (arc > from + rest && arc < to - rest) add(arc);
  }
  add(to);
  return part;
}

}  // namespace explica::surface
