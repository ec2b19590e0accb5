// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/PatchFile.h"

#include "ByteSource.h"
#include "MeshBuilder.h"

#include "Explica/Core/WholeFile.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

namespace explica::io {
namespace {

// int32 -1, int32 count, then per vertex int32 +-(number + 1), negative on the border, and three
// float32; everything big-endian.
constexpr std::int32_t kMark = -1;
constexpr std::size_t kEntry = 16;

std::vector<bool> membersOf(const Patch& patch, Eigen::Index vertexCount) {
  std::vector<bool> member(static_cast<std::size_t>(vertexCount));
  for (const std::int32_t v : patch.vertices) {
    if (v < 0 || v >= vertexCount) {
      throw InvalidInput("patch: names vertex " + std::to_string(v) + "; the surface has " +
                         std::to_string(vertexCount));
    }
    member[v] = true;
  }
  return member;
}

/// Vertices at the sides that one face of the list alone has.
std::vector<bool> rimOf(const Faces& faces, Eigen::Index vertexCount) {
  std::vector<std::pair<std::int32_t, std::int32_t>> sides;
  sides.reserve(static_cast<std::size_t>(faces.size()));
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) sides.push_back(std::minmax(faces(f, k), faces(f, (k + 1) % 3)));
  }
  std::ranges::sort(sides);
  std::vector<bool> rim(static_cast<std::size_t>(vertexCount));
  for (auto side = sides.begin(); side != sides.end();) {
    const auto next = std::find_if(side, sides.end(), [&](const auto& s) { return s != *side; });
    if (next == side + 1) rim[side->first] = rim[side->second] = true;
    side = next;
  }
  return rim;
}

}  // namespace

Patch readPatch(const std::filesystem::path& path, std::optional<Eigen::Index> vertexCount) {
  const Bytes bytes = ByteSource(path).rest();
  ByteCursor cursor(path, bytes, true);
  if (cursor.left() < 8 || cursor.take<std::int32_t>() != kMark) {
    failToRead(path, "is not a FreeSurfer patch");
  }
  const auto announced = cursor.take<std::int32_t>();
  const std::size_t count = checkedCount(path, announced, cursor.left(), kEntry, "vertices");
  Patch patch;
  patch.vertices.reserve(count);
  patch.border.reserve(count);
  patch.positions.resize(static_cast<Eigen::Index>(count), 3);
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t code = cursor.take<std::int32_t>();
    const std::int64_t vertex = std::abs(code) - 1;
    if (vertex < 0) failToRead(path, "has the vertex code 0, which stands for no vertex");
    if (vertexCount && vertex >= *vertexCount) {
      refuse(path, "names vertex " + std::to_string(vertex) + "; the surface has " +
                       std::to_string(*vertexCount) + ": is it another surface's patch?");
    }
    patch.vertices.push_back(static_cast<std::int32_t>(vertex));
    patch.border.push_back(code < 0);
    for (int axis = 0; axis < 3; ++axis) {
      const double value = cursor.take<float>();
      if (!std::isfinite(value)) {
        refuse(path, "vertex " + std::to_string(vertex) + " has a coordinate that is not finite");
      }
      patch.positions(static_cast<Eigen::Index>(i), axis) = value;
    }
  }
  std::vector<std::int32_t> sorted = patch.vertices;
  std::ranges::sort(sorted);
  const auto twice = std::ranges::adjacent_find(sorted);
  if (twice != sorted.end()) {
    refuse(path, "names vertex " + std::to_string(*twice) + " twice");
  }
  return patch;
}

void writePatch(const std::filesystem::path& path, const Patch& patch) {
  const std::size_t count = patch.vertices.size();
  if (count == 0 || patch.border.size() != count ||
      patch.positions.rows() != static_cast<Eigen::Index>(count)) {
    throw InvalidInput("patch for " + quoted(path) +
                       ": it has no vertices, or not one place and one border mark for each");
  }
  Bytes bytes;
  bytes.reserve(8 + kEntry * count);
  append(bytes, kMark, true);
  append(bytes, static_cast<std::int32_t>(count), true);
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t code = patch.vertices[i] + 1;
    append(bytes, patch.border[i] ? -code : code, true);
    for (int axis = 0; axis < 3; ++axis) {
      append(bytes, static_cast<float>(patch.positions(static_cast<Eigen::Index>(i), axis)), true);
    }
  }
  writeTextFile(path, textOf(bytes));
}

bool isPatchFile(const std::filesystem::path& path) {
  ByteSource source(path);
  const ByteView first = source.peek(8);
  return first.size() == 8 && load<std::int32_t>(first.data(), true) == kMark;
}

Faces patchFaces(const Patch& patch, const Faces& faces, Eigen::Index vertexCount) {
  const std::vector<bool> member = membersOf(patch, vertexCount);
  Faces kept(faces.rows(), 3);
  Eigen::Index count = 0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    if (member[faces(f, 0)] && member[faces(f, 1)] && member[faces(f, 2)]) {
      kept.row(count++) = faces.row(f);
    }
  }
  kept.conservativeResize(count, 3);
  return kept;
}

Patch patchOf(const TriangleMesh& mesh, const std::vector<bool>& inPatch) {
  Patch patch;
  for (std::int32_t v = 0; v < mesh.vertexCount(); ++v) {
    if (inPatch.at(v)) patch.vertices.push_back(v);
  }
  const Faces faces = patchFaces(patch, mesh.faces, mesh.vertexCount());
  const std::vector<bool> rim = rimOf(faces, mesh.vertexCount());
  patch.positions.resize(static_cast<Eigen::Index>(patch.vertices.size()), 3);
  for (std::size_t i = 0; i < patch.vertices.size(); ++i) {
    patch.border.push_back(rim[patch.vertices[i]]);
    patch.positions.row(i) = mesh.positions.row(patch.vertices[i]);
  }
  return patch;
}

}  // namespace explica::io
