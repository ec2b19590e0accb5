// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Surface/TopologyCorrection.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/VoxelSets.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Freudenthal.h"

#include <algorithm>
#include <cmath>

namespace explica::surface {
namespace {

using Marks = std::vector<std::uint8_t>;

/// Linear offsets of the 14 neighbours; border voxels must never be asked.
std::array<std::ptrdiff_t, kNeighbours> neighbourOffsets(const Grid& grid) {
  const std::ptrdiff_t row = grid.size[0], slice = row * grid.size[1];
  std::array<std::ptrdiff_t, kNeighbours> offsets{};
  for (int n = 0; n < kNeighbours; ++n) {
    offsets[n] = kSteps[n][0] + kSteps[n][1] * row + kSteps[n][2] * slice;
  }
  return offsets;
}

bool onBorder(const Grid& grid, std::size_t v) {
  const auto at = grid.subscripts(v);
  for (int a = 0; a < 3; ++a) {
    if (at[a] == 0 || at[a] == grid.size[a] - 1) return true;
  }
  return false;
}

/// Voxels by rank, highest first; equal ranks last in, first out.
class RankedQueue {
 public:
  /// Ranks from 0 to `highest` mm are told apart at a sixteenth of `unit`.
  RankedQueue(double highest, double unit)
      : perMm_(16 / unit), buckets_(static_cast<std::size_t>(highest * perMm_) + 2) {}

  void push(double rank, std::size_t voxel) {
    const auto bucket =
        std::min(buckets_.size() - 1, static_cast<std::size_t>(std::max(0.0, rank) * perMm_));
    buckets_[bucket].push_back(static_cast<std::uint32_t>(voxel));
    top_ = std::max(top_, static_cast<std::ptrdiff_t>(bucket));
  }
  /// Next voxel, or -1 if there is none.
  std::ptrdiff_t pop() {
    while (top_ >= 0 && buckets_[top_].empty()) --top_;
    if (top_ < 0) return -1;
    const std::ptrdiff_t voxel = buckets_[top_].back();
    buckets_[top_].pop_back();
    return voxel;
  }

 private:
  double perMm_;
  std::vector<std::vector<std::uint32_t>> buckets_;
  std::ptrdiff_t top_ = -1;
};

/// A set of voxels that changes by simple points only.
class HomotopicSet {
 public:
  HomotopicSet(const Grid& grid, Marks members)
      : offsets_(neighbourOffsets(grid)), members_(std::move(members)) {}

  [[nodiscard]] bool canChange(std::size_t v) const {
    unsigned around = 0;
    for (int n = 0; n < kNeighbours; ++n) {
      around |= static_cast<unsigned>(members_[v + offsets_[n]]) << n;
    }
    return isSimple(static_cast<Neighbourhood>(around));
  }

  /// Turns every voxel with wanted[v] != members[v] that a chain of simple changes reaches, in the
  /// order of rank.
  void approach(const Marks& wanted, const Volume<float>& rank, double unit) {
    double highest = 0;
    for (float r : rank.data) highest = std::max(highest, static_cast<double>(r));
    RankedQueue queue(highest, unit);
    Marks queued(members_.size(), 0);
    const auto offer = [&](std::size_t v) {
      if (wanted[v] != members_[v] && !queued[v]) {
        queued[v] = 1;
        queue.push(rank[v], v);
      }
    };
    for (std::size_t v = 0; v < members_.size(); ++v) {
      if (wanted[v] == members_[v]) continue;
      for (const auto offset : offsets_) {
        if (members_[v + offset] == wanted[v]) {
          offer(v);
          break;
        }
      }
    }
    for (std::ptrdiff_t v = queue.pop(); v >= 0; v = queue.pop()) {
      queued[v] = 0;
      if (!canChange(v)) continue;
      members_[v] = wanted[v];
      for (const auto offset : offsets_) offer(v + offset);
    }
  }

  [[nodiscard]] const Marks& members() const { return members_; }
  [[nodiscard]] Marks& members() { return members_; }
  [[nodiscard]] const auto& offsets() const { return offsets_; }

 private:
  std::array<std::ptrdiff_t, kNeighbours> offsets_;
  Marks members_;
};

/// Pieces of a mask, each a list of voxels in the order of discovery; voxels on the border of the
/// box are not followed.
std::vector<std::vector<std::size_t>> pieces(const Marks& mask, const Grid& grid) {
  const auto offsets = neighbourOffsets(grid);
  std::vector<std::vector<std::size_t>> found;
  Marks seen(mask.size(), 0);
  for (std::size_t start = 0; start < mask.size(); ++start) {
    if (!mask[start] || seen[start]) continue;
    std::vector<std::size_t> piece = {start};
    seen[start] = 1;
    for (std::size_t next = 0; next < piece.size(); ++next) {
      const std::size_t v = piece[next];
      if (onBorder(grid, v)) continue;
      for (const auto offset : offsets) {
        const std::size_t w = v + offset;
        if (mask[w] && !seen[w]) {
          seen[w] = 1;
          piece.push_back(w);
        }
      }
    }
    found.push_back(std::move(piece));
  }
  return found;
}

/// Distance of each voxel's centre to the nearest one of the set, mm.
Volume<float> distancesTo(const VoxelSet& set) {
  Volume<float> distance = squaredDistanceTo(set);
  parallelFor(distance.size(), 1 << 16,
              [&](std::size_t v) { distance[v] = std::sqrt(distance[v]); });
  return distance;
}

Defect describeChange(const LevelSet& level, const std::vector<std::size_t>& voxels,
                      DefectKind kind) {
  Defect defect;
  defect.kind = kind;
  defect.voxels = static_cast<std::int64_t>(voxels.size());
  Vector sum = Vector::Zero();
  for (const std::size_t v : voxels) {
    const auto at = level.grid.subscripts(v);
    sum += Vector(at[0], at[1], at[2]);
    defect.cost += std::abs(level[v]);
  }
  defect.place = level.grid.toWorld(sum / static_cast<double>(voxels.size()));
  return defect;
}

/// Turns islands and cavities over; records them.
void cleanPieces(const LevelSet& level, Marks& inside, std::vector<Defect>& defects) {
  const auto islands = pieces(inside, level.grid);
  const auto largest =
      std::max_element(islands.begin(), islands.end(),
                       [](const auto& a, const auto& b) { return a.size() < b.size(); });
  for (auto island = islands.begin(); island != islands.end(); ++island) {
    if (island == largest) continue;
    for (const std::size_t v : *island) inside[v] = 0;
    defects.push_back(describeChange(level, *island, DefectKind::Island));
  }
  // The background that reaches the border: the box's border voxels are joined through voxel 0.
  Marks outside(inside.size());
  for (std::size_t v = 0; v < inside.size(); ++v)
    outside[v] = !inside[v] && !onBorder(level.grid, v);
  const auto offsets = neighbourOffsets(level.grid);
  for (const auto& part : pieces(outside, level.grid)) {
    const bool open = std::any_of(part.begin(), part.end(), [&](std::size_t v) {
      return std::any_of(offsets.begin(), offsets.end(),
                         [&](std::ptrdiff_t o) { return onBorder(level.grid, v + o); });
    });
    if (open) continue;
    for (const std::size_t v : part) inside[v] = 1;
    defects.push_back(describeChange(level, part, DefectKind::Cavity));
  }
}

/// Takes fill voxels back that the set does not need: simple ones, as listed.
void takeBack(HomotopicSet& set, const std::vector<std::size_t>& added, const Marks& target) {
  bool changed = true;
  while (changed) {
    changed = false;
    for (const std::size_t v : added) {
      if (!target[v] && set.members()[v] && set.canChange(v)) {
        set.members()[v] = 0;
        changed = true;
      }
    }
  }
}

/// Cuts handles and fills tunnels until the mask is a ball.
void makeBall(const LevelSet& level, Marks& inside, std::vector<Defect>& defects,
              const Monitor& monitor) {
  const Grid& grid = level.grid;
  const double unit = grid.spacing.minCoeff();

  monitor.progress(0.2, "growing from inside and from outside");
  Marks seed(inside.size(), 0), box(inside.size());
  const Volume<float> depth =
      distancesTo(setWhere(grid, [&](std::size_t v) { return inside[v] == 0; }));
  seed[std::max_element(depth.data.begin(), depth.data.end()) - depth.data.begin()] = 1;
  for (std::size_t v = 0; v < box.size(); ++v) box[v] = !onBorder(grid, v);
  HomotopicSet grown(grid, std::move(seed)), shrunk(grid, std::move(box));
  // Each waits for its own voxels only, one after another: the two run beside each other.
  parallelFor(2, 1, [&](std::size_t side) {
    if (side == 0) {
      grown.approach(inside, depth, unit);
    } else {
      shrunk.approach(
          inside, distancesTo(setWhere(grid, [&](std::size_t v) { return inside[v] != 0; })), unit);
    }
  });
  if (grown.members() == inside) return;

  monitor.progress(0.8, "choosing between fills and cuts");
  const auto note = [&](DefectKind kind, std::vector<std::size_t> voxels, double alternative) {
    std::erase_if(voxels, [&](std::size_t v) { return grown.members()[v] == inside[v]; });
    if (voxels.empty()) return;
    defects.push_back(describeChange(level, voxels, kind));
    defects.back().alternativeCost = alternative;
  };
  // Both growths are balls.  The homology of the outer one relative to the inner one is 0, and it
  // is the sum of that of the pieces between them, which touch no other: each by itself may be
  // added whole.
  Marks difference(inside.size());
  for (std::size_t v = 0; v < inside.size(); ++v) {
    difference[v] = shrunk.members()[v] && !grown.members()[v];
  }
  for (const auto& piece : pieces(difference, grid)) {
    double filled = 0, lost = 0;
    for (const std::size_t v : piece) (inside[v] ? lost : filled) += std::abs(level[v]);
    if (lost > filled) {
      for (const std::size_t v : piece) grown.members()[v] = 1;
      takeBack(grown, piece, inside);
      note(DefectKind::Tunnel, piece, lost);
    } else {
      note(DefectKind::Handle, piece, filled);
    }
  }
  inside = grown.members();
}

}  // namespace

std::int64_t boundaryEulerCharacteristic(const LevelSet& level) {
  // The boundary surface's Euler characteristic is twice that of the foreground's complex; that is
  // a sum over foreground simplices: points, edges, triangles, tetrahedra.
  const auto offsets = neighbourOffsets(level.grid);
  std::int64_t sum = 0;
  for (std::size_t v = 0; v < level.size(); ++v) {
    if (level[v] <= 0 || onBorder(level.grid, v)) continue;
    // Simplices are counted at their lowest point: chains of steps up.
    std::int64_t here = 1;
    std::array<bool, 8> in{};
    constexpr std::array<int, 7> bitsOfStep = {1, 2, 4, 3, 5, 6, 7};
    for (int n = 0; n < 7; ++n) in[bitsOfStep[n]] = level[v + offsets[n]] > 0;
    for (int a = 1; a < 8; ++a) {
      if (!in[a]) continue;
      --here;
      for (int b = a + 1; b < 8; ++b) {
        if (!in[b] || (a & b) != a) continue;
        ++here;
        for (int c = b + 1; c < 8; ++c) {
          if (in[c] && (b & c) == b) --here;
        }
      }
    }
    sum += here;
  }
  return 2 * sum;
}

TopologyResult correctTopology(const LevelSet& level, GenusRule rule, const Monitor& monitor) {
  const Grid& grid = level.grid;
  TopologyResult result;
  result.level = level;

  Marks inside(level.size());
  bool any = false;
  for (std::size_t v = 0; v < level.size(); ++v) {
    inside[v] = level[v] > 0;
    any = any || inside[v];
    if (inside[v] && onBorder(grid, v)) {
      throw InvalidInput("level: positive on the border of its box; widen the box by background");
    }
  }
  if (!any) throw InvalidInput("level: no positive voxel; nothing is inside the surface");

  monitor.progress(0.0, "islands and cavities");
  cleanPieces(level, inside, result.defects);

  if (rule == GenusRule::Zero) makeBall(level, inside, result.defects, monitor);

  for (std::size_t v = 0; v < level.size(); ++v) {
    if ((level[v] > 0) != (inside[v] != 0)) {
      result.level[v] = inside[v] ? kLeastLevel : -kLeastLevel;
      ++result.voxelsChanged;
    }
  }
  std::sort(result.defects.begin(), result.defects.end(), [](const Defect& a, const Defect& b) {
    return a.voxels != b.voxels ? a.voxels > b.voxels
                                : std::lexicographical_compare(a.place.begin(), a.place.end(),
                                                               b.place.begin(), b.place.end());
  });
  result.handlesLeft = 1 - boundaryEulerCharacteristic(result.level) / 2;
  monitor.progress(1.0, "topology corrected");
  return result;
}

double correctedShare(const LevelSet& before, const LevelSet& after, const TriangleMesh& mesh) {
  const Grid& grid = after.grid;
  const auto differs = [&](int i, int j, int k) {
    return grid.contains(i, j, k) && (before(i, j, k) > 0) != (after(i, j, k) > 0);
  };
  const Eigen::VectorXd areas = geometry::vertexAreas(mesh);
  Eigen::VectorXd beside = Eigen::VectorXd::Zero(areas.size());
  parallelFor(areas.size(), 4096, [&](std::size_t v) {
    const auto row = static_cast<Eigen::Index>(v);
    const Vector low = grid.toIndex(mesh.positions.row(row)).array().floor();
    for (int n = 0; n < 8; ++n) {
      if (differs(static_cast<int>(low[0]) + (n & 1), static_cast<int>(low[1]) + (n >> 1 & 1),
                  static_cast<int>(low[2]) + (n >> 2))) {
        beside[row] = areas[row];
      }
    }
  });
  return beside.sum() / areas.sum();
}

}  // namespace explica::surface
