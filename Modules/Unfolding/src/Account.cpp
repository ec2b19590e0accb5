// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/Account.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"
#include "Explica/Geometry/FaceCrossing.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace explica::unfolding {
namespace {

Vector areaVector(const TriangleMesh& mesh, std::int32_t face) {
  return 0.5 * (mesh.corner(face, 1) - mesh.corner(face, 0))
                   .cross(mesh.corner(face, 2) - mesh.corner(face, 0));
}

/// A column made of a member.
template <class Member>
EvolutionColumn column(const char* name, const char* format, Member member) {
  return {name, format, [member](const IterationRecord& row) {
            return static_cast<double>(std::invoke(member, row));
          }};
}

EvolutionColumn phaseColumn(const char* name, double PhaseSeconds::*member) {
  return {name, "%.4f", [member](const IterationRecord& row) { return row.phases.*member; }};
}

std::vector<EvolutionColumn> listColumns() {
  using R = IterationRecord;
  std::vector<EvolutionColumn> list = {column("visibility", "%.6f", &R::visibility),
                                       column("area_error_mean", "%.6g", &R::areaErrorMean),
                                       column("area_error_max", "%.6g", &R::areaErrorMax),
                                       column("area_error_share", "%.6g", &R::areaErrorShare),
                                       column("edge_strain_mean", "%.6g", &R::edgeStrainMean),
                                       column("collar_stretch_mean", "%.6g", &R::collarStretchMean),
                                       column("collar_stretch_max", "%.6g", &R::collarStretchMax)};
  for (const TermInfo& info : kTerms) {
    list.push_back({"energy_" + std::string(info.name), "%.6g",
                    [term = info.term](const R& row) { return row.energies[term]; }});
  }
  for (EvolutionColumn c :
       {column("objective_before", "%.9g", &R::objectiveBefore),
        column("objective_after", "%.9g", &R::objectiveAfter),
        column("contacts", "%.0f", &R::contacts),
        column("nearest_contact", "%.6g", &R::nearestContact),
        column("safe_step", "%.6g", &R::safeStep), column("step", "%.6g", &R::step),
        column("largest_move", "%.6g", &R::largestMove), column("damping", "%.6g", &R::damping),
        column("solves", "%.0f", &R::solves),
        phaseColumn("seconds_visibility", &PhaseSeconds::visibility),
        phaseColumn("seconds_repulsion", &PhaseSeconds::repulsion),
        phaseColumn("seconds_collision", &PhaseSeconds::collision),
        phaseColumn("seconds_solve", &PhaseSeconds::solve),
        column("seconds", "%.3f", &R::seconds)}) {
    list.push_back(std::move(c));
  }
  return list;
}

}  // namespace

const std::vector<EvolutionColumn>& evolutionColumns() {
  static const std::vector<EvolutionColumn> columns = listColumns();
  return columns;
}

Eigen::VectorXd vertexMeans(const TriangleMesh& mesh, std::span<const std::int32_t> faces,
                            const Eigen::VectorXd& faceValues, double elsewhere) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(mesh.vertexCount());
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(mesh.vertexCount());
  for (std::size_t n = 0; n < faces.size(); ++n) {
    const double area = areaVector(mesh, faces[n]).norm();
    for (int k = 0; k < 3; ++k) {
      sums[mesh.faces(faces[n], k)] += area * faceValues[static_cast<Eigen::Index>(n)];
      areas[mesh.faces(faces[n], k)] += area;
    }
  }
  return (areas.array() > 0).select(sums.cwiseQuotient(areas.cwiseMax(1e-300)), elsewhere);
}

Eigen::VectorXd vertexStrains(const TriangleMesh& reference, const Positions& deformed,
                              std::span<const std::int32_t> faces) {
  const Faces chosen = reference.faces(faces, Eigen::all);
  const Edges edges = geometry::buildTopology(chosen, reference.vertexCount()).edges;
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(reference.vertexCount());
  Eigen::VectorXd counts = sums;
  for (Eigen::Index e = 0; e < edges.rows(); ++e) {
    const std::int32_t a = edges(e, 0), b = edges(e, 1);
    const double length = (reference.positions.row(a) - reference.positions.row(b)).norm();
    if (!(length > 0)) continue;
    const double strain = std::abs((deformed.row(a) - deformed.row(b)).norm() / length - 1);
    for (const std::int32_t v : {a, b}) {
      sums[v] += strain;
      counts[v] += 1;
    }
  }
  return sums.cwiseQuotient(counts.cwiseMax(1));
}

std::string evolutionTable(const std::vector<IterationRecord>& history) {
  std::string table = "iteration\tphase";
  for (const EvolutionColumn& column : evolutionColumns()) table += "\t" + column.name;
  table += "\n";
  for (const IterationRecord& row : history) {
    table += std::to_string(row.iteration) + "\t" + std::string(nameOf(row.phase));
    for (const EvolutionColumn& column : evolutionColumns()) {
      table += "\t" + printed(column.format, column.of(row));
    }
    table += "\n";
  }
  return table;
}

std::vector<Crossing> listCrossings(const TriangleMesh& mesh,
                                    std::span<const geometry::FacePair> pairs,
                                    std::span<const geometry::FacePair> left,
                                    const Region& region) {
  std::vector<Crossing> list;
  for (const geometry::FacePair& pair : pairs) {
    Crossing crossing;
    crossing.faces = pair;
    crossing.place = geometry::placeOfCrossing(mesh, pair);
    for (const std::int32_t f : pair) {
      crossing.facesInRegion += std::binary_search(region.faces.begin(), region.faces.end(), f);
    }
    crossing.parted = !std::binary_search(left.begin(), left.end(), pair);
    list.push_back(crossing);
  }
  return list;
}

std::string crossingTable(const TriangleMesh& mesh, std::span<const Crossing> crossings) {
  std::string table = "face_1\tface_2\tvertices_1\tvertices_2\tx\ty\tz\tfaces_in_region\tparted\n";
  for (const Crossing& c : crossings) {
    const auto f = mesh.faces.row(c.faces[0]), g = mesh.faces.row(c.faces[1]);
    table += printed("%d\t%d\t%d,%d,%d\t%d,%d,%d\t%.4f\t%.4f\t%.4f\t%d\t%s\n", c.faces[0],
                     c.faces[1], f[0], f[1], f[2], g[0], g[1], g[2], c.place[0], c.place[1],
                     c.place[2], c.facesInRegion, c.parted ? "yes" : "no");
  }
  return table;
}

Positions roundedToSingle(const Positions& positions) {
  return positions.cast<float>().cast<double>();
}

void requireFitsSingle(const TriangleMesh& mesh, std::string_view name) {
  constexpr double kCoarsest = 0.02;  // of the mean edge: nearer features than this do not survive
  const double farthest = mesh.positions.cwiseAbs().maxCoeff();
  const double edge = geometry::meanEdgeLength(mesh);
  const double step = farthest * std::numeric_limits<float>::epsilon();
  if (step <= kCoarsest * edge) return;
  throw InvalidInput(
      std::string(name) +
      printed(": coordinates reach %.3g mm, where single precision, in which files keep them, "
              "steps by %.2g mm beside edges of %.2g mm; move the surface nearer to the origin",
              farthest, step, edge));
}

double backfacingShare(const TriangleMesh& mesh, std::span<const std::int32_t> faces,
                       const visibility::Viewpoints& viewpoints) {
  double away = 0, all = 0;
  for (const std::int32_t f : faces) {
    const Vector area = areaVector(mesh, f);
    const Point centroid = (mesh.corner(f, 0) + mesh.corner(f, 1) + mesh.corner(f, 2)) / 3;
    double flux = 0;
    for (std::size_t k = 0; k < viewpoints.points.size(); ++k) {
      flux += viewpoints.weights[k] * area.dot((viewpoints.points[k] - centroid).normalized());
    }
    all += area.norm();
    if (flux < 0) away += area.norm();
  }
  return all > 0 ? away / all : 0;
}

}  // namespace explica::unfolding
