// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Visibility/VisibleFraction.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <embree3/rtcore.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>

namespace explica::visibility {
namespace {

constexpr std::size_t kGrain = 256;  // faces a task

struct ReleaseDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseDevice>;
using Scene = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene>;

/// The ray's own face, which must not hide it.
struct OwnFaceContext {
  RTCIntersectContext base;
  std::uint32_t face;
};

void ignoreOwnFace(const RTCFilterFunctionNArguments* args) {
  const auto* context = reinterpret_cast<const OwnFaceContext*>(args->context);
  for (unsigned int i = 0; i < args->N; ++i) {
    if (args->valid[i] != -1) continue;
    if (RTCHitN_primID(args->hit, args->N, i) == context->face) args->valid[i] = 0;
  }
}

class Occluders {
 public:
  Occluders(const TriangleMesh& mesh, const Point& centre) : device_(rtcNewDevice(nullptr)) {
    if (!device_) throw EnvironmentError("ray casting: Embree cannot start");
    scene_.reset(rtcNewScene(device_.get()));
    rtcSetSceneFlags(
        scene_.get(),
        static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
    const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                3 * sizeof(float), static_cast<std::size_t>(mesh.vertexCount())));
    auto* faces = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t),
        static_cast<std::size_t>(mesh.faceCount())));
    if (!vertices || !faces) {
      rtcReleaseGeometry(geometry);
      throw EnvironmentError("ray casting: not enough memory");
    }
    for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
      for (int k = 0; k < 3; ++k) {
        vertices[3 * v + k] = static_cast<float>(mesh.positions(v, k) - centre[k]);
      }
    }
    for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
      for (int k = 0; k < 3; ++k) faces[3 * f + k] = static_cast<std::uint32_t>(mesh.faces(f, k));
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_.get());
  }

  /// Rays that are cast together.
  static constexpr std::size_t kPacket = 16;

  /// How many of at most kPacket segments no face other than `face` meets, mm about centre.
  /// @param from  where they start
  /// @param by    unit directions
  [[nodiscard]] int countClear(std::span<const Point> from, std::span<const Vector> by,
                               std::span<const double> lengths, std::uint32_t face) const {
    OwnFaceContext context;
    rtcInitIntersectContext(&context.base);
    context.base.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    context.base.filter = ignoreOwnFace;
    context.face = face;
    RTCRay16 rays = {};
    alignas(64) std::array<int, kPacket> valid = {};
    for (std::size_t n = 0; n < from.size(); ++n) {
      valid[n] = -1;
      rays.org_x[n] = static_cast<float>(from[n].x());
      rays.org_y[n] = static_cast<float>(from[n].y());
      rays.org_z[n] = static_cast<float>(from[n].z());
      rays.dir_x[n] = static_cast<float>(by[n].x());
      rays.dir_y[n] = static_cast<float>(by[n].y());
      rays.dir_z[n] = static_cast<float>(by[n].z());
      rays.tfar[n] = static_cast<float>(lengths[n]);
      rays.mask[n] = 0xffffffffU;
    }
    rtcOccluded16(valid.data(), scene_.get(), &context.base, &rays);
    int clear = 0;
    for (std::size_t n = 0; n < from.size(); ++n) clear += !(rays.tfar[n] < 0);
    return clear;
  }

 private:
  Device device_;
  Scene scene_;
};

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

}  // namespace

double VisibleFraction::of(const TriangleMesh& mesh, const std::vector<std::int32_t>& faces) const {
  const Eigen::VectorXd areas = areasOf(mesh);
  double seen = 0;
  double area = 0;
  for (const std::int32_t f : faces) {
    seen += face[f] * areas[f];
    area += areas[f];
  }
  return area > 0 ? seen / area : 0;
}

VisibleFraction visibleFraction(const TriangleMesh& mesh, const Viewpoints& viewpoints,
                                const VisibleFractionOptions& options) {
  if (mesh.faceCount() == 0) throw InvalidInput("visible fraction: the surface has no face");
  if (viewpoints.points.empty() || viewpoints.points.size() != viewpoints.weights.size()) {
    throw InvalidInput("visible fraction: at least one viewpoint, each with a weight, is needed");
  }
  if (options.subdivision < 1 || options.subdivision > 64) {
    throw InvalidInput("visible fraction: subdivision is " + std::to_string(options.subdivision) +
                       "; it must lie between 1 and 64");
  }
  if (!mesh.positions.allFinite()) {
    throw InvalidInput("visible fraction: a vertex position is not finite");
  }
  const Point low = mesh.positions.colwise().minCoeff().transpose();
  const Point high = mesh.positions.colwise().maxCoeff().transpose();
  const Point centre = (low + high) / 2;
  const double radius = (high - low).norm() / 2;
  const Occluders occluders(mesh, centre);
  const std::vector<Vector> samples = subTriangleCentroids(options.subdivision);

  VisibleFraction result;
  result.face.setZero(mesh.faceCount());
  parallelFor(static_cast<std::size_t>(mesh.faceCount()), kGrain, [&](std::size_t i) {
    const auto f = static_cast<Eigen::Index>(i);
    const Point a = mesh.corner(f, 0) - centre;
    const Point b = mesh.corner(f, 1) - centre;
    const Point c = mesh.corner(f, 2) - centre;
    const Vector normal = (b - a).cross(c - a);
    double seen = 0;
    for (std::size_t p = 0; p < viewpoints.points.size(); ++p) {
      const Point target = viewpoints.points[p] - centre;
      if (!(normal.dot(target - a) > 0)) continue;  // turned away
      int clear = 0;
      std::array<Point, Occluders::kPacket> from;
      std::array<Vector, Occluders::kPacket> by;
      std::array<double, Occluders::kPacket> lengths;
      for (std::size_t first = 0; first < samples.size(); first += Occluders::kPacket) {
        const std::size_t count = std::min(Occluders::kPacket, samples.size() - first);
        for (std::size_t n = 0; n < count; ++n) {
          const Vector& s = samples[first + n];
          from[n] = s[0] * a + s[1] * b + s[2] * c;
          const Vector toTarget = target - from[n];
          const double distance = toTarget.norm();
          by[n] = toTarget / distance;
          // Nothing lies beyond the mesh's ball: a far viewpoint costs no precision.
          lengths[n] = std::min(distance, from[n].norm() + 1.001 * radius);
        }
        clear += occluders.countClear({from.data(), count}, {by.data(), count},
                                      {lengths.data(), count}, static_cast<std::uint32_t>(i));
      }
      seen += viewpoints.weights[p] * clear / static_cast<double>(samples.size());
    }
    result.face[f] = seen;
  });

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
  return result;
}

}  // namespace explica::visibility
