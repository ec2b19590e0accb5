// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/Comparison.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/Geodesic.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/Predicates.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace explica::flattening {
namespace {

/// Draws indices with probabilities proportional to weights.
class Lottery {
 public:
  explicit Lottery(const Eigen::VectorXd& weights) : sums_(weights.begin(), weights.end()) {
    std::partial_sum(sums_.begin(), sums_.end(), sums_.begin());
  }
  [[nodiscard]] std::int32_t draw(std::mt19937_64& random) const {
    // 53 bits by hand: the standard's distributions differ between libraries.
    const double u = static_cast<double>(random() >> 11) * 0x1p-53 * sums_.back();
    const auto at = std::ranges::upper_bound(sums_, u);
    return static_cast<std::int32_t>(std::min<std::ptrdiff_t>(
        at - sums_.begin(), static_cast<std::ptrdiff_t>(sums_.size()) - 1));
  }

 private:
  std::vector<double> sums_;
};

/// The s that makes the sum of |s r_i - 1| least: a weighted median of 1 / r_i with weights r_i.
double bestScale(const std::vector<double>& ratios) {
  std::vector<double> sorted = ratios;
  std::ranges::sort(sorted, std::greater<>());
  const double half = std::accumulate(sorted.begin(), sorted.end(), 0.0) / 2;
  double sum = 0;
  for (const double r : sorted) {
    sum += r;
    if (sum >= half) return 1 / r;
  }
  return 1;
}

struct Drawn {
  std::vector<DistancePairs::Pair> local, all;
};

Drawn drawFrom(std::int32_t source, const geometry::SubMesh& part,
               const geometry::MeshTopology& topology, const Eigen::VectorXd& areas,
               const Lottery& anywhere, std::size_t count, const DistanceOptions& options, bool far,
               std::uint64_t seed) {
  const std::array<std::int32_t, 1> sources = {source};
  const Eigen::VectorXd d = geometry::geodesicDistances(part.mesh, topology, sources,
                                                        far ? kInfinity : options.localLimit);
  Eigen::VectorXd near = areas;
  for (Eigen::Index v = 0; v < d.size(); ++v) {
    if (!(d[v] <= options.localLimit) || v == source) near[v] = 0;
  }
  std::mt19937_64 random(seed);
  Drawn drawn;
  const auto add = [&](std::vector<DistancePairs::Pair>& list, std::int32_t to) {
    if (to == source || !std::isfinite(d[to]) || !(d[to] > 0)) return;
    list.push_back({part.vertexOrigin[source], part.vertexOrigin[to], d[to]});
  };
  for (std::size_t n = 0; far && n < count; ++n) add(drawn.all, anywhere.draw(random));
  if (near.sum() > 0) {
    const Lottery nearby(near);
    for (std::size_t n = 0; n < count; ++n) add(drawn.local, nearby.draw(random));
  }
  return drawn;
}

}  // namespace

DistancePairs drawPairs(const TriangleMesh& reference, std::span<const std::int32_t> faces,
                        const DistanceOptions& options) {
  if (options.pairs < 0 || options.sources < 1 || !(options.localLimit > 0)) {
    throw InvalidInput("pairs: needs pairs >= 0, sources >= 1 and a limit above 0 mm");
  }
  DistancePairs pairs;
  if (options.pairs == 0) return pairs;
  const geometry::SubMesh part = geometry::extractFaces(reference, faces);
  const auto topology = geometry::buildTopology(part.mesh.faces, part.mesh.vertexCount());
  const Eigen::VectorXd areas = geometry::vertexAreas(part.mesh);
  const Lottery anywhere(areas);
  std::mt19937_64 random(options.seed);
  const int count = std::min(options.sources, options.pairs);
  std::vector<std::int32_t> sources;
  for (int n = 0; n < count; ++n) sources.push_back(anywhere.draw(random));
  std::vector<Drawn> drawn(sources.size());
  const auto each = static_cast<std::size_t>(options.pairs / count);
  parallelFor(sources.size(), 1, [&](std::size_t n) {
    drawn[n] = drawFrom(sources[n], part, topology, areas, anywhere, each, options,
                        static_cast<int>(n) < options.farSources, options.seed + 1000003 * (n + 1));
  });
  for (const Drawn& d : drawn) {
    pairs.local.insert(pairs.local.end(), d.local.begin(), d.local.end());
    pairs.all.insert(pairs.all.end(), d.all.begin(), d.all.end());
  }
  return pairs;
}

DistanceError distanceError(const std::vector<DistancePairs::Pair>& pairs,
                            const TriangleMesh& deformed, std::span<const std::int32_t> faces,
                            DistanceKind kind) {
  std::vector<double> ratios(pairs.size(), kNaN);
  if (kind == DistanceKind::Straight) {
    for (std::size_t n = 0; n < pairs.size(); ++n) {
      const auto apart =
          deformed.positions.row(pairs[n].from) - deformed.positions.row(pairs[n].to);
      ratios[n] = apart.norm() / pairs[n].distance;
    }
  } else {
    const geometry::SubMesh part = geometry::extractFaces(deformed, faces);
    const auto topology = geometry::buildTopology(part.mesh.faces, part.mesh.vertexCount());
    std::vector<std::int32_t> number(static_cast<std::size_t>(deformed.vertexCount()), -1);
    for (std::size_t n = 0; n < part.vertexOrigin.size(); ++n) {
      number[part.vertexOrigin[n]] = static_cast<std::int32_t>(n);
    }
    std::vector<std::size_t> begin;  // pairs of one source stand together
    for (std::size_t n = 0; n < pairs.size(); ++n) {
      if (n == 0 || pairs[n].from != pairs[n - 1].from) begin.push_back(n);
    }
    begin.push_back(pairs.size());
    parallelFor(begin.size() - 1, 1, [&](std::size_t group) {
      const std::array<std::int32_t, 1> source = {number[pairs[begin[group]].from]};
      const Eigen::VectorXd d = geometry::geodesicDistances(part.mesh, topology, source);
      for (std::size_t n = begin[group]; n < begin[group + 1]; ++n) {
        ratios[n] = d[number[pairs[n].to]] / pairs[n].distance;
      }
    });
  }
  std::erase_if(ratios, [](double r) { return !std::isfinite(r); });
  DistanceError result{.pairs = ratios.size()};
  if (ratios.empty()) return result;
  result.scale = bestScale(ratios);
  double sum = 0;
  for (const double r : ratios) sum += std::abs(result.scale * r - 1);
  result.error = sum / static_cast<double>(ratios.size());
  return result;
}

bool isFlatMap(const TriangleMesh& mesh, std::span<const std::int32_t> faces) {
  const double z = mesh.corner(faces.front(), 0).z();
  return std::ranges::all_of(faces, [&](std::int32_t f) {
    return mesh.corner(f, 0).z() == z && mesh.corner(f, 1).z() == z && mesh.corner(f, 2).z() == z;
  });
}

std::int64_t turnedOver(const TriangleMesh& mesh, std::span<const std::int32_t> faces) {
  if (isFlatMap(mesh, faces)) {
    std::int64_t positive = 0, negative = 0, none = 0;
    const auto plane = [&](std::int32_t v) {
      return Eigen::Vector2d(mesh.positions(v, 0), mesh.positions(v, 1));
    };
    for (const std::int32_t f : faces) {
      const int sign = geometry::orientation(plane(mesh.faces(f, 0)), plane(mesh.faces(f, 1)),
                                             plane(mesh.faces(f, 2)));
      (sign > 0 ? positive : sign < 0 ? negative : none) += 1;
    }
    return std::min(positive, negative) + none;
  }
  const geometry::SubMesh part = geometry::extractFaces(mesh, faces);
  const Positions normals = geometry::faceNormalVectors(part.mesh);
  const Positions around = geometry::vertexNormals(part.mesh);
  std::int64_t count = 0;
  for (Eigen::Index f = 0; f < part.mesh.faceCount(); ++f) {
    Vector mean = Vector::Zero();
    for (int k = 0; k < 3; ++k) mean += around.row(part.mesh.faces(f, k)).transpose();
    count += normals.row(f).dot(mean) <= 0;
  }
  return count;
}

}  // namespace explica::flattening
