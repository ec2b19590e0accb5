// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Occluders.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <array>
#include <new>

namespace explica::visibility {
namespace {

struct PacketContext {
  RTCIntersectContext base;
  const std::uint32_t* faces;  ///< of each ray its own, which must not hide it
};

void ignoreOwnFace(const RTCFilterFunctionNArguments* args) {
  const auto* context = reinterpret_cast<const PacketContext*>(args->context);
  for (unsigned int i = 0; i < args->N; ++i) {
    if (args->valid[i] != -1) continue;
    const unsigned int ray = RTCRayN_id(args->ray, args->N, i);
    if (RTCHitN_primID(args->hit, args->N, i) == context->faces[ray]) args->valid[i] = 0;
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

void Occluders::Packet::add(const Point& from, const Vector& by, double length,
                            std::uint32_t face) {
  rays.org_x[count] = static_cast<float>(from.x());
  rays.org_y[count] = static_cast<float>(from.y());
  rays.org_z[count] = static_cast<float>(from.z());
  rays.dir_x[count] = static_cast<float>(by.x());
  rays.dir_y[count] = static_cast<float>(by.y());
  rays.dir_z[count] = static_cast<float>(by.z());
  rays.tfar[count] = static_cast<float>(length);
  rays.mask[count] = 0xffffffffU;
  rays.id[count] = static_cast<std::uint32_t>(count);
  faces[count++] = face;
}

std::uint32_t Occluders::clear(Packet& packet) const {
  PacketContext context;
  rtcInitIntersectContext(&context.base);
  context.base.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  context.base.filter = ignoreOwnFace;
  context.faces = packet.faces.data();
  alignas(64) std::array<int, kPacket> valid = {};
  std::fill_n(valid.begin(), packet.count, -1);
  rtcOccluded16(valid.data(), scene_.get(), &context.base, &packet.rays);
  std::uint32_t clear = 0;
  for (std::size_t n = 0; n < packet.count; ++n) {
    if (!(packet.rays.tfar[n] < 0)) clear |= 1U << n;
  }
  return clear;
}

}  // namespace explica::visibility
