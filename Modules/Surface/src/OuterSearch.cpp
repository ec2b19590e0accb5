// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "OuterSearch.h"

#include "Explica/Core/Parallel.h"
#include "PathProfile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace explica::surface {
namespace {

constexpr double kFine = 0.25;    // voxels from place to place of a profile
constexpr double kTooLong = 1.5;  // of the usual length
/// Of the usual depth: the middle, clear of both borders.
constexpr std::array kGreyPlaces = {0.4, 0.5, 0.6};

/// Median over a vertex and two rings.
double medianAround(std::size_t v, const Eigen::VectorXd& values,
                    const geometry::MeshTopology& topology) {
  std::vector<double> around;
  for (const std::int32_t w : withinTwoEdges(v, topology)) around.push_back(values[w]);
  return median(std::move(around));
}

class Search {
 public:
  Search(const std::vector<Trajectory>& paths, const MaskedImage& image, double voxel, double sign,
         const OuterSearchOptions& options)
      : paths_(paths),
        image_(image),
        voxel_(voxel),
        sign_(sign),
        usual_(usualLength(paths)),
        options_(options) {}

  /// Brightness of grey matter and how much it counts: what is far longer than usual may be other
  /// tissue.
  [[nodiscard]] Eigen::RowVector2d greyAt(std::size_t v) const {
    const double length = paths_[v].length();
    if (paths_[v].end == TrajectoryEnd::NoRibbon || length > kTooLong * usual_) return {0, 0};
    const Along path(paths_[v]);
    double sum = 0;
    for (const double share : kGreyPlaces) sum += valueOf(path, share * depthOf(v));
    if (!std::isfinite(sum)) return {0, 0};
    return {sum / kGreyPlaces.size(), 1};
  }

  /// Of grey matter beside the darkest just outside, over all vertices.
  [[nodiscard]] double usualContrast(const Eigen::VectorXd& grey) const {
    std::vector<double> contrasts(paths_.size(), kNaN);
    parallelFor(paths_.size(), 256, [&](std::size_t v) {
      if (paths_[v].end == TrajectoryEnd::NoRibbon) return;
      Outward outward = outwardOn(v);
      contrasts[v] = grey[static_cast<Eigen::Index>(v)] - firstDarkest(outward, kInfinity).first;
    });
    return median(std::move(contrasts));
  }

  /// Where the trajectory is half way to the darkest; its length if that is farther or nowhere.
  [[nodiscard]] double borderOf(std::size_t v, double grey, double contrast) const {
    const double length = paths_[v].length();
    Outward outward = outwardOn(v);
    auto [darkest, place] = firstDarkest(outward, options_.flat * contrast);
    if (!(grey - darkest > options_.flat * contrast)) return length;
    if (!isSeen(v, arcOf(outward, place))) return length;
    while (place > 0 && smoothAt(outward, place) < 0.5 * (grey + darkest)) --place;
    return std::min(arcOf(outward, place), length);
  }

 private:
  [[nodiscard]] double depthOf(std::size_t v) const { return std::min(usual_, paths_[v].length()); }
  /// Brightness at places of a trajectory from the middle of the ribbon on, each looked at once.
  struct Outward {
    Along path;
    double first, last;          ///< of them, mm along the trajectory
    std::vector<double> values;  ///< from two places before the first
  };
  [[nodiscard]] Outward outwardOn(std::size_t v) const {
    const double last = paths_[v].length() + options_.beyond * voxel_;
    return {Along(paths_[v]), 0.5 * depthOf(v), last, {}};
  }
  [[nodiscard]] double arcOf(const Outward& outward, int place) const {
    return outward.first + place * kFine * voxel_;
  }
  /// Mean over a voxel, against noise.
  [[nodiscard]] double smoothAt(Outward& outward, int place) const {
    while (static_cast<int>(outward.values.size()) < place + 5) {
      const int next = static_cast<int>(outward.values.size()) - 2;
      outward.values.push_back(valueOf(outward.path, arcOf(outward, next)));
    }
    double sum = 0;
    for (int k = 0; k < 5; ++k) sum += outward.values[place + k];
    return sum / 5;
  }

  /// The darkest until it rises again, and its place.
  /// @param rise  what is no noise
  [[nodiscard]] std::pair<double, int> firstDarkest(Outward& outward, double rise) const {
    std::pair least(kInfinity, 0);
    for (int place = 0; arcOf(outward, place) <= outward.last; ++place) {
      const double value = smoothAt(outward, place);
      if (value > least.first + rise) break;
      if (value < least.first) least = {value, place};
    }
    return least;
  }

  [[nodiscard]] double valueOf(const Along& path, double arc) const {
    return sign_ * valueAt(image_.image, path.at(arc));
  }
  /// True if the image shows a voxel more than that place.
  [[nodiscard]] bool isSeen(std::size_t v, double arc) const {
    return image_.seenAt(along(paths_[v], arc + voxel_)) > 0.5;
  }

  const std::vector<Trajectory>& paths_;
  const MaskedImage& image_;
  double voxel_, sign_, usual_;
  const OuterSearchOptions& options_;
};

}  // namespace

Eigen::VectorXd searchOuter(const std::vector<Trajectory>& paths,
                            const geometry::MeshTopology& topology, double edge,
                            const MaskedImage& image, double voxel, double sign,
                            double fluidContrast, const OuterSearchOptions& options) {
  const Search search(paths, image, voxel, sign, options);
  const auto n = static_cast<Eigen::Index>(paths.size());
  VertexRows seen(n, 2);
  parallelFor(paths.size(), 256,
              [&](std::size_t v) { seen.row(static_cast<Eigen::Index>(v)) = search.greyAt(v); });
  seen = averaged(std::move(seen), topology, timesFor(options.greySpread * voxel, edge));
  const Eigen::VectorXd grey = seen.col(0).cwiseQuotient(seen.col(1));
  const double contrast = fluidContrast > 0 ? fluidContrast : search.usualContrast(grey);
  Eigen::VectorXd border(n);
  parallelFor(paths.size(), 256, [&](std::size_t v) {
    const auto row = static_cast<Eigen::Index>(v);
    border[row] =
        paths[v].end == TrajectoryEnd::NoRibbon ? kNaN : search.borderOf(v, grey[row], contrast);
  });
  Eigen::VectorXd ways = Eigen::VectorXd::Zero(n);
  parallelFor(paths.size(), 256, [&](std::size_t v) {
    if (paths[v].end == TrajectoryEnd::NoRibbon) return;
    const double rest = paths[v].length() - medianAround(v, border, topology);
    const auto row = static_cast<Eigen::Index>(v);
    if (rest > options.farthest * voxel) ways[row] = -rest;
  });
  return ways;
}

}  // namespace explica::surface
