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
#include <utility>
#include <vector>

namespace explica::pipeline {

/// What a run starts from.
enum class InputKind {
  Auto,       ///< told by the input itself, see detectKind
  T1,         ///< skull-stripped T1-weighted volume
  Labels,     ///< label volume of white and grey matter
  FreeSurfer  ///< subject directory with mri/ribbon.mgz
};

enum class RunHemisphere { Left, Right };

/// Which of the three surfaces is unfolded.
enum class UnfoldedSurface { White, Mid, Pial };

/// The commands of a run, in their order.
enum class RunStep { Segment, Thickness, Surface, Unfold, Report };

/// How a run is put together; the steps' own options come on top.
struct PlanOptions {
  InputKind kind = InputKind::Auto;
  RunHemisphere hemisphere = RunHemisphere::Left;
  UnfoldedSurface unfolded = UnfoldedSurface::Mid;
  std::vector<RunStep> steps;  ///< those to do; empty for all that the input allows
};

template <class Visitor>
void describe(PlanOptions& options, Visitor&& visit) {
  visit(Field{"kind", "", "what the input is"}, options.kind);
  visit(Field{"hemisphere", "", "which hemisphere to work on"}, options.hemisphere);
  visit(Field{"unfold-surface", "", "which surface to unfold a patch of"}, options.unfolded);
  visit(Field{"steps", "", "steps to do (default: all that the input allows)"}, options.steps);
}

/// One command of a run.
struct PlannedStep {
  std::string name;  ///< of its folder
  std::string command;
  std::vector<std::string> needs;                  ///< steps whose outputs it reads
  std::shared_ptr<nlohmann::ordered_json> values;  ///< options and positionals, as in --config
};

/// What kind of input a path is: a folder with mri/ribbon.mgz is a FreeSurfer subject; a volume of
/// whole numbers with at most 64 different values, or with FreeSurfer's cortex labels, holds
/// labels; any other volume is a T1.
/// @throws IOError, InvalidInput  as readScalars; a folder without ribbon
[[nodiscard]] InputKind detectKind(const std::filesystem::path& input);

/// The commands that lead from an input to a report, with the values that tie them together.
/// @param out    where the steps' folders will be
/// @param atlas  for a T1: labels in its space; without it only the whole brain's tissues can be
/// had
/// @throws InvalidInput  kind Auto, or a T1 without atlas where more than segmentation is asked for
[[nodiscard]] std::vector<PlannedStep> planRun(const std::filesystem::path& input,
                                               const std::filesystem::path& out,
                                               const std::optional<std::string>& atlas,
                                               const PlanOptions& options);

/// The point of a surface where a patch is taken if none is named: of the vertices within 15 mm of
/// the line through the centroid along `direction`, the farthest out.
[[nodiscard]] Point outermostPoint(const TriangleMesh& mesh, const Vector& direction);

}  // namespace explica::pipeline

namespace explica {

template <>
struct EnumNames<pipeline::InputKind> {
  static constexpr std::array table = {std::pair{pipeline::InputKind::Auto, "auto"},
                                       std::pair{pipeline::InputKind::T1, "t1"},
                                       std::pair{pipeline::InputKind::Labels, "labels"},
                                       std::pair{pipeline::InputKind::FreeSurfer, "freesurfer"}};
};
template <>
struct EnumNames<pipeline::RunHemisphere> {
  static constexpr std::array table = {std::pair{pipeline::RunHemisphere::Left, "L"},
                                       std::pair{pipeline::RunHemisphere::Right, "R"}};
};
template <>
struct EnumNames<pipeline::UnfoldedSurface> {
  static constexpr std::array table = {std::pair{pipeline::UnfoldedSurface::White, "white"},
                                       std::pair{pipeline::UnfoldedSurface::Mid, "mid"},
                                       std::pair{pipeline::UnfoldedSurface::Pial, "pial"}};
};
template <>
struct EnumNames<pipeline::RunStep> {
  static constexpr std::array table = {std::pair{pipeline::RunStep::Segment, "segment"},
                                       std::pair{pipeline::RunStep::Thickness, "thickness"},
                                       std::pair{pipeline::RunStep::Surface, "surface"},
                                       std::pair{pipeline::RunStep::Unfold, "unfold"},
                                       std::pair{pipeline::RunStep::Report, "report"}};
};

}  // namespace explica
