// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/PatchTable.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"

#include <array>
#include <cmath>
#include <set>

namespace explica::flattening {
namespace {

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

/// A patch's measures, for a row each.
class Rows {
 public:
  Rows(const TriangleMesh& reference, const Positions& flat, const std::vector<PatchMap>& maps)
      : reference_(reference),
        maps_(maps),
        weights_(geometry::vertexAreas(reference)),
        areas_(geometry::faceAreas(reference)),
        flatAreas_(geometry::faceAreas({flat, reference.faces})) {}

  /// The row of the vertices that `take` accepts.
  template <class Take>
  [[nodiscard]] std::string row(const std::string& name, const std::string& key,
                                const Take& take) const {
    std::int64_t vertices = 0, faces = 0;
    double area = 0, flatArea = 0;
    for (Eigen::Index v = 0; v < reference_.vertexCount(); ++v) vertices += take(v);
    for (Eigen::Index f = 0; f < reference_.faceCount(); ++f) {
      const auto& face = reference_.faces.row(f);
      if (!take(face[0]) || !take(face[1]) || !take(face[2])) continue;
      ++faces;
      area += areas_[f];
      flatArea += flatAreas_[f];
    }
    std::string text = name + "\t" + key + "\t" + std::to_string(vertices) + "\t" +
                       std::to_string(faces) + "\t" + cellText(area) + "\t" + cellText(flatArea);
    for (const PatchMap& map : maps_) {
      const Moments moments = momentsOf(map.values, weights_, take);
      text += "\t" + cellText(moments.mean) + "\t" + cellText(moments.deviation);
    }
    return text + "\n";
  }

 private:
  const TriangleMesh& reference_;
  const std::vector<PatchMap>& maps_;
  Eigen::VectorXd weights_, areas_, flatAreas_;
};

}  // namespace

std::string patchTable(const TriangleMesh& reference, const Positions& flat,
                       const std::vector<PatchRegions>& regions,
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
  const Rows rows(reference, flat, maps);
  text += rows.row("all", "n/a", [](Eigen::Index) { return true; });
  for (const PatchRegions& one : regions) {
    const std::set<Label> keys(one.keys.begin(), one.keys.end());
    for (const Label key : keys) {
      const auto name = one.names.find(key);
      if (name == one.names.end()) continue;
      text += rows.row(name->second, std::to_string(key),
                       [&](Eigen::Index v) { return one.keys[v] == key; });
    }
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
    const std::array<Label, 3> keys = {regions[faces(f, 0)], regions[faces(f, 1)],
                                       regions[faces(f, 2)]};
    const std::array<Point, 3> corners = {at(faces(f, 0)), at(faces(f, 1)), at(faces(f, 2))};
    if (keys[0] != keys[1] && keys[1] != keys[2] && keys[2] != keys[0]) {
      const Point middle = (corners[0] + corners[1] + corners[2]) / 3;
      for (int k = 0; k < 3; ++k) {  // from the middle out, the edge's first corner lies right
        const int next = (k + 1) % 3;
        pieces.push_back({middle, (corners[k] + corners[next]) / 2, {keys[next], keys[k]}});
      }
      continue;
    }
    for (int k = 0; k < 3; ++k) {  // the corner that is alone, if there is one
      const int next = (k + 1) % 3, last = (k + 2) % 3;
      if (keys[k] == keys[next] || keys[k] == keys[last]) continue;
      pieces.push_back({(corners[k] + corners[next]) / 2,
                        (corners[k] + corners[last]) / 2,
                        {keys[k], keys[next]}});
    }
  }
  return pieces;
}

}  // namespace explica::flattening
