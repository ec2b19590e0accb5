// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "MaskedImage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace explica::surface {
namespace {

/// The voxels that share a face with one; -1 where the image ends.
std::array<std::int64_t, 6> faceNeighbours(const Grid& grid, std::size_t v) {
  const auto at = grid.subscripts(v);
  std::array<std::int64_t, 6> found;
  for (int n = 0; n < 6; ++n) {
    auto next = at;
    next[n / 2] += n % 2 == 0 ? -1 : 1;
    found[n] = grid.contains(next[0], next[1], next[2])
                   ? static_cast<std::int64_t>(grid.linear(next[0], next[1], next[2]))
                   : -1;
  }
  return found;
}

float meanOfKnown(const Volume<float>& image, std::size_t v) {
  float sum = 0;
  int count = 0;
  for (const std::int64_t w : faceNeighbours(image.grid, v)) {
    if (w < 0 || image[w] == 0) continue;
    sum += image[w];
    ++count;
  }
  return sum / static_cast<float>(count);
}

/// Voxels of 0 that touch one of `known`, ascending.
std::vector<std::size_t> besides(const Volume<float>& image,
                                 const std::vector<std::size_t>& known) {
  std::vector<std::size_t> front;
  for (const std::size_t v : known) {
    for (const std::int64_t w : faceNeighbours(image.grid, v)) {
      if (w >= 0 && image[w] == 0) front.push_back(static_cast<std::size_t>(w));
    }
  }
  std::sort(front.begin(), front.end());
  front.erase(std::unique(front.begin(), front.end()), front.end());
  return front;
}

}  // namespace

Volume<float> beyondMask(Volume<float> image, double reach) {
  // A place so far away diagonally is up to sqrt(3) times as many steps away.
  const int steps =
      static_cast<int>(std::ceil(std::sqrt(3.0) * reach / image.grid.spacing.minCoeff()));
  if (std::find(image.data.begin(), image.data.end(), 0.0F) == image.data.end()) return image;
  std::vector<std::size_t> known;
  for (std::size_t v = 0; v < image.size(); ++v) {
    if (image[v] != 0) known.push_back(v);
  }
  for (int step = 0; step < steps; ++step) {
    known = besides(image, known);
    std::vector<float> values(known.size());
    for (std::size_t n = 0; n < known.size(); ++n) values[n] = meanOfKnown(image, known[n]);
    for (std::size_t n = 0; n < known.size(); ++n) image[known[n]] = values[n];
  }
  return image;
}

}  // namespace explica::surface
