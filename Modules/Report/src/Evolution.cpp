// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Evolution.h"

#include "Encoding.h"
#include "Explica/Core/EigenViews.h"
#include "Explica/Core/Errors.h"
#include "Explica/Report/SurfacePicture.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace explica::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kSteps = 8191;  // of the box along each axis: 0.03 mm of a brain

/// The colours of a legend or scale, three bytes each.
std::string packColours(const std::vector<Colour>& colours) {
  std::string bytes;
  for (const Colour& colour : colours) {
    for (const float c : colour) bytes.push_back(static_cast<char>(encodeSrgb(c)));
  }
  return base64(bytes);
}

/// Values to 1/65534 of their own range, so that the one under the pointer can be read; 65535 is
/// not-a-number.
Json mapJson(const EvolutionMap& map) {
  constexpr int kLevels = 65534;
  double least = kInfinity, most = -kInfinity;
  for (const double v : map.values) {
    if (!std::isfinite(v)) continue;
    least = std::min(least, v);
    most = std::max(most, v);
  }
  if (!(most > least)) {
    if (!std::isfinite(least)) least = 0;
    most = least + 1;
  }
  std::vector<std::int32_t> values;
  for (const double v : map.values) {
    values.push_back(std::isfinite(v) ? static_cast<std::int32_t>(
                                            std::lround(kLevels * (v - least) / (most - least)))
                                      : kLevels + 1);
  }
  std::vector<Colour> colours;
  for (int e = 0; e < 256; ++e) {
    colours.push_back(colourAt(map.scale.map, e == 255 ? kNaN : e / 254.0));
  }
  return {{"name", map.scale.title},
          {"unit", map.scale.unit},
          {"low", map.scale.low},
          {"high", map.scale.high},
          {"least", least},
          {"step", (most - least) / kLevels},
          {"colours", packColours(colours)},
          {"values", packIntegers(values, 1)}};
}

Json labelsJson(const EvolutionLabels& labels) {
  std::vector<std::string> names;
  std::vector<Colour> colours;
  for (const LegendEntry& entry : labels.legend) {
    names.push_back(entry.name);
    colours.push_back(entry.colour);
  }
  return {{"name", labels.title},
          {"names", names},
          {"colours", packColours(colours)},
          {"entries", packIntegers(labels.entries, 1)}};
}

}  // namespace

Evolution evolutionOf(const std::vector<TriangleMesh>& frames) {
  if (frames.empty()) throw InvalidInput("evolution: no frames");
  Evolution evolution;
  evolution.mesh = frames.front();
  const TriangleMesh& first = frames.front();
  std::vector<bool> differs(static_cast<std::size_t>(first.vertexCount()), false);
  for (const TriangleMesh& frame : frames) {
    if (frame.vertexCount() != first.vertexCount() || frame.faces.rows() != first.faces.rows() ||
        frame.faces != first.faces) {
      throw InvalidInput("evolution: frames differ in vertices or faces");
    }
    for (Eigen::Index v = 0; v < first.vertexCount(); ++v) {
      if (frame.positions.row(v) != first.positions.row(v)) differs[v] = true;
    }
  }
  for (std::size_t v = 0; v < differs.size(); ++v) {
    if (differs[v]) evolution.moved.push_back(static_cast<std::int32_t>(v));
  }
  for (std::size_t f = 0; f < frames.size(); ++f) {
    Positions positions(static_cast<Eigen::Index>(evolution.moved.size()), 3);
    for (std::size_t m = 0; m < evolution.moved.size(); ++m) {
      positions.row(m) = frames[f].positions.row(evolution.moved[m]);
    }
    evolution.frames.push_back(std::move(positions));
    evolution.frameTitles.push_back("frame " + std::to_string(f));
  }
  return evolution;
}

std::string evolutionJson(const Evolution& evolution) {
  const TriangleMesh& mesh = evolution.mesh;
  Eigen::AlignedBox3d box = boundingBox(mesh.positions);
  for (const Positions& frame : evolution.frames) box.extend(boundingBox(frame));
  for (const EvolutionShape& shape : evolution.shapes) box.extend(boundingBox(shape.positions));
  const Point low = box.min();
  const double unit = std::max(box.sizes().maxCoeff(), 1e-9) / kSteps;
  const auto quantise = [&](double x, int axis) {
    return static_cast<std::int32_t>(std::lround((x - low[axis]) / unit));
  };

  std::vector<std::int32_t> positions;
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    for (int c = 0; c < 3; ++c) positions.push_back(quantise(mesh.positions(v, c), c));
  }
  const SurfaceScene scene(mesh);
  std::vector<std::int32_t> openness;
  for (const float open : scene.openness()) {
    openness.push_back(static_cast<std::int32_t>(std::lround(255 * open)));
  }

  Json frames = Json::array(), shapes = frames, maps = frames, labels = frames;
  std::vector<std::int32_t> before;
  for (const std::int32_t v : evolution.moved) {
    for (int c = 0; c < 3; ++c) before.push_back(positions[3 * static_cast<std::size_t>(v) + c]);
  }
  for (const Positions& frame : evolution.frames) {
    std::vector<std::int32_t> change(before.size());
    for (std::size_t i = 0; i < before.size(); ++i) {
      const int axis = static_cast<int>(i % 3);
      const std::int32_t now = quantise(frame(static_cast<Eigen::Index>(i / 3), axis), axis);
      change[i] = now - before[i];
      before[i] = now;
    }
    frames.push_back(packIntegers(change, 0));
  }
  for (const EvolutionShape& shape : evolution.shapes) {
    std::vector<std::int32_t> shift;
    for (Eigen::Index i = 0; i < shape.positions.size(); ++i) {
      const int axis = static_cast<int>(i % 3);
      shift.push_back(quantise(shape.positions(i / 3, axis), axis) - positions[i]);
    }
    shapes.push_back({{"name", shape.name}, {"shift", packIntegers(shift, 3)}});
  }
  for (const EvolutionMap& map : evolution.maps) maps.push_back(mapJson(map));
  for (const EvolutionLabels& map : evolution.labels) labels.push_back(labelsJson(map));
  Json json = {
      {"low", {low.x(), low.y(), low.z()}},
      {"unit", unit},
      {"positions", packIntegers(positions, 3)},
      {"faces", packIntegers(facesInOrder(mesh.faces), 3)},
      {"openness", packIntegers(openness, 1)},
      {"moved", packIntegers(evolution.moved, 1)},
      {"frames", frames},
      {"titles", evolution.frameTitles},
      {"region", packIntegers(evolution.region.empty() ? evolution.moved : evolution.region, 1)},
      {"shapes", shapes},
      {"detached", evolution.detached},
      {"maps", maps},
      {"labels", labels}};
  if (const auto& at = evolution.viewpoint) json["viewpoint"] = {at->x(), at->y(), at->z()};
  return json.dump();
}

}  // namespace explica::report
