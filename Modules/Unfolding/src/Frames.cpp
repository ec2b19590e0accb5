// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Frames.h"

#include "Explica/Visibility/AverageVisibility.h"

#include <cmath>

namespace explica::unfolding {

std::vector<UnfoldFrame> framesAlong(const Unfolder& unfolder,
                                     const visibility::Viewpoints& viewpoints,
                                     const std::vector<Positions>& path, int count) {
  std::vector<UnfoldFrame> frames;
  if (count <= 0 || path.empty()) return frames;
  const visibility::AverageVisibility measure(unfolder.reference().faces, unfolder.region().faces,
                                              viewpoints);
  const auto stateAt = [&](std::size_t n, double t) {
    UnfoldFrame frame;
    frame.positions = unfolder.reference().positions;
    Positions moved = path[n];
    if (t > 0) moved += t * (path[n + 1] - path[n]);
    frame.positions(unfolder.movingVertices(), Eigen::all) = moved;
    frame.visibility = measure.value(frame.positions);
    return frame;
  };
  const UnfoldFrame first = stateAt(0, 0), last = stateAt(path.size() - 1, 0);
  if (count == 1) return {last};
  frames.push_back(first);
  std::size_t n = 0;
  UnfoldFrame next = path.size() > 1 ? stateAt(1, 0) : last;
  for (int k = 1; k + 1 < count; ++k) {
    const double wanted = first.visibility + (last.visibility - first.visibility) * k / (count - 1);
    while (n + 2 < path.size() && next.visibility < wanted) next = stateAt(++n + 1, 0);
    if (n + 1 >= path.size()) break;
    double low = 0, high = 1;
    UnfoldFrame frame;
    for (int halving = 0; halving < 20; ++halving) {
      const double middle = 0.5 * (low + high);
      frame = stateAt(n, middle);
      if (std::abs(frame.visibility - wanted) < 1e-5) break;
      (frame.visibility < wanted ? low : high) = middle;
    }
    frames.push_back(std::move(frame));
  }
  frames.push_back(last);
  return frames;
}

}  // namespace explica::unfolding
