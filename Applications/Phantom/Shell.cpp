// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// The command to imitate: settings, one declaration, one run.

#include "Explica/Phantom/Shell.h"
#include "Explica/Application/Command.h"
#include "Explica/IO/VolumeFile.h"

#include <nlohmann/json.hpp>

namespace explica::app {
namespace {

/// What the user may set.  Option structs of modules are members, so that each default is stated
/// once, in its module; paths of inputs are std::string members.
struct Settings {
  phantom::ShellOptions shell;
};

/// Said once: parser, --help, --config, provenance, reference page and descriptors follow.
void declare(Declaration& d, Settings& s) {
  d.synopsis("spherical shell of tissue with its exact thickness and harmonic function")
      .description(
          R"(Concentric spheres about the middle of the grid. Label 1 is enclosed by the tissue, 2 is the tissue, 0 the rest. Every trajectory is a radius, so that the thickness is the difference of the radii everywhere.)")
      .example("explica phantom shell --size 48 --out shell", "A shell of 48 voxels a side")
      .options("Shell", s.shell)
      .output("labels.nii.gz", FileKind::LabelVolume, "1 inside, 2 tissue, 0 outside")
      .output("level.nii.gz", FileKind::Volume,
              "distance from the inner sphere, mm, negative inside")
      .output("outer_level.nii.gz", FileKind::Volume,
              "distance from the outer sphere, mm, negative inside")
      .output("harmonic.nii.gz", FileKind::Volume, "exact harmonic function, 0 inside to 1 outside")
      .output("thickness.nii.gz", FileKind::Volume, "exact thickness, mm")
      .output("inner_distance.nii.gz", FileKind::Volume, "exact L0, mm")
      .output("outer_distance.nii.gz", FileKind::Volume, "exact L1, mm")
      .output("inner_point.nii.gz", FileKind::PointVolume, "exact phi0, RAS mm")
      .output("outer_point.nii.gz", FileKind::PointVolume, "exact phi1, RAS mm");
}

/// Read, call, write, report.  Loops over voxels belong in modules.
Termination run(Context& context, const Settings& s) {
  // A command with inputs reads and checks them here, before its first step: --dry-run ends there.
  phantom::Shell shell;
  {
    auto step = context.step("generate");  // timed until the end of its scope
    shell = phantom::makeShell(s.shell);
  }
  auto step = context.step("write");
  io::writeVolume(context.output("labels.nii.gz"), shell.labels);
  io::writeVolume(context.output("level.nii.gz"), shell.level);
  io::writeVolume(context.output("outer_level.nii.gz"), shell.outerLevel);
  io::writeVolume(context.output("harmonic.nii.gz"), shell.harmonic);
  io::writeVolume(context.output("thickness.nii.gz"), shell.thicknessMap);
  io::writeVolume(context.output("inner_distance.nii.gz"), shell.innerDistance);
  io::writeVolume(context.output("outer_distance.nii.gz"), shell.outerDistance);
  io::writeVolume(context.output("inner_point.nii.gz"), shell.innerPoint);
  io::writeVolume(context.output("outer_point.nii.gz"), shell.outerPoint);

  using Names = nlohmann::ordered_json;
  context.result("labels", Names{{"outside", phantom::Shell::kOuter},
                                 {"inner", phantom::Shell::kInner},
                                 {"tissue", phantom::Shell::kTissue}});
  context.result("answers", Names{{"level", "level.nii.gz"},
                                  {"outer_level", "outer_level.nii.gz"},
                                  {"harmonic", "harmonic.nii.gz"},
                                  {"thickness", "thickness.nii.gz"},
                                  {"inner_distance", "inner_distance.nii.gz"},
                                  {"outer_distance", "outer_distance.nii.gz"},
                                  {"inner_point", "inner_point.nii.gz"},
                                  {"outer_point", "outer_point.nii.gz"}});
  context.result("thickness", shell.thickness);
  context.result("inner_radius", shell.innerRadius);
  context.result("outer_radius", shell.outerRadius);
  return Termination::NotRun;  // nothing was iterated; an iterative command returns how it ended
}

}  // namespace

Command phantomShellCommand() {
  return makeCommand<Settings>("phantom shell", declare, run);
}

}  // namespace explica::app
