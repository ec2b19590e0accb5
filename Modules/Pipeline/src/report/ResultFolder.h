// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Folders.h"
#include "Explica/Core/Monitor.h"
#include "Explica/Core/Results.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Pipeline/RunState.h"
#include "Explica/Provenance/Json.h"
#include "Explica/Report/Page.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace explica::pipeline {

using provenance::Json;

/// One command's output folder.
struct StepFolder {
  std::string name;
  std::string command;
  std::filesystem::path folder;
  Json record;
  Json summary;

  [[nodiscard]] std::optional<double> number(std::string_view key) const;
  [[nodiscard]] std::string text(std::string_view key) const;  ///< of the summary; empty if absent
  [[nodiscard]] bool has(std::string_view file) const { return isThere(folder / file); }
  /// "left", "right", or empty where the step is about neither or both.
  [[nodiscard]] std::string side() const;
  /// ", left" after a title; empty without a side.
  [[nodiscard]] std::string sideWords() const;
};

/// A run's or command's folder, read once.
class ResultFolder {
 public:
  /// @throws InvalidInput  no command has written the folder
  ResultFolder(const std::filesystem::path& folder, const Monitor& monitor,
               report::ReportContent& content);

  [[nodiscard]] const std::vector<StepNote>& notes() const { return notes_; }
  [[nodiscard]] const std::vector<StepFolder>& steps() const { return steps_; }
  [[nodiscard]] std::vector<const StepFolder*> stepsOf(std::string_view command) const;
  /// The step of that command for the same hemisphere, else the only one, else nullptr.
  [[nodiscard]] const StepFolder* beside(const StepFolder& step, std::string_view command) const;
  [[nodiscard]] report::ReportContent& content() { return content_; }

  /// Does a part of the report; what goes wrong leaves only that part out, and is said.
  void attempt(const std::string& what, const std::function<void()>& part);

 private:
  void add(const std::filesystem::path& folder, const std::string& name);

  const Monitor& monitor_;
  report::ReportContent& content_;
  std::vector<StepNote> notes_;
  std::vector<StepFolder> steps_;
};

/// The file that a step read under a role, where it lies now.
[[nodiscard]] std::optional<std::filesystem::path> inputOf(const StepFolder& step,
                                                           std::string_view role);

[[nodiscard]] std::vector<std::filesystem::path> inputsOf(const StepFolder& step,
                                                          std::string_view role);

/// Files of a step's folder whose names end so, in order.
[[nodiscard]] std::vector<std::filesystem::path> filesOf(const StepFolder& step,
                                                         std::string_view ending);

/// The map of that name in a file, or its first where the name is empty.
[[nodiscard]] std::optional<io::VertexMap> mapNamed(const std::filesystem::path& file,
                                                    Eigen::Index vertexCount,
                                                    std::string_view name = {});

using explica::readable;
/// A share as a percentage.
[[nodiscard]] std::string percent(double share);
/// A value of a summary or of the options, as people read it.
[[nodiscard]] std::string readable(const Json& value);
/// Name of a step as people read it: "thickness-L" as "Thickness (left)".
[[nodiscard]] std::string titleOf(std::string_view step);
/// "area_error_mean" as "Area error mean".
[[nodiscard]] std::string inWords(std::string_view key);

}  // namespace explica::pipeline
