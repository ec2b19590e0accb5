// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Execute.h"

#include <sstream>
#include <string>
#include <vector>

namespace explica::app {

// How declarations are put into words: shared by help, reference pages and descriptions.

/// What stands for a parameter's value: "X,Y,Z", "MM", "hybrid|eulerian"; empty for flags.
[[nodiscard]] std::string placeholder(const Parameter& parameter);
/// The parameter as it is typed: "--radius MM".
[[nodiscard]] std::string leftColumn(const Parameter& parameter);
/// Its meaning, then kind of file, unit, range and default in brackets.
[[nodiscard]] std::string rightColumn(const Parameter& parameter);
/// "explica thickness [SEG] --out DIR [options]".
[[nodiscard]] std::string usageLine(const Declaration& declaration);

/// Writes words in lines of at most 96 columns; the first begins at `column`, others at `indent`.
void wrap(std::ostringstream& out, const std::string& text, std::size_t indent, std::size_t column);
/// Writes two columns.
void row(std::ostringstream& out, const std::string& left, const std::string& right);

/// The categories of options, in the order of their first one.
[[nodiscard]] std::vector<std::string> categoriesOf(const std::vector<Parameter>& parameters);
/// The declaration's parameters and the common ones, bound to `common`.
[[nodiscard]] std::vector<Parameter> allParameters(const Declaration& declaration,
                                                   CommonOptions& common);
/// The declared outputs, with summary and record where the command writes a folder.
[[nodiscard]] std::vector<OutputSlot> allOutputs(const Declaration& declaration);

/// A step whose options a command takes over, and what stands before their names.
struct StepOptions {
  std::string command, prefix;
};
[[nodiscard]] std::vector<StepOptions> stepsOf(const Declaration& declaration);

}  // namespace explica::app
