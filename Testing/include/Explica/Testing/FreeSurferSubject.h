// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Grid.h"

#include <zlib.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace explica::testing {

/// A cortical vertex of FreeSurfer's white surface whose place is known.
struct KnownVertex {
  Point place = Point::Zero();    ///< scanner RAS, mm
  Vector index = Vector::Zero();  ///< in mri/ribbon.mgz
  double thickness = 0;           ///< FreeSurfer's, mm
  double area = 0;                ///< of the white surface, mm^2
  std::string region;
};

/// Cortical vertices of `?h.thickness_at_known_vertices.csv.gz` (bert's SOURCE.md); none if the
/// file cannot be read.
inline std::vector<KnownVertex> knownVertices(const std::filesystem::path& path) {
  std::vector<KnownVertex> vertices;
  gzFile file = gzopen(path.c_str(), "rb");
  char line[512];
  bool header = true;
  while (file != nullptr && gzgets(file, line, sizeof line) != nullptr) {
    if (std::exchange(header, false)) continue;
    std::array<std::string, 15> cell;
    std::istringstream text(line);
    for (auto& c : cell) std::getline(text, c, ',');
    KnownVertex v;
    v.place = Point(std::stod(cell[4]), std::stod(cell[5]), std::stod(cell[6]));
    v.index = Vector(std::stod(cell[7]), std::stod(cell[8]), std::stod(cell[9]));
    v.thickness = std::stod(cell[10]);
    v.area = std::stod(cell[11]);
    v.region = cell[14].substr(0, cell[14].find_last_not_of("\r\n") + 1);
    if (v.thickness > 0) vertices.push_back(v);  // 0 outside the cortex
  }
  if (file != nullptr) gzclose(file);
  return vertices;
}

/// A row of `?h.aparc.stats`.
struct RegionStats {
  double area = 0;       ///< SurfArea, mm^2
  double thickness = 0;  ///< ThickAvg, mm
};

/// Rows of `?h.aparc.stats` by the region's name.
inline std::map<std::string, RegionStats> regionStats(const std::filesystem::path& path) {
  std::map<std::string, RegionStats> regions;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream text(line);
    std::string name;
    double vertices = 0, area = 0, volume = 0, thickness = 0;
    if (line.starts_with('#')) continue;
    if (text >> name >> vertices >> area >> volume >> thickness) regions[name] = {area, thickness};
  }
  return regions;
}

/// Pearson's, of equally long rows.
inline double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  const auto n = static_cast<double>(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    sa += a[k];
    sb += b[k];
    saa += a[k] * a[k];
    sbb += b[k] * b[k];
    sab += a[k] * b[k];
  }
  return (n * sab - sa * sb) / std::sqrt((n * saa - sa * sa) * (n * sbb - sb * sb));
}

/// Our thickness beside FreeSurfer's, vertex by vertex and region by region.
class ThicknessComparison {
 public:
  void add(const KnownVertex& vertex, double thickness) {
    ours_.push_back(thickness);
    theirs_.push_back(vertex.thickness);
    auto& [sum, area] = byRegion_[vertex.region];
    sum += vertex.area * thickness;
    area += vertex.area;
  }
  [[nodiscard]] std::size_t vertices() const { return ours_.size(); }
  [[nodiscard]] double vertexCorrelation() const { return correlation(ours_, theirs_); }
  /// Mean of the absolute differences at vertices, mm.
  [[nodiscard]] double difference() const {
    double sum = 0;
    for (std::size_t k = 0; k < ours_.size(); ++k) sum += std::abs(ours_[k] - theirs_[k]);
    return sum / static_cast<double>(ours_.size());
  }

  /// Standard deviations of ours and of theirs, mm.
  [[nodiscard]] std::pair<double, double> deviations() const {
    const auto of = [](const std::vector<double>& values) {
      const auto n = static_cast<double>(values.size());
      double sum = 0, squares = 0;
      for (const double value : values) {
        sum += value;
        squares += value * value;
      }
      return std::sqrt(squares / n - sum * sum / (n * n));
    };
    return {of(ours_), of(theirs_)};
  }

  struct Regions {
    std::size_t count = 0;
    double correlation = 0;
  };
  /// Regional means against `?h.aparc.stats`; a part of a region need not be as thick as the whole,
  /// so that only regions count of which half the area is known.
  [[nodiscard]] Regions regions(const std::filesystem::path& stats) const {
    std::vector<double> ours, theirs;
    for (const auto& [region, expected] : regionStats(stats)) {
      const auto found = byRegion_.find(region);
      if (found == byRegion_.end() || found->second.second < 0.5 * expected.area) continue;
      ours.push_back(found->second.first / found->second.second);
      theirs.push_back(expected.thickness);
    }
    return {ours.size(), correlation(ours, theirs)};
  }

 private:
  std::vector<double> ours_, theirs_;
  std::map<std::string, std::pair<double, double>> byRegion_;  ///< thickness times area, area
};

}  // namespace explica::testing
