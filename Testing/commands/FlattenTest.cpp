// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// explica flatten and explica compare on surfaces of real heads.

#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/IO/PatchFile.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Testing/Command.h"
#include "RealSurfaces.h"

#include <gtest/gtest.h>

#include <cmath>
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

class WholeHemisphere : public FlattenCommand, public ::testing::WithParamInterface<std::string> {};

TEST_P(WholeHemisphere, WithTheShippedCutsKeepsDistancesBetterThanTheShippedMap) {
  TemporaryFolder folder;
  const std::string side = GetParam(), mid = middle(folder, side);
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

TEST_P(WholeHemisphere, CutByItselfKeepsDistancesAsWellAsWithCutsMadeByHand) {
  TemporaryFolder folder;
  const std::string side = GetParam(), mid = middle(folder, side);
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
  const std::string name = (side == "right" ? "rh" : "lh") + std::string(".patch.3d");
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

INSTANTIATE_TEST_SUITE_P(Fsaverage5, WholeHemisphere, ::testing::Values("left", "right"),
                         [](const auto& row) { return row.param; });

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
  const auto none =
      explica({"flatten", folder / "mid.surf.gii", "--label", folder / "cap.label.gii",
               "--label-key", "7,8", "--out", folder / "none"});
  EXPECT_EQ(none.exitCode, 2);
  EXPECT_NE(none.err.find("7 or 8, keys go from 0 to 3"), std::string::npos) << none;
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
  io::writeFreeSurferLabel(folder / "lh.cortex.label", cortex, io::readSurface(mid).mesh.positions);
  EXPECT_EQ(areaWith({"--cortex", folder / "lh.cortex.label"}), byThickness);
  io::writeGiftiShape(folder / "valid.shape.gii", {{"thickness", "mm", thickness}}, "CortexLeft");
  EXPECT_EQ(areaWith({}), byThickness);  // beside the surface
}

}  // namespace
}  // namespace explica::testing
