// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Collision/Untangling.h"

#include "CrossingLength.h"

#include "Explica/Core/DisjointSets.h"
#include "Explica/Core/Errors.h"
#include "Explica/Geometry/FaceTree.h"
#include "Explica/Geometry/MeshTopology.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace explica::collision {
namespace {

using geometry::FacePair;
using Matrix = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

constexpr int kMostRings = 5;       // of vertices about crossing faces that may move
constexpr double kFarthest = 3;     // mean edge lengths of the place that a vertex goes at most
constexpr int kDescentSteps = 120;  // along the gradient of the crossings' length

/// Crossing pairs that are mended together, and the vertices that may move for it.
struct Group {
  std::vector<FacePair> pairs;
  std::vector<std::int32_t> free;
};

/// Ascending, none twice.
std::vector<std::int32_t> inOrder(std::vector<std::int32_t> list) {
  std::ranges::sort(list);
  list.erase(std::unique(list.begin(), list.end()), list.end());
  return list;
}

std::vector<std::int32_t> withRings(const geometry::MeshTopology& topology,
                                    std::vector<std::int32_t> vertices, int rings) {
  for (int ring = 0; ring < rings; ++ring) {
    vertices = inOrder(std::move(vertices));
    for (std::size_t n = 0, count = vertices.size(); n < count; ++n) {
      const auto around = topology.vertexVertices[vertices[n]];
      vertices.insert(vertices.end(), around.begin(), around.end());
    }
  }
  return inOrder(std::move(vertices));
}

/// Pairs whose free vertices overlap belong together, so that no crossing is half in a group.
std::vector<Group> groupsOf(const TriangleMesh& mesh, const geometry::MeshTopology& topology,
                            const std::vector<FacePair>& pairs, int rings) {
  std::vector<std::vector<std::int32_t>> free;
  DisjointSets sets(pairs.size());
  std::map<std::int32_t, std::int32_t> owner;
  for (std::size_t n = 0; n < pairs.size(); ++n) {
    const auto pair = static_cast<std::int32_t>(n);
    std::vector<std::int32_t> corners;
    for (const std::int32_t f : pairs[n]) {
      for (int k = 0; k < 3; ++k) corners.push_back(mesh.faces(f, k));
    }
    free.push_back(withRings(topology, corners, rings));
    for (const std::int32_t v : free.back())
      sets.join(owner.try_emplace(v, pair).first->second, pair);
  }
  std::map<std::int32_t, Group> groups;
  for (std::size_t n = 0; n < pairs.size(); ++n) {
    Group& group = groups[sets.root(static_cast<std::int32_t>(n))];
    group.pairs.push_back(pairs[n]);
    group.free.insert(group.free.end(), free[n].begin(), free[n].end());
  }
  std::vector<Group> result;
  for (auto& [first, group] : groups) {
    group.free = inOrder(std::move(group.free));
    result.push_back(std::move(group));
  }
  return result;
}

/// Faces with one of the vertices, ascending.
std::vector<std::int32_t> facesAround(const geometry::MeshTopology& topology,
                                      const std::vector<std::int32_t>& vertices) {
  std::vector<std::int32_t> faces;
  for (const std::int32_t v : vertices) {
    const auto around = topology.vertexFaces[v];
    faces.insert(faces.end(), around.begin(), around.end());
  }
  return inOrder(std::move(faces));
}

/// The place of one group: every face that the moving ones can reach, on vertices of its own.
class Place {
 public:
  Place(const TriangleMesh& mesh, const geometry::MeshTopology& topology,
        const std::vector<geometry::Box>& boxes, const Group& group)
      : group_(group) {
    const std::vector<std::int32_t> moving = facesAround(topology, group.free);
    double sum = 0;
    for (const std::int32_t f : moving) {
      for (int k = 0; k < 3; ++k) sum += (mesh.corner(f, k) - mesh.corner(f, (k + 1) % 3)).norm();
    }
    edge_ = sum / (3 * static_cast<double>(moving.size()));
    cap_ = kFarthest * edge_;
    geometry::Box all;
    std::vector<geometry::Box> reach;
    for (const std::int32_t f : moving) {
      reach.emplace_back(boxes[f].min().array() - cap_, boxes[f].max().array() + cap_);
      all.extend(reach.back());
    }
    std::vector<std::int32_t> reachable;
    for (std::size_t f = 0; f < boxes.size(); ++f) {
      const auto meets = [&](const geometry::Box& box) { return box.intersects(boxes[f]); };
      if (meets(all) && std::ranges::any_of(reach, meets)) {
        reachable.push_back(static_cast<std::int32_t>(f));
      }
    }
    part_ = geometry::extractFaces(mesh, reachable);

    unknown_.assign(part_.vertexOrigin.size(), -1);
    for (std::size_t v = 0; v < unknown_.size(); ++v) {
      if (!std::ranges::binary_search(group.free, part_.vertexOrigin[v])) continue;
      unknown_[v] = static_cast<std::int32_t>(free_.size());
      free_.push_back(static_cast<std::int32_t>(v));
    }
    marked_.resize(part_.faceOrigin.size());
    for (std::size_t f = 0; f < marked_.size(); ++f) {
      marked_[f] = std::ranges::binary_search(moving, part_.faceOrigin[f]);
    }
    topology_ = geometry::buildTopology(part_.mesh.faces, part_.mesh.vertexCount());
  }

  [[nodiscard]] const TriangleMesh& start() const { return part_.mesh; }
  [[nodiscard]] const std::vector<std::int32_t>& free() const { return free_; }
  [[nodiscard]] std::int32_t origin(std::int32_t vertex) const {
    return part_.vertexOrigin[vertex];
  }
  [[nodiscard]] double edge() const { return edge_; }

  /// Intersecting pairs of the part with a face that moves.
  [[nodiscard]] std::vector<FacePair> crossings(const Positions& x) const {
    return geometry::findSelfIntersections({x, part_.mesh.faces}, marked_);
  }

  /// True if all of the part's pairs are among the group's.
  [[nodiscard]] bool onlyOld(const std::vector<FacePair>& pairs) const {
    return std::ranges::all_of(pairs, [&](const FacePair& pair) {
      const FacePair whole = {part_.faceOrigin[pair[0]], part_.faceOrigin[pair[1]]};
      return std::ranges::binary_search(group_.pairs, whole);
    });
  }

  /// No vertex farther from its start than allowed, and in single precision.
  [[nodiscard]] Positions withinReach(Positions x) const {
    for (const std::int32_t v : free_) {
      Vector move = (x.row(v) - part_.mesh.positions.row(v)).transpose();
      if (move.norm() > 0.99 * cap_) move *= 0.99 * cap_ / move.norm();
      if (move.norm() == 0) continue;
      x.row(v) =
          (part_.mesh.positions.row(v) + move.transpose()).cast<float>().cast<double>().eval();
    }
    return x;
  }

  /// Laplacian sum of (x_v - x_w) over neighbours, rows of free vertices only, all columns.
  [[nodiscard]] const geometry::MeshTopology& topology() const { return topology_; }
  [[nodiscard]] const std::vector<std::int32_t>& unknown() const { return unknown_; }

 private:
  const Group& group_;
  geometry::SubMesh part_;
  geometry::MeshTopology topology_;
  std::vector<std::int32_t> unknown_;  ///< of the part's vertices: row, or -1
  std::vector<std::int32_t> free_;
  std::vector<bool> marked_;
  double edge_ = 0;  ///< mm
  double cap_ = 0;   ///< mm
};

/// A state of the place and what is left in it.
struct Attempt {
  Positions positions;
  std::size_t left = 0;
  double moveMax = 0;
};

class Best {
 public:
  explicit Best(const Place& place, std::size_t crossings) : place_(place), fewest_(crossings) {}

  /// Takes note of a state if it is allowed and better; says if nothing crosses in it.
  bool consider(const Positions& x, const std::vector<FacePair>& pairs) {
    if (pairs.size() > fewest_ || !place_.onlyOld(pairs)) return false;
    const double move =
        std::sqrt((x - place_.start().positions).rowwise().squaredNorm().maxCoeff());
    const bool better =
        best_ ? pairs.size() < best_->left || (pairs.size() == best_->left && move < best_->moveMax)
              : pairs.size() < fewest_;
    if (better) best_ = {x, pairs.size(), move};
    return pairs.empty();
  }
  [[nodiscard]] const std::optional<Attempt>& get() const { return best_; }

 private:
  const Place& place_;
  std::size_t fewest_;
  std::optional<Attempt> best_;
};

void descend(const Place& place, Best& best) {
  const auto& unknown = place.unknown();
  const auto count = static_cast<Eigen::Index>(place.free().size());
  constexpr double kMass = 0.1;  // against the graph Laplacian: neighbours within 3 edges follow
  Triplets entries;
  for (const std::int32_t v : place.free()) {
    const auto around = place.topology().vertexVertices[v];
    entries.emplace_back(unknown[v], unknown[v], kMass + static_cast<double>(around.size()));
    for (const std::int32_t w : around) {
      if (unknown[w] >= 0) entries.emplace_back(unknown[v], unknown[w], -1);
    }
  }
  Matrix metric(count, count);
  metric.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Matrix> solver(metric);

  Positions x = place.start().positions;
  std::vector<FacePair> pairs = place.crossings(x);
  for (int n = 0; n < kDescentSteps; ++n) {
    const Positions gradient = crossingLength({x, place.start().faces}, pairs).gradient;
    Eigen::MatrixXd right(count, 3);
    for (Eigen::Index i = 0; i < count; ++i) right.row(i) = -gradient.row(place.free()[i]);
    const Eigen::MatrixXd move = solver.solve(right);
    const double largest = std::sqrt(move.rowwise().squaredNorm().maxCoeff());
    if (!(largest > 0) || !std::isfinite(largest)) return;
    constexpr double kStep = 0.05;  // mean edge lengths
    for (Eigen::Index i = 0; i < count; ++i) {
      x.row(place.free()[i]) += kStep * place.edge() / largest * move.row(i);
    }
    x = place.withinReach(std::move(x));
    pairs = place.crossings(x);
    if (best.consider(x, pairs) || pairs.empty()) return;
  }
}

/// Minimises  sum |mean of neighbours - x_v|^2 + w sum |x_v - start_v|^2  over the free vertices,
/// the first sum over them and their fixed neighbours.
void smooth(const Place& place, Best& best) {
  const auto& unknown = place.unknown();
  const auto& topology = place.topology();
  const auto count = static_cast<Eigen::Index>(place.free().size());
  const Positions& start = place.start().positions;
  std::vector<std::int32_t> centres = place.free();
  for (const std::int32_t v : place.free()) {
    for (const std::int32_t w : topology.vertexVertices[v]) {
      if (unknown[w] < 0) centres.push_back(w);
    }
  }
  centres = inOrder(std::move(centres));
  Triplets entries;
  Eigen::MatrixXd known = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(centres.size()), 3);
  for (std::size_t n = 0; n < centres.size(); ++n) {
    const auto row = static_cast<Eigen::Index>(n);
    const auto around = topology.vertexVertices[centres[n]];
    const auto put = [&](std::int32_t v, double weight) {
      if (unknown[v] >= 0) {
        entries.emplace_back(row, unknown[v], weight);
      } else {
        known.row(row) += weight * start.row(v);
      }
    };
    put(centres[n], 1);
    for (const std::int32_t w : around) put(w, -1.0 / static_cast<double>(around.size()));
  }
  Matrix laplacian(static_cast<Eigen::Index>(centres.size()), count);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  Eigen::MatrixXd old(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) old.row(i) = start.row(place.free()[i]);
  Matrix identity(count, count);
  identity.setIdentity();
  for (const double hold : {3.0, 1.0, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001, 1e-6}) {
    const Eigen::SimplicialLDLT<Matrix> solver(
        Matrix(laplacian.transpose() * laplacian + hold * identity));
    const Eigen::MatrixXd solved = solver.solve(hold * old - laplacian.transpose() * known);
    if (solver.info() != Eigen::Success || !solved.allFinite()) continue;
    Positions x = start;
    for (Eigen::Index i = 0; i < count; ++i) x.row(place.free()[i]) = solved.row(i);
    x = place.withinReach(std::move(x));
    if (best.consider(x, place.crossings(x))) return;
  }
}

/// Goes back towards the start nearly as far as nothing more crosses: both ways above go in steps.
/// What is left of the way, a 128th, is a hundred times what rounding to single precision moves.
Positions drawnBack(const Place& place, const Attempt& found) {
  constexpr int kHalvings = 7;
  const Positions& start = place.start().positions;
  const auto stateAt = [&](double share) {
    return place.withinReach(start + share * (found.positions - start));
  };
  const auto allowed = [&](const Positions& x) {
    const auto pairs = place.crossings(x);
    return pairs.size() <= found.left && place.onlyOld(pairs);
  };
  double far = 1, near = 0;
  for (int n = 0; n < kHalvings; ++n) {
    const double share = (far + near) / 2;
    (allowed(stateAt(share)) ? far : near) = share;
  }
  const Positions x = stateAt(std::min(1.0, 2 * far - near));
  return allowed(x) ? x : found.positions;
}

bool isConcerned(const std::vector<geometry::FacePair>& pairs, const std::vector<bool>& concerned) {
  return std::ranges::any_of(pairs, [&](const geometry::FacePair& pair) {
    return concerned.empty() || concerned[pair[0]] || concerned[pair[1]];
  });
}

}  // namespace

void Untangling::noteMoves(const Positions& start) {
  double sum = 0;
  for (Eigen::Index v = 0; v < start.rows(); ++v) {
    const double move = (positions.row(v) - start.row(v)).norm();
    if (move == 0) continue;
    moved.push_back(static_cast<std::int32_t>(v));
    moveMax = std::max(moveMax, move);
    sum += move;
  }
  if (!moved.empty()) moveMean = sum / static_cast<double>(moved.size());
}

Untangling untangle(const TriangleMesh& mesh, const UntangleOptions& options,
                    const Monitor& monitor) {
  if (!options.concerned.empty() &&
      static_cast<Eigen::Index>(options.concerned.size()) != mesh.faceCount()) {
    throw InvalidInput("concerned: needs one flag per face");
  }
  Untangling result;
  result.positions = mesh.positions;
  result.before = result.after = geometry::findSelfIntersections(mesh);
  if (!isConcerned(result.before, options.concerned)) return result;
  const auto topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
  TriangleMesh now = mesh;
  std::vector<geometry::Box> boxes = geometry::faceBoxes(now);
  for (int rings = 1; rings <= kMostRings && isConcerned(result.after, options.concerned);
       ++rings) {
    const auto groups = groupsOf(now, topology, result.after, rings);
    std::vector<bool> moved(boxes.size(), false);
    for (std::size_t n = 0; n < groups.size() && !monitor.shouldStop(); ++n) {
      const Group& group = groups[n];
      // Most groups part with their first ring.
      monitor.progress(1 - (1 - static_cast<double>(n) / static_cast<double>(groups.size())) /
                               std::pow(2.0, rings - 1),
                       "crossings");
      if (!isConcerned(group.pairs, options.concerned)) continue;
      const Place place(now, topology, boxes, group);
      Best best(place, group.pairs.size());
      descend(place, best);
      smooth(place, best);
      if (!best.get()) continue;
      const Positions mended = drawnBack(place, *best.get());
      for (const std::int32_t v : place.free()) now.positions.row(place.origin(v)) = mended.row(v);
      for (const std::int32_t f : facesAround(topology, group.free)) {
        moved[f] = true;
        boxes[f].setEmpty();
        for (int k = 0; k < 3; ++k) boxes[f].extend(now.corner(f, k));
      }
    }
    result.after = geometry::findSelfIntersections(now, moved, result.after);
  }
  result.positions = std::move(now.positions);
  result.noteMoves(mesh.positions);
  return result;
}

}  // namespace explica::collision
