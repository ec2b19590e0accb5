// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <cstdint>

namespace explica::surface {

/// What a surface has to keep clear of itself.
struct Room {
  double gap = 0;        ///< between a vertex and a face, or two edges, that share no vertex, mm
  double leastArea = 0;  ///< of a face, mm^2
};

/// What surfaces of a volume keep: some hundredths of a voxel, and of their edges if these are
/// finer.
/// @param voxel  its shortest edge, mm
/// @param edge   mean edge of the surfaces, mm
[[nodiscard]] Room roomFor(double voxel, double edge);

/// What has less room than that: pairs and faces.
struct Cramped {
  std::int64_t pairs = 0;
  std::int64_t faces = 0;
};

/// Gives a surface room where it almost touches itself or has shrunk to almost nothing: pairs that
/// are nearer than a gap are pushed apart (banks of a sulcus that growth has brought into contact;
/// corners of faces less high than that), and too small faces grow, which widens the thin thread
/// that they go around.  A vertex moves by no more than the gap, or where faces are too small by
/// the root of their least area, and none through the surface; the others, and all faces, stay.
/// @param mesh  without self-intersection; positions are float32 numbers
/// @return  what is left.  Does not depend on the number of threads.
Cramped keepRoom(TriangleMesh& mesh, const Room& room);

}  // namespace explica::surface
