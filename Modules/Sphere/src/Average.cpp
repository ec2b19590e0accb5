// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sphere/Average.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/SphereLocator.h"
#include "Explica/Sphere/SphereMap.h"

#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace explica::sphere {
namespace {

constexpr double kAtRest = 0.05;      // degrees: half of what is called the identity
constexpr double kEnoughPeople = 10;  // whose deviation is known to a quarter of itself
constexpr int kAlignments = 3;        // of shapes: the mean moves by less than 0.01 mm after two

using Places = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Where the directions lie on the faces of a spherical mesh, by its vertices.
Places placesOn(const TriangleMesh& sphere, const Positions& directions) {
  const geometry::SphereLocator locator(sphere);
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index v = 0; v < directions.rows(); ++v) {
    const auto place = locator.locate(directions.row(v).transpose());
    for (int k = 0; k < 3; ++k) {
      entries.emplace_back(v, sphere.faces(place.face, k), place.weights[k]);
    }
  }
  Places places(directions.rows(), sphere.vertexCount());
  places.setFromTriplets(entries.begin(), entries.end());
  return places;
}

Eigen::Matrix3d rotationOnto(const FoldingSphere& person, const SphereRegistration& found) {
  return bestRotation(person.sphere.positions, found.positions,
                      geometry::vertexAreas(person.sphere));
}

/// Means over the people at each vertex of the grid.
struct Means {
  Eigen::VectorXd sulc, curvature, sulcSquares, curvatureSquares;
  Positions places;  ///< on the people's own spheres, rotated; sum of unit vectors

  explicit Means(Eigen::Index vertices)
      : sulc(Eigen::VectorXd::Zero(vertices)),
        curvature(sulc),
        sulcSquares(sulc),
        curvatureSquares(sulc),
        places(Positions::Zero(vertices, 3)) {}

  void add(const FoldingSphere& person, const SphereRegistration& found, const Places& at) {
    const Eigen::VectorXd s = at * person.sulc, c = at * person.curvature;
    sulc += s;
    curvature += c;
    sulcSquares += s.cwiseAbs2();
    curvatureSquares += c.cwiseAbs2();
    places += Positions(at * person.sphere.positions * rotationOnto(person, found).transpose())
                  .rowwise()
                  .normalized();
  }
};

Eigen::VectorXd deviation(const Eigen::VectorXd& sum, const Eigen::VectorXd& squares, double n) {
  return ((squares - sum.cwiseAbs2() / n) / (n - 1)).cwiseMax(0).cwiseSqrt();
}

/// The folds at the mean places.
FoldingSphere meanOf(const Means& means, const Faces& faces, double n) {
  FoldingSphere mean;
  mean.sphere = {kSphereRadius * means.places.rowwise().normalized(), faces};
  makeOneToOne(mean.sphere);
  mean.sulc = means.sulc / n;
  mean.curvature = means.curvature / n;
  if (n < kEnoughPeople) return mean;
  mean.sulcSd = deviation(means.sulc, means.sulcSquares, n);
  mean.curvatureSd = deviation(means.curvature, means.curvatureSquares, n);
  return mean;
}

/// The same folds at the grid's vertices.
FoldingSphere onGrid(const FoldingSphere& mean, const TriangleMesh& grid) {
  const Places at = placesOn(mean.sphere, grid.positions);
  FoldingSphere folding{grid, at * mean.sulc, at * mean.curvature, {}, {}};
  if (mean.sulcSd.size() == 0) return folding;
  folding.sulcSd = at * mean.sulcSd;
  folding.curvatureSd = at * mean.curvatureSd;
  return folding;
}

/// From whom to begin, and in which order to add: whichever way people are named, by how deep their
/// folds are, so that it is the same; the person in the middle first.
std::vector<std::size_t> orderOf(const std::vector<FoldingSphere>& people) {
  std::vector<double> depth;
  for (const FoldingSphere& person : people) {
    depth.push_back((person.sulc.array() - person.sulc.mean()).square().mean());
  }
  std::vector<std::size_t> order(people.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](std::size_t p) { return depth[p]; });
  std::swap(order.front(), order[order.size() / 2]);
  return order;
}

double meanAngle(const Positions& a, const Positions& b) {
  return (a.rowwise().normalized() - b.rowwise().normalized()).rowwise().norm().mean() * 180 / kPi;
}

}  // namespace

SphereAverage averageSpheres(std::vector<FoldingSphere> people, const TriangleMesh& grid,
                             const AverageOptions& options, const Monitor& monitor) {
  if (people.size() < 2) throw InvalidInput("people: a mean is of two at least");
  const auto count = static_cast<double>(people.size());
  SphereAverage average;
  const std::vector<std::size_t> order = orderOf(people);
  FoldingSphere target = people[order.front()];
  RegisterOptions registration = options.registration;
  for (int n = 0; n < options.iterations; ++n) {
    Means means(grid.vertexCount());
    average.registered.resize(people.size());
    average.correlation = 0;
    double done = 0;
    for (const std::size_t p : order) {
      monitor.progress((n + done++ / count) / options.iterations,
                       "iteration " + std::to_string(n + 1) + ", person " + std::to_string(p + 1));
      const auto found = registerSphere(people[p], target, registration, monitor);
      if (found.termination == Termination::Interrupted) {
        average.termination = Termination::Interrupted;
        return average;
      }
      means.add(people[p], found,
                placesOn({found.positions, people[p].sphere.faces}, grid.positions));
      // From here on the person's sphere is turned as the template is.
      people[p].sphere.positions *= rotationOnto(people[p], found).transpose();
      average.registered[p] = found.positions;
      average.correlation += found.after.sulc / count;
    }
    registration.rotate = false;
    const FoldingSphere mean = meanOf(means, grid.faces, count);
    average.deformation.push_back(meanAngle(mean.sphere.positions, grid.positions));
    target = onGrid(mean, grid);
    for (Positions& person : average.registered) {
      person = placesOn(grid, person) * mean.sphere.positions;
      person = kSphereRadius * person.rowwise().normalized();
    }
    average.termination = Termination::MaxIterations;
    if (average.deformation.back() < kAtRest) {
      average.termination = Termination::Converged;
      break;
    }
  }
  average.folding = std::move(target);
  return average;
}

Positions meanShape(const std::vector<Positions>& shapes) {
  const auto centred = [](const Positions& shape) {
    return Positions(shape.rowwise() - shape.colwise().mean());
  };
  const Eigen::RowVector3d place = shapes.front().colwise().mean();
  const Eigen::VectorXd weights = Eigen::VectorXd::Ones(shapes.front().rows());
  Positions mean = centred(shapes.front());
  for (int n = 0; n < kAlignments; ++n) {
    Positions sum = Positions::Zero(mean.rows(), 3);
    for (const Positions& shape : shapes) {
      const Positions here = centred(shape);
      sum += here * bestRotation(here, mean, weights).transpose();
    }
    mean = sum / static_cast<double>(shapes.size());
  }
  return mean.rowwise() + place;
}

void AverageSummary::add(const SphereAverage& hemisphere) {
  people = std::max(people, static_cast<std::int64_t>(hemisphere.registered.size()));
  deformation = std::fmax(deformation, hemisphere.deformation.back());
  correlation = std::fmin(correlation, hemisphere.correlation);
}

void describe(Results& t, const AverageSummary& s) {
  t.count("people", "People", "Whose spheres and folds are averaged.", s.people).inHead();
  t.number("mean_deformation", "Mean deformation", "degrees",
           "Between a template's vertex and the mean of its places on the people's own spheres, "
           "mean over the template, before the last correction.",
           s.deformation)
      .atMost(0.1, Judgement::Look, "an unbiased template deforms its people by the identity")
      .inHead();
  t.number("folding_correlation_after", "Correlation of sulcal depth with the template", "",
           "Mean over the people.", s.correlation)
      .inHead();
}

}  // namespace explica::sphere
