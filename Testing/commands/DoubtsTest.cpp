// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// What of an input is cut, guessed or contradicted is a number in summary.json, a warning where it
// is not 0, and a line of the report.

#include "Explica/Geometry/Fixtures.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Provenance/Doubts.h"
#include "Explica/Testing/Command.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

namespace explica::testing {
namespace {

using provenance::Doubt;
using provenance::kDoubts;

/// Labels of a function of the voxel.
template <class Function>
Volume<Label> labelsOf(const std::array<int, 3>& size, const Function& labelAt) {
  Grid grid;
  grid.size = size;
  Volume<Label> labels(grid);
  for (std::size_t v = 0; v < labels.size(); ++v) labels[v] = labelAt(grid.subscripts(v));
  return labels;
}

/// Layers along k: 1 below, 2 from 3 to 5, 3 above.
Volume<Label> slab() {
  return labelsOf({12, 10, 9}, [](const std::array<int, 3>& at) {
    return at[2] < 3 ? 1 : at[2] < 6 ? 2 : 3;
  });
}

/// White balls of radius 9 about (15, 16, 16) and, if wanted, (33, 16, 16), which a bridge joins,
/// in grey shells of 3 voxels; fluid around.
Volume<Label> balls(bool two) {
  return labelsOf({48, 32, 32}, [two](const std::array<int, 3>& at) {
    const Vector p(at[0], at[1], at[2]);
    double r = (p - Vector(15, 16, 16)).norm();
    if (two) r = std::min(r, (p - Vector(33, 16, 16)).norm());
    const bool bridge = two && std::hypot(p.y() - 16, p.z() - 16) < 3 && p.x() > 15 && p.x() < 33;
    return bridge || r < 9 ? 3 : r < 12 ? 2 : 1;
  });
}

class Doubts : public ::testing::Test {
 protected:
  /// Runs a command; the number under a key of its summary.
  int numberAfter(std::vector<std::string> words, const char* key) {
    words.insert(words.end(), {"--force", "--out", folder_ / "out"});
    last_ = explica(words);
    EXPECT_TRUE(last_.exitCode == 0 || last_.exitCode == 3) << last_;
    return readJson(folder_ / "out/summary.json").value(key, -1);
  }

  /// Whether a sentence of the last command's warnings holds these words.
  [[nodiscard]] bool warned(const std::string& words) const {
    const auto summary = readJson(folder_ / "out/summary.json");
    for (const auto& warning : summary["warnings"]) {
      if (warning.get<std::string>().find(words) != std::string::npos) return true;
    }
    return false;
  }

  /// Overwrites bytes of a file.
  template <class T>
  void patch(const std::string& name, std::streamoff at, T value) const {
    std::fstream file(folder_ / name, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(at);
    file.write(reinterpret_cast<const char*>(&value), sizeof value);
  }

  [[nodiscard]] std::vector<std::string> thickness(const std::string& name) const {
    return {"thickness", folder_ / name, "--inner", "1", "--tissue", "2", "--sulci", "ignore"};
  }

  TemporaryFolder folder_;
  CommandResult last_;
};

TEST_F(Doubts, TissueInTheOutermostLayerOfTheImageIsCounted) {
  io::writeVolume(folder_ / "slab.nii", slab());
  // Three layers, each with the 2 (12 + 10) - 4 voxels of its outline.
  EXPECT_EQ(numberAfter(thickness("slab.nii"), provenance::kTissueAtImageBorder), 120);
  EXPECT_TRUE(warned("120 of 360 tissue voxels")) << last_;
  io::writeVolume(folder_ / "ball.nii", labelsOf({16, 16, 16}, [](const std::array<int, 3>& at) {
                    const double r = Vector(at[0] - 8, at[1] - 8, at[2] - 8).norm();
                    return r < 3 ? 1 : r < 6 ? 2 : 3;
                  }));
  EXPECT_EQ(numberAfter(thickness("ball.nii"), provenance::kTissueAtImageBorder), 0);
  EXPECT_FALSE(warned("outermost")) << last_;
}

TEST_F(Doubts, ACutBetweenHemispheresThatNoLabelDrawsIsCounted) {
  io::writeVolume(folder_ / "two.nii.gz", balls(true));
  EXPECT_GT(numberAfter({"surface", folder_ / "two.nii.gz", "--hemisphere", "L", "--faces", "1000"},
                        provenance::kHemisphereCutByGuess),
            10);
  EXPECT_TRUE(warned("no label parts the hemispheres")) << last_;
  io::writeVolume(folder_ / "one.nii.gz", balls(false));
  EXPECT_EQ(numberAfter({"surface", folder_ / "one.nii.gz", "--faces", "1000"},
                        provenance::kHemisphereCutByGuess),
            0);
}

TEST_F(Doubts, LabelsThatThePresetDoesNotKnowAreCounted) {
  Volume<Label> labels = balls(false);
  io::writeVolume(folder_ / "known.nii.gz", labels);
  EXPECT_EQ(numberAfter({"surface", folder_ / "known.nii.gz", "--faces", "1000"},
                        provenance::kLabelsUnknown),
            0);
  labels(1, 1, 1) = 7;
  labels(2, 1, 1) = 9;
  io::writeVolume(folder_ / "unknown.nii.gz", labels);
  EXPECT_EQ(numberAfter({"surface", folder_ / "unknown.nii.gz", "--preset", "three-class",
                         "--faces", "1000"},
                        provenance::kLabelsUnknown),
            2);
  EXPECT_TRUE(warned("no label 7, 9")) << last_;
}

TEST_F(Doubts, HeadersThatContradictThemselvesAreCounted) {
  io::writeVolume(folder_ / "slab.nii", slab());
  EXPECT_EQ(numberAfter(thickness("slab.nii"), provenance::kHeadersDisagree), 0);
  constexpr std::streamoff kRowX = 280;  // of a NIfTI-1 header's sform: four float32
  patch("slab.nii", kRowX + 12, 5.0F);   // moves the voxels by 5 mm
  std::vector<std::string> words = thickness("slab.nii");
  words.insert(words.end(), {"--xform", "sform"});
  EXPECT_EQ(numberAfter(words, provenance::kHeadersDisagree), 1);
  EXPECT_TRUE(warned("place the voxels differently (by up to 5")) << last_;
}

TEST_F(Doubts, PlacementsThatNoHeaderStatesAreCounted) {
  io::writeVolume(folder_ / "slab.nii", slab());
  EXPECT_EQ(numberAfter(thickness("slab.nii"), provenance::kPlacementsAssumed), 0);
  constexpr std::streamoff kCodes = 252;  // of a NIfTI-1 header's qform and sform: two int16
  patch("slab.nii", kCodes, std::int32_t{0});
  std::vector<std::string> words = thickness("slab.nii");
  words.insert(words.end(), {"--xform", "none"});
  EXPECT_EQ(numberAfter(words, provenance::kPlacementsAssumed), 1);
  EXPECT_TRUE(warned("does not say where the voxels lie")) << last_;
}

TEST_F(Doubts, SurfacesThatStateNoFrameAreCounted) {
  const TriangleMesh sphere = geometry::makeIcosphere(2, 10.0);
  io::writeSurface(folder_ / "a.off", sphere);
  io::writeSurface(folder_ / "b.surf.gii", sphere);
  const auto compare = [&](const char* after) {
    return std::vector<std::string>{"compare", folder_ / "b.surf.gii", folder_ / after, "--pairs",
                                    "20"};
  };
  EXPECT_EQ(numberAfter(compare("a.off"), provenance::kFramesNotStated), 1);
  EXPECT_TRUE(warned("coordinate system unknown")) << last_;
  EXPECT_EQ(numberAfter(compare("b.surf.gii"), provenance::kFramesNotStated), 0);
  // A file that is read twice is warned of once.
  EXPECT_GT(numberAfter({"compare", folder_ / "a.off", folder_ / "a.off", "--pairs", "20"},
                        provenance::kFramesNotStated),
            0);
  const std::size_t first = last_.err.find("coordinate system unknown");
  ASSERT_NE(first, std::string::npos) << last_;
  EXPECT_EQ(last_.err.find("coordinate system unknown", first + 1), std::string::npos) << last_;
}

TEST_F(Doubts, InputsChangedSinceTheirRecordAreCounted) {
  ASSERT_EQ(explica({"phantom", "shell", "--size", "16", "--out", folder_ / "shell"}).exitCode, 0);
  EXPECT_EQ(numberAfter(thickness("shell/labels.nii.gz"), provenance::kInputsChanged), 0);
  Volume<Label> labels = io::readLabels(folder_ / "shell/labels.nii.gz").volume;
  labels(0, 0, 0) = 5;
  io::writeVolume(folder_ / "shell/labels.nii.gz", labels);
  EXPECT_EQ(numberAfter(thickness("shell/labels.nii.gz"), provenance::kInputsChanged), 1);
  EXPECT_TRUE(warned("was changed since")) << last_;
}

TEST_F(Doubts, EachIsALineOfTheReport) {
  io::writeVolume(folder_ / "slab.nii", slab());
  ASSERT_EQ(numberAfter(thickness("slab.nii"), provenance::kTissueAtImageBorder), 120);
  ASSERT_EQ(explica({"report", folder_ / "out", "--page", folder_ / "page.html"}).exitCode, 0);
  const std::string page = readText(folder_ / "page.html");
  EXPECT_NE(page.find("120 voxels of tissue in the outermost layer"), std::string::npos);
  auto summary = readJson(folder_ / "out/summary.json");
  int count = 2;
  for (const Doubt& doubt : kDoubts) summary[doubt.key] = count++;
  writeText(folder_ / "out/summary.json", summary.dump());
  ASSERT_EQ(explica({"report", folder_ / "out", "--page", folder_ / "page.html"}).exitCode, 0);
  const std::string all = readText(folder_ / "page.html");
  count = 2;
  for (const Doubt& doubt : kDoubts) {
    EXPECT_NE(all.find(std::to_string(count++) + " " + doubt.meaning), std::string::npos)
        << doubt.key;
  }
}

}  // namespace
}  // namespace explica::testing
