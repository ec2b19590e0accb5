// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/CortexFiles.h"

#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Sampling/Depth.h"
#include "Explica/Study/SubjectFiles.h"

#include <fnmatch.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <vector>

namespace explica::app {
namespace {

namespace fs = std::filesystem;

struct Pair {
  fs::path white, pial;
  std::optional<fs::path> volume;  ///< whose surface RAS they use
};

/// How programs name the white surface of a hemisphere, and what its pial one has instead.
struct Naming {
  std::string pattern, white, pial;
};

std::vector<Naming> namingsOf(const std::string& side) {
  const std::string prefix = side == "L" ? "lh" : "rh";
  return {{prefix + ".white", ".white", ".pial"},
          {prefix + ".white.surf.gii", ".white.", ".pial."},
          {"*hemi-" + side + "_*white.surf.gii", "white.surf", "pial.surf"},
          {"*." + side + ".white.*surf.gii", ".white.", ".pial."},
          {"wm_" + prefix + ".gii", "wm_", "pia_"}};
}

std::optional<Pair> pairBy(const Naming& naming, const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code absent;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, absent)) {
    const std::string name = entry.path().filename().string();
    if (fnmatch(naming.pattern.c_str(), name.c_str(), 0) != 0) continue;
    std::string pial = name;
    pial.replace(pial.rfind(naming.white), naming.white.size(), naming.pial);
    if (isThere(folder / pial)) found.push_back(entry.path());
  }
  if (found.empty()) return {};
  // The subject's own surface has the shortest name: those of a template name their space, too.
  const auto first = std::min_element(found.begin(), found.end(), [](const auto& a, const auto& b) {
    const auto& x = a.native();
    const auto& y = b.native();
    return x.size() != y.size() ? x.size() < y.size() : x < y;
  });
  std::string pial = first->filename().string();
  pial.replace(pial.rfind(naming.white), naming.white.size(), naming.pial);
  return Pair{*first, folder / pial, {}};
}

std::optional<Pair> pairOf(const fs::path& folder, const std::string& side) {
  for (const Naming& naming : namingsOf(side)) {
    if (const auto pair = pairBy(naming, folder)) return pair;
  }
  try {
    const study::SubjectFiles files = study::findSubjectFiles(folder);
    const study::HemisphereFiles& found = files.of(side);
    if (found.white && found.pial) return Pair{*found.white, *found.pial, files.surfaceVolume};
  } catch (const InvalidInput&) {
    // No whole subject.
  }
  for (const Naming& naming : namingsOf(side)) {
    if (const auto pair = pairBy(naming, folder / "surf")) return pair;
  }
  return {};
}

Pair findPair(const fs::path& folder, const std::optional<std::string>& hemisphere) {
  const Pair plain{folder / "white.surf.gii", folder / "pial.surf.gii", {}};
  if (isThere(plain.white) && isThere(plain.pial)) return plain;
  std::vector<Pair> found;
  for (const std::string side : {"L", "R"}) {
    if (hemisphere && *hemisphere != side) continue;
    if (const auto pair = pairOf(folder, side)) found.push_back(*pair);
  }
  if (found.size() > 1) {
    throw UsageError("--surfaces " + folder.string() +
                     " holds both hemispheres: say which with --hemisphere L or R");
  }
  if (!found.empty()) return found.front();
  std::string tried = "white.surf.gii";
  for (const std::string side : {"L", "R"}) {
    if (hemisphere && *hemisphere != side) continue;
    for (const Naming& naming : namingsOf(side)) tried += ", " + naming.pattern;
  }
  throw InvalidInput("surfaces: '" + folder.string() + "' holds no white and pial surface" +
                     (hemisphere ? " of hemisphere " + *hemisphere : "") + " (looked for " + tried +
                     ", each with its pial surface); name them with --white and --pial");
}

}  // namespace

void declareCortex(Declaration& d, CortexFiles& files, const std::string& group) {
  d.inputOption("surfaces", FileKind::Folder,
                "folder with the white and pial surface, named as by explica surface, FreeSurfer, "
                "fMRIPrep, the HCP or pycortex",
                files.folder, group)
      .category(group)
      .option("hemisphere", "L or R, where the folder holds both", files.hemisphere)
      .inputOption("white", FileKind::Surface, "white surface", files.white, group)
      .inputOption("pial", FileKind::Surface, "its pial surface, same faces", files.pial, group)
      .excludes("surfaces", {"white", "pial"})
      .needs({"hemisphere"}, {"surfaces"});
}

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

void declarePlace(Declaration& d, VolumePlace& place, const std::string& group) {
  d.inputOption("to-volume", FileKind::Any,
                "transform from the surface to the volumes: 4 x 4 matrix as text (RAS mm), ITK "
                "(text, .mat, .h5), FreeSurfer LTA or register.dat, pycortex xfm",
                place.file, group)
      .category(group)
      .option("to-volume-sense", "which way the transform is taken", place.sense)
      .needs({"to-volume-sense"}, {"to-volume"});
}

std::optional<io::PointTransform> transformTo(Context& context, const Grid& volume,
                                              const VolumePlace& place, const Cortex* cortex) {
  if (!place.file) return {};
  io::TransformSides sides;
  sides.volume = volume;
  sides.sense = place.sense;
  if (cortex != nullptr) {
    sides.scannerFromFile = cortex->origin.applied;
    sides.scannerFromTkr = cortex->scannerFromTkr;
  }
  io::PointTransform transform = io::readPointTransform(*place.file, sides);
  context.note("to-volume",
               nlohmann::ordered_json{{"format", transform.format}, {"sense", transform.sense}});
  context.detail("'" + *place.file + "': " + transform.format + ", " + transform.sense);
  return transform;
}

std::string stemOf(const std::string& path) {
  std::string name = std::filesystem::path(path).filename().string();
  for (const std::string_view ending : {".nii.gz", ".nii", ".mgz", ".mgh.gz", ".mgh", ".nrrd",
                                        ".nhdr", ".mha", ".mhd", ".hdr", ".img"}) {
    if (name.size() > ending.size() && name.ends_with(ending)) {
      name.resize(name.size() - ending.size());
      break;
    }
  }
  return name;
}

}  // namespace explica::app
