// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// explica flatten and explica compare on surfaces of real heads.

#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/Geodesic.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/IO/PatchFile.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Testing/Command.h"
#include "Explica/Testing/FreeSurferLabel.h"
#include "Explica/Testing/Stops.h"
#include "RealSurfaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <sstream>

namespace explica::testing {
namespace {

class FlattenCommand : public RealSurfaces {
 protected:
  /// The surface half way between white and pial, written into a folder.
  static std::string middle(const TemporaryFolder& folder, const std::string& side) {
    const auto surface = [&](const std::string& name) {
      return io::readSurface(data() / "fsaverage5" / (name + "_" + side + ".gii.gz"));
    };
    io::LoadedSurface white = surface("white");
    white.mesh.positions = ((white.mesh.positions + surface("pial").mesh.positions) / 2).eval();
    io::writeGiftiSurface(folder / "mid.surf.gii", white.mesh, white.metadata);
    return folder / "mid.surf.gii";
  }

  static std::string shipped(const std::string& side) {
    return (data() / "fsaverage5" / ("flat_" + side + ".gii.gz")).string();
  }

  /// Rows of comparison.tsv by surface, columns by name.
  static std::map<std::string, std::map<std::string, double>> table(const std::string& file) {
    std::map<std::string, std::map<std::string, double>> rows;
    std::istringstream lines(readText(file));
    std::string line, word;
    std::vector<std::string> header;
    while (std::getline(lines, line)) {
      std::istringstream words(line);
      std::vector<std::string> row;
      while (std::getline(words, word, '\t')) row.push_back(word);
      if (header.empty()) {
        header = row;
        continue;
      }
      for (std::size_t n = 1; n < row.size(); ++n) rows[row[0]][header[n]] = std::stod(row[n]);
    }
    return rows;
  }
};

/// The grid's place (RAS mm) at u, v (mm) and depth (0 to 1), trilinear; none where a cell is
/// empty.
std::optional<Point> interpolated(const Volume<Eigen::Vector3f>& grid, const Eigen::Vector3f& uvd) {
  const auto& size = grid.grid.size;
  const Vector index((uvd[0] - grid.grid.origin[0]) / grid.grid.spacing[0],
                     (uvd[1] - grid.grid.origin[1]) / grid.grid.spacing[1], uvd[2] * (size[2] - 1));
  Point sum = Point::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    std::array<int, 3> at{};
    for (int axis = 0; axis < 3; ++axis) {
      const int low = std::clamp(static_cast<int>(std::floor(index[axis])), 0, size[axis] - 2);
      const int upper = corner >> axis & 1;
      weight *= upper == 1 ? index[axis] - low : 1 - (index[axis] - low);
      at[axis] = low + upper;
    }
    const Eigen::Vector3f& place = grid(at[0], at[1], at[2]);
    if (!place.allFinite()) return {};
    sum += weight * place.cast<double>();
  }
  return sum;
}

class WholeHemisphere : public FlattenCommand {};

TEST_F(WholeHemisphere, WithTheShippedCutsKeepsDistancesBetterThanTheShippedMap) {
  TemporaryFolder folder;
  const std::string side = "right", mid = middle(folder, side);
  const auto made = explica({"flatten", mid, "--cuts", shipped(side), "--out", folder / "flat"});
  ASSERT_EQ(made.exitCode, 0) << made;
  const auto summary = readJson(folder / "flat/summary.json");
  EXPECT_EQ(summary["turned_over"], 0);
  EXPECT_EQ(summary["rim_crossings"], 0);
  EXPECT_LT(summary["area_error_mean"], 0.05);
  const auto compared = explica(
      {"compare", mid, shipped(side), folder / "flat/flat.surf.gii", "--out", folder / "compared"});
  ASSERT_EQ(compared.exitCode, 0) << compared;
  auto rows = table(folder / "compared/comparison.tsv");
  auto &ours = rows["flat.surf.gii"], &theirs = rows["flat_" + side + ".gii.gz"];
  EXPECT_LT(ours["geodesic_error_local"], theirs["geodesic_error_local"]);
  EXPECT_LT(ours["geodesic_error_all"], theirs["geodesic_error_all"]);
  EXPECT_LT(ours["area_error_mean"], theirs["area_error_mean"]);
  EXPECT_EQ(ours["crossings"], 0);
}

TEST_F(WholeHemisphere, CutByItselfKeepsDistancesAsWellAsWithCutsMadeByHand) {
  TemporaryFolder folder;
  const std::string side = "left", mid = middle(folder, side);
  const auto byHand = explica({"flatten", mid, "--cuts", shipped(side), "--out", folder / "hand"});
  ASSERT_EQ(byHand.exitCode, 0) << byHand;
  const auto made = explica({"flatten", mid, "--cuts", "auto", "--cortex",
                             (data() / "fsaverage5" / ("thick_" + side + ".gii.gz")).string(),
                             "--out", folder / "auto"});
  ASSERT_EQ(made.exitCode, 0) << made;
  const auto hand = readJson(folder / "hand/summary.json"),
             ours = readJson(folder / "auto/summary.json");
  EXPECT_LE(ours["geodesic_error_local"], 1.1 * double(hand["geodesic_error_local"]));
  EXPECT_LE(ours["geodesic_error_all"], 1.1 * double(hand["geodesic_error_all"]));
  EXPECT_LE(ours["area_error_mean"], 0.05);
  EXPECT_EQ(ours["turned_over"], 0);
  EXPECT_EQ(ours["rim_crossings"], 0);
  EXPECT_GT(ours["faces"], hand["faces"]);  // no face is lost along cuts
  EXPECT_LE(ours["cuts"], 6);
  EXPECT_LT(ours["cut_length"], 450);
  EXPECT_GT(ours["cut_depth"], 0.5);  // standard deviations: in sulci
  EXPECT_NEAR(ours["cut_strain"], ours["edge_strain_mean"], 0.01);
  const auto patch = io::readSurface(folder / "auto/patch.surf.gii").mesh;
  const auto condition = geometry::inspectMesh(patch);
  EXPECT_EQ(condition.eulerCharacteristic, 1);  // a disc
  EXPECT_TRUE(condition.manifold());
  EXPECT_EQ(condition.vertices, std::int64_t(ours["vertices"]));
  EXPECT_TRUE(
      geometry::findSelfIntersections(io::readSurface(folder / "auto/patch_flat.surf.gii").mesh)
          .empty());

  // The patch, which leaves the vertices on cuts out, and the same vertices as a label.
  const std::string name = "lh.patch.3d";
  const auto again =
      explica({"flatten", mid, "--cuts", folder / ("auto/" + name), "--out", folder / "again"});
  ASSERT_EQ(again.exitCode, 0) << again;
  EXPECT_LE(readJson(folder / "again/summary.json")["geodesic_error_all"],
            1.1 * double(hand["geodesic_error_all"]));
  io::LabelMap stays;
  stays.keys.setZero(10242);
  stays.table = {{0, "out", {}}, {1, "in", {}}};
  for (const auto v : io::readPatch(folder / ("auto/" + name)).vertices) stays.keys[v] = 1;
  io::writeGiftiLabel(folder / "stays.label.gii", stays, "CortexLeft");
  const auto labelled =
      explica({"flatten", mid, "--cuts", folder / "stays.label.gii", "--out", folder / "label"});
  ASSERT_EQ(labelled.exitCode, 0) << labelled;
  EXPECT_EQ(readText(folder / "again/flat.surf.gii"), readText(folder / "label/flat.surf.gii"));
}

io::SurfaceMetadata leftHemisphere() {
  io::SurfaceMetadata metadata;
  metadata.structure = "CortexLeft";
  return metadata;
}

/// A folder with a sphere of 642 vertices, a wall about its south pole and a cut up a meridian.
void writeTemplate(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const TriangleMesh sphere = geometry::makeIcosphere(3, 100);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(sphere.vertexCount());
  io::writeGiftiSurface(folder / "sphere.surf.gii", sphere, leftHemisphere());
  io::writeGiftiShape(folder / "sulc.shape.gii", {{"sulc", "", zero}}, "CortexLeft");
  io::writeGiftiShape(folder / "curvature.shape.gii", {{"curv", "", zero}}, "CortexLeft");
  io::LabelMap cuts{"cuts", {}, {{0, "cortex", {}}, {1, "wall", {}}, {2, "meridian", {}}}};
  cuts.keys.setZero(sphere.vertexCount());
  for (Eigen::Index v = 0; v < cuts.keys.size(); ++v) {
    const Point p = sphere.positions.row(v);
    if (std::abs(p.y()) < 12 && p.x() > 10) cuts.keys[v] = 2;
    if (p.z() < -80) cuts.keys[v] = 1;
  }
  io::writeGiftiLabel(folder / "cuts.label.gii", cuts, "CortexLeft");
}

TEST(FlattenTemplate, LaysTheCutsOfATemplateOnASurface) {
  TemporaryFolder folder;
  writeTemplate(folder / "template");
  TriangleMesh mesh = geometry::makeIcosphere(4, 30);
  const io::SurfaceMetadata left = leftHemisphere();
  io::writeGiftiSurface(folder / "sphere.reg.surf.gii", mesh, left);
  mesh.positions.col(0) *= 1.2;
  io::writeGiftiSurface(folder / "white.surf.gii", mesh, left);
  const std::vector<std::string> words = {"flatten",    folder / "white.surf.gii",
                                          "--cuts",     "template",
                                          "--template", folder / "template"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), words.begin(), words.end());
    return explica(more);
  };
  const auto made = with({"--out", folder / "flat"});
  ASSERT_EQ(made.exitCode, 0) << made;
  EXPECT_EQ(readJson(folder / "flat/summary.json")["cuts"], 1);
  EXPECT_NE(readText(folder / "flat/cuts.tsv").find("1\tmeridian\t"), std::string::npos);
  const auto labels = io::readVertexLabels(folder / "flat/cuts.label.gii", mesh.vertexCount());
  std::size_t along = 0;
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    EXPECT_EQ(labels.keys[v] == 1 || mesh.positions(v, 2) > -26.5, true);
    if (labels.keys[v] != 2) continue;
    ++along;
    EXPECT_LT(std::abs(mesh.positions(v, 1)), 0.2 * 30);  // the line, and an edge
    EXPECT_GT(mesh.positions(v, 0), 0);
  }
  EXPECT_GT(along, 20U);
  const auto other = with({"--cut-name", "calcarine", "--out", folder / "other"});
  EXPECT_EQ(other.exitCode, 2) << other;
  EXPECT_NE(other.err.find("it has meridian"), std::string::npos) << other;
  std::filesystem::remove(folder / "sphere.reg.surf.gii");
  const auto alone = with({"--out", folder / "alone"});
  EXPECT_EQ(alone.exitCode, 2) << alone;
  EXPECT_NE(alone.err.find("--sphere"), std::string::npos) << alone;
}

TEST_F(FlattenCommand, AnUnfoldedPatchIsMeasuredAgainstTheSurfaceThatItsRecordNames) {
  TemporaryFolder folder;
  const std::string mid = middle(folder, "left");
  auto words = unfoldAbout(mid, Vector(-1, 0.2, 0.2), 25, "elastic");
  words.insert(words.end(), {"--max-iterations", "2", "--out", folder / "unfolded"});
  const auto unfolded = explica(words);
  ASSERT_TRUE(unfolded.exitCode == 0 || unfolded.exitCode == 3) << unfolded;
  for (const std::string name : {"white", "pial"}) {
    const auto surface = io::readSurface(data() / "fsaverage5" / (name + "_left.gii.gz"));
    io::writeGiftiSurface(folder / (name + ".surf.gii"), surface.mesh, surface.metadata);
  }
  const auto made = explica({"flatten", folder / "unfolded/unfolded.surf.gii", "--surfaces",
                             folder.path().string(), "--grid", "1", "--out", folder / "flat"});
  ASSERT_EQ(made.exitCode, 0) << made;
  const auto summary = readJson(folder / "flat/summary.json");
  EXPECT_EQ(summary["faces"], readJson(folder / "unfolded/summary.json")["region_faces"]);
  EXPECT_LE(summary["area_error_mean"], 0.0101);
  EXPECT_LT(summary["geodesic_error_local"], 0.052);

  const auto flat = io::readSurface(folder / "flat/flat.surf.gii");
  EXPECT_EQ(flat.metadata.geometricType, "Flat");
  const auto opened = io::readSurface(folder / "unfolded/unfolded.surf.gii").metadata;
  EXPECT_EQ(opened.geometricType, "Inflated");
  EXPECT_EQ(opened.secondary, "");
  EXPECT_EQ(opened.structure, flat.metadata.structure);
  EXPECT_EQ(flat.mesh.vertexCount(), 10242);
  EXPECT_TRUE((flat.mesh.positions.col(2).array() == 0).all());
  EXPECT_TRUE(geometry::findSelfIntersections(flat.mesh).empty());
  const auto patch = io::readSurface(folder / "flat/patch.surf.gii").mesh;
  EXPECT_EQ(geometry::inspectMesh(patch).unusedVertices, 0);
  io::VolumeReadOptions withNaN;
  withNaN.allowNonFinite = true;
  const auto grid = io::readVectors(folder / "flat/grid.nii.gz", withNaN).volume;
  EXPECT_NEAR(grid.grid.spacing[0], 1, 1e-6);
  EXPECT_NEAR(grid.grid.spacing[1], 1, 1e-6);
  EXPECT_EQ(grid.grid.size[2], 5);
}

/// A patch of a real hemisphere with its stack of depths, and what lies at its voxels and cells.
class RealStack : public FlattenCommand {
 protected:
  void SetUp() override {
    FlattenCommand::SetUp();
    if (IsSkipped()) return;
    for (const std::string name : {"white", "pial"}) {
      const auto surface = io::readSurface(data() / "fsaverage5" / (name + "_left.gii.gz"));
      io::writeGiftiSurface(folder_ / (name + ".surf.gii"), surface.mesh, surface.metadata);
    }
    const std::string mid = middle(folder_, "left");
    const TriangleMesh mesh = io::readSurface(mid).mesh;
    Eigen::Index centre = 0;
    (void)(mesh.positions * Vector(-1, 0.2, 0.2)).maxCoeff(&centre);
    const std::array<std::int32_t, 1> sources = {static_cast<std::int32_t>(centre)};
    const Eigen::VectorXd distance = geometry::geodesicDistances(
        mesh, geometry::buildTopology(mesh.faces, mesh.vertexCount()), sources);
    io::LabelMap ball{"ball", (distance.array() < 25).cast<Label>(), {}};
    ball.table = {{0, "rest", {}}, {1, "ball", {1, 0, 0, 1}}};
    io::writeGiftiLabel(folder_ / "ball.label.gii", ball, "CortexLeft");
    lattice_.spacing = {0.8, 0.8, 0.8};
    for (int axis = 0; axis < 3; ++axis) {
      lattice_.origin[axis] = mesh.positions(centre, axis) - 32;
      lattice_.size[axis] = 80;
    }
    io::writeVolume(folder_ / "any.nii.gz", Volume<float>(lattice_, 1));
    flatten("any", "flat");
  }

  void flatten(const std::string& volume, const std::string& out) {
    const auto made =
        explica({"flatten", folder_ / "mid.surf.gii", "--label", folder_ / "ball.label.gii",
                 "--surfaces", folder_.path().string(), "--volumes", folder_ / (volume + ".nii.gz"),
                 "--depths", "5", "--grid", "0.5", "--out", folder_ / out});
    ASSERT_EQ(made.exitCode, 0) << made;
  }

  [[nodiscard]] Volume<Eigen::Vector3f> points(const std::string& name) const {
    io::VolumeReadOptions withNaN;
    withNaN.allowNonFinite = true;
    return io::readVectors(folder_ / ("flat/" + name), withNaN).volume;
  }

  TemporaryFolder folder_;
  Grid lattice_;
};

TEST_F(RealStack, HasSquareCellsAndNoEmptyOneInsideThePatch) {
  const auto grid = points("grid.nii.gz");
  EXPECT_NEAR(grid.grid.spacing[0], 0.5, 1e-6);
  EXPECT_NEAR(grid.grid.spacing[1], 0.5, 1e-6);
  const TriangleMesh flat = io::readSurface(folder_ / "flat/patch_flat.surf.gii").mesh;
  const auto layer = static_cast<std::size_t>(grid.grid.size[0]) * grid.grid.size[1];
  std::vector<bool> inside(layer, false);
  for (Eigen::Index f = 0; f < flat.faceCount(); ++f) {
    Eigen::Matrix2d sides;
    sides.col(0) = (flat.corner(f, 1) - flat.corner(f, 0)).head<2>();
    sides.col(1) = (flat.corner(f, 2) - flat.corner(f, 0)).head<2>();
    const Eigen::Matrix2d inverse = sides.inverse();
    for (std::size_t n = 0; n < layer; ++n) {
      const auto [i, j, k] = grid.grid.subscripts(n);
      const Point at = grid.grid.origin + Vector(0.5 * i, 0.5 * j, 0);
      const Eigen::Vector2d share = inverse * (at - flat.corner(f, 0)).head<2>();
      if (share.minCoeff() > 1e-4 && share.sum() < 1 - 1e-4) inside[n] = true;
    }
  }
  const auto count = std::count(inside.begin(), inside.end(), true);
  EXPECT_GT(count, 5000);
  for (std::size_t n = 0; n < layer; ++n) {
    for (int k = 0; k < 5; ++k) {
      const bool filled = grid[n + layer * static_cast<std::size_t>(k)].allFinite();
      EXPECT_TRUE(filled || !inside[n]) << n << " " << k;
      EXPECT_EQ(filled, grid[n].allFinite());
    }
  }
}

TEST_F(RealStack, AFunctionPrintedOnTheCortexComesBack) {
  const auto places = points("to_flat.nii.gz");
  ASSERT_EQ(places.grid.size, lattice_.size);
  const auto f = [](double u, double v, double depth) {
    return std::sin(0.2 * u) * std::cos(0.2 * v) + depth;
  };
  Volume<float> printed(lattice_, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t n = 0; n < printed.size(); ++n) {
    const Eigen::Vector3f& at = places[n];
    if (at.allFinite()) printed[n] = static_cast<float>(f(at[0], at[1], at[2]));
  }
  io::writeVolume(folder_ / "printed.nii.gz", printed);
  flatten("printed", "back");
  io::VolumeReadOptions withNaN;
  withNaN.allowNonFinite = true;
  const auto back = io::readScalars(folder_ / "back/flat_printed.nii.gz", withNaN).volume;
  std::vector<double> errors;
  for (std::size_t n = 0; n < back.size(); ++n) {
    if (!std::isfinite(back[n])) continue;
    const auto [i, j, k] = back.grid.subscripts(n);
    const double u = back.grid.origin[0] + 0.5 * i, v = back.grid.origin[1] + 0.5 * j;
    errors.push_back(std::abs(back[n] - f(u, v, k / 4.0)));
  }
  ASSERT_GT(errors.size(), 2000U);
  std::sort(errors.begin(), errors.end());
  RecordProperty("median", std::to_string(errors[errors.size() / 2]));
  RecordProperty("p99", std::to_string(errors[errors.size() * 99 / 100]));
  EXPECT_LT(errors[errors.size() / 2], 0.01);  // the function's range is 3
  EXPECT_LT(errors[errors.size() * 99 / 100], 0.06);
}

TEST_F(RealStack, VoxelsComeBackWithinATenthOfAVoxel) {
  const auto places = points("to_flat.nii.gz"), grid = points("grid.nii.gz");
  std::vector<double> errors;
  for (std::size_t n = 0; n < places.size(); ++n) {
    if (!places[n].allFinite()) continue;
    const auto back = interpolated(grid, places[n]);
    const auto [i, j, k] = lattice_.subscripts(n);
    if (back) errors.push_back((lattice_.toIndex(*back) - Vector(i, j, k)).norm());
  }
  ASSERT_GT(errors.size(), 5000U);
  std::sort(errors.begin(), errors.end());
  RecordProperty("median", std::to_string(errors[errors.size() / 2]));
  RecordProperty("p99", std::to_string(errors[errors.size() * 99 / 100]));
  EXPECT_LT(errors[errors.size() / 2], 0.1);
  EXPECT_LT(errors[errors.size() * 99 / 100], 0.3);
}

/// A functional image of pycortex's example subject on a patch of its cortex.
class FunctionalImage : public FlattenCommand {
 protected:
  void SetUp() override {
    FlattenCommand::SetUp();
    if (IsSkipped()) return;
    const TriangleMesh mesh = io::readSurface(individual()).mesh;
    Eigen::Index back = 0;
    (void)mesh.positions.col(1).minCoeff(&back);
    const Vector behind = mesh.positions.row(back);
    const auto near =
        ((mesh.positions.rowwise() - behind.transpose()).rowwise().norm().array() < 9);
    io::LabelMap ball{"ball", near.cast<Label>(), {{0, "rest", {}}, {1, "ball", {1, 0, 0, 1}}}};
    io::writeGiftiLabel(folder_ / "ball.label.gii", ball, "CortexLeft");
  }

  [[nodiscard]] CommandResult flatten(const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"flatten",  individual().string(),
                                      "--label",  folder_ / "ball.label.gii",
                                      "--grid",   "1",
                                      "--depths", "3",
                                      "--out",    folder_ / "flat"};
    words.insert(words.end(), more.begin(), more.end());
    return explica(words);
  }

  static std::string given(const std::string& name) {
    return (data() / "s1_pycortex_lh" / name).string();
  }

  TemporaryFolder folder_;
};

TEST_F(FunctionalImage, ComesOntoTheFlatMapThroughItsTransform) {
  const auto made =
      flatten({"--surfaces", given(""), "--volumes", given("transforms/fullhead_reference.nii.gz"),
               "--to-volume", given("transforms/fullhead_matrices.xfm")});
  ASSERT_EQ(made.exitCode, 0) << made;
  EXPECT_NE(made.err.find("flat map: usable, one-to-one\n"), std::string::npos);
  EXPECT_NE(made.err.find("Mean area error 0."), std::string::npos) << made;
  io::VolumeReadOptions withNaN;
  withNaN.allowNonFinite = true;
  const auto places = io::readVectors(folder_ / "flat/grid.nii.gz", withNaN).volume;
  const auto values =
      io::readScalars(folder_ / "flat/flat_fullhead_reference.nii.gz", withNaN).volume;
  const auto image = io::readScalars(given("transforms/fullhead_reference.nii.gz")).volume;
  const auto rows = readJson(given("transforms/fullhead_matrices.xfm"))["coord"];
  std::size_t known = 0;
  for (std::size_t n = 0; n < places.size(); ++n) {
    if (!places[n].allFinite()) continue;
    Eigen::Array3d at;
    for (int r = 0; r < 3; ++r) {
      at[r] = double(rows[r][3]);
      for (int c = 0; c < 3; ++c) at[r] += double(rows[r][c]) * places[n][c];
    }
    const Eigen::Array3d low = at.floor(), share = at - low;
    double expected = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Array3d up(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
      const Eigen::Array3d p = low + up, weight = up * share + (1 - up) * (1 - share);
      expected += weight.prod() * image(int(p[0]), int(p[1]), int(p[2]));
    }
    EXPECT_NEAR(values[n], expected, 0.01 * (1 + expected));
    ++known;
  }
  EXPECT_GT(known, 300U);
}

TEST_F(FunctionalImage, IsRefusedBeforeTheMapIsMadeWhereThePatchLiesOutsideIt) {
  const std::string slab = given("transforms/retinotopy_reference.nii.gz");
  const auto elsewhere =
      flatten({"--surfaces", given(""), "--volumes", slab, "--to-volume",
               given("transforms/fullhead_matrices.xfm"), "--to-volume-sense", "inverse"});
  EXPECT_EQ(elsewhere.exitCode, 2) << elsewhere;
  writeText(folder_ / "far.txt", "1 0 0 500\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  const auto far =
      flatten({"--surfaces", given(""), "--volumes", slab, "--to-volume", folder_ / "far.txt"});
  EXPECT_EQ(far.exitCode, 2) << far;
  EXPECT_NE(far.err.find("no vertex of the patch lies in it"), std::string::npos) << far;
  const auto nameless = flatten({"--surfaces", given("transforms")});
  EXPECT_EQ(nameless.exitCode, 2) << nameless;
  EXPECT_NE(nameless.err.find("wm_lh.gii"), std::string::npos) << nameless;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "flat"));
}

TEST_F(FlattenCommand, ClosedSurfacesAndStrangersAreRefusedWithARemedy) {
  TemporaryFolder folder;
  const std::string mid = middle(folder, "left");
  const auto closed = explica({"flatten", mid, "--out", folder / "flat"});
  EXPECT_EQ(closed.exitCode, 2);
  EXPECT_NE(closed.err.find("--cuts"), std::string::npos) << closed;
  const auto stranger =
      explica({"compare", mid, individual().string(), "--out", folder / "compared"});
  EXPECT_EQ(stranger.exitCode, 2);
  EXPECT_NE(stranger.err.find("same vertices"), std::string::npos) << stranger;
}

/// A cap of a sphere with regions of two files.
TEST(FlattenSides, AMapIsSeenFromOutsideWhicheverWayFacesRun) {
  const TemporaryFolder folder;
  const TriangleMesh ball = geometry::makeIcosphere(4, 30);
  TriangleMesh turned = ball;
  turned.faces.col(1).swap(turned.faces.col(2));
  for (const TriangleMesh& mesh : {ball, turned}) {
    io::writeSurface(folder / "ball.surf.gii", mesh);
    const auto made = explica({"flatten", folder / "ball.surf.gii", "--center", "0,0,30",
                               "--radius", "15", "--force", "--out", folder / "flat"});
    ASSERT_EQ(made.exitCode, 0) << made;
    const Positions flat = io::readSurface(folder / "flat/flat.surf.gii").mesh.positions;
    int mirrored = 0;
    for (Eigen::Index f = 0; f < ball.faceCount(); ++f) {
      if (ball.corner(f, 0).z() < 28 || ball.corner(f, 1).z() < 28 || ball.corner(f, 2).z() < 28) {
        continue;
      }
      const Vector a = flat.row(ball.faces(f, 0)), b = flat.row(ball.faces(f, 1)),
                   c = flat.row(ball.faces(f, 2));
      mirrored += (b - a).cross(c - a).z() < 0;
    }
    EXPECT_EQ(mirrored, 0);
  }
}

TEST(FlattenRegions, KeepNamesAndColoursOfEachFile) {
  TemporaryFolder folder;
  const TriangleMesh sphere = geometry::makeIcosphere(4, 30);
  io::writeGiftiSurface(folder / "mid.surf.gii", sphere);
  const auto above = [&](double height) {
    return (sphere.positions.col(2).array() > height).cast<Label>().matrix().eval();
  };
  const std::vector<io::LabelEntry> none = {{0, "???", {0, 0, 0, 0}}};
  io::writeGiftiLabel(folder / "cap.label.gii",
                      {"cap", above(10), {none[0], {1, "cap", {1, 1, 1, 1}}}}, "CortexLeft");
  io::LabelMap areas{"areas", above(20), none};
  areas.keys += 4 * above(10);
  areas.table.push_back({4, "V2", {0, 0, 1, 1}});
  areas.table.push_back({5, "V1", {1, 0, 0, 1}});
  areas.table.push_back({6, "elsewhere", {0, 1, 0, 1}});
  io::writeGiftiLabel(folder / "areas.label.gii", areas, "CortexLeft");
  io::LabelMap spot{"spot", (sphere.positions.col(0).array() > 15).cast<Label>(), none};
  spot.table.push_back({1, "spot", {0, 1, 1, 1}});
  io::writeGiftiLabel(folder / "spot.label.gii", spot, "CortexLeft");
  const auto made =
      explica({"flatten", folder / "mid.surf.gii", "--label", folder / "cap.label.gii", "--regions",
               folder / "areas.label.gii", "--regions", folder / "spot.label.gii",
               "--area-tolerance", "0.05", "--out", folder / "flat"});
  ASSERT_EQ(made.exitCode, 0) << made;
  const Eigen::VectorXd origin =
      io::readVertexMaps(folder / "flat/vertex_of.shape.gii").front().values;
  const io::LabelMap kept = io::readVertexLabels(folder / "flat/patch_areas.label.gii");
  ASSERT_EQ(kept.table.size(), 3u);  // what the patch has, and what is none
  EXPECT_EQ(kept.table[1].name, "V2");
  EXPECT_EQ(kept.table[2].colour, (std::array<float, 4>{1, 0, 0, 1}));
  for (Eigen::Index v = 0; v < origin.size(); ++v) {
    EXPECT_EQ(kept.keys[v], areas.keys[static_cast<Eigen::Index>(origin[v])]);
  }
  const io::LabelMap second = io::readVertexLabels(folder / "flat/patch_spot.label.gii");
  EXPECT_GT(second.keys.sum(), 10);
  const std::string table = readText(folder / "flat/patch.tsv");
  for (const char* row : {"\nV1\t5\t", "\nV2\t4\t", "\nspot\t1\t"}) {
    EXPECT_NE(table.find(row), std::string::npos) << table;
  }
  EXPECT_EQ(table.find("elsewhere"), std::string::npos);
}

TEST(FlattenRegions, SeveralLabelsAndKeysMakeOnePatch) {
  TemporaryFolder folder;
  const TriangleMesh sphere = geometry::makeIcosphere(4, 30);
  io::writeGiftiSurface(folder / "mid.surf.gii", sphere);
  const auto write = [&](const std::string& name, const auto& keys) {
    io::LabelMap labels{name, keys, {{0, "???", {0, 0, 0, 0}}}};
    for (const Label key : {1, 2, 3}) labels.table.push_back({key, std::to_string(key), {}});
    io::writeGiftiLabel(folder / (name + ".label.gii"), labels, "CortexLeft");
  };
  const auto x = sphere.positions.col(0).array(), z = sphere.positions.col(2).array();
  const auto left = (z > 10 && x < 1).cast<Label>().eval(),
             right = (z > 10 && x > -1).cast<Label>().eval();
  write("left", left.matrix().eval());
  write("right", right.matrix().eval());
  write("cap", (left + 2 * right).min(3).matrix().eval());
  const auto facesOf = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"flatten", folder / "mid.surf.gii", "--area-tolerance", "0.05"});
    words.insert(words.end(), {"--out", folder / "flat", "--force"});
    const auto made = explica(words);
    EXPECT_EQ(made.exitCode, 0) << made;
    return int(readJson(folder / "flat/summary.json")["faces"]);
  };
  const int whole = facesOf({"--label", folder / "cap.label.gii"});
  EXPECT_EQ(facesOf({"--label", folder / "left.label.gii", "--label", folder / "right.label.gii"}),
            whole);
  EXPECT_EQ(facesOf({"--label", folder / "cap.label.gii", "--label-key", "1,2,3"}), whole);
  EXPECT_LT(facesOf({"--label", folder / "cap.label.gii", "--label-key", "1,3"}), 0.7 * whole);
  // z > 10 of a sphere of 30 mm is what lies within sqrt(2 * 30 * 20) = 34.64 mm of its top.
  EXPECT_EQ(facesOf({"--center", "0,0,30", "--radius", "34.64"}), whole);
  const auto none =
      explica({"flatten", folder / "mid.surf.gii", "--label", folder / "cap.label.gii",
               "--label-key", "7,8", "--out", folder / "none"});
  EXPECT_EQ(none.exitCode, 2);
  EXPECT_NE(none.err.find("7 or 8, keys go from 0 to 3"), std::string::npos) << none;
}

/// A limit that has passed before any work begins: what the help promises does not hang on a clock.
TEST(FlattenLimit, CutsAreWrittenWhereverTheSearchForThemIsStoppedAndTheRunGoesOn) {
  TemporaryFolder folder;
  io::writeSurface(folder / "sphere.surf.gii", geometry::makeFoldedSphere(4, 30.0));
  const auto withWords = [&](std::vector<std::string> more, const std::string& out,
                             const CommandSetting& setting = {}) {
    std::vector<std::string> words = {
        "flatten",   folder / "sphere.surf.gii", "--cuts", "auto", "--grid", "2", "--out",
        folder / out};
    words.insert(words.end(), more.begin(), more.end());
    return explica(words, setting);
  };
  // Reading the surface and preparing it have a few checks, after which nothing is written.
  constexpr const char* kWithinTheSearch = "stopped while cuts were sought";
  CommandResult stopped;
  for (long checks = 20; checks < 20000; checks += checks / 8) {
    stopped = withWords({"--frames", "4"}, "a", stopAtCheck(checks));
    ASSERT_EQ(stopped.exitCode, 3) << stopped;
    if (stopped.err.find(kWithinTheSearch) != std::string::npos) break;
    ASSERT_FALSE(std::filesystem::exists(folder / "a")) << stopped;
  }
  ASSERT_NE(stopped.err.find(kWithinTheSearch), std::string::npos) << stopped;
  const auto summary = readJson(folder / "a/summary.json");
  EXPECT_EQ(summary["termination"], "interrupted");
  EXPECT_TRUE(std::filesystem::exists(folder / "a/cuts.tsv"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a/flat.surf.gii")) << "no map of half the cuts";
  EXPECT_EQ(withWords({"--resume"}, "a").exitCode, 0);
  EXPECT_EQ(withWords({}, "b").exitCode, 0);
  EXPECT_EQ(readText(folder / "a/flat.surf.gii"), readText(folder / "b/flat.surf.gii"));
  EXPECT_EQ(withWords({"--resume"}, "c").exitCode, 2);  // nothing lies there

  io::writeSurface(folder / "sphere.surf.gii", geometry::makeFoldedSphere(4, 31.0));
  const auto stranger = withWords({"--resume"}, "a");
  EXPECT_EQ(stranger.exitCode, 2);
  EXPECT_NE(stranger.err.find("another surface"), std::string::npos) << stranger;
}

TEST(FlattenLimit, AStopBetweenCutsAndMapLeavesTheCuts) {
  TemporaryFolder folder;
  io::writeSurface(folder / "sphere.surf.gii", geometry::makeFoldedSphere(3, 30.0));
  const std::vector<std::string> words = {
      "flatten",   folder / "sphere.surf.gii", "--cuts", "auto", "--threads", "1", "--out",
      folder / "a"};
  ASSERT_EQ(explica(words).exitCode, 0);
  const std::string map = readText(folder / "a/flat.surf.gii");
  const long mapped = firstCheckThatLeaves("flat.surf.gii", words, folder / "a");
  const auto stopped = explica(words, stopAtCheck(mapped - 1));
  ASSERT_TRUE(isInterrupted(stopped)) << stopped;
  const auto steps = readJson(folder / "a/provenance.json")["steps"];
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_EQ(steps[0]["termination"], "finished");
  EXPECT_EQ(steps[1]["termination"], "interrupted");
  EXPECT_TRUE(std::filesystem::exists(folder / "a/cuts.tsv"));
  std::vector<std::string> again = words;
  again.push_back("--resume");
  EXPECT_EQ(explica(again).exitCode, 0);
  EXPECT_EQ(readText(folder / "a/flat.surf.gii"), map);
}

TEST_F(FlattenCommand, TheWallOfAutomaticCutsIsTakenFromWhatIsGivenOrFound) {
  TemporaryFolder folder;
  const std::string mid = middle(folder, "left");
  const auto areaWith = [&](const std::vector<std::string>& words) {
    auto all = std::vector<std::string>{"flatten", mid, "--cuts", "auto", "--cut.most", "0"};
    all.insert(all.end(), words.begin(), words.end());
    all.insert(all.end(), {"--out", folder / "out", "--force"});
    const auto made = explica(all);
    EXPECT_EQ(made.exitCode, 0) << made;
    return double(readJson(folder / "out/summary.json")["area"]);
  };
  const double found = areaWith({});
  const double whole = geometry::totalArea(io::readSurface(mid).mesh);
  EXPECT_NEAR(found, 0.97 * whole, 0.01 * whole);
  const auto thickness = io::readVertexMaps(data() / "fsaverage5/thick_left.gii.gz").front().values;
  io::LabelMap cortex;
  cortex.keys = (thickness.array() != 0).cast<Label>() + 1;
  cortex.table = {{1, "Medial_wall", {0, 0, 0, 1}}, {2, "cortex", {1, 1, 0, 1}}};
  io::writeGiftiLabel(folder / "cortex.label.gii", cortex, "CortexLeft");
  io::writeFreeSurferAnnot(folder / "lh.test.annot", cortex);
  const double byThickness =
      areaWith({"--cortex", (data() / "fsaverage5/thick_left.gii.gz").string()});
  EXPECT_EQ(areaWith({"--cortex", folder / "cortex.label.gii"}), byThickness);
  EXPECT_EQ(areaWith({"--cortex", folder / "lh.test.annot"}), byThickness);
  cortex.keys.array() -= 1;
  explica::test::writeFreeSurferLabel(folder / "lh.cortex.label", cortex,
                                      io::readSurface(mid).mesh.positions);
  EXPECT_EQ(areaWith({"--cortex", folder / "lh.cortex.label"}), byThickness);
  io::writeGiftiShape(folder / "valid.shape.gii", {{"thickness", "mm", thickness}}, "CortexLeft");
  EXPECT_EQ(areaWith({}), byThickness);  // beside the surface
}

}  // namespace
}  // namespace explica::testing
