// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sampling/Ribbon.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Known.h"

#include <Eigen/Geometry>

#include <array>
#include <cmath>

namespace explica::sampling {
namespace {

constexpr int kLayers = 10;         // between white and pial surface
constexpr double kThinnest = 1e-3;  // mm: where the surfaces touch, places count a little still

/// Centres of the four triangles into which the middles of its edges cut a face.
constexpr std::array<std::array<double, 3>, 4> kPlaces = {{{2.0 / 3, 1.0 / 6, 1.0 / 6},
                                                           {1.0 / 6, 2.0 / 3, 1.0 / 6},
                                                           {1.0 / 6, 1.0 / 6, 2.0 / 3},
                                                           {1.0 / 3, 1.0 / 3, 1.0 / 3}}};

/// Sums of value times volume, and of the volumes that are known, per face and frame.
struct FaceSums {
  std::vector<double> value, volume;  ///< frames x F
  std::vector<double> all;            ///< F: the volumes
};

/// One layer of every face's prism: its corners, and the volume of a quarter of it.
struct Layer {
  Positions corners;  ///< V x 3
  std::vector<double> quarter;
};

Layer layerAt(const TriangleMesh& white, const TriangleMesh& pial, double depth) {
  Layer layer{(1 - depth) * white.positions + depth * pial.positions, {}};
  layer.quarter.resize(static_cast<std::size_t>(white.faceCount()));
  parallelFor(layer.quarter.size(), [&](std::size_t f) {
    const auto face = white.faces.row(f);
    const auto corner = [&](int k) -> Point { return layer.corners.row(face[k]).transpose(); };
    const double area = 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
    double thickness = kThinnest;
    for (int k = 0; k < 3; ++k) {
      thickness += (pial.positions.row(face[k]) - white.positions.row(face[k])).norm() / 3;
    }
    layer.quarter[f] = area * thickness / (kLayers * static_cast<double>(kPlaces.size()));
  });
  return layer;
}

Positions placesIn(const Layer& layer, const Faces& faces, const std::array<double, 3>& weights) {
  Positions places(faces.rows(), 3);
  parallelFor(static_cast<std::size_t>(faces.rows()), [&](std::size_t f) {
    const auto row = static_cast<Eigen::Index>(f);
    places.row(row) = weights[0] * layer.corners.row(faces(row, 0)) +
                      weights[1] * layer.corners.row(faces(row, 1)) +
                      weights[2] * layer.corners.row(faces(row, 2));
  });
  return places;
}

void add(const std::vector<float>& values, const std::vector<double>& volumes, FaceSums& sums) {
  const std::size_t faces = volumes.size(), frames = values.size() / faces;
  parallelFor(faces, [&](std::size_t f) {
    sums.all[f] += volumes[f];
    for (std::size_t at = f; at < frames * faces; at += faces) {
      if (std::isnan(values[at])) continue;
      sums.value[at] += volumes[f] * values[at];
      sums.volume[at] += volumes[f];
    }
  });
}

/// From the faces to the vertices that they have.
std::vector<float> atVertices(const FaceSums& sums, const TriangleMesh& mesh) {
  const auto faces = static_cast<std::size_t>(mesh.faceCount()),
             vertices = static_cast<std::size_t>(mesh.vertexCount());
  const std::size_t frames = sums.value.size() / faces;
  std::vector<float> result(frames * vertices, std::numeric_limits<float>::quiet_NaN());
  parallelFor(frames, 1, [&](std::size_t frame) {
    std::vector<double> value(vertices), volume(vertices), all(vertices);
    for (std::size_t f = 0; f < faces; ++f) {
      for (const std::int32_t v : mesh.faces.row(f)) {
        value[v] += sums.value[frame * faces + f];
        volume[v] += sums.volume[frame * faces + f];
        all[v] += sums.all[f];
      }
    }
    for (std::size_t v = 0; v < vertices; ++v) {
      if (volume[v] > 0 && volume[v] >= kEnough * all[v]) {
        result[frame * vertices + v] = static_cast<float>(value[v] / volume[v]);
      }
    }
  });
  return result;
}

}  // namespace

RibbonSampler::RibbonSampler(const Grid& grid, const TriangleMesh& white, const TriangleMesh& pial,
                             Interpolation interpolation,
                             std::function<Positions(const Positions&)> toVolume,
                             const Volume<std::uint8_t>* mask)
    : grid_(grid),
      white_(white),
      pial_(pial),
      interpolation_(interpolation),
      toVolume_(std::move(toVolume)),
      mask_(mask) {
  if (white.positions.rows() != pial.positions.rows() || white.faceCount() == 0) {
    throw InvalidInput("white and pial surface: they need the same vertices, and faces");
  }
}

std::vector<float> RibbonSampler::sample(std::span<const float> frames) const {
  const auto faces = static_cast<std::size_t>(white_.faceCount());
  const std::size_t count = frames.size() / std::max<std::size_t>(1, grid_.voxelCount());
  FaceSums sums{std::vector<double>(count * faces), std::vector<double>(count * faces),
                std::vector<double>(faces)};
  for (int n = 0; n < kLayers; ++n) {
    const Layer layer = layerAt(white_, pial_, (n + 0.5) / kLayers);
    for (const auto& weights : kPlaces) {
      Positions places = placesIn(layer, white_.faces, weights);
      if (toVolume_) places = toVolume_(places);
      add(Sampler(grid_, places, interpolation_, mask_).sample(frames), layer.quarter, sums);
    }
  }
  return atVertices(sums, white_);
}

}  // namespace explica::sampling
