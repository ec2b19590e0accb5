// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Maps/Icosphere.h"

#include "Explica/Core/Errors.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace explica::maps {
namespace {

constexpr double kRadius = 100;     // of FreeSurfer's spheres, mm
constexpr double kDecimals = 1e4;   // of the coordinates in FreeSurfer's icosahedra
constexpr int kFsaverageLevel = 7;  // divisions: 163,842 vertices

/// The icosahedron whose poles are 0 and 11, numbered as FreeSurfer does.
TriangleMesh icosahedron() {
  TriangleMesh mesh{Positions(12, 3), Faces(20, 3)};
  const double z = 1 / std::sqrt(5.0);
  constexpr std::array<int, 5> kUpper = {2, 3, 4, 5, 1}, kLower = {8, 9, 10, 6, 7};
  mesh.positions.row(0) << 0, 0, 1;
  mesh.positions.row(11) << 0, 0, -1;
  for (int k = 0; k < 5; ++k) {
    const double up = 2 * kPi * k / 5, down = up + kPi / 5;
    mesh.positions.row(kUpper[k]) << 2 * z * std::cos(up), 2 * z * std::sin(up), z;
    mesh.positions.row(kLower[k]) << 2 * z * std::cos(down), 2 * z * std::sin(down), -z;
  }
  mesh.faces << 0, 3, 4, 0, 4, 5, 0, 5, 1, 0, 1, 2, 0, 2, 3, 3, 2, 8, 3, 8, 9, 3, 9, 4, 4, 9,
      10,                                                                                      //
      4, 10, 5, 5, 10, 6, 5, 6, 1, 1, 6, 7, 1, 7, 2, 2, 7, 8, 8, 11, 9, 9, 11, 10, 10, 11, 6,  //
      6, 11, 7, 7, 11, 8;
  return mesh;
}

/// Every face into four: first those at first corners, in the order of the faces, then the three
/// others of each face; new vertices in the order in which the faces' edges c-a, b-c, a-b name
/// them.
TriangleMesh divided(const TriangleMesh& mesh) {
  const Eigen::Index vertices = mesh.vertexCount(), faces = mesh.faceCount();
  TriangleMesh fine{Positions(4 * vertices - 6, 3), Faces(4 * faces, 3)};
  fine.positions.topRows(vertices) = mesh.positions;
  std::unordered_map<std::int64_t, std::int32_t> middles;
  const auto middle = [&](std::int32_t a, std::int32_t b) {
    const auto next =
        static_cast<std::int32_t>(vertices + static_cast<Eigen::Index>(middles.size()));
    const auto [at, added] =
        middles.try_emplace(std::int64_t{std::min(a, b)} << 32 | std::max(a, b), next);
    if (added) {
      fine.positions.row(next) = (mesh.positions.row(a) + mesh.positions.row(b)).normalized();
    }
    return at->second;
  };
  for (Eigen::Index f = 0; f < faces; ++f) {
    const std::int32_t a = mesh.faces(f, 0), b = mesh.faces(f, 1), c = mesh.faces(f, 2);
    const std::int32_t ca = middle(c, a), bc = middle(b, c), ab = middle(a, b);
    fine.faces.row(f) << a, ab, ca;
    fine.faces.middleRows<3>(faces + 3 * f) << ca, bc, c, ab, bc, ca, ab, b, bc;
  }
  return fine;
}

}  // namespace

TriangleMesh fsaverageSphere(int level) {
  if (level < 0 || level > kFsaverageLevel) {
    throw InvalidInput("fsaverage's sphere has levels 0 to 7, not " + std::to_string(level));
  }
  TriangleMesh mesh = icosahedron();
  for (int k = 0; k < level; ++k) mesh = divided(mesh);
  mesh.positions = (kDecimals * mesh.positions.array()).round() / kDecimals;
  mesh.positions = kRadius * mesh.positions.rowwise().normalized();
  return mesh;
}

std::optional<int> fsaverageLevel(std::string_view name) {
  if (name == "fsaverage") return kFsaverageLevel;
  for (int level = 3; level < kFsaverageLevel; ++level) {
    if (name == "fsaverage" + std::to_string(level)) return level;
  }
  return {};
}

}  // namespace explica::maps
