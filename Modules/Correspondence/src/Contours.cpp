// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/Contours.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Field.h"
#include "HalfwaySurface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace explica::correspondence {

namespace {

/// A curve of vertices of the half-way surface, one after the other.
struct Line {
  std::vector<std::int32_t> vertices;
  bool closed = false;
};

/// Edges joined to lines: those with ends first, then rings.
std::vector<Line> linesOf(const HalfwaySurface& surface) {
  std::vector<std::array<std::int32_t, 2>> beside(surface.vertices.size(), {-1, -1});
  for (const auto& edge : surface.faces) {
    for (const auto& [from, to] : {std::pair{edge[0], edge[1]}, std::pair{edge[1], edge[0]}}) {
      (beside[from][0] < 0 ? beside[from][0] : beside[from][1]) = to;
    }
  }
  std::vector<Line> lines;
  std::vector<std::uint8_t> seen(beside.size(), 0);
  for (const bool ends : {true, false}) {
    for (std::size_t v = 0; v < beside.size(); ++v) {
      if (seen[v] || beside[v][0] < 0 || (ends && beside[v][1] >= 0)) continue;
      Line line{{}, !ends};
      for (auto at = static_cast<std::int32_t>(v); at >= 0 && !seen[at];) {
        seen[at] = 1;
        line.vertices.push_back(at);
        const auto [a, b] = beside[at];
        at = a >= 0 && !seen[a] ? a : b;
      }
      lines.push_back(std::move(line));
    }
  }
  return lines;
}

void addPoint(const TrajectoryTracer& tracer, const Point& start, Contour& contour) {
  const auto inward = tracer.path(start, 0), outward = tracer.path(start, 1);
  if (!inward || !outward) return;
  const double off = 0.5 * (outward->length() - inward->length());
  contour.inner.push_back(inward->points.back());
  contour.middle.push_back(off > 0 ? outward->at(off) : inward->at(-off));
  contour.outer.push_back(outward->points.back());
  contour.thickness.push_back(inward->length() + outward->length());
}

}  // namespace

std::vector<Contour> contoursOf(const harmonic::Annulus& annulus,
                                const harmonic::Interpolant& interpolant) {
  if (!annulus.planar) {
    throw InvalidInput("contours: the tissue is not measured slice by slice");
  }
  constexpr std::size_t kFewest = 3;
  const TrajectoryTracer tracer(annulus, interpolant);
  const HalfwaySurface surface = halfwaySurface(annulus, interpolant.u);
  const std::vector<Line> lines = linesOf(surface);
  std::vector<Contour> contours(lines.size());
  parallelFor(lines.size(), 1, [&](std::size_t n) {
    Contour& contour = contours[n];
    for (const std::int32_t v : lines[n].vertices) {
      addPoint(tracer, tracer.field().toWorld(surface.vertices[v].x), contour);
    }
    contour.slice = static_cast<int>(std::lround(surface.vertices[lines[n].vertices[0]].x[2])) +
                    annulus.first[2];
    contour.closed = lines[n].closed && contour.inner.size() == lines[n].vertices.size();
  });
  std::erase_if(contours, [](const Contour& c) { return c.inner.size() < kFewest; });
  std::stable_sort(contours.begin(), contours.end(),
                   [](const Contour& a, const Contour& b) { return a.slice < b.slice; });
  return contours;
}

}  // namespace explica::correspondence
