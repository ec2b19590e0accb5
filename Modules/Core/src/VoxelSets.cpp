// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/VoxelSets.h"

#include "Explica/Core/DisjointSets.h"
#include "Explica/Core/GridLines.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace explica {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();  // no voxel of the set anywhere

/// What a line needs to work in.
struct Line {
  explicit Line(int length) : f(length), out(length), site(length), border(length) {}
  std::vector<float> f, out;
  std::vector<int> site;
  std::vector<double> border;
};

/// Squared distances along one line to where it is 0, in place; it is 0 or kFar.
void nearestOf(Line& line, double h) {
  std::vector<float>& f = line.f;
  const int n = static_cast<int>(f.size());
  int steps = n;
  const auto pass = [&](int p) {
    steps = f[p] == 0 ? 0 : std::min(steps + 1, n);
    line.site[p] = std::min(line.site[p], steps);
  };
  std::ranges::fill(line.site, n);
  for (int p = 0; p < n; ++p) pass(p);
  steps = n;
  for (int p = n - 1; p >= 0; --p) pass(p);
  for (int p = 0; p < n; ++p) {
    const double d = h * line.site[p];
    if (line.site[p] < n) f[p] = static_cast<float>(d * d);
  }
}

/// Lower envelope of the parabolas f[q] + (h (p - q))^2 along one line, in place.
void envelope(Line& line, double h) {
  auto& [f, out, site, border] = line;
  const int n = static_cast<int>(f.size());
  int count = 0;
  for (int q = 0; q < n; ++q) {
    if (f[q] == kFar) continue;
    double from = -std::numeric_limits<double>::infinity();
    while (count > 0) {
      const int s = site[count - 1];
      from = (static_cast<double>(f[q]) - f[s] +
              h * h * (static_cast<double>(q) * q - static_cast<double>(s) * s)) /
             (2 * h * h * (q - s));
      if (from > border[count - 1]) break;
      --count;
      from = -std::numeric_limits<double>::infinity();
    }
    site[count] = q;
    border[count] = from;
    ++count;
  }
  if (count == 0) return;
  int current = 0;
  for (int p = 0; p < n; ++p) {
    while (current + 1 < count && border[current + 1] <= p) ++current;
    const double d = h * (p - site[current]);
    out[p] = static_cast<float>(f[site[current]] + d * d);
  }
  f.swap(out);
}

}  // namespace

std::int64_t voxelsIn(const VoxelSet& set) {
  return parallelSum(set.size(), 1 << 18, std::int64_t{0},
                     [&](std::size_t begin, std::size_t end) -> std::int64_t {
                       const auto first = set.data.begin();
                       return static_cast<std::int64_t>(end - begin) -
                              std::count(first + static_cast<std::ptrdiff_t>(begin),
                                         first + static_cast<std::ptrdiff_t>(end), 0);
                     });
}

std::int64_t voxelAt(const Grid& grid, const Point& place) {
  const Vector index = grid.toIndex(place);
  const int i = static_cast<int>(std::lround(index[0])),
            j = static_cast<int>(std::lround(index[1])),
            k = static_cast<int>(std::lround(index[2]));
  return grid.contains(i, j, k) ? static_cast<std::int64_t>(grid.linear(i, j, k)) : -1;
}

Volume<float> squaredDistanceTo(const VoxelSet& set) {
  const Grid& grid = set.grid;
  Volume<float> squared(grid, kFar);
  for (std::size_t v = 0; v < set.size(); ++v) {
    if (set[v] != 0) squared[v] = 0;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const GridLines lines(grid.size, axis);
    parallelForBlocks(lines.count, 512, [&](std::size_t begin, std::size_t end) {
      Line line(lines.length);
      for (std::size_t l = begin; l < end; ++l) {
        float* const start = squared.data.data() + lines.begin(l);
        for (int p = 0; p < lines.length; ++p) line.f[p] = start[p * lines.stride];
        axis == 0 ? nearestOf(line, grid.spacing[axis]) : envelope(line, grid.spacing[axis]);
        for (int p = 0; p < lines.length; ++p) start[p * lines.stride] = line.f[p];
      }
    });
  }
  return squared;
}

std::int32_t Components::largest() const {
  if (size.empty()) return -1;
  return static_cast<std::int32_t>(std::ranges::max_element(size) - size.begin());
}

namespace {

/// Voxels of a set that follow each other along the first axis.
struct VoxelRun {
  int begin, end;
};

/// The runs of every line along the first axis.
struct VoxelRuns {
  std::vector<VoxelRun> runs;
  std::vector<std::int32_t> first;  ///< of each line; one more at the end

  explicit VoxelRuns(const VoxelSet& set) {
    const int length = set.grid.size[0];
    for (std::size_t line = 0; line < set.size(); line += length) {
      first.push_back(static_cast<std::int32_t>(runs.size()));
      const std::uint8_t* const in = set.data.data() + line;
      for (int i = 0; i < length; ++i) {
        if (in[i] == 0) continue;
        const int begin = i;
        while (i < length && in[i] != 0) ++i;
        runs.push_back({begin, i});
      }
    }
    first.push_back(static_cast<std::int32_t>(runs.size()));
  }

  /// Joins the runs of two lines that have voxels beside each other.
  void join(std::size_t line, std::size_t other, DisjointSets& sets) const {
    std::int32_t a = first[line], b = first[other];
    while (a < first[line + 1] && b < first[other + 1]) {
      if (runs[a].begin < runs[b].end && runs[b].begin < runs[a].end) sets.join(a, b);
      runs[a].end < runs[b].end ? ++a : ++b;
    }
  }
};

}  // namespace

Components componentsOf(const VoxelSet& set) {
  const std::int64_t length = set.grid.size[0], rows = set.grid.size[1];
  const VoxelRuns lines(set);
  DisjointSets sets(lines.runs.size());
  for (std::size_t line = 0; line + 1 < lines.first.size(); ++line) {
    if (line % rows != 0) lines.join(line, line - 1, sets);
    if (line >= static_cast<std::size_t>(rows)) lines.join(line, line - rows, sets);
  }
  Components components;
  std::vector<std::int32_t> number(lines.runs.size());
  for (std::int32_t run = 0; run < static_cast<std::int32_t>(lines.runs.size()); ++run) {
    const std::int32_t root = sets.root(run);
    if (root == run) {
      number[run] = static_cast<std::int32_t>(components.size.size());
      components.size.push_back(0);
    }
    number[run] = number[root];
    components.size[number[run]] += lines.runs[run].end - lines.runs[run].begin;
  }
  components.number = Volume<std::int32_t>(set.grid, -1);
  parallelFor(lines.first.size() - 1, 256, [&](std::size_t line) {
    for (std::int32_t run = lines.first[line]; run < lines.first[line + 1]; ++run) {
      const auto start =
          components.number.data.begin() + static_cast<std::ptrdiff_t>(line) * length;
      std::fill(start + lines.runs[run].begin, start + lines.runs[run].end, number[run]);
    }
  });
  return components;
}

Volume<float> spreadLabels(const VoxelSet& through, VoxelSet& labels) {
  const Grid& grid = through.grid;
  const auto& n = grid.size;
  Volume<float> arrival(grid, kFar);
  using Entry = std::pair<float, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
  for (std::size_t v = 0; v < through.size(); ++v) {
    if (labels[v]) {
      arrival[v] = 0;
      front.emplace(0.0F, static_cast<std::uint32_t>(v));
    }
  }
  while (!front.empty()) {
    const auto [time, v] = front.top();
    front.pop();
    if (time > arrival[v]) continue;
    const auto at = grid.subscripts(v);
    for (int dk = -1; dk <= 1; ++dk) {
      for (int dj = -1; dj <= 1; ++dj) {
        for (int di = -1; di <= 1; ++di) {
          const int i = at[0] + di, j = at[1] + dj, k = at[2] + dk;
          if (i < 0 || j < 0 || k < 0 || i >= n[0] || j >= n[1] || k >= n[2]) continue;
          const std::size_t w = grid.linear(i, j, k);
          if (!through[w]) continue;
          const float step =
              static_cast<float>(Vector(di, dj, dk).cwiseProduct(grid.spacing).norm());
          if (time + step < arrival[w]) {
            arrival[w] = time + step;
            labels[w] = labels[v];
            front.emplace(arrival[w], static_cast<std::uint32_t>(w));
          }
        }
      }
    }
  }
  return arrival;
}

}  // namespace explica
