// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Obliquity.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace explica::ventricle {

namespace {

constexpr int kFurthest = 2;    // slices from which a boundary that cannot be believed is continued
constexpr double kReach = 1.5;  // slices to either side over which a parabola is believed
constexpr int kSamples = 96;    // over that reach: a sixtieth of a slice at least

/// Blurs by (1 2 1) / 4 along both axes, twice: a step becomes smooth over two pixels, its half
/// level stays.
void blur(std::vector<float>& image, int width, int height) {
  std::vector<float> copy;
  const auto along = [&](int step, int count, int lines, int stride) {
    copy = image;
    for (int line = 0; line < lines; ++line) {
      for (int p = 0; p < count; ++p) {
        const std::size_t at = static_cast<std::size_t>(line) * stride + std::size_t(p) * step;
        const float before = p > 0 ? copy[at - step] : 0,
                    after = p + 1 < count ? copy[at + step] : 0;
        image[at] = 0.25F * before + 0.5F * copy[at] + 0.25F * after;
      }
    }
  };
  for (int round = 0; round < 2; ++round) {
    along(1, width, height, width);
    along(width, height, width, 1);
  }
}

float valueAt(const std::vector<float>& image, int width, int height, double x, double y) {
  const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
  if (i < 0 || j < 0 || i + 1 >= width || j + 1 >= height) return 0;
  const auto f = static_cast<float>(x - i), g = static_cast<float>(y - j);
  const float* p = image.data() + static_cast<std::size_t>(j) * width + i;
  return (1 - g) * ((1 - f) * p[0] + f * p[1]) + g * ((1 - f) * p[width] + f * p[width + 1]);
}

}  // namespace

BoundaryProfile::Shape BoundaryProfile::shapeOf(const Mask& mask,
                                                const std::array<int, 3>& size) const {
  Shape shape;
  double count = 0;
  for (std::size_t p = 0; p < mask.size(); ++p) {
    if (mask[p] == 0) continue;
    count += 1;
    shape.centre +=
        Eigen::Vector2d(static_cast<double>(p % size[0]), static_cast<double>(p / size[0]))
            .cwiseProduct(pixel_);
  }
  if (count == 0) return shape;
  shape.centre /= count;
  shape.usable = true;
  Mask soft = mask;
  blur(soft, size[0], size[1]);
  const double step = 0.25 * pixel_.minCoeff();
  const double reach = pixel_.cwiseProduct(Eigen::Vector2d(size[0], size[1])).norm();
  std::array<double, kAngles> squared{};
  for (int a = 0; a < kAngles; ++a) {
    const double angle = 2 * kPi * a / kAngles;
    const Eigen::Vector2d e(std::cos(angle), std::sin(angle));
    const auto valueOnRay = [&](double r) {
      const Eigen::Vector2d x = (shape.centre + r * e).cwiseQuotient(pixel_);
      return valueAt(soft, size[0], size[1], x[0], x[1]);
    };
    double r = reach;
    float beyond = 0, here = 0;
    while (r > 0 && (here = valueOnRay(r)) < 0.5F) beyond = here, r -= step;
    r = std::max(r, 0.0);
    if (here > beyond) r += step * (here - 0.5) / (here - beyond);
    squared[a] = r * r;
  }
  // A weighted mean over 11 degrees on either side: the noise of single pixels goes.
  for (int a = 0; a < kAngles; ++a) {
    constexpr std::array<double, 4> kWeight = {4, 3, 2, 1};
    double sum = 0;
    for (int d = -3; d <= 3; ++d)
      sum += kWeight[std::abs(d)] * squared[(a + d + kAngles) % kAngles];
    shape.squared[a] = sum / 16;
  }
  // The blur shrinks what is strongly curved: the enclosed area is that of the pixels.
  const double mean = std::accumulate(shape.squared.begin(), shape.squared.end(), 0.0) / kAngles;
  const double scale = mean > 0 ? count * pixel_.prod() / (kPi * mean) : 1;
  for (double& value : shape.squared) value *= scale;
  return shape;
}

int BoundaryProfile::nearestTo(int k) const {
  int nearest = -1;
  for (int q = 0; q < static_cast<int>(shapes_.size()); ++q) {
    if (has(q) && (nearest < 0 || std::abs(q - k) < std::abs(nearest - k))) nearest = q;
  }
  return nearest;
}

template <class Value, class ValueAt>
BoundaryProfile::Parabola<Value> BoundaryProfile::parabola(int k, const ValueAt& valueAt) const {
  const Value here = valueAt(k);
  if (has(k - 1) && has(k + 1)) {
    const Value before = valueAt(k - 1), after = valueAt(k + 1);
    return {here, Value(0.5 * (after - before)), Value(0.5 * (after + before) - here)};
  }
  for (const int side : {1, -1}) {
    if (!has(k - side)) continue;
    const Value one = valueAt(k - side);
    if (!has(k - 2 * side)) return {here, Value(side * (here - one)), Value(0 * here)};
    const Value two = valueAt(k - 2 * side);
    return {here, Value(0.5 * side * (3 * here - 4 * one + two)),
            Value(0.5 * (here - 2 * one + two))};
  }
  return {here, Value(0 * here), Value(0 * here)};
}

double BoundaryProfile::distance(int k, const Eigen::Vector2d& point, const Eigen::Vector2d& normal,
                                 double gap) const {
  const int near = nearestTo(k);
  if (near < 0) return std::abs(gap);
  const double here = std::clamp(k - near, -kFurthest, kFurthest);
  const auto centre = parabola<Eigen::Vector2d>(near, [&](int q) { return shapes_[q].centre; });
  const Eigen::Vector2d e = (point - centre.at(here)).normalized();
  if (!e.allFinite()) return std::abs(gap);
  const double turn = std::atan2(e[1], e[0]) / (2 * kPi) * kAngles;
  const double lower = std::floor(turn), share = turn - lower;
  const int a = (static_cast<int>(lower) + kAngles) % kAngles, b = (a + 1) % kAngles;
  const auto squared = parabola<double>(near, [&](int q) {
    return (1 - share) * shapes_[q].squared[a] + share * shapes_[q].squared[b];
  });
  const auto placeAt = [&](double z) {
    return normal.dot(centre.at(z) + std::sqrt(std::max(0.0, squared.at(z))) * e);
  };
  const double place = placeAt(here);
  double nearest = gap * gap;
  for (int q = 0; q <= kSamples; ++q) {
    const double z = kReach * (2.0 * q / kSamples - 1);
    const double offset = gap + placeAt(here + z) - place;
    nearest = std::min(nearest, offset * offset + z * z * slice_ * slice_);
  }
  return std::sqrt(nearest);
}

}  // namespace explica::ventricle
