// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "MaskedImage.h"

#include "PathProfile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace explica::surface {
namespace {

float meanOfKnown(const Volume<float>& image, std::size_t v) {
  float sum = 0;
  int count = 0;
  for (const std::int64_t w : image.grid.neighbours(v)) {
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
    for (const std::int64_t w : image.grid.neighbours(v)) {
      if (w >= 0 && image[w] == 0) front.push_back(static_cast<std::size_t>(w));
    }
  }
  std::sort(front.begin(), front.end());
  front.erase(std::unique(front.begin(), front.end()), front.end());
  return front;
}

}  // namespace

double MaskedImage::seenAt(const Point& p) const {
  if (seen.size() == 0) return 1;
  const double share = valueAt(seen, p);
  return std::isfinite(share) ? share : 0;
}

MaskedImage beyondMask(Volume<float> image, double reach) {
  MaskedImage result{std::move(image), {}};
  Volume<float>& values = result.image;
  if (std::find(values.data.begin(), values.data.end(), 0.0F) == values.data.end()) return result;
  result.seen = Volume<float>(values.grid, 0.0F);
  std::vector<std::size_t> known;
  for (std::size_t v = 0; v < values.size(); ++v) {
    if (values[v] == 0) continue;
    result.seen[v] = 1;
    known.push_back(v);
  }
  // A place so far away diagonally is up to sqrt(3) times as many steps away.
  const int steps =
      static_cast<int>(std::ceil(std::sqrt(3.0) * reach / values.grid.spacing.minCoeff()));
  for (int step = 0; step < steps; ++step) {
    known = besides(values, known);
    std::vector<float> means(known.size());
    for (std::size_t n = 0; n < known.size(); ++n) means[n] = meanOfKnown(values, known[n]);
    for (std::size_t n = 0; n < known.size(); ++n) values[known[n]] = means[n];
  }
  return result;
}

}  // namespace explica::surface
