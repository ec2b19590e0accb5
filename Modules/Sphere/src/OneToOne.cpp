// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sphere/OneToOne.h"

#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SphereLocator.h"
#include "Star.h"

#include <map>
#include <optional>
#include <set>

namespace explica::sphere {
namespace {

using Loop = std::vector<std::int32_t>;

constexpr int kSweeps = 20;    // over what was put back, towards where it was
constexpr int kParts = 8;      // of the way from the middle of a ring to where a vertex was
constexpr int kMostRings = 5;  // about what single precision leaves no room for, moved with it

Eigen::RowVector3d inSinglePrecision(Eigen::RowVector3d row) {
  for (double& x : row) {
    const volatile float single =
        static_cast<float>(x);  // GCC 12 leaves pairs of doubles unrounded
    x = single;
  }
  return row;
}

Eigen::RowVector3d asWritten(const Point& place) {
  return inSinglePrecision(kSphereRadius * place.normalized().transpose());
}

/// Neighbours of a vertex, counter-clockwise.
Loop ringOf(const Faces& faces, const geometry::MeshTopology& topology, std::int32_t v) {
  std::map<std::int32_t, std::int32_t> next;
  for (const std::int32_t f : topology.vertexFaces[v]) {
    for (int k = 0; k < 3; ++k) {
      if (faces(f, k) == v) next[faces(f, (k + 1) % 3)] = faces(f, (k + 2) % 3);
    }
  }
  Loop ring = {next.begin()->first};
  while (ring.size() < next.size()) ring.push_back(next.at(ring.back()));
  return ring;
}

/// A mesh from which the vertices of faces turned over are taken out, one merged with a neighbour
/// after another, until none is turned over, and put back in the reverse order, each where it sees
/// its ring: beside the neighbour that it was merged with, there always is such a place.
class Untangling {
 public:
  explicit Untangling(TriangleMesh& sphere)
      : given_(sphere.positions),
        positions_(sphere.positions),
        rings_(static_cast<std::size_t>(sphere.vertexCount())) {
    const auto topology = geometry::buildTopology(sphere.faces, sphere.vertexCount());
    for (std::size_t v = 0; v < rings_.size(); ++v)
      rings_[v] = ringOf(sphere.faces, topology, static_cast<std::int32_t>(v));
  }

  void takeOut(const Faces& faces, const std::vector<std::int32_t>& turned) {
    for (const std::int32_t f : turned) {
      for (int k = 0; k < 3; ++k) consider(faces(f, k));
    }
    while (!plans_.empty()) {
      const auto best = std::ranges::max_element(plans_, [](const auto& a, const auto& b) {
        return a.second.before - a.second.after < b.second.before - b.second.after;
      });
      const std::int32_t v = best->first;
      const std::optional<Merger> merger = bestMerger(v);  // neighbours may have changed since
      if (merger)
        merge(v, *merger);
      else
        plans_.erase(v);
    }
  }

  /// @return false if double precision leaves no room
  bool putBack() {
    std::set<std::int32_t> back;
    for (; !removals_.empty(); removals_.pop_back()) {
      const Removal& removal = removals_.back();
      for (const auto& [u, ring] : removal.rings) rings_[u] = ring;
      back.insert(removal.vertex);
      if (!place(removal.vertex, true)) return false;
      for (const std::int32_t u : rings_[removal.vertex]) {
        if (back.count(u)) place(u, true);
      }
    }
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (const std::int32_t v : back) place(v, true);
    }
    makeRoom();
    return true;
  }

 private:
  /// A vertex's faces replaced by those from one of its neighbours.
  struct Merger {
    std::int64_t before = 0, after = 0;  ///< faces turned over
    std::size_t centre = 0;              ///< of the ring
  };
  struct Removal {
    std::int32_t vertex = -1;
    std::vector<std::pair<std::int32_t, Loop>> rings;  ///< its neighbours' before
  };

  [[nodiscard]] bool isTurned(std::int32_t a, std::int32_t b, std::int32_t c) const {
    return geometry::sphericalOrientation(positions_.row(a), positions_.row(b),
                                          positions_.row(c)) <= 0;
  }

  [[nodiscard]] bool joined(std::int32_t a, std::int32_t b) const {
    return std::ranges::find(rings_[a], b) != rings_[a].end();
  }

  /// The one that leaves the fewest faces turned over; none where each would join twice what is
  /// joined already.
  [[nodiscard]] std::optional<Merger> bestMerger(std::int32_t v) const {
    const Loop& ring = rings_[v];
    const std::size_t size = ring.size();
    std::optional<Merger> best;
    for (std::size_t c = 0; c < size; ++c) {
      const auto at = [&](std::size_t n) { return ring[(c + n) % size]; };
      bool possible = rings_[at(1)].size() > 3 && rings_[at(size - 1)].size() > 3;
      Merger merger{0, 0, c};
      for (std::size_t n = 0; n < size; ++n) merger.before += isTurned(v, at(n), at(n + 1));
      for (std::size_t n = 1; n + 1 < size; ++n) merger.after += isTurned(at(0), at(n), at(n + 1));
      for (std::size_t n = 2; n + 1 < size; ++n) possible &= !joined(at(0), at(n));
      if (possible && (!best || merger.after < best->after)) best = merger;
    }
    return best;
  }

  void consider(std::int32_t v) {
    plans_.erase(v);
    const auto merger = bestMerger(v);
    if (merger && merger->before > 0) plans_[v] = *merger;
  }

  void merge(std::int32_t v, const Merger& merger) {
    Removal removal{v, {}};
    Loop ring = rings_[v];
    for (const std::int32_t u : ring) removal.rings.emplace_back(u, rings_[u]);
    std::rotate(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(merger.centre),
                ring.end());
    Loop& centre = rings_[ring[0]];
    auto at = centre.erase(std::ranges::find(centre, v));
    centre.insert(at, ring.begin() + 2, ring.end() - 1);
    std::erase(rings_[ring[1]], v);
    std::erase(rings_[ring.back()], v);
    for (std::size_t n = 2; n + 1 < ring.size(); ++n)
      std::ranges::replace(rings_[ring[n]], v, ring[0]);
    removals_.push_back(std::move(removal));
    plans_.erase(v);
    for (const std::int32_t u : ring) consider(u);
  }

  /// Moves a vertex to where its ring is seen from: as near as that goes to where it was given, or
  /// to the middle of all such places.  In double precision if the place written does not see it.
  /// @return false if neither its place nor any other that was tried sees the ring
  bool place(std::int32_t v, bool nearGiven) {
    Ring ring, directions;
    for (const std::int32_t u : rings_[v]) {
      ring.push_back(positions_.row(u).transpose());
      directions.push_back(ring.back().normalized());
    }
    const auto take = [&](const Eigen::RowVector3d& tried) {
      if (!seesRing(ring, tried.transpose())) return false;
      positions_.row(v) = tried;
      return true;
    };
    if (nearGiven && take(given_.row(v))) return true;
    const Point given = given_.row(v).normalized().transpose();
    const Point middle = placeInside(directions).value_or(positions_.row(v).normalized());
    for (int parts = nearGiven ? kParts - 1 : 0; parts >= 0; --parts) {
      const double share = static_cast<double>(parts) / kParts;
      if (take(asWritten(middle + share * (given - middle)))) return true;
    }
    return take(kSphereRadius * middle.transpose()) || take(positions_.row(v));
  }

  /// Moves what is not yet as it is written, and what is about it, apart until it is.
  void makeRoom() {
    const auto isWritten = [&](std::int32_t v) {
      return positions_.row(v) == inSinglePrecision(positions_.row(v));
    };
    std::set<std::int32_t> cramped;
    for (std::int32_t v = 0; v < positions_.rows(); ++v) {
      if (!isWritten(v)) cramped.insert(v);
    }
    for (int width = 0; width < kMostRings; ++width) {
      if (std::ranges::all_of(cramped, isWritten)) return;
      for (const std::int32_t v : std::set(cramped)) {
        cramped.insert(rings_[v].begin(), rings_[v].end());
      }
      for (int sweep = 0; sweep < kSweeps; ++sweep) {
        for (const std::int32_t v : cramped) place(v, false);
      }
    }
  }

  const Positions given_;
  Positions& positions_;
  std::vector<Loop> rings_;
  std::map<std::int32_t, Merger> plans_;  ///< of vertices with faces turned over
  std::vector<Removal> removals_;
};

}  // namespace

OneToOne makeOneToOne(TriangleMesh& sphere) {
  for (Eigen::Index v = 0; v < sphere.vertexCount(); ++v) {
    sphere.positions.row(v) = asWritten(sphere.positions.row(v).transpose());
  }
  OneToOne result;
  const std::vector<std::int32_t> turned = geometry::turnedOver(sphere);
  result.turnedBefore = static_cast<std::int64_t>(turned.size());
  if (turned.empty()) return result;
  const Positions given = sphere.positions;
  Untangling untangling(sphere);
  untangling.takeOut(sphere.faces, turned);
  if (!untangling.putBack()) sphere.positions = given;
  for (Eigen::Index v = 0; v < sphere.vertexCount(); ++v) {
    sphere.positions.row(v) = inSinglePrecision(sphere.positions.row(v));
  }
  result.turnedAfter = static_cast<std::int64_t>(geometry::turnedOver(sphere).size());
  for (std::int32_t v = 0; v < sphere.vertexCount(); ++v) {
    if (sphere.positions.row(v) != given.row(v)) result.moved.push_back(v);
  }
  return result;
}

}  // namespace explica::sphere
