// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Execute.h"

#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace explica::app {

// How declarations are put into words: shared by help, reference pages, manual pages, completion
// and descriptions.

/// What stands for a parameter's value: "X,Y,Z", "MM", "hybrid|eulerian"; empty for flags.
[[nodiscard]] std::string placeholder(const Parameter& parameter);
/// The parameter as it is typed: "--radius MM".
[[nodiscard]] std::string leftColumn(const Parameter& parameter);
/// Its meaning, then kind of file, unit, range and default in brackets.
[[nodiscard]] std::string rightColumn(const Parameter& parameter);
/// "explica thickness [SEG] --out DIR [options]".
[[nodiscard]] std::string usageLine(const Declaration& declaration);
/// The text with its ASCII letters in upper case.
[[nodiscard]] std::string upperCase(std::string text);

/// The text with every `from` in it put as `by`.
[[nodiscard]] std::string replaced(std::string text, std::string_view from, std::string_view by);

/// Two columns under a heading.
struct Section {
  std::string title;
  std::vector<std::pair<std::string, std::string>> rows;
};
/// Positional arguments under that title, then options by category, in the order of the first of
/// each.
[[nodiscard]] std::vector<Section> sectionsOf(const std::vector<Parameter>& parameters,
                                              const std::string& arguments = "Arguments");
/// The declaration's parameters and the common ones, bound to `common`.
[[nodiscard]] std::vector<Parameter> allParameters(const Declaration& declaration,
                                                   CommonOptions& common);
/// The declared outputs, with summary and record where the command writes a folder.
[[nodiscard]] std::vector<OutputSlot> allOutputs(const Declaration& declaration);
/// The steps whose options a command takes over: what stands before their names, and whose they
/// are.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> stepsOf(
    const Declaration& declaration);
/// What exit codes mean, by code.
[[nodiscard]] const std::vector<std::pair<std::string, std::string>>& exitCodes();
/// The same as a sentence.
[[nodiscard]] std::string exitCodesText();

/// Words in lines of at most 96 columns; the first begins at `column`, others at `indent`.
void wrap(std::ostringstream& out, const std::string& text, std::size_t indent = 0,
          std::size_t column = 0);
/// Two columns, as help has them.
void row(std::ostringstream& out, const std::string& left, const std::string& right);

}  // namespace explica::app
