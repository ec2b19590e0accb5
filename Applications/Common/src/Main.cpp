// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Core/Memory.h"
#include "Explica/Core/Text.h"
#include "Explica/Provenance/Software.h"
#include "Limits.h"
#include "Parse.h"
#include "Run.h"
#include "Signals.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <optional>
#include <string_view>
#include <system_error>

namespace explica::app {
namespace {

using provenance::Json;

bool has(const std::vector<std::string>& words, const std::string& wanted) {
  const auto end = std::find(words.begin(), words.end(), "--");
  return std::find(words.begin(), end, wanted) != end;
}

/// What is asked of the program as a whole, before any command; true if it was answered.
bool answerAboutProgram(const std::string& word) {
  if (word == "--version") {
    std::cout << provenance::softwareText() << "\n" << provenance::builtWithText() << "\n";
  } else if (word == "--help" || word == "--help-all" || word == "-h") {
    std::cout << overviewText();
  } else if (word == "--describe") {
    std::cout << provenance::textOf(describeAllCommands(), 2) << "\n";
  } else {
    return false;
  }
  return true;
}

/// What is asked about a command instead of running it; true if it was answered.
bool answerAboutCommand(const Declaration& declaration, const std::vector<std::string>& words) {
  if (has(words, "--help-all")) {
    std::cout << helpText(declaration);
  } else if (has(words, "--help") || has(words, "-h")) {
    std::cout << firstHelpText(declaration);
  } else if (has(words, "--version")) {
    std::cout << provenance::softwareText() << "\n" << provenance::builtWithText() << "\n";
  } else if (has(words, "--describe")) {
    std::cout << provenance::textOf(describeJson(declaration), 2) << "\n";
  } else if (has(words, "--describe=page")) {
    std::cout << referencePage(declaration);
  } else {
    return false;
  }
  return true;
}

/// The kinds of a verb that is no command by itself, such as `phantom`; empty for other words.
std::string kindsText(const std::string& verb) {
  const auto kinds = kindsOf(verb);
  if (kinds.empty()) return {};
  std::string text = "explica " + verb + " KIND; kinds are\n";
  for (const Command* kind : kinds) {
    text += "  " + kind->name() + ": " + kind->begin().declaration.synopsisText + "\n";
  }
  return text;
}

[[noreturn]] void refuseUnknown(const std::vector<std::string>& words) {
  if (const auto kinds = kindsOf(words[0]); !kinds.empty()) {
    const std::string names = joined(
        kinds, ", ", [&](const Command* kind) { return kind->name().substr(words[0].size() + 1); });
    throw UsageError((words.size() > 1 ? "unknown kind '" + words[1] + "' of " : "no kind of ") +
                     words[0] + "; kinds are " + names);
  }
  std::vector<std::string> names;
  for (const Command& candidate : allCommands()) names.push_back(candidate.name());
  const std::string near = nearestWord(words[0], names);
  throw UsageError("unknown command '" + words[0] + "'" +
                   (near.empty() ? "; see explica --help" : "; did you mean '" + near + "'?"));
}

/// Says how it ended; a dry run's answer is the options as they were understood.
void report(const Run& run, const Outcome& outcome, Console& console) {
  if (run.common.dryRun) {
    Json options = Json::object();
    for (const Parameter& parameter : run.invocation.declaration.parameters) {
      options[parameter.option.name] = provenance::valueOf(parameter.option);
    }
    std::cout << provenance::textOf(options, 2) << "\n";
    if (outcome.exitCode == kDone) {
      console.info("dry run: inputs and options are usable; nothing was written");
    } else {
      console.warning("dry run: not all can be done, see above; nothing was written");
    }
    return;
  }
  if (outcome.abandoned) {
    console.warning("stopped (" + std::string(nameOf(outcome.termination)) +
                    ") before there was a result; nothing was written");
  }
  if (outcome.record.empty()) return;
  for (const std::string& line : outcome.head) console.info(line);
  const std::string where = outcome.record.parent_path().string();
  if (!outcome.plausible && reachedGoal(outcome.termination)) {
    console.warning("finished; check the results in " + where + " before using them");
  } else if (outcome.exitCode == kStoppedEarly) {
    console.warning("ended before its goal (" + std::string(nameOf(outcome.termination)) +
                    "); the results so far are in " + where);
  } else {
    console.info("done: results in " + where);
  }
}

/// --report: the page that `explica report` makes of the finished folder, which it leaves as it is.
void writeReport(const Run& run, const Outcome& outcome, Console& console) {
  if (!run.common.report || outcome.record.empty()) return;
  const std::string folder = outcome.record.parent_path().string();
  if (signalled()) {
    console.warning("no report: the run was asked to end; see explica report " + folder);
    return;
  }
  Run page;
  page.invocation = findCommand("report")->begin();
  page.argv = {"explica", "report", folder};
  page.given = parseWords(page.invocation.declaration, page.common, {"--", folder});
  page.common.threads = run.common.threads;
  execute(page, console);
}

int runCommandLine(std::vector<std::string> words, const std::vector<std::string>& argv,
                   Console& console, std::string& commandName) {
  if (words.empty()) {
    std::cerr << overviewText();
    return kUsage;
  }
  if (words[0] == "help") words.erase(words.begin()), words.push_back("--help");
  if (answerAboutProgram(words[0])) return kDone;

  const Command* command = nullptr;
  if (words.size() > 1) command = findCommand(words[0] + " " + words[1]);
  const std::size_t used = command ? 2 : 1;
  if (!command) command = findCommand(words[0]);
  if (!command) {
    const std::string kinds = kindsText(words[0]);
    if (kinds.empty() || !(has(words, "--help") || has(words, "--help-all"))) {
      refuseUnknown(words);
    }
    std::cout << kinds;
    return kDone;
  }
  commandName = command->name();
  words.erase(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(used));

  Run run;
  run.invocation = command->begin();
  Declaration& declaration = run.invocation.declaration;
  if (answerAboutCommand(declaration, words)) return kDone;
  run.given = parseWords(declaration, run.common, words);
  requireGiven(declaration, run.given);
  requireSomething(declaration, run.given);
  refuseIgnored(declaration, run.given);
  run.argv = argv;
  if (run.common.quiet) console.setLevel(Console::Level::Quiet);
  if (run.common.verbose) console.setLevel(Console::Level::Verbose);
  if (run.common.log) console.openLog(*run.common.log);

  if (run.common.maxMemory) limitMemory(*run.common.maxMemory);
  std::optional<TimeLimit> limit;
  if (run.common.maxTime) limit.emplace(*run.common.maxTime);
  const Outcome outcome = execute(run, console);
  report(run, outcome, console);
  writeReport(run, outcome, console);
  if (const auto checks = checksMade())
    console.info(std::to_string(*checks) + " checks for a stop");
  return outcome.exitCode;
}

}  // namespace

std::vector<const Command*> kindsOf(std::string_view verb) {
  std::vector<const Command*> kinds;
  for (const Command& command : allCommands()) {
    if (command.name().starts_with(std::string(verb) + " ")) kinds.push_back(&command);
  }
  return kinds;
}

const Command* findCommand(std::string_view name) {
  for (const Command& command : allCommands()) {
    if (command.name() == name) return &command;
  }
  return nullptr;
}

namespace {

/// Why what was printed, or the log, did not arrive; empty if all did.
std::string whatWasLost(const Console& console) {
  std::cout.flush();
  if (!std::cout || std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    return "what was printed is lost: standard output cannot be written";
  }
  return console.lost();
}

}  // namespace

int runMain(int argc, char** argv) {
  keepFreedMemory();
  const std::vector<std::string> all(argv, argv + argc);
  Console console;
  std::string command;
  const auto fail = [&](int code, const std::string& message) {
    console.endProgress();
    console.error("explica" + (command.empty() ? "" : " " + command) + ": " + message);
    return code;
  };
  catchSignals();
  try {
    const int code =
        runCommandLine({all.begin() + (all.empty() ? 0 : 1), all.end()}, all, console, command);
    const std::string lost = whatWasLost(console);
    return lost.empty() ? code : fail(kEnvironment, lost);
  } catch (const UsageError& error) {
    return fail(kUsage, error.what());
  } catch (const InvalidInput& error) {
    return fail(kBadInput, error.what());
  } catch (const IOError& error) {
    return fail(kBadInput, error.what());
  } catch (const EnvironmentError& error) {
    return fail(kEnvironment, error.what());
  } catch (const Json::exception& error) {
    // Values of the wrong type in a summary, a sidecar or the like, which no schema describes.
    return fail(kBadInput,
                std::string("a JSON file of the input holds what is not expected there (") +
                    error.what() + ")");
  } catch (const std::bad_alloc&) {
    return fail(kEnvironment, kOutOfMemory);
  } catch (const std::system_error& error) {
    const bool noThread = error.code() == std::errc::resource_unavailable_try_again;
    return fail(kEnvironment, noThread ? kOutOfMemory : error.what());
  } catch (const std::exception& error) {
    // So oneTBB says that its threads' stacks found no room.
    const bool noThread =
        std::string_view(error.what()).find("pthread_create") != std::string_view::npos;
    if (noThread) return fail(kEnvironment, kOutOfMemory);
    return fail(kEnvironment, std::string("internal error, please report it: ") + error.what());
  }
}

}  // namespace explica::app
