// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Visibility/VisibleFraction.h"

#include "Occluders.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <utility>

namespace explica::visibility {
namespace {

constexpr std::size_t kGrain = 256;  // faces a task

/// Centroids of the n^2 equal sub-triangles, as barycentric coordinates.
std::vector<Vector> subTriangleCentroids(int n) {
  std::vector<Vector> result;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; i + j < n; ++j) {
      for (int flipped = 0; flipped < (i + j + 1 < n ? 2 : 1); ++flipped) {
        const double shift = flipped ? 2.0 / 3 : 1.0 / 3;
        const double u = (i + shift) / n;
        const double v = (j + shift) / n;
        result.emplace_back(1 - u - v, u, v);
      }
    }
  }
  return result;
}

Eigen::VectorXd areasOf(const TriangleMesh& mesh) {
  Eigen::VectorXd areas(mesh.faceCount());
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    areas[f] = (mesh.corner(f, 1) - mesh.corner(f, 0))
                   .cross(mesh.corner(f, 2) - mesh.corner(f, 0))
                   .norm() /
               2;
  }
  return areas;
}

/// Where positions count from, for single precision, and how far from there any is.
struct Frame {
  Point middle;
  double radius;  ///< mm
};

Frame frameOf(const Positions& positions) {
  const Point low = positions.colwise().minCoeff().transpose();
  const Point high = positions.colwise().maxCoeff().transpose();
  return {(low + high) / 2, (high - low).norm() / 2};
}

/// Rays from samples of faces to the viewpoints.
class Rays {
 public:
  Rays(const TriangleMesh& mesh, const Viewpoints& viewpoints, int subdivision, const Frame& frame)
      : mesh_(mesh),
        viewpoints_(viewpoints),
        frame_(frame),
        occluders_(mesh, frame.middle),
        samples_(subTriangleCentroids(subdivision)) {}

  /// Shares of a face's area: what is seen, and what arrives of the flux.
  struct Share {
    double seen = 0;
    double arriving = 0;
  };
  /// Calls keep(face, share) for faces one after the other, whose rays are cast together.
  template <class Keep>
  void look(std::size_t begin, std::size_t end, const Keep& keep) const {
    struct Look {  // of a face to a viewpoint
      std::size_t face;
      double weight;
      int clear = 0;
      double cosines = 0;
    };
    std::vector<Look> looks;
    Occluders::Packet packet;
    std::array<std::pair<std::size_t, double>, Occluders::kPacket> ofRay;  // its look, its cosine
    const auto cast = [&] {
      std::uint32_t free = occluders_.clear(packet);
      for (; free != 0; free &= free - 1) {
        const auto& [look, cosine] = ofRay[std::countr_zero(free)];
        ++looks[look].clear;
        looks[look].cosines += cosine;
      }
      packet.count = 0;
    };
    const auto& [middle, radius] = frame_;
    for (std::size_t f = begin; f < end; ++f) {
      const auto face = static_cast<Eigen::Index>(f);
      const Point a = mesh_.corner(face, 0) - middle;
      const Point b = mesh_.corner(face, 1) - middle;
      const Point c = mesh_.corner(face, 2) - middle;
      const Vector normal = (b - a).cross(c - a).stableNormalized();
      for (std::size_t p = 0; p < viewpoints_.points.size(); ++p) {
        const Point target = viewpoints_.points[p] - middle;
        if (!(normal.dot(target - a) > 0)) continue;  // turned away
        looks.push_back({f, viewpoints_.weights[p]});
        for (const Vector& s : samples_) {
          const Point from = s[0] * a + s[1] * b + s[2] * c;
          const Vector toTarget = target - from;
          const double distance = toTarget.norm();
          const Vector by = toTarget / distance;
          ofRay[packet.count] = {looks.size() - 1, normal.dot(by)};
          // Nothing lies beyond the mesh's ball: a far viewpoint costs no precision.
          packet.add(from, by, std::min(distance, from.norm() + 1.001 * radius),
                     static_cast<std::uint32_t>(f));
          if (packet.count == Occluders::kPacket) cast();
        }
      }
    }
    cast();
    const auto rays = static_cast<double>(samples_.size());
    std::vector<Share> shares(end - begin);
    for (const Look& look : looks) {
      shares[look.face - begin].seen += look.weight * look.clear / rays;
      shares[look.face - begin].arriving += look.weight * look.cosines / rays;
    }
    for (std::size_t f = begin; f < end; ++f) keep(f, shares[f - begin]);
  }

 private:
  const TriangleMesh& mesh_;
  const Viewpoints& viewpoints_;
  Frame frame_;
  Occluders occluders_;
  std::vector<Vector> samples_;
};

void requireInputs(const TriangleMesh& mesh, const Viewpoints& viewpoints) {
  if (mesh.faceCount() == 0) throw InvalidInput("visible fraction: the surface has no face");
  if (viewpoints.points.empty() || viewpoints.points.size() != viewpoints.weights.size()) {
    throw InvalidInput("visible fraction: at least one viewpoint, each with a weight, is needed");
  }
  if (!mesh.positions.allFinite()) {
    throw InvalidInput("visible fraction: a vertex position is not finite");
  }
}

/// Some faces of a surface, each on corners of its own.
TriangleMesh partOf(const Positions& positions, const Faces& faces,
                    std::span<const std::int32_t> chosen) {
  const auto count = static_cast<Eigen::Index>(chosen.size());
  TriangleMesh part{Positions(3 * count, 3), Faces(count, 3)};
  for (Eigen::Index n = 0; n < 3 * count; ++n) {
    part.positions.row(n) = positions.row(faces(chosen[n / 3], n % 3));
    part.faces(n / 3, n % 3) = static_cast<std::int32_t>(n);
  }
  return part;
}

/// How far any point of a face is from its first corner.
double sizeOf(const TriangleMesh& mesh, Eigen::Index f) {
  const Point a = mesh.corner(f, 0), b = mesh.corner(f, 1), c = mesh.corner(f, 2);
  return std::sqrt(std::max((b - a).squaredNorm(), (c - a).squaredNorm()));
}

/// Whether the way from the eye through a point, from `first` times to `last` times as far as that,
/// comes nearer to a box than `margin`.
bool passes(const Point& eye, const Point& through, double first, double last,
            const Eigen::AlignedBox3d& box, double margin) {
  for (int k = 0; k < 3; ++k) {
    const double way = through[k] - eye[k];
    const double low = (box.min()[k] - margin - eye[k]) / way;
    const double high = (box.max()[k] + margin - eye[k]) / way;
    first = std::max(first, std::min(low, high));
    last = std::min(last, std::max(low, high));
  }
  return !(first > last);
}

/// Whether a face may stand on a way to the eye that passes a box: anywhere, or between both. The
/// nearer it is to the eye, the more its size counts at the box.
bool mayStandIn(const TriangleMesh& mesh, Eigen::Index f, const Point& eye, bool between,
                const Eigen::AlignedBox3d& box, double margin) {
  const Point corner = mesh.corner(f, 0);
  const double size = sizeOf(mesh, f), distance = (corner - eye).norm();
  if (!(distance > size)) return true;
  const double farthest = box.exteriorDistance(eye) + box.diagonal().norm();
  const double scale = std::max(1.0, farthest / (distance - size));
  return passes(eye, corner, between ? 1 : 0, kInfinity, box, margin + scale * size);
}

/// The listed faces, and behind them all others that may stand on ways from them to the viewpoints.
/// @param box      that these ways pass, as near as `margin`
/// @param between  they begin there
TriangleMesh withWhatMayHide(const TriangleMesh& mesh, const std::vector<std::int32_t>& faces,
                             const Viewpoints& viewpoints, const Eigen::AlignedBox3d& box,
                             bool between, double margin) {
  std::vector<char> others(static_cast<std::size_t>(mesh.faceCount()));
  parallelFor(others.size(), kGrain, [&](std::size_t f) {
    others[f] = std::ranges::any_of(viewpoints.points, [&](const Point& eye) {
      return mayStandIn(mesh, static_cast<Eigen::Index>(f), eye, between, box, margin);
    });
  });
  for (const std::int32_t f : faces) others[f] = 0;
  std::vector<std::int32_t> chosen = faces;
  for (std::size_t f = 0; f < others.size(); ++f) {
    if (others[f] != 0) chosen.push_back(static_cast<std::int32_t>(f));
  }
  return partOf(mesh.positions, mesh.faces, chosen);
}

/// Vertices and the whole, of what the faces show.
void addUp(const TriangleMesh& mesh, VisibleFraction& result) {
  const Eigen::VectorXd areas = areasOf(mesh);
  const double total = areas.sum();
  result.total = total > 0 ? result.face.dot(areas) / total : 0;
  result.vertex.setZero(mesh.vertexCount());
  Eigen::VectorXd around = Eigen::VectorXd::Zero(mesh.vertexCount());
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      result.vertex[mesh.faces(f, k)] += result.face[f] * areas[f];
      around[mesh.faces(f, k)] += areas[f];
    }
  }
  for (Eigen::Index v = 0; v < around.size(); ++v) {
    result.vertex[v] = around[v] > 0 ? result.vertex[v] / around[v] : 0;
  }
}

double meanOver(const TriangleMesh& mesh, const std::vector<std::int32_t>& faces,
                const Eigen::VectorXd& values) {
  const Eigen::VectorXd areas = areasOf(mesh);
  double sum = 0;
  double area = 0;
  for (const std::int32_t f : faces) {
    sum += values[f] * areas[f];
    area += areas[f];
  }
  return area > 0 ? sum / area : 0;
}

}  // namespace

double VisibleFraction::of(const TriangleMesh& mesh, const std::vector<std::int32_t>& faces) const {
  return meanOver(mesh, faces, face);
}

double VisibleFraction::realOf(const TriangleMesh& mesh,
                               const std::vector<std::int32_t>& faces) const {
  return meanOver(mesh, faces, arriving);
}

VisibleFraction visibleFraction(const TriangleMesh& mesh, const Viewpoints& viewpoints,
                                const VisibleFractionOptions& options) {
  requireInputs(mesh, viewpoints);
  if (options.subdivision < 1 || options.subdivision > 64) {
    throw InvalidInput("visible fraction: subdivision is " + std::to_string(options.subdivision) +
                       "; it must lie between 1 and 64");
  }
  const Rays rays(mesh, viewpoints, options.subdivision, frameOf(mesh.positions));
  VisibleFraction result;
  result.face.setZero(mesh.faceCount());
  result.arriving.setZero(mesh.faceCount());
  const auto count = static_cast<std::size_t>(mesh.faceCount());
  parallelForBlocks(count, kGrain, [&](std::size_t begin, std::size_t end) {
    rays.look(begin, end, [&](std::size_t f, const Rays::Share& share) {
      result.face[static_cast<Eigen::Index>(f)] = share.seen;
      result.arriving[static_cast<Eigen::Index>(f)] = share.arriving;
    });
  });
  addUp(mesh, result);
  return result;
}

VisibleFraction visibleFractionAfter(const TriangleMesh& mesh, const Viewpoints& viewpoints,
                                     const Positions& stood, const VisibleFraction& before) {
  requireInputs(mesh, viewpoints);
  Frame frame = frameOf(stood);
  frame.radius =
      std::max(frame.radius,
               (mesh.positions.rowwise() - frame.middle.transpose()).rowwise().norm().maxCoeff());
  const TriangleMesh then{stood, mesh.faces};
  Eigen::AlignedBox3d moved;  // about the faces that are not where they were, there and here
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    const auto stays = [&](std::int32_t v) { return mesh.positions.row(v) == stood.row(v); };
    if (stays(mesh.faces(f, 0)) && stays(mesh.faces(f, 1)) && stays(mesh.faces(f, 2))) continue;
    for (int k = 0; k < 3; ++k) moved.extend(mesh.corner(f, k)).extend(then.corner(f, k));
  }
  std::vector<std::int32_t> changed;
  double largest = 0;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    const double size = sizeOf(mesh, f);
    if (std::ranges::none_of(viewpoints.points, [&](const Point& eye) {
          return passes(eye, mesh.corner(f, 0), 0, 1, moved, size);
        })) {
      continue;
    }
    changed.push_back(static_cast<std::int32_t>(f));
    largest = std::max(largest, size);
  }
  VisibleFraction result = before;
  if (!changed.empty()) {
    const TriangleMesh part = withWhatMayHide(mesh, changed, viewpoints, moved, false, 2 * largest);
    const Rays rays(part, viewpoints, VisibleFractionOptions{}.subdivision, frame);
    parallelForBlocks(changed.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      rays.look(begin, end, [&](std::size_t i, const Rays::Share& share) {
        result.face[changed[i]] = share.seen;
        result.arriving[changed[i]] = share.arriving;
      });
    });
  }
  addUp(mesh, result);
  return result;
}

double seenShare(const TriangleMesh& mesh, const std::vector<std::int32_t>& faces,
                 const Viewpoints& viewpoints) {
  requireInputs(mesh, viewpoints);
  Eigen::AlignedBox3d box;
  for (const std::int32_t f : faces) {
    for (int k = 0; k < 3; ++k) box.extend(mesh.corner(f, k));
  }
  const TriangleMesh part = withWhatMayHide(mesh, faces, viewpoints, box, true, 0);
  const Rays rays(part, viewpoints, VisibleFractionOptions{}.subdivision, frameOf(mesh.positions));
  const auto count = static_cast<Eigen::Index>(faces.size());
  Eigen::VectorXd seen(count);
  parallelForBlocks(faces.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    rays.look(begin, end, [&](std::size_t i, const Rays::Share& share) {
      seen[static_cast<Eigen::Index>(i)] = share.seen;
    });
  });
  const Eigen::VectorXd areas = areasOf(part).head(count);
  return areas.sum() > 0 ? seen.dot(areas) / areas.sum() : 0;
}

std::vector<float> standingOver(const Positions& positions, const Faces& faces,
                                std::span<const std::int32_t> listed,
                                std::span<const std::int32_t> asked, const Vector& axis) {
  const TriangleMesh below = partOf(positions, faces, listed);
  requireInputs(below, viewpoint(axis));
  const Point middle = below.corner(0, 0);
  const Occluders occluders(below, middle);
  std::vector<float> over(asked.size());
  constexpr std::size_t kAtOnce = Occluders::kPacket / 3;  // faces whose rays go together
  parallelFor((over.size() + kAtOnce - 1) / kAtOnce, kGrain, [&](std::size_t number) {
    const std::size_t first = kAtOnce * number, count = std::min(kAtOnce, over.size() - first);
    Occluders::Packet packet;
    for (std::size_t n = 0; n < 3 * count; ++n) {
      const std::int32_t face = asked[first + n / 3];
      const auto corner = [&](std::size_t k) -> Point {
        return positions.row(faces(face, static_cast<Eigen::Index>(k % 3))).transpose();
      };
      const Point from = (4 * corner(n) + corner(n + 1) + corner(n + 2)) / 6 - middle;
      packet.add(from, -axis, kInfinity, RTC_INVALID_GEOMETRY_ID);
    }
    const std::uint32_t clear = occluders.clear(packet);
    for (std::size_t n = 0; n < count; ++n) {
      over[first + n] = 1 - static_cast<float>(std::popcount(clear >> (3 * n) & 7U)) / 3;
    }
  });
  return over;
}

}  // namespace explica::visibility
