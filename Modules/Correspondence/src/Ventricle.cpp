// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/Ventricle.h"

#include "Explica/Core/Errors.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace explica::correspondence {

namespace {

constexpr std::array<const char*, 17> kNames = {"basal anterior",
                                                "basal anteroseptal",
                                                "basal inferoseptal",
                                                "basal inferior",
                                                "basal inferolateral",
                                                "basal anterolateral",
                                                "mid anterior",
                                                "mid anteroseptal",
                                                "mid inferoseptal",
                                                "mid inferior",
                                                "mid inferolateral",
                                                "mid anterolateral",
                                                "apical anterior",
                                                "apical septal",
                                                "apical inferior",
                                                "apical lateral",
                                                "apex"};

/// Segment of an angle from the anterior insertion, degrees in [0, 360).
int segmentAt(double angle, int third) {
  if (third < 2) return 6 * third + 1 + (1 + static_cast<int>(angle / 60)) % 6;
  // Apical segments are centred like the rings above: the septal one starts 15 degrees on.
  const double shifted = std::fmod(angle - 15 + 360, 360);
  return 13 + (1 + static_cast<int>(shifted / 90)) % 4;
}

std::string number(double value, const char* format = "%.3f") {
  if (std::isnan(value)) return "n/a";
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

}  // namespace

WallSegments wallSegments(const harmonic::Annulus& annulus, const Correspondence& correspondence,
                          const Point& insertion) {
  if (annulus.grid.dimension() == 2) {
    throw InvalidInput("segments of the heart need a stack of slices; this image has one");
  }
  const int slices = annulus.size[2];
  std::vector<std::size_t> cavity(slices, 0), tissue(slices, 0);
  std::vector<Vector> centre(slices, Vector::Zero());
  const std::size_t sliceSize = annulus.strides()[2];
  for (std::size_t p = 0; p < annulus.numberAt.size(); ++p) {
    const std::size_t k = p / sliceSize, row = p / annulus.size[0];
    if (annulus.numberAt[p] >= 0) ++tissue[k];
    if (annulus.numberAt[p] != harmonic::kInner) continue;
    ++cavity[k];
    centre[k] += Vector(static_cast<double>(p % annulus.size[0] + annulus.first[0]),
                        static_cast<double>(row % annulus.size[1]) + annulus.first[1], 0);
  }
  std::vector<int> ring;
  for (int k = 0; k < slices; ++k) {
    if (cavity[k] > 0) centre[k] /= static_cast<double>(cavity[k]);
    if (cavity[k] > 0 && tissue[k] > 0) ring.push_back(k);
  }
  if (ring.empty()) throw InvalidInput("no slice has both tissue and cavity");

  WallSegments result;
  // The cavity tapers towards the apex: compare the halves of the stack.
  std::size_t low = 0, high = 0;
  for (std::size_t q = 0; q < ring.size(); ++q) {
    if (2 * q < ring.size()) low += cavity[ring[q]];
    if (2 * q + 1 >= ring.size()) high += cavity[ring[q]];
  }
  result.apexAtHighSlice = low >= high;
  const double up = result.apexAtHighSlice ? 1 : -1;
  const Vector axis = up * annulus.grid.direction.col(2);  // towards the apex, and a viewer there

  const auto count = static_cast<int>(ring.size());
  result.segmentOf.assign(annulus.count(), 0);
  std::array<std::vector<double>, 18> values;
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
    const double thickness = correspondence.thickness(n);
    if (std::isnan(thickness)) continue;
    const int k = annulus.boxSubscripts(n)[2];
    const auto at = std::lower_bound(ring.begin(), ring.end(), k);
    int segment = 17;
    if (at != ring.end() && *at == k) {
      int rank = static_cast<int>(at - ring.begin());
      if (!result.apexAtHighSlice) rank = count - 1 - rank;
      const int third = std::min(2, 3 * rank / count);
      const Vector index = annulus.index(n);
      const Point middle = annulus.grid.toWorld(Vector(centre[k][0], centre[k][1], index[2]));
      Vector reference = insertion - middle, here = annulus.grid.toWorld(index) - middle;
      reference -= reference.dot(axis) * axis;
      here -= here.dot(axis) * axis;
      double angle = std::atan2(axis.dot(reference.cross(here)), reference.dot(here)) * 180 / kPi;
      if (angle < 0) angle += 360;
      segment = segmentAt(std::min(angle, 359.999), third);
    } else {
      // Beyond the cavity: the apex on its side, else the first ring's wall (no cavity drawn).
      const bool beyondApex = result.apexAtHighSlice ? k > ring.back() : k < ring.front();
      if (!beyondApex) continue;
    }
    result.segmentOf[n] = segment;
    values[segment].push_back(thickness);
  }
  for (int segment = 1; segment <= 17; ++segment) {
    WallSegment row;
    row.segment = segment;
    row.name = kNames[segment - 1];
    const auto& v = values[segment];
    row.voxels = v.size();
    if (!v.empty()) {
      double sum = 0, squares = 0;
      for (const double t : v) sum += t;
      row.mean = sum / static_cast<double>(v.size());
      for (const double t : v) squares += (t - row.mean) * (t - row.mean);
      row.deviation = std::sqrt(squares / static_cast<double>(v.size()));
      row.minimum = *std::min_element(v.begin(), v.end());
      row.maximum = *std::max_element(v.begin(), v.end());
    }
    result.rows.push_back(std::move(row));
  }
  return result;
}

std::string tableOf(const WallSegments& segments) {
  std::string text =
      "segment\tname\tvoxels\tthickness_mean\tthickness_sd\tthickness_min\t"
      "thickness_max\n";
  for (const WallSegment& row : segments.rows) {
    text += std::to_string(row.segment) + '\t' + row.name + '\t' + std::to_string(row.voxels) +
            '\t' + number(row.mean) + '\t' + number(row.deviation) + '\t' + number(row.minimum) +
            '\t' + number(row.maximum) + '\n';
  }
  return text;
}

std::string bullseyeOf(const WallSegments& segments) {
  double low = kInfinity, high = -kInfinity;
  for (const WallSegment& row : segments.rows) {
    if (row.voxels == 0) continue;
    low = std::min(low, row.mean);
    high = std::max(high, row.mean);
  }
  const auto colour = [&](const WallSegment& row) -> std::string {
    if (row.voxels == 0) return "#e0e0e0";
    const double t = high > low ? (row.mean - low) / (high - low) : 0.5;
    // Dark blue over green to yellow, lighter with thickness, so that it survives in grey.
    const double red = 68 + t * t * 185, green = 20 + t * 211, blue = 90 + 60 * std::sin(kPi * t);
    char text[8];
    std::snprintf(text, sizeof text, "#%02x%02x%02x", static_cast<int>(red),
                  static_cast<int>(green), static_cast<int>(blue * (1 - 0.7 * t)));
    return text;
  };
  constexpr std::array<double, 4> kRadius = {200, 150, 100, 50};
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 440 480\" width=\"440\" "
      "height=\"480\" font-family=\"sans-serif\" font-size=\"13\" text-anchor=\"middle\">\n"
      "<title>Wall thickness, mm, in the 17 segments of the left ventricle</title>\n";
  const auto at = [](double radius, double angleDeg) {
    // Counter-clockwise from the right, y downwards.
    const double a = angleDeg * kPi / 180;
    return number(220 + radius * std::cos(a), "%.2f") + " " +
           number(220 - radius * std::sin(a), "%.2f");
  };
  for (const WallSegment& row : segments.rows) {
    double x = 220, y = 220;
    if (row.segment == 17) {
      svg += "<circle cx=\"220\" cy=\"220\" r=\"50\" fill=\"" + colour(row) +
             "\" stroke=\"white\" stroke-width=\"2\"/>\n";
    } else {
      const int ring = row.segment <= 6 ? 0 : row.segment <= 12 ? 1 : 2;
      const double width = ring == 2 ? 90 : 60;
      const int place = row.segment - (ring == 0 ? 1 : ring == 1 ? 7 : 13);
      const double from = 90 - width / 2 + place * width, to = from + width;
      const std::string outer = number(kRadius[ring], "%g"),
                        inner = number(kRadius[ring + 1], "%g");
      svg += "<path d=\"M " + at(kRadius[ring], from) + " A " + outer + " " + outer + " 0 0 0 " +
             at(kRadius[ring], to) + " L " + at(kRadius[ring + 1], to) + " A " + inner + " " +
             inner + " 0 0 1 " + at(kRadius[ring + 1], from) + " Z\" fill=\"" + colour(row) +
             "\" stroke=\"white\" stroke-width=\"2\"/>\n";
      const double middle = (from + to) / 2 * kPi / 180;
      x = 220 + (kRadius[ring] - 25) * std::cos(middle);
      y = 220 - (kRadius[ring] - 25) * std::sin(middle);
    }
    const bool dark = row.voxels > 0 && high > low && (row.mean - low) / (high - low) < 0.5;
    svg += "<text x=\"" + number(x, "%.1f") + "\" y=\"" + number(y + 5, "%.1f") + "\" fill=\"" +
           (dark ? "white" : "black") + "\"><title>" + std::to_string(row.segment) + " " +
           row.name + "</title>" + number(row.mean, "%.1f") + "</text>\n";
  }
  svg +=
      "<text x=\"220\" y=\"465\">wall thickness, mm (anterior on top, septum left, seen from the "
      "apex)</text>\n</svg>\n";
  return svg;
}

}  // namespace explica::correspondence
