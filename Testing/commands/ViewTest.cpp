// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Pictures without a display.

#include "Explica/Geometry/Fixtures.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Testing/Command.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace explica::testing {
namespace {

const CommandSetting kNoDisplay = {{}, {{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}}, {}, {}};

void writeSphere(const TemporaryFolder& folder) {
  const TriangleMesh mesh = geometry::makeFoldedSphere(4, 40);
  io::writeGiftiSurface(folder / "a.surf.gii", mesh);
  io::writeGiftiShape(folder / "a.shape.gii", {{"height", "mm", mesh.positions.col(2)}}, "Other");
}

TEST(View, DrawsTheSameBytesTwiceWithoutADisplay) {
  TemporaryFolder folder;
  writeSphere(folder);
  std::vector<std::string> pictures;
  for (const char* threads : {"1", "4"}) {
    const std::string file = folder / (std::string(threads) + ".png");
    const auto view =
        explica({"view", folder / "a.surf.gii", "--map", folder / "a.shape.gii", "--width", "300",
                 "--height", "200", "--threads", threads, "--screenshot", file},
                kNoDisplay);
    ASSERT_EQ(view.exitCode, 0) << view;
    pictures.push_back(readText(file));
  }
  EXPECT_EQ(pictures[0].compare(1, 3, "PNG"), 0);
  EXPECT_EQ(pictures[0], pictures[1]);
}

TEST(View, LabelsHaveTheirTablesColoursAndTheMedialWallIsGrey) {
  TemporaryFolder folder;
  writeSphere(folder);
  const TriangleMesh mesh = io::readSurface(folder / "a.surf.gii").mesh;
  const auto picture = [&](const std::vector<std::string>& words, const std::string& name) {
    std::vector<std::string> all = {"view", folder / "a.surf.gii"};
    all.insert(all.end(), words.begin(), words.end());
    all.insert(all.end(), {"--views", "left", "--width", "200", "--height", "150", "--screenshot",
                           folder / (name + ".png")});
    const auto drawn = explica(all, kNoDisplay);
    EXPECT_EQ(drawn.exitCode, 0) << drawn;
    return readText(folder / (name + ".png"));
  };
  io::LabelMap labels{"areas", (mesh.positions.col(2).array() > 0).cast<Label>() + 1, {}};
  const auto write = [&](const std::string& file, const std::array<float, 4>& second) {
    labels.table = {{1, "one", {1, 0, 0, 1}}, {2, "two", second}};
    io::writeGiftiLabel(folder / file, labels, "CortexLeft");
    return folder / file;
  };
  const std::string blue = write("blue.label.gii", {0, 0, 1, 1}),
                    green = write("green.label.gii", {0, 1, 0, 1});
  const std::string drawn = picture({"--labels", blue}, "labels");
  EXPECT_NE(drawn, picture({"--labels", green}, "green"));
  EXPECT_EQ(drawn, picture({"--map", blue}, "map"));  // never as a scale of values

  // What was not measured, by valid.shape.gii or as a thickness of 0, has no value's colour.
  Eigen::VectorXd values = mesh.positions.col(2).cwiseAbs().array() + 1, valid(values.size());
  for (Eigen::Index v = 0; v < values.size(); ++v) {
    valid[v] = mesh.positions(v, 1) > 0 ? 1 : 0;
    if (valid[v] == 0) values[v] = 0;
  }
  Eigen::VectorXd unknown = values;
  for (Eigen::Index v = 0; v < values.size(); ++v) {
    if (valid[v] == 0) unknown[v] = kNaN;
  }
  const auto maps = [&](const std::string& file, const std::string& name, const auto& of) {
    io::GiftiMapsWriter writer(folder / file, "CortexLeft", 1);
    const std::vector<float> floats(of.begin(), of.end());
    writer.add(name, "mm", floats);
    writer.finish();
    return folder / file;
  };
  const auto drawnMap = [&](const std::string& file, const std::string& name) {
    return picture({"--map", file, "--map-name", name, "--range", "0,40"}, "m");
  };
  const std::string plain = drawnMap(maps("m.shape.gii", "m", values), "m");
  const std::string known = drawnMap(maps("m.shape.gii", "m", unknown), "m");
  EXPECT_NE(plain, known);
  io::writeGiftiShape(folder / "valid.shape.gii", {{"valid", "", valid}}, "CortexLeft");
  EXPECT_EQ(drawnMap(maps("m.shape.gii", "m", values), "m"), known);
  std::filesystem::remove(folder / "valid.shape.gii");
  const std::string thin = drawnMap(maps("t.shape.gii", "thickness", values), "thickness");
  EXPECT_EQ(thin, drawnMap(maps("t.shape.gii", "thickness", unknown), "thickness"));
}

TEST(View, ShowsContoursOnAVolume) {
  TemporaryFolder folder;
  ASSERT_EQ(explica({"phantom", "cortex", "--size", "40", "--out", folder / "p"}).exitCode, 0);
  const auto plain = explica(
      {"view", folder / "p/t1.nii.gz", "--height", "300", "--screenshot", folder / "plain.png"},
      kNoDisplay);
  const auto lined = explica({"view", folder / "p/t1.nii.gz", folder / "p/white.surf.gii",
                              "--height", "300", "--screenshot", folder / "lined.png"},
                             kNoDisplay);
  EXPECT_EQ(plain.exitCode, 0) << plain;
  EXPECT_EQ(lined.exitCode, 0) << lined;
  EXPECT_NE(readText(folder / "plain.png"), readText(folder / "lined.png"));
}

/// The folder `u` of three iterations with their frames.
void writeUnfoldedSphere(const TemporaryFolder& folder) {
  writeSphere(folder);
  ASSERT_NE(explica({"unfold", folder / "a.surf.gii", "--center", "0,0,40", "--radius", "14",
                     "--direction", "0,0,1", "--max-iterations", "3", "--frames", "3", "--out",
                     folder / "u"})
                .exitCode,
            2);
}

TEST(View, MakesAFilmOfFrames) {
  TemporaryFolder folder;
  writeUnfoldedSphere(folder);
  const auto film =
      explica({"view", folder / "u", "--labels", folder / "u/region.label.gii", "--width", "160",
               "--height", "120", "--direction", "0,0,1", "--film", folder / "u.gif"},
              kNoDisplay);
  ASSERT_EQ(film.exitCode, 0) << film;
  EXPECT_EQ(readText(folder / "u.gif").substr(0, 6), "GIF89a");

  // Without options the region is coloured and seen from its viewpoint.
  const auto plain = explica(
      {"view", folder / "u", "--width", "160", "--height", "120", "--film", folder / "plain.gif"},
      kNoDisplay);
  ASSERT_EQ(plain.exitCode, 0) << plain;
  EXPECT_NE(readText(folder / "plain.gif"), readText(folder / "u.gif"));

  const auto other = explica({"view", folder / "u", "--film", folder / "u.avi"}, kNoDisplay);
  EXPECT_EQ(other.exitCode, 1) << other;
  EXPECT_NE(other.err.find(".webm"), std::string::npos) << other;
  const auto nothing =
      explica({"view", folder.path().string(), "--film", folder / "u.avi"}, kNoDisplay);
  EXPECT_EQ(nothing.err, other.err) << "before anything is read or drawn";
}

TEST(View, MakesFilmsOfEveryFormat) {
  TemporaryFolder folder;
  writeUnfoldedSphere(folder);
  // An odd width, which the codecs of videos do not take as it is.
  const auto film = [&](const std::string& name, const CommandSetting& setting = kNoDisplay) {
    return explica(
        {"view", folder / "u", "--width", "161", "--height", "120", "--film", folder / name},
        setting);
  };
  const struct {
    std::string name;
    std::size_t at;
    std::string magic;
  } videos[] = {{"u.mp4", 4, "ftyp"}, {"u.webm", 0, "\x1a\x45\xdf\xa3"}};
  for (const auto& video : videos) {
    if (std::filesystem::exists("/usr/bin/ffmpeg")) {
      const auto made = film(video.name);
      ASSERT_EQ(made.exitCode, 0) << made;
      EXPECT_EQ(readText(folder / video.name).substr(video.at, 4), video.magic) << video.name;
      std::filesystem::remove(folder / video.name);
    }
    CommandSetting without = kNoDisplay;
    without.environment["PATH"] = folder.path().string();
    const auto refused = film(video.name, without);
    EXPECT_EQ(refused.exitCode, 4) << refused;
    EXPECT_NE(refused.err.find("ffmpeg is not installed; write a .gif"), std::string::npos)
        << refused;
    EXPECT_FALSE(std::filesystem::exists(folder / video.name));
  }
}

TEST(View, SaysWhichMapIsMissing) {
  TemporaryFolder folder;
  writeSphere(folder);
  const auto view = explica({"view", folder / "a.surf.gii", "--map", folder / "a.shape.gii",
                             "--map-name", "depth", "--screenshot", folder / "x.png"},
                            kNoDisplay);
  EXPECT_EQ(view.exitCode, 2);
  EXPECT_NE(view.err.find("height"), std::string::npos) << view;
}

/// Both hemispheres with a map each, and the left one as a flat map with a region.
class Figure : public ::testing::Test {
 protected:
  void SetUp() override {
    TriangleMesh mesh = geometry::makeFoldedSphere(3, 40);
    for (const std::string side : {"L", "R"}) {
      const std::string structure = side == "L" ? "CortexLeft" : "CortexRight";
      io::SurfaceMetadata metadata;
      metadata.structure = structure;
      io::writeGiftiSurface(folder_ / (side + ".surf.gii"), mesh, metadata);
      io::writeGiftiShape(folder_ / (side + ".shape.gii"),
                          {{"height", "mm", mesh.positions.col(2)}}, structure);
    }
    io::LabelMap areas{"areas", (mesh.positions.col(0).array() > 0).cast<Label>(), {}};
    areas.table = {{0, "???", {0, 0, 0, 0}}, {1, "V1", {1, 0, 0, 1}}};
    io::writeGiftiLabel(folder_ / "L.label.gii", areas, "CortexLeft");
    std::vector<std::int32_t> upper;
    for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
      if (mesh.corner(f, 0).z() > 20) upper.push_back(static_cast<std::int32_t>(f));
    }
    mesh.faces = mesh.faces(upper, Eigen::all).eval();
    mesh.positions.col(2).setZero();
    io::SurfaceMetadata flat;
    flat.structure = "CortexLeft";
    io::writeGiftiSurface(folder_ / "flat.surf.gii", mesh, flat);
  }

  CommandResult draw(std::vector<std::string> files, const std::string& out,
                     const std::vector<std::string>& more = {}) {
    for (std::string& file : files) file = folder_ / file;
    files.insert(files.begin(), "figure");
    files.insert(files.end(), {"--size", "400", "--out", folder_ / out});
    files.insert(files.end(), more.begin(), more.end());
    return explica(files, kNoDisplay);
  }

  TemporaryFolder folder_;
};

TEST_F(Figure, HasBothHemispheresFlatMapsAndOneColourBarInLayers) {
  const auto made = draw(
      {"R.surf.gii", "L.surf.gii", "L.shape.gii", "R.shape.gii", "flat.surf.gii", "L.label.gii"},
      "a");
  ASSERT_EQ(made.exitCode, 0) << made;
  const std::string svg = readText(folder_ / "a/figure.svg");
  for (const char* text :
       {"<g id=\"surfaces\" inkscape:groupmode=\"layer\"", "id=\"titles\"", "id=\"colour-bar\"",
        "id=\"scale\"", ">left, lateral<", ">right, medial<", ">height [mm]<"}) {
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  }
  EXPECT_LT(svg.find(">left, lateral<"), svg.find(">right, lateral<"));
  const std::size_t outlines = svg.find("id=\"outlines\""), names = svg.find("id=\"names\"");
  EXPECT_LT(outlines, svg.find("<path inkscape:label=\"V1\"")) << "a path that can be edited";
  EXPECT_LT(names, svg.find(">V1</text>")) << "and text";
  const auto again = draw(
      {"L.surf.gii", "L.shape.gii", "R.surf.gii", "R.shape.gii", "flat.surf.gii", "L.label.gii"},
      "b", {"--threads", "1"});
  ASSERT_EQ(again.exitCode, 0) << again;
  EXPECT_EQ(readText(folder_ / "a/figure.png"), readText(folder_ / "b/figure.png"));
  const auto without =
      draw({"L.surf.gii", "L.shape.gii", "R.surf.gii", "R.shape.gii", "flat.surf.gii"}, "c");
  EXPECT_NE(readText(folder_ / "a/figure.png"), readText(folder_ / "c/figure.png"));
}

TEST_F(Figure, TellsThatMapsOfOneBarHaveDifferentNames) {
  io::writeGiftiShape(folder_ / "R.depth.shape.gii",
                      {{"depth", "mm", io::readVertexMaps(folder_ / "R.shape.gii").front().values}},
                      "CortexRight");
  const auto same = draw({"L.surf.gii", "L.shape.gii", "R.surf.gii", "R.shape.gii"}, "a");
  EXPECT_EQ(same.err.find("different names"), std::string::npos) << same;
  const auto other = draw({"L.surf.gii", "L.shape.gii", "R.surf.gii", "R.depth.shape.gii"}, "b");
  EXPECT_EQ(other.exitCode, 0) << other;
  EXPECT_NE(other.err.find("different names, 'height' and 'depth'"), std::string::npos) << other;
}

TEST_F(Figure, RefusesAMapThatItWouldNotShow) {
  const auto made = draw({"L.surf.gii", "L.shape.gii", "L.shape.gii"}, "a");
  EXPECT_EQ(made.exitCode, 2) << made;
  EXPECT_NE(made.err.find("have another map already"), std::string::npos) << made;
}

TEST_F(Figure, RefusesMapsOfTheOtherSideAndWhatIsNoSurface) {
  const auto swapped = draw({"L.surf.gii", "R.shape.gii"}, "a");
  EXPECT_EQ(swapped.exitCode, 2) << swapped;
  EXPECT_NE(swapped.err.find("right hemisphere"), std::string::npos) << swapped;
  const auto none = draw({"L.shape.gii"}, "a");
  EXPECT_EQ(none.exitCode, 2) << none;
  EXPECT_NE(none.err.find("is no surface"), std::string::npos) << none;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a"));
}

}  // namespace
}  // namespace explica::testing
