// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Visibility/VisibleFraction.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <embree3/rtcore.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
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

  /// True if a face other than `face` meets the segment from `from` along `direction`, mm about
  /// centre.
  [[nodiscard]] bool hides(const Point& from, const Vector& direction, double length,
                           std::uint32_t face) const {
    OwnFaceContext context;
    rtcInitIntersectContext(&context.base);
    context.base.filter = ignoreOwnFace;
    context.face = face;
    RTCRay ray;
    ray.org_x = static_cast<float>(from.x());
    ray.org_y = static_cast<float>(from.y());
    ray.org_z = static_cast<float>(from.z());
    ray.dir_x = static_cast<float>(direction.x());
    ray.dir_y = static_cast<float>(direction.y());
    ray.dir_z = static_cast<float>(direction.z());
    ray.tnear = 0;
    ray.tfar = static_cast<float>(length);
    ray.time = 0;
    ray.mask = 0xffffffffU;
    ray.id = 0;
    ray.flags = 0;
    rtcOccluded1(scene_.get(), &context.base, &ray);
    return ray.tfar < 0;
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
      for (const Vector& s : samples) {
        const Point x = s[0] * a + s[1] * b + s[2] * c;
        const Vector toTarget = target - x;
        const double distance = toTarget.norm();
        // Nothing lies beyond the mesh's ball: a far viewpoint costs no precision.
        const double length = std::min(distance, x.norm() + 1.001 * radius);
        if (!occluders.hides(x, toTarget / distance, length, static_cast<std::uint32_t>(i)))
          ++clear;
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
