// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/Cuts.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/IndicesWhere.h"
#include "Explica/Geometry/MeshTopology.h"
#include "FoldWays.h"
#include "LayFlat.h"
#include "ScaleFactor.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace explica::flattening {
namespace {

constexpr Eigen::Index kSearchVertices = 20000;  // on which ways are found: 2 mm apart in a human
constexpr Eigen::Index kTrialVertices = 3000;    // that show what cuts relieve
constexpr double kTrialAreaError = 0.05;         // as a hemisphere with cuts is laid flat
constexpr std::size_t kCandidates = 5;           // ends that are tried out for each cut ...
constexpr std::size_t kFurther = 15;             // ... and as many where none of these helps
constexpr std::size_t kHighest = 2;              // ... the highest peaks first, then the widest
constexpr double kFlank = 0.5;                   // of a peak's height: what is above belongs to it
constexpr double kPriceOfACut = 0.1;             // of the square root of the area: few, not many
constexpr int kHalvings = 4;                     // of the last cut's length: to a sixteenth of it

/// Mean of |length in the map / length - 1| over edges, those of two faces counted twice.
double meanStrain(const IntrinsicMesh& mesh, const FlatPositions& flat) {
  double sum = 0;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const double length =
          (flat.row(mesh.faces(f, (k + 1) % 3)) - flat.row(mesh.faces(f, k))).norm();
      sum += std::abs(length / mesh.lengths(f, k) - 1);
    }
  }
  return sum / static_cast<double>(mesh.lengths.size());
}

double meanAreaError(const std::vector<RestFace>& rest, const IntrinsicMesh& mesh,
                     const FlatPositions& flat) {
  double sum = 0;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const auto a = flat.row(mesh.faces(f, 0));
    const Eigen::RowVector2d u = flat.row(mesh.faces(f, 1)) - a;
    const Eigen::RowVector2d v = flat.row(mesh.faces(f, 2)) - a;
    sum += std::abs((u[0] * v[1] - u[1] * v[0]) / (2 * rest[f].area) - 1);
  }
  return sum / static_cast<double>(mesh.faces.rows());
}

/// A disc seen with few vertices, and how much its map strains edges.
struct Trial {
  CoarseDisc coarse;
  double strain = kNaN;
};

Trial layTrial(const IntrinsicDisc& disc, const Monitor& monitor) {
  Trial trial;
  trial.coarse = coarseDisc(disc, kTrialVertices);
  const IntrinsicMesh& mesh = trial.coarse.disc.mesh;
  const auto rest = restFaces(mesh, kNeedleHeight * mesh.lengths.mean());
  FlattenOptions options;
  options.areaTolerance = kTrialAreaError;
  options.tolerance = 1e-3;
  Monitor quiet = monitor;
  quiet.onProgress = nullptr;
  const Laid laid = layFlat(
      trial.coarse.disc, [&](const FlatPositions& flat) { return meanAreaError(rest, mesh, flat); },
      options, quiet);
  trial.strain = meanStrain(mesh, laid.positions);
  return trial;
}

/// A vertex higher than its neighbours, and the integral of the height over what lies about it
/// above its flank and belongs to no higher peak, mm^2.
struct Peak {
  std::int32_t vertex = -1;
  double beneath = 0;
};

/// Peaks of a function on the vertices, the highest first.
std::vector<Peak> peaksOf(const IntrinsicMesh& mesh, const Eigen::VectorXd& height) {
  std::vector<std::vector<std::int32_t>> near(static_cast<std::size_t>(mesh.vertexCount));
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(mesh.vertexCount);
  const auto rest = restFaces(mesh, 0);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      near[mesh.faces(f, k)].push_back(mesh.faces(f, (k + 1) % 3));
      near[mesh.faces(f, (k + 1) % 3)].push_back(mesh.faces(f, k));
      areas[mesh.faces(f, k)] += rest[f].area / 3;
    }
  }
  auto order = indicesWhere(near.size(), [&](std::size_t v) { return height[v] > 0; });
  std::ranges::stable_sort(order,
                           [&](std::int32_t a, std::int32_t b) { return height[a] > height[b]; });
  std::vector<Peak> peaks;
  std::vector<bool> taken(near.size(), false);
  for (const std::int32_t top : order) {
    const bool peak =
        std::ranges::none_of(near[top], [&](std::int32_t w) { return height[w] > height[top]; });
    if (!peak || taken[top]) continue;
    Peak found{top, 0};
    std::vector<std::int32_t> stack = {top};
    taken[top] = true;
    while (!stack.empty()) {
      const std::int32_t v = stack.back();
      stack.pop_back();
      found.beneath += areas[v] * height[v];
      for (const std::int32_t w : near[v]) {
        if (taken[w] || !(height[w] > kFlank * height[top])) continue;
        taken[w] = true;
        stack.push_back(w);
      }
    }
    peaks.push_back(found);
  }
  return peaks;
}

/// The search for cuts on a disc of moderate size.
class CutSearch {
 public:
  /// @param paths  cuts that an earlier search has found
  CutSearch(IntrinsicDisc disc, Eigen::VectorXd depth, std::vector<bool> barred,
            std::vector<CutPath> paths, const Monitor& monitor)
      : disc_(std::move(disc)),
        barred_(std::move(barred)),
        ways_(disc_.mesh, std::move(depth), barred_),
        monitor_(monitor),
        starts_(disc_.rim),
        paths_(std::move(paths)) {
    for (const CutPath& path : paths_) starts_.insert(starts_.end(), path.begin(), path.end());
    double area = 0;
    for (const RestFace& face : restFaces(disc_.mesh, 0)) area += face.area;
    price_ = kPriceOfACut * std::sqrt(area);
    Trial trial = tryOut(paths_);
    if (!monitor_.shouldStop()) trial_ = std::move(trial);
  }

  [[nodiscard]] double strain() const { return trial_.strain; }
  [[nodiscard]] const std::vector<CutPath>& paths() const { return paths_; }

  /// Adds the cut that relieves most for its price.
  /// @return false if no cut relieves anything, or the search is to stop
  bool addBest() {
    struct Found {
      CutPath path;
      Trial trial;
      double gain = 0;
    };
    std::optional<Found> best;
    if (monitor_.shouldStop()) return false;
    std::size_t triedEnds = 0;
    for (const std::int32_t end : worstPlaces()) {
      if (triedEnds++ >= kCandidates && best) break;
      CutPath path = ways_.to(end, starts_);
      if (path.size() < 2) continue;
      std::vector<CutPath> tried = paths_;
      tried.push_back(path);
      Trial trial = tryOut(tried);
      if (monitor_.shouldStop()) return false;  // a trial cut short says nothing
      const double gain = (strain() - trial.strain) / (price_ + ways_.lengthOf(path));
      if (!(gain > (best ? best->gain : 0))) continue;
      best = Found{std::move(path), std::move(trial), gain};
    }
    if (!best) return false;
    starts_.insert(starts_.end(), best->path.begin(), best->path.end());
    paths_.push_back(std::move(best->path));
    trial_ = std::move(best->trial);
    return true;
  }

  /// Shortens the last cut as far as the strain stays within what is asked for; leaves it whole if
  /// the search is to stop.
  void shortenLast(double wanted) {
    const CutPath whole = paths_.back();
    const Trial before = trial_;
    double enough = 1, tooShort = 0;
    for (int n = 0; n < kHalvings; ++n) {
      const double share = (enough + tooShort) / 2;
      std::vector<CutPath> tried = paths_;
      tried.back() = beginning(whole, share);
      Trial trial = tryOut(tried);
      if (monitor_.shouldStop()) {
        paths_.back() = whole;
        trial_ = before;
        return;
      }
      if (trial.strain > wanted) {
        tooShort = share;
        continue;
      }
      enough = share;
      trial_ = std::move(trial);
      paths_ = std::move(tried);
    }
  }

 private:
  [[nodiscard]] Trial tryOut(const std::vector<CutPath>& cuts) const {
    IntrinsicDisc opened = disc_;
    const auto copyOf = openFaces(opened.mesh.faces, opened.mesh.vertexCount, cuts);
    opened.mesh.vertexCount += static_cast<Eigen::Index>(copyOf.size());
    opened.rim = geometry::boundaryLoops(opened.mesh.faces, opened.mesh.vertexCount).front();
    return layTrial(opened, monitor_);
  }

  /// Where distances suffer most: the highest peaks of |u|, then those under which most of |u|
  /// lies, for a thin finger is high and a whole lobe is wide.
  [[nodiscard]] std::vector<std::int32_t> worstPlaces() const {
    const IntrinsicDisc& disc = trial_.coarse.disc;
    const Eigen::VectorXd u = scaleFactor(disc).cwiseAbs();
    std::vector<Peak> peaks = peaksOf(disc.mesh, u);
    std::erase_if(peaks, [&](const Peak& peak) {
      const std::int32_t origin = trial_.coarse.vertexOrigin[peak.vertex];
      return origin >= disc_.mesh.vertexCount || barred_[origin];
    });
    std::vector<std::int32_t> places;
    const auto take = [&](std::size_t upTo) {
      for (const Peak& peak : peaks) {
        const std::int32_t place = trial_.coarse.vertexOrigin[peak.vertex];
        if (places.size() >= upTo) return;
        if (std::ranges::find(places, place) == places.end()) places.push_back(place);
      }
    };
    take(kHighest);
    std::ranges::stable_sort(peaks, std::ranges::greater{}, &Peak::beneath);
    take(kFurther);
    return places;
  }

  /// The beginning of a path up to a share of its length, one edge at least.
  [[nodiscard]] CutPath beginning(const CutPath& path, double share) const {
    const double whole = ways_.lengthOf(path);
    CutPath part = {path[0], path[1]};
    while (part.size() < path.size()) {
      part.push_back(path[part.size()]);
      if (ways_.lengthOf(part) <= share * whole) continue;
      part.pop_back();
      break;
    }
    return part;
  }

  IntrinsicDisc disc_;
  std::vector<bool> barred_;
  FoldWays ways_;
  const Monitor& monitor_;
  double price_ = 0;  ///< of a cut beside its length, mm
  Trial trial_;
  std::vector<std::int32_t> starts_;
  std::vector<CutPath> paths_;
};

/// Adds cuts until the strain asked for, or as many as allowed.
Termination searchOn(CutSearch& search, const CutOptions& options, const Monitor& monitor) {
  while (!(search.strain() <= options.edgeStrain)) {
    if (monitor.shouldStop()) return Termination::Interrupted;
    if (static_cast<int>(search.paths().size()) >= options.most) return Termination::MaxIterations;
    monitor.progress(std::min(1.0, options.edgeStrain / search.strain()),
                     "cut " + std::to_string(search.paths().size() + 1));
    if (search.addBest()) continue;
    return monitor.shouldStop() ? Termination::Interrupted : Termination::Stalled;
  }
  if (!search.paths().empty()) search.shortenLast(options.edgeStrain);
  return monitor.shouldStop() ? Termination::Interrupted : Termination::TargetReached;
}

void requireWithin(const std::vector<CutPath>& paths, Eigen::Index vertexCount) {
  for (const CutPath& path : paths) {
    for (const std::int32_t v : path) {
      if (v < 0 || v >= vertexCount) {
        throw InvalidInput("state: its cuts belong to another surface");
      }
    }
  }
}

}  // namespace

CutPlan findCuts(const Disc& disc, const Eigen::VectorXd& depth, const CutOptions& options,
                 const Monitor& monitor, const CutPlan* resume) {
  if (depth.size() != disc.mesh.vertexCount()) {
    throw InvalidInput("depth: needs one value a vertex");
  }
  if (!(options.edgeStrain > 0) || options.most < 0) {
    throw InvalidInput("cuts: needs a strain above 0 and no negative number of cuts");
  }
  CutPlan plan;
  if (resume != nullptr) plan = *resume;
  plan.termination = Termination::Interrupted;
  if (monitor.shouldStop()) return plan;
  const IntrinsicDisc fine = intrinsicDisc(disc);
  const std::vector<bool> barred = besideHoles(disc, fine.mesh.vertexCount);
  Eigen::VectorXd fineDepth = Eigen::VectorXd::Zero(fine.mesh.vertexCount);
  fineDepth.head(depth.size()) = depth;
  CoarseDisc coarse = coarseDisc(fine, kSearchVertices);
  requireWithin(plan.found, coarse.disc.mesh.vertexCount);
  Eigen::VectorXd coarseDepth(coarse.disc.mesh.vertexCount);
  std::vector<bool> coarseBarred;
  for (Eigen::Index v = 0; v < coarseDepth.size(); ++v) {
    coarseDepth[v] = fineDepth[coarse.vertexOrigin[v]];
    coarseBarred.push_back(barred[coarse.vertexOrigin[v]]);
  }
  CutSearch search(coarse.disc, std::move(coarseDepth), std::move(coarseBarred), plan.found,
                   monitor);
  if (plan.found.empty()) plan.strainBefore = search.strain();
  plan.termination = searchOn(search, options, monitor);
  if (std::isfinite(search.strain())) plan.edgeStrain = search.strain();
  plan.found = search.paths();
  plan.cuts.clear();
  const FoldWays ways(fine.mesh, fineDepth, barred);
  std::vector<std::int32_t> starts = disc.rim;
  for (const CutPath& found : plan.found) {
    Cut cut;
    cut.path = ways.to(coarse.vertexOrigin[found.back()], starts);
    cut.length = ways.lengthOf(cut.path);
    cut.depth = ways.depthOf(cut.path);
    starts.insert(starts.end(), cut.path.begin(), cut.path.end());
    plan.cuts.push_back(std::move(cut));
  }
  return plan;
}

double CutPlan::length() const {
  double sum = 0;
  for (const Cut& cut : cuts) sum += cut.length;
  return sum;
}

void describe(Results& t, const CutPlan& plan) {
  double depth = 0;
  for (const Cut& cut : plan.cuts) depth += cut.length * cut.depth;
  const double length = plan.length();
  t.count("cuts", "Relief cuts", "Along sulci where that is not much longer.", plan.cuts.size())
      .inHead();
  t.number("cut_length", "Length of the cuts", "mm", "", length).inHead();
  t.number("cut_depth", "Mean fold depth along the cuts", "", "1 is a standard deviation inwards.",
           length > 0 ? depth / length : kNaN);
  t.share("cut_strain_before", "Change of lengths without the cuts",
          "Mean over edges of the map of a coarse disc.", plan.strainBefore);
  t.share("cut_strain", "Change of lengths with the cuts", "", plan.edgeStrain);
}

}  // namespace explica::flattening
