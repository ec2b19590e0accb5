// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/CortexTemplate.h"
#include "Explica/Application/FoldingFiles.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/StopScope.h"
#include "Explica/IO/RegionFiles.h"
#include "Explica/IO/StatedHemisphere.h"
#include "Explica/IO/VertexFile.h"
#include "Explica/Maps/Icosphere.h"
#include "Explica/Maps/Parcellation.h"
#include "Explica/Sphere/Average.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>

namespace explica::app {
namespace {

namespace fs = std::filesystem;

struct TemplateSettings {
  std::vector<std::string> people;
  std::string density = "fsaverage5";
  sphere::AverageOptions average;
};

void declare(Declaration& d, TemplateSettings& s) {
  d.synopsis("a template of people's own: mean folds, surfaces and regions, without favour for any")
      .description(
          "Registers all people to their mean, again and again, and moves the mean each time to "
          "where the people's own spheres are deformed by the identity in the mean. The order of "
          "people says only where it lies in space. What is written is a folder for --template of "
          "register, parcellate and run. Surfaces are means of positions after rigid alignment; "
          "regions, where all people have some, are those of the majority, by their names. A "
          "hemisphere that fewer than two people have is left out.")
      .reference(
          "Guimond, Meunier, Thirion 2000, Computer Vision and Image Understanding 77:192-210")
      .example("explica template sub-01 sub-02 sub-03 --out ours",
               "Of three folders of explica run; then: explica register ... --template ours")
      .input("PEOPLE", FileKind::Folder,
             "folders of explica run, FreeSurfer subjects, or a study's OUT_DIR with all its runs",
             s.people)
      .category("Template")
      .option("density", "its vertices: fsaverage3 ... fsaverage6 or fsaverage", s.density)
      .options("Template", s.average)
      .output("hemi-*_sphere.surf.gii", FileKind::Surface, "fsaverage's sphere of that density")
      .output("hemi-*_sulc.shape.gii", FileKind::VertexData, "mean sulcal depth")
      .output("hemi-*_curvature.shape.gii", FileKind::VertexData, "mean curvature")
      .output("hemi-*_sd.shape.gii", FileKind::VertexData,
              "of ten people or more: deviations of both between them")
      .output("hemi-*_white.surf.gii", FileKind::Surface, "mean white surface")
      .output("hemi-*_pial.surf.gii", FileKind::Surface, "mean pial surface")
      .output("hemi-*_regions.label.gii", FileKind::VertexLabel, "regions of the majority")
      .results<sphere::AverageSummary>();
}

/// A person's files of one hemisphere.
struct Person {
  std::string name, sphere, sulc, curvature, white, pial, labels;
};

/// The runs of a study, or the folder itself.
std::vector<fs::path> peopleIn(const std::string& given) {
  const fs::path runs = fs::path(given) / "runs";
  return isFolder(runs) ? foldersOf(runs) : std::vector<fs::path>{given};
}

/// What a folder has of a hemisphere, if it has its sphere.
std::optional<Person> personIn(const fs::path& folder, const std::string& structure) {
  const bool right = structure == "CortexRight";
  const std::string side = right ? "-R" : "-L", prefix = right ? "rh." : "lh.";
  std::vector<std::string> folders;
  for (const std::string step : {"surface", "sphere", "parcellate"}) {
    for (const std::string& name : {step + side, step}) folders.push_back((folder / name).string());
  }
  for (const char* below : {"", "surf", "label"}) folders.push_back((folder / below).string());
  const auto find = [&](const std::string& freeSurfer, const std::string& own) {
    return findFile(folders, {own, prefix + freeSurfer});
  };
  const auto sphere = find("sphere", "sphere.surf.gii");
  if (!sphere) return {};
  const std::string said = io::statedStructure(*sphere);
  const bool isRight =
      said.empty() ? folder.filename().string().ends_with("_hemi-R") : said == "CortexRight";
  if (isRight != right) return {};
  Person person;
  person.name = folder.lexically_normal().string();
  person.sphere = *sphere;
  const auto demand = [&](const std::string& freeSurfer, const std::string& own) {
    if (const auto found = find(freeSurfer, own)) return *found;
    throw InvalidInput("'" + person.name + "': has a sphere, but no " + prefix + freeSurfer +
                       " or " + own);
  };
  person.sulc = demand("sulc", "sulc.shape.gii");
  person.curvature = demand("curv", "curvature.shape.gii");
  person.white = demand("white", "white.surf.gii");
  person.pial = demand("pial", "pial.surf.gii");
  person.labels = find("aparc.annot", "regions.label.gii").value_or("");
  return person;
}

TriangleMesh readMesh(Context& context, const std::string& file) {
  return readSurface(context, "PEOPLE", context.input(file, "person").string(),
                     {.space = io::SurfaceSpace::Scanner})
      .mesh;
}

sphere::FoldingSphere foldingOf(Context& context, const Person& person) {
  FoldingFiles files;
  files.sphere = person.sphere;
  files.sulc = person.sulc;
  files.curvature = person.curvature;
  return readFolding(context, files, "person");
}

/// White and pial surface of the template.
std::array<TriangleMesh, 2> meanSurfaces(Context& context, const std::vector<Person>& people,
                                         const std::vector<TriangleMesh>& spheres,
                                         const TriangleMesh& grid) {
  std::vector<Positions> shapes;
  for (std::size_t p = 0; p < people.size(); ++p) {
    checkpoint(context.monitor());
    const auto weights =
        maps::resamplingWeights(spheres[p], grid, maps::ResamplingMethod::Barycentric, {}, {});
    Positions shape(2 * grid.vertexCount(), 3);
    shape << weights * readMesh(context, people[p].white).positions,
        weights * readMesh(context, people[p].pial).positions;
    shapes.push_back(std::move(shape));
  }
  const Positions mean = sphere::meanShape(shapes);
  return {TriangleMesh{mean.topRows(grid.vertexCount()), grid.faces},
          TriangleMesh{mean.bottomRows(grid.vertexCount()), grid.faces}};
}

/// The majority's regions, if all have some.
std::optional<io::LabelMap> majority(Context& context, const std::vector<Person>& people,
                                     const std::vector<TriangleMesh>& spheres,
                                     const TriangleMesh& grid) {
  std::vector<io::LabelMap> files;
  for (std::size_t p = 0; p < people.size(); ++p) {
    if (people[p].labels.empty()) return {};
    files.push_back(
        io::readVertexLabels(context.input(people[p].labels, "person"), spheres[p].vertexCount()));
  }
  io::numberAlike(files);
  std::vector<maps::LabelledSphere> labelled;
  for (std::size_t p = 0; p < people.size(); ++p) {
    labelled.push_back({spheres[p], files[p].keys, {}});
  }
  return io::LabelMap{"regions", maps::parcellate(grid, {}, labelled).keys, files.front().table};
}

/// One hemisphere of all who have it.
struct TemplateSide {
  std::string structure;
  std::vector<Person> people;
  std::vector<sphere::FoldingSphere> folds;
};

void writeSide(Context& context, const TemplateSide& side, const sphere::SphereAverage& average) {
  const std::string stem = side.structure == "CortexRight" ? "hemi-R_" : "hemi-L_";
  const sphere::FoldingSphere& folding = average.folding;
  io::SurfaceMetadata metadata;
  metadata.structure = side.structure;
  const auto surface = [&](const std::string& name, const TriangleMesh& mesh) {
    io::writeGiftiSurface(context.output(stem + name + ".surf.gii"), mesh, metadata);
  };
  const auto map = [&](const std::string& name, const std::string& unit,
                       const Eigen::VectorXd& values) {
    if (values.size() == 0) return;
    io::writeGiftiShape(context.output(stem + name + ".shape.gii"), {{name, unit, values}},
                        side.structure);
  };
  map("sulc", "mm", folding.sulc);
  map("curvature", "mm^-1", folding.curvature);
  map("sulc_sd", "mm", folding.sulcSd);
  map("curvature_sd", "mm^-1", folding.curvatureSd);
  std::vector<TriangleMesh> spheres;
  for (std::size_t p = 0; p < side.people.size(); ++p) {
    spheres.push_back({average.registered[p], side.folds[p].sphere.faces});
  }
  const auto ribbon = meanSurfaces(context, side.people, spheres, folding.sphere);
  surface("white", ribbon[0]);
  surface("pial", ribbon[1]);
  if (const auto labels = majority(context, side.people, spheres, folding.sphere)) {
    io::writeGiftiLabel(context.output(stem + "regions.label.gii"), *labels, side.structure);
  }
  metadata.geometricType = "Spherical";
  metadata.topologicalType = "Closed";
  surface("sphere", folding.sphere);
}

std::vector<Person> peopleOf(const TemplateSettings& s, const std::string& structure) {
  std::vector<Person> people;
  for (const std::string& given : s.people) {
    for (const fs::path& folder : peopleIn(given)) {
      if (auto person = personIn(folder, structure)) people.push_back(std::move(*person));
    }
  }
  return people;
}

/// Reads the hemispheres that two people have, or more.
std::vector<TemplateSide> readSides(Context& context, const TemplateSettings& s) {
  std::vector<TemplateSide> sides;
  for (const std::string structure : {"CortexLeft", "CortexRight"}) {
    TemplateSide side{structure, peopleOf(s, structure), {}};
    if (side.people.size() == 1) {
      context.warn("'" + side.people.front().name + "' alone has the " +
                   (structure == "CortexLeft" ? "left" : "right") + " hemisphere: it is left out");
    }
    if (side.people.size() < 2) continue;
    for (const Person& person : side.people) side.folds.push_back(foldingOf(context, person));
    sides.push_back(std::move(side));
  }
  if (!sides.empty()) return sides;
  throw InvalidInput("'" + s.people.front() + "'" + (s.people.size() > 1 ? " and the others" : "") +
                     ": fewer than two people with a sphere (?h.sphere, sphere.surf.gii) of one "
                     "hemisphere; explica run makes them");
}

Termination run(Context& context, const TemplateSettings& s) {
  const auto level = maps::fsaverageLevel(s.density);
  if (!level) {
    throw UsageError("--density: '" + s.density +
                     "' is none of fsaverage3 ... fsaverage6, fsaverage");
  }
  const std::vector<TemplateSide> sides = readSides(context, s);
  sphere::AverageSummary summary;
  Termination worst = Termination::NotRun;
  for (const TemplateSide& side : sides) {
    auto step = context.step(side.structure == "CortexRight" ? "right" : "left");
    const auto average = sphere::averageSpheres(side.folds, maps::fsaverageSphere(*level),
                                                s.average, context.monitor());
    checkpoint(context.monitor());
    step.termination(average.termination);
    writeSide(context, side, average);
    summary.add(average);
    if (!reachedGoal(average.termination)) worst = average.termination;
  }
  context.results(summary);
  return worst;
}

}  // namespace

Command templateCommand() {
  return makeCommand<TemplateSettings>("template", declare, run);
}

}  // namespace explica::app
