// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Left is left, and a map is of its surface's mesh: files that do not belong together are refused
// with both names.  The pairs of options are taken from `explica --describe`.

#include "DescribedCommands.h"
#include "QuickRuns.h"

#include "Explica/IO/VertexDataFile.h"

#include <gtest/gtest.h>

namespace explica::testing {
namespace {

bool isOnVertices(const Json& parameter) {
  const Json& kind = parameter["file"];
  return kind == "surface" || kind == "vertex data" || kind == "vertex labels" ||
         parameter["one_by_one"].get<bool>();
}

/// A file that states its hemisphere by its name.
std::string fileOf(const TemporaryFolder& folder, const Json& parameter, const std::string& side) {
  const Json& kind = parameter["file"];
  const std::string name =
      parameter["name"].get<std::string>() + (kind == "vertex data"     ? ".shape.gii"
                                              : kind == "vertex labels" ? ".label.gii"
                                                                        : ".off");
  const std::string file = folder / (side + "." + name);
  if (kind == "vertex data") {
    io::writeGiftiShape(file, {{"a", "", Eigen::VectorXd::Ones(12)}}, "Other");
  } else if (kind == "vertex labels") {
    io::writeGiftiLabel(file, {"a", Eigen::VectorXi::Ones(12), {{1, "one", {}}}}, "Other");
  } else {
    io::writeSurface(file, geometry::makeIcosphere(0, 10.0));
  }
  return file;
}

/// What a parameter that must be given takes.
std::string givenFor(const TemporaryFolder& folder, const Json& parameter) {
  return parameter["file"].is_null() ? valueFor(parameter) : fileOf(folder, parameter, "lh");
}

/// Whether a folder must be given, whose files are found by their names only.
bool needsFolder(const Json& command) {
  const Json& all = command["parameters"];
  return std::any_of(all.begin(), all.end(), [](const Json& p) {
    return p["file"] == "folder" && p["required"].get<bool>();
  });
}

void append(std::vector<std::string>& words, const Json& parameter, const std::string& value) {
  if (!parameter["positional"].get<bool>()) {
    words.push_back("--" + parameter["name"].get<std::string>());
  }
  words.push_back(value);
}

/// The command with a left file for one option and a right one for the other, and what else it must
/// be given.
std::vector<std::string> wordsFor(const TemporaryFolder& folder, const Json& command,
                                  const Json& left, const Json& right) {
  std::vector<std::string> words = wordsOf(command);
  std::set<std::string> given;
  for (const Json& p : command["parameters"]) {
    const bool isLeft = p["name"] == left["name"], isRight = p["name"] == right["name"];
    if (!isLeft && !isRight && !p["required"].get<bool>()) continue;
    given.insert(p["name"]);
    if (isLeft || !isRight) append(words, p, givenFor(folder, p));
    if (isRight) append(words, p, fileOf(folder, p, "rh"));
  }
  for (const Json* p : {&left, &right}) {
    for (const Json& name : (*p)["needs"]) {
      const Json& needed = parameterOf(command, name);
      if (needed.is_null() || needed["file"].is_null() || !given.insert(name).second) continue;
      append(words, needed, fileOf(folder, needed, "lh"));
    }
    appendNeeds(words, command, *p, given);
  }
  if (command["writes_folder"].get<bool>()) {
    words.push_back("--out");
    words.push_back(folder / "out");
  }
  return words;
}

bool exclude(const Json& one, const Json& other) {
  for (const Json& name : one["excludes"]) {
    if (name == other["name"]) return true;
  }
  return false;
}

/// True if what one needs excludes the other: an option, or its value.
bool excludeByNeeds(const Json& command, const Json& one, const Json& other) {
  const std::string otherName = other["name"];
  for (const Json& name : one["needs"]) {
    const std::string condition = name, option = condition.substr(0, condition.find('='));
    if (option != condition && option == otherName) return true;
    for (const std::string needed : other["needs"]) {
      if (needed.starts_with(option + "=") && needed != condition) return true;
    }
    const Json& needed = parameterOf(command, name);
    if (!needed.is_null() && (exclude(needed, other) || exclude(other, needed))) return true;
  }
  return false;
}

TEST(LeftIsLeft, ForEveryPairOfOptionsOfEveryCommand) {
  std::size_t tried = 0;
  for (const Json& command : describedCommands()) {
    if (!command["files_meet"].get<bool>() || needsFolder(command)) continue;
    for (const Json& left : command["parameters"]) {
      for (const Json& right : command["parameters"]) {
        if (!isOnVertices(left) || !isOnVertices(right) || exclude(left, right)) continue;
        if (excludeByNeeds(command, left, right) || excludeByNeeds(command, right, left)) continue;
        if (left["name"] > right["name"]) continue;  // tried the other way round
        const bool same = left["name"] == right["name"];
        if (same && (!left["list"].get<bool>() || left["one_by_one"].get<bool>())) continue;
        if (!left["side"].is_null() || !right["side"].is_null()) continue;
        const TemporaryFolder folder;
        const auto words = wordsFor(folder, command, left, right);
        const auto before = folder.entries();
        const auto result = explica(words);
        EXPECT_EQ(result.exitCode, 2) << command["command"] << " " << result;
        for (const char* part : {"/lh.", "/rh.", "left hemisphere", "--accept hemisphere"}) {
          EXPECT_NE(result.err.find(part), std::string::npos) << part << result;
        }
        EXPECT_EQ(folder.entries(), before);
        ++tried;
      }
    }
  }
  EXPECT_GT(tried, 40U);
}

TEST(LeftIsLeft, ForOptionsOfOneSide) {
  const TemporaryFolder folder;
  std::size_t tried = 0;
  for (const Json& command : describedCommands()) {
    for (const Json& p : command["parameters"]) {
      if (p["side"].is_null()) continue;
      const bool left = p["side"] == "left";
      std::vector<std::string> words = wordsOf(command);
      append(words, p, fileOf(folder, p, left ? "rh" : "lh"));
      const auto result = explica(words + std::vector<std::string>{"--out", folder / "out"});
      EXPECT_EQ(result.exitCode, 2) << result;
      EXPECT_NE(result.err.find(left ? "of the right hemisphere" : "of the left hemisphere"),
                std::string::npos)
          << result;
      ++tried;
    }
  }
  EXPECT_GE(tried, 4U);
}

/// Both hemispheres as `explica surface` leaves them: equal names, the side in the file.
void writeHemispheres(const TemporaryFolder& folder) {
  for (const std::string side : {"L", "R"}) {
    const std::string structure = side == "L" ? "CortexLeft" : "CortexRight";
    const std::filesystem::path out = folder / side;
    std::filesystem::create_directories(out);
    io::SurfaceMetadata metadata;
    metadata.structure = structure;
    for (const auto& [name, radius] : {std::pair{"white", 30.0}, {"pial", 33.0}}) {
      io::writeGiftiSurface(out / (std::string(name) + ".surf.gii"),
                            geometry::makeFoldedSphere(3, radius), metadata);
    }
    const Eigen::VectorXd map =
        (geometry::makeFoldedSphere(3, 30.0).positions.col(2).array() > 10).cast<double>();
    io::writeGiftiShape(out / "map.shape.gii", {{"a", "", map}}, structure);
    io::writeGiftiLabel(out / "regions.label.gii",
                        {"a", map.cast<int>(), {{0, "none", {}}, {1, "one", {}}}}, structure);
  }
  Grid grid;
  grid.size = {30, 30, 30};
  grid.spacing = {3, 3, 3};
  grid.origin = {-45, -45, -45};
  Volume<float> image(grid);
  for (std::size_t v = 0; v < image.size(); ++v) image[v] = static_cast<float>(v % 101);
  io::writeVolume(folder / "image.nii.gz", image);
}

struct Swap {
  std::string name;
  std::vector<std::string> words;
  bool writesFolder = true;
};
void PrintTo(const Swap& row, std::ostream* stream) {
  *stream << row.name;
}

const Swap kSwaps[] = {
    {"Cifti", {"cifti", "--left", "{L}/map.shape.gii", "--right", "{L}/map.shape.gii"}},
    {"CiftiCortex", {"cifti", "--left", "{L}/map.shape.gii", "--left-cortex", "{R}/map.shape.gii"}},
    {"SampleFolderAndLabels",
     {"sample", "{image}", "--surfaces", "{L}", "--labels", "{R}/regions.label.gii"}},
    {"SampleFolderAndHemisphere", {"sample", "{image}", "--surfaces", "{L}", "--hemisphere", "R"}},
    {"ViewMap",
     {"view", "{L}/pial.surf.gii", "--map", "{R}/map.shape.gii", "--screenshot", "{out}.png",
      "--width", "60", "--height", "60"},
     false},
    {"Compare", {"compare", "{L}/pial.surf.gii", "{R}/white.surf.gii", "--pairs", "20"}},
    {"Resample",
     {"resample", "{L}/map.shape.gii", "--from", "{R}/white.surf.gii", "--to", "fsaverage3"}},
    {"FlattenCuts", {"flatten", "{L}/pial.surf.gii", "--cuts", "{R}/regions.label.gii"}},
};

class SwappedSides : public ::testing::TestWithParam<Swap> {};

TEST_P(SwappedSides, AreRefusedAndCanBeAccepted) {
  const TemporaryFolder folder;
  writeHemispheres(folder);
  std::vector<std::string> words = GetParam().words;
  for (std::string& word : words) {
    if (word == "{image}") word = folder / "image.nii.gz";
    if (word == "{L}" || word == "{R}") word = folder / word.substr(1, 1);
    if (word.starts_with("{L}/") || word.starts_with("{R}/")) {
      word = folder / (word.substr(1, 1) + word.substr(3));
    }
    if (word == "{out}.png") word = folder / "out.png";
  }
  if (GetParam().writesFolder) words = words + std::vector<std::string>{"--out", folder / "out"};
  const auto before = folder.entries();
  const auto refused = explica(words);
  EXPECT_EQ(refused.exitCode, 2) << refused;
  for (const char* part : {"left", "right", "--accept hemisphere goes on"}) {
    EXPECT_NE(refused.err.find(part), std::string::npos) << refused;
  }
  EXPECT_EQ(folder.entries(), before);
  const auto accepted = explica(words + std::vector<std::string>{"--accept", "hemisphere"});
  EXPECT_TRUE(accepted.exitCode == 0 || accepted.exitCode == 3) << accepted;
  EXPECT_NE(accepted.err.find("; accepted"), std::string::npos) << accepted;
  if (!GetParam().writesFolder) return;
  EXPECT_GE(readJson(folder / "out/summary.json")["inputs_contradict"].get<int>(), 1);
}

INSTANTIATE_TEST_SUITE_P(Table, SwappedSides, ::testing::ValuesIn(kSwaps),
                         [](const auto& row) { return row.param.name; });

TEST(Meeting, MapsOfBothSidesInOneFileHaveOneName) {
  TemporaryFolder folder;
  writeHemispheres(folder);
  const auto joined = [&](const std::string& name, const char* out) {
    const Eigen::VectorXd values = io::readVertexMaps(folder / "R/map.shape.gii").front().values;
    io::writeGiftiShape(folder / "R/map.shape.gii", {{name, "", values}}, "CortexRight");
    return explica({"cifti", "--left", folder / "L/map.shape.gii", "--right",
                    folder / "R/map.shape.gii", "--out", folder / out});
  };
  EXPECT_EQ(joined("rh.a", "same").err.find("'rh.a' on the right"), std::string::npos);
  const auto other = joined("b", "other");
  EXPECT_EQ(other.exitCode, 0) << other;
  EXPECT_NE(other.err.find("map 1 is 'a' on the left and 'b' on the right"), std::string::npos)
      << other;
}

TEST(Meeting, MapsOfAnotherMeshWithTheSameCountAreKnownByTheirRecord) {
  const TemporaryFolder folder;
  for (const char* size : {"20", "24"}) {
    const std::string name = std::string("shell") + size;
    ASSERT_EQ(explica({"phantom", "shell", "--size", size, "--out", folder / name}).exitCode, 0);
    ASSERT_EQ(explica({"surface", folder / (name + "/labels.nii.gz"), "--white-label", "1",
                       "--grey-label", "2", "--faces", "2000", "--out",
                       folder / ("of" + std::string(size))})
                  .exitCode,
              0);
  }
  const auto view = [&](const std::string& surface, const std::string& map) {
    return std::vector<std::string>{"view",         folder / surface,
                                    "--map",        folder / map,
                                    "--screenshot", folder / "out.png",
                                    "--width",      "60",
                                    "--height",     "60"};
  };
  const auto wrong = view("of20/pial.surf.gii", "of24/thickness.shape.gii");
  const auto refused = explica(wrong);
  EXPECT_EQ(refused.exitCode, 2) << refused;
  EXPECT_NE(refused.err.find("was not made for the mesh of"), std::string::npos) << refused;
  EXPECT_FALSE(std::filesystem::exists(folder / "out.png"));
  EXPECT_EQ(explica(wrong + std::vector<std::string>{"--accept", "mesh"}).exitCode, 0);
  const auto unknown = explica(wrong + std::vector<std::string>{"--accept", "everything"});
  EXPECT_EQ(unknown.exitCode, 1) << unknown;

  // What belongs together still meets: beside each other, and over several commands.
  EXPECT_EQ(explica(view("of20/white.surf.gii", "of20/thickness.shape.gii")).exitCode, 0);
  ASSERT_EQ(
      explica({"repair", folder / "of20/pial.surf.gii", "--out", folder / "repaired"}).exitCode, 0);
  const auto far = explica(view("repaired/pial.surf.gii", "of20/thickness.shape.gii"));
  EXPECT_EQ(far.exitCode, 0) << far;
  const auto farWrong = explica(view("repaired/pial.surf.gii", "of24/thickness.shape.gii"));
  EXPECT_EQ(farWrong.exitCode, 2) << farWrong;
}

// ---- no argument is ignored ----

/// A value that an option would take.
std::vector<std::string> given(const Json& p) {
  const std::string name = "--" + p["name"].get<std::string>();
  return p["type"] == "flag" ? std::vector<std::string>{name}
                             : std::vector<std::string>{name, valueFor(p)};
}

std::vector<std::string> withRequired(const Json& command) {
  std::vector<std::string> words = wordsOf(command);
  for (const Json& p : command["parameters"]) {
    if (p["required"].get<bool>()) append(words, p, p["file"].is_null() ? valueFor(p) : "absent");
  }
  return words;
}

TEST(NoArgumentIsIgnored, BesideOneThatExcludesIt) {
  std::size_t tried = 0;
  for (const Json& command : describedCommands()) {
    for (const Json& p : command["parameters"]) {
      for (const Json& other : p["excludes"]) {
        const Json& beside = parameterOf(command, other);
        if (beside.is_null() || (p["name"] > other && exclude(beside, p))) continue;
        const auto result = explica(withRequired(command) + given(p) + given(beside));
        EXPECT_EQ(result.exitCode, 1) << command["command"] << result;
        EXPECT_NE(result.err.find("exclude each other: leave one of them out"), std::string::npos)
            << command["command"] << result;
        ++tried;
      }
    }
  }
  EXPECT_GT(tried, 30U);
}

TEST(NoArgumentIsIgnored, WithoutOneThatItNeeds) {
  std::size_t tried = 0;
  for (const Json& command : describedCommands()) {
    for (const Json& p : command["parameters"]) {
      if (p["needs"].empty()) continue;
      std::vector<std::string> words = withRequired(command) + given(p);
      // A condition that holds by default is undone.
      for (const Json& condition : p["needs"]) {
        const std::string text = condition;
        if (const auto at = text.find('='); at != std::string::npos) {
          const Json& needed = parameterOf(command, text.substr(0, at));
          if (needed["default"] != text.substr(at + 1)) continue;
          for (const Json& choice : needed["choices"]) {
            if (choice == needed["default"]) continue;
            words = words + std::vector<std::string>{"--" + text.substr(0, at), choice};
            break;
          }
        }
      }
      const auto result = explica(words);
      EXPECT_EQ(result.exitCode, 1) << result;
      EXPECT_NE(result.err.find("--" + p["name"].get<std::string>() + " has no effect without"),
                std::string::npos)
          << result;
      ++tried;
    }
  }
  EXPECT_GT(tried, 25U);
}

TEST(NoArgumentIsIgnored, TheFolderOfResultsIsGivenOnce) {
  for (const Json& command : describedCommands()) {
    const Json& folder = parameterOf(command, "OUT_DIR");
    if (folder.is_null() || !folder["required"].get<bool>()) continue;
    SCOPED_TRACE(command["command"].get<std::string>());
    EXPECT_TRUE(parameterOf(command, "out").is_null());
    EXPECT_EQ(command["usage"].get<std::string>().find("--out"), std::string::npos);
    const auto result = explica(withRequired(command) + std::vector<std::string>{"--out", "b"});
    EXPECT_EQ(result.exitCode, 1) << result;
  }
  const auto hearts = explica({"study", "hearts", "people", "a", "--out", "b"});
  EXPECT_NE(hearts.err.find("OUT_DIR says where the results go"), std::string::npos) << hearts;
}

}  // namespace
}  // namespace explica::testing
