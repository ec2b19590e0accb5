// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Flattening/Cuts.h"
#include "Explica/Geometry/MeshTopology.h"
#include "FoldWays.h"

namespace explica::flattening {
namespace {

constexpr Label kWall = 1;

/// Vertices of a key, those next to the wall or an earlier cut first, then outwards from them.
std::vector<std::int32_t> inOrder(const geometry::IndexLists& around, const VertexKeys& keys,
                                  Label key) {
  std::vector<std::int32_t> order;
  std::vector<bool> taken(static_cast<std::size_t>(keys.size()), false);
  for (std::int32_t v = 0; v < keys.size(); ++v) {
    if (keys[v] != key) continue;
    for (const std::int32_t u : around[v]) {
      if (keys[u] >= kWall && keys[u] < key) taken[v] = true;
    }
    if (taken[v]) order.push_back(v);
  }
  for (std::size_t n = 0; n < order.size(); ++n) {
    for (const std::int32_t u : around[order[n]]) {
      if (keys[u] != key || taken[u]) continue;
      taken[u] = true;
      order.push_back(u);
    }
  }
  return order;
}

/// Mean edge of the disc on the sphere.
double spacingOf(const Faces& faces, const Positions& places) {
  double sum = 0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    sum += (places.row(faces(f, 0)) - places.row(faces(f, 1))).norm();
  }
  return sum / static_cast<double>(faces.rows());
}

/// Minus the distance of each vertex from a line, over `unit`.
Eigen::VectorXd nearness(const Positions& places, const Positions& line, double unit) {
  Eigen::VectorXd near(places.rows());
  for (Eigen::Index v = 0; v < places.rows(); ++v) {
    near[v] = -(line.rowwise() - places.row(v)).rowwise().norm().minCoeff() / unit;
  }
  return near;
}

}  // namespace

std::vector<CutLine> cutLines(const TriangleMesh& sphere, const VertexKeys& keys,
                              const std::map<Label, std::string>& names) {
  const auto around = geometry::buildTopology(sphere.faces, sphere.vertexCount()).vertexVertices;
  std::vector<CutLine> lines;
  for (const auto& [key, name] : names) {
    if (key <= kWall) continue;
    const auto order = inOrder(around, keys, key);
    if (order.empty()) {
      throw InvalidInput("cut '" + name + "' touches neither the medial wall nor an earlier cut");
    }
    lines.push_back({name, sphere.positions(order, Eigen::all)});
  }
  return lines;
}

CutPlan cutsAlong(const Disc& disc, const Positions& places, const std::vector<CutLine>& lines,
                  const Eigen::VectorXd& depth) {
  const IntrinsicDisc fine = intrinsicDisc(disc);
  const std::vector<bool> barred = besideHoles(disc, fine.mesh.vertexCount);
  const auto onAll = [&](const Eigen::VectorXd& values) {
    Eigen::VectorXd all = Eigen::VectorXd::Zero(fine.mesh.vertexCount);
    all.head(values.size()) = values;
    return all;
  };
  const FoldWays folds(fine.mesh, onAll(depth), barred);
  const double spacing = spacingOf(disc.mesh.faces, places);
  std::vector<std::int32_t> starts = disc.rim;
  CutPlan plan;
  for (const CutLine& line : lines) {
    Eigen::Index end = 0;
    (places.rowwise() - line.points.row(line.points.rows() - 1))
        .rowwise()
        .squaredNorm()
        .minCoeff(&end);
    const FoldWays ways(fine.mesh, onAll(nearness(places, line.points, spacing)), barred);
    Cut cut;
    cut.path = ways.to(static_cast<std::int32_t>(end), starts);
    if (cut.path.size() < 2) continue;
    cut.length = folds.lengthOf(cut.path);
    cut.depth = folds.depthOf(cut.path);
    cut.name = line.name;
    starts.insert(starts.end(), cut.path.begin(), cut.path.end());
    plan.cuts.push_back(std::move(cut));
  }
  plan.termination = Termination::TargetReached;
  return plan;
}

}  // namespace explica::flattening
