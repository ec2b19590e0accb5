// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <embree3/rtcore.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace explica::visibility {

/// Faces that stand between a place and who looks at it: Embree in single precision, robust
/// traversal.
class Occluders {
 public:
  /// @param centre  origin of the positions that rays start from
  /// @throws EnvironmentError  Embree cannot start, or memory does not suffice
  Occluders(const TriangleMesh& mesh, const Point& centre);

  /// Rays that are cast together.
  static constexpr std::size_t kPacket = 16;

  struct Packet {
    RTCRay16 rays = {};
    std::array<std::uint32_t, kPacket> faces;
    std::size_t count = 0;
    /// @param from  where it starts, mm about centre
    /// @param by    unit direction
    /// @param face  that does not count
    void add(const Point& from, const Vector& by, double length, std::uint32_t face);
  };
  /// Bit n is set if no face but its own meets ray n.  The rays are spent.
  [[nodiscard]] std::uint32_t clear(Packet& packet) const;

 private:
  struct ReleaseDevice {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  };
  struct ReleaseScene {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseDevice> device_;
  std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene> scene_;
};

}  // namespace explica::visibility
