// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// The command to imitate: settings, one declaration, one run.

#include "Explica/Phantom/Shell.h"
#include "AnnulusKind.h"

namespace explica::app {
namespace {

/// What the user may set.  Option structs of modules are members, so that each default is stated
/// once, in its module; paths of inputs are std::string members.
struct PhantomShellSettings {
  phantom::ShellOptions shell;
};

/// Said once: parser, --help, --config, provenance, reference page and descriptors follow.
void declare(Declaration& d, PhantomShellSettings& s) {
  d.synopsis("spherical shell of tissue with its exact thickness and harmonic function")
      .description(
          R"(Concentric spheres about the middle of the grid. Label 1 is enclosed by the tissue, 2 is the tissue, 0 the rest. Every trajectory is a radius, so that the thickness is the difference of the radii everywhere.)")
      .example("explica phantom shell --size 48 --out shell", "A shell of 48 voxels a side")
      .options("Shell", s.shell)
      .output("labels.nii.gz", FileKind::LabelVolume, "1 inside, 2 tissue, 0 outside")
      .output("level.nii.gz", FileKind::Volume,
              "distance from the inner sphere, mm, negative inside")
      .output("outer_level.nii.gz", FileKind::Volume,
              "distance from the outer sphere, mm, negative inside");
  declareAnswers(d);
}

/// Read, call, write, report.  Loops over voxels belong in modules.
Termination run(Context& context, const PhantomShellSettings& s) {
  // A command with inputs reads and checks them here, before its first step: --dry-run ends there.
  phantom::Shell shell;
  harmonic::PhantomAnswers answers;
  {
    auto step = context.step("generate");  // timed until the end of its scope
    shell = phantom::makeShell(s.shell);
    answers = harmonic::answersOf(shell);
  }
  auto step = context.step("write");
  io::writeVolume(context.output("labels.nii.gz"), shell.labels);
  io::writeVolume(context.output("level.nii.gz"), shell.innerLevel);
  io::writeVolume(context.output("outer_level.nii.gz"), shell.outerLevel);
  writeAnswers(context, answers);
  tellAnswers(context, shell, {{"level", "level.nii.gz"}, {"outer_level", "outer_level.nii.gz"}});
  context.result("thickness", shell.thickness());
  context.result("inner_radius", shell.innerRadius);
  context.result("outer_radius", shell.outerRadius);
  return Termination::NotRun;  // nothing was iterated; an iterative command returns how it ended
}

}  // namespace

Command phantomShellCommand() {
  return makeCommand<PhantomShellSettings>("phantom shell", declare, run);
}

}  // namespace explica::app
