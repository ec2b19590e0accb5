// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Watch.h"

#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/Geodesic.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"

namespace explica::python {

namespace {

std::pair<Positions, Faces> meshPair(TriangleMesh mesh) {
  return {std::move(mesh.positions), std::move(mesh.faces)};
}

py::dict conditionOf(const geometry::MeshCondition& c) {
  using namespace py::literals;
  return py::dict(
      "vertices"_a = c.vertices, "faces"_a = c.faces, "edges"_a = c.edges,
      "components"_a = c.components, "euler_characteristic"_a = c.eulerCharacteristic,
      "boundary_edges"_a = c.boundaryEdges, "non_manifold_edges"_a = c.nonManifoldEdges,
      "non_manifold_vertices"_a = c.nonManifoldVertices,
      "inconsistent_edges"_a = c.inconsistentEdges,
      "repeated_vertex_faces"_a = c.repeatedVertexFaces, "zero_area_faces"_a = c.zeroAreaFaces,
      "duplicate_faces"_a = c.duplicateFaces, "coincident_vertices"_a = c.coincidentVertices,
      "unused_vertices"_a = c.unusedVertices, "non_finite_vertices"_a = c.nonFiniteVertices,
      "indices_out_of_range"_a = c.indicesOutOfRange, "manifold"_a = c.manifold(),
      "closed_manifold"_a = c.closedManifold());
}

/// Binds a measure of a whole surface.
template <auto measure>
void defOfMesh(py::module_& m, const char* name, const char* doc) {
  m.def(
      name,
      [](const PositionsIn& positions, const FacesIn& faces) {
        return measure(meshOf(positions, faces));
      },
      py::arg("positions"), py::arg("faces"), doc);
}

/// Areas, normals and the volume.
void bindMeasures(py::module_& m) {
  defOfMesh<geometry::faceAreas>(
      m, "face_areas",
      "Area of each face, mm^2, shape (F,), of positions (V, 3) in mm and faces (F, 3).");
  defOfMesh<geometry::vertexAreas>(
      m, "vertex_areas", "A third of the areas of the faces at each vertex, mm^2, shape (V,).");
  defOfMesh<geometry::vertexNormals>(m, "vertex_normals",
                                     "Area-weighted outward unit normals, shape (V, 3).");
  defOfMesh<geometry::faceNormalVectors>(
      m, "face_normals", "Outward normal of each face, twice its area long, shape (F, 3), mm^2.");
  defOfMesh<geometry::enclosedVolume>(
      m, "enclosed_volume",
      "Signed volume of a closed surface, mm^3; positive if faces are outward.");
}

/// What makes a surface usable or not.
void bindTests(py::module_& m) {
  const auto p = py::arg("positions"), f = py::arg("faces");
  m.def(
      "inspect_mesh",
      [](const PositionsIn& positions, const FacesIn& faces) {
        return conditionOf(geometry::inspectMesh({positions, faces}));
      },
      p, f,
      "Counts of what makes a surface usable or not: Euler characteristic, boundary, defects.");
  m.def(
      "self_intersections",
      [](const PositionsIn& positions, const FacesIn& faces) {
        const TriangleMesh mesh = meshOf(positions, faces);
        return rowsOf(unlocked([&] { return geometry::findSelfIntersections(mesh); }));
      },
      p, f, "Pairs of faces that intersect, shape (N, 2); decided exactly.");
}

/// Distances on a surface.
void bindPlaces(py::module_& m) {
  const auto p = py::arg("positions"), f = py::arg("faces");
  m.def(
      "geodesic_distances",
      [](const PositionsIn& positions, const FacesIn& faces,
         const std::vector<std::int32_t>& sources, double limit) {
        const TriangleMesh mesh = meshOf(positions, faces);
        return unlocked([&] {
          const auto topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
          return geometry::geodesicDistances(mesh, topology, sources, limit);
        });
      },
      p, f, py::arg("sources"), py::arg("limit") = kInfinity,
      "Distance along the surface from the nearest source vertex, mm, shape (V,); inf beyond "
      "limit.");
}

/// Surfaces whose measures are known.
void bindFixtures(py::module_& m) {
  m.def(
      "icosphere",
      [](int levels, double radius) { return meshPair(geometry::makeIcosphere(levels, radius)); },
      py::arg("levels"), py::arg("radius") = 1.0,
      "Sphere of 20 * 4**levels faces: positions (V, 3), faces (F, 3).");
  m.def(
      "folded_sphere",
      [](int levels, double radius, double depth, int waves) {
        return meshPair(geometry::makeFoldedSphere(levels, radius, depth, waves));
      },
      py::arg("levels"), py::arg("radius") = 1.0, py::arg("depth") = 0.25, py::arg("waves") = 6,
      "Sphere with folds: positions (V, 3), faces (F, 3).");
}

}  // namespace

void bindGeometry(py::module_& m) {
  bindMeasures(m);
  bindTests(m);
  bindPlaces(m);
  bindFixtures(m);
}

}  // namespace explica::python
