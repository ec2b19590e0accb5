// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/TriangleMesh.h"

#include <nlohmann/json_fwd.hpp>

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace explica::pipeline {

/// What a run starts from.
enum class InputKind {
  Auto,        ///< told by the input itself, see detectKind
  T1,          ///< T1-weighted volume, with or without skull
  Labels,      ///< label volume of white and grey matter
  FreeSurfer,  ///< subject directory of recon-all: mri, surf, label
  Bids         ///< anat folder of fMRIPrep, sMRIPrep or of segmentations
};
constexpr auto enumWords(InputKind) {
  using enum InputKind;
  return std::to_array<EnumWord<InputKind>>(
      {{Auto, "auto"}, {T1, "t1"}, {Labels, "labels"}, {FreeSurfer, "freesurfer"}, {Bids, "bids"}});
}

/// What to do with white and pial surfaces that are there already.
enum class GivenSurfaces {
  Use,    ///< take them over as they are
  Remake  ///< make our own from the labels
};
constexpr auto enumWords(GivenSurfaces) {
  using enum GivenSurfaces;
  return std::to_array<EnumWord<GivenSurfaces>>({{Use, "use"}, {Remake, "remake"}});
}

enum class RunHemisphere { Left, Right, Both };
constexpr auto enumWords(RunHemisphere) {
  using enum RunHemisphere;
  return std::to_array<EnumWord<RunHemisphere>>({{Left, "L"}, {Right, "R"}, {Both, "both"}});
}

/// Which of the three surfaces is unfolded.
enum class UnfoldedSurface { White, Mid, Pial };
constexpr auto enumWords(UnfoldedSurface) {
  using enum UnfoldedSurface;
  return std::to_array<EnumWord<UnfoldedSurface>>({{White, "white"}, {Mid, "mid"}, {Pial, "pial"}});
}

/// The commands of a run, in their order.
enum class RunStep { Segment, Thickness, Surface, Sphere, Register, Parcellate, Unfold, Report };
constexpr auto enumWords(RunStep) {
  using enum RunStep;
  return std::to_array<EnumWord<RunStep>>({{Segment, "segment"},
                                           {Thickness, "thickness"},
                                           {Surface, "surface"},
                                           {Sphere, "sphere"},
                                           {Register, "register"},
                                           {Parcellate, "parcellate"},
                                           {Unfold, "unfold"},
                                           {Report, "report"}});
}

/// How a run is put together; the steps' own options come on top.
struct PlanOptions {
  InputKind kind = InputKind::Auto;
  RunHemisphere hemisphere = RunHemisphere::Both;
  UnfoldedSurface unfolded = UnfoldedSurface::Mid;
  GivenSurfaces given = GivenSurfaces::Use;
  std::vector<RunStep> steps;              ///< those to do; empty for all that the input allows
  std::string cortexTemplate = "colin27";  ///< to register to; "none": the steps after `sphere`
                                           ///< are not among those that are done by themselves
};

template <class Visitor>
void describe(PlanOptions& options, Visitor&& visit) {
  visit(Field{"kind", "", "what the input is"}, options.kind);
  visit(
      Field{"hemisphere", "", "which hemisphere to work on; both where the input tells them apart"},
      options.hemisphere);
  visit(Field{"unfold-surface", "", "which surface to unfold a patch of"}, options.unfolded);
  visit(Field{"given-surfaces", "", "what to do with white and pial surfaces found in the input"},
        options.given);
  visit(Field{"steps", "", "steps to do (default: all that the input allows)"}, options.steps);
  visit(Field{"template", "",
              "cortex that hemispheres are registered to, and whose regions they get; see "
              "register; none: neither"},
        options.cortexTemplate);
}

/// One command of a run.
struct PlannedStep {
  std::string name;  ///< of its folder
  std::string command;
  std::vector<std::string> needs;                  ///< steps whose outputs it reads
  std::shared_ptr<nlohmann::ordered_json> values;  ///< options and positionals, as in --config
};

/// A file that a run reads, and what for.
struct SourceFile {
  std::string role;  ///< "labels", "white surface", ...
  std::filesystem::path path;
  std::string meaning;  ///< "FreeSurfer's ribbon", "1 grey, 2 white, 3 fluid"; may be empty
};

/// A run before it begins: what it reads, what it does, and what it does without.
struct Plan {
  InputKind kind = InputKind::Auto;  ///< never Auto
  std::vector<SourceFile> sources;
  std::vector<std::string> remarks;  ///< sentences for the user: what was missing, and so on
  std::vector<PlannedStep> steps;
};

/// What kind of input a path is.  A folder is a FreeSurfer subject or a BIDS anat folder (see
/// study::findSubjectFiles).  A volume of whole numbers with at most 64 different values, or with
/// FreeSurfer's cortex labels, holds labels; any other volume is a T1.
/// @throws IOError, InvalidInput  as readScalars and findSubjectFiles
[[nodiscard]] InputKind detectKind(const std::filesystem::path& input);

/// True if the labels tell the left hemisphere from the right one.
/// @throws as io::readLabels
[[nodiscard]] bool labelsHaveSides(const std::filesystem::path& labels);

/// The commands that lead from an input to a report, with the values that tie them together.
///
/// Three classes without names are told apart by their contacts: grey matter is the class that
/// touches both others most, so that fMRIPrep's order (1 grey, 2 white, 3 fluid) and ours
/// (1 fluid, 2 grey, 3 white) are both understood.
///
/// With both hemispheres, the steps after `segment` come twice, their names ending in -L and -R; an
/// input that does not tell the sides apart has one set of steps, without ending.
///
/// @param out    where the steps' folders will be
/// @param atlas  for a T1: labels in its space, instead of a template's brought there; otherwise
///               regions to report, instead of those found with the input
/// @throws InvalidInput  a step that the input does not allow
[[nodiscard]] Plan planRun(const std::filesystem::path& input, const std::filesystem::path& out,
                           const std::optional<std::string>& atlas, const PlanOptions& options);

/// The point of a surface where a patch is taken if none is named: of the vertices within 15 mm of
/// the line through the centroid along `direction`, the farthest out.
[[nodiscard]] Point outermostPoint(const TriangleMesh& mesh, const Vector& direction);

}  // namespace explica::pipeline
