// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Pipeline/Plan.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <unistd.h>

#include <fstream>
#include <functional>
#include <set>

namespace explica::pipeline {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

class PlanOfLabels : public ::testing::Test {
 protected:
  PlanOfLabels()
      : folder_(fs::temp_directory_path() / ("explica-plan-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~PlanOfLabels() override { fs::remove_all(folder_); }

  /// Writes a cube of 24 voxels a side whose labels follow from the distance of its middle, mm, and
  /// from the side of the middle.
  [[nodiscard]] fs::path write(const std::function<Label(double radius, bool left)>& label) const {
    constexpr int kSide = 24;
    Grid grid;
    grid.size = {kSide, kSide, kSide};
    Volume<Label> volume(grid);
    const Point middle = grid.toWorld(Point::Constant((kSide - 1) / 2.0));
    for (int k = 0; k < kSide; ++k) {
      for (int j = 0; j < kSide; ++j) {
        for (int i = 0; i < kSide; ++i) {
          const Vector from = grid.toWorld(Point(i, j, k)) - middle;
          volume(i, j, k) = label(from.norm(), from.x() < 0);
        }
      }
    }
    io::writeVolume(folder_ / "labels.nii", volume);
    return folder_ / "labels.nii";
  }

  [[nodiscard]] Plan plan(const fs::path& input, const PlanOptions& options = {}) const {
    return planRun(input, folder_ / "out", std::nullopt, options);
  }
  [[nodiscard]] static Json valuesOf(const Plan& plan, const std::string& step) {
    for (const PlannedStep& planned : plan.steps) {
      if (planned.name == step) return *planned.values;
    }
    return nullptr;
  }

  fs::path folder_;
};

/// White matter within 5 mm, grey within 8, fluid within 10, by the given labels.
std::function<Label(double, bool)> shells(Label white, Label grey, Label fluid) {
  return [=](double radius, bool) {
    return radius < 5 ? white : radius < 8 ? grey : radius < 10 ? fluid : 0;
  };
}

TEST_F(PlanOfLabels, GreyMatterIsTheClassBetweenTheOthers) {
  const Plan ours = plan(write(shells(3, 2, 1)));
  EXPECT_EQ(valuesOf(ours, "thickness")["inner"], Json({3}));
  EXPECT_EQ(valuesOf(ours, "thickness")["tissue"], Json({2}));
  const Plan theirs = plan(write(shells(2, 1, 3)));
  EXPECT_EQ(valuesOf(theirs, "thickness")["inner"], Json({2}));
  EXPECT_EQ(valuesOf(theirs, "thickness")["tissue"], Json({1}));
  EXPECT_EQ(valuesOf(theirs, "surface")["white"], Json({2}));
  EXPECT_EQ(valuesOf(theirs, "surface")["grey"], Json({1}));
}

TEST_F(PlanOfLabels, ARibbonTellsItsSides) {
  const fs::path ribbon = write([](double radius, bool left) -> Label {
    if (radius < 6) return left ? 2 : 41;
    return radius < 9 ? (left ? 3 : 42) : 0;
  });
  EXPECT_TRUE(labelsHaveSides(ribbon));
  PlanOptions options;
  const Plan both = plan(ribbon, options);
  EXPECT_EQ(both.steps.size(), 16u) << "each step for each side";
  EXPECT_EQ(valuesOf(both, "surface-R")["hemisphere"], "R");
  const Json left = valuesOf(both, "thickness-L");
  EXPECT_EQ(left["inner"], Json({2}));
  EXPECT_EQ(left["tissue"], Json({3}));
  EXPECT_EQ(left["insulated"], Json({41}));
  options.hemisphere = RunHemisphere::Right;
  const Plan whole = plan(ribbon, options);
  EXPECT_EQ(valuesOf(whole, "thickness")["inner"], Json({41}));
  EXPECT_EQ(valuesOf(whole, "thickness")["tissue"], Json({42}));
  EXPECT_EQ(valuesOf(whole, "surface")["hemisphere"], "R");
}

TEST_F(PlanOfLabels, AFreeSurferSubjectsImagePlacesTheBordersOfSurfacesThatAreMade) {
  const fs::path labels = write([](double radius, bool left) -> Label {
    if (radius < 6) return left ? 2 : 41;
    return radius < 9 ? (left ? 3 : 42) : 0;
  });
  const fs::path subject = folder_ / "subject";
  fs::create_directories(subject / "mri");
  fs::create_directories(subject / "surf");
  const auto volume = io::readLabels(labels).volume;
  io::writeVolume(subject / "mri/ribbon.mgz", volume);
  PlanOptions options;
  options.hemisphere = RunHemisphere::Left;
  options.steps = {RunStep::Surface};
  EXPECT_FALSE(valuesOf(plan(subject, options), "surface").contains("image"));
  io::writeVolume(subject / "mri/brain.mgz", volume);
  const std::string image = (subject / "mri/brain.mgz").string();
  EXPECT_EQ(valuesOf(plan(subject, options), "surface")["image"], image);
  for (const char* name : {"lh.white", "lh.pial"}) std::ofstream(subject / "surf" / name) << ' ';
  const Json given = valuesOf(plan(subject, options), "surface");
  EXPECT_TRUE(given.contains("white-surface"));
  EXPECT_FALSE(given.contains("image"));
  options.given = GivenSurfaces::Remake;
  EXPECT_EQ(valuesOf(plan(subject, options), "surface")["image"], image);
}

TEST_F(PlanOfLabels, ThreeClassesHaveNoSides) {
  EXPECT_FALSE(labelsHaveSides(write(shells(3, 2, 1))));
}

TEST_F(PlanOfLabels, FewWholeNumbersAreLabelsOthersAreAnImage) {
  EXPECT_EQ(detectKind(write(shells(3, 2, 1))), InputKind::Labels);
  EXPECT_EQ(detectKind(write([](double radius, bool) { return static_cast<Label>(60 * radius); })),
            InputKind::T1);
}

TEST_F(PlanOfLabels, AHemisphereGoesToTheTemplateAndOtherTissueDoesNot) {
  const auto ribbon = [](double radius, bool left) -> Label {
    return radius < 5 ? (left ? 2 : 41) : radius < 8 ? (left ? 3 : 42) : 0;
  };
  const auto namesOf = [](const Plan& plan) {
    std::set<std::string> names;
    for (const PlannedStep& step : plan.steps) names.insert(step.name);
    return names;
  };
  const Plan person = plan(write(ribbon));
  EXPECT_EQ(namesOf(person).count("parcellate-R"), 1);
  EXPECT_EQ(valuesOf(person, "register-L")["template"], "colin27");
  EXPECT_EQ(valuesOf(person, "resample-L")["space"], "colin27");
  PlanOptions without;
  without.cortexTemplate = "none";
  EXPECT_EQ(namesOf(plan(write(ribbon), without)).count("sphere-L"), 0);
  EXPECT_EQ(namesOf(plan(write(shells(3, 2, 1)))).count("sphere"), 0);
  without.steps = {RunStep::Sphere};
  EXPECT_EQ(namesOf(plan(write(shells(3, 2, 1)), without)), std::set<std::string>{"sphere"});
}

TEST_F(PlanOfLabels, StepsNeedWhatTheyReadAndOthersAreLeftOut) {
  PlanOptions options;
  const Plan whole = plan(write(shells(3, 2, 1)), options);
  ASSERT_EQ(whole.steps.size(), 3u);
  EXPECT_EQ(whole.kind, InputKind::Labels);
  EXPECT_EQ(whole.steps[2].command, "unfold");
  EXPECT_EQ(whole.steps[2].needs, std::vector<std::string>{"surface"});
  options.steps = {RunStep::Thickness, RunStep::Report};
  const Plan part = plan(folder_ / "labels.nii", options);
  ASSERT_EQ(part.steps.size(), 1u);
  EXPECT_EQ(part.steps[0].name, "thickness");
}

TEST(OutermostPoint, IsTheTopOfABumpInTheDirectionAsked) {
  TriangleMesh mesh = geometry::makeIcosphere(4, 50.0);
  const Vector direction = Vector(1, 2, -0.5).normalized();
  // The nearest vertex to the line becomes a bump; one far from the line, farther out, does not
  // count.
  Eigen::Index bump = 0;
  (mesh.positions * direction).maxCoeff(&bump);
  mesh.positions.row(bump) *= 1.2;
  const Point top = mesh.positions.row(bump).transpose();
  EXPECT_LT((outermostPoint(mesh, direction) - top).norm(), 1e-9);
  EXPECT_LT((outermostPoint(mesh, 7 * direction) - top).norm(), 1e-9) << "its length is no matter";
}

TEST(OutermostPoint, MovesWithTheMesh) {
  TriangleMesh mesh = geometry::makeFoldedSphere(4, 50.0);
  const Vector direction(0.3, -1, 0.2);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Vector(1, 1, 0.2).normalized()).toRotationMatrix();
  const Vector shift(10, -20, 5);
  const Point before = outermostPoint(mesh, direction);
  mesh.positions = (mesh.positions * turn.transpose()).rowwise() + shift.transpose();
  EXPECT_LT((outermostPoint(mesh, turn * direction) - (turn * before + shift)).norm(), 1e-9);
}

}  // namespace
}  // namespace explica::pipeline
