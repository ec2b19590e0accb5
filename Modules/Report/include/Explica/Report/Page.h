// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Report/Evolution.h"
#include "Explica/Report/Picture.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace explica::report {

/// How a step of the work went.
enum class StepState { Done, StoppedEarly, Failed, Missing };

/// What one command did.
struct ReportStep {
  std::string name;  ///< "thickness"
  StepState state = StepState::Done;
  std::string message;  ///< why it failed or stopped; empty if it is done
  std::string commandLine;
  std::string version;  ///< of the software
  double seconds = 0;
  std::vector<std::pair<std::string, std::string>> numbers;  ///< from the summary: name, value
  std::vector<std::pair<std::string, std::string>> options;  ///< resolved, defaults included
  std::vector<std::string> warnings;
};

/// Something that a reader must know before trusting the result.
enum class FlagLevel { Good, Notice, Bad };
struct ReportFlag {
  FlagLevel level = FlagLevel::Good;
  std::string what;
  std::string why;
};

/// A picture and what it shows.
struct ReportPicture {
  std::string title;
  std::string caption;
  Picture picture;
};

/// Everything that a page shows.
struct ReportContent {
  std::string title;
  std::vector<ReportFlag> flags;
  std::vector<ReportStep> steps;
  std::vector<ReportPicture> pictures;
  std::vector<std::string> charts;  ///< SVG elements of Chart.h
  std::optional<Evolution> evolution;
};

/// One self-contained HTML page: styles, script, pictures and 3D data inside; opens from the file
/// system without any network request.  Contains neither the time of day nor random numbers.
[[nodiscard]] std::string reportPage(const ReportContent& content);

}  // namespace explica::report
