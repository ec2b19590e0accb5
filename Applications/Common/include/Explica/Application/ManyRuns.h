// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/Application/Declaration.h"
#include "Explica/Provenance/Json.h"

#include <filesystem>
#include <string>
#include <vector>

namespace explica::app {

/// What commands share that take many people through another command.

/// A name for the part of the work that these people are, whatever their order and with or without
/// "sub-"; empty for all of it.
/// @param further  what else parts the work, such as hemispheres
[[nodiscard]] std::string shareOfWork(const std::vector<std::string>& people,
                                      const std::vector<std::string>& further = {});

/// Those options of another command's declaration that the user gave to this one.
[[nodiscard]] provenance::Json givenOptions(const Context& context, const Declaration& declaration);

/// Warns of a run that failed, and writes why into problem.txt in its folder.
void sayProblem(Context& context, const std::string& name, const std::filesystem::path& folder,
                const std::string& why);

/// How work on many people ended: warns of those that failed.
/// @param data  names the whole, for messages; `what` is counted, such as "hearts"
/// @param worst  of those that did not fail
/// @throws InvalidInput  all failed
[[nodiscard]] Termination endOfRuns(Context& context, const std::string& data, const char* what,
                                    std::size_t all, const std::vector<std::string>& failed,
                                    Termination worst);

/// Takes back what the steps of an `explica run` below the output folder have left.
void dropSteps(Context& context, const std::string& run);

/// Writes into problem.txt that a run was interrupted before it had results: tables do not call
/// that a failure.
void sayInterrupted(const std::filesystem::path& folder);

/// What a part's numbers say against it counts against the whole, too.
/// @param kind  of the part, "run" or "step"
void passFlagsOn(Context& context, const char* kind, const std::filesystem::path& part);

}  // namespace explica::app
