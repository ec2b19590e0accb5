// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Watch.h"

#include "Explica/Collision/Repair.h"
#include "Explica/Core/Errors.h"
#include "Explica/Sampling/Depth.h"
#include "Explica/Sampling/NearestColumn.h"
#include "Explica/Sampling/Sampler.h"

namespace explica::python {
namespace {

using namespace py::literals;
using FloatArray = py::array_t<float, py::array::f_style | py::array::forcecast>;

/// Grid of an image's first three axes.
Grid gridOfFrames(const FloatArray& values, const Eigen::Matrix4d& affine) {
  if (values.ndim() < 3 || values.ndim() > 4) {
    throw InvalidInput("image: has " + std::to_string(values.ndim()) +
                       " axes; (I, J, K) or (I, J, K, T) is needed");
  }
  return gridFromAffine({static_cast<int>(values.shape(0)), static_cast<int>(values.shape(1)),
                         static_cast<int>(values.shape(2))},
                        affine);
}

py::array samplePoints(const FloatArray& values, const Eigen::Matrix4d& affine,
                       const PositionsIn& points, const std::string& interpolate,
                       const std::optional<py::array>& mask) {
  const Grid grid = gridOfFrames(values, affine);
  std::optional<Volume<std::uint8_t>> known;
  if (mask) {
    const Volume<float> given = scalarVolume(*mask, affine);
    known.emplace(given.grid);
    for (std::size_t v = 0; v < given.size(); ++v) known->data[v] = given[v] != 0;
  }
  const auto way = valueOf<sampling::Interpolation>(interpolate);
  const std::span<const float> frames(values.data(), static_cast<std::size_t>(values.size()));
  const Positions places = points;
  std::vector<float> got = unlocked([&] {
    return sampling::Sampler(grid, places, way, known ? &*known : nullptr).sample(frames);
  });
  const py::ssize_t count = points.rows(), some = values.ndim() == 4 ? values.shape(3) : 1;
  auto* kept = new std::vector<float>(std::move(got));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<float>*>(p); });
  return py::array_t<float>({some, count}, kept->data(), owner);
}

}  // namespace

void bindSampling(py::module_& m) {
  m.def("sample_points", &samplePoints, "values"_a, "affine"_a, "points"_a,
        "interpolate"_a = "linear", "mask"_a = py::none(),
        "Values (T, P) of an image (I, J, K) or (I, J, K, T) at points (P, 3), mm in the image's\n"
        "world; NaN where not known: outside the field of view or `mask`, or where the image is "
        "NaN.");
  m.def(
      "positions_at_depth",
      [](const PositionsIn& white, const PositionsIn& pial, const FacesIn& faces, double depth,
         const std::string& kind) {
        return sampling::positionsAtDepth(meshOf(white, faces), meshOf(pial, faces), depth,
                                          valueOf<sampling::DepthKind>(kind));
      },
      "white"_a, "pial"_a, "faces"_a, "depth"_a, "kind"_a = "depth",
      "Vertices (V, 3) at a depth from 0 (white) to 1 (pial) of the distance (\"depth\") or of "
      "the\n"
      "column's volume (\"volume\").");
  m.def(
      "nearest_columns",
      [](const PositionsIn& white, const PositionsIn& pial, const FacesIn& faces,
         const PositionsIn& points) {
        const auto places =
            sampling::nearestColumns(meshOf(white, faces), meshOf(pial, faces), points);
        Eigen::VectorXi vertex(static_cast<Eigen::Index>(places.size()));
        Eigen::VectorXd depth(vertex.size()), distance(vertex.size());
        for (Eigen::Index n = 0; n < vertex.size(); ++n) {
          vertex[n] = places[n].vertex;
          depth[n] = places[n].depth;
          distance[n] = places[n].distance;
        }
        return py::dict("vertex"_a = vertex, "depth"_a = depth, "distance"_a = distance);
      },
      "white"_a, "pial"_a, "faces"_a, "points"_a,
      "Where points (P, 3), RAS mm, lie in the cortex: the nearest column's vertex, the depth "
      "along\n"
      "it, the distance to it in mm.");
  m.def(
      "repair_surface",
      [](const PositionsIn& positions, const FacesIn& faces, double maxMove) {
        const TriangleMesh mesh = meshOf(positions, faces);
        collision::RepairOptions options;
        options.maxMove = maxMove;
        auto repaired = unlocked(
            [&] { return collision::repairSurfaces(std::span(&mesh, 1), options).front(); });
        return py::dict(
            "positions"_a = repaired.positions, "pairs_before"_a = rowsOf(repaired.before),
            "pairs_after"_a = rowsOf(repaired.after), "moved"_a = columnOf(repaired.moved),
            "move_mean"_a = repaired.moveMean, "move_max"_a = repaired.moveMax);
      },
      "positions"_a, "faces"_a, "max_move"_a = 0.75,
      "Parts faces that intersect by moves of at most `max_move` mm: positions (V, 3), the pairs "
      "of\n"
      "faces before and after, the vertices that moved and how far.");
}

}  // namespace explica::python
