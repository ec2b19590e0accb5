// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sampling/Depth.h"

#include "Explica/Geometry/MeshMeasures.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>

namespace explica::sampling {
namespace {

constexpr int kMostDepths = 1000;  // between two surfaces

std::string shown(std::string_view text) {
  return "depths: '" + std::string(text.substr(0, 40)) + "'";
}

std::optional<int> wholeNumber(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return {};
  return value;
}

}  // namespace

std::vector<double> depthsFromText(std::string_view text) {
  std::vector<double> depths;
  if (const std::optional<int> count = wholeNumber(text); count && *count != 0) {
    if (*count < 1 || *count > kMostDepths) {
      throw InvalidInput(shown(text) + " must be a number of depths from 1 to 1000");
    }
    if (*count == 1) return {0.5};
    for (int i = 0; i < *count; ++i) depths.push_back(static_cast<double>(i) / (*count - 1));
    return depths;
  }
  while (true) {
    const std::string_view word = text.substr(0, text.find(','));
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || error != std::errc{} || end != word.data() + word.size() ||
        !(value >= 0 && value <= 1)) {
      throw InvalidInput(shown(word) +
                         " is neither a number of depths nor a depth from 0 (white) to 1 (pial)");
    }
    if (std::ranges::find(depths, value) != depths.end()) {
      throw InvalidInput(shown(word) + " is there twice");
    }
    depths.push_back(value);
    if (depths.size() > kMostDepths) throw InvalidInput("depths: there are more than 1000");
    if (word.size() == text.size()) return depths;
    text.remove_prefix(word.size() + 1);
  }
}

Eigen::VectorXd shareOfWay(const Eigen::VectorXd& whiteAreas, const Eigen::VectorXd& pialAreas,
                           double depth, DepthKind kind) {
  Eigen::VectorXd share = Eigen::VectorXd::Constant(whiteAreas.size(), depth);
  if (kind == DepthKind::Depth) return share;
  constexpr double kAlike =
      1e-6;  // relative difference of areas below which the column is straight
  for (Eigen::Index v = 0; v < share.size(); ++v) {
    const double a = whiteAreas[v], b = pialAreas[v];
    if (!(std::abs(b - a) > kAlike * (a + b))) continue;
    share[v] = (std::sqrt((1 - depth) * a * a + depth * b * b) - a) / (b - a);
  }
  return share;
}

void requireCorresponding(const TriangleMesh& white, const TriangleMesh& pial) {
  if (white.vertexCount() != pial.vertexCount()) {
    throw InvalidInput("white and pial: they have " + std::to_string(white.vertexCount()) +
                       " and " + std::to_string(pial.vertexCount()) +
                       " vertices; surfaces of one run, with corresponding vertices, are needed");
  }
  if (white.faceCount() != pial.faceCount() || white.faces != pial.faces) {
    throw InvalidInput(
        "white and pial: their faces differ, so that their vertices do not correspond; surfaces of "
        "one run are needed");
  }
}

Positions positionsAtDepth(const TriangleMesh& white, const TriangleMesh& pial, double depth,
                           DepthKind kind) {
  requireCorresponding(white, pial);
  Eigen::VectorXd share = Eigen::VectorXd::Constant(white.vertexCount(), depth);
  if (kind == DepthKind::Volume) {
    share = shareOfWay(geometry::vertexAreas(white), geometry::vertexAreas(pial), depth, kind);
  }
  return ((1 - share.array()).matrix().asDiagonal() * white.positions +
          share.asDiagonal() * pial.positions)
      .eval();
}

Positions positionsAtDepths(const TriangleMesh& white, const TriangleMesh& pial,
                            const std::vector<double>& depths, DepthKind kind) {
  const Eigen::Index count = white.vertexCount();
  Positions points(static_cast<Eigen::Index>(depths.size()) * count, 3);
  for (std::size_t d = 0; d < depths.size(); ++d) {
    points.middleRows(static_cast<Eigen::Index>(d) * count, count) =
        positionsAtDepth(white, pial, depths[d], kind);
  }
  return points;
}

}  // namespace explica::sampling
