// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Declaration.h"
#include "Explica/Application/ReadPolygon.h"
#include "Explica/Planar/PolygonUnfolding.h"

#include <optional>
#include <string>
#include <vector>

namespace explica::app {

/// A polygon that brings its region and viewpoint along.
enum class PhantomPolygon { Polygon19, Polygon34 };
constexpr auto enumWords(PhantomPolygon) {
  using enum PhantomPolygon;
  return std::to_array<EnumWord<PhantomPolygon>>(
      {{Polygon19, "polygon19"}, {Polygon34, "polygon34"}});
}

inline constexpr char kPolygonState[] = "polygon.state";

/// What `explica polygon` is asked for.
struct PolygonSettings {
  std::optional<std::string> file;
  std::optional<PhantomPolygon> phantom;
  PolygonReading reading;
  std::optional<std::string> region;
  std::vector<Eigen::Vector2d> viewpoint;
  std::vector<Eigen::Vector2d> direction;
  double distance = 1000;
  std::vector<double> weights;
  std::vector<double> line;
  planar::PolygonUnfoldingOptions unfolding;
  int frames = 0;
  int stages = 6;
  bool resume = false;
};

void declarePolygon(Declaration& d, PolygonSettings& s);

}  // namespace explica::app
