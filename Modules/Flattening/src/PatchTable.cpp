// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/PatchTable.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>

namespace explica::flattening {
namespace {

std::string numberText(double value) {
  if (!std::isfinite(value)) return "n/a";
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

struct Moments {
  double mean = kNaN, deviation = kNaN;
};

/// Of the vertices that `take` accepts, by weight.
template <class Take>
Moments momentsOf(const Eigen::VectorXd& values, const Eigen::VectorXd& weights, const Take& take) {
  double weight = 0, sum = 0, squares = 0;
  const auto every = [&](const auto& add) {
    for (Eigen::Index v = 0; v < values.size(); ++v) {
      if (take(v) && std::isfinite(values[v])) add(v);
    }
  };
  every([&](Eigen::Index v) {
    weight += weights[v];
    sum += weights[v] * values[v];
  });
  if (!(weight > 0)) return {};
  const double mean = sum / weight;
  every([&](Eigen::Index v) { squares += weights[v] * (values[v] - mean) * (values[v] - mean); });
  return {mean, std::sqrt(squares / weight)};
}

}  // namespace

std::string patchTable(const TriangleMesh& reference, const Positions& flat,
                       const VertexKeys& regions, const std::map<Label, std::string>& names,
                       const std::vector<PatchMap>& maps) {
  std::string text = "region\tkey\tvertices\tfaces\tarea_mm2\tarea_flat_mm2";
  for (const PatchMap& map : maps) {
    if (map.values.size() != reference.vertexCount()) {
      throw InvalidInput("map '" + map.name + "': has " + std::to_string(map.values.size()) +
                         " values for " + std::to_string(reference.vertexCount()) + " vertices");
    }
    text += "\t" + map.name + "_mean\t" + map.name + "_sd";
  }
  text += "\n";
  const Eigen::VectorXd weights = geometry::vertexAreas(reference);
  const Eigen::VectorXd areas = geometry::faceAreas(reference);
  const Eigen::VectorXd flatAreas = geometry::faceAreas({flat, reference.faces});
  std::vector<std::optional<Label>> rows = {std::nullopt};
  const std::set<Label> keys(regions.begin(), regions.end());
  for (const Label key : keys) {
    if (key != 0) rows.emplace_back(key);
  }
  for (const auto& key : rows) {
    const auto take = [&](Eigen::Index v) { return !key || regions[v] == *key; };
    std::int64_t vertices = 0, faces = 0;
    double area = 0, flatArea = 0;
    for (Eigen::Index v = 0; v < reference.vertexCount(); ++v) vertices += take(v);
    for (Eigen::Index f = 0; f < reference.faceCount(); ++f) {
      if (!take(reference.faces(f, 0)) || !take(reference.faces(f, 1)) ||
          !take(reference.faces(f, 2))) {
        continue;
      }
      ++faces;
      area += areas[f];
      flatArea += flatAreas[f];
    }
    const auto name = key ? names.find(*key) : names.end();
    text += !key ? "all" : name == names.end() ? std::to_string(*key) : name->second;
    text += "\t" + (key ? std::to_string(*key) : std::string("n/a")) + "\t" +
            std::to_string(vertices) + "\t" + std::to_string(faces) + "\t" + numberText(area) +
            "\t" + numberText(flatArea);
    for (const PatchMap& map : maps) {
      const Moments moments = momentsOf(map.values, weights, take);
      text += "\t" + numberText(moments.mean) + "\t" + numberText(moments.deviation);
    }
    text += "\n";
  }
  return text;
}

std::map<Label, Point> regionPlaces(const TriangleMesh& mesh, const VertexKeys& regions) {
  const auto topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
  std::vector<std::int32_t> front, ring(static_cast<std::size_t>(mesh.vertexCount()), -1);
  const auto reach = [&](std::int32_t v, std::int32_t distance) {
    if (ring[v] >= 0) return;
    ring[v] = distance;
    front.push_back(v);
  };
  for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
    const std::int32_t a = topology.edges(e, 0), b = topology.edges(e, 1);
    if (regions[a] == regions[b] && topology.edgeFaces(e, 1) >= 0) continue;
    reach(a, 0);
    reach(b, 0);
  }
  for (std::size_t n = 0; n < front.size(); ++n) {
    for (const std::int32_t v : topology.vertexVertices[front[n]]) reach(v, ring[front[n]] + 1);
  }
  std::map<Label, Point> places;
  // The last of a region that the rings reach lies deepest in it.
  for (const std::int32_t v : front) places[regions[v]] = mesh.positions.row(v).transpose();
  return places;
}

std::vector<OutlinePiece> outlines(const Faces& faces, const Positions& positions,
                                   const VertexKeys& regions) {
  std::vector<OutlinePiece> pieces;
  const auto at = [&](std::int32_t v) -> Point { return positions.row(v).transpose(); };
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    std::vector<std::pair<Point, std::array<Label, 2>>> crossings;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = faces(f, k), b = faces(f, (k + 1) % 3);
      if (regions[a] == regions[b]) continue;
      crossings.push_back({(at(a) + at(b)) / 2,
                           {std::min(regions[a], regions[b]), std::max(regions[a], regions[b])}});
    }
    if (crossings.size() == 2) {
      pieces.push_back({crossings[0].first, crossings[1].first, crossings[0].second});
    } else if (crossings.size() == 3) {
      const Point middle = (at(faces(f, 0)) + at(faces(f, 1)) + at(faces(f, 2))) / 3;
      for (const auto& [point, sides] : crossings) pieces.push_back({point, middle, sides});
    }
  }
  return pieces;
}

}  // namespace explica::flattening
