// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Execute.h"
#include "Explica/Provenance/Json.h"

#include <set>
#include <string>
#include <vector>

namespace explica::app {

/// The common options that make sense for a command, as parameters bound to `common`.
[[nodiscard]] std::vector<Parameter> commonParameters(const Declaration& declaration,
                                                      CommonOptions& common);

/// Sets the declaration's and the common values from words, and from the file that --config names.
/// @return names that were given, in either way
/// @throws UsageError  says what is wrong and, for a misspelt option, which one may be meant
std::set<std::string> parseWords(Declaration& declaration, CommonOptions& common,
                                 const std::vector<std::string>& words);

/// Sets values from JSON with (possibly nested) option names as keys; `source` starts messages.
/// @return the names set
/// @throws UsageError  unknown key or wrong value
std::set<std::string> applyJson(std::vector<Parameter*> parameters, const provenance::Json& values,
                                const std::string& source);

/// A required value that neither came by words nor by JSON.
/// @throws UsageError  names it
void requireGiven(const Declaration& declaration, const std::set<std::string>& given);

/// A command that reads files, called without any word.
/// @throws UsageError  shows how it is used
void requireSomething(const Declaration& declaration, const std::set<std::string>& given);
/// An option that has no effect beside another one, or without one.
/// @throws UsageError  says which to leave out
void refuseIgnored(const Declaration& declaration, const std::set<std::string>& given);
/// "--label", or a positional's name.
[[nodiscard]] std::string dashed(const Parameter& parameter);
/// What an option needs to have an effect: "--label or --method thesis"; empty if nothing.
[[nodiscard]] std::string needsText(const Declaration& declaration, const Parameter& parameter);

/// Commands whose names start with `verb `: the kinds of a verb.
[[nodiscard]] std::vector<const Command*> kindsOf(std::string_view verb);

/// The text of `explica --help`: the commands by task.
[[nodiscard]] std::string overviewText();
/// The text of --help: what goes in and out, the options that most people need, an example.
[[nodiscard]] std::string firstHelpText(const Declaration& declaration);
/// The text of --help-all.
[[nodiscard]] std::string helpText(const Declaration& declaration);
/// True for a parameter of the declaration, or a common one, that --help shows.
[[nodiscard]] bool shownAtFirst(const Declaration& declaration, const Parameter& parameter);

/// The whole declaration as JSON, from which reference pages and descriptors are made.
[[nodiscard]] provenance::Json describeJson(const Declaration& declaration);
/// All of them, in the order of their names.
[[nodiscard]] provenance::Json describeAllCommands();

/// Applications/<Name>/README.md.
[[nodiscard]] std::string referencePage(const Declaration& declaration);

/// The nearest of `candidates` if it is near enough to be a misspelling; else empty.
[[nodiscard]] std::string nearestWord(const std::string& word,
                                      const std::vector<std::string>& candidates);

}  // namespace explica::app
