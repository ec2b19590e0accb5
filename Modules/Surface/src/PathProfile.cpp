// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "PathProfile.h"

#include "Explica/Core/OrderStatistics.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace explica::surface {

Along::Along(const Trajectory& path) : path_(path), length_(path.length()) {
  const std::size_t n = path.points.size();
  if (n < 2) return;
  inward_ = (path.points[0] - path.points[1]).normalized();
  outward_ = (path.points[n - 1] - path.points[n - 2]).normalized();
}

Point Along::at(double arc) const {
  if (arc < 0) return path_.points.front() - arc * inward_;
  if (arc > length_) return path_.points.back() + (arc - length_) * outward_;
  return path_.at(arc);
}

Point along(const Trajectory& path, double arc) {
  return Along(path).at(arc);
}

Trajectory between(const Trajectory& path, double from, double to) {
  Trajectory part;
  part.end = path.end;
  const Along whole(path);
  const auto add = [&](double arc) {
    part.points.push_back(whole.at(arc));
    part.along.push_back(static_cast<float>(arc - from));
  };
  add(from);
  for (const float arc : path.along) {
    const double rest = 1e-3 * (to - from);  // closer points would leave a direction to rounding
    if (arc > from + rest && arc < to - rest) add(arc);
  }
  add(to);
  return part;
}

double valueAt(const Volume<float>& image, const Point& p) {
  const Grid& grid = image.grid;
  const Vector index = grid.toIndex(p);
  std::array<int, 3> base;
  Vector t;
  for (int a = 0; a < 3; ++a) {
    if (!(index[a] >= 0 && index[a] <= grid.size[a] - 1)) return kNaN;
    base[a] = std::min(static_cast<int>(index[a]), std::max(0, grid.size[a] - 2));
    t[a] = index[a] - base[a];
  }
  const std::size_t line = grid.size[0], slice = line * grid.size[1];
  const float* const first = &image(base[0], base[1], base[2]);
  const Eigen::Array2d x(1 - t[0], t[0]);
  double sum = 0;
  for (int c = 0; c < 4; ++c) {
    const int j = c & 1, k = c >> 1;
    const Eigen::Array2d weight = x * (j ? t[1] : 1 - t[1]) * (k ? t[2] : 1 - t[2]);
    const float* const row = first + j * line + k * slice;
    if (weight[0] > 0) sum += weight[0] * row[0];
    if (weight[1] > 0) sum += weight[1] * row[1];
  }
  return sum;
}

double median(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  return values.empty() ? kNaN : upperMedian(std::move(values));
}

double usualLength(const std::vector<Trajectory>& paths) {
  std::vector<double> lengths;
  for (const Trajectory& path : paths) {
    if (path.length() > 0) lengths.push_back(path.length());
  }
  return median(std::move(lengths));
}

std::vector<std::int32_t> withinTwoEdges(std::size_t vertex,
                                         const geometry::MeshTopology& topology) {
  std::vector<std::int32_t> near = {static_cast<std::int32_t>(vertex)};
  for (const std::int32_t w : topology.vertexVertices[vertex]) {
    near.push_back(w);
    const auto second = topology.vertexVertices[w];
    near.insert(near.end(), second.begin(), second.end());
  }
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  return near;
}

VertexRows averaged(VertexRows values, const geometry::MeshTopology& topology, int times) {
  const auto columns = static_cast<std::size_t>(values.cols());
  VertexRows next(values.rows(), values.cols());
  for (int pass = 0; pass < times; ++pass) {
    parallelFor(topology.vertexVertices.size(), 1024, [&](std::size_t v) {
      const double* const own = values.data() + v * columns;
      double* const mean = next.data() + v * columns;
      std::copy(own, own + columns, mean);
      if (!std::isfinite(own[0])) return;
      int count = 1;
      for (const std::int32_t w : topology.vertexVertices[v]) {
        const double* const other = values.data() + w * columns;
        if (!std::isfinite(other[0])) continue;
        for (std::size_t c = 0; c < columns; ++c) mean[c] += other[c];
        ++count;
      }
      for (std::size_t c = 0; c < columns; ++c) mean[c] /= count;
    });
    std::swap(values, next);
  }
  return values;
}

int timesFor(double deviation, double edge) {
  constexpr double kVariance = 3.0 / 7;  // of one time, in squared edges
  constexpr double kMost = 400;          // a window of 13 edges; wider ones say nothing more
  if (!(edge > 0)) return 1;
  return static_cast<int>(
      std::clamp(std::round(deviation * deviation / (kVariance * edge * edge)), 1.0, kMost));
}

}  // namespace explica::surface
