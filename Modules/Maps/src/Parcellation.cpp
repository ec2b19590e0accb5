// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Maps/Parcellation.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Maps/Smoothing.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace explica::maps {
namespace {

/// Width of the surroundings in which foldings are compared, over the sphere's radius: 20 mm on a
/// sphere of 100 mm, about the distance of neighbouring sulci.
constexpr double kSurroundings = 0.2;
constexpr double kLeastDifference = 0.01;  // of two maps of variance 1: noise of the maps

Eigen::VectorXd standardised(const Eigen::VectorXd& values) {
  const Eigen::VectorXd centred = values.array() - values.mean();
  return centred / std::sqrt(centred.squaredNorm() / static_cast<double>(values.size()));
}

/// Weight of an atlas' vote at each vertex.
Eigen::VectorXd agreement(const TriangleMesh& sphere, const Eigen::VectorXd& folding,
                          const Eigen::VectorXd& other) {
  const Eigen::VectorXd difference = (standardised(folding) - standardised(other)).cwiseAbs2();
  const double radius = sphere.positions.rowwise().norm().mean();
  const Eigen::VectorXd around = smoothMaps(sphere, difference, kSurroundings * radius);
  return around.cwiseMax(kLeastDifference).cwiseInverse();
}

}  // namespace

Parcellation parcellate(const TriangleMesh& sphere, const Eigen::VectorXd& folding,
                        const std::vector<LabelledSphere>& atlases) {
  if (atlases.empty()) throw InvalidInput("no labelled surface is given");
  const bool weigh = atlases.size() > 1 && folding.size() == sphere.vertexCount() &&
                     std::ranges::all_of(atlases, [](const LabelledSphere& atlas) {
                       return atlas.folding.size() == atlas.sphere.vertexCount();
                     });
  std::vector<std::map<Label, double>> votes(static_cast<std::size_t>(sphere.vertexCount()));
  for (const LabelledSphere& atlas : atlases) {
    if (atlas.keys.size() != atlas.sphere.vertexCount()) {
      throw InvalidInput("an atlas has " + std::to_string(atlas.keys.size()) +
                         " labels, its sphere " + std::to_string(atlas.sphere.vertexCount()) +
                         " vertices");
    }
    const ResamplingWeights weights =
        resamplingWeights(atlas.sphere, sphere, ResamplingMethod::Adaptive,
                          geometry::vertexAreas(atlas.sphere), geometry::vertexAreas(sphere));
    Eigen::VectorXd say = Eigen::VectorXd::Ones(sphere.vertexCount());
    if (weigh) say = agreement(sphere, folding, resampleMaps(weights, atlas.folding));
    for (Eigen::Index v = 0; v < weights.rows(); ++v) {
      for (ResamplingWeights::InnerIterator it(weights, v); it; ++it) {
        votes[v][atlas.keys[it.index()]] += say[v] * it.value();
      }
    }
  }
  Parcellation result{VertexKeys(sphere.vertexCount()), Eigen::VectorXd(sphere.vertexCount())};
  for (Eigen::Index v = 0; v < sphere.vertexCount(); ++v) {
    double all = 0, most = -1;
    for (const auto& [key, share] : votes[v]) {
      all += share;
      if (share > most) result.keys[v] = key, most = share;
    }
    result.doubt[v] = std::max(0.0, 1 - most / all);
  }
  return result;
}

}  // namespace explica::maps
