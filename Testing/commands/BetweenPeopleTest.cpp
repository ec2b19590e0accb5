// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// explica register, parcellate, template, longitudinal, unfold --region: what users type and what
// they get.

#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Testing/Meshes.h"
#include "Explica/Testing/SmallDisk.h"
#include "QuickRuns.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const fs::path kSharedData = EXPLICA_REAL_DATA;

TriangleMesh sphereIn(const std::string& file) {
  io::SurfaceReadOptions reading;
  reading.space = io::SurfaceSpace::Scanner;
  TriangleMesh mesh = io::readSurface(file, reading).mesh;
  mesh.positions.rowwise().normalize();
  return mesh;
}

/// Degrees between directions.
Eigen::VectorXd anglesBetween(const Positions& a, const Positions& b) {
  return (a - b).rowwise().norm() * 180 / kPi;
}

/// Registers a left hemisphere's sphere onto a target given by the further words.
std::string registered(const TemporaryFolder& folder, const std::string& name,
                       const std::string& sphere, const std::vector<std::string>& target) {
  const auto result =
      explica(std::vector<std::string>{"register", sphere, "--out", folder / name} + target);
  EXPECT_EQ(result.exitCode, 0) << result;
  return folder / (name + "/sphere.reg.surf.gii");
}

TEST(SpherePeople, APersonKeepsAreasAndShapes) {
  const fs::path people = kSharedData / "oasis_sd";
  if (!fs::exists(people)) GTEST_SKIP() << "skipped: no real data";
  TemporaryFolder folder;
  const auto run =
      explica({"sphere", (people / "OAS1_0003/lh.white").string(), "--out", folder / "sphere"});
  ASSERT_EQ(run.exitCode, 0) << run;
  const Json summary = Json::parse(std::ifstream(folder / "sphere/summary.json"));
  EXPECT_EQ(summary["turned_over"], 0);
  EXPECT_LE(summary["areal_log2_mean"], 0.20);
  EXPECT_LE(summary["stretch_median"], 1.5);
  EXPECT_LE(summary["stretch_p95"], 2.6);
}

TEST(RegisterPeople, FsaverageFiveOntoFsaverageIsTheIdentity) {
  const fs::path five = kSharedData / "fsaverage5/fs_binary";
  if (!fs::exists(five)) GTEST_SKIP() << "skipped: no real data";
  TemporaryFolder folder;
  const auto moved = registered(folder, "moved", (five / "lh.sphere").string(),
                                {"--template", (kSharedData / "fsaverage").string()});
  const Eigen::VectorXd angles =
      anglesBetween(sphereIn(moved).positions, sphereIn((five / "lh.sphere").string()).positions);
  // The folds of the coarse mesh are not quite those of the fine one: a fraction of its 2 degrees
  // between neighbours.
  EXPECT_LT(angles.mean(), 0.4);
  EXPECT_LT(angles.maxCoeff(), 2);
}

TEST(RegisterPeople, ThereAndBackAgainIsTheIdentity) {
  const fs::path people = kSharedData / "oasis_sd";
  if (!fs::exists(people)) GTEST_SKIP() << "skipped: no real data";
  TemporaryFolder folder;
  const std::string a = (people / "OAS1_0001/lh.sphere").string(),
                    b = (people / "OAS1_0003/lh.sphere").string();
  const TriangleMesh aOnB = sphereIn(registered(folder, "ab", a, {"--to", b, "--level", "5"}));
  const auto bOnA = registered(folder, "ba", b, {"--to", a, "--level", "5"});
  // Places of A taken to B, and there to where B's vertices come to on A.
  io::writeSurface(folder / "ab.surf.gii", aOnB);
  io::writeSurface(folder / "b.surf.gii", sphereIn(b));
  io::writeSurface(folder / "bOnA.surf.gii", sphereIn(bOnA));
  const auto carried =
      explica({"resample", folder / "bOnA.surf.gii", "--from", folder / "b.surf.gii", "--to",
               folder / "ab.surf.gii", "--space", "back", "--out", folder / "back"});
  ASSERT_EQ(carried.exitCode, 0) << carried;
  std::string file;
  for (const auto& entry : fs::directory_iterator(folder / "back")) {
    if (entry.path().string().ends_with(".surf.gii")) file = entry.path().string();
  }
  const Eigen::VectorXd angles = anglesBetween(sphereIn(file).positions, sphereIn(a).positions);
  EXPECT_LT(angles.mean(), 1);
}

TEST(RegisterPeople, TakesAnothersMapsByNameAndMixesUpNone) {
  TemporaryFolder folder;
  ASSERT_EQ(
      explica({"phantom", "cortex", "--size", "32", "--spacing", "2", "--out", folder / "cortex"})
          .exitCode,
      0);
  for (const std::string faces : {"2000", "2400"}) {
    const std::string made = folder / ("surfaces" + faces);
    ASSERT_EQ(explica({"surface", folder / "cortex/labels.nii.gz", "--white-label", "3",
                       "--grey-label", "2", "--faces", faces, "--out", made})
                  .exitCode,
              0);
    ASSERT_EQ(explica({"sphere", made + "/white.surf.gii", "--out", folder / ("sphere" + faces)})
                  .exitCode,
              0);
  }
  const auto onto = [&](const std::string& sulc, const std::string& toSulc) {
    return explica({"register", folder / "sphere2000/sphere.surf.gii", "--sulc",
                    folder / ("surfaces" + sulc + "/sulc.shape.gii"), "--curvature",
                    folder / "surfaces2000/curvature.shape.gii", "--to",
                    folder / "sphere2400/sphere.surf.gii", "--to-sulc",
                    folder / ("surfaces" + toSulc + "/sulc.shape.gii"), "--to-curvature",
                    folder / "surfaces2400/curvature.shape.gii", "--level", "3", "--out",
                    folder / "out", "--force"});
  };
  const auto right = onto("2000", "2400");
  EXPECT_EQ(right.exitCode, 0) << right;
  for (const auto& wrong : {onto("2400", "2400"), onto("2000", "2000")}) {
    EXPECT_EQ(wrong.exitCode, 2) << wrong;
    EXPECT_NE(wrong.err.find("was not made for the mesh of"), std::string::npos) << wrong;
  }
}

TEST(RegisterPeople, LeftGoesOntoAnothersRightMirrored) {
  TemporaryFolder folder;
  writePerson(folder);
  for (const char* map : {"sphere", "sulc", "curv"}) {
    fs::copy_file(folder / (std::string("lh.") + map), folder / (std::string("rh.") + map));
  }
  const auto onto = [&](const std::string& side) {
    return explica({"register", folder / "lh.sphere", "--to", folder / (side + ".sphere"),
                    "--mirror", "--level", "3", "--out", folder / side});
  };
  const auto right = onto("rh");
  EXPECT_EQ(right.exitCode, 0) << right;
  const auto left = onto("lh");
  EXPECT_EQ(left.exitCode, 2) << left;
  EXPECT_NE(left.err.find("leave --mirror out"), std::string::npos) << left;
}

TEST(Parcellate, LabelsTheVoxelsBetweenTheSurfaces) {
  TemporaryFolder folder;
  writeMapAndRegions(folder);
  const auto result =
      explica({"parcellate", folder.path().string(), "--atlas", folder / "lh.regions.label.gii",
               "--volume", "--out", folder / "out"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const auto volume = io::readLabels(folder / "out/aparc.nii.gz").volume;
  std::array<double, 3> voxels{};
  for (const Label label : volume.data) voxels.at(static_cast<std::size_t>(label)) += 1;
  // Zones of height 7 and 11 between spheres of 10 and 14 mm: y beyond 3 of 10 at the inner one.
  const double zone = 0.35 * 4 * kPi / 3 * (14 * 14 * 14 - 10 * 10 * 10);
  EXPECT_NEAR(voxels[1], zone, 0.06 * zone);
  EXPECT_NEAR(voxels[2], zone, 0.06 * zone);
  EXPECT_EQ(readText(folder / "out/aparc.tsv"), "index\tname\n1\tfront\n2\tback\n");
  const auto bare =
      explica({"parcellate", folder.path().string(), "--atlas", folder / "lh.regions.label.gii",
               "--volume", "--like", folder / "map.nii.gz", "--out", folder / "like"});
  ASSERT_EQ(bare.exitCode, 0) << bare;
  EXPECT_EQ(io::readLabels(folder / "like/aparc.nii.gz").volume.grid.size,
            (std::array<int, 3>{24, 24, 24}));
}

TEST(Parcellate, FindsTheSphereThatRegisterWroteBesideTheSurfaces) {
  TemporaryFolder folder;
  writeMapAndRegions(folder);
  const fs::path person = folder / "person";
  fs::create_directories(person / "surface-L");
  fs::create_directories(person / "register-L");
  for (const char* name : {"white.surf.gii", "pial.surf.gii"})
    fs::copy_file(folder / name, person / "surface-L" / name);
  fs::copy_file(folder / "sphere.reg.surf.gii", person / "register-L/sphere.reg.surf.gii");
  const auto result =
      explica({"parcellate", folder / "person/surface-L/", "--atlas",
               folder / "lh.regions.label.gii", "--volume", "--out", folder / "out"});
  ASSERT_EQ(result.exitCode, 0) << result;
  EXPECT_EQ(io::readVertexLabels(folder / "out/regions.label.gii").keys,
            io::readVertexLabels(folder / "lh.regions.label.gii").keys);
  const auto right = explica({"parcellate", folder / "person/surface-R", "--atlas",
                              folder / "lh.regions.label.gii", "--out", folder / "no"});
  EXPECT_NE(right.exitCode, 0) << right;
}

TEST(Parcellate, SaysThatAVolumeNeedsSurfaces) {
  TemporaryFolder folder;
  writeMapAndRegions(folder);
  fs::remove(folder / "pial.surf.gii");
  const auto result =
      explica({"parcellate", folder.path().string(), "--atlas", folder / "lh.regions.label.gii",
               "--volume", "--out", folder / "out"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_NE(result.err.find("no lh.pial or pial.surf.gii"), std::string::npos) << result;
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(UnfoldRegion, IsTakenByItsName) {
  TemporaryFolder folder;
  writeMapAndRegions(folder);
  const std::vector<std::string> words = {"unfold",           folder / "white.surf.gii",
                                          "--label",          folder / "lh.regions.label.gii",
                                          "--direction",      "0,1,0",
                                          "--max-iterations", "1"};
  auto result =
      explica(words + std::vector<std::string>{"--label-key", "front", "--out", folder / "out"});
  EXPECT_TRUE(result.exitCode == 0 || result.exitCode == 3) << result;
  const auto region = io::readVertexLabels(folder / "out/region.label.gii").keys;
  const Positions places = geometry::makeIcosphere(3, 10.0).positions;
  for (Eigen::Index v = 0; v < region.size(); ++v) EXPECT_EQ(region[v] == 1, places(v, 1) > 3) << v;
  result =
      explica(words + std::vector<std::string>{"--label-key", "insula", "--out", folder / "no"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_NE(result.err.find("has no region 'insula'; its regions are front, back"),
            std::string::npos)
      << result;
}

TEST(Template, OfOnePersonTwiceIsThePerson) {
  TemporaryFolder folder;
  writePerson(folder);
  const auto result = explica({"template", folder.path().string(), folder.path().string(),
                               "--density", "fsaverage3", "--level", "3", "--out", folder / "out"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_EQ(summary["people"], 2);
  EXPECT_LT(summary["mean_deformation"], 0.1);
  const TriangleMesh white = io::readSurface(folder / "out/hemi-L_white.surf.gii").mesh;
  EXPECT_NEAR(geometry::totalArea(white), geometry::totalArea(geometry::makeFoldedSphere(3, 30.0)),
              300);  // faces over the chords of bends
  // And it is a template.
  const auto found = explica({"register", folder / "lh.sphere", "--template", folder / "out",
                              "--level", "3", "--out", folder / "on"});
  ASSERT_EQ(found.exitCode, 0) << found;
  EXPECT_GT(readJson(folder / "on/summary.json")["folding_correlation_after"], 0.99);
}

TEST(Template, MendsFacesThatASphereHasTurnedOver) {
  TemporaryFolder folder;
  writePerson(folder);
  TriangleMesh sphere = io::readSurface(folder / "lh.sphere").mesh;
  const auto face = sphere.faces.row(40);
  const Eigen::RowVector3d across =  // beyond the opposite edge
      sphere.positions.row(face[1]) + sphere.positions.row(face[2]) - sphere.positions.row(face[0]);
  sphere.positions.row(face[0]) = sphere.positions.row(face[0]).norm() * across.normalized();
  io::writeSurface(folder / "sphere.surf.gii", sphere);
  const auto result = explica({"template", folder.path().string(), folder.path().string(),
                               "--density", "fsaverage3", "--level", "3", "--out", folder / "out"});
  ASSERT_EQ(result.exitCode, 0) << result;
  EXPECT_NE(result.err.find("are turned over; "), std::string::npos) << result;
  EXPECT_LT(readJson(folder / "out/summary.json")["mean_deformation"], 0.1);
}

TEST(Template, OfOnePersonIsRefused) {
  TemporaryFolder folder;
  writePerson(folder);
  const auto result = explica({"template", folder.path().string(), "--out", folder / "out"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_NE(result.err.find("fewer than two people"), std::string::npos) << result;
}

/// Two sessions of the phantom cortex as the scanner may have them: the second turned and shifted,
/// with noise of its own; and regions of it, four a side.
class Longitudinal : public ::testing::Test {
 protected:
  /// @param thinned  mm less in the second session
  Json changeOf(const std::string& thinned) {
    write("first", "2.5", "1", Eigen::Isometry3d::Identity());
    Eigen::Isometry3d turned = Eigen::Isometry3d::Identity();
    turned.linear() =
        Eigen::AngleAxisd(8 * kPi / 180, Vector(1, -0.5, 0.3).normalized()).toRotationMatrix();
    turned.translation() = Vector(3.3, -2.6, 1.4);
    write("second", thinned, "2", turned);
    writeRegions();
    CommandSetting patient;
    patient.timeout = 1800;
    const auto result =
        explica({"longitudinal", folder_ / "first.nii.gz", folder_ / "second.nii.gz", "--atlas",
                 folder_ / "atlas.nii.gz", "--hemisphere", "L", "--template", "none",
                 "--surface.faces", "8000", "--out", folder_ / "out"},
                patient);
    // The phantom's brain is smaller than a person's: doubtful.
    EXPECT_EQ(result.exitCode, 3) << result;
    return readJson(folder_ / "out/summary.json");
  }

  /// Mean change of each region of the left side, mm.
  [[nodiscard]] std::vector<double> changes() const {
    std::istringstream table(readText(folder_ / "out/regions/regions.tsv"));
    std::vector<double> values;
    for (std::string line; std::getline(table, line);) {
      const std::size_t at = line.find("change_session-2_mean\t");
      if (at != line.npos) values.push_back(std::stod(line.substr(at + 22)));
    }
    return values;
  }

  void write(const std::string& name, const std::string& thickness, const std::string& seed,
             const Eigen::Isometry3d& motion) {
    ASSERT_EQ(explica({"phantom", "cortex", "--size", "64", "--thickness", thickness, "--seed",
                       seed, "--out", folder_ / name})
                  .exitCode,
              0);
    Volume<float> image = io::readScalars(folder_ / (name + "/t1.nii.gz")).volume;
    image.grid.direction = motion.linear() * image.grid.direction;
    image.grid.origin = motion * image.grid.origin;
    io::writeVolume(folder_ / (name + ".nii.gz"), image);
  }

  void writeRegions() {
    const Volume<Label> labels = io::readLabels(folder_ / "first/labels.nii.gz").volume;
    Volume<Label> atlas(labels.grid, 0);
    for (std::size_t v = 0; v < labels.size(); ++v) {
      const auto [i, j, k] = labels.grid.subscripts(v);
      const Point at = labels.grid.toWorld(Vector(i, j, k));
      if (labels[v] != 0) atlas[v] = 1 + (at.x() > 0) + 2 * (at.y() > 0) + 4 * (at.z() > 0);
    }
    io::writeVolume(folder_ / "atlas.nii.gz", atlas);
    std::ofstream(folder_ / "atlas.nii.txt")
        << "1 Occipital_Inf_L\n2 Occipital_Inf_R\n3 Frontal_Inf_L\n4 Frontal_Inf_R\n"
           "5 Occipital_Sup_L\n6 Occipital_Sup_R\n7 Frontal_Sup_L\n8 Frontal_Sup_R\n";
  }

  TemporaryFolder folder_;
};

TEST_F(Longitudinal, FindsTheThinningOfAPhantom) {
  const Json summary = changeOf("2.3");
  EXPECT_NEAR(summary["thickness_change_mean"].get<double>(), -0.2, 0.02);
  EXPECT_GT(summary["thickness_change_known"].get<double>(), 0.6);
  ASSERT_EQ(changes().size(), 4U);
  for (const double change : changes()) EXPECT_NEAR(change, -0.2, 0.08);
}

TEST_F(Longitudinal, FindsNoChangeWhereThereIsNone) {
  const Json summary = changeOf("2.5");
  EXPECT_NEAR(summary["thickness_change_mean"].get<double>(), 0, 0.02);
  EXPECT_GT(summary["session_correlation"].get<double>(), 0.95);
  ASSERT_EQ(changes().size(), 4U);
  double squares = 0;
  for (const double change : changes()) squares += change * change / 4;
  EXPECT_LT(std::sqrt(squares), 0.04);
}

TEST_F(Longitudinal, SessionsOfDifferentVoxelsAreToBeLookedAt) {
  write("first", "2.5", "1", Eigen::Isometry3d::Identity());
  const Volume<float> fine = io::readScalars(folder_ / "first.nii.gz").volume;
  Grid thick = fine.grid;
  thick.size[2] /= 2;
  thick.spacing[2] *= 2;
  thick.origin = fine.grid.toWorld(Vector(0, 0, 0.5));
  Volume<float> slices(thick);
  for (std::size_t v = 0; v < slices.size(); ++v) {
    const auto [i, j, k] = slices.grid.subscripts(v);
    slices[v] = (fine(i, j, 2 * k) + fine(i, j, 2 * k + 1)) / 2;
  }
  io::writeVolume(folder_ / "second.nii.gz", slices);
  writeRegions();
  const auto result =
      explica({"longitudinal", folder_ / "first.nii.gz", folder_ / "second.nii.gz", "--atlas",
               folder_ / "atlas.nii.gz", "--hemisphere", "L", "--template", "none",
               "--surface.faces", "3000", "--out", folder_ / "out"});
  EXPECT_EQ(result.exitCode, 3) << result;
  const Json summary = readJson(folder_ / "out/summary.json");
  EXPECT_EQ(summary["session_voxels"], 2);
  EXPECT_NE(summary["reasons"].dump().find("Voxel sizes of the sessions"), std::string::npos);
  // Its page has the doubts of the runs within it.
  ASSERT_EQ(explica({"report", folder_ / "out", "--out", folder_ / "page"}).exitCode, 0);
  const std::string page = readText(folder_ / "page/report.html");
  EXPECT_NE(page.find("skull or neck may be left in the brain"), std::string::npos);
  EXPECT_EQ(page.find("stopped: finished"), std::string::npos);
}

TEST_F(Longitudinal, OfOneSessionIsRefused) {
  write("first", "2.5", "1", Eigen::Isometry3d::Identity());
  const auto result = explica({"longitudinal", folder_ / "first.nii.gz", "--out", folder_ / "out"});
  EXPECT_EQ(result.exitCode, 1) << result;
  EXPECT_NE(result.err.find("is one session"), std::string::npos) << result;
}

TEST_F(Longitudinal, LeavesNothingWhenAStepFails) {
  write("first", "2.5", "1", Eigen::Isometry3d::Identity());
  const auto result =
      explica({"longitudinal", folder_ / "first.nii.gz", folder_ / "first.nii.gz", "--atlas",
               folder_ / "first/labels.nii.gz", "--hemisphere", "L", "--out", folder_ / "out"});
  EXPECT_EQ(result.exitCode, 2) << result;
  EXPECT_NE(result.err.find("no legend"), std::string::npos) << result;
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(Longitudinal, LeavesNothingOnADiskThatFillsUpWithSessions) {
  const SmallDisk disk(folder_ / "disk", "100k");
  if (!disk.mounted()) GTEST_SKIP() << "skipped: this user may not mount a small file system";
  ASSERT_EQ(explica({"phantom", "cortex", "--size", "32", "--spacing", "2", "--out", folder_ / "p"})
                .exitCode,
            0);
  const std::string image = folder_ / "p/t1.nii.gz";
  const auto result = explica({"longitudinal", image, image, "--template", "none", "--atlas",
                               folder_ / "p/labels.nii.gz", "--out", folder_ / "disk/out"});
  EXPECT_EQ(result.exitCode, 4) << result;
  EXPECT_TRUE(fs::is_empty(folder_ / "disk")) << result;
}

struct Refusal {
  std::string name;
  std::vector<std::string> words;
  std::string says;
};

class BetweenPeopleRefuses : public ::testing::TestWithParam<Refusal> {};

TEST_P(BetweenPeopleRefuses, InOneSentence) {
  TemporaryFolder folder;
  writePerson(folder);
  writeFoldedCap(folder);
  io::writeSurface(folder / "torus.surf.gii", geometry::makeTorus(24, 12, 20.0, 6.0));
  io::writeSurface(folder / "pieces.surf.gii",
                   geometry::joined(geometry::makeIcosphere(2, 10.0),
                                    geometry::makeIcosphere(2, 10.0, Point(30, 0, 0))));
  for (const char* made : {"empty", "bare"}) fs::create_directory(folder / made);
  fs::copy_file(folder / "lh.sphere", folder / "bare/lh.sphere.reg");
  for (const char* map : {"sphere", "sulc", "curv"}) {
    fs::copy_file(folder / (std::string("lh.") + map), folder / (std::string("rh.") + map));
  }
  io::writeFreeSurferCurv(folder / "lh.short", Eigen::VectorXd::Ones(42), 80);
  std::vector<std::string> words = filled(GetParam().words, folder);
  const auto result = explica(words + std::vector<std::string>{"--out", folder / "out"});
  EXPECT_EQ(result.exitCode, 2) << result;
  EXPECT_NE(result.err.find(GetParam().says), std::string::npos) << result;
  EXPECT_FALSE(fs::exists(folder / "out"));
}

INSTANTIATE_TEST_SUITE_P(
    Inputs, BetweenPeopleRefuses,
    ::testing::Values(Refusal{"OpenSurface", {"sphere", "{folder}/cap.surf.gii"}, "boundary"},
                      Refusal{"Torus", {"sphere", "{folder}/torus.surf.gii"}, "1 handles (genus)"},
                      Refusal{"TwoPieces", {"sphere", "{folder}/pieces.surf.gii"}, "2 pieces"},
                      Refusal{"NoTemplate",
                              {"register", "{folder}/lh.sphere", "--template", "{folder}/empty"},
                              "no lh.sphere.reg in it"},
                      Refusal{"TemplateWithoutSulc",
                              {"register", "{folder}/lh.sphere", "--template", "{folder}/bare"},
                              "no lh.sulc in it"},
                      Refusal{"OtherHemisphere",
                              {"register", "{folder}/lh.sphere", "--to", "{folder}/rh.sphere"},
                              "hemisphere"},
                      Refusal{"SulcOfAnotherMesh",
                              {"register", "{folder}/lh.sphere", "--sulc", "{folder}/lh.short",
                               "--to", "{folder}/lh.sphere"},
                              "42"},
                      Refusal{"NoSphere",
                              {"register", "{folder}/cap.surf.gii", "--surfaces", "{folder}",
                               "--to", "{folder}/lh.sphere"},
                              "cap.surf.gii"}),
    [](const auto& row) { return row.param.name; });

}  // namespace
}  // namespace explica::testing
