// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <embree3/rtcore.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

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

  /// Bit n is set if no face other than `face` meets segment n, of at most kPacket.
  /// @param from  where they start, mm about centre
  /// @param by    unit directions
  [[nodiscard]] std::uint32_t clear(std::span<const Point> from, std::span<const Vector> by,
                                    std::span<const double> lengths, std::uint32_t face) const;

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
