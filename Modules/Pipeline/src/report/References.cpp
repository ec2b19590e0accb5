// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "References.h"

#include "Explica/Core/EigenViews.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Provenance/Record.h"

#include <algorithm>
#include <iterator>

namespace explica::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr int kDeepest = 3;              // folders below the one named: a study's runs/NAME/surface
constexpr std::size_t kMostFiles = 400;  // of a study: more do not change a distribution

struct ThicknessFile {
  fs::path file;
  std::string side;
};

std::vector<ThicknessFile> freeSurfersOwn(const fs::path& subject) {
  std::vector<ThicknessFile> found;
  for (const auto& [name, side] : {std::pair{"lh.thickness", "left"}, {"rh.thickness", "right"}}) {
    if (isThere(subject / "surf" / name)) found.push_back({subject / "surf" / name, side});
  }
  return found;
}

/// A result of `explica surface`; none of another command.
std::optional<ThicknessFile> resultIn(const fs::path& folder) {
  const fs::path file = folder / "thickness.shape.gii";
  if (!isThere(file) || !isThere(folder / provenance::kRecordName)) return {};
  StepFolder step;
  step.name = folder.filename().string();
  step.record = provenance::readRecord(folder / provenance::kRecordName);
  if (step.record.value("command", "") != "surface") return {};
  return ThicknessFile{file, step.side()};
}

void search(const fs::path& folder, int depth, std::vector<ThicknessFile>& found) {
  for (ThicknessFile& own : freeSurfersOwn(folder)) found.push_back(std::move(own));
  if (auto result = resultIn(folder)) found.push_back(std::move(*result));
  if (depth == 0) return;
  for (const fs::path& next : foldersOf(folder)) {
    if (!fs::is_symlink(next)) search(next, depth - 1, found);
  }
}

/// The subject from whose labels a surface was made.
std::vector<ThicknessFile> sameSubject(const StepFolder& step) {
  const auto labels = inputOf(step, "SEG");
  if (!labels || labels->parent_path().filename() != "mri") return {};
  return freeSurfersOwn(labels->parent_path().parent_path());
}

Eigen::VectorXd valuesOf(const std::vector<ThicknessFile>& files) {
  std::vector<double> values;
  for (const ThicknessFile& one : files) {
    const io::VertexMap map = io::readVertexMaps(one.file).front();
    std::ranges::copy_if(map.values, std::back_inserter(values), [](double t) { return t > 0; });
  }
  return asVector(values);
}

std::vector<ThicknessFile> filesUnder(const std::string& folder) {
  if (!isFolder(folder)) throw InvalidInput("reference: " + folder + ": no such folder");
  std::vector<ThicknessFile> files;
  search(folder, kDeepest, files);
  if (files.empty()) {
    throw InvalidInput("reference: " + folder +
                       ": holds no thickness, neither of explica surface nor of FreeSurfer");
  }
  return files;
}

}  // namespace

void requireThickness(const std::vector<std::string>& folders) {
  for (const std::string& folder : folders) (void)filesUnder(folder);
}

std::optional<ThicknessReference> thicknessReference(const std::vector<std::string>& folders,
                                                     const StepFolder& step) {
  std::vector<ThicknessFile> files;
  for (const std::string& folder : folders) {
    for (ThicknessFile& one : filesUnder(folder)) files.push_back(std::move(one));
  }
  if (folders.empty()) files = sameSubject(step);
  const std::string side = step.side();
  std::erase_if(files, [&](const ThicknessFile& one) {
    return !side.empty() && !one.side.empty() && one.side != side;
  });
  if (files.empty()) return {};
  if (files.size() > kMostFiles) files.resize(kMostFiles);
  const std::string count = std::to_string(files.size());
  const std::string last = fs::path(folders.empty() ? "" : folders.front()).filename().string();
  return ThicknessReference{folders.empty()     ? "by FreeSurfer"
                            : files.size() == 1 ? (last.empty() ? "reference" : last)
                                                : count + " hemispheres of the reference",
                            valuesOf(files)};
}

}  // namespace explica::pipeline
