// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/ColourMap.h"

#include <algorithm>
#include <cmath>

namespace explica::report {
namespace {

using Lab = Eigen::Vector3d;  // lightness, green-red, blue-yellow

/// Linear sRGB of an OKLab colour; the matrices are those of [Ottosson2020].
Colour fromLab(const Lab& lab) {
  const double l = std::pow(lab[0] + 0.3963377774 * lab[1] + 0.2158037573 * lab[2], 3);
  const double m = std::pow(lab[0] - 0.1055613458 * lab[1] - 0.0638541728 * lab[2], 3);
  const double s = std::pow(lab[0] - 0.0894841775 * lab[1] - 1.2914855480 * lab[2], 3);
  const auto clip = [](double x) { return static_cast<float>(std::clamp(x, 0.0, 1.0)); };
  return {clip(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          clip(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          clip(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

/// A map's curve: points joined by a Catmull-Rom spline, tabulated by arc length.
class Curve {
 public:
  explicit Curve(const std::vector<Lab>& knots) {
    constexpr int kFine = 64;
    std::vector<Lab> fine;
    const int spans = static_cast<int>(knots.size()) - 1;
    for (int s = 0; s < spans; ++s) {
      const Lab& a = knots[std::max(s - 1, 0)];
      const Lab& b = knots[s];
      const Lab& c = knots[s + 1];
      const Lab& d = knots[std::min(s + 2, spans)];
      for (int f = 0; f < kFine + (s + 1 == spans ? 1 : 0); ++f) {
        const double t = static_cast<double>(f) / kFine;
        fine.emplace_back(0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t * t +
                                 (3 * b - a - 3 * c + d) * t * t * t));
      }
    }
    std::vector<double> length(fine.size(), 0.0);
    for (std::size_t f = 1; f < fine.size(); ++f)
      length[f] = length[f - 1] + (fine[f] - fine[f - 1]).norm();
    std::size_t at = 0;
    for (int e = 0; e <= kEntries; ++e) {
      const double target = length.back() * e / kEntries;
      while (at + 2 < fine.size() && length[at + 1] < target) ++at;
      const double t = std::clamp((target - length[at]) / (length[at + 1] - length[at]), 0.0, 1.0);
      table_[e] = fromLab((1 - t) * fine[at] + t * fine[at + 1]);
    }
  }

  [[nodiscard]] Colour operator()(double t) const {
    const double x = std::clamp(t, 0.0, 1.0) * kEntries;
    const int e = std::min(static_cast<int>(x), kEntries - 1);
    const auto f = static_cast<float>(x - e);
    Colour colour;
    for (int c = 0; c < 3; ++c) colour[c] = (1 - f) * table_[e][c] + f * table_[e + 1][c];
    return colour;
  }

 private:
  static constexpr int kEntries = 512;
  std::array<Colour, kEntries + 1> table_;
};

const Curve& curveOf(ColourMap map) {
  static const Curve sequential({{0.25, 0.00, -0.12},
                                 {0.42, -0.03, -0.10},
                                 {0.58, -0.09, -0.02},
                                 {0.75, -0.12, 0.10},
                                 {0.93, -0.04, 0.16}});
  static const Curve heat({{0.22, 0.07, -0.08},
                           {0.42, 0.15, 0.01},
                           {0.62, 0.13, 0.10},
                           {0.80, 0.03, 0.15},
                           {0.95, -0.03, 0.10}});
  static const Curve diverging({{0.40, -0.02, -0.15},
                                {0.67, -0.03, -0.09},
                                {0.94, 0.0, 0.0},
                                {0.67, 0.05, 0.10},
                                {0.40, 0.08, 0.07}});
  switch (map) {
    case ColourMap::Heat:
      return heat;
    case ColourMap::Diverging:
      return diverging;
    default:
      return sequential;
  }
}

/// Outwards to two significant digits of the range.
double roundTo(double value, double range, bool up) {
  if (!(range > 0)) return value;
  const double unit = std::pow(10, std::floor(std::log10(range)) - 1);
  return (up ? std::ceil(value / unit - 1e-9) : std::floor(value / unit + 1e-9)) * unit;
}

}  // namespace

Colour colourAt(ColourMap map, double t) {
  if (std::isnan(t)) return {0.3f, 0.3f, 0.3f};
  if (map == ColourMap::Grey) {
    const float light =
        decodeSrgb(static_cast<std::uint8_t>(std::lround(255 * std::clamp(t, 0.0, 1.0))));
    return {light, light, light};
  }
  return curveOf(map)(t);
}

Colour colourOfLabel(Label label) {
  static constexpr std::array<std::array<std::uint8_t, 3>, 8> kHues = {{{230, 159, 0},
                                                                        {86, 180, 233},
                                                                        {0, 158, 115},
                                                                        {240, 228, 66},
                                                                        {0, 114, 178},
                                                                        {213, 94, 0},
                                                                        {204, 121, 167},
                                                                        {90, 90, 90}}};
  if (label <= 0) return {0.62f, 0.62f, 0.62f};
  const auto index = static_cast<std::uint32_t>(label) - 1u;
  const auto& hue = kHues[index % kHues.size()];
  const std::array<float, 4> lightness = {1.0f, 0.55f, 0.3f, 0.78f};
  const float light = lightness[(index / kHues.size()) % lightness.size()];
  return {light * decodeSrgb(hue[0]), light * decodeSrgb(hue[1]), light * decodeSrgb(hue[2])};
}

Colour colourOfLabel(Label label, const std::array<float, 4>& own) {
  if (!(own[3] > 0) || !(own[0] + own[1] + own[2] > 0)) return colourOfLabel(label);
  const auto linear = [](float x) {
    return decodeSrgb(static_cast<std::uint8_t>(std::lround(255 * std::clamp(x, 0.0F, 1.0F))));
  };
  return {linear(own[0]), linear(own[1]), linear(own[2])};
}

ColourScale scaleFor(const Eigen::VectorXd& values, std::string title, std::string unit,
                     std::optional<ColourMap> map) {
  std::vector<double> sorted;
  for (const double v : values) {
    if (std::isfinite(v)) sorted.push_back(v);
  }
  ColourScale scale{.title = std::move(title), .unit = std::move(unit)};
  if (sorted.empty()) return scale;
  std::ranges::sort(sorted);
  const std::size_t n = sorted.size();
  scale.low = sorted[n / 50];
  scale.high = sorted[n - 1 - n / 50];
  const bool bothSigns = sorted[n / 10] < 0 && sorted[n - 1 - n / 10] > 0;
  scale.map = map.value_or(bothSigns ? ColourMap::Diverging : ColourMap::Sequential);
  if (scale.map == ColourMap::Diverging && scale.low < 0 && scale.high > 0) {
    scale.high = std::max(scale.high, -scale.low);
    scale.low = -scale.high;
  }
  if (!(scale.high > scale.low)) {
    scale.low = sorted.front();
    scale.high = sorted.back();
  }
  if (!(scale.high > scale.low)) {
    const double half = std::max(0.5 * std::abs(scale.low), 0.5);
    scale.low -= half;
    scale.high += half;
  }
  const double range = scale.high - scale.low;
  scale.low = roundTo(scale.low, range, false);
  scale.high = roundTo(scale.high, range, true);
  return scale;
}

std::vector<Colour> coloursOf(const Eigen::VectorXd& values, const ColourScale& scale) {
  std::vector<Colour> colours(static_cast<std::size_t>(values.size()));
  for (Eigen::Index v = 0; v < values.size(); ++v) colours[v] = scale(values[v]);
  return colours;
}

}  // namespace explica::report
