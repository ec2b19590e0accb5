// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// What the fuzzers start from, what they once found, and both with a little damage, given to the
// commands that read such files: an answer, never "internal error", never exit code 4.

#include "../fuzz/Readers.h"
#include "QuickRuns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <random>
#include <set>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

using Words = std::vector<std::string>;

/// The commands that read what a reader reads; {file} is it, {folder} where the other inputs are.
struct Use {
  std::string reader;
  std::vector<Words> commands;
  bool takesTheSeed = true;  ///< the whole file is of use to the first command
};

void PrintTo(const Use& use, std::ostream* stream) {
  *stream << use.reader;
}

std::vector<Use> allUses() {
  const Words surfaces = {"--white", "{folder}/white.off", "--pial", "{folder}/pial.off"};
  const Words map = Words{"sample", "{folder}/map.nii"} + surfaces;
  const std::vector<Words> volume = {Words{"sample", "{file}"} + surfaces,
                                     {"thickness", "{file}", "--inner", "1", "--tissue", "2"},
                                     map + Words{"--mask", "{file}"}};
  const std::vector<Words> surface = {{"compare", "{file}", "{file}", "--pairs", "10"},
                                      {"inflate", "{file}", "--max-iterations", "1"},
                                      {"repair", "{file}"},
                                      {"sphere", "{file}", "--max-iterations", "1"}};
  const std::vector<Words> maps = {{"cifti", "--left", "{file}"}};
  const Words region = {"unfold",           "{folder}/white.off",
                        "--direction",      "0,0,1",
                        "--label",          "{file}",
                        "--max-iterations", "1"};
  const std::vector<Words> labels = {map + Words{"--labels", "{file}"}, region};
  const std::vector<Words> transform = {map + Words{"--to-volume", "{file}", "--to-volume-sense",
                                                    "forward", "--fs-volume", "{folder}/map.nii"}};
  const std::vector<Words> polygon = {
      {"embed", "{file}", "--order", "4", "--max-iterations", "2"},
      {"polygon", "{file}", "--region", "1:2", "--viewpoint", "100,50", "--max-iterations", "2"}};
  std::vector<Use> uses = {
      {"cifti", {volume[0], maps[0]}, false},  // which is written only
      {"patch", {{"flatten", "{folder}/white.off", "--cuts", "{file}"}}},
      {"points-tsv", {map + Words{"--points", "{file}"}}},
      {"legend-tsv",
       {{"surface", "--white-surface", "{folder}/white.off", "--pial-surface", "{folder}/pial.off",
         "--atlas", "{folder}/map.nii", "--atlas-legend", "{file}"}}},
      {"record",
       {{"history", "{file}"},
        {"verify", "{file}"},
        {"replay", "{file}", "--dry-run"},
        {"verify", "{file}", "--prov-json"}}},
      {"study", {{"study", "list", "{file}"}, {"study", "check", "{file}"}}},
      {"configuration", {{"phantom", "shell", "--dry-run", "--config", "{file}"}}},
  };
  const auto add = [&uses](const Words& readers, const std::vector<Words>& commands) {
    for (const auto& reader : readers) uses.push_back({reader, commands});
  };
  add({"nifti", "nifti-gz", "mgh", "nrrd", "metaimage", "png"}, volume);
  add({"gifti", "freesurfer-surface", "vtk", "vtp", "ply", "ply-text", "obj", "off", "stl",
       "stl-text"},
      surface);
  add({"gifti-maps", "freesurfer-curv"}, maps);
  add({"gifti-labels", "freesurfer-annot", "freesurfer-label"}, labels);
  add({"matrix", "itk-text", "itk-mat", "itk-hdf5", "lta", "register-dat", "pycortex"}, transform);
  add({"polygon-csv"}, polygon);
  add({"polygon-vtp"}, {polygon[1]});
  return uses;
}

const fuzz::Reader& readerOf(const std::string& name) {
  const auto& all = fuzz::allReaders();
  return *std::find_if(all.begin(), all.end(), [&](const auto& r) { return r.name == name; });
}

TEST(FuzzedFiles, OfEveryReaderAreGivenToACommand) {
  std::multiset<std::string> used, readers;
  for (const Use& use : allUses()) used.insert(use.reader);
  for (const fuzz::Reader& reader : fuzz::allReaders()) readers.insert(reader.name);
  EXPECT_EQ(used, readers);
}

TEST(FuzzedFiles, AreThereForEveryFormatOfSurfaces) {
  for (const std::string& ending : io::surfaceEndings()) {
    const bool packed = ending.ends_with(".gz");  // the packing is fuzzed with volumes
    const auto& all = fuzz::allReaders();
    EXPECT_TRUE(packed ||
                std::any_of(all.begin(), all.end(),
                            [&](const fuzz::Reader& r) { return r.file.ends_with(ending); }))
        << ending << ": add a row to Testing/fuzz/Readers.cpp";
  }
}

/// One byte, one number or one piece is another, or the end is missing.
std::string damaged(std::string text, std::mt19937& random) {
  const auto below = [&random](std::size_t count) {
    return random() % std::max<std::size_t>(count, 1);
  };
  const std::size_t place = below(below(2) ? text.size() : std::min<std::size_t>(text.size(), 400));
  switch (below(4)) {
    case 0:
      return text.substr(0, place);
    case 1:
      text[place] = static_cast<char>(below(256));
      return text;
    case 2:
      return text.insert(place, text.substr(below(text.size()), 1 + below(40)));
    default:
      break;
  }
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  const auto first =
      std::find_if(text.begin() + static_cast<std::ptrdiff_t>(place), text.end(), digit);
  const auto last = std::find_if_not(first, text.end(), digit);
  static const std::vector<std::string> numbers = {"-1",          "0", "1e999", "nan",
                                                   "99999999999", ".", "1e18"};
  return text.replace(first, last, numbers[below(numbers.size())]);
}

class FuzzedFiles : public ::testing::TestWithParam<Use> {
 protected:
  void SetUp() override {
    // Partly within the seeds' volume of 4 x 3 x 3 voxels, with as many vertices as their maps.
    io::writeSurface(folder_ / "white.off", geometry::makeIcosphere(0, 1.0));
    io::writeSurface(folder_ / "pial.off", geometry::makeIcosphere(0, 1.2));
    Grid grid;
    grid.size = {16, 16, 16};
    grid.spacing = {4, 4, 4};
    grid.origin = {-30, -30, -30};
    io::writeVolume(folder_ / "map.nii", Volume<float>(grid, 1.0F));
    file_ = folder_ / readerOf(GetParam().reader).file;
  }

  /// What the fuzzer starts from.
  [[nodiscard]] std::string seed() const {
    const std::string& reader = GetParam().reader;
    if (reader == "study") {
      return readText(fs::path(EXPLICA_SOURCE_DIR) / "ExampleData/study/study.yaml");
    }
    if (reader == "configuration") return R"({"size": 8, "quiet": true, "spacing": 1.5e0})";
    if (reader == "record") {
      const auto made = explica({"phantom", "shell", "--size", "8", "--out", folder_ / "shell"});
      EXPECT_EQ(made.exitCode, 0) << made;
      return readText(folder_ / "shell/provenance.json");
    }
    std::string test = readerOf(reader).file;
    std::replace(test.begin(), test.end(), '.', '_');
    CommandSetting setting;
    setting.environment["EXPLICA_SEEDS"] = folder_ / "seeds";
    const auto made = runProgram(
        {EXPLICA_SEED_WRITER, "--gtest_filter=Formats/DamagedFiles.WholeOnesAreSeeds/" + test},
        setting);
    EXPECT_EQ(made.exitCode, 0) << made;
    return readText(fs::path(folder_ / "seeds") / readerOf(reader).file / "seed");
  }

  /// The answer of one of the commands to a file of this content.
  [[nodiscard]] CommandResult answerTo(const std::string& content, std::size_t command) const {
    writeText(file_, content);
    Words words = filled(GetParam().commands[command % GetParam().commands.size()], folder_);
    std::replace(words.begin(), words.end(), std::string("{file}"), file_);
    const std::set<std::string> withoutFolder = {"verify", "history", "study"};
    if (!withoutFolder.contains(words[0])) words = words + Words{"--out", folder_ / "out"};
    const CommandResult result = explica(words);
    fs::remove_all(folder_ / "out");
    return result;
  }

  void expectASentence(const std::string& content, std::size_t command) const {
    const CommandResult result = answerTo(content, command);
    EXPECT_TRUE(result.exitCode >= 0 && result.exitCode <= 3) << result << content;
    EXPECT_EQ(result.err.find("internal error"), std::string::npos) << result;
    if (result.exitCode == 1 || result.exitCode == 2) {
      EXPECT_FALSE(result.out.empty() && result.err.empty());
    }
  }

  TemporaryFolder folder_;
  std::string file_;
};

TEST_P(FuzzedFiles, AreTakenWhole) {
  const CommandResult result = answerTo(seed(), 0);
  // Some volumes lie beside the surface, which is reported after they have been read.
  const bool taken = result.exitCode == 0 || result.exitCode == 3 ||
                     result.err.find("is known at no vertex") != std::string::npos;
  EXPECT_EQ(taken, GetParam().takesTheSeed) << result;
}

TEST_P(FuzzedFiles, ThatOnceCrashedAReaderGetASentence) {
  const fs::path kept =
      fs::path(EXPLICA_SOURCE_DIR) / "Testing/fuzz/regressions" / GetParam().reader;
  if (!fs::exists(kept)) return;
  for (const auto& entry : fs::directory_iterator(kept)) {
    SCOPED_TRACE(entry.path());
    for (std::size_t c = 0; c < GetParam().commands.size(); ++c) {
      expectASentence(readText(entry.path()), c);
    }
  }
}

TEST_P(FuzzedFiles, ThatAreDamagedGetASentence) {
  constexpr std::size_t kFiles = 9;
  std::mt19937 random(20261122);
  const std::string whole = seed();
  for (std::size_t n = 0; n < kFiles; ++n) {
    SCOPED_TRACE(n);
    expectASentence(damaged(whole, random), n);
  }
}

INSTANTIATE_TEST_SUITE_P(Readers, FuzzedFiles, ::testing::ValuesIn(allUses()), [](const auto& row) {
  std::string name = row.param.reader;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace explica::testing
