// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "MeshBuilder.h"

#include "SurfaceFrame.h"

#include <cmath>
#include <limits>

namespace explica::io {
void MeshBuilder::addPolygon(const std::filesystem::path& path, const std::int64_t* corners,
                             std::size_t count) {
  if (count < 3) failToRead(path, "has a face of " + std::to_string(count) + " corners");
  splitPolygons += count > 3;
  for (std::size_t k = 2; k < count; ++k) {
    triangles.insert(triangles.end(), {vertexNumber(corners[0]), vertexNumber(corners[k - 1]),
                                       vertexNumber(corners[k])});
  }
}

std::int32_t MeshBuilder::vertexNumber(std::int64_t inFile) {
  return inFile < 0 || inFile > std::numeric_limits<std::int32_t>::max()
             ? -1
             : static_cast<std::int32_t>(inFile);
}

LoadedSurface MeshBuilder::finish(const std::filesystem::path& path, const char* format) {
  const std::size_t vertexCount = coordinates.size() / 3;
  const std::size_t faceCount = triangles.size() / 3;
  if (vertexCount == 0 || faceCount == 0) refuse(path, "holds no triangles; a surface is needed");
  if (std::max(vertexCount, faceCount) > std::numeric_limits<std::int32_t>::max()) {
    refuse(path, "has more vertices or faces than 32-bit indices count");
  }
  LoadedSurface surface;
  surface.origin.path = path;
  surface.origin.format = format;
  surface.metadata.structure = structureFromName(path);
  TriangleMesh& mesh = surface.mesh;
  mesh.positions.resize(static_cast<Eigen::Index>(vertexCount), 3);
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    if (!std::isfinite(coordinates[i])) {
      refuse(path, "vertex " + std::to_string(i / 3) + " has a coordinate that is not finite");
    }
    if (std::abs(coordinates[i]) > kFarthest) {
      refuse(path, "vertex " + std::to_string(i / 3) +
                       " lies farther than 10 km from the origin; coordinates are in mm");
    }
    mesh.positions.data()[i] = coordinates[i];
  }
  std::vector<double>().swap(coordinates);
  mesh.faces.resize(static_cast<Eigen::Index>(faceCount), 3);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::int32_t vertex = triangles[i];
    if (vertex < 0 || static_cast<std::size_t>(vertex) >= vertexCount) {
      refuse(path, "face " + std::to_string(i / 3) + " names " +
                       (vertex < 0 ? "a vertex of a negative or huge number"
                                   : "vertex " + std::to_string(vertex)) +
                       "; there are " + std::to_string(vertexCount));
    }
    mesh.faces.data()[i] = vertex;
  }
  if (splitPolygons > 0) {
    surface.origin.notes.push_back(std::to_string(splitPolygons) +
                                   " polygons were split into triangles");
  }
  return surface;
}

std::size_t checkedCount(const std::filesystem::path& path, std::int64_t count,
                         std::size_t bytesLeft, std::size_t bytesEach, const char* what) {
  if (count < 0 || static_cast<std::uint64_t>(count) > bytesLeft / bytesEach) {
    failTruncated(path,
                  "announces " + std::to_string(count) + " " + what + ", more than it can hold");
  }
  return static_cast<std::size_t>(count);
}

std::int64_t wholeNumber(const std::filesystem::path& path, double value) {
  constexpr double kLargest = 9e15;  // whole numbers that a double holds exactly
  if (!(std::abs(value) <= kLargest) || std::trunc(value) != value) {
    failToRead(path, "has a vertex number that is no whole number");
  }
  return static_cast<std::int64_t>(value);
}

void addColumns(std::vector<VertexMap>& maps, const std::string& name, const std::string& unit,
                const std::vector<double>& values, std::size_t columns) {
  for (std::size_t c = 0; c < columns; ++c) {
    VertexMap map{columns > 1 ? name + "[" + std::to_string(c) + "]" : name, unit,
                  Eigen::VectorXd(static_cast<Eigen::Index>(values.size() / columns))};
    for (Eigen::Index row = 0; row < map.values.size(); ++row) {
      map.values[row] = values[static_cast<std::size_t>(row) * columns + c];
    }
    maps.push_back(std::move(map));
  }
}

}  // namespace explica::io
