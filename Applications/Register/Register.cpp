// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sphere/Register.h"
#include "Explica/Sphere/Summary.h"

#include "Explica/Application/Command.h"
#include "Explica/Application/FoldingFiles.h"
#include "Explica/Core/Errors.h"
#include "Explica/IO/StatedHemisphere.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"

namespace explica::app {
namespace {

struct RegisterSettings {
  std::string sphere;
  std::optional<std::string> sulc, curvature, surfaces;
  std::optional<std::string> templateName;
  std::optional<std::string> to, toSulc, toCurvature;
  bool mirror = false;
  sphere::RegisterOptions registration;
};

void declare(Declaration& d, RegisterSettings& s) {
  d.synopsis("a sphere brought onto a template's, or another person's, by the folds")
      .description(
          R"(Registers a hemisphere's sphere to a template by sulcal depth and mean curvature: an icosphere on the template moves over the sphere, from coarse to fine, to where the folds agree, from many rotations at once, of which those of least energy go on. No face of it turns over and no area changes by more than --max-areal doublings, so that the map is one to one; the sphere's vertices follow, and what is written is tested exactly. The template is a folder with lh.sphere.reg, lh.sulc and lh.curv (rh. for a right hemisphere; lh.sulc_sd and lh.curv_sd beside them weigh the maps), what explica run has left of a person, or --to another person's sphere. A right hemisphere goes onto a left one with --mirror, and the other way round.)")
      .reference("Yeo et al. 2010, Spherical Demons, IEEE Trans. Med. Imaging 29(3):650-668")
      .reference("Alexa 2022, Super-Fibonacci spirals, CVPR")
      .example("explica register lh.sphere --template fsaverage --out registered",
               "A FreeSurfer subject's sphere onto $SUBJECTS_DIR/fsaverage")
      .input("SPHERE", FileKind::Surface, "sphere about the origin", s.sphere)
      .inputOption("sulc", FileKind::VertexData, "sulcal depth (default: beside the sphere)",
                   s.sulc, "Folds")
      .inputOption("curvature", FileKind::VertexData, "mean curvature (default: beside the sphere)",
                   s.curvature, "Folds")
      .category("Folds")
      .option("surfaces", "folder with the folding maps", s.surfaces)
      .category("Target")
      .option("template",
              "folder, name of a subject in $SUBJECTS_DIR (fsaverage), or colin27 (also if "
              "none is named): made once from Colin27 of mricron-data",
              s.templateName)
      .inputOption("to", FileKind::Surface, "another person's sphere instead of a template", s.to,
                   "Target")
      .inputOption("to-sulc", FileKind::VertexData, "its sulcal depth (default: beside it)",
                   s.toSulc, "Target")
      .inputOption("to-curvature", FileKind::VertexData, "its mean curvature (default: beside it)",
                   s.toCurvature, "Target")
      .option("mirror", "register to the other hemisphere, mirrored", s.mirror)
      .options("Registration", s.registration)
      .ofAnother("to", s.mirror)
      .ofAnother("to-sulc", s.mirror)
      .ofAnother("to-curvature", s.mirror)
      .excludes("to", {"template"})
      .needs({"to-sulc", "to-curvature"}, {"to"})
      .output("sphere.reg.surf.gii", FileKind::Surface, "the sphere in the template's frame")
      .output("?h.sphere.reg", FileKind::Surface, "the same as FreeSurfer writes it")
      .output("areal.shape.gii", FileKind::VertexData, "log2 of the map's change of areas")
      .output("folding.shape.gii", FileKind::VertexData,
              "sulcal depth and curvature of the sphere and of the template there")
      .results<sphere::SphereRegistration>();
}

std::string otherSide(const std::string& structure) {
  return structure == "CortexRight" ? "CortexLeft" : "CortexRight";
}

FoldingFiles targetFiles(Context& context, const RegisterSettings& s,
                         const std::string& structure) {
  const std::string side = s.mirror ? otherSide(structure) : structure;
  if (s.to) {
    const std::string known = io::statedStructure(*s.to);
    if (!known.empty() && known != side) {
      throw InvalidInput("'" + *s.to + "' and '" + s.sphere + "' are " +
                         (s.mirror ? "the same hemisphere" : "of different hemispheres") +
                         (s.mirror ? "; leave --mirror out" : "; add --mirror"));
    }
    return subjectFiles(*s.to, side, s.toSulc, s.toCurvature, {});
  }
  return findTemplate(context, s.templateName.value_or(kDefaultTemplate), side);
}

void write(Context& context, const sphere::FoldingSphere& moving,
           const sphere::SphereRegistration& result, const std::string& structure) {
  io::SurfaceMetadata metadata;
  metadata.structure = structure;
  metadata.geometricType = "Spherical";
  metadata.topologicalType = "Closed";
  const TriangleMesh sphere{result.positions, moving.sphere.faces};
  io::writeGiftiSurface(context.output("sphere.reg.surf.gii"), sphere, metadata);
  const bool right = structure == "CortexRight";
  io::writeFreeSurferSurface(context.output(right ? "rh.sphere.reg" : "lh.sphere.reg"), sphere);
  io::writeGiftiShape(context.output("areal.shape.gii"), {{"areal log2", "", result.arealLog2}},
                      structure);
  io::writeGiftiShape(context.output("folding.shape.gii"),
                      {{"sulc", "", moving.sulc},
                       {"template's sulc", "", result.sulc},
                       {"curvature", "", moving.curvature},
                       {"template's curvature", "", result.curvature}},
                      structure);
}

Termination run(Context& context, const RegisterSettings& s) {
  std::string structure = io::readSurface(s.sphere).metadata.structure;
  if (structure == "Other") structure = "CortexLeft";
  const FoldingFiles files = subjectFiles(s.sphere, structure, s.sulc, s.curvature, s.surfaces);
  sphere::FoldingSphere moving = readFolding(context, files);
  const sphere::FoldingSphere target =
      readFolding(context, targetFiles(context, s, structure), "to");
  if (s.mirror) moving.sphere = sphere::mirrored(std::move(moving.sphere));
  sphere::SphereRegistration result;
  {
    auto step = context.step("register");
    result = sphere::registerSphere(moving, target, s.registration, context.monitor());
    step.iterations(result.iterations);
    step.termination(result.termination);
  }
  auto step = context.step("write");
  write(context, moving, result, structure);
  context.results(result);
  return result.rounding.turnedAfter > 0 ? Termination::Stalled : result.termination;
}

}  // namespace

Command registerCommand() {
  return makeCommand<RegisterSettings>("register", declare, run);
}

}  // namespace explica::app
