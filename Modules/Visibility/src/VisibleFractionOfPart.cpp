// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Rays.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Visibility/VisibleFraction.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace explica::visibility {
namespace {

constexpr std::size_t kGrain = 256;  // elements a task

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

}  // namespace

VisibleFraction visibleFractionAfter(const TriangleMesh& mesh, const Viewpoints& viewpoints,
                                     const Positions& stood, const VisibleFraction& before) {
  requireInputs(mesh, viewpoints, "visible fraction");
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
    rays.look(changed.size(), [&](std::size_t i, const Rays::Share& share) {
      result.face[changed[i]] = share.seen;
      result.arriving[changed[i]] = share.arriving;
    });
  }
  result.addUp(mesh);
  return result;
}

double seenShare(const TriangleMesh& mesh, const std::vector<std::int32_t>& faces,
                 const Viewpoints& viewpoints) {
  requireInputs(mesh, viewpoints, "visible fraction");
  Eigen::AlignedBox3d box;
  for (const std::int32_t f : faces) {
    for (int k = 0; k < 3; ++k) box.extend(mesh.corner(f, k));
  }
  const TriangleMesh part = withWhatMayHide(mesh, faces, viewpoints, box, true, 0);
  const Rays rays(part, viewpoints, VisibleFractionOptions{}.subdivision, frameOf(mesh.positions));
  const auto count = static_cast<Eigen::Index>(faces.size());
  Eigen::VectorXd seen(count);
  rays.look(faces.size(), [&](std::size_t i, const Rays::Share& share) {
    seen[static_cast<Eigen::Index>(i)] = share.seen;
  });
  const Eigen::VectorXd areas = geometry::faceAreas(part).head(count);
  return areas.sum() > 0 ? seen.dot(areas) / areas.sum() : 0;
}

std::vector<float> standingOver(const Positions& positions, const Faces& faces,
                                std::span<const std::int32_t> listed,
                                std::span<const std::int32_t> asked, const Vector& axis) {
  const TriangleMesh below = partOf(positions, faces, listed);
  requireInputs(below, viewpoint(axis), "visible fraction");
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
