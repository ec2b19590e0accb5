// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/CortexTemplate.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/IO/LabelNames.h"
#include "Explica/IO/RegionFiles.h"
#include "Explica/IO/StatedHemisphere.h"
#include "Explica/Maps/Icosphere.h"
#include "Explica/Maps/LabelVolume.h"
#include "Explica/Maps/Parcellation.h"

#include <array>
#include <map>
#include <optional>
#include <set>

namespace explica::app {
namespace {

namespace fs = std::filesystem;

struct ParcellateSettings {
  std::string folder;
  std::vector<std::string> atlases;
  std::optional<std::string> templateName, hemisphere;
  bool volume = false;
  std::optional<std::string> ribbon, like;
};

/// Labels that are carried over, with what else is known of those who have them.
struct NamedAtlas {
  std::string file, sphere, sulc;  ///< empty: to be looked for beside the file
};

void declare(Declaration& d, ParcellateSettings& s) {
  d.synopsis("regions of an atlas, or of labelled people, on a person's surfaces")
      .description(
          "Carries labels over to a person's surfaces through spheres in register, such as "
          "FreeSurfer's sphere.reg. Several atlases vote: where sulcal depth is known of all, the "
          "votes of those whose folds are like the person's around a vertex count more. The sphere "
          "of an atlas is ?h.sphere.reg beside its file or in ../surf, as in FreeSurfer's "
          "subjects, with ?h.sulc; files on fsaverage3 to fsaverage need none. Without --atlas the "
          "regions are those of the template.")
      .reference(
          "Artaechevarria, Munoz-Barrutia, Ortiz-de-Solorzano 2009, IEEE Trans. Medical Imaging "
          "28(8):1266-1277")
      .example("explica parcellate bert/surf --atlas fsaverage/label/lh.aparc.annot --out regions",
               "fsaverage's Desikan-Killiany regions on a FreeSurfer subject")
      .input("SURFACES", FileKind::Folder,
             "folder with the person's ?h.sphere.reg or sphere.reg.surf.gii (and sulc), or a "
             "surface folder of explica run with register's beside it",
             s.folder)
      .inputOption("atlas", FileKind::VertexLabel, "labels of a template or of a labelled person",
                   s.atlases)
      .category("Input")
      .option("template",
              "as of register: whose regions they are without --atlas (default: colin27)",
              s.templateName)
      .option("hemisphere", "L or R, where neither the atlas' name nor the sphere says",
              s.hemisphere)
      .category("Volume")
      .option("volume",
              "also label the voxels of which at least half lies between white and pial surface",
              s.volume)
      .option("ribbon", "folder with white and pial surface, where SURFACES has none", s.ribbon)
      .inputOption("like", FileKind::Volume,
                   "image whose voxels they are (default: 1 mm, about the surfaces)", s.like,
                   "Volume")
      .needs({"ribbon", "like"}, {"volume"})
      .results<maps::Parcellation>()
      .output("regions.label.gii", FileKind::VertexLabel, "region of each vertex")
      .output("?h.*.annot", FileKind::VertexLabel, "the same as FreeSurfer's annotation")
      .output("doubt.shape.gii", FileKind::VertexData, "share of the votes against the region")
      .output("aparc.nii.gz", FileKind::LabelVolume,
              "with --volume: the regions between white and pial surface, with the keys of "
              "FreeSurfer's aparc+aseg where all are its regions")
      .output("aparc.tsv", FileKind::Table, "with --volume: key and name of each region");
}

std::string prefixOf(const ParcellateSettings& s) {
  if (s.hemisphere && *s.hemisphere != "L" && *s.hemisphere != "R") {
    throw UsageError("--hemisphere must be L or R");
  }
  const auto sphere = findFile(withRegistration(s.folder), {"sphere.reg.surf.gii"});
  const std::string asked = !s.atlases.empty() ? s.atlases.front() : sphere.value_or("");
  const std::string said = asked.empty() ? "" : io::statedStructure(asked);
  if (!s.hemisphere && said.empty()) {
    throw UsageError("'" + (asked.empty() ? s.folder : asked) +
                     "' does not say of which hemisphere it is; say it with --hemisphere L or R");
  }
  return (s.hemisphere ? *s.hemisphere == "R" : said == "CortexRight") ? "rh." : "lh.";
}

TriangleMesh readSphere(Context& context, const fs::path& path) {
  TriangleMesh sphere = readSurface(context, "sphere", context.input(path, "sphere").string(),
                                    {.space = io::SurfaceSpace::Scanner})
                            .mesh;
  maps::requireSphere(sphere, "'" + path.string() + "'");
  return sphere;
}

/// fsaverage's sphere of so many vertices.
std::optional<TriangleMesh> fsaverageOf(Eigen::Index vertices) {
  for (int level = 3; level <= 7; ++level) {
    if (10 * (Eigen::Index{1} << (2 * level)) + 2 == vertices) return maps::fsaverageSphere(level);
  }
  return {};
}

/// Sphere and folding of an atlas, found beside its file where they are not named.
maps::LabelledSphere readAtlas(Context& context, const NamedAtlas& named, const std::string& prefix,
                               const io::LabelMap& labels) {
  const std::string& file = named.file;
  const fs::path own = fs::path(file).parent_path();
  const std::vector<std::string> folders = {own.string(), (own / "../surf").string()};
  const auto find = [&](const std::string& given, const std::vector<std::string>& names) {
    return given.empty() ? findFile(folders, names) : std::optional(given);
  };
  maps::LabelledSphere atlas{{}, labels.keys, {}};
  const auto sphere = find(named.sphere, {prefix + "sphere.reg", "sphere.reg.surf.gii"});
  const auto known = sphere ? std::nullopt : fsaverageOf(labels.keys.size());
  if (!sphere && !known) {
    throw InvalidInput("'" + file + "': no " + prefix +
                       "sphere.reg is beside it or in ../surf, and fsaverage's spheres have other "
                       "numbers of vertices than its " +
                       std::to_string(labels.keys.size()));
  }
  atlas.sphere = sphere ? readSphere(context, *sphere) : *known;
  if (atlas.sphere.vertexCount() != labels.keys.size()) {
    throw InvalidInput("'" + file + "': has " + std::to_string(labels.keys.size()) +
                       " labels, its sphere " + std::to_string(atlas.sphere.vertexCount()) +
                       " vertices");
  }
  const auto sulc = find(named.sulc, {prefix + "sulc", "sulc.shape.gii"});
  if (!sulc) return atlas;
  atlas.folding =
      io::readVertexMaps(context.input(*sulc, "sulc"), labels.keys.size()).front().values;
  return atlas;
}

/// The labels that the user names, else the template's.
std::vector<NamedAtlas> atlasesOf(Context& context, const ParcellateSettings& s,
                                  const std::string& structure) {
  std::vector<NamedAtlas> atlases;
  for (const std::string& file : s.atlases) {
    atlases.push_back({file, "", ""});
  }
  if (!atlases.empty()) return atlases;
  const std::string name = s.templateName.value_or(kDefaultTemplate);
  const CortexTemplate known = findTemplate(context, name, structure);
  if (known.atlas.empty()) {
    throw InvalidInput("template '" + name +
                       "': has no regions (?h.aparc.annot); name some with --atlas");
  }
  context.input(known.atlas, "atlas");
  return {{known.atlas, known.sphere, known.sulc}};
}

/// The table with other colours where two labels share one: annot files tell labels by colour.
std::vector<io::LabelEntry> toldByColour(std::vector<io::LabelEntry> table) {
  std::set<std::array<float, 4>> colours;
  for (const io::LabelEntry& entry : table) colours.insert(entry.colour);
  if (colours.size() == table.size()) return table;
  for (io::LabelEntry& entry : table) entry.colour = io::distinctColour(entry.key);
  return table;
}

/// White and pial surface of the person.
std::array<TriangleMesh, 2> readRibbon(Context& context, const ParcellateSettings& s,
                                       const std::string& prefix, Eigen::Index vertices) {
  std::array<TriangleMesh, 2> ribbon;
  for (std::size_t n = 0; n < 2; ++n) {
    const std::string name = n == 0 ? "white" : "pial";
    const auto file =
        findFile({s.folder, s.ribbon.value_or(s.folder)}, {prefix + name, name + ".surf.gii"});
    if (!file) {
      throw InvalidInput("'" + s.ribbon.value_or(s.folder) + "': no " + prefix + name + " or " +
                         name +
                         ".surf.gii in it, which --volume needs; name their folder by --surfaces");
    }
    ribbon[n] = readSurface(context, name, context.input(*file, name).string(),
                            {.space = io::SurfaceSpace::Scanner})
                    .mesh;
    if (ribbon[n].vertexCount() == vertices) continue;
    throw InvalidInput("'" + *file + "': has " + std::to_string(ribbon[n].vertexCount()) +
                       " vertices, the person's sphere " + std::to_string(vertices));
  }
  return ribbon;
}

/// The labels of a volume: FreeSurfer's of aparc+aseg where all regions are its own, else those of
/// the atlas; what is no region becomes 0.
std::map<Label, io::LabelEntry> volumeLabels(const io::LabelMap& labels, bool left) {
  std::map<std::string, Label> freeSurfer;
  for (Label n = 1; n < 100; ++n) freeSurfer[io::freeSurferRegion(1000 + n)] = n;
  std::map<Label, io::LabelEntry> result;
  bool own = true;
  for (const io::LabelEntry& entry : labels.table) {
    if (io::meansNoRegion(entry.name)) continue;
    result[entry.key] = entry;
    own = own && freeSurfer.count(entry.name) > 0;
  }
  for (auto& [key, entry] : result) {
    if (own) entry.key = (left ? 1000 : 2000) + freeSurfer[entry.name];
  }
  return result;
}

void writeVolume(Context& context, const std::array<TriangleMesh, 2>& ribbon, const Grid& grid,
                 const io::LabelMap& regions, bool left) {
  const auto named = volumeLabels(regions, left);
  maps::VertexKeys keys = maps::VertexKeys::Zero(regions.keys.size());
  for (Eigen::Index v = 0; v < keys.size(); ++v) {
    if (const auto at = named.find(regions.keys[v]); at != named.end()) keys[v] = at->second.key;
  }
  io::writeVolume(context.output("aparc.nii.gz"),
                  maps::labelsBetween(grid, ribbon[0], ribbon[1], keys));
  std::string legend = "index\tname\n";
  for (const auto& [key, entry] : named) {
    legend += std::to_string(entry.key) + "\t" + entry.name + "\n";
  }
  writeTextFile(context.output("aparc.tsv"), legend);
}

Termination run(Context& context, const ParcellateSettings& s) {
  const std::string prefix = prefixOf(s);
  const std::string structure = prefix == "rh." ? "CortexRight" : "CortexLeft";
  const auto place =
      findFile(withRegistration(s.folder), {prefix + "sphere.reg", "sphere.reg.surf.gii"});
  if (!place) {
    throw InvalidInput("'" + s.folder + "': holds no " + prefix +
                       "sphere.reg and no sphere.reg.surf.gii, which explica register writes");
  }
  if (const std::string said = io::statedStructure(*place); !said.empty() && said != structure) {
    throw InvalidInput("'" + *place + "': is of the other hemisphere than the regions asked for (" +
                       prefix.substr(0, 2) + ")");
  }
  const TriangleMesh sphere = readSphere(context, *place);
  Eigen::VectorXd folding;
  if (const auto sulc = findFile({s.folder}, {prefix + "sulc", "sulc.shape.gii"})) {
    folding = io::readVertexMaps(context.input(*sulc, "sulc"), sphere.vertexCount()).front().values;
  }
  const std::vector<NamedAtlas> named = atlasesOf(context, s, structure);
  std::vector<io::LabelMap> labels;
  for (const NamedAtlas& atlas : named) labels.push_back(io::readVertexLabels(atlas.file));
  io::numberAlike(labels);
  std::vector<maps::LabelledSphere> atlases;
  for (std::size_t a = 0; a < labels.size(); ++a) {
    atlases.push_back(readAtlas(context, named[a], prefix, labels[a]));
  }
  std::array<TriangleMesh, 2> ribbon;
  Grid grid;
  if (s.volume) {
    ribbon = readRibbon(context, s, prefix, sphere.vertexCount());
    grid = s.like ? io::readGrid(*s.like) : maps::gridAround(ribbon[1].positions, 1);
  }
  auto step = context.step("parcellate");
  const maps::Parcellation found = maps::parcellate(sphere, folding, atlases);
  const io::LabelMap result{"regions", found.keys, toldByColour(labels.front().table)};
  std::string name = fs::path(named.front().file).filename().string();
  name = name.starts_with(prefix) ? name.substr(3) : name;
  name = name.substr(0, name.rfind(name.ends_with(".label.gii") ? ".label.gii" : "."));
  io::writeGiftiLabel(context.output("regions.label.gii"), result, structure);
  io::writeFreeSurferAnnot(context.output(prefix + name + ".annot"), result);
  io::writeGiftiShape(context.output("doubt.shape.gii"), {{"doubt", "", found.doubt}}, structure);
  if (s.volume) writeVolume(context, ribbon, grid, result, structure == "CortexLeft");
  context.results(found);
  return Termination::NotRun;
}

}  // namespace

Command parcellateCommand() {
  return makeCommand<ParcellateSettings>("parcellate", declare, run);
}

}  // namespace explica::app
