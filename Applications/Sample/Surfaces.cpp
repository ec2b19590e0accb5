// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Surfaces.h"

#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Sampling/Depth.h"
#include "Explica/Study/SubjectFiles.h"

#include <algorithm>
#include <vector>

namespace explica::app {
namespace {

namespace fs = std::filesystem;

struct Pair {
  fs::path white, pial;
  std::optional<fs::path> volume;  ///< whose surface RAS they use
};

bool exist(const Pair& pair) {
  return fs::exists(pair.white) && fs::exists(pair.pial);
}

/// Files of a folder whose names hold all words, sorted.
std::vector<fs::path> filesWith(const fs::path& folder, const std::vector<std::string>& words) {
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool all = std::all_of(words.begin(), words.end(), [&](const std::string& word) {
      return name.find(word) != std::string::npos;
    });
    if (all) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// The HCP's names: SUBJECT.L.white.32k_fs_LR.surf.gii or SUBJECT.L.white.native.surf.gii.
std::optional<Pair> hcpPair(const fs::path& folder, const std::string& side) {
  const auto white = filesWith(folder, {"." + side + ".white.", ".surf.gii"});
  if (white.empty()) return {};
  std::string pial = white.front().filename().string();
  pial.replace(pial.find(".white."), 7, ".pial.");
  const Pair pair{white.front(), folder / pial, {}};
  if (!exist(pair)) return {};
  return pair;
}

Pair findPair(const fs::path& folder, const std::optional<std::string>& hemisphere) {
  Pair pair{folder / "white.surf.gii", folder / "pial.surf.gii", {}};
  if (exist(pair)) return pair;
  if (!hemisphere) {
    throw UsageError("--surfaces " + folder.string() +
                     " holds both hemispheres, or none; say which with --hemisphere L or R");
  }
  const std::string& side = *hemisphere;
  const std::string prefix = side == "L" ? "lh." : "rh.";
  pair = {folder / (prefix + "white"), folder / (prefix + "pial"), {}};  // a subject's surf folder
  if (exist(pair)) return pair;
  if (const auto hcp = hcpPair(folder, side)) return *hcp;
  try {
    const study::SubjectFiles files = study::findSubjectFiles(folder);
    const study::HemisphereFiles& found = files.of(side);
    if (found.white && found.pial) return {*found.white, *found.pial, files.surfaceVolume};
  } catch (const InvalidInput&) {
    // Said below with what this command looks for.
  }
  throw InvalidInput("surfaces: " + folder.string() +
                     " holds no white and pial surface of hemisphere " + side +
                     " (looked for white.surf.gii, lh.white or rh.white, *_hemi-" + side +
                     "_white.surf.gii, *." + side + ".white.*.surf.gii with their pial ones)");
}

}  // namespace

Cortex readCortex(Context& context, const CortexFiles& files) {
  if (files.white.has_value() != files.pial.has_value()) {
    throw UsageError("--white and --pial belong together; one of them is missing");
  }
  if (files.folder.has_value() == files.white.has_value()) {
    throw UsageError("give the surfaces by --surfaces DIR, or by --white and --pial");
  }
  if (files.hemisphere && *files.hemisphere != "L" && *files.hemisphere != "R") {
    throw UsageError("--hemisphere must be L or R");
  }
  Pair pair;
  io::SurfaceReadOptions reading = files.reading;
  if (files.folder) {
    pair = findPair(*files.folder, files.hemisphere);
    context.input(pair.white, "white");
    context.input(pair.pial, "pial");
    if (!reading.fsVolume && pair.volume) reading.fsVolume = pair.volume->string();
  } else {
    pair = {*files.white, *files.pial, {}};
  }
  io::LoadedSurface white = readSurface(context, "white", pair.white.string(), reading);
  io::LoadedSurface pial = readSurface(context, "pial", pair.pial.string(), reading);
  sampling::requireCorresponding(white.mesh, pial.mesh);
  Cortex cortex{
      std::move(white.mesh), std::move(pial.mesh), white.metadata.structure, white.origin, {}};
  if (reading.fsVolume) {
    cortex.scannerFromTkr = io::scannerFromTkr(io::readGrid(*reading.fsVolume));
  } else if (white.origin.space.starts_with("tkr")) {
    cortex.scannerFromTkr = white.origin.applied;
  }
  return cortex;
}

}  // namespace explica::app
