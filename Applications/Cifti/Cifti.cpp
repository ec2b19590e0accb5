// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/CiftiFile.h"
#include "Explica/IO/StatedHemisphere.h"
#include "Explica/IO/VertexFile.h"

#include "Explica/Application/Command.h"
#include "Explica/Core/Errors.h"
#include "Explica/IO/VertexDataFile.h"

#include <optional>
#include <string>
#include <vector>

namespace explica::app {
namespace {

struct CiftiSettings {
  std::optional<std::string> left, right, leftCortex, rightCortex;
  std::string name = "both";
  std::optional<double> seconds;
};

void declare(Declaration& d, CiftiSettings& s) {
  d.synopsis("maps or labels of both hemispheres in one CIFTI file")
      .description(
          R"(Joins the vertex data of the left and the right hemisphere, the medial wall left out, into a file for Workbench and what else reads CIFTI-2: .dscalar.nii of maps, .dtseries.nii of a series if --seconds says how far apart its frames are, .dlabel.nii of labels (GIFTI labels and FreeSurfer's annot). The cortex is where --left-cortex and --right-cortex are not 0: FreeSurfer's cortex.label, valid.shape.gii of explica sample, or any map; without them all vertices are in.)")
      .example(
          "explica cifti --left L/bold.func.gii --right R/bold.func.gii --left-cortex "
          "lh.cortex.label --right-cortex rh.cortex.label --seconds 2 --name bold --out cifti",
          "A sampled functional series of both hemispheres")
      .inputOption("left", FileKind::VertexData, "maps or labels of the left hemisphere", s.left)
      .inputOption("right", FileKind::VertexData, "maps or labels of the right hemisphere", s.right)
      .inputOption("left-cortex", FileKind::VertexData, "not 0 where the left cortex is",
                   s.leftCortex)
      .inputOption("right-cortex", FileKind::VertexData, "not 0 where the right cortex is",
                   s.rightCortex)
      .ofSide("left", Hemisphere::Left)
      .ofSide("left-cortex", Hemisphere::Left)
      .ofSide("right", Hemisphere::Right)
      .ofSide("right-cortex", Hemisphere::Right)
      .category("Output")
      .option("name", "name of the file, without its ending", s.name)
      .option({"seconds", "s", "time between maps that are a series"}, s.seconds)
      .output("*.dscalar.nii", FileKind::Any, "maps of both hemispheres")
      .output("*.dtseries.nii", FileKind::Any, "with --seconds: a series of both hemispheres")
      .output("*.dlabel.nii", FileKind::Any, "labels of both hemispheres with names and colours");
}

struct CiftiSide {
  const char* structure;
  std::optional<std::string> data, cortex;
};

io::CiftiStructure cortexOf(const CiftiSide& side, Eigen::Index vertexCount) {
  return io::ciftiStructure(side.structure, side.cortex
                                                ? io::readVertexNumbers(*side.cortex, vertexCount)
                                                : Eigen::VectorXd::Ones(vertexCount));
}

/// Labels of the side; FreeSurfer's annots number both hemispheres alike, which is right where the
/// names agree.
io::CiftiLabels ciftiLabelsOf(const CiftiSide& side) {
  io::CiftiLabels part{{}, io::readVertexLabels(*side.data)};
  part.where = cortexOf(side, part.labels.keys.size());
  return part;
}

io::CiftiPart mapsOf(const CiftiSide& side) {
  io::CiftiPart part{{}, io::readVertexMaps(*side.data)};
  part.where = cortexOf(side, part.maps.front().values.size());
  return part;
}

/// A file has one name for both sides of a map.
void warnOfOtherNames(Context& context, const std::vector<io::CiftiPart>& parts) {
  for (std::size_t m = 0; parts.size() == 2 && m < parts[0].maps.size(); ++m) {
    if (m >= parts[1].maps.size()) return;
    const std::string &left = parts[0].maps[m].name, &right = parts[1].maps[m].name;
    if (io::withoutSide(left) == io::withoutSide(right)) continue;
    context.warn("map " + std::to_string(m + 1) + " is '" + left + "' on the left and '" + right +
                 "' on the right; the file has the left one's name");
  }
}

template <class Part>
std::vector<Part> each(const std::vector<CiftiSide>& sides, Part (*read)(const CiftiSide&)) {
  std::vector<Part> parts;
  for (const CiftiSide& side : sides) parts.push_back(read(side));
  return parts;
}

Termination run(Context& context, const CiftiSettings& s) {
  std::vector<CiftiSide> sides;
  if (s.left) sides.push_back({"CortexLeft", s.left, s.leftCortex});
  if (s.right) sides.push_back({"CortexRight", s.right, s.rightCortex});
  if (sides.empty()) throw UsageError("give --left, --right, or both");
  if (s.name.empty() || s.name.find('/') != std::string::npos) {
    throw UsageError("--name must be the name of a file, without folders");
  }
  if (s.seconds && !(*s.seconds > 0)) throw UsageError("--seconds must be positive");
  const bool labels = io::namesLabels(*sides.front().data);
  for (const CiftiSide& side : sides) {
    if (io::namesLabels(*side.data) != labels) {
      throw UsageError(
          "one hemisphere has labels and the other one maps; two of a kind are needed");
    }
  }
  const std::vector<io::CiftiPart> parts =
      labels ? std::vector<io::CiftiPart>() : each(sides, mapsOf);
  if (!s.seconds) warnOfOtherNames(context, parts);
  const io::CiftiFile file = labels      ? io::ciftiLabels(each(sides, ciftiLabelsOf))
                             : s.seconds ? io::ciftiSeries(parts, *s.seconds)
                                         : io::ciftiScalars(parts);
  auto step = context.step("write");
  const std::size_t maps = labels ? 1 : parts.front().maps.size();
  context.result("vertices", file.values.size() / maps);
  if (!labels) context.result("maps", maps);
  file.write(context.output(s.name + file.ending));
  return Termination::NotRun;
}

}  // namespace

Command ciftiCommand() {
  return makeCommand<CiftiSettings>("cifti", declare, run);
}

}  // namespace explica::app
