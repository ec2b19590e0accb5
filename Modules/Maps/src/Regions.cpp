// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Maps/Regions.h"

#include "Explica/Core/Errors.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>

namespace explica::maps {
namespace {

/// Place of each vertex's region in the list of regions, or -1.
std::vector<std::ptrdiff_t> placesOf(std::span<const Label> keys, std::span<const Label> regions) {
  std::map<Label, std::ptrdiff_t> place;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    place.try_emplace(regions[r], static_cast<std::ptrdiff_t>(r));
  }
  std::vector<std::ptrdiff_t> places(keys.size(), -1);
  for (std::size_t v = 0; v < keys.size(); ++v) {
    if (const auto at = place.find(keys[v]); at != place.end()) places[v] = at->second;
  }
  return places;
}

}  // namespace

Eigen::VectorXd vertexVolumes(const TriangleMesh& white, const TriangleMesh& pial) {
  if (white.faces.rows() != pial.faces.rows() || white.faces != pial.faces ||
      white.vertexCount() != pial.vertexCount()) {
    throw InvalidInput("white and pial surface have different faces");
  }
  Eigen::VectorXd volumes = Eigen::VectorXd::Zero(white.vertexCount());
  for (Eigen::Index f = 0; f < white.faceCount(); ++f) {
    // Diagonals go from the white corner of the smaller number to the pial one of the larger.
    Eigen::RowVector3i face = white.faces.row(f);
    std::sort(face.data(), face.data() + 3);
    const bool turned = (white.faces.row(f).array() == face.array()).count() == 1;
    const auto w = [&](int k) -> Point { return white.positions.row(face[k]).transpose(); };
    const auto p = [&](int k) -> Point { return pial.positions.row(face[k]).transpose(); };
    const double sixfold = (w(1) - w(0)).cross(w(2) - w(0)).dot(p(2) - w(0)) +
                           (w(1) - w(0)).cross(p(2) - w(0)).dot(p(1) - w(0)) +
                           (p(1) - w(0)).cross(p(2) - w(0)).dot(p(0) - w(0));
    for (int k = 0; k < 3; ++k) volumes[face[k]] += (turned ? -sixfold : sixfold) / 18;
  }
  return volumes;
}

std::vector<RegionMoments> regionMoments(std::span<const Label> keys, const Eigen::VectorXd& values,
                                         const Eigen::VectorXd& areas,
                                         std::span<const Label> regions) {
  std::vector<RegionMoments> moments(regions.size());
  std::vector<double> area(regions.size()), weighted(regions.size()), squares(regions.size()),
      weightedSquares(regions.size());
  const auto places = placesOf(keys, regions);
  const auto forKnown = [&](const auto& visit) {
    for (std::size_t v = 0; v < places.size(); ++v) {
      const auto row = static_cast<Eigen::Index>(v);
      if (places[v] >= 0 && std::isfinite(values[row])) visit(places[v], values[row], areas[row]);
    }
  };
  forKnown([&](std::size_t r, double value, double vertexArea) {
    ++moments[r].count;
    moments[r].sum += value;
    area[r] += vertexArea;
    weighted[r] += vertexArea * value;
  });
  for (std::size_t r = 0; r < regions.size(); ++r) {
    if (moments[r].count > 0)
      moments[r].mean = moments[r].sum / static_cast<double>(moments[r].count);
    if (area[r] > 0) moments[r].meanOverArea = weighted[r] / area[r];
  }
  forKnown([&](std::size_t r, double value, double vertexArea) {
    const double from = value - moments[r].mean, fromWeighted = value - moments[r].meanOverArea;
    squares[r] += from * from;
    weightedSquares[r] += vertexArea * fromWeighted * fromWeighted;
  });
  for (std::size_t r = 0; r < regions.size(); ++r) {
    if (moments[r].count == 0) continue;
    moments[r].deviation = std::sqrt(squares[r] / static_cast<double>(moments[r].count));
    moments[r].deviationOverArea = std::sqrt(weightedSquares[r] / area[r]);
  }
  return moments;
}

}  // namespace explica::maps
