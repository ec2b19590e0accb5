// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/AreaProjection.h"
#include "../src/Around.h"
#include "../src/Room.h"
#include "../src/energies/Energy.h"

#include "Meander.h"

#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Visibility/AverageVisibility.h"

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <numeric>
#include <random>

namespace explica::unfolding {
namespace {

struct Sample {
  TriangleMesh mesh = makeMeander(6, 4, 1.2, 1);
  visibility::Viewpoints view{{Point(3, 2, 9), Point(-4, 1, 12)}, {0.25, 0.75}};
  Patch patch;
  Objective objective;
  Positions directions;  ///< of the faces of the region; no rows: towards the view
  Eigen::VectorXd multipliers;
  std::vector<std::int32_t> unknown;
  std::vector<collision::Contact> contacts;
  std::unique_ptr<repulsion::KnotEnergy> knot = repulsion::makeKnotEnergy(
      repulsion::KnotMethod::AllPairs, mesh,
      std::vector<bool>(static_cast<std::size_t>(mesh.vertexCount()), true));

  Sample() {
    const Eigen::VectorXd areas = geometry::faceAreas(mesh);
    for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
      patch.faces.push_back({{mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)},
                             (f % 2 == 0 ? 0.9 : 0.2) * areas[f],
                             areas[f],
                             1.5 * areas[f],
                             0.5 * areas[f]});
    }
    patch.regionFaces = patch.faces.size() * 3 / 4;
    const Edges edges = geometry::buildTopology(mesh.faces, mesh.vertexCount()).edges;
    for (Eigen::Index e = 0; e < edges.rows(); ++e) {
      patch.springs.push_back({{edges(e, 0), edges(e, 1)}, 1.1, 0.5});
    }
    patch.regionSprings = patch.springs.size() * 3 / 4;
    patch.yieldStrain = 0.1;
    patch.room = {Vector(0.6, 0, -0.8), 40, 5};  // above all of it, faces look away from it
    guideBeside(0.035);
    multipliers = Eigen::VectorXd::LinSpaced(static_cast<Eigen::Index>(patch.regionFaces), -1, 2);
    unknown.resize(static_cast<std::size_t>(mesh.vertexCount()));
    std::iota(unknown.begin(), unknown.end(), 0);
    listAround(patch, unknown);
    const auto last = static_cast<std::int32_t>(mesh.vertexCount()) - 1;
    contacts.push_back({{last, mesh.faces(0, 0), mesh.faces(0, 1), mesh.faces(0, 2)},
                        collision::PairKind::VertexFace,
                        50});
  }

  /// Every other vertex is guided to a place `share` of the guide's radius beside it.
  void guideBeside(double share) {
    patch.guide.axis = Vector(0.6, 0, -0.8);
    patch.guide.radius = 40;
    patch.guide.vertices.clear();
    patch.guide.weights.clear();
    for (std::int32_t v = 0; v < mesh.vertexCount(); v += 2) {
      patch.guide.vertices.push_back(v);
      patch.guide.weights.push_back(1 + 0.1 * v);
    }
    patch.guide.places = mesh.positions(patch.guide.vertices, Eigen::all);
    patch.guide.places.rowwise() += 40 * share * Eigen::RowVector3d(0.8, 0, 0.6);
  }

  [[nodiscard]] Configuration at(const Positions& x) const {
    Configuration now(patch, x, view, multipliers, contacts, knot.get());
    if (directions.rows() > 0) now.directions = &directions;
    return now;
  }
  [[nodiscard]] double value(const Positions& x, const TermValues& strengths) const {
    IterationRecord account;
    return objective.value(at(x), strengths, account);
  }
  [[nodiscard]] Positions gradient(const TermValues& strengths) const {
    IterationRecord account;
    return objective.gradient(at(mesh.positions), strengths, account);
  }

  /// The stiffness as a dense matrix, from solutions with a shifted diagonal.
  [[nodiscard]] Eigen::MatrixXd stiffness(const TermValues& strengths) const {
    constexpr double kShift = 10;
    BlockSystem system;
    Couplings couplings;
    const auto count = static_cast<std::int32_t>(mesh.vertexCount());
    for (std::int32_t i = 0; i < count; ++i) {
      for (std::int32_t j = 0; j < i; ++j) couplings.emplace_back(i, j);
    }
    system.reset(count, couplings);
    objective.addStiffness(at(mesh.positions), strengths, unknown, system);
    system.addDiagonal(kShift);
    Eigen::MatrixXd inverse(3 * count, 3 * count);
    for (std::int32_t column = 0; column < 3 * count; ++column) {
      Positions unit = Positions::Zero(count, 3), solution;
      unit.data()[column] = 1;
      EXPECT_TRUE(system.solve(unit, solution));
      inverse.col(column) = Eigen::Map<const Eigen::VectorXd>(solution.data(), 3 * count);
    }
    EXPECT_NEAR((inverse - inverse.transpose()).norm(), 0, 1e-9 * inverse.norm());
    const Eigen::LDLT<Eigen::MatrixXd> factors(inverse);
    Eigen::MatrixXd dense(3 * count, 3 * count);
    for (Eigen::Index column = 0; column < dense.cols(); ++column) {
      const Eigen::VectorXd unit = Eigen::VectorXd::Unit(dense.rows(), column);
      dense.col(column) = factors.solve(unit);
      dense(column, column) -= kShift;
    }
    return dense;
  }
};

/// One term alone; the multipliers belong to the areas and are there with any strength.
TermValues only(Term term, double strength) {
  TermValues strengths;
  strengths[term] = strength;
  return strengths;
}

Positions randomDirection(Eigen::Index count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Positions d(count, 3);
  for (Eigen::Index i = 0; i < d.size(); ++i) d.data()[i] = uniform(random);
  return d;
}

TEST(Around, ListsTheCornersOfEveryUnknownByItem) {
  const std::vector<std::array<std::int32_t, 3>> items = {{0, 1, 2}, {2, 1, 3}, {4, 3, 1}};
  const std::vector<std::int32_t> unknown = {-1, 2, 0, -1, 1};
  const Around around(items.size(), unknown, [&](std::size_t n) { return items[n]; });
  ASSERT_EQ(around.rows(), 3U);
  const std::vector<std::vector<std::array<std::int32_t, 2>>> expected = {
      {{0, 2}, {1, 0}}, {{2, 0}}, {{0, 1}, {1, 1}, {2, 2}}};
  for (std::size_t row = 0; row < 3; ++row) {
    std::vector<std::array<std::int32_t, 2>> found;
    for (const auto& [item, place] : around.at(row)) found.push_back({item, place});
    EXPECT_EQ(found, expected[row]) << row;
  }
  EXPECT_EQ(Around().rows(), 0U);
}

/// Each row of the table: E(x + h d) - E(x) - h g.d must fall as h^2.
TEST(Energy, GradientOfEveryTermPassesTheTaylorTest) {
  for (const TermInfo& info : kTerms) {
    Sample s;
    if (info.term != Term::Area) s.multipliers.setZero();
    const Positions d = randomDirection(s.mesh.vertexCount(), 3);
    const TermValues strengths = only(info.term, 1.3);
    const double slope = (s.gradient(strengths).array() * d.array()).sum();
    const auto valueAt = [&](double h) { return s.value(s.mesh.positions + h * d, strengths); };
    EXPECT_GT(std::abs(valueAt(0)), 0) << info.name;
    const auto remainder = [&](double h) { return std::abs(valueAt(h) - valueAt(0) - h * slope); };
    const double rate = std::log10(remainder(1e-3) / remainder(1e-4));
    EXPECT_GT(rate, 1.85) << info.name;
    EXPECT_LT(rate, 2.15) << info.name;
  }
}

TEST(Energy, GradientTowardsDirectionsOfTheFacesOwnPassesTheTaylorTest) {
  Sample s;
  s.multipliers.setZero();
  s.directions = randomDirection(static_cast<Eigen::Index>(s.patch.regionFaces), 5);
  s.directions.rowwise().normalize();
  for (PatchFace& face : s.patch.faces) face.holdWeight = 0;
  const Positions d = randomDirection(s.mesh.vertexCount(), 3);
  const TermValues strengths = only(Term::Visibility, 1.3);
  const double slope = (s.gradient(strengths).array() * d.array()).sum();
  const auto valueAt = [&](double h) { return s.value(s.mesh.positions + h * d, strengths); };
  const auto remainder = [&](double h) { return std::abs(valueAt(h) - valueAt(0) - h * slope); };
  const double rate = std::log10(remainder(1e-3) / remainder(1e-4));
  EXPECT_GT(rate, 1.85);
  EXPECT_LT(rate, 2.15);
  // The term is the weight times one less the cosine.
  double expected = 0;
  for (std::size_t f = 0; f < s.patch.regionFaces; ++f) {
    const auto row = static_cast<Eigen::Index>(f);
    const double cosine =
        s.directions.row(row).dot(shapeOf(s.patch.faces[f], s.mesh.positions).normal);
    expected += 1.3 * s.patch.faces[f].weight * (1 - cosine);
  }
  EXPECT_NEAR(valueAt(0), expected, 1e-9 * expected);
}

TEST(Energy, StiffnessOfEveryTermIsSymmetricPositiveSemiDefinite) {
  for (const TermInfo& info : kTerms) {
    Sample s;
    if (info.term != Term::Area) s.multipliers.setZero();
    const Eigen::MatrixXd all = s.stiffness(only(info.term, 1.3));
    EXPECT_NEAR((all - all.transpose()).norm(), 0, 1e-7 * (1 + all.norm())) << info.name;
    // As many of its pivots are negative as of its eigenvalues (Sylvester's law of inertia).
    const double shift = 1e-7 * (1 + all.norm());
    const Eigen::MatrixXd shifted = all + shift * Eigen::MatrixXd::Identity(all.rows(), all.cols());
    EXPECT_GT(Eigen::LDLT<Eigen::MatrixXd>(shifted).vectorD().minCoeff(), 0) << info.name;
  }
}

TEST(Energy, StiffnessIsTheHessianWhereAreasAndLengthsAreAtRest) {
  for (const Term term : {Term::Area, Term::Spring, Term::Collar}) {
    Sample s;
    const Positions& x = s.mesh.positions;
    for (PatchFace& face : s.patch.faces) face.restArea = shapeOf(face, x).area;
    for (PatchSpring& spring : s.patch.springs) spring.restLength = lengthOf(spring, x);
    s.multipliers.setZero();
    const TermValues strengths = only(term, 4);
    const Eigen::MatrixXd hessian = s.stiffness(strengths);
    const Positions d = randomDirection(s.mesh.vertexCount(), 5);
    const Eigen::Map<const Eigen::VectorXd> flat(d.data(), d.size());
    constexpr double h = 1e-4;
    const double curvature =
        (s.value(x + h * d, strengths) + s.value(x - h * d, strengths)) / (h * h);
    EXPECT_NEAR(flat.dot(hessian * flat), curvature, 1e-4 * curvature)
        << kTerms[static_cast<std::size_t>(term)].name;
  }
}

TEST(Energy, AFaceOfTheCollarThatHasGivenWayIsHeldBackNoStifferFartherOn) {
  Sample s;
  s.multipliers.setZero();
  const Positions& x = s.mesh.positions;
  const auto stretchTo = [&](double ratio) {
    for (PatchFace& face : s.patch.faces) face.restArea = shapeOf(face, x).area / ratio;
  };
  const TermValues strengths = only(Term::Collar, 0);  // what holds back has a strength of its own
  const auto heldAt = [&](double share) {              // of the way from kCollarMean to kCollarMost
    stretchTo(kCollarMean + share * (kCollarMost - kCollarMean));
    return s.value(x, strengths);
  };
  const double most = heldAt(1);
  EXPECT_EQ(heldAt(0), 0);
  EXPECT_NEAR(heldAt(0.5), most / 32, 1e-12 * most);
  // Value, slope and curvature of the fifth power go on from there as a parabola.
  EXPECT_NEAR(heldAt(1.5), (1 + 5 * 0.5 + 10 * 0.25) * most, 1e-12 * most);
  EXPECT_NEAR(heldAt(5), (1 + 5 * 4 + 10 * 16) * most, 1e-10 * most);

  stretchTo(1.5 * kCollarMost);
  const Positions d = randomDirection(s.mesh.vertexCount(), 3);
  const double slope = (s.gradient(strengths).array() * d.array()).sum();
  const auto remainder = [&](double h) {
    return std::abs(s.value(x + h * d, strengths) - s.value(x, strengths) - h * slope);
  };
  const double rate = std::log10(remainder(1e-3) / remainder(1e-4));
  EXPECT_GT(rate, 1.85);
  EXPECT_LT(rate, 2.15);
}

/// What "Add an energy" of the module's page asks for, and no more: a pull of the region's faces to
/// a plane, strength/2 * sum of w (h / radius)^2, h the height of the centroid over the plane.
class PlaneEnergy final : public Energy {
 public:
  [[nodiscard]] double value(const Configuration& now, double strength) const override {
    double sum = 0;
    for (const PatchFace& face : now.patch.ofRegion()) {
      const double share = heightOf(face, now) / now.patch.room.radius;
      sum += 0.5 * strength * face.weight * share * share;
    }
    return sum;
  }

  void addGradient(const Configuration& now, double strength, Positions& gradient) const override {
    const PatchRoom& room = now.patch.room;
    for (const PatchFace& face : now.patch.ofRegion()) {
      const double pull =
          strength * face.weight * heightOf(face, now) / (room.radius * room.radius);
      for (const std::int32_t v : face.vertices) {
        gradient.row(v) += pull / 3 * room.axis.transpose();
      }
    }
  }

  void addStiffness(const Configuration& now, double strength,
                    const std::vector<std::int32_t>& unknown, BlockSystem& system) const override {
    const auto faces = now.patch.ofRegion();
    const PatchRoom& room = now.patch.room;
    const Eigen::Matrix3d along = room.axis * room.axis.transpose();
    const double scale = strength / (9 * room.radius * room.radius);
    addBlocks(
        now.patch.facesAround, 0, faces.size(), [&](std::int32_t f) { return faces[f].vertices; },
        unknown, system,
        [&](std::int32_t f, int, int) -> Eigen::Matrix3d {
          return scale * faces[f].weight * along;
        });
  }

 private:
  static double heightOf(const PatchFace& face, const Configuration& now) {
    return now.patch.room.axis.dot(centroidOf(face, now.x));
  }
};

TEST(Energy, ANewOneIsAClassOfThreeFunctionsOfWhichTheLastLeadsToItsMinimum) {
  Sample s;
  const PlaneEnergy energy;
  const Positions d = randomDirection(s.mesh.vertexCount(), 7);
  const auto gradientAt = [&](const Positions& x) {
    Positions gradient = Positions::Zero(x.rows(), 3);
    energy.addGradient(s.at(x), 1.3, gradient);
    return gradient;
  };
  const auto valueAt = [&](const Positions& x) { return energy.value(s.at(x), 1.3); };
  const Positions& x = s.mesh.positions;
  const double slope = (gradientAt(x).array() * d.array()).sum();
  const auto remainder = [&](double h) {
    return std::abs(valueAt(x + h * d) - valueAt(x) - h * slope);
  };
  EXPECT_NEAR(std::log10(remainder(1e-2) / remainder(1e-3)), 2, 0.05);
  // It is quadratic: one step of its stiffness, hardly damped, ends where it is flat.
  constexpr double kDamping = 1e-7;
  BlockSystem system;
  Couplings couplings;
  for (std::int32_t i = 0; i < s.mesh.vertexCount(); ++i) {
    for (std::int32_t j = 0; j < i; ++j) couplings.emplace_back(i, j);
  }
  system.reset(static_cast<std::int32_t>(s.mesh.vertexCount()), couplings);
  energy.addStiffness(s.at(x), 1.3, s.unknown, system);
  system.addDiagonal(kDamping);
  Positions step;
  ASSERT_TRUE(system.solve(-gradientAt(x), step));
  EXPECT_GT(valueAt(x), 0);
  EXPECT_LT(valueAt(x + step), 1e-6 * valueAt(x));
  EXPECT_EQ(energy.phase(), &PhaseSeconds::visibility);
}

TEST(Energy, LiftPullsAlongItsAxisUpToItsHeightOnly) {
  Sample s;
  for (PatchFace& face : s.patch.faces) face.holdWeight = 0;
  s.multipliers.setZero();
  const auto pull = [&](double height) {
    s.patch.room = {Vector::UnitZ(), height, 5};
    return s.gradient(only(Term::Lift, 2));
  };
  const double top = s.mesh.positions.col(2).maxCoeff();
  EXPECT_EQ(pull(s.mesh.positions.col(2).minCoeff() - 5).norm(), 0);
  const Positions all = pull(top + 1);
  EXPECT_EQ(all.leftCols(2).norm(), 0);
  EXPECT_LE(all.col(2).maxCoeff(), 0);  // downhill is up
  EXPECT_LT(all.col(2).sum(), 0);
}

TEST(Energy, AGuidePullsAcrossTheViewOnceAVertexIsFarFromHomeAndNoHarderFartherOff) {
  Sample s;
  s.multipliers.setZero();
  for (PatchFace& face : s.patch.faces) face.holdWeight = 0;
  const auto pull = [&](double share) {
    s.guideBeside(share);
    return s.gradient(only(Term::Guide, 2));
  };
  EXPECT_EQ(pull(0.019).norm(), 0);
  const Positions most = pull(0.05);
  EXPECT_NEAR((pull(0.2) - most).norm(), 0, 1e-12 * most.norm());
  EXPECT_NEAR((pull(0.035) - 0.5 * most).norm(), 0, 1e-12 * most.norm());
  const Eigen::VectorXd along = most * s.patch.guide.axis;
  EXPECT_LT(along.norm(), 1e-12 * most.norm());
  EXPECT_EQ(most.row(1).norm(), 0);  // has no place in the map
  // Strength, area of the vertex, slope and radius; downhill is towards the place.
  EXPECT_NEAR(most(2, 0), -2 * 1.2 * 0.03 / 40 * 0.8, 1e-12);
  s.patch.guide.places.rowwise() += 7 * s.patch.guide.axis.transpose();
  EXPECT_NEAR((s.gradient(only(Term::Guide, 2)) - 0.5 * most).norm(), 0, 1e-12 * most.norm());
}

TEST(Energy, ACollarThatStandsUprightIsNotTurned) {
  Sample s;
  s.multipliers.setZero();
  for (PatchFace& face : s.patch.faces) face.holdWeight = 0;
  const double size = s.gradient(only(Term::Overhang, 1)).norm();
  EXPECT_GT(size, 0);
  s.patch.room.axis = Vector::UnitZ();  // all faces of this sample look up
  EXPECT_EQ(s.gradient(only(Term::Overhang, 1)).norm(), 0);
}

TEST(Energy, ACollarOverTheRegionCostsTheAreaThatItHides) {
  Sample s;
  s.multipliers.setZero();
  for (PatchFace& face : s.patch.faces) face.overWeight = face.holdWeight = 0;
  EXPECT_EQ(s.value(s.mesh.positions, only(Term::Overhang, 2)), 0) << "what stands beside it";
  PatchFace& face = s.patch.faces.back();
  face.overWeight = 3;
  s.patch.room.axis = -shapeOf(face, s.mesh.positions).normal;  // its underside is seen
  const double all = s.value(s.mesh.positions, only(Term::Overhang, 2));
  EXPECT_NEAR(all, 2 * 3, 1e-9) << "strength and area";
}

TEST(Energy, ALengthCostsItsSquareAtFirstAndInProportionFarOff) {
  Positions x = Positions::Zero(2, 3);
  x(1, 0) = 1;
  const auto costOf = [&](double strain) {
    const std::vector<PatchSpring> springs = {{{0, 1}, 1 / (1 + strain), 1}};
    return springValue(springs, 0.1, x, 1);
  };
  EXPECT_NEAR(costOf(1e-3), 1e-6, 1e-10);
  EXPECT_NEAR(costOf(-1e-3), 1e-6, 1e-10);
  EXPECT_EQ(springValue(std::vector<PatchSpring>{{{0, 1}, 0.5, 1}}, kInfinity, x, 1), 1);
  // Its asymptote is 2 d |s| - 2 d^2, d = 0.1, reached from above by d^3 / |s|.
  for (const double strain : {2.0, 4.0}) {
    const double asymptote = 0.2 * strain - 0.02;
    EXPECT_GT(costOf(strain), asymptote);
    EXPECT_LT(costOf(strain), asymptote + 1.01e-3 / strain);
  }
}

TEST(Energy, VisibilityTermIsAreaTimesOneLessTheAverageVisibility) {
  // The two agree where areas are at rest, up to the centroid rule for the flux.
  Sample s;
  s.mesh = makeMeander(20, 6);
  s.view = visibility::viewpoint(Point(5, 3, 1000));
  s.patch = {};
  s.contacts.clear();
  s.knot.reset();
  std::vector<std::int32_t> all;
  const Eigen::VectorXd areas = geometry::faceAreas(s.mesh);
  for (std::int32_t f = 0; f < s.mesh.faceCount(); ++f) {
    s.patch.faces.push_back({{s.mesh.faces(f, 0), s.mesh.faces(f, 1), s.mesh.faces(f, 2)},
                             areas[f],
                             areas[f],
                             areas[f],
                             0});
    all.push_back(f);
  }
  s.patch.regionFaces = all.size();
  s.multipliers = Eigen::VectorXd::Zero(s.mesh.faceCount());
  const double term = s.value(s.mesh.positions, only(Term::Visibility, 1));
  const double average =
      visibility::AverageVisibility(s.mesh.faces, all, s.view).value(s.mesh.positions);
  EXPECT_NEAR(term, areas.sum() * (1 - average), 1e-6 * areas.sum());
}

TEST(AreaProjection, LeavesNoFirstOrderChangeOfArea) {
  const TriangleMesh mesh = makeMeander(12, 8, 1.2, 1);
  const Eigen::VectorXd areas = geometry::faceAreas(mesh);
  Patch patch;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    patch.faces.push_back(
        {{mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)}, areas[f], areas[f], areas[f], 0});
  }
  patch.regionFaces = patch.faces.size();
  std::vector<std::int32_t> unknown(static_cast<std::size_t>(mesh.vertexCount()));
  std::iota(unknown.begin(), unknown.end(), 0);
  const Positions wanted = randomDirection(mesh.vertexCount(), 4);
  Positions velocity = wanted;
  keepAreas(patch, mesh.positions, unknown, velocity);
  constexpr double h = 1e-6;
  const auto rates = [&](const Positions& v) {
    TriangleMesh moved = mesh;
    moved.positions += h * v;
    return Eigen::VectorXd((geometry::faceAreas(moved) - areas) / h);
  };
  EXPECT_GT(rates(wanted).norm(), 1);
  EXPECT_LT(rates(velocity).norm(), 1e-3);
  EXPECT_GT(velocity.norm(), 0.1 * wanted.norm());
  // A projection: what it took is orthogonal to what it left.
  EXPECT_NEAR((velocity.array() * (wanted - velocity).array()).sum(), 0,
              1e-5 * wanted.squaredNorm());
}

TEST(BlockSystem, SolvesWhatADenseSolverSolves) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  constexpr std::int32_t count = 12;
  const Couplings couplings = {{3, 1}, {5, 0}, {11, 2}, {7, 3}, {10, 9}};
  BlockSystem system;
  system.reset(count, couplings);
  Eigen::MatrixXd dense = 20 * Eigen::MatrixXd::Identity(3 * count, 3 * count);
  system.addDiagonal(20);
  for (const auto& [i, j] : couplings) {
    Eigen::Matrix3d block;
    for (int n = 0; n < 9; ++n) block.data()[n] = uniform(random);
    system.add(i, j, block);
    dense.block<3, 3>(3 * i, 3 * j) += block;
    dense.block<3, 3>(3 * j, 3 * i) += block.transpose();
  }
  const Positions right = randomDirection(count, 9);
  Positions solution;
  ASSERT_TRUE(system.solve(right, solution));
  const Eigen::VectorXd expected =
      dense.ldlt().solve(Eigen::Map<const Eigen::VectorXd>(right.data(), right.size()));
  const Eigen::Map<const Eigen::VectorXd> found(solution.data(), solution.size());
  EXPECT_NEAR((found - expected).norm(), 0, 1e-12);
  system.reset(count, couplings);
  EXPECT_FALSE(system.solve(right, solution));  // all zero: not positive definite
}

}  // namespace
}  // namespace explica::unfolding
