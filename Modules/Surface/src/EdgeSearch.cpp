// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "EdgeSearch.h"

#include "BorderChooser.h"
#include "Explica/Core/Parallel.h"
#include "PathProfile.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace explica::surface {
namespace {

constexpr double kProfileStep = 0.1;  // voxels from place to place of a mean profile
constexpr double kDeep = 2;           // voxels inside the border: white matter
constexpr double kMost = 0.5;         // of the ribbon a border goes outward in one pass
constexpr double kFarthest = 4;       // voxels inward, all passes together
constexpr int kSmooth = 1;            // places on each side over which a slope is taken
/// Voxels, as long as they are along the way, before a mask's edge that a voxel there changes:
/// between its centre and the next one's.
constexpr double kPartial = 1.5;
/// Least fall a voxel, of the usual contrast, for which a border leaves such voxels: a quarter of
/// that of an edge seen through a point spread of a voxel's deviation.
constexpr double kLeastFall = 0.1;

/// The usual brightness of the tissues, times `sign`.
struct Usual {
  double white = 0, grey = 0;
  double sign = 1;  ///< 1 if white matter is brighter than grey matter
};

Usual usualBrightness(const std::vector<Trajectory>& paths, const Volume<float>& image,
                      double voxel) {
  std::vector<double> white, grey;
  for (const Trajectory& path : paths) {
    if (path.end == TrajectoryEnd::NoRibbon) continue;
    white.push_back(valueAt(image, along(path, -kDeep * voxel)));
    grey.push_back(valueAt(image, along(path, 0.5 * path.length())));
  }
  Usual usual{median(std::move(white)), median(std::move(grey)), 1};
  if (usual.white < usual.grey) usual = {-usual.white, -usual.grey, -1};
  return usual;
}

class PathSearch {
 public:
  PathSearch(const std::vector<Trajectory>& paths, const geometry::MeshTopology& topology,
             double edge, const MaskedImage& masked, double voxel, const EdgeSearchOptions& options)
      : paths_(paths),
        topology_(topology),
        image_(masked.image),
        voxel_(voxel),
        options_(options),
        times_(timesFor(options.spread * voxel, edge)),
        usual_(usualBrightness(paths, masked.image, voxel)),
        way_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(paths.size()))),
        first_(-static_cast<int>(std::lround(options.inward / kProfileStep)) - kSmooth),
        count_(static_cast<int>(std::lround(options.outward / kProfileStep)) + kSmooth - first_ +
               1),
        whole_(wholeUpTo(masked)) {}

  void improve() {
    const VertexRows edges =
        averaged(edgesOf(averaged(profiles(), topology_, times_)), topology_, times_);
    follow(edges.col(1));
    const Eigen::VectorXd level = edges.col(0);
    const double step = voxel_ / kSide;
    std::vector<Profile> misses(paths_.size());
    std::vector<Choice> choices(paths_.size());
    parallelFor(paths_.size(), 256, [&](std::size_t v) {
      misses[v].fill(static_cast<float>(kNaN));
      const auto row = static_cast<Eigen::Index>(v);
      if (!std::isfinite(level[row])) return;
      choices[v] = choiceOf(v, step);
      const Along path(paths_[v]);
      for (int k = 0; k < kPlaces; ++k) {
        misses[v][k] =
            static_cast<float>((valueOf(path, way_[row] + (k - kSide) * step) - level[row]) /
                               (usual_.white - usual_.grey));
      }
    });
    const BorderChooser chooser(std::move(misses), std::move(choices), topology_, step, voxel_,
                                {options_.centring, options_.smoothness});
    way_ += chooser.choose(options_.rounds);
  }

  [[nodiscard]] const Eigen::VectorXd& way() const { return way_; }

 private:
  [[nodiscard]] double valueOf(const Along& path, double arc) const {
    return usual_.sign * valueAt(image_, path.at(arc));
  }

  /// How far along each trajectory voxels are seen that a mask's edge leaves whole, and the size of
  /// a voxel that way, mm.
  [[nodiscard]] VertexRows wholeUpTo(const MaskedImage& masked) const {
    VertexRows whole = VertexRows::Constant(way_.size(), 2, kInfinity);
    if (masked.seen.size() == 0) return whole;
    const Grid& grid = masked.seen.grid;
    const double step = kProfileStep * voxel_;
    parallelFor(paths_.size(), 256, [&](std::size_t v) {
      if (paths_[v].end == TrajectoryEnd::NoRibbon) return;
      const double last = paths_[v].length() + kPartial * grid.spacing.maxCoeff();
      for (double arc = 0; arc < last; arc += step) {
        const Point end = along(paths_[v], arc);
        if (masked.seenAt(end) >= 0.5) continue;
        const Vector outward = (end - along(paths_[v], arc - voxel_)).normalized();
        const double size = grid.spacing.cwiseProduct(grid.direction.transpose() * outward).norm();
        whole.row(static_cast<Eigen::Index>(v)) << arc - kPartial * size, size;
        return;
      }
    });
    return whole;
  }

  /// Length of the ribbon outside of the border as it is.
  [[nodiscard]] double lengthOf(std::size_t v) const {
    return paths_[v].length() - way_[static_cast<Eigen::Index>(v)];
  }

  [[nodiscard]] VertexRows profiles() const {
    VertexRows all = VertexRows::Constant(static_cast<Eigen::Index>(paths_.size()), count_, kNaN);
    parallelFor(paths_.size(), 256, [&](std::size_t v) {
      if (paths_[v].end == TrajectoryEnd::NoRibbon) return;
      const auto row = static_cast<Eigen::Index>(v);
      const Along path(paths_[v]);
      for (int k = 0; k < count_; ++k) {
        all(row, k) = valueOf(path, way_[row] + (first_ + k) * kProfileStep * voxel_);
      }
      if (!all.row(row).allFinite()) all(row, 0) = kNaN;
    });
    return all;
  }

  /// Brightness at the edge of each mean profile, and where it lies, voxels; NaN where it has none.
  [[nodiscard]] VertexRows edgesOf(const VertexRows& mean) const {
    VertexRows edges = VertexRows::Constant(mean.rows(), 2, kNaN);
    parallelFor(paths_.size(), 256, [&](std::size_t v) {
      const auto row = static_cast<Eigen::Index>(v);
      if (!std::isfinite(mean(row, 0))) return;
      Eigen::VectorXd slope = Eigen::VectorXd::Zero(count_);
      for (int k = kSmooth; k < count_ - kSmooth; ++k) {
        slope[k] = mean(row, k - kSmooth) - mean(row, k + kSmooth);
      }
      double best = 0;
      const double whole = whole_(row, 0), apart = 2 * kSmooth * kProfileStep * voxel_;
      const double usual = kLeastFall * apart / whole_(row, 1) * (usual_.white - usual_.grey);
      const double least = way_[row] > whole ? usual : 0;
      for (int k = kSmooth + 1; k < count_ - kSmooth - 1; ++k) {
        const double place = (first_ + k) * kProfileStep;
        if (place * voxel_ > kMost * lengthOf(v) || !(mean(row, k) > usual_.grey)) continue;
        if (way_[row] + place * voxel_ > whole) continue;
        if (slope[k] < least || slope[k] < slope[k - 1] || slope[k] < slope[k + 1]) continue;
        const double off = place / options_.likely;
        const double score = slope[k] * std::exp(-0.5 * off * off);
        if (score <= best) continue;
        best = score;
        edges.row(row) << mean(row, k), place;
      }
    });
    return edges;
  }

  /// Goes to where the edges of the mean profiles lie, a voxel at most: across a cortex of even
  /// brightness no level leads there.
  void follow(const Eigen::VectorXd& places) {
    parallelFor(paths_.size(), 256, [&](std::size_t v) {
      const auto row = static_cast<Eigen::Index>(v);
      if (!std::isfinite(places[row])) return;
      const double least = -kFarthest * voxel_;
      const double most = std::max(least, way_[row] + kMost * lengthOf(v));
      way_[row] = std::clamp(way_[row] + std::clamp(places[row], -1.0, 1.0) * voxel_, least, most);
    });
  }

  [[nodiscard]] Choice choiceOf(std::size_t v, double step) const {
    const double way = way_[static_cast<Eigen::Index>(v)];
    const auto places = [&](double length) {
      return std::clamp(static_cast<int>(std::floor(length / step)), 0, kSide);
    };
    return {kSide - places(kFarthest * voxel_ + way), kSide + places(kMost * lengthOf(v))};
  }

  const std::vector<Trajectory>& paths_;
  const geometry::MeshTopology& topology_;
  const Volume<float>& image_;
  double voxel_;
  EdgeSearchOptions options_;
  int times_;  ///< that profiles are averaged over neighbours
  Usual usual_;
  Eigen::VectorXd way_;
  int first_, count_;
  VertexRows whole_;  ///< see wholeUpTo()
};

}  // namespace

Eigen::VectorXd searchWhite(const std::vector<Trajectory>& paths,
                            const geometry::MeshTopology& topology, double edge,
                            const MaskedImage& image, double voxel,
                            const EdgeSearchOptions& options) {
  PathSearch search(paths, topology, edge, image, voxel, options);
  for (int pass = 0; pass < options.passes; ++pass) search.improve();
  return search.way();
}

}  // namespace explica::surface
