// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"

#include "Explica/Geometry/FaceTree.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/Geodesic.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"

namespace explica::python {

using PositionsIn = Eigen::Ref<const Positions>;
using FacesIn = Eigen::Ref<const Faces>;

namespace {

py::tuple meshTuple(TriangleMesh mesh) {
  return py::make_tuple(py::cast(std::move(mesh.positions)), py::cast(std::move(mesh.faces)));
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

}  // namespace

void bindGeometry(py::module_& m) {
  const auto p = py::arg("positions"), f = py::arg("faces");
  m.def(
      "face_areas",
      [](const PositionsIn& positions, const FacesIn& faces) {
        return geometry::faceAreas(meshOf(positions, faces));
      },
      p, f, "Area of each face, mm^2, shape (F,), of positions (V, 3) in mm and faces (F, 3).");
  m.def(
      "vertex_areas",
      [](const PositionsIn& positions, const FacesIn& faces) {
        return geometry::vertexAreas(meshOf(positions, faces));
      },
      p, f, "A third of the areas of the faces at each vertex, mm^2, shape (V,).");
  m.def(
      "vertex_normals",
      [](const PositionsIn& positions, const FacesIn& faces) {
        return geometry::vertexNormals(meshOf(positions, faces));
      },
      p, f, "Area-weighted outward unit normals, shape (V, 3).");
  m.def(
      "enclosed_volume",
      [](const PositionsIn& positions, const FacesIn& faces) {
        return geometry::enclosedVolume(meshOf(positions, faces));
      },
      p, f, "Signed volume of a closed surface, mm^3; positive if faces are outward.");
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
        const auto pairs = [&] {
          const py::gil_scoped_release unlocked;
          return geometry::findSelfIntersections(mesh);
        }();
        Edges result(static_cast<Eigen::Index>(pairs.size()), 2);
        for (std::size_t n = 0; n < pairs.size(); ++n) {
          result.row(static_cast<Eigen::Index>(n)) << pairs[n][0], pairs[n][1];
        }
        return result;
      },
      p, f, "Pairs of faces that intersect, shape (N, 2); decided exactly.");
  m.def(
      "geodesic_distances",
      [](const PositionsIn& positions, const FacesIn& faces,
         const std::vector<std::int32_t>& sources, double limit) {
        const TriangleMesh mesh = meshOf(positions, faces);
        const auto topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
        return geometry::geodesicDistances(mesh, topology, sources, limit);
      },
      p, f, py::arg("sources"), py::arg("limit") = kInfinity,
      "Distance along the surface from the nearest source vertex, mm, shape (V,); inf beyond "
      "limit.");
  m.def(
      "closest_points",
      [](const PositionsIn& positions, const FacesIn& faces, const PositionsIn& queries) {
        const geometry::FaceTree tree(meshOf(positions, faces));
        Positions points(queries.rows(), 3);
        Eigen::VectorXi face(queries.rows());
        for (Eigen::Index q = 0; q < queries.rows(); ++q) {
          const auto nearest = tree.closestPoint(queries.row(q).transpose());
          points.row(q) = nearest.point.transpose();
          face[q] = nearest.face;
        }
        return std::make_pair(points, face);
      },
      p, f, py::arg("queries"),
      "Nearest surface points, shape (N, 3), and their faces, shape (N,), of query points (N, 3).");
  m.def(
      "icosphere",
      [](int levels, double radius) { return meshTuple(geometry::makeIcosphere(levels, radius)); },
      py::arg("levels"), py::arg("radius") = 1.0,
      "Sphere of 20 * 4**levels faces: positions (V, 3), faces (F, 3).");
  m.def(
      "folded_sphere",
      [](int levels, double radius, double depth, int waves) {
        return meshTuple(geometry::makeFoldedSphere(levels, radius, depth, waves));
      },
      py::arg("levels"), py::arg("radius") = 1.0, py::arg("depth") = 0.25, py::arg("waves") = 6,
      "Sphere with folds: positions (V, 3), faces (F, 3).");
}

}  // namespace explica::python
