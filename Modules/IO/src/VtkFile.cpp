// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/VtkFile.h"

#include "Bytes.h"
#include "VtkWriter.h"
#include "Xml.h"

#include "Explica/Core/WholeFile.h"

#include <array>

namespace explica::io {
namespace {

struct VtkCell {
  std::uint8_t type;  ///< VTK's number
  Eigen::Index corners;
};

VtkCell cellOf(CellKind kind) {
  constexpr std::array<VtkCell, 3> kCells = {{{3, 2}, {9, 4}, {12, 8}}};  // as CellKind has them
  return kCells[static_cast<std::size_t>(kind)];
}

void writeDocument(const std::filesystem::path& path, const std::string& type,
                   const std::string& body, const AppendedArrays& arrays) {
  WholeFile file(path);
  file.write("<?xml version=\"1.0\"?>\n<VTKFile type=\"" + type +
             "\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<" + type +
             ">\n" + body + "</" + type + ">\n<AppendedData encoding=\"raw\">\n_");
  file.write(arrays.bytes().data(), arrays.bytes().size());
  file.write("\n</AppendedData>\n</VTKFile>\n");
  file.commit();
}

std::string spaceField(AppendedArrays& arrays) {
  // Viewers differ on what they assume (Slicer: LPS), so the file says it.
  const std::int32_t one = 1;
  return "<FieldData>\n" +
         arrays.add("SpaceRAS", "Int32", 1, &one, sizeof(one), " NumberOfTuples=\"1\"") +
         "</FieldData>\n";
}

std::string offsetsOf(AppendedArrays& arrays, const std::vector<std::int32_t>& offsets) {
  return arrays.add("offsets", "Int32", 1, offsets.data(), offsets.size() * sizeof(std::int32_t));
}

/// Ends of `count` cells of `length` vertices each.
std::vector<std::int32_t> evenOffsets(Eigen::Index count, int length) {
  std::vector<std::int32_t> offsets(static_cast<std::size_t>(count));
  for (std::size_t c = 0; c < offsets.size(); ++c) {
    offsets[c] = static_cast<std::int32_t>((c + 1) * static_cast<std::size_t>(length));
  }
  return offsets;
}

std::string mapsOf(AppendedArrays& arrays, const std::filesystem::path& path, const char* element,
                   const std::vector<VertexMap>& maps, Eigen::Index count) {
  std::string text = std::string("<") + element + ">\n";
  for (const VertexMap& map : maps) {
    if (map.values.size() != count) {
      throw InvalidInput("map '" + map.name + "' for " + quoted(path) + ": it has " +
                         std::to_string(map.values.size()) + " values; " + std::to_string(count) +
                         " are needed");
    }
    text += arrays.add(map.name, "Float64", 1, map.values.data(),
                       static_cast<std::size_t>(map.values.size()) * sizeof(double));
  }
  return text + "</" + element + ">\n";
}

std::string pointsOf(AppendedArrays& arrays, const Positions& points) {
  return "<Points>\n" +
         arrays.add("Points", "Float64", 3, points.data(),
                    static_cast<std::size_t>(points.size()) * sizeof(double)) +
         "</Points>\n";
}

}  // namespace

std::string AppendedArrays::add(const std::string& name, const char* type, int components,
                                const void* values, std::size_t size, const char* more) {
  const std::size_t offset = bytes_.size();
  append(bytes_, static_cast<std::uint64_t>(size), false);
  const auto* from = static_cast<const std::uint8_t*>(values);
  bytes_.insert(bytes_.end(), from, from + size);
  return std::string("<DataArray type=\"") + type + "\" Name=\"" + escapedXml(name) +
         "\" NumberOfComponents=\"" + std::to_string(components) + "\"" + more +
         " format=\"appended\" offset=\"" + std::to_string(offset) + "\"/>\n";
}

void writePolyData(const std::filesystem::path& path, const Positions& points, const char* cellName,
                   const std::int32_t* connectivity, Eigen::Index cellCount, int cellLength,
                   const std::vector<VertexMap>& pointMaps,
                   const std::vector<VertexMap>& cellMaps) {
  AppendedArrays arrays;
  std::string body = spaceField(arrays);
  const bool lines = std::string_view(cellName) == "Lines";
  body += "<Piece NumberOfPoints=\"" + std::to_string(points.rows()) +
          "\" NumberOfVerts=\"0\" NumberOfLines=\"" + std::to_string(lines ? cellCount : 0) +
          "\" NumberOfStrips=\"0\" NumberOfPolys=\"" + std::to_string(lines ? 0 : cellCount) +
          "\">\n";
  body += mapsOf(arrays, path, "PointData", pointMaps, points.rows());
  body += mapsOf(arrays, path, "CellData", cellMaps, cellCount);
  body += pointsOf(arrays, points);
  body += std::string("<") + cellName + ">\n" +
          arrays.add("connectivity", "Int32", 1, connectivity,
                     static_cast<std::size_t>(cellCount * cellLength) * sizeof(std::int32_t)) +
          offsetsOf(arrays, evenOffsets(cellCount, cellLength)) + "</" + cellName + ">\n</Piece>\n";
  writeDocument(path, "PolyData", body, arrays);
}

void writeVtp(const std::filesystem::path& path, const TriangleMesh& mesh,
              const std::vector<VertexMap>& vertexMaps, const std::vector<VertexMap>& faceMaps) {
  writePolyData(path, mesh.positions, "Polys", mesh.faces.data(), mesh.faceCount(), 3, vertexMaps,
                faceMaps);
}

void writeVtu(const std::filesystem::path& path, const Positions& points,
              const std::vector<Cells>& cells, const std::vector<VertexMap>& pointMaps,
              const std::vector<VertexMap>& cellMaps) {
  std::vector<std::int32_t> connectivity;
  std::vector<std::int32_t> offsets;
  std::vector<std::uint8_t> types;
  for (const Cells& group : cells) {
    if (group.vertices.rows() > 0 && group.vertices.cols() != cellOf(group.kind).corners) {
      throw InvalidInput("cells for " + quoted(path) + ": rows of " +
                         std::to_string(group.vertices.cols()) + " vertices; their kind has " +
                         std::to_string(cellOf(group.kind).corners));
    }
    connectivity.insert(connectivity.end(), group.vertices.data(),
                        group.vertices.data() + group.vertices.size());
    for (Eigen::Index c = 0; c < group.vertices.rows(); ++c) {
      const std::int32_t before = offsets.empty() ? 0 : offsets.back();
      offsets.push_back(before + static_cast<std::int32_t>(group.vertices.cols()));
      types.push_back(cellOf(group.kind).type);
    }
  }
  const auto cellCount = static_cast<Eigen::Index>(offsets.size());
  AppendedArrays arrays;
  std::string body = spaceField(arrays);
  body += "<Piece NumberOfPoints=\"" + std::to_string(points.rows()) + "\" NumberOfCells=\"" +
          std::to_string(cellCount) + "\">\n";
  body += mapsOf(arrays, path, "PointData", pointMaps, points.rows());
  body += mapsOf(arrays, path, "CellData", cellMaps, cellCount);
  body += pointsOf(arrays, points);
  body += "<Cells>\n" +
          arrays.add("connectivity", "Int32", 1, connectivity.data(),
                     connectivity.size() * sizeof(std::int32_t)) +
          offsetsOf(arrays, offsets) + arrays.add("types", "UInt8", 1, types.data(), types.size()) +
          "</Cells>\n</Piece>\n";
  writeDocument(path, "UnstructuredGrid", body, arrays);
}

}  // namespace explica::io
