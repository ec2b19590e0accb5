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
    double sum = 0;
    for (const double share : kGreyPlaces) sum += valueOf(v, share * depthOf(v));
    if (!std::isfinite(sum)) return {0, 0};
    return {sum / kGreyPlaces.size(), 1};
  }

  /// Of grey matter beside the darkest just outside, over all vertices.
  [[nodiscard]] double usualContrast(const Eigen::VectorXd& grey) const {
    std::vector<double> contrasts(paths_.size(), kNaN);
    parallelFor(paths_.size(), 256, [&](std::size_t v) {
      if (paths_[v].end == TrajectoryEnd::NoRibbon) return;
      contrasts[v] = grey[static_cast<Eigen::Index>(v)] - firstDarkest(v, kInfinity).first;
    });
    return median(std::move(contrasts));
  }

  /// The darkest from the middle of the ribbon on, until it rises again.
  /// @param rise  what is no noise
  /// @return brightness and place
  [[nodiscard]] std::pair<double, double> firstDarkest(std::size_t v, double rise) const {
    std::pair least(kInfinity, paths_[v].length());
    const double last = paths_[v].length() + options_.beyond * voxel_;
    for (double at = 0.5 * depthOf(v); at <= last; at += kFine * voxel_) {
      const double value = smoothOf(v, at);
      if (value > least.first + rise) break;
      if (value < least.first) least = {value, at};
    }
    return least;
  }

  /// Where the trajectory is half way to the darkest; its length if that is farther or nowhere.
  [[nodiscard]] double borderOf(std::size_t v, double grey, double contrast) const {
    const double length = paths_[v].length();
    const auto [darkest, place] = firstDarkest(v, options_.flat * contrast);
    if (!(grey - darkest > options_.flat * contrast) || !isSeen(v, place)) return length;
    double at = place;
    while (at > 0.5 * depthOf(v) && smoothOf(v, at) < 0.5 * (grey + darkest)) at -= kFine * voxel_;
    return std::min(at, length);
  }

 private:
  [[nodiscard]] double depthOf(std::size_t v) const { return std::min(usual_, paths_[v].length()); }
  /// Mean over a voxel, against noise.
  [[nodiscard]] double smoothOf(std::size_t v, double arc) const {
    double sum = 0;
    for (int k = -2; k <= 2; ++k) sum += valueOf(v, arc + k * kFine * voxel_);
    return sum / 5;
  }
  [[nodiscard]] double valueOf(std::size_t v, double arc) const {
    return sign_ * valueAt(image_.image, along(paths_[v], arc));
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
  Eigen::MatrixXd seen(n, 2);
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
