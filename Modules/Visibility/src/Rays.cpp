// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Rays.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

namespace explica::visibility {
namespace {

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

}  // namespace

Frame frameOf(const Positions& positions) {
  const Point low = positions.colwise().minCoeff().transpose();
  const Point high = positions.colwise().maxCoeff().transpose();
  return {(low + high) / 2, (high - low).norm() / 2};
}

void requireInputs(const TriangleMesh& mesh, const Viewpoints& viewpoints,
                   const std::string& what) {
  if (mesh.faceCount() == 0) throw InvalidInput(what + ": the surface has no face");
  if (viewpoints.points.empty() || viewpoints.points.size() != viewpoints.weights.size()) {
    throw InvalidInput(what + ": at least one viewpoint, each with a weight, is needed");
  }
  if (!mesh.positions.allFinite()) throw InvalidInput(what + ": a vertex position is not finite");
}

Rays::Rays(const TriangleMesh& mesh, const Viewpoints& viewpoints, int subdivision,
           const Frame& frame)
    : mesh_(mesh),
      viewpoints_(viewpoints),
      frame_(frame),
      occluders_(mesh, frame.middle),
      samples_(subTriangleCentroids(subdivision)) {}

void Rays::look(std::size_t count,
                const std::function<void(std::size_t, const Share&)>& keep) const {
  constexpr std::size_t kGrain = 256;  // faces a task
  parallelForBlocks(count, kGrain, [&](std::size_t begin, std::size_t end) {
    const std::vector<Share> shares = sharesOf(begin, end);
    for (std::size_t f = begin; f < end; ++f) keep(f, shares[f - begin]);
  });
}

std::vector<Rays::Share> Rays::sharesOf(std::size_t begin, std::size_t end) const {
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
  return shares;
}

}  // namespace explica::visibility
