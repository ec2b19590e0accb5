// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Phantom/Cortex.h"
#include "Explica/Application/Command.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VolumeFile.h"

#include <nlohmann/json.hpp>

namespace explica::app {
namespace {

struct PhantomCortexSettings {
  phantom::CortexOptions cortex;
};

void declare(Declaration& d, PhantomCortexSettings& s) {
  d.synopsis("folded grey ribbon of constant thickness, as labels and as a T1-weighted image")
      .description(
          R"(A folded white surface with grey matter of one thickness all around it, and fluid beyond. Label 3 is white matter, 2 grey, 1 fluid, as explica segment writes them. The image has noise and a bias field; with --dura, a sheet nearly as bright as grey matter lies in the fluid.)")
      .example("explica phantom cortex --size 48 --out cortex", "A ribbon in 48 voxels a side")
      .example("explica phantom cortex --dura 1 --noise 6 --out dura",
               "With a sheet of dura near it, noisy")
      .options("Cortex", s.cortex)
      .output("labels.nii.gz", FileKind::LabelVolume, "3 white, 2 grey, 1 fluid, 0 outside")
      .output("t1.nii.gz", FileKind::Volume, "T1-weighted image, skull-stripped")
      .output("level.nii.gz", FileKind::Volume,
              "distance to the white surface, mm, negative inside")
      .output("white.surf.gii", FileKind::Surface, "the exact white surface");
}

Termination run(Context& context, const PhantomCortexSettings& s) {
  phantom::Cortex cortex;
  {
    auto step = context.step("generate");
    cortex = phantom::makeCortex(s.cortex);
  }
  auto step = context.step("write");
  io::writeVolume(context.output("labels.nii.gz"), cortex.labels);
  io::writeVolume(context.output("t1.nii.gz"), cortex.image);
  io::writeVolume(context.output("level.nii.gz"), cortex.level);
  io::SurfaceMetadata metadata;
  metadata.secondary = "GrayWhite";
  io::writeGiftiSurface(context.output("white.surf.gii"), cortex.white, metadata);
  using Names = nlohmann::ordered_json;
  context.result("labels", Names{{"outside", phantom::Cortex::kOutside},
                                 {"csf", phantom::Cortex::kCsf},
                                 {"grey", phantom::Cortex::kGrey},
                                 {"white", phantom::Cortex::kWhite}});
  context.result("answers", Names{{"level", "level.nii.gz"}, {"white", "white.surf.gii"}});
  context.result("thickness", cortex.thickness);
  return Termination::NotRun;
}

}  // namespace

Command phantomCortexCommand() {
  return makeCommand<PhantomCortexSettings>("phantom cortex", declare, run);
}

}  // namespace explica::app
