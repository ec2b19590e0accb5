// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Occluders.h"

#include "Explica/Core/Errors.h"

#include <array>
#include <new>

namespace explica::visibility {
namespace {

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

}  // namespace

Occluders::Occluders(const TriangleMesh& mesh, const Point& centre)
    : device_(rtcNewDevice(nullptr)) {
  if (!device_ && rtcGetDeviceError(nullptr) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
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

std::uint32_t Occluders::clear(std::span<const Point> from, std::span<const Vector> by,
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
  std::uint32_t clear = 0;
  for (std::size_t n = 0; n < from.size(); ++n) {
    if (!(rays.tfar[n] < 0)) clear |= 1U << n;
  }
  return clear;
}

}  // namespace explica::visibility
