// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/Fixtures.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Testing/Command.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace explica::testing {
namespace {

void unfoldSphere(const TemporaryFolder& folder) {
  io::writeGiftiSurface(folder / "a.surf.gii", geometry::makeFoldedSphere(4, 40));
  const auto unfold = explica({"unfold", folder / "a.surf.gii", "--center", "0,0,40", "--radius",
                               "14", "--direction", "0,0.3,1", "--max-iterations", "4", "--frames",
                               "4", "--out", folder / "u"});
  ASSERT_TRUE(unfold.exitCode == 0 || unfold.exitCode == 3) << unfold;
}

std::size_t countOf(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) {
    ++count;
  }
  return count;
}

TEST(Report, WorksInABrowserWithoutANetwork) {
  if (!std::filesystem::exists("/usr/bin/chromium") ||
      !std::filesystem::exists("/usr/bin/chromedriver")) {
    GTEST_SKIP() << "no chromium";
  }
  TemporaryFolder folder;
  unfoldSphere(folder);
  const auto report = explica({"report", folder / "u"});
  ASSERT_EQ(report.exitCode, 0) << report;
  const auto browser =
      runProgram({"/usr/bin/python3", EXPLICA_SOURCE_DIR "/Testing/commands/report_page.py",
                  folder / "u/report.html"});
  EXPECT_EQ(browser.exitCode, 0) << browser;

  // Of a run on both sides the reader chooses which patch to see.
  // Its patch is long, and in sight from end to end all the same.
  const TriangleMesh mesh = io::readSurface(folder / "a.surf.gii").mesh;
  io::LabelMap strip{"strip", {}, {{0, "???", {0, 0, 0, 0}}, {1, "strip", {1, 0, 0, 1}}}};
  strip.keys = (mesh.positions.col(0).array().abs() < 5 && mesh.positions.col(1).array() > 0 &&
                mesh.positions.col(2).array().abs() < 30)
                   .cast<Label>();
  io::writeGiftiLabel(folder / "strip.label.gii", strip, "CortexLeft");
  const auto other = explica(
      {"unfold", folder / "a.surf.gii", "--label", folder / "strip.label.gii", "--direction",
       "0,1,0", "--max-iterations", "3", "--frames", "3", "--out", folder / "both/unfold-R"});
  ASSERT_TRUE(other.exitCode == 0 || other.exitCode == 3) << other;
  std::filesystem::copy(folder / "u", folder / "both/unfold-L");
  std::filesystem::copy(folder / "u/frames", folder / "both/unfold-L/frames");
  writeText(folder / "both/run.json",
            R"({"steps": [{"name": "unfold-L", "command": "unfold", "state": "done", "message": ""},
                          {"name": "unfold-R", "command": "unfold", "state": "done", "message": ""}]})");
  ASSERT_EQ(explica({"report", folder / "both"}).exitCode, 0);
  const auto both =
      runProgram({"/usr/bin/python3", EXPLICA_SOURCE_DIR "/Testing/commands/report_page.py",
                  folder / "both/report.html"});
  EXPECT_EQ(both.exitCode, 0) << both;
  EXPECT_NE(both.out.find("another patch is another picture"), std::string::npos) << both;
}

/// The page without scripts, styles and pictures: what a reader reads.
std::string wordsOf(const std::string& page) {
  std::string words = page;
  for (const auto& [open, close] :
       {std::pair{"<script", "</script>"}, std::pair{"<style", "</style>"},
        std::pair{"<pre", "</pre>"}, std::pair{"base64,", "'"}}) {
    for (std::size_t at = words.find(open); at != std::string::npos; at = words.find(open, at)) {
      words.erase(at, words.find(close, at) - at + std::string_view(close).size());
    }
  }
  return words;
}

TEST(Report, AnswersInTheOrderOfAReadersQuestions) {
  TemporaryFolder folder;
  unfoldSphere(folder);
  ASSERT_EQ(explica({"report", folder / "u"}).exitCode, 0);
  const std::string words = wordsOf(readText(folder / "u/report.html"));
  std::size_t before = 0;
  for (const char* question :
       {"Is it right?", "What was found", "See for yourself", "How it was made"}) {
    const std::size_t at = words.find("<h2>" + std::string(question));
    ASSERT_NE(at, std::string::npos) << question;
    EXPECT_GT(at, before) << question;
    before = at;
  }
  EXPECT_NE(words.find("Average visibility"), std::string::npos);
  EXPECT_EQ(readText(folder / "u/report.html").find("\"flux "), std::string::npos);
  EXPECT_NE(words.find("Facing the viewpoint (1 = directly), after"), std::string::npos);
  for (const char* key : {"area_error", "visibility_final", "energy_", "edge_strain"}) {
    EXPECT_EQ(words.find(key), std::string::npos) << "a raw key: " << key;
  }
}

TEST(Report, SaysThatADetachedPatchIsDrawnApart) {
  TemporaryFolder folder;
  io::writeGiftiSurface(folder / "a.surf.gii", geometry::makeFoldedSphere(4, 40));
  const auto unfold = explica({"unfold", folder / "a.surf.gii", "--center", "0,0,40", "--radius",
                               "14", "--direction", "0,0.3,1", "--surround", "none",
                               "--max-iterations", "4", "--out", folder / "u"});
  ASSERT_TRUE(unfold.exitCode == 0 || unfold.exitCode == 3) << unfold;
  ASSERT_EQ(explica({"report", folder / "u"}).exitCode, 0);
  EXPECT_NE(wordsOf(readText(folder / "u/report.html")).find("drawn apart from the surface"),
            std::string::npos);
}

TEST(Report, ShowsWhereFacesCrossAndTheFlagLeadsThere) {
  TemporaryFolder folder;
  // Two spheres that pass through each other, far from the region, where nothing parts them.
  io::writeGiftiSurface(folder / "a.surf.gii",
                        geometry::joined(geometry::makeFoldedSphere(4, 40),
                                         geometry::makeIcosphere(3, 10, Point(1, 2, -42))));
  const auto unfold = explica({"unfold", folder / "a.surf.gii", "--center", "0,0,40", "--radius",
                               "14", "--direction", "0,0.3,1", "--no-repair", "--max-iterations",
                               "4", "--out", folder / "u"});
  ASSERT_EQ(unfold.exitCode, 3) << unfold;
  const auto pairs = readJson(folder / "u/summary.json")["self_intersections_initial"];
  ASSERT_GT(pairs, 7);
  ASSERT_EQ(explica({"report", folder / "u"}).exitCode, 0);
  const std::string page = readText(folder / "u/report.html");
  EXPECT_EQ(countOf(page, "id='crossing-places'"), 1u);
  EXPECT_EQ(countOf(page, "<a href='#crossing-places'>see</a>"), 1u);
  const std::size_t begin = page.find("id='crossing-places'");
  const std::string figure = page.substr(begin, page.find("</figure>", begin) - begin);
  EXPECT_EQ(countOf(figure, "class='tile'"), 21u) << "seven places in three directions";
  EXPECT_EQ(countOf(figure, "class='place'>z = "), 7u);
  EXPECT_NE(figure.find("faces that cross"), std::string::npos);
  EXPECT_EQ(countOf(figure, "<path stroke='#ffd60a' d=''"), 0u) << "the surface is in every tile";
  EXPECT_EQ(countOf(figure, "<path stroke='#ff453a' d=''"), 0u) << "and so are the faces";

  // Without the surface of the start there is no picture, and no link to none.
  std::filesystem::remove((folder / "a.surf.gii"));
  ASSERT_EQ(explica({"report", folder / "u"}).exitCode, 0);
  EXPECT_EQ(readText(folder / "u/report.html").find("#crossing-places'"), std::string::npos);
}

TEST(Report, ShowsSlicesInEitherConvention) {
  TemporaryFolder folder;
  ASSERT_EQ(explica({"phantom", "shell", "--size", "20", "--out", folder / "p"}).exitCode, 0);
  ASSERT_EQ(explica({"surface", folder / "p/labels.nii.gz", "--white-label", "1", "--grey-label",
                     "2", "--faces", "1000", "--out", folder / "s"})
                .exitCode,
            0);
  for (const char* convention : {"neurological", "radiological"}) {
    ASSERT_EQ(
        explica({"report", folder / "s", "--convention", convention, "--slices", "3"}).exitCode, 0);
    const std::string words = wordsOf(readText(folder / "s/report.html"));
    EXPECT_NE(words.find(convention == std::string("neurological") ? "left is on the left"
                                                                   : "left is on the right"),
              std::string::npos);
    const std::size_t slices = words.find("<h3 id='slices'");
    ASSERT_NE(slices, std::string::npos);
    EXPECT_EQ(countOf(words.substr(0, slices), "class='tile'"), 2u) << "beside the verdict";
    EXPECT_NE(words.substr(0, slices).find("Thickness, inflated"), std::string::npos);
    EXPECT_NE(words.find("2.3 to 3.1 mm (95 % of 1,035 people"), std::string::npos);
    EXPECT_EQ(countOf(words.substr(slices), "class='tile'"), 9u);
  }
  EXPECT_EQ(explica({"report", folder / "s", "--slices", "0"}).exitCode, 1);
}

TEST(Report, ComparesTheImageBeforeAndAfterItsPreparation) {
  TemporaryFolder folder;
  ASSERT_EQ(explica({"phantom", "cortex", "--size", "40", "--out", folder / "p"}).exitCode, 0);
  const auto segmented = explica({"segment", folder / "p/t1.nii.gz", "--template", "none",
                                  "--max-iterations", "4", "--out", folder / "s"});
  ASSERT_TRUE(segmented.exitCode == 0 || segmented.exitCode == 3) << segmented;
  ASSERT_EQ(explica({"report", folder / "s"}).exitCode, 0);
  const std::string words = wordsOf(readText(folder / "s/report.html"));
  EXPECT_NE(words.find("<b>Bias field.</b>"), std::string::npos);
  EXPECT_NE(words.find("field divided out instead of the image as it came"), std::string::npos);
  EXPECT_NE(words.find("class='other'"), std::string::npos);
  if (!std::filesystem::exists("/usr/bin/chromium")) return;
  const auto browser =
      runProgram({"/usr/bin/python3", EXPLICA_SOURCE_DIR "/Testing/commands/report_flicker.py",
                  folder / "s/report.html"});
  EXPECT_EQ(browser.exitCode, 0) << browser;
}

TEST(Report, LeavesOutWhatItCannotReadAndSaysSo) {
  TemporaryFolder folder;
  unfoldSphere(folder);
  writeText(folder / "u/unfolded.surf.gii", "damaged");
  writeText(folder / "u/visibility.shape.gii", "damaged");
  const auto report = explica({"report", folder / "u"});
  EXPECT_EQ(report.exitCode, 0) << report;
  EXPECT_NE(readText(folder / "u/report.html").find("left out"), std::string::npos);
}

/// Spheres as white and pial surface, an image that falls outwards, and regions.
void makeCortex(const TemporaryFolder& folder) {
  const TriangleMesh white = geometry::makeIcosphere(4, 10.0);
  io::writeGiftiSurface(folder / "white.surf.gii", white);
  io::writeGiftiSurface(folder / "pial.surf.gii", geometry::makeIcosphere(4, 14.0));
  Grid grid;
  grid.size = {32, 32, 32};
  grid.origin = Vector::Constant(-15.5);
  Volume<float> image(grid);
  for (std::size_t v = 0; v < image.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    image[v] = static_cast<float>(100 - 4 * grid.toWorld(Vector(i, j, k)).norm());
  }
  io::writeVolume(folder / "t1.nii.gz", image);
  io::LabelMap regions{"areas", {}, {{0, "???", {0, 0, 0, 0}}, {1, "upper", {1, 0, 0, 1}}}};
  regions.keys = (white.positions.col(2).array() > 3).cast<Label>();
  io::writeGiftiLabel(folder / "areas.label.gii", regions, "CortexLeft");
}

TEST(Report, OfSamplesShowsMapsAndProfiles) {
  TemporaryFolder folder;
  makeCortex(folder);
  writeText(folder / "electrodes.tsv", "name\tx\ty\tz\nA1\t0\t0\t13\n");
  const auto made = explica({"sample", folder / "t1.nii.gz", "--surfaces", folder.path().string(),
                             "--depths", "5", "--labels", folder / "areas.label.gii", "--points",
                             folder / "electrodes.tsv", "--out", folder / "s"});
  ASSERT_EQ(made.exitCode, 0) << made;
  ASSERT_EQ(explica({"report", folder / "s"}).exitCode, 0);
  const std::string words = wordsOf(readText(folder / "s/report.html"));
  EXPECT_NE(words.find("Known of t1"), std::string::npos);
  const std::string page = readText(folder / "s/report.html");
  EXPECT_NE(page.find("data-title=\"middle surface\""), std::string::npos);
  for (const char* depth : {"0", "0.5", "1"}) {
    const std::string map = std::string(R"({"name":"t1, depth )") + depth + "\"";
    EXPECT_EQ(countOf(page, map), 1u) << map;
  }
  EXPECT_EQ(countOf(words, "<svg class='chart'"), 2u) << "all, and one region";
  EXPECT_EQ(countOf(words, "fill-opacity"), 2u) << "each with its spread";
  EXPECT_NE(words.find(">A1<"), std::string::npos);
  EXPECT_EQ(words.find("left out"), std::string::npos);
}

TEST(Report, OfAFlatMapShowsItFoldedAndLayerByLayer) {
  TemporaryFolder folder;
  makeCortex(folder);
  ASSERT_EQ(explica({"sample", folder / "t1.nii.gz", "--surfaces", folder.path().string(), "--out",
                     folder / "s"})
                .exitCode,
            0);
  const auto made =
      explica({"flatten", folder / "white.surf.gii", "--label", folder / "areas.label.gii",
               "--surfaces", folder.path().string(), "--volumes", folder / "t1.nii.gz", "--depths",
               "4", "--map", folder / "s/t1.func.gii", "--regions", folder / "areas.label.gii",
               "--area-tolerance", "0.05", "--out", folder / "f"});
  ASSERT_EQ(made.exitCode, 0) << made;
  ASSERT_EQ(explica({"report", folder / "f"}).exitCode, 0);
  const std::string words = wordsOf(readText(folder / "f/report.html"));
  EXPECT_NE(words.find("expected 0 (one-to-one)"), std::string::npos);
  const std::string page = readText(folder / "f/report.html");
  EXPECT_NE(page.find("data-title=\"patch\""), std::string::npos);
  EXPECT_NE(page.find(R"({"name":"flat","shift":)"), std::string::npos);
  EXPECT_NE(page.find(R"({"name":"t1, depth 0.5")"), std::string::npos);
  EXPECT_NE(words.find("t1, layer by layer"), std::string::npos);
  EXPECT_EQ(countOf(words, "class='view'"), 4u);
  EXPECT_NE(words.find(">upper<"), std::string::npos);
  EXPECT_EQ(words.find("left out:"), std::string::npos);
}

TEST(Report, ShowsGivenMapsOnTheUnfolding) {
  TemporaryFolder folder;
  unfoldSphere(folder);
  const TriangleMesh mesh = io::readSurface(folder / "a.surf.gii").mesh;
  io::writeGiftiShape(folder / "height.shape.gii", {{"height", "mm", mesh.positions.col(2)}},
                      "CortexLeft");
  io::writeGiftiShape(folder / "short.shape.gii", {{"short", "", Eigen::VectorXd::Ones(7)}},
                      "CortexLeft");
  const auto report = explica({"report", folder / "u", "--map", folder / "height.shape.gii",
                               "--map", folder / "short.shape.gii"});
  ASSERT_EQ(report.exitCode, 0) << report;
  const std::string page = readText(folder / "u/report.html");
  EXPECT_NE(page.find(R"({"name":"height")"), std::string::npos);
  EXPECT_EQ(page.find(R"({"name":"short")"), std::string::npos);
}

/// The folder of `explica surface` on a phantom cortex of so many voxels.
void makeSurface(const TemporaryFolder& folder, const std::string& size) {
  ASSERT_EQ(explica({"phantom", "cortex", "--size", size, "--out", folder / ("p" + size)}).exitCode,
            0);
  const auto made =
      explica({"surface", folder / ("p" + size + "/labels.nii.gz"), "--white-label", "3",
               "--grey-label", "2", "--faces", "2000", "--out", folder / ("s" + size)});
  ASSERT_EQ(made.exitCode, 0) << made;
}

TEST(Report, HasSlicesToScrollThroughAndToRate) {
  if (!std::filesystem::exists("/usr/bin/chromium")) GTEST_SKIP() << "no chromium";
  TemporaryFolder folder;
  makeSurface(folder, "40");
  ASSERT_EQ(explica({"report", folder / "s40"}).exitCode, 0);
  const auto browser =
      runProgram({"/usr/bin/python3", EXPLICA_SOURCE_DIR "/Testing/commands/report_slices.py",
                  folder / "s40/report.html"});
  EXPECT_EQ(browser.exitCode, 0) << browser;
}

TEST(Report, MorphsASurfaceFromWhiteToFlatAndOpensThePatchOnIt) {
  if (!std::filesystem::exists("/usr/bin/chromium")) GTEST_SKIP() << "no chromium";
  TemporaryFolder folder;
  ASSERT_EQ(explica({"phantom", "cortex", "--size", "32", "--spacing", "2", "--out", folder / "p"})
                .exitCode,
            0);
  const auto run = explica({"run", folder / "p/labels.nii.gz", "--steps",
                            "thickness,surface,sphere,unfold,report", "--surface.faces", "2000",
                            "--unfold.max-iterations", "5", "--out", folder / "r"});
  ASSERT_TRUE(run.exitCode == 0 || run.exitCode == 3) << run;
  const auto browser =
      runProgram({"/usr/bin/python3", EXPLICA_SOURCE_DIR "/Testing/commands/report_shapes.py",
                  folder / "r/report.html"});
  EXPECT_EQ(browser.exitCode, 0) << browser;
}

TEST(Report, SaysWhatIsWrongOnceAndNamesCommandsNotFolders) {
  TemporaryFolder folder;
  ASSERT_EQ(explica({"phantom", "cortex", "--size", "40", "--out", folder / "p"}).exitCode, 0);
  const auto small = explica(
      {"segment", folder / "p/t1.nii.gz", "--template", "none", "--out", folder / "odd-name"});
  ASSERT_EQ(small.exitCode, 3) << small;
  ASSERT_EQ(explica({"report", folder / "odd-name"}).exitCode, 0);
  const std::string words = wordsOf(readText(folder / "odd-name/report.html"));
  const std::string flags = words.substr(0, words.find("What was found"));
  EXPECT_EQ(countOf(flags, "skull or neck may be left"), 1u);
  EXPECT_NE(flags.find("Brain volume:"), std::string::npos);
  EXPECT_EQ(flags.find("Odd-name:"), std::string::npos);
}

TEST(Report, ShowsLayersAndTheGridOfThickness) {
  TemporaryFolder folder;
  ASSERT_EQ(explica({"phantom", "shell", "--size", "20", "--out", folder / "p"}).exitCode, 0);
  const auto made = explica({"thickness", folder / "p/labels.nii.gz", "--inner", "1", "--tissue",
                             "2", "--layers", "2", "--cells", "3", "--out", folder / "t"});
  ASSERT_EQ(made.exitCode, 0) << made;
  ASSERT_EQ(explica({"report", folder / "t"}).exitCode, 0);
  const std::string page = readText(folder / "t/report.html");
  EXPECT_NE(page.find("<b>Layers.</b>"), std::string::npos);
  EXPECT_NE(page.find("Layer 2: "), std::string::npos);
  EXPECT_EQ(countOf(page, "all layers, median"), 2u);
}

TEST(Report, RefusesAFolderWithoutRecords) {
  TemporaryFolder folder;
  const auto report = explica({"report", folder.path().string()});
  EXPECT_EQ(report.exitCode, 2);
  EXPECT_NE(report.err.find("provenance.json"), std::string::npos) << report;
  // Nor one that merely holds such a folder.
  ASSERT_EQ(explica({"phantom", "shell", "--size", "20", "--out", folder / "p"}).exitCode, 0);
  EXPECT_EQ(explica({"report", folder.path().string()}).exitCode, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "report.html"));
}

}  // namespace
}  // namespace explica::testing
