// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "ImageBorder.h"

#include "BorderChooser.h"
#include "EdgeSearch.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "MaskedImage.h"
#include "NarrowFluid.h"
#include "OuterSearch.h"
#include "PathProfile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace explica::surface {
namespace {

/// Of a short trajectory each border takes this share at most, so that they do not pass each other.
constexpr double kShortShare = 0.35;
/// The middle between two banks is known to half a voxel.
constexpr double kMiddleKnown = 0.5;
constexpr int kBeyondBank = static_cast<int>(kMiddleKnown * kSide);

/// White matter is looked at this far inside its border, the outside this far beyond the tissue,
/// voxels; grey matter in the middle.
constexpr std::array kWhiteDepths = {1.5, 2.0, 2.5};
/// Least distance to any border over depth: where a blade's other side is nearer, grey matter mixes
/// in, and would put the border outward.
constexpr double kDeepShare = 0.75;
constexpr std::array kGreyShares = {0.4, 0.5, 0.6};
constexpr double kOutsideReach = 2;
constexpr int kOutsideSamples = 9;
/// Deviation of the window in which brightness of white matter is averaged, voxels.
constexpr double kWhiteSpread = 4.1;
/// Standard deviation of a border that a mask's edge gives, voxels: it is somewhere in its voxel.
/// Where it leaves less of the usual thickness than a share, it may have cut cortex off.
const double kUniform = 1 / std::sqrt(12.0);
constexpr double kThinShare = 0.5;
/// Farthest beyond the tissue that the image is looked at, voxels.
constexpr double kBeyondMask = kOutsideReach + 1;

/// Brightness of the tissues along each trajectory; NaN where there is no ribbon or no image.
struct Tissues {
  Eigen::VectorXd white;  ///< mean of what lies deep, over neighbours
  Eigen::VectorXd grey, outside;
  double noise = 0;         ///< standard deviation in white matter
  Eigen::VectorXd covered;  ///< share of the outside that the image's mask has not cut away
  double sign = 1;          ///< 1 if brightness falls outward, or -1
};

/// By which border the sense of an image is told.
enum class SenseOf { White, Outer };

/// Sums and counts of white matter's brightness deep inside, along each trajectory.
/// @param inner  as distanceLevelOf(): positive in white matter
VertexRows deepWhite(const std::vector<Trajectory>& paths, const LevelSet& inner,
                     const Volume<float>& image, double voxel) {
  const double band = bandOf(inner.grid);
  VertexRows found = VertexRows::Zero(static_cast<Eigen::Index>(paths.size()), 2);
  parallelFor(paths.size(), 256, [&](std::size_t v) {
    if (paths[v].end == TrajectoryEnd::NoRibbon) return;
    for (const double depth : kWhiteDepths) {
      const Point at = along(paths[v], -depth * voxel);
      const double value = valueAt(image, at), least = kDeepShare * depth * voxel;
      const bool isDeep = band * sample(inner, at).value >= std::min(least, kDeepShare * band);
      if (!isDeep || !std::isfinite(value)) continue;
      found.row(static_cast<Eigen::Index>(v)) += Eigen::RowVector2d(value, 1);
    }
  });
  return found;
}

/// What differs from the vertices around, by the median, which vessels do not move.
double noiseOf(const Eigen::VectorXd& white, const geometry::MeshTopology& topology) {
  constexpr int kAround = 2;
  constexpr double kOfMedian = 1.4826;  // of a normal distribution
  const Eigen::VectorXd off = (white - averaged(white, topology, kAround)).cwiseAbs();
  return kOfMedian * median({off.begin(), off.end()});
}

Tissues brightnessOf(const std::vector<Trajectory>& paths, const MaskedImage& masked,
                     const LevelSet& inner, const geometry::MeshTopology& topology, double edge,
                     double voxel, SenseOf sense) {
  const Volume<float>& image = masked.image;
  const auto n = static_cast<Eigen::Index>(paths.size());
  Tissues found;
  found.grey = found.outside = found.covered = Eigen::VectorXd::Constant(n, kNaN);
  VertexRows white = deepWhite(paths, inner, image, voxel);
  found.noise = noiseOf(white.col(0).cwiseQuotient(white.col(1)), topology);
  white = averaged(std::move(white), topology, timesFor(kWhiteSpread * voxel, edge));
  found.white = white.col(0).cwiseQuotient(white.col(1));
  parallelFor(paths.size(), 256, [&](std::size_t v) {
    const Trajectory& path = paths[v];
    if (path.end == TrajectoryEnd::NoRibbon) return;
    double grey = 0;
    for (const double share : kGreyShares)
      grey += valueAt(image, along(path, share * path.length()));
    found.grey[static_cast<Eigen::Index>(v)] = grey / kGreyShares.size();
  });
  const auto beyond = [&](const Trajectory& path, int k) {
    return along(path, path.length() + kOutsideReach * voxel * k / (kOutsideSamples - 1));
  };
  std::vector<double> contrast(paths.size());
  parallelFor(paths.size(), 256, [&](std::size_t v) {
    const auto row = static_cast<Eigen::Index>(v);
    contrast[v] = sense == SenseOf::White
                      ? found.white[row] - found.grey[row]
                      : found.grey[row] - valueAt(image, beyond(paths[v], kOutsideSamples / 2));
  });
  found.sign = median(contrast) < 0 ? -1 : 1;
  parallelFor(paths.size(), 256, [&](std::size_t v) {
    const Trajectory& path = paths[v];
    if (path.end == TrajectoryEnd::NoRibbon) return;
    double least = kInfinity;  // vessels and meninges beside fluid must not hide it
    int seen = 0;
    for (int k = 0; k < kOutsideSamples; ++k) {
      const Point at = beyond(path, k);
      const double value = found.sign * valueAt(image, at);
      if (value < least) least = value;
      seen += masked.seenAt(at) > 0.5;
    }
    found.covered[static_cast<Eigen::Index>(v)] = seen / static_cast<double>(kOutsideSamples);
    found.outside[static_cast<Eigen::Index>(v)] = least < kInfinity ? found.sign * least : kNaN;
  });
  return found;
}

/// Of grey matter and pure fluid, as most vertices have it; 0 if fluid's brightness is not known.
double fluidContrast(const Tissues& tissues, double fluid) {
  if (!(fluid > 0)) return 0;
  const Eigen::VectorXd contrast = tissues.sign * (tissues.grey - fluid * tissues.white);
  return median({contrast.begin(), contrast.end()});
}

/// How far a border may go outward and inward on a trajectory, in places.
Choice choiceOn(const Trajectory& path, bool outer, double step) {
  if (path.end == TrajectoryEnd::NoRibbon) return {};
  const int inside =
      std::min(kSide, static_cast<int>(std::floor(kShortShare * path.length() / step)));
  if (!outer) return {0, kSide + inside};
  return {kSide - inside, path.end == TrajectoryEnd::Bank ? kSide + kBeyondBank : kPlaces - 1};
}

/// Brightness on both sides of a border, and of the border itself.
struct Edge {
  Eigen::VectorXd inside, outside, level;
  Eigen::VectorXd contrast;  ///< in which misses of the level count
  Eigen::VectorXd covered;   ///< share of the outside that the image shows
};

/// Half way between what is seen on both sides, or where `share` says.
Edge edgeBetween(const Eigen::VectorXd& inside, const Eigen::VectorXd& outside, double share) {
  return {inside, outside, outside + share * (inside - outside), (inside - outside).cwiseAbs(),
          Eigen::VectorXd::Ones(inside.size())};
}

/// The outer border beside fluid that may be too narrow to be seen as dark as it is: there the
/// slope is small against noise, too, so that misses count in the contrast that there would be.
/// Where a mask has cut fluid away, how dark it is seen says nothing, and the border lies half way
/// to pure fluid.
Edge edgeBesideFluid(const Eigen::VectorXd& grey, const Eigen::VectorXd& darkest,
                     const Eigen::VectorXd& fluid, const Eigen::VectorXd& covered) {
  Edge edge{grey, darkest, darkest, (grey - fluid).cwiseAbs(), covered};
  for (Eigen::Index v = 0; v < grey.size(); ++v) {
    const double depth = (grey[v] - darkest[v]) / (grey[v] - fluid[v]);
    if (!std::isfinite(depth)) continue;
    edge.level[v] += levelBesideFluid(depth) * (grey[v] - darkest[v]);
    edge.level[v] = covered[v] * edge.level[v] + (1 - covered[v]) * 0.5 * (grey[v] + fluid[v]);
  }
  return edge;
}

/// What is bright in fluid shows dura, bone and the flow in vessels dark: beyond half the
/// brightness of grey matter there is none.
double missOfDark(double value, double grey) {
  return (value - 0.5 * grey) / (0.5 * grey);
}

/// How far brightness is from the border's level at each place, in contrasts: positive inside.
/// The edge of the image's mask is a border, too, if brightness shows none before it.
std::vector<Profile> missesOf(const std::vector<Trajectory>& paths, bool outer,
                              const MaskedImage& masked, double step, double sign, const Edge& edge,
                              double flat) {
  std::vector<double> contrast(paths.size());
  for (std::size_t v = 0; v < paths.size(); ++v) {
    const auto row = static_cast<Eigen::Index>(v);
    contrast[v] = sign * (edge.inside[row] - edge.outside[row]);
  }
  const double least = flat * median(contrast);
  const bool darkIsOutside = outer && sign < 0;
  std::vector<Profile> profiles(paths.size());
  parallelFor(paths.size(), 256, [&](std::size_t v) {
    profiles[v].fill(static_cast<float>(kNaN));
    const auto row = static_cast<Eigen::Index>(v);
    const bool isFlat = !(contrast[v] > least) && edge.covered[row] > 0.5;
    if (isFlat && !darkIsOutside) return;
    const double border = outer ? paths[v].length() : 0;
    bool any = !isFlat;
    Profile found;
    const Along path(paths[v]);
    for (int k = 0; k < kPlaces; ++k) {
      const Point at = path.at(border + (k - kSide) * step);
      const double value = valueAt(masked.image, at);
      double miss = isFlat ? 1 : sign * (value - edge.level[row]) / edge.contrast[row];
      if (darkIsOutside) miss = std::min(miss, missOfDark(value, edge.inside[row]));
      any = any || miss < 0;
      const double within = outer ? 2 * masked.seenAt(at) - 1 : 1;
      // What is brighter than fluid up to the mask's edge is tissue, however little brighter.
      const bool cutOff = edge.covered[row] < 0.5 && miss > 0;
      found[k] = static_cast<float>(cutOff ? within : std::min(miss, within));
    }
    if (any) profiles[v] = found;
  });
  return profiles;
}

/// What an image says of one border.
struct Sight {
  std::vector<Profile> misses;  ///< of the border's level
  Eigen::VectorXd noise;        ///< of brightness, in the same contrasts
  Eigen::VectorXd covered;      ///< share of the outside that the image shows
};

/// An image, and the tissues that it shows along trajectories.
class Look {
 public:
  Look(const std::vector<Trajectory>& paths, const MaskedImage& masked, const LevelSet& inner,
       const geometry::MeshTopology& topology, double edge, double voxel, SenseOf sense)
      : paths_(paths),
        masked_(masked),
        topology_(topology),
        edge_(edge),
        voxel_(voxel),
        tissues_(brightnessOf(paths, masked, inner, topology, edge, voxel, sense)) {}

  [[nodiscard]] const Tissues& tissues() const { return tissues_; }

  /// @param fluid  brightness of pure fluid, of that of white matter; 0: not known
  [[nodiscard]] Sight at(bool outer, double fluid, double step,
                         const ImageBorderOptions& options) const {
    const EdgeOptions& chosen = optionsAt(outer, fluid, options);
    const Eigen::VectorXd inside = outer ? over(tissues_.grey, chosen.spread) : tissues_.white;
    const Eigen::VectorXd outside = over(outer ? tissues_.outside : tissues_.grey, chosen.spread);
    const Edge edge = outer && fluid > 0 ? edgeBesideFluid(inside, outside, fluid * tissues_.white,
                                                           over(tissues_.covered, chosen.spread))
                                         : edgeBetween(inside, outside, chosen.level);
    return {missesOf(paths_, outer, masked_, step, tissues_.sign, edge, options.flat),
            tissues_.noise * edge.contrast.cwiseInverse(), edge.covered};
  }

  static const EdgeOptions& optionsAt(bool outer, double fluid, const ImageBorderOptions& options) {
    return outer && fluid > 0 ? options.besideFluid : outer ? options.outer : options.white;
  }

 private:
  [[nodiscard]] Eigen::VectorXd over(const Eigen::VectorXd& values, double spread) const {
    return averaged(values, topology_, timesFor(spread * voxel_, edge_));
  }

  const std::vector<Trajectory>& paths_;
  const MaskedImage& masked_;
  const geometry::MeshTopology& topology_;
  double edge_, voxel_;
  Tissues tissues_;
};

/// Brightness of pure fluid in the second image, of that of its white matter: where fluid is so
/// wide that the first shows it pure.  0 where that is nowhere, or not known of the first.
double fluidInSecond(const Tissues& first, double fluid, const Tissues& second) {
  constexpr double kPure = 0.9;  // of the contrast
  if (!(fluid > 0)) return 0;
  std::vector<double> seen;
  for (Eigen::Index v = 0; v < first.grey.size(); ++v) {
    const double depth =
        (first.grey[v] - first.outside[v]) / (first.grey[v] - fluid * first.white[v]);
    if (depth >= kPure) seen.push_back(second.outside[v] / second.white[v]);
  }
  const double found = seen.empty() ? 0 : median(std::move(seen));
  return std::isfinite(found) ? found : 0;
}

/// How far brightness falls outward along a profile, contrasts.
float fallOf(const Profile& misses) {
  float highest = misses[0], fall = 0;
  for (const float miss : misses) {
    highest = std::max(highest, miss);
    fall = std::max(fall, highest - miss);
  }
  return fall;
}

/// Two sights of one border as one: means by the inverse of the variances of its place, which are
/// those of noise over the square of the slope, and by how much of the outside each shows.
Sight meanOf(Sight first, const Sight& second) {
  static constexpr double kLeastNoise = 1e-6;  // contrasts: images without any have equal weights
  const auto weightOf = [](const Sight& sight, std::size_t v) {
    const auto row = static_cast<Eigen::Index>(v);
    const double slope = fallOf(sight.misses[v]) / std::max(sight.noise[row], kLeastNoise);
    const double weight = sight.covered[row] * slope * slope;
    return std::isfinite(weight) && std::isfinite(sight.misses[v][kSide]) ? weight : 0;
  };
  parallelFor(first.misses.size(), 1024, [&](std::size_t v) {
    const auto row = static_cast<Eigen::Index>(v);
    const double one = weightOf(first, v), two = weightOf(second, v);
    if (!(two > 0)) return;
    const auto share = static_cast<float>(two / (one + two));
    for (int k = 0; k < kPlaces; ++k) {
      const float own = first.misses[v][k], other = second.misses[v][k];
      first.misses[v][k] = one > 0 ? own + share * (other - own) : other;
    }
    first.noise[row] = one > 0
                           ? std::hypot((1 - share) * first.noise[row], share * second.noise[row])
                           : second.noise[row];
    first.covered[row] = std::max(first.covered[row], second.covered[row]);
  });
  return first;
}

/// Standard deviations of the chosen places, mm.
Eigen::VectorXd doubtOf(const std::vector<Trajectory>& paths, bool outer, double voxel,
                        const Eigen::VectorXd& ways, const Eigen::VectorXd& deviations,
                        const Eigen::VectorXd& covered) {
  const double usual = usualLength(paths);
  Eigen::VectorXd doubt = Eigen::VectorXd::Zero(ways.size());
  for (Eigen::Index v = 0; v < ways.size(); ++v) {
    if (paths[v].end == TrajectoryEnd::NoRibbon) continue;
    const bool isThin = paths[v].length() + ways[v] < kThinShare * usual;
    const double unseen = (1 - covered[v]) * (isThin ? 1 : kUniform) * voxel;
    const bool isMiddle = outer && paths[v].end == TrajectoryEnd::Bank;
    const double most = (isMiddle ? kMiddleKnown : 1) * voxel;
    doubt[v] = std::min(most, std::hypot(deviations[v], unseen));
  }
  return doubt;
}

}  // namespace

ImageBorders findBorders(const std::vector<Trajectory>& given, const TriangleMesh& white,
                         const LevelSet& inner, const BorderImages& images, double voxel,
                         const ImageBorderOptions& options) {
  const MaskedImage masked = beyondMask(images.image, kBeyondMask * voxel);
  const auto topology = geometry::buildTopology(white.faces, white.vertexCount());
  const double step = options.reach * voxel / kSide;
  const double edge = geometry::meanEdgeLength(white);
  ImageBorders borders;
  borders.white = borders.outer = Eigen::VectorXd::Zero(white.vertexCount());
  borders.doubt = borders.missing = Eigen::MatrixXd::Zero(white.vertexCount(), 2);
  std::vector<Trajectory> paths = given;
  if (options.search) {
    borders.white = searchWhite(given, topology, edge, masked, voxel);
    parallelFor(paths.size(), 256, [&](std::size_t v) {
      if (paths[v].end == TrajectoryEnd::NoRibbon) return;
      paths[v] = between(given[v], borders.white[static_cast<Eigen::Index>(v)], given[v].length());
    });
    const Tissues tissues =
        brightnessOf(paths, masked, inner, topology, edge, voxel, SenseOf::White);
    borders.outer = searchOuter(paths, topology, edge, masked, voxel, tissues.sign,
                                fluidContrast(tissues, options.fluid));
    for (std::size_t v = 0; v < paths.size(); ++v) {
      const double way = borders.outer[static_cast<Eigen::Index>(v)];
      if (way == 0) continue;
      paths[v] = between(paths[v], 0, paths[v].length() + way);
      paths[v].end = TrajectoryEnd::Outer;
    }
  }
  const Look look(paths, masked, inner, topology, edge, voxel, SenseOf::White);
  for (const bool outer : {false, true}) {
    Sight sight = look.at(outer, options.fluid, step, options);
    if (outer && images.second) {
      const MaskedImage second = beyondMask(*images.second, kBeyondMask * voxel);
      const Look other(paths, second, inner, topology, edge, voxel, SenseOf::Outer);
      const double fluid = fluidInSecond(look.tissues(), options.fluid, other.tissues());
      sight = meanOf(std::move(sight), other.at(outer, fluid, step, options));
    }
    std::vector<Choice> choices(paths.size());
    for (std::size_t v = 0; v < paths.size(); ++v) choices[v] = choiceOn(paths[v], outer, step);
    const BorderChooser chooser(std::move(sight.misses), std::move(choices), topology, step, voxel,
                                Look::optionsAt(outer, options.fluid, options).costs);
    const Eigen::VectorXd ways = chooser.choose(options.rounds);
    borders.doubt.col(outer ? 1 : 0) = doubtOf(
        paths, outer, voxel, ways, chooser.deviations(ways, sight.noise, voxel), sight.covered);
    (outer ? borders.outer : borders.white) += ways;
    borders.missing.col(outer ? 1 : 0) = chooser.missing();
  }
  return borders;
}

}  // namespace explica::surface
