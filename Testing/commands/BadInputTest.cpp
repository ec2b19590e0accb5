// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Wrong inputs: one clear sentence that names the file, exit code 2, nothing written.

#include "BadVolumes.h"
#include "QuickRuns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

namespace explica::testing {
namespace {

/// Says what is wrong with how a command refused; empty if nothing is.  Warnings that came before,
/// such as that a file states no frame, do not count.
std::string faultOfRefusal(const CommandResult& result, const std::string& file,
                           const std::vector<std::string>& message) {
  if (result.exitCode != 2) return "exit code " + std::to_string(result.exitCode) + " instead of 2";
  std::string said = result.err;
  while (said.rfind("warning: ", 0) == 0) said.erase(0, said.find('\n') + 1);
  if (std::count(said.begin(), said.end(), '\n') != 1) return "not one sentence";
  if (said.rfind("error: explica ", 0) != 0) return "does not start with the command";
  if (said.find(file) == std::string::npos) return "does not name " + file;
  for (const auto& part : message) {
    if (said.find(part) == std::string::npos) return "does not say '" + part + "'";
  }
  return "";
}

// ---- commands that read a 3D volume; {file} is the bad one ----

struct VolumeCommand {
  std::string name;
  std::vector<std::string> words;
  std::string accepts = {};  ///< the case that is no fault for this command
};
void PrintTo(const VolumeCommand& command, std::ostream* stream) {
  *stream << command.name;
}

const VolumeCommand kVolumeCommands[] = {
    {"Segment", {"segment", "{file}"}},
    {"Surface", {"surface", "{file}"}},
    {"SurfaceLevel", {"surface", "--inner-level", "{file}"}},
    {"Thickness", {"thickness", "{file}", "--inner", "1", "--tissue", "2"}, "TwoDimensional"},
    {"Run", {"run", "{file}", "--quiet"}},
    {"RunLabels", {"run", "{file}", "--kind", "labels", "--quiet"}},
};

class BadVolumeInput : public ::testing::TestWithParam<std::tuple<VolumeCommand, BadVolume>> {};

TEST_P(BadVolumeInput, IsRefusedInOneSentence) {
  const auto& [command, volume] = GetParam();
  if (command.accepts == volume.name) return;
  TemporaryFolder folder;
  const std::string file = folder / volume.file;
  volume.make(file);
  const auto before = folder.entries();
  auto words = command.words;
  std::replace(words.begin(), words.end(), std::string("{file}"), file);
  const auto result = explica(words + std::vector<std::string>{"--out", folder / "out"});
  EXPECT_EQ(faultOfRefusal(result, file, volume.message), "") << result;
  const auto dry = explica(words + std::vector<std::string>{"--dry-run", "--out", folder / "out"});
  EXPECT_EQ(faultOfRefusal(dry, file, volume.message), "") << dry;
  EXPECT_EQ(folder.entries(), before);
}

INSTANTIATE_TEST_SUITE_P(Table, BadVolumeInput,
                         ::testing::Combine(::testing::ValuesIn(kVolumeCommands),
                                            ::testing::ValuesIn(badVolumes())),
                         [](const auto& row) {
                           return std::get<0>(row.param).name + std::get<1>(row.param).name;
                         });

// ---- a study keeps the refusal as a row ----

class BadVolumeInStudy : public ::testing::TestWithParam<BadVolume> {};

TEST_P(BadVolumeInStudy, IsAProblemInOneSentence) {
  const BadVolume& volume = GetParam();
  TemporaryFolder folder;
  writeText(folder / "dataset_description.json", R"({"Name": "a", "BIDSVersion": "1.8.0"})");
  const std::filesystem::path anat = folder / "sub-01/anat";
  std::filesystem::create_directories(anat);
  const bool packed = volume.file.ends_with(".gz");
  const std::string file = anat / (packed ? "sub-01_dseg.nii.gz" : "sub-01_dseg.nii");
  volume.make(file);
  const auto result = explica({"bids", folder.path().string(), folder / "out", "participant",
                               "--hemisphere", "L", "--quiet"});
  EXPECT_EQ(result.exitCode, 2) << result;
  const std::string problem = readText(folder / "out/runs/sub-01_hemi-L/problem.txt");
  EXPECT_EQ(std::count(problem.begin(), problem.end(), '\n'), 1) << problem;
  EXPECT_NE(problem.find(volume.name == "Missing" ? anat.string() : file), std::string::npos)
      << problem;
  if (volume.name != "Missing") {
    for (const auto& part : volume.message) {
      EXPECT_NE(problem.find(part), std::string::npos) << problem;
    }
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "out/sub-01"));
  ASSERT_EQ(explica({"bids", folder.path().string(), folder / "out", "group"}).exitCode, 0);
  EXPECT_NE(readText(folder / "out/study.tsv").find("sub-01\tL\tfailed: "), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Table, BadVolumeInStudy, ::testing::ValuesIn(badVolumes()),
                         [](const auto& row) { return row.param.name; });

// ---- commands that read a surface; {file} is the bad one ----

struct BadSurface {
  std::string name;
  std::string file;
  std::string text;  ///< of the file; empty: there is none
  std::vector<std::string> message;
};
void PrintTo(const BadSurface& surface, std::ostream* stream) {
  *stream << surface.name;
}

/// A tetrahedron of 10 mm as OFF, which the cases below damage.
const std::string kVertices = "0 0 0\n10 0 0\n0 10 0\n0 0 10\n";
const std::string kFaces = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

const BadSurface kBadSurfaces[] = {
    {"Missing", "absent.surf.gii", "", {"no such file"}},
    {"NotASurface", "letter.surf.gii", "Dear reader, this is a letter.\n", {}},
    {"Truncated", "cut.off", "OFF\n4 4 0\n" + kVertices + "3 0 2 1\n3 0 1", {}},
    {"TruncatedGifti", "cut.surf.gii", "<?xml version=\"1.0\"?>\n<GIFTI Version=\"1.0\"><Data", {}},
    {"IndexOutOfRange",
     "range.off",
     "OFF\n4 4 0\n" + kVertices + "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 9\n",
     {}},
    {"NotANumber", "nan.off", "OFF\n4 4 0\n0 0 0\nnan 0 0\n0 10 0\n0 0 10\n" + kFaces, {}},
    {"NoFaces", "points.off", "OFF\n4 0 0\n" + kVertices, {}},
    {"NonManifold",
     "fan.off",
     "OFF\n5 5 0\n" + kVertices + "5 5 5\n" + kFaces + "3 1 2 4\n",
     {"manifold"}},
    {"Inconsistent",
     "turned.off",
     "OFF\n4 4 0\n" + kVertices + "3 0 1 2\n3 0 1 3\n3 0 3 2\n3 1 2 3\n",
     {}},
};

const VolumeCommand kPolygonCommands[] = {
    {"Polygon", {"polygon", "{file}", "--viewpoint", "0,100"}},
    {"Embed", {"embed", "{file}"}},
};

const VolumeCommand kSurfaceCommands[] = {
    {"Repair", {"repair", "{file}"}},
    {"Unfold", {"unfold", "{file}", "--vertex", "0", "--radius", "5", "--direction", "0,0,1"}},
    {"Flatten", {"flatten", "{file}"}},
    {"Compare", {"compare", "{file}", "{file}"}},
    {"Inflate", {"inflate", "{file}"}},
    {"Smooth", {"smooth", "{file}", "--surface", "{file}", "--fwhm", "3"}},
    {"Sphere", {"sphere", "{file}"}},
};

const BadSurface kBadPolygons[] = {
    {"Missing", "absent.csv", "", {"no such file"}},
    {"NotAPolygon", "letter.csv", "Dear reader, this is a letter.\n", {}},
    {"TwoVertices", "edge.csv", "x,y\n0,0\n1,0\n", {}},
    {"NotANumber", "nan.csv", "x,y\n0,0\n1,0\nnan,1\n0,1\n", {}},
};

class BadSurfaceInput : public ::testing::TestWithParam<std::tuple<VolumeCommand, BadSurface>> {};

TEST_P(BadSurfaceInput, IsRefusedInOneSentence) {
  const auto& [command, surface] = GetParam();
  TemporaryFolder folder;
  const std::string file = folder / surface.file;
  if (!surface.text.empty()) writeText(file, surface.text);
  const auto before = folder.entries();
  auto words = command.words;
  std::replace(words.begin(), words.end(), std::string("{file}"), file);
  const auto result = explica(words + std::vector<std::string>{"--out", folder / "out"});
  EXPECT_EQ(faultOfRefusal(result, file, surface.message), "") << result;
  EXPECT_EQ(folder.entries(), before);
}

INSTANTIATE_TEST_SUITE_P(Table, BadSurfaceInput,
                         ::testing::Combine(::testing::ValuesIn(kSurfaceCommands),
                                            ::testing::ValuesIn(kBadSurfaces)),
                         [](const auto& row) {
                           return std::get<0>(row.param).name + std::get<1>(row.param).name;
                         });

INSTANTIATE_TEST_SUITE_P(Polygons, BadSurfaceInput,
                         ::testing::Combine(::testing::ValuesIn(kPolygonCommands),
                                            ::testing::ValuesIn(kBadPolygons)),
                         [](const auto& row) {
                           return std::get<0>(row.param).name + std::get<1>(row.param).name;
                         });

// ---- readable files that do not suit what is asked of them ----

struct Unsuitable {
  std::string name;
  std::vector<std::vector<std::string>> before;
  std::vector<std::string> words;
  std::string file;  ///< that the sentence must name
  std::vector<std::string> message;
  std::function<void(const TemporaryFolder&)> prepare = {};
};
void PrintTo(const Unsuitable& row, std::ostream* stream) {
  *stream << row.name;
}

const std::vector<std::string> kShell = {"phantom", "shell", "--size",
                                         "16",      "--out", "{folder}/shell"};
const std::string kLabels = "{folder}/shell/labels.nii.gz";

const Unsuitable kUnsuitable[] = {
    {"TissueLabelAbsent",
     {kShell},
     {"thickness", kLabels, "--inner", "1", "--tissue", "7"},
     kLabels,
     {"7"}},
    {"InnerLabelAbsent",
     {kShell},
     {"thickness", kLabels, "--inner", "9", "--tissue", "2"},
     kLabels,
     {"9"}},
    {"TissueMissesTheOuterSide",
     {kShell},
     {"thickness", kLabels, "--inner", "0,1", "--tissue", "2"},
     kLabels,
     {"outer"}},
    {"HeartWithoutClearLabels",
     {kShell},
     {"heart", kLabels, "--cavity", "1", "--wall", "9"},
     kLabels,
     {"9", "wall"}},
    {"WhiteLabelAbsent",
     {kShell},
     {"surface", kLabels, "--white-label", "8", "--grey-label", "2"},
     kLabels,
     {"8"}},
    {"FractionsAreNoLabels",
     {kShell},
     {"thickness", "{folder}/shell/harmonic.nii.gz", "--inner", "1", "--tissue", "2"},
     "{folder}/shell/harmonic.nii.gz",
     {"whole"}},
    {"FolderOfNoSubject",
     {kShell},
     {"run", "{folder}/shell"},
     "{folder}/shell",
     {"mri/ribbon.mgz", "anat"}},
    {"LabelsOfAHeartAreNoCortex",
     {{"phantom", "ventricle", "--size", "64", "--spacing", "2", "--slice", "8", "--frames", "2",
       "--out", "{folder}/beat"}},
     {"run", "{folder}/beat/frame-0000.nii.gz"},
     "",
     {"thick slices, as of a heart"}},
    {"FreeSurferSubjectHalfDone",
     {},
     {"run", "{folder}/bert"},
     "{folder}/bert",
     {"recon-all"},
     [](const TemporaryFolder& folder) {
       std::filesystem::create_directories(folder / "bert/mri");
       writeText(folder / "bert/mri/nu.mgz", "not yet");
     }},
    {"OpenSurfaceWhereClosedIsNeeded",
     {},
     {"surface", "--white-surface", "{folder}/open.off", "--pial-surface", "{folder}/open.off"},
     "{folder}/open.off",
     {"boundary"},
     [](const TemporaryFolder& folder) {
       writeText(folder / "open.off", "OFF\n4 3 0\n" + kVertices + "3 0 2 1\n3 0 1 3\n3 0 3 2\n");
     }},
    {"PialOfOtherFaces",
     {},
     {"surface", "--white-surface", "{folder}/sphere.surf.gii", "--pial-surface",
      "{folder}/four.off"},
     "{folder}/four.off",
     {"same faces", "642", "(4, 4)"},
     [](const TemporaryFolder& folder) {
       writeFoldedSphere(folder);
       writeText(folder / "four.off", "OFF\n4 4 0\n" + kVertices + kFaces);
     }},
    {"ParcellationOfAnotherSurface",
     {},
     {"surface", "--white-surface", "{folder}/sphere.surf.gii", "--pial-surface",
      "{folder}/sphere.surf.gii", "--parcellation", "{folder}/lh.label"},
     "{folder}/lh.label",
     {"642"},
     [](const TemporaryFolder& folder) {
       writeFoldedSphere(folder);
       writeText(folder / "lh.label", "#!ascii label\n2\n0 0 0 0 0\n9999 1 1 1 0\n");
     }},
    {"LabelOfAnotherSurface",
     {},
     {"unfold", "{folder}/sphere.surf.gii", "--label", "{folder}/lh.label", "--direction", "0,0,1"},
     "{folder}/lh.label",
     {"642"},
     [](const TemporaryFolder& folder) {
       writeFoldedSphere(folder);
       writeText(folder / "lh.label", "#!ascii label\n2\n0 0 0 0 0\n9999 1 1 1 0\n");
     }},
    {"LabelsToSmooth",
     {},
     {"smooth", "{folder}/lh.regions.label.gii", "--surface", "{folder}/white.surf.gii", "--fwhm",
      "3"},
     "{folder}/lh.regions.label.gii",
     {"not labels"},
     writeMapAndRegions},
    {"MapOfAnotherSphere",
     {},
     {"resample", "{folder}/lh.regions.label.gii", "--from", "{folder}/crossed.surf.gii", "--to",
      "fsaverage3"},
     "{folder}/lh.regions.label.gii",
     {"642", "1284"},
     writeMapAndRegions},
    {"FolderWhereASphereIsNeeded",
     {},
     {"register", "{folder}/maps", "--template", "fsaverage"},
     "{folder}/maps",
     {"is a folder", "maps/white.surf.gii"},
     [](const TemporaryFolder& folder) {
       std::filesystem::create_directory(folder / "maps");
       writeText(folder / "maps/white.surf.gii", "-");
     }},
    {"NeitherTargetNorFile",
     {},
     {"resample", "{folder}/thickness.shape.gii", "--from", "{folder}/white.surf.gii", "--to",
      "fsaverage9"},
     "fsaverage9",
     {"fsaverage3"},
     writeMapAndRegions},
    {"RegionsOfTheOtherHemisphere",
     {},
     {"regions", "{folder}", "--hemisphere", "R", "--atlas", "{folder}/lh.regions.label.gii"},
     "{folder}/lh.regions.label.gii",
     {"left", "right"},
     writeMapAndRegions},
    {"RegionsOfAnotherMesh",
     {},
     {"regions", "{folder}", "--atlas", "{folder}/lh.regions.label.gii"},
     "{folder}/lh.regions.label.gii",
     {"explica resample"},
     [](const TemporaryFolder& folder) {
       writeMapAndRegions(folder);
       io::LabelMap regions{"regions", {}, {{1, "front"}}};
       regions.keys.setOnes(12);
       io::writeGiftiLabel(folder / "lh.regions.label.gii", regions, "CortexLeft");
     }},
    {"FolderWithoutAreas",
     {},
     {"regions", "{folder}/empty", "--atlas", "{folder}/lh.regions.label.gii"},
     "{folder}/empty",
     {"?h.white", "?h.area"},
     [](const TemporaryFolder& folder) {
       writeMapAndRegions(folder);
       std::filesystem::create_directory(folder / "empty");
     }},
    {"LegendWithoutNames",
     {kShell},
     {"surface", kLabels, "--white-label", "1", "--grey-label", "2", "--faces", "1000", "--atlas",
      kLabels, "--atlas-legend", "{folder}/legend.txt"},
     "{folder}/legend.txt",
     {"line 2"},
     [](const TemporaryFolder& folder) {
       writeText(folder / "legend.txt", "1 inside\ntwo tissue\n");
     }},
};

class UnsuitableInput : public ::testing::TestWithParam<Unsuitable> {};

TEST_P(UnsuitableInput, IsRefusedInOneSentence) {
  TemporaryFolder folder;
  if (GetParam().prepare) GetParam().prepare(folder);
  for (const auto& line : GetParam().before) {
    const auto made = explica(filled(line, folder));
    ASSERT_EQ(made.exitCode, 0) << made;
  }
  const auto before = folder.entries();
  const auto result = explica(filled(GetParam().words, folder) +
                              std::vector<std::string>{"--quiet", "--out", folder / "out"});
  EXPECT_EQ(faultOfRefusal(result, filled({GetParam().file}, folder)[0], GetParam().message), "")
      << result;
  EXPECT_EQ(folder.entries(), before);
}

INSTANTIATE_TEST_SUITE_P(Table, UnsuitableInput, ::testing::ValuesIn(kUnsuitable),
                         [](const auto& row) { return row.param.name; });

}  // namespace
}  // namespace explica::testing
