// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/Contours.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Correspondence/Trajectory.h"

#include <array>
#include <cmath>
#include <optional>

namespace explica::correspondence {

namespace {

using harmonic::Annulus;

/// A line of points where u is one half, continuous indices of the box.
struct Line {
  std::vector<Vector> points;
  bool closed = false;
};

/// Crossings of the half-way level with a slice's links, and how cells join them.
class SliceMarcher {
 public:
  SliceMarcher(const Annulus& annulus, const std::vector<double>& u, int slice)
      : annulus_(annulus), u_(u), slice_(slice), width_(annulus.size[0]) {
    const std::size_t links = 2ul * annulus.size[0] * annulus.size[1];
    joined_.assign(links, {-1, -1});
    for (int j = 0; j + 1 < annulus.size[1]; ++j) {
      for (int i = 0; i + 1 < annulus.size[0]; ++i) visitCell(i, j);
    }
  }

  [[nodiscard]] std::vector<Line> lines() const {
    std::vector<Line> found;
    std::vector<std::uint8_t> seen(joined_.size(), 0);
    const auto follow = [&](std::int32_t start) {
      Line line;
      std::int32_t at = start;
      while (at >= 0 && !seen[at]) {
        seen[at] = 1;
        line.points.push_back(crossing(at));
        const auto [a, b] = joined_[at];
        at = a >= 0 && !seen[a] ? a : (b >= 0 && !seen[b] ? b : -1);
      }
      return line;
    };
    // Lines with ends first, then rings.
    for (const bool ends : {true, false}) {
      for (std::size_t link = 0; link < joined_.size(); ++link) {
        const auto [a, b] = joined_[link];
        if (seen[link] || a < 0 || (ends && b >= 0)) continue;
        found.push_back(follow(static_cast<std::int32_t>(link)));
        found.back().closed = !ends;
      }
    }
    return found;
  }

 private:
  [[nodiscard]] std::int32_t codeAt(int i, int j) const {
    return annulus_.numberAt[i + annulus_.strides()[1] * j + annulus_.strides()[2] * slice_];
  }
  [[nodiscard]] std::optional<double> valueAt(int i, int j) const {
    const std::int32_t n = codeAt(i, j);
    if (n >= 0) return u_[n];
    if (n == harmonic::kInner) return 0.0;
    if (n == harmonic::kOuter) return 1.0;
    return {};
  }
  /// The link from (i, j) along an axis.
  [[nodiscard]] std::int32_t linkOf(int i, int j, int axis) const {
    return 2 * (i + width_ * j) + axis;
  }
  [[nodiscard]] Vector crossing(std::int32_t link) const {
    const int axis = link % 2, i = link / 2 % width_, j = link / 2 / width_;
    const double a = *valueAt(i, j), b = *valueAt(i + (axis == 0), j + (axis == 1));
    const double t = (0.5 - a) / (b - a);
    return {i + (axis == 0 ? t : 0), j + (axis == 1 ? t : 0), static_cast<double>(slice_)};
  }
  /// True between voxels of two banks: the boundary lies between them, not the middle.
  [[nodiscard]] bool isCut(int i, int j, int axis) const {
    const std::int32_t n = codeAt(i, j), m = codeAt(i + (axis == 0), j + (axis == 1));
    return n >= 0 && m >= 0 && annulus_.links[n][2 * axis + 1] != m;
  }
  void join(std::int32_t a, std::int32_t b) {
    (joined_[a][0] < 0 ? joined_[a][0] : joined_[a][1]) = b;
    (joined_[b][0] < 0 ? joined_[b][0] : joined_[b][1]) = a;
  }

  void visitCell(int i, int j) {
    // Corners and links run around the cell.
    const std::array<std::optional<double>, 4> value = {valueAt(i, j), valueAt(i + 1, j),
                                                        valueAt(i + 1, j + 1), valueAt(i, j + 1)};
    const std::array<std::int32_t, 4> link = {linkOf(i, j, 0), linkOf(i + 1, j, 1),
                                              linkOf(i, j + 1, 0), linkOf(i, j, 1)};
    const std::array<bool, 4> cut = {isCut(i, j, 0), isCut(i + 1, j, 1), isCut(i, j + 1, 0),
                                     isCut(i, j, 1)};
    double sum = 0;
    bool tissue = false;
    for (int c = 0; c < 4; ++c) {
      if (!value[c]) return;
      sum += *value[c];
    }
    for (const int n : {codeAt(i, j), codeAt(i + 1, j), codeAt(i, j + 1), codeAt(i + 1, j + 1)}) {
      tissue = tissue || n >= 0;
    }
    if (!tissue) return;
    std::array<int, 4> crossed{};
    int count = 0;
    for (int c = 0; c < 4; ++c) {
      const bool here = *value[c] < 0.5, there = *value[(c + 1) % 4] < 0.5;
      if (here != there && !cut[c]) crossed[count++] = c;
    }
    if (count == 2) join(link[crossed[0]], link[crossed[1]]);
    if (count != 4) return;
    // Two lines: the middle's side is joined.
    const bool together = (sum < 2) == (*value[0] < 0.5);
    join(link[0], link[together ? 1 : 3]);
    join(link[2], link[together ? 3 : 1]);
  }

  const Annulus& annulus_;
  const std::vector<double>& u_;
  int slice_;
  int width_;
  std::vector<std::array<std::int32_t, 2>> joined_;
};

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

std::vector<Contour> contoursOf(const Annulus& annulus, const harmonic::Interpolant& interpolant) {
  if (!annulus.planar) {
    throw InvalidInput("contours: the tissue is not measured slice by slice");
  }
  constexpr std::size_t kFewest = 3;
  const TrajectoryTracer tracer(annulus, interpolant);
  const Vector first(annulus.first[0], annulus.first[1], annulus.first[2]);
  std::vector<std::vector<Contour>> bySlice(annulus.size[2]);
  parallelFor(bySlice.size(), 1, [&](std::size_t slice) {
    const SliceMarcher marcher(annulus, interpolant.u, static_cast<int>(slice));
    for (const Line& line : marcher.lines()) {
      Contour contour;
      contour.slice = static_cast<int>(slice) + annulus.first[2];
      for (const Vector& at : line.points) {
        addPoint(tracer, annulus.grid.toWorld(at + first), contour);
      }
      contour.closed = line.closed && contour.inner.size() == line.points.size();
      if (contour.inner.size() >= kFewest) bySlice[slice].push_back(std::move(contour));
    }
  });
  std::vector<Contour> contours;
  for (std::vector<Contour>& found : bySlice) {
    for (Contour& contour : found) contours.push_back(std::move(contour));
  }
  return contours;
}

}  // namespace explica::correspondence
