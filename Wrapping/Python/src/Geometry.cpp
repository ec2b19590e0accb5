// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Watch.h"

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

/// Areas, normals, angles, lengths and the Laplacian.
void bindMeasures(py::module_& m) {
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
      "face_normals",
      [](const PositionsIn& positions, const FacesIn& faces) {
        return geometry::faceNormalVectors(meshOf(positions, faces));
      },
      p, f, "Outward normal of each face, twice its area long, shape (F, 3), mm^2.");
  m.def(
      "enclosed_volume",
      [](const PositionsIn& positions, const FacesIn& faces) {
        return geometry::enclosedVolume(meshOf(positions, faces));
      },
      p, f, "Signed volume of a closed surface, mm^3; positive if faces are outward.");
  m.def(
      "smallest_angles",
      [](const PositionsIn& positions, const FacesIn& faces) {
        return geometry::smallestAnglesRad(meshOf(positions, faces));
      },
      p, f, "Smallest interior angle of each face, radians, shape (F,).");
  m.def(
      "mean_edge_length",
      [](const PositionsIn& positions, const FacesIn& faces) {
        return geometry::meanEdgeLength(meshOf(positions, faces));
      },
      p, f, "Mean length of the edges, mm, each counted once per face.");
  m.def(
      "cotangent_laplacian",
      [](const PositionsIn& positions, const FacesIn& faces) {
        const auto matrix = geometry::cotangentLaplacian(meshOf(positions, faces));
        Eigen::VectorXi row(matrix.nonZeros()), column(matrix.nonZeros());
        Eigen::VectorXd value(matrix.nonZeros());
        Eigen::Index n = 0;
        for (Eigen::Index outer = 0; outer < matrix.outerSize(); ++outer) {
          for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, outer); it; ++it, ++n) {
            row[n] = static_cast<int>(it.row());
            column[n] = static_cast<int>(it.col());
            value[n] = it.value();
          }
        }
        return std::make_tuple(std::move(value), std::move(row), std::move(column));
      },
      p, f,
      "Cotangent Laplacian (V, V), symmetric positive semi-definite, without mass, as\n"
      "(values, rows, columns): scipy.sparse.coo_matrix((values, (rows, columns))).");
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

/// Distances on a surface and from it.
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
  m.def(
      "closest_points",
      [](const PositionsIn& positions, const FacesIn& faces, const PositionsIn& queries) {
        const TriangleMesh mesh = meshOf(positions, faces);
        Positions points(queries.rows(), 3);
        Eigen::VectorXi face(queries.rows());
        unlocked([&] {
          const geometry::FaceTree tree(mesh);
          for (Eigen::Index q = 0; q < queries.rows(); ++q) {
            const auto nearest = tree.closestPoint(queries.row(q).transpose());
            points.row(q) = nearest.point.transpose();
            face[q] = nearest.face;
          }
        });
        return std::make_tuple(std::move(points), std::move(face));
      },
      p, f, py::arg("queries"),
      "Nearest surface points, shape (N, 3), and their faces, shape (N,), of query points (N, 3).");
}

/// Edges, pieces and parts.
void bindTopology(py::module_& m) {
  const auto p = py::arg("positions"), f = py::arg("faces");
  m.def(
      "mesh_edges",
      [](const PositionsIn& positions, const FacesIn& faces) {
        const TriangleMesh mesh = meshOf(positions, faces);
        auto topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
        return std::make_pair(std::move(topology.edges), std::move(topology.edgeFaces));
      },
      p, f,
      "Edges (E, 2), smaller vertex first, and the faces at each (E, 2), the second -1 on the "
      "boundary.");
  m.def(
      "face_components",
      [](const PositionsIn& positions, const FacesIn& faces) {
        const TriangleMesh mesh = meshOf(positions, faces);
        return columnOf(geometry::faceComponents(mesh.faces, mesh.vertexCount()));
      },
      p, f, "Component of each face, (F,), from 0 in the order of their first faces.");
  m.def(
      "extract_faces",
      [](const PositionsIn& positions, const FacesIn& faces,
         const std::vector<std::int32_t>& wanted) {
        const TriangleMesh mesh = meshOf(positions, faces);
        requireFaces(mesh, wanted, "wanted");
        auto part = geometry::extractFaces(mesh, wanted);
        return std::make_tuple(std::move(part.mesh.positions), std::move(part.mesh.faces),
                               columnOf(part.vertexOrigin));
      },
      p, f, py::arg("wanted"),
      "The listed faces on their own vertices only: positions (v, 3), faces (f, 3), and the "
      "vertex\n"
      "of the whole that each vertex of the part is, (v,).");
  m.def(
      "subdivide",
      [](const PositionsIn& positions, const FacesIn& faces) {
        return meshPair(geometry::subdivide(meshOf(positions, faces)));
      },
      p, f, "Each face into four by its edges' midpoints; old vertices keep their numbers.");
}

/// Surfaces whose measures are known.
void bindFixtures(py::module_& m) {
  m.def(
      "torus",
      [](int majorSegments, int minorSegments, double major, double minor) {
        return meshPair(geometry::makeTorus(majorSegments, minorSegments, major, minor));
      },
      py::arg("major_segments"), py::arg("minor_segments"), py::arg("major"), py::arg("minor"),
      "Torus about the z axis, `major` mm to the tube's centre, `minor` mm the tube: positions\n"
      "(V, 3), faces (F, 3).");
  m.def(
      "rectangle",
      [](int columns, int rows, double width, double height) {
        return meshPair(geometry::makeRectangle(columns, rows, width, height));
      },
      py::arg("columns"), py::arg("rows"), py::arg("width"), py::arg("height"),
      "Flat rectangle [0, width] x [0, height] mm in z = 0: positions (V, 3), faces (F, 3).");
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
  bindTopology(m);
  bindFixtures(m);
}

}  // namespace explica::python
