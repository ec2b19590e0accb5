// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/PolygonFile.h"

#include "ByteSource.h"
#include "VtkFormat.h"
#include "VtkWriter.h"

#include "Explica/Core/WholeFile.h"

#include <array>
#include <cmath>
#include <optional>

namespace explica::io {
namespace {

using Points2 = std::vector<std::array<double, 2>>;

/// The first two numbers of a line, if it starts with two numbers.
std::optional<std::array<double, 2>> numbersOf(std::string_view line) {
  std::array<double, 2> numbers{};
  std::size_t at = 0;
  for (double& number : numbers) {
    at = std::min(line.find_first_not_of(" \t,;\"", at), line.size());
    if (at < line.size() && line[at] == '+') ++at;
    const auto [end, error] = std::from_chars(line.data() + at, line.data() + line.size(), number);
    if (error != std::errc{}) return {};
    at = static_cast<std::size_t>(end - line.data());
    if (at < line.size() && std::string_view(" \t,;\"").find(line[at]) == std::string_view::npos) {
      return {};
    }
  }
  return numbers;
}

Points2 readText(const std::filesystem::path& path, ByteView bytes) {
  Points2 points;
  ByteCursor cursor(path, bytes, false);
  bool headerSeen = false;
  for (std::size_t lineNumber = 1; cursor.left() > 0; ++lineNumber) {
    const std::string_view line = cursor.line();
    const std::size_t start = line.find_first_not_of(" \t");
    if (start == std::string_view::npos || line[start] == '#') continue;
    const std::optional<std::array<double, 2>> numbers = numbersOf(line);
    if (numbers) {
      points.push_back(*numbers);
    } else if (points.empty() && !headerSeen) {
      headerSeen = true;
    } else {
      failToRead(path, "line " + std::to_string(lineNumber) + " does not start with two numbers");
    }
  }
  return points;
}

/// Follows cells that link points to the one loop that they form.
std::vector<std::int64_t> loopOf(const std::filesystem::path& path, const PolyData& data) {
  const auto count = static_cast<std::int64_t>(data.coordinates.size() / 3);
  if (data.polygons.count() + data.strips.count() > 1) {
    refuse(path, "holds several faces; one closed polygon is needed");
  }
  std::vector<std::array<std::int64_t, 2>> neighbours(static_cast<std::size_t>(count), {-1, -1});
  const auto join = [&](std::int64_t from, std::int64_t to) {
    for (const auto& [vertex, other] : {std::pair{from, to}, std::pair{to, from}}) {
      if (vertex < 0 || vertex >= count) {
        refuse(path,
               "names point " + std::to_string(vertex) + "; there are " + std::to_string(count));
      }
      auto& pair = neighbours[vertex];
      if (pair[1] >= 0) refuse(path, "its lines branch; one closed polygon is needed");
      pair[pair[0] >= 0 ? 1 : 0] = other;
    }
  };
  std::int64_t links = 0;
  std::int64_t first = -1;
  const auto follow = [&](const CellList& cells, bool closed) {
    for (std::size_t c = 0; c < cells.count(); ++c) {
      const std::int64_t begin = cells.offsets[c];
      const std::int64_t end = cells.offsets[c + 1];
      if (begin < end && first < 0) first = cells.connectivity[begin];
      for (std::int64_t i = begin; i + 1 < end; ++i, ++links) {
        join(cells.connectivity[i], cells.connectivity[i + 1]);
      }
      if (closed && end - begin > 2) {
        join(cells.connectivity[end - 1], cells.connectivity[begin]);
        ++links;
      }
    }
  };
  follow(data.lines, false);
  follow(data.polygons, true);
  std::vector<std::int64_t> loop;
  if (first < 0) {  // points alone: their order is the polygon
    for (std::int64_t v = 0; v < count; ++v) loop.push_back(v);
    return loop;
  }
  std::int64_t before = -1;
  std::int64_t at = first;
  do {
    loop.push_back(at);
    const auto& pair = neighbours[at];
    const std::int64_t next = before < 0 || pair[0] != before ? pair[0] : pair[1];
    if (next < 0) refuse(path, "its line is open; one closed polygon is needed");
    before = at;
    at = next;
  } while (at != first && static_cast<std::int64_t>(loop.size()) <= count);
  if (at != first || static_cast<std::int64_t>(loop.size()) != links) {
    refuse(path, "its lines form several loops; one closed polygon is needed");
  }
  return loop;
}

Points2 readVtk(const std::filesystem::path& path, ByteView bytes) {
  const PolyData data = readPolyData(path, bytes);
  Points2 points;
  for (const std::int64_t v : loopOf(path, data)) {
    const double* x = data.coordinates.data() + 3 * v;
    points.push_back({x[0], x[1]});
    const double z0 = data.coordinates[2];
    if (!(std::abs(x[2] - z0) <= 1e-6 * (1 + std::abs(z0)))) {
      refuse(path, "is not planar: its z differs; a polygon in a plane of constant z is needed");
    }
  }
  return points;
}

}  // namespace

Positions2 readPolygon(const std::filesystem::path& path) {
  const Bytes bytes = ByteSource(path).rest();
  Points2 points = looksLikeVtkLegacy(bytes) || looksLikeVtkXml(bytes) ? readVtk(path, bytes)
                                                                       : readText(path, bytes);
  if (points.size() > 1 && points.front() == points.back()) points.pop_back();
  if (points.size() < 3) {
    refuse(path, "holds " + std::to_string(points.size()) +
                     " points; a polygon of at least 3 (x, y a line) is needed");
  }
  Positions2 polygon(static_cast<Eigen::Index>(points.size()), 2);
  for (std::size_t v = 0; v < points.size(); ++v) {
    const auto row = static_cast<Eigen::Index>(v);
    polygon.row(row) << points[v][0], points[v][1];
    if (!polygon.row(row).allFinite()) {
      refuse(path, "vertex " + std::to_string(v) + " has a coordinate that is not finite");
    }
    if (polygon.row(row).cwiseAbs().maxCoeff() > kFarthest) {
      refuse(path, "vertex " + std::to_string(v) +
                       " lies farther than 10 km from the origin; coordinates are in mm");
    }
  }
  return polygon;
}

void writePolygonCsv(const std::filesystem::path& path, const Positions2& polygon) {
  std::string text = "x,y\n";
  for (const auto& point : polygon.rowwise()) appendRow(text, "", point, ',');
  writeTextFile(path, text);
}

void writePolygonVtp(const std::filesystem::path& path, const Positions2& polygon,
                     const std::vector<VertexMap>& vertexMaps,
                     const std::vector<VertexMap>& edgeMaps) {
  Positions points = Positions::Zero(polygon.rows(), 3);
  points.leftCols<2>() = polygon;
  Edges edges(polygon.rows(), 2);
  for (Eigen::Index v = 0; v < polygon.rows(); ++v) {
    edges.row(v) << static_cast<std::int32_t>(v),
        static_cast<std::int32_t>((v + 1) % polygon.rows());
  }
  writePolyData(path, points, "Lines", edges.data(), edges.rows(), 2, vertexMaps, edgeMaps);
}

}  // namespace explica::io
